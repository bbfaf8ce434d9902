"""Forces that a run starts with: contacts that slide keep to their limit of friction, as at every other step."""

import subprocess

import numpy as np
import pytest

from bulkwear.workflows.engine.solver import BUILT, solver_environment

pytestmark = pytest.mark.solver

RADIUS, SPACING, DENSITY = 5e-3, 0.012, 2650.0  # m, m, kg/m3
ROWS = 8  # spheres along each side of the square in which they lie
FRICTION, VELOCITY = 0.38, 2.0  # -, m/s
GRAVITY = 5000.0  # m/s2: a sphere stays on the round top of another as it goes over it
YOUNG, POISSON = 5e8, 0.3  # Pa, -
SLIDE = 200  # steps to the second run: until then every contact has its tangential spring at the limit
ROUNDING = 1e-9  # relative
ABOVE = 2.0  # times its limit: what the damping of such a sliding exceeds by far where nothing limits it
MASS = DENSITY * 4.0 / 3.0 * np.pi * RADIUS**3  # kg
SURFACES = {
    "mesh": [
        "fix plate all mesh/surface file plate.stl type 2",
        "fix walls all wall/gran model hertz tangential history mesh n_meshes 1 meshes plate",
    ],
    "primitive": ["fix walls all wall/gran model hertz tangential history primitive type 2 zplane 0."],
    "particles": ["group below type 2", "fix held below freeze"],
}
DECK = """\
units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
read_data spheres.data
neighbor 0.001 bin
neigh_modify delay 0 exclude type 1 1
fix youngs_modulus all property/global youngsModulus peratomtype {young} {young}
fix poissons_ratio all property/global poissonsRatio peratomtype {poisson} {poisson}
fix restitution all property/global coefficientRestitution peratomtypepair 2 0.5 0.5 0.5 0.5
fix friction all property/global coefficientFriction peratomtypepair 2 {friction} {friction} {friction} {friction}
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1e-6
group sliding type 1
velocity sliding set {velocity} 0. 0. units box
fix gravity all gravity {gravity} vector 0. 0. -1.
fix motion sliding nve/sphere
{surface}
run {slide}
dump forces sliding custom 1 forces.dump id x y z fx fy fz
dump_modify forces format "%d{digits}"
run 0
"""
PLATE = """\
solid plate
facet normal 0 0 1
outer loop
vertex -0.19 -0.19 0
vertex 0.19 -0.19 0
vertex 0.19 0.19 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex -0.19 -0.19 0
vertex 0.19 0.19 0
vertex -0.19 0.19 0
endloop
endfacet
endsolid plate
"""


def below() -> np.ndarray:
    """Centres (n, 3) m of the spheres that are held."""
    x, y = (SPACING * (axis.ravel() - 0.5 * ROWS) for axis in np.meshgrid(*2 * [np.arange(ROWS)]))
    return np.column_stack([x, y, np.full(x.size, -RADIUS)])


def data(surface: str) -> str:
    """Spheres that press by more and by less than their weight, so that they rise and sink; below them others, held."""
    held = below()
    modulus = YOUNG / (2.0 * (1.0 - POISSON**2))
    at_rest = (MASS * GRAVITY / (4.0 / 3.0 * modulus * np.sqrt(RADIUS))) ** (2.0 / 3.0)  # m, Hertz
    overlap = at_rest * np.random.default_rng(1).uniform(0.3, 2.0, len(held))
    spheres = [(1, *place) for place in held + np.outer(2.0 * RADIUS - overlap, [0.0, 0.0, 1.0])]
    if surface == "particles":
        spheres += [(2, *place) for place in held]
    lines = [f"{k} {kind} {2 * RADIUS} {DENSITY} {x} {y} {z}" for k, (kind, x, y, z) in enumerate(spheres, start=1)]
    box = [f"-0.2 0.2 {axis}lo {axis}hi" for axis in "xyz"]
    return "\n".join(["spheres", "", f"{len(lines)} atoms", "2 atom types", "", *box, "", "Atoms", "", *lines, ""])


def over_limit(program: str, folder, surface: str) -> np.ndarray:
    """Tangential force over its limit at the start of a second run, per sphere."""
    (folder / "spheres.data").write_text(data(surface))
    (folder / "plate.stl").write_text(PLATE)
    lines = "\n".join(SURFACES[surface])
    words = {"friction": FRICTION, "velocity": VELOCITY, "gravity": GRAVITY, "surface": lines, "slide": SLIDE}
    words |= {"young": YOUNG, "poisson": POISSON, "digits": 6 * " %.17g"}
    (folder / "deck.in").write_text(DECK.format(**words))
    run = [program, "-in", "deck.in"]
    subprocess.run(run, cwd=folder, env=solver_environment(), check=True, capture_output=True)
    found = np.loadtxt(folder / "forces.dump", skiprows=9)
    found = found[np.argsort(found[:, 0])]
    position, force = found[:, 1:4], found[:, 4:] + [0.0, 0.0, MASS * GRAVITY]
    apart = position - below() if surface == "particles" else np.array([[0.0, 0.0, 1.0]])
    direction = apart / np.linalg.norm(apart, axis=1)[:, None]
    normal = np.sum(force * direction, axis=1)
    assert np.all(normal > 0.0)
    return np.linalg.norm(force - normal[:, None] * direction, axis=1) / (FRICTION * normal)


@pytest.mark.parametrize("surface", SURFACES)
def test_friction_keeps_to_its_limit(tmp_path, surface):
    """Also of spheres that rise and sink, whose springs stand on either side of the limit."""
    assert over_limit(str(BUILT), tmp_path, surface) == pytest.approx(1.0, rel=ROUNDING)


@pytest.mark.parametrize("surface", SURFACES)
def test_the_plain_program_adds_damping_without_a_limit(tmp_path, surface):
    """What ours is there for: where the plain program changes, ours is not needed any more."""
    assert np.any(over_limit("liggghts", tmp_path, surface) > ABOVE)
