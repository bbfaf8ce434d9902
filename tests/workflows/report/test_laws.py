"""Figures of laws side by side: what they draw, say, and make interactive; which laws are compared in what."""

from itertools import combinations

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.plots.laws import MOST_IN_COLUMN, law_bars, law_pictures
from bulkwear.postproc.plots.style import remarks_of
from bulkwear.postproc.tables.law_volumes import LawMap, laws_of_settings, map_table
from bulkwear.workflows.report.figure_findings import laws_apart, laws_on_designs, steepest_map
from bulkwear.workflows.report.laws import coefficients_remark, flow_of, wear_by_law, what_wears
from bulkwear.workflows.report.products import products_of_study
from tests.support.charts import drawn_chart, names, values
from tests.support.law_cases import told_of
from tests.support.own_machine_project import machine_study
from tests.support.tiny import tiny_study

PACKINGS = (1, 2, 3)


def volumes(place: str, front: bool) -> pd.DataFrame:
    """volume_by_law.csv of two settings with some packings: shear work wears 0.3 of Archard's."""
    rows = [
        told_of(setting, packing, law, 2.0 if setting == "B" and law == "finnie" else 1.0)
        | {"over_archard": np.nan if law == "finnie" else 1.0 if law == "archard" else 0.3 + 0.01 * packing}
        | {"overlap": {"archard": 1.0, "tangential_work": 0.9, "finnie": 0.2}[law] - 0.1 * (setting == "B")}
        | {"cycles": 4 if setting == "A" else 2, "front_share": 0.6 if front else np.nan, place: "liner"}
        for setting in "AB"
        for packing in PACKINGS
        for law in ("archard", "tangential_work", "finnie")
    ]
    return pd.DataFrame(rows)


def test_bars_are_the_means_with_intervals_over_packings():
    """A panel per measure that there is; Finnie's volume is not shown, where it lies is."""
    table = laws_of_settings(volumes("part", front=False))
    figure = law_bars(table, ["said"])
    left, middle, right = figure.axes
    lengths = [bar.get_width() for bar in left.patches]
    assert lengths == pytest.approx([1.0, 1.0, *[np.prod([0.31, 0.32, 0.33]) ** (1 / 3)] * 2])
    assert [bar.get_width() for bar in middle.patches] == pytest.approx([2.0, 2.0, 4.0])  # of B, per block
    assert len(right.patches) == 6
    assert [text.get_text() for text in left.get_yticklabels()] == ["A", "B"]
    assert remarks_of(figure) == "said"
    assert laws_apart(table).startswith("By finnie 10 % of the wear lies where Archard's does, at B liner")


def test_ratios_of_orders_of_magnitude_are_seen_from_one():
    """Where one law takes a hundred times what another does, bars go both ways from 1 on an axis of powers of ten."""
    table = volumes("part", front=False)
    table.loc[(table["law"] == "finnie") & (table["setting"] == "B"), "worn_volume_m3"] *= 50.0
    left, middle, _ = law_bars(laws_of_settings(table), ["said"]).axes
    assert (left.get_xscale(), middle.get_xscale()) == ("linear", "log")
    assert list(middle.get_xticks()) == [1.0, 10.0, 100.0]
    assert [(bar.get_x(), bar.get_x() + bar.get_width()) for bar in middle.patches] == [
        (1.0, pytest.approx(end)) for end in (2.0, 2.0, 200.0)
    ]


def test_a_bar_is_named_by_its_part_where_its_setting_has_several():
    """From top to bottom in the order of the table."""
    table = laws_of_settings(pd.concat([volumes("part", front=False), volumes("part", front=False).assign(part="lip")]))
    left = law_bars(table, []).axes[0]
    assert [text.get_text() for text in left.get_yticklabels()] == ["A liner", "B liner", "A lip", "B lip"]
    assert left.yaxis_inverted()


@pytest.mark.parametrize("settings", [MOST_IN_COLUMN, MOST_IN_COLUMN + 1, 40])
def test_names_of_many_settings_do_not_touch(settings):
    """Every row has its name."""
    one = volumes("part", front=False).query("setting == 'A'")
    named = [one.assign(setting=f"m{number:02d}-per-triangle") for number in range(settings)]
    figure = law_bars(laws_of_settings(pd.concat(named)), [])
    figure.canvas.draw()
    left = figure.axes[0]
    labels = [label for label in (*left.get_yticklabels(), *left.get_yticklabels(minor=True)) if label.get_text()]
    boxes = [label.get_window_extent() for label in labels]
    assert len(boxes) == settings
    assert not [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]


def test_the_design_on_which_laws_disagree_is_named():
    """Over the first one, each law with its interval, least first; nothing where they agree, or of one setting."""
    table = laws_of_settings(volumes("part", front=False))  # Finnie wears B twice as much, in half as many blocks
    assert laws_on_designs(table) == (
        "Laws disagree most on the liner of B: over that of A it wears 2 (2 to 2) by archard, 2 (2 to 2) by tangential"
        " work and 4 (4 to 4) by finnie."
    )
    assert laws_on_designs(table[table["law"] != "finnie"]) == ""
    assert laws_on_designs(table[table["setting"] == "A"]) == ""


PLACES = [("part", False, 3), ("surface", True, 4), ("surface", False, 3)]


@pytest.mark.parametrize(("place", "front", "panels"), PLACES)
def test_the_chart_has_what_the_table_tells(place, front, panels):
    """Of parts or surfaces, with intervals; a measure that no run has makes no panel of bars."""
    table = laws_of_settings(volumes(place, front))
    found = drawn_chart(wear_by_law.product, table)
    assert names(found) == ["archard", "tangential work", "finnie"]
    assert len(found["panels"]) == panels
    assert values(found, "tangential work", 2)[0] == pytest.approx([0.9, 0.8])


def test_laws_whose_coefficients_are_no_volume_over_sliding_work_are_named():
    """Nothing is said where all are."""
    assert coefficients_remark(["archard", "tangential_work", "combined"]) == []
    (said,) = coefficients_remark(["archard", "impact_threshold", "oka"])
    assert said == "the coefficient of impact threshold, oka is another quantity than Archard's: compare places alone"


def test_maps_of_all_laws_have_one_scale():
    """A picture per law, and one bar that ends at the most uneven of them; nothing worn is said."""
    plate = flat_plate(1e-2, 1e-2, 5e-3)
    count = len(plate.triangles)
    even, uneven = np.ones(count), np.where(np.arange(count) == 0, count, 0.0)
    maps = [LawMap("archard", plate, even, 3), LawMap("tangential_work", plate, uneven, 3)]
    figure = law_pictures(maps, [])
    assert [axes.get_title() for axes in figure.axes[:2]] == ["archard", "tangential work"]
    assert figure.axes[-1].get_xlim()[1] == pytest.approx(count)
    assert "1 by archard" in steepest_map(map_table("A", maps))
    spot = map_table("A", maps).assign(relative_depth=0.0)
    assert steepest_map(spot) == "Less than 1 % of the area wears."
    assert law_pictures([], []).axes == []


def test_a_map_of_next_to_no_wear_has_the_scale_of_what_wears():
    """As of a pin on a disc, whose track is less than a hundredth of it."""
    plate = flat_plate(2e-2, 2e-2, 1e-3)
    count = len(plate.triangles)
    figure = law_pictures([LawMap("archard", plate, np.where(np.arange(count) == 0, count, 0.0), 1)], [])
    assert count > 100 and figure.axes[-1].get_xlim() == pytest.approx((0.0, count))


def test_every_part_that_wears_is_told_with_its_law(tmp_path):
    """By its name and the label of its faces; samples have one law for all faces, and a flow along the travel."""
    with machine_study(tmp_path) as study:
        found = what_wears(study)[study.runs[0].name]
        assert flow_of(study) is None and "wear_by_law" in products_of_study(study)
    assert [(law, part, label) for law, _, part, label, *_ in found] == [
        ("archard", "liner", 0),
        ("finnie", "plate", 1),
        ("archard", "paddle", 2),
    ]
    sample = tiny_study()
    law, _, part, label, *_ = what_wears(sample)[sample.runs[0].name][0]
    assert (law, part, label, flow_of(sample)) == ("archard", "", None, (0.0, 1.0, 0.0))
