"""The angle of a slope is that of the heap it was made with, however the heap is turned, scaled or roughened."""

import math

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.free_surface import FreeSurfaceError, fitted_slope, scanned_heights, surface_points

LARGEST_ERROR = 0.5  # degrees, what a heap's angle may be missed by
EXACT = 1e-9  # relative: the same arithmetic on mirrored or scaled numbers
LENGTH, WIDTH = 0.2, 0.04  # m
ANGLES = (24.0, 30.0, 36.0, 42.0)


def heap(angle, diameter=0.005, noise=0.0, toe=0.0, seed=1, length=LENGTH, per_cell=4.0):
    """Particles under a slope that falls from y = 0 to its toe at y = length; noise is in diameters.

    toe: share of the height over which the slope runs out, its gradient falling linearly to a third.
    """
    random = np.random.default_rng(seed)
    gradient = math.tan(math.radians(angle))
    count = int(per_cell * length * WIDTH / diameter**2)
    x = random.uniform(-WIDTH / 2.0, WIDTH / 2.0, count)
    y = random.uniform(0.0, length, count)
    run_out = toe * length
    from_toe = np.clip(run_out - (length - y), 0.0, None)
    surface = gradient * (length - y) + gradient * (2.0 / 3.0) * from_toe**2 / (2.0 * max(run_out, 1e-12))
    layers = [surface - depth * diameter + noise * diameter * random.standard_normal(count) for depth in range(3)]
    return pd.DataFrame(
        {
            "x_m": np.tile(x, 3),
            "y_m": np.tile(y, 3),
            "z_m": np.concatenate(layers),
            "radius_m": diameter / 2.0 * np.tile(random.choice([0.8, 1.0, 1.2], count), 3),
        }
    )


def measured(particles, diameter=0.005, length=LENGTH):
    """Slope of a heap between its walls."""
    return fitted_slope(surface_points(particles, WIDTH, diameter), 0.0, length, diameter)


def degrees(slope):
    """Angle of a slope in degrees."""
    return math.degrees(slope.angle_rad)


@pytest.mark.parametrize("angle", ANGLES)
def test_an_ideal_plane_has_its_angle(angle):
    """The fitted angle of a plane is the plane's."""
    assert abs(degrees(measured(heap(angle))) - angle) < LARGEST_ERROR


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("angle", ANGLES)
def test_a_rough_slope_has_its_angle(angle, seed):
    """Particles that stand out by a third of a diameter at random do not turn the slope."""
    assert abs(degrees(measured(heap(angle, noise=0.3, seed=seed))) - angle) < LARGEST_ERROR


@pytest.mark.parametrize("angle", ANGLES)
def test_a_curved_toe_does_not_count(angle):
    """A toe that runs out over the lowest fifth of its length leaves the angle of the straight part."""
    assert abs(degrees(measured(heap(angle, noise=0.1, toe=0.2))) - angle) < LARGEST_ERROR


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("angle", ANGLES)
def test_few_particles_are_enough(angle, seed):
    """Eight hundred particles, twenty diameters of slope, still give the angle."""
    few = heap(angle, diameter=0.01, noise=0.1, seed=seed, per_cell=3.5)
    assert len(few) < 850
    assert abs(degrees(measured(few, diameter=0.01)) - angle) < LARGEST_ERROR


def test_a_grain_that_lies_loose_does_not_count():
    """A tenth of the particles lifted by two diameters leave the angle: the fit is of medians."""
    particles = heap(33.0, noise=0.1)
    lifted = np.random.default_rng(3).choice(len(particles) // 3, len(particles) // 30, replace=False)
    particles.loc[lifted, "z_m"] += 0.01
    assert abs(degrees(measured(particles)) - 33.0) < LARGEST_ERROR


def test_a_flat_crest_does_not_count():
    """A heap that was not drained to its back wall keeps a level top; the slope below it is what is measured."""
    particles = heap(40.0, noise=0.1)
    particles["z_m"] = np.minimum(particles["z_m"], 0.6 * LENGTH * math.tan(math.radians(40.0)))
    assert abs(degrees(measured(particles)) - 40.0) < LARGEST_ERROR


def test_mirrored_heap_has_the_same_slope():
    """A slope that rises has the angle of its mirror image that falls."""
    particles = heap(35.0, noise=0.2)
    mirrored = particles.assign(y_m=LENGTH - particles["y_m"])
    first, second = measured(particles), measured(mirrored)
    assert second.gradient > 0.0 > first.gradient
    # the raster starts at the other end: cells are cut elsewhere, within the scatter of the surface
    assert abs(degrees(first) - degrees(second)) < LARGEST_ERROR


def test_units_do_not_matter():
    """A heap in another unit of length has the angle of the same heap in metres."""
    particles, unit = heap(35.0, noise=0.2), 1024.0  # a power of two: no number is rounded into another cell
    metres = measured(particles)
    points = surface_points(particles * unit, unit * WIDTH, unit * 0.005)
    others = fitted_slope(points, 0.0, unit * LENGTH, unit * 0.005)
    assert others.angle_rad == pytest.approx(metres.angle_rad, rel=EXACT)
    assert others.start_m == pytest.approx(unit * metres.start_m, rel=EXACT)


def test_shift_across_the_periodic_slice_does_not_matter():
    """Moving all particles by one raster step round the periodic width shifts the scan and nothing else."""
    particles = heap(35.0, noise=0.2)
    step = WIDTH / 80
    moved = particles.assign(x_m=(particles["x_m"] + step + WIDTH / 2.0) % WIDTH - WIDTH / 2.0)
    one, other = (scanned_heights(each, WIDTH, step)[1] for each in (particles, moved))
    np.testing.assert_allclose(np.roll(one, 1, axis=0), other, rtol=1e-6)


def test_uncertainty_is_the_scatter_of_heaps():
    """The stated uncertainty is the standard deviation between heaps of other seeds, within a factor of two."""
    slopes = [measured(heap(35.0, noise=0.3, seed=seed)) for seed in range(30)]
    scatter = np.std([slope.angle_rad for slope in slopes])
    stated = np.mean([slope.uncertainty_rad for slope in slopes])
    assert scatter / 2.0 < stated < 2.0 * scatter


def test_the_stretch_lies_between_toe_and_crest():
    """The stretch used leaves out a tenth of the height at the toe, a twentieth at the crest, and both walls."""
    slope = measured(heap(35.0))
    column = 0.005  # m: both ends are rounded to whole ones, and the one next to a wall is left out before
    assert 0.05 * LENGTH <= slope.start_m <= 0.05 * LENGTH + 2 * column
    assert 0.90 * LENGTH - 2 * column <= slope.end_m <= 0.90 * LENGTH + column
    assert slope.curvature_rad == pytest.approx(0.0, abs=math.radians(1.5))  # halves of a plane, each with its scatter


def test_a_box_without_slope_is_refused():
    """Too few columns for a slope are refused with their number, not fitted."""
    with pytest.raises(FreeSurfaceError, match="columns of one particle diameter"):
        measured(heap(35.0, diameter=0.03), diameter=0.03)
