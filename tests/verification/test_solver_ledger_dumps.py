"""The two producers of a ledger beside each other, and the solver's own Finnie wear: same contacts, same sums.

A dump at every step still is not what the solver's ledger sees. The solver calculates forces from velocities in the
middle of the step (velocity Verlet), and hands them to the ledger as they are. The dump is written at the step's end,
when velocities have had the second half of their kick, and calculates the contact forces once more from those: the
damping part of the normal force differs by c a dt/2, with the damping coefficient c and the acceleration a. That
averages out over an oscillation but not on each triangle. Positions and sliding speeds are the same in both, and so is
friction: the dump has the force of the step beside the one that it evaluates.
"""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import areas, stl_corners
from bulkwear.postproc.readers.mesh_loads import read_mesh_loads
from bulkwear.postproc.wear.ledger import vector_columns
from tests.verification.ledger_cases import (
    DUMP_LINES,
    LOAD,
    PIN_MOTION,
    RADIUS,
    hertz_overlap,
    ledger_of_dumps,
    pin,
    ring,
    run_case,
    table_of_solver,
    total,
)

pytestmark = pytest.mark.solver

MAP_TOLERANCE = 1e-4  # of the total, sum of the differences of all triangles. Measured: 4e-5 and less
RADIUS_TOLERANCE = 2e-3  # relative, of a single triangle: one that is hardly touched has a single sample of the force
POSITION_TOLERANCE = 1e-6  # m; means weighted with slightly different work
FINNIE_TOLERANCE = 1e-9  # relative; the solver writes 11 digits
FINNIE_COEFFICIENT = 1e-12  # 1/Pa, of the frame deck
# Less than the overlap that carries the load: the pin falls in and oscillates, so that forces and speeds vary.
HEIGHT = RADIUS - 0.8 * hertz_overlap()  # m
DRAGGED = [*pin(1.31234567e-4, -0.0040007123456, HEIGHT), "velocity all set 0.0 1.0 0.0 units box"]
LOADS = "dump loads all mesh/vtk {steps} loads_*.vtk stress wear id sample"


def assert_same_map(ledger, mesh, table, tolerance=MAP_TOLERANCE):
    """Works and impulses agree triangle by triangle, time exactly, the contact radius closely."""
    exact = table_of_solver(ledger, mesh)
    for name in ("sliding_work_J", "normal_impulse_N_s", "tangential_work_J", "drive_work_J"):
        assert np.abs(exact[name] - table[name]).sum() <= tolerance * exact[name].sum(), name
    for name in ("impulse", "moment"):
        one, other = (np.array([each[field] for field in vector_columns(name)]) for each in (exact, table))
        assert np.abs(one - other).sum() <= tolerance * np.abs(one).sum(), name
    assert not any(table[field].any() or exact[field].any() for field in vector_columns("back_impulse"))
    assert ledger.columns["contact_time_s"] == pytest.approx(table["contact_time_s"], rel=1e-9)
    radius, sampled = ledger.columns["contact_radius_m"], table["contact_radius_m"]
    assert np.array_equal(np.isnan(radius), np.isnan(sampled))
    assert radius == pytest.approx(sampled, rel=RADIUS_TOLERANCE, nan_ok=True)


@pytest.mark.parametrize("element_size", [1e-3, 0.5e-3])
def test_straight_drag_gives_the_same_map(tmp_path, element_size):
    """Per triangle: sliding work, impulse, contact time, contact radius and contact position agree."""
    mesh = flat_plate(0.006, 0.012, element_size)
    ledger = run_case(tmp_path, mesh, DRAGGED, PIN_MOTION, outputs=DUMP_LINES)
    table = ledger_of_dumps(tmp_path, mesh, 2e-6, after_step=0)
    assert_same_map(ledger, mesh, table)
    weights = np.column_stack([ledger.columns[f"contact_weight_{k}"] for k in (1, 2, 3)])
    position = np.einsum("ik,ikj->ij", weights, stl_corners(mesh.points, mesh.triangles))
    sampled = np.column_stack([table[f"contact_position_{axis}_m"] for axis in "xyz"])
    assert position == pytest.approx(sampled, abs=POSITION_TOLERANCE, nan_ok=True)


def test_turning_disc_gives_the_same_map(tmp_path):
    """A disc that turns under a pin at rest: the maps agree as well."""
    period, time_step, steps = 0.05, 2e-6, 4000
    mesh = ring(0.0214, 0.0226, 0.5e-3)
    turn = f"fix turn all move/mesh mesh sample rotate origin 0.0 0.0 0.0 axis 0.0 0.0 1.0 period {period}"
    box = {"domain": "-0.03 0.03 -0.03 0.03 -0.01 0.02", "time_step": time_step, "steps": steps, "outputs": DUMP_LINES}
    ledger = run_case(tmp_path, mesh, pin(0.022, 3.1234e-5, HEIGHT), PIN_MOTION, mesh_lines=[turn], **box)
    omega = 2 * np.pi / period

    def pose(step):
        angle = omega * time_step * step
        return [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]], np.zeros(3)

    table = ledger_of_dumps(tmp_path, mesh, time_step, 0, wall_angular_velocity=(0.0, 0.0, omega), pose=pose)
    assert_same_map(ledger, mesh, table)
    assert total(ledger, "normal_impulse_N_s") == pytest.approx(LOAD * steps * time_step, rel=1e-2)  # it fell in first


def test_finnie_kernel_is_the_solver_s_own_wear(tmp_path):
    """k times the kernel's sum is `wear finnie` times the area, triangle by triangle, in shallow and steep hits.

    The solver's wear also holds the contacts seen when the run was set up: they stand in the dump of the first step.
    """
    steps, mesh = 6000, flat_plate(0.006, 0.012, 1e-3)
    bouncing = [
        *pin(1.31234567e-4, -0.0040007123456, HEIGHT),
        "velocity all set 0.0 1.0 -0.5 units box",
        f"create_atoms 1 single 0.0 0.0035 {1.5 * RADIUS} units box",
        f"set atom 2 density 4850.0 diameter {2 * RADIUS} vz -1.0 vy -0.3",
    ]
    motion = ["fix load all addforce 0.0 0.0 -20.0", "fix integrate all nve/sphere"]
    ledger = run_case(tmp_path, mesh, bouncing, motion, steps=steps, friction=0.3, outputs=[LOADS.format(steps=steps)])
    first, last = (read_mesh_loads(tmp_path / f"loads_{step}.vtk", len(mesh.triangles)) for step in (0, steps))
    worn = (last["finnie_wear"] - first["finnie_wear"]) * areas(mesh.points, mesh.triangles)
    assert np.count_nonzero(worn) > 5
    ours = FINNIE_COEFFICIENT * ledger.columns["finnie_work_J"]
    assert ours == pytest.approx(worn, rel=FINNIE_TOLERANCE, abs=FINNIE_TOLERANCE * worn.max())
