"""Contacts of particles by scale: packings of containers and of beds ahead of a sample and behind it, and single
collisions in units of their size, one curve for all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, OTHER_COLOUR, SMALLEST_FONT, new_figure
from bulkwear.postproc.statistics.intervals import estimates, interval_table

STATES = {"loose": "loose", "dense": "shaken", "difference": "shaken minus loose"}
QUANTITIES = {"coordination_number": "Contacts of a particle (-)", "porosity": "Porosity (-)"}
WHOLE = "porosity_whole_particles"
BED_STATES = {"before": ("#0072B2", "o"), "after": ("#D55E00", "s")}
BED_NAMES = {"before": "ahead of the sample", "after": "behind it"}
PUBLISHED_MARKS = {"about": "D", "above": "^", "below": "v"}
RANGE_COLOUR = "#e5e5e5"
MARKERS = "osD^v<>P"  # of particle scales
MODEL_SHADES = {"cdt": "#0072B2", "epsd2": "#D55E00", "own_spin": "#009E73", "rvd": "#CC79A7"}
MODEL_NAMES = {"cdt": "type A (cdt)", "epsd2": "type C (epsd2)", "own_spin": "own_spin", "rvd": "rvd"}
MARKS_PER_CURVE = 8  # of a collision
ASIDE = 0.15  # particle scales, that marks of two kinds stand to the left and to the right of theirs
PACKING_SIZE, MEAN_SIZE = 2.5, 6.0  # points, of marks: of a packing among several, of their mean
NORMAL = {"overlap": "Overlap / R (-)", "normal_force": "Normal force / (E* R²) (-)"}
# Not the torque: where a sphere has stopped turning, type A turns it to and fro from step to step.
TANGENTIAL = {
    "tangential_force": "Tangential force\n/ (E* R²) (-)",
    "spin": "Spin\n· $R\\, /\\, \\sqrt{E^*/\\rho}$ (-)",
}
COLLISION_TITLES = {"pair": "two particles, head-on", "wall": "particle and wall, head-on"}


def scale_colours(scales: Sequence[float]) -> dict[float, tuple]:
    """Return a colour for every particle scale, from dark (small) to light; also told apart by their markers."""
    shades = mpl.colormaps["viridis"]
    return {scale: shades(0.85 * k / max(len(scales) - 1, 1)) for k, scale in enumerate(sorted(scales))}


def packings_by_scale(
    axes: Axes,
    table: pd.DataFrame,
    quantity: str,
    look: tuple[str, str],
    name: str,
    hollow: pd.Series | None = None,
    aside: float = 0.0,
) -> None:
    """Draw a quantity of every packing against particle scale, and where there are several the mean of each scale with
    its 95 % interval.

    table: particle_scale and the quantity, a line per packing; look: colour and marker
    hollow: whether the mark of a packing is; that of a mean is, where that of any of its packings is
    aside: particle scales, that marks stand to the right of theirs
    """
    shade, mark = look
    hollow = pd.Series(False, index=table.index) if hollow is None else hollow
    repeated = table["particle_scale"].duplicated().any()
    drawn = {"color": shade, "markersize": PACKING_SIZE if repeated else MEAN_SIZE, "label": name, "zorder": 4}
    for empty, one in table.groupby(hollow):
        face = "white" if empty else shade
        axes.plot(one["particle_scale"] + aside, one[quantity], mark, markerfacecolor=face, **drawn)
    if not repeated:
        return
    means = interval_table(estimates(table["particle_scale"], table[quantity]))
    empty = hollow.groupby(table["particle_scale"]).any()
    drawn = {"fmt": mark, "color": shade, "markersize": MEAN_SIZE, "capsize": 3, "linewidth": 1.0, "zorder": 3}
    for each in means.itertuples():
        reach = [[each.mean - each.interval_low], [each.interval_high - each.mean]]
        face = "white" if empty[each.setting] else shade
        axes.errorbar(each.setting + aside, each.mean, reach, markerfacecolor=face, label=f"{name} mean", **drawn)


def packing_profiles(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw coordination number and porosity against height (mm): loose, shaken, and their difference, by scale.

    table: as from `flow.packing.loose_and_dense`, with particle_scale and height_mm
    published: state, quantity, relation (above, below), value and source, drawn as grey ranges
    """
    scales = sorted(set(table["particle_scale"]))
    colours = scale_colours(scales)
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(len(QUANTITIES), len(STATES), sharey=True)
    for row, (quantity, label) in zip(grid, QUANTITIES.items(), strict=True):
        for axes, (state, name) in zip(row, STATES.items(), strict=True):
            shown = published[(published["state"] == state) & (published["quantity"] == quantity)]
            _range(axes, shown)
            for k, scale in enumerate(scales):
                one = table[(table["state"] == state) & (table["particle_scale"] == scale)]
                drawn = {"color": colours[scale], "marker": MARKERS[k % len(MARKERS)], "markersize": 4}
                axes.plot(one[quantity], one["height_mm"], linewidth=1.0, label=f"scale {scale:g}", **drawn)
                if quantity == "porosity":
                    axes.plot(one[WHOLE], one["height_mm"], ":", color=colours[scale], linewidth=0.8, label="_whole")
            axes.set_xlabel(label)
            axes.set_title(name, loc="left", fontsize=SMALLEST_FONT, pad=2)
        row[0].set_ylabel("Height (mm)")
        row[0].set_ylim(bottom=0.0)
    handles = grid[0, 0].get_legend_handles_labels()[0]
    handles.append(Line2D([], [], color="black", linestyle=":", label="particles whole"))
    if not published.empty:
        source = published["source"].iloc[0].partition(",")[0]
        handles.append(Line2D([], [], color=RANGE_COLOUR, linewidth=8, label=source))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 6))
    return figure


def _range(axes: Axes, published: pd.DataFrame) -> None:
    """Shade what is published: the range between its bounds, if it has both."""
    bounds = published.set_index("relation")["value"]
    if {"above", "below"} <= set(bounds.index):
        axes.axvspan(bounds["above"], bounds["below"], color=RANGE_COLOUR, zorder=0)


def bed_packing(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw coordination number and porosity of a bed against particle scale, ahead of a sample and behind it: packings,
    and where there are several their means with intervals.

    table: particle_scale, state (before, after), coordination_number, porosity and porosity_whole_particles
    published: state, scale_from, scale_to, quantity, relation, value and source; drawn as bounds with a direction
    """
    figure = new_figure(remarks)
    panels = figure.subplots(1, len(QUANTITIES))
    for axes, (quantity, label) in zip(panels, QUANTITIES.items(), strict=True):
        for (state, (shade, marker)), aside in zip(BED_STATES.items(), (-ASIDE, ASIDE), strict=True):
            one = table[table["state"] == state]
            packings_by_scale(axes, one, quantity, (shade, marker), BED_NAMES[state], aside=aside)
            if quantity == "porosity":
                means = one.groupby("particle_scale")[WHOLE].mean()
                axes.plot(means.index, means, ":", color=shade, label="_whole")
        for _, bound in published[published["quantity"] == quantity].iterrows():
            shade = BED_STATES[bound["state"]][0]
            drawn = {
                "marker": PUBLISHED_MARKS[bound["relation"]],
                "linestyle": "-",
                "markerfacecolor": "white",
                "label": "_bound",
            }
            ends = [bound["scale_from"], bound["scale_to"]]
            axes.plot(ends, [bound["value"]] * 2, color=shade, linewidth=0.8, markersize=7, **drawn)
        axes.set(xlabel="Particle scale (-)", ylabel=label)
    looks = [(BED_NAMES[state], look) for state, look in BED_STATES.items() if state in set(table["state"])]
    handles = [Line2D([], [], color=shade, marker=mark, linestyle="", label=name) for name, (shade, mark) in looks]
    handles.append(Line2D([], [], color="black", linestyle=":", label="particles whole"))
    if not published.empty:
        source = published["source"].iloc[0].partition(",")[0]
        for relation in dict.fromkeys(published["relation"]):
            drawn = {
                "marker": PUBLISHED_MARKS[relation],
                "markerfacecolor": "white",
                "color": OTHER_COLOUR,
                "linewidth": 0.8,
            }
            handles.append(Line2D([], [], label=f"{source}: {relation}", **drawn))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 5))
    return figure


# ---------------------------------------------------------------- single collisions


def collisions(histories: pd.DataFrame, closed: Mapping[str, pd.DataFrame], remarks: Sequence[str]) -> Figure:
    """Draw overlap and normal force of head-on collisions, and what rolling friction acts on in an oblique one.

    histories: as from `collision.read_collisions` with particle_scale and rolling_friction
    closed: {collision: closed form, as from `collision.dimensionless`}, drawn as lines. Everything
    without unit; where scales agree their marks lie on one curve.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(2, 3, sharex="col")
    first = histories["rolling_friction"].iloc[0]  # turns nothing in head-on collisions
    for column, kind in enumerate(COLLISION_TITLES):
        one = histories[(histories["collision"] == kind) & (histories["rolling_friction"] == first)]
        for axes, (name, label) in zip(grid[:, column], NORMAL.items(), strict=True):
            axes.plot(closed[kind]["time"], closed[kind][name], color="black", linewidth=1.0)
            _marks(axes, one, name, "#0072B2")
            axes.set_ylabel(label)
        grid[0, column].set_title(COLLISION_TITLES[kind], loc="left", fontsize=SMALLEST_FONT)
    oblique = histories[histories["collision"] == "oblique pair"]
    for axes, (name, label) in zip(grid[:, -1], TANGENTIAL.items(), strict=True):
        for model, one in oblique.groupby("rolling_friction", sort=False):
            _marks(axes, one, name, MODEL_SHADES[model], joined=True)
        axes.set_ylabel(label)
    grid[0, -1].set_title("oblique, with spin", loc="left", fontsize=SMALLEST_FONT)
    for axes in grid[-1]:
        axes.set_xlabel(r"Time · $\sqrt{E^*/\rho}\, /\, R$ (-)")
    _collision_legend(figure, histories)
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
        axes.plot(one["time"], one[name], marker=MARKERS[k % len(MARKERS)], linewidth=0.8, **drawn)


def _collision_legend(figure: Figure, histories: pd.DataFrame) -> None:
    handles = [Line2D([], [], color="black", linewidth=1.0, label="Hertz with viscoelastic damping")]
    for k, scale in enumerate(dict.fromkeys(histories["particle_scale"])):
        drawn = {"marker": MARKERS[k % len(MARKERS)], "linestyle": "", "color": "#595959", "markerfacecolor": "white"}
        handles.append(Line2D([], [], label=f"scale {scale:g}", **drawn))
    for model in dict.fromkeys(histories["rolling_friction"]):
        handles.append(Line2D([], [], color=MODEL_SHADES[model], label=MODEL_NAMES[model]))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 4))
