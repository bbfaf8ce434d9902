"""Containers of packings that hold no slabs, come to no rest or are shaken by nothing a person means are refused."""

import pytest

from bulkwear.workflows.config.design import ConfigError, load_study

REFUSED = [
    ({"fill_height_mm": 5}, "packing.fill_height_mm is 5", "at least 190.8 mm, 12 median diameters (particle_scale 6)"),
    ({"rest_check_interval_s": 1, "rest_longest_s": 0.1}, "packing.rest_longest_s is 0.1", "at least 5.3 s: a fall"),
    ({"shaking_s": 1e-6}, "packing.shaking_s is 1e-06", "at least 0.0314 s, a swing at packing.frequency_deg_per_s"),
    (
        {"frequency_deg_per_s": 1e6, "amplitude_diameters": 1},
        "packing.frequency_deg_per_s is",
        "a swing of 15.9 mm then takes 20 time steps or more, and its walls pass through no particle in one",
    ),
]


@pytest.mark.parametrize(("changes", "found", "allowed"), REFUSED)
def test_containers_that_tell_nothing(changes, found, allowed):
    """With the key, and the least or the most of it."""
    with pytest.raises(ConfigError) as caught:
        load_study("particle_size", overrides={"rows": ["S6"], "packing": changes})
    assert found in str(caught.value) and allowed in str(caught.value)


def test_a_container_may_stand_still():
    """Without an amplitude frequency and time are those of nothing."""
    still = {"amplitude_diameters": 0, "shaking_s": 1e-6}
    assert load_study("particle_size", overrides={"rows": ["S6"], "packing": still}).runs
