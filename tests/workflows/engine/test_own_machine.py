"""What a machine with a deck of one's own is refused for, before the solver starts."""

from dataclasses import replace

import pytest

from bulkwear.workflows.engine import own_machine as module
from tests.workflows.cases.equipment.scenes import box

PART = module.Part("liner", box((0.4, 0.1, 0.03), 0.05), box((0.4, 0.1, 0.03), 0.05))
STEPS, TIME_STEP, COEFFICIENT = 100, 1e-6, 1e-12


@pytest.mark.parametrize(
    ("parts", "changes", "sentence"),
    [
        ([], {}, "parts is empty"),
        ([replace(PART, name="left liner")], {}, "a part is called 'left liner', allowed are letters"),
        ([PART, PART], {}, "each name once"),
        ([PART], {"cycle_steps": 0}, "cycle_steps is 0, allowed are 1 or more"),
        ([PART], {"time_step_s": 0.0}, "time_step_s is 0, allowed are values above 0"),
        ([PART], {"coefficient_per_pa": -1e-12}, "coefficient_per_pa is -1e-12, allowed are values above 0"),
        ([PART], {"coefficient_per_pa": float("nan")}, "coefficient_per_pa is nan"),
        ([PART], {"deck": "gone.in"}, "gone.in: there is no such deck"),
        ([PART], {"folder": "."}, "update_000 is there already"),
    ],
)
def test_nothing_is_written_or_simulated_of_what_is_wrong(tmp_path, monkeypatch, parts, changes, sentence):
    """The sentence comes first, so that the corrected call finds an empty folder."""
    monkeypatch.setattr(module, "run_deck", lambda *given, **more: pytest.fail("the solver was called"))
    (tmp_path / "deck.in").write_text("units si\n")
    (tmp_path / "update_000").mkdir()
    given = {"folder": "new", "deck": "deck.in", "cycle_steps": STEPS, "time_step_s": TIME_STEP}
    given |= {"coefficient_per_pa": COEFFICIENT} | changes
    given |= {name: tmp_path / given[name] for name in ("folder", "deck")}
    with pytest.raises((ValueError, FileExistsError), match=sentence):
        next(module.wear_machine(parts=parts, updates=1, **given))
    assert not (tmp_path / "new").exists()
