"""The files of templates/: which there are, the project's before a case's and the package's, and their syntax.

What is read of a file is kept until it is written to; `templates_read_once` looks for that once, for much that is
asked at one moment.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, lru_cache
from pathlib import Path

import jinja2

from bulkwear.workflows.engine.project import TEMPLATES, current_project

Templates = tuple[jinja2.Environment, tuple[tuple[str, int], ...]]  # and (path, time in ns) of each file
_HELD: ContextVar[Templates | None] = ContextVar("templates", default=None)


class DeckError(ValueError):
    """A template and its parameters do not fit; the message names the template and the parameter."""


def template_folders() -> tuple[Path, ...]:
    """Return the folders in which a template is found by its name: of the project, each case's, then of the package."""
    roots = [folder / TEMPLATES for folder in current_project().folders]
    return tuple(found for root in roots if root.is_dir() for found in (root, *_of_cases(root)))


def _of_cases(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.is_dir() and not path.name.startswith("_"))


def own_templates() -> list[Path]:
    """Return the templates that are the current project's own, not the package's."""
    project = current_project()
    return [] if project.is_package else sorted((project.folder / TEMPLATES).rglob("*.in.j2"))


def template_file(name: str) -> Path:
    """Return the file that a template of that name is read from. Raises DeckError where there is none."""
    for folder in template_folders():
        if (folder / name).is_file():
            return folder / name
    raise DeckError(f"{TEMPLATES}/{name}: no such template.")


def shown_template(name: str) -> str:
    """Return the path of a template as messages show it: from the project's folder where it is the project's own.

    name: of its file, without .in.j2
    """
    path, folder = template_file(f"{name}.in.j2"), current_project().folder
    return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else str(path)


@cache
def environment_of(folders: tuple[Path, ...]) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders, encoding="utf-8-sig"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"table": pair_table, "particles_and_walls": particles_and_walls}
    return environment


def pair_table(rows: Sequence[Sequence[float]]) -> str:
    """Return a square table as the continued lines of a LIGGGHTS command."""
    return " &\n".join("     " + " ".join(f"{value:.9g}" for value in row) for row in rows)


def particles_and_walls(particles: float, walls: float, type_names: Sequence[str]) -> list[list[float]]:
    """Return the table of a property of all contacts between particles, the first type, and of all others."""
    return [[particles if i == j == 0 else walls for j, _ in enumerate(type_names)] for i, _ in enumerate(type_names)]


def templates_read() -> Templates:
    """Return the environment that reads templates, and which there are: as they are, or as looked at once."""
    return _HELD.get() or _templates_now()


def _templates_now() -> Templates:
    environment = environment_of(template_folders())
    return environment, tuple(sorted(_written(environment.loader.searchpath)))


@contextmanager
def templates_read_once() -> Iterator[None]:
    """Look once at which templates there are and when they were written, for all that is asked within."""
    token = _HELD.set(_HELD.get() or _templates_now())
    try:
        yield
    finally:
        _HELD.reset(token)


def _written(folders: Iterable[str]) -> Iterator[tuple[str, int]]:
    """Yield (path, time in ns) of every template; asked for at each use, where pathlib would take most of the time."""
    for folder in folders:
        for place, _, names in os.walk(folder):
            for name in names:
                if name.endswith(".in.j2"):
                    path = os.path.join(place, name)
                    yield path, os.stat(path).st_mtime_ns


@lru_cache(maxsize=256)
def parsed(environment: jinja2.Environment, name: str, path: Path, _written: int) -> jinja2.nodes.Template:
    """Return the syntax tree of a file; _written: when, in ns. Raises DeckError."""
    shown = shown_template(name.removesuffix(".in.j2"))
    try:
        return environment.parse(path.read_text(encoding="utf-8-sig"))
    except jinja2.TemplateSyntaxError as fault:
        words = fault.message.removesuffix(".")
        raise DeckError(f"{shown}, line {fault.lineno}: {words}.") from fault
    except UnicodeDecodeError as fault:
        raise DeckError(f"{shown}: byte {fault.start} is not UTF-8, allowed is UTF-8 text.") from fault
