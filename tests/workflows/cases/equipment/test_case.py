"""A run of equipment on the real solver: the balance of particles, phases, wear by part, poses, restarts, losses."""

import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.mesh import enclosed_volume, read_surface, stl_corners
from bulkwear.postproc.wear.bodies import body
from bulkwear.postproc.wear.update import CARRIED_VOLUME, REMOVED_THICKNESS
from bulkwear.workflows.cases.equipment import blocks, flow
from bulkwear.workflows.cases.equipment.findings import answers_on_holes
from bulkwear.workflows.cases.equipment.motions import motion_of
from bulkwear.workflows.cases.equipment.surfaces import faces_of
from bulkwear.workflows.cases.equipment.tables import run_summary
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.case import CycleError
from bulkwear.workflows.engine.cycles import run_chain
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.pouring import particles_of_mass
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, solver_command, solver_environment
from bulkwear.workflows.engine.wear_step import wear
from tests import REPOSITORY
from tests.support.own_machine_project import CORNERS, FASTER, SHAFT, SIZES, machine_chain, machine_study
from tests.support.patience import LONGEST_S
from tests.support.stl import stl_facets

pytestmark = pytest.mark.solver

CYCLES = 9  # start-up 3, pristine 3, wearing 2, worn 1
PHASES = ["start_up"] * 2 + ["pristine"] * 3 + ["wearing"] * 2 + ["worn"]  # of cycles 1 to 8
PRINTED = 1e-9  # relative; the solver prints 15 digits, sums of masses lose some
STL_ROUNDING = 1e-9  # m; %.9g of coordinates below 1 m
ON_FACE = 1e-9  # m; contact points are weighted means of a face's corners
VOLUME = 1e-6  # relative; a lost volume is a thousandth of the body's, both in double precision
BATCHES = 2  # insertions of the feed by which its mass may be ahead or behind
REPEATED = 0.05  # -, of places of the feed that two blocks have; seen 0.01 by chance, 0.6 where all draw alike
SMALL_STEP = 1e-2  # relative; doubled steps of 0.02 of the allowed one, where nodes move along turning normals
HOUR = 3600.0
DRIVER = """
import pickle, sys
from pathlib import Path
from bulkwear.workflows.engine.cycles import run_chain
from bulkwear.workflows.engine.project import enter_project
enter_project(Path(sys.argv[2]))
run_chain(pickle.load(open(sys.argv[1], "rb")))
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """An undisturbed run of the tiny machine; the process works in its project."""
    folder = tmp_path_factory.mktemp("machine")
    with machine_study(folder) as study:
        chain = machine_chain(study, folder / "results/machine")
        run_chain(chain)
        yield chain


def cycle(chain, number):
    return state.cycle_folder(chain.folder, number)


def span_of(chain, number):
    return Span(**state.read_state(chain.folder, number)["span"])


def surface(chain, number):
    """The surface that a cycle leaves; the one as built for 0."""
    return read_surface(cycle(chain, number) / "surface.vtu" if number else chain.surface)


def whole_flow(chain):
    return flow.whole_flow(chain.folder, chain.parameters, CYCLES - 1)


def wear_table(chain):
    return pd.read_csv(chain.folder / "wear.csv")


def part_body(chain, mesh, number):
    return body(mesh, faces_of(mesh, number, chain.parameters["parts"][number]))


# ---------------------------------------------------------------- what a run leaves


def test_every_block_leaves_its_contract(finished):
    """Tables, deck, restart and pictures of each block; ledger and surface of each but the first; no binary ledger."""
    for number in range(CYCLES):
        names = {path.name for path in cycle(finished, number).iterdir()}
        always = {"deck.in", "flow.csv", "flow.txt", "strays.dump", "state.json"}
        assert ("run.restart" in names) == (number in (0, CYCLES - 2, CYCLES - 1))
        assert always | {f"{part['name']}.stl" for part in finished.parameters["parts"]} <= names
        later = {"patches.csv", "parts.csv", "surface.vtu", "ledger.parquet", "wear_history.csv"}
        assert later & names == (later if number else set())
        assert not [name for name in names if name.endswith(".bin")]
        assert len(flow.pictures_of(cycle(finished, number))) >= finished.parameters["sampling"]["pictures_per_block"]
        assert not state.read_state(finished.folder, number)["solver_warnings"]
    assert {path.name for path in finished.folder.iterdir()} >= {"wear.csv", "cost.csv", "worn_surface.vtu"}


def test_phases_follow_one_another(finished):
    """Start-up for its longest time here, then the blocks that the study asks for; operation goes on while it wears."""
    table = wear_table(finished)
    assert table["phase"].tolist() == PHASES and table["cycle"].tolist() == list(range(1, CYCLES))
    assert table["stands_for_h"].tolist() == [0.0] * 5 + [200.0, 200.0, 0.0]
    assert table["operation_h"].tolist() == [0.0] * 6 + [200.0, 400.0]
    assert (table["worn_volume_m3"] > 0.0).tolist() == [phase == "wearing" for phase in PHASES]
    assert np.isfinite(table["deciding_width"]).tolist() == [False] * 4 + [True] * 4
    tables = blocks.patch_tables(finished.folder, CYCLES - 1)
    assert [each["phase"].iloc[0] for each in tables] == PHASES


# ---------------------------------------------------------------- particles


def test_balance_of_particles_closes_in_every_block(finished):
    """What came in is there or left through the outlet, to the particle and to the mass; pictures have the same."""
    density = finished.parameters["particle"]["density_kg_per_m3"]
    ends = whole_flow(finished).groupby("cycle").last()
    assert (ends["inserted_particles"] == ends["particles"] + ends["out_particles"]).all()
    missing = ends["inserted_mass_kg"] - ends["held_mass_kg"] - ends["out_mass_kg"]
    assert (missing.abs() < PRINTED * ends["inserted_mass_kg"]).all()
    assert (ends["out_particles"].diff().iloc[3:] > 0).all() and (wear_table(finished)["lost_particles"] == 0).all()
    for number, row in ends.iterrows():
        picture = read_snapshot(flow.pictures_of(cycle(finished, number))[-1])
        assert len(picture) == row["particles"] and picture["id"].is_unique
        mass = density * 4.0 / 3.0 * np.pi * (picture["radius_m"] ** 3).sum()
        assert mass == pytest.approx(row["held_mass_kg"], rel=1e-5)  # radii of six digits


def test_flow_goes_on_over_blocks(finished):
    """Times follow one another, and nothing that is counted falls."""
    whole, interval = whole_flow(finished), 0.15 / 20
    np.testing.assert_allclose(np.diff(whole["time_s"]), interval, rtol=1e-6)
    for name in ("inserted_particles", "inserted_mass_kg", "out_particles", "out_mass_kg"):
        assert (whole[name].diff().dropna() >= 0).all()
    pd.testing.assert_series_equal(whole["out_mass_kg"], whole["out_below_mass_kg"], check_names=False)


def test_feed_is_what_the_study_says(finished):
    """1.5 t/h over the whole run; restarts neither stop it nor begin it anew: no two blocks are fed alike."""
    last, rate = whole_flow(finished).iloc[-1], finished.parameters["inlet"]["rate_kg_per_s"]
    batch = whole_flow(finished)["inserted_mass_kg"].diff().max()
    assert abs(last["inserted_mass_kg"] - rate * last["time_s"]) < BATCHES * batch
    count = particles_of_mass(finished.parameters["particle"], last["inserted_mass_kg"])
    assert count == pytest.approx(last["inserted_particles"], rel=0.15)  # 300 particles of two sizes: 4 %
    taken = batch_places(finished)
    assert all(len(places) > 3 for places in taken)
    total = sum(map(len, taken))
    assert total - len(set().union(*taken)) <= REPEATED * total


def batch_places(chain):
    """Where (x, y in um) each block placed those that still fall at its end."""
    found = []
    for number in range(CYCLES):
        last = read_snapshot(flow.pictures_of(cycle(chain, number))[-1])
        falling = last[last["z_m"] > 0.12]
        found.append({(round(1e6 * x), round(1e6 * y)) for x, y in zip(falling["x_m"], falling["y_m"], strict=True)})
    return found


# ---------------------------------------------------------------- poses


def test_parts_stand_where_their_motion_has_taken_them(finished):
    """What the solver reads in a block: each part at its pose when the block begins, from the surface before."""
    for number in range(CYCLES):
        before = surface(finished, max(number - 1, 0))
        for k, part in enumerate(finished.parameters["parts"]):
            found = stl_facets(cycle(finished, number) / f"{part['name']}.stl")
            placed = motion_of(part["motion"]).placed(before.points, 0.15 * number)
            expected = stl_corners(placed, before.triangles[faces_of(before, k, part)])
            np.testing.assert_allclose(found, expected, atol=STL_ROUNDING)
    turned = [stl_facets(cycle(finished, number) / "paddle.stl").mean(axis=(0, 1)) for number in range(6)]  # as built
    angle = np.unwrap([np.arctan2(-(z - SHAFT[2] / 1e3), x - SHAFT[0] / 1e3) for x, _, z in turned])
    np.testing.assert_allclose(np.diff(angle), 2.0 * np.pi * 0.15, rtol=1e-6)  # a turn a second


def test_ledgers_are_in_the_frame_of_the_drawing(finished):
    """Contact points lie on the faces of the part as drawn, wherever it has turned meanwhile."""
    low = (np.array(CORNERS["paddle"]) + SHAFT) / 1e3
    box = np.array([low, low + np.array(SIZES["paddle"]) / 1e3])
    touched = 0
    for number in range(1, 6):  # the shape as built
        ledger = pd.read_parquet(cycle(finished, number) / "ledger.parquet")
        there = ledger[faces_of(surface(finished, number), 2, finished.parameters["parts"][2])].dropna()
        points = there[[f"contact_position_{axis}_m" for axis in "xyz"]].to_numpy()
        inside = np.minimum(points - box[0], box[1] - points)
        assert (inside > -ON_FACE).all() and (inside.min(axis=1) < ON_FACE).all()
        touched += len(points)
    assert touched > 15


def test_driver_does_what_the_deck_does_by_hand(finished, tmp_path):
    """A block in a copy of its folders, by the solver alone, prints the same flow to the last digit."""
    for name in ("domain.in", "outlet_below.stl"):
        shutil.copy(finished.folder / name, tmp_path)
    before, last = cycle(finished, CYCLES - 2), cycle(finished, CYCLES - 1)  # restart files of others are gone
    (tmp_path / before.name).mkdir()
    shutil.copy(before / "run.restart", tmp_path / before.name)
    hand = tmp_path / last.name
    hand.mkdir()
    for path in (last / "deck.in", *last.glob("*.stl")):
        shutil.copy(path, hand)
    command = solver_command(1, LEDGER_EXECUTABLE)
    subprocess.run(command, cwd=hand, env=solver_environment(), capture_output=True, check=True)
    assert (hand / flow.PRINTED).read_text() == (last / flow.PRINTED).read_text()


# ---------------------------------------------------------------- wear


def test_each_part_loses_what_its_own_law_says(finished):
    """Volume of the drawing less the present one, plus what is carried: rate by the part's law and coefficient, times
    hours, over all updates."""
    run, worn = finished.parameters, surface(finished, CYCLES - 1)
    tables = [pd.read_csv(cycle(finished, number) / "parts.csv").set_index("part") for number in range(1, CYCLES)]
    steel = ("sliding_work_J", run["wear"]["wear_coefficient_per_pa"])
    laws = {"liner": steel, "plate": ("finnie_work_J", 1e-12), "paddle": steel}
    for number, part in enumerate(run["parts"][:3]):
        bodies = [part_body(finished, mesh, number) for mesh in (surface(finished, 0), worn)]
        lost = -np.diff([enclosed_volume(each.points, each.triangles) for each in bodies])[0]
        carried = bodies[1].point_data[CARRIED_VOLUME].sum()
        told = sum((table["worn_volume_m3_per_h"] * table["stands_for_h"])[part["name"]] for table in tables)
        assert lost > 0.0 and lost + carried == pytest.approx(told, rel=VOLUME)
        column, coefficient = laws[part["name"]]
        for at, table in enumerate(tables, start=1):
            ledger = pd.read_parquet(cycle(finished, at) / "ledger.parquet")
            there = faces_of(surface(finished, at - 1), number, part)
            rate = coefficient * ledger[column].to_numpy()[there].sum() / 0.15 * HOUR
            assert table.loc[part["name"], "worn_volume_m3_per_h"] == pytest.approx(rate, rel=PRINTED)
    assert [table.loc["hood", "worn_volume_m3_per_h"] for table in tables] == [0.0] * len(tables)


def test_sum_over_parts_is_the_row_of_the_run(finished):
    """wear.csv has the volume of all parts; its balance closes on the geometry."""
    table = wear_table(finished)
    parts = [pd.read_csv(cycle(finished, number) / "parts.csv") for number in range(1, CYCLES)]
    told = [(each["worn_volume_m3_per_h"] * each["stands_for_h"]).sum() for each in parts]
    np.testing.assert_allclose(table["worn_volume_m3"], told, rtol=PRINTED)
    assert (table["balance_error"] < 1e-9).all()
    assert table["total_applied_volume_m3"].iloc[-1] + table["carried_volume_m3"].iloc[-1] == pytest.approx(
        sum(told), rel=VOLUME
    )


def test_rigid_part_stays_to_the_last_bit(finished):
    """Its points and faces are those of the drawing in every block, also in the surface of the whole run."""
    first = part_body(finished, surface(finished, 0), 3)
    later = [surface(finished, number) for number in range(1, CYCLES)]
    for mesh in (*later, read_surface(finished.folder / "worn_surface.vtu")):
        now = part_body(finished, mesh, 3)
        assert np.array_equal(now.points, first.points) and np.array_equal(now.triangles, first.triangles)
        assert not now.point_data[REMOVED_THICKNESS].any()


def test_shape_is_kept_but_while_it_wears(finished):
    """Blocks of start-up and sampling leave it as drawn, blocks on the worn shape as it is."""
    points = [surface(finished, number).points for number in range(CYCLES)]
    same = [np.array_equal(points[k], points[k + 1]) for k in range(CYCLES - 1)]
    assert same[:5] == [True] * 5 and same[5:7] == [False, False]
    np.testing.assert_allclose(points[8], points[7], atol=1e-12)  # m; what is carried is rounding


def worn_by(finished, folder, span=None, parts=None):
    """The surface and the row of the first update, for another span or with other parts."""
    run = finished.parameters if parts is None else {**finished.parameters, "parts": parts}
    ledger = pd.read_parquet(cycle(finished, 6) / "ledger.parquet")
    row = wear(replace(finished, parameters=run), span or span_of(finished, 6), folder, surface(finished, 0), ledger)
    return read_surface(folder / "surface.vtu"), row


def test_twice_the_operation_is_twice_the_depth(finished, tmp_path):
    """Of the same block, far from the caps; so does twice the coefficient of each part, of that part alone."""
    once, _ = worn_by(finished, tmp_path)
    np.testing.assert_array_equal(once.points, surface(finished, 6).points)
    span = span_of(finished, 6)
    longer, row = worn_by(finished, tmp_path, replace(span, stands_for_s=2.0 * span.stands_for_s))
    deep = once.point_data[REMOVED_THICKNESS] > 0.1 * once.point_data[REMOVED_THICKNESS].max()
    ratio = longer.point_data[REMOVED_THICKNESS][deep] / once.point_data[REMOVED_THICKNESS][deep]
    assert deep.sum() > 10 and np.abs(ratio / 2.0 - 1.0).max() < SMALL_STEP and row["step_demand"] < 0.1
    assert row["worn_volume_m3"] == pytest.approx(2.0 * wear_table(finished)["worn_volume_m3"][5], rel=PRINTED)
    key, parts = "wear_coefficient_per_pa", finished.parameters["parts"]
    harder, _ = worn_by(finished, tmp_path, parts=[{**parts[0], key: 2.0 * parts[0][key]}, *parts[1:]])
    bodies = [[part_body(finished, mesh, k).point_data[REMOVED_THICKNESS] for k in range(3)] for mesh in (once, harder)]
    assert bodies[1][0].max() == pytest.approx(2.0 * bodies[0][0].max(), rel=SMALL_STEP)
    assert all(np.array_equal(bodies[0][k], bodies[1][k]) for k in (1, 2))


def test_liner_that_is_worn_through_is_told_with_its_place(finished, tmp_path):
    """One of 10 um, thinner than the update is deep; what lies behind is not taken."""
    parts = finished.parameters["parts"]
    thin = [{**parts[0], "thickness_m": 1e-5}, *parts[1:]]
    mesh, row = worn_by(finished, tmp_path, parts=thin)
    assert row["through_nodes"] > 0 and wear_table(finished)["through_nodes"].max() == 0
    remaining = part_body(finished, mesh, 0).point_data
    assert remaining["lost_thickness_m"].max() > 1e-5


SHORT = {
    "start_up": {"most_s": 0.3},
    "sampling": {"fewest_blocks": 1, "most_blocks": 1},
    "parts": FASTER,
}  # start-up 2, pristine 1, wearing 2, worn 1
THIN = 1e-5  # m, of the liner: an update is deeper


@pytest.mark.parametrize("then", [None, *(pytest.param(each, marks=pytest.mark.verify) for each in ("cap", "go_on"))])
def test_run_whose_liner_is_worn_through_ends_or_goes_on(tmp_path, capsys, then):
    """It ends after that update unless it is told to go on, at the back or beyond it; the answer tells hours and place,
    a node of the liner.
    """
    with machine_study(tmp_path, **SHORT, **({"wear": {"worn_through": then}} if then else {})) as study:
        whole = machine_chain(study, tmp_path / "results/machine")
        liner, *others = whole.parameters["parts"]
        chain = replace(whole, parameters={**whole.parameters, "parts": [{**liner, "thickness_m": THIN}, *others]})
        run_chain(chain)
    table = wear_table(chain)
    first = table[table["through_nodes"] > 0].iloc[0]
    assert first["phase"] == "wearing" and (table["balance_error"] < 1e-6).all()
    assert table["phase"].tolist()[2:] == (["wearing"] if then is None else ["wearing", "wearing", "worn"])
    found = run_summary(table, chain.folder)
    assert found["through_h"] == 200.0 and found["operation_h"] == (200.0 if then is None else 400.0)
    (said,) = answers_on_holes(pd.DataFrame([{"run": chain.name, **found}]))
    assert f"by 200 h: {found['through_said']}." in said and found["through_said"] in capsys.readouterr().err
    place = [float(each) for each in re.search(r"first at \((.*)\) mm, where the part was 0.01 mm", said)[1].split(",")]
    worn = part_body(chain, surface(chain, int(first["cycle"])), 0).points
    assert np.linalg.norm(worn - np.array(place) / 1e3, axis=1).min() < 1e-4  # places of four digits
    lost = part_body(chain, read_surface(chain.folder / "worn_surface.vtu"), 0).point_data["lost_thickness_m"].max()
    assert (lost > THIN * (1.0 + 1e-6)) == (then == "go_on")


# ---------------------------------------------------------------- killed, and lost particles


def copy_of(finished, folder, cycles):
    """The same run elsewhere, so many of its cycles done."""
    target = folder / finished.name
    target.mkdir()
    shutil.copy(finished.surface, target / "surface.vtu")
    for number in range(cycles):
        shutil.copytree(cycle(finished, number), target / cycle(finished, number).name)
    return replace(finished, folder=target, surface=target / "surface.vtu")


MOMENTS = {
    "while an update is simulated": (6, "strays.dump"),
    "while the worn shape is accounted": (8, "run.restart"),
}


@pytest.mark.verify
@pytest.mark.parametrize("moment", MOMENTS)
def test_killed_and_started_again_is_the_undisturbed_run(finished, tmp_path, moment):
    """kill -9 and a second start: tables, phases and surface to the last bit."""
    begun, written = MOMENTS[moment]
    chain = copy_of(finished, tmp_path, begun)
    (tmp_path / "chain.pickle").write_bytes(pickle.dumps(chain))
    command = [sys.executable, "-c", DRIVER, str(tmp_path / "chain.pickle"), str(finished.folder.parents[2])]
    process, deadline = subprocess.Popen(command, cwd=REPOSITORY), time.monotonic() + LONGEST_S
    while not (chain.folder / f"cycle_{begun:03d}.part" / written).exists():
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    run_chain(chain)
    for name in ("wear.csv", "worn_surface.vtu"):
        assert (chain.folder / name).read_bytes() == (finished.folder / name).read_bytes(), name
    for number in range(begun, CYCLES):
        for name in ("flow.csv", "patches.csv", "parts.csv", "ledger.parquet", "surface.vtu"):
            assert (cycle(chain, number) / name).read_bytes() == (cycle(finished, number) / name).read_bytes(), name


def test_particle_that_gets_lost_stops_the_run_with_its_place(tmp_path):
    """The outlet ends at the plate, on whose top all falls: what goes off it beyond is named with where it was."""
    inlet = {"centre_mm": [155, 0, 40], "size_mm": [44, 60]}
    outlets = {"below": {"centre_mm": [-200, 0, -250], "size_mm": [680, 500]}}
    domain = {"low_mm": [-500, -300, -350], "high_mm": [500, 300, 300]}
    with machine_study(tmp_path, inlet=inlet, outlets=outlets, domain=domain) as study:
        chain = machine_chain(study, tmp_path / "results/machine")
        with pytest.raises(CycleError) as fault:
            run_chain(chain)
    found = re.fullmatch(
        r"A, cycle (\d+): (\d+) particles? (?:is|are) missing in the balance .*: "
        r"last seen at \(([\d.]+), .*, (-[\d.]+)\) mm, going -z; .*close the gap there, or put an outlet there\.",
        str(fault.value),
    )
    assert found and int(found[2]) > 0, str(fault.value)
    assert float(found[3]) > 140.0 and -400.0 < float(found[4]) < -100.0
    assert state.finished_cycles(chain.folder, inputs_digest(chain)) == int(found[1])
