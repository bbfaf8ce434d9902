"""Where the drawings of parts are: files in meshes of the project or the package, drawn by a script where missing."""

from __future__ import annotations

import difflib
import subprocess
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.engine.state import digest, file_digest

MESHES = "meshes"
SCRIPT = "draw.py"  # in the folder of drawings: python draw.py <folder> writes them all there


def drawing_source(name: str) -> Path:
    """Return the file of a drawing, or the script that draws it where there is no such file.

    name: path below meshes. Raises ConfigError where there is neither.
    """
    project = current_project()
    for candidate in (Path(MESHES, name), Path(MESHES, name).with_name(SCRIPT)):
        if found := project.every(candidate.as_posix()):
            return found[0]
    raise ConfigError(
        f"{MESHES}/{name}: there is no such file{_nearest(name)}, and no {SCRIPT} in its folder that draws it; "
        f"allowed is a CAD or mesh file in {MESHES} of the project or the package."
    )


def _nearest(name: str) -> str:
    """Return which file of the folder has nearly that name, in brackets, where there is one; of a name with backslashes
    how folders are parted.
    """
    if "\\" in name:
        return " (folders are parted by /)"
    try:
        beside = current_project().names(Path(MESHES, name).parent.as_posix(), "")
    except OSError:  # a name that no file system takes
        return ""
    small = {each.lower(): each for each in beside}
    near = difflib.get_close_matches(Path(name).name.lower(), list(small), n=1)
    return f" (the nearest is {small[near[0]]})" if near else ""


def check_solid(part: Mapping[str, Any], names: Iterable[str]) -> None:
    """Raise ConfigError for a part whose solid is not among the names of its drawing's."""
    if "solid" in part and part["solid"] not in names:
        raise ConfigError(f"parts.{part['name']}.solid is '{part['solid']}', allowed is one of {', '.join(names)}.")


def drawing_digest(name: str) -> str:
    """Return the hash of a drawing, or of the script that draws it. Raises ConfigError where there is neither."""
    source = drawing_source(name)
    return digest(source.name, file_digest(source))


def drawing(name: str, folder: Path) -> Path:
    """Return the file of a drawing, drawn into the folder first where there is only its script.

    Raises ConfigError with the script's last words where it fails or does not draw it.
    """
    source = drawing_source(name)
    if source.name != SCRIPT:
        return source
    drawn = folder / name
    if not drawn.is_file():
        drawn.parent.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([sys.executable, str(source), str(drawn.parent)], capture_output=True, text=True)
        if done.returncode or not drawn.is_file():
            found = sorted(path.name for path in drawn.parent.iterdir())
            words = (done.stderr.strip().splitlines() or [f"it drew {', '.join(found) or 'nothing'}"])[-1]
            raise ConfigError(f"{MESHES}/{name}: {SCRIPT} in its folder did not draw it: {words}.")
    return drawn
