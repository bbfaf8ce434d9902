"""A sphere that overlaps a sharp edge of a mesh is pushed off it, whatever the triangles at the edge look like."""

import subprocess

import numpy as np
import pytest

from bulkwear.meshes.tester import sample_block
from bulkwear.postproc.mesh import write_stl

pytestmark = pytest.mark.solver

SIDE, THICKNESS, SIZE, HOLDER = 0.04, 0.005, 2e-3, 0.01  # m; a rim of small elements over a coarse holder: obtuse ones
RADIUS = 4.24e-3  # m
YOUNG, POISSON = (1.736e8, 7.884e8), (0.24, 0.46)  # Pa and -, of sphere and wall
PER_EDGE = 100
HERTZ = 1e-3  # relative; digits of the dump and of the STL
DECK = f"""\
units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
read_data spheres.data
neighbor 0.002 bin
neigh_modify delay 0 exclude type 1 1 one 20000 page 1000000
fix youngs_modulus all property/global youngsModulus peratomtype {YOUNG[0]} {YOUNG[1]}
fix poissons_ratio all property/global poissonsRatio peratomtype {POISSON[0]} {POISSON[1]}
fix restitution all property/global coefficientRestitution peratomtypepair 2 0.5 0.5 0.5 0.5
fix friction all property/global coefficientFriction peratomtypepair 2 0.4 0.4 0.4 0.4
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1e-9
fix block all mesh/surface/stress file block.stl type 2
fix walls all wall/gran model hertz tangential history mesh n_meshes 1 meshes block
fix motion all nve/sphere
dump forces all custom 1 forces_*.dump id fx fy fz
run 1
"""


def spheres_at_the_rim():
    """Centres (n, 3) m and distances (n,) m of spheres that lie over the rim of the block's top, between the planes of
    top and side, so that the edge is what they touch; the corners are kept off.
    """
    generator = np.random.default_rng(3)
    along = generator.uniform(RADIUS - 0.5 * SIDE, 0.5 * SIDE - RADIUS, 4 * PER_EDGE)
    distance = RADIUS * generator.uniform(0.5, 0.95, along.size)
    angle = generator.uniform(0.05, 0.45, along.size) * np.pi
    outwards, up = 0.5 * SIDE + distance * np.cos(angle), distance * np.sin(angle)
    edge = np.arange(along.size) % 4
    x = np.choose(edge, [outwards, -outwards, along, along])
    y = np.choose(edge, [along, along, outwards, -outwards])
    return np.column_stack([x, y, up]), distance


def test_every_sphere_feels_the_edge(tmp_path):
    """The force is Hertz' for the overlap with the edge; a contact that the solver misses would be none at all."""
    block = sample_block(SIDE, SIDE, THICKNESS, SIZE, None, HOLDER)
    write_stl(tmp_path / "block.stl", block.points, block.triangles)
    centres, distance = spheres_at_the_rim()
    rows = [f"{number} 1 {2 * RADIUS} 2650 {x} {y} {z}" for number, (x, y, z) in enumerate(centres, start=1)]
    head = ["spheres", "", f"{len(rows)} atoms", "2 atom types", ""]
    box = [f"-0.1 0.1 {axis}lo {axis}hi" for axis in "xyz"]
    (tmp_path / "spheres.data").write_text("\n".join([*head, *box, "", "Atoms", "", *rows, ""]))
    (tmp_path / "deck.in").write_text(DECK)
    subprocess.run(["liggghts", "-in", "deck.in"], cwd=tmp_path, check=True, capture_output=True)
    found = np.loadtxt(tmp_path / "forces_1.dump", skiprows=9)
    force = np.linalg.norm(found[np.argsort(found[:, 0]), 1:], axis=1)
    stiffness = 1.0 / sum((1.0 - nu**2) / modulus for modulus, nu in zip(YOUNG, POISSON, strict=True))
    hertz = 4.0 / 3.0 * stiffness * np.sqrt(RADIUS) * (RADIUS - distance) ** 1.5
    assert force == pytest.approx(hertz, rel=HERTZ)
