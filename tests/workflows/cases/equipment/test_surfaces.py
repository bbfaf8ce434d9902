"""The surface of a machine: labels of parts, bodies of a file by name, the room that motion needs, rectangles."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.postproc.mesh import (
    SurfaceMesh,
    areas,
    boundary_edges,
    enclosed_volume,
    nonmanifold_edges,
    unit_normals,
)
from bulkwear.postproc.wear.bodies import body, together
from bulkwear.postproc.wear.built_shape import PANEL, PRISTINE_RISE
from bulkwear.postproc.wear.mesh_faults import with_target_edges
from bulkwear.postproc.wear.side import with_sides
from bulkwear.postproc.wear.update import wear_update
from bulkwear.workflows.cases.equipment import surfaces
from bulkwear.workflows.cases.equipment.surfaces import (
    faces_of,
    feed_face,
    label_of,
    machine_surface,
    on_ends,
    open_ends,
    part_surface,
    rectangle,
    room_needed,
)
from bulkwear.workflows.config.layers import ConfigError
from tests.support.own_machine_project import (
    CORNERS,
    SETTINGS,
    SIZES,
    SLOPE_DEG,
    TINY,
    Machine,
    drawings,
    machine_study,
)
from tests.support.own_solids import SIZES as SOLID_SIZES
from tests.support.own_solids import bodies, box, write_ascii, write_binary, write_bodies

VOLUME = 1e-6  # relative; binary numbers of a text file
ROUND_OFF = 1e-12
OFF_M, EVEN = 2e-4, 1e-9  # m, that a flat top loses; relative, of the flat and even loss in closed form
TURN_MISSED = 2e-3  # relative; corners of a turning box between two of 64 looks at a turn: 1 - cos(pi / 64)


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """Parameters of the tiny machine, and its surface."""
    with machine_study(tmp_path_factory.mktemp("surfaces")) as study:
        run = study.runs[0].parameters
        yield SimpleNamespace(run=run, parts=run["parts"], surface=machine_surface(run["parts"]))


def test_edges_and_hollows_as_built_are_no_pits(tmp_path):
    """The inside of a trough that loses the same everywhere on its floor loses that at the corner to its walls too, and
    the top of the liner at its edges.
    """
    with machine_study(tmp_path) as study:
        surface = study.case.surface_mesh(study.case.surface_sections(study.runs[0].parameters))
    assert {PANEL, "part"} <= set(surface.cell_data) and PRISTINE_RISE in surface.point_data
    built = with_target_edges(with_sides(surface))
    slope = np.radians(SLOPE_DEG)
    top = (built.cell_data["part"] == 0) & (
        unit_normals(built.points, built.triangles) @ (np.sin(slope), 0.0, np.cos(slope)) > 1.0 - ROUND_OFF
    )
    worn, _ = wear_update(built, np.where(top, OFF_M * areas(built.points, built.triangles), 0.0))
    nodes = np.unique(built.triangles[top])
    lost = (built.points - worn.points)[nodes] @ (np.sin(slope), 0.0, np.cos(slope))
    np.testing.assert_allclose(lost, OFF_M, rtol=EVEN)


def test_labels_say_which_part_and_whether_it_wears(machine):
    """Part k is k where it wears, -1 - k where it keeps its shape, in the order of the study."""
    labels = machine.surface.cell_data["part"]
    assert list(dict.fromkeys(labels.tolist())) == [0, 1, 2, -4]
    assert [label_of(k, part) for k, part in enumerate(machine.parts)] == [0, 1, 2, -4]
    assert sum(faces_of(machine.surface, k, part).sum() for k, part in enumerate(machine.parts)) == len(labels)


@pytest.mark.parametrize("number", range(4))
def test_parts_are_bodies_of_their_own_as_drawn(machine, number):
    """Closed, outside out, as large as drawn, and where they were drawn; none shares a node with another."""
    part = machine.parts[number]
    one = body(machine.surface, faces_of(machine.surface, number, part))
    size = np.array(SIZES[part["name"]]) / 1e3
    assert enclosed_volume(one.points, one.triangles) == pytest.approx(size.prod(), rel=VOLUME)
    if part["name"] in ("plate", "hood"):
        low = np.array(CORNERS[part["name"]]) / 1e3
        np.testing.assert_allclose([one.points.min(0), one.points.max(0)], [low, low + size], atol=1e-9)
    assert len(one.points) == len(np.unique(machine.surface.triangles[faces_of(machine.surface, number, part)]))


def test_edges_are_about_as_long_as_asked(machine):
    """No triangle has several times the area of one with its part's edge."""
    for number, part in enumerate(machine.parts):
        found = areas(machine.surface.points, machine.surface.triangles)[faces_of(machine.surface, number, part)]
        assert found.max() < 2.0 * part["edge_m"] ** 2
        assert found.mean() > 0.1 * part["edge_m"] ** 2


def part_of(file, **changes):
    return {"name": "lining", "file": str(file), "unit": "mm", "edge_m": 0.05, "wears": True, **changes}


@pytest.fixture
def two_bodies(tmp_path, monkeypatch):
    """A file with two bodies, trough and lip."""
    write_ascii(tmp_path / "both.stl", bodies())
    monkeypatch.setattr(surfaces, "drawing", lambda file, folder: tmp_path / file)
    return tmp_path


@pytest.mark.parametrize("solid", ["trough", "lip"])
def test_solid_is_the_body_of_that_name(two_bodies, solid):
    """One body of the file, labelled as the part that it is; without a name all of them are one part."""
    one = part_surface(3, part_of("both.stl", solid=solid), two_bodies, own_mesh)
    assert enclosed_volume(one.points, one.triangles) == pytest.approx(math.prod(SOLID_SIZES[solid]) / 1e9, rel=VOLUME)
    assert set(one.cell_data["part"].tolist()) == {3}
    both = part_surface(3, part_of("both.stl", wears=False), two_bodies, own_mesh)
    assert set(both.cell_data["part"].tolist()) == {-4}
    whole = sum(math.prod(size) for size in SOLID_SIZES.values()) / 1e9
    assert enclosed_volume(both.points, both.triangles) == pytest.approx(whole, rel=VOLUME)


def test_a_file_of_several_parts_is_meshed_once(two_bodies, monkeypatch):
    """Once for every body, unit and edge that its parts have; each part is what it is alone, to the last bit."""
    parts = [
        part_of("both.stl", name="a", solid="trough"),
        part_of("both.stl", name="b", solid="lip", wears=False),
        part_of("both.stl", name="c", solid="lip", edge_m=0.04),
        part_of("both.stl", name="d", solid="lip", unit="cm", edge_m=0.5),
        part_of("both.stl", name="e", solid="trough"),
    ]
    alone = [part_surface(number, part, two_bodies, own_mesh) for number, part in enumerate(parts)]
    asked = []

    def asked_for(*given, **named):
        asked.append((*given, *named.values()))
        return own_mesh(*given, **named)

    monkeypatch.setattr("bulkwear.meshes.own.mesh.own_mesh", asked_for)
    whole = machine_surface(parts)
    path = two_bodies / "both.stl"
    assert asked == [
        (path, "mm", 0.05, "trough"),
        (path, "mm", 0.05, "lip"),
        (path, "mm", 0.04, "lip"),
        (path, "cm", 0.5, "lip"),
    ]
    for number, (part, mesh) in enumerate(zip(parts, alone, strict=True)):
        one = body(whole, faces_of(whole, number, part))
        assert np.array_equal(one.points[one.triangles], mesh.points[mesh.triangles])


@pytest.mark.parametrize("name", ["both.stl", "both.step"])
def test_unknown_solid_is_one_sentence(two_bodies, name):
    """It names part and bodies."""
    if name == "both.step":
        write_bodies(two_bodies / name)
    with pytest.raises(ConfigError, match=r"^parts\.lining\.solid is 'spout', allowed is one of trough, lip\.$"):
        part_surface(0, part_of(name, solid="spout"), two_bodies, own_mesh)


def test_a_fault_of_another_body_is_none_of_a_solids(two_bodies):
    """Neither one that cuts itself and has a corner that is no number, nor one that is far too large."""
    cut = [box((50.0, 50.0, 50.0), corner) for corner in ((500.0, 500.0, 500.0), (520.0, 510.0, 505.0))]
    faulty = np.concatenate([cut[0][0], cut[1][0], [[np.nan, 0, 0]]]), np.concatenate([cut[0][1], cut[1][1] + 8])
    faulty[1][-1, 0] = 16
    huge = box((1e7, 1e7, 1e7))
    write_ascii(two_bodies / "both.stl", {"bolts": faulty, **bodies(), "room": huge})
    one = part_surface(0, part_of("both.stl", solid="trough", edge_m=0.01), two_bodies, own_mesh)
    assert enclosed_volume(one.points, one.triangles) == pytest.approx(math.prod(SOLID_SIZES["trough"]) / 1e9)
    for solid in ("bolts", "room"):
        with pytest.raises(ConfigError, match=rf"^parts\.lining: .*'{solid}'"):
            part_surface(0, part_of("both.stl", solid=solid, edge_m=0.01), two_bodies, own_mesh)


def test_only_the_solid_of_a_cad_file_is_meshed(two_bodies):
    """Another body may have as many elements at that edge as no surface may have, and faces in common with it."""
    with gmsh_model() as gmsh:
        low, room = gmsh.model.occ.addBox(0, 0, 0, 100, 50, 10), gmsh.model.occ.addBox(0, 0, 10, 1e5, 1e5, 1e5)
        gmsh.model.occ.fragment([(3, low)], [(3, room)])
        gmsh.model.occ.synchronize()
        gmsh.write(str(two_bodies / "rooms.brep"))
    one = part_surface(0, part_of("rooms.brep", solid="rooms_body_1", edge_m=0.01), two_bodies, own_mesh)
    assert enclosed_volume(one.points, one.triangles) == pytest.approx(0.1 * 0.05 * 0.01, rel=VOLUME)
    with pytest.raises(ConfigError, match=r"the target edges give about .* part 'rooms_body_2' with 0\.01 m"):
        part_surface(0, part_of("rooms.brep", edge_m=0.01), two_bodies, own_mesh)


def test_file_that_is_no_mesh_is_one_sentence(two_bodies):
    """It names the part."""
    (two_bodies / "words.stl").write_text("a chute\n")
    with pytest.raises(ConfigError, match=r"^parts\.lining: .*words\.stl"):
        part_surface(0, part_of("words.stl"), two_bodies, own_mesh)


# ---------------------------------------------------------------- slices


def slice_of(**periodic):
    """What is asked of a run's parameters: two parts that wear, and a slice along y."""
    parts = [{"wears": True}, {"wears": True}]
    return {"parts": parts, "periodic": {"axis": "y", "low_m": -0.05, "high_m": 0.05, **periodic} if periodic else None}


def two_parts(second_length=0.1):
    """A box from end to end of the slice, and one from its upper end as long as told, as one surface."""
    boxes = [
        box((0.2, 0.1, 0.03), (0.0, -0.05, 0.0)),
        box((0.2, second_length, 0.03), (0.5, 0.05 - second_length, 0.0)),
    ]
    return together([SurfaceMesh(*each, {"part": np.full(12, number)}) for number, each in enumerate(boxes)])


def test_parts_that_go_through_a_slice_are_open_there():
    """They have lost the two faces at either end, and nothing else."""
    whole = two_parts()
    found = open_ends(whole, slice_of(axis="y"))
    assert len(found.triangles) == 24 - 8 and found.cell_data["part"].tolist() == [0] * 8 + [1] * 8
    assert np.abs(unit_normals(found.points, found.triangles)[:, 1]).max() < ROUND_OFF
    assert areas(found.points, found.triangles).sum() == pytest.approx(2 * 2 * (0.2 * 0.1 + 0.1 * 0.03), rel=ROUND_OFF)


@pytest.mark.parametrize("half", [50.0, 1500.1, 1501.14])
def test_a_slice_of_single_precision(tmp_path, half):
    """Binary STL rounds 1501.14 mm to 1501.140015: its nodes are put on the ends, where its faces are left out."""
    bodies = {name: (points * [1.0, half / 50.0, 1.0], triangles) for name, (points, triangles) in drawings().items()}
    ends = {"periodic": {"axis": "y", "low_mm": -half, "high_mm": half}, "parts": {"paddle": {"motion": None}}}
    with machine_study(tmp_path, machine=Machine(SETTINGS, bodies, TINY.materials), **ends) as study:
        for name, each in bodies.items():
            write_binary(tmp_path / f"meshes/{name}.stl", *each)
        run = study.case.surface_sections(study.runs[0].parameters)
        surface = study.case.surface_mesh(run)
    along = surface.points[:, 1]
    assert [along.min(), along.max()] == [run["periodic"]["low_m"], run["periodic"]["high_m"]]
    assert np.abs(unit_normals(surface.points, surface.triangles)[:, 1]).max() < ROUND_OFF
    assert len(boundary_edges(surface.triangles))


def test_nodes_farther_from_an_end_stay():
    """Than the weld tolerance, 1e-6 of the part; so do all without a slice."""
    run, whole = slice_of(axis="y"), two_parts()
    for beyond, moved in ((1e-8, True), (-1e-7, True), (1e-6, False)):
        off = SurfaceMesh(whole.points + np.array([0.0, beyond, 0.0]), whole.triangles, whole.cell_data)
        found = on_ends(off, run).points
        np.testing.assert_array_equal(found, whole.points if moved else off.points)
        assert on_ends(off, slice_of()) is off


def test_part_that_ends_within_a_slice_stays_closed():
    """Its face at one end can be touched from the image of the slice; so does every part without a slice."""
    found = open_ends(two_parts(second_length=0.06), slice_of(axis="y"))
    assert found.cell_data["part"].tolist() == [0] * 8 + [1] * 12
    assert len(open_ends(two_parts(), slice_of()).triangles) == 24
    assert len(open_ends(two_parts(), slice_of(axis="x")).triangles) == 24


# ---------------------------------------------------------------- the room that a motion needs

ARM = np.array([[0.3, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.1, 0.0]])  # m, reaches 0.3 m from the axis
TURN_S = 0.5


def turning(**changes):
    """A part that turns about y once in half a second."""
    motion = {"kind": "rotation", "point_m": [0, 0, 0], "axis": [0, 1, 0], "speed_rad_per_s": 2.0 * math.pi / TURN_S}
    return {"motion": {**motion, **changes}}


@pytest.mark.parametrize("turns", [1.0, 7.3, 63.0, 126.0, 63.0 * 9])
def test_room_of_a_turning_part_is_its_circle(turns):
    """However many turns the run takes, whole numbers of them between two looks as well."""
    low, high = room_needed(ARM, turning(), turns * TURN_S)
    assert [low[0], low[2]] == pytest.approx([-0.3, -0.3], rel=TURN_MISSED)
    assert [high[0], high[2]] == pytest.approx([0.3, 0.3], rel=TURN_MISSED)
    assert [low[1], high[1]] == [0.0, 0.1]


def test_room_of_a_part_that_starts_late():
    """It turns after the start and its ramp only; a run that ends before needs no more than where it was drawn."""
    late = turning(start_s=2.0, ramp_s=1.0)
    assert room_needed(ARM, late, 1.9)[0] == pytest.approx([0.0, 0.0, 0.0], abs=ROUND_OFF)
    assert room_needed(ARM, late, 63.0 * TURN_S)[0][2] == pytest.approx(-0.3, rel=TURN_MISSED)


def test_room_of_other_motions():
    """A swing to both sides by its amplitude, a way as far as the run goes, none of a belt, none at rest."""
    swing = {"motion": {"kind": "oscillation", "amplitude_m": [0.0, 0.0, 0.05], "period_s": 0.01}}
    low, high = room_needed(ARM, swing, 10.0)
    assert [low[2], high[2]] == pytest.approx([-0.05, 0.05], rel=TURN_MISSED)
    way = {"motion": {"kind": "translation", "velocity_m_per_s": [0.0, 0.2, 0.0]}}
    assert room_needed(ARM, way, 3.0)[1][1] == pytest.approx(0.1 + 0.6, rel=ROUND_OFF)
    for still in ({"motion": None}, {"motion": {"kind": "belt", "velocity_m_per_s": [1.0, 0.0, 0.0]}}):
        low, high = room_needed(ARM, still, 10.0)
        assert low.tolist() == ARM.min(0).tolist() and high.tolist() == ARM.max(0).tolist()


# ---------------------------------------------------------------- inlets and outlets

NORMALS = [[0, 0, -1], [0, 0, 1], [1, 0, 0], [0, -3, 0], [1, 2, -2], [0.3, -0.4, 0.1]]


@pytest.mark.parametrize("normal", NORMALS, ids=str)
def test_rectangle_looks_whither_the_material_goes(normal):
    """Both triangles; the sides are as long as asked, the first one horizontal, the middle is the centre."""
    mesh = rectangle({"centre_m": [0.1, -0.2, 0.3], "normal": normal, "size_m": [0.4, 0.2]})
    unit = np.array(normal) / np.linalg.norm(normal)
    np.testing.assert_allclose(unit_normals(mesh.points, mesh.triangles), [unit, unit], atol=ROUND_OFF)
    first, second = mesh.points[1] - mesh.points[0], mesh.points[3] - mesh.points[0]
    assert [np.linalg.norm(first), np.linalg.norm(second)] == pytest.approx([0.4, 0.2], rel=ROUND_OFF)
    assert abs(first[2]) < ROUND_OFF and abs(first @ second) < ROUND_OFF
    np.testing.assert_allclose(mesh.points.mean(axis=0), [0.1, -0.2, 0.3], atol=ROUND_OFF)
    assert areas(mesh.points, mesh.triangles).sum() == pytest.approx(0.08, rel=ROUND_OFF)


def test_sides_of_a_horizontal_rectangle_are_along_x_and_y():
    """The first one along x."""
    mesh = rectangle({"centre_m": [0, 0, 0], "normal": [0, 0, -2], "size_m": [0.4, 0.2]})
    assert np.ptp(mesh.points, axis=0).tolist() == [0.4, 0.2, 0.0]


def test_normal_without_length_is_refused():
    """It says no direction."""
    with pytest.raises(ValueError, match="normal"):
        rectangle({"centre_m": [0, 0, 0], "normal": [0, 0, 0], "size_m": [1, 1]})


@pytest.mark.parametrize("normal", NORMALS, ids=str)
def test_inlet_is_its_rectangle_in_small_triangles(normal):
    """Whatever their order is: the same outline, area and side, no gap and no overlap."""
    given = {"centre_m": [0.1, -0.2, 0.3], "normal": normal, "size_m": [0.4, 0.2]}
    whole, found = rectangle(given), feed_face(given, 7, 2)
    unit = np.array(normal) / np.linalg.norm(normal)
    np.testing.assert_allclose(unit_normals(found.points, found.triangles), np.tile(unit, (128, 1)), atol=1e-9)
    size = areas(found.points, found.triangles)
    assert size.sum() == pytest.approx(0.08, rel=ROUND_OFF) and np.ptp(size) < 1e-9 * size[0]
    np.testing.assert_allclose([found.points.min(0), found.points.max(0)], [whole.points.min(0), whole.points.max(0)])
    assert len(boundary_edges(found.triangles)) == 32 and len(nonmanifold_edges(found.triangles)) == 0


def test_every_block_and_packing_has_an_order_of_its_own():
    """The same one again for the same seed and cycle."""
    given = {"centre_m": [0, 0, 0], "normal": [0, 0, -1], "size_m": [0.4, 0.2]}
    found = {(seed, cycle): feed_face(given, seed, cycle) for seed in (20261123, 20262123) for cycle in range(5)}
    middles = {key: mesh.points[mesh.triangles].mean(axis=1).round(9) for key, mesh in found.items()}
    for key, here in middles.items():
        again = feed_face(given, *key)
        assert np.array_equal(again.triangles, found[key].triangles)
        for other, there in middles.items():
            assert other == key or (here == there).all(axis=1).sum() < 8  # one of 128 by chance
