"""What the source tells of particle size beside made-up studies: who agrees is known."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.crossing import Crossing
from bulkwear.postproc.statistics.intervals import Ends
from bulkwear.postproc.statistics.verdicts import AGREES, CONTRADICTS, OTHER_SIZE, UNSAID
from bulkwear.workflows.cases.sliding_sample.particle_size import figures
from bulkwear.workflows.cases.sliding_sample.particle_size.published_sizes import (
    _words,
    beside_the_source,
    critical_sentences,
    packing_beside_the_source,
    steady_by_scale,
)
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import (
    over_the_sample,
    ratio_by_scale,
    read_critical_scale,
    smallest_and_largest,
    velocity_bounds,
    wear_by_scale,
)
from tests import PUBLISHED
from tests.support.charts import drawn_chart, values
from tests.workflows.cases.sliding_sample.particle_size.test_wear_by_scale import summary

RESULTS, PACKING = (pd.read_csv(PUBLISHED / f"{name}.csv") for name in ("particle_size_results", "packing"))
PACKINGS = ("", "-2", "-3")
SCALES = {
    f"S{scale:g}{packing}_{of}": scale for scale in (4.0, 5.0) for packing in PACKINGS for of in ("convex", "plain")
}
SCATTER = {"": 1.0, "-2": 1.01, "-3": 0.99}  # -, of packings
CRITICAL = Crossing(4.0, 3.5, 4.5, 3.0, 5.0, 4, 6, 3)
RATIO = 0.289  # -, alpha_ER of the source's particles over its bumps


def steady_rows():
    """Relative velocity 12 % over plain samples and 45 % over convex ones, both with little deviation."""
    rows = []
    for run in SCALES:
        row, surface = run.split("_")
        names = {"run": run, "row": row, "surface": surface, "start_mm": 100.0, "end_mm": 700.0, "drift": 0.01}
        mean = (12.0 if surface == "plain" else 45.0) * SCATTER[row[2:]]
        rows.append({**names, "measure": "relative_velocity_percent", "mean": mean, "deviation": 0.5, "steady": True})
        rows.append({**names, "measure": "relative_gradient", "mean": 0.5, "deviation": 0.02, "steady": False})
    return steady_by_scale(pd.DataFrame(rows), SCALES)


def profiles():
    """Layers over samples: slow over the plain one; the lowest over the convex one at 1 m/s, the next at 0.2 m/s."""
    layers = {"convex": (1.0, 0.2), "plain": (0.3, 0.1)}
    rows = [
        {
            "run": run,
            "row": run.split("_")[0],
            "surface": run.split("_")[1],
            "zone": zone,
            "height_mm": (10.0, 30.0)[k],
            "velocity_m_per_s": layers[run.split("_")[1]][k] * SCATTER[run.split("_")[0][2:]],
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
    """What keeps its bounds at all scales agrees, what does not at one of them differs, and where the scales simulated
    do not reach as far as what is claimed it is said."""
    table = beside_the_source(RESULTS, steady_rows(), profiles(), CRITICAL, RATIO)
    assert len(table) == (RESULTS["quantity"] != "steady").sum()
    found = table.set_index(["quantity", "surface", "scales", "relation"])["verdict"]
    assert found["critical_scale", "convex", "4", "about"] == AGREES
    assert found["critical_size_ratio", "convex", "1 to 8", "about"] == UNSAID  # 1.01 to 1.30, margin 0.85 to 1.15
    assert found["relative_velocity", "plain", "1 to 8", "above"] == UNSAID
    assert found["relative_velocity", "convex", "5", "about"] == AGREES
    assert found["relative_velocity", "convex", "1", "about"] == UNSAID
    assert found["relative_wear_rate_deviation", "plain", "1 to 8", "below"] == CONTRADICTS  # 2 % here
    reasons = table.set_index(["quantity", "surface", "scales", "relation"])["reason"]
    said = reasons["relative_velocity", "plain", "1 to 8", "above"]
    assert said == "claimed of 1 to 8 times the particles, the runs cover 4 to 5"
    simulated = RESULTS.assign(
        scale_from=RESULTS["scale_from"].replace(1, 4), scale_to=RESULTS["scale_to"].replace(8, 5)
    )
    table = beside_the_source(simulated, steady_rows(), profiles(), CRITICAL, RATIO)
    found = table.set_index(["quantity", "surface", "scales", "relation"])["verdict"]
    assert found["relative_velocity", "plain", "4 to 5", "above"] == AGREES
    assert found["velocity_every_layer", "plain", "4 to 5", "below"] == AGREES
    assert found["velocity_lowest_layer", "convex", "4 to 5", "above"] == AGREES
    faster = profiles().assign(velocity_m_per_s=0.5 + 0.01 * profiles()["velocity_m_per_s"])
    far = replace(CRITICAL, value=9.0, low=8.5, high=9.5)
    found = beside_the_source(RESULTS, steady_rows(), faster, far, RATIO).set_index("quantity")
    assert found.loc["critical_scale", "verdict"] == OTHER_SIZE
    assert found.loc["critical_scale", "factor"] == pytest.approx(9.0 / 4.0)
    assert found.loc["velocity_every_layer", "verdict"] == CONTRADICTS
    assert found.loc["velocity_lowest_layer", "verdict"] == CONTRADICTS


def test_one_packing_says_nothing():
    """Without a second packing no number of the source gets a verdict, whatever the values."""
    first = [run for run in SCALES if "-" not in run]
    steady, layers = (table[table["run"].isin(first)] for table in (steady_rows(), profiles()))
    table = beside_the_source(RESULTS, steady, layers, replace(CRITICAL, low=np.nan, high=np.nan, packings=1), RATIO)
    assert (table["verdict"] == UNSAID).all()
    assert "one packing, scatter unknown" in set(table["reason"])


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
    measures = {"porosity": 0.43, "porosity_whole_particles": 0.43}
    contacts = (4.6, 4.7, 4.8)  # of three packings
    told = {"state": "before", "particle_scale": 4.0, **measures}
    bed = pd.DataFrame([{**told, "coordination_number": count} for count in contacts])
    table = packing_beside_the_source(PACKING, pd.DataFrame(rows), bed)
    found = table.set_index(["quantity", "surface", "relation"])
    loose = found.loc[["coordination_number"]].loc[(slice(None), "container, loose"), :]
    assert loose["found"].str.startswith("scale 4: 5.20").all() and (loose["verdict"] == UNSAID).all()  # one container
    assert found.loc[("coordination_number", "container, difference", "above"), "found"].startswith("scale 4: 0.200")
    assert found.loc[("coordination_number", "bed, before", "above"), "verdict"] == CONTRADICTS
    assert found.loc[("coordination_number", "bed, before", "below"), "verdict"] == UNSAID  # of scales 6 to 8


def test_the_critical_scale_is_told_beside_the_sources():
    """In words: at which scales the pattern wears less, the interval, and reasons where the source's is outside."""
    ratios = ratio_by_scale(wear_by_scale(summary([2.0, 3.0, 4.0, 6.0, 8.0], noise=0.01, packings=3)))
    said = " ".join(critical_sentences(CRITICAL, 4.0, ratios, "convex"))
    assert "wears less than the plain one at scale 2, 3, 4, more at scale 6, 8" in said
    assert "Critical scale 4, 95 % interval over 4 forms 3.5 to 4.5; the source's is about 4" in said
    assert "between the scales 3 and 5" in said and "differs" not in said
    said = " ".join(critical_sentences(replace(CRITICAL, value=9.0, low=8.5, high=np.inf), 4.0, ratios, "convex"))
    assert "8.5 to beyond the scales simulated" in said and "What differs from the source" in said
    assert "how bumps are turned, which" in said and "staggered" not in said  # that is decided: docs/decisions.md
    none = Crossing(np.nan, np.nan, np.nan, np.nan, np.nan, 0, 6, 3, "no form tried describes the wear")
    assert "no form tried describes the wear" in " ".join(critical_sentences(none, 4.0, ratios, "convex"))


def test_the_critical_scale_is_read_back(tmp_path):
    """As it was written, open ends and reasons included."""
    for number, found in enumerate((replace(CRITICAL, low=-np.inf), replace(CRITICAL, reason="none between"))):
        path = tmp_path / f"{number}.csv"
        pd.DataFrame([vars(found)]).to_csv(path, index=False)
        assert read_critical_scale(path) == found


def test_maps_show_the_smallest_and_the_largest_particles():
    """Both surfaces of two rows, the smallest first, whatever the order of the table."""
    table = summary([8.0, 2.0, 4.0])
    runs = smallest_and_largest(table.assign(run=table["row"] + "_" + table["surface"]))
    assert runs["row"].tolist() == ["S2", "S2", "S8", "S8"] and set(runs["surface"]) == {"convex", "plain"}


def test_the_chart_has_a_panel_for_each_measure_beside_the_source():
    """Means with the deviations of their windows; levels of the source in the panel of their quantity."""
    table = steady_rows()
    found = drawn_chart(figures.steady_by_scale.product, table, published=RESULTS)
    velocity = RESULTS[RESULTS["quantity"] == "relative_velocity"]
    assert len(found["panels"][0]["data"]) == len(table) // 2 + len(velocity)
    assert values(found, "plain, at most, Yan 2022") == [[15.0, 15.0]]
    assert found["panels"][0]["data"][0]["error_y"]["array"] == [0.5]
    assert [panel["layout"]["yaxis"]["title"]["text"] for panel in found["panels"]] == [
        "Relative velocity of the particles (%)",
        "Wear rate over the largest of all runs<br>(%)",
    ]


def test_a_crossing_without_a_value_says_so():
    """Its interval stands alone; no number is printed where there is none."""
    found = {"": Ends(float("nan"), 10.8, float("inf"), 3)}
    assert _words(found) == "no value (95 % interval 10.8 to inf)"
