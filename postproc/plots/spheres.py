"""Particles as circles of their true size, coloured by what they do."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize


def draw_circles(
    axes: Axes, places: np.ndarray, radii: np.ndarray, values: np.ndarray, norm: Normalize, colours: str
) -> None:
    """Draw a circle round each place.

    places (n, 2) and radii (n,): in the units of the axes; values (n,): coloured by `norm` in the map `colours`
    """
    size = 2.0 * radii
    circles = EllipseCollection(
        size,
        size,
        np.zeros(len(size)),
        units="xy",
        offsets=places,
        offset_transform=axes.transData,
        array=values,
        cmap=colours,
        norm=norm,
        linewidths=0.0,
    )
    axes.add_collection(circles)
