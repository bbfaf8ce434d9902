"""Where numba keeps what it has compiled: a folder that always works.

It writes beside the modules, or into the user's cache. Where neither can be written, as in a read-only installation of
a user without a home, it does not compile at all; it then gets a folder of this user's in the temporary folder.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

VARIABLE = "NUMBA_CACHE_DIR"


def choose_cache(package: Path) -> None:
    """Name a folder in the environment unless one is named there, or one of numba's own can be written.

    package: folder of the modules that are compiled
    """
    if VARIABLE in os.environ or _writable(package) or _writable(_user_cache()):
        return
    os.environ[VARIABLE] = str(_own_folder())


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
