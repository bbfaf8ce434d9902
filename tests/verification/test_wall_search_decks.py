"""Every deck of the project, and LIGGGHTS' tutorials with walls of meshes, by either search for contacts with meshes:
the same to the last bit, on one process.

Takes some minutes. The tutorials are those of a clone of LIGGGHTS-PUBLIC, whose folder examples/LIGGGHTS/
Tutorials_public the environment names as LIGGGHTS_TUTORIALS; without it they are left out.
"""

from __future__ import annotations

import io
import os
import re
import shutil
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from bulkwear.postproc.flow.bulk_test import HEAP
from bulkwear.workflows.cases.calibration.boxes import test_of as bulk_test_of
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.bulk_simulations import FILLED
from bulkwear.workflows.engine.bulk_tests import write_test
from bulkwear.workflows.engine.chain import RESTART, SURFACE, Chain, write_bed
from bulkwear.workflows.engine.cycles import BED_RESTART, HISTORY, LEDGER, run_cycle
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.schedule import first_span
from bulkwear.workflows.engine.solver import DECK, LEDGER_EXECUTABLE, SCREEN, SEARCHES, run_deck
from bulkwear.workflows.engine.state import cycle_folder
from tests.support.bulk_boxes import PAIR, SEED, small
from tests.support.own_machine_project import machine_chain, machine_study
from tests.support.tiny import tiny_chain, tiny_study
from tests.support.tiny_tester import tiny_tester
from tests.verification.test_circular_tester_ring import RING
from tests.verification.test_wall_shear import SMALL
from tests.workflows.cases.pin_on_disc.test_case import pin_chain, tiny_pin
from tests.workflows.cases.sliding_sample.test_clumps import clumps
from tests.workflows.cases.sliding_sample.test_window import window_study
from tests.workflows.engine.test_contact_model import ONE_BY_ONE, PROPERTIES

pytestmark = [pytest.mark.solver, pytest.mark.verify]

LONG_STEPS = {"rayleigh_fraction": 0.4}  # as in most studies
TESTERS: dict[str, Mapping[str, Any]] = {"channel": {}, "ring": {"tester": RING}}
SLIDING = {
    "between end walls": tiny_study,
    "closed on itself": lambda: tiny_study(bed={"ends": "periodic", "ahead_mm": 80}),
    "in a window that travels": window_study,
    "clumps": clumps,
}
SMALL_DRAW_DOWN = {"length_mm": 250, "fill_height_mm": 100, "fill_mass_kg_per_m": 35.0}
SMALL_DRAW_DOWN |= {"lower_height_mm": 150, "opening_mm": 80}
TUTORIALS = {"chute_wear": "granwalls", "conveyor": "wall", "meshGran": "granwalls", "movingMeshGran": "bucket_wall"}
TUTORIAL_STEPS = 40_000  # of each `run` at most
LAST_STATE = (
    "write_dump all custom last.dump id x y z vx vy vz fx fy fz omegax omegay omegaz modify sort id format"
    f' "%d{12 * " %.17g"}"'
)


CHAINS: dict[str, Callable[[Path], Chain]] = {
    **{f"bed {name}": lambda folder, make=make: tiny_chain(make(), folder) for name, make in SLIDING.items()},
    **{
        " ".join(["contact model", *chosen.values()]): lambda folder, chosen=chosen: tiny_chain(
            tiny_study(solver=PROPERTIES | chosen), folder
        )
        for chosen in ONE_BY_ONE
    },
    **{
        f"tester, {name}": lambda folder, given=given: tiny_chain(
            tiny_tester(solver=LONG_STEPS, **given), folder, "convex"
        )
        for name, given in TESTERS.items()
    },
    "pin on a disc": lambda folder: pin_chain(tiny_pin(), folder / "pin"),
}


def written(folder: Path, *names: str) -> dict[str, bytes]:
    """{name: content} of what is there of those files."""
    return {name: (folder / name).read_bytes() for name in names if (folder / name).is_file()}


def first_cycles(chain: Chain, folder: Path, search: str) -> dict[str, dict[str, bytes]]:
    """What the run-in and the first wear cycle of a run leave, their contacts with meshes found by a search."""
    settings = {**chain.parameters, "solver": {**chain.parameters["solver"], "search": search}}
    folder.mkdir()
    given = replace(chain, folder=folder, parameters=settings, surface=shutil.copy(chain.surface, folder))
    inputs, found = inputs_digest(given), {}
    for cycle, span in enumerate((None, first_span(settings))):
        run_cycle(given, span, inputs, Progress(search, 1))
        place = cycle_folder(folder, cycle)
        assert f": {search}, " in (place / SCREEN).read_text()
        found[place.name] = written(place, RESTART, LEDGER, SURFACE, HISTORY)
    return found


def assert_same(chain: Chain) -> None:
    """Restart files, ledgers, history and worn surface do not depend on who searches.

    Ledgers are compared as numbers: where a triangle bears nothing, the library's own stress is -0, ours 0.
    """
    ours, stock = (first_cycles(chain, chain.folder.parent / search, search) for search in SEARCHES)
    assert [set(files) for files in ours.values()] == [{RESTART}, {RESTART, LEDGER, SURFACE, HISTORY}]
    tables = [pd.read_parquet(io.BytesIO(found["cycle_001"].pop(LEDGER))) for found in (ours, stock)]
    pd.testing.assert_frame_equal(*tables, check_exact=True)
    assert tables[0]["sliding_work_J"].sum() > 0.0
    assert ours == stock


@pytest.mark.parametrize("name", CHAINS)
def test_same_over_run_in_and_first_cycle(tmp_path, name):
    """Every kind of bed, contact model of the settings and tester, and the pin."""
    assert_same(CHAINS[name](tmp_path))


def test_same_over_the_first_blocks_of_a_machine(tmp_path):
    """A liner, a paddle that turns, a feed and an outlet."""
    with machine_study(tmp_path / "project") as study:
        assert_same(machine_chain(study, tmp_path / "machine"))


def test_same_bed_of_the_tester(tmp_path):
    """Filled and levelled under the consolidator, which is a mesh."""
    study, found = tiny_tester(solver=LONG_STEPS), {}
    bed = study.beds[study.bed_of("convex")]
    for search in SEARCHES:
        write_bed(study.case, bed, tmp_path / search)
        run_deck(tmp_path / search, executable=LEDGER_EXECUTABLE, search=search)
        found[search] = written(tmp_path / search, BED_RESTART)
    assert found["ours"] and found["ours"] == found["stock"]


@pytest.mark.parametrize("kind", ["shear_box", "draw_down", "wall_shear"])
def test_same_bulk_test(tmp_path, kind):
    """A box that is opened, one whose slot is, and one whose plate is dragged."""
    asked = {"fidelity": "quick", "wall_shear": SMALL, "draw_down": SMALL_DRAW_DOWN}
    run = load_study("calibration", overrides=asked).all_runs[0].parameters
    test, found = small() if kind == "shear_box" else bulk_test_of(run, kind, PAIR, SEED), {}
    for search in SEARCHES:
        write_test(test, tmp_path / search)
        run_deck(tmp_path / search, executable=LEDGER_EXECUTABLE, search=search)
        found[search] = written(tmp_path / search, HEAP, FILLED)
    assert found["ours"] and found["ours"] == found["stock"]


@pytest.mark.skipif("LIGGGHTS_TUTORIALS" not in os.environ, reason="LIGGGHTS_TUTORIALS names no folder")
@pytest.mark.parametrize("name", TUTORIALS)
def test_same_in_tutorials(tmp_path, name):
    """Places, velocities, forces and spins when they end, or after many steps; pictures are left out."""
    found = {}
    for search in SEARCHES:
        folder = shutil.copytree(Path(os.environ["LIGGGHTS_TUTORIALS"]) / name, tmp_path / search)
        (folder / "post").mkdir(exist_ok=True)
        text = re.sub(r"^\s*(un)?dump.*$", "", (folder / f"in.{name}").read_text(), flags=re.MULTILINE)
        shorter = re.sub(r"(?m)^(run\s+)(\d+)", lambda words: f"{words[1]}{min(int(words[2]), TUTORIAL_STEPS)}", text)
        (folder / DECK).write_text(f"{shorter}\n{LAST_STATE}\n")
        run_deck(folder, executable=LEDGER_EXECUTABLE, search=search)
        assert f"Wall search of {TUTORIALS[name]}: {search}, " in (folder / SCREEN).read_text()
        found[search] = (folder / "last.dump").read_bytes()
    assert found["ours"].count(b"\n") > 100
    assert found["ours"] == found["stock"]
