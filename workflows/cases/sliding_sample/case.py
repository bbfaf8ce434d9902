"""A sample, patterned or plain, that slides through a bed of particles (Yan 2022, chapters 3, 4 and 6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, write_stl
from bulkwear.postproc.readers.cycle_folders import FLOW_TABLE, SPIN_TABLE
from bulkwear.postproc.readers.solver_log import exchanges, thermo_rows, thermo_table
from bulkwear.postproc.wear.caps import GRAVITY, gap_closing_step
from bulkwear.workflows.cases.sliding_sample import work as sliding_work
from bulkwear.workflows.cases.sliding_sample.beds import bed_measures
from bulkwear.workflows.cases.sliding_sample.checks import SLIDING_CHECKS
from bulkwear.workflows.cases.sliding_sample.decks import (
    end_wall_corners,
    lowered_bed,
    settled_bed,
    sliding_sample,
    wear_interval_steps,
)
from bulkwear.workflows.cases.sliding_sample.parameters import derived_parameters, flow_measures
from bulkwear.workflows.cases.sliding_sample.shape import rolling, solver_for
from bulkwear.workflows.cases.sliding_sample.study import varies_scale
from bulkwear.workflows.config.clumps import shaped
from bulkwear.workflows.config.optimise import OPTIMISE
from bulkwear.workflows.config.patterns import (
    dimension_columns,
    highest_point,
    option_keys,
    pattern_section,
    sample_surface,
)
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.case import SETUP_BED, SETUP_LOADS, Parameters, Run, register
from bulkwear.workflows.engine.derived import (
    ADAPTIVE,
    PERIODIC,
    WALLS,
    WINDOW,
    particle_section,
    template_sections,
    wall_section,
    wear_section,
    window_lengths,
)
from bulkwear.workflows.engine.pieces import piece_ends
from bulkwear.workflows.engine.sample_case import SampleCase
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.solver import LOG
from bulkwear.workflows.engine.templates import render, used_sections
from bulkwear.workflows.engine.work import Stage, Work
from bulkwear.workflows.engine.worn_pair import LAW_FIGURES

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.engine.beds import BedMeasure


END_WALL = "end_wall.stl"


class SlidingSample(SampleCase):
    """The sample rests, the bed travels past it; cycle 0 lowers the bed on to the sample and runs it in."""

    name = "sliding_sample"
    material_keys = (
        ("sample", "material", "walls"),
        ("bed", "material", "particles"),
        ("bed", "floor_material", "walls"),
    )
    checks = SLIDING_CHECKS
    run_templates = ("lowered_bed", "sliding_sample")
    bed_template = "settled_bed"
    more_templates = ("packed_container", "bed_contacts", "collision")
    seed_setting = "bed.seed"
    figure_modules = (
        *("search.figures", "particle_size.figures", "particle_size.packing_figures"),
        *("screening.figures", "screening.regression_figures", "figures"),
    )
    shared_figures = ("beds", "worn_surface", "worn_surface_3d", "wear_updates", "worn_film", *LAW_FIGURES)
    solver_rules = (*SampleCase.solver_rules, "packing_profiles")
    alternatives = (("sliding", "travel_mm"), ("sliding", "test_duration_h"))
    geometry = ("sample", "pattern")
    first_title = "lowering and run-in"
    leftovers = (SETUP_LOADS, SETUP_BED)
    kept = (FLOW_TABLE, SPIN_TABLE)

    def surfaces(self, head: Mapping[str, Any]) -> Sequence[str]:
        """Return the surfaces that the study names."""
        return head["surfaces"]

    def needed_columns(self, surface: str) -> Sequence[str]:
        """Return the dimensions of the surface's pattern."""
        return dimension_columns(surface)

    def needed_pattern_keys(self, settings: Mapping[str, Any], surface: str) -> list[str]:
        """Return what else describes the surface's pattern."""
        return option_keys(surface)

    def run_parameters(
        self, settings: Mapping[str, Any], materials: Mapping[str, Any], factors: Mapping[str, Any], surface: str
    ) -> dict[str, Any]:
        """Return the parameters of a run, derived ones included."""
        scale = row_particle_scale(settings, materials, factors["bed_thickness_m"])
        grains = particle_section(settings["bed"]["material"], materials, scale)
        bodies = {
            "particle": shaped(grains, settings["bed"]["shape"]),
            "sample_material": wall_section(settings["sample"]["material"], materials),
            "floor_material": wall_section(settings["bed"]["floor_material"], materials),
        }
        sections, factor = template_sections(settings), settings["bed"]["rolling_friction_factor"]
        sections["solver"] = solver_for(sections["solver"], bodies["particle"], factor)
        parameters = {
            "ledger": settings["ledger"],
            "sample": settings["sample"],
            "pattern": pattern_section(surface, {**settings["pattern"], **factors}),
            "bed": {**_bed(settings["bed"]), "thickness_m": factors["bed_thickness_m"]},
            "sliding": _sliding(settings["sliding"], factors["velocity_m_per_s"], settings["wear"]["acceleration"]),
            "wear": wear_section(settings["wear"], materials["particles"][settings["bed"]["material"]]),
            "remeshing": settings["remeshing"],
            **sections,
            **{name: rolling(body, factor) for name, body in bodies.items()},
        }
        derived = derived_parameters(parameters)
        rise = searched_height(settings, factors, surface) - highest_point(parameters["pattern"])
        return {**parameters, "derived": derived | {"highest_point_m": derived["highest_point_m"] + max(rise, 0.0)}}

    def beds(self, runs: Sequence[Run]) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
        """Return the beds of a study; runs with equal parameters share one.

        Beds settle on a temporary floor (`temporary_floor_m`) above the highest point of the whole study's samples, of
        those that a search may still propose as well.
        """
        beds: dict[str, dict[str, Any]] = {}
        bed_of = {}
        clearance = max(run.parameters["derived"]["highest_point_m"] for run in runs)
        for run in runs:
            wanted = {**bed_parameters(run), "temporary_floor_m": clearance}
            name = next((name for name, bed in beds.items() if bed == wanted), f"bed_{len(beds) + 1}")
            beds[name], bed_of[run.name] = wanted, name
        return beds, bed_of

    def table_columns(self, parameters: Parameters) -> dict[str, Any]:
        """Return particle scale, layers and alpha_ER, the particle's size over a bump's (Yan 2022, Eq 4.18)."""
        return {
            "particle_scale": parameters["particle"]["scale"],
            "layers": parameters["derived"]["layers"],
            "equivalent_size_ratio": parameters["derived"]["equivalent_size_ratio"],
        }

    def surface_mesh(self, geometry: Parameters) -> SurfaceMesh:
        """Return the sample with its skirt."""
        return sample_surface(geometry["sample"], geometry["pattern"])

    def run_in_steps(self, parameters: Parameters, bed: Parameters | None) -> int:
        """Return the time steps of lowering and run-in."""
        return lowered_bed(parameters, bed, "")["lowering_steps"] + parameters["derived"]["run_in_steps"]

    def deck(self, parameters: Parameters, bed: Parameters | None, span: Span | None, restart: str) -> str:
        """Return the deck of a wear cycle, or of lowering and run-in."""
        if span is None:
            return render("lowered_bed", lowered_bed(parameters, bed, restart))
        return render("sliding_sample", sliding_sample(parameters, bed, span, restart))

    def further_work(self, study: Any) -> tuple[Work, ...]:
        """Return the containers in which the particles of a study of particle size are packed."""
        from bulkwear.workflows.cases.sliding_sample.particle_size.packings import packing_work
        from bulkwear.workflows.cases.sliding_sample.particle_size.study import packed_runs

        return (packing_work(packed_runs(study), to_si(study.settings)["packing"]),) if varies_scale(study) else ()

    def bed_stages(self, parameters: Parameters, bed: Parameters) -> tuple[Stage, ...]:
        """Return settling, and in a window the fall to the true floor."""
        return sliding_work.bed_stages(parameters, bed)

    def bed_bytes(self, parameters: Parameters) -> float:
        """Return what a bed leaves on disk."""
        return sliding_work.bed_bytes(parameters)

    def run_stages(self, parameters: Parameters, bed: Parameters | None) -> tuple[Stage, ...]:
        """Return lowering, run-in and wear cycles."""
        return sliding_work.run_stages(parameters, bed)

    def run_bytes(self, parameters: Parameters) -> float:
        """Return what a run leaves on disk."""
        return sliding_work.run_bytes(parameters)

    def piece_ends(self, parameters: Parameters, bed: Parameters | None, span: Span | None) -> list[int]:
        """Return where the pieces of a cycle end, and of lowering and run-in, whose first one lowers the bed.

        One after another they would overwrite sampled contacts, and a look at the wear that falls on their end.
        """
        interval, total = parameters["solver"]["checkpoint_interval_steps"], super().piece_ends(parameters, bed, span)
        if span is None:
            return piece_ends(total[0] - parameters["derived"]["run_in_steps"], total[0], interval)
        if parameters["ledger"] != "solver":
            return total
        look = wear_interval_steps(parameters, span)
        return [end + (end < total[0] and end % look == 0) for end in piece_ends(0, total[0], interval)]

    def bed_deck(self, bed: Parameters) -> dict[str, Any]:
        """Return the parameters of the deck that fills and settles a bed."""
        return settled_bed(bed)

    def bed_measures(self, bed: Parameters, log: Path) -> list[BedMeasure]:
        """Return mass and level of a bed that has settled, and of a window's bed once more as it is in use."""
        return bed_measures(bed, thermo_table(log))

    def write_shared_files(self, parameters: Parameters, bed: Parameters | None, surface: Path, folder: Path) -> None:
        """Write the wall that closes the bed at both ends, two triangles across the domain at y = 0, if it has ends."""
        if bed["ends"] != WALLS:
            return
        half_width, bottom, top = end_wall_corners(bed)
        corners = [(-half_width, bottom), (half_width, bottom), (half_width, top), (-half_width, top)]
        points = np.array([(x, 0.0, z) for x, z in corners])
        write_stl(folder / END_WALL, points, np.array([[0, 1, 2], [0, 2, 3]]))

    def record(self, parameters: Parameters, bed: Parameters | None, span: Span | None) -> dict[str, Any]:
        """Return how far the bed has travelled, and the seed of its packing."""
        steps = parameters["derived"]["run_in_steps"] + (span.end if span else 0)
        return {"bed_travelled_m": deck.travelled(parameters, steps), "seed": bed["seed"]}

    def forces(self, parameters: Parameters, span: Span, folder: Path) -> pd.DataFrame:
        """Return the bed's force on the sample."""
        import pandas as pd

        thermo = thermo_rows(folder / LOG)
        time_s = (thermo["Step"] + span.first_step) * parameters["derived"]["time_step_s"]
        table = {"time_s": time_s, "travel_m": time_s * parameters["sliding"]["velocity_m_per_s"]}
        return pd.DataFrame(table | {f"force_{axis}_N": thermo[f"force_{axis}"] for axis in "xyz"})

    def own_columns(self, parameters: Parameters, span: Span, folder: Path) -> dict[str, float]:
        """Return the bed's mean velocity over that of its floor (-) where friction alone takes the bed along.

        In a travelling window the particles that left and entered instead, how many of the others are missing, and how
        far its front lags behind the floor.
        """
        if parameters["bed"]["ends"] == WINDOW:
            return exchanged_particles(folder) | {"front_lag": front_lag(parameters, folder)}
        if parameters["bed"]["ends"] != PERIODIC:
            return {}
        pace = thermo_rows(folder / LOG)["bed_pace"].mean()
        return {"bed_over_floor_velocity": float(pace / parameters["sliding"]["velocity_m_per_s"])}

    def cycle_fault(self, parameters: Parameters, own: Mapping[str, float]) -> str | None:
        """Return a phrase if a window lost particles besides those that it exchanged."""
        missing = own.get("missing_particles", 0)
        return f"{missing} particles are missing besides those that left the window, allowed is 0" if missing else None

    def reduce(self, parameters: Parameters, span: Span, folder: Path) -> list[Path]:
        """Reduce the snapshots of the bed to the bins of its flow; the last one stays for pictures."""
        from bulkwear.workflows.cases.sliding_sample.flow_history import RunFlow, reduce_snapshots

        start = deck.travelled(parameters, span.first_step)
        return reduce_snapshots(folder, RunFlow(**flow_measures(parameters)), start)

    def closing_gap(self, parameters: Parameters, duration: float) -> float:
        """Return the gap (m) that particles fall through in the stated part of a cycle."""
        return gap_closing_step(parameters["wear"]["gap_closing_fraction"], duration, GRAVITY)

    def worn_through(self, worn: SurfaceMesh) -> str | None:
        """Return a phrase if the sample is worn down to the floor."""
        from bulkwear.meshes.sample import floor_fault

        return floor_fault(worn)

    def summary(
        self, design: Path, wear: Sequence[Path], pristine: Sequence[Path], worn: Sequence[Path]
    ) -> pd.DataFrame:
        """Return the totals of every run, and its wear over that of its plain twin."""
        from bulkwear.postproc.tables.summary import summary_table

        return summary_table(design, wear)


register(SlidingSample())


def front_lag(parameters: Parameters, folder: Path) -> float:
    """Return how far the bed at a window's front lags behind its floor when a cycle ends, over the floor's velocity.

    It is looked at just downstream of where the strip is before an exchange. Near 0 nothing there knows of the sample.
    """
    from bulkwear.postproc.flow.bed import lag, read_snapshot, snapshots

    strip, clearance = window_lengths(parameters["particle"])
    start = parameters["derived"]["bed_start_m"] + clearance + parameters["bed"]["exchange_m"] + strip
    bed = read_snapshot(snapshots(folder)[-1])
    return lag(bed, start, start + strip, parameters["sliding"]["velocity_m_per_s"])


def exchanged_particles(folder: Path) -> dict[str, int]:
    """Return how many particles left and entered in a cycle, and how far any count is from what that leaves."""
    counts, told = thermo_table(folder / LOG)["Atoms"], exchanges(folder / LOG)
    expected = counts[0] + np.concatenate(([0], np.cumsum(told["entered"] - told["left"])))
    missing = np.abs(expected[1:] - told["here"]).max(initial=0)
    uncounted = np.abs(counts[:, None] - expected).min(axis=1).max()
    return {
        "left_particles": int(told["left"].sum()),
        "entered_particles": int(told["entered"].sum()),
        "missing_particles": int(max(missing, uncounted)),
    }


def searched_height(settings: Mapping[str, Any], factors: Mapping[str, Any], surface: str) -> float:
    """Return the height (m) of the highest pattern that the study's search may propose, 0 without a search."""
    if OPTIMISE not in settings:
        return 0.0
    ends = to_si({each["name"]: each["high"] for each in settings[OPTIMISE]["factors"]})
    return highest_point(pattern_section(surface, {**settings["pattern"], **factors, **ends}))


def row_particle_scale(settings: Mapping[str, Any], materials: Mapping[str, Any], thickness: float) -> float:
    """Return the particle scale (-) of a bed of that thickness (m): the study's, lowered to keep bed.least_layers."""
    scale, layers = settings["particle_scale"], settings["bed"]["least_layers"]
    diameter = materials["particles"][settings["bed"]["material"]]["median_diameter_m"]
    return min(scale, max(thickness / (layers * diameter), 1.0)) if layers else scale


def _sliding(sliding: Mapping[str, Any], velocity: float, acceleration: float) -> dict[str, Any]:
    """Return the section with velocity (m/s) and travel, which a test duration makes with the acceleration (-).

    Without the length of the first cycle where all are equal: it then changes nothing.
    """
    kept = {k: v for k, v in sliding.items() if sliding["cycles"] == ADAPTIVE or k != "first_cycle_m"}
    duration = kept.pop("test_duration_s", None)
    if duration is not None:
        kept["travel_m"] = velocity * duration / acceleration
    return {**kept, "velocity_m_per_s": velocity}


def _bed(bed: Mapping[str, Any]) -> dict[str, Any]:
    """Return the section without what the materials of the run hold, and without the travel between exchanges where
    there are none: it then changes nothing.
    """
    elsewhere = {"shape", "rolling_friction_factor"} | (set() if bed["ends"] == WINDOW else {"exchange_m"})
    return {key: value for key, value in bed.items() if key not in elsewhere}


def bed_parameters(run: Run) -> dict[str, Any]:
    """Return exactly what determines the settled bed of a run (SI); runs with equal ones share a bed.

    `start_m` is the y of the upstream end before the travel: the sample is at y = 0, the bed moves in +y over
    `travel_m`, or goes round (`ends` periodic, travel_m 0). It settles with the largest time step, which does not
    depend on the run's velocity.
    """
    parameters, derived = run.parameters, run.parameters["derived"]
    return {
        "particle": parameters["particle"],
        "floor_material": parameters["floor_material"],
        "width_m": parameters["bed"]["width_m"],
        "length_m": derived["bed_length_m"],
        "start_m": derived["bed_start_m"],
        "travel_m": derived["bed_travel_m"],
        "ends": parameters["bed"]["ends"],
        "thickness_m": parameters["bed"]["thickness_m"],
        "seed": parameters["bed"]["seed"],
        **used_sections("settled_bed", parameters, ends=parameters["bed"]["ends"]),
        "rolling_friction_for_solver": {
            name: derived["rolling_friction_for_solver"][name] for name in ("particle", "floor_material")
        },
        "youngs_modulus_pa": {name: derived["youngs_modulus_pa"][name] for name in ("particle", "floor_material")},
        "time_step_s": derived["largest_time_step_s"],
    }
