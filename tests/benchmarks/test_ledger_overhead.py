"""The decks that are compared: each has what it is to measure, and nothing else differs."""

from pathlib import Path

import pytest

from benchmarks.ledger_overhead import variants
from benchmarks.ranks import GRIDS, PROCESSORS
from benchmarks.runs import RUN, case_study, own_folders
from bulkwear.workflows.engine.chain import Chain
from tests.support.tiny import tiny_study

STEPS = 100


@pytest.fixture(scope="module")
def decks():
    """The decks of the tiny study's run; nothing is simulated."""
    study, run = tiny_study(), "R9_convex"
    bed = study.beds[study.bed_of(run)]
    chain = Chain(run, Path(run), study.case, study.run(run).parameters, Path("surface.vtu"), bed, Path("bed.restart"))
    return variants(chain, STEPS)


def lines(deck: str) -> set[str]:
    return {line.split("#")[0].strip() for line in deck.splitlines()} - {""}


def test_a_bare_deck_has_the_same_physics_and_nothing_else(decks):
    """No loads, wear, checks or output; materials, contact law, motion and time step are those of the whole deck."""
    bare, whole = ("\n".join(sorted(lines(decks[name]))) for name in ("bare", "whole"))
    for word in ("load_ledger", "mesh/surface/stress", "wear finnie", "store_force", "step_check", "dump ", "force_z"):
        assert word not in bare, word
        assert word in whole, word
    assert [line for line in bare.splitlines() if line.startswith("write_restart")] == []
    for start in ("pair_style", "fix  motion", "fix  gravity", "fix  floor", "timestep", "run "):
        assert [line for line in decks["bare"].splitlines() if line.startswith(start)] == [
            line for line in decks["whole"].splitlines() if line.startswith(start)
        ], start


def test_the_ledger_is_all_that_differs_from_the_plain_deck(decks):
    """One fix, and its end."""
    more = lines(decks["solver"]) - lines(decks["plain"])
    assert {line.split()[1] for line in more} == {"load_ledger"}
    assert not lines(decks["plain"]) - lines(decks["solver"])


def test_each_grid_is_written_into_the_deck(decks):
    """The deck's own choice is replaced, once."""
    for grid in GRIDS.values():
        assert PROCESSORS.sub(f"processors {grid}", decks["solver"]).count(f"processors {grid} ") == 1


def test_no_benchmark_takes_what_another_prepared(tmp_path):
    """Another size of particles or width has folders of its own, the same study the same ones."""
    cases = [case_study(4.0), case_study(3.4), case_study(4.0, 2), case_study(4.0)]
    runs, beds = zip(*(own_folders(tmp_path, study, RUN) for study in cases), strict=True)
    assert len(set(runs)) == len(set(beds)) == len(cases) - 1
    assert (runs[0], beds[0]) == (runs[-1], beds[-1])


def test_a_bed_twice_as_wide_has_twice_the_work():
    """Bed, sample and particles are doubled, length and time step are not."""
    one, two = (case_study(4.0, wider).run(RUN).parameters for wider in (1, 2))
    for section in ("bed", "sample"):
        assert two[section] == {**one[section], "width_m": pytest.approx(2.0 * one[section]["width_m"])}
    assert two["derived"]["bed_particles"] == pytest.approx(2 * one["derived"]["bed_particles"], abs=1)
    assert two["derived"]["time_step_s"] == one["derived"]["time_step_s"]
