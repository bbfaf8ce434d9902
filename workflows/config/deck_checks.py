"""Checks of the templates of a study, before any solver starts: a fault ends in one sentence that names the file."""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jinja2
import jinja2.meta

from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.validation import locate
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.engine.template_files import DeckError, own_templates, templates_read
from bulkwear.workflows.engine.templates import template_variables

if TYPE_CHECKING:
    from bulkwear.workflows.engine.case import Case


@contextmanager
def template_faults_told() -> Iterator[None]:
    """Raise ConfigError, with file and line, for a filter or a test of a template that there is none of: Jinja finds
    these only where it compiles.
    """
    try:
        yield
    except jinja2.TemplateAssertionError as fault:
        words = fault.message.removesuffix(".")
        raise ConfigError(f"{_file_of(fault)}, line {fault.lineno}: {words}.") from None


def _file_of(fault: jinja2.TemplateAssertionError) -> str:
    """Return the template that has a fault, which itself names none."""
    environment, stamp = templates_read()
    for path in (Path(name) for name, _ in stamp):
        try:
            jinja2.meta.find_undeclared_variables(environment.parse(path.read_text(encoding="utf-8-sig")))
        except jinja2.TemplateAssertionError as found:
            if (found.lineno, found.message) == (fault.lineno, fault.message):
                folder = current_project().folder
                return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else str(path)
        except (jinja2.TemplateSyntaxError, UnicodeDecodeError):
            continue  # of no deck that was asked for
    return "templates"


def check_own_words(layers: tuple[Layer, ...], case: Case, words: Mapping[str, Any], decks: Callable[[], Any]) -> None:
    """Raise ConfigError for a word of the user's own that no template of a case uses, or that is one of ours, and for a
    template of the project's own that uses a word which nobody gives.

    decks: renders a deck of each kind
    """
    bed = (case.bed_template,) if case.bed_template else ()
    templates = (*case.run_templates, *bed, *case.more_templates)
    if not words and not own_templates():
        return
    for file in own_templates():
        _check_own_template(file)
    where = f"{locate(layers, ('deck',))}: " if words else ""
    try:
        unused = sorted(set(words).difference(*map(template_variables, templates)))
        if not unused:
            decks()
    except DeckError as fault:
        raise ConfigError(f"{where}{fault}") from None
    for word in unused:
        raise ConfigError(
            f"{locate(layers, ('deck', word))}: deck.{word} stands in no template, allowed is a word that one of"
            f" {', '.join(templates)} uses."
        )


def _check_own_template(file: Path) -> None:
    """Raise ConfigError for a template of the project's own that is empty or begins with a byte order mark."""
    text, shown = file.read_bytes(), file.relative_to(current_project().folder)
    if text.startswith(codecs.BOM_UTF8):
        raise ConfigError(
            f"{shown}: found a byte order mark, which the solver takes for a word, allowed is UTF-8 without one."
        )
    if not text.strip():
        raise ConfigError(f"{shown}: the file is empty, allowed is a template, or no such file.")
