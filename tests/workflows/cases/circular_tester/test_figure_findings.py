"""Sentences on the figures of the circular wear tester say what their tables say."""

import pandas as pd
import pytest

from bulkwear.workflows.cases.circular_tester import figure_findings as findings

NAN = float("nan")
ONE = {"packings": 1, "interval_low": NAN, "interval_high": NAN}
SETTING = {"surface": ["plain", "convex"], "shape": "channel", "particle_scale": 6.0}


def test_reductions_stand_beside_measured_ones():
    """A pattern that wears more is told so; hours without a prediction are left out."""
    rows = {"quantity": "reduction", "hours": [56.0, 184.0], "ours": [49.2, NAN], "experiment": [42.9, 49.0]}
    table = pd.DataFrame(rows | ONE)
    said = "The pattern wears 49 % less after 56 h (one packing, scatter unknown; measured 43 %)."
    assert findings.reduction(table) == said
    several = table.assign(ours=-10.0, experiment=NAN, interval_low=-20.0, interval_high=0.4).head(1)
    assert findings.reduction(several) == "The pattern wears 10 % more after 56 h (one further packing: -20 to 0 %)."
    assert findings.reduction(table.tail(1)) == ""


def test_volumes_are_those_of_the_last_revolution():
    """Scales are named where there are several."""
    table = pd.DataFrame(SETTING | {"revolution": 4.0, "volume_mm3": [96.0, 48.0]})
    table = pd.concat([table.assign(revolution=1.0, volume_mm3=20.0), table], ignore_index=True)
    assert findings.lost(table) == "Lost are by plain 96 mm³ in 4 revolutions and convex 48 mm³ in 4 revolutions."
    other = pd.concat([table, table.assign(particle_scale=4.0)])
    assert "plain (scale 6) 96 mm³" in findings.lost(other) and "convex (scale 4)" in findings.lost(other)


def test_increments_of_first_and_last_revolution():
    """One revolution has one increment."""
    table = pd.DataFrame(SETTING | {"revolution": 0.0, "increment_mm3": [24.0, 12.0]})
    assert findings.increments(table) == "A revolution takes off plain 24 mm³; convex 12 mm³."
    longer = pd.concat([table, table.assign(revolution=1.0, increment_mm3=12.34)])
    assert "plain 24 mm³ in its first and 12.3 mm³ in its last" in findings.increments(longer)


def test_reductions_by_particle_scale():
    """Of the short test; without a plain twin nothing is told."""
    table = pd.DataFrame(SETTING | {"hours": 56.0, "reduction_percent": [0.0, 49.0]})
    long = table.assign(hours=184.0, reduction_percent=70.0)
    said = "After 56 h the pattern has lowered the wear by 49 % at scale 6."
    assert findings.reduction_by_scale(pd.concat([long, table])) == said
    assert findings.reduction_by_scale(table.assign(reduction_percent=NAN)) == ""


def test_columns_and_the_share_of_the_pattern():
    """Most of each surface, and how much the pattern bears; of plain samples alone there is no share."""
    columns = {"surface": ["convex", "convex", "plain"], "column": [1, 2, 1], "base_mm3": [1.0, 2.0, 4.0]}
    table = pd.DataFrame(columns | {"bumps_mm3": [6.0, 3.0, 0.0], "total_mm3": [7.0, 5.0, 4.0]})
    said = "ost is on column 1 of the convex sample (7 mm³) and column 1 of the plain sample (4 mm³)."
    assert findings.wear_by_column(table) == f"The pattern bears 75 % of its sample's wear; m{said}"
    assert findings.wear_by_column(table.tail(1)) == "Most is on column 1 of the plain sample (4 mm³)."


@pytest.mark.parametrize(("reach", "sure"), [(0.1, True), (0.6, False)])
def test_the_most_worn_shape_may_not_be_told(reach, sure):
    """Where intervals overlap the next one is named; one packing tells numbers alone, one shape is itself."""
    volumes = pd.Series([1.0, 3.0, 2.0])
    table = pd.DataFrame({"bump": ["C11", "C12", "C13"], "volume_mm3": volumes, "packings": 3})
    several = table.assign(interval_low=volumes - reach, interval_high=volumes + reach)
    said = findings.most_worn(several)
    assert said.startswith("Of 3 shapes C12 loses most, 3 mm³ (95 %") and "1.5 times their mean" in said
    assert ("; C13, the next one, may lose as much" in said) != sure
    assert "may" not in findings.most_worn(table.assign(**ONE))
    assert findings.most_worn(table.assign(**ONE).head(1)) == "C11 loses 1 mm³ (one packing, scatter unknown)."


def test_crests_of_sections():
    """How far they are lowered, and how far meshes differ; one mesh has nothing to differ from."""
    heights = {"pristine": [0.0, 5.0], "1": [0.0, 4.9], "2": [0.0, 4.75]}
    table = pd.concat(
        [pd.DataFrame({"bump": "C11", "name": name, "height_mm": each}) for name, each in heights.items()]
    )
    assert findings.lowered_crests(table) == "After 2 revolutions the crests are lowered: C11 by 250 µm."
    assert findings.crests_by_mesh(table) == "The crest of C11 differs by 150 µm between the meshes."
    assert findings.crests_by_mesh(table[table["name"] != "2"]) == ""


def test_elements_and_machines():
    """Change from the finest to the coarsest mesh; ratios by machine over the revolutions that both have."""
    table = {"surface": ["plain", "convex"] * 2, "element_size_mm": [1.0, 1.0, 2.0, 2.0]}
    effect = pd.DataFrame(table | {"relative_percent": [100.0, 50.0, 98.0, 51.0]})
    said = "From elements of 1 to 2 mm volumes change: plain -2.0 % and convex +2.0 %."
    assert findings.change_by_mesh(effect) == said
    assert findings.change_by_mesh(effect.head(2)) == ""
    means = pd.DataFrame({"shape": ["channel", "ring"], "particle_scale": 6.0, "revolutions": 1, "ratio": [0.5, 0.52]})
    means = means.assign(ratio_low=NAN, ratio_high=NAN, packings=1)
    assert findings.by_machine(means) == (
        "Patterned over plain wear is 0.5 (one packing, scatter unknown) in the channel and 0.52 (one packing, scatter"
        " unknown) in the ring, over 1 revolution."
    )


def test_steadiness_is_that_of_the_last_revolution():
    """By measure, over both samples."""
    table = {"surface": ["plain", "convex", "plain"], "measure": "velocity_m_per_s", "revolution": [2, 2, 1]}
    said = findings.variations(pd.DataFrame(table | {"variation": [0.05, 0.06, 0.5]}))
    assert said == "Within the last revolution these vary: velocity by 5 to 6 %."


def test_the_lowest_layer_over_both_samples():
    """Means of all revolutions in the unit of the figure; with one sample there is no ratio."""
    table = pd.DataFrame({"surface": ["plain", "convex", "plain"], "measure": "bottom_velocity_m_per_s"})
    table = table.assign(mean=[0.4, 0.25, 0.6])
    assert findings.velocity(table) == (
        "Over the pattern the lowest layer passes 0.5 times as fast as over the plain sample (250 mm/s against 500"
        " mm/s, mean of the revolutions)."
    )
    assert findings.velocity(table[table["surface"] == "plain"]) == ""
    assert findings.force(table) == ""
    particles = pd.DataFrame({"surface": ["plain", "convex"], "relative_speed": [1.0, 0.4]})
    assert "pass 0.4 times as fast" in findings.passing(particles)
    assert findings.passing(particles.head(1)) == ""


def test_patterns_that_are_worn_off():
    """One that is gone, and one that stays."""
    left = pd.DataFrame({"run": ["a", "b"], "revolution": 900.0, "pattern_share": [0.01, 0.99], "lost_mm3": 1.0})
    left = left.assign(mean_per_revolution_mm3=[2.0, 0.5], plain_per_revolution_mm3=1.0)
    assert findings.worn_off(left) == (
        "The pattern of a is gone after 900 revolutions and wears faster than plain from 900 on; the pattern of b keeps"
        " 99 % in the end."
    )


def test_published_numbers_that_settings_reach():
    """All settings that reach most are named where that is more than the reference does."""
    table = pd.DataFrame({"pair": ["reference"] * 2 + ["deep"] * 2 + ["thin"] * 2, "key": ["a", "b"] * 3})
    table = table.assign(reached=[True, False, True, True, True, True])
    said = "The reference reaches 1 of 2 published numbers"
    assert findings.reached(table) == f"{said}; deep and thin reach 2, the most."
    assert findings.reached(table.head(4)) == f"{said}; deep reaches 2, the most."
    assert findings.reached(table.assign(reached=[True, False] * 3)) == f"{said}, no setting more."
    assert findings.reached(table.head(2)) == f"{said}."
