"""Records that are sealed: every changed letter that changes what they say is noticed, and the file is named."""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.records import RecordError, read_record, write_record
from bulkwear.workflows.engine.row_check import RowCheck
from bulkwear.workflows.engine.wear_step import TOTALS

RECORD = {
    "inputs": "a" * 64,
    "files": {"surface.vtu": "b" * 64},
    "wear": {"cycle": 3, "worn_volume_m3": 1.2345678901234567e-9, "deciding_width": math.inf, "phase": "start_up"},
    "span": None,
    "solver": "Version 3.8.0, \u00fcber",
}


def test_a_record_comes_back_as_it_was_written(tmp_path):
    """Numbers to the last bit, infinity and letters of all kinds included; nothing else is left in the folder."""
    path = tmp_path / "state.json"
    write_record(path, RECORD)
    assert read_record(path) == RECORD
    assert [each.name for each in tmp_path.iterdir()] == ["state.json"]


def test_every_flipped_bit_is_noticed(tmp_path_factory):
    """A flip leaves the same record, or a fault that names the file; never another record."""
    path = tmp_path_factory.mktemp("flips") / "state.json"
    write_record(path, RECORD)
    content = path.read_bytes()

    @settings(max_examples=1000, deadline=None)
    @given(st.integers(0, 8 * len(content) - 1))
    def noticed(bit):
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        try:
            assert read_record(path) == RECORD
        except RecordError as fault:
            assert str(path) in str(fault)

    noticed()


@pytest.mark.parametrize(
    "text", [b"", b"{", b"null", b"[]", b"\xff\xfe", b"[" * 100_000, b'{"a": 1' + b"0" * 5000 + b"}"]
)
def test_what_is_no_record_is_torn(tmp_path, text):
    """Whatever stands in the file, the fault is a sentence."""
    path = tmp_path / "state.json"
    path.write_bytes(text)
    with pytest.raises(RecordError, match=r"state\.json: the record is torn"):
        read_record(path)


def test_a_record_of_an_earlier_version_still_counts(tmp_path):
    """Records were not sealed once; what they say is taken."""
    path = tmp_path / "state.json"
    path.write_text(json.dumps(RECORD))
    assert read_record(path) == RECORD


def worn_cycle(run, cycle, before, worn=2e-9, changes=()):
    """A finished cycle with a row that adds some volume; returns its row."""
    row = {"cycle": cycle} | dict.fromkeys(TOTALS.values(), worn)
    row |= {total: before.get(total, 0.0) + worn for total in TOTALS} | dict(changes)
    with state.working_folder(run, cycle) as folder:
        (folder / "surface.vtu").write_text(f"cycle {cycle}")
        state.write_state(folder, "same", ("surface.vtu",), {"wear": row, "span": {"cycle": cycle}})
    return row


@pytest.mark.parametrize("total", TOTALS)
def test_rows_that_contradict_their_totals_do_not_count(tmp_path, total):
    """Ten times the volume beside the total of before: the cycle is made again, and the sentence names its record."""
    said, before = [], {}
    with state.working_folder(tmp_path, 0) as folder:
        state.write_state(folder, "same", (), {"span": None})
    for cycle in range(1, 5):
        before = worn_cycle(tmp_path, cycle, before, changes={TOTALS[total]: 2e-8} if cycle == 3 else {})
    count = state.finished_cycles(tmp_path, "same", faulty=RowCheck().fault, say=said.append)
    assert count == 3
    assert len(said) == 1 and f"cycle_003/state.json: {total} is" in said[0] and "cycle_003 is made again" in said[0]


def test_a_row_of_another_cycle_does_not_count(tmp_path):
    """The number in a row is that of its span."""
    with state.working_folder(tmp_path, 0) as folder:
        state.write_state(folder, "same", (), {"span": None})
    worn_cycle(tmp_path, 1, {}, changes={"cycle": 7})
    assert state.finished_cycles(tmp_path, "same", faulty=RowCheck().fault) == 1


@pytest.mark.parametrize("text", ["cycle 2", "another one"])
def test_a_cycle_made_again_keeps_what_follows_where_it_is_the_same(tmp_path, text):
    """After a damaged record the cycle is made again; later cycles hold if it left the same files, and wait aside if
    not."""
    for cycle in range(5):
        worn_cycle(tmp_path, cycle, {})
    record = tmp_path / "cycle_002" / state.STATE
    record.write_text(record.read_text().replace("cycle", "cycel", 1))
    said = []
    assert state.finished_cycles(tmp_path, "same", say=said.append) == 2
    assert f"{record}: the record is not as it was written" in said[0]
    with state.working_folder(tmp_path, 2) as folder:
        (folder / "surface.vtu").write_text(text)
        state.write_state(folder, "same", ("surface.vtu",), {})
    assert state.finished_cycles(tmp_path, "same") == (5 if text == "cycle 2" else 3)
    aside = sorted(path.name for path in (tmp_path / "superseded" / "damaged").iterdir())
    assert aside == (["cycle_002"] if text == "cycle 2" else ["cycle_002", "cycle_003", "cycle_004"])


def test_a_damaged_first_record_does_not_set_a_run_aside(tmp_path):
    """The inputs of a run are told by the first record that is whole."""
    for cycle in range(3):
        worn_cycle(tmp_path, cycle, {})
    (tmp_path / "cycle_000" / state.STATE).write_text("{")
    assert state.set_aside_others(tmp_path, "same") is None
    assert len(list(tmp_path.glob("cycle_00?"))) == 3
