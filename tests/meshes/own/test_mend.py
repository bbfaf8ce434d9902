"""What is mended: equal points, useless facets, nodes on edges, windings. Each repair is counted in the table."""

import numpy as np
import pytest
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.meshes.own.repairs import Repairs
from bulkwear.meshes.own.solids import Solids
from bulkwear.meshes.own.weld import WELD_OF_SIZE, weld_tolerance, welded
from bulkwear.postproc.mesh import boundary_edges, nonmanifold_edges
from tests.support.own_solids import MM, box, write_ascii

SEED = 20220317
EXAMPLES = 20  # of a property: some tenths of a second
EXACT = 1e-12  # relative: sums of a few products
SIDE = 100.0  # mm, of the cube
VOLUME = (SIDE * MM) ** 3  # m3
TOLERANCE = WELD_OF_SIZE * np.sqrt(3.0) * SIDE  # mm, weld tolerance of the cube


def cube():
    """Points (8, 3) mm and triangles of a cube."""
    return box((SIDE, SIDE, SIDE))


def made(tmp_path, facets, **options):
    """The surface of facets (m, 3, 3) mm."""
    facets = np.asarray(facets)
    write_ascii(tmp_path / "a.stl", {"a": (facets.reshape(-1, 3), np.arange(3 * len(facets)).reshape(-1, 3))})
    return own_mesh(tmp_path / "a.stl", "mm", **options)


def counted(found):
    """How often each repair was done, by its words."""
    return {row.repair: row.count for row in found.repairs}


def test_a_sound_body_needs_nothing(tmp_path):
    """A cube of twelve facets: eight nodes, no row in the table."""
    points, triangles = cube()
    found = made(tmp_path, points[triangles])
    assert found.repairs == ()
    assert len(found.surface.points) == 8
    assert "nothing had to be repaired" in found.text()


@settings(max_examples=EXAMPLES, deadline=None)
@seed(SEED)
@given(flips=st.lists(st.booleans(), min_size=12, max_size=12), order=st.permutations(range(12)))
def test_windings_in_the_file_do_not_matter(tmp_path_factory, flips, order):
    """Facets turned and mixed at random: the same closed body, outward; the turned ones are counted."""
    points, triangles = cube()
    mixed = np.where(np.array(flips)[:, None], triangles[:, ::-1], triangles)[order]
    found = made(tmp_path_factory.mktemp("cube"), points[mixed])
    (part,) = found.parts
    assert part.closed
    assert part.volume_m3 == pytest.approx(VOLUME, rel=EXACT)
    assert len(nonmanifold_edges(found.surface.triangles)) == 0
    assert counted(found).get("facets turned round", 0) == sum(flips)


@pytest.mark.parametrize(("share", "sound"), [(0.4, True), (5e4, False)])
def test_points_closer_than_the_tolerance_are_one(tmp_path, share, sound):
    """Corners of facets off by less than the weld tolerance are welded and counted; off by more they stay apart."""
    points, triangles = cube()
    facets = points[triangles]
    facets[0, 0] += (0.0, share * TOLERANCE, 0.0)
    found = made(tmp_path, facets)
    assert found.parts[0].closed == sound
    assert found.weld_m == pytest.approx(TOLERANCE * MM, rel=1e-3)  # the file is off by a little more than the cube
    if sound:
        (row,) = found.repairs
        assert (row.repair, row.count, row.part) == ("points welded", 1, "a")
        assert row.largest_mm == pytest.approx(share * TOLERANCE, rel=1e-6)  # differences of coordinates of 1e5 times


def test_tolerance_grows_with_the_distance_from_the_origin():
    """Coordinates have digits: what is far away is less certain."""
    points, _ = cube()
    assert weld_tolerance(points + 1e4) == pytest.approx(WELD_OF_SIZE * (1e4 + SIDE), rel=EXACT)


def test_useless_facets_are_dropped(tmp_path):
    """A facet without area, one that collapses to an edge, one that is there twice: dropped, counted, placed."""
    points, triangles = cube()
    facets = points[triangles]
    middle = 0.5 * (points[0] + points[1])
    extra = [[points[0], points[1], middle], [points[0], points[0], points[1]], facets[3][[1, 2, 0]]]
    found = made(tmp_path, np.concatenate([facets, extra]))
    assert found.parts[0].closed
    assert len(found.surface.triangles) == 12
    rows = counted(found)
    assert rows["collapsed facets dropped"] == rows["facets without width dropped"] == 1
    assert rows["duplicate facets dropped"] == 1
    place = next(row.place_m for row in found.repairs if "width" in row.repair)
    assert place == pytest.approx(MM * middle, abs=EXACT)


def test_a_node_on_an_edge_splits_the_facet_across(tmp_path):
    """One side of an edge has two nodes on it, the other none: cut there, closed, and the volume stays."""
    points, triangles = cube()
    facets = points[triangles]
    edge = facets[0][:2]
    third = [edge[0] + share * (edge[1] - edge[0]) for share in (0.3, 0.8)]
    pieces = [[edge[0], third[0], facets[0][2]], [third[0], third[1], facets[0][2]], [third[1], edge[1], facets[0][2]]]
    found = made(tmp_path, np.concatenate([pieces, facets[1:]]))
    assert found.parts[0].closed
    assert found.parts[0].volume_m3 == pytest.approx(VOLUME, rel=EXACT)
    assert counted(found) == {"edges split at nodes on them": 2}
    assert len(found.surface.triangles) == 11 + 3 + 2


def test_facets_without_width_close_what_they_closed(tmp_path):
    """CAD programs put a facet of no width between an edge and a node on it: dropped, the edge is split instead."""
    points, triangles = cube()
    facets = points[triangles]
    edge = facets[0][:2]
    middle = edge.mean(axis=0)
    pieces = [[edge[0], middle, facets[0][2]], [middle, edge[1], facets[0][2]], [edge[0], edge[1], middle]]
    found = made(tmp_path, np.concatenate([pieces, facets[1:]]))
    assert found.parts[0].closed
    assert len(boundary_edges(found.surface.triangles)) == 0


def test_unused_nodes_are_left_out():
    """Nodes of no triangle are not in the mesh."""
    points, triangles = cube()
    solids = Solids(np.concatenate([points + 1.0, [[9e3, 0, 0]]]), triangles, np.zeros(12, dtype=np.int64), ("a",))
    assert len(welded(solids, TOLERANCE, Repairs(("a",))).points) == 8


def test_a_cavity_looks_inward(tmp_path):
    """A closed piece within another one of its part is a hole in it: its volume counts against it."""
    points, triangles = cube()
    hole = points * 0.5 + 0.25 * SIDE
    grain = points * 0.1 + 0.45 * SIDE
    found = made(tmp_path, np.concatenate([points[triangles], hole[triangles], grain[triangles][:, ::-1]]))
    assert found.parts[0].volume_m3 == pytest.approx(VOLUME * (1.0 - 0.5**3 + 0.1**3), rel=EXACT)
    assert counted(found) == {"facets turned round": 24, "cavities found, turned inward": 1}


def test_the_side_of_an_open_plate_is_unknown(tmp_path):
    """Without its lid a box is a sheet: one winding, that of most of its area; the touched side is unknown."""
    points, triangles = cube()
    open_box = points[triangles[(points[triangles][:, :, 2] < SIDE).any(axis=1)]]
    open_box[2] = open_box[2][::-1]
    found = made(tmp_path, open_box)
    assert not found.parts[0].closed
    assert len(nonmanifold_edges(found.surface.triangles)) == 0
    assert counted(found) == {"facets turned round": 1, "open pieces, touched side unknown": 1}


def test_solids_that_are_faces_of_one_body_share_its_edges(tmp_path):
    """A body whose six faces are a solid each is closed: no crack can open between the parts."""
    points, triangles = cube()
    sides = {f"side_{k}": (points, triangles[[k, k + 6]]) for k in range(6)}
    sides["side_3"] = (points, triangles[[3, 9]][:, ::-1])
    write_ascii(tmp_path / "a.stl", sides)
    found = own_mesh(tmp_path / "a.stl", "mm")
    assert len(found.surface.points) == 8
    assert len(boundary_edges(found.surface.triangles)) == 0
    assert sum(row.count for row in found.repairs if "joined" in row.repair) == 12


@pytest.mark.parametrize(("shift", "words"), [((SIDE, 30.0, 20.0), "touches"), ((0.5 * SIDE, 30.0, 20.0), "cuts")])
def test_parts_that_touch_or_cut_are_told(tmp_path, shift, words):
    """Assemblies have both: a row in the table, no refusal; the parts keep their volumes."""
    points, triangles = cube()
    write_ascii(tmp_path / "a.stl", {"a": (points, triangles), "b": (points + shift, triangles)})
    found = own_mesh(tmp_path / "a.stl", "mm")
    assert [part.volume_m3 for part in found.parts] == pytest.approx([VOLUME, VOLUME], rel=EXACT)
    (row,) = found.repairs
    assert row.repair.startswith(f"warning: {words}")
    assert "part 'b'" in row.repair
    assert row.count > 0


def test_parts_beside_one_another_are_not_told(tmp_path):
    """A gap of a tenth of a millimetre is a gap."""
    points, triangles = cube()
    write_ascii(tmp_path / "a.stl", {"a": (points, triangles), "b": (points + np.array([SIDE + 0.1, 0, 0]), triangles)})
    assert own_mesh(tmp_path / "a.stl", "mm").repairs == ()


def test_obtuse_corners_come_last(tmp_path):
    """As the solver needs them (`postproc.mesh.obtuse_last`)."""
    flat = np.array([[[0, 0, 0], [100, 0, 0], [-50, 40, 0]]], dtype=float)
    found = made(tmp_path, flat)
    corner = found.surface.points[found.surface.triangles[0, 2]]
    assert corner == pytest.approx([0.0, 0.0, 0.0], abs=EXACT)
