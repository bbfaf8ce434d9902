"""Tables of the flow through machines: what comes in, is held and goes out, whether it is steady, particles counted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.steady_flow import POWER_PREFIX, steady_flow, steady_rest
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.cases.equipment.tables import KEPT, KG_PER_TONNE, SECONDS_PER_HOUR, Runs

COUNTED = (("in", "inserted"), ("out", "out"))  # column of the balance: its counter in flow.csv


def flow_table(runs: Runs) -> pd.DataFrame:
    """Return a row per run and phase in which the shape is kept: t/h in and out, held mass, residence time (held mass
    over what goes out), power, and whether the flow is steady, in a word and in a sentence. Intervals are of the run.

    The flow as built is judged with the start-up before it, of which the beginning is cut off.
    """
    rows = []
    for run in runs.values:
        of_run = runs.flow[runs.flow["run"] == run["run"]].dropna(axis="columns", how="all")  # powers of other designs
        for phase in KEPT:
            cycles = of_run.loc[of_run["phase"] == phase, "cycle"]
            if not cycles.empty:
                row = {name: run[name] for name in ("setting", "packing", "run")} | {"phase": phase}
                rows.append(row | _flow_of(of_run, int(cycles.min()), int(cycles.max()), run["block_s"]))
    return pd.DataFrame(rows)


def _flow_of(flow: pd.DataFrame, first: int, last: int, block_s: float) -> dict[str, Any]:
    """Return the flow of a run from cycle to cycle; its interval and verdict need some blocks, its means do not."""
    powers = [name for name in flow if name.startswith(POWER_PREFIX)]
    flow = flow.dropna(subset=powers)  # those of the first block are not printed
    window = flow[flow["cycle"].between(first, last)]
    window = pd.concat([flow[flow["cycle"] == first - 1].tail(1), window])
    ends, found = window.iloc[[0, -1]], steady_flow(window, block_s)
    as_built = window["phase"].iloc[-1] == PRISTINE
    judged = steady_rest(flow[flow["cycle"] <= last], block_s) if as_built else found
    seconds = float(np.diff(ends["time_s"])[0])
    row = {"start_s": float(ends["time_s"].iloc[0]), "duration_s": seconds}
    ways = (("in", "inserted", found.rate_in_kg_per_s), ("out", "out", found.rate_out_kg_per_s))
    for way, counted, rate in ways:
        mean = float(np.diff(ends[f"{counted}_mass_kg"])[0]) / seconds
        values = dict(zip((way, f"{way}_low", f"{way}_high"), (mean, *rate.interval()), strict=True))
        row |= {f"{name}_t_per_h": value * SECONDS_PER_HOUR / KG_PER_TONNE for name, value in values.items()}
    held, out = float(window["held_mass_kg"].mean()), row["out_t_per_h"] * KG_PER_TONNE / SECONDS_PER_HOUR
    power = float(window[powers].mean().sum()) if powers else np.nan
    row |= {"held_kg": held, "residence_s": held / out if out > 0.0 else np.nan, "power_W": power}
    return row | {"answer": judged.answer, "said": judged.said()}


def mass_balance(runs: Runs) -> pd.DataFrame:
    """Return a row per run and cycle: particles in, out and held, and how many are missing, 0 where none is lost.

    missing = held before + in - out - held at the end
    """
    rows = []
    for run, of_run in runs.flow.groupby("run", sort=False):
        before = {"particles": 0, "inserted_particles": 0, "out_particles": 0}
        for cycle, table in of_run.groupby("cycle"):
            last = table.iloc[-1]
            row = {"run": run, "cycle": int(cycle), "phase": last["phase"], "time_s": last["time_s"]}
            row |= {"held_before": int(before["particles"]), "held": int(last["particles"])}
            row |= {name: int(last[f"{key}_particles"] - before[f"{key}_particles"]) for name, key in COUNTED}
            row["missing"] = row["held_before"] + row["in"] - row["out"] - row["held"]
            rows.append(row | {"held_kg": last["held_mass_kg"]})
            before = last
    return pd.DataFrame(rows)
