"""What the source tells of particle size beside made-up studies: who agrees is known."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.lines import Crossing
from bulkwear.workflows.cases.sliding_sample.particle_size.published_sizes import (
    AGREES,
    DIFFERS,
    UNSAID,
    beside_the_source,
    critical_sentences,
    packing_beside_the_source,
    steady_by_scale,
    verdict,
)
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import (
    over_the_sample,
    read_critical_scale,
    smallest_and_largest,
    velocity_bounds,
    wear_by_scale,
)
from tests import PUBLISHED
from tests.workflows.cases.sliding_sample.particle_size.test_wear_by_scale import summary

RESULTS, PACKING = (pd.read_csv(PUBLISHED / f"{name}.csv") for name in ("particle_size_results", "packing"))
SCALES = {"S4_convex": 4.0, "S4_plain": 4.0, "S5_convex": 5.0, "S5_plain": 5.0}
CRITICAL = Crossing(4.2, 3.1, 5.2, True)
RATIO = 0.289  # -, alpha_ER of the source's particles over its bumps


def steady_rows():
    """Relative velocity 12 % over plain samples and 45 % over convex ones, both with little deviation."""
    rows = []
    for run in SCALES:
        row, surface = run.split("_")
        names = {"run": run, "row": row, "surface": surface, "start_mm": 100.0, "end_mm": 700.0, "drift": 0.01}
        mean = 12.0 if surface == "plain" else 45.0
        rows.append({**names, "measure": "relative_velocity_percent", "mean": mean, "deviation": 0.5, "steady": True})
        rows.append({**names, "measure": "relative_gradient", "mean": 0.5, "deviation": 0.02, "steady": False})
    return steady_by_scale(pd.DataFrame(rows), SCALES)


def profiles():
    """Layers over samples: slow over the plain one; the lowest over the convex one at 1 m/s, the next at 0.2 m/s."""
    layers = {"convex": (1.0, 0.2), "plain": (0.3, 0.1)}
    rows = [
        {
            "run": run,
            "row": run[:2],
            "surface": run[3:],
            "zone": zone,
            "height_mm": (10.0, 30.0)[k],
            "velocity_m_per_s": layers[run[3:]][k],
            "upward_ratio": 0.1,
            "sideways_ratio": -0.5,
        }
        for run in SCALES
        for k in range(2)
        for zone in ("central", "side")
    ]
    return over_the_sample(pd.DataFrame(rows), SCALES)


def test_wear_rates_are_told_in_percent():
    """Both measures have one unit, and each run its scale."""
    table = steady_rows().set_index(["run", "measure"])
    assert table.loc[("S5_plain", "relative_wear_rate"), "mean_percent"] == pytest.approx(50.0)
    assert table.loc[("S5_plain", "relative_velocity"), "deviation_percent"] == pytest.approx(0.5)
    assert table.loc[("S4_convex", "relative_velocity"), "particle_scale"] == 4.0


def test_layers_have_components_of_their_velocity():
    """Ratios times the velocity with the sample; what is beside the sample is left out."""
    table = profiles()
    assert len(table) == 2 * len(SCALES)
    np.testing.assert_allclose(table["upward_m_per_s"], 0.1 * table["velocity_m_per_s"])
    np.testing.assert_allclose(table["sideways_m_per_s"], -0.5 * table["velocity_m_per_s"])


def test_bounds_of_velocity_reach_as_far_as_they_hold():
    """The plain sample's over all layers, the convex one's over the lowest."""
    bounds = velocity_bounds(RESULTS, profiles()).set_index("surface")
    assert bounds.loc["plain", "place_to"] == 30.0 and bounds.loc["plain", "value"] == 0.35
    assert bounds.loc["convex", "place_to"] == 10.0 and bounds.loc["convex", "relation"] == "above"


def test_numbers_of_the_source_get_a_verdict():
    """What keeps its bounds agrees, what does not differs, and of scales that were not simulated nothing is said."""
    table = beside_the_source(RESULTS, steady_rows(), profiles(), CRITICAL, RATIO)
    assert len(table) == (RESULTS["quantity"] != "steady").sum()
    found = table.set_index(["quantity", "surface", "scales", "relation"])["verdict"]
    assert found["critical_scale", "convex", "4", "about"] == AGREES
    assert found["critical_size_ratio", "convex", "1 to 8", "about"] == AGREES
    assert found["relative_velocity", "plain", "1 to 8", "above"] == AGREES
    assert found["relative_velocity", "convex", "5", "about"] == AGREES
    assert found["relative_velocity", "convex", "1", "about"] == UNSAID
    assert found["relative_wear_rate_deviation", "plain", "1 to 8", "below"] == DIFFERS  # 2 % here
    assert found["velocity_every_layer", "plain", "1 to 8", "below"] == AGREES
    assert found["velocity_lowest_layer", "convex", "1 to 8", "above"] == AGREES
    ours = table[table["quantity"] == "critical_size_ratio"].iloc[0]
    assert ours["low"] == pytest.approx(RATIO * 3.1) and ours["high"] == pytest.approx(RATIO * 5.2)
    faster = profiles().assign(velocity_m_per_s=0.5)
    found = beside_the_source(RESULTS, steady_rows(), faster, None, RATIO).set_index("quantity")["verdict"]
    assert found["critical_scale"] == UNSAID
    assert found["velocity_every_layer"] == DIFFERS and found["velocity_lowest_layer"] == DIFFERS


@pytest.mark.parametrize(
    ("relation", "low", "high", "told"),
    [
        ("about", 9.0, 9.5, AGREES),
        ("about", 12.0, 13.0, DIFFERS),
        ("about", 3.0, np.inf, AGREES),
        ("above", 10.0, 12.0, AGREES),
        ("above", 9.9, 12.0, DIFFERS),
        ("below", 2.0, 10.1, DIFFERS),
        ("below", np.nan, np.nan, UNSAID),
    ],
)
def test_verdicts(relation, low, high, told):
    """Against a published 10."""
    assert verdict(relation, 10.0, low, high) == told


def test_packings_count_without_their_lowest_and_highest_slab():
    """Slabs at floor and surface are far off and do not count; the change is that of the means."""
    rows = []
    for state, contacts in (("loose", 5.2), ("dense", 5.4), ("difference", 99.0)):
        for layer in (1, 2, 3):
            value = contacts if layer == 2 else 1.0
            porosity = {"loose": 0.42, "dense": 0.40}.get(state, 9.0)
            one = {"state": state, "particle_scale": 4.0, "layer": layer, "particles": 100}
            rows.append(
                one | {"coordination_number": value, "porosity": porosity, "porosity_whole_particles": porosity}
            )
    measures = {"coordination_number": 4.7, "porosity": 0.43, "porosity_whole_particles": 0.43}
    bed = pd.DataFrame([{"state": "before", "particle_scale": 4.0, **measures}])
    table = packing_beside_the_source(PACKING, pd.DataFrame(rows), bed)
    found = table.set_index(["quantity", "surface", "relation"])
    assert (found.loc[["coordination_number"]].loc[(slice(None), "container, loose"), "verdict"] == AGREES).all()
    change = found.loc[("coordination_number", "container, difference", "above")]
    assert change["low"] == pytest.approx(0.2) and change["verdict"] == AGREES
    assert found.loc[("porosity", "container, difference", "above"), "verdict"] == AGREES
    assert found.loc[("coordination_number", "bed, before", "above"), "verdict"] == DIFFERS
    assert found.loc[("coordination_number", "bed, before", "below"), "verdict"] == UNSAID  # of scales 6 to 8


def test_the_critical_scale_is_told_beside_the_sources():
    """In words: which rows wear less, the interval, whether the source's is inside, and reasons where it is not."""
    wear = wear_by_scale(summary([2.0, 3.0, 4.0, 6.0, 8.0]))
    said = " ".join(critical_sentences(CRITICAL, 4.0, wear, 0))
    assert "wears less than the plain one in S2, S3, S4, and not less in S6, S8" in said
    assert "4.2 (95 % interval 3.1 to 5.2), which holds the source's of about 4" in said
    assert "differs" not in said and "not steady" not in said
    said = " ".join(critical_sentences(Crossing(9.0, 8.5, 12.0, True), 4.0, wear, 3))
    assert "does not hold" in said and "What differs from the source" in said
    assert "outside the scales simulated (2 to 8)" in said and "In 3 of the windows" in said
    assert "5 rows do not bound a critical scale" in " ".join(critical_sentences(None, 4.0, wear, 0))
    said = " ".join(critical_sentences(Crossing(5.0, -np.inf, np.inf, False), 4.0, wear, 0))
    assert "5 rows, whose straight lines cross at 5, do not bound a critical scale" in said


def test_the_critical_scale_is_read_back(tmp_path):
    """As it was written, open ends included; an empty table is none."""
    path = tmp_path / "critical_scale.csv"
    pd.DataFrame([vars(Crossing(4.0, -np.inf, 5.0, True))]).to_csv(path, index=False)
    assert read_critical_scale(path) == Crossing(4.0, -np.inf, 5.0, True)
    pd.DataFrame([], columns=["value", "low", "high", "bounded"]).to_csv(path, index=False)
    assert read_critical_scale(path) is None


def test_maps_show_the_smallest_and_the_largest_particles():
    """Both surfaces of two rows, the smallest first, whatever the order of the table."""
    table = summary([8.0, 2.0, 4.0])
    runs = smallest_and_largest(table.assign(run=table["row"] + "_" + table["surface"]))
    assert runs["row"].tolist() == ["S2", "S2", "S8", "S8"] and set(runs["surface"]) == {"convex", "plain"}
