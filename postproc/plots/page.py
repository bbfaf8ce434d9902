"""Interactive 3-D pages of worn surfaces: one file each, with its viewer, readable without a network."""

from __future__ import annotations

import html
import io
import json
import re
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import rgb2hex

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.plots.scene import add_sample, load_pyvista, new_plotter
from bulkwear.postproc.plots.style import MAP
from bulkwear.postproc.tables.depths import face_depth
from bulkwear.postproc.tables.display import MILLIMETRES

PAGE_ZOOM = 1.7  # -, from all in view with much room to all in view
VIEWERS_ICONS = "https://kitware.github.io/vtk-js/icon/favicon-"  # the only thing that the viewer would fetch
NAME_HEIGHT = 0.09  # -, of letters, in lengths of the sample


def surfaces_page(
    path: str | Path,
    meshes: Mapping[str, SurfaceMesh],
    deformed: bool,
    limits: tuple[float, float],
    quantity: str,
    remarks: Sequence[str],
) -> None:
    """Write an interactive page with worn surfaces side by side, names before them; needs no network to be
    read.

    meshes: by run, left to right; limits: um; quantity: what the colour is; remarks: printed below the
    surfaces.
    """
    plotter = new_plotter((1200, 600))
    plotter.disable_parallel_projection()
    offset = 0.0
    for run, mesh in meshes.items():
        width, length = np.ptp(mesh.points[:, :2], axis=0)
        shift = [offset + width / 2.0, 0.0, 0.0]
        shifted = SurfaceMesh(mesh.points + shift, mesh.triangles, mesh.cell_data, mesh.point_data)
        add_sample(plotter, shifted, face_depth(mesh, deformed), limits)
        _add_name(plotter, run.replace("_", " "), (offset + width / 2.0, -0.62 * length), length)
        offset += 1.12 * width
    plotter.camera_position = "xy"
    plotter.camera.elevation = -40.0
    plotter.reset_camera()
    plotter.camera.Dolly(PAGE_ZOOM)
    plotter.renderer.ResetCameraClippingRange()
    page = viewer_page(plotter)
    plotter.close()
    Path(path).write_text(_with_legend(page, limits, quantity, remarks), encoding="utf-8")


def viewer_page(plotter) -> str:
    """Return a page with a viewer and the plotter's scene in it; needs neither a server nor the network.

    The same as pyvista's export of pages, without its server, which fetches files for other viewers at its start.
    """
    from trame_vtk.modules.vtk import serializers  # slow to import
    from trame_vtk.tools.vtksz2html import write_html

    plotter.render()
    serializers.initialize_serializers()
    context = serializers.SynchronizationContext()
    window, camera = plotter.render_window, plotter.camera
    scene = serializers.serialize(None, window, serializers.reference_id(window), context, 1)
    scene["extra"] = {
        "vtkRefId": serializers.reference_id(window),
        "centerOfRotation": camera.GetFocalPoint(),
        "camera": serializers.reference_id(camera),
    }
    arrays = {
        entry["hash"]: {**entry, "content": context.get_cached_data_array(entry["hash"], False)}
        for entry in serializers.extract_array_hash(scene)
    }
    packed, page = io.BytesIO(), io.StringIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("index.json", json.dumps({"hashes": arrays, "scene": scene}))
    write_html(packed.getvalue(), page)
    return page.getvalue()


def _with_legend(page: str, limits: tuple[float, float], quantity: str, remarks: Sequence[str]) -> str:
    """Return the page with a colour bar and the remarks over the scene: the viewer's own bar has wrong
    numbers.
    """
    colours = ", ".join(rgb2hex(colormaps[MAP](share)) for share in np.linspace(0.0, 1.0, 9))
    low, high = (f"{limit:.3g}" for limit in limits)
    legend = (
        '<div class="content" style="position:absolute;inset:0"></div>'  # the viewer empties its container
        '<div style="position:fixed;z-index:9;pointer-events:none;right:16px;top:14px;width:240px;'
        'font:13px sans-serif;color:#222">'
        f"{html.escape(quantity)} (µm)"
        f'<div style="height:14px;margin:4px 0;background:linear-gradient(to right, {colours})"></div>'
        f'<span>{low}</span><span style="float:right">{high} and more</span></div>'
        '<div style="position:fixed;z-index:9;pointer-events:none;left:12px;right:12px;bottom:8px;'
        f'font:13px sans-serif;color:#555">{html.escape("; ".join(remarks))}</div>'
    )
    page = page.replace(VIEWERS_ICONS, "data:,")
    page = re.sub("<title>.*?</title>", "<title>Worn surfaces</title>", page, count=1)
    return page.replace("<body>", f"<body>{legend}", 1)


def _add_name(plotter, text: str, place: tuple[float, float], length: float) -> None:
    """Write a name flat on the ground before a sample; place and length in m."""
    letters = load_pyvista().Text3D(text, depth=0.01)
    letters.points *= NAME_HEIGHT * length * MILLIMETRES
    middle = np.reshape(letters.bounds, (3, 2)).mean(axis=1)
    letters.translate((place[0] * MILLIMETRES - middle[0], place[1] * MILLIMETRES - middle[1], 0.0), inplace=True)
    plotter.add_mesh(letters, color="#333333")
