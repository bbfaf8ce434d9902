"""Drawings of parts: files of the project or the package, or what a script in their folder draws."""

import pytest

from bulkwear.workflows.cases.equipment.drawings import drawing, drawing_digest, drawing_source
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine.project import enter_project, leave_project
from tests.support.own_machine_project import machine_project

DRAW = """\
import sys
from pathlib import Path

for name in ("box.stl", "lid.stl"):
    Path(sys.argv[1], name).write_text("solid " + name)
"""


@pytest.fixture
def project(tmp_path):
    """A project with drawn parts, and a folder whose parts a script draws."""
    folder = machine_project(tmp_path / "project")
    (folder / "meshes/feeder").mkdir()
    (folder / "meshes/feeder/draw.py").write_text(DRAW)
    enter_project(folder)
    yield folder
    leave_project()


def test_file_that_is_there_is_the_drawing(project, tmp_path):
    """It is taken where it lies."""
    assert drawing("liner.stl", tmp_path / "drawn") == project / "meshes/liner.stl"
    assert not (tmp_path / "drawn").exists()


def test_script_draws_what_is_missing(project, tmp_path):
    """Into the folder that is named, once for all parts that it draws; nothing is left beside it."""
    drawn = tmp_path / "drawn"
    assert drawing("feeder/box.stl", drawn).read_text() == "solid box.stl"
    (project / "meshes/feeder/draw.py").write_text("raise SystemExit('drawn twice')")
    assert drawing("feeder/lid.stl", drawn) == drawn / "feeder/lid.stl"
    assert [path.name for path in (project / "meshes/feeder").iterdir()] == ["draw.py"]


def test_drawings_of_the_same_name_are_two(project, tmp_path):
    """Where the scripts of two folders draw a box each, neither stands for the other."""
    (project / "meshes/hopper").mkdir()
    (project / "meshes/hopper/draw.py").write_text(DRAW.replace("solid ", "hopper's "))
    found = [drawing(f"{folder}/box.stl", tmp_path / "drawn").read_text() for folder in ("feeder", "hopper")]
    assert found == ["solid box.stl", "hopper's box.stl"]


def test_file_stands_before_the_script(project, tmp_path):
    """A reader replaces what the script would draw by a file of theirs."""
    (project / "meshes/feeder/box.stl").write_text("solid mine")
    assert drawing("feeder/box.stl", tmp_path / "drawn").read_text() == "solid mine"
    assert drawing_source("feeder/lid.stl").name == "draw.py"


@pytest.mark.parametrize("name", ["chutes/box.stl", f"feeder{300 * 'r'}/box.stl"])
def test_a_part_that_is_nowhere_is_one_sentence(project, name):
    """Also by a name that no file system takes."""
    with pytest.raises(ConfigError, match=rf"^meshes/{name}: there is no such file, and no draw\.py in its folder"):
        drawing_source(name)


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("import sys\nprint('no gmsh', file=sys.stderr)\nsys.exit(3)\n", "no gmsh"),
        ("raise ValueError('a wall of 0 mm')\n", "ValueError: a wall of 0 mm"),
        (DRAW.replace("box", "boxes"), r"it drew boxes\.stl, lid\.stl"),
        ("pass\n", "it drew nothing"),
    ],
    ids=["ends", "raises", "draws others", "draws nothing"],
)
def test_script_that_does_not_draw_is_one_sentence(project, tmp_path, script, words):
    """It names the part and has the script's last words, or what it drew."""
    (project / "meshes/feeder/draw.py").write_text(script)
    with pytest.raises(ConfigError, match=rf"^meshes/feeder/box\.stl: draw\.py .*{words}\.$") as fault:
        drawing("feeder/box.stl", tmp_path / "drawn")
    assert "\n" not in str(fault.value)


def test_the_nearest_drawing_is_named(project):
    """Also where upper and lower case differ alone."""
    for name in ("Lid.STEP", "lid.step"):
        (project / "meshes/feeder/LID.step").write_text("")
        with pytest.raises(ConfigError, match=rf"^meshes/feeder/{name}: .* file \(the nearest is LID\.step\), and no"):
            (project / "meshes/feeder/draw.py").unlink(missing_ok=True)
            drawing_source(f"feeder/{name}")


def test_a_backslash_is_told(project):
    """No nearest file, which would be another one: folders of other systems are parted otherwise."""
    (project / "meshes/feeder/LID.step").write_text("")
    with pytest.raises(ConfigError, match=r"LID\.step: there is no such file \(folders are parted by /\), and no"):
        drawing_source("feeder\\LID.step")


def test_neither_file_nor_script_is_one_sentence(project, tmp_path):
    """It names what is missing and what is allowed."""
    with pytest.raises(ConfigError, match=r"^meshes/hopper/box\.step: there is no such file, and no draw\.py"):
        drawing("hopper/box.step", tmp_path / "drawn")


def test_digest_is_that_of_file_or_script(project):
    """Another drawing, or another script, is another machine; what one script draws has that of the script."""
    before = {name: drawing_digest(name) for name in ("liner.stl", "feeder/box.stl", "feeder/lid.stl")}
    (project / "meshes/liner.stl").write_text("solid other")
    (project / "meshes/feeder/draw.py").write_text(DRAW + "\n")
    after = {name: drawing_digest(name) for name in before}
    assert not set(before.values()) & set(after.values())
    assert after == {name: drawing_digest(name) for name in before}
    assert before["feeder/box.stl"] == before["feeder/lid.stl"]
