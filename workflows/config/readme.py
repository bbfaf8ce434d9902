"""Write config/README.md from the schemas: every key with its unit, what is allowed and what it means.

python -m bulkwear.workflows.config.readme
"""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from bulkwear.postproc.wear.laws import LAWS, Law, Parameter
from bulkwear.workflows.config.columns import ANY_SETTING
from bulkwear.workflows.config.contact_checks import CONTACT_CHECKS
from bulkwear.workflows.config.law_settings import parameters_schema
from bulkwear.workflows.config.layers import KeyPath, dotted
from bulkwear.workflows.config.pin_checks import PIN_RANGE_CHECKS
from bulkwear.workflows.config.run_checks import COMMON_CHECKS, LAST_CHECKS, Check
from bulkwear.workflows.config.schema import leaves, load_schema, schema_files, subschema
from bulkwear.workflows.config.validation import NEEDED, allowed_text
from bulkwear.workflows.engine.cases import case_names, find_case
from bulkwear.workflows.engine.project import PACKAGE

INTRODUCTION = """\
# Configuration

Generated from the schemas (`workflows/config/schemas`, `workflows/cases/*/*.schema.yaml`) and the wear laws
(`postproc/wear/laws.py`) by `python -m bulkwear.workflows.config.readme`; edit these, not this page.

* `default.yaml`: settings that all cases share.
* `cases/<case>.yaml`: settings of one case, which stand above those.
* `studies/<name>.yaml`: one study of a case, or what it changes of one that it `extends`; it overrides settings, and
  its `fidelities` blocks override them again.
* The command line overrides all of them.
* `designs/*.csv`: design tables; each row makes a run, or one with each surface (`R9_convex`). Columns are those of the
  case; where they name a setting, the row overrides it. A column `note` is for remarks, and nothing reads it.
* `materials.yaml`: particles, walls and their contacts.

A project of one's own has such a folder too; [docs/project.md](../docs/project.md) tells how its files and these go
together.

Every key with a dimension ends in its unit; another unit is refused, and so is an unknown key. Numbers are
written as in YAML 1.2: `6.3e-13`, `1e-9` and `.5` are numbers, `'80'` and `80 mm` are not. `<name>` stands for a
name of your own. A key that is needed has no default; where its block may be left out, it is needed within that block.
"""

ANY_SETTING_WORDS = """\
Besides these, any setting of the case that is a number, a word or a list of numbers may be a column, under its
path with points, as `inlet.rate_t_per_h`; a list has spaces between its numbers. An empty cell leaves the setting as it
is.

"""

SETTINGS = "settings"  # ends the names of the schemas of what has defaults
CHECKS_TITLE = "Checks that compare values"

LAWS_HEAD = """\
## Wear laws

Values of `wear.law`. `wear.parameters` holds the parameters of the chosen law, in the units that their names spell;
those of another law are refused, and stand in `wear.beside.<law>`.

"""
LAW_TABLE = """

| key | law | unit | allowed | default | meaning |
|---|---|---|---|---|---|
"""

TABLES = (
    ("Settings", "settings", "of `default.yaml`, cases, studies, their fidelities and the command line"),
    ("Study", "study", "of `studies/<name>.yaml` besides settings"),
    ("Materials", "materials", "of `materials.yaml`"),
)
TABLES_OF_CASE = (
    ("Settings", "settings", "of `cases/{case}.yaml`, studies, their fidelities and the command line"),
    ("Study", "study", "of `studies/<name>.yaml` besides those of every study"),
    ("Design table", "design", "are the columns of `designs/*.csv`"),
)


def _rows(schema: dict[str, Any], given: bool) -> Iterator[str]:
    """Yield the rows of a schema's keys; given: whether what it requires is needed, for there are no defaults."""
    told = set()
    for path, inner in leaves(schema):
        for block in (path[:end] for end in range(1, len(path))):
            found = _schema_of(schema, block)
            if block not in told and "description" in found and (_needed(schema, block) or NEEDED in found):
                yield _row(schema, block, found, given)
            told.add(block)
        if "description" in inner:
            yield _row(schema, path, inner, given)


def _row(schema: dict[str, Any], path: KeyPath, inner: dict[str, Any], given: bool) -> str:
    unit = inner.get("x-unit", "-")
    allowed = allowed_text(inner).removesuffix(f" {unit}")
    needed = "; may be left out" if _optional_block(schema, path) else ""
    if _needed(schema, path) or (given and path[-1] in _schema_of(schema, path[:-1]).get("required", ())):
        needed = "; needed"
    overriding = f"; overrides `{inner['x-setting']}`" if "x-setting" in inner else ""
    return f"| `{dotted(path)}` | {unit} | {allowed}{needed} | {inner['description']}{overriding} |"


def _schema_of(schema: dict[str, Any], path: KeyPath) -> dict[str, Any]:
    return subschema(schema, path) or {}


def _needed(schema: dict[str, Any], path: KeyPath) -> bool:
    """Return whether a study has to give the key at a path, or in a block that it gives."""
    return path[-1] in _schema_of(schema, path[:-1]).get(NEEDED, ())


def _optional_block(schema: dict[str, Any], path: KeyPath) -> bool:
    """Return whether a block with keys that it needs has no defaults itself, and is no one of many."""
    above = _schema_of(schema, path[:-1])
    named = path[-1] in above.get("properties", {})
    return named and NEEDED in _schema_of(schema, path) and path[-1] not in above.get("required", ())


def table(name: str) -> str:
    """Return the Markdown table of one schema."""
    rows = _rows(load_schema(name), given=not name.endswith(SETTINGS))
    return "\n".join(["| key | unit | allowed | meaning |", "|---|---|---|---|", *rows])


def wear_laws() -> str:
    """Return the section about the wear laws and their parameters."""
    laws = [f"* `{name}`: {_words(law)} Source: {law.source}." for name, law in sorted(LAWS.items())]
    rows = [_parameter_row(name, parameter) for name, law in sorted(LAWS.items()) for parameter in law.parameters]
    return LAWS_HEAD + "\n".join(laws) + (LAW_TABLE + "\n".join(rows) if rows else "") + "\n"


def _words(law: Law) -> str:
    names = ("wear_coefficient_per_pa", *(f"parameters.{parameter.name}" for parameter in law.parameters))
    return law.words.format(**{name.rpartition(".")[2]: f"`wear.{name}`" for name in names})


def _parameter_row(law: str, parameter: Parameter) -> str:
    schema = parameters_schema(law)["properties"][parameter.name]
    allowed = allowed_text(schema).removesuffix(f" {schema['x-unit']}")
    default = "required" if parameter.default is None else f"{parameter.default:g}"
    unit = schema["x-unit"]
    return f"| `wear.parameters.{parameter.name}` | {law} | {unit} | {allowed} | {default} | {parameter.meaning} |"


def listed(checks: Iterable[Check]) -> str:
    """Return the Markdown list of checks."""
    return "Done before any solver starts:\n\n" + "\n".join(f"* {_first_paragraph(check)}" for check in checks)


def _first_paragraph(documented: Any) -> str:
    return " ".join((inspect.getdoc(documented) or "").partition("\n\n")[0].split())


def sections_of_case(name: str) -> Iterator[str]:
    """Yield the sections about one case."""
    yield f"## Case `{name}`\n\n{_first_paragraph(type(find_case(name)))}\n"
    for title, kind, where in TABLES_OF_CASE:
        schema = f"cases/{name}/{kind}"
        if schema_files(schema):
            beside = ANY_SETTING_WORDS if load_schema(schema).get(ANY_SETTING) else ""
            yield f"### {title}\n\nKeys {where.format(case=name)}.\n\n{beside}{table(schema)}\n"
    if checks := find_case(name).checks:
        yield f"### {CHECKS_TITLE}\n\n{listed(checks)}\n"


def readme() -> str:
    """Return the whole page."""
    sections = [f"## {title}\n\nKeys {where}.\n\n{table(name)}\n" for title, name, where in TABLES]
    cases = [section for name in case_names() for section in sections_of_case(name)]
    common = f"## {CHECKS_TITLE}\n\n{listed((*COMMON_CHECKS, *CONTACT_CHECKS, *PIN_RANGE_CHECKS, *LAST_CHECKS))}\n"
    return "\n".join([INTRODUCTION, sections[0], wear_laws(), *sections[1:], common, *cases])


def main(root: Path = PACKAGE) -> None:
    """Write config/README.md."""
    (root / "config" / "README.md").write_text(readme(), encoding="utf-8")


if __name__ == "__main__":
    main()
