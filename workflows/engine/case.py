"""What a case tells the rest of the workflow: a class with one method for everything that differs between cases, and
the cases that there are.

A case turns settings and design rows into runs, makes the decks of a run's cycles and reads what they leave; the loop
over cycles, wear, state and tables know no case. What most cases have in common is the default here. Modules that are
slow to import and needed in jobs only are imported where they are used: every job of Snakemake reads the studies first.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.caps import edge_limit
from bulkwear.postproc.wear.kernel_sums import kernel_sums
from bulkwear.workflows.engine.derived import law_parameters, law_volume, laws_beside
from bulkwear.workflows.engine.schedule import Span, first_span, next_span
from bulkwear.workflows.engine.work import Stage, Work
from bulkwear.workflows.engine.worn_pair import BESIDE, COEFFICIENT_ERROR, ONLY_TOLD, WornPair, pair_of_section

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.postproc.wear.directions import SliceEnds
    from bulkwear.workflows.engine.beds import BedMeasure

CASES_PACKAGE = "bulkwear.workflows.cases"  # whose packages are the cases, each registered when it is imported
DEFAULT_CASE = "sliding_sample"  # of a study that names none
SURFACE_STL, LOAD_LEDGER, FORCES = "surface.stl", "load_ledger.bin", "forces.csv"
SETUP_LOADS, SETUP_BED = "loads_0.vtk", "bed_0.dump"  # of a cycle's first instant: the last one of the cycle before

Parameters = Mapping[str, Any]  # of a run or of a bed, SI


class CycleError(RuntimeError):
    """A cycle went wrong in a way that the solver did not notice; the message names run, cycle and what to do."""


@dataclass(frozen=True, eq=False)
class Piece:
    """What the solver gets of a surface as one of its meshes in a cycle.

    mesh: where it stands when the cycle begins; triangles: (k,) their numbers on the whole surface
    name: of the mesh in the decks, before the number of the cycle; stl, ledger, loads: names of its files, the last one
        without the step that ends it
    frame: the same facets in the frame of the ledger's vectors and positions, None where that is the solver's
    """

    mesh: SurfaceMesh
    triangles: np.ndarray
    name: str = "sample"
    stl: str = SURFACE_STL
    ledger: str = LOAD_LEDGER
    loads: str = "loads"
    frame: SurfaceMesh | None = None


@dataclass(frozen=True)
class Run:
    """One simulation: a row of the design with one surface, "" where the case knows no surfaces.

    `parameters` holds the sections of the case (see its `run_parameters`); SI, the unit is the suffix of the key.
    """

    name: str
    row: str
    surface: str
    parameters: dict[str, Any]


class Case:
    """A case; subclasses override what they need, and their module registers one of them.

    name: of its folder, and in studies; a case that extends another one also has what that one's folder has: schemas,
        defaults, page, figures, rules
    material_keys: (section, key, kind in materials.yaml) of the settings that name a material
    checks: of a run, see run_checks.py
    run_templates: names of the templates of a run's decks; bed_template: of the deck of a bed; more_templates: of
        simulations beside the runs
    worn_pair: paths of the settings that name the wall that wears and what wears it; none where several parts do
    alternatives: two settings of which exactly one is given; the stronger layer's replaces the other
    geometry: sections of a run's parameters that its pristine surface depends on
    consumed: sections of a run's parameters that the driver reads besides decks, surface and bed, see inputs.py
    length: (section, key) of a run's parameters that only say after how many of its equal cycles it ends; a longer run
        goes on from the cycles of a shorter one
    only_told: keys of the parameters that tables and pages read, and no simulation
    first_title: what people call cycle 0
    leftovers: files that a wear cycle's solver leaves and nobody needs once the cycle is accounted
    kept: files that `reduce` leaves, without which a wear cycle is not whole
    seed_setting: that seeds the bed which a run starts from, a column of the design may have its place; "" without
        beds, where a setting has one packing, for the reason `one_packing`
    figure_modules: of its folder, that declare figures and tables (`workflows.report.products`), in a page's order
    shared_figures: names of those of `workflows.report.products.SHARED` that it shows, after its own
    run_rules: rules that make a job of every run
    solver_rules: those whose jobs call the solver
    counts_on: whether the solver's steps are counted through all cycles of a run, not from the start of each
    forces_table: file of a cycle that holds the rows of `forces`
    by_part: whether parts wear as bodies of their own, in one surface
    rim_direction: in which nodes at the rim of what wears slide, None: along their normal, like others
    wears: whether its runs are wear cycles; else a study has no table of them, and what it says of its results and
        cost is its case's alone
    """

    name = ""
    material_keys: tuple[tuple[str, str, str], ...] = ()
    checks: tuple[Callable[..., Any], ...] = ()
    run_templates: tuple[str, ...] = ()
    bed_template = ""
    more_templates: tuple[str, ...] = ()
    worn_pair: tuple[tuple[str, ...], ...] = ()
    alternatives: tuple[tuple[str, str], ...] = ()
    geometry: tuple[str, ...] = ()
    consumed: tuple[str, ...] = ("wear", "remeshing", "sliding")
    length: tuple[tuple[str, str], ...] = ()
    only_told: tuple[str, ...] = (*ONLY_TOLD, COEFFICIENT_ERROR, BESIDE)
    first_title = ""
    leftovers: tuple[str, ...] = (SETUP_LOADS,)
    kept: tuple[str, ...] = ()
    seed_setting: str = ""
    one_packing: str = "runs start from no bed"
    figure_modules: tuple[str, ...] = ("figures",)
    shared_figures: tuple[str, ...] = ()
    run_rules: tuple[str, ...] = ("surface_mesh", "worn_run")
    solver_rules: tuple[str, ...] = ("settled_bed", "worn_run")
    wears: bool = True
    counts_on: bool = False
    forces_table: str = FORCES
    by_part: bool = False
    rim_direction: tuple[float, float, float] | None = None

    # ---------------------------------------------------------------- from settings to runs

    def surfaces(self, head: Mapping[str, Any]) -> Sequence[str]:
        """Return the surfaces of which each design row makes a run; `head` holds the keys that are the study's own."""
        return ("",)

    def named_materials(self, settings: Mapping[str, Any]) -> tuple[tuple[str, ...], ...]:
        """Return the path of each setting that names a material, and its kind."""
        return self.material_keys

    def looks_for(self, settings: Mapping[str, Any]) -> Collection[str]:
        """Return the parameters of materials that a study looks for, as `particle.contact.rolling_friction`."""
        return ()

    def worn_pairs(self, settings: Mapping[str, Any]) -> list[WornPair]:
        """Return what wears in a run of these settings; what they do not give yet is left out."""
        return [pair_of_section(settings, *self.worn_pair)] if self.worn_pair else []

    def needed_columns(self, surface: str) -> Sequence[str]:
        """Return the columns that a design needs for such a surface, besides those that its schema requires."""
        return ()

    def needed_pattern_keys(self, settings: Mapping[str, Any], surface: str) -> list[str]:
        """Return the keys that the section `pattern` of the settings needs for a run, besides those always required."""
        return []

    def design_fault(self, rows: Sequence[Mapping[str, Any]]) -> str | None:
        """Return what is wrong with a design as a whole, a phrase after the table's name, or None."""
        return None

    def run_parameters(
        self, settings: Mapping[str, Any], materials: Mapping[str, Any], factors: Mapping[str, Any], surface: str
    ) -> dict[str, Any]:
        """Return the parameters of a run, JSON-able; everything in SI, given and returned."""
        raise NotImplementedError

    def beds(self, runs: Sequence[Run]) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
        """Return {bed id: parameters} and {run: bed id}; nothing where runs start from no bed."""
        return {}, {}

    def table_columns(self, parameters: Parameters) -> dict[str, Any]:
        """Return the columns of design.csv that follow from a run's parameters."""
        return {}

    def surface_sections(self, parameters: Parameters) -> dict[str, Any]:
        """Return the parameters of a run that its pristine surface depends on: here the sections of `geometry`."""
        return {name: parameters[name] for name in self.geometry}

    def check_files(self, runs: Sequence[Run]) -> None:
        """Raise ConfigError for a file that runs are made from, where a look at it shows what is wrong with it."""

    def surface_mesh(self, geometry: Parameters) -> SurfaceMesh:
        """Return the pristine surface of a run from what `surface_sections` returns of its parameters."""
        raise NotImplementedError

    # ---------------------------------------------------------------- decks of a run

    def run_in_steps(self, parameters: Parameters, bed: Parameters | None) -> int:
        """Return the time steps of cycle 0."""
        raise NotImplementedError

    def deck(self, parameters: Parameters, bed: Parameters | None, span: Span | None, restart: str) -> str:
        """Return the deck of a wear cycle, or of cycle 0 (None).

        restart: path of the restart file it begins with, from its folder; "" where cycle 0 begins with none
        """
        raise NotImplementedError

    def sample_decks(self, parameters: Parameters, bed: Parameters | None) -> list[str]:
        """Return the decks of cycle 0 and of the first wear cycle as they are wherever the run's folder is."""
        return [self.deck(parameters, bed, span, restart="") for span in (None, first_span(parameters))]

    def piece_ends(self, parameters: Parameters, bed: Parameters | None, span: Span | None) -> list[int]:
        """Return the solver's steps in a cycle at which it ends and is started anew; the last one ends the cycle."""
        return [span.solver_steps if span else self.run_in_steps(parameters, bed)]

    def bed_deck(self, bed: Parameters) -> dict[str, Any]:
        """Return the parameters of the deck of a bed, whose template is `bed_template`."""
        raise NotImplementedError

    def slice_ends(self, parameters: Parameters) -> SliceEnds | None:
        """Return the ends of the periodic slice that a run's surface is cut by, if it is."""
        return None

    def bed_measures(self, bed: Parameters, log: Path) -> list[BedMeasure]:
        """Return what was asked of a bed and what the log of its deck says it has; a bed that misses one is refused."""
        return []

    def write_bed_files(self, bed: Parameters, folder: Path) -> None:
        """Write what the deck of a bed reads into its folder."""

    def write_shared_files(self, parameters: Parameters, bed: Parameters | None, surface: Path, folder: Path) -> None:
        """Write what the decks of all cycles of a run read besides surface and restart file into the run's folder.

        surface: file of the run's pristine surface
        """

    def write_cycle_files(self, parameters: Parameters, span: Span | None, folder: Path) -> None:
        """Write what the deck of a cycle, of cycle 0 for None, reads alone besides its surface into its folder."""

    def pieces(self, parameters: Parameters, span: Span | None, surface: SurfaceMesh) -> list[Piece]:
        """Return the meshes that the solver gets of the surface in a cycle; here all of it is one."""
        return [Piece(surface, np.arange(len(surface.triangles)))]

    def next_span(self, parameters: Parameters, states: Sequence[Mapping[str, Any]]) -> Span | None:
        """Return the span of the wear cycle after those that left these states, first one first; None after the last.

        Here all cycles are equal parts of the travel, or each is as long as the one before lets expect.
        """
        return next_span(parameters, Span(**states[-1]["span"]), states[-1]["wear"])

    def laws(self, parameters: Parameters) -> list[tuple[str, dict[str, float]]]:
        """Return the name of each wear law of a run with its parameters (SI), the coefficient included."""
        return [(parameters["wear"]["law"], law_parameters(parameters))] if "wear" in parameters else []

    def kernels(self, parameters: Parameters) -> dict[str, dict[str, float]]:
        """Return `kernel_sums` of the wear laws of a run and those beside them."""
        return kernel_sums([*self.laws(parameters), *laws_beside(parameters)])

    def law_volume(self, parameters: Parameters, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame) -> np.ndarray:
        """Return the volume (m,) m3 that the wear law makes of a cycle's ledger, a row per triangle of the surface,
        acceleration included.
        """
        return law_volume(parameters, ledger)

    def on_surface(self, parameters: Parameters, ledger: pd.DataFrame) -> pd.DataFrame:
        """Return a ledger in the frame of the master surface, where the solver's is another one."""
        return ledger

    def substeps(self, parameters: Parameters, wear: Mapping[str, float]) -> int:
        """Return in how many the solver takes each time step of a cycle whose predecessor left that row of wear.csv."""
        return 1

    def deck_files(self, runs: Sequence[str], beds: Sequence[str]) -> list[str]:
        """Return the decks of a study that are rendered without the solver, below results/<study>/decks."""
        return [*(f"{run}/cycle_000/deck.in" for run in runs), *(f"beds/{bed}/deck.in" for bed in beds)]

    # ---------------------------------------------------------------- what a study will cost

    def work(
        self, runs: Sequence[Run], beds: Mapping[str, Parameters], bed_of: Mapping[str, str], ranks: int
    ) -> tuple[Work, ...]:
        """Return the jobs of a study that call the solver, those that others need first; see `workflows.engine.work`.

        beds, bed_of: as from `beds`; here a job for each bed and one for each run, which costs nothing where a run
        before it has the same parameters
        """
        first = {bed_of[run.name]: run.parameters for run in reversed(runs) if run.name in bed_of}
        jobs = [
            Work("settled_bed", (name,), self.bed_stages(first[name], bed), "", ranks, 1, self.bed_bytes(first[name]))
            for name, bed in beds.items()
        ]
        for run in runs:
            bed, same = bed_of.get(run.name), next(each for each in runs if each.parameters == run.parameters)
            if same is not run:
                jobs.append(Work("worn_run", (run.name,), (), f"worn_run_{same.name}", ranks))
                continue
            stages = self.run_stages(run.parameters, beds.get(bed))
            needs = f"settled_bed_{bed}" if bed else ""
            jobs.append(Work("worn_run", (run.name,), stages, needs, ranks, 1, self.run_bytes(run.parameters)))
        return tuple(jobs)

    def further_work(self, study: Any) -> tuple[Work, ...]:
        """Return the jobs of a checked study that call the solver besides beds and runs."""
        return ()

    def bed_stages(self, parameters: Parameters, bed: Parameters) -> tuple[Stage, ...]:
        """Return the stages of filling a bed; parameters are those of a run that starts from it."""
        raise NotImplementedError

    def bed_bytes(self, parameters: Parameters) -> float:
        """Return what such a bed leaves on disk."""
        raise NotImplementedError

    def run_stages(self, parameters: Parameters, bed: Parameters | None) -> tuple[Stage, ...]:
        """Return the stages of a run; the last one is of its wear cycles."""
        raise NotImplementedError

    def run_bytes(self, parameters: Parameters) -> float:
        """Return what a run leaves on disk."""
        raise NotImplementedError

    # ---------------------------------------------------------------- what a cycle leaves

    def simulation_folders(self, folder: Path, runs: Sequence[str]) -> list[Path]:
        """Return the folders of a study's folder that hold cycles, one for each simulation; here those of its runs."""
        return [folder / run for run in runs]

    def record(self, parameters: Parameters, bed: Parameters | None, span: Span | None) -> dict[str, Any]:
        """Return what the state of a cycle tells besides that of all cases."""
        return {}

    def forces(self, parameters: Parameters, span: Span, folder: Path) -> pd.DataFrame:
        """Return the rows of forces.csv of a cycle from what the solver left in its folder."""
        raise NotImplementedError

    def own_columns(self, parameters: Parameters, span: Span, folder: Path) -> dict[str, float]:
        """Return the case's own columns of a cycle's row of wear.csv."""
        return {}

    def reduce(self, parameters: Parameters, span: Span, folder: Path) -> list[Path]:
        """Make tables of what a wear cycle wrote in bulk; return the files, leftovers aside, of no use from then on."""
        return []

    def cycle_fault(self, parameters: Parameters, own: Mapping[str, float]) -> str | None:
        """Return a phrase if a cycle went wrong unnoticed by the solver, from its own columns; else None."""
        return None

    def geometry_columns(self, before: SurfaceMesh, worn: SurfaceMesh, touched: np.ndarray) -> dict[str, float]:
        """Return columns of wear.csv from the surfaces before and after an update; touched: (m,) bool, what wears."""
        return {}

    def files_to_drop(self, parameters: Parameters, span: Span | None) -> tuple[str, ...]:
        """Return the files of a cycle that go when its successor is finished; here all are kept."""
        return ()

    def travel_columns(self, parameters: Parameters, time_s: np.ndarray | float) -> dict[str, np.ndarray | float]:
        """Return columns of the tables of wear that go on with time (s), in whose place a case counts; here none."""
        return {}

    def part_name(self, parameters: Parameters, label: int) -> str:
        """Return what people call the part with that label on the surface."""
        return str(label)

    def label_columns(self, surface: SurfaceMesh, volume: np.ndarray) -> dict[str, float]:
        """Return columns of the tables of wear by labels; volume: (m,) m3, 0 on faces that do not wear."""
        return {}

    # ---------------------------------------------------------------- bounds of a wear update

    def local_thickness(self, parameters: Parameters, surface: SurfaceMesh) -> Mapping[int, float] | float | None:
        """Return the thickness (m) of what wears, of all parts or by label, None where it is not known."""
        return parameters["wear"].get("local_thickness_m")

    def lasting_limit(self, parameters: Parameters, surface: SurfaceMesh) -> np.ndarray:
        """Return how far (n,) m each node may move in one update, however long the cycle."""
        return edge_limit(surface.points, surface.triangles, parameters["wear"]["largest_step_edge_fraction"])

    def closing_gap(self, parameters: Parameters, duration: float) -> float:
        """Return how far (m) any node may move in an update after a cycle of that duration (s)."""
        return np.inf

    def worn_through(self, worn: SurfaceMesh) -> str | None:
        """Return a phrase if the surface is worn further than the case allows, else None."""
        return None

    # ---------------------------------------------------------------- summary

    def summary(
        self, design: Path, wear: Sequence[Path], pristine: Sequence[Path], worn: Sequence[Path]
    ) -> pd.DataFrame:
        """Return the table of summary.csv, one row per run; all files in the order of the design's rows."""
        raise NotImplementedError


REGISTERED: dict[str, Case] = {}


def register(case: Case) -> Case:
    """Make a case known under its name; the module `case` of its folder does it. Raises TypeError for what is none."""
    if not isinstance(case, Case):
        raise TypeError(f"register takes an object of a class of cases, found {case!r}")
    REGISTERED[case.name] = case
    return case
