"""The command `mesh`: a surface and its tables, or a sentence and a picture of the fault."""

import numpy as np
import pytest
from PIL import Image

from bulkwear.__main__ import main
from bulkwear.postproc.mesh import read_surface
from tests.support.own_solids import AREA, MM, bodies, box, write_ascii
from tests.support.stl import stl_facets

LONGEST = 15.00001  # mm, 1.5 targets and the last digit of the STL
EXACT = 1e-9  # relative: an STL has nine digits
RED = (160, 90, 90)  # of a pixel's red at least, green and blue at most: the colour of faults under any light


@pytest.fixture
def trough(tmp_path):
    """The path of an STL with two bodies, in mm."""
    write_ascii(tmp_path / "plant.stl", bodies())
    return tmp_path / "plant.stl"


def test_a_surface_and_its_tables(trough, tmp_path, capsys):
    """Files in m for a study and for the solver, in the same order; lengths of the command are in the file's unit."""
    files = ["-o", str(tmp_path / "out.vtu"), "--stl", str(tmp_path / "out.stl")]
    choices = ["--unit", "mm", "--edge", "10", "--edge", "lip=5", "--ball", "0", "0", "0", "20", "2", "--weld", "0.001"]
    assert main(["mesh", str(trough), *choices, *files]) == 0
    said = capsys.readouterr().out
    assert "trough" in said
    assert "lip" in said
    assert "points within 0.001 mm are one" in said
    surface, corners = read_surface(tmp_path / "out.vtu"), stl_facets(tmp_path / "out.stl")
    np.testing.assert_allclose(corners, surface.points[surface.triangles], rtol=0.0, atol=EXACT)
    size = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1) / MM
    part, places = surface.cell_data["part"], corners.mean(axis=1) / MM
    assert 0.5 * LONGEST < size[part == 0].max() <= LONGEST
    assert size[part == 1].max() <= 0.5 * LONGEST
    assert size[np.linalg.norm(places, axis=1) < 18.0].max() <= 0.2 * LONGEST
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert area.sum() == pytest.approx(AREA, rel=1e-6)  # digits of the STL
    assert part.dtype == np.int64


def test_bodies_that_touch_are_a_file_each(tmp_path, capsys):
    """Where the solver would refuse all parts in one mesh, the STL is one per part, named for it."""
    points, triangles = box((100.0, 100.0, 100.0))
    beside = points + np.array([100.0, 0, 0])
    write_ascii(tmp_path / "a.stl", {"left wall": (points, triangles), "right/wall": (beside, triangles)})
    assert main(["mesh", str(tmp_path / "a.stl"), "--unit", "mm", "--stl", str(tmp_path / "out.stl")]) == 0
    assert "a mesh per part for the solver" in capsys.readouterr().out
    assert not (tmp_path / "out.stl").exists()
    right = stl_facets(tmp_path / "out_right_wall.stl")
    np.testing.assert_allclose(
        [right.min(axis=(0, 1)), right.max(axis=(0, 1))], [[0.1, 0, 0], [0.2, 0.1, 0.1]], atol=EXACT
    )
    assert len(stl_facets(tmp_path / "out_left_wall.stl")) == 12


def test_a_refused_surface_is_drawn(tmp_path, capsys, monkeypatch):
    """Two cubes in one solid that overlap: a sentence with the place, a picture with red faces in both views."""
    monkeypatch.chdir(tmp_path)
    points, triangles = box((100.0, 100.0, 100.0))
    both = np.concatenate([points, points + np.array([50.0, 30, 20])])
    write_ascii(tmp_path / "a.stl", {"wall": (both, np.concatenate([triangles, triangles + 8]))})
    assert main(["mesh", "a.stl", "--unit", "mm", "-o", "out.vtu"]) == 1
    said = capsys.readouterr().err
    assert said.startswith("a.stl: part 'wall' cuts itself")
    assert said.rstrip().endswith("Its picture is out.fault.png")
    assert not (tmp_path / "out.vtu").exists()
    pixels = np.asarray(Image.open(tmp_path / "out.fault.png").convert("RGB")).astype(int)
    red = (pixels[:, :, 0] > RED[0]) & (pixels[:, :, 1:] < RED[1]).all(axis=2)
    half = pixels.shape[1] // 2
    assert red[:, :half].sum() > 100
    assert red[:, half:].sum() > 1000


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--unit", "yard"], "the unit of lengths is 'yard', allowed is one of m, cm"),
        (["--unit", "mm", "--edge", "lip=fine"], "--edge is 'lip=fine', allowed is a length or"),
        (["--unit", "mm", "--edge", "floor=3"], "edges name the part 'floor', allowed are trough, lip and"),
        (["--unit", "mm", "--edge", "3", "--edge", "4"], "--edge is given twice for all parts, the second time '4'"),
        (["--unit", "mm", "--edge", "lip=3", "--edge", "lip=3"], "--edge is given twice for part 'lip', the second"),
        (["--unit", "mm", "--edge", "inf"], "target edge of all parts is inf m, allowed is a finite length above 0"),
        (["--unit", "mm", "--ball", "0", "0", "0", "-1", "3"], "the radius of ball 1 is -0.001 m, allowed is a"),
        (["--unit", "mm", "--ball", "9e3", "0", "0", "9", "3"], "--ball is '9000 0 0 9 3', allowed is one that the"),
        (["--unit", "mm", "--angle", "nan"], "the wanted smallest angle is nan degrees, allowed are 0 to 45"),
    ],
)
def test_words_that_make_no_sense(trough, capsys, words, said):
    """One sentence in one line, and no traceback."""
    assert main(["mesh", str(trough), *words]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "out.txt"], "-o is 'out.txt', allowed is a name that ends with .vtu"),
        (["--stl", "out.vtu"], "--stl is 'out.vtu', allowed is a name that ends with .stl"),
        (["-o", "folder.vtu"], "-o is 'folder.vtu', which is a folder, allowed is a file"),
        (["--stl", "none/out.stl"], "--stl is 'none/out.stl', its folder 'none' is not there, allowed is one that"),
        (["-o", "plant.stl/out.vtu"], "-o is 'plant.stl/out.vtu', its folder 'plant.stl' is a file, allowed is one"),
        (["--stl", "folder.vtu/../plant.stl"], "which is an input, allowed is another file"),
    ],
)
def test_files_that_cannot_be_written(trough, capsys, monkeypatch, words, said):
    """One sentence before anything is read: the input is none, but that is not what is told."""
    monkeypatch.chdir(trough.parent)
    (trough.parent / "folder.vtu").mkdir()
    trough.write_text("hello")
    assert main(["mesh", "plant.stl", "--unit", "mm", *words]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert trough.read_text() == "hello"


def test_a_folder_that_is_read_only(trough, capsys, monkeypatch):
    """Told before, for whoever may not write there."""
    monkeypatch.setattr("os.access", lambda path, mode: False)
    assert main(["mesh", str(trough), "--unit", "mm", "-o", str(trough.parent / "out.vtu")]) == 1
    assert "is read-only, allowed is one to write into" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["out.vtu", None])
def test_faults_of_the_system_are_sentences(trough, capsys, monkeypatch, name):
    """A disk that is full: the file, where the system names one, and its reason; no traceback."""

    def full(path, surface):
        raise OSError(28, "No space left on device", *filter(None, [name]))

    monkeypatch.setattr("bulkwear.postproc.mesh.write_surface", full)
    assert main(["mesh", str(trough), "--unit", "mm", "-o", str(trough.parent / "out.vtu")]) == 1
    assert capsys.readouterr().err == (
        f"{name or 'a file'}: No space left on device, allowed is what can be read and written\n"
    )


def test_files_of_parts_are_all_written(tmp_path, capsys):
    """Parts whose names differ by what no file's name has are two files, and none of them is an input."""
    points, triangles = box((100.0, 100.0, 100.0))
    beside = points + np.array([100.0, 0, 0])
    write_ascii(tmp_path / "a.stl", {"wall/left": (points, triangles), "wall left": (beside, triangles)})
    words = ["mesh", str(tmp_path / "a.stl"), "--unit", "mm", "--stl"]
    assert main([*words, str(tmp_path / "out.stl")]) == 0
    left, right = (stl_facets(tmp_path / f"out_wall_left{end}.stl")[:, :, 0].max() for end in ("", "_2"))
    assert [left, right] == pytest.approx([0.1, 0.2])
    (tmp_path / "a.stl").rename(tmp_path / "out_wall_left.stl")
    words[1] = str(tmp_path / "out_wall_left.stl")
    assert main([*words, str(tmp_path / "out.stl")]) == 1
    assert "out_wall_left.stl', which is an input, allowed is another file" in capsys.readouterr().err


def test_a_fault_is_told_without_its_picture(tmp_path, capsys, monkeypatch):
    """Where the picture cannot be written, the sentence of the fault comes first, and why there is no picture."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.fault.png").mkdir()
    write_ascii(tmp_path / "a.stl", {"needle": (np.array([[0, 0, 0], [100, 0, 0], [100, 0.3, 0.0]]), [[0, 1, 2]])})
    assert main(["mesh", "a.stl", "--unit", "mm"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("a.stl: part 'needle' has 1 faces that are too sharp")
    assert "Its picture a.fault.png cannot be drawn (" in line


def test_the_unit_has_to_be_said(trough, capsys):
    """It is never guessed."""
    with pytest.raises(SystemExit):
        main(["mesh", str(trough)])
    assert "--unit" in capsys.readouterr().err
