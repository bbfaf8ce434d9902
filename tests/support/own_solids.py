"""Bodies of a plant as a CAD file has them, written in each format; facets as an STL has them."""

import re
from pathlib import Path

import meshio
import numpy as np

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.own.stl import FACET_TYPE

MM = 1e-3  # m, unit of the files here
SIZES = {"trough": (120.0, 40.0, 20.0), "lip": (30.0, 40.0, 50.0)}  # mm, boxes
CORNERS = {"trough": (0.0, 0.0, 0.0), "lip": (130.0, 0.0, -7.0)}  # mm, their lowest corners
AREA = sum(2.0 * (a * b + b * c + c * a) for a, b, c in SIZES.values()) * MM**2  # m2
VOLUMES = [a * b * c * MM**3 for a, b, c in SIZES.values()]  # m3
BOX = np.array([[0.0, 0.0, -7.0], [160.0, 40.0, 43.0]]) * MM  # m
QUADS = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])  # outward


def box(size, corner=(0.0, 0.0, 0.0)):
    """Points (8, 3) and triangles (12, 3) of a box, outward."""
    corners = np.array([[k & 1, k >> 1 & 1, k >> 2 & 1] for k in range(8)], dtype=float)
    triangles = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
    return corners * size + corner, triangles


def bodies():
    """Points (n, 3) mm and triangles of the bodies by name."""
    return {name: box(size, CORNERS[name]) for name, size in SIZES.items()}


def all_facets():
    """Points (16, 3) mm, triangles and part of both bodies."""
    points, triangles = zip(*bodies().values(), strict=True)
    return np.concatenate(points), np.concatenate([triangles[0], triangles[1] + 8]), np.repeat([0, 1], 12)


def write_ascii(path: Path, solids) -> None:
    """Write {name: (points, triangles)} as ASCII STL, a block each."""
    lines = []
    for name, (points, triangles) in solids.items():
        lines.append(f"solid {name}")
        for corners in np.asarray(points)[triangles]:
            lines += [
                "facet normal 0 0 0",
                " outer loop",
                *(f"  vertex {x!r} {y!r} {z!r}" for x, y, z in corners.tolist()),
            ]
            lines += [" endloop", "endfacet"]
        lines.append(f"endsolid {name}")
    path.write_text("\n".join(lines) + "\n")


def write_binary(path: Path, points, triangles, title=b"") -> None:
    """Write facets as binary STL."""
    facets = np.zeros(len(triangles), dtype=FACET_TYPE)
    facets["corners"] = np.asarray(points)[triangles]
    path.write_bytes(title.ljust(80, b"\0") + len(facets).to_bytes(4, "little") + facets.tobytes())


def write_obj(path: Path) -> None:
    """Write the bodies as groups of quadrilaterals, the second counted backwards and with texture and normal."""
    lines = []
    for name, (points, _) in bodies().items():
        lines += [f"v {x} {y} {z}" for x, y, z in points] + [f"g {name}"]
        words = [[f"{k - 8}/1/1" if name == "lip" else f"{k + 1}" for k in quad] for quad in QUADS]
        lines += ["f " + " ".join(each) for each in words]
    path.write_text("\n".join(lines) + "\n")


def write_ply(path: Path) -> None:
    """Write the bodies as binary PLY, colours and a label after the nodes of a face."""
    points, triangles, part = all_facets()
    kind = [("count", "u1"), ("nodes", "<i4", 3), ("red", "u1"), ("part", "<i4")]
    faces = np.zeros(len(triangles), dtype=kind)
    faces["count"], faces["nodes"], faces["part"] = 3, triangles, part
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property double {axis}" for axis in "xyz"] + [f"element face {len(faces)}"]
    head += ["property list uchar int vertex_indices", "property uchar red", "property int part", "end_header", ""]
    path.write_bytes("\n".join(head).encode() + points.astype("<f8").tobytes() + faces.tobytes())


def write_ply_text(path: Path) -> None:
    """Write the bodies as ASCII PLY of quadrilaterals, the first of them as two triangles."""
    points = np.concatenate([points for points, _ in bodies().values()])
    faces = [[*quad, number] for number in range(2) for quad in QUADS + 8 * number]
    faces[:1] = [[*faces[0][:3], 0], [*np.take(faces[0], [0, 2, 3]), 0]]
    lines = ["ply", "format ascii 1.0", "comment by hand", f"element vertex {len(points)}"]
    lines += [f"property float {axis}" for axis in "xyz"] + [f"element face {len(faces)}"]
    lines += ["property list uchar int vertex_index", "property int part", "end_header"]
    lines += [" ".join(map(str, point)) for point in points.tolist()]
    lines += [" ".join(map(str, [len(face) - 1, *face])) for face in faces]
    path.write_text("\n".join(lines) + "\n")


def write_meshio(path: Path) -> None:
    """Write the bodies by meshio, with the label that its format knows."""
    points, triangles, part = all_facets()
    if path.suffix == ".msh":
        names = {name: np.array([number + 1, 2]) for number, name in enumerate(SIZES)}
        data = {"gmsh:physical": [part + 1], "gmsh:geometrical": [part + 1]}
        mesh = meshio.Mesh(points, [("triangle", triangles)], cell_data=data, field_data=names)
        meshio.write(path, mesh, file_format="gmsh22", binary=False)
    else:
        meshio.write(path, meshio.Mesh(points, [("triangle", triangles)], cell_data={"part": [part.astype(np.int64)]}))


def write_cad(path: Path) -> None:
    """Write the bodies by OpenCASCADE, with their names where the format has any."""
    with gmsh_model() as gmsh:
        for name, size in SIZES.items():
            tag = gmsh.model.occ.addBox(*CORNERS[name], *size)
            gmsh.model.occ.synchronize()
            gmsh.model.setEntityName(3, tag, name)
        gmsh.write(str(path))
    if path.suffix == ".step":  # gmsh writes no names, but the number of the file in its process and that of the body
        text = path.read_text()
        for number, name in enumerate(SIZES, start=1):
            text = re.sub(rf"'Open CASCADE STEP translator [^']* \d+\.{number}'", f"'{name}'", text)
        path.write_text(text)


def write_bodies(path: Path) -> None:
    """Write the bodies in the format that the file's name says; `binary.stl` is a binary one."""
    if path.name == "binary.stl":
        points, triangles, _ = all_facets()
        write_binary(path, points, triangles, b"solid of a program that begins binary files like this")
    elif path.suffix == ".stl":
        write_ascii(path, bodies())
    elif path.suffix == ".obj":
        write_obj(path)
    elif path.suffix == ".ply":
        (write_ply_text if path.stem == "text" else write_ply)(path)
    elif path.suffix in (".step", ".brep", ".iges"):
        write_cad(path)
    else:
        write_meshio(path)
