"""One wear step on a synthetic ledger: what is handed on, what is refused."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, areas, read_surface, write_surface
from bulkwear.postproc.wear.caps import CAP_SHARES
from bulkwear.postproc.wear.mesh_faults import with_target_edges
from bulkwear.postproc.wear.remesh import RemeshError
from bulkwear.workflows.config.patterns import sample_surface
from bulkwear.workflows.engine import wear_step
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.schedule import first_span
from tests.support.tiny import tiny_study

RUN = "R9_convex"
EXACT = 1e-12  # relative; sums of some thousand numbers
FOLDER = "cycle"


@pytest.fixture
def chain(tmp_path):
    """The tiny convex run with its surface and nothing simulated."""
    study = tiny_study()
    parameters = study.run(RUN).parameters
    surface = tmp_path / "surface.vtu"
    write_surface(surface, sample_surface(parameters["sample"], parameters["pattern"]))
    (tmp_path / FOLDER).mkdir()
    return Chain(
        RUN, tmp_path, study.case, parameters, surface, study.beds[study.bed_of(RUN)], tmp_path / "bed.restart"
    )


def ledger_of(mesh, work_per_area: float) -> pd.DataFrame:
    """A ledger of even sliding work, contacts in the middle of each triangle."""
    area, middle = areas(mesh.points, mesh.triangles), mesh.points[mesh.triangles].mean(axis=1)
    even = {name: work_per_area * area for name in wear_step.SUMMED}
    position = {f"contact_position_{axis}_m": middle[:, k] for k, axis in enumerate("xyz")}
    radius = {"contact_radius_m": np.full(len(area), 1e-4)}
    return pd.DataFrame({"triangle": np.arange(len(area)), **even, **position, **radius, "finnie_wear": 0.0 * area})


def test_sums_over_cycles_are_those_of_the_ledgers(chain, tmp_path):
    """Two cycles on the same surface: the surface carries the sum of both ledgers, triangle by triangle."""
    mesh, span = read_surface(chain.surface), first_span(chain.parameters)
    ledger = ledger_of(mesh, 1e-3)
    wear_step.wear(chain, span, tmp_path / FOLDER, mesh, ledger)
    once = read_surface(tmp_path / FOLDER / "surface.vtu")
    wear_step.wear(chain, span, tmp_path / FOLDER, SurfaceMesh(mesh.points, mesh.triangles, once.cell_data), ledger)
    twice = read_surface(tmp_path / FOLDER / "surface.vtu")
    for name in wear_step.SUMMED:
        np.testing.assert_allclose(twice.cell_data[name], 2.0 * ledger[name], rtol=EXACT)


def test_a_surface_whose_normals_look_away_is_turned_and_wears_down(chain, tmp_path):
    """Pressed on the back of its facets only, it is turned, told, and recedes; its balance is that of the geometry."""
    mesh, span = read_surface(chain.surface), first_span(chain.parameters)
    upside = SurfaceMesh(mesh.points, mesh.triangles[:, [0, 2, 1]], mesh.cell_data)
    write_surface(chain.surface, upside)
    pressing = {f"{kind}_{axis}_N_s": 0.0 for kind in ("impulse", "back_impulse") for axis in "xy"}
    down = -areas(mesh.points, mesh.triangles)  # N s on the mesh, from above
    ledger = ledger_of(upside, 1e2).assign(**pressing, impulse_z_N_s=down, back_impulse_z_N_s=down)
    row = wear_step.wear(chain, span, tmp_path / FOLDER, upside, ledger)
    worn = read_surface(tmp_path / FOLDER / "surface.vtu")
    assert row["turned_faces"] == len(mesh.triangles)
    assert row["applied_volume_m3"] > 0.0
    assert row["balance_error"] < 1e-9
    assert (worn.points[:, 2] <= mesh.points[:, 2]).all()
    assert np.array_equal(worn.triangles, mesh.triangles)


def test_remeshing_hands_sums_on_part_by_part(chain):
    """As sums per area, with two triangles of the base exchanged for their three parts, every part keeps its sum."""
    mesh = read_surface(chain.surface)
    sums = {name: np.linspace(1.0, 2.0, len(mesh.triangles)) for name in wear_step.SUMS}
    before = SurfaceMesh(mesh.points, mesh.triangles, {**mesh.cell_data, **sums})
    split = int(np.flatnonzero(before.cell_data["part"] == 0)[0])
    dense = wear_step.as_densities(before)
    a, b, c = mesh.triangles[split]
    centre = len(mesh.points)
    triangles = np.vstack([np.delete(mesh.triangles, split, 0), [(a, b, centre), (b, c, centre), (c, a, centre)]])
    cells = {k: np.concatenate([np.delete(v, split, 0), [v[split]] * 3]) for k, v in dense.cell_data.items()}
    points = np.vstack([mesh.points, mesh.points[[a, b, c]].mean(axis=0)])
    after = wear_step.as_sums(SurfaceMesh(points, triangles, cells), before)
    for part in np.unique(before.cell_data["part"]):
        old, new = (m.cell_data["sliding_work_J"][m.cell_data["part"] == part].sum() for m in (before, after))
        assert new == pytest.approx(old, rel=EXACT)


def test_a_surface_beyond_repair_stops_with_run_and_cycle(chain, monkeypatch):
    """The sentence of the remeshing, with the run and the cycle in front; nothing is written."""

    def refuses(mesh, bounds, moved):
        raise RemeshError("faces cut one another at (1, 2, 3) mm")

    monkeypatch.setattr(wear_step, "remesh", refuses)
    mesh, span = read_surface(chain.surface), first_span(chain.parameters)
    with pytest.raises(wear_step.WearError, match=r"R9_convex, cycle 1: faces cut one another at \(1, 2, 3\) mm"):
        wear_step.wear(chain, span, chain.folder / FOLDER, mesh, ledger_of(mesh, 1e-3))
    assert not (chain.folder / FOLDER / "surface.vtu").exists()


def test_a_surface_beyond_repair_is_worn_by_less(chain, monkeypatch):
    """The cap is halved until the surface can be repaired; what is not applied is carried, and the balance closes."""
    mesh, span = read_surface(chain.surface), first_span(chain.parameters)
    whole = wear_step.wear(chain, span, chain.folder / FOLDER, mesh, ledger_of(mesh, 1e3))
    repair, refused = wear_step.remesh, iter((True, True, False))

    def refuses_twice(*of_remesh):
        if next(refused):
            raise RemeshError("faces cut one another at (1, 2, 3) mm")
        return repair(*of_remesh)

    monkeypatch.setattr(wear_step, "remesh", refuses_twice)
    less = wear_step.wear(chain, span, chain.folder / FOLDER, mesh, ledger_of(mesh, 1e3))
    assert less["step_limit_m"] == 0.25 * whole["step_limit_m"]
    assert 0.0 < less["applied_volume_m3"] < 0.5 * whole["applied_volume_m3"]
    due = [row["applied_volume_m3"] + row["carried_volume_m3"] for row in (less, whole)]
    assert due == pytest.approx([whole["worn_volume_m3"]] * 2, rel=EXACT)


def test_a_spot_beyond_repair_is_held_back_alone(chain, monkeypatch):
    """Only nodes near the place that is told lose less, down to nothing; the cap of others stays."""
    mesh, span = read_surface(chain.surface), first_span(chain.parameters)
    whole = wear_step.wear(chain, span, chain.folder / FOLDER, mesh, ledger_of(mesh, 1e3))
    repair, refused = wear_step.remesh, iter([True] * len(CAP_SHARES) + [False])
    spot = mesh.points[mesh.triangles[mesh.cell_data["part"] == 0][0]].mean(axis=0)

    def refuses_a_spot(*of_remesh):
        if next(refused):
            raise RemeshError("faces cut one another at (1, 2, 3) mm", spot[None])
        return repair(*of_remesh)

    monkeypatch.setattr(wear_step, "remesh", refuses_a_spot)
    less = wear_step.wear(chain, span, chain.folder / FOLDER, mesh, ledger_of(mesh, 1e3))
    assert less["step_limit_m"] == whole["step_limit_m"]
    assert 0.5 * whole["applied_volume_m3"] < less["applied_volume_m3"] < whole["applied_volume_m3"]
    worn = read_surface(chain.folder / FOLDER / "surface.vtu")
    near = np.linalg.norm(mesh.points - spot, axis=1) < with_target_edges(mesh).point_data["target_edge_m"]
    assert near.any() and np.isin(mesh.points[near].view("V24"), worn.points.view("V24")).all()


def test_a_block_that_stands_for_no_operation_keeps_the_shape(chain):
    """Nor does what an earlier update held back move it."""
    mesh, span = read_surface(chain.surface), first_span(chain.parameters)
    kept, worn = replace(span, phase="worn"), replace(span, phase="wearing", stands_for_s=1.0)
    limits = [wear_step.node_limits(chain.case, chain.parameters, mesh, each) for each in (kept, worn, span)]
    assert [limit.any() for limit in limits] == [False, True, True]


def test_a_sliver_stops_before_the_solver_refuses_it(chain, monkeypatch):
    """A triangle flatter than the solver takes is named with its place; one that is merely acute is not."""
    mesh = read_surface(chain.surface)
    assert wear_step.sliver(mesh) is None
    face = int(np.flatnonzero(mesh.cell_data["part"] == 0)[0])
    a, b, c = mesh.triangles[face]
    points = mesh.points.copy()
    points[c] = 0.5 * (points[a] + points[b]) + 1e-3 * (points[c] - points[a])
    assert "has an angle of" in wear_step.sliver(SurfaceMesh(points, mesh.triangles, mesh.cell_data))


def test_elements_as_built_are_the_target_of_remeshing(chain):
    """The first cycle notes the edges of the pristine surface; later ones keep the note."""
    mesh, span = read_surface(chain.surface), first_span(chain.parameters)
    wear_step.wear(chain, span, chain.folder / FOLDER, mesh, ledger_of(mesh, 1e-3))
    worn = read_surface(chain.folder / FOLDER / "surface.vtu")
    np.testing.assert_array_equal(worn.point_data["target_edge_m"], with_target_edges(mesh).point_data["target_edge_m"])
