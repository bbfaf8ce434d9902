"""Cycles of other inputs are kept aside; the solver's part is in test_reused_cycles.py."""

import pytest

from bulkwear.workflows.engine import state

FILES = ("surface.vtu",)


def finished_cycle(run, cycle, inputs):
    """A finished cycle with one file."""
    with state.working_folder(run, cycle) as folder:
        (folder / FILES[0]).write_text(f"{inputs} {cycle}")
        state.write_state(folder, inputs, FILES, {})


def test_unfinished_cycles_go_with_the_finished_ones(tmp_path):
    """What a killed run left as .part stays for the same inputs, goes with the cycles of others and comes back."""
    for cycle in range(2):
        finished_cycle(tmp_path, cycle, "old")
    (tmp_path / "cycle_020.part").mkdir()
    assert state.set_aside_others(tmp_path, "old") is None
    assert (tmp_path / "cycle_020.part").is_dir()
    assert "its inputs changed" in state.set_aside_others(tmp_path, "new")
    assert not list(tmp_path.glob("cycle_*"))
    assert "brought back" in state.set_aside_others(tmp_path, "old")
    assert state.finished_cycles(tmp_path, "old") == 2
    assert sorted(path.name for path in tmp_path.glob("cycle_*")) == ["cycle_000", "cycle_001", "cycle_020.part"]


def test_a_run_that_becomes_shorter_and_longer_again_loses_no_cycle(tmp_path):
    """Cycles beyond a shorter run's end wait aside, come back for a longer one, and do not for other inputs."""
    for cycle in range(12):
        finished_cycle(tmp_path, cycle, "same")
    assert state.fit_length(tmp_path, "same", None) is state.fit_length(tmp_path, "same", 12) is None
    assert "is shorter now" in state.fit_length(tmp_path, "same", 3)
    assert [path.name for path in sorted(tmp_path.glob("cycle_*"))] == ["cycle_000", "cycle_001", "cycle_002"]
    assert "9 cycles of it were brought back" in state.fit_length(tmp_path, "same", 20)
    assert state.finished_cycles(tmp_path, "same") == 12
    state.fit_length(tmp_path, "same", 3)
    state.set_aside_others(tmp_path, "new")
    finished_cycle(tmp_path, 0, "new")
    assert state.fit_length(tmp_path, "new", 12) is None
    assert state.finished_cycles(tmp_path, "new") == 1
    assert "brought back" in state.set_aside_others(tmp_path, "same")
    assert "later cycles are kept" in state.fit_length(tmp_path, "same", 11)
    assert state.finished_cycles(tmp_path, "same") == 11


@pytest.mark.parametrize(
    "text", ["", '{"inputs": "sa', "null", "[]", '{"inputs": "same", "files": null}', '{"files": {}}']
)
def test_a_torn_state_is_no_cycle(tmp_path, text):
    """A state that a full disk or a lost machine left unfinished is that of no finished cycle and stops no run."""
    finished_cycle(tmp_path, 0, "same")
    (tmp_path / "cycle_000" / state.STATE).write_text(text)
    assert state.finished_cycles(tmp_path, "same") == 0


def test_cycles_are_shared_only_where_inputs_are_the_same(tmp_path):
    """A run gets what it lacks of another run's whole cycles; damaged ones and those of other inputs stay there."""
    one, other = tmp_path / "R1_plain", tmp_path / "R8_plain"
    for cycle in range(4):
        finished_cycle(one, cycle, "same")
    finished_cycle(other, 0, "same")
    (one / "cycle_003" / FILES[0]).write_text("damage")
    own = (other / "cycle_000" / state.STATE).read_text()
    assert state.share_cycles(other, one, "different") == 0
    assert state.share_cycles(other, one, "same") == 2
    assert state.finished_cycles(other, "same") == 3
    assert (other / "cycle_000" / state.STATE).read_text() == own
    assert [state.read_state(other, cycle).get("shared_with") for cycle in range(3)] == [None, "R1_plain", "R1_plain"]
    assert state.share_cycles(other, one, "same") == 0
    finished_cycle(one, 3, "same")
    assert state.share_cycles(other, one, "same") == 1


def test_a_run_goes_on_from_its_own_cycles(tmp_path):
    """A run with a wear cycle of its own takes none of another's: they do not go on from where it stands."""
    one, other = tmp_path / "R1_plain", tmp_path / "R8_plain"
    for cycle in range(4):
        finished_cycle(one, cycle, "same")
    for cycle in range(2):
        finished_cycle(other, cycle, "same")
    assert state.share_cycles(other, one, "same") == 0
    assert state.finished_cycles(other, "same") == 2


def test_what_one_run_drops_the_other_keeps(tmp_path):
    """Shared files are each run's own: what one removes is still there for the other, whose cycles stay whole."""
    one, other = tmp_path / "R1_plain", tmp_path / "R8_plain"
    finished_cycle(one, 0, "same")
    state.share_cycles(other, one, "same")
    state.drop_files(state.cycle_folder(one, 0), FILES)
    assert (other / "cycle_000" / FILES[0]).read_text() == "same 0"
    assert state.finished_cycles(other, "same") == state.finished_cycles(one, "same") == 1
