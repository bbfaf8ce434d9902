"""The page of a calibration: one HTML file that needs nothing else, read from the tables its jobs left."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd

from postproc.inference.posterior import FAMILY_SHARE
from workflows.cases.calibration.driver import SIMULATIONS
from workflows.cases.calibration.page import KEY_NUMBERS, simplifications
from workflows.cases.calibration.plots.responses import parameter_name, response_name
from workflows.cases.calibration.responses import RECOMMENDED, information_table, interval_table
from workflows.cases.calibration.tables import Calibrated, read_calibrated
from workflows.engine import state
from workflows.engine.bulk_simulations import BLOCKED
from workflows.report.figures import OF_CALIBRATIONS
from workflows.report.page import FORECAST, commit, data_uri, environment, figure
from workflows.report.text import setting_rows

PACKAGES = ("numpy", "scipy", "pandas", "scikit-learn", "matplotlib", "snakemake")


def write_page(path: Path, study: Mapping[str, Any], measured: Path, pairs: Path) -> None:
    """Write the page of a calibration beside its tables; study as in `pages.calibration.page_parameters`."""
    done = read_calibrated(study["run"], measured, pairs, path.parent)
    part = path.with_suffix(".html.part")
    part.write_text(environment().get_template(KEY_NUMBERS).render(page_context(done, study)), encoding="utf-8")
    os.replace(part, path)


def page_context(done: Calibrated, study: Mapping[str, Any]) -> dict[str, Any]:
    """Return everything that the template shows."""
    statements = done.statements
    intervals = interval_table(done.problem, done.known, done.pairs[done.compared])
    return {
        "study": study,
        "made": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "cards": cards(done, statements, intervals),
        "intervals": [{**row, "name": parameter_name(row["parameter"])} for row in intervals.to_dict("records")],
        "statements": [{**row, "name": response_name(row["response"])} for row in statements.to_dict("records")],
        "information": [
            {**row, "name": response_name(row["response"])}
            for row in information_table(done.problem, done.known).to_dict("records")
        ],
        "said": sentences(done, statements),
        "statements_csv": data_uri(statements.to_csv(index=False).encode(), "text/csv"),
        "figures": [figure(name, index, done.folder) for index, name in enumerate(OF_CALIBRATIONS, start=1)],
        "settings": setting_rows(study["settings"], study["paper_settings"]),
        "simplified": simplifications(study["settings"]),
        "cost": cost_table(done.folder).to_dict("records"),
        "forecast": forecast_row(pd.read_csv(done.folder / FORECAST)),
        "materials": (done.folder / "materials.yaml").read_text(),
        "versions": {"this project": commit(), "LIGGGHTS": solver_said(done.folder)}
        | {name: version(name) for name in PACKAGES},
    }


def cards(done: Calibrated, statements: pd.DataFrame, intervals: pd.DataFrame) -> list[dict[str, str]]:
    """Return the few numbers that answer the question."""
    share = float(statements.loc[statements["pair"] == done.compared, "denser_share"].iloc[0])
    other = ", ".join(f"{value:g}" for value in done.pairs[done.compared].values())
    found = [
        (f"{row.recommended:.2f}", f"{parameter_name(row.parameter)}, 95 % between {row.low:.2f} and {row.high:.2f}")
        for row in intervals.itertuples()
    ]
    found.append((str(len(done.simulations)), "simulations until the stopping rule or the limit"))
    where = "in" if share <= FAMILY_SHARE else "outside"
    found.append((f"{100.0 * share:.3g} %", f"of the posterior fits better than ({other}): {where} the family"))
    return [{"value": value, "label": label} for value, label in found]


def sentences(done: Calibrated, statements: pd.DataFrame) -> list[str]:
    """Return what the numbers say, one sentence per finding."""
    said = []
    for pair in (RECOMMENDED, done.compared):
        part = statements[statements["pair"] == pair]
        values = ", ".join(f"{value:.2f}" for value in done.pairs[pair].values())
        told = "; ".join(
            f"{response_name(row.response)} {row.simulated:.2f} ± {row.simulated_uncertainty:.2f} against"
            f" {row.measured:g} ± {row.measured_deviation:g}, {row.inside} ({row.deviations:+.1f} standard deviations)"
            for row in part[part["seeds"] > 0].itertuples()
        )
        said.append(f"The {pair.replace('_', ' ')} pair ({values}) gives: {told}.")
    said.append(_seed_sentence(done))
    blocked = int(sum(table[BLOCKED].sum() for table in (done.simulations, done.repeats) if BLOCKED in table))
    if blocked:
        flowed = len(done.simulations) + len(done.repeats)
        said.append(
            f"An arch blocked the slot in {blocked} packing(s), whose test was done again with another packing;"
            f" {flowed} tests gave an answer."
        )
    unknown = [name for name in done.problem.measured if name not in done.known.predicted]
    if unknown:
        names = ", ".join(response_name(name) for name in unknown)
        said.append(f"Measured but not simulated at this fidelity, so not part of the posterior: {names}.")
    return said


def _seed_sentence(done: Calibrated) -> str:
    scatter = "; ".join(
        f"{response_name(name)} {surrogate.seed_deviation:.2g}" for name, surrogate in done.known.surrogates.items()
    )
    return f"Standard deviation between packings, as the surrogates find it: {scatter}."


def cost_table(folder: Path) -> pd.DataFrame:
    """Return number, solver seconds and particles of the simulations of each kind."""
    rows = []
    for path in sorted((folder / SIMULATIONS).glob("*/cycle_000")):
        found = json.loads((path / state.STATE).read_text())
        rows.append({"test": found["test"]["kind"].replace("_", " "), **found["cost"]})
    table = pd.DataFrame(rows)
    grouped = table.groupby("test", as_index=False)
    return grouped.agg(
        simulations=("steps", "size"),
        solver_s=("solver_s", "sum"),
        most_particles=("particles", "max"),
        mean_steps=("steps", "mean"),
    )


def forecast_row(forecast: pd.DataFrame) -> dict[str, Any]:
    """Return what LIGGGHTS was forecast to take (s) if all simulations were needed, and by which rates."""
    return {"solver_s": float(forecast["solver_s"].sum()), "by": forecast["by"].iloc[0]}


def solver_said(folder: Path) -> str:
    """Return what LIGGGHTS called itself in one of the simulations."""
    path = next(iter(sorted((folder / SIMULATIONS).glob("*/cycle_000"))))
    return json.loads((path / state.STATE).read_text())["solver"] or "not reported"
