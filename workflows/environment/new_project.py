"""Make a project in a folder of its own, worked in with this package; what is in it stands in workflows/new_project."""

from __future__ import annotations

import shutil
from pathlib import Path

import jinja2

PACKAGE = Path(__file__).resolve().parents[2]
SKELETON = PACKAGE / "workflows" / "new_project"
PROFILES = PACKAGE / "workflows" / "profiles"
WITH_WORDS = ("Snakefile", "README.md")  # files in which the package's path is filled in


def make_project(folder: Path) -> str:
    """Write the files of a new project and return what to do next. Raises FileExistsError unless it is new or empty."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise FileExistsError(f"{folder}: there is something in it, allowed is a new or an empty folder.")
    shutil.copytree(SKELETON, folder, dirs_exist_ok=True)
    shutil.copytree(PROFILES, folder / "profiles")
    (folder / "gitignore").rename(folder / ".gitignore")
    words = jinja2.Environment(keep_trailing_newline=True, undefined=jinja2.StrictUndefined)
    for name in WITH_WORDS:
        path = folder / name
        path.write_text(words.from_string(path.read_text()).render(package=PACKAGE))
    return f"{folder}: a project with the study first. Next: cd {str(folder)!r} && snakemake"
