"""The figure of the groove: every mesh in the panel of its scheme, same axes, every number printed."""

import numpy as np
import pandas as pd

from benchmarks.plots.groove import COLUMNS, groove_convergence
from postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, remarks_of

REMARKS = ["pin of radius 3 mm", "softened"]
X = np.linspace(-2.0, 2.0, 9)  # mm
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
