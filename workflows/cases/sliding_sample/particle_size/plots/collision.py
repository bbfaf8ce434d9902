"""Collisions of particles at several scales, in units of their size: one curve for all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, new_figure

MARKS = "osD^v<>P"  # of particle scales
SHADES = {"cdt": "#0072B2", "epsd2": "#D55E00"}
NAMES = {"cdt": "type A (cdt)", "epsd2": "type C (epsd2)"}
MARKS_PER_CURVE = 8
NORMAL = {"overlap": "Overlap / R (-)", "normal_force": "Normal force / (E* R²) (-)"}
# Not the torque: where a sphere has stopped turning, type A turns it to and fro from step to step.
TANGENTIAL = {"tangential_force": "Tangential force\n/ (E* R²) (-)", "spin": r"Spin · $R\, /\, \sqrt{E^*/\rho}$ (-)"}
TITLES = {"pair": "two particles, head-on", "wall": "particle and wall, head-on"}


def collisions(histories: pd.DataFrame, closed: Mapping[str, pd.DataFrame], remarks: Sequence[str]) -> Figure:
    """Draw overlap and normal force of head-on collisions, and what rolling friction acts on in an oblique one.

    histories: as from `analysis.collision.read_collisions` with particle_scale and rolling_friction
    closed: {collision: closed form, as from `analysis.collision.dimensionless`}, drawn as lines. Everything
    without unit; where scales agree their marks lie on one curve.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(2, 3, sharex="col")
    first = histories["rolling_friction"].iloc[0]  # turns nothing in head-on collisions
    for column, kind in enumerate(TITLES):
        one = histories[(histories["collision"] == kind) & (histories["rolling_friction"] == first)]
        for axes, (name, label) in zip(grid[:, column], NORMAL.items(), strict=True):
            axes.plot(closed[kind]["time"], closed[kind][name], color="black", linewidth=1.0)
            _marks(axes, one, name, "#0072B2")
            axes.set_ylabel(label)
        grid[0, column].set_title(TITLES[kind], loc="left", fontsize=SMALLEST_FONT)
    oblique = histories[histories["collision"] == "oblique pair"]
    for axes, (name, label) in zip(grid[:, -1], TANGENTIAL.items(), strict=True):
        for model, one in oblique.groupby("rolling_friction", sort=False):
            _marks(axes, one, name, SHADES[model], joined=True)
        axes.set_ylabel(label)
    grid[0, -1].set_title("oblique, with spin", loc="left", fontsize=SMALLEST_FONT)
    for axes in grid[-1]:
        axes.set_xlabel(r"Time · $\sqrt{E^*/\rho}\, /\, R$ (-)")
    _legend(figure, histories)
    return figure


def _marks(axes: Axes, table: pd.DataFrame, name: str, shade: str, joined: bool = False) -> None:
    """Mark the curve of every scale at points of its own, so that marks on one curve do not hide each other."""
    scales = list(dict.fromkeys(table["particle_scale"]))
    for k, scale in enumerate(scales):
        one = table[table["particle_scale"] == scale]
        every = max(len(one) // MARKS_PER_CURVE, 1)
        drawn = {"color": shade, "markerfacecolor": "white", "markersize": 4, "label": f"scale {scale:g}"}
        drawn["markevery"] = (k * every // len(scales), every)
        drawn["linestyle"] = "-" if joined and k == 0 else "none"
        axes.plot(one["time"], one[name], marker=MARKS[k % len(MARKS)], linewidth=0.8, **drawn)


def _legend(figure: Figure, histories: pd.DataFrame) -> None:
    handles = [Line2D([], [], color="black", linewidth=1.0, label="Hertz with viscoelastic damping")]
    for k, scale in enumerate(dict.fromkeys(histories["particle_scale"])):
        drawn = {"marker": MARKS[k % len(MARKS)], "linestyle": "", "color": "#595959", "markerfacecolor": "white"}
        handles.append(Line2D([], [], label=f"scale {scale:g}", **drawn))
    for model in dict.fromkeys(histories["rolling_friction"]):
        handles.append(Line2D([], [], color=SHADES[model], label=NAMES[model]))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 4))
