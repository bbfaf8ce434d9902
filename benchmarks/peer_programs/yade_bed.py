"""A run of `benchmarks.peers` by Yade: `yade -n -x -j1 yade_bed.py`, in a folder with run.json and particles.csv.

Hertz-Mindlin with `Law2_ScGeom_MindlinPhys_Mindlin`. Yade takes the reduced radius of a sphere on a facet as half the
sphere's; the walls' modulus is raised so that the normal force is that of the whole radius all the same.
"""

import json
import math
import sys
from pathlib import Path

from yade import Vector3, utils
from yade.wrapper import (
    Bo1_Facet_Aabb,
    Bo1_Sphere_Aabb,
    Bo1_Wall_Aabb,
    ForceResetter,
    FrictMat,
    Ig2_Facet_Sphere_ScGeom,
    Ig2_Sphere_Sphere_ScGeom,
    Ig2_Wall_Sphere_ScGeom,
    InsertionSortCollider,
    InteractionLoop,
    Ip2_FrictMat_FrictMat_MindlinPhys,
    Law2_ScGeom_MindlinPhys_Mindlin,
    NewtonIntegrator,
    Omega,
)

sys.path.insert(0, str(Path.cwd()))
from samples import start, write_sample

SKIN = 0.2e-3  # m, half of that of the other codes: Yade's is on both sides of a pair
STIFFER = 1.0 / (math.sqrt(2.0) - 1.0)  # -, walls over particles: their pair has sqrt(2) times the E* of two particles

run = json.loads(Path("run.json").read_text())
start()
scene = Omega()
angle = math.atan(run["friction"])
kinds = {
    name: FrictMat(
        young=factor * run["youngs_modulus"],
        poisson=run["poissons_ratio"],
        density=run["density"],
        frictionAngle=angle,
        label=name,
    )
    for name, factor in {"particle": 1.0, "wall": STIFFER}.items()
}
for kind in kinds.values():
    scene.materials.append(kind)
balls = []
for line in Path("particles.csv").read_text().splitlines()[1:]:
    *centre, radius = map(float, line.split(","))
    balls.append(scene.bodies.append(utils.sphere(centre, radius, material="particle")))
facets = [
    scene.bodies.append(utils.facet([run["points"][corner] for corner in triangle], material="wall"))
    for triangle in run["triangles"]
]
for axis in (0, 1):
    for place in (-run["half_width"], run["half_width"]):
        scene.bodies.append(utils.wall(place, axis, material="wall"))
for facet in facets:
    scene.bodies[facet].state.vel = (run["speed"], 0.0, 0.0)
scene.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb(), Bo1_Wall_Aabb()], verletDist=SKIN),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_MindlinPhys(en=run["restitution"], es=run["restitution"])],
        [Law2_ScGeom_MindlinPhys_Mindlin()],
    ),
    NewtonIntegrator(damping=0.0, gravity=(0.0, 0.0, -run["gravity"])),
]
scene.dt = run["time_step"]
for sample in range(1, run["samples"] + 1):
    scene.run(run["interval"], True)
    states = [scene.bodies[ball].state for ball in balls]
    rows = [(ball + 1, *state.pos, *state.vel, *state.angVel) for ball, state in zip(balls, states, strict=True)]
    write_sample(sample * run["interval"], rows, sum((scene.forces.f(facet) for facet in facets), Vector3(0, 0, 0)))
