"""Remake every page of results in docs from its runs, or say which are older than the code and what redoing them costs.

    make results                                  # a line per page; pages whose runs are in results/ are written anew
    make results RUN=1 PAGE=screening_results_quick    # simulates what is missing first, of one page or of all

In the repository, where docs/results.json lists the pages. Writes docs/results.md, and a warning below the title of
each page whose simulations are older than the code.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from bulkwear.workflows.config.chosen import ROWS
from bulkwear.workflows.config.design import Study, load_study
from bulkwear.workflows.config.packings import PACKINGS
from bulkwear.workflows.engine.project import work_here
from bulkwear.workflows.engine.provenance import code_of_cases
from bulkwear.workflows.engine.work import Work
from bulkwear.workflows.forecast.forecast import forecast_table, hours_text, totals, work_of
from bulkwear.workflows.forecast.rates import rates_file, read_rates
from bulkwear.workflows.report.markdown import (
    as_decided,
    fidelity_that_was_run,
    origin_of,
    versions_in_folder,
    write_results,
)
from bulkwear.workflows.report.provenance_of_pages import (
    Origin,
    ResultsError,
    keep_origin,
    older,
    read_changes,
    read_origins,
)
from bulkwear.workflows.report.simulated import warnings_of
from bulkwear.workflows.report.spot_checks import read_checks
from bulkwear.workflows.results.commands import WRITTEN, call, remake_by_command
from bulkwear.workflows.results.index import mark, redo

PROFILE = "workflows/profiles/default"
GO_ON = "What is begun goes on by the present code, and the page is of both; for one of the present code alone move"
PENDING = "update pending"  # what Snakemake's summary plans for a file


class RemakeError(RuntimeError):
    """A page could not be remade; the message says what failed."""


def study_command(study: str, origin: Origin, cores: int, *words: str) -> list[str]:
    """Return the command that makes a study as a page has it."""
    settings = [f"{key}={json.dumps(value)}" for key, value in origin.overrides.items()]
    command = [sys.executable, "-m", "snakemake", "--workflow-profile", PROFILE, "--cores", str(cores), study, *words]
    return [*command, *(["--config", *settings] if settings else [])]


def pending_files(summary: str) -> list[tuple[str, str]]:
    """Return (rule, file) of what Snakemake would make, from its table of files (`--summary`)."""
    head, *rows = [line.split("\t") for line in summary.splitlines() if "\t" in line]
    rule, plan = head.index("rule"), head.index("plan")
    return [(row[rule], row[0]) for row in rows if row[plan] == PENDING]


def missing_work(study: Study, pending: Sequence[tuple[str, str]] | None) -> list[Work]:
    """Return the jobs of a study that call the solver and whose files are pending; None: all of them are.

    A job is named after its rule and what stands for its wildcards, which is a part of its files' paths.
    """
    if pending is None:
        return list(work_of(study.foreseen))
    work = work_of(study)
    return [job for job in work if any(_makes(job.name, rule, file) for rule, file in pending)]


def _makes(job: str, rule: str, file: str) -> bool:
    return job == rule or (job.startswith(f"{rule}_") and job.removeprefix(f"{rule}_") in Path(file).parts)


def pending_of(origin: Origin, cores: int) -> list[tuple[str, str]] | None:
    """Return `pending_files` of a page's study; None where none of it was run here. Raises RemakeError."""
    if not (Path("results") / origin.study / "design.csv").is_file():
        return None
    done = subprocess.run(study_command(origin.study, origin, cores, "--summary"), capture_output=True, text=True)
    if done.returncode != 0:
        raise RemakeError(f"snakemake cannot plan {origin.study}:\n{done.stderr.strip()}")
    return pending_files(done.stdout)


def cost_words(work: Sequence[Work], cores: int) -> str:
    """Return in words what jobs cost by forecast. Raises RatesError."""
    sums = totals(forecast_table(work, read_rates(rates_file()).rates), cores)
    return f"about {sums['core_h']:.2g} core hours, {hours_text(sums['wall_h'])} on {cores} cores"


def remake_study(origin: Origin, docs: Path, cores: int, run: bool) -> str:
    """Write the page of a study from its runs; return what was done, or what is missing and what it costs."""
    study = load_study(origin.study, overrides=origin.overrides)
    folder = Path("results") / origin.study
    settings = {name: value for name, value in origin.settings.items() if name not in (ROWS, PACKINGS)}
    ran_here = fidelity_that_was_run(folder) in (None, study.fidelity)
    pending = pending_of(origin, cores) if ran_here else None
    missing = missing_work(study.foreseen, pending)
    begun = [] if pending is None else begun_by_older_code(folder, study, origin.case)
    solving = pending is None or any(rule in study.case.solver_rules for rule, _ in pending)
    if solving and not run:
        what = f"{len(missing)} jobs of the solver are not done in results/{origin.study}"
        return f"{what}; redoing costs {cost_words(missing, cores)}: {' '.join([redo(origin), *begun])}"
    if solving and begun:
        print(f"{origin.page}: {' '.join(begun)}", file=sys.stderr, flush=True)
    if pending or pending is None:
        call(study_command(origin.study, origin, cores))
    if origin.figure:
        shutil.copyfile(folder / "figures" / f"{origin.figure}.png", docs / origin.page)
        keep_origin(docs, origin_of(origin.page, folder, as_decided(study, folder), settings))
    else:
        write_results(folder, docs, as_decided(study, folder), settings)
    return f"{WRITTEN} results/{origin.study}"


def begun_by_older_code(folder: Path, study: Study, case: str) -> list[str]:
    """Return the sentences about what older code has simulated in a study's folder; none where no part is newer."""
    found = warnings_of(versions_in_folder(folder, study), code_of_cases((case,)), [case])
    return [*found, f"{GO_ON} {folder} away."] if found else []


def remake(docs: Path, page: str, run: bool, cores: int) -> None:
    """Remake all pages, or one, and print a line for each; faults of single pages go to standard error."""
    changes = read_changes(docs)
    print(f"Forecasts by {read_rates(rates_file()).said()}.")
    for origin in chosen(read_origins(docs), page):
        try:
            done = remake_by_command(origin, docs, run) if origin.command else remake_study(origin, docs, cores, run)
        except (ValueError, RuntimeError, OSError) as fault:
            print(f"{origin.page}: {fault}", file=sys.stderr)
            continue
        found = next(each for each in read_origins(docs) if each.page == origin.page)
        stale = older(found, changes, code_of_cases((found.case,)), read_checks(docs))
        state = "older than the code" if stale else "as new as the code"
        again = f", whose runs no job does again; {anew(found, cores)}" if stale and WRITTEN in done else ""
        print(f"{origin.page}: {state}; {done}{again}", flush=True)
    mark(docs, changes)


def anew(origin: Origin, cores: int) -> str:
    """Return what simulating a page anew takes whose runs are finished, though by older code."""
    if origin.command:
        return f"to simulate them anew move {origin.runs or 'what it kept'} away: {redo(origin)}"
    cost = cost_words(missing_work(load_study(origin.study, overrides=origin.overrides).foreseen, None), cores)
    return f"to simulate them anew ({cost}) move results/{origin.study} away: {redo(origin)}"


def chosen(origins: Sequence[Origin], page: str) -> list[Origin]:
    """Return those pages, or the one that is named with or without its ending. Raises ResultsError."""
    found = [each for each in origins if page in ("", each.page, Path(each.page).stem)]
    if not found:
        names = ", ".join(Path(each.page).stem for each in origins)
        raise ResultsError(f"PAGE is {page}, allowed is one of {names}.")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="where the pages are")
    parser.add_argument("--page", default="", help="one page alone")
    parser.add_argument("--run", action="store_true", help="simulate what is missing first")
    parser.add_argument("--cores", type=int, default=os.cpu_count(), help="for simulations and their forecast")
    given = parser.parse_args()
    try:
        work_here()
        remake(given.docs, given.page, given.run, given.cores)
    except (ValueError, RuntimeError) as fault:
        sys.exit(str(fault))


if __name__ == "__main__":
    main()
