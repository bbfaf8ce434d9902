"""The bed that the ledger's benchmarks share: the demo's convex sample, run in, with one wear cycle to simulate."""

from __future__ import annotations

from pathlib import Path

from postproc.mesh import SurfaceMesh, read_surface, write_surface
from postproc.readers.solver_log import thermo_table
from workflows.config.design import Study, load_study
from workflows.config.patterns import sample_surface
from workflows.engine import state
from workflows.engine.chain import RESTART, Chain, run_in_steps, write_cycle, write_shared_files
from workflows.engine.cycles import fill_bed, run_cycle
from workflows.engine.inputs import inputs_digest
from workflows.engine.progress import Progress
from workflows.engine.schedule import first_span
from workflows.engine.solver import LOG

STUDY, RUN = "demo", "R9_convex"


def prepared_chain(folder: Path, particle_scale: float, wider: int = 1) -> Chain:
    """Return the chain of the case; fills its bed and runs it in unless that was done in this folder before.

    wider: as many times as wide are bed and sample, and so many ranks prepare them
    """
    study = case_study(particle_scale, wider)
    parameters, bed_name = study.run(RUN).parameters, study.bed_of(RUN)
    bed_folder, surface = folder / "bed", folder / RUN / "surface.vtu"
    if not (bed_folder / "bed.restart").exists():
        fill_bed(study.case, bed_name, study.beds[bed_name], bed_folder, ranks=wider)
    if not surface.exists():
        surface.parent.mkdir(parents=True, exist_ok=True)
        write_surface(surface, sample_surface(parameters["sample"], parameters["pattern"]))
    chain = Chain(
        RUN, surface.parent, study.case, parameters, surface, study.beds[bed_name], bed_folder / "bed.restart", wider
    )
    if not (state.cycle_folder(chain.folder, 0) / RESTART).exists():
        run_cycle(chain, None, inputs_digest(chain), Progress(RUN, run_in_steps(chain)))
    return chain


def case_study(particle_scale: float, wider: int = 1) -> Study:
    """Return the study of the case, bed and sample so many times as wide."""
    size = {"particle_scale": particle_scale, "fidelity": "quick"}
    settings = load_study(STUDY, overrides=size).settings
    widths = {name: {"width_mm": wider * settings[name]["width_mm"]} for name in ("sample", "bed")}
    return load_study(STUDY, overrides=size | widths)


def cycle_deck(chain: Chain, name: str) -> tuple[Path, SurfaceMesh, str]:
    """Return a new folder beside the run's cycles with what its first wear cycle reads, its surface, and the deck."""
    folder, surface = chain.folder / name, read_surface(chain.surface)
    folder.mkdir(exist_ok=True)
    write_shared_files(chain)
    write_cycle(chain, first_span(chain.parameters), folder, surface)
    return folder, surface, (folder / "deck.in").read_text()


def particles_of(chain: Chain) -> int:
    """Return the number of particles of a prepared chain."""
    return int(thermo_table(state.cycle_folder(chain.folder, 0) / LOG)["Atoms"][-1])
