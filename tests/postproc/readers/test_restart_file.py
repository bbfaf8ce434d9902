"""Restart files of the solver itself: whole ones are read, and none that lost anything."""

import shutil

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bulkwear.postproc.readers import restart_file
from bulkwear.postproc.readers.restart_file import RestartFileError, read_restart
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.workflows.engine.solver import DECK, LOG, run_deck
from tests import REPOSITORY

DATA = REPOSITORY / "tests" / "data"
STEPS, TYPES, PAGE = 600, 2, 4096  # types as the deck has them
pytestmark = pytest.mark.solver


@pytest.fixture(scope="module", params=[1, 2])
def restart(request, tmp_path_factory):
    """(restart file of a bed on a plate, its particles by the log, ranks that wrote it)."""
    folder = tmp_path_factory.mktemp("restart")
    shutil.copy(DATA / "plate.stl", folder)
    deck = (DATA / "bed_on_plate.in").read_text().replace("variable steps index 6000", f"variable steps index {STEPS}")
    (folder / DECK).write_text(f"{deck}\nwrite_restart run.restart\n")
    run_deck(folder, ranks=request.param)
    return folder / "run.restart", thermo_table(folder / LOG)["Atoms"][-1], request.param


def test_a_whole_restart_file_tells_its_particles(restart):
    """Step, particles, ranks and types of the header; the particles are those of the solver's log."""
    path, particles, ranks = restart
    assert read_restart(path) == (STEPS + 1, particles, ranks, TYPES)


def test_records_may_lie_across_blocks(restart, monkeypatch):
    """Read a few numbers at a time, fewer than a particle has, the file tells the same, and is not whole when cut."""
    path, particles, _ = restart
    monkeypatch.setattr(restart_file, "BLOCK_NUMBERS", 7)
    assert read_restart(path).particles == particles
    cut = path.with_name("cut.restart")
    cut.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(RestartFileError):
        read_restart(cut)


def test_what_lost_a_byte_or_a_page_is_not_whole(restart):
    """Cut anywhere, without a piece in its middle, or with more behind: refused, and the file is named."""
    path, _, _ = restart
    content, damaged = path.read_bytes(), path.with_name("damaged.restart")

    @settings(max_examples=100, deadline=None)
    @given(st.integers(0, len(content) - 1), st.integers(1, len(content)))
    @example(content.index(b"gran\0") + 10, 1)  # of the contact model's number
    def refused(begin, length):
        damaged.write_bytes(content[:begin] + content[begin + length :])
        with pytest.raises(RestartFileError, match=r"damaged.restart: the restart file of \d+ bytes is not whole"):
            read_restart(damaged)

    refused()
    for wrong in (b"", content[:-8], content[PAGE:], content + bytes(8), bytes(len(content))):
        damaged.write_bytes(wrong)
        with pytest.raises(RestartFileError):
            read_restart(damaged)


def test_a_missing_restart_file_is_said(tmp_path):
    """A file that is not there is a fault of its own."""
    with pytest.raises(RestartFileError, match=r"no\.restart: the restart file cannot be read \(No such file"):
        read_restart(tmp_path / "no.restart")
