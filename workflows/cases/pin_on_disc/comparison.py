"""Runs of pins on discs against each other, and against thesis and laboratory: meshes, depth, width and volume.

runs, published: as in runs.py; contours, volumes: of all runs, as from `runs.of_runs`; folder: of the study.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import read_surface
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.pin_on_disc.contours import section_table
from bulkwear.workflows.cases.pin_on_disc.run_in import SIZES
from bulkwear.workflows.cases.pin_on_disc.runs import (
    CALIBRATED,
    common_revolution,
    conditions_words,
    over_test,
    reference_runs,
)

EDGES_PER_WIDTH = 5.0  # -, meshes up to a fifth of the groove's width are to agree
STABLE_PERCENT = 5.0  # within which they are to agree
PERCENT = 100.0
COMPARED = ("depth", "width", "volume")
LABORATORY_ANGLES = (40, 160, 280)  # degrees; the thesis takes three at random
SAME_VOLUME = 0.02  # -, in which the law's volume of a run is the laboratory's


def mesh_series(summary: pd.DataFrame, statistics: pd.DataFrame) -> pd.DataFrame:
    """Depth and widths (mm) of each mesh and scheme after the last revolution that all of them have.

    summary : DESIGN columns; runs of another series with the coefficient of the mesh series count too.
    statistics : as from `run_in.revolution_statistics`. Columns: scheme, element_size_mm, run, revolution,
    size, mean_mm, deviation_mm; empty without a mesh series.
    """
    meshes = summary[summary["series"] == "mesh"]
    coefficients = meshes["wear_coefficient_per_pa"].unique()
    same = summary["series"].isin(("mesh", "coefficient")) & summary["wear_coefficient_per_pa"].isin(coefficients)
    chosen = statistics.merge(summary.loc[same, ["run", "scheme", "element_size_mm"]], on="run")
    last = chosen.groupby("run")["revolution"].max().min()
    chosen = chosen[chosen["revolution"] == last].assign(
        mean_mm=MILLIMETRES * chosen["mean_m"], deviation_mm=MILLIMETRES * chosen["deviation_m"]
    )
    columns = ["scheme", "element_size_mm", "run", "revolution", "size", "mean_mm", "deviation_mm"]
    return chosen[columns].sort_values(["scheme", "element_size_mm"], kind="stable").reset_index(drop=True)


def mesh_stability(series: pd.DataFrame) -> pd.DataFrame:
    """How far the meshes of edges up to a fifth of the groove's width agree, per scheme and size.

    series : as from `mesh_series`. The groove's width is the opening on the finest mesh of the scheme. Columns:
    scheme, size, groove_width_mm, largest_element_mm, meshes, difference_percent (largest over least, less 1),
    stable (within STABLE_PERCENT; False with fewer than two such meshes, for then nothing was compared).
    """
    rows = []
    for scheme, of_scheme in series.groupby("scheme", sort=False):
        opening = of_scheme[of_scheme["size"] == "opening width"]
        width = float(opening.loc[opening["element_size_mm"].idxmin(), "mean_mm"])
        fine = of_scheme[of_scheme["element_size_mm"] <= width / EDGES_PER_WIDTH]
        for size in SIZES:
            means = fine.loc[fine["size"] == size, "mean_mm"]
            difference = PERCENT * (means.max() / means.min() - 1.0) if len(means) > 1 else np.nan
            rows.append(
                {
                    "scheme": scheme,
                    "size": size,
                    "groove_width_mm": width,
                    "largest_element_mm": width / EDGES_PER_WIDTH,
                    "meshes": len(means),
                    "difference_percent": difference,
                    "stable": bool(difference <= STABLE_PERCENT),
                }
            )
    return pd.DataFrame(rows)


def compared_runs(runs: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Runs that are compared with thesis and laboratory: the reference runs, then those with the laboratory's volume.

    The law gives a run that volume if its coefficient times its load, track and revolutions is the laboratory's.
    """
    of_test, revolutions = (
        published_value(published, name, "laboratory") for name in ("wear_coefficient", "revolutions")
    )
    reach = runs["wear_coefficient_per_pa"] * runs["revolutions"] / (of_test * revolutions) * over_test(runs, published)
    same = (runs["series"] == "coefficient") & (np.abs(reach - 1.0) <= SAME_VOLUME)
    chosen = dict.fromkeys([*reference_runs(runs, published, CALIBRATED).values(), *runs.loc[same, "run"]])
    return runs.set_index("run", drop=False).loc[list(chosen)].reset_index(drop=True)


def case_name(run: pd.Series, revolution: int, published: pd.DataFrame) -> str:
    """What a compared run is called, with load and track where they are not the source's."""
    scheme = run["scheme"].replace("_", " ")
    own = conditions_words(run.to_frame().T.infer_objects(), published)
    name = f"{scheme}, {1e11 * run['wear_coefficient_per_pa']:.3g}e-11/Pa, {revolution} rev."
    return f"{name}, {own}" if own else name


def compared_cases(compared: pd.DataFrame, contours: pd.DataFrame, volumes: pd.DataFrame, published) -> pd.DataFrame:
    """Mean depth, mean opening (mm) and removed volume (mm3) of compared runs after the thesis' revolutions, or fewer.

    Last comes the groove of the pin's own shape with the laboratory's volume. Columns: case, run, depth_mm, width_mm,
    volume_mm3.
    """
    rows = []
    for _, run in compared.iterrows():
        of_run = contours[contours["run"] == run["run"]]
        last = common_revolution(of_run, int(published_value(published, "revolutions", "simulation")))
        sizes = MILLIMETRES * of_run[of_run["revolution"] == last][["depth_m", "opening_width_m"]].mean()
        at_end = (volumes["run"] == run["run"]) & (volumes["revolution"] == last)
        volume = CUBIC_MILLIMETRES * float(volumes.loc[at_end, "removed_volume_m3"].iloc[0])
        values = {"depth_mm": sizes["depth_m"], "width_mm": sizes["opening_width_m"], "volume_mm3": volume}
        rows.append({"case": case_name(run, last, published), "run": run["run"]} | values)
    depth, width = laboratory_segment(published)
    volume = published_value(published, "volume", "laboratory")
    rows.append({"case": "pin's shape", "run": "", "depth_mm": depth, "width_mm": width, "volume_mm3": volume})
    return pd.DataFrame(rows)


def comparison(published: pd.DataFrame, ours: pd.DataFrame) -> pd.DataFrame:
    """Depth, width (mm) and volume (mm3) of laboratory, thesis and our runs, with differences in percent.

    published : quantity, of, value; ours : `case`, `run` and `depth_mm`, `width_mm`, `volume_mm3`, one row per case.
    Columns: case, run, <quantity>, <quantity>_to_laboratory_percent, <quantity>_to_thesis_percent.
    """
    units = {"depth": "depth_mm", "width": "width_mm", "volume": "volume_mm3"}
    first = [
        {"case": case, "run": ""} | {units[name]: published_value(published, name, of) for name in COMPARED}
        for case, of in (("laboratory", "laboratory"), ("Yan 2022", "simulation"))
    ]
    table = pd.concat([pd.DataFrame(first), ours[["case", "run", *units.values()]]], ignore_index=True)
    for row, name in enumerate(("laboratory", "thesis")):
        for quantity, column in units.items():
            table[f"{quantity}_to_{name}_percent"] = PERCENT * (table[column] / table.loc[row, column] - 1.0)
    return table


def circular_segment(area: float, radius: float) -> tuple[float, float]:
    """Depth and width (m) of the shallow segment of a circle (m) with an area (m2): w^3 = 12 r A, d = w^2 / (8 r).

    The groove of a pin that leaves its own shape, to which every real one of that volume can be compared.
    """
    width = float(np.cbrt(12.0 * radius * area))
    return width**2 / (8.0 * radius), width


def laboratory_segment(published: pd.DataFrame) -> tuple[float, float]:
    """Depth and width (mm) of a groove of the pin's own shape that has the laboratory's volume all round the track."""
    circumference = 2.0 * np.pi * published_value(published, "track_radius", "laboratory")
    area = published_value(published, "volume", "laboratory") / circumference
    return circular_segment(area, published_value(published, "pin_radius", "laboratory"))


def laboratory_boxes(published: pd.DataFrame) -> pd.DataFrame:
    """Least and largest depth and width (mm) of the laboratory's contours."""
    parts = (("laboratory, least", "least_"), ("laboratory, largest", ""))
    return pd.DataFrame(
        [
            {"of": words}
            | {f"{size}_mm": published_value(published, f"{part}{size}", "laboratory") for size in ("depth", "width")}
            for words, part in parts
        ]
    )


def laboratory_sections(folder: str | Path, compared: pd.DataFrame, cases: pd.DataFrame) -> pd.DataFrame:
    """Sections of the worn discs of compared runs at three angles: `case` and as from `section_table`."""
    names = cases.set_index("run")["case"]
    return pd.concat(
        [
            section_table(
                read_surface(Path(folder) / run["run"] / "worn_surface.vtu"), run["track_radius_m"], LABORATORY_ANGLES
            ).assign(case=names[run["run"]])
            for _, run in compared.iterrows()
        ],
        ignore_index=True,
    )
