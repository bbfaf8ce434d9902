"""Decks of a few spheres with a rolling model, on walls or on one another, and what the solver dumps of them."""

import numpy as np

from bulkwear.postproc.mesh import write_stl
from bulkwear.workflows.engine.solver import DECK, LEDGER_EXECUTABLE, run_deck
from tests.support.shapes import plate, shifted

RADII, DENSITY, COEFFICIENT, OVERLAP = (0.005, 0.008), 2500.0, 0.3, 1e-4  # m, kg/m3, -, m
MOMENT_OF_INERTIA = 0.4 * 4.0 / 3.0 * np.pi * RADII[0] ** 5 * DENSITY  # kg m2, of the smaller spheres
YOUNGS_MODULUS, POISSONS_RATIO = 1e7, 0.3  # Pa, -, of `HEAD`
SHEAR_MODULUS = YOUNGS_MODULUS / (2.0 * (1.0 + POISSONS_RATIO))  # Pa
EFFECTIVE_MODULUS = 0.5 * YOUNGS_MODULUS / (1.0 - POISSONS_RATIO**2)  # Pa, of two spheres, or of one and a wall
LONG = 5e-6  # s, a step that stops spins within hundreds
STOPPED, GROWTH = 1e-9, 1e-12  # rad/s, and relative: rounding
RESTARTED = 1e-9  # relative: rounding, which rolling does not amplify
GRAVITY = 9.81  # m/s2
HOLD = "fix hold all setforce 0.0 0.0 0.0\n"
HEAD = """\
units si
atom_style sphere
atom_modify map array sort 0 0
boundary f f f
newton off
communicate single vel yes
processors 1 {ranks} 1
region room block -0.5 0.5 -0.5 1.1 -0.1 0.1 units box
create_box 2 room
fix youngs_modulus all property/global youngsModulus peratomtype 1e7 1e7
fix poissons_ratio all property/global poissonsRatio peratomtype 0.3 0.3
fix restitution all property/global coefficientRestitution peratomtypepair 2 0.5 0.5 0.5 0.5
fix friction all property/global coefficientFriction peratomtypepair 2 {friction} {friction} {friction} {friction}
fix rolling all property/global coefficientRollingFriction peratomtypepair 2 0.3 0.3 0.3 0.3
pair_style gran model hertz tangential history rolling_friction {model}
pair_coeff * *
neighbor 0.002 bin
neigh_modify delay 0
timestep {step}
"""
WALL = "fix wall all wall/gran model hertz tangential history rolling_friction {model} "
WALLS = {
    "mesh": "fix plate all mesh/surface file plate.stl type 2\n" + WALL + "mesh n_meshes 1 meshes plate\n",
    "plane": WALL + "primitive type 2 zplane 0.0\n",
}
DUMP = "dump spins all custom {every} spins_*.dump id x fx fy fz tqx tqy tqz omegax omegay omegaz vx\n" + (
    'dump_modify spins sort id format "%d' + 11 * " %.15g" + '"\n'
)
FLOOR = shifted(plate(0.8, 0.8, 2), (-0.4, -0.4, 0.0))


def placed(centres, radii, spins):
    """Lines of a deck that place spheres: centres (n, 3) m, radii (n,) m, spins (n, 3) rad/s."""
    lines = []
    for number, (at, radius, spin) in enumerate(zip(centres, radii, spins, strict=True), start=1):
        lines.append("create_atoms 1 single {:.15g} {:.15g} {:.15g} units box".format(*at))
        lines.append(f"set atom {number} diameter {2.0 * radius} density {DENSITY}")
        lines.append("set atom {} omegax {:.15g} omegay {:.15g} omegaz {:.15g}".format(number, *spin))
    return "\n".join(lines) + "\n"


def simulated(folder, text, ranks=1, square=FLOOR):
    """What was dumped of a deck that is run: force, torque and spin, (times, n, 3) each, x and vx (times, n).

    square: its plate
    """
    folder.mkdir(exist_ok=True)
    write_stl(folder / "plate.stl", square.points, square.triangles)
    (folder / DECK).write_text(text)
    run_deck(folder, ranks, executable=LEDGER_EXECUTABLE)
    dumps = sorted(folder.glob("spins_*.dump"), key=lambda path: int(path.stem.split("_")[1]))
    rows = np.array([np.loadtxt(path, skiprows=9, ndmin=2) for path in dumps])
    vectors = {name: rows[..., at : at + 3] for name, at in (("force", 2), ("torque", 5), ("spin", 8))}
    return {"x": rows[..., 1], "vx": rows[..., 11]} | vectors


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def tangential(vectors, normal):
    return vectors - np.einsum("ij,ij->i", vectors, normal)[:, None] * normal


def slope_deck(model, slope, step, seconds, wall="mesh"):
    """A sphere at rest on a wall, gravity turned by a slope (-) about y; it lies as deep as its weight presses it."""
    radius, mass = RADII[0], 4.0 / 3.0 * np.pi * RADII[0] ** 3 * DENSITY
    angle = np.arctan(slope)
    deep = (0.75 * mass * GRAVITY * np.cos(angle) / (EFFECTIVE_MODULUS * np.sqrt(radius))) ** (2.0 / 3.0)
    steps = round(seconds / step)
    return (
        HEAD.format(model=model, step=step, friction=0.9, ranks=1)
        + placed([[0.0, 0.11, radius - deep]], [radius], [[0.0, 0.0, 0.0]])
        + WALLS[wall].format(model=model)
        + f"fix weight all gravity {GRAVITY} vector {np.sin(angle)} 0.0 {-np.cos(angle)}\nfix motion all nve/sphere\n"
        + f"{DUMP.format(every=steps // 2)}run {steps}\n"
    )
