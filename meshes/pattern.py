"""The shapes that a sample's surface may bear, each by the name of such a surface; the rest is in `meshes.lattice`.

Another shape is a class here and its place in PATTERNS: settings, design columns, checks, meshes and estimates follow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bulkwear.meshes.bump import bump_shell
from bulkwear.meshes.lattice import Pattern, dimension, option
from bulkwear.meshes.shell import Shell, shell_element_size

MAJOR_AXES = ("along_travel", "across_travel")
THOMSEN = 1.6075  # exponent of K. Thomsen's formula for the area of an ellipsoid; its error is below 1.1 %


@dataclass(frozen=True)
class ConvexPattern(Pattern):
    """Semi-ellipsoids (Yan 2022, Figure 3.7); radii a and b of the foot, a may be the smaller, as in Table 3.8."""

    name = "convex"
    noun = "bump"

    major_radius: float = dimension("mm", 0.1, 100, "radius a of a bump along its major axis")
    minor_radius: float = dimension("mm", 0.1, 100, "radius b of a bump across its major axis")
    height: float = dimension("mm", 0.1, 100, "height h of a bump")
    row_spacing: float
    column_spacing: float
    major_axis: str = option("along_travel", MAJOR_AXES, "where the major radius points")
    row_offset: float = 0.5

    @property
    def foot(self) -> tuple[tuple[str, float], tuple[str, float]]:
        radii = ("minor radius", self.minor_radius), ("major radius", self.major_radius)
        return radii if self.major_axis == "along_travel" else radii[::-1]

    def height_at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        inside = 1.0 - (x / self.half_width) ** 2 - (y / self.half_length) ** 2
        return self.height * np.sqrt(np.maximum(inside, 0.0))

    @property
    def highest_point(self) -> float:
        return self.height

    @property
    def deepest_point(self) -> float:
        return 0.0

    @property
    def bump_axes(self) -> tuple[float, float, float]:
        return self.major_radius, self.minor_radius, self.height

    def shell(self, element_size: float) -> Shell:
        """Mesh a bump: it stands upright at its foot."""
        size = shell_element_size(self.half_width, self.half_length, element_size)
        return bump_shell(self.half_width, self.half_length, self.height, size)

    @property
    def shell_area(self) -> float:
        a, b, h = self.half_width, self.half_length, self.height
        pairs = ((a * b) ** THOMSEN, (a * h) ** THOMSEN, (b * h) ** THOMSEN)
        return 2.0 * math.pi * (sum(pairs) / 3.0) ** (1.0 / THOMSEN)


PATTERNS: dict[str, type[Pattern]] = {each.name: each for each in (ConvexPattern,)}
