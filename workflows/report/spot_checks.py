"""What spot checks say of pages in docs: one run of a study, simulated again by newer code, makes the same numbers.

`docs/results_checks.json` keeps them; `make results CHECK=1` does them and adds them. A check says nothing
of code that its run does not go through.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from bulkwear.workflows.report.simulated import Simulated

FILE = "results_checks.json"  # in docs


class SpotCheckError(ValueError):
    """The list of spot checks is damaged; the message names the file."""


@dataclass(frozen=True)
class SpotCheck:
    """A row of a study, simulated by two versions of the code on one machine.

    study, fidelity, row: what was simulated, one packing
    before, after: commits; code: what `provenance.simulating_code` says of the later one
    date: day, UTC; tables: of its runs, how many were compared
    difference: "" where all of their numbers are the same but for round-off, else in which tables they are not
    simulated_by: a commit that simulated in place of `before`, by the same code; "" where that did itself
    """

    study: str
    fidelity: str
    row: str
    before: str
    after: str
    code: Mapping[str, Any]
    date: str
    tables: int
    difference: str = ""
    simulated_by: str = ""


def read_checks(docs: Path) -> list[SpotCheck]:
    """Return the spot checks in a folder, none where it keeps none. Raises SpotCheckError."""
    path = docs / FILE
    try:
        return [SpotCheck(**each) for each in json.loads(path.read_text(encoding="utf-8"))]
    except FileNotFoundError:
        return []
    except (OSError, ValueError, TypeError) as fault:
        raise SpotCheckError(f"{path}: found no list of spot checks ({fault}).") from fault


def keep_check(docs: Path, check: SpotCheck) -> None:
    """Add a spot check to those of a folder, instead of an earlier one of the same versions and study."""
    kept = [each for each in read_checks(docs) if _asked(each) != _asked(check)]
    part = docs / f"{FILE}.part"
    part.write_text(json.dumps([asdict(each) for each in (*kept, check)], indent=1) + "\n", encoding="utf-8")
    os.replace(part, docs / FILE)


def _asked(check: SpotCheck) -> tuple[str, str, str]:
    return check.study, check.before, check.after


def passed(version: Simulated, study: str, checks: Iterable[SpotCheck]) -> list[SpotCheck]:
    """Return the checks of a study that lead from a version to later and later code with the same numbers."""
    known, chain = list(checks), []
    commit = (version.found or {}).get("commit")
    while following := [
        each for each in known if each.study == study and each.before == commit and not each.difference
    ]:
        chain.append(following[-1])
        known = [each for each in known if each.before != commit]
        commit = chain[-1].after
    return chain


def failed(versions: Sequence[Simulated], study: str, checks: Iterable[SpotCheck]) -> list[str]:
    """Return a sentence for each check of those versions in which numbers are not the same."""
    commits = {(version.found or {}).get("commit") for version in versions}
    return [
        f"Spot check, {each.date}: {each.row} at {each.fidelity} by {each.after} differs from {each.before} in "
        f"{each.difference}."
        for each in checks
        if each.study == study and each.before in commits and each.difference
    ]


def as_new_as(version: Simulated, chain: Sequence[SpotCheck]) -> Simulated:
    """Return a version with the code of the last check that it passed, its name saying so."""
    if not chain:
        return version
    last = chain[-1]
    name = f"{version.name}, with the same numbers as {last.after} in a spot check of {last.row} at {last.fidelity}"
    return replace(version, name=name, found={**(version.found or {}), **last.code})
