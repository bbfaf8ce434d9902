"""Decks of equipment: every combination of what a study may ask for renders; the solver runs them by hand."""

import itertools
import re
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from bulkwear.meshes.own.stl import read_stl_solids
from bulkwear.postproc.mesh import unit_normals, write_surface
from bulkwear.workflows.cases.equipment import decks as equipment_deck
from bulkwear.workflows.cases.equipment.flow import filling_phrase, flow_table, lost_particles, printed_flow
from bulkwear.workflows.cases.equipment.motions import motion_of
from bulkwear.workflows.cases.equipment.parameters import filled_mass
from bulkwear.workflows.cases.equipment.surfaces import faces_of, machine_surface, rectangle
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.chain import Chain, deck_text, write_decks
from bulkwear.workflows.engine.derived import neighbour_skin
from bulkwear.workflows.engine.schedule import first_span
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, solver_command, solver_environment
from tests.support.own_machine_project import machine_study

FILLING = {"fraction": 0.1, "axis": "y", "centre_mm": [-60, 0, -250], "radius_mm": 60, "length_mm": 100}
INLETS = {"fed": {}, "filled": {"inlet": None, "filling": FILLING}, "both": {"filling": FILLING}}
HELD = {"centre_mm": [0, 0, -430], "normal": [0, 0, -1], "size_mm": [700, 400]}


def stacked(*names):
    """Outlets below one another: a particle that falls through two within a step would be taken out twice."""
    return {"outlets": {name: {**HELD, "centre_mm": [0, 0, -430 - 5 * k]} for k, name in enumerate(names)}}


OUTLETS = {"one": {}, "two": {"outlets": {"held": HELD}}, "none": {"outlets": None}}
REFUSED = (("fed", "none"), ("both", "none"))
SLICES = {"whole": {}, "slice": {"periodic": {"axis": "y", "low_mm": -51, "high_mm": 51}}}
TURN = {"point_mm": [60, 0, -220], "axis": [0, 1, 0]}
MOTIONS = {
    "rest": None,
    "rotation": {"kind": "rotation", **TURN, "speed_rpm": 60, "start_s": 0.1, "ramp_s": 0.1, "stop_s": 9},
    "translation": {"kind": "translation", "velocity_m_per_s": [0, 0, -0.1]},
    "oscillation": {"kind": "oscillation", "amplitude_mm": [5, 0, 0], "period_s": 0.05, "phase_deg": 90},
    "swing": {"kind": "angular_oscillation", **TURN, "amplitude_deg": 2, "period_s": 0.05},
    "belt": {"kind": "belt", "velocity_m_per_s": [1, 0, 0]},
    "turning surface": {"kind": "turning_surface", **TURN, "speed_rpm": 60},
}
OPEN = re.compile(r"\{\{|\}\}|\{%|%\}|\t|\bNone\b|\bnan\b")
ROUND_OFF = 1e-9
ROOM = 1e-3  # relative; a turning part is looked at in 64 poses of a turn


def changes_of(*choices, motion="rotation", **more):
    """The changes of the tiny machine for a choice of each kind; the paddle has that motion."""
    found = {"parts": {"paddle": {"motion": None}}, **more}
    for choice in choices:
        found |= choice
    if MOTIONS[motion]:
        whole = dict.fromkeys(("point_mm", "axis", "speed_rpm"), None)
        found["parts"] = {**found["parts"], "paddle": {"motion": {**whole, **MOTIONS[motion]}}}
    return found


def texts_of(run, folder):
    """The decks of the first block and of the one after it."""
    chain = Chain("A", folder / "A", find_case("equipment"), run, folder / "A/surface.vtu")
    return [deck_text(chain, span) for span in (None, first_span(run))]


@pytest.mark.parametrize(
    ("fed", "outlets", "sliced"),
    [each for each in itertools.product(INLETS, OUTLETS, SLICES) if each[:2] not in REFUSED],
    ids=lambda value: value,
)
def test_decks_of_every_machine_render(tmp_path, fed, outlets, sliced):
    """Fed, filled or both, with and without outlets and as a slice: nothing is open, and nothing is there unasked."""
    with machine_study(tmp_path, **changes_of(INLETS[fed], OUTLETS[outlets], SLICES[sliced])) as study:
        start, block = texts_of(study.runs[0].parameters, tmp_path)
    for text in (start, block):
        assert not OPEN.search(text)
        assert ("insert/stream" in text) == (fed != "filled")
        assert text.count("massflow/mesh") == {"one": 1, "two": 2, "none": 0}[outlets]
        assert ("boundary        f p f" in text) == (sliced == "slice")
    assert ("insert/pack" in start) == (fed != "fed") and "insert/pack" not in block
    assert "load/ledger" in block and "load/ledger" not in start
    assert "read_restart    ../cycle_000/run.restart" in block and "create_box      3 domain" in start


@pytest.mark.parametrize("motion", MOTIONS)
def test_decks_of_every_motion_render(tmp_path, motion):
    """A part moves by a fix, or by words of its mesh, or not at all; a motion goes on where the block before ended."""
    with machine_study(tmp_path, **changes_of(motion=motion)) as study:
        start, block = texts_of(study.runs[0].parameters, tmp_path)
    moved = motion not in ("rest", "belt", "turning surface")
    for cycle, text in enumerate((start, block)):
        assert not OPEN.search(text)
        assert ("move/mesh" in text) == moved
        assert (f"part_paddle_{cycle}" in text) and f"part_paddle_{1 - cycle}" not in text
        words = re.search(rf"^fix  part_paddle_{cycle} .*$", text, re.MULTILINE)[0]
        assert ("surface_vel 1 0 0" in words) == (motion == "belt")
        assert ("surface_ang_vel" in words) == (motion == "turning surface")


def test_names_of_parts_and_outlets_take_no_other_name(tmp_path):
    """A part called size, an outlet called held or fed: every id and every variable is defined once."""
    rigid = {"file": "hood.stl", "unit": "mm", "role": "rigid", "edge_mm": 30, "material": "steel"}
    changes = {
        "parts": {
            name: {**rigid, "motion": {"kind": "belt", "velocity_m_per_s": [k, 0, 0]}}
            for k, name in enumerate(("size", "outlet_held", "walls", "feed", "load_ledger"), start=1)
        },
        **stacked("held", "fed", "filled", "liner"),
        "filling": FILLING,
    }
    with machine_study(tmp_path, **changes) as study:
        for text in texts_of(study.runs[0].parameters, tmp_path):
            joined = re.sub(r" &\n", " ", text)
            for word in ("fix", "variable", "dump"):
                found = re.findall(rf"^{word} +(\S+)", joined, re.MULTILINE)
                assert sorted(set(found)) == sorted(found)
            header = re.search(r'title "([^"]*)"', joined)[1].split()
            assert len(set(header)) == len(header)


def test_steps_are_counted_through(tmp_path):
    """A block begins with the step at which the one before ended, wherever it stands in the run."""
    with machine_study(tmp_path) as study:
        run = study.runs[0].parameters
        span = replace(first_span(run), cycle=7, first_step=6 * 1220)
        words = [
            equipment_deck.equipment_start(run),
            *(equipment_deck.equipment(run, s, "r") for s in (first_span(run), span)),
        ]
    assert [(each["begin_step"], each["end_step"]) for each in words] == [(0, 1220), (1220, 2440), (8540, 9760)]


def test_all_ledgers_sum_what_any_part_needs(tmp_path):
    """A run's ledger is one table: the kernel of one part's law stands in the lines of all; without one nowhere."""
    with machine_study(tmp_path / "a") as study:
        text = texts_of(study.runs[0].parameters, tmp_path)[1]
    lines = re.findall(r"^fix +load_ledger_\w+ all load/ledger .*$", text, re.MULTILINE)
    assert len(lines) == 4 and all(line.endswith(" kernels finnie_work") for line in lines)
    with machine_study(tmp_path / "b", "row,parts.plate.role\nA,rigid\n") as study:
        assert "kernels" not in texts_of(study.runs[0].parameters, tmp_path)[1]


def test_property_tables_are_those_of_bulk_and_walls(tmp_path):
    """Types in order; a pair with the bulk has the wall's own values."""
    with machine_study(tmp_path) as study:
        run = study.runs[0].parameters
        words = equipment_deck.material_words(run)
    assert words["type_names"] == ["ore", "steel", "perspex"]
    assert [row[0] for row in words["restitution"]] == words["restitution"][0] == [0.45, 0.6, 0.4]
    assert words["sliding_friction"][0] == [0.3, 0.38, 0.36]
    assert all(np.array_equal(np.array(table), np.array(table).T) for table in (words["restitution"],))


# ---------------------------------------------------------------- domain, inlet, outlets, filling


def domain_of(folder, **changes):
    """The parameters of a run, its surface, and the lowest and highest corner of its domain."""
    with machine_study(folder, **changes) as study:
        run = study.runs[0].parameters
        surface = machine_surface(run["parts"])
        return run, surface, np.array(equipment_deck.domain(run, surface)).T


def test_everything_lies_in_the_domain(tmp_path):
    """Parts wherever their motion takes them, inlet with the room before it, outlets; strays cross it in two looks."""
    run, surface, (low, high) = domain_of(tmp_path)
    margin = equipment_deck.room_round(run)
    room = [equipment_deck.inlet_room(run), *(rectangle(each).points for each in run["outlets"].values())]
    for number, part in enumerate(run["parts"]):
        own = surface.points[np.unique(surface.triangles[faces_of(surface, number, part)])]
        room += [motion_of(part["motion"]).placed(own, time) for time in np.linspace(0.0, 1.35, 50)]
    points = np.concatenate(room)
    assert (points > low).all() and (points < high).all()
    np.testing.assert_allclose([points.min(0) - low, high - points.max(0)], margin, rtol=ROOM)
    fast = equipment_deck.FASTEST * equipment_deck.STRAY_STEPS * run["derived"]["time_step_s"]
    assert equipment_deck.SHELL_SHARE * margin >= fast * (1.0 - ROUND_OFF)
    assert margin >= equipment_deck.MARGIN_DIAMETERS * max(run["particle"]["diameters_m"])


def test_domain_is_as_given_but_for_the_slice(tmp_path):
    """A periodic axis ends where the slice ends, of a given domain as well."""
    given = {"domain": {"low_mm": [-500, -400, -600], "high_mm": [500, 400, 300]}}
    _, _, ends = domain_of(tmp_path / "a", **given)
    np.testing.assert_allclose(ends, [[-0.5, -0.4, -0.6], [0.5, 0.4, 0.3]], rtol=ROUND_OFF)
    _, _, sliced = domain_of(tmp_path / "b", **given, **SLICES["slice"])
    np.testing.assert_allclose(sliced, [[-0.5, -0.051, -0.6], [0.5, 0.051, 0.3]], rtol=ROUND_OFF)
    _, _, room = domain_of(tmp_path / "c", **SLICES["slice"])
    assert room[:, 1].tolist() == [-0.051, 0.051]


def test_files_that_all_blocks_read(tmp_path):
    """Inlet and outlets look whither the material goes; strays are looked for inside the domain's faces."""
    with machine_study(tmp_path, **OUTLETS["two"]) as study:
        run = study.runs[0].parameters
        equipment_deck.write_shared(run, machine_surface(run["parts"]), tmp_path)
        equipment_deck.write_feed(run, 3, tmp_path)
    for name in (equipment_deck.INLET, "outlet_below.stl", "outlet_held.stl"):
        found = read_stl_solids(tmp_path / name)
        normals = unit_normals(found.points, found.triangles)
        np.testing.assert_allclose(normals, np.tile([0, 0, -1], (len(normals), 1)), atol=ROUND_OFF)
    regions = re.findall(r"^region +(\w+) block (.*) units box$", (tmp_path / "domain.in").read_text(), re.MULTILINE)
    domain, near = (np.array(ends.replace("side out", "").split(), float).reshape(3, 2) for _, ends in regions)
    assert [name for name, _ in regions] == ["domain", "near_faces"]
    assert (domain[:, 0] < near[:, 0]).all() and (near[:, 1] < domain[:, 1]).all()


def test_filling_keeps_off_the_ends_but_in_a_slice(tmp_path):
    """Centres stay a radius away from mantle and ends; a slice has none."""
    with machine_study(tmp_path / "a", **INLETS["both"]) as study:
        run = study.runs[0].parameters
    radius = 0.5 * max(run["particle"]["diameters_m"])
    words = equipment_deck.equipment_start(run)
    assert words["filling_ends_m"] == pytest.approx([-0.05 + radius, 0.05 - radius], rel=ROUND_OFF)
    assert words["filling_radius_m"] == pytest.approx(0.06 - radius, rel=ROUND_OFF)
    assert words["filling_centre_m"] == [-0.06, -0.25] and words["filled_mass_kg"] == filled_mass(run)
    with machine_study(tmp_path / "b", **INLETS["both"], **SLICES["slice"]) as study:
        sliced = equipment_deck.equipment_start(study.runs[0].parameters)
    assert sliced["filling_ends_m"] == [-0.05, 0.05]


# ---------------------------------------------------------------- lists and cells of neighbours


def test_lists_of_neighbours_last_as_long_as_the_feed_is_fast(tmp_path):
    """At the speed of the fall a particle moves by half the skin in the steps asked for; at most two radii, and never
    less than without a feed."""
    with machine_study(tmp_path) as study:
        run = {**study.runs[0].parameters}
    run["parts"] = [{**part, "motion": None} for part in run["parts"]]
    run["derived"] = {**run["derived"], "time_step_s": 5e-5}
    radius, step = 0.5 * min(run["particle"]["diameters_m"]), run["derived"]["time_step_s"]
    inlet, fall = run["inlet"], run["inlet"]["centre_m"][2] - run["outlets"]["below"]["centre_m"][2]
    fastest = np.sqrt(np.square(inlet["velocity_m_per_s"]).sum() + 2 * 9.81 * fall)
    assert fall > 0 and equipment_deck.fall_speed(run) == pytest.approx(fastest, rel=ROUND_OFF)
    assert equipment_deck.skin(run) == pytest.approx(2 * fastest * step * equipment_deck.LIST_STEPS, rel=ROUND_OFF)

    def fed_with(speed):
        return equipment_deck.skin({**run, "inlet": {**inlet, "velocity_m_per_s": [0, 0, -speed]}})

    assert fed_with(1e3) == pytest.approx(equipment_deck.FED_SKIN_OVER_RADIUS * radius, rel=ROUND_OFF)
    least = neighbour_skin(run["particle"])
    assert least == equipment_deck.skin({**run, "inlet": None}) < equipment_deck.skin(run) < fed_with(1e3)


def test_cells_of_neighbours_are_wide_where_particles_are_few(tmp_path):
    """A room that its particles fill keeps the solver's cells and says nothing of them; emptier room has wider ones,
    up to a multiple of how far neighbours are looked for."""
    with machine_study(tmp_path) as study:
        run = study.runs[0].parameters
        surface = machine_surface(run["parts"])
    reach = max(run["particle"]["diameters_m"]) + equipment_deck.skin(run)

    def side(particles, length=1.0):
        held = {**run, "derived": {**run["derived"], "held_particles": particles}}
        return equipment_deck.cell_side(held, [(0.0, length)] * 3)

    assert side(1e9) == pytest.approx(0.5 * reach, rel=ROUND_OFF)
    assert side(1.0, 100.0) == pytest.approx(equipment_deck.LARGEST_CELL * reach, rel=ROUND_OFF)
    few = 1.0 / (equipment_deck.CELLS_PER_PARTICLE * reach**3)
    assert side(few) == pytest.approx(reach, rel=ROUND_OFF) and side(8 * few, 2.0) == pytest.approx(
        reach, rel=ROUND_OFF
    )
    for particles, said in ((1e9, 0), (1.0, 1)):
        held = {**run, "derived": {**run["derived"], "held_particles": particles}}
        equipment_deck.write_shared(held, surface, tmp_path)
        lines = re.findall(r"^neigh_modify binsize (\S+)$", (tmp_path / "domain.in").read_text(), re.MULTILINE)
        assert len(lines) == said
    ends = equipment_deck.domain(run, surface)
    assert float(lines[0]) == pytest.approx(equipment_deck.cell_side(held, ends), rel=ROUND_OFF)


# ---------------------------------------------------------------- the solver runs them

SHORT = {"sampling": {"block_s": 0.05}, "start_up": {"most_s": 0.75}}  # s; the paddle turns once in the longest run
MOVING = {
    name.replace(" ", "_"): {
        **{"file": "hood.stl", "unit": "mm", "role": "rigid", "edge_mm": 60, "material": "steel"},
        "motion": motion,
    }
    for name, motion in MOTIONS.items()
    if motion
}
BY_HAND = {
    "filled, fed, with all motions": {
        **INLETS["both"],
        **{**stacked("held", "fed"), "parts": MOVING, **SHORT},
    },
    "filled, a slice without outlets": {**INLETS["filled"], **OUTLETS["none"], **SLICES["slice"], **SHORT},
}


@pytest.mark.solver
@pytest.mark.parametrize("machine", BY_HAND)
def test_decks_run_by_hand(tmp_path, machine):
    """As they are written, one after the other, without the driver; every particle is accounted for."""
    with machine_study(tmp_path, **BY_HAND[machine]) as study:
        run, case = study.runs[0].parameters, study.case
        chain = Chain("A", tmp_path / "A", case, run, tmp_path / "surface.vtu")
        write_surface(chain.surface, machine_surface(run["parts"]))
        write_decks(chain)
    for cycle in range(2):
        folder = chain.folder / f"cycle_{cycle:03d}"
        done = subprocess.run(
            solver_command(1, LEDGER_EXECUTABLE), cwd=folder, env=solver_environment(), capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout[-2000:]
        table = flow_table(run, folder)
        assert len(table) == 20 and lost_particles(table) == 0 and table["particles"].iloc[-1] > 0
    first = printed_flow(chain.folder / "cycle_000").iloc[0]
    assert filling_phrase(run, chain.folder) is None and first["filled_mass_kg"] > 0.0
    assert (table["inserted_particles"].iloc[-1] > first["filled_particles"]) == bool(run["inlet"])
    powers = [name for name in table if name.startswith("power_")]
    assert powers == [f"power_{part['name']}_W" for part in run["parts"] if part["motion"]]
