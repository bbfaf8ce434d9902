"""Lights of a verdict: what they look at, and from where on they warn."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.steady import DRIFTING, FEWEST_VALUES, STEADY, UNSAID
from bulkwear.workflows.report import verdict
from bulkwear.workflows.report.sections import CARE, SOUND, WEAK
from bulkwear.workflows.report.time_step import time_step_light


@pytest.mark.parametrize(
    ("answers", "state"), [([STEADY] * 2, SOUND), ([STEADY, UNSAID], CARE), ([STEADY, UNSAID, DRIFTING], WEAK)]
)
def test_the_worst_run_decides_whether_runs_are_steady(answers, state):
    """One that still changes makes it weak, one of which nothing can be said calls for care."""
    assert verdict.steady_light(answers).state == state


@pytest.mark.parametrize(("carried", "state"), [(0.0, SOUND), (0.05, CARE), (0.5, WEAK)])
def test_what_caps_hold_back_is_told(carried, state):
    """By the run that carries the largest share of its wear."""
    summary = pd.DataFrame({"carried_volume_m3": [0.0, carried], "worn_volume_m3": 1.0})
    light = verdict.cap_light({"settings": {"wear": {"deform": True}}}, summary)
    assert light.state == state and (f"{100.0 * carried:.2g} %" in light.said) == (state != SOUND)
    nothing = summary.assign(carried_volume_m3=0.0, worn_volume_m3=0.0)
    for deform, table in ((False, summary), (True, nothing)):  # a machine without updates wears nothing
        kept = verdict.cap_light({"settings": {"wear": {"deform": deform}}}, table)
        assert kept.state == CARE and "kept as built" in kept.said
    rigid = pd.DataFrame({"carried_volume_m3": [carried, 1.0], "worn_volume_m3": 1.0, "deform": [True, False]})
    assert verdict.cap_light({"settings": {"wear": {"deform": True}}}, rigid) == light


@pytest.mark.parametrize(("packings", "state"), [(1, WEAK), (2, CARE), (verdict.ENOUGH_PACKINGS, SOUND)])
def test_the_setting_of_fewest_packings_decides(packings, state):
    """Of one packing the scatter is unknown, and it is said."""
    counts = {"A": verdict.ENOUGH_PACKINGS, "B": packings}
    design = pd.DataFrame([{"setting": name, "packing": k} for name, count in counts.items() for k in range(count)])
    light = verdict.packings_light(design)
    assert light.state == state and ("unknown" in light.said) == (packings == 1)


def test_rows_that_were_not_run_are_named():
    """A whole design says nothing; of a long list the first ones are named and the others counted."""
    assert verdict.left_out_words([]) == []
    names = [f"R{number}" for number in range(verdict.MOST_NAMED + 2)]
    assert "Not run: R0, R1 of the design." in verdict.left_out_words(names[:2])[0]
    assert "R4 and 2 more of the design" in verdict.left_out_words(names)[0]


def test_particles_of_another_size_call_for_care():
    """The scale is told; particles of their true size are sound."""
    runs = {f"run_{scale:g}": {"particle": {"scale": scale}} for scale in (1.0, 2.5)}
    light = verdict.scale_light({"parameters": runs})
    assert light.state == CARE and "1 to 2.5" in light.said
    assert verdict.scale_light({"parameters": {"run_1": runs["run_1"]}}).state == SOUND


def test_wear_per_metre_tells_whether_a_run_is_steady():
    """Even wear is steady, wear that doubles is not; of few cycles, and of uneven ones, nothing is said."""
    cycles = np.arange(1, 4 * FEWEST_VALUES + 1)
    even = pd.DataFrame({"travel_m": 0.1 * cycles, "worn_volume_m3": 1e-9 * (1.0 + 1e-4 * (cycles % 2))})
    assert verdict._steady(even) == STEADY
    assert verdict._steady(even.assign(worn_volume_m3=1e-9 * (1.0 + cycles / len(cycles)))) == DRIFTING
    assert verdict._steady(even.head(FEWEST_VALUES - 1)) == UNSAID
    uneven = verdict._steady(even.assign(travel_m=0.1 * cycles**1.1))
    assert uneven == verdict.UNEVEN_CYCLES
    said = [verdict.steady_light(answers).said for answers in ([UNSAID, STEADY], [uneven], [uneven, uneven, UNSAID])]
    assert said[0] == "Of 1 of 2 runs it cannot be said: they are too short."
    assert said[1] == "Of 1 of 1 runs it cannot be said: they are of wear cycles of unequal travel."
    assert said[2] == "Of 3 of 3 runs it cannot be said: 1 too short, 2 of wear cycles of unequal travel."


def test_a_time_step_beyond_what_is_shown_calls_for_care():
    """By the longest step under each rolling model; a model without a limit is named."""

    def light(*solvers):
        runs = [{"rolling_friction": model, "rayleigh_fraction": fraction} for model, fraction in solvers]
        study = {"parameters": {str(number): {"solver": run} for number, run in enumerate(runs)}}
        return time_step_light(study, {"own_spin": 0.2, "cdt": 0.3})

    assert light(("own_spin", 0.05), ("own_spin", 0.2)).state == SOUND
    found = light(("own_spin", 0.1), ("cdt", 0.05), ("cdt", 0.4))
    assert found.state == CARE and "0.4 of the Rayleigh time under cdt, shown up to 0.3" in found.said
    assert "own_spin" not in found.said
    assert "under off, of which no limit is shown" in light(("off", 0.1)).said
