"""Render the templates of templates/, the project's before the package's, into decks that run by hand.

A deck's parameters are SI numbers and words; what a template does not use, and what it uses but is not given, is an
error. Two sections reach templates whole, and need not be used up: `solver`, as one mapping, and `deck`, the user's own
words.
"""

from __future__ import annotations

import operator
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from traceback import extract_tb
from types import MappingProxyType
from typing import Any

import jinja2
import jinja2.meta

from bulkwear.workflows.engine.state import digest
from bulkwear.workflows.engine.template_files import (
    DeckError,
    own_templates,
    parsed,
    shown_template,
    template_file,
    templates_read,
)

SOLVER, OWN = "solver", "deck"  # sections of a run, a bed or a test that reach its templates whole
PRUNING = threading.RLock()  # trees are shared
TESTS = {"eq": operator.eq, "ne": operator.ne, "in": lambda value, several: value in several}  # of branches


def _is_own(template: str) -> bool:
    """Return whether a template, or a partial that it includes, is the current project's own."""
    own = own_templates()
    return bool(own) and any(template_file(name) in own for name in _uses(template, {}).variables)


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
    environment, stamp = templates_read()
    chosen = [(name, value) for name, value in words.items() if name != SOLVER]
    chosen += [(f"{SOLVER}.{name}", value) for name, value in words.get(SOLVER, {}).items()]
    choosing = _kept_choosing(environment, template, stamp)
    decided = sorted(each for each in chosen if each[0] in choosing and isinstance(each[1], str | int))
    return _kept_uses(environment, template, tuple(decided), stamp)


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

    The trees are kept for the next words: their branches are pruned within the context only, by one thread at a time.
    """
    written = dict(stamp)
    trees: dict[str, jinja2.nodes.Template] = {}
    names = [f"{template}.in.j2"]
    with PRUNING, ExitStack() as pruned:
        for name in names:
            path = template_file(name)
            trees[name] = parsed(environment, name, path, written.get(str(path), 0))
            for branch in trees[name].find_all(jinja2.nodes.If):
                pruned.callback(_prune(branch, words))
            found = jinja2.meta.find_referenced_templates(trees[name])
            names.extend(part for part in found if part and part not in names)
        yield trees


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

    Raises DeckError for missing parameters, for unused ones but in a project's own template, for an own word that is
    one of the other parameters, and, with the line, for what fails while the template is filled.
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
        return templates_read()[0].get_template(f"{template}.in.j2").render({**given, **own})
    except Exception as fault:  # what is computed in a template may fail in any way
        said = f"{type(fault).__name__}: {str(fault).removesuffix('.')}."
        raise DeckError(f"{_place_of(fault, template)}: {said}") from fault


def _place_of(fault: Exception, template: str) -> str:
    """Return the file, and where it is known the line, of a template or of a partial that a fault arose in."""
    lines = [(Path(frame.filename), frame.lineno) for frame in extract_tb(fault.__traceback__)]
    files = {template_file(name): name.removesuffix(".in.j2") for name in _uses(template, {}).variables}
    innermost = next(((files[path], line) for path, line in reversed(lines) if path in files), None)
    return f"{shown_template(innermost[0])}, line {innermost[1]}" if innermost else shown_template(template)
