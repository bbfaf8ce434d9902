"""Write config/README.md from the schemas: every key with its unit, what is allowed and what it means.

python -m workflows.config_readme
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from workflows.config_files import dotted
from workflows.design import REPOSITORY
from workflows.run_checks import RUN_CHECKS
from workflows.validation import allowed_text, leaves, load_schema

INTRODUCTION = """\
# Configuration

Generated from `workflows/schemas` by `python -m workflows.config_readme`; edit the schemas, not this page.

* `default.yaml`: settings of every study.
* `studies/<name>.yaml`: one study; it overrides settings, and its `fidelities` blocks override them again.
* The command line overrides all of them.
* `designs/*.csv`: design tables; one row and one surface make one run, `R9_convex`.
* `materials.yaml`: particles, walls and their contacts.

Every key with a dimension ends in its unit; another unit is refused, and so is an unknown key. Numbers are
written as in YAML 1.2: `6.3e-13`, `1e-9` and `.5` are numbers, `'80'` and `80 mm` are not.
"""

CHECKS = """\
## Checks that compare values

Done before any solver starts, in `workflows/run_checks.py`:

"""

TABLES = (
    ("Settings", "settings", "of `default.yaml`, studies, their fidelities and the command line"),
    ("Study", "study", "of `studies/<name>.yaml` besides settings"),
    ("Design table", "design", "are the columns of `designs/*.csv`"),
    ("Materials", "materials", "of `materials.yaml`"),
)


def _rows(schema: dict[str, Any]) -> Iterator[str]:
    for path, inner in leaves(schema):
        unit, meaning = inner.get("x-unit", "-"), inner.get("description")
        if meaning is not None:
            allowed = allowed_text(inner).removesuffix(f" {unit}")
            yield f"| `{dotted(path)}` | {unit} | {allowed} | {meaning} |"


def table(name: str) -> str:
    """Return the Markdown table of one schema."""
    return "\n".join(["| key | unit | allowed | meaning |", "|---|---|---|---|", *_rows(load_schema(name))])


def readme() -> str:
    """Return the whole page."""
    sections = [f"## {title}\n\nKeys {where}.\n\n{table(name)}\n" for title, name, where in TABLES]
    checks = "\n".join(f"* {(check.__doc__ or '').splitlines()[0]}" for check in RUN_CHECKS)
    return "\n".join([INTRODUCTION, *sections, CHECKS + checks]) + "\n"


def main(root: Path = REPOSITORY) -> None:
    """Write config/README.md."""
    (root / "config" / "README.md").write_text(readme(), encoding="utf-8")


if __name__ == "__main__":
    main()
