"""Sentences on the figures of particle size say what their tables say."""

import pandas as pd

from bulkwear.workflows.cases.sliding_sample.particle_size import figure_findings as findings

NAN = float("nan")
SCALES = {"particle_scale": [2.0, 8.0]}
ONE = "(one packing, scatter unknown)"


def test_ratios_at_the_ends_of_the_scales():
    """Patterned over plain of the same bed; one scale is told once, none says nothing."""
    wear = [
        {"row": f"S{scale:g}", "particle_scale": scale, "curve": "plain", "relative_wear": 1.0} for scale in (2.0, 8.0)
    ]
    wear += [each | {"curve": "convex", "relative_wear": value} for each, value in zip(wear, (0.7, 1.2), strict=True)]
    table = pd.DataFrame(wear)
    said = f"The patterned sample wears over the plain one 0.7 {ONE} at scale 2"
    assert findings.ratios_by_scale(table) == f"{said} and 1.2 {ONE} at scale 8."
    assert findings.ratios_by_scale(table[table["particle_scale"] == 2.0]) == f"{said}."
    ratios = pd.DataFrame(SCALES | {"wear_over_plain": [0.7, 1.2], "packings": 1, "equivalent_radius": [0.5, 2.0]})
    ratios = ratios.assign(interval_low=NAN, interval_high=NAN)
    assert findings.ratios_by_size(ratios).endswith("at scale 8, where particles are 0.5 to 2 times as large as bumps.")
    assert findings.ratios_by_size(ratios.head(0)) == ""


def test_steady_windows_are_counted():
    """Means of the smallest and the largest scale; a measure without values is left out."""
    rows = {"measure": "relative_velocity", "surface": "convex", "mean_percent": [30.0, 60.0], "steady": [True, False]}
    table = pd.DataFrame(SCALES | rows)
    said = "1 of 2 windows are steady; relative velocity (convex) 30 % at scale 2 and 60 % at scale 8."
    assert findings.steady_ends(table) == said
    empty = table.assign(measure="relative_wear_rate", mean_percent=NAN)
    assert findings.steady_ends(pd.concat([table, empty])) == said.replace("1 of 2", "2 of 4")


def test_layers_over_the_scales():
    """The largest size of each scale whatever its sign, or the lowest layer's; nothing without values."""
    rows = {"surface": "convex", "particle_scale": [2.0, 2.0, 8.0], "layer": [1, 2, 1]}
    table = pd.DataFrame(rows | {"velocity_m_per_s": [0.1, 9.0, 0.2], "upward_m_per_s": [0.01, -0.03, 0.02]})
    end = "(convex) at particle scales 2 to 8."
    assert findings.velocity(table) == f"With the sample the lowest layer moves at 0.1 to 0.2 m/s {end}"
    assert findings.upward(table) == f"Upwards or downwards layers move at most at 0.02 to 0.03 m/s {end}"
    assert findings.upward(table.assign(upward_m_per_s=NAN)) == ""


def test_spin_in_front_and_at_the_back():
    """Halves of the sample, by surface."""
    rows = {"run": "a", "surface": "convex", "along_mm": [10.0, 20.0, 30.0, 40.0]}
    table = pd.DataFrame(rows | {"averaged_angular_velocity_deg_per_s": [400.0, 200.0, 100.0, 100.0]})
    said = "The lowest layer turns with 300 °/s in front and 100 °/s at the back (convex), mean over the scales."
    assert findings.spin_along(table) == said
    assert findings.spin_along(table.assign(averaged_angular_velocity_deg_per_s=NAN)) == ""


def test_packings_without_their_first_and_last_slab():
    """Of containers by slabs, of beds as they are; differences are not told."""
    slabs = {
        "particle_scale": 2.0,
        "layer": [1, 2, 3],
        "coordination_number": [0.0, 6.0, 0.0],
        "porosity": [0.9, 0.4, 0.9],
        "porosity_whole_particles": [0.9, 0.4, 0.9],
        "particles": 10,
    }
    higher = {"particle_scale": 1.0, "layer": [1, 2, 3, 4], "coordination_number": [0.0, 6.0, 6.0, 0.0]}
    higher |= {"porosity": [0.9, 0.4, 0.4, 0.9], "porosity_whole_particles": 0.4, "particles": 10}
    table = pd.concat([pd.DataFrame(higher), pd.DataFrame(slabs)]).assign(state="loose")
    said = "Over the particle scales particles have filled 6 contacts and a porosity of 0.4"
    assert findings.packing(pd.concat([table, table.assign(state="difference")])) == f"{said}."
    beds = pd.DataFrame(SCALES | {"state": ["before", "after"], "coordination_number": [4.0, 5.0], "porosity": 0.45})
    assert findings.packing(beds).endswith(
        "before the sample 4 contacts and a porosity of 0.45; behind it 5 contacts and a porosity of 0.45."
    )
    assert findings.packing(table.assign(state="difference")) == ""


def test_collisions_by_scale():
    """The widest difference of a peak between scales, over the larger one; that of rounding is called less than it."""
    one = {"collision": "pair", "rolling_friction": "cdt", "overlap": [0.5, -1.0], "normal_force": [0.0, 2.0]}
    one |= {"tangential_force": 0.0, "spin": 0.0}
    both = [pd.DataFrame(one).assign(particle_scale=scale) for scale in (1.0, 4.0)]
    told = "Largest overlap, forces and spin at scale 1 to 4 differ by"
    assert findings.collisions(pd.concat(both)) == f"{told} less than 0.001 %."
    assert findings.collisions(pd.concat([both[0], both[1].assign(normal_force=[0.0, 1.9])])) == f"{told} 5 % at most."
