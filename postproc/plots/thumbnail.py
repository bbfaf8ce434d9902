"""Small pictures of worn surfaces from above, for tables of runs: made of a table of faces, without a renderer."""

from __future__ import annotations

import io

import matplotlib as mpl
import numpy as np
import pandas as pd
from PIL import Image
from scipy.spatial import cKDTree

from bulkwear.postproc.plots.style import MAP

SIDE = 72  # pixels of the longer side
COLOURS = 64


def thumbnail(faces: pd.DataFrame, top: float) -> bytes:
    """Return a PNG of a surface seen from above, each pixel with the colour of the face next to it.

    faces: x_mm, y_mm of centroids, and depth_um; top: depth (um) of the last colour
    """
    places = faces[["x_mm", "y_mm"]].to_numpy()
    low, size = places.min(axis=0), np.maximum(np.ptp(places, axis=0), np.finfo(float).tiny)
    columns, rows = np.maximum((SIDE * size / size.max()).round().astype(int), 1)
    x, y = (low[k] + size[k] * (np.arange(count) + 0.5) / count for k, count in enumerate((columns, rows)))
    grid = np.stack(np.meshgrid(x, y[::-1]), axis=-1)  # pictures begin at the top
    nearest = cKDTree(places).query(grid)[1]
    pixels = mpl.colormaps[MAP](faces["depth_um"].to_numpy()[nearest] / top, bytes=True)[..., :3]
    written = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).quantize(COLOURS).save(written, "PNG", optimize=True)
    return written.getvalue()
