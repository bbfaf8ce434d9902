"""What the tests of the pin-on-disc decks share: their parameters, a pin set down, and arcs of its track."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bulkwear.meshes.disc import track_disc, track_stretch
from bulkwear.postproc.mesh import SurfaceMesh, write_stl
from bulkwear.postproc.readers.load_ledger import LoadLedger, read_load_ledger
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.postproc.reference.sphere_contact import stable_time_step, touching_reach
from bulkwear.workflows.engine.derived import rayleigh_time, youngs_modulus
from bulkwear.workflows.engine.templates import render
from tests.verification.groove_cases import touching_height
from tests.verification.ledger_cases import DENSITY, LOAD, MASS, RADIUS, effective_modulus, hertz_overlap, run

TRACK_RADIUS = 0.022  # m; this and what follows: Yan 2022, Table 5.2 and section 5.4.1
DISC_RADIUS, INNER_RADIUS = 0.024, 0.020  # m; nothing inside the inner one is touched
ANGULAR_VELOCITY = math.radians(180.0)  # rad/s
TIME_STEP = 1.4e-5  # s
PIN, DISC = {"shear_modulus": 0.1e9, "poissons_ratio": 0.24}, {"shear_modulus": 78e9, "poissons_ratio": 0.3}  # Pa, -
RAYLEIGH_FRACTION = 0.2  # -, of the time steps where the source gives none
FRICTION, RESTITUTION = 1.0, 0.5  # -; the table names a restitution without its value: an assumption
BAND = 0.5e-3  # m, half the width of the fine band
SETTLING_TIME = 0.014  # s; the pin's oscillation of 0.34 ms has lost all but 1e-20 of itself

COLUMNS = range(1, 19)  # of the dump of contacts
SOLVER = {
    **{"contact_model": "hertz", "cohesion": "none", "rolling_friction": "cdt", "rolling_radius": "full"},
    "sampling_interval_steps": 1,
}
LEDGERS = {
    "solver": {"ledger_history": "", "ledger_kernels": ""},
    "dumps": {
        "contact_columns": " ".join(f"c_wall_contact[{k}]" for k in COLUMNS),
        "contact_format": " ".join("%.12g" for _ in COLUMNS),
    },
}


@dataclass(frozen=True)
class PinCase:
    """A pin and how it is taken round, SI; the defaults are those of Yan 2022, chapter 5."""

    track_radius: float = TRACK_RADIUS
    pin_radius: float = RADIUS
    density: float = DENSITY
    load: float = LOAD
    angular_velocity: float = ANGULAR_VELOCITY
    time_step: float = TIME_STEP
    restitution: float = RESTITUTION
    friction: float = FRICTION
    rest_steps: int = 200

    @property
    def steps_per_turn(self) -> int:
        """Whole steps of a revolution, at least; `exact` makes the time step fit them (1e-9 forgives rounding)."""
        return math.ceil(2.0 * math.pi / (self.angular_velocity * self.time_step) - 1e-9)

    def exact(self) -> PinCase:
        """The same with the largest time step, not above the present one, of which a turn has a whole number."""
        return replace(self, time_step=2.0 * math.pi / (self.angular_velocity * self.steps_per_turn))

    def load_times_distance(self, steps: int) -> float:
        """Work (J) of the load over the arc of that many steps."""
        return self.load * self.track_radius * self.angular_velocity * self.time_step * steps


def disc(element_size: float, band: float = BAND) -> SurfaceMesh:
    """The unworn disc of chapter 5 with that element size (m) to `band` (m) on either side of the track."""
    return track_disc(TRACK_RADIUS, INNER_RADIUS, DISC_RADIUS, element_size, band)


def groove(mesh: SurfaceMesh, profile: Callable[[np.ndarray], np.ndarray]) -> SurfaceMesh:
    """The disc with a groove: profile takes distances (m) from the track and returns depths (m), above 0 in it."""
    across = np.hypot(mesh.points[:, 0], mesh.points[:, 1]) - TRACK_RADIUS
    return SurfaceMesh(np.column_stack([mesh.points[:, :2], -np.maximum(profile(across), 0.0)]), mesh.triangles)


def round_groove(mesh: SurfaceMesh, depth: float) -> SurfaceMesh:
    """The disc with a groove of the pin's own radius, `depth` (m) deep."""
    return groove(mesh, lambda across: np.sqrt(RADIUS**2 - across**2) - (RADIUS - depth))


def worn_groove(mesh: SurfaceMesh) -> SurfaceMesh:
    """The disc with a shallow groove as after twelve revolutions at 1.7e-11 1/Pa: 2.2 um deep, 0.7 mm wide."""
    return groove(mesh, lambda across: 2.2e-6 * (1.0 - (across / 0.35e-3) ** 2))


def common(case: PinCase, cycle: int, report_steps: int) -> dict:
    """Parameters of both decks."""
    pair = lambda value: [[value, value], [value, value]]  # noqa: E731
    fraction = case.time_step / rayleigh_time(case.pin_radius, case.density, **PIN)
    return {
        "time_step_s": case.time_step,
        "solver": {**SOLVER, "rayleigh_fraction": round(fraction, 3)},
        "largest_time_fraction": 1.25 * fraction,
        "skin_m": 0.2 * case.pin_radius,
        "most_neighbours": 20_000,
        "neighbours_of_page": 1_000_000,
        "load_n": case.load,
        "track_radius_m": case.track_radius,
        "type_names": ["pin", "disc"],
        "youngs_modulus_pa": [youngs_modulus(*part.values()) for part in (PIN, DISC)],
        "poissons_ratio": [part["poissons_ratio"] for part in (PIN, DISC)],
        "restitution": pair(case.restitution),
        "sliding_friction": pair(case.friction),
        "rolling_friction_coefficient": pair(0.0),
        "finnie_coefficient_per_pa": pair(1e-11),
        "cycle": cycle,
        "report_steps": report_steps,
    }


def write_set_down(folder: Path, case: PinCase, mesh: SurfaceMesh) -> None:
    """Write the deck that sets the pin down at angle 0, from where it just touches, and the surface that it reads."""
    outside = case.track_radius + 4.0 * case.pin_radius
    text = render(
        "pin_set_down",
        common(case, 0, 100)
        | {
            "domain_half_width_m": outside,
            "domain_bottom_m": -case.pin_radius,
            "domain_top_m": 4.0 * case.pin_radius,
            "pin_radius_m": case.pin_radius,
            "density_kg_per_m3": case.density,
            "pin_height_m": touching_height(mesh, case.track_radius, 0.0, case.pin_radius),
            "settling_steps": math.ceil(SETTLING_TIME / case.time_step),
        },
    )
    _write(folder, text, case, mesh, 0.0, 0.0)


def write_arc(
    folder: Path,
    case: PinCase,
    mesh: SurfaceMesh,
    cycle: int,
    first_step: int,
    steps: int,
    report_steps: int = 400,
    ledger: str = "solver",
) -> np.ndarray:
    """Write the deck of a wear cycle and the stretch of the surface that it reads; return the stretch's triangles.

    first_step: steps of all cycles before, since the pin stood at angle 0
    """
    per_step = case.angular_velocity * case.time_step
    text = render(
        "pin_on_disc",
        common(case, cycle, report_steps)
        | {
            "run_restart": f"../cycle_{cycle - 1}/run.restart",
            "start_angle_rad": per_step * first_step,
            "angular_velocity_rad_per_s": case.angular_velocity,
            "cycle_steps": steps,
            "rest_steps": case.rest_steps,
            "force_interval_steps": report_steps,
            "ledger": ledger,
            **LEDGERS[ledger],
        },
    )
    return _write(folder, text, case, mesh, per_step * first_step, per_step * (first_step + steps))


def _write(folder: Path, text: str, case: PinCase, mesh: SurfaceMesh, start: float, end: float) -> np.ndarray:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.in").write_text(text)
    sunk = 2.0 * hertz_overlap(case.load, case.pin_radius)  # in the deepest place, with room
    reach = touching_reach(case.pin_radius, sunk - mesh.points[:, 2].min())
    chosen = track_stretch(mesh, case.track_radius, start, end, reach)
    write_stl(folder / "surface.stl", mesh.points, mesh.triangles[chosen])
    return chosen


def set_down(folder: Path, case: PinCase, mesh: SurfaceMesh) -> None:
    """Set the pin down on a surface, in `cycle_0` of a folder."""
    write_set_down(folder / "cycle_0", case, mesh)
    run(folder / "cycle_0")


def arc(
    folder: Path, case: PinCase, mesh: SurfaceMesh, cycle: int, first_step: int, steps: int, report_steps: int = 400
) -> tuple[LoadLedger, dict[str, np.ndarray]]:
    """Take the pin on over an arc; return the ledger, by the triangles of the whole mesh, and the table of forces."""
    place = folder / f"cycle_{cycle}"
    chosen = write_arc(place, case, mesh, cycle, first_step, steps, report_steps)
    run(place)
    ledger = read_load_ledger(place / "load_ledger.bin", f"sample_{cycle}", len(chosen), steps=steps)
    return on_whole(ledger, chosen, len(mesh.triangles)), thermo_table(place / "log.liggghts")


@dataclass(frozen=True)
class Ride:
    """What a pin did over a degree of track, -: contacts at once; mean and standard deviation of the vertical force
    over the load; work over F L.
    """

    contacts: float
    mean: float
    deviation: float
    work: float


def ride(folder: Path, mesh: SurfaceMesh, time_step: float, restitution: float) -> Ride:
    """Take the pin over a degree of a surface with that time step (s); the forces of the first fifth do not count.

    Raises RuntimeError where the solver loses the pin.
    """
    case = PinCase(time_step=time_step, restitution=restitution)
    set_down(folder, case, mesh)
    steps = round(math.radians(1.0) / (case.angular_velocity * time_step))
    ledger, forces = arc(folder, case, mesh, 1, 0, steps, report_steps=1)
    vertical = -forces["force_z"][forces["run"] == 1][1 + steps // 5 :] / case.load
    work = ledger.columns["sliding_work_J"].sum() / case.load_times_distance(steps)
    contacts = ledger.columns["contact_time_s"].sum() / ledger.time_s
    return Ride(contacts, vertical.mean(), vertical.std(), work)


def stable_step(contacts: float, restitution: float) -> float:
    """Largest stable time step (s) of the pin on that many contacts, by the closed form."""
    return stable_time_step(LOAD, RADIUS, effective_modulus(), MASS, restitution, contacts)


def on_whole(ledger: LoadLedger, chosen: np.ndarray, count: int) -> LoadLedger:
    """A stretch's ledger with a row for each of the `count` triangles of the whole mesh, 0 where it has none."""
    columns = {}
    for name, values in ledger.columns.items():
        columns[name] = np.zeros(count)
        columns[name][chosen] = values
    return replace(ledger, columns=columns)
