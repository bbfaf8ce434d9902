"""The solver's load ledger on one, two and four processes and across periodic boundaries: each contact once."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import write_stl
from bulkwear.postproc.readers.load_ledger import SUMS, WORKS, read_load_ledger
from tests.verification.ledger_cases import (
    LOAD,
    MESH_LINE,
    PIN_MOTION,
    RADIUS,
    hertz_overlap,
    pin,
    ring,
    run_case,
    total,
)

pytestmark = pytest.mark.solver

RANK_TOLERANCE = 1e-12  # relative; one trajectory, its sums split between two processes
PRINTED = 1e-12  # relative; the solver prints 15 digits
SEAM_TOLERANCE = 0.02  # relative; where two meshes meet. Measured: 0.007 each, 0.0007 in all
LAW_TOLERANCE = 1e-6  # relative, as on one process without periodic boundaries
STEPS, TIME_STEP = 4000, 2e-6  # -, s, of the frame deck
SPEED = 1.0  # m/s
WEIGHTS = ("contact_weight_1", "contact_weight_2", "contact_weight_3")
CENTRED = "-0.02 0.02 -0.02 0.02 -0.01 0.02"  # m; half of it belongs to each process
TIGHT = "-0.005 0.005 -0.006 0.006 -0.01 0.02"  # m; the plate's own edges are the box's faces in x and y
# Half the overlap that carries the load: the pin falls in and oscillates, so that every term of the sums differs.
HEIGHT = RADIUS - 0.5 * hertz_overlap()  # m


def assert_same_ledger(found, expected, tolerance=RANK_TOLERANCE):
    """All columns agree triangle by triangle, against the largest value of the column."""
    assert found.header["contacts"] == expected.header["contacts"]
    assert found.steps == expected.steps
    for name, values in expected.columns.items():
        largest = np.nanmax(np.abs(values))
        assert found.columns[name] == pytest.approx(values, rel=0, abs=tolerance * largest, nan_ok=True), name


def dragged(folder, ranks, processors, place, direction, height=HEIGHT, mesh=None, **rest):
    """A pin dragged over a plate of 10 x 12 mm."""
    mesh = flat_plate(0.01, 0.012, 0.5e-3) if mesh is None else mesh
    velocity = " ".join(str(SPEED * part) for part in direction)
    particles = [*pin(*place, height), f"velocity all set {velocity} 0.0 units box"]
    return run_case(folder, mesh, particles, PIN_MOTION, ranks, processors=processors, **rest)


@pytest.mark.parametrize(
    ("processors", "place", "direction"),
    [
        ("2 1 1", (-0.001000712, 1.31234567e-4), (1, 0)),  # crosses from one process to the other
        pytest.param("1 2 1", (1.31234567e-4, -0.001000712), (0, 1), marks=pytest.mark.verify),
        ("1 2 1", (-0.001000712, 1.1e-8), (1, 0)),  # runs along the border
    ],
)
def test_two_processes_give_the_ledger_of_one(tmp_path, processors, place, direction):
    """A straight drag that changes process, or runs along the border between two: the same ledger."""
    short = {"domain": CENTRED, "steps": 1000}
    one = dragged(tmp_path / "one", 1, "1 1 1", place, direction, **short)
    two = dragged(tmp_path / "two", 2, processors, place, direction, **short)
    assert two.header["ranks"] == 2
    assert_same_ledger(two, one)


def test_four_processes_give_the_ledger_of_one(tmp_path):
    """A drag along the border between two and on through the place where all four meet: the same ledger."""
    place, short = (-0.000500712, 1.1e-8), {"domain": CENTRED, "steps": 500}
    one = dragged(tmp_path / "one", 1, "1 1 1", place, (1, 0), **short)
    four = dragged(tmp_path / "four", 4, "2 2 1", place, (1, 0), **short)
    assert four.header["ranks"] == 4
    assert_same_ledger(four, one)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.verify)])
def test_totals_for_thermo_output(tmp_path, ranks):
    """f_load_ledger and f_load_ledger[1] ... [7] are the sums of the file's columns, on any number of processes."""
    names = (*SUMS, *WORKS)
    variables = [f"variable total{k} equal f_load_ledger[{k}]" for k in range(1, 8)]
    printed = " ".join(f"${{total{k}}}" for k in range(1, 8))
    watch = f'fix watch all print 100 "${{total0}} {printed}" file totals.txt screen no'
    outputs = [*variables, "variable total0 equal f_load_ledger", "set group all omegax 200.0", watch]
    case = {"domain": CENTRED, "steps": 1500, "outputs": outputs}
    above = RADIUS + 1e-6  # m, so that there is an impact
    ledger = dragged(tmp_path, ranks, f"{ranks} 1 1", (-0.002000712, 1.31234567e-4), (1, 0), above, **case)
    totals = np.loadtxt(tmp_path / "totals.txt")[-1]
    sums = [total(ledger, name) for name in names]
    assert min(sums[:-1]) > 0.0  # nothing drives the plate
    assert totals == pytest.approx([sums[0], *sums], rel=PRINTED)


def test_two_meshes_have_a_ledger_each(tmp_path):
    """A pin that is dragged from one mesh to another: each ledger holds what was done to its own mesh.

    Where the meshes meet both rims are touched at once for a moment, which lifts the pin and slides on two faces.
    """
    mesh = flat_plate(0.01, 0.006, 0.5e-3)
    write_stl(tmp_path / "ahead.stl", mesh.points + np.array([0.0, 0.006, 0.0]), mesh.triangles)
    other = MESH_LINE.replace("fix sample", "fix ahead").replace("sample.stl", "ahead.stl")
    second = "fix second all load/ledger mesh ahead file ahead.bin"
    case = {"mesh_lines": [other], "meshes": "2 meshes sample ahead", "outputs": [second]}
    place = (1.31234567e-4, -0.001000712)  # 4 mm before the rim, 4 mm of travel behind it
    first = dragged(tmp_path, 1, "1 1 1", place, (0, 1), RADIUS - hertz_overlap(), mesh, **case)
    second = read_load_ledger(tmp_path / "ahead.bin", "ahead", len(mesh.triangles))
    expected = LOAD * SPEED * STEPS * TIME_STEP
    both = total(first, "sliding_work_J"), total(second, "sliding_work_J")
    assert both == pytest.approx((expected / 2, expected / 2), rel=SEAM_TOLERANCE)
    assert sum(both) == pytest.approx(expected, rel=SEAM_TOLERANCE)
    assert total(first, "impact_energy_J") == 0.0


@pytest.mark.verify
def test_turning_disc_on_two_processes(tmp_path):
    """A disc whose triangles wander from process to process under a pin at rest near the border: the same ledger."""
    mesh, steps, time_step = ring(0.0214, 0.0226, 0.5e-3), 800, 5e-6
    turn = "fix turn all move/mesh mesh sample rotate origin 0.0 0.0 0.0 axis 0.0 0.0 1.0 period 0.05"
    place = (0.022, 1.234e-4)
    box = {"domain": "-0.03 0.03 -0.03 0.03 -0.01 0.02", "time_step": time_step, "steps": steps}
    box |= {"mesh_lines": [turn]}
    one, two = (
        run_case(tmp_path / str(ranks), mesh, pin(*place), PIN_MOTION, ranks, processors=f"1 {ranks} 1", **box)
        for ranks in (1, 2)
    )
    assert_same_ledger(two, one)
    expected = LOAD * 2 * np.pi * np.hypot(*place) * steps * time_step / 0.05
    assert total(two, "sliding_work_J") == pytest.approx(expected, rel=LAW_TOLERANCE)


@pytest.mark.parametrize(
    ("direction", "ranks"),
    [
        ((1, 0), 1),
        pytest.param((1, 0), 2, marks=pytest.mark.verify),
        ((0, 1), 1),
        pytest.param((0, 1), 2, marks=pytest.mark.verify),
    ],
)
def test_periodic_boundary_under_a_pin(tmp_path, ranks, direction):
    """A pin that leaves at one face of a periodic box and comes in at the other: F L, each step one contact."""
    place = (0.001000712, 1.31234567e-4) if direction == (1, 0) else (1.31234567e-4, 0.001000712)
    ledger = dragged(
        tmp_path, ranks, f"{ranks} 1 1", place, direction, RADIUS - hertz_overlap(), boundary="p p f", domain=TIGHT
    )
    assert total(ledger, "sliding_work_J") == pytest.approx(LOAD * SPEED * STEPS * TIME_STEP, rel=LAW_TOLERANCE)
    assert ledger.header["contacts"] == STEPS
    assert total(ledger, "impact_energy_J") == 0.0
    assert_inside(ledger)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.verify)])
def test_periodic_boundary_crossed_by_the_mesh_too(tmp_path, ranks):
    """A plate that moves against the pin and crosses the same boundary: F L with the relative distance."""
    mesh = flat_plate(0.01, 0.012, 0.5e-3)
    moving = f"fix carry all move/mesh mesh sample linear {-0.5 * SPEED} 0.0 0.0"
    ledger = dragged(
        tmp_path, ranks, f"{ranks} 1 1", (0.001000712, 1.31234567e-4), (0.5, 0), RADIUS - hertz_overlap(), mesh,
        mesh_lines=[moving], boundary="p p f", domain=TIGHT,
    )  # fmt: skip
    assert total(ledger, "sliding_work_J") == pytest.approx(LOAD * SPEED * STEPS * TIME_STEP, rel=LAW_TOLERANCE)
    assert ledger.header["contacts"] == STEPS
    assert_inside(ledger)


def assert_inside(ledger):
    """Mean contact points lie inside their triangles, at whichever periodic image the contact was."""
    weights = np.column_stack([ledger.columns[name] for name in WEIGHTS])[ledger.columns["contact_time_s"] > 0]
    assert weights.min() > 0.0
    assert weights.max() < 1.0
    assert weights.sum(axis=1) == pytest.approx(1.0, abs=RANK_TOLERANCE)
