"""The driver of a run: solver restart -> load ledger -> wear -> displaced mesh, cycle by cycle, resumable.

Every step is a plain function of the files of a cycle's folder (chain.py, accounting.py); here they are strung
together.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from bulkwear.postproc.mesh import SurfaceMesh, read_surface, write_surface
from bulkwear.postproc.readers.dump_text import ContactDumpError
from bulkwear.postproc.readers.load_ledger import LoadLedgerError, announcement
from bulkwear.postproc.readers.mesh_loads import MeshLoadsError
from bulkwear.postproc.readers.restart_file import RestartFileError, read_restart
from bulkwear.postproc.readers.solver_log import SolverLogError, last_step, solver_version, thermo_table, warnings
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.accounting import HISTORY, LEDGER, account_and_wear
from bulkwear.workflows.engine.beds import bed_fault, write_measures
from bulkwear.workflows.engine.case import Case
from bulkwear.workflows.engine.chain import (
    RESTART,
    SURFACE,
    WORN_THROUGH,
    Chain,
    run_in_steps,
    span_of,
    steps_before,
    surface_before,
    title,
    total_steps,
    write_bed,
    write_cycle,
    write_shared_files,
)
from bulkwear.workflows.engine.disk import (
    FEW,
    LAST_RESTARTS,
    RESTART_EVERY,
    check_room,
    folder_bytes,
    is_full,
    whole_restart,
)
from bulkwear.workflows.engine.inputs import SIMULATED_FROM, inputs_digest, simulated_from, why_again
from bulkwear.workflows.engine.job import Progress, write_table
from bulkwear.workflows.engine.ledgers import SamplesError, producer
from bulkwear.workflows.engine.own_kernels import own_library
from bulkwear.workflows.engine.patience import PATIENCE, Patience
from bulkwear.workflows.engine.pieces import Piece, finished_pieces, forget_pieces, simulate_in_pieces
from bulkwear.workflows.engine.provenance import PROVENANCE, provenance, simulating_code, write_provenance
from bulkwear.workflows.engine.row_check import RowCheck
from bulkwear.workflows.engine.schedule import Span, known_spans
from bulkwear.workflows.engine.series import write_series
from bulkwear.workflows.engine.solver import (
    LAUNCHER,
    LOG,
    SCREEN,
    SolverError,
    cycle_fault,
    executable_of,
    processor_seconds,
    run_deck,
)
from bulkwear.workflows.engine.wear_step import worn_surface

WORN_SURFACE = "worn_surface.vtu"
OWN_TIME = "other_processor_s"  # of a cycle's cost; cycles of earlier versions lack it
# Faults of what the solver left: only another simulation mends it, as after a disk that was full for a moment.
UNREADABLE = (LoadLedgerError, MeshLoadsError, ContactDumpError, SamplesError, SolverLogError)
BED_RESTART = "bed.restart"
ROOM_MARGIN = 1.5  # -, over the disk that the cycle before has taken
# Of the decks of beds, where they have them.
BED_STEPS = ("settling_steps", "packing_steps", "lowering_steps", "steady_steps")


def run_chain(chain: Chain) -> None:
    """Run what is missing of a run, then write its wear.csv and cost.csv. Resumes after the last finished cycle.

    Raises SolverError, StateError, DiskError, WearError or a reader's error; finished cycles stay, they are not done
    again.
    """
    announce = Progress(chain.name, 1).say
    with state.only_driver(chain.folder, announce):
        inputs = inputs_digest(chain)
        why = why_again(chain.folder, simulated_from(chain.case, chain.parameters, chain.bed))
        if moved := state.set_aside_others(chain.folder, inputs):
            announce(f"{why}; {moved}" if why else moved)
        if moved := state.fit_length(chain.folder, inputs, cycles_of(chain)):
            announce(moved)
        if chain.same_as and (shared := state.share_cycles(chain.folder, chain.same_as, inputs)):
            announce(f"is the same simulation as {chain.same_as.name} and shares {shared} cycles with it")
        finished = finished_cycles(chain, inputs, announce)
        span = span_of(chain, finished) if finished else None
        unfinished = finished == 0 or span is not None
        if unfinished and (fault := cycle_fault(cycle_executable(chain), chain.case, chain.parameters)):
            raise SolverError(fault)
        progress = Progress(chain.name, total_steps(chain), steps_before(chain, span))
        if finished and unfinished:
            announce(f"resumes after {title(chain, finished - 1)}")
        if not finished:
            run_cycle(chain, None, inputs, progress)
            finished = finished_cycles(chain, inputs, announce)
            span = span_of(chain, finished)
        for cycle in range(1, finished - 1):
            drop_files(chain, cycle)
        drop_restarts(chain, finished)
        while span:
            run_cycle(chain, span, inputs, progress)
            drop_files(chain, span.cycle - 1)
            finished += 1
            drop_restarts(chain, finished)
            if state.cycle_folder(chain.folder, finished).exists():  # they follow one that was damaged
                finished = finished_cycles(chain, inputs, announce)
            span = span_of(chain, finished)
        write_products(chain, finished)


def finished_cycles(chain: Chain, inputs: str, announce: Callable[[str], None]) -> int:
    """Return how many cycles of a run are finished such that the next one can go on from them.

    Where the last one's restart file is not whole, and its state was written nevertheless, it is made again.
    """

    def usable(folder: Path) -> bool:
        try:
            read_restart(folder / RESTART)
        except RestartFileError as fault:
            announce(f"{fault} {folder.name} is made again.")
            return False
        return True

    return state.finished_cycles(chain.folder, inputs, (RESTART, SURFACE), usable, RowCheck().fault, announce)


def cycles_of(chain: Chain) -> int | None:
    """Return how many cycles a run has, cycle 0 included, where the case lets it be lengthened; else None."""
    return len(known_spans(chain.parameters)) + 1 if chain.case.length else None


def run_cycle(chain: Chain, span: Span | None, inputs: str, progress: Progress) -> None:
    """Simulate, account, wear and displace one cycle; cycle 0 (None) brings the run to its start, without wear."""
    started, own, cycle = time.monotonic(), time.process_time(), span.cycle if span else 0
    origin, code = origin_digest(chain, cycle, inputs), simulating_code(chain.case)
    with state.working_folder(chain.folder, cycle, lambda part: bool(finished_pieces(part, origin))) as folder:
        before = folder_bytes(state.cycle_folder(chain.folder, cycle - 1)) if cycle else 0
        check_room(folder, ROOM_MARGIN * before, f"{chain.name}, {title(chain, cycle)}")
        if not span and chain.bed_restart:
            whole_restart(chain.bed_restart)
        surface = read_surface(surface_before(chain, cycle))
        started -= sum(piece.wall_s for piece in finished_pieces(folder, origin))
        write_shared_files(chain)
        triangles = write_cycle(chain, span, folder, surface)
        pieces = simulate(chain, span, folder, triangles, progress, origin)
        record, spent = accounted(chain, span, folder, surface) if span else ({"cost": {}}, [])
        if through := record.get(WORN_THROUGH):
            progress.say(f"{title(chain, cycle)}: {through}")
        if turned := record.get("wear", {}).get("turned_faces"):
            progress.say(f"{title(chain, cycle)}: {turned} faces looked away from the particles and were turned")
        spent_s = time.monotonic() - started, time.process_time() - own
        record["cost"] = cost(chain, span, folder, sum(triangles.values()), pieces, *spent_s) | record["cost"]
        record |= {
            "span": asdict(span) if span else None,
            **chain.case.record(chain.parameters, chain.bed, span),
            PROVENANCE: provenance(code, cycle_executable(chain), record["cost"]),
            "solver": solver_version(folder / SCREEN),
            "solver_ledger": announcement(folder / SCREEN),
            "solver_warnings": warnings(folder / SCREEN),
        }
        if inputs_digest(chain) != inputs:
            raise state.StateError(f"{chain.name}: its inputs changed while {title(chain, cycle)} ran; start again.")
        kept = (*producer(chain.parameters).kept, *chain.case.kept)
        files = (RESTART, SURFACE, LEDGER, HISTORY, chain.case.forces_table, *kept) if span else (RESTART,)
        if span is None:
            found = simulated_from(chain.case, chain.parameters, chain.bed)
            (folder / SIMULATED_FROM).write_text(json.dumps(found, indent=1) + "\n")
        state.write_state(folder, inputs, files, record)
        forget_pieces(folder)  # before anything that a repeated accounting would miss
        for path in spent:
            path.unlink()


def accounted(chain: Chain, span: Span, folder: Path, surface: SurfaceMesh) -> tuple[dict[str, Any], list[Path]]:
    """Account and wear a simulated cycle, see `account_and_wear`; where what the solver left cannot be read, nothing of
    its simulation counts any more.
    """
    try:
        return account_and_wear(chain, span, folder, surface)
    except UNREADABLE as fault:
        if not is_full(fault):
            forget_pieces(folder)
        raise type(fault)(f"{fault} The next start simulates {title(chain, span.cycle)} again.") from fault


def drop_files(chain: Chain, cycle: int) -> None:
    """Remove what the case does not keep of a cycle that has a successor."""
    folder = state.cycle_folder(chain.folder, cycle)
    span = state.read_state(chain.folder, cycle)["span"]
    state.drop_files(folder, chain.case.files_to_drop(chain.parameters, Span(**span) if span else None))


def drop_restarts(chain: Chain, finished: int) -> None:
    """Remove restart files of finished cycles, but for those of cycle 0 and of the last two, from which a run is
    resumed, and of every tenth, so that little is done again where a file between them turns out to be damaged.
    """
    if chain.parameters["solver"]["kept_restarts"] != FEW:
        return
    folders = {cycle: state.cycle_folder(chain.folder, cycle) for cycle in range(1, finished)}
    with_restart = [cycle for cycle, folder in folders.items() if (folder / RESTART).exists()]
    for cycle in with_restart[:-LAST_RESTARTS]:
        if cycle % RESTART_EVERY:
            state.drop_files(folders[cycle], (RESTART,))


def origin_digest(chain: Chain, cycle: int, inputs: str) -> str:
    """Return the hash of what a cycle starts from: the run's inputs and the state of the cycle before."""
    before = state.cycle_folder(chain.folder, cycle - 1) / state.STATE
    return state.digest(inputs, state.file_digest(before)) if cycle else inputs


def simulate(
    chain: Chain,
    span: Span | None,
    folder: Path,
    triangles: Mapping[str, int],
    progress: Progress,
    origin: str = "",
) -> list[Piece]:
    """Run the solver on a cycle's deck, or on the pieces of it that are missing; return all pieces.

    triangles: {id of a mesh: number of its triangles}; origin: hash of what the cycle starts from. Raises SolverError.
    """
    cycle, before = span.cycle if span else 0, steps_before(chain, span)
    substeps, counted = span.substeps if span else 1, before if chain.case.counts_on else 0

    def run(variables: Mapping[str, str]) -> float:
        if "begin" in variables:
            progress.say(f"{title(chain, cycle)} goes on after step {variables['begin_step']}")
        return run_deck(
            folder,
            chain.ranks,
            lambda step: progress.update(before + (step - counted) // substeps, title(chain, cycle)),
            triangles=triangles,
            executable=cycle_executable(chain),
            launcher=chain.launcher,
            variables=variables,
            patience=replace(chain.patience, say=progress.say),
            search=chain.parameters["solver"]["search"],
            own_kernels=own_kernels(chain),
        )

    ends = chain.case.piece_ends(chain.parameters, chain.bed, span)
    return simulate_in_pieces(folder, origin, ends, run)


def own_kernels(chain: Chain) -> Path | None:
    """Return the library of the contact kernels that a run's project has in C++; none where contacts are sampled."""
    summed = chain.parameters["ledger"] == "solver"
    return own_library(chain.case.kernels(chain.parameters)) if summed else None


def cycle_executable(chain: Chain) -> str:
    """Return the program that simulates the cycles of a run. Cycle 0 has no ledger, but walls as the others have,
    and the program with our search for contacts takes less time for it.
    """
    return executable_of(chain.parameters, wears=True)


def cost(
    chain: Chain,
    span: Span | None,
    folder: Path,
    triangles: int,
    pieces: Sequence[Piece],
    all_seconds: float,
    own_seconds: float,
) -> dict[str, float]:
    """Return what a cycle cost: times in s and the sizes that they depend on.

    pieces: of its simulation; all_seconds: wall time of the cycle; own_seconds: processor time of the driver itself,
    since it was last started
    """
    thermo = thermo_table(folder / LOG)
    solver_seconds = sum(piece.wall_s for piece in pieces)
    return {
        "cycle": span.cycle if span else 0,
        "solver_s": round(solver_seconds, 3),
        "processor_s": round(sum(piece.processor_s for piece in pieces), 3),
        "other_s": round(all_seconds - solver_seconds, 3),
        OWN_TIME: round(own_seconds, 3),
        "steps": span.solver_steps if span else run_in_steps(chain),
        "particles": int(thermo["Atoms"][-1]),
        "triangles": triangles,
        "ranks": chain.ranks,
        "ledger_bytes": 0,
    }


def write_products(chain: Chain, finished: int) -> None:
    """Write wear.csv, cost.csv, worn_surface.vtu and cycles.pvd of a run from what its finished cycles left."""
    states = [state.read_state(chain.folder, cycle) for cycle in range(finished)]
    write_table(chain.folder / "wear.csv", [found["wear"] for found in states[1:]])
    free = dict.fromkeys(("solver_s", "processor_s", "other_s", OWN_TIME), 0.0)  # what another run has paid for
    costs = [found["cost"] | (free if "shared_with" in found else {}) for found in states]
    write_table(chain.folder / "cost.csv", [{**each, OWN_TIME: each.get(OWN_TIME, math.nan)} for each in costs])
    write_surface(chain.folder / WORN_SURFACE, worn_surface(chain, Span(**states[-1]["span"])))
    write_series(chain.folder, SURFACE, range(1, finished))


def fill_bed(
    case: Case,
    name: str,
    bed: Mapping[str, Any],
    folder: Path,
    ranks: int = 1,
    launcher: str = LAUNCHER,
    patience: Patience = PATIENCE,
) -> None:
    """Fill and settle a bed; leaves bed.restart, provenance.json, cost.csv and its measures in the folder.

    Raises SolverError, also for a bed that is not as asked.
    """
    parameters = case.bed_deck(bed)
    total = sum(parameters.get(name, 0) for name in BED_STEPS)
    progress, code = Progress(name, total), simulating_code(case)
    with state.only_driver(folder, progress.say):
        write_bed(case, bed, folder)
        (folder / BED_RESTART).unlink(missing_ok=True)  # of an earlier filling: it would count as this one's
        before = processor_seconds()
        program = executable_of(bed)
        seconds = run_deck(
            folder,
            ranks,
            lambda step: progress.update(step, "filling and settling"),
            executable=program,
            launcher=launcher,
            patience=replace(patience, say=progress.say),
        )
        if not (folder / BED_RESTART).exists():  # asked to end, the solver ends without a fault
            step = last_step(folder / SCREEN)
            raise SolverError(f"{folder / SCREEN}: LIGGGHTS ended at step {step} without {BED_RESTART}; start again.")
        whole_restart(folder / BED_RESTART)
    measures = case.bed_measures(bed, folder / LOG)
    write_measures(measures, folder)
    if fault := bed_fault(measures):
        raise SolverError(f"{folder / LOG}: {fault}.")
    particles = int(thermo_table(folder / LOG)["Atoms"][-1])
    processor = round(processor_seconds() - before, 3)
    row = {"solver_s": round(seconds, 3), "processor_s": processor, "steps": total, "particles": particles}
    write_provenance(folder, provenance(code, program, row) | {"solver": solver_version(folder / SCREEN)})
    write_table(folder / "cost.csv", [row])
