"""The figure of the stable time step: a line per groove and restitution, the limit, and pins thrown out."""

import numpy as np
import pandas as pd

from benchmarks.plots.time_step import PANELS, time_step_limit
from bulkwear.postproc.plots.style import remarks_of

RATIOS = [0.5, 0.9, 1.1, 1.3]
GROOVES = {"shallow": 6.4, "deep": 59.3}  # contacts


def figure():
    """Figure of two grooves and two restitutions; the largest time step throws the pin out of the deep one."""
    rows = [
        {"groove": name, "restitution": restitution, "contacts": contacts, "time_step_over_limit": ratio}
        | {column: np.nan if name == "deep" and ratio > 1.2 else ratio * contacts for column in PANELS}
        for name, contacts in GROOVES.items()
        for restitution in (0.5, 0.9)
        for ratio in RATIOS
    ]
    return time_step_limit(pd.DataFrame(rows), ["softened pin"])


def test_every_series_is_drawn_and_named():
    """Each panel has a line per groove and restitution with its values, and the limit at 1; one legend names all."""
    made = figure()
    assert [axes.get_title(loc="left") for axes in made.axes] == [title for title, _ in PANELS.values()]
    for axes in made.axes:
        lines = [line for line in axes.get_lines() if len(line.get_xdata()) == len(RATIOS)]
        assert [line.get_ydata()[0] for line in lines] == [0.5 * c for c in GROOVES.values() for _ in (0.5, 0.9)]
        assert any(set(line.get_xdata()) == {1.0} for line in axes.get_lines())
        assert axes.get_xlabel().endswith("(-)") and axes.get_title(loc="left").endswith("(-)")
    names = [text.get_text() for text in made.legends[0].get_texts()]
    assert names == [
        f"{name}: {contacts:.0f} contacts, restitution {e}"
        for name, contacts in GROOVES.items()
        for e in ("0.5", "0.9")
    ]


def test_pins_thrown_out_are_marked_above_all_else():
    """Where a value is missing a cross stands above every value drawn; the remarks are printed."""
    made = figure()
    for axes in made.axes:
        crosses = [line for line in axes.get_lines() if line.get_marker() == "x" and len(line.get_xdata())]
        assert [line.get_xdata().tolist() for line in crosses] == [[1.3], [1.3]]
        largest = np.nanmax(
            np.concatenate([line.get_ydata() for line in axes.get_lines() if line.get_marker() in "os"])
        )
        assert min(line.get_ydata().min() for line in crosses) > largest
    assert remarks_of(made) == "softened pin"
