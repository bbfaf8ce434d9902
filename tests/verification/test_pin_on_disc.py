"""The decks of a pin on a disc: work, map and motion of a pin that is taken round over stretches of its track."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, write_stl
from bulkwear.postproc.readers.load_ledger import SUMS, read_load_ledger
from tests.verification.ledger_cases import PIN_MOTION, RADIUS, hertz_overlap, ledger_of_dumps, pin, run, run_case
from tests.verification.pin_cases import (
    ANGULAR_VELOCITY,
    LOAD,
    TRACK_RADIUS,
    PinCase,
    arc,
    disc,
    set_down,
    write_arc,
)

pytestmark = pytest.mark.solver

# Archard knows no speed: twenty times that of the study, in a twentieth of the steps.
FAST = replace(PinCase(), angular_velocity=20.0 * ANGULAR_VELOCITY).exact()
WORK = 1e-6  # -, of F L. Measured: 1e-15; the load stays at its equilibrium
# A second contact at an edge lifts the pin by up to 15 um; in a cycle that ends meanwhile m 0.3 m/s is left of F T.
FINE_WORK = 2e-5  # -, of F L, of a turn of 2 s. Measured: 4e-6 at 0.1 mm, 1e-15 at 0.25 mm
ROUNDING = 1e-12  # -, relative
SAME_MAP = 1e-6  # -, of the whole work, L1 of two maps: a step within rounding of an edge. Measured: 1e-13
CENTRE = 1e-15  # m, rounding of the place on a track of 22 mm
RECESSION = 20e-6  # m, half the overlap: what one wear update may take from under the pin
AFTER_RECESSION = 1e-5  # -, of F L. Measured: 4e-9
ARC_STEPS = 1500  # of 75 degrees


@pytest.fixture(scope="module")
def coarse():
    """Disc with elements of 0.5 mm round the track."""
    return disc(5e-4)


def cycles(folder, case, mesh, cuts):
    """Set the pin down, then one cycle between each two of these steps; sums of all ledgers, per triangle."""
    set_down(folder, case, mesh)
    sums = {name: np.zeros(len(mesh.triangles)) for name in SUMS}
    for k, (first, last) in enumerate(itertools.pairwise(cuts), start=1):
        ledger, _ = arc(folder, case, mesh, k, first, last - first)
        for name in SUMS:
            sums[name] += ledger.columns[name]
    return sums


def difference(one, other):
    """L1 of the difference of two maps of the work, over the whole work."""
    return np.abs(one - other).sum() / other.sum()


@pytest.mark.parametrize(
    ("case", "element_size", "count", "tolerance"),
    [
        (FAST, 1e-3, 3, WORK),
        (FAST, 5e-4, 3, WORK),
        pytest.param(PinCase().exact(), 2.5e-4, 12, FINE_WORK, marks=pytest.mark.verify),
        pytest.param(PinCase().exact(), 1e-4, 12, FINE_WORK, marks=pytest.mark.verify),
    ],
)
def test_a_turn_is_load_times_distance(tmp_path, case, element_size, count, tolerance):
    """One revolution in several cycles on the flat disc: F L, whatever the mesh; no rolling, no impact.

    The fine meshes at the study's 180 degrees per second and in its twelve cycles.
    """
    mesh, steps = disc(element_size), case.steps_per_turn
    sums = cycles(tmp_path, case, mesh, np.linspace(0, steps, count + 1).astype(int).tolist())
    expected = case.load_times_distance(steps)
    assert expected == pytest.approx(LOAD * 2.0 * math.pi * TRACK_RADIUS, rel=ROUNDING)
    assert sums["sliding_work_J"].sum() == pytest.approx(expected, rel=tolerance)
    assert sums["normal_impulse_N_s"].sum() == pytest.approx(LOAD * steps * case.time_step, rel=tolerance)
    assert sums["rolling_work_J"].sum() == sums["impact_energy_J"].sum() == 0.0
    assert np.count_nonzero(sums["contact_time_s"]) > 2.0 * math.pi * TRACK_RADIUS / element_size


def test_a_disc_that_turns_and_a_pin_that_goes_round_are_the_same(tmp_path, coarse):
    """The whole disc turning under a held pin does the same work, triangle by triangle, as the pin over its stretch."""
    period = 2.0 * math.pi / FAST.angular_velocity
    turn = f"fix turn all move/mesh mesh sample rotate origin 0. 0. 0. axis 0. 0. -1. period {period!r}"
    box = {"domain": "-0.03 0.03 -0.03 0.03 -0.01 0.02", "time_step": FAST.time_step, "steps": ARC_STEPS}
    held = run_case(tmp_path / "held", coarse, pin(TRACK_RADIUS, 0.0), PIN_MOTION, mesh_lines=[turn], **box)
    set_down(tmp_path, FAST, coarse)
    guided, _ = arc(tmp_path, FAST, coarse, 1, 0, ARC_STEPS)
    works = [ledger.columns["sliding_work_J"] for ledger in (guided, held)]
    assert works[1].sum() == pytest.approx(FAST.load_times_distance(ARC_STEPS), rel=WORK)
    assert difference(*works) < SAME_MAP


def test_the_stretch_is_as_good_as_the_whole_disc(tmp_path, coarse):
    """With all triangles and with those of the stretch: the same ledger, bit for bit."""
    set_down(tmp_path, FAST, coarse)
    ledger, _ = arc(tmp_path, FAST, coarse, 1, 0, ARC_STEPS)
    folder = tmp_path / "cycle_1"
    assert 0.1 < read_load_ledger(folder / "load_ledger.bin").triangles / len(coarse.triangles) < 0.3
    write_stl(folder / "surface.stl", coarse.points, coarse.triangles)
    run(folder)
    whole = read_load_ledger(folder / "load_ledger.bin", "sample_1", len(coarse.triangles), ARC_STEPS)
    for name in SUMS:
        np.testing.assert_array_equal(whole.columns[name], ledger.columns[name])


def test_cycles_add_up(tmp_path, coarse):
    """Three cycles, each with a mesh of its own, do what one does: the pin goes on where it was, at the same height."""
    cuts = [0, 500, 1100, ARC_STEPS]
    parts = cycles(tmp_path / "parts", FAST, coarse, cuts)
    whole = cycles(tmp_path / "whole", FAST, coarse, [0, ARC_STEPS])
    assert difference(parts["sliding_work_J"], whole["sliding_work_J"]) < SAME_MAP
    assert parts["contact_time_s"].sum() == pytest.approx(whole["contact_time_s"].sum(), rel=ROUNDING)


def watched(folder):
    """Run a cycle's deck, which also tells of the pin every 50 steps: x, y, z, velocity and spin in a row each."""
    columns, deck = "x y z vx vy vz omegax omegay omegaz", folder / "deck.in"
    watch = f"dump watch all custom 50 pin.txt {columns}\ndump_modify watch format '{' '.join(['%.17g'] * 9)}'\nrun  "
    deck.write_text(watch.join(deck.read_text().rsplit("run  ", 1)))
    run(folder)
    lines = (folder / "pin.txt").read_text().splitlines()[9::10]  # nine lines of header before each
    return np.array([line.split() for line in lines], dtype=float)[1:]


def test_the_pin_keeps_to_its_circle(tmp_path, coarse):
    """Every place is on the circle at the angle of its step, to rounding, with the holder's velocity; no spin."""
    set_down(tmp_path, FAST, coarse)
    for k, (first, last) in enumerate(itertools.pairwise([0, 400, 700]), start=1):
        write_arc(tmp_path / f"cycle_{k}", FAST, coarse, k, first, last - first)
        row = watched(tmp_path / f"cycle_{k}")
        angle = FAST.angular_velocity * FAST.time_step * (first + 50 * np.arange(1, len(row) + 1))
        around = np.column_stack([np.cos(angle), np.sin(angle)])
        assert np.abs(row[:, :2] - TRACK_RADIUS * around).max() < CENTRE
        forward = TRACK_RADIUS * FAST.angular_velocity * around[:, ::-1] * [-1.0, 1.0]
        np.testing.assert_allclose(row[:, 3:5], forward, atol=ROUNDING)
        assert not row[:, 6:].any()
        assert row[:, 2] == pytest.approx(RADIUS - hertz_overlap(), rel=1e-9)


def test_a_surface_that_recedes_under_the_pin_costs_no_work(tmp_path, coarse):
    """Half the overlap taken away at a stroke: after the rest the pin carries its load again, the work is F L."""
    set_down(tmp_path, FAST, coarse)
    lower = SurfaceMesh(coarse.points - [0.0, 0.0, RECESSION], coarse.triangles)
    ledger, forces = arc(tmp_path, FAST, lower, 1, 0, ARC_STEPS, report_steps=10)
    expected = FAST.load_times_distance(ARC_STEPS)
    assert ledger.columns["sliding_work_J"].sum() == pytest.approx(expected, rel=AFTER_RECESSION)
    assert ledger.columns["impact_energy_J"].sum() == 0.0
    moving = forces["run"] == 1
    assert forces["force_z"][moving][1:20] == pytest.approx(-LOAD, rel=1e-3)
    means = np.loadtxt(tmp_path / "cycle_1" / "forces.txt")
    assert means[:, 0].tolist() == list(range(10, ARC_STEPS + 1, 10))
    assert means[:, 3].mean() == pytest.approx(-LOAD, rel=1e-5)
    impulse = np.diff(forces["impulse"][moving]) / (10 * FAST.time_step)
    assert impulse == pytest.approx(-means[:, 3], rel=1e-4)  # on the flat the only normal is the vertical


def test_sampled_contacts_give_the_same_ledger(tmp_path, coarse):
    """With ledger: dumps the same arc, sampled at every step, gives the same map with any LIGGGHTS."""
    set_down(tmp_path, FAST, coarse)
    steps = 300
    summed, _ = arc(tmp_path, FAST, coarse, 1, 0, steps)
    chosen = write_arc(tmp_path / "cycle_1", FAST, coarse, 1, 0, steps, ledger="dumps")
    run(tmp_path / "cycle_1", solver="liggghts")
    stretch = SurfaceMesh(coarse.points, coarse.triangles[chosen])
    sampled = ledger_of_dumps(tmp_path / "cycle_1", stretch, FAST.time_step, 0)
    work = np.zeros(len(coarse.triangles))
    work[chosen] = sampled["sliding_work_J"]
    assert difference(work, summed.columns["sliding_work_J"]) < 1e-4
