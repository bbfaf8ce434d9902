"""How many triangles a surface will have, without meshing it: areas over the area of a triangle of the target edge."""

from __future__ import annotations

import math

from bulkwear.meshes import disc, plane
from bulkwear.meshes.lattice import Pattern, pattern_centres
from bulkwear.meshes.sample import skirt_width
from bulkwear.meshes.shell import shell_element_size

EQUILATERAL = math.sqrt(3.0) / 4.0  # area of an equilateral triangle over its edge squared
# Mean area of a triangle over that of the equilateral one with the target edge, measured on meshes of the studies.
SAMPLE_AREA, DISC_AREA = 0.90, 0.86


def sample_triangles(
    width: float,
    length: float,
    element_size: float,
    pattern: Pattern | None,
    height_above_floor: float,
    skirt_slope: float,
    skirt_radius: float = 0.0,
) -> float:
    """About how many triangles `meshes.sample.sliding_sample` makes; same arguments."""
    frame = skirt_width(height_above_floor, skirt_slope, skirt_radius)
    outer = element_size if skirt_radius > 0.0 else max(element_size, frame / plane.FRAME_EDGES)
    rim = 2.0 * (width + length) + 4.0 * frame  # half way across the frame
    count = width * length / element_size**2 + rim * frame / (element_size * outer)
    if pattern is not None:
        count += len(pattern_centres(pattern, width, length)[0]) * _shape_over_plane(pattern, element_size)
    return count / (EQUILATERAL * SAMPLE_AREA)


def _shape_over_plane(pattern: Pattern, element_size: float) -> float:
    """What a shape adds: its shell less its foot, and finer elements round it, over the square of their edge."""
    a, b = pattern.half_width, pattern.half_length
    edge = shell_element_size(a, b, element_size)
    grown = (element_size - edge) / plane.GROWTH
    foot = math.pi * (3.0 * (a + b) - math.sqrt((3.0 * a + b) * (a + 3.0 * b)))  # perimeter; Ramanujan 1914
    round_it = foot * ((1.0 / edge - 1.0 / element_size) / plane.GROWTH - grown / element_size**2)
    return pattern.shell_area / edge**2 - math.pi * a * b / element_size**2 + round_it


def disc_triangles(
    track_radius: float, inner_radius: float, disc_radius: float, element_size: float, band_half_width: float
) -> float:
    """About how many triangles `meshes.disc.track_disc` makes; same arguments."""
    sides = (track_radius - inner_radius, disc_radius - track_radius)
    around = 2.0 * math.pi * track_radius
    return around * sum(_beside_track(side, element_size, band_half_width, max(sides)) for side in sides)


def stretch_triangles(
    track_radius: float,
    inner_radius: float,
    disc_radius: float,
    element_size: float,
    band_half_width: float,
    arc: float,
    reach: float,
) -> float:
    """About how many of them `meshes.disc.track_stretch` takes for an arc (rad) and a reach (m) of the pin."""
    wide = reach + element_size / math.sqrt(3.0)  # triangles count when their middle is within reach and their own
    sides = (track_radius - inner_radius, disc_radius - track_radius)
    across = sum(_beside_track(min(side, wide), element_size, band_half_width, max(sides)) for side in sides)
    return across * (min(arc, 2.0 * math.pi) * track_radius + 0.5 * math.pi * wide)


def _beside_track(width: float, element_size: float, band: float, widest: float) -> float:
    """Triangles per length of track on one side of it, up to `width` (m): the integral of one over their area."""
    largest = max(element_size, widest / disc.RIM_EDGES)
    fine = min(width, band)
    grown = min(max(width - band, 0.0), (largest - element_size) / disc.GROWTH)
    coarse = max(width - band, 0.0) - grown
    edge = element_size + disc.GROWTH * grown
    count = fine / element_size**2 + grown / (element_size * edge) + coarse / largest**2
    return count / (EQUILATERAL * DISC_AREA)
