"""The study of one size under rvd is the study of particle sizes but for these two, and its gravel the source's."""

import yaml

from tests import REPOSITORY


def read(name):
    return yaml.safe_load((REPOSITORY / "config" / name).read_text(encoding="utf-8"))


def test_it_differs_in_sizes_and_rolling_model_alone():
    one = read("studies/particle_size_one_size.yaml")
    assert one.pop("title") and one.pop("question")
    assert one == {
        "extends": "particle_size",
        "bed": {"material": "river_gravel_one_size"},
        "solver": {"rolling_friction": "rvd"},
    }


def test_its_gravel_is_the_sources_but_for_the_sizes():
    particles = read("materials.yaml")["particles"]
    one, published = particles["river_gravel_one_size"], particles["river_gravel_published"]
    assert one.pop("size_distribution") == {"relative_diameter": [1.0], "mass_fraction": [1.0]}
    assert len(published.pop("size_distribution")["mass_fraction"]) > 1
    assert one == published
