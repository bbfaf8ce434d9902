"""Interactive page of worn surfaces: one file with all that it needs, readable without a network.

The views are drawn by plotly's own script, which its package brings along.
"""

from __future__ import annotations

import base64
import importlib.resources
import json
import zlib
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import rgb2hex

from bulkwear.postproc.plots.style import MAP
from bulkwear.postproc.tables.compared_surfaces import Shown
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.tables.packed_surfaces import packed

TEMPLATE = Path(__file__).with_name("compare.html")
COLOURS = 9  # of the map, from which the page makes all others
LIBRARY = ("plotly", "package_data", "plotly.min.js")


def surfaces_page(
    path: str | Path, surfaces: Sequence[Shown], deformed: bool, parts: Mapping[int, str], remarks: Sequence[str]
) -> None:
    """Write a page on which runs, cycles and quantities are chosen, seen beside one another, and cut.

    deformed: whether wear was applied to the shape; parts: name of a part by its label; remarks: printed below
    """
    told, numbers = packed(surfaces, deformed)
    points = np.concatenate([each.mesh.points for each in surfaces]) * MILLIMETRES
    told |= {
        "seen": [points.min(axis=0).tolist(), points.max(axis=0).tolist()],
        "colours": [rgb2hex(colormaps[MAP](share)) for share in np.linspace(0.0, 1.0, COLOURS)],
        "parts": {str(label): name for label, name in parts.items()},
        "remarks": list(remarks),
    }
    page = TEMPLATE.read_text(encoding="utf-8")
    for mark, text in {
        "/*TOLD*/": json.dumps(told).replace("</", "<\\/"),
        "/*NUMBERS*/": base64.b64encode(numbers).decode(),
        "/*LIBRARY*/": plotly_script(),
    }.items():
        page = page.replace(mark, text, 1)
    Path(path).write_text(page, encoding="utf-8")


def within_a_page(page: str) -> str:
    """Return the text of a page of surfaces without plotly's script, which it then takes from the page that frames it:
    from the element "plotly".
    """
    return page.replace(plotly_script(), "", 1)


@cache
def plotly_script() -> str:
    """Return plotly's script, compressed, in letters."""
    script = importlib.resources.files(LIBRARY[0]).joinpath(*LIBRARY[1:]).read_bytes()
    return base64.b64encode(zlib.compress(script, 9)).decode()
