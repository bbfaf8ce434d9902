"""Clumps beside spheres of several rolling frictions: means, ratios, and which spheres wear the same."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.grain_shape import (
    answers,
    compares_shapes,
    equal_factors,
    shape_sentences,
    shape_table,
)
from bulkwear.workflows.cases.sliding_sample.plots.grain_shape import wear_by_grain_shape
from bulkwear.workflows.config.design import load_study

ROUNDING = 1e-12  # relative
MM3_PER_M3 = 1e9
# plain and convex wear per metre (m3/m): of spheres by their factor, and of a clump
SPHERES = {0.0: (1e-9, 2e-9), 0.5: (2e-9, 2e-9), 1.0: (4e-9, 2e-9)}
CLUMP = (3e-9, 1.5e-9)
OF_STUDY = {"shape": "sphere", "rolling_friction_factor": 1.0}  # what empty cells of the design stand for


def summary(packings=1):
    """A summary of spheres and a clump; packings wear 1, 4, ... times as much, so that geometric means differ."""
    rows = [(f"sphere-{factor:g}", "sphere", factor, wear) for factor, wear in SPHERES.items()]
    rows.append(("angular", "tetrahedron", 0.0, CLUMP))
    lines = []
    for packing in range(packings):
        for setting, shape, factor, (plain, convex) in rows:
            for surface, wear in (("plain", plain), ("convex", convex)):
                line = {"setting": setting, "packing": packing + 1, "surface": surface, "shape": shape}
                lines.append(
                    {
                        **line,
                        "rolling_friction_factor": factor,
                        "worn_volume_per_metre_m3_per_m": wear * 4.0**packing,
                        "wear_over_plain": wear / plain,
                    }
                )
    return pd.DataFrame(lines)


def test_wear_of_clumps_is_set_over_that_of_round_spheres():
    """Per measure: value in display units, and over the value of the spheres with the least rolling friction."""
    table = shape_table(summary(), OF_STUDY).set_index(["measure", "setting"])
    assert table.loc[("plain sample", "angular"), "value"] == pytest.approx(CLUMP[0] * MM3_PER_M3, rel=ROUNDING)
    assert table.loc[("plain sample", "angular"), "over_round"] == pytest.approx(3.0, rel=ROUNDING)
    assert table.loc[("convex sample", "angular"), "over_round"] == pytest.approx(0.75, rel=ROUNDING)
    ratio = table.loc[("patterned over plain", "angular")]
    assert ratio["value"] == pytest.approx(CLUMP[1] / CLUMP[0], rel=ROUNDING)
    assert ratio["over_round"] == pytest.approx(0.25, rel=ROUNDING)


def test_spheres_that_wear_the_same():
    """Straight lines between means: 3 lies half-way from 2 at 0.5 to 4 at 1; nothing wears 1.5 on the convex sample."""
    table = shape_table(summary(), OF_STUDY).set_index(["measure", "setting"])["same_as"]
    assert table["plain sample", "angular"] == "0.75"
    assert table["convex sample", "angular"] == "none from 0 to 1"
    assert table["patterned over plain", "angular"] == "1"  # 2 at 0, 1 at 0.5, 0.5 at 1: a point itself
    assert (table[[name.startswith("sphere") for _, name in table.index]] == "").all()


@pytest.mark.parametrize(
    ("values", "value", "expected"),
    [
        ([1.0, 3.0, 1.0], 2.0, [0.25, 0.75]),
        ([1.0, 2.0, 4.0], 1.0, [0.0]),
        ([1.0, 2.0, 4.0], 5.0, []),
        ([2.0, 2.0, 4.0], 3.0, [0.75]),
    ],
)
def test_every_crossing_is_found(values, value, expected):
    """Wear need not grow with rolling friction: a value may be passed twice, at a point, or never."""
    assert equal_factors(np.array([0.0, 0.5, 1.0]), np.array(values), value) == pytest.approx(expected)


def test_means_over_packings_are_geometric_and_have_intervals():
    """Two packings that wear 1 and 4: the mean is 2; of one packing nothing is known, which is said."""
    two = shape_table(summary(packings=2), OF_STUDY)
    plain = two[(two["measure"] == "plain sample") & (two["setting"] == "angular")].iloc[0]
    assert plain["value"] == pytest.approx(2.0 * CLUMP[0] * MM3_PER_M3, rel=1e-9)
    assert plain["packings"] == 2 and plain["interval_low"] < plain["value"] < plain["interval_high"]
    assert "scatter unknown" in shape_sentences(shape_table(summary(), OF_STUDY))[-1]
    assert not any("scatter unknown" in said for said in shape_sentences(two))


def test_an_empty_cell_is_what_the_study_says():
    """A row without a shape is one of the study's, spheres here, on the line; without a factor it has the study's."""
    table = summary()
    own = table["setting"].isin(["sphere-0.5", "sphere-1"])
    emptied = table.assign(shape=table["shape"].mask(own))
    emptied["rolling_friction_factor"] = emptied["rolling_friction_factor"].mask(table["setting"] == "sphere-1")
    found = shape_table(emptied, OF_STUDY)
    pd.testing.assert_frame_equal(found, shape_table(table, OF_STUDY))
    assert not any("sphere-0.5" in said for said in shape_sentences(found))
    study = load_study("grain_shape")
    rows = tuple(
        {k: v for k, v in row.items() if row["shape"] != "sphere" or k != "shape"} for row in study.design_rows
    )
    assert compares_shapes(replace(study, design_rows=rows))


def test_only_studies_of_shape_tell_of_it(tmp_path):
    """Those with clumps beside spheres of two rolling frictions or more."""
    assert compares_shapes(load_study("grain_shape"))
    assert not compares_shapes(load_study("grain_shape", overrides={"rows": ["sphere-0", "pair"]}))
    assert not compares_shapes(load_study("demo"))
    assert answers(tmp_path) == []


def test_figure_shows_each_measure():
    """A panel per measure, in it a level per clump."""
    figure = wear_by_grain_shape(shape_table(summary(packings=2), OF_STUDY), ["remark"])
    assert [axes.get_title() for axes in figure.axes] == ["plain sample", "convex sample", "patterned over plain"]
    levels = [line for line in figure.axes[0].lines if line.get_label() == "angular"]
    assert len(levels) == 1 and levels[0].get_ydata()[0] == pytest.approx(2.0 * CLUMP[0] * MM3_PER_M3, rel=1e-9)
