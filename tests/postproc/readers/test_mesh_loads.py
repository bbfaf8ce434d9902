"""LIGGGHTS' own loads per triangle, from real dumps."""

import os
import subprocess

import numpy as np
import pytest

from bulkwear.postproc.readers.contacts import read_contacts
from bulkwear.postproc.readers.mesh_loads import MeshLoadsError, read_mesh_loads
from tests import DATA
from tests.support.patience import LONGEST_S

SIX_DIGITS = 1e-5  # of a number in a dump
TRIANGLES, AREA = 24, 0.005 * 0.005 / 2  # m2, plate.stl
LOAD = 5.0  # N, sphere_on_plate.in


def test_the_stress_of_the_slide_is_load_over_area():
    """5 N on triangle 2; with friction 1 the shear stress is as large (Coulomb)."""
    loads = read_mesh_loads(DATA / "slide_loads.vtk", TRIANGLES)
    expected = np.zeros(TRIANGLES)
    expected[4 if loads["normal_stress_Pa"][4] else 2] = LOAD / AREA
    np.testing.assert_allclose(loads["normal_stress_Pa"], expected, rtol=SIX_DIGITS)
    np.testing.assert_allclose(loads["shear_stress_Pa"], expected, rtol=SIX_DIGITS)
    np.testing.assert_array_equal(loads["triangle"], np.arange(TRIANGLES))
    assert loads["triangle"].dtype == np.int64


def test_finnie_wear_stays_where_particles_have_been():
    """Finnie wear accumulates: triangles that carry no stress now may be worn."""
    loads = read_mesh_loads(DATA / "bed_loads.vtk", TRIANGLES)
    assert (loads["finnie_wear"] >= 0.0).all()
    assert (loads["finnie_wear"][loads["normal_stress_Pa"] == 0.0] > 0.0).any()


def test_triangles_are_sorted_by_their_id(tmp_path):
    """Under MPI the file lists the triangles rank by rank."""
    ids = "meshid 1 24 int\n" + " ".join(str(k) for k in range(9))
    text = (DATA / "bed_loads.vtk").read_text()
    assert ids in text
    path = tmp_path / "shuffled.vtk"
    path.write_text(text.replace(ids, "meshid 1 24 int\n8 7 6 5 4 3 2 1 0"))
    plain, shuffled = read_mesh_loads(DATA / "bed_loads.vtk"), read_mesh_loads(path)
    order = [*range(8, -1, -1), *range(9, TRIANGLES)]
    for name in ("normal_stress_Pa", "shear_stress_Pa", "finnie_wear"):
        np.testing.assert_array_equal(shuffled[name], plain[name][order])
        assert plain[name].any()


def test_a_dump_without_a_field_gives_nan(tmp_path):
    """`wear` is there only with `wear finnie`."""
    path = tmp_path / "loads.vtk"
    path.write_text((DATA / "slide_loads.vtk").read_text().replace("\nwear 1 24", "\nother 1 24"))
    loads = read_mesh_loads(path)
    assert np.isnan(loads["finnie_wear"]).all()
    assert loads["normal_stress_Pa"].any()


FAULTS = {
    "other count": (None, None, 25, r"found 24 triangles, allowed is each of 0 \.\.\. 24 once"),
    "id twice": ("\n0 1 2 3 4 5 6 7 8 \n9 10", "\n0 0 2 3 4 5 6 7 8 \n9 10", 24, "found 24 triangles"),
    "no ids": ("meshid", "other", 24, "no field 'meshid', allowed is a dump with the keyword `id`"),
    "no cell data": ("CELL_DATA", "POINT_DATA", 24, "no cell data"),
    "nan": (
        "normal_stress_average 1 24 double\n0",
        "normal_stress_average 1 24 double\nnan",
        24,
        "finite numbers",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_spoilt_file_is_refused(tmp_path, name):
    """One sentence with file, what is there and what is allowed."""
    old, new, triangles, words = FAULTS[name]
    text = (DATA / "bed_loads.vtk").read_text()
    if old is not None:
        head, _, cells = text.partition("CELL_DATA")
        cells = "CELL_DATA" + cells
        assert old in cells
        text = head + cells.replace(old, new, 1)
    path = tmp_path / "spoilt.vtk"
    path.write_text(text)
    with pytest.raises(MeshLoadsError, match=r"spoilt\.vtk: .*" + words):
        read_mesh_loads(path, triangles)


def test_a_file_cut_off_is_refused(tmp_path):
    """A missing value is found, wherever the file ends."""
    text = (DATA / "bed_loads.vtk").read_text().rstrip()
    path = tmp_path / "cut.vtk"
    for length in range(0, len(text) - 1, 53):
        path.write_text(text[:length])
        with pytest.raises(MeshLoadsError, match=r"cut\.vtk: .*allowed"):
            read_mesh_loads(path, TRIANGLES)


def run_bed(folder, ranks):
    """Runs bed_on_plate.in on some ranks; returns its contacts and its loads file."""
    (folder / "plate.stl").write_bytes((DATA / "plate.stl").read_bytes())
    deck = (DATA / "bed_on_plate.in").read_text()
    (folder / "bed_on_plate.in").write_text(deck.replace("boundary f f f", f"boundary f f f\nprocessors 1 {ranks} 1"))
    mpirun = ["mpirun", "--bind-to", "none", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"} if os.getuid() == 0 else {}
    with open(folder / "screen.txt", "w") as screen:
        command = [*mpirun, "liggghts", "-in", "bed_on_plate.in"]
        subprocess.run(command, cwd=folder, env={**os.environ, **root}, stdout=screen, check=True, timeout=LONGEST_S)
    return list(read_contacts(folder / "contacts.dump", folder / "spins.dump")), folder / "loads_6000.vtk"


def facets(path):
    """(m, 3, 3) corners of an ASCII STL file."""
    corners = [line.split()[1:] for line in path.read_text().splitlines() if "vertex" in line]
    return np.array(corners, float).reshape(-1, 3, 3)


def cells(path):
    """(m, 3, 3) corners of the cells of a mesh/vtk dump, in the order of the file, and their ids."""
    words = path.read_text().split()
    start = words.index("POINTS")
    points = np.array(words[start + 3 : start + 3 + 3 * int(words[start + 1])], float).reshape(-1, 3, 3)
    start = words.index("meshid")
    return points, np.array(words[start + 4 : start + 4 + len(points)], int)


@pytest.mark.solver
@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.verify)])
def test_ids_are_the_facets_of_the_stl_file_also_under_mpi(tmp_path, ranks):
    """LIGGGHTS itself, a plate moving across the ranks: all ids count the facets of the STL file."""
    contacts, path = run_bed(tmp_path, ranks)
    travel = np.array([0.0, 0.2 * 5e-6, 0.0])  # m per step, bed_on_plate.in
    corners, ids = cells(path)
    expected = facets(tmp_path / "plate.stl")[ids] + travel * 6000
    np.testing.assert_allclose(corners, expected, rtol=0, atol=1e-7)  # m, six digits of the dump
    found = 0
    for one in contacts:
        triangle = facets(tmp_path / "plate.stl")[one.triangle] + travel * one.step
        edges = np.roll(triangle, -1, axis=1) - triangle
        to_point = one.contact_point[:, None] - triangle
        sides = edges[..., 0] * to_point[..., 1] - edges[..., 1] * to_point[..., 0]
        assert (sides > -1e-9).all()  # m2: inside, up to the dump's six digits
        found += one.triangle.size
    assert found > 20
    loads = read_mesh_loads(path, TRIANGLES)
    touched = np.unique(contacts[-1].triangle)
    np.testing.assert_array_equal(np.flatnonzero(loads["normal_stress_Pa"]), touched)


@pytest.mark.parametrize(
    ("old", "new"),
    [("CELL_DATA ", "CELL_DATA x"), ("meshid 1 24", "meshid 1 2x"), ("meshid 1 24", f"meshid 1 {10**20}")],
)
def test_numbers_of_values_that_are_none_name_the_file(tmp_path, old, new):
    """A flipped letter in a count is a sentence with the file's name."""
    text = (DATA / "bed_loads.vtk").read_text()
    assert old in text
    (tmp_path / "loads.vtk").write_text(text.replace(old, new, 1))
    with pytest.raises(MeshLoadsError, match=r"loads\.vtk: "):
        read_mesh_loads(tmp_path / "loads.vtk")


def test_a_missing_dump_names_itself(tmp_path):
    """So does a file that is not there."""
    with pytest.raises(MeshLoadsError, match=r"none\.vtk: the dump cannot be read"):
        read_mesh_loads(tmp_path / "none.vtk")
