"""Wall friction from the log of a wall shear test."""

import math

import numpy as np
import pytest

from bulkwear.postproc.flow.wall_shear import WallShearError, wall_friction_angle
from bulkwear.postproc.readers.solver_log import SolverLogError

LOAD, FRICTION, NOISE = 14.0, 0.38, 0.2  # N, -, N
WITHIN = 3.0  # standard uncertainties: one seeded series may be that far off
DIGITS = 1e-6  # relative: of the log's numbers


def log(folder, shear, normal, columns="shear_n normal_n"):
    """The log of a drag whose plate is drawn along y: particles pull it back and press it down."""
    rows = [f"{10 * (i + 1)} 500 {-s:.8g} {-n:.8g}" for i, (s, n) in enumerate(zip(shear, normal, strict=True))]
    path = folder / "log.liggghts"
    head = ["Step Atoms ke other", "0 500 1 2", "Loop time of 1", f"Step Atoms {columns}", "0 500 0 0"]
    path.write_text("\n".join([*head, *rows, "Loop time of 2", ""]))
    return path


def test_angle_is_that_of_the_forces_once_the_bed_slides(tmp_path):
    """Shear over normal force of the second half is the friction; the rise before it does not count."""
    rise = np.minimum(np.linspace(0.0, 2.2, 200), 1.0)
    angle, uncertainty = wall_friction_angle(log(tmp_path, FRICTION * LOAD * rise, np.full(200, LOAD)))
    assert angle == pytest.approx(math.atan(FRICTION), rel=DIGITS)
    assert uncertainty == pytest.approx(0.0, abs=DIGITS)


def test_uncertainty_is_that_of_the_fluctuation(tmp_path):
    """Independent noise on the shear force makes the uncertainty that of its mean."""
    noise = NOISE * np.random.default_rng(5).standard_normal(400)
    angle, uncertainty = wall_friction_angle(log(tmp_path, FRICTION * LOAD + noise, np.full(400, LOAD)))
    expected = NOISE / LOAD / math.sqrt(200) / (1.0 + FRICTION**2)
    assert 0.5 * expected < uncertainty < 3.0 * expected  # of ten blocks, whose correlation is found too
    assert abs(angle - math.atan(FRICTION)) < WITHIN * expected


@pytest.mark.parametrize(
    ("shear", "normal", "columns", "words"),
    [
        ([1.0] * 39, [2.0] * 39, "shear_n normal_n", "39 forces on the plate, allowed are 40"),
        ([0.0] * 50, [0.0] * 50, "shear_n normal_n", "no normal force on the plate"),
    ],
)
def test_a_log_without_wall_friction_is_refused(tmp_path, shear, normal, columns, words):
    """A fault names the log, what it lacks and what is allowed."""
    with pytest.raises(WallShearError, match=f"log.liggghts: {words}"):
        wall_friction_angle(log(tmp_path, shear, normal, columns))


def test_a_log_without_the_forces_of_the_plate_is_refused(tmp_path):
    """A deck of one's own that does not print a force is told which, and that it has to."""
    with pytest.raises(SolverLogError, match=r"log\.liggghts: found no column shear_n.*thermo_style has v_shear_n"):
        wall_friction_angle(log(tmp_path, [1.0] * 50, [2.0] * 50, "other normal_n"))
