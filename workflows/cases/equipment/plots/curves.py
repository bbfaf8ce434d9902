"""Curves and bars: the flow over time, lives of parts, depth of the deciding place against hours of operation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator

from bulkwear.postproc.plots.style import (
    BLUE,
    LARGEST_HEIGHT,
    ORANGE,
    SERIES_COLOURS,
    SMALLEST_FONT,
    facets,
    label_all,
    new_figure,
)
from bulkwear.postproc.tables.display import few_digits
from bulkwear.workflows.cases.equipment.life_findings import TOO_WIDE
from bulkwear.workflows.report.text import range_text

PHASES = {  # phase: what it is called, and its shade
    "start_up": ("start-up", "#d9d9d9"),
    "pristine": ("as built", "white"),
    "wearing": ("wear is carried on", "#fde7cf"),
    "worn": ("worn shape", "#dcebf5"),
}
MOST_SETTINGS = 3  # side by side over time
WIDE_RANGE = 30.0  # -, longest over shortest life from which their axis is logarithmic
PAST_THE_END = 1.08  # -, over the longest end: there an interval without one stops
FAR_OFF = 8.0  # -, over the deepest place shown: a depth beyond is named in a panel's title, not drawn
SLIGHTLY = 1.2  # -, over the last hour drawn: a life up to there is drawn too
BAR_HEIGHT = 0.8  # -, of the room of a part
BAR_SHARE, BAR_SHARE_MT = 0.56, 0.46  # -, of the axis of lives, up to the end of the longest: words stand behind it
WORDS_INCHES = 0.17  # height of a bar from which numbers stand behind it
BARS_SHARE = 0.7  # -, of the height of a figure that its bars have
BAR_INCHES = 0.32  # height of a bar and its share of gaps


def setting_colour(settings: Sequence[str], setting: str) -> str:
    """Return the colour of a setting in all figures of curves."""
    return SERIES_COLOURS[list(settings).index(setting) % len(SERIES_COLOURS)]


# ---------------------------------------------------------------- flow


def flow_over_time(series: pd.DataFrame, phases: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw mass in and out (t/h), mass held (kg) and the power of moving parts (kW) over simulated time (s).

    series: run, setting, packing, time_s, in_t_per_h, out_t_per_h, held_kg, and power_<part>_kW of parts that move
    phases: of the first packing of each setting: setting, phase, start_s, end_s
    """
    settings = list(dict.fromkeys(series["setting"]))[:MOST_SETTINGS]
    powers = [name for name in series if name.startswith("power_")]
    fed = bool(series[["in_t_per_h", "out_t_per_h"]].abs().to_numpy().max(initial=0.0) > 0.0)
    lines = ["flow"] * fed + ["held"] + ["power"] * bool(powers)
    figure = new_figure(remarks, LARGEST_HEIGHT if len(lines) > 1 else 3.2)
    grid = figure.subplots(len(lines), len(settings), sharex="col", sharey="row", squeeze=False)
    handles = {}
    for column, setting in enumerate(settings):
        of_setting = series[series["setting"] == setting]
        for kind, axes in zip(lines, grid[:, column], strict=True):
            _shade(axes, phases[phases["setting"] == setting])
            handles |= _LINES[kind](axes, of_setting)
        if len(settings) > 1:
            grid[0, column].set_title(setting, loc="left", fontsize=SMALLEST_FONT)
        grid[-1, column].set_xlabel("Simulated time (s)")
    for kind, axes in zip(lines, grid[:, 0], strict=True):
        _from_zero(axes, series[_COLUMNS[kind] or powers])
        axes.set_ylabel({"flow": "Mass flow (t/h)", "held": "Held (kg)", "power": "Power (kW)"}[kind])
    shades = [
        Patch(facecolor=colour, edgecolor="#999999", linewidth=0.5, label=name) for name, colour in _there(phases)
    ]
    figure.legend(handles=[*handles.values(), *shades], loc="outside upper center", ncols=5)
    return figure


_COLUMNS = {"flow": ["in_t_per_h", "out_t_per_h"], "held": ["held_kg"], "power": []}


def _from_zero(axes: Axes, values: pd.DataFrame) -> None:
    """Let an axis that panels share begin at 0, or below where values do."""
    low, high = min(float(values.min().min()), 0.0), max(float(values.max().max()), 0.0)
    room = 0.06 * (high - low) or 1.0
    axes.set_ylim(low - room * (low < 0.0), high + room)


def _there(phases: pd.DataFrame) -> list[tuple[str, str]]:
    return [PHASES[phase] for phase in PHASES if phase in set(phases["phase"])]


def _shade(axes: Axes, phases: pd.DataFrame) -> None:
    """Shade the time of each phase; time ends with the last one."""
    for phase in phases.itertuples():
        axes.axvspan(phase.start_s, phase.end_s, facecolor=PHASES[phase.phase][1], linewidth=0.0, zorder=0)
    axes.set_xlim(0.0, phases["end_s"].max())
    axes.grid(axis="x", visible=False)


def _curves(axes: Axes, rows: pd.DataFrame, column: str, colour: str, label: str, style: str = "-") -> Line2D:
    """Draw a column over time: the first packing thick, others thin; return what a legend needs."""
    first = rows["packing"].min()
    for packing, of_packing in rows.groupby("packing"):
        width, opacity = (1.2, 1.0) if packing == first else (0.6, 0.45)
        look = {"color": colour, "linewidth": width, "alpha": opacity, "linestyle": style}
        axes.plot(of_packing["time_s"], of_packing[column], zorder=3 if packing == first else 2, **look)
    return Line2D([], [], color=colour, linewidth=1.2, linestyle=style, label=label)


def _flow_lines(axes: Axes, rows: pd.DataFrame) -> dict[str, Line2D]:
    put = {"in": _curves(axes, rows, "in_t_per_h", "black", "in")}
    return put | {"out": _curves(axes, rows, "out_t_per_h", BLUE, "out")}


def _held_line(axes: Axes, rows: pd.DataFrame) -> dict[str, Line2D]:
    return {"held": _curves(axes, rows, "held_kg", "#009E73", "held")}


def _power_lines(axes: Axes, rows: pd.DataFrame) -> dict[str, Line2D]:
    found = {}
    for name, style in zip(
        [name for name in rows if name.startswith("power_")], ("-", "--", ":", "-.") * 9, strict=False
    ):
        part = name.removeprefix("power_").removesuffix("_kW").replace("_", " ")
        found[name] = _curves(axes, rows, name, ORANGE, f"power of {part}", style)
    return found


_LINES = {"flow": _flow_lines, "held": _held_line, "power": _power_lines}


# ---------------------------------------------------------------- lives


def life_bars(lives: pd.DataFrame, hours_per_mt: Mapping[str, float], remarks: Sequence[str]) -> Figure:
    """Draw the life (h) of each part and setting with its 95 % interval, Mt on the upper axis.

    lives: setting, part, life_h, life_low_h, life_high_h (infinite or NaN where there is no end), packings, rule; an
        interval that tells nothing is not drawn
    hours_per_mt: {setting: hours}; where settings differ, or without an inlet, there is no upper axis, and bars say Mt
    """
    parts, settings = (list(dict.fromkeys(lives[name])) for name in ("part", "setting"))
    untold = (lives["life_high_h"] > TOO_WIDE * lives["life_low_h"]) & np.isfinite(lives["life_high_h"])
    if untold.any():
        lives = lives.assign(**{name: lives[name].mask(untold) for name in ("life_low_h", "life_high_h")})
        remarks = [*remarks, f"no interval: packings do not tell the life within a factor of {TOO_WIDE:g}"]
    figure = new_figure(remarks, min(1.3 + BAR_INCHES * len(lives) + 0.16 * len(remarks), LARGEST_HEIGHT))
    axes = figure.subplots()
    factors = {hours_per_mt.get(setting, np.nan) for setting in settings}
    shared = len(factors) == 1 and np.isfinite(next(iter(factors)))
    known = lives["life_h"][np.isfinite(lives["life_h"])]
    ends = lives[["life_h", "life_high_h"]].to_numpy(float)
    longest = float(np.max(ends[np.isfinite(ends)], initial=1.0))
    wide = len(known) > 0 and known.max() > WIDE_RANGE * known.min()
    left = 0.5 * float(known.min()) if wide else 0.0
    axes.set_ylim(len(parts) - 0.5, -0.5)
    for row in lives.itertuples():
        count = len(settings)
        place = parts.index(row.part) + BAR_HEIGHT * ((settings.index(row.setting) + 0.5) / count - 0.5)
        per_mt = np.nan if shared else hours_per_mt.get(row.setting, np.nan)
        colour = setting_colour(settings, row.setting)
        _life_bar(axes, row, place, BAR_HEIGHT / count, (left, longest), colour, per_mt)
    axes.set_yticks(range(len(parts)), [_with_rule(lives, part) for part in parts])
    axes.grid(axis="y", visible=False)
    axes.set_xscale("log" if wide else "linear")
    longest *= PAST_THE_END if (np.isfinite(lives["life_low_h"]) & ~np.isfinite(lives["life_high_h"])).any() else 1.0
    share = BAR_SHARE if shared or not hours_per_mt else BAR_SHARE_MT
    room = left * (longest / left) ** (1.0 / share) if wide else longest / share
    axes.set(xlim=(left, room), xlabel="Life (h of operation)")
    if not wide:
        axes.xaxis.set_major_locator(MaxNLocator(6, prune="upper"))  # a label at the end would be cut off
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.6g}"))
    if shared:
        factor = next(iter(factors))
        other = axes.secondary_xaxis("top", functions=(lambda hours: hours / factor, lambda mass: mass * factor))
        other.set_xlabel("Life (Mt)")
        if not wide:
            other.xaxis.set_major_locator(MaxNLocator(6, prune="upper"))
    if len(settings) > 1:
        handles = [Patch(color=setting_colour(settings, setting), label=setting) for setting in settings]
        figure.legend(handles=handles, loc="outside upper center", ncols=min(len(settings), 4))
    return figure


def _with_rule(lives: pd.DataFrame, part: str) -> str:
    """Return a part's name with its change-out rule below."""
    rules = dict.fromkeys(lives.loc[lives["part"] == part, "rule"].dropna())
    return "\n".join([part.replace("_", " "), *rules])


def _life_bar(
    axes: Axes, row: tuple, place: float, height: float, ends: tuple[float, float], colour: str, per_mt: float
) -> None:
    """Draw a life with its interval and its numbers, these where bars are wide enough for letters.

    ends: h, of the axis and of the longest life
    """
    left, longest = ends
    part_inches = axes.figure.get_figheight() * BARS_SHARE / (axes.get_ylim()[0] - axes.get_ylim()[1])
    if not np.isfinite(row.life_h):
        reason = getattr(row, "reason", "")
        said = reason if isinstance(reason, str) and reason else "no life is known"
        axes.text(left, place, f"  {said}", va="center", fontsize=SMALLEST_FONT, color=colour)
        return
    axes.barh(place, row.life_h - left, 0.86 * height, left=left, color=colour, alpha=0.75, linewidth=0.0)
    end = row.life_h
    if np.isfinite(row.life_low_h):
        high = row.life_high_h if np.isfinite(row.life_high_h) else PAST_THE_END * longest
        axes.plot([row.life_low_h, high], [place, place], color="black", linewidth=1.1, solid_capstyle="butt")
        for value in filter(np.isfinite, (row.life_low_h, row.life_high_h)):
            axes.plot([value] * 2, [place - 0.2 * height, place + 0.2 * height], color="black", linewidth=1.1)
        if not np.isfinite(row.life_high_h):
            axes.plot(high, place, ">", color="black", markersize=4.5)
        end = max(end, high)
    if height * part_inches < WORDS_INCHES:
        return
    place_of = {"xytext": (5.0, 0.0), "textcoords": "offset points", "va": "center", "fontsize": SMALLEST_FONT}
    axes.annotate(life_words(row, per_mt), (end, place), **place_of)


def life_words(row: tuple, hours_per_mt: float = np.nan) -> str:
    """Return a life with its interval in words; row: life_h, life_low_h, life_high_h, packings; the mass where
    hours_per_mt is known.
    """
    words = f"{few_digits(row.life_h)} h"
    if np.isfinite(row.life_low_h):
        high = few_digits(row.life_high_h) if np.isfinite(row.life_high_h) else "no end"
        words += f" ({few_digits(row.life_low_h)} to {high}{', one packing' if row.packings == 1 else ''})"
    return words + (f", {few_digits(row.life_h / hours_per_mt)} Mt" if np.isfinite(hours_per_mt) else "")


# ---------------------------------------------------------------- depth against hours


def recession_against_time(depths: pd.DataFrame, lives: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the depth (mm) of the deciding patch of each part against hours of operation, one panel per part.

    depths: setting, part, packing (0: the mean over packings), operation_h, depth_mm, simulated (False: extrapolated)
    lives: setting, part, allowed_mm, life_h
    """
    parts, settings = (list(dict.fromkeys(depths[name])) for name in ("part", "setting"))
    figure = new_figure(remarks, 3.8 if len(parts) <= 3 else LARGEST_HEIGHT)
    last = max(float(depths["operation_h"].max()), 1.0)
    last = max(last, *lives.loc[lives["life_h"] <= SLIGHTLY * last, "life_h"], last)
    for part, axes in facets(figure, parts).items():
        far = FAR_OFF * depths.loc[depths["part"] == part, "depth_mm"].max()
        for setting in settings:
            rows = depths[(depths["part"] == part) & (depths["setting"] == setting)]
            _depth_lines(axes, rows, setting_colour(settings, setting))
            own = lives[(lives["part"] == part) & (lives["setting"] == setting)]
            for row in own[own["allowed_mm"] <= far].itertuples():
                _change_out(axes, row, setting_colour(settings, setting), last)
        limits = lives.loc[(lives["part"] == part) & (lives["allowed_mm"] > far), "allowed_mm"]
        named = [part.replace("_", " ")] if len(parts) > 1 else []
        named += [f"changed at {range_text(limits.tolist(), 3)} mm"] if len(limits) else []
        axes.set_title(", ".join(named), loc="left", fontsize=SMALLEST_FONT)
        axes.set_ylim(bottom=0.0)
        axes.set_xlim(0.0, 1.03 * last)
        axes.xaxis.set_major_locator(MaxNLocator(5, prune="upper"))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.6g}"))
    label_all(figure, len(parts) > 1, "Operation (h)", "Depth of the deciding patch (mm)")
    handles = [Line2D([], [], color=setting_colour(settings, each), linewidth=1.8, label=each) for each in settings]
    styles = {
        "mean of packings": ("-", 1.8),
        "a packing": ("-", 0.6),
        "extrapolated": ("--", 1.2),
        "change-out": (":", 1.2),
    }
    if depths["packing"].max() < 2:
        styles = {"simulated": ("-", 1.8)} | {name: styles[name] for name in ("extrapolated", "change-out")}
    grey = [Line2D([], [], color="black", linestyle=s, linewidth=w, label=name) for name, (s, w) in styles.items()]
    figure.legend(handles=[*(handles if len(settings) > 1 else []), *grey], loc="outside upper center", ncols=5)
    return figure


def _depth_lines(axes: Axes, rows: pd.DataFrame, colour: str) -> None:
    """Draw the packings thin, their mean thick, and what follows beyond the simulated hours dashed."""
    for packing, of_packing in rows.groupby("packing"):
        mean = packing == 0
        for simulated, part in of_packing.groupby("simulated"):
            if not simulated and not mean:
                continue
            look = {"linewidth": 1.8 if mean else 0.6, "alpha": 1.0 if mean else 0.6, "color": colour}
            look |= {} if simulated else {"linestyle": "--", "linewidth": 1.2}
            axes.plot(part["operation_h"], part["depth_mm"], **look)
        if mean:
            marked = of_packing[of_packing["simulated"]]
            axes.plot(marked["operation_h"], marked["depth_mm"], "o", color=colour, markersize=3.0)


def _change_out(axes: Axes, row: tuple, colour: str, last: float) -> None:
    """Draw the depth at which a part is changed, and the hour at which it is reached, unless after the last one."""
    if np.isfinite(row.allowed_mm):
        axes.axhline(row.allowed_mm, color=colour, linestyle=":", linewidth=1.2)
        if row.life_h <= last:
            axes.plot(row.life_h, row.allowed_mm, "D", color=colour, markersize=5.0, clip_on=False)
