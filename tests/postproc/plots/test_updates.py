"""The figure of the wear updates draws its table, in panels with units and the remarks below."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots import updates
from bulkwear.postproc.plots.style import SMALLEST_FONT, remarks_of
from bulkwear.postproc.tables.updates import update_summary

REMARKS = ["particles at scale 2", "wear accelerated 4000 times"]
BOUND = 15.0  # degrees
FACES = np.array([0, 12, 30])


def table_of(*rows, faces=FACES):
    """Updates of the convex and the plain run of each row, three cycles of unequal length, different in each run."""
    ends = np.array([10.0, 30.0, 40.0])
    tables = []
    for k, (row, surface) in enumerate((row, surface) for row in rows for surface in ("convex", "plain")):
        columns = {
            "cycle": [1, 2, 3],
            "cycle_start_mm": [0.0, 10.0, 30.0],
            "travel_mm": ends,
            "applied_percent": 100.0 - ends / (k + 1),
            "carried_percent": ends / (k + 1),
            "step_demand": ends / 10.0 + k,
            "step_taken": 1.0 / (k + 1),
            "smallest_angle_deg": 30.0 - 0.3 * ends,
            "remeshed_faces": faces * (k + 1),
            "bad_faces_left": 0,
            "balance_error": [0.0, 1e-12, 1e-11],
        }
        tables.append(pd.DataFrame(columns).assign(run=f"{row}_{surface}", setting=row, surface=surface))
    return pd.concat(tables, ignore_index=True)


def lines_of(figure):
    """All curves or points with a label: label -> (x, y)."""
    lines = [line for axes in figure.axes for line in axes.get_lines() if not line.get_label().startswith("_")]
    return {line.get_label(): line.get_xydata() for line in lines}


def bars_of(figure, label):
    """Left edges, right edges and heights (n, 3) of the bars of a label."""
    bars = next(found for axes in figure.axes for found in axes.containers if found.get_label() == label)
    return np.array([[bar.get_x(), bar.get_x() + bar.get_width(), bar.get_height()] for bar in bars])


def test_each_update_is_drawn_as_tabled():
    """Every line holds its column against the travel; bars of remeshed faces span their cycle."""
    table = table_of("R9")
    figure = updates.wear_updates(table, BOUND, REMARKS)
    drawn = lines_of(figure)
    for name, run in table.groupby("run"):
        for column in ("applied_percent", "carried_percent", "step_demand", "step_taken", "smallest_angle_deg"):
            np.testing.assert_array_equal(drawn[f"{name} {column}"], run[["travel_mm", column]])
        errors = drawn[f"{name} balance_error"][:, 1]
        np.testing.assert_array_equal(errors, [np.nan, 1e-12, 1e-11])
        bars = bars_of(figure, f"{name} remeshed_faces")
        np.testing.assert_allclose(bars, run[["cycle_start_mm", "travel_mm", "remeshed_faces"]])


def test_panels_have_units_and_bounds():
    """Axes carry %, degrees and mm; cap and bound are drawn where they lie; the balance is on a log axis."""
    figure = updates.wear_updates(table_of("R9"), BOUND, REMARKS)
    panels = {axes.get_ylabel(): axes for axes in figure.axes}
    assert {"(%)", "(-)", "(°)"} <= {label.split()[-1] for label in panels}
    dotted = {
        label: [line.get_ydata()[0] for line in axes.get_lines() if line.get_linestyle() == ":"]
        for label, axes in panels.items()
    }
    assert (dotted[updates.STEP], dotted[updates.ANGLE]) == ([1.0], [BOUND])
    assert panels[updates.BALANCE].get_yscale() == "log"
    assert panels[updates.BALANCE].get_xlabel() == "Travel (mm)"


def test_without_remeshing_there_is_no_axis_for_it():
    """Where no face was remeshed, the figure says so and has no bars."""
    figure = updates.wear_updates(table_of("R9", faces=np.zeros(3, dtype=int)), BOUND, REMARKS)
    panels = {axes.get_ylabel(): axes for axes in figure.axes}
    assert updates.FACES not in panels
    assert "no face was remeshed" in panels[updates.ANGLE].get_title(loc="left")


def test_many_rows_show_the_worst_of_each_run():
    """One point per run and column beside its row, named on the axis."""
    rows = [f"R{k}" for k in range(1, 14)]
    summary = update_summary(table_of(*rows))
    figure = updates.worst_updates(summary, BOUND, REMARKS)
    drawn = lines_of(figure)
    for surface, runs in summary.groupby("surface"):
        places = drawn[f"{surface} step_demand"]
        np.testing.assert_array_equal(places[:, 1], runs["step_demand"])
        np.testing.assert_array_equal(np.round(places[:, 0]), np.arange(len(rows)))
        np.testing.assert_array_equal(bars_of(figure, f"{surface} remeshed_faces")[:, 2], runs["remeshed_faces"])
    balance = next(axes for axes in figure.axes if axes.get_ylabel() == updates.BALANCE)
    assert [label.get_text() for label in balance.get_xticklabels()] == rows


@pytest.mark.parametrize("draw", ["each", "worst"])
def test_remarks_and_fonts(draw):
    """All remarks are printed below the panels, no letter is below 9 pt, nothing leaves the figure."""
    table = table_of("R1", "R2")
    figure = (
        updates.wear_updates(table, BOUND, REMARKS)
        if draw == "each"
        else updates.worst_updates(update_summary(table), BOUND, REMARKS)
    )
    figure.draw_without_rendering()
    assert remarks_of(figure) == "; ".join(REMARKS)
    texts = [text for text in figure.findobj(lambda artist: hasattr(artist, "get_fontsize")) if text.get_text()]
    assert min(text.get_fontsize() for text in texts) >= SMALLEST_FONT
    remark = next(text for text in figure.texts if text.get_gid() == "remarks").get_window_extent()
    boxes = [axes.get_tightbbox() for axes in figure.axes]
    assert remark.y1 < min(box.y0 for box in boxes)
    assert min(box.x0 for box in boxes) >= 0.0
    assert max(box.x1 for box in boxes) <= figure.bbox.x1
