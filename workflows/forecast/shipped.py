"""What the package's studies cost by the default rates, as a page of docs.

`python -m bulkwear.workflows.forecast.shipped` writes it.
"""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.engine.project import PACKAGE, Project
from bulkwear.workflows.forecast.forecast import forecast_table, hours_text, wall_hours, work_of
from bulkwear.workflows.forecast.rates import DEFAULT, read_rates

FIDELITIES = ("quick", "standard", "paper")
CORES = 2
PAGE = PACKAGE / "docs" / "forecast_studies.md"
HEAD = f"""\
# Forecasts of the studies

Core hours, and wall time on {CORES} cores, by the default rates, with as many packings as each study has.
`python -m bulkwear.workflows.forecast.shipped` writes this page.

| study | {" | ".join(FIDELITIES)} |
|---|{"---|" * len(FIDELITIES)}
"""
Forecasts = Mapping[tuple[str, str], pd.DataFrame]  # table of jobs by study and fidelity


def shipped_forecasts() -> Forecasts:
    """Return the forecast of every study of the package at every fidelity."""
    rates = read_rates(PACKAGE / DEFAULT).rates
    return {
        (name, fidelity): forecast_table(work_of(load_study(name, overrides={"fidelity": fidelity}).foreseen), rates)
        for name in list_studies(Project(PACKAGE))
        for fidelity in FIDELITIES
    }


def page(forecasts: Forecasts) -> str:
    """Return the page: a line per study."""
    names = dict.fromkeys(name for name, _ in forecasts)
    cells = {name: [cost(forecasts[name, fidelity]) for fidelity in FIDELITIES] for name in names}
    return HEAD + "".join(f"| `{name}` | {' | '.join(costs)} |\n" for name, costs in cells.items())


def cost(table: pd.DataFrame) -> str:
    """Return core hours and wall time of the jobs of a study."""
    hours = float(f"{table['core_h'].sum():.2g}")
    return f"{hours:,.15g}; {hours_text(wall_hours(table, CORES))}"


if __name__ == "__main__":
    PAGE.write_text(page(shipped_forecasts()), encoding="utf-8")
