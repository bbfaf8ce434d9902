"""Decks of `benchmarks.peers` for LIGGGHTS, with and without our ledger, and for LAMMPS."""

from __future__ import annotations

import numpy as np

from benchmarks.peer_case import FORCES, RADII, STATE_COLUMNS, STATES, PeerRun

SKIN = 0.4e-3  # m
FILL = "filled.dump"
LIGGGHTS_MODEL = "hertz tangential history"
LIMIT = "limitForce on"  # no damping pulls, as in LAMMPS' limit_damping, in Yade and in Kratos
LEDGER_FILE = "load_ledger.bin"
SEEDS = (15485863, 15485867, 32452843, 32452867, 49979687)  # bed, mixture, sizes; LIGGGHTS wants primes, all other


def liggghts_head(run: PeerRun) -> list[str]:
    """Return the lines before the particles: box, materials, contact law."""
    side, pair = run.domain_side, "peratomtypepair 1"
    return [
        "units si",
        "atom_style granular",
        "atom_modify map array",
        "boundary f f f",
        "newton off",
        "communicate single vel yes",
        f"region box block -{side} {side} -{side} {side} -0.002 {run.height} units box",
        "create_box 1 box",
        f"neighbor {SKIN} bin",
        "neigh_modify delay 0",
        f"fix youngs_modulus all property/global youngsModulus peratomtype {run.youngs_modulus}",
        f"fix poissons_ratio all property/global poissonsRatio peratomtype {run.poissons_ratio}",
        f"fix restitution all property/global coefficientRestitution {pair} {run.restitution}",
        f"fix friction all property/global coefficientFriction {pair} {run.friction}",
        f"fix finnie all property/global k_finnie {pair} {run.archard}",
        f"pair_style gran model {LIGGGHTS_MODEL} {LIMIT}",
        "pair_coeff * *",
        f"timestep {run.time_step:.17g}",
    ]


def liggghts_walls(run: PeerRun) -> list[str]:
    """Return the four walls at rest; the floor is a mesh."""
    return [
        f"fix wall_{axis}{number} all wall/gran model {LIGGGHTS_MODEL} primitive type 1 {axis}plane {place} {LIMIT}"
        for axis in "xy"
        for number, place in enumerate((-run.half_width, run.half_width))
    ]


def filling_deck(run: PeerRun, count: int, steps: int) -> str:
    """Return the deck that lets `count` particles fall and come to rest; leaves `FILL`."""
    inside = run.half_width - RADII[-1]
    each = [
        f"fix template_{number} all particletemplate/sphere {SEEDS[2 + number]} atom_type 1"
        f" density constant {run.density} radius constant {radius}"
        for number, radius in enumerate(RADII)
    ]
    shares = np.array(RADII) ** 3 / (np.array(RADII) ** 3).sum()  # of the mass: as many of each
    mixed = " ".join(f"template_{number} {share:.9g}" for number, share in enumerate(shares))
    lines = [
        *liggghts_head(run),
        *each,
        f"fix mixture all particledistribution/discrete {SEEDS[1]} {len(RADII)} {mixed}",
        f"region fill block -{inside} {inside} -{inside} {inside} {RADII[-1]} {run.height - RADII[-1]} units box",
        f"fix fill all insert/pack seed {SEEDS[0]} distributiontemplate mixture insert_every once"
        f" overlapcheck yes all_in yes particles_in_region {count} region fill",
        *liggghts_walls(run),
        f"fix floor all wall/gran model {LIGGGHTS_MODEL} primitive type 1 zplane 0.0 {LIMIT}",
        f"fix gravity all gravity {run.gravity} vector 0. 0. -1.",
        "fix slow all viscous 1e-3",
        "fix motion all nve/sphere",
        f"dump rest all custom {steps} {FILL} id x y z radius",
        'dump_modify rest format "%d %.17g %.17g %.17g %.17g"',
        f"run {steps}",
    ]
    return "\n".join(lines) + "\n"


def motion(run: PeerRun) -> list[str]:
    """Return how particles move; after the walls, since forces on dragged ones are taken from them last."""
    if run.dragged:
        return [
            f"velocity all set {run.speed} 0.0 0.0 units box",
            "fix motion all nve",
            "fix guide all setforce 0.0 0.0 0.0",
        ]
    return [f"fix gravity all gravity {run.gravity} vector 0. 0. -1.", "fix motion all nve/sphere"]


def liggghts_deck(run: PeerRun, ledger: bool) -> str:
    """Return the deck of a run; ledger: with ours."""
    mesh = "mesh/surface/stress file floor.stl type 1"
    pull = [f"fix pull all move/mesh mesh floor linear {run.speed} 0. 0."]
    lines = [
        *liggghts_head(run),
        "read_data particles.data add",
        f"fix floor all {mesh} wear finnie" if run.dragged else f"fix floor all {mesh}",
        f"fix floor_wall all wall/gran model {LIGGGHTS_MODEL} mesh n_meshes 1 meshes floor {LIMIT}",
        *liggghts_walls(run),
        *([] if run.dragged else pull),
        *motion(run),
        *([f"fix load_ledger all load/ledger mesh floor file {LEDGER_FILE}"] if ledger else []),
        *outputs(run, "f_floor[1]", "f_floor[2]", "f_floor[3]"),
        *([f"dump wear all mesh/vtk {run.steps} loads_*.vtk stress wear id floor"] if run.dragged else []),
        f"run {run.steps}",
    ]
    return "\n".join(lines) + "\n"


def outputs(run: PeerRun, *force: str, word: str = "") -> list[str]:
    """Return the lines that write states and the force on the floor.

    force: of the input language, x, y, z; word: that stands before the format of all of a dump's columns
    """
    form = "%d" + " %.17g" * (len(STATE_COLUMNS) - 1)
    told = "${now} ${floor_x} ${floor_y} ${floor_z}"
    values = [f"variable floor_{axis} equal {each}" for axis, each in zip("xyz", force, strict=True)]
    return [
        *values,
        "variable now equal step",
        f'fix forces all print {run.interval} "{told}" file {FORCES} screen no',
        f"thermo {run.interval}",
        "thermo_style custom step atoms ke v_floor_x v_floor_z",
        f"dump states all custom {run.interval} {STATES} {' '.join(STATE_COLUMNS)}",
        f'dump_modify states sort id format {word}"{form}"',
    ]


def particle_data(run: PeerRun, particles: np.ndarray) -> str:
    """Return the data file of particles (n, 4), read by LIGGGHTS and LAMMPS alike."""
    side = run.domain_side
    atoms = [
        f"{number} 1 {2.0 * radius:.17g} {run.density} {x:.17g} {y:.17g} {z:.17g}"
        for number, (x, y, z, radius) in enumerate(particles, 1)
    ]
    return "\n".join(
        [
            "particles",
            "",
            f"{len(particles)} atoms",
            "1 atom types",
            "",
            *(f"{-side} {side} {axis}lo {axis}hi" for axis in "xy"),
            f"-0.002 {run.height} zlo zhi",
            "",
            "Atoms",
            "",
            *atoms,
            "",
        ]
    )


def lammps_deck(run: PeerRun) -> str:
    """Return the deck of a bed for LAMMPS; its floor is a plane that shears, as this version has no mesh for it."""
    side = run.half_width
    law = (
        f"hertz/material {run.youngs_modulus} {run.restitution} {run.poissons_ratio}"
        f" tangential mindlin NULL {run.tangential_damping:.12g} {run.friction} damping coeff_restitution limit_damping"
    )
    lines = [
        "units si",
        "atom_style sphere",
        "boundary f f f",
        "newton off",
        "comm_modify vel yes",
        "read_data particles.data",
        f"neighbor {SKIN} bin",
        "neigh_modify delay 0",
        "pair_style granular",
        f"pair_coeff * * {law}",
        f"timestep {run.time_step:.17g}",
        f"fix floor_wall all wall/gran granular {law} zplane 0.0 NULL shear x {run.speed} contacts",
        *(f"fix wall_{axis} all wall/gran granular {law} {axis}plane {-side} {side}" for axis in "xy"),
        *motion(run),
        "compute on_particles all reduce sum f_floor_wall[2] f_floor_wall[3] f_floor_wall[4]",
        *outputs(run, *(f"-c_on_particles[{number}]" for number in (1, 2, 3)), word="line "),
        f"run {run.steps}",
    ]
    return "\n".join(lines) + "\n"
