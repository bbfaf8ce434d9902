"""The figure of the groove: every mesh in the panel of its scheme, same axes, every number printed."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.plots.figures import COLUMNS, Panel, deviation_figure, groove_convergence, wear_side_by_side
from bulkwear.postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, remarks_of

REMARKS = ["pin of radius 3 mm", "softened"]
X = np.linspace(-2.0, 2.0, 9)  # mm
BEDS = ["bed of 2 m", "window"]
SEEDS = (1, 2)
DEPTHS = {  # um
    ("conserving", 5): 301.0,
    ("conserving", 20): 305.0,
    ("spread_once", 20): 338.0,
    ("per_triangle", 5): 84.0,
    ("per_triangle", 20): 188.0,
}


def figure():
    """Figure of parabolas of those depths (um)."""
    sections = pd.concat(
        pd.DataFrame({"scheme": scheme, "edges_per_width": edges, "x_mm": X, "depth_um": depth * (1 - X**2 / 4)})
        for (scheme, edges), depth in DEPTHS.items()
    )
    table = pd.DataFrame(
        [
            {"scheme": scheme, "strokes": 25, "edges_per_width": edges, "depth_um": depth, "width_mm": 2.0}
            | {"removed_over_archard": 0.99, "accounted_over_archard": 1.0, "work_over_load_times_distance": 1.1}
            for (scheme, edges), depth in DEPTHS.items()
        ]
    )
    return groove_convergence(sections, table, REMARKS)


def test_each_scheme_has_a_panel_with_all_its_meshes():
    """Curves lie in the panel of their scheme, in the order of the meshes; both panels have the same axes."""
    left, right = figure().axes[:2]
    for axes, depths in ((left, [301.0, 305.0, 338.0]), (right, [84.0, 188.0])):
        assert [line.get_ydata().max() for line in axes.get_lines()] == depths
    assert left.get_ylim() == right.get_ylim()
    assert left.get_xlim() == right.get_xlim()
    assert left.get_ylim()[0] > left.get_ylim()[1]  # depth downwards
    styles = {(line.get_linestyle(), line.get_color()) for line in left.get_lines()}
    assert len(styles) == 3


def test_numbers_and_remarks_are_printed():
    """The table holds a row per mesh and scheme under the heads of all columns; remarks below; type is legible."""
    made = figure()
    cells = made.axes[2].tables[0].get_celld()
    assert max(row for row, _ in cells) == len(DEPTHS)
    assert max(column for _, column in cells) == len(COLUMNS)
    depths = [cells[row, 1 + list(COLUMNS).index("depth_um")].get_text().get_text() for row in range(1, 6)]
    assert depths == ["301", "305", "338", "84", "188"]
    assert remarks_of(made) == "; ".join(REMARKS)
    assert made.get_figheight() <= LARGEST_HEIGHT
    assert min(cell.get_text().get_fontsize() for cell in cells.values()) >= SMALLEST_FONT


ROWS = pd.DataFrame(
    {
        "value": [0.1, 0.2, 0.4],
        "failed": [0, 0, 1],
        "change": [0.0, 0.03, np.nan],
        "change_low": [0.0, 0.01, np.nan],
        "change_high": [0.0, 0.05, np.nan],
    }
)


def test_changes_intervals_and_marks_are_drawn():
    """Per cent on the axis, the interval as a bar, a line where the solver failed and at each marked value."""
    figure = deviation_figure([Panel("Step (-)", ROWS, {"studies": 0.2})] * 2, "wear", 0.02, ["four layers"])
    assert len(figure.axes) == 2 and remarks_of(figure) == "four layers"
    axes = figure.axes[0]
    assert axes.get_ylabel() == "Change of wear (%)" and axes.get_xlabel() == "Step (-)"
    (bars,) = axes.containers
    assert bars.lines[0].get_ydata() == pytest.approx([0.0, 3.0])
    (spans,) = bars.lines[2]
    assert spans.get_segments()[1][:, 1] == pytest.approx([1.0, 5.0])
    upright = {float(line.get_xdata()[0]) for line in axes.get_lines() if len(set(line.get_xdata())) == 1}
    assert {0.2, 0.4} <= upright
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["studies", "a run failed"]


def test_packings_and_their_ratios_are_drawn_as_tabled():
    """Per surface and bed a line per packing and one of their mean, over the middle of its blocks; and the ratio, with
    its interval where there is one, over what the bed costs.
    """
    work = pd.DataFrame(
        {"surface": surface, "bed": bed, "seed": seed, "block": block, "sliding_work_J": 0.1 * block * seed + len(bed)}
        for surface in ("plain", "convex")
        for bed in BEDS
        for seed in SEEDS
        for block in (1, 2, 3)
    )
    table = work[["surface", "bed"]].drop_duplicates().assign(wear_over_full=[1.0, 0.9, 1.0, 1.3])
    table = table.assign(ratio_low=[np.nan, 0.8, np.nan, 1.2], ratio_high=[np.nan, 1.1, np.nan, 1.5])
    table = table.assign(cheaper_in_particle_steps=[1.0, 5.0, 1.0, 4.0])
    figure = wear_side_by_side(work, table, 0.1, ["scale 5"])
    for (along, ratios), surface in zip(np.reshape(figure.axes, (2, 2)), ("plain", "convex"), strict=True):
        rows, lines = table[table["surface"] == surface], iter(along.get_lines())
        for bed in BEDS:
            one = work[(work["surface"] == surface) & (work["bed"] == bed)]
            of_packings = [one.loc[one["seed"] == seed, "sliding_work_J"].to_numpy() / 0.1 for seed in SEEDS]
            for expected in (*of_packings, np.mean(of_packings, axis=0)):
                line = next(lines)
                np.testing.assert_allclose(line.get_xdata(), [50.0, 150.0, 250.0])
                np.testing.assert_allclose(line.get_ydata(), expected)
        assert next(lines, None) is None
        drawn = [container.lines[0].get_xydata()[0] for container in ratios.containers]
        np.testing.assert_allclose(drawn, rows[["cheaper_in_particle_steps", "wear_over_full"]])
        (bar,) = (part for container in ratios.containers for part in container.lines[2])
        np.testing.assert_allclose(bar.get_segments()[0][:, 1], rows[["ratio_low", "ratio_high"]].iloc[1])
        assert ratios.get_ylim()[0] < rows["ratio_low"].min() and ratios.get_ylim()[1] > rows["ratio_high"].max()
        assert surface in along.get_title(loc="left")
