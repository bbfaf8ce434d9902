"""Charts of figures, made of the tables that their functions return."""

import json

import pandas as pd

from bulkwear.postproc.plots.interactive import plotted
from bulkwear.workflows.report.products import Product


def drawn_chart(product: Product, table: pd.DataFrame, **beside: pd.DataFrame) -> dict:
    """Return what plotly draws of the first chart of a figure whose columns its table has."""
    fitting = [chart for chart in product.charts if chart.columns() <= set(table)]
    assert fitting, [sorted(chart.columns() - set(table)) for chart in product.charts]
    found = plotted(fitting[0], {"": table, **beside})
    return json.loads(json.dumps(found, allow_nan=False))


def names(found: dict) -> list[str]:
    """Return the entries of a chart's legend."""
    return [entry["name"] for entry in found["entries"]]


def values(found: dict, name: str, panel: int = 0, along: str = "y") -> list[list[float]]:
    """Return the values of the curves of an entry in one panel."""
    traces = [trace for trace in found["panels"][panel]["data"] if trace["legendgroup"] == name]
    return [trace[along] for trace in traces if trace.get("hoverinfo") != "skip"]
