"""The drawings of studies: what their scripts say is in the files, as volumes in closed form, boxes and names."""

import functools
import math
import time

import numpy as np
import pytest

from bulkwear.meshes.chute import draw as chute
from bulkwear.meshes.drawing import prism, write_step
from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.mill import draw as mill
from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.meshes.screw import draw as screw
from bulkwear.meshes.which_law import draw as which_law
from bulkwear.postproc.mesh import area_vectors

SCRIPTS = {"chute": chute, "mill": mill, "screw": screw, "which_law": which_law}
BODIES = ("chute/walls", "screw/screw")
MORE_BODIES = ("chute/impact_plate", "chute/liner_plain", "screw/trough", "which_law/plate_15", "which_law/slide")
LONGEST_S = 10.0  # s of the processor, of a script: each takes about one
LARGEST_BYTES = 1_000_000  # of a drawing
OF_CURVED = 1e-3  # -, of a volume with curved faces: OpenCASCADE's quadrature, and a loft in place of a helix
OF_BUMPS = 5e-3  # -, of the volume of bumps, a twentieth of what that quadrature is over
OF_PLANE = 1e-9  # -, with plane faces
COARSE_M = 0.06  # m, target edge for names, boxes and what touches
PLANNED_M = {"trough": 0.02, "bumps": 0.03}  # m, target edges of the studies at quick fidelity


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Folder with the drawings of all scripts, each in its own, and the time of the processor that each took (s)."""
    folder, took = tmp_path_factory.mktemp("drawn"), {}
    for name, script in SCRIPTS.items():
        begun = time.process_time()
        script.main(folder / name)
        took[name] = time.process_time() - begun
    return folder, took


def volume_m3(path):
    """Volume of the only body of a drawing by OpenCASCADE."""
    with gmsh_model() as gmsh:
        (body,) = (each for each in gmsh.model.occ.importShapes(str(path)) if each[0] == 3)
        return 1e-9 * gmsh.model.occ.getMass(*body)


def found(drawn, name, edge_m=COARSE_M):
    """The surface of a drawing, `chute/walls` for one; meshed once."""
    return mesh_of(drawn[0] / f"{name}.step", edge_m)


@functools.cache
def mesh_of(path, edge_m):
    return own_mesh(path, "mm", edge_m)


def warnings_of(mesh):
    """What was told of parts that cut or touch others."""
    return [each.repair for each in mesh.repairs if "warning" in each.repair]


@pytest.mark.parametrize("name", SCRIPTS)
def test_scripts_are_quick_and_files_small(drawn, name):
    """A script makes its drawings while one waits, and leaves nothing else beside them."""
    folder, took = drawn
    files = sorted((folder / name).iterdir())
    assert took[name] < LONGEST_S
    assert {path.suffix for path in files} == {".step"}
    assert max(path.stat().st_size for path in files) < LARGEST_BYTES


def test_equal_drawings_are_equal_files(drawn, tmp_path):
    """The script again, in the same process: no date, no counter is in the files."""
    screw.main(tmp_path)
    for path in tmp_path.iterdir():
        assert path.read_bytes() == (drawn[0] / "screw" / path.name).read_bytes()


@pytest.mark.parametrize("name", [*BODIES, *(pytest.param(each, marks=pytest.mark.verify) for each in MORE_BODIES)])
def test_bodies_are_closed_and_have_the_names_of_their_files(drawn, name):
    (part,) = found(drawn, name).parts
    assert part.name == name.rpartition("/")[2]
    assert part.closed and part.volume_m3 > 0.0


# ---------------------------------------------------------------- chute


def test_chute_has_the_volumes_of_its_dimensions(drawn):
    """Box less room; a plate; a prism with one upright end."""
    behind = chute.PLATE_FACE + chute.PLATE_THICKNESS + chute.GAP
    depth = behind - chute.BACK + 2.0 * chute.WALL
    height = chute.TOP + chute.WALL - chute.BOTTOM
    full = depth * height * (chute.WIDTH + 2.0 * chute.WALL)
    above = (chute.PLATE_FACE + chute.GAP - chute.BACK) * (chute.TOP - chute.PLATE_TOP - chute.GAP)
    below = (behind - chute.BACK) * (chute.PLATE_TOP + chute.GAP - chute.BOTTOM)
    width = chute.WIDTH - 2.0 * chute.GAP
    plate = width * chute.PLATE_THICKNESS * (chute.PLATE_TOP - chute.PLATE_BOTTOM)
    expected = {"walls": full - chute.WIDTH * (above + below), "impact_plate": plate, "liner_plain": plain_liner_mm3()}
    for name, volume in expected.items():
        assert volume_m3(drawn[0] / "chute" / f"{name}.step") == pytest.approx(1e-9 * volume, rel=OF_PLANE), name


def plain_liner_mm3():
    """Volume of a plate with an upright upper end."""
    thickness, upright = chute.LINER_THICKNESS, math.tan(chute.LINER_ANGLE)
    section = thickness * chute.LINER_LENGTH - 0.5 * thickness**2 * upright
    return (chute.WIDTH - 2.0 * chute.GAP) * section


@pytest.mark.verify
@pytest.mark.parametrize(("pattern", "rows", "bumps"), [("r5", 13, 26), ("r9", 13, 78)])
def test_patterns_add_half_ellipsoids(drawn, pattern, rows, bumps):
    """As many as there are places, each 2/3 pi a b h above the plate; meshed coarsely they keep most of that."""
    places = np.array(chute.bump_places(pattern))
    radii = np.array(chute.bump_radii(pattern))
    assert len(places) == bumps and len(np.unique(places[:, 0])) == rows
    added = bumps * 2.0 / 3.0 * math.pi * radii.prod()
    path = drawn[0] / "chute" / f"liner_{pattern}.step"
    assert 1e9 * volume_m3(path) - plain_liner_mm3() == pytest.approx(added, rel=OF_BUMPS)
    meshed = found(drawn, f"chute/liner_{pattern}", PLANNED_M["bumps"]).parts[0]
    assert meshed.closed and meshed.name == f"liner_{pattern}"
    assert 0.9 < (1e9 * meshed.volume_m3 - plain_liner_mm3()) / added < 1.0


@pytest.mark.parametrize("pattern", chute.PATTERNS)
def test_bumps_are_those_of_the_source_enlarged(pattern):
    """Particle over bump is that of the source: 10 mm over the bumps here, 2.65 mm over its own."""
    a, b, h, column = chute.PATTERNS[pattern]
    here, there = 10.0 / np.cbrt(np.prod(chute.bump_radii(pattern))), 2.65 / np.cbrt(a * b * h)
    assert here == pytest.approx(there, rel=1e-12)
    places = np.array(chute.bump_places(pattern))
    first, second = (places[places[:, 0] == down, 1] for down in np.unique(places[:, 0])[:2])
    assert np.diff(first) == pytest.approx(column * 10.0 / 2.65)
    assert np.sort(-second) == pytest.approx(np.sort(first))  # the shifted row: the other way round
    clear = chute.WIDTH / 2.0 - chute.GAP - np.abs(places[:, 1]).max() - chute.bump_radii(pattern)[1]
    assert clear >= chute.RIM


@pytest.mark.verify
def test_chute_is_assembled_without_touching(drawn):
    """Liner, plate and walls share no place, and the plate stands a gap proud of the wall above it."""
    files = [drawn[0] / "chute" / f"{name}.step" for name in ("walls", "impact_plate", "liner_r5")]
    together = own_mesh(files, "mm", COARSE_M)
    assert together.one_mesh and warnings_of(together) == []
    walls, plate, liner = together.parts
    assert plate.low_m[0] == pytest.approx(1e-3 * chute.PLATE_FACE)
    assert liner.high_m == pytest.approx((0.63, 0.2497, -1.0), abs=1e-6)
    assert all(walls.low_m[k] < min(plate.low_m[k], liner.low_m[k]) for k in range(3))


# ---------------------------------------------------------------- mill


def test_mill_is_an_open_shell_of_the_slice(drawn):
    """Area of plates and lifters by their lengths in the section; it ends in both faces of the slice."""
    mesh = found(drawn, "mill/liner", 0.03)
    (part,) = mesh.parts
    foot = mill.CREST / 2.0 + mill.HEIGHT * math.tan(mill.FACE_ANGLE)
    face = math.dist(*mill.lifter_corners(0)[:2])
    plates = 2.0 * math.pi * mill.RADIUS - mill.LIFTERS * 2.0 * mill.RADIUS * math.asin(foot / mill.RADIUS)
    section = plates + mill.LIFTERS * (2.0 * face + mill.CREST)
    assert not part.closed
    assert part.area_m2 == pytest.approx(1e-6 * mill.SLICE * section, rel=1e-4)  # chords of 30 mm in place of arcs
    y = mesh.surface.points[:, 1]
    assert (y.min(), y.max()) == pytest.approx((-0.5e-3 * mill.SLICE, 0.5e-3 * mill.SLICE), abs=1e-9)


def test_mill_has_lifters_all_round(drawn):
    """Radii are those of plates and crests; crests are at angles of equal distance."""
    points = found(drawn, "mill/liner", 0.03).surface.points
    radius, angle = np.hypot(points[:, 0], points[:, 2]), np.arctan2(points[:, 0], points[:, 2])
    assert radius.max() == pytest.approx(1e-3 * mill.RADIUS, rel=1e-9)
    assert radius.min() == pytest.approx(1e-3 * (mill.RADIUS - mill.HEIGHT), rel=1e-9)
    crests = angle[radius < 1e-3 * (mill.RADIUS - 0.9 * mill.HEIGHT)] * mill.LIFTERS / (2.0 * math.pi)
    assert np.abs(crests - np.round(crests)).max() < 0.1  # a crest is 80 of 479 mm wide
    assert len(np.unique(np.round(crests) % mill.LIFTERS)) == mill.LIFTERS


# ---------------------------------------------------------------- screw


def test_screw_has_the_volume_of_shaft_and_flight(drawn):
    """Every line along the axis through the flight is as long in it as it is thick."""
    shaft = math.pi * screw.SHAFT_RADIUS**2 * (screw.LENGTH - 2.0 * screw.CLEARANCE)
    ring = math.pi * (screw.RADIUS**2 - screw.SHAFT_RADIUS**2)
    volume = shaft + screw.TURNS * ring * screw.FLIGHT_THICKNESS
    assert volume_m3(drawn[0] / "screw" / "screw.step") == pytest.approx(1e-9 * volume, rel=OF_CURVED)


def test_trough_has_the_volume_of_its_walls(drawn):
    """Block, hopper and spout less a U, what is in the hopper above it, and what is in the spout below it."""
    inside = screw.RADIUS + screw.CLEARANCE
    outside = inside + screw.WALL
    (hopper_from, hopper_to, top), (spout_from, spout_to, bottom) = screw.HOPPER, screw.SPOUT
    hopper, spout, walls = hopper_to - hopper_from, spout_to - spout_from, 2.0 * screw.WALL
    full = (screw.LENGTH + walls) * (screw.LID + screw.WALL + outside)
    full += (hopper + walls) * (top - screw.LID - screw.WALL) + (spout + walls) * (-outside - bottom)
    half_round = 0.5 * math.pi * inside**2
    room = screw.LENGTH * (half_round + 2.0 * inside * screw.LID) + hopper * 2.0 * inside * (top - screw.LID)
    room += spout * (2.0 * inside * -bottom - half_round)
    expected = 2.0 * outside * full - room
    assert volume_m3(drawn[0] / "screw" / "trough.step") == pytest.approx(1e-9 * expected, rel=OF_CURVED)


@pytest.mark.verify
def test_flight_and_trough_stay_apart_as_meshed(drawn):
    """The trough's facets are chords of its circle: at the edge of the study they leave the flight free."""
    surface = found(drawn, "screw/trough", PLANNED_M["trough"]).surface
    corners = surface.points[surface.triangles]
    x, y, z = (
        1e3 * 0.5 * (corners + np.roll(corners, 1, axis=1)).reshape(-1, 3).T
    )  # middles of edges: nearest on chords
    between_ends = (x > screw.CLEARANCE) & (x < screw.LENGTH - screw.CLEARANCE)
    assert np.hypot(y, z)[between_ends].min() > screw.RADIUS + 0.5 * screw.CLEARANCE
    files = [drawn[0] / "screw" / f"{name}.step" for name in ("screw", "trough")]
    together = own_mesh(files, "mm", PLANNED_M["trough"])
    assert together.one_mesh and warnings_of(together) == []


# ---------------------------------------------------------------- what the scripts share


def test_a_body_without_a_name_is_refused(tmp_path):
    with gmsh_model() as gmsh:
        body = prism(gmsh, [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)], -1.0, 1.0)
        with pytest.raises(ValueError, match="names are given for"):
            write_step(gmsh, tmp_path / "a.step", {body + 1: "wedge"})


def test_bodies_of_one_file_keep_their_names(tmp_path):
    """Two bodies, the later one named first: each name stands at its own volume."""
    with gmsh_model() as gmsh:
        small = prism(gmsh, [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)], -1.0, 1.0)
        large = prism(gmsh, [(50.0, 0.0), (90.0, 0.0), (50.0, 40.0)], -1.0, 1.0)
        write_step(gmsh, tmp_path / "two.step", {large: "large", small: "small"})
    parts = own_mesh(tmp_path / "two.step", "mm", 0.01).parts
    assert {part.name: part.volume_m3 for part in parts} == pytest.approx({"small": 100e-9, "large": 1600e-9}, rel=1e-9)


@pytest.mark.verify
@pytest.mark.parametrize("angle", which_law.ANGLES)
def test_plates_of_which_law_stand_at_their_angles_to_the_stream(drawn, angle):
    """The face that a stream along x hits is at that angle to it, upright, and as large as the plate."""
    surface = found(drawn, f"which_law/plate_{angle}").surface
    vectors = area_vectors(surface.points, surface.triangles)
    areas = np.linalg.norm(vectors, axis=1)
    expected = np.array([-math.sin(math.radians(angle)), math.cos(math.radians(angle)), 0.0])
    front = (vectors @ expected) > (1.0 - OF_PLANE) * areas
    assert areas[front].sum() == pytest.approx(1e-6 * which_law.PLATE_LENGTH * which_law.PLATE_HEIGHT, rel=OF_PLANE)
