"""Render the templates of templates/, the project's before the package's, into decks that run by hand.

A deck's parameters are SI numbers and words; what a template does not use, and what it uses but is not given, is an
error. Two sections reach templates whole, and need not be used up: `solver`, as one mapping, and `deck`, the user's own
words.
"""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import jinja2
import jinja2.meta

from bulkwear.workflows.engine.project import TEMPLATES, current_project
from bulkwear.workflows.engine.state import digest

SOLVER, OWN = "solver", "deck"  # sections of a run, a bed or a test that reach its templates whole
TESTS = {"eq": operator.eq, "ne": operator.ne, "in": lambda value, several: value in several}  # of branches


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


def _is_own(template: str) -> bool:
    """Return whether a template, or a partial that it includes, is the current project's own."""
    own = own_templates()
    return bool(own) and any(template_file(name) in own for name in _uses(template, {}).variables)


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
def _environment(folders: tuple[Path, ...]) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
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


Templates = tuple[jinja2.Environment, tuple[tuple[str, int], ...]]  # and (path, time in ns) of each
_HELD: ContextVar[Templates | None] = ContextVar("templates", default=None)


@dataclass(frozen=True)
class Uses:
    """What a template and its partials use.

    variables: {file name: names of parameters}; settings: as `solver_settings` returns them
    """

    variables: Mapping[str, frozenset[str]]
    settings: Mapping[str, str]


def _uses(template: str, words: Mapping[str, Any]) -> Uses:
    """Return what a template and its partials use, without branches that `words` do not take.

    That is decided for branches `{% if name == "word" %}` whose name, or `solver.name`, `words` has, and for those with
    `!=` and `in ("word", "other")`; all others count as taken.
    """
    environment, stamp = _HELD.get() or _templates_now()
    chosen = [(name, value) for name, value in words.items() if name != SOLVER]
    chosen += [(f"{SOLVER}.{name}", value) for name, value in words.get(SOLVER, {}).items()]
    choosing = _kept_choosing(environment, template, stamp)
    decided = sorted(each for each in chosen if each[0] in choosing and isinstance(each[1], str | int))
    return _kept_uses(environment, template, tuple(decided), stamp)


def _templates_now() -> Templates:
    environment = _environment(template_folders())
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


@lru_cache(maxsize=64)
def _kept_choosing(environment: jinja2.Environment, template: str, stamp: tuple[tuple[str, int], ...]) -> set[str]:
    """Return the names of the words that choose a branch in a template or its partials."""
    with _pruned_trees(environment, template, {}, stamp) as trees:
        tests = [_choice(branch) for tree in trees.values() for branch in tree.find_all(jinja2.nodes.If)]
    return {test[0] for test in tests if test}


@lru_cache(maxsize=256)  # every run and cycle asks for the same few; `stamp` tells edited files
def _kept_uses(
    environment: jinja2.Environment, template: str, chosen: tuple, stamp: tuple[tuple[str, int], ...]
) -> Uses:
    settings: dict[str, str] = {}
    with _pruned_trees(environment, template, dict(chosen), stamp) as trees:
        for tree in trees.values():
            for name, chosen_by in _solver_settings(tree):
                settings[name] = chosen_by if settings.get(name, chosen_by) else ""
        variables = {file: frozenset(jinja2.meta.find_undeclared_variables(tree)) for file, tree in trees.items()}
    return Uses(variables, settings)


@contextmanager
def _pruned_trees(
    environment: jinja2.Environment, template: str, words: Mapping[str, Any], stamp: Iterable[tuple[str, int]]
) -> Iterator[dict[str, jinja2.nodes.Template]]:
    """Give {file name: syntax tree} of a template and its partials, see `_uses`; words by the names of `_choice`.

    The trees are kept for the next words: their branches are pruned within the context only.
    """
    written = dict(stamp)
    trees: dict[str, jinja2.nodes.Template] = {}
    names = [f"{template}.in.j2"]
    with ExitStack() as pruned:
        for name in names:
            path = template_file(name)
            trees[name] = _parsed(environment, name, path, written[str(path)])
            for branch in trees[name].find_all(jinja2.nodes.If):
                pruned.callback(_prune(branch, words))
            found = jinja2.meta.find_referenced_templates(trees[name])
            names.extend(part for part in found if part and part not in names)
        yield trees


@lru_cache(maxsize=256)
def _parsed(environment: jinja2.Environment, name: str, path: Path, _written: int) -> jinja2.nodes.Template:
    """Return the syntax tree of a file; _written: when, in ns. Raises DeckError."""
    shown = shown_template(name.removesuffix(".in.j2"))
    try:
        return environment.parse(path.read_text(encoding="utf-8-sig"))
    except jinja2.TemplateSyntaxError as fault:
        raise DeckError(f"{shown}, line {fault.lineno}: {fault.message}.") from fault
    except UnicodeDecodeError as fault:
        raise DeckError(f"{shown}: byte {fault.start} is not UTF-8, allowed is UTF-8 text.") from fault


def _prune(branch: jinja2.nodes.If, words: Mapping[str, Any]) -> Callable[[], None]:
    """Empty the part of a branch that `words` do not take; return what fills it again."""
    test, whole = _choice(branch), (branch.body, branch.else_)
    if test and test[0] in words:
        name, operator, value = test
        taken = TESTS[operator](words[name], value)
        branch.body, branch.else_ = (branch.body, []) if taken else ([], branch.else_)

    def fill() -> None:
        branch.body, branch.else_ = whole

    return fill


def _choice(branch: jinja2.nodes.If) -> tuple[str, str, Any] | None:
    """Return (name or solver.name, operator, value) of a branch that a word decides; None of any other one."""
    test = branch.test
    if not isinstance(test, jinja2.nodes.Compare) or len(test.ops) != 1 or test.ops[0].op not in TESTS:
        return None
    if not isinstance(test.ops[0].expr, jinja2.nodes.Literal):
        return None
    of_solver, name = _is_solver_setting(test.expr), test.expr
    if not of_solver and not isinstance(name, jinja2.nodes.Name):
        return None
    return f"{SOLVER}.{name.attr}" if of_solver else name.name, test.ops[0].op, test.ops[0].expr.as_const()


def _is_solver_setting(node: jinja2.nodes.Node) -> bool:
    """Return whether a node is `solver.name`."""
    return (
        isinstance(node, jinja2.nodes.Getattr) and isinstance(node.node, jinja2.nodes.Name) and node.node.name == SOLVER
    )


def _solver_settings(node: jinja2.nodes.Node, chosen_by: str = "") -> Iterator[tuple[str, str]]:
    """Yield (name, setting that the branch asks for in which it stands) of each `solver.name` below a node."""
    if _is_solver_setting(node):
        yield node.attr, chosen_by
    for child in node.iter_child_nodes():
        in_branch = isinstance(node, jinja2.nodes.If) and child is not node.test
        asked = next((name for name, _ in _solver_settings(node.test)), "") if in_branch else ""
        yield from _solver_settings(child, asked or chosen_by)


def template_sources(template: str) -> dict[str, str]:
    """Return {file name: text} of a template and its partials: what a deck depends on besides its parameters."""
    return {name: template_file(name).read_text(encoding="utf-8") for name in _uses(template, {}).variables}


def templates_digest(*templates: str) -> str:
    """Return the hash of templates and their partials, for what runs decks that no digest of a run holds."""
    return digest(*map(template_sources, templates))


def template_variables(template: str, words: Mapping[str, Any] = MappingProxyType({})) -> set[str]:
    """Return the names of all parameters that a template and its partials use, in the branches that `words` take."""
    return set().union(*_uses(template, words).variables.values())


def template_users(template: str, names: set[str], words: Mapping[str, Any]) -> list[str]:
    """Return which of a template and its partials, without .in.j2, use one of these parameters."""
    used = _uses(template, words).variables
    return [part.removesuffix(".in.j2") for part, variables in used.items() if names & variables]


def solver_settings(template: str, words: Mapping[str, Any] = MappingProxyType({})) -> dict[str, str]:
    """Return {setting of the solver's section that a template uses: the one whose value makes it do so}.

    words: as for `template_variables`; "" for what is used whatever the others are
    """
    return dict(_uses(template, words).settings)


def whole_sections(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sections of a run, a bed or a test that reach its templates whole."""
    return {name: parameters[name] for name in (SOLVER, OWN)}


def used_sections(template: str, parameters: Mapping[str, Any], **words: Any) -> dict[str, Any]:
    """Return these sections with what the deck of a template depends on: beds that differ in nothing else are equal.

    words: further ones that choose branches
    """
    used = _uses(template, {**whole_sections(parameters), **words})
    kept = {"rayleigh_fraction", *used.settings}  # `integration` uses that one too
    own = set().union(*used.variables.values())
    return {
        SOLVER: {name: value for name, value in parameters[SOLVER].items() if name in kept},
        OWN: {name: value for name, value in parameters[OWN].items() if name in own},
    }


def render(template: str, parameters: Mapping[str, Any]) -> str:
    """Return the deck of a template, e.g. "settled_bed"; parameters hold its `whole_sections` too.

    Raises DeckError for missing parameters, for unused ones but in a project's own template, and for an own word that
    is one of the other parameters.
    """
    own = parameters.get(OWN, {})
    given = {name: value for name, value in parameters.items() if name != OWN}
    used = _uses(template, given)
    wanted = set().union(*used.variables.values())
    missing = {f"solver.{name}" for name in used.settings}
    missing -= {f"solver.{name}" for name in given.get(SOLVER, {})}
    unused = set() if _is_own(template) else set(given) - wanted - {SOLVER}
    unknown = (wanted - {*given, *own}) | missing
    if unknown:
        using = next((part for part in template_users(template, unknown, given)), template)
        words = f"is not given, allowed are its deck's words and those of `{OWN}`"
        raise DeckError(f"{shown_template(using)}: parameter {', '.join(sorted(unknown))} {words}.")
    for names, fault in (
        (unused, "is never used"),
        (set(given) & set(own), "is one of ours, no word of deck may be called so"),
    ):
        if names:
            raise DeckError(f"{shown_template(template)}: parameter {', '.join(sorted(names))} {fault}.")
    try:
        return _environment(template_folders()).get_template(f"{template}.in.j2").render({**given, **own})
    except Exception as fault:  # what is computed in a template may fail in any way
        raise DeckError(f"{shown_template(template)}: {type(fault).__name__}: {fault}.") from fault
