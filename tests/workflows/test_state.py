"""Cycles of other inputs are kept aside; the solver's part is in test_cycles.py."""

from workflows import state

FILES = ("surface.vtu",)


def finished_cycle(run, cycle, inputs):
    """A finished cycle with one file."""
    with state.working_folder(run, cycle) as folder:
        (folder / FILES[0]).write_text(f"{inputs} {cycle}")
        state.write_state(folder, inputs, FILES, {})


def test_unfinished_cycles_of_other_inputs_are_removed(tmp_path):
    """What a killed run left as .part stays for the same inputs, goes with the cycles of others, comes back never."""
    for cycle in range(2):
        finished_cycle(tmp_path, cycle, "old")
    (tmp_path / "cycle_020.part").mkdir()
    assert state.set_aside_others(tmp_path, "old") is None
    assert (tmp_path / "cycle_020.part").is_dir()
    assert "its inputs changed" in state.set_aside_others(tmp_path, "new")
    assert not list(tmp_path.glob("cycle_*"))
    assert "brought back" in state.set_aside_others(tmp_path, "old")
    assert state.finished_cycles(tmp_path, "old") == 2
    assert sorted(path.name for path in tmp_path.glob("cycle_*")) == ["cycle_000", "cycle_001"]
