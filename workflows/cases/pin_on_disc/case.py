"""A pin that is pressed on a disc and slides round on it (Yan 2022, chapter 5 and section 4.3.2)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.meshes.disc import track_disc, track_stretch
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.reference.sphere_contact import safe_time_step, stable_time_step, touching_reach
from bulkwear.workflows.cases.pin_on_disc import decks as pin_deck
from bulkwear.workflows.cases.pin_on_disc.checks import design_fault
from bulkwear.workflows.cases.pin_on_disc.parameters import PIN_CHECKS, ROUNDING, run_parameters
from bulkwear.workflows.engine.case import SETUP_LOADS, Parameters, Piece, register
from bulkwear.workflows.engine.sample_case import SampleCase
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.solver import LOG
from bulkwear.workflows.engine.templates import render
from bulkwear.workflows.engine.work import Stage
from bulkwear.workflows.engine.worn_pair import LAW_FIGURES

if TYPE_CHECKING:
    import pandas as pd

FORCE_WINDOWS = "forces.txt"  # of the solver: means over windows of equal length
# Relative, of the mean vertical force of a cycle: what a pin lacks that is off the disc for that share of the cycle.
# One that swings when a cycle ends lacks its momentum: seen 0.2 %, at 3 m/s, where it meets its own groove for the
# first time and touches nine triangles at once after one.
LOAD_TOLERANCE = 1e-2
HEADROOM_OVERLAPS = 2.0  # -, of the pin over the deepest point, for what it can touch: it sinks in by one
SET_DOWN_ARC = 1e-3  # rad, on either side of the place where the pin is set down


class PinOnDisc(SampleCase):
    """The disc rests, the pin is taken round and is free to rise and sink; cycle 0 sets it down on the flat disc.

    The solver gets the stretch of the track that the cycle's arc needs.
    """

    name = "pin_on_disc"
    material_keys = (("pin", "material", "pins"), ("disc", "material", "walls"))
    worn_pair = (("disc", "material"), ("pin", "material"))
    checks = PIN_CHECKS
    run_templates = ("pin_set_down", "pin_on_disc")
    figure_modules = ("volume_figures", "groove_figures")
    shared_figures = LAW_FIGURES
    consumed = ("wear", "remeshing", "sliding", "pin", "disc")
    run_rules = ("surface_mesh", "worn_run", "track_tables")
    geometry = ("disc",)
    first_title = "setting the pin down"
    leftovers = (SETUP_LOADS, FORCE_WINDOWS)

    def design_fault(self, rows: Sequence[Mapping[str, Any]]) -> str | None:
        """Return a phrase unless figures can be made of the rows."""
        return design_fault(rows)

    def run_parameters(
        self, settings: Mapping[str, Any], materials: Mapping[str, Any], factors: Mapping[str, Any], surface: str
    ) -> dict[str, Any]:
        """Return the parameters of a run, derived ones included."""
        return run_parameters(settings, materials)

    def table_columns(self, parameters: Parameters) -> dict[str, Any]:
        """Return all that rows may differ in, and the sliding distance."""
        pin, disc, wear = (parameters[name] for name in ("pin", "disc", "wear"))
        return {
            "wear_coefficient_per_pa": wear["accelerated_wear_coefficient_per_pa"],
            "element_size_mm": 1e3 * disc["element_size_m"],
            "scheme": wear["scheme"],
            "revolutions": parameters["sliding"]["revolutions"],
            "load_n": pin["load_n"],
            "pin_radius_mm": 1e3 * pin["radius_m"],
            "track_radius_mm": 1e3 * disc["track_radius_m"],
            "disc_radius_mm": 1e3 * disc["radius_m"],
            "particle_scale": parameters["particle"]["scale"],
            "deform": wear["deform"],
            "sliding_distance_m": parameters["derived"]["sliding_distance_m"],
        }

    def surface_mesh(self, geometry: Parameters) -> SurfaceMesh:
        """Return the ring round the track."""
        names = ("track_radius_m", "inner_radius_m", "radius_m", "element_size_m", "band_half_width_m")
        return track_disc(*(geometry["disc"][name] for name in names))

    def run_in_steps(self, parameters: Parameters, bed: Parameters | None) -> int:
        """Return the time steps until the pin rests."""
        return pin_deck.settling_steps(parameters)

    def deck(self, parameters: Parameters, bed: Parameters | None, span: Span | None, restart: str) -> str:
        """Return the deck of a wear cycle, or of setting the pin down."""
        if span is None:
            return render("pin_set_down", pin_deck.pin_set_down(parameters))
        return render("pin_on_disc", pin_deck.pin_on_disc(parameters, span, restart))

    def pieces(self, parameters: Parameters, span: Span | None, surface: SurfaceMesh) -> list[Piece]:
        """Return the stretch of the disc that the pin can touch in a cycle."""
        steps = (span.first_step, span.end) if span else (0, 0)
        start, end = (pin_deck.angle(parameters, step) for step in steps)
        margin = 0.0 if span else SET_DOWN_ARC
        depth = -float(surface.points[:, 2].min()) + HEADROOM_OVERLAPS * parameters["derived"]["overlap_m"]
        reach = touching_reach(parameters["pin"]["radius_m"], depth)
        track = parameters["disc"]["track_radius_m"]
        triangles = track_stretch(surface, track, start - margin, end + margin, reach)
        return [Piece(SurfaceMesh(surface.points, surface.triangles[triangles]), triangles)]

    def run_stages(self, parameters: Parameters, bed: Parameters | None) -> tuple[Stage, ...]:
        """Return setting the pin down and the wear cycles; how much a groove widens the stretch is left out."""
        return pin_deck.run_stages(parameters, HEADROOM_OVERLAPS, 2.0 * SET_DOWN_ARC)

    def run_bytes(self, parameters: Parameters) -> float:
        """Return what a run leaves on disk."""
        return pin_deck.run_bytes(parameters, self.run_stages(parameters, None)[-1].triangles)

    def forces(self, parameters: Parameters, span: Span, folder: Path) -> pd.DataFrame:
        """Return means over windows of the track: force on the disc, sum of normal forces, contacts at once."""
        import pandas as pd

        windows = np.loadtxt(folder / FORCE_WINDOWS, ndmin=2)
        sums, step = _sums(parameters, folder), windows[:, 0] / span.substeps + span.first_step
        time_s = step * parameters["derived"]["time_step_s"]
        return pd.DataFrame(
            {
                "time_s": time_s,
                "travel_m": time_s * parameters["sliding"]["velocity_m_per_s"],
                "angle_deg": 360.0 * pin_deck.revolutions(parameters, step),
                **{f"force_{axis}_N": windows[:, 1 + k] for k, axis in enumerate("xyz")},
                **sums,
            }
        )

    def own_columns(self, parameters: Parameters, span: Span, folder: Path) -> dict[str, float]:
        """Return revolutions done, mean number of contacts, and the mean vertical force of the pin on the disc."""
        windows = np.loadtxt(folder / FORCE_WINDOWS, ndmin=2)
        turns = pin_deck.revolutions(parameters, span.end)
        return {
            "revolution": round(turns) if abs(turns - round(turns)) < ROUNDING * turns else turns,
            "contacts_per_step": float(np.mean(_sums(parameters, folder)["contacts"])),
            "mean_vertical_force_N": -float(windows[:, 3].mean()),
            "time_step_s": parameters["derived"]["time_step_s"] / span.substeps,
        }

    def cycle_fault(self, parameters: Parameters, own: Mapping[str, float]) -> str | None:
        """Return a phrase if the pin did not stay on the disc, or was about to swing by itself."""
        load, force, contacts = parameters["pin"]["load_n"], own["mean_vertical_force_N"], own["contacts_per_step"]
        fraction, derived = parameters["solver"]["rayleigh_fraction"], parameters["derived"]
        if not abs(force - load) <= LOAD_TOLERANCE * load:
            return (
                f"the mean vertical force of the pin on the disc is {force:.6g} N, allowed is the load of {load:g} N "
                f"within {100 * LOAD_TOLERANCE:g} %: the pin left the disc; take a smaller solver.rayleigh_fraction "
                f"than {fraction:g}, or smaller wear cycles"
            )
        step, stable = own["time_step_s"], stable_time_step(*_contact(parameters), contacts=max(contacts, 1.0))
        if step <= stable:
            return None
        return (
            f"the pin had {contacts:.3g} contacts at once, with which a time step of {step:.3g} s makes it swing by "
            f"itself, allowed is {stable:.3g} s: take more, shorter wear cycles, or a solver.rayleigh_fraction of at "
            f"most {fraction * stable / derived['time_step_s']:.2g}"
        )

    def substeps(self, parameters: Parameters, wear: Mapping[str, float]) -> int:
        """Return in how many the solver takes each time step after a cycle with so many contacts at once."""
        step = parameters["derived"]["time_step_s"]
        load, radius, modulus, mass, restitution = _contact(parameters)
        safe = safe_time_step(step, wear["contacts_per_step"], load, radius, modulus, mass, restitution)
        return math.ceil(step / safe)

    def geometry_columns(self, before: SurfaceMesh, worn: SurfaceMesh, touched: np.ndarray) -> dict[str, float]:
        """Return the volume of the update as the source may count it: areas times paths of centroids (Eq 5.9).

        Over all triangles, and over those in contact.
        """
        from bulkwear.postproc.wear.schemes import centroid_path_volume

        paths = before.points, worn.points, before.triangles
        return {
            "centroid_path_volume_m3": centroid_path_volume(*paths),
            "touched_centroid_path_volume_m3": centroid_path_volume(*paths, counted=touched),
        }

    def files_to_drop(self, parameters: Parameters, span: Span | None) -> tuple[str, ...]:
        """Return the solver's files of a cycle, and what a resume needs except at the end of a revolution."""
        if span is None:
            return ()
        solver_files = ("surface.stl", f"loads_{span.solver_steps}.vtk", "screen.txt")
        if span.cycle % parameters["sliding"]["cycles_per_revolution"] == 0:
            return solver_files
        return (*solver_files, "surface.vtu", "run.restart")

    def lasting_limit(self, parameters: Parameters, surface: SurfaceMesh) -> np.ndarray:
        """Return the smaller of a fraction of the edges and of the pin's overlap: it must not lose contact."""
        overlap = parameters["wear"]["largest_step_overlap_fraction"] * parameters["derived"]["overlap_m"]
        return np.fmin(super().lasting_limit(parameters, surface), overlap)

    def summary(
        self, design: Path, wear: Sequence[Path], pristine: Sequence[Path], worn: Sequence[Path]
    ) -> pd.DataFrame:
        """Return each run's totals beside alpha F L and the volume that its geometry has lost."""
        from bulkwear.workflows.cases.pin_on_disc.volume import summary_table

        return summary_table(design, wear, pristine, worn)


register(PinOnDisc())


def _contact(parameters: Parameters) -> tuple[float, float, float, float, float]:
    """Return load (N), radius (m), effective modulus (Pa), mass (kg) and restitution (-) of the pin on the disc."""
    pin, derived, contact = parameters["pin"], parameters["derived"], parameters["sample_material"]["contact"]
    return (
        *(pin["load_n"], pin["radius_m"], derived["effective_modulus_pa"], derived["pin_mass_kg"]),
        contact["restitution"],
    )


def _sums(parameters: Parameters, folder: Path) -> dict[str, np.ndarray]:
    """Return mean sum of the normal forces (N) and mean number of contacts in each window, from the ledger's sums."""
    from bulkwear.postproc.readers.solver_log import thermo_table

    thermo = thermo_table(folder / LOG)
    arc = thermo["run"] == thermo["run"].max()
    duration = parameters["derived"]["force_interval_steps"] * parameters["derived"]["time_step_s"]
    return {
        "normal_force_N": np.diff(thermo["impulse"][arc]) / duration,
        "contacts": np.diff(thermo["contact"][arc]) / duration,
    }
