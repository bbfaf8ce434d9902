"""Every format gives the same surface; units, names and parts are the file's; what cannot be read is one sentence."""

import re
import shlex
import subprocess
import sys

import meshio
import numpy as np
import pytest

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.own import cad
from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.meshes.own.read import part_sizes
from tests import REPOSITORY
from tests.support.own_solids import (
    AREA,
    BOX,
    MM,
    SIZES,
    VOLUMES,
    all_facets,
    bodies,
    write_ascii,
    write_binary,
    write_bodies,
)

EDGE = 0.02  # m
EXACT = 1e-12  # relative: formats with all digits
SINGLE = 1e-6  # relative: binary STL has 24 bits
RADIUS = 30.0  # mm, of a pipe
HOUR_S = 3600
CAD = 1e-9  # relative: OpenCASCADE's own precision on flat faces
FORMATS = {
    "ascii.stl": EXACT,
    "binary.stl": SINGLE,
    "bodies.obj": EXACT,
    "bodies.vtk": EXACT,
    "bodies.vtu": EXACT,
    "bodies.ply": EXACT,
    "text.ply": EXACT,
    "bodies.msh": EXACT,
    "bodies.step": CAD,
    "bodies.brep": CAD,
}
WITH_PARTS = [name for name in FORMATS if name != "binary.stl"]
WITH_NAMES = ["ascii.stl", "bodies.obj", "bodies.msh", "bodies.step"]


def but_for_later(names, later):
    """The names, one of them for the long tests: its reader is that of STEP."""
    return [pytest.param(name, marks=pytest.mark.verify) if name == later else name for name in names]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """All files."""
    made = tmp_path_factory.mktemp("files")
    for name in FORMATS:
        write_bodies(made / name)
    return made


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_gives_the_same_surface(folder, name):
    """Area, volume and bounding box are those of the bodies, refined or meshed; all faces look outward."""
    found = own_mesh(folder / name, "mm", EDGE)
    tolerance = FORMATS[name]
    assert sum(part.area_m2 for part in found.parts) == pytest.approx(AREA, rel=tolerance)
    assert sum(part.volume_m3 for part in found.parts) == pytest.approx(sum(VOLUMES), rel=tolerance)
    points = found.surface.points
    np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], BOX, atol=tolerance * np.ptp(BOX))


@pytest.mark.parametrize("name", but_for_later(FORMATS, "bodies.brep"))
def test_sizes_are_told_without_meshing(folder, name):
    """Part by part, under the names of the mesh, with the triangles that the file has."""
    told, meshed = part_sizes(folder / name, "mm"), own_mesh(folder / name, "mm", EDGE).parts
    assert list(told) == [part.name for part in meshed]
    area = sum(size.area_m2 for size in told.values())
    np.testing.assert_allclose(
        [size.area_m2 for size in told.values()], [part.area_m2 for part in meshed], rtol=FORMATS[name]
    )
    assert [size.triangles for size in told.values()] == (
        [0, 0] if FORMATS[name] == CAD else [24 // len(told)] * len(told)
    )
    if name == "ascii.stl":  # numbers without a unit of their own
        of_m = part_sizes(folder / name, "m").values()
        assert sum(size.area_m2 for size in of_m) == pytest.approx(1e6 * area)


@pytest.mark.parametrize("name", but_for_later(WITH_PARTS, "bodies.brep"))
def test_bodies_are_parts(folder, name):
    """Two bodies are two parts, in order, each with its own volume, and with its name where the format has names."""
    found = own_mesh(folder / name, "mm", EDGE)
    assert [part.volume_m3 for part in found.parts] == pytest.approx(VOLUMES, rel=CAD)
    assert np.array_equal(np.unique(found.surface.cell_data["part"]), [0, 1])
    assert (np.diff(found.surface.cell_data["part"]) >= 0).all()
    if name in WITH_NAMES:
        assert [part.name for part in found.parts] == list(SIZES)


def test_several_files_are_parts(folder, tmp_path):
    """A file each: a part each, in the order of the files; equal names are numbered."""
    for name, (points, triangles) in bodies().items():
        write_binary(tmp_path / f"{name}.stl", points, triangles)
    found = own_mesh([tmp_path / "lip.stl", tmp_path / "trough.stl"], "mm")
    assert [part.name for part in found.parts] == ["lip", "trough"]
    moved, triangles = bodies()["lip"]
    write_ascii(tmp_path / "other.stl", {"lip": (moved + 500.0, triangles)})
    found = own_mesh([tmp_path / "lip.stl", tmp_path / "other.stl"], "mm")
    assert [part.name for part in found.parts] == ["lip", "lip_2"]


@pytest.mark.parametrize(
    ("unit", "metres"), [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("in", 0.0254), ("ft", 0.3048)]
)
def test_the_unit_is_what_the_user_says(folder, unit, metres):
    """Lengths scale with the unit, volumes with its cube; nothing is guessed."""
    found = own_mesh(folder / "ascii.stl", unit)
    assert found.parts[0].volume_m3 == pytest.approx(VOLUMES[0] * (metres / MM) ** 3, rel=EXACT)


@pytest.mark.parametrize(
    ("unit", "scale", "said"), [("m", 1e4, "unit is m"), ("um", 1e-3, "unit is um"), ("yard", 1.0, "'yard'")]
)
def test_a_unit_that_makes_no_sense_is_refused(tmp_path, unit, scale, said):
    """Parts over a kilometre or under a micrometre: the sentence says so and names the units."""
    points, triangles = bodies()["trough"]
    write_ascii(tmp_path / "a.stl", {"trough": (points * scale, triangles)})
    with pytest.raises(ValueError, match=f"{said}.*mm"):
        own_mesh(tmp_path / "a.stl", unit)


def test_a_unit_other_than_the_files_own_is_refused(folder):
    """STEP says its unit; another one is a mistake of somebody."""
    with pytest.raises(ValueError, match=r"bodies\.step: the file says that its lengths are in mm, found unit in"):
        own_mesh(folder / "bodies.step", "in", EDGE)


def test_metres_of_a_step_file_are_metres(folder, tmp_path):
    """A file whose unit is the metre is a thousand times larger."""
    text = (folder / "bodies.step").read_text().replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)")
    (tmp_path / "m.step").write_text(text)
    found = own_mesh(tmp_path / "m.step", "m", EDGE / MM)
    assert found.parts[0].volume_m3 == pytest.approx(VOLUMES[0] / MM**3, rel=CAD)


def test_faces_of_an_iges_file_are_sewn(tmp_path):
    """IGES knows faces only: those of one body become a closed part."""
    with gmsh_model() as gmsh:
        gmsh.model.occ.addBox(0.0, 0.0, 0.0, *SIZES["trough"])
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "trough.iges"))
    (part,) = own_mesh(tmp_path / "trough.iges", "mm", EDGE).parts
    assert part.volume_m3 == pytest.approx(VOLUMES[0], rel=CAD)


@pytest.fixture(scope="module")
def pipe(tmp_path_factory):
    """A STEP file of two pipes side by side, in mm."""
    path = tmp_path_factory.mktemp("pipes") / "pipes.step"
    with gmsh_model() as gmsh:
        for place in (0.0, 4.0 * RADIUS):
            outer, inner = (gmsh.model.occ.addCylinder(place, 0, 0, 0, 0, 90.0, r) for r in (RADIUS, 0.8 * RADIUS))
            gmsh.model.occ.cut([(3, outer)], [(3, inner)])
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def test_cad_files_are_meshed_on_their_true_surface(pipe):
    """Every node of a pipe lies on one of its two cylinders; the volume is short of the true one by the chords."""
    found = own_mesh(pipe, "mm", 0.005)
    surface = found.surface
    nodes = np.unique(surface.triangles[surface.cell_data["part"] == 0])
    radius = np.linalg.norm(surface.points[nodes][:, :2], axis=1) / (RADIUS * MM)
    on_ends = np.isin(surface.points[nodes][:, 2], [0.0, 90.0 * MM])
    off = np.minimum(np.abs(radius - 1.0), np.abs(radius - 0.8))
    assert off[~on_ends].max() < SINGLE  # of gmsh's projection
    true = np.pi * (1.0 - 0.8**2) * RADIUS**2 * 90.0 * MM**3
    assert found.parts[0].volume_m3 == pytest.approx(true, rel=0.02)  # 5 mm chords on 30 mm: 0.5 %, twice


def test_bodies_of_a_cad_file_have_edges_of_their_own(pipe):
    """Fine where told fine; a part without an edge, and one that is not there, are sentences."""
    fine, coarse = own_mesh(pipe, "mm", {"pipes_body_1": 0.005, "*": 0.02}).parts
    assert fine.triangles > 3 * coarse.triangles
    with pytest.raises(ValueError, match="part 'pipes_body_2' of a CAD file has no target edge"):
        own_mesh(pipe, "mm", {"pipes_body_1": 0.005})
    with pytest.raises(ValueError, match="edges name the part 'elbow', allowed are pipes_body_1, pipes_body_2 and"):
        own_mesh(pipe, "mm", {"elbow": 0.005, "*": 0.02})


def test_parts_of_several_cad_files_have_edges_of_their_own(folder, tmp_path):
    """Each file takes the edges of its parts; a name that none of them has is a sentence, with the names of all."""
    write_bodies(tmp_path / "other.step")
    text = (tmp_path / "other.step").read_text().replace("'trough'", "'hood'").replace("'lip'", "'apron'")
    (tmp_path / "other.step").write_text(text)
    files, coarse = [folder / "bodies.step", tmp_path / "other.step"], {"trough": 0.02, "hood": 0.005, "*": 0.02}
    found = {part.name: part.triangles for part in own_mesh(files, "mm", coarse).parts}
    assert found["hood"] > 3 * found["trough"] and found["lip"] == found["apron"]
    with pytest.raises(ValueError, match="edges name the part 'elbow', allowed are trough, lip, hood, apron and"):
        own_mesh(files, "mm", {"elbow": 0.005, "*": 0.02})
    with pytest.raises(ValueError, match=r"bodies\.step: part 'lip' .* target edge, allowed is one for each of trough"):
        own_mesh(files, "mm", {"trough": 0.02, "lipp": 0.02})


@pytest.mark.parametrize("name", WITH_NAMES)
def test_one_part_alone(folder, name):
    """Its triangles and nodes, and no others; a part that is not there is a sentence with those that are."""
    found = own_mesh(folder / name, "mm", EDGE, solid="lip")
    assert [part.name for part in found.parts] == ["lip"]
    assert found.parts[0].volume_m3 == pytest.approx(VOLUMES[1], rel=FORMATS[name])
    assert len(found.surface.points) == len(np.unique(found.surface.triangles))
    with pytest.raises(ValueError, match=rf"{name}: there is no part 'elbow', allowed is one of trough, lip$"):
        own_mesh(folder / name, "mm", EDGE, solid="elbow")


@pytest.mark.parametrize("order", ["<", ">"])
def test_polygons_of_any_length_in_a_binary_ply(tmp_path, order):
    """A square pyramid of one quadrilateral and four triangles: closed, its volume a third of base times height."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 3.0]])
    faces = [[0, 1, 4], [3, 2, 1, 0], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    kind = "little" if order == "<" else "big"
    head = ["ply", f"format binary_{kind}_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property float {axis}" for axis in "xyz"] + [
        "element face 5",
        "property list uchar short vertex_indices",
    ]
    rows = b"".join(bytes([len(face)]) + np.array(face, dtype=f"{order}i2").tobytes() for face in faces)
    content = "\n".join([*head, "end_header", ""]).encode() + points.astype(f"{order}f4").tobytes() + rows
    (tmp_path / "a.ply").write_bytes(content)
    (part,) = own_mesh(tmp_path / "a.ply", "m").parts
    assert part.volume_m3 == pytest.approx(1.0, rel=EXACT)


def test_a_cad_file_needs_a_target_edge(folder):
    """It has no triangles of its own."""
    with pytest.raises(ValueError, match="has no triangles, allowed is a target edge"):
        own_mesh(folder / "bodies.step", "mm")


def test_a_binary_stl_may_begin_with_solid(tmp_path):
    """It is known by its size, not by its title."""
    points, triangles, _ = all_facets()
    write_binary(tmp_path / "a.stl", points, triangles, b"solid of some program")
    assert len(own_mesh(tmp_path / "a.stl", "mm").surface.triangles) == len(triangles)


@pytest.mark.parametrize("change", [-30, 2])
def test_a_binary_stl_of_another_length_is_no_text(tmp_path, change):
    """It has zero bytes: what it begins with does not matter, and none of its bytes are told."""
    points, triangles, _ = all_facets()
    write_binary(tmp_path / "a.stl", points, triangles, b"solid of some program")
    content = (tmp_path / "a.stl").read_bytes()
    (tmp_path / "a.stl").write_bytes(content[:change] if change < 0 else content + b"x" * change)
    with pytest.raises(ValueError, match=rf"a\.stl: found {len(content) + change} bytes, allowed .* says 24$") as said:
        own_mesh(tmp_path / "a.stl", "mm")
    assert str(said.value).isprintable()


@pytest.mark.parametrize("name", ["a.vtu", "a.msh"])
def test_a_broken_file_prints_nothing(tmp_path, capsys, name):
    """The error is the one sentence; the reader of the format says nothing of its own."""
    (tmp_path / name).write_text({"a.vtu": "<VTKFile>no", "a.msh": "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"}[name])
    with pytest.raises(ValueError, match=rf"{name}: not a readable \{name[1:]} file \(\D+\)$"):
        own_mesh(tmp_path / name, "mm")
    assert capsys.readouterr() == ("", "")


def test_a_folder_is_no_file(tmp_path):
    """It is told before the files beside it are read."""
    (tmp_path / "a.stl").write_text("hello")
    (tmp_path / "b.stl").mkdir()
    with pytest.raises(ValueError, match=r"b\.stl: is a folder, allowed is a file of \.stl, \.obj"):
        own_mesh([tmp_path / "a.stl", tmp_path / "b.stl"], "mm")


def test_a_cad_file_is_not_meshed_with_too_small_an_edge(folder):
    """Areas of its true faces tell before that the triangles will be too many."""
    count = AREA / (np.sqrt(3.0) / 4.0 * 1e-5**2)
    said = rf"bodies\.step: the target edges give about {count:.2g} triangles, .*part 'trough' with 1e-05 m, allowed"
    with pytest.raises(ValueError, match=said.replace("+", r"\+")):
        own_mesh(folder / "bodies.step", "mm", 1e-5)


def _cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "bodies.brep"])
def test_a_truncated_file_is_one_sentence(folder, tmp_path, name):
    """It names the file."""
    (tmp_path / name).write_bytes((folder / name).read_bytes())
    _cut(tmp_path / name)
    with pytest.raises(ValueError, match=name.replace(".", r"\.")) as said:
        own_mesh(tmp_path / name, "mm", EDGE)
    assert "Traceback" not in str(said.value)


def test_a_cad_file_that_crashes_its_reader_is_one_sentence(folder, tmp_path):
    """OpenCASCADE runs beyond the end of a BREP that announces more shapes than it has."""
    text = (folder / "bodies.brep").read_text()
    (tmp_path / "a.brep").write_text(re.sub(r"TShapes \d+", "TShapes 999", text))
    with pytest.raises(ValueError, match=r"a\.brep: not a readable \.brep file \(OpenCASCADE ended with signal 11\)$"):
        part_sizes(tmp_path / "a.brep", "mm")


def test_a_reader_that_comes_to_no_end_is_ended(folder, monkeypatch):
    """By the system, when its processor time is used up: as where a BREP is cut short."""
    monkeypatch.setattr(cad, "PROGRAM", "tests.support.endless")
    with pytest.raises(ValueError, match=r"bodies\.step: not a readable .* came to no end within its processor time"):
        part_sizes(folder / "bodies.step", "mm")


def test_a_step_file_that_is_not_whole_is_refused(folder, tmp_path):
    """OpenCASCADE skips what it cannot read, and says so on the terminal alone."""
    text = (folder / "bodies.step").read_text()
    (tmp_path / "a.step").write_text(text.replace("ENDSEC;\nEND-ISO", "(", 1))
    with pytest.raises(ValueError, match=r"a\.step: not a whole \.step file \("):
        part_sizes(tmp_path / "a.step", "mm")


@pytest.mark.parametrize(("node", "name"), [(-1, "a.vtk"), (16, "a.vtu"), (16, "a.ply")])
def test_a_face_of_a_node_that_is_not_there_is_refused(tmp_path, node, name):
    """Before the first and after the last one."""
    points, triangles, _ = all_facets()
    triangles[5, 1] = node
    meshio.write(tmp_path / name, meshio.Mesh(points, [("triangle", triangles)]))
    with pytest.raises(ValueError, match=rf"{name}: a face names node {node}, allowed are 0 to 15$"):
        own_mesh(tmp_path / name, "mm")


@pytest.mark.parametrize("name", FORMATS)
def test_an_empty_file_is_one_sentence(tmp_path, name):
    """It names the file and what is allowed."""
    (tmp_path / name).touch()
    with pytest.raises(ValueError, match=r"the file is empty, allowed is a surface"):
        own_mesh(tmp_path / name, "mm", EDGE)


def test_a_coordinate_that_is_no_number_is_refused(tmp_path):
    """NaN in a facet: file, part and number of the facet; in ASCII a word that is no number, too."""
    points, triangles, _ = all_facets()
    points[9, 1] = np.nan
    write_binary(tmp_path / "a.stl", points, triangles)
    with pytest.raises(ValueError, match=r"a\.stl: \d triangles have a coordinate that is not finite, .* number 1\d"):
        own_mesh(tmp_path / "a.stl", "mm")
    write_ascii(tmp_path / "b.stl", bodies())
    (tmp_path / "b.stl").write_text((tmp_path / "b.stl").read_text().replace("120.0", "12O.0", 1))
    with pytest.raises(ValueError, match=r"b\.stl, line \d+: found '12O.0' as a coordinate of solid 'trough', allowed"):
        own_mesh(tmp_path / "b.stl", "mm")


def test_a_limit_of_processor_time_that_a_shell_has_set_stays(folder):
    """CAD files are read where `ulimit -t` has set a hard limit, which nobody may raise."""
    code = f"print(part_sizes(Path({str(folder / 'bodies.step')!r}), 'mm'))"
    code = f"from pathlib import Path; from bulkwear.meshes.own.read import part_sizes; {code}"
    asked = f"ulimit -t {HOUR_S}; exec {sys.executable} -c {shlex.quote(code)}"
    ended = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, cwd=REPOSITORY)
    assert "trough" in ended.stdout, ended.stderr


def test_the_line_of_a_decimal_comma_is_named(tmp_path):
    """In a solid that is not the first; the words between vertices are no coordinates."""
    write_ascii(tmp_path / "a.stl", bodies())
    lines = (tmp_path / "a.stl").read_text().splitlines()
    at = [number for number, line in enumerate(lines) if "vertex" in line][-2]
    words = lines[at].split()
    words[2] = "1,5"
    (tmp_path / "a.stl").write_text("\n".join([*lines[:at], " ".join(words), *lines[at + 1 :]]) + "\n")
    with pytest.raises(ValueError, match=rf"a\.stl, line {at + 1}: found '1,5' .* a number with a decimal point"):
        own_mesh(tmp_path / "a.stl", "mm")


def test_byte_order_marks(tmp_path):
    """That of UTF-8 changes nothing; UTF-16 is named."""
    write_ascii(tmp_path / "a.stl", bodies())
    text = (tmp_path / "a.stl").read_text()
    (tmp_path / "b.stl").write_text(text, encoding="utf-8-sig")
    (tmp_path / "c.stl").write_text(text, encoding="utf-16")
    plain, marked = (own_mesh(tmp_path / name, "mm").surface for name in ("a.stl", "b.stl"))
    np.testing.assert_array_equal(marked.points, plain.points)
    with pytest.raises(ValueError, match=r"c\.stl: found text as UTF-16, allowed is an ASCII STL as UTF-8"):
        own_mesh(tmp_path / "c.stl", "mm")


@pytest.mark.parametrize(
    ("name", "under", "said"),
    [
        ("bodies.step", "a.stl", "begins with 'ISO-10303-21'"),
        ("bodies.ply", "a.step", "begins with 'ply'"),
        ("ascii.stl", "a.obj", "no triangle found"),
        ("ascii.stl", "a.dwg", r"the format '\.dwg' is unknown, allowed are \.stl"),
    ],
)
def test_a_wrong_ending_is_refused(folder, tmp_path, name, under, said):
    """What the file holds is not what its name says."""
    (tmp_path / under).write_bytes((folder / name).read_bytes())
    with pytest.raises(ValueError, match=said):
        own_mesh(tmp_path / under, "mm", EDGE)


def test_a_file_that_is_not_there(tmp_path):
    """The sentence names it."""
    with pytest.raises(FileNotFoundError, match=r"chute\.stl: no such file"):
        own_mesh(tmp_path / "chute.stl", "mm")


@pytest.mark.parametrize(
    ("line", "said"), [("f 1 2", "a face has 2 vertices"), ("f 1 2 99", "vertex 99 of 8"), ("v 1 2 x", "could not")]
)
def test_a_faulty_line_of_an_obj_is_named(tmp_path, line, said):
    """The sentence has file, line and what is wrong."""
    write_bodies(tmp_path / "a.obj")
    lines = (tmp_path / "a.obj").read_text().splitlines()
    (tmp_path / "a.obj").write_text("\n".join([*lines[:8], line, *lines[8:]]))
    with pytest.raises(ValueError, match=rf"a\.obj, line 9: .*{said}"):
        own_mesh(tmp_path / "a.obj", "mm")
