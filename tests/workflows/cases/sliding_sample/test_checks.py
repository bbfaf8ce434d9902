"""What is refused of a sliding sample before any solver starts."""

import re

import pytest

from bulkwear.workflows.cases.sliding_sample.checks import LEAST_WIDTH_EXTENTS
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.engine.grains import largest_extent
from tests.support.tiny import tiny_study

SMALL_SAMPLE = {"width_mm": 5, "element_size_mm": 1, "skirt_slope_deg": 20}
THIN_BED = {"allow_thin_bed": True}
WINDOW = {"ends": "window", "exchange_mm": 60, "ahead_mm": 60, "behind_mm": 60}
ROUNDED = 0.001  # mm, more than what a sentence leaves out of a length


def narrow(width_mm, **changes):
    """The tiny study with a small sample in a bed of that width."""
    return tiny_study(sample=SMALL_SAMPLE, bed={"width_mm": width_mm, **THIN_BED}, **changes)


def test_a_bed_narrower_than_two_particles_is_refused():
    """At two of the largest particles a grain hangs between a neighbour and its image; a little wider is a bed."""
    particle = tiny_study().runs[0].parameters["particle"]
    bound = 1e3 * LEAST_WIDTH_EXTENTS * largest_extent(particle)
    words = rf"bed\.width_mm is {bound:.10g} for row R9, allowed is above {bound:.6g} mm, two of the largest"
    with pytest.raises(ConfigError, match=words):
        narrow(bound)
    assert narrow(bound + ROUNDED).runs


def test_clumps_need_a_time_step_of_run_in():
    """They are set in motion in it; spheres, whose velocity is set, need none, and the step that is named is enough."""

    def clumps(run_in_mm):
        changes = {"fidelity": "quick", "rows": ["pair"], "packings": 1, "sliding": {"run_in_mm": run_in_mm}}
        return load_study("grain_shape", overrides=changes)

    assert tiny_study(sliding={"run_in_mm": 0}).runs[0].parameters["derived"]["run_in_steps"] == 0
    with pytest.raises(ConfigError, match=r"sliding\.run_in_mm is 0 .*allowed is at least (\S+) mm, one time") as fault:
        clumps(0)
    least = float(re.search(r"at least (\S+) mm", str(fault.value))[1])
    assert clumps(least).runs[0].parameters["derived"]["run_in_steps"] == 1


def test_a_patch_is_no_wider_than_the_sample():
    """Its radius is half of the shorter side at most; that of a patch of another kind counts for nothing."""

    def patched(radius_mm, patch="radius"):
        sides = {"width_mm": 40, "length_mm": 30}
        return tiny_study(sample=sides, wear={"patch": patch, "patch_radius_mm": radius_mm})

    words = r"wear\.patch_radius_mm is 15\.01 for row R9, allowed is at most 15 mm, half of the sample's shorter side: "
    with pytest.raises(ConfigError, match=words):
        patched(15.01)
    assert patched(15).runs
    assert patched(100, "simulated").runs


@pytest.mark.parametrize(
    ("changes", "block", "key", "bound"),
    [
        ({"sample": {"width_mm": 55, "skirt_slope_deg": 1.3}}, "sample", "width_mm", "at most"),
        ({"bed": {"ahead_mm": 2}, "sample": {"skirt_slope_deg": 1.3}}, "bed", "ahead_mm", "at least"),
        ({"sample": {"skirt_radius_mm": 10}}, "sample", "skirt_radius_mm", "at least"),
        ({"bed": {**WINDOW, "exchange_mm": 1}}, "bed", "exchange_mm", "at least"),
        ({"bed": {**WINDOW, "ahead_mm": 20}}, "bed", "ahead_mm", "at least"),
        ({"bed": {**WINDOW, "behind_mm": 30}}, "bed", "behind_mm", "at least"),
        ({"bed": {"ends": "periodic", "width_mm": 61}}, "bed", "ahead_mm", "at least"),
    ],
)
def test_a_length_that_a_refusal_names_is_enough(changes, block, key, bound):
    """Shown to six digits, half of them are rounded to the wrong side."""
    with pytest.raises(ConfigError, match=rf"{block}\.{key} is .*allowed is {bound} (\S+) ") as fault:
        tiny_study(**changes)
    enough = float(re.search(rf"allowed is {bound} (\S+) ", str(fault.value))[1])
    assert tiny_study(**changes | {block: {**changes[block], key: enough}}).runs
