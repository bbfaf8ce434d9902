"""A little of `make chaos`: files and configurations under faults, without the solver."""

import random
import re
import shutil

import pytest

from benchmarks import chaos_files
from benchmarks.chaos import BAD, SAMPLES, SEED, page, samples_of_users, spoilt_project, table_of, with_part
from benchmarks.chaos_files import CAD_MACHINES, READERS, SPINS, Outcome, files_of_studies
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.wear_step import TOTALS

FLIPS, READS, CONFIGURATIONS = 150, 250, 25
SOURCES = {"loads.vtk": "bed_loads.vtk", "contacts.dump": "slide_contacts.dump", "spins.dump": "slide_spins.dump"}


@pytest.fixture
def chance():
    return random.Random(SEED)


def nothing_bad(outcome):
    """Whether nothing was lost, wrong, hung or ended in a traceback; what did is shown."""
    assert not any(getattr(outcome, name) for name in BAD), outcome.said
    return outcome.tried == outcome.refused + outcome.unchanged


def test_flipped_bits_in_finished_cycles_are_noticed(tmp_path, chance):
    """In records, restart files, surfaces and tables alike."""
    before = {}
    for cycle in range(3):
        row = {"cycle": cycle} | dict.fromkeys(TOTALS.values(), 1e-9)
        row |= {total: before.get(total, 0.0) + row[part] for total, part in TOTALS.items()}
        with state.working_folder(tmp_path, cycle) as folder:
            for name in ("run.restart", "surface.vtu", "forces.csv"):
                (folder / name).write_bytes(chance.randbytes(200))
            record = {"wear": row, "span": {"cycle": cycle}} if cycle else {"span": None}
            state.write_state(folder, "same", ("run.restart", "surface.vtu", "forces.csv"), record)
        before = row if cycle else {}
    outcome = chaos_files.flipped_bits(tmp_path, "same", FLIPS, chance)
    assert nothing_bad(outcome) and outcome.refused > FLIPS // 2
    assert state.finished_cycles(tmp_path, "same") == 3


def test_mutated_files_are_read_or_refused(tmp_path, chance):
    """A reader returns, or says in one sentence which file is wrong."""
    for name, source in SOURCES.items():
        shutil.copy(SAMPLES / source, tmp_path / name)
    samples_of_users(tmp_path)
    samples = sorted({*tmp_path.iterdir()} - {tmp_path / name for name in (SPINS, *CAD_MACHINES)})
    here = tmp_path / "reading"
    shutil.copytree(tmp_path, here)
    assert {path.name for path in samples} <= set(READERS)
    assert nothing_bad(chaos_files.mutated_files(samples, here, READS, chance, "files"))


@pytest.mark.verify
def test_mutated_configurations_are_loaded_or_refused(tmp_path, chance):
    """Each study in turn loads, or one sentence says what is wrong with it."""
    project = spoilt_project(tmp_path / "project")
    studies = files_of_studies(project)
    assert len(studies) >= 11 and all(len(files) == len(set(files)) >= 5 for files in studies.values())
    outcome = chaos_files.mutated_configurations(project, studies, CONFIGURATIONS, chance)
    assert nothing_bad(outcome) and outcome.refused


def test_what_is_not_told_counts_as_a_traceback():
    """The measure itself: a fault without a sentence, and one that nobody meant."""
    outcome = Outcome("faults")
    for fault in (KeyError("worn_um"), ValueError("two\nlines"), RecursionError("too deep")):

        def raises(fault=fault):
            raise fault

        chaos_files.attempt(outcome, raises, "a file", lambda fault: isinstance(fault, ValueError))
    assert (outcome.tried, outcome.tracebacks) == (3, 3)


def test_the_page_has_a_row_per_kind_of_fault():
    """With what must be 0 beside what was tried."""
    text = page(table_of("files", [Outcome("flips", tried=7, refused=7)], SEED))
    assert re.search(rf"\| {SEED} \| \d{{4}}-\d\d-\d\d \| flips \| 7 \| 7 \| 0 \| 0 \| 0 \| 0 \| 0 \|", text)


def test_a_part_that_is_tried_again_takes_the_place_of_its_rows():
    """Those of other parts stay, and all keep their order."""
    first = table_of("runs", [Outcome("kills", tried=3)], SEED)
    both = with_part(first, "files", table_of("files", [Outcome("flips", tried=7), Outcome("reads", tried=2)], SEED))
    assert list(both["what"]) == ["flips", "reads", "kills"]
    again = with_part(both, "files", table_of("files", [Outcome("flips", tried=9)], SEED + 1))
    assert list(again["what"]) == ["flips", "kills"] and list(again["tried"]) == [9, 3]
    assert list(again["seed"]) == [SEED + 1, SEED]
