"""Collisions of single particles with LIGGGHTS, in units of their size: does a scaled one do the same as a real one?

Coarse graining must not change them (Yan 2022, section 4.2). Units (Eq 4.6 and 4.7): lengths in the radius R,
velocities in sqrt(E*/rho), so times in R sqrt(rho/E*), forces in E* R^2, torques in E* R^3.

The parameters of a test, all SI: particle, wall_material, solver and deck as those of a bulk test (bulk_tests.py), and
collision with speed_m_per_s and sideways_speed_m_per_s, before contact.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.reference.collision import Collision, collision, reduced
from bulkwear.postproc.reference.sphere_contact import effective_modulus
from bulkwear.workflows.cases.sliding_sample.particle_size.study import by_scale
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.bulk_tests import bulk_materials, time_step
from bulkwear.workflows.engine.case import Parameters
from bulkwear.workflows.engine.derived import WALLS, derived_materials, youngs_modulus
from bulkwear.workflows.engine.solver import DECK, OWN_ROLLING_MODELS, executable_of, run_deck
from bulkwear.workflows.engine.templates import render

DUMP = "collision.dump"
COLUMNS = (
    *("id", "x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz"),
    *("fx", "fy", "fz", "tqx", "tqy", "tqz", "radius"),
)
# Collision -> its first sphere and the other one, None for the wall, as numbered in its template.
COLLISIONS = {"pair": (1, 2), "oblique pair": (3, 4), "wall": (5, None), "oblique wall": (6, None)}
DOWN = np.array([0.0, 0.0, -1.0])  # where the wall is
MODELS = ("cdt", "epsd2", *OWN_ROLLING_MODELS)  # rolling types A and C of LIGGGHTS, and those of our program
SPEEDS = {"speed_m_per_s": 1.0, "sideways_speed_m_per_s": 0.5}  # before contact: of beds at rest and in motion
EXACT_STEP = 0.002  # -, of the Rayleigh time: collisions are then within 0.1 % of the closed form
DRAWN_POINTS = 400  # of a collision's history
GAP_RADII = 0.005  # -, between the spheres at the start
DOMAIN_RADII = 10.0  # -, half the domain's width
AFTER = 1.1  # -, times the longest collision: all have parted
NUMBER_FORMAT = " ".join(["%.12g"] * (len(COLUMNS) - 1))


@dataclass(frozen=True)
class Spheres:
    """Two spheres and a wall, SI: radii, density, Young's moduli and Poisson's ratios; restitution of pair and wall."""

    radius: float
    smaller_radius: float
    density: float
    modulus: float
    poissons_ratio: float
    wall_modulus: float
    wall_poissons_ratio: float
    restitution: float
    wall_restitution: float

    def effective_modulus(self, kind: str) -> float:
        """Return E* (Pa) of a collision named in COLLISIONS."""
        wall = COLLISIONS[kind][1] is None
        other = (self.wall_modulus, self.wall_poissons_ratio) if wall else (self.modulus, self.poissons_ratio)
        return effective_modulus(self.modulus, self.poissons_ratio, *other)

    def units(self, kind: str) -> dict[str, float]:
        """Return the units (SI) of length, velocity, time, force, torque and spin of a collision."""
        modulus = self.effective_modulus(kind)
        velocity = math.sqrt(modulus / self.density)
        return {
            "length": self.radius,
            "velocity": velocity,
            "time": self.radius / velocity,
            "force": modulus * self.radius**2,
            "torque": modulus * self.radius**3,
            "spin": velocity / self.radius,
        }

    def closed_form(self, kind: str, speed: float) -> Collision:
        """Return the collision at a normal velocity (m/s) from its equation of motion; oblique ones as head-on ones."""
        wall = COLLISIONS[kind][1] is None
        other = math.inf if wall else self.smaller_radius
        mass, other_mass = (4.0 / 3.0 * math.pi * self.density * radius**3 for radius in (self.radius, other))
        restitution = self.wall_restitution if wall else self.restitution
        bodies = reduced(self.radius, other), reduced(mass, other_mass)
        return collision(speed, *bodies, self.effective_modulus(kind), restitution)

    def closed_forms(self, speed: float) -> dict[str, Collision]:
        """Return the closed form of every collision, without the oblique ones."""
        return {kind: self.closed_form(kind, speed) for kind in ("pair", "wall")}


# ---------------------------------------------------------------- with the solver


def collision_deck(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of collisions."""
    particle, asked = test["particle"], test["collision"]
    spheres, step = spheres_of(test), time_step(test)
    materials = derived_materials(bulk_materials({**test, "floor_material": test["wall_material"]}))
    integration = {**deck.integration(test, step, particle, 1), "gravity_m_per_s2": 0.0}
    integration.pop("report_steps")
    return {
        **integration,
        **deck.material_tables(particle, test["wall_material"], test["wall_material"], materials),
        "type_names": ["particle", "wall", "wall"],
        "ends": WALLS,
        "radius_m": spheres.radius,
        "smaller_radius_m": spheres.smaller_radius,
        "gap_m": GAP_RADII * spheres.radius,
        "speed_m_per_s": asked["speed_m_per_s"],
        "sideways_speed_m_per_s": asked["sideways_speed_m_per_s"],
        "spin_rad_per_s": asked["sideways_speed_m_per_s"] / spheres.radius,
        "half_width_m": DOMAIN_RADII * spheres.radius,
        "density_kg_per_m3": particle["density_kg_per_m3"],
        "number_format": NUMBER_FORMAT,
        "collision_steps": deck.steps(AFTER * _longest(test), step),
    }


def spheres_of(test: Mapping[str, Any]) -> Spheres:
    """Return what is known of a test: the median particle, the smallest one, and the wall."""
    particle, wall = test["particle"], test["wall_material"]
    return Spheres(
        radius=particle["median_diameter_m"] / 2.0,
        smaller_radius=min(particle["diameters_m"]) / 2.0,
        density=particle["density_kg_per_m3"],
        modulus=youngs_modulus(particle["shear_modulus_pa"], particle["poissons_ratio"]),
        poissons_ratio=particle["poissons_ratio"],
        wall_modulus=youngs_modulus(wall["shear_modulus_pa"], wall["poissons_ratio"]),
        wall_poissons_ratio=wall["poissons_ratio"],
        restitution=particle["contact"]["restitution"],
        wall_restitution=wall["contact"]["restitution"],
    )


def _longest(test: Mapping[str, Any]) -> float:
    """Return how long (s) it takes from the start until all have parted."""
    speed = test["collision"]["speed_m_per_s"]
    lasting = [each.time[-1] for each in spheres_of(test).closed_forms(speed).values()]
    return GAP_RADII * test["particle"]["median_diameter_m"] / 2.0 / speed + max(lasting)


def simulate(test: Mapping[str, Any], folder: Path) -> Path:
    """Run a test in a folder and return the path of its dump. Raises SolverError."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DECK).write_text(render("collision", collision_deck(test)))
    run_deck(folder, executable=executable_of(test))
    return folder / DUMP


# ---------------------------------------------------------------- what collisions left


def read_collisions(path: str | Path, spheres: Spheres, time_step: float) -> pd.DataFrame:
    """Return the history of every collision of a dump, from the step before contact to the one after it.

    time_step: s. Columns collision, then without unit (units as above): time (0 at the first step in contact), overlap,
    approach (velocity along the contact's normal), normal_force (repelling), tangential_force (magnitude), torque
    (magnitude, about the first sphere's centre), spin (magnitude, of the first sphere).
    Raises ContactDumpError for a damaged dump.
    """
    from bulkwear.postproc.readers.dump_text import read_frames  # slow to import, and every start reads the page

    batches = list(read_frames(path, "ATOMS", ("id",)))
    steps = np.concatenate([batch.steps for batch in batches])
    frames = np.concatenate([batch.table for batch in batches]).reshape(len(steps), -1, len(COLUMNS))
    tables = [
        _history(kind, frames, steps * time_step, spheres.units(kind)).assign(collision=kind) for kind in COLLISIONS
    ]
    return pd.concat(tables, ignore_index=True)


def _history(kind: str, frames: np.ndarray, time: np.ndarray, units: Mapping[str, float]) -> pd.DataFrame:
    first, other = COLLISIONS[kind]
    place, velocity, spin, force, torque = (_vectors(frames, first, start) for start in (1, 4, 7, 10, 13))
    reach = frames[:, first - 1, -1]
    if other is None:
        normal, distance, relative = DOWN, place[:, 2], velocity
    else:
        between = _vectors(frames, other, 1) - place
        distance = np.linalg.norm(between, axis=1)
        normal, relative = between / distance[:, None], velocity - _vectors(frames, other, 4)
        reach = reach + frames[:, other - 1, -1]
    normal_force = -(force * normal).sum(axis=1)
    table = pd.DataFrame(
        {
            "time": time / units["time"],
            "overlap": (reach - distance) / units["length"],
            "approach": (relative * normal).sum(axis=1) / units["velocity"],
            "normal_force": normal_force / units["force"],
            "tangential_force": np.linalg.norm(force + normal_force[:, None] * normal, axis=1) / units["force"],
            "torque": np.linalg.norm(torque, axis=1) / units["torque"],
            "spin": np.linalg.norm(spin, axis=1) / units["spin"],
        }
    )
    touching = np.flatnonzero(table["overlap"] > 0.0)
    table = table.iloc[max(touching[0] - 1, 0) : touching[-1] + 2]
    return table.assign(time=table["time"] - table["time"].iloc[1]).reset_index(drop=True)


def _vectors(frames: np.ndarray, sphere: int, start: int) -> np.ndarray:
    return frames[:, sphere - 1, start : start + 3]


def collision_measures(histories: pd.DataFrame) -> pd.DataFrame:
    """Return one row per collision with what coarse graining must keep; units as in `read_collisions`.

    Columns collision, restitution (-), largest_overlap, largest_force, largest_tangential_force, largest_torque,
    spin_after, duration.
    """
    rows = []
    for kind, table in histories.groupby("collision", sort=False):
        rows.append(
            {
                "collision": kind,
                "restitution": -table["approach"].iloc[-1] / table["approach"].iloc[0],
                "largest_overlap": table["overlap"].max(),
                "largest_force": table["normal_force"].max(),
                "largest_tangential_force": table["tangential_force"].max(),
                "largest_torque": table["torque"].max(),
                "spin_after": table["spin"].iloc[-1],
                "duration": table["time"].iloc[-2] - table["time"].iloc[1],
            }
        )
    return pd.DataFrame(rows)


def dimensionless(closed: Collision, units: Mapping[str, float]) -> pd.DataFrame:
    """Return a closed form in the columns time, overlap, approach and normal_force of `read_collisions`."""
    return pd.DataFrame(
        {
            "time": closed.time / units["time"],
            "overlap": closed.overlap / units["length"],
            "approach": closed.approach / units["velocity"],
            "normal_force": closed.force / units["force"],
        }
    )


def spread_over_scales(measures: pd.DataFrame) -> pd.DataFrame:
    """Return how far collisions differ between particle scales: rolling_friction, collision, measure, spread (-).

    measures: as from `collision_measures`, with particle_scale and rolling_friction. Spread: largest minus smallest
    over the largest magnitude; measures that are zero throughout are left out.
    """
    keys = ["rolling_friction", "collision"]
    long = measures.melt(id_vars=[*keys, "particle_scale"], var_name="measure").groupby([*keys, "measure"], sort=False)
    range_, most = long["value"].max() - long["value"].min(), long["value"].agg(lambda values: values.abs().max())
    return (range_[most > 0.0] / most[most > 0.0]).rename("spread").reset_index()


# ---------------------------------------------------------------- the collisions of a study


def collision_tests(runs: Mapping[str, Parameters]) -> list[dict[str, Any]]:
    """Return collisions of a study's particles with each other and its sample, of all scales and rolling models; of
    LIGGGHTS' own ones alone where the study has one of these, for it may run on any LIGGGHTS.
    """
    own = {run["solver"]["rolling_friction"] for run in runs.values()} & {*OWN_ROLLING_MODELS}
    return [
        {
            "particle": run["particle"],
            "wall_material": run["sample_material"],
            "solver": {**run["solver"], "rayleigh_fraction": EXACT_STEP, "rolling_friction": model},
            "deck": run["deck"],
            "collision": SPEEDS,
        }
        for model in MODELS
        if own or model not in OWN_ROLLING_MODELS
        for run in by_scale(runs).values()
    ]


def collision_tables(tests: Sequence[Mapping[str, Any]], folder: Path) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Simulate collisions; return their histories, thinned out, and their measures."""
    histories, measures = [], []
    for test in tests:
        model, scale = test["solver"]["rolling_friction"], test["particle"]["scale"]
        names = {"rolling_friction": model, "particle_scale": scale}
        dump = simulate(test, folder / f"{model}_{scale:g}")
        found = read_collisions(dump, spheres_of(test), time_step(test))
        dump.unlink()  # 10 MB, and one second makes it again
        measures.append(collision_measures(found).assign(**names))
        every = [one.iloc[:: max(len(one) // DRAWN_POINTS, 1)] for _, one in found.groupby("collision", sort=False)]
        histories.append(pd.concat(every).assign(**names))
    return pd.concat(histories, ignore_index=True), pd.concat(measures, ignore_index=True)


def closed_forms(test: Mapping[str, Any]) -> dict[str, pd.DataFrame]:
    """Return the closed form of every head-on collision of a test without unit, see `dimensionless`."""
    spheres = spheres_of(test)
    forms = spheres.closed_forms(test["collision"]["speed_m_per_s"])
    return {kind: dimensionless(form, spheres.units(kind)) for kind, form in forms.items()}
