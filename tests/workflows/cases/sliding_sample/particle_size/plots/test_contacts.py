"""Figures of packings and of collisions show every scale, what is published, and the closed form."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import remarks_of
from bulkwear.workflows.cases.sliding_sample.particle_size.collision import COLLISIONS, MODELS, dimensionless
from bulkwear.workflows.cases.sliding_sample.particle_size.plots.contacts import (
    ASIDE,
    PACKING_SIZE,
    RANGE_COLOUR,
    bed_packing,
    collisions,
    packing_profiles,
)
from tests import PUBLISHED
from tests.workflows.cases.sliding_sample.particle_size.test_collision import gravel

PUBLISHED = pd.read_csv(PUBLISHED / "packing.csv")
SCALES = [1.0, 4.0, 8.0]


def profiles():
    tables = []
    for scale in SCALES:
        for state, contacts, pores in (("loose", 5.2, 0.41), ("dense", 5.4, 0.39), ("difference", 0.2, -0.02)):
            height = 10.0 * scale * np.arange(1, 4)
            table = pd.DataFrame({"height_mm": height, "coordination_number": contacts, "porosity": pores})
            tables.append(table.assign(porosity_whole_particles=pores + 0.01, state=state, particle_scale=scale))
    return pd.concat(tables, ignore_index=True)


def test_profiles_show_scales_rules_and_ranges():
    """Three curves per panel, three more by the source's rule of porosity; ranges where both bounds are published."""
    figure = packing_profiles(profiles(), PUBLISHED[PUBLISHED["case"] == "container"], ["scaled"])
    panels = figure.axes
    assert [len(axes.lines) for axes in panels] == [3, 3, 3, 6, 6, 6]
    assert [len(axes.patches) for axes in panels] == [1, 0, 1, 0, 0, 1]
    low, high = panels[0].patches[0].get_x(), panels[0].patches[0].get_x() + panels[0].patches[0].get_width()
    assert (low, high) == pytest.approx((5.0, 5.6))
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["scale 1", "scale 4", "scale 8", "particles whole", "Yan 2022"]
    assert figure.legends[0].get_lines()[-1].get_color() == RANGE_COLOUR
    assert "scaled" in remarks_of(figure)


def test_without_published_values_nothing_is_shaded():
    """An empty table leaves the panels white and the legend without a source."""
    figure = packing_profiles(profiles(), PUBLISHED.iloc[:0], [])
    assert all(not axes.patches for axes in figure.axes)
    assert len(figure.legends[0].get_texts()) == len(SCALES) + 1


def test_a_bed_is_shown_by_scale_before_and_after():
    """Two curves of contacts, four of porosity; published bounds stand over the scales that they hold for."""
    rows = [
        {"particle_scale": scale, "state": state, "coordination_number": contacts, "porosity": pores}
        for scale in SCALES
        for state, contacts, pores in (("before", 5.1, 0.40), ("after", 4.8, 0.42))
    ]
    table = pd.DataFrame(rows).assign(porosity_whole_particles=0.41)
    figure = bed_packing(table, PUBLISHED[PUBLISHED["case"] == "bed"], [])
    contacts, pores = figure.axes
    assert len(contacts.lines) == 4 and len(pores.lines) == 4
    assert all(line.get_linestyle() == "None" for line in contacts.lines if line.get_label() != "_bound")
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names[:3] == ["ahead of the sample", "behind it", "particles whole"]
    bounds = [line for line in contacts.lines if line.get_label() == "_bound"]
    assert [list(line.get_xdata()) for line in bounds] == [[1, 5], [6, 8]]


def test_packings_of_a_bed_are_small_marks_about_their_mean():
    """Nothing joins them; particles counted whole are a line through the means."""
    rows = [
        {"particle_scale": scale, "state": "before", "coordination_number": 5.0 + off, "porosity": 0.4 + 0.1 * off}
        for scale in SCALES
        for off in (-0.2, 0.0, 0.2)
    ]
    table = pd.DataFrame(rows)
    table = table.assign(porosity_whole_particles=table["porosity"] + 0.01)
    contacts, pores = bed_packing(table, PUBLISHED[:0], []).axes
    (packings,) = [line for line in contacts.lines if line.get_label() == "ahead of the sample"]
    assert packings.get_linestyle() == "None" and packings.get_markersize() == PACKING_SIZE
    assert len(packings.get_xdata()) == len(table)
    means = [bars.lines[0] for bars in contacts.containers]
    assert [line.get_xdata()[0] for line in means] == [scale - ASIDE for scale in SCALES]
    assert [line.get_ydata()[0] for line in means] == pytest.approx([5.0] * len(SCALES))
    (whole,) = [line for line in pores.lines if line.get_label() == "_whole" and len(line.get_xdata())]
    assert list(whole.get_xdata()) == SCALES and list(whole.get_ydata()) == pytest.approx([0.41] * len(SCALES))


def drawn_histories():
    """Half sines in the place of simulations."""
    time = np.linspace(0.0, 12.0, 60)
    tables = []
    for model in MODELS:
        for scale in (1.0, 3.0, 8.0):
            for kind in COLLISIONS:
                shape = np.sin(np.pi * time / 12.0)
                table = pd.DataFrame({"time": time, "overlap": 0.015 * shape, "normal_force": 0.0018 * shape})
                table = table.assign(tangential_force=0.4 * table["normal_force"], spin=0.01 - 0.5 * table["overlap"])
                tables.append(table.assign(collision=kind, particle_scale=scale, rolling_friction=model))
    return pd.concat(tables, ignore_index=True)


def test_the_figure_shows_every_scale_and_the_closed_form():
    """Six panels; each head-on panel has a line of the closed form and marks of three scales; remarks are printed."""
    spheres = gravel()
    closed = {kind: dimensionless(each, spheres.units(kind)) for kind, each in spheres.closed_forms(1.0).items()}
    figure = collisions(drawn_histories(), closed, ["a remark"])
    panels = figure.axes
    assert len(panels) == 6 and [len(axes.lines) for axes in panels] == 2 * [4, 4, 3 * len(MODELS)]
    assert max(panels[0].lines[0].get_ydata()) == pytest.approx(closed["pair"]["overlap"].max())
    assert panels[0].lines[1].get_linestyle() == "None"  # marks: joined, they would be a line of their own
    assert "a remark" in remarks_of(figure)
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"scale 1", "scale 3", "scale 8"} <= set(names)
