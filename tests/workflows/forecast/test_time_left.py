"""Time left of a study: its forecast, set right by how long its jobs took."""

import pandas as pd

from bulkwear.workflows.forecast.time_left import TimeLeft

SLOWER = 3.0  # -, than forecast


def test_time_left_is_the_forecast_at_the_pace_so_far():
    """Of three jobs one after the other the first takes three times its forecast: so will the others."""
    now = [0.0]
    hours = [1.0, 2.0, 3.0]
    table = pd.DataFrame({"job": ["a", "b", "c"], "wall_h": hours, "cores": 1, "needs": ""})
    left = TimeLeft("demo", table, 1, lambda: now[0])
    now[0] = SLOWER * hours[0] * 3600.0
    assert (
        left.finished("a") == f"demo: 1 of 3 jobs of the solver done, about {SLOWER * sum(hours[1:]):.0f} h 0 min left"
    )
    left.finished("b")
    assert left.finished("c") == "demo: 3 of 3 jobs of the solver done; tables, figures and page follow"


def test_no_time_left_before_there_is_a_pace():
    """Of two jobs side by side the shorter one, done first, tells nothing of the longer."""
    table = pd.DataFrame({"job": ["a", "b"], "wall_h": [1.0, 2.0], "cores": 1, "needs": ""})
    assert TimeLeft("demo", table, 2).finished("a") == "demo: 1 of 2 jobs of the solver done"
