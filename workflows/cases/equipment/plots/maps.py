"""Maps on the parts that wear: recession, remaining thickness, pressure, sliding and impact, designs side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib import colormaps
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap, ListedColormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from bulkwear.postproc.mesh import SurfaceMesh, areas, centroids, unit_normals
from bulkwear.postproc.plots.style import LARGEST_HEIGHT, MAP, REMARK_LINE, SMALLEST_FONT, WIDTH, new_figure, scaled
from bulkwear.postproc.tables.depths import area_quantile
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.equipment.pictures import RECESSION, REMAINING, PartMap
from bulkwear.workflows.cases.equipment.plots.panels import Box, Picture, picture_grid
from bulkwear.workflows.cases.equipment.plots.scales import colour_bar, on_scale, scale_of, second_scale, top_of
from bulkwear.workflows.cases.equipment.plots.views import (
    NO_VALUE,
    View,
    best_oblique,
    best_views,
    mean_normal,
    part_picture,
    view_of,
)

BAR_ROOM, SMALL_BAR_ROOM = 1.4, 0.85  # inches, for a colour bar with its labels
BAR_LEFT, SMALL_BAR_LEFT, BAR_WIDE = 0.84, 0.76, 0.12  # inches: from the right to the bar, and its width
MARGIN, BESIDE = 0.08, 0.15  # inches, round all pictures, and beside that of the machine
FACING = 0.5  # -, cosine of a face to the eye from which its thickness counts for the scale
MOST_OF_WEAR = 0.75  # -, of what a part has lost: where this is lost sets the scale of what is left
FINE_COLOURS = 1024  # of a scale with a step in it
MACHINE_SHARE, MACHINE_WIDTHS = 0.6, (1.0, 1.9)  # -, of the height; inches: the picture of the whole machine
WHOLE_SCALE = (0.0, 1.0)  # of values that are shares of a scale
SAME_DIGITS = 9  # of factors that count as the same
WINDOW_DEG = 60.0  # of the circumference of a part that closes round its axis, which is shown unrolled
DUE_COLOUR = "#d62728"  # where a part is due for change
QUANTITIES = {  # column of a map: (title, unit, factor from SI)
    "pressure_Pa": ("Pressure", "kPa", 1e-3),
    "sliding_velocity_m_per_s": ("Sliding velocity", "m/s", 1.0),
    "sliding_power_W_per_m2": ("Sliding power", "W/m²", 1.0),
    "impact_power_W_per_m2": ("Impact power", "W/m²", 1.0),
}


# ---------------------------------------------------------------- views


def shown_parts(maps: Sequence[PartMap]) -> tuple[list[PartMap], dict[str, list[View]]]:
    """Return the maps as they are shown, and the views of each part, which all settings share.

    A part that closes round the axis it turns about is shown unrolled, a window of it round its worst place; of maps
    without marks the same window of all.
    """
    shown, views = [], {}
    for part in dict.fromkeys(each.part for each in maps):
        of_part = [each for each in maps if each.part == part]
        most = max(of_part, key=_worn)
        if most.turns_about is not None and mean_normal(most.mesh, most.wear) is None:
            of_part = [unrolled(each, Strip.of(each if each.marks else most)) for each in of_part]
            most = max(of_part, key=_worn)
            normal = mean_normal(most.mesh, most.wear)
            towards, up = [np.array([0.0, 0.0, 1.0]) if normal is None else normal], np.array([0.0, 1.0, 0.0])
        else:
            towards, up = best_views(most.mesh, most.wear), None
        points = np.concatenate([each.mesh.points for each in of_part])
        views[part] = [view_of(points, direction, up=up) for direction in towards]
        shown += of_part
    return shown, views


def _worn(shown: PartMap) -> float:
    return float(np.nansum(shown.wear))


@dataclass(frozen=True, eq=False)
class Strip:
    """How a part that closes round an axis is unrolled.

    point: (3,) m on the axis; axis, first, second: (3,) unit vectors; radius: m, at which lengths are true; origin: rad
    """

    point: np.ndarray
    axis: np.ndarray
    first: np.ndarray
    second: np.ndarray
    radius: float
    origin: float

    @classmethod
    def of(cls, shown: PartMap) -> Strip:
        """Return the strip in whose middle the first mark lies, or without marks the face that wears most."""
        point, axis = (np.asarray(each, dtype=float) for each in shown.turns_about)
        axis = axis / np.linalg.norm(axis)
        first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
        first /= np.linalg.norm(first)
        second = np.cross(axis, first)
        middle = centroids(shown.mesh.points, shown.mesh.triangles)
        worst = next(iter(shown.marks.values()), middle[int(np.nan_to_num(shown.wear).argmax())]) - point
        x, y = float(worst @ first), float(worst @ second)
        return cls(point, axis, first, second, float(np.hypot(x, y)), float(np.arctan2(y, x)))

    @property
    def reach(self) -> float:
        """Return how far (m) the window goes to either side."""
        return 0.5 * np.radians(WINDOW_DEG) * self.radius

    def places(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) m on the strip: against the sense of the axis, along it, inwards; right-handed."""
        from_axis = np.reshape(points, (-1, 3)) - self.point
        x, y = from_axis @ self.first, from_axis @ self.second
        angle = (np.arctan2(y, x) - self.origin + np.pi) % (2.0 * np.pi) - np.pi
        return np.column_stack([-self.radius * angle, from_axis @ self.axis, self.radius - np.hypot(x, y)])


def unrolled(shown: PartMap, strip: Strip) -> PartMap:
    """Return a part on a strip, cut to its window."""
    points = strip.places(shown.mesh.points)
    inside = (np.abs(points[shown.mesh.triangles][:, :, 0]) <= strip.reach).all(axis=1)
    nodes, triangles = np.unique(shown.mesh.triangles[inside], return_inverse=True)
    marks = {text: strip.places(place)[0] for text, place in shown.marks.items()}
    return replace(
        shown,
        mesh=SurfaceMesh(points[nodes], triangles.reshape(-1, 3)),
        values={name: values[inside] for name, values in shown.values.items()},
        wear=shown.wear[inside],
        marks={text: place for text, place in marks.items() if abs(place[0]) <= strip.reach},
        note=f"{WINDOW_DEG:g}° of it unrolled, moves to the left",
    )


def view_name(part: str, number: int, count: int) -> str:
    """Return what a view of a part is called."""
    return part.replace("_", " ") + (f", side {number + 1}" if count > 1 else "")


def part_pictures(
    maps: Sequence[PartMap],
    views: Mapping[str, Sequence[View]],
    quantity: str,
    limits: tuple[float, float],
    colours: Mapping[str, Colormap] | None = None,
    marked: bool = True,
) -> dict[tuple[str, str], Picture]:
    """Return a picture of each view of each part of each setting by (setting, name of the view).

    colours: {part: its colours}, MAP where there are none
    """
    found = {}
    for shown in maps:
        of_part = views[shown.part]
        for number, view in enumerate(of_part):
            pixels = part_picture(
                shown.mesh, shown.values[quantity], limits, (colours or {}).get(shown.part, MAP), view
            )
            marks = _seen_marks(shown, view) if marked else {}
            found[shown.setting, view_name(shown.part, number, len(of_part))] = Picture(pixels, view, marks, shown.note)
    return found


def _seen_marks(shown: PartMap, view: View) -> dict[str, np.ndarray]:
    """Return the marks of places whose face looks to the eye."""
    middle = centroids(shown.mesh.points, shown.mesh.triangles)
    corners = shown.mesh.points[shown.mesh.triangles]
    front = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ view.towards > 0.0
    worn = np.where(np.nan_to_num(shown.wear) > 0.0, 0.0, np.inf)  # the face of a place is one that wears
    near = {
        text: int((np.linalg.norm(middle - place, axis=1) + worn).argmin()) if np.isfinite(worn).any() else 0
        for text, place in shown.marks.items()
    }
    return {text: shown.marks[text] for text, face in near.items() if front[face]}


def machine_picture(
    maps: Sequence[PartMap], quantity: str, limits: tuple[float, float], rigid: Sequence[SurfaceMesh]
) -> Picture:
    """Return a picture of the whole machine of the first setting from the side, its rigid parts transparent."""
    mesh, values, wear = _joined([each for each in maps if each.setting == maps[0].setting], quantity)
    view = view_of(np.concatenate([mesh.points, *(each.points for each in rigid)]), best_oblique(mesh, wear))
    return Picture(part_picture(mesh, values, limits, MAP, view, behind=rigid), view)


def _joined(maps: Sequence[PartMap], quantity: str) -> tuple[SurfaceMesh, np.ndarray, np.ndarray]:
    """Return the parts of a setting as one surface, with values, and wear of which each part has as much."""
    starts = np.cumsum([0, *(len(each.mesh.points) for each in maps)])
    triangles = [each.mesh.triangles + start for each, start in zip(maps, starts, strict=False)]
    mesh = SurfaceMesh(np.concatenate([each.mesh.points for each in maps]), np.concatenate(triangles))
    values, wear = (
        np.concatenate([each.values[quantity] for each in maps]),
        np.concatenate([each.wear for each in maps]),
    )
    return mesh, values, wear


# ---------------------------------------------------------------- figures


def wear_map(
    maps: Sequence[PartMap],
    rigid: Mapping[str, Sequence[SurfaceMesh]],
    mm_per_mt: Mapping[str, float],
    remarks: Sequence[str],
) -> Figure:
    """Draw the recession (mm per 1,000 h) of the parts that wear, a row or column per setting, and the whole machine of
    the first setting, all on one scale, of decades where a part is far below another one.

    maps: with quantity `recession` (mm per 1,000 h), NaN where nothing touched, in the frame they were drawn in
    rigid: {setting: surfaces of its parts that keep their shape}
    mm_per_mt: {setting: mm per Mt of 1 mm per 1,000 h}, NaN or missing without an inlet; a second scale stands at the
    bar where all have the same, else a remark tells them
    """
    settings = list(dict.fromkeys(each.setting for each in maps))
    factors = {setting: mm_per_mt.get(setting, np.nan) for setting in settings}
    shared = len(set(np.round(list(factors.values()), SAME_DIGITS))) == 1 and np.isfinite(factors[settings[0]])
    figure = page([*remarks, *([] if shared else per_mt_words(factors))])
    scale = scale_of(maps, RECESSION)
    maps = on_scale(maps, RECESSION, scale)
    shown, views = shown_parts(maps)
    box = room(figure)
    if len(views) > 1 or any(rigid.values()) or shown[0].mesh is not maps[0].mesh:
        whole = machine_picture(maps, RECESSION, WHOLE_SCALE, rigid.get(settings[0], ()))
        narrow = float(np.clip(MACHINE_SHARE * box.height * whole.aspect, *MACHINE_WIDTHS))
        name = f"machine\n{settings[0]}" if len(settings) > 1 else "machine"
        picture_grid(figure, {("", name): whole}, replace(box, width=narrow))
        box = replace(box, left=box.left + narrow + BESIDE, width=box.width - narrow - BESIDE)
    pictures = part_pictures(shown, views, RECESSION, WHOLE_SCALE)
    picture_grid(figure, _in_order(pictures), box)
    bar = colour_bar(figure, bar_box(figure), scale, "Recession (mm per 1,000 h)")
    if shared:
        second_scale(bar, factors[settings[0]])
    _key(bar, [], "not worn")
    return figure


def per_mt_words(factors: Mapping[str, float]) -> list[str]:
    """Return what a mm per 1,000 h is per Mt of each setting with a feed; factors: {setting: mm per Mt}."""
    told = [f"{factor:.3g} ({setting})" for setting, factor in factors.items() if np.isfinite(factor)]
    return [f"1 mm per 1,000 h in mm per Mt: {', '.join(told)}"] if told else []


def _in_order(
    pictures: Mapping[tuple[str, str], Picture], maps: Sequence[PartMap] = ()
) -> dict[tuple[str, str], Picture]:
    """Return pictures setting by setting, these in the order of maps."""
    settings = list(dict.fromkeys([*(each.setting for each in maps), *(setting for setting, _ in pictures)]))
    return {key: pictures[key] for setting in settings for key in pictures if key[0] == setting}


def page(remarks: Sequence[str]) -> Figure:
    """Return an empty figure of the largest size, on which pictures have places of their own."""
    figure = new_figure(remarks, LARGEST_HEIGHT)
    figure.set_layout_engine(None)
    return figure


def room(figure: Figure) -> Box:
    """Return the room that pictures have besides the colour bar and the remarks."""
    lines = next((text.get_text().count("\n") + 1 for text in figure.texts if text.get_gid() == "remarks"), 0)
    below = REMARK_LINE * lines + MARGIN
    return Box(MARGIN, below, WIDTH - BAR_ROOM - MARGIN, figure.get_figheight() - below - MARGIN)


def bar_box(figure: Figure, quarter: Box | None = None) -> Box:
    """Return where a colour bar stands: at the right of a figure, with room for words below, or of a quarter of it."""
    whole = room(figure)
    box, away, below = (
        (quarter, SMALL_BAR_LEFT, 0.06) if quarter else (replace(whole, left=0.0, width=WIDTH), BAR_LEFT, 0.14)
    )
    low = box.bottom + below * box.height
    return Box(box.left + box.width - away, low, BAR_WIDE, (0.94 - below) * box.height)


def remaining_thickness(maps: Sequence[PartMap], change_out_mm: Mapping[str, float], remarks: Sequence[str]) -> Figure:
    """Draw the remaining thickness (mm) of the parts that wear, settings and hours side by side, all on one scale.

    maps: with quantity REMAINING (mm), settings named with the hours; change_out_mm: {part: remaining thickness at
    which it is changed}: fainter ones are red; NaN or missing where there is no such rule
    """
    figure = page(remarks)
    shown, views = shown_parts(maps)
    facing = [_facing(each, views[each.part]) for each in shown]
    thickest = max(map(thickness_where_worn, facing), default=0.0) or top_of(facing, REMAINING)
    limits = (0.0, max(thickest, *due_of(change_out_mm)))
    colours = {each.part: _with_due(change_out_mm.get(each.part, np.nan), limits[1]) for each in shown}
    pictures = part_pictures(shown, views, REMAINING, limits, colours, marked=False)
    picture_grid(figure, _in_order(pictures, maps), room(figure))
    one = len({change_out_mm.get(part, np.nan) for part in colours}) == 1
    palette = next(iter(colours.values())) if one else MAP
    bar = colour_bar(figure, bar_box(figure), Normalize(*limits), "Remaining thickness (mm)", colours=palette)
    _key(bar, [("due", DUE_COLOUR)] * any(np.isfinite(value) for value in change_out_mm.values()))
    return figure


def due_of(change_out_mm: Mapping[str, float]) -> list[float]:
    """Return the thicknesses (mm) at which parts are changed, those that are known, and 0."""
    return [0.0, *(value for value in change_out_mm.values() if np.isfinite(value))]


def _facing(shown: PartMap, views: Sequence[View]) -> PartMap:
    """Return a map with values only where faces look to the eye: edges of plates are as thick as plates are long."""
    normals = unit_normals(shown.mesh.points, shown.mesh.triangles)
    facing = np.any([normals @ view.towards > FACING for view in views], axis=0)
    return replace(shown, values={name: np.where(facing, values, np.nan) for name, values in shown.values.items()})


def thickness_where_worn(shown: PartMap) -> float:
    """Return the thickness as built (mm) that most of what is lost was lost below, 0 where nothing is: the end of a
    shaft, as thick as the shaft is long, and the rim of a flight set no scale for the flight.
    """
    left, lost = shown.values[REMAINING], np.nan_to_num(shown.wear) * areas(shown.mesh.points, shown.mesh.triangles)
    worn = np.isfinite(left) & (lost > 0.0)
    if not worn.any():
        return 0.0
    built = left + MILLIMETRES * np.nan_to_num(shown.wear)
    return area_quantile(built[worn], lost[worn], MOST_OF_WEAR)


def _with_due(due: float, top: float) -> Colormap:
    """Return the colours from 0 to `top` (mm), red up to `due`."""
    colours = colormaps[MAP](np.linspace(0.0, 1.0, FINE_COLOURS))
    if np.isfinite(due):
        colours[np.linspace(0.0, top, FINE_COLOURS) <= due] = to_rgba(DUE_COLOUR)
    return ListedColormap(colours)


def _key(bar: Colorbar, words: Sequence[tuple[str, str]], grey: str = "not known") -> None:
    """Say below a bar what colours mean, (text, colour), and what grey does."""
    lowest = -0.05 if bar.extend == "max" else -0.12  # below the arrow that a bar of lower values ends in
    for number, (text, colour) in enumerate([*words, (grey, NO_VALUE)]):
        height = lowest - 0.07 * number
        box = {"width": 1.0, "height": 0.05, "facecolor": colour, "edgecolor": "none", "clip_on": False}
        bar.ax.add_patch(Rectangle((0.0, height - 0.025), transform=bar.ax.transAxes, **box))
        place = {"xytext": (4.0, 0.0), "textcoords": "offset points", "va": "center", "ha": "left"}
        bar.ax.annotate(text, (1.0, height), xycoords="axes fraction", fontsize=SMALLEST_FONT, **place)


def impact_and_sliding(maps: Sequence[PartMap], remarks: Sequence[str]) -> Figure:
    """Draw pressure, sliding velocity, sliding power and impact power on the parts that wear, each on a scale of its
    own, which all settings share, from the first side of each part.

    maps: with the quantities of QUANTITIES, SI
    """
    figure = page(remarks)
    shown, views = shown_parts(maps)
    views = {part: sides[:1] for part, sides in views.items()}
    whole = room(figure)
    for number, (quantity, (title, unit, factor)) in enumerate(QUANTITIES.items()):
        line, column = divmod(number, 2)
        wide, high = 0.5 * WIDTH, 0.5 * whole.height
        quarter = Box(column * wide, whole.bottom + (1 - line) * high, wide, high)
        told = [replace(each, values={quantity: factor * each.values[quantity]}) for each in shown]
        limits = (0.0, top_of(told, quantity))
        pictures = part_pictures(told, views, quantity, limits, marked=False)
        inside = replace(quarter, left=quarter.left + MARGIN, width=wide - SMALL_BAR_ROOM - MARGIN)
        picture_grid(figure, _in_order(pictures), inside)
        unit, ticks = scaled(unit, limits[1])
        place = bar_box(figure, quarter)
        colour_bar(figure, place, Normalize(*limits), f"{title} ({unit})", format=ticks)
    return figure
