"""Equipment of one's own: parts from CAD, a feed in t/h or a filling, hours of operation, and the liners' life."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, read_surface
from bulkwear.workflows.cases.equipment import decks as equipment_deck
from bulkwear.workflows.cases.equipment.change_out import REMAINING, RULES, given_rule
from bulkwear.workflows.cases.equipment.checks import EQUIPMENT_CHECKS
from bulkwear.workflows.cases.equipment.motions import motion_of
from bulkwear.workflows.cases.equipment.parameters import PART_DEFAULTS, laws_of, run_parameters
from bulkwear.workflows.cases.equipment.phases import next_block
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine.case import Case, CycleError, Parameters, Piece, Run, register
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.templates import render
from bulkwear.workflows.engine.work import Stage
from bulkwear.workflows.engine.worn_pair import LAW_FIGURES, WornPair

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.postproc.wear.directions import SliceEnds

SECONDS_PER_HOUR = 3600.0
OF_WEAR = (*PART_DEFAULTS, "law_parameters", *Case.only_told)  # keys of a part
OF_DURATION = ("time_step_s", "run_in_steps", "travel_steps")  # in which parts move, and particles fly


class Equipment(Case):
    """A machine of parts that wear, move or keep their shape. Blocks of equal length follow one another; what each is
    for is found as the run goes on (phases.py).
    """

    name = "equipment"
    material_keys = (("bulk", "material", "particles"),)
    checks = EQUIPMENT_CHECKS
    alternatives = (("operation", "duration_h"), ("operation", "throughput_mt"))
    run_templates = ("equipment_start", "equipment")
    seed_setting = "bulk.seed"
    figure_modules = ("figures", "map_figures", "flow_figures", "lifter_figures")
    geometry = ("parts", "particle", "inlet", "filling", "outlets", "periodic", "domain")
    through_files = ("inlet", "outlets", "periodic", "domain")  # the solver reads them from files beside its decks
    consumed = ("wear", "remeshing", "parts", "sampling", "start_up", "updates", *through_files)
    only_told = (*Case.only_told, *RULES)
    first_title = "start-up"
    leftovers = ()
    kept = ("patches.csv", "parts.csv", "flow.csv")
    solver_rules = ("worn_run",)
    counts_on = True
    forces_table = "parts.csv"
    by_part = True
    shared_figures = ("worn_surface_3d", *LAW_FIGURES)

    def named_materials(self, settings: Mapping[str, Any]) -> tuple[tuple[str, ...], ...]:
        """Return the path of each setting that names a material, and its kind."""
        parts = settings.get("parts", {})
        return (*self.material_keys, *(("parts", name, "material", "walls") for name in parts))

    def worn_pairs(self, settings: Mapping[str, Any]) -> list[WornPair]:
        """Return the parts that wear, each with its wall and the bulk material."""
        law, bulk = settings["wear"]["law"], settings["bulk"].get("material")
        return [
            WornPair(("parts", name), part["material"], bulk, part.get("law", law))
            for name, part in settings.get("parts", {}).items()
            if part.get("role") == "wears" and "material" in part
        ]

    def run_parameters(
        self, settings: Mapping[str, Any], materials: Mapping[str, Any], factors: Mapping[str, Any], surface: str
    ) -> dict[str, Any]:
        """Return the parameters of a run, derived ones included; what a row says is in the settings already."""
        return run_parameters(settings, materials)

    def table_columns(self, parameters: Parameters) -> dict[str, Any]:
        """Return what follows from a row's settings."""
        inlet = parameters["inlet"]
        return {
            "feed_t_per_h": 3.6 * inlet["rate_kg_per_s"] if inlet else 0.0,
            "particle_scale": parameters["particle"]["scale"],
            "predicted_operation_h": parameters["derived"]["operation_s"] / SECONDS_PER_HOUR,
        }

    def surface_sections(self, parameters: Parameters) -> dict[str, Any]:
        """Return what the parts are made and checked from: not how they wear; of the run how long it may get, and how
        thick a liner is when it is changed.
        """
        parts = [
            {key: value for key, value in part.items() if key not in (*OF_WEAR, *RULES)} | _checked_rule(part)
            for part in parameters["parts"]
        ]
        derived = {key: parameters["derived"][key] for key in OF_DURATION}
        sections = super().surface_sections(parameters)
        return {**sections, "parts": parts, "derived": derived, **_checked_rule(parameters["operation"])}

    def check_files(self, runs: Sequence[Run]) -> None:
        """Raise ConfigError for a drawing without the solid that is named, or in a unit that makes it far too large."""
        for run in runs:
            self.run_stages(run.parameters, None)

    def slice_ends(self, parameters: Parameters) -> SliceEnds | None:
        """Return the ends of the slice in which a machine is periodic."""
        from bulkwear.postproc.wear.directions import SliceEnds

        ends = parameters["periodic"]
        return SliceEnds("xyz".index(ends["axis"]), ends["low_m"], ends["high_m"]) if ends else None

    def surface_mesh(self, geometry: Parameters) -> SurfaceMesh:
        """Return all parts as one surface, each in the frame it was drawn in, its sharp edges and hollows known as
        built. Raises ConfigError for a machine that cannot be simulated.
        """
        from bulkwear.postproc.wear.built_shape import with_built_shape
        from bulkwear.workflows.cases.equipment.machine_checks import check_machine, check_units
        from bulkwear.workflows.cases.equipment.surfaces import machine_surface, on_ends, open_ends

        try:
            surface = on_ends(machine_surface(geometry["parts"]), geometry)
        except ConfigError:
            check_units(geometry)  # a wrong unit may be why
            raise
        check_machine(geometry, surface)
        return with_built_shape(open_ends(surface, geometry))

    # ---------------------------------------------------------------- decks

    def run_in_steps(self, parameters: Parameters, bed: Parameters | None) -> int:
        """Return the time steps of the first block."""
        return parameters["derived"]["run_in_steps"]

    def deck(self, parameters: Parameters, bed: Parameters | None, span: Span | None, restart: str) -> str:
        """Return the deck of a block."""
        if span is None:
            return render("equipment_start", equipment_deck.equipment_start(parameters))
        return render("equipment", equipment_deck.equipment(parameters, span, restart))

    def piece_ends(self, parameters: Parameters, bed: Parameters | None, span: Span | None) -> list[int]:
        """Return the step that ends a block; steps are counted through all blocks."""
        begin = parameters["derived"]["run_in_steps"]
        return [begin + span.end if span else begin]

    def write_shared_files(self, parameters: Parameters, bed: Parameters | None, surface: Path, folder: Path) -> None:
        """Write outlets and domain."""
        equipment_deck.write_shared(parameters, read_surface(surface), folder)

    def write_cycle_files(self, parameters: Parameters, span: Span | None, folder: Path) -> None:
        """Write the inlet, which every block has its own of."""
        equipment_deck.write_feed(parameters, span.cycle if span else 0, folder)

    def pieces(self, parameters: Parameters, span: Span | None, surface: SurfaceMesh) -> list[Piece]:
        """Return the parts where their motion has taken them when the block begins."""
        from bulkwear.workflows.cases.equipment.surfaces import faces_of

        begin = (parameters["derived"]["run_in_steps"] + span.first_step) if span else 0
        time, found = begin * parameters["derived"]["time_step_s"], []
        for number, part in enumerate(parameters["parts"]):
            triangles = np.flatnonzero(faces_of(surface, number, part))
            frame = SurfaceMesh(surface.points, surface.triangles[triangles])
            placed = SurfaceMesh(motion_of(part["motion"]).placed(surface.points, time), frame.triangles)
            name = part["name"]
            files = (f"{name}.stl", f"load_ledger_{name}.bin", f"loads_{name}")
            found.append(Piece(placed, triangles, equipment_deck.mesh_name(part), *files, frame))
        return found

    def laws(self, parameters: Parameters) -> list[tuple[str, dict[str, float]]]:
        """Return the wear laws of the parts, each with its parameters."""
        return laws_of(parameters)

    # ---------------------------------------------------------------- wear

    def next_span(self, parameters: Parameters, states: Sequence[Mapping[str, Any]]) -> Span | None:
        """Return the next block, see `phases.next_block`."""
        return next_block(parameters, states)

    def law_volume(self, parameters: Parameters, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame) -> np.ndarray:
        """Return what each part's law makes of a block's ledger, for the operation that its wear stands for."""
        from bulkwear.workflows.cases.equipment.blocks import duration_s, rate_volume

        return rate_volume(parameters, surface, ledger) * (span.stands_for_s / duration_s(parameters, span))

    def local_thickness(self, parameters: Parameters, surface: SurfaceMesh) -> Mapping[int, float]:
        """Return the liners' thickness (m) by label; that of others is measured."""
        from bulkwear.workflows.cases.equipment.blocks import given_thickness

        return given_thickness(parameters)

    def part_name(self, parameters: Parameters, label: int) -> str:
        """Return the name of the part with that label."""
        return parameters["parts"][label if label >= 0 else -1 - label]["name"]

    # ---------------------------------------------------------------- what a block leaves

    def forces(self, parameters: Parameters, span: Span, folder: Path) -> pd.DataFrame:
        """Return the block's table by parts."""
        from bulkwear.workflows.cases.equipment.blocks import part_rows

        return part_rows(parameters, span, *_left(span, folder))

    def own_columns(self, parameters: Parameters, span: Span, folder: Path) -> dict[str, float]:
        """Write the block's tables of patches and of the flow, and return what decides the next block.

        Raises CycleError where the machine was not filled as asked, and where particles were lost elsewhere than
        through an outlet.
        """
        from bulkwear.workflows.cases.equipment import blocks, flow
        from bulkwear.workflows.cases.equipment.steadiness import is_steady

        left = _left(span, folder)
        rows = blocks.patch_rows(parameters, span, folder.parent, *left)
        rows.to_csv(folder / blocks.PATCHES, index=False)
        last = flow.flow_table(parameters, folder)
        last.to_csv(folder / flow.FLOW, index=False)
        if fault := flow.filling_phrase(parameters, folder.parent) or flow.lost_phrase(parameters, folder, last):
            raise CycleError(f"{folder.parent.name}, cycle {span.cycle}: {fault}.")
        before = blocks.patch_tables(folder.parent, span.cycle - 1)
        tables = [table for table in [*before, rows] if table["phase"].iloc[0] != "start_up"]
        sampled = [table for table in tables if table["phase"].iloc[0] == "pristine"]
        whole = flow.whole_flow(folder.parent, parameters, span.cycle - 1, last)
        return {
            "phase": rows["phase"].iloc[0],
            "operation_h": span.operation_s / SECONDS_PER_HOUR,
            "stands_for_h": span.stands_for_s / SECONDS_PER_HOUR,
            "steady": int(is_steady(parameters, whole)),
            "deciding_width": blocks.deciding_width(parameters, sampled),
            "fastest_step_per_s": max(
                blocks.fastest_step_per_s(parameters, tables),
                blocks.held_back_per_s(parameters, span, *left) if tables else 0.0,
            ),
            "held_mass_kg": float(last["held_mass_kg"].iloc[-1]),
            "lost_particles": flow.lost_particles(last),
        }

    def summary(
        self, design: Path, wear: Sequence[Path], pristine: Sequence[Path], worn: Sequence[Path]
    ) -> pd.DataFrame:
        """Return the table of summary.csv, a row per run."""
        from bulkwear.workflows.cases.equipment.tables import summary

        return summary(design, wear, pristine, worn)

    # ---------------------------------------------------------------- cost

    def run_stages(self, parameters: Parameters, bed: Parameters | None) -> tuple[Stage, ...]:
        """Return the stages of a run as long as it may get."""
        from bulkwear.workflows.cases.equipment.work import run_stages

        return run_stages(parameters)

    def run_bytes(self, parameters: Parameters) -> float:
        """Return what a run leaves on disk."""
        from bulkwear.workflows.cases.equipment.work import run_bytes

        return run_bytes(parameters)


register(Equipment())


def _checked_rule(section: Parameters) -> dict[str, Any]:
    """Return a rule of change-out as drawings are checked by it: what shall remain of a thickness, of others which."""
    return {name: value if name == REMAINING else True for name, value in given_rule(section).items()}


def _left(span: Span, folder: Path) -> tuple[SurfaceMesh, pd.DataFrame]:
    """Return the surface that a block went on with, and its ledger; folder: of the block."""
    import pandas as pd

    from bulkwear.postproc.readers.load_ledger import TABLE

    before = folder.parent if span.cycle == 1 else folder.with_name(f"cycle_{span.cycle - 1:03d}")
    return read_surface(before / "surface.vtu"), pd.read_parquet(folder / TABLE)
