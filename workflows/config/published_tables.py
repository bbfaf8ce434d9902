"""Tables of published numbers, config/published/*.csv: checked before anything runs, one sentence per fault."""

from __future__ import annotations

from pathlib import Path

from bulkwear.workflows.config.layers import Layer, display_name, read_csv_rows
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.validation import cell_value, check_columns, check_layer
from bulkwear.workflows.engine.project import Project

FOLDER = Path("config") / "published"
SCHEMA = "published"


def check_published(project: Project) -> None:
    """Check the tables of a project's own; those that the package has no schema for only for whole rows.

    Raises ConfigError naming file, line and column.
    """
    for path in sorted((project.folder / FOLDER).glob("*.csv")):
        check_table(path, project.folder)


def check_table(path: Path, root: Path) -> None:
    """Check one table; root: folder from which it is named. Raises ConfigError."""
    header, rows = read_csv_rows(path, root)
    schema = load_schema(SCHEMA)["properties"].get(path.name)
    if schema is None:
        return
    source = display_name(path, root)
    check_columns(header, schema, source)
    for line, cells in rows:
        filled = {name: cell_value(text, schema["properties"][name]) for name, text in cells.items() if text}
        check_layer(Layer(source, filled, {(): line}), schema)
