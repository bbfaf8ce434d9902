"""A pin on a disc: its rows, its faults, its decks, and a tiny run on the real solver, undisturbed and killed."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import read_surface, write_surface
from bulkwear.workflows.cases.pin_on_disc.case import LOAD_TOLERANCE
from bulkwear.workflows.cases.pin_on_disc.decks import pin_on_disc, pin_set_down
from bulkwear.workflows.cases.pin_on_disc.page import update_remark
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine import cycles, state
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.chain import MOST_DECKS, Chain, deck_text, write_decks
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.schedule import known_spans
from tests import DATA, REPOSITORY
from tests.support.killed import kill_when, start_driver, wait_until_no_solver
from tests.support.stl import stl_facets

GOLDEN = DATA / "golden_pin_on_disc.in"
TINY = {  # two revolutions of a small disc in four cycles, 30 times the coefficient: a groove that is felt
    "pin": {"radius_mm": 1, "load_n": 5},
    "disc": {"radius_mm": 3, "track_radius_mm": 2.2, "element_size_mm": 0.2, "band_half_width_mm": 0.3},
    "sliding": {"angular_speed_deg_per_s": 1800, "revolutions": 2, "cycles_per_revolution": 2},
}
ROW = "c17-conserving"
FLAT = 1e-6  # relative; a flat disc under the settled pin: work is F L
OTHER_STEPS = 1e-5  # relative; how long two triangles are touched at once depends on the time step; seen 1.3e-6
ARCHARD = 0.02  # relative; the rise of the summed normal forces in the groove of the tiny run
ROUND_OFF = 1e-9  # relative; sums of some ten thousand steps


def tiny_pin(**changes):
    """The quick study, shrunk."""
    settings = {key: dict(value) for key, value in TINY.items()}
    for key, value in changes.items():
        settings[key] = {**settings.get(key, {}), **value} if isinstance(value, dict) else value
    return load_study("pin_on_disc", overrides=settings)


def pin_chain(study, folder: Path, run: str = ROW) -> Chain:
    """A chain in `folder`, its disc built."""
    parameters, case = study.run(run).parameters, study.case
    folder.mkdir(parents=True, exist_ok=True)
    write_surface(folder / "surface.vtu", case.surface_mesh(case.surface_sections(parameters)))
    return Chain(run, folder, study.case, parameters, folder / "surface.vtu")


# ---------------------------------------------------------------- settings


def test_a_row_overrides_the_settings_and_an_empty_cell_leaves_them():
    """Standard rows: coefficient, mesh and size series, each from its own columns, the rest from the settings."""
    study = load_study("pin_on_disc", overrides={"fidelity": "standard"})
    calibrated, coarse, large = (study.run(name).parameters for name in ("c17-conserving", "m05-per-triangle", "s8"))
    assert (calibrated["pin"]["load_n"], calibrated["disc"]["track_radius_m"]) == (5.0, 0.022)
    assert (coarse["disc"]["element_size_m"], coarse["wear"]["scheme"]) == (0.0005, "per_triangle")
    assert (large["pin"]["radius_m"], large["pin"]["load_n"], large["wear"]["deform"]) == (0.024, 1.0, False)
    assert large["disc"]["radius_m"] == 0.1 and large["sliding"]["cycles"] == 12
    assert [run.name for run in study.runs] == [run.row for run in study.runs]


def test_the_time_step_is_the_sources():
    """0.2 of the Rayleigh time of the pin of Table 5.2 is 1.4e-5 s; a revolution has whole cycles of whole windows."""
    derived = load_study("pin_on_disc", overrides={"fidelity": "standard"}).run(ROW).parameters["derived"]
    assert derived["time_step_s"] == pytest.approx(1.4e-5, rel=0.03)
    assert derived["first_cycle_steps"] % derived["force_interval_steps"] == 0
    assert derived["overlap_m"] == pytest.approx(40.8e-6, rel=0.01)
    assert 12 * derived["first_cycle_steps"] * derived["time_step_s"] == pytest.approx(2.0, rel=ROUND_OFF)


@pytest.mark.parametrize("element", [0.2, 8.0])
def test_every_stretch_of_the_disc_lies_in_the_domain(element):
    """Elements of a rigid disc may be as large as its rim is far: what the solver gets lies inside, in every cycle."""
    disc = {"radius_mm": 20, "track_radius_mm": 12, "element_size_mm": element}
    study = tiny_pin(disc=disc, wear={"deform": False})
    parameters, case = study.run(ROW).parameters, study.case
    surface, deck = case.surface_mesh(parameters), pin_set_down(parameters)
    for span in (None, *known_spans(parameters)):
        mesh = case.pieces(parameters, span, surface)[0].mesh
        there = mesh.points[np.unique(mesh.triangles)]
        assert np.abs(there[:, :2]).max() < deck["domain_half_width_m"]
        assert deck["domain_bottom_m"] < there[:, 2].min() and there[:, 2].max() < deck["domain_top_m"]


def test_the_per_triangle_rule_has_no_patch():
    """The source moves single triangles: its rule is compared without a patch."""
    study = tiny_pin()
    assert study.run("c17-per-triangle").parameters["wear"]["patch"] == "none"
    assert study.run("c17-conserving").parameters["wear"]["patch"] == "simulated"


def test_the_excess_figure_says_how_long_an_update_is():
    """Eq 5.9 over touched triangles depends on it: 12 cycles per revolution are arcs of 30 degrees."""
    study = load_study("pin_on_disc", overrides={"fidelity": "standard"})
    assert update_remark(study).startswith("wear updates of 30 degrees: ")


FAULTS = [
    (
        {"ledger": "dumps"},
        "command line: ledger is 'dumps' for row c17-conserving, allowed is solver for a pin on a disc.",
    ),
    (
        {"solver": {"ranks": 2}},
        "command line: solver.ranks is 2 for row c17-conserving, allowed is 1 for a single pin.",
    ),
    (
        {"disc": {"radius_mm": 22.5}},
        "command line: disc.radius_mm is 22.5 for row c17-conserving, allowed is at least 22.6996 mm, the track and two"
        " contact radii, and below 44 mm, two tracks.",
    ),
    (
        {"sliding": {"revolutions": 1.3}},
        "command line: sliding.revolutions is 1.3 for row c17-conserving, allowed is a multiple of 1/12 from 1 on,"
        " so that wear cycles are whole and a revolution has its contours.",
    ),
    (
        {"sliding": {"revolutions": 0.5}},
        "command line: sliding.revolutions is 0.5 for row c17-conserving, allowed is a multiple of 1/12 from 1 on,"
        " so that wear cycles are whole and a revolution has its contours.",
    ),
    (
        {"disc": {"element_size_mm": 1.5}},
        "command line: disc.element_size_mm is 1.5 for row c17-conserving, allowed is at most 1.39918 mm, four radii of"
        " the pin's contact.",
    ),
    (
        {"pin": {"material": "gold"}},
        "command line: pin.material is 'gold', allowed is one of iron_ore.",
    ),
    (
        {"packings": 1, "until": {"width_fraction": 0.1, "most_packings": 8, "most_core_h": 10}},
        "command line: until is a block of keys, allowed is no such block in studies of case pin_on_disc: runs start"
        " from no bed.",
    ),
    (
        {"pin": {"load_n": 1000}},
        "command line: pin.load_n is 1000 for row c17-conserving, allowed is at most 394.271 N, under which the pin"
        " sinks into the disc by 0.25 of its radius, by the moduli as simulated (found 0.465).",
    ),
    (
        {"wear": {"law": "impact_threshold", "parameters": {"threshold_velocity_m_per_s": 0}}},
        "command line: wear.law is 'impact_threshold' for row c17-conserving, allowed is one of archard, combined,"
        " finnie, tangential_work: a pin slides, and makes no impacts.",
    ),
    (
        {"wear": {"patch": "radius", "patch_radius_mm": 2.1}},
        "command line: wear.patch_radius_mm is 2.1 for row c17-conserving, allowed is at most 2 mm, disc.radius_mm less"
        " disc.track_radius_mm: a wider patch spreads the wear beyond the disc.",
    ),
    (
        {"disc": {"radius_mm": 21}, "wear": {"patch": "radius", "patch_radius_mm": 1}},
        "command line: disc.radius_mm is 21 for row c17-conserving, allowed is at least 22.6996 mm, the track and two"
        " contact radii, and below 44 mm, two tracks.",
    ),
    (
        {"wear": {"acceleration": 1e5}},
        "config/designs/pin_on_disc_quick.csv, line 2, row c17-conserving: a wear coefficient, with its acceleration,"
        " of 1.7e-06 1/Pa wears a deeper groove than 36 updates of 20.4 um can take, allowed is at most 1.36962e-07"
        " 1/Pa.",
    ),
    (
        {"sample": {"width_mm": 9}},
        "command line: sample (a block of keys) is no known key, allowed are fidelity, particle_scale, packings, until,"
        " rows,"
        " materials, ledger, beyond_machine, wear, remeshing, solver, deck, pin, disc, sliding.",
    ),
]


@pytest.mark.parametrize(("overrides", "message"), FAULTS)
def test_a_pin_that_cannot_run_is_refused_in_one_sentence(overrides, message):
    """Faults name the key, where it stands and what is allowed, before any solver starts."""
    with pytest.raises(ConfigError) as caught:
        load_study("pin_on_disc", overrides=overrides)
    assert str(caught.value) == message


def test_what_a_pins_refusal_names_is_enough():
    """A load under which a pin rests on the disc, which has room for it, a patch that it has room for, and an
    acceleration that updates take.
    """
    assert load_study("pin_on_disc", overrides={"wear": {"patch": "radius", "patch_radius_mm": 2}}).runs
    heavy = {"pin": {"load_n": 394.271}, "disc": {"radius_mm": 26}}
    assert load_study("pin_on_disc", overrides=heavy).runs
    assert load_study("pin_on_disc", overrides={"wear": {"acceleration": 1.36962e-7 / 5.0e-11}}).runs
    assert load_study("pin_on_disc", overrides={"wear": {"acceleration": 1e5, "deform": False}}).runs


def test_a_fault_of_a_rows_own_value_names_the_table(config):
    """Where the row gives the value, the message names its file, line and column."""
    for name in ("cases/pin_on_disc.yaml", "materials.yaml", "studies/pin_on_disc.yaml"):
        config.write(name, (REPOSITORY / "config" / name).read_text(encoding="utf-8"))
    table = "row,series,revolutions\nhalf,coefficient,0.55\n"
    config.write("designs/pin_on_disc_quick.csv", table)
    with pytest.raises(ConfigError) as caught:
        load_study("pin_on_disc", config.project)
    assert str(caught.value) == (
        "config/designs/pin_on_disc_quick.csv, line 2, row half: revolutions is 0.55, allowed is a multiple of 1/12"
        " from 1 on, so that wear cycles are whole and a revolution has its contours."
    )


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (
            "row,series\nm1,mesh\ns1,size\n",
            "column series holds mesh, size, allowed is a design with at least one row of series coefficient.",
        ),
        (
            "row,series,wear_coefficient_per_pa\nc1,coefficient,2e-11\nm1,mesh,1e-11\nm2,mesh,5e-11\nm3,mesh,\n",
            "column wear_coefficient_per_pa holds 1e-11, 5e-11, nothing in series mesh, allowed is one for all its"
            " rows.",
        ),
        (
            "row,series,load_n,track_radius_mm\nc1,coefficient,5,\nc2,coefficient,10,\nm1,mesh,5,20\n",
            "column load_n holds 5.0, 10.0 in series coefficient and mesh, allowed is one for these rows.",
        ),
        (
            "row,series,particle_scale,track_radius_mm\nc1,coefficient,,22\nm1,mesh,,20\ns1,size,2,\n",
            "column track_radius_mm holds 22.0, 20.0 in series coefficient and mesh, allowed is one for these rows.",
        ),
        (
            "row,series,particle_scale\nc1,coefficient,2\nc2,coefficient,\n",
            "column particle_scale holds 2.0, nothing in series coefficient, allowed is one for these rows.",
        ),
    ],
)
def test_a_design_of_which_no_figures_can_be_made_is_refused(config, table, words):
    """Without the series of coefficients, or with rows in one figure that differ in what it does not tell."""
    for name in ("cases/pin_on_disc.yaml", "materials.yaml", "studies/pin_on_disc.yaml"):
        config.write(name, (REPOSITORY / "config" / name).read_text(encoding="utf-8"))
    config.write("designs/pin_on_disc_quick.csv", table)
    with pytest.raises(ConfigError) as caught:
        load_study("pin_on_disc", config.project)
    assert str(caught.value) == f"config/designs/pin_on_disc_quick.csv: {words}"


# ---------------------------------------------------------------- decks


@pytest.mark.parametrize("fidelity", ["quick", "standard", "paper"])
@pytest.mark.parametrize("rolling_friction", ["cdt", "own_spin"])
def test_every_deck_of_every_pin_renders(fidelity, rolling_friction, tmp_path):
    """No deck has an open word, a missing or an unused parameter, or a tab."""
    study = load_study(
        "pin_on_disc", overrides={"fidelity": fidelity, "solver": {"rolling_friction": rolling_friction}}
    )
    for run in study.runs:
        chain = Chain(run.name, tmp_path, study.case, run.parameters, tmp_path / "surface.vtu")
        for span in (None, *known_spans(run.parameters)[:2]):
            text = deck_text(chain, span)
            assert f"rolling_friction {rolling_friction}" in text
            assert not re.search(r"\{\{|\}\}|\{%|%\}|\t|\bNone\b|\bnan\b", text)


def test_golden_deck(tmp_path):
    """The deck of the tiny pin's second cycle, word for word; a change of it is a decision."""
    study = tiny_pin()
    parameters = study.run(ROW).parameters
    chain = Chain(ROW, tmp_path, study.case, parameters, tmp_path / "surface.vtu")
    assert deck_text(chain, known_spans(parameters)[1]) == GOLDEN.read_text()


def test_decks_by_hand_are_those_of_the_first_cycles(tmp_path):
    """Of 48 cycles the decks of setting down and of the first twelve are written, each with its stretch of the disc."""
    chain = pin_chain(tiny_pin(sliding={"cycles_per_revolution": 24, "revolutions": 2}), tmp_path / ROW)
    write_decks(chain)
    folders = sorted(chain.folder.glob("cycle_*"))
    assert [folder.name for folder in folders] == [f"cycle_{number:03d}" for number in range(MOST_DECKS + 1)]
    first, last = (
        stl_facets(folder / "surface.stl")[:, :, :2].mean(axis=(0, 1)) for folder in (folders[1], folders[12])
    )
    assert np.arctan2(*first[::-1]) == pytest.approx(np.radians(7.5), abs=0.1)
    assert np.arctan2(*last[::-1]) == pytest.approx(np.radians(172.5), abs=0.1)


# ---------------------------------------------------------------- what a cycle may not do


def test_a_pin_that_left_the_disc_stops_the_run():
    """A mean vertical force off the load is a fault that names both and what to do."""
    case, parameters = find_case("pin_on_disc"), tiny_pin().run(ROW).parameters
    held = {"mean_vertical_force_N": 5.0 * (1.0 + 0.9 * LOAD_TOLERANCE), "contacts_per_step": 1.0, "time_step_s": 1e-6}
    assert case.cycle_fault(parameters, held) is None
    fault = case.cycle_fault(parameters, {**held, "mean_vertical_force_N": 4.9})
    assert "4.9 N, allowed is the load of 5 N" in fault and "smaller solver.rayleigh_fraction than 0.2" in fault


def test_too_many_contacts_for_the_time_step_stop_the_run():
    """With hundreds of contacts at once the pin swings by itself; the fault says which time step would do."""
    case, parameters = find_case("pin_on_disc"), tiny_pin().run(ROW).parameters
    step = parameters["derived"]["time_step_s"]
    row = {"mean_vertical_force_N": 5.0, "contacts_per_step": 400.0, "time_step_s": step}
    fault = case.cycle_fault(parameters, row)
    assert "400 contacts at once" in fault and "or a solver.rayleigh_fraction of at most" in fault
    assert case.cycle_fault(parameters, {**row, "time_step_s": step / case.substeps(parameters, row)}) is None


def test_a_pin_on_many_contacts_gets_smaller_time_steps():
    """Up to 23 contacts the source's time step is safe, then it is halved: the arc stays, steps and windows double."""
    case, study = find_case("pin_on_disc"), load_study("pin_on_disc", overrides={"fidelity": "standard"})
    parameters = study.run(ROW).parameters
    assert [case.substeps(parameters, {"contacts_per_step": n}) for n in (1.0, 20.0, 30.0)] == [1, 1, 2]
    span = known_spans(parameters)[1]
    one, two = (pin_on_disc(parameters, replace(span, substeps=k), "") for k in (1, 2))
    assert two["time_step_s"] * two["cycle_steps"] == pytest.approx(one["time_step_s"] * one["cycle_steps"])
    assert two["start_angle_rad"] == one["start_angle_rad"]
    assert (two["cycle_steps"], two["force_interval_steps"]) == (
        2 * one["cycle_steps"],
        2 * one["force_interval_steps"],
    )


# ---------------------------------------------------------------- on the solver


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """An undisturbed run: two revolutions in four cycles."""
    chain = pin_chain(tiny_pin(), tmp_path_factory.mktemp("pin") / ROW)
    cycles.run_chain(chain)
    return chain


@pytest.mark.solver
def test_the_first_turn_is_archards_and_the_groove_adds_little(finished):
    """The first arc on the flat disc is F L; volumes balance; the pin keeps its load in every cycle."""
    table = pd.read_csv(finished.folder / "wear.csv")
    parameters = finished.parameters
    arc = parameters["derived"]["sliding_distance_m"] / len(table)
    work = parameters["pin"]["load_n"] * arc
    assert table["sliding_work_J"][0] == pytest.approx(work, rel=FLAT)
    np.testing.assert_allclose(table["sliding_work_J"], work, rtol=ARCHARD)
    np.testing.assert_allclose(table["mean_vertical_force_N"], parameters["pin"]["load_n"], rtol=LOAD_TOLERANCE)
    assert table["revolution"].tolist() == [0.5, 1, 1.5, 2]
    assert (table["balance_error"] < ROUND_OFF).all()
    worn = read_surface(finished.folder / "worn_surface.vtu")
    assert (worn.points[:, 2] <= 0.0).all() and worn.points[:, 2].min() < 0.0


@pytest.mark.solver
def test_a_cycle_leaves_its_contract_and_old_ones_only_what_is_needed(finished):
    """Ledger, forces and state in every cycle; surface and restart file at the end of a revolution, and in the last."""
    for cycle in range(1, 5):
        folder = state.cycle_folder(finished.folder, cycle)
        names = {path.name for path in folder.iterdir()}
        assert {"deck.in", "log.liggghts", "ledger.parquet", "forces.csv", "state.json"} <= names
        assert ({"surface.vtu", "run.restart"} <= names) == (cycle % 2 == 0)
        assert not names & {"load_ledger.bin", "forces.txt", "loads_0.vtk"}
    forces = pd.concat(
        [pd.read_csv(state.cycle_folder(finished.folder, cycle) / "forces.csv") for cycle in range(1, 5)]
    )
    assert forces["angle_deg"].iloc[-1] == pytest.approx(720.0)
    assert forces["angle_deg"].diff().dropna().max() < 1.0
    assert -forces["force_z_N"].mean() == pytest.approx(5.0, rel=LOAD_TOLERANCE)


@pytest.mark.solver
def test_ledgers_name_triangles_of_the_whole_disc(finished):
    """Each cycle's ledger holds its stretch; loaded triangles of the first half turn lie on that half."""
    disc = read_surface(finished.surface)
    ledger = pd.read_parquet(state.cycle_folder(finished.folder, 1) / "ledger.parquet")
    assert 0 < len(ledger) < len(disc.triangles)
    loaded = ledger["triangle"][ledger["sliding_work_J"] > 0.0]
    middle = disc.points[disc.triangles[loaded]].mean(axis=1)
    assert (middle[:, 1] > -2e-4).all() and middle[:, 1].max() > 2e-3
    np.testing.assert_allclose(np.hypot(*middle[:, :2].T), 2.2e-3, atol=3e-4)


@pytest.mark.solver
def test_a_cycle_in_smaller_time_steps_is_the_same_cycle(finished, tmp_path):
    """The first arc in half the time step: the same work, time, angle and windows, twice the solver's steps."""
    folder = tmp_path / ROW
    folder.mkdir()
    shutil.copy(finished.surface, folder / "surface.vtu")
    chain = replace(finished, folder=folder, surface=folder / "surface.vtu")
    inputs, span = inputs_digest(chain), known_spans(chain.parameters)[0]
    for each in (None, replace(span, substeps=2)):
        cycles.run_cycle(chain, each, inputs, Progress(ROW, 1))
    found, expected = (state.read_state(run.folder, 1) for run in (chain, finished))
    for name in ("sliding_work_J", "time_s", "revolution", "mean_vertical_force_N"):
        assert found["wear"][name] == pytest.approx(expected["wear"][name], rel=OTHER_STEPS)
    assert found["cost"]["steps"] == 2 * expected["cost"]["steps"]
    tables = [pd.read_csv(state.cycle_folder(run.folder, 1) / "forces.csv") for run in (chain, finished)]
    np.testing.assert_allclose(tables[0]["angle_deg"], tables[1]["angle_deg"], rtol=ROUND_OFF)


@pytest.mark.verify
@pytest.mark.solver
@pytest.mark.parametrize("cycle", [2, 4])
def test_killed_and_started_again_gives_the_same_tables(finished, tmp_path, cycle):
    """kill -9 in a cycle, start again: the same wear.csv and worn surface, bit for bit."""
    folder = tmp_path / ROW
    folder.mkdir()
    shutil.copy(finished.surface, folder / "surface.vtu")
    chain = replace(finished, folder=folder, surface=folder / "surface.vtu")
    kill_when(start_driver(chain, tmp_path), lambda: (folder / f"cycle_{cycle:03d}.part" / "forces.txt").exists())
    wait_until_no_solver(tmp_path)
    cycles.run_chain(chain)
    assert (folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()
    found, expected = (read_surface(run.folder / "worn_surface.vtu") for run in (chain, finished))
    np.testing.assert_array_equal(found.points, expected.points)


@pytest.mark.verify
@pytest.mark.solver
def test_a_damaged_newest_cycle_is_done_again_from_what_was_kept(finished, tmp_path):
    """Without its newest cycle a run goes back to the last one that still has its surface, and ends the same."""
    folder = tmp_path / ROW
    shutil.copytree(finished.folder, folder)
    (folder / "cycle_004" / "surface.vtu").write_bytes(b"damaged")
    chain = replace(finished, folder=folder, surface=folder / "surface.vtu")
    cycles.run_chain(chain)
    assert (folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


@pytest.mark.parametrize(
    ("key", "wrong", "pin"),
    [("element_size_mm", 3.0, {}), ("radius_mm", 22.1, {}), ("radius_mm", 22.1, {"radius_mm": 7})],
)
def test_a_bound_of_the_disc_that_a_refusal_names_is_allowed(key, wrong, pin):
    """It is rounded to the side that is allowed."""
    with pytest.raises(ConfigError) as fault:
        load_study("pin_on_disc", overrides={"pin": pin, "disc": {key: wrong}})
    bound = float(re.search(r"allowed is at (?:most|least) (\S+) mm", str(fault.value))[1])
    load_study("pin_on_disc", overrides={"pin": pin, "disc": {key: bound}})
