"""Film of a surface that wears, cycle by cycle: an animated GIF, drawn frame by frame and packed small."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from PIL import Image

from bulkwear.postproc.mesh import SurfaceMesh, areas, worn_faces
from bulkwear.postproc.plots.pictures import TOP_SHARE
from bulkwear.postproc.plots.scene import WHITE, common_bounds, surface_oblique, trimmed
from bulkwear.postproc.plots.style import (
    LARGEST_HEIGHT,
    MAP,
    OTHER_COLOUR,
    PATTERN_COLOUR,
    WIDTH,
    new_figure,
    picture,
    scaled,
)
from bulkwear.postproc.tables.depths import area_quantile, face_depth
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES
from bulkwear.postproc.tables.film import (
    DEEPEST_DRAWN,
    drawn_height,
    exaggerated,
    exaggeration,
    section,
    section_place,
)

FRAME_RESOLUTION = 100  # dots per inch: 800 pixels wide
VIEW = (1000, 560)  # pixels of a rendered view
LARGEST_BYTES = 1_500_000  # of a film, which is embedded into the page
COLOUR_COUNTS = (192, 96, 48)  # of a film's palette, the first that is small enough
PALETTE_FRAMES = 4  # evenly spaced, from which the palette is made
PALETTE_SHADES = np.linspace(0.4, 1.0, 120)  # -, brightness of the map's colours, which the palette must all have
WHOLE_SECONDS, LONGEST_FRAME, SHORTEST_FRAME, LAST_FRAME = 6.0, 0.8, 0.1, 2.0  # s
SECTION_ROOM = 0.15  # -, of the section's height, above and below
TITLE_FONT = 10.0  # pt
SMALL_PERCENT = 9.95  # below it a percentage has a decimal
LEAST_STRIP, LARGEST_STRIP = 0.15, 0.33  # -, of the frame's height for the section


def film_pictures(
    run: str, surfaces: Sequence[SurfaceMesh], frames: pd.DataFrame, quantity: str, remarks: Sequence[str]
) -> list[np.ndarray]:
    """Return the frames (h, w, 3) of a film: the surface obliquely, coloured by wear depth, and a section below.

    surfaces: one per frame, the unworn one first; frames: as from `tables.film.frame_table`; quantity: what the
    colour is. Colour scale, view, section and exaggeration of the wear are the same on all frames.
    """
    limits = film_limits(surfaces[-1])
    factor, most = exaggeration(surfaces[0], surfaces[-1]), DEEPEST_DRAWN * drawn_height(surfaces[0])
    if factor > 1.0:
        remarks = [*remarks, f"wear is drawn {factor:,.0f} times as deep as it is, at most {most * MILLIMETRES:.2g} mm"]
    surfaces = [exaggerated(mesh, factor, most) for mesh in surfaces]
    bounds, x = common_bounds(surfaces), section_place(surfaces[0], surfaces[-1])
    views = trimmed([surface_oblique(mesh, True, limits, bounds, VIEW) for mesh in surfaces])
    figure = new_figure(remarks, LARGEST_HEIGHT)
    figure.set_dpi(FRAME_RESOLUTION)
    canvas = FigureCanvasAgg(figure)
    sections = [section(mesh, x) * MILLIMETRES for mesh in surfaces]
    strip = section_height(sections)
    view, cut = figure.subplots(2, 1, height_ratios=(1.0 - strip, strip))
    title = figure.suptitle(run, x=0.008, ha="left", fontsize=TITLE_FONT)
    picture(view, views[0])
    unit, ticks = scaled("µm", limits[1])
    bar = ScalarMappable(Normalize(*limits), MAP)
    placed = {"shrink": 0.9, "pad": 0.02, "panchor": False}
    figure.colorbar(bar, ax=view, label=f"{quantity} ({unit})", format=ticks, extend="max", **placed)
    line = _section_axes(cut, sections, x)
    drawn = []
    for lines, pixels, frame in zip(sections, views, frames.itertuples(), strict=True):
        view.images[0].set_data(pixels)
        line.set_segments(lines)
        title.set_text(frame_title(run, frame))
        canvas.draw()
        figure.set_layout_engine(None)  # the first frame's layout is that of all
        drawn.append(np.asarray(canvas.buffer_rgba())[..., :3].copy())
    return drawn


def film_limits(last: SurfaceMesh) -> tuple[float, float]:
    """Return the colour scale (um) of a film: 0 to the depth that 99 % of the worn area does not exceed in the end."""
    worn = worn_faces(last)
    top = area_quantile(face_depth(last, True)[worn], areas(last.points, last.triangles[worn]), TOP_SHARE)
    return 0.0, max(top * MICROMETRES, float(np.finfo(float).tiny))


def section_height(sections: Sequence[np.ndarray]) -> float:
    """Return the share of the frame's height that sections (k, 2, 2; mm) as wide as the frame would take, bounded."""
    length, height = np.ptp(np.concatenate(sections), axis=(0, 1))
    return float(np.clip(height / length * WIDTH / LARGEST_HEIGHT, LEAST_STRIP, LARGEST_STRIP))


def frame_title(run: str, frame: Any) -> str:
    """Return what stands above a frame, a row of `tables.film.frame_table`."""
    left = frame.bumps_left_percent
    pattern = "" if np.isnan(left) else f", {left:.{0 if left > SMALL_PERCENT else 1}f} % of the pattern left"
    name, travel = (
        run.replace("_", " "),
        f"{frame.travel_mm:.0f}" if frame.travel_mm >= 10.0 else f"{frame.travel_mm:.3g}",
    )
    return f"{name}: cycle {frame.cycle}, {travel} mm of travel, {frame.applied_volume_mm3:.3g} mm³ worn off{pattern}"


def _section_axes(axes: Axes, sections: Sequence[np.ndarray], x: float) -> LineCollection:
    """Draw the first, unworn one of sections (k, 2, 2; mm), with equal axes; return the lines of the worn one."""
    unworn, ends = sections[0], np.concatenate(sections)
    axes.add_collection(LineCollection(unworn, colors=OTHER_COLOUR, linewidths=0.8, linestyles=":"))
    line = axes.add_collection(LineCollection(unworn, colors=PATTERN_COLOUR, linewidths=1.4))
    (left, low), (right, high) = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
    room = SECTION_ROOM * max(high - low, (right - left) / 20.0)
    axes.set(xlim=(left, right), ylim=(low - room, high + room), aspect="equal")
    axes.set(
        xlabel=f"y (mm), section at x = {round(x * MILLIMETRES, 2) + 0.0:g} mm; the bed moves to +y", ylabel="z (mm)"
    )
    return line


def save_film(pictures: Sequence[np.ndarray], path: str | Path, largest: int = LARGEST_BYTES) -> None:
    """Write pictures (h, w, 3) as an animated GIF that repeats; colours, then frames, are thinned until it is no larger
    than `largest` bytes.
    """
    shown = list(pictures)
    content = next((film for count in COLOUR_COUNTS if len(film := _packed(shown, count)) <= largest), None)
    while content is None and len(shown) > 2:
        shown = [*shown[:-1:2], shown[-1]]
        film = _packed(shown, COLOUR_COUNTS[-1])
        content = film if len(film) <= largest else None
    Path(path).write_bytes(content if content is not None else _packed(shown, COLOUR_COUNTS[-1]))


def save_still(pictures: Sequence[np.ndarray], path: str | Path) -> None:
    """Write the last picture (h, w, 3) of a film as PNG."""
    Image.fromarray(pictures[-1]).save(path, "PNG", optimize=True)


def _packed(pictures: Sequence[np.ndarray], colours: int) -> bytes:
    """Return an animated GIF of one palette without dithering: what does not change takes no room."""
    sample = np.linspace(0, len(pictures) - 1, min(len(pictures), PALETTE_FRAMES)).round().astype(int)
    palette = Image.fromarray(np.concatenate([_map_colours(pictures[0].shape[1]), *(pictures[k] for k in sample)]))
    palette, white = _with_white(palette.quantize(colours))
    first, *others = (_in_palette(pixels, palette, white) for pixels in pictures)
    seconds = float(np.clip(WHOLE_SECONDS / len(pictures), SHORTEST_FRAME, LONGEST_FRAME))
    durations = [round(1000.0 * each) for each in (*[seconds] * len(others), LAST_FRAME)]
    stream = io.BytesIO()
    first.save(stream, "GIF", save_all=True, append_images=others, duration=durations, loop=0, optimize=False)
    return stream.getvalue()


def _with_white(palette: Image.Image) -> tuple[Image.Image, int]:
    """Return an image with a palette whose lightest colour is white, as the page is, and that colour's index."""
    colours = np.array(palette.getpalette(), dtype=np.uint8).reshape(-1, 3)
    white = int(colours.sum(axis=1, dtype=int).argmax())
    colours[white] = WHITE
    palette.putpalette(colours.ravel().tolist())
    return palette, white


def _in_palette(pixels: np.ndarray, palette: Image.Image, white: int) -> Image.Image:
    """Return a picture in the colours of a palette; white stays white, for which the nearest colour may be taken."""
    image = Image.fromarray(pixels).quantize(palette=palette, dither=Image.Dither.NONE)
    blank = (pixels == WHITE).all(axis=2)
    image.paste(white, mask=Image.fromarray(WHITE * blank.astype(np.uint8)))
    return image


def _map_colours(width: int) -> np.ndarray:
    """Return the colours of the map from left to right, light below and dark above, as a picture (h, width, 3)."""
    colours = colormaps[MAP](np.linspace(0.0, 1.0, width))[:, :3]
    return (WHITE * PALETTE_SHADES[:, None, None] * colours).round().astype(np.uint8)
