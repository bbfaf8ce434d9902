"""Refinement: edges below their limit, the surface where it was, no crack, no sliver that could be avoided."""

import re
import subprocess

import numpy as np
import pytest

from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.meshes.own.refine import LONGEST_OVER_TARGET, WANTED_ANGLE, Ball, Box, NearPlaces, across_edges
from bulkwear.meshes.own.weld import open_corners
from bulkwear.postproc.mesh import (
    boundary_edges,
    centroids,
    edge_lengths_per_triangle,
    nonmanifold_edges,
    smallest_angles,
    write_stl,
)
from bulkwear.postproc.mesh_checks import intersecting_faces, overlapping_faces
from tests.support.own_solids import MM, box, write_ascii, write_binary

EXACT = 1e-12  # relative: sums over some thousand triangles
SINGLE = 1e-6  # relative: binary STL has 24 bits
ROUNDING = 1e-12  # m
SIDES = 48  # of the hopper's outlet
DECK = """\
units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
region box block -1 1 -1 1 -1 1 units box
create_box 1 box
create_atoms 1 single 0.9 0.9 0.9
set group all diameter 0.02 density 1000
neighbor 0.002 bin
neigh_modify delay 0 one 20000 page 1000000
fix youngs_modulus all property/global youngsModulus peratomtype 5e6
fix poissons_ratio all property/global poissonsRatio peratomtype 0.3
fix restitution all property/global coefficientRestitution peratomtypepair 1 0.5
fix friction all property/global coefficientFriction peratomtypepair 1 0.4
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1e-9
fix own all mesh/surface/stress file own.stl type 1
fix walls all wall/gran model hertz tangential history mesh n_meshes 1 meshes own
fix motion all nve/sphere
run 1
"""


def plate_with_hole(thickness=8.0):
    """Points mm and triangles of a closed plate with a round hole, as CAD writes it: slivers from rim to outline."""
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    rim = 40.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    outline = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1.0]]) * 150.0
    quarter = SIDES // 4
    flat = []
    for k in range(SIDES):
        corner = SIDES + k // quarter
        flat.append([k, corner, (k + 1) % SIDES])
    flat += [[(k + 1) * quarter % SIDES, SIDES + k, SIDES + (k + 1) % 4] for k in range(4)]
    flat, count = np.array(flat), SIDES + 4
    rings = [np.arange(SIDES), SIDES + np.arange(4)]
    walls = []
    for ring, turned in zip(rings, (False, True), strict=True):
        ahead = np.roll(ring, -1)
        wall = np.concatenate(
            [np.column_stack([ring, ahead, ahead + count]), np.column_stack([ring, ahead + count, ring + count])]
        )
        walls.append(wall[:, ::-1] if turned else wall)
    plan = np.concatenate([rim, outline])
    points = np.concatenate([np.column_stack([plan, np.full(count, z)]) for z in (0.0, thickness)])
    return points, np.concatenate([flat, flat[:, ::-1] + count, *walls])


@pytest.fixture(scope="module")
def tilted():
    """The plate with a hole, tilted, so that nothing lies along an axis; written with all digits."""
    points, triangles = plate_with_hole()
    turn, _ = np.linalg.qr(np.random.default_rng(20220317).random((3, 3)))
    return points @ turn.T, triangles


def written(tmp_path, points, triangles):
    """The path of an STL with that body."""
    write_ascii(tmp_path / "a.stl", {"plate": (points, triangles)})
    return tmp_path / "a.stl"


@pytest.mark.parametrize("edge", [0.06, 0.02, 0.007])
def test_the_surface_stays_where_it_was(tmp_path, tilted, edge):
    """Volume, area and bounding box do not change, and what was closed is closed."""
    path = written(tmp_path, *tilted)
    before, after = own_mesh(path, "mm"), own_mesh(path, "mm", edge)
    (old,), (new,) = before.parts, after.parts
    assert new.triangles > old.triangles
    assert new.closed
    assert new.volume_m3 == pytest.approx(old.volume_m3, rel=EXACT)
    assert new.area_m2 == pytest.approx(old.area_m2, rel=EXACT)
    np.testing.assert_allclose([new.low_m, new.high_m], [old.low_m, old.high_m], atol=ROUNDING)


@pytest.mark.parametrize(("edge", "angle"), [(0.06, 9.0), (0.02, WANTED_ANGLE), (0.007, WANTED_ANGLE)])
def test_no_edge_is_longer_than_stated(tmp_path, tilted, edge, angle):
    """Edges end at 1.5 targets; flat regions of slivers get angles above the wanted one, or, where the rim of the hole
    is ten times finer than the target, nearly so; no crack, no cut.
    """
    surface = own_mesh(written(tmp_path, *tilted), "mm", edge).surface
    points, triangles = surface.points, surface.triangles
    assert edge_lengths_per_triangle(points, triangles).max() <= LONGEST_OVER_TARGET * edge
    assert smallest_angles(points, triangles).min() > angle
    assert len(boundary_edges(triangles)) == len(nonmanifold_edges(triangles)) == 0
    assert len(intersecting_faces(points, triangles)) == 0
    assert len(overlapping_faces(points, triangles, 1e-9)) == 0


def test_single_precision_moves_it_by_less_than_the_tolerance(tmp_path, tilted):
    """Facets of a binary STL are flat within its digits only; the table says how far turning edges moved it."""
    write_binary(tmp_path / "a.stl", *tilted)
    before, after = own_mesh(tmp_path / "a.stl", "mm"), own_mesh(tmp_path / "a.stl", "mm", 0.02)
    assert after.parts[0].volume_m3 == pytest.approx(before.parts[0].volume_m3, rel=SINGLE)
    (row,) = (row for row in after.repairs if row.repair == "edges turned in flat regions")
    assert 0.0 < row.largest_mm <= after.weld_m / MM


def test_parts_have_edges_of_their_own(tmp_path):
    """Fine where told fine, untouched where nothing is told."""
    points, triangles = box((200.0, 100.0, 50.0))
    write_ascii(tmp_path / "a.stl", {"a": (points, triangles), "b": (points + np.array([300.0, 0, 0]), triangles)})
    fine, whole = own_mesh(tmp_path / "a.stl", "mm", {"a": 0.01}).parts
    assert fine.longest_edge_m <= LONGEST_OVER_TARGET * 0.01
    assert whole.triangles == 12
    fine, coarse = own_mesh(tmp_path / "a.stl", "mm", {"a": 0.01, "*": 0.05}).parts
    assert coarse.longest_edge_m <= LONGEST_OVER_TARGET * 0.05
    assert fine.triangles > 10 * coarse.triangles


def test_parts_with_common_edges_fit_together(tmp_path):
    """A body of one solid per face: a fine face beside coarse ones leaves no crack, and all labels stay."""
    points, triangles = box((100.0, 80.0, 60.0))
    write_ascii(tmp_path / "a.stl", {f"side_{k}": (points, triangles[[k, k + 6]]) for k in range(6)})
    found = own_mesh(tmp_path / "a.stl", "mm", {"side_1": 0.004, "*": 0.03})
    surface = found.surface
    assert len(boundary_edges(surface.triangles)) == 0
    assert [part.area_m2 for part in found.parts] == pytest.approx(
        [part.area_m2 for part in own_mesh(tmp_path / "a.stl", "mm").parts], rel=EXACT
    )
    assert found.parts[1].longest_edge_m <= LONGEST_OVER_TARGET * 0.004
    assert found.parts[0].triangles < 0.5 * found.parts[1].triangles


def _callable(places):
    return np.where(np.linalg.norm(places - (0.1, 0.05, 0.05), axis=1) < 0.02, 0.002, np.inf)


@pytest.mark.parametrize(
    "region",
    [
        Ball((0.1, 0.05, 0.05), 0.02, 0.002),
        Box((0.08, 0.03, 0.04), (0.12, 0.07, 0.06), 0.002),
        NearPlaces(np.array([[0.1, 0.05, 0.05]]), 0.02, 0.002),
        _callable,
    ],
    ids=["ball", "box", "near places", "function"],
)
def test_regions_are_finer(tmp_path, region):
    """Where a region asks for it edges are below its limit, far away they are not touched, and no crack opens."""
    points, triangles = box((200.0, 100.0, 50.0))
    path = written(tmp_path, points, triangles)
    plain, found = own_mesh(path, "mm", 0.02), own_mesh(path, "mm", 0.02, [region])
    surface = found.surface
    places, longest = (
        centroids(surface.points, surface.triangles),
        edge_lengths_per_triangle(surface.points, surface.triangles),
    )
    inside = np.linalg.norm(places - (0.1, 0.05, 0.05), axis=1) < 0.019
    assert inside.sum() > 100
    assert longest[inside].max() <= LONGEST_OVER_TARGET * 0.002
    assert len(surface.triangles) < 6000  # everywhere so fine it would be 40,000
    assert found.parts[0].closed
    assert found.parts[0].volume_m3 == pytest.approx(plain.parts[0].volume_m3, rel=EXACT)


def test_an_open_sheet_keeps_its_outline(tmp_path):
    """The outline is as long as before, in smaller pieces."""
    points, triangles = plate_with_hole()
    sheet = triangles[: SIDES + 4]
    path = written(tmp_path, points, sheet)
    lengths = []
    for edge in (None, 0.01):
        surface = own_mesh(path, "mm", edge).surface
        edges = boundary_edges(surface.triangles)
        lengths.append(np.linalg.norm(np.diff(surface.points[edges], axis=1), axis=2).sum())
        assert len(open_corners(surface.triangles)) == len(edges)
    assert lengths[1] == pytest.approx(lengths[0], rel=EXACT)


def test_slivers_without_a_target_are_turned(tmp_path):
    """A strip cut into needles that the solver refuses gets good angles without a new node."""
    x = np.linspace(0.0, 100.0, 11)
    points = np.concatenate([np.column_stack([x, 0 * x, 0 * x]), np.column_stack([x, 0 * x + 0.4, 0 * x])])
    fan = [[21, k, k + 1] for k in range(10)] + [[0, k + 1, k] for k in range(11, 21)]
    found = own_mesh(written(tmp_path, points, np.array(fan)), "mm")
    assert len(found.surface.points) == 22
    assert found.parts[0].smallest_angle_deg == pytest.approx(np.degrees(np.arctan2(0.4, 10.0)))


def test_neighbours_across_edges():
    """Each edge names the triangle across it, -1 where it is open."""
    assert across_edges(np.array([[0, 1, 2], [2, 1, 3]])).tolist() == [[-1, 1, -1], [0, -1, -1]]


def loaded(folder, points, triangles):
    """How many triangles of a surface LIGGGHTS says it has loaded."""
    write_stl(folder / "own.stl", points, triangles)
    (folder / "deck.in").write_text(DECK)
    command = ["stdbuf", "-o0", "liggghts", "-in", "deck.in"]
    said = subprocess.run(command, cwd=folder, check=True, capture_output=True).stdout.decode(errors="replace")
    return int(re.search(r"mesh own containing (\d+) triangle\(s\) successful", said)[1])


@pytest.mark.solver
@pytest.mark.parametrize("edge", [None, 0.02])
def test_the_solver_takes_bodies_that_touch_apart(tmp_path, edge):
    """Two cubes with a side in common, one the mirror image of the other: facets that LIGGGHTS refuses in one mesh.
    That is said before, and it takes each part.
    """
    points, triangles = box((100.0, 100.0, 100.0))
    mirrored = points * (-1.0, 1.0, 1.0) + np.array([200.0, 0, 0])
    write_ascii(tmp_path / "a.stl", {"a": (points, triangles), "b": (mirrored, triangles[:, ::-1])})
    found = own_mesh(tmp_path / "a.stl", "mm", edge)
    assert not found.one_mesh
    assert any("a mesh per part for the solver" in row.repair for row in found.repairs)
    with pytest.raises(subprocess.CalledProcessError):
        loaded(tmp_path, found.surface.points, found.surface.triangles)
    for number, part in enumerate(found.parts):
        mine = found.surface.triangles[found.surface.cell_data["part"] == number]
        assert loaded(tmp_path, found.surface.points, mine) == part.triangles


@pytest.mark.solver
@pytest.mark.parametrize("corner", [(103.0, 0.0, 0.0), (50.0, 30.0, 20.0), (100.0, 30.0, 20.0), (100.0, 100.0, 0.0)])
def test_the_solver_takes_other_parts_together(tmp_path, corner):
    """Cubes apart, through one another, side to side off the edges, with an edge in common: one mesh, as is said."""
    points, triangles = box((100.0, 100.0, 100.0))
    write_ascii(tmp_path / "a.stl", {"a": (points, triangles), "b": (points + np.array(corner), triangles)})
    found = own_mesh(tmp_path / "a.stl", "mm", 0.02)
    assert found.one_mesh
    assert loaded(tmp_path, found.surface.points, found.surface.triangles) == len(found.surface.triangles)


@pytest.mark.solver
@pytest.mark.parametrize("edge", [None, 0.01])
def test_the_solver_keeps_every_triangle(tmp_path, tilted, edge):
    """LIGGGHTS loads as many triangles as the surface has: none is degenerate, double or too sharp for it."""
    surface = own_mesh(written(tmp_path, *tilted), "mm", edge).surface
    assert loaded(tmp_path, surface.points, surface.triangles) == len(surface.triangles)
