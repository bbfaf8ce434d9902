"""A bed in a window that travels with the sample: what its decks are told, and when they exchange bed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from workflows.engine.derived import ROUNDING, WINDOW, window_lengths


def window(
    run: Mapping[str, Any], bed: Mapping[str, Any], steps_before: int, steps: int, packing: str, look: int = 0
) -> dict[str, Any]:
    """Return what the travelling window needs in a deck (SI); nothing where there is none.

    steps_before: of the bed in motion, before the deck's step 0; steps: of the deck; packing: path of its file
    look: steps between two looks at the wear inside the deck, 0: none
    """
    if bed["ends"] != WINDOW:
        return {}
    strip, clearance = window_lengths(bed["particle"])
    per_step = run["sliding"]["velocity_m_per_s"] * run["derived"]["time_step_s"]
    every = max(int(run["bed"]["exchange_m"] / per_step * (1.0 + ROUNDING)), 1)
    return {
        "face_m": bed["start_m"] + clearance,
        "strip_length_m": strip,
        "clearance_m": clearance,
        "period_m": bed["length_m"],
        "packing_file": packing,
        "travel_per_step_m": per_step,
        "steps_before": steps_before,
        "exchange_steps": [*exchange_steps(steps_before, steps, every, look), steps + 1],
    }


def exchange_steps(steps_before: int, steps: int, every: int, look: int = 0) -> list[int]:
    """Return the steps of a deck at which a window exchanges bed: every so many of the bed in motion, from its start.

    The deck begins after `steps_before` steps of the bed in motion, less than none where it is set in motion within it.
    What falls on a look at the wear (every `look` steps, 0: none) is done one step later: a run that ended with a look
    would take it for the ledger of the whole cycle. An exchange at the deck's first instant is of the deck before.
    """
    first = max(-(-(steps_before + 1) // every), 0) * every - steps_before
    return [step + (look > 0 and step < steps and step % look == 0) for step in range(first, steps + 1, every)]
