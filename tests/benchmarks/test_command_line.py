"""Command lines of benchmarks: where they cannot go on they say why in a sentence."""

import argparse

import pytest

from benchmarks.command_line import TableError, command, output_folder, read_table
from bulkwear.workflows.engine.solver import SolverError

DAMAGED = {
    "empty": (b"", "No columns to parse"),
    "no text": (b"\xff\xfe\x00", "no table"),
    "header alone": (b"model,angle_deg\n", "has no row"),
    "another table": (b"row,wear\nR1,2\n", "no column model;"),
    "a word for a number": (b"model,angle_deg\ncdt,33\nrvd,steep\n", "line 3: angle_deg is 'steep'"),
    "ragged": (b"model,angle_deg\ncdt,33\nrvd,1,2,3\n", "no table"),
}


def raising(fault):
    def main():
        raise fault

    return main


@pytest.mark.parametrize(("content", "said"), DAMAGED.values(), ids=DAMAGED)
def test_a_damaged_table_is_refused_by_its_name(tmp_path, content, said):
    file = tmp_path / "angles.csv"
    file.write_bytes(content)
    with pytest.raises(TableError, match="allowed is") as fault:
        read_table(file, ["model"], ["angle_deg"])
    assert said in str(fault.value) and str(file) in str(fault.value)


def test_a_table_may_have_gaps_where_nothing_was_measured(tmp_path):
    file = tmp_path / "angles.csv"
    file.write_text("model,angle_deg\ncdt,33\nrvd,\n")
    assert read_table(file, ["model"], ["angle_deg"])["angle_deg"].isna().tolist() == [False, True]


def test_results_go_into_a_folder_that_is_made(tmp_path):
    assert output_folder(str(tmp_path / "new" / "docs")).is_dir()
    (tmp_path / "file").write_text("")
    for place in ("file", "file/docs"):
        with pytest.raises(argparse.ArgumentTypeError, match="allowed is a folder"):
            output_folder(str(tmp_path / place))


def test_our_faults_end_in_a_sentence_and_others_in_a_traceback(capsys, tmp_path):
    missing = tmp_path / "missing"
    for fault, said in (
        (SolverError("R5: lost atoms"), "R5: lost atoms\n"),
        (FileNotFoundError(2, "No such file", str(missing)), f"{missing}: No such file, allowed is"),
    ):
        with pytest.raises(SystemExit) as end:
            command(raising(fault))
        assert end.value.code == 1 and said in capsys.readouterr().err
    with pytest.raises(KeyError):
        command(raising(KeyError("a defect of ours")))


def test_a_command_hands_on_its_exit_code():
    for code in (0, 1):
        with pytest.raises(SystemExit) as end:
            command(lambda code=code: code)
        assert end.value.code == code
