"""Simulate one row of a study again by the code that simulated its page and by today's: are the numbers the same?

    python -m benchmarks.spot_check                           # every page whose simulations are older than the code
    python -m benchmarks.spot_check --page chute_results_quick

Each version is cloned into a folder of its own (results/spot_checks/<commit>) and set up there; the first row of the
study's design runs at quick fidelity, one packing of it. Of bulk tests, in which nothing wears, a shear box runs. What
comes of it goes to docs/results_checks.json, and `make results` no longer calls such a page older than the code. Exit
code 1 where numbers differ or cannot be had.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from benchmarks import rolling_models
from benchmarks.command_line import command
from benchmarks.rolling_case import CALIBRATED, SHEAR_BOX
from benchmarks.same_results import compare, tables
from benchmarks.tilted_bed import REFERENCE
from benchmarks.tilted_layer import CASE
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.project import PACKAGE, work_here
from bulkwear.workflows.engine.provenance import code_of_cases
from bulkwear.workflows.engine.state import digest
from bulkwear.workflows.report.provenance_of_pages import Origin, read_origins, versions_in
from bulkwear.workflows.report.simulated import newer_parts
from bulkwear.workflows.report.spot_checks import SpotCheck, as_new_as, keep_check, passed, read_checks
from bulkwear.workflows.results.remake import chosen

FIDELITY = "quick"  # of what is simulated again, whatever the page's: standard takes hours
ONE_PACKING = {"packings": 1}
WEAR, WORN_RUN = "wear.csv", "worn_run"  # of each run, by the file contract, and the rule that makes it
SNAKEMAKE = (".venv/bin/snakemake", "--workflow-profile", "workflows/profiles/default")
FOLDER = Path("results/spot_checks")
# Relative: a sum in another order. Of a bed in which one bit differs the tables differ by per cents soon after.
ROUND_OFF = 1e-9


@dataclass(frozen=True)
class Sample:
    """What is simulated again of a study: row of its design, or pair of frictions, and fidelity.

    runs: folders of what it makes; table: that each of them must have; place: in a clone, where they are; command:
    that makes them there
    """

    row: str
    fidelity: str
    runs: tuple[str, ...]
    table: str
    place: Path
    command: tuple[str, ...]


class VersionError(RuntimeError):
    """A version of the code cannot simulate the row; the message says which and why."""


def wanted(origin: Origin, docs: Path) -> dict[str, str]:
    """Return {commit: hash of its code} of what simulated a page and is older than today's code, those that passed a
    check not.
    """
    if not origin.checked_by:
        return {}
    now, checks = code_of_cases((origin.case,)), read_checks(docs)
    found = [as_new_as(each, passed(each, origin.checked_by, checks)) for each in versions_in(origin)]
    old = [each.found for each in found if newer_parts(each, now) and each.found and each.found["commit"]]
    return {str(each["commit"]): digest(each["parts"]) for each in old}


def checks_done(origins: Iterable[Origin], docs: Path) -> dict[tuple[str, str], SpotCheck]:
    """Return {(study, hash of the code that was checked): the last check} of versions that passed up to today."""
    found, checks = {}, read_checks(docs)
    for origin in origins:
        now = code_of_cases((origin.case,))
        for version in versions_in(origin):
            chain = passed(version, origin.checked_by, checks)
            if not chain or newer_parts(as_new_as(version, chain), now):
                continue
            for count in range(len(chain)):
                before = as_new_as(version, chain[:count]).found or {}
                found[origin.checked_by, digest(before.get("parts"))] = chain[-1]
    return found


def sample_of(study: str) -> Sample:
    """Return what is simulated again of a study: the first row of its design, which most designs begin with what others
    are held against; of bulk tests a shear box. Raises VersionError where there is neither.
    """
    row = str(load_study(study, overrides={"fidelity": FIDELITY, **ONE_PACKING}).design_rows[0]["row"])
    settings = {"fidelity": FIDELITY, **ONE_PACKING, "rows": [row]}
    chosen_alone = load_study(study, overrides=settings)
    if WORN_RUN in chosen_alone.case.solver_rules:
        place, runs = Path("results", study), tuple(run.name for run in chosen_alone.runs)
        files, told = (
            (f"{place}/{run}/{WEAR}" for run in runs),
            (f"{key}={json.dumps(it)}" for key, it in settings.items()),
        )
        return Sample(row, FIDELITY, runs, WEAR, place, (*SNAKEMAKE, *files, "--config", *told))
    if chosen_alone.case.name == CASE:
        return sample_of_bulk_tests()
    raise VersionError(
        f"{study}: its runs make no {WEAR}, allowed is a study of worn runs or bulk tests; redo its page."
    )


def sample_of_bulk_tests() -> Sample:
    """Return the shear box of the pair that every calibration is compared with, under the studies' rolling model."""
    place, asked = Path("results", "bulk_test"), ["--models", REFERENCE, "--tests", SHEAR_BOX, "--pairs", CALIBRATED]
    kept = [word for option in ("--folder", "--output") for word in (option, f"{place}/{SHEAR_BOX}")]
    command = (".venv/bin/python", "-m", "benchmarks.rolling_models", *asked, "--packings", "1", *kept)
    return Sample(CALIBRATED, rolling_models.FIDELITY, (SHEAR_BOX,), rolling_models.FILE, place, command)


def solved(commit: str, sample: Sample, folder: Path) -> Path:
    """Return the results of a sample by a commit, in its clone; goes on where it was left. Raises VersionError."""
    clone = (folder / commit).resolve()
    if not clone.exists():
        _call(["git", "clone", "--quiet", "--no-checkout", str(PACKAGE), str(clone)], Path())
        _call(["git", "checkout", "--quiet", "--detach", commit], clone)
    _call(["make", "--silent", "setup"], clone)
    for run in sample.runs:
        (clone / sample.place / run).mkdir(parents=True, exist_ok=True)
    _call(sample.command, clone)
    return clone / sample.place


def _call(command: Sequence[str], where: Path) -> None:
    program = Path(where, ".venv/bin").resolve()
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}  # it may lead to other code
    environment = {**kept, "PATH": os.pathsep.join([str(program), os.environ["PATH"]])}
    done = subprocess.run(command, cwd=where, stdout=sys.stderr, env=environment)
    if done.returncode != 0:
        raise VersionError(f"{where}: {' '.join(command)} ended with exit code {done.returncode}.")


def spot_check(origin: Origin, before: str, folder: Path) -> SpotCheck:
    """Return what came of simulating the first row by a commit and by today's. Raises VersionError."""
    code = code_of_cases((origin.case,))
    if code["commit"] is None or code["changed"]:
        raise VersionError(f"{PACKAGE}: files that matter are not committed, allowed is a commit of git.")
    sample = sample_of(origin.checked_by)
    old, new = (solved(commit, sample, folder) for commit in (before, code["commit"]))
    compared = {run: tables(old / run) for run in sample.runs}
    if missing := [run for run, found in compared.items() if sample.table not in found]:
        raise VersionError(f"{old}: found no {sample.table} of {', '.join(missing)}, allowed is one of each run.")
    faults = [f"{run}/{fault}" for run in sample.runs for fault in compare(old / run, new / run, {}, ROUND_OFF)]
    count = sum(len(found) for found in compared.values())
    day, what = f"{datetime.now(UTC):%Y-%m-%d}", (origin.checked_by, sample.fidelity, sample.row)
    return SpotCheck(*what, before, code["commit"], code, day, count, "; ".join(faults))


def check_pages(origins: Iterable[Origin], docs: Path, folder: Path, known: Iterable[Origin] = ()) -> bool:
    """Do the checks that pages lack, and print a line for each; return whether all were done with the same numbers.

    What cannot be simulated is told on standard error, and the next page's turn comes.
    """
    same, done = True, dict(checks_done(known, docs))
    for origin in origins:
        for commit, code in wanted(origin, docs).items():
            key = origin.checked_by, code  # one row speaks for several pages, and for commits of the same code
            if key not in done:
                try:
                    done[key] = spot_check(origin, commit, folder)
                except VersionError as fault:
                    print(fault, file=sys.stderr)
                    done[key], same = None, False
            if (check := done[key]) is None:
                continue
            if commit != check.before:
                check = replace(check, before=commit, simulated_by=check.before)
            keep_check(docs, check)
            same &= not check.difference
            said = f"differs: {check.difference}" if check.difference else "the same numbers but for round-off"
            told = f"{check.study}, row {check.row}: {check.before} and {check.after}, {check.tables} tables: {said}"
            print(told, flush=True)
    return same


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="where the pages are")
    parser.add_argument("--page", default="", help="one page alone")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="of the clones")
    given = parser.parse_args()
    try:
        work_here()
        known = read_origins(given.docs)
        return 0 if check_pages(chosen(known, given.page), given.docs, given.folder, known) else 1
    except (ValueError, RuntimeError) as fault:
        print(fault, file=sys.stderr)
        return 1


if __name__ == "__main__":
    command(main)
