"""Pictures of the disc: set-up, how contours are taken, the unrolled track as a map, the worn disc in 3-D."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from bulkwear.postproc.mesh import SurfaceMesh, edge_lengths_per_triangle
from bulkwear.postproc.plots.scene import load_pyvista, new_plotter, trimmed
from bulkwear.postproc.plots.style import MAP, SMALLEST_FONT, height_of_pictures, new_figure, picture
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES
from bulkwear.workflows.cases.pin_on_disc.contours import CONTOURS, OPENING_LEVEL, contour_table, depth_map, track_radii
from bulkwear.workflows.cases.pin_on_disc.plots.contours import SCHEME_COLOURS, SCHEME_NAMES

PIN_COLOUR = "#D55E00"
RELIEF_SPACING = 20e-6  # m, of the places across the track in 3-D
RELIEF_SIDE = 1.2e-3  # m, shown either side of the track
DEEPEST_SHARE = 0.995  # of the places of a map: deeper ones share the top colour
PLAIN_BOX = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}  # behind words that stand on lines
SHOWN_SLICE = 12.0  # degrees, of the disc that shows how contours are taken
RELIEF = 0.15  # -, of the track's radius: how deep the exaggerated groove of the picture is
STRETCH = 5.0  # -, by which it is wider
RELIEF_CONTOURS = 720  # of the picture in 3-D
VIEW = (0.35, -1.0, 0.75)  # from where the disc is looked at


def disc_setup(
    mesh: SurfaceMesh, track_radius: float, pin_radius: float, load: float, remarks: Sequence[str]
) -> Figure:
    """Draw the disc from above with its elements, track and pin, and the pin on it from the side; lengths in mm."""
    figure = new_figure(remarks, 4.6)
    above, side = figure.subplots(1, 2, width_ratios=(1, 1))
    corners = MILLIMETRES * mesh.points[mesh.triangles][:, :, :2]
    edge = MILLIMETRES * edge_lengths_per_triangle(mesh.points, mesh.triangles).mean(axis=1)
    elements = PolyCollection(corners, array=edge, cmap=MAP, edgecolors="none", rasterized=True)
    above.add_collection(elements)
    track, pin = MILLIMETRES * track_radius, MILLIMETRES * pin_radius
    above.add_patch(Circle((0.0, 0.0), track, fill=False, color="white", linewidth=0.8))
    above.add_patch(Circle((track, 0.0), pin, color=PIN_COLOUR, alpha=0.8))
    above.annotate(
        "", (0.0, track - 5.0), (track - 5.0, 0.0), arrowprops={"arrowstyle": "->", "connectionstyle": "arc3,rad=0.4"}
    )
    above.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    above.autoscale_view()
    above.set_xlim(right=track + pin + 1.0)
    figure.colorbar(elements, ax=above, label="Mean edge of an element (mm)", shrink=0.8, location="left")
    inner, outer = (MILLIMETRES * bound for bound in _rims(mesh))
    side.add_patch(Circle((track, pin), pin, color=PIN_COLOUR, alpha=0.8))
    side.fill_between([inner, outer], -0.6, 0.0, color="#9aa0a6")
    side.text(track, -1.2, "disc, a ring of it is meshed", ha="center", va="top", fontsize=SMALLEST_FONT)
    side.annotate(f"{load:g} N", (track, pin), (track, 2.0 * pin + 1.6), ha="center", arrowprops={"arrowstyle": "->"})
    side.annotate(
        "pin, held in the plane,\nfree to sink",
        (track - pin, pin),
        (track - 3.6 * pin, 1.6 * pin),
        fontsize=SMALLEST_FONT,
    )
    side.set(
        aspect="equal", xlabel="r (mm)", ylabel="z (mm)", ylim=(-2.6, 2.0 * pin + 3.0), xlim=(inner - 9.0, outer + 2.0)
    )
    return figure


def _rims(mesh: SurfaceMesh) -> tuple[float, float]:
    radius = np.hypot(mesh.points[:, 0], mesh.points[:, 1])
    return float(radius.min()), float(radius.max())


def contour_extraction(mesh: SurfaceMesh, track_radius: float, angle: int, remarks: Sequence[str]) -> Figure:
    """Draw a slice of the worn disc with its radial contours, and one contour with its depth and widths."""
    figure = new_figure(remarks, 4.4)
    above, section = figure.subplots(1, 2, width_ratios=(2, 3))
    radii = track_radii(mesh, track_radius)
    _slice(above, mesh, radii, angle)
    depth = depth_map(mesh, radii)[angle]
    row = contour_table(mesh, track_radius).iloc[angle]
    across = MILLIMETRES * (radii - track_radius)
    section.plot(across, MICROMETRES * depth, color="black", linewidth=1.2)
    deepest = across[np.argmax(depth)]
    section.annotate("", (deepest, 0.0), (deepest, MICROMETRES * row["depth_m"]), arrowprops={"arrowstyle": "<->"})
    half = (deepest, 0.5 * MICROMETRES * row["depth_m"])
    section.annotate(f"depth {MICROMETRES * row['depth_m']:.3g} µm", half, ha="center", bbox=PLAIN_BOX)
    middle = 0.5 * across[depth > OPENING_LEVEL * depth.max()][[0, -1]].sum()
    for name, level, words in (
        ("opening_width_m", OPENING_LEVEL, f"opening (at {100 * OPENING_LEVEL:g} % of the depth)"),
        ("area_width_m", 1.12, "holds 95 % of the area"),
    ):
        width, height = MILLIMETRES * row[name], level * MICROMETRES * row["depth_m"]
        section.annotate(
            "",
            (middle - width / 2, height),
            (middle + width / 2, height),
            arrowprops={"arrowstyle": "<->", "color": SCHEME_COLOURS["conserving"]},
        )
        section.annotate(
            f"{width:.3g} mm {words}",
            (middle, height),
            (0.0, 4.0),
            textcoords="offset points",
            bbox=PLAIN_BOX,
            ha="center",
            va="bottom",
            color=SCHEME_COLOURS["conserving"],
            fontsize=SMALLEST_FONT,
        )
    section.set(xlabel="Across the track, outwards (mm)", ylabel="Depth (µm)", title=f"contour at {angle} degrees")
    section.set_ylim(1.3 * MICROMETRES * row["depth_m"], -0.15 * MICROMETRES * row["depth_m"])
    section.set_xlim(
        middle - 1.2 * MILLIMETRES * row["opening_width_m"], middle + 1.2 * MILLIMETRES * row["opening_width_m"]
    )
    return figure


def _slice(axes, mesh: SurfaceMesh, radii: np.ndarray, angle: int) -> None:
    """Draw the elements of some degrees of the disc, coloured by depth, and the contours over them."""
    turned = np.radians(angle) + np.radians(SHOWN_SLICE) * np.array([-0.5, 0.5])
    middle = mesh.points[mesh.triangles].mean(axis=1)
    at = np.mod(np.arctan2(middle[:, 1], middle[:, 0]) - turned[0], 2.0 * np.pi)
    shown = mesh.triangles[at < turned[1] - turned[0]]
    look = {"cmap": MAP, "edgecolors": "white", "linewidths": 0.1, "rasterized": True}
    depth = -MICROMETRES * mesh.points[shown][:, :, 2].mean(axis=1)
    axes.add_collection(PolyCollection(MILLIMETRES * mesh.points[shown][:, :, :2], array=depth, **look))
    for degree in np.arange(np.ceil(np.degrees(turned[0])), np.degrees(turned[1])):
        direction = np.array([np.cos(np.radians(degree)), np.sin(np.radians(degree))])
        ends = MILLIMETRES * radii[[0, -1], None] * direction
        look = {"color": "white" if degree != angle else PIN_COLOUR, "linewidth": 0.8 if degree != angle else 2.0}
        axes.plot(*ends.T, **look)
    axes.set(
        aspect="equal", xlabel="x (mm)", ylabel="y (mm)", title=f"{CONTOURS} contours, {360 / CONTOURS:g} degree apart"
    )
    axes.autoscale_view()


def unrolled_track(maps: Mapping[str, pd.DataFrame], remarks: Sequence[str]) -> Figure:
    """Draw depth (um) over angle and radius, one map per scheme, on one scale.

    maps : by scheme, as from `contours.track_map`.
    """
    figure = new_figure(remarks, 4.6)
    grid = figure.subplots(len(maps), 1, sharex=True, squeeze=False)[:, 0]
    top = max(np.finfo(float).tiny, *(float(np.quantile(depth, DEEPEST_SHARE)) for depth in maps.values()))
    for axes, (scheme, depth) in zip(grid, maps.items(), strict=True):
        extent = (-0.5, CONTOURS - 0.5, depth.index[0], depth.index[-1])
        look = {"origin": "lower", "aspect": "auto", "cmap": MAP, "interpolation": "nearest"}
        drawn = axes.imshow(depth.to_numpy(), extent=extent, vmin=0.0, vmax=top, **look)
        axes.grid(False)
        axes.set_title(SCHEME_NAMES[scheme], loc="left")
        axes.set_ylabel("Radius (mm)")
    figure.colorbar(drawn, ax=list(grid), label="Depth (µm)", extend="max")
    grid[-1].set_xlabel("Angle (degrees)")
    grid[-1].set_xticks(range(0, 361, 60))
    return figure


def worn_disc(meshes: Mapping[str, SurfaceMesh], track_radius: float, remarks: Sequence[str]) -> Figure:
    """Draw the tracks of worn discs in 3-D, one per scheme, on one scale; depth and width exaggerated by the factors
    that are written above.
    """
    deepest = max(np.finfo(float).tiny, *(-float(mesh.points[:, 2].min()) for mesh in meshes.values()))
    factor, limits = float(f"{RELIEF * track_radius / deepest:.0e}"), (0.0, MICROMETRES * deepest)
    said = f"depth exaggerated {factor:g} times, width {STRETCH:g} times"
    views = trimmed([_relief(mesh, track_radius, factor, limits) for mesh in meshes.values()])
    figure = new_figure(remarks, height_of_pictures(views, len(views)))
    grid = figure.subplots(1, len(views), squeeze=False)[0]
    for axes, scheme, view in zip(grid, meshes, views, strict=True):
        picture(axes, view)
        axes.set_title(f"{SCHEME_NAMES[scheme]}\n{said}", fontsize=SMALLEST_FONT)
    bar = ScalarMappable(Normalize(*limits), MAP)
    figure.colorbar(bar, ax=list(grid), label="Depth (µm)", location="bottom", shrink=0.6, pad=0.02)
    return figure


def _relief(mesh: SurfaceMesh, track_radius: float, factor: float, limits: tuple[float, float]) -> np.ndarray:
    """Pixels (h, w, 3) of a track, depth `factor` times and width `STRETCH` times true; colour: depth, limits in um."""
    radii = track_radii(mesh, track_radius, RELIEF_SPACING)
    radii = radii[np.abs(radii - track_radius) <= RELIEF_SIDE]
    depth = depth_map(mesh, radii, RELIEF_CONTOURS)
    angle = 2.0 * np.pi / RELIEF_CONTOURS * np.arange(RELIEF_CONTOURS + 1)[:, None]
    around = np.concatenate([depth, depth[:1]])
    wider = track_radius + STRETCH * (radii - track_radius)
    points = MILLIMETRES * np.stack([wider * np.cos(angle), wider * np.sin(angle), -factor * around])
    surface = load_pyvista().StructuredGrid(*points)
    surface.point_data["depth"] = MICROMETRES * around.ravel(order="F")
    plotter = new_plotter((1100, 900))
    look = {"ambient": 0.3, "diffuse": 0.7, "specular": 0.0}
    plotter.add_mesh(surface, scalars="depth", cmap=MAP, clim=limits, show_scalar_bar=False, **look)
    plotter.view_vector(VIEW, (0.0, 0.0, 1.0))
    plotter.reset_camera()
    pixels = np.array(plotter.screenshot(return_img=True))[..., :3]
    plotter.close()
    return pixels
