"""Settings against their plain twins: parts that add up, laws side by side, relative wear with its size ratio."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.tables.history import force_summary
from bulkwear.workflows.cases.sliding_sample.comparison import (
    law_comparison,
    plain_of_row,
    relative_wear_table,
    wear_split,
)
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.report.products import products_of
from tests.support.charts import drawn_chart, values

RELATIVE = 1e-12  # rounding of a few quotients


@pytest.fixture
def summary():
    """Two settings: B wears 1.5 of its plain twin; A, in two packings, 0.5 and 0.72."""
    volume = np.array([3.0, 2.0, 2.0, 4.0, 3.6, 5.0]) * 1e-9
    bumps = np.array([0.5, 0.0, 1.5, 0.0, 1.8, 0.0]) * 1e-9
    names = [("B", "B", 1), ("A", "A", 1), ("A-2", "A", 2)]
    runs = [
        {"run": f"{row}_{surface}", "row": row, "setting": setting, "packing": packing, "surface": surface}
        for row, setting, packing in names
        for surface in ("convex", "plain")
    ]
    return pd.DataFrame(runs).assign(
        worn_volume_m3=volume,
        base_worn_volume_m3=volume - bumps,
        pattern_worn_volume_m3=bumps,
        finnie_volume_m3=0.01 * volume,
        wear_over_plain=[1.5, 1.0, 0.5, 1.0, 0.72, 1.0],
    )


@pytest.fixture
def shown():
    """What draws the chart of a figure by name."""
    products = products_of(find_case("sliding_sample"))
    return lambda name, table, **beside: drawn_chart(products[name], table, **beside)


def test_charts_show_settings_with_their_intervals(summary, shown):
    """Parts stand upon one another below the plain sample's line; the source's value at its row; both laws; forces."""
    split, relative = wear_split(summary), relative_wear_table(summary, {})
    found = shown("wear_split", split)
    assert found["panels"][0]["layout"]["barmode"] == "stack"
    assert values(found, "pattern") == [pytest.approx(split["pattern_over_plain"], rel=1e-5)]
    assert values(found, "plain sample") == [[1.0, 1.0]]
    published = pd.DataFrame({"row": ["A"], "relation": ["above"], "value": [0.5], "source": ["Yan 2022"]})
    found = shown("relative_wear", relative, published=published)
    assert values(found, "convex") == [pytest.approx(relative["wear_over_plain"], rel=1e-5)]
    theirs = "at least, Yan 2022"
    assert values(found, theirs) == [[0.5]] and values(found, theirs, along="x") == [["A"]]
    laws = law_comparison(summary)
    assert values(shown("wear_law_comparison", laws), "the study's law") == [pytest.approx(laws["worn_volume_mm3"])]
    forces = summary[["run", "row", "setting", "packing", "surface"]].assign(vertical_force_N=2.0, drag_force_N=1.0)
    found = shown("forces", force_summary(forces))
    assert [(panel["title"], panel["data"][0]["y"]) for panel in found["panels"]] == [
        ("vertical", [2.0, 2.0]),
        ("drag", [1.0, 1.0]),
    ]
    along = shown("forces", forces.assign(travel_mm=1.0))
    assert along["sift"] == ["B", "A"] and len(along["panels"]) == 2


def test_twins_are_of_the_same_packing(summary):
    """Each packing is set over its own plain run, not over that of another bed."""
    ratio = summary["worn_volume_m3"] / plain_of_row(summary, "worn_volume_m3")
    np.testing.assert_allclose(ratio, summary["wear_over_plain"], rtol=RELATIVE)


def test_split_adds_up_to_the_relative_wear(summary):
    """Base and bumps over plain add up to the geometric mean of wear over plain; a plain sample is 1."""
    split = wear_split(summary).set_index(["setting", "surface"])
    total = split["base_over_plain"] + split["pattern_over_plain"]
    np.testing.assert_allclose(total, split["wear_over_plain"], rtol=RELATIVE)
    assert split.loc[("A", "convex"), "wear_over_plain"] == pytest.approx(0.6, rel=RELATIVE)
    assert (split["wear_over_plain"].xs("plain", level="surface") == 1.0).all()


def test_laws_stand_side_by_side(summary):
    """The ratio of the laws is that of their volumes, which are means over the packings in mm3."""
    table = law_comparison(summary).set_index(["setting", "surface"])
    np.testing.assert_allclose(table["finnie_over_archard"], 0.01, rtol=RELATIVE)
    assert table.loc[("A", "plain"), "worn_volume_mm3"] == pytest.approx(4.5, rel=RELATIVE)
    assert table.loc[("B", "plain"), "packings"] == 1


def test_relative_wear_has_the_size_ratio_of_its_setting(summary):
    """A line per setting with a pattern, in the order of the design, with alpha_ER; one packing has no interval."""
    table = relative_wear_table(summary, {"A_convex": 0.7, "A-2_convex": 0.7, "B_convex": 0.3})
    assert table["setting"].tolist() == ["B", "A"]
    assert table["equivalent_size_ratio"].tolist() == [0.3, 0.7]
    assert table["packings"].tolist() == [1, 2]
    assert table["interval_low"].isna().tolist() == [True, False]
