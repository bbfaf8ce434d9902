"""The best design of each flow regime as a design table, and simulated runs of it against the prediction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import ORDER, groups_of_rows
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import WEAR
from bulkwear.workflows.cases.sliding_sample.screening.study_regression import Screening, best_design_table

DIGITS = 6  # significant, of a level in the design table
PREDICTED = ("predicted", "run_low", "run_high")


def best_of_regimes(
    study: Screening,
    summary: pd.DataFrame,
    regimes: pd.DataFrame,
    columns: Mapping[str, str],
    conditions: Sequence[str],
) -> pd.DataFrame:
    """Return the design of least predicted wear in each regime that was found, with the interval of one further run.

    columns: {short name: column of the design} of the factors; conditions: columns of the design that are no property
    of the pattern. They are held, one after the other, at every combination at which a patterned run had the regime, so
    a regime is not claimed where it was not seen; the best pattern of the best combination is taken.

    Columns row (the regime), those of the factors, not_in_model, and predicted, run_low and run_high _m3_per_m.
    """
    groups = groups_of_rows(regimes)
    runs = summary[summary["surface"] != PLAIN].assign(regime=lambda table: table["row"].map(groups))
    held = {short: column for short, column in columns.items() if column in conditions}
    lines = []
    for regime in (name for name in ORDER if (runs["regime"] == name).any()):
        seen = runs[runs["regime"] == regime]
        cases = seen[list(held.values())].drop_duplicates().rename(columns={column: k for k, column in held.items()})
        found = best_design_table(study, cases.to_dict("records"))
        best = found.loc[found["predicted"].idxmin()]
        levels = {column: float(f"{best[short]:.{DIGITS}g}") for short, column in columns.items()}
        predicted = {f"{name}_m3_per_m": best[name] for name in PREDICTED}
        lines.append({"row": regime, **levels, **predicted, "not_in_model": best["not_in_model"]})
    return pd.DataFrame(lines)


def design_of(predictions: pd.DataFrame, design: pd.DataFrame, columns: Sequence[str]) -> pd.DataFrame:
    """Return a design table (row and columns) of `best_of_regimes`.

    design: of the study; columns that are no factor have their value there. Raises ValueError where there are several.
    """
    table = predictions.reindex(columns=["row", *columns])
    for column in (name for name in columns if name not in predictions):
        values = design[column].unique()
        if len(values) > 1:
            raise ValueError(
                f"column {column} is no factor and has {len(values)} values, allowed is one value to confirm at"
            )
        table[column] = values[0]
    return table


def confirmation_table(predictions: pd.DataFrame, summary: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return prediction and simulation of each packing, in display units, and whether its run is inside the interval.

    predictions: as from `best_of_regimes`; summary, regimes: of the confirming study, whose settings have the names of
    their rows
    Columns row, setting, found_regime, predicted, run_low, run_high, simulated, plain (all mm3_per_m), inside,
    over_predicted.
    """
    patterned, plain = (summary[(summary["surface"] == PLAIN) == which].set_index("row") for which in (False, True))
    predicted = predictions[["row", *(f"{name}_m3_per_m" for name in PREDICTED)]].rename(columns={"row": "setting"})
    table = patterned["setting"].reset_index().merge(predicted, on="setting")
    simulated = table["row"].map(patterned[WEAR])
    table = table.assign(
        found_regime=table["row"].map(groups_of_rows(regimes)),
        simulated_m3_per_m=simulated,
        plain_m3_per_m=table["row"].map(plain[WEAR]),
        inside=simulated.between(table["run_low_m3_per_m"], table["run_high_m3_per_m"]),
        over_predicted=simulated / table["predicted_m3_per_m"],
    )
    return in_display_units(table)


def check_fidelity(predictions: pd.DataFrame, fidelity: str, source: str) -> None:
    """Raise ValueError unless predictions were made at the fidelity of the runs that are to confirm them."""
    made = set(predictions["fidelity"])
    if made != {fidelity}:
        raise ValueError(
            f"{source}: predicted at fidelity {', '.join(sorted(made))}, the runs are at {fidelity};"
            " allowed is the same fidelity, given to both with --config fidelity=..."
        )


def confirmation_remarks(table: pd.DataFrame) -> list[str]:
    """Return what the figure must say: where a run has not the regime that its design was chosen for."""
    other = table[table["found_regime"] != table["setting"]]
    told = other[["row", "setting", "found_regime"]].to_numpy()
    return [f"the run {row} for {setting} flow is found {found}" for row, setting, found in told]


def interval_reach(table: pd.DataFrame) -> np.ndarray:
    """Return how far the interval reaches below and above the prediction, (2, rows), mm3 per m."""
    middle = table["predicted_mm3_per_m"]
    return np.stack([middle - table["run_low_mm3_per_m"], table["run_high_mm3_per_m"] - middle])
