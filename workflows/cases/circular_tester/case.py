"""A submerged sample in the rotating annular bed of a circular wear tester (Yan 2022, chapter 6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.meshes.tester import placed, sample_block
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.readers.cycle_folders import LAYER_TABLE
from bulkwear.postproc.readers.solver_log import thermo_rows, thermo_table
from bulkwear.postproc.wear.caps import GRAVITY, gap_closing_step
from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.cases.circular_tester import work as tester_work
from bulkwear.workflows.cases.circular_tester.checks import TESTER_CHECKS, design_fault
from bulkwear.workflows.cases.circular_tester.parameters import bed_parameters, run_parameters
from bulkwear.workflows.config.patterns import dimension_columns, option_keys, pattern_of, surface_name
from bulkwear.workflows.engine.case import SETUP_BED, SETUP_LOADS, Parameters, Piece, Run, register
from bulkwear.workflows.engine.pieces import piece_ends
from bulkwear.workflows.engine.sample_case import SampleCase
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.solver import LOG
from bulkwear.workflows.engine.templates import render
from bulkwear.workflows.engine.work import Stage
from bulkwear.workflows.engine.worn_pair import LAW_FIGURES

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.engine.beds import BedMeasure


class CircularTester(SampleCase):
    """The sample rests in the bed, the trough turns; cycle 0 puts the sample into a bed that is steady already.

    The master surface is in the sample's own frame; the solver gets it inclined.
    """

    name = "circular_tester"
    material_keys = (
        ("sample", "material", "walls"),
        ("bed", "material", "particles"),
        ("bed", "floor_material", "walls"),
    )
    checks = TESTER_CHECKS
    run_templates = ("tester_run_in", "circular_tester")
    bed_template = "tester_bed"
    seed_setting = "bed.seed"
    figure_modules = ("figures", "place_figures", "flow_figures", "sensitivity_figures")
    shared_figures = ("beds", "worn_surface", "worn_surface_3d", "wear_updates", *LAW_FIGURES)
    geometry = ("sample", "pattern")
    consumed = ("wear", "remeshing", "sliding", "tester")
    length = (("sliding", "revolutions"), ("sliding", "cycles"), ("derived", "travel_steps"))
    first_title = "run-in"
    leftovers = (SETUP_LOADS, SETUP_BED)
    kept = (LAYER_TABLE,)

    def needed_pattern_keys(self, settings: Mapping[str, Any], surface: str) -> list[str]:
        """Return what describes the pattern of the row's surface."""
        named = settings["sample"]["surface"]
        return [*dimension_columns(named), *option_keys(named)]

    def design_fault(self, rows: Sequence[Mapping[str, Any]]) -> str | None:
        """Return a phrase unless figures can be made of the rows."""
        return design_fault(rows)

    def run_parameters(
        self, settings: Mapping[str, Any], materials: Mapping[str, Any], factors: Mapping[str, Any], surface: str
    ) -> dict[str, Any]:
        """Return the parameters of a run, derived ones included; what a row says is in the settings already."""
        return run_parameters(settings, materials)

    def beds(self, runs: Sequence[Run]) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
        """Return the beds of a study; runs of equal machine and particles share one, whatever their sample."""
        headroom: dict[float, float] = {}
        for run in runs:
            scale, derived = run.parameters["particle"]["scale"], run.parameters["derived"]
            headroom[scale] = max(headroom.get(scale, 0.0), derived["headroom_m"])
        beds: dict[str, dict[str, Any]] = {}
        bed_of = {}
        for run in runs:
            wanted = bed_parameters(run.parameters, headroom[run.parameters["particle"]["scale"]])
            name = next((name for name, bed in beds.items() if bed == wanted), f"bed_{len(beds) + 1}")
            beds[name], bed_of[run.name] = wanted, name
        return beds, bed_of

    def table_columns(self, parameters: Parameters) -> dict[str, Any]:
        """Return all that rows may differ in."""
        derived = parameters["derived"]
        return {
            "surface": surface_name(parameters["pattern"]),
            "shape": parameters["tester"]["shape"],
            "particle_scale": parameters["particle"]["scale"],
            "element_size_mm": 1e3 * parameters["sample"]["element_size_m"],
            "wear_coefficient_per_pa": parameters["wear"]["accelerated_wear_coefficient_per_pa"],
            "revolutions": parameters["sliding"]["revolutions"],
            "layers": derived["layers"],
            "equivalent_size_ratio": derived["equivalent_size_ratio"],
        }

    def surface_mesh(self, geometry: Parameters) -> SurfaceMesh:
        """Return the whole sample in its own frame, its top at z = 0."""
        sample, pattern = geometry["sample"], pattern_of(geometry["pattern"])
        lengths = (sample["width_m"], sample["length_m"], sample["thickness_m"], sample["element_size_m"])
        return sample_block(*lengths, pattern, tester_deck.HOLDER_SIZE)

    def run_in_steps(self, parameters: Parameters, bed: Parameters | None) -> int:
        """Return the time steps of the run-in."""
        return parameters["derived"]["run_in_steps"]

    def deck(self, parameters: Parameters, bed: Parameters | None, span: Span | None, restart: str) -> str:
        """Return the deck of a wear cycle, or of the run-in."""
        if span is None:
            return render("tester_run_in", tester_deck.tester_run_in(parameters, bed, restart))
        return render("circular_tester", tester_deck.circular_tester(parameters, bed, span, restart))

    def piece_ends(self, parameters: Parameters, bed: Parameters | None, span: Span | None) -> list[int]:
        """Return where the pieces of a cycle end; a look at the wear that falls on one would be overwritten."""
        interval, total = parameters["solver"]["checkpoint_interval_steps"], super().piece_ends(parameters, bed, span)
        look = tester_deck.look_steps(parameters, span) if span else 0
        ends = piece_ends(0, total[0], interval)
        return [end + (span is not None and end < total[0] and end % look == 0) for end in ends]

    def bed_deck(self, bed: Parameters) -> dict[str, Any]:
        """Return the parameters of the deck that fills the trough and turns it until the flow is steady."""
        return tester_deck.tester_bed(bed)

    def bed_measures(self, bed: Parameters, log: Path) -> list[BedMeasure]:
        """Return mass, level past the consolidator and the sample's depth under it, of the last revolution."""
        from bulkwear.workflows.cases.circular_tester.beds import bed_measures

        return bed_measures(bed, thermo_table(log))

    def write_bed_files(self, bed: Parameters, folder: Path) -> None:
        """Write consolidator, trough and the block of the sample."""
        tester_deck.write_machine(bed, folder)
        tester_deck.write_block(bed, folder)

    def write_shared_files(self, parameters: Parameters, bed: Parameters | None, surface: Path, folder: Path) -> None:
        """Write consolidator and trough."""
        tester_deck.write_machine(bed, folder)

    def pieces(self, parameters: Parameters, span: Span | None, surface: SurfaceMesh) -> list[Piece]:
        """Return the sample as it lies in the trough: inclined."""
        inclined = placed(surface, tester_deck.pose(parameters["tester"]), np.zeros(3))
        return [Piece(inclined, np.arange(len(surface.triangles)))]

    def on_surface(self, parameters: Parameters, ledger: pd.DataFrame) -> pd.DataFrame:
        """Return a ledger with its vectors in the sample's own frame."""
        from bulkwear.postproc.wear.ledger import POSITION_FIELDS, VECTOR_UNITS, vector_columns

        pose, turned = tester_deck.pose(parameters["tester"]), {}
        for columns in map(list, (POSITION_FIELDS, *map(vector_columns, VECTOR_UNITS))):
            turned |= dict(zip(columns, (ledger[columns].to_numpy() @ pose).T, strict=True))
        return ledger.assign(**turned)

    def record(self, parameters: Parameters, bed: Parameters | None, span: Span | None) -> dict[str, Any]:
        """Return the sample's pose, how often the trough has gone round since wear counts, and the packing's seed."""
        return {
            "pose": tester_deck.pose(parameters["tester"]).tolist(),
            "revolution": revolution(parameters, span.end if span else 0),
            "seed": bed["seed"],
        }

    def forces(self, parameters: Parameters, span: Span, folder: Path) -> pd.DataFrame:
        """Return the bed's force on sample and holder, and velocity and height of the bed over the sample."""
        import pandas as pd

        thermo = thermo_rows(folder / LOG)
        step = thermo["Step"] + span.first_step
        time_s = step * parameters["derived"]["time_step_s"]
        return pd.DataFrame(
            {
                "time_s": time_s,
                "travel_m": time_s * parameters["sliding"]["velocity_m_per_s"],
                "revolution": revolution(parameters, step),
                **{f"force_{axis}_N": thermo[f"force_{axis}"] for axis in "xyz"},
                "velocity_over_m_per_s": thermo["sample_v"],
                "height_over_m": thermo["sample_h"],
            }
        )

    def own_columns(self, parameters: Parameters, span: Span, folder: Path) -> dict[str, float]:
        """Return revolutions done, the bed's mean velocity over the trough's (-), and the particles there are."""
        thermo = thermo_rows(folder / LOG)
        return {
            "revolution": revolution(parameters, span.end),
            "bed_over_floor_velocity": float(thermo["bed_pace"].mean()),
            "particles": int(thermo["Atoms"][-1]),
        }

    def reduce(self, parameters: Parameters, span: Span, folder: Path) -> list[Path]:
        """Reduce the snapshots of the bed to what its lowest layer does; the last one stays for pictures."""
        from bulkwear.workflows.cases.circular_tester.layer import LayerOverSample, reduce_layer

        sample = parameters["sample"]
        layer = LayerOverSample(
            sample["width_m"],
            sample["length_m"],
            parameters["particle"]["median_diameter_m"],
            tester_deck.pose(parameters["tester"]),
        )
        start = revolution(parameters, span.first_step)
        return reduce_layer(folder, layer, start, 1.0 / parameters["derived"]["revolution_steps"])

    def geometry_columns(self, before: SurfaceMesh, worn: SurfaceMesh, touched: np.ndarray) -> dict[str, float]:
        """Return what is left of the pattern: its volume over its feet, negative where it lies below them."""
        from bulkwear.postproc.wear.pattern_left import pattern_volume

        return {"pattern_volume_m3": pattern_volume(worn)}

    def closing_gap(self, parameters: Parameters, duration: float) -> float:
        """Return the gap (m) that particles fall through in the stated part of a cycle."""
        return gap_closing_step(parameters["wear"]["gap_closing_fraction"], duration, GRAVITY)

    def bed_stages(self, parameters: Parameters, bed: Parameters) -> tuple[Stage, ...]:
        """Return filling, lowering of the consolidator and turning until the flow is steady."""
        return tester_work.bed_stages(parameters, bed)

    def bed_bytes(self, parameters: Parameters) -> float:
        """Return what a bed leaves on disk."""
        return tester_work.bed_bytes(parameters)

    def run_stages(self, parameters: Parameters, bed: Parameters | None) -> tuple[Stage, ...]:
        """Return run-in and wear cycles."""
        return tester_work.run_stages(parameters)

    def run_bytes(self, parameters: Parameters) -> float:
        """Return what a run leaves on disk."""
        return tester_work.run_bytes(parameters)

    def worn_through(self, worn: SurfaceMesh) -> str | None:
        """Return a phrase if the sample is worn down to its holder's bottom."""
        top = worn.points[np.unique(worn.triangles[worn.cell_data["part"] >= 0]), 2]
        return "the sample is worn through" if top.min() <= worn.points[:, 2].min() else None

    def summary(
        self, design: Path, wear: Sequence[Path], pristine: Sequence[Path], worn: Sequence[Path]
    ) -> pd.DataFrame:
        """Return the totals of every run."""
        from bulkwear.postproc.tables.summary import totals_of_runs

        return totals_of_runs(design, wear)


register(CircularTester())


def revolution(parameters: Parameters, steps: Any) -> Any:
    """Return how often the trough has gone round in so many time steps (-); rounding apart whole after whole ones."""
    return steps / parameters["derived"]["revolution_steps"]
