"""Runs of pins on discs: those of a design, those that stand for the source's, and the forces of their pins.

runs: the table that `pin_runs` reads; published: config/published/pin_on_disc.csv (`quantity`, `of`, `value`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, read_surface
from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.report.sentences import listed
from bulkwear.workflows.report.text import range_text

DESIGN = ("run", "series", "scheme", "wear_coefficient_per_pa", "element_size_mm", "load_n", "track_radius_mm")
SCHEMES = ("conserving", "per_triangle")  # in the order in which they are shown
REFERENCE = "reference_wear_coefficient"  # published, of the reference simulations: Yan 2022, Fig 5.7 to 5.14
CALIBRATED = "wear_coefficient"  # published, of the simulation with the laboratory's volume: Fig 5.17, 5.18, Table 5.4
SAME = 1e-6  # -, to which loads and tracks are the same
COEFFICIENT_TOLERANCE = 1e-6  # -, to which two wear coefficients are the same
FORCES = ("vertical_force_N", "normal_force_N")
WHOLE = 1e-6  # revolutions that a cycle may end beside a whole one
WINDOW_ROUNDING = 1e-6  # revolutions by which a window of forces may end behind a whole one


def pin_runs(design: str | Path) -> pd.DataFrame:
    """The runs of a design table, one row each, with `track_radius_m`.

    Raises ValueError that names the columns of DESIGN which are missing.
    """
    runs = pd.read_csv(design, dtype={"run": str, "row": str, "series": str, "scheme": str})
    missing = [name for name in DESIGN if name not in runs]
    if missing:
        raise ValueError(f"{design}: column {', '.join(missing)} is missing, allowed is a design of pins on discs")
    return runs.assign(track_radius_m=runs["track_radius_mm"] / MILLIMETRES)


def runs_and_published(files: SimpleNamespace) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The runs of a job's `design` and the values of its `published` table."""
    return pin_runs(files.design), pd.read_csv(files.published)


def of_runs(runs: pd.DataFrame, files: Sequence[str | Path]) -> pd.DataFrame:
    """One table of every run behind the other, each row with the columns of its run.

    runs : as from `pin_runs`; files : CSV of each run, in the same order.
    """
    tables = [pd.read_csv(file).assign(run=run) for run, file in zip(runs["run"], files, strict=True)]
    together = pd.concat(tables, ignore_index=True)
    return together.merge(runs[["run", *runs.columns.difference(together.columns)]], on="run")


def whole_revolutions(wear: pd.DataFrame) -> pd.DataFrame:
    """Rows of wear.csv (`cycle`, `revolution`) whose cycle ends with a whole revolution, which is an integer then."""
    number = wear["revolution"].round()
    return wear.assign(revolution=number.astype(int))[(wear["revolution"] - number).abs() <= WHOLE]


def common_revolution(table: pd.DataFrame, at_most: int) -> int:
    """Last revolution that all runs of a table have, not beyond `at_most`."""
    return int(min(table.groupby("run")["revolution"].max().min(), at_most))


def over_test(table: pd.DataFrame, published: pd.DataFrame) -> pd.Series:
    """Load times track of each row over those of the source, which its test and its simulations share (-).

    table : with `load_n` and `track_radius_m`. By Archard's law volumes at equal coefficient and revolutions are so.
    """
    load, track = source_conditions(published)
    return table["load_n"] * table["track_radius_m"] / (load * track)


def source_conditions(published: pd.DataFrame) -> tuple[float, float]:
    """Load (N) and radius of the track (m) of the source."""
    load, track = (published_value(published, name, "laboratory") for name in ("load", "track_radius"))
    return load, track / MILLIMETRES


def as_tested(table: pd.DataFrame, published: pd.DataFrame) -> np.ndarray:
    """Whether rows with `load_n` and `track_radius_m` have the load and the track of the source."""
    return np.isclose(table[["load_n", "track_radius_m"]], source_conditions(published), rtol=SAME, atol=0.0).all(
        axis=1
    )


def conditions_words(table: pd.DataFrame, published: pd.DataFrame) -> str:
    """Which load and track rows have instead of the source's; "" where all have these. table : as in `as_tested`."""
    load, track = source_conditions(published)
    lengths = MILLIMETRES * table["track_radius_m"]
    kinds = (("", table["load_n"], load, "N"), ("a track of ", lengths, MILLIMETRES * track, "mm"))
    return listed(
        [
            f"{words}{range_text(values.tolist(), 4)} {unit} instead of {theirs:g} {unit}"
            for words, values, theirs, unit in kinds
            if not np.isclose(values, theirs, rtol=SAME, atol=0.0).all()
        ]
    )


def reference_runs(runs: pd.DataFrame, published: pd.DataFrame, of: str) -> dict[str, str]:
    """The run of each scheme that stands for the thesis': its coefficient, or the nearest one; finest mesh.

    runs : as from `pin_runs`; published : with the coefficients of the simulations; of : which one, REFERENCE or
    CALIBRATED. Only of the series of coefficients.
    """
    wanted = published_value(published, of, "simulation")
    series = runs[runs["series"] == "coefficient"]
    far = np.abs(np.log(series["wear_coefficient_per_pa"] / wanted))
    ordered = series.assign(far=far.round(9)).sort_values(["far", "element_size_mm"], kind="stable")
    first = ordered.drop_duplicates("scheme").set_index("scheme")["run"]
    return {scheme: first[scheme] for scheme in SCHEMES if scheme in first}


def only_reference(table: pd.DataFrame, runs: pd.DataFrame, published: pd.DataFrame, of: str) -> pd.DataFrame:
    """Rows of the runs that stand for the thesis', the conserving one first; of : as in `reference_runs`."""
    chosen = reference_runs(runs, published, of)
    return pd.concat([table[table["run"] == run] for run in chosen.values()], ignore_index=True)


def reference_discs(
    folder: str | Path, runs: pd.DataFrame, published: pd.DataFrame
) -> tuple[dict[str, SurfaceMesh], float]:
    """Worn discs of the runs that stand for the thesis' Fig 5.17, by scheme, and the radius (m) of their track."""
    chosen = reference_runs(runs, published, CALIBRATED)
    meshes = {scheme: read_surface(Path(folder) / run / "worn_surface.vtu") for scheme, run in chosen.items()}
    track = runs.loc[runs["run"].isin(chosen.values()), "track_radius_m"]
    return meshes, float(track.iloc[0])


def same_coefficient(table: pd.DataFrame, coefficient: float) -> pd.DataFrame:
    """Rows of one wear coefficient (1/Pa)."""
    far = np.abs(table["wear_coefficient_per_pa"] / coefficient - 1.0)
    return table[far <= COEFFICIENT_TOLERANCE]


def coefficient_remark(shown: pd.DataFrame, published: pd.DataFrame, of: str) -> str:
    """The wear coefficient of the runs of a figure in words, and the published one where theirs is another.

    shown : rows of `pin_runs`; published, of : as in `reference_runs`.
    """
    wanted = published_value(published, of, "simulation")
    source = published.loc[(published["quantity"] == of) & (published["of"] == "simulation"), "source"].iloc[0]
    theirs = {}
    for scheme, rows in shown.groupby("scheme"):
        others = rows[~rows.index.isin(same_coefficient(rows, wanted).index)]
        values = ", ".join(f"{value:.3g}" for value in rows["wear_coefficient_per_pa"].drop_duplicates())
        instead = f" instead of the published {wanted:.3g} ({source})" if len(others) else ""
        theirs[scheme.replace("_", " ")] = f"{values} 1/Pa{instead}"
    if len(set(theirs.values())) == 1:
        return f"wear coefficient {next(iter(theirs.values()))}"
    return "wear coefficient, " + ", ".join(f"{scheme}: {words}" for scheme, words in theirs.items())


def reference_remark(runs: pd.DataFrame, published: pd.DataFrame, of: str) -> str:
    """As `coefficient_remark`, of the runs that stand for the thesis'."""
    chosen = reference_runs(runs, published, of)
    return coefficient_remark(runs[runs["run"].isin(chosen.values())], published, of)


def window_forces(folder: str | Path) -> pd.DataFrame:
    """Forces of a pin (N, means of windows of a fraction of a degree) with the `revolution` that they fall in.

    folder : of the run, with cycle_<nnn>/forces.csv. Columns: revolution, vertical_force_N, normal_force_N (the sum of
    those of all contacts). Raises FileNotFoundError when there is none.
    """
    files = cycle_files(folder, "forces.csv")
    if not files:
        raise FileNotFoundError(f"{folder}: no cycle_*/forces.csv found, at least one wear cycle must have been run.")
    forces = pd.concat([pd.read_csv(file) for file in files], ignore_index=True)
    revolution = np.ceil(forces["angle_deg"] / 360.0 - WINDOW_ROUNDING).clip(lower=1.0).astype(int)
    return pd.DataFrame(
        {
            "revolution": revolution,
            "vertical_force_N": forces["force_z_N"].abs(),
            "normal_force_N": forces["normal_force_N"],
        }
    )


def force_boxes(forces: pd.DataFrame) -> pd.DataFrame:
    """Mean, extremes, quartiles and share of outliers (%) of both forces per run and revolution.

    forces : `run` and as from `window_forces`. Outliers lie more than 1.5 times the box beyond it.
    """
    rows = []
    for (run, revolution), windows in forces.groupby(["run", "revolution"], sort=False):
        for name in FORCES:
            force = windows[name]
            low, middle, high = force.quantile([0.25, 0.5, 0.75])
            beyond = np.maximum(low - force, force - high) > 1.5 * (high - low)
            rows.append(
                {"run": run, "revolution": revolution, "force": name.removesuffix("_N"), "mean_N": force.mean()}
                | {"least_N": force.min(), "quarter_N": low, "median_N": middle, "three_quarters_N": high}
                | {"largest_N": force.max(), "outliers_percent": 100.0 * beyond.mean()}
            )
    return pd.DataFrame(rows)
