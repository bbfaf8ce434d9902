"""Thumbnails of worn surfaces."""

import io

import numpy as np
import pandas as pd
from PIL import Image

from bulkwear.postproc.plots.thumbnail import SIDE, thumbnail


def test_the_deep_side_has_the_last_colour():
    """A sample twice as long as wide, worn in its far half, which is the upper one of the picture."""
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0.0, 10.0, 20), np.linspace(0.0, 20.0, 40)))
    faces = pd.DataFrame({"x_mm": x, "y_mm": y, "depth_um": np.where(y > 10.0, 5.0, 0.0)})
    picture = np.asarray(Image.open(io.BytesIO(thumbnail(faces, 5.0))).convert("RGB")).astype(int)
    assert picture.shape == (SIDE, SIDE // 2, 3)
    upper, lower = picture[5].mean(axis=0), picture[-5].mean(axis=0)
    assert upper[0] > 200 and upper[1] > 200 and lower[1] < 50  # yellow, and dark violet
