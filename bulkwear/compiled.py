"""Where numba keeps what it has compiled, a folder that always works, and that it is not older than the source.

It writes beside the modules, or into the user's cache. Where neither can be written, as in a read-only installation of
a user without a home, it does not compile at all; it then gets a folder of this user's in the temporary folder.
"""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from pathlib import Path

VARIABLE = "NUMBA_CACHE_DIR"
SHARED = "triangle.py"  # of postproc, arithmetic that these modules hold compiled copies of
CALLERS = ("mesh_cuts.py", "wear/face_kernels.py", "wear/remesh_kernels.py")


def choose_cache(package: Path) -> None:
    """Name a folder in the environment unless one is named there, or one of numba's own can be written.

    package: folder of the modules that are compiled
    """
    if VARIABLE in os.environ or _writable(package) or _writable(_user_cache()):
        return
    os.environ[VARIABLE] = str(_own_folder())


def forget_older(package: Path) -> None:
    """Remove numba's indices of modules whose compiled code is older than the shared arithmetic that it holds a copy
    of: numba itself looks at the time of the module alone. For what it keeps beside modules.
    """
    newest = (package / SHARED).stat().st_mtime
    for caller in (package / name for name in CALLERS):
        for index in (caller.parent / "__pycache__").glob(f"{caller.stem}.*.nbi"):
            with suppress(OSError):  # another process was first, or nothing can be written there
                if index.stat().st_mtime < newest:
                    index.unlink()


def _user_cache() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path(os.environ.get("HOME", "/")) / ".cache") / "numba"


def _writable(folder: Path) -> bool:
    """Return whether files can be written to a folder, or it can be made."""
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    return folder.is_dir() and os.access(folder, os.W_OK | os.X_OK)


def _own_folder() -> Path:
    """Return a folder that is this user's alone: what lies in it is run."""
    import tempfile  # slow to import, and few need it

    folder = Path(tempfile.gettempdir()) / f"bulkwear_numba_{os.getuid()}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
        if stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077:
            return folder
    except OSError:
        pass
    return Path(tempfile.mkdtemp(prefix="bulkwear_numba_"))
