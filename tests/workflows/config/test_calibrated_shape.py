"""Friction that was calibrated for clumps is that of clumps: another shape is refused; that of spheres is for all."""

import shutil

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from tests import REPOSITORY

CALIBRATED = (
    "    calibrated: {{study: calibration, rolling_radius: full, rolling_friction: cdt, particle_scale: 2, measured: a,"
    " intervals: b{}}}\n"
)
CONTACT = "    contact: {restitution: 0.45, sliding_friction: 0.21, rolling_friction: 0.40}\n"


def shape_of_bed(config, calibrated, shape):
    """Load a study of beds of a shape whose gravel was calibrated; the shape that its runs have."""
    config.edit("materials.yaml", CONTACT, CONTACT + CALIBRATED.format(calibrated))
    shutil.copytree(REPOSITORY / "config" / "clumps", config.path("clumps"))
    overrides = {"solver": {"rolling_friction": "cdt"}, "bed": {"shape": shape}}
    particle = load_study("small", config.project, overrides).runs[0].parameters["particle"]
    return particle.get("clump", {"name": "sphere"})["name"]


def test_another_shape_is_refused(config):
    """One sentence with the shape that it is for."""
    with pytest.raises(ConfigError) as caught:
        shape_of_bed(config, ", shape: pair", "sphere")
    assert str(caught.value) == (
        "command line: bed.shape is 'sphere', allowed is pair, for which river_gravel was calibrated, or another"
        " bed.material."
    )


@pytest.mark.parametrize(
    ("calibrated", "shape"), [(", shape: pair", "pair"), (", shape: sphere", "pair"), ("", "pair")]
)
def test_its_own_shape_is_taken(config, calibrated, shape):
    """And clumps may have the sliding friction of spheres, as in a study of shape."""
    assert shape_of_bed(config, calibrated, shape) == shape
