"""Scans of every format are read in blocks; what is damaged is named."""

import numpy as np
import pytest

from bulkwear.postproc.readers import point_cloud
from bulkwear.postproc.readers.point_cloud import inside_box, point_blocks, random_points

POINTS = np.array([[1.5, -2.0, 3.25], [0.0, 4.0, -1.0], [7.0, 8.0, 9.0], [-1.0, 0.5, 0.25]])  # mm, exact in float32


def ply_head(kind, count, properties="property float x\nproperty float y\nproperty float z\n", before=""):
    text = f"ply\nformat {kind} 1.0\ncomment a scanner\n{before}element vertex {count}\n{properties}"
    return (text + "element face 0\nproperty list uchar int vertex_indices\nend_header\n").encode()


def text_rows(points, separator=" ", more=""):
    return "".join(separator.join(f"{value:g}" for value in row) + more + "\n" for row in points).encode()


def binary_stl(points):
    facets = np.zeros(len(points), dtype=point_cloud.STL_FACET)
    facets["corners"] = points[:, None] + np.arange(3)[None, :, None]
    return b"solid by its first word only".ljust(80) + np.uint32(len(points)).tobytes() + facets.tobytes()


def text_stl(points):
    facet = "facet normal 0 0 1\n outer loop\n" + "  vertex {:g} {:g} {:g}\n" * 3 + " endloop\nendfacet\n"
    corners = points[:, None] + np.arange(3)[None, :, None]
    return ("solid s\n" + "".join(facet.format(*each.ravel()) for each in corners) + "endsolid s\n").encode()


CORNERS = (POINTS[:, None] + np.arange(3)[None, :, None]).reshape(-1, 3)
WITH_COLOUR = "property uchar red\nproperty double x\nproperty float y\nproperty float z\n"
COLOURED = np.dtype([("red", "u1"), ("x", ">f8"), ("y", ">f4"), ("z", ">f4")])
FORMATS = {
    "text.ply": (ply_head("ascii", 4) + text_rows(POINTS), POINTS),
    "little.ply": (ply_head("binary_little_endian", 4) + POINTS.astype("<f4").tobytes(), POINTS),
    "big.ply": (
        ply_head("binary_big_endian", 4, WITH_COLOUR)
        + np.rec.fromarrays([[1, 2, 3, 4], *POINTS.T], dtype=COLOURED).tobytes(),
        POINTS,
    ),
    "later.ply": (
        ply_head("binary_little_endian", 4, before="element pose 2\nproperty float angle\n")
        + np.zeros(2, "<f4").tobytes()
        + POINTS.astype("<f4").tobytes(),
        POINTS,
    ),
    "binary.stl": (binary_stl(POINTS), CORNERS),
    "text.stl": (text_stl(POINTS), CORNERS),
    "a.xyz": (text_rows(POINTS), POINTS),
    "b.csv": (b"x;y;z;intensity\n" + text_rows(POINTS, ";", ";12"), POINTS),
    "c.pts": (b"4\n# taken on a Monday\n" + text_rows(POINTS, ",") + b"\n# end\n", POINTS),
    "hole.xyz": (text_rows(POINTS[:2]) + b"nan nan nan\n" + text_rows(POINTS[2:]), POINTS),
}


def read(path, unit="mm"):
    return np.concatenate(list(point_blocks(path, unit)))


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("block", [3, 100])
def test_every_format_gives_its_points(tmp_path, monkeypatch, name, block):
    """In m, in order, however large the blocks are."""
    monkeypatch.setattr(point_cloud, "POINTS_PER_BLOCK", block)
    content, expected = FORMATS[name]
    (tmp_path / name).write_bytes(content)
    blocks = list(point_blocks(tmp_path / name))
    assert np.concatenate(blocks) == pytest.approx(1e-3 * expected, rel=1e-12)
    assert max(map(len, blocks)) <= block


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("um", 1e-6), ("inch", 0.0254)])
def test_units(tmp_path, unit, metres):
    (tmp_path / "a.xyz").write_bytes(FORMATS["a.xyz"][0])
    assert read(tmp_path / "a.xyz", unit) == pytest.approx(metres * POINTS)


LINE_ENDS = np.full((256, 3), 0.01, "<f4").tobytes()  # 0.01 begins with the byte of a line end


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.obj", b"", "kind of scan is '.obj'"),
        ("a.ply", b"plz\n", "line 1"),
        ("a.ply", ply_head("ascii", 4).replace(b"end_header\n", b""), "no end_header"),
        ("a.ply", ply_head("utf8", 4), "format of the PLY is 'utf8'"),
        ("a.ply", b"ply\nformat ascii 1.0\nvertices 4\nend_header\n", "line 3"),
        ("a.ply", ply_head("ascii", 0).replace(b"vertex", b"point"), "no element vertex"),
        ("a.ply", ply_head("ascii", 4, "property float x\nproperty float y\n"), "it needs x, y and z"),
        ("a.ply", ply_head("ascii", 4, "property list uchar float x\n"), "no lists"),
        ("a.ply", ply_head("ascii", 5) + text_rows(POINTS), "promises 5 points, found 4"),
        ("a.ply", ply_head("binary_little_endian", 4) + POINTS.astype("<f4").tobytes()[:-5], "promises 4 points"),
        ("a.stl", binary_stl(POINTS)[10:], "no binary STL"),
        ("a.stl", text_stl(POINTS)[:-20], "cut short"),
        ("a.stl", text_stl(POINTS).replace(b"vertex 0", b"vertex O"), "vertex 4"),
        ("a.xyz", text_rows(POINTS) + b"1.0 two 3.0\n", "line 5"),
        ("a.xyz", text_rows(POINTS) + b"1.0 2.0\n", "line 5"),
        ("a.xyz", b"no\nnumbers\nat all\n", "line 3"),
        (
            "a.csv",
            b"x;y;z\n79,337;116,797;20,000\n",
            "line 2: '79,337;116,797;20,000', allowed are decimals with a point",
        ),
        ("a.txt", b"79,337 116,797 20,000\n", "line 1: .* decimals with a point"),
        ("a.txt", b"-79,337\t116,797\t20\n", "line 1: .* decimals with a point"),
        ("a.xyz", b"", "no points"),
        ("a.ply", ply_head("ascii", 0), "no points"),
        (
            "a.ply",
            (ply_head("binary_little_endian", 256) + LINE_ENDS).replace(b"\n", b"\r\n"),
            "a binary file that was copied as text",
        ),
        (
            "a.ply",
            ply_head("binary_little_endian", 4, "property double x\nproperty double y\nproperty double z\n")
            + np.full((4, 3), 1e292).tobytes(),
            "found coordinates beyond 1e\\+09",
        ),
    ],
)
def test_damaged_files_are_named_with_the_place(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match=words) as error:
        read(tmp_path / name)
    assert str(tmp_path / name) in str(error.value)


def test_unknown_unit_and_missing_file(tmp_path):
    with pytest.raises(ValueError, match="unit of the scan is 'ell'"):
        read(tmp_path / "a.xyz", "ell")
    with pytest.raises(FileNotFoundError, match="no such scan"):
        read(tmp_path / "a.xyz")


def test_random_points_are_a_fair_choice():
    """As many as asked for, each once, from all blocks alike; all of them when there are fewer."""
    points = np.column_stack([np.arange(30_000.0), np.zeros((30_000, 2))])
    chosen, total = random_points(iter(np.array_split(points, 11)), 3000)
    assert total == 30_000
    assert len(np.unique(chosen[:, 0])) == 3000
    counts = np.histogram(chosen[:, 0], 10, (0.0, 30_000.0))[0]
    assert np.abs(counts - 300).max() < 5 * np.sqrt(300)
    assert len(random_points(iter([points]), 50_000)[0]) == 30_000


def test_a_box_cuts_out_the_sample():
    box = np.array([[0.0, 2.0], [-3.0, 5.0], [-2.0, 4.0]])
    kept = np.concatenate(list(inside_box(iter([POINTS[:2], POINTS[2:]]), box)))
    assert kept.tolist() == POINTS[:2].tolist()
    with pytest.raises(ValueError, match="no scanned point"):
        list(inside_box(iter([POINTS]), box + 100.0))
    with pytest.raises(ValueError, match="from < to"):
        list(inside_box(iter([POINTS]), box[:, ::-1]))
