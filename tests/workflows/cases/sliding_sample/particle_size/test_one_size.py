"""The study of one size under rvd is the study of particle sizes but for these two, and its gravel the source's."""

import yaml

from tests import REPOSITORY

ITS_OWN = {"bed": "material", "solver": "rolling_friction"}  # settings that particle_size does not give


def read(name):
    return yaml.safe_load((REPOSITORY / "config" / name).read_text(encoding="utf-8"))


def test_it_differs_in_sizes_and_rolling_model_alone():
    one, usual = (read(f"studies/particle_size{name}.yaml") for name in ("_one_size", ""))
    told = {section: one[section].pop(key) for section, key in ITS_OWN.items()}
    assert told == {"bed": "river_gravel_one_size", "solver": "rvd"}
    assert all(one.pop(key) != usual.pop(key) for key in ("title", "question"))
    assert one == usual


def test_its_gravel_is_the_sources_but_for_the_sizes():
    particles = read("materials.yaml")["particles"]
    one, published = particles["river_gravel_one_size"], particles["river_gravel_published"]
    assert one.pop("size_distribution") == {"relative_diameter": [1.0], "mass_fraction": [1.0]}
    assert len(published.pop("size_distribution")["mass_fraction"]) > 1
    assert one == published
