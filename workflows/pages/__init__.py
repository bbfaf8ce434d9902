"""What a study's page and figures say that depends on its case: one module per case.

Each has KEY_NUMBERS, a template of workflows/report, and FURTHER_TEMPLATES that it includes; run_columns() of the table
of runs, RUNS_NOTE below it; remarks() of every figure; simplifications() and further_cap(); DECKS to be shown. What its
template shows is in a module beside it, which only the page imports.
"""

from __future__ import annotations

from types import ModuleType

from workflows.pages import calibration, circular_tester, pin_on_disc, sliding_sample

PAGES: dict[str, ModuleType] = {
    "sliding_sample": sliding_sample,
    "pin_on_disc": pin_on_disc,
    "calibration": calibration,
    "circular_tester": circular_tester,
}
