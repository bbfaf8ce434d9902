"""Folders of finished cycles."""

from bulkwear.postproc.readers.cycle_folders import cycle_files, cycle_folders, step_files


def test_cycles_come_by_number_and_unfinished_ones_do_not(tmp_path):
    """Cycle 1000 comes after 999; what a killed run left as .part is no cycle, nor is anything else of such a name."""
    for name in ("cycle_1000", "cycle_999", "cycle_000", "cycle_020.part", "cycle_x"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "forces.csv").touch()
    (tmp_path / "cycle_000" / "forces.csv").unlink()
    assert [folder.name for folder in cycle_folders(tmp_path)] == ["cycle_000", "cycle_999", "cycle_1000"]
    found = cycle_files(tmp_path, "forces.csv")
    assert [path.relative_to(tmp_path).as_posix() for path in found] == [
        "cycle_999/forces.csv",
        "cycle_1000/forces.csv",
    ]


def test_files_come_by_time_step_and_those_of_a_users_own_deck_do_not(tmp_path):
    """Step 1000 comes after 200; words in the place of the step make a file none of the solver's."""
    for name in ("bed_1000.dump", "bed_200.dump", "bed_mine_300.dump", "bed_.dump", "bed_4.dump.gz", "bed_x.dump"):
        (tmp_path / name).touch()
    assert [path.name for path in step_files(tmp_path, "bed_", ".dump")] == ["bed_200.dump", "bed_1000.dump"]
