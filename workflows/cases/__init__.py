"""The cases that a study can be about. To add one: a subclass of `Case`, its line here and in the study's schema, its
settings in config/cases and its schemas in workflows/schemas/cases.
"""

from __future__ import annotations

from workflows.cases.base import Case
from workflows.cases.calibration import Calibration
from workflows.cases.circular_tester import CircularTester
from workflows.cases.pin_on_disc import PinOnDisc
from workflows.cases.sliding_sample import SlidingSample

DEFAULT_CASE = "sliding_sample"
CASES: dict[str, Case] = {
    "sliding_sample": SlidingSample(),
    "pin_on_disc": PinOnDisc(),
    "calibration": Calibration(),
    "circular_tester": CircularTester(),
}
