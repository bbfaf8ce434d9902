"""A run of `benchmarks.peers` by Kratos DEM: `python kratos_bed.py`, in a folder with run.json and particles.csv.

`DEM_D_Hertz_viscous_Coulomb` between particles and with walls, which are rigid faces. Wear of the floor is Kratos' own:
severity over hardness, times normal force and sliding, over the area of the triangle, in its nodes.
"""

import json
from pathlib import Path

import KratosMultiphysics as Kratos
import KratosMultiphysics.DEMApplication as Dem
from KratosMultiphysics.DEMApplication.DEM_analysis_stage import DEMAnalysisStage
from samples import start, write_sample

NAME, SEARCH_EVERY = "bed", 20  # steps between two searches for neighbours
FOREVER = 1e6  # s
SKIN = 0.4e-3  # m, within which neighbours are looked for
FLOOR, SIDES = "Floor", "Sides"

run = json.loads(Path("run.json").read_text())
particles = [tuple(map(float, line.split(","))) for line in Path("particles.csv").read_text().splitlines()[1:]]


def block(head, lines):
    """Return a block of Kratos' model file."""
    return "\n".join([f"Begin {head}", *lines, f"End {head.split()[0]}", ""])


def part(name, nodes, kind, numbers, data=()):
    """Return the block of a part of the model; kind: of its members."""
    inner = [block("SubModelPartData", data), block("SubModelPartNodes", map(str, nodes))]
    return block(f"SubModelPart {name}", [*inner, block(f"SubModelPart{kind}", map(str, numbers))])


def write_spheres():
    """Write the model file of the particles."""
    numbers = range(1, len(particles) + 1)
    text = [
        block("Properties 1", []),
        block("Nodes", (f"{n} {x!r} {y!r} {z!r}" for n, (x, y, z, _) in zip(numbers, particles, strict=True))),
        block("Elements SphericParticle3D", (f"{n} 1 {n}" for n in numbers)),
        block("NodalData RADIUS", (f"{n} 0 {radius!r}" for n, (*_, radius) in zip(numbers, particles, strict=True))),
        part("Particles", numbers, "Elements", numbers),
    ]
    Path(f"{NAME}DEM.mdpa").write_text("\n".join(text))


def write_walls():
    """Write the model file of the floor, which moves, and of the four walls, each of two triangles."""
    points, triangles = list(run["points"]), [list(triangle) for triangle in run["triangles"]]
    side, top = run["half_width"], run["height"]
    corners = [(-side, -side), (side, -side), (side, side), (-side, side)]
    first, of_floor = len(points), len(triangles)
    points += [(x, y, z) for z in (0.0, top) for x, y in corners]
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        triangles += [[first + a, first + b, first + b + 4], [first + a, first + b + 4, first + a + 4]]
    moving = [
        f"LINEAR_VELOCITY [3] ({run['speed']!r}, 0.0, 0.0)",
        "RIGID_BODY_MOTION 1",
        "VELOCITY_START_TIME 0.0",
        f"VELOCITY_STOP_TIME {FOREVER}",
    ]
    faces = (f"{n} 2 {a + 1} {b + 1} {c + 1}" for n, (a, b, c) in enumerate(triangles, 1))
    text = [
        block("Properties 2", []),
        block("Nodes", (f"{n} {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(points, 1))),
        block("Conditions RigidFace3D3N", faces),
        part(FLOOR, range(1, first + 1), "Conditions", range(1, of_floor + 1), [] if run["dragged"] else moving),
        part(SIDES, range(first + 1, len(points) + 1), "Conditions", range(of_floor + 1, len(triangles) + 1)),
    ]
    Path(f"{NAME}DEM_FEM_boundary.mdpa").write_text("\n".join(text))


def write_materials():
    """Write the table of materials."""
    body = {"YOUNG_MODULUS": run["youngs_modulus"], "POISSON_RATIO": run["poissons_ratio"]}
    contact = {
        "COEFFICIENT_OF_RESTITUTION": run["restitution"],
        "STATIC_FRICTION": run["friction"],
        "DYNAMIC_FRICTION": run["friction"],
        "FRICTION_DECAY": 0.0,
        "ROLLING_FRICTION": 0.0,
        "ROLLING_FRICTION_WITH_WALLS": 0.0,
        "SEVERITY_OF_WEAR": run["archard"],
        "IMPACT_WEAR_SEVERITY": 0.0,
        "BRINELL_HARDNESS": 1.0,
        "DEM_DISCONTINUUM_CONSTITUTIVE_LAW_NAME": "DEM_D_Hertz_viscous_Coulomb",
        "DEM_ROLLING_FRICTION_MODEL_NAME": "DEMRollingFrictionModelConstantTorque",
    }
    kinds = {"particle": body | {"PARTICLE_DENSITY": run["density"]}, "wall": body | {"COMPUTE_WEAR": run["dragged"]}}
    pairs = [("particle", "particle"), ("particle", "wall")]
    numbers = {"particle": 1, "wall": 2}
    told = {
        "materials": [
            {"material_name": name, "material_id": numbers[name], "Variables": given} for name, given in kinds.items()
        ],
        "material_relations": [
            {"material_names_list": pair, "material_ids_list": [numbers[name] for name in pair], "Variables": contact}
            for pair in pairs
        ],
        "material_assignation_table": [["SpheresPart", "particle"], ["RigidFacePart", "wall"]],
    }
    Path("MaterialsDEM.json").write_text(json.dumps(told))


def settings():
    """Return the settings of the analysis."""
    return {
        "problem_name": NAME,
        "do_print_results_option": False,
        "dem_inlet_option": False,
        "GravityX": 0.0,
        "GravityY": 0.0,
        "GravityZ": 0.0 if run["dragged"] else -run["gravity"],
        "RotationOption": not run["dragged"],
        "TranslationalIntegrationScheme": "Velocity_Verlet",
        "RotationalIntegrationScheme": "Direct_Integration",
        "MaxTimeStep": run["time_step"],
        "FinalTime": run["steps"] * run["time_step"],
        "NeighbourSearchFrequency": SEARCH_EVERY,
        "SearchTolerance": SKIN,
        "search_tolerance_against_walls": SKIN,
        "PostRigidElementForces": True,
        "solver_settings": {
            "RemoveBallsInitiallyTouchingWalls": False,
            "strategy": "sphere_strategy",
            "model_import_settings": {"input_type": "mdpa", "input_filename": NAME},
            "material_import_settings": {"materials_filename": "MaterialsDEM.json"},
        },
    }


class Bed(DEMAnalysisStage):
    """The analysis, which writes samples and does nothing else between steps."""

    def Initialize(self):  # noqa: N802 (of Kratos)
        super().Initialize()
        self.done = 0
        if run["dragged"]:
            for node in self.spheres_model_part.Nodes:
                node.SetSolutionStepValue(Kratos.VELOCITY_X, run["speed"])
                for axis in "XYZ":
                    node.Fix(getattr(Kratos, f"VELOCITY_{axis}"))

    def KeepAdvancingSolutionLoop(self):  # noqa: N802 (of Kratos)
        return self.done < run["steps"]

    def OutputSolutionStep(self):  # noqa: N802 (of Kratos)
        self.done += 1
        if self.done % run["interval"] == 0:
            write_sample(self.done, self.rows(), self.force())
        if self.done == run["steps"] and run["dragged"]:
            Path("wear.json").write_text(json.dumps({"volume_m3": self.wear()}))

    def rows(self):
        """Return the states of the particles."""
        names = (Kratos.VELOCITY, Kratos.ANGULAR_VELOCITY)
        return [
            (node.Id, node.X, node.Y, node.Z, *(value for name in names for value in node.GetSolutionStepValue(name)))
            for node in self.spheres_model_part.Nodes
        ]

    def force(self):
        """Return the force of the particles on the floor."""
        nodes = self.rigid_face_model_part.GetSubModelPart(FLOOR).Nodes
        forces = [node.GetSolutionStepValue(Dem.CONTACT_FORCES) for node in nodes]
        return [sum(force[axis] for force in forces) for axis in range(3)]

    def wear(self):
        """Return the worn volume of the floor (m3); Kratos gives its nodes volume over the area of the triangle."""
        part = self.rigid_face_model_part.GetSubModelPart(FLOOR)
        area = next(iter(part.Conditions)).GetGeometry().Area()  # all triangles are alike
        return area * sum(node.GetSolutionStepValue(Dem.NON_DIMENSIONAL_VOLUME_WEAR) for node in part.Nodes)


start()
write_spheres()
write_walls()
write_materials()
Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
Bed(Kratos.Model(), Kratos.Parameters(json.dumps(settings()))).Run()
