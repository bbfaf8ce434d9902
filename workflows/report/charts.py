"""Interactive figures of a page: read from the tables beside the pictures, written for the page's script."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from bulkwear.postproc.tables.summary import NAMES
from bulkwear.workflows.report.products import Product, outputs_of, paths_of

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study


def tables_of_charts(product: Product, study: Study) -> dict[str, str]:
    """Return {key: path} of the tables, besides its own, that a figure's charts are made of.

    Keys are those of the product's tables, or of its inputs that are one file. Raises ValueError for another one.
    """
    keys = {layer.table for chart in product.charts for panel in chart.panels for layer in panel.layers} - {""}
    inputs = {name: paths_of(product.inputs[name], study) for name in product.inputs if name in keys}
    known = {name: path for name, path in inputs.items() if isinstance(path, str)} | outputs_of(product, study.name)
    for key in keys - set(known):
        raise ValueError(f"chart of {product.name}: table {key!r}, allowed are {', '.join(known)}.")
    return {key: known[key] for key in sorted(keys)}


def chart_text(product: Product, beside: Mapping[str, str], folder: Path) -> str | None:
    """Return a figure's chart as JSON that may stand in a script element; None where it has none.

    beside: as from `tables_of_charts`; folder: results/<study>. A table that is not there is left out, with the layers
    that are made of it.
    """
    if not product.charts:
        return None
    from bulkwear.postproc.plots.interactive import plotted  # slow to import, and Snakemake reads this module first

    results = f"results/{folder.name}/"
    files = {
        key: folder / path.removeprefix(results) if path.startswith(results) else Path(path)
        for key, path in beside.items()
    }
    files[""] = folder / "figures" / f"{product.name}.csv"
    tables = {key: pd.read_csv(file, dtype=NAMES) for key, file in files.items() if file.is_file()}
    found = next(filter(None, (plotted(chart, tables) for chart in product.charts)), None)
    return json.dumps(found, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c") if found else None
