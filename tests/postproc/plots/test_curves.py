"""Curves draw their tables: units on the axes, values as they stand, the remarks below."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots import curves
from bulkwear.postproc.plots.style import LARGEST_HEIGHT, RESOLUTION, SMALLEST_FONT, WIDTH, remarks_of, save, scaled

REMARKS = [
    "sample 80 x 80 mm of 200 x 200 mm; bed width 100 mm of 300 mm; bed ahead of the sample 160 mm of 200 mm",
    "particles at scale 2",
    "wear accelerated 10000 times",
    "fewer than three layers of particles in the bed: R2 (1.9)",
]


def runs(*rows):
    """Names of the convex and the plain run of each row, a setting of its own."""
    return [
        {"run": f"{row}_{s}", "row": row, "setting": row, "surface": s} for row in rows for s in ("convex", "plain")
    ]


def history_of(*rows, applied=0.5):
    """Wear that grows with the travel, different in each run."""
    travel = np.array([0.0, 10.0, 20.0])
    tables = [
        pd.DataFrame(
            {
                "travel_mm": travel,
                "worn_volume_mm3": travel * (k + 1),
                "applied_volume_mm3": applied * travel * (k + 1),
            }
        ).assign(**run)
        for k, run in enumerate(runs(*rows))
    ]
    return pd.concat(tables, ignore_index=True)


def lines_of(figure):
    """All curves with a run's name as label: label -> (x, y)."""
    drawn = {}
    for axes in figure.axes:
        for line in axes.get_lines():
            if not line.get_label().startswith("_"):
                drawn.setdefault((line.get_label(), axes.get_ylabel()), line.get_xydata())
    return drawn


def texts_of(figure):
    """Every text on a figure that is not empty."""
    figure.draw_without_rendering()
    return [text for text in figure.findobj(lambda artist: hasattr(artist, "get_fontsize")) if text.get_text()]


def test_wear_is_drawn_as_tabled():
    """Both curves of each run hold the table's values; axes carry mm and mm³."""
    history = history_of("R9")
    figure = curves.wear_against_travel(history, REMARKS)
    drawn = {label: values for (label, _), values in lines_of(figure).items()}
    for run, rows in history.groupby("run"):
        np.testing.assert_array_equal(drawn[f"{run} archard"], rows[["travel_mm", "worn_volume_mm3"]])
        np.testing.assert_array_equal(drawn[f"{run} applied"], rows[["travel_mm", "applied_volume_mm3"]])
    assert figure.axes[0].get_xlabel() == "Travel (mm)"
    assert "(mm³)" in figure.axes[0].get_ylabel()


def test_packings_are_thin_and_their_mean_is_thick():
    """Of two packings, one of them looked at elsewhere along the travel, the mean line is half of their sum."""
    first = history_of("R9").assign(packing=1)
    other = first.assign(packing=2, run=first["run"] + "-2", worn_volume_mm3=3.0 * first["worn_volume_mm3"])
    other.loc[other["travel_mm"] == 10.0, ["travel_mm", "worn_volume_mm3"]] *= 1.2
    (axes,) = curves.wear_against_travel(pd.concat([first, other], ignore_index=True), REMARKS).axes
    drawn = {line.get_label(): line for line in axes.get_lines()}
    np.testing.assert_allclose(drawn["R9_plain archard"].get_ydata(), [0.0, 40.0, 80.0])
    thin, thick = (drawn[f"R9_plain {name}"] for name in ("packing", "archard"))
    np.testing.assert_allclose(drawn["R9_plain-2 packing"].get_ydata(), [0.0, 72.0, 120.0])
    assert thin.get_linewidth() < thick.get_linewidth()


def test_a_rigid_study_has_no_applied_curve():
    """Where nothing is applied, no curve at zero is drawn and the legend does not promise one."""
    figure = curves.wear_against_travel(history_of("R9", applied=0.0), REMARKS)
    assert not [label for label, _ in lines_of(figure) if "applied" in label]
    assert "applied" not in " ".join(text.get_text() for text in figure.legends[0].get_texts())


def test_many_rows_become_small_multiples():
    """One axes per design row, named, each with its own two runs; units on the figure."""
    rows = [f"R{k}" for k in range(1, 14)]
    figure = curves.wear_against_travel(history_of(*rows, applied=0.0), REMARKS)
    assert [axes.get_title(loc="left") for axes in figure.axes] == rows
    for row, axes in zip(rows, figure.axes, strict=True):
        assert {line.get_label() for line in axes.get_lines()} == {f"{row}_convex archard", f"{row}_plain archard"}
    assert figure.get_supxlabel() == "Travel (mm)"
    assert "(mm³)" in figure.get_supylabel()


def test_distribution_is_drawn_as_tabled():
    """Curves hold the table's shares; the axis says which depth in µm."""
    shares = {"depth_um": [0.1, 1.0], "area_share_percent": [80.0, 0.0]}
    table = pd.concat([pd.DataFrame(shares).assign(**run) for run in runs("R9")], ignore_index=True)
    figure = curves.depth_distribution(table, "Removed thickness", REMARKS)
    for values in lines_of(figure).values():
        np.testing.assert_array_equal(values, [[0.1, 80.0], [1.0, 0.0]])
    assert figure.axes[0].get_xlabel() == "Removed thickness (µm)"
    assert "%" in figure.axes[0].get_ylabel()


def test_forces_are_drawn_as_tabled():
    """Vertical force above, drag below, both in N against travel in mm."""
    values = {"travel_mm": [1.0, 2.0, 3.0], "vertical_force_N": [5.0, 6.0, 7.0], "drag_force_N": [2.0, 2.5, 3.0]}
    table = pd.concat([pd.DataFrame(values).assign(**run) for run in runs("R9")], ignore_index=True)
    figure = curves.forces(table, REMARKS)
    drawn = lines_of(figure)
    np.testing.assert_array_equal(drawn["R9_plain", "Vertical force (N)"], table[["travel_mm", "vertical_force_N"]][:3])
    np.testing.assert_array_equal(drawn["R9_plain", "Drag force (N)"], table[["travel_mm", "drag_force_N"]][:3])
    assert figure.axes[1].get_xlabel() == "Travel (mm)"


@pytest.mark.parametrize("rows", [["R9"], [f"R{k}" for k in range(1, 14)]])
def test_remarks_fonts_and_size(rows, tmp_path):
    """All remarks are printed inside the figure, no letter is below 9 pt, the picture is at most 1600 x 1000."""
    figure = curves.wear_against_travel(history_of(*rows), REMARKS)
    assert remarks_of(figure) == "; ".join(REMARKS)
    assert figure.get_supxlabel() == ("Travel (mm)" if len(rows) > 1 else "")
    assert min(text.get_fontsize() for text in texts_of(figure)) >= SMALLEST_FONT
    remark = next(text for text in figure.texts if text.get_gid() == "remarks").get_window_extent()
    assert remark.x1 <= WIDTH * RESOLUTION
    assert remark.y1 < min(axes.get_tightbbox().y0 for axes in figure.axes)
    labels = [text for text in figure.texts if text.get_text() == "Travel (mm)"]
    for label in labels:
        box = label.get_window_extent()
        assert remark.y1 < box.y0
        assert box.y1 < min(axes.get_tightbbox().y0 for axes in figure.axes)
    save(figure, tmp_path / "figure.png")
    header = (tmp_path / "figure.png").read_bytes()[16:24]
    width, height = (int.from_bytes(header[k : k + 4], "big") for k in (0, 4))
    assert (width, height <= LARGEST_HEIGHT * RESOLUTION) == (WIDTH * RESOLUTION, True)


@pytest.mark.parametrize(
    ("largest", "unit", "tick"),
    [(5.0, "mm³", "2"), (2.5e-6, "$10^{-6}$ mm³", "2e+06"), (0.0, "mm³", "2"), (3e4, "$10^{3}$ mm³", "0.002")],
)
def test_powers_of_ten_move_into_the_unit(largest, unit, tick):
    """Where numbers would be hard to read the unit takes a power of 1000; ticks are divided by it."""
    found, formatter = scaled("mm³", largest)
    assert (found, formatter(2.0, 0)) == (unit, tick)


def test_sampling_errors_are_drawn_in_percent_at_their_stride():
    """Each error is drawn where it was measured; the short window, measured against stride 1, has no point there."""
    errors = pd.DataFrame(
        {
            "stride_steps": [1, 10, 100],
            "total_error": [1e-6, 1e-4, 1e-3],
            "short_window_error": [0.0, 0.01, 0.1],
            "map_error": [1e-5, 0.02, 0.2],
            "dumps_MB": [100.0, 10.0, 1.0],
        }
    )
    drawn = {label: points for (label, _), points in lines_of(curves.sampling_error(errors, REMARKS)).items()}
    np.testing.assert_allclose(drawn["map over the triangles, whole travel"][:, 1], [1e-3, 2.0, 20.0])
    np.testing.assert_array_equal(drawn["total of a tenth of the travel"][:, 0], [10, 100])
