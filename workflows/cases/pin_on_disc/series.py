"""Runs of the pin-on-disc study against each other, and against thesis and laboratory: mesh, size, comparison."""

from __future__ import annotations

import numpy as np
import pandas as pd

from postproc.tables.display import CUBIC_MILLIMETRES, MILLIMETRES
from postproc.tables.published import published_value
from workflows.cases.pin_on_disc.run_in import SIZES

EDGES_PER_WIDTH = 5.0  # -, meshes up to a fifth of the groove's width are to agree
STABLE_PERCENT = 5.0  # within which they are to agree
PERCENT = 100.0
COMPARED = ("depth", "width", "volume")
DESIGN = ("run", "series", "scheme", "wear_coefficient_per_pa", "element_size_mm")


def mesh_series(summary: pd.DataFrame, statistics: pd.DataFrame) -> pd.DataFrame:
    """Depth and widths (mm) of each mesh and scheme after the last revolution that all of them have.

    summary : DESIGN columns; runs of another series with the coefficient of the mesh series count too.
    statistics : as from `analysis.run_in.revolution_statistics`. Columns: scheme, element_size_mm, run, revolution,
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


def size_invariance(sizes: pd.DataFrame) -> pd.DataFrame:
    """Simulated over theoretical volume of Archard's law against the scale of the pin, its difference in percent.

    sizes : `run`, `particle_scale`, `archard_volume_m3` (alpha W), `alpha_F_L_volume_m3`, one row per run.
    """
    ratio = sizes["archard_volume_m3"] / sizes["alpha_F_L_volume_m3"]
    table = sizes[["run", "particle_scale"]].assign(
        simulated_volume_mm3=CUBIC_MILLIMETRES * sizes["archard_volume_m3"],
        theoretical_volume_mm3=CUBIC_MILLIMETRES * sizes["alpha_F_L_volume_m3"],
        ratio=ratio,
        difference_percent=PERCENT * (ratio - 1.0),
    )
    return table.sort_values("particle_scale", kind="stable").reset_index(drop=True)


def circular_segment(area: float, radius: float) -> tuple[float, float]:
    """Depth and width (m) of the shallow segment of a circle (m) with an area (m2): w^3 = 12 r A, d = w^2 / (8 r).

    The groove of a pin that leaves its own shape, to which every real one of that volume can be compared.
    """
    width = float(np.cbrt(12.0 * radius * area))
    return width**2 / (8.0 * radius), width


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
