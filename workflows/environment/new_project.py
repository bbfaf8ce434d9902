"""Make a project in a folder of its own, worked in with this package; what is in it stands in workflows/new_project."""

from __future__ import annotations

import shlex
import shutil
from pathlib import Path

import jinja2

PACKAGE = Path(__file__).resolve().parents[2]
PARTS = {".": PACKAGE / "workflows" / "new_project", "profiles": PACKAGE / "workflows" / "profiles"}
WITH_WORDS = ("Snakefile", "README.md")  # files in which the package's path is filled in
NAMES = {"gitignore": ".gitignore"}  # a file that would count here already


def make_project(folder: Path) -> str:
    """Write the files of a new project and return what to do next.

    Raises ValueError unless the folder is new or empty, for a package whose path Snakemake would misread, and where
    nothing can be written.
    """
    try:
        folder = folder.expanduser()
    except RuntimeError:  # pathlib's, for a user that the system does not know
        raise ValueError(f"{folder}: {folder.parts[0]} is the home of nobody, allowed is another folder.") from None
    if any(brace in str(PACKAGE) for brace in "{}"):
        raise ValueError(f"{PACKAGE}: the package is in a folder with a brace in its name, allowed is one without.")
    if any(brace in str(folder.absolute()) for brace in "{}"):
        raise ValueError(f"{folder}: found a brace in the name of the folder, allowed is one without.")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise ValueError(f"{folder}: there is something in it, allowed is a new or an empty folder.")
    try:
        _write(folder)
    except OSError as fault:
        raise ValueError(f"{folder}: {fault.strerror}, allowed is a folder that can be written to.") from None
    return f"{folder}: a project with the study first. Next: cd {shlex.quote(str(folder))} && snakemake"


def _write(folder: Path) -> None:
    """Copy texts alone: a package may be read-only, a project is not."""
    for place, part in PARTS.items():
        for path in (path for path in part.rglob("*") if path.is_file()):
            target = folder / place / path.relative_to(part)
            target = target.with_name(NAMES.get(target.name, target.name))
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
    words = jinja2.Environment(keep_trailing_newline=True, undefined=jinja2.StrictUndefined)
    for name in WITH_WORDS:
        text = words.from_string((folder / name).read_text(encoding="utf-8")).render(package=str(PACKAGE))
        (folder / name).write_text(text, encoding="utf-8")
