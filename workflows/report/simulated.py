"""Which versions of our code simulated what a page shows, and where the code that matters is newer.

Read from what simulations record of themselves (`workflows/engine/provenance.py`). Versions are compared by the hashes
of the parts of the code, so that it works without git; with git the commits between are counted.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.workflows.engine.code_parts import part_files
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.engine.provenance import OWN, PROVENANCE, PROVENANCE_FILE, git
from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.state import STATE

UNRECORDED = "a version that did not record itself"
SHORT = 8  # letters of a commit on a figure
MOST_RUNS = 6  # named in a sentence
PLACES = {  # part of the code: what it is, as sentences name it
    "wear": "wear and its ledger (postproc/wear, readers)",
    "flow": "measures of the flow (postproc/flow)",
    "engine": "the engine (workflows/engine)",
    "meshes": "meshes (meshes)",
    "solver": "the solver's load ledger (solver)",
    "templates": "templates of the decks (templates)",
    "case": "the case (workflows/cases)",
    OWN: "this project's own code",
}


@dataclass(frozen=True)
class Simulated:
    """What one version of the code simulated.

    name: of the version, as sentences have it; runs: names of the simulations, in their order
    found: its record, None where there is none; dates: days of the first and the last one, "" where not told
    """

    name: str
    runs: tuple[str, ...]
    found: Mapping[str, Any] | None
    dates: tuple[str, str] = ("", "")


def versions_of(folders: Iterable[Path], beds: Iterable[Path] = (), within: Path | None = None) -> list[Simulated]:
    """Return the versions that simulated runs, whose folders hold cycles, and beds; those of most simulations first.

    within: a folder that all runs are in, at any depth, and are named from; else they have the names of their folders

    A simulation of several versions counts for each of them; what is not there counts for none.
    """
    names = {folder: str(folder.relative_to(within)) if within else folder.name for folder in folders}
    records = [(name, _state(path)) for folder, name in names.items() for path in cycle_files(folder, STATE)]
    records += [(bed.name, _bed(bed)) for bed in beds if (bed / "bed.restart").is_file()]
    by_version: dict[str, list[tuple[str, Mapping[str, Any] | None]]] = {}
    for name, found in records:
        by_version.setdefault(json.dumps(_code(found), sort_keys=True), []).append((name, found))
    return sorted(map(_simulated, by_version.values()), key=lambda version: -len(version.runs))


def _state(path: Path) -> Mapping[str, Any] | None:
    return read_record(path).get(PROVENANCE)


def _bed(folder: Path) -> Mapping[str, Any] | None:
    path = folder / PROVENANCE_FILE
    return json.loads(path.read_text()) if path.is_file() else None


def _code(found: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return what tells versions of the code apart."""
    keys = ("version", "wear_version", "commit", "changed", "parts")
    return {key: found[key] for key in keys} if found else {}


def _simulated(records: Sequence[tuple[str, Mapping[str, Any] | None]]) -> Simulated:
    runs, found = tuple(dict.fromkeys(name for name, _ in records)), records[0][1]
    days = sorted(record["date"][:10] for _, record in records if record)
    return Simulated(version_name(found), runs, found, (days[0], days[-1]) if days else ("", ""))


def version_name(found: Mapping[str, Any] | None) -> str:
    """Return what a version of the code is called: its commit; where git was not, its number and a hash."""
    if not found:
        return UNRECORDED
    if found["commit"]:
        return f"commit {found['commit']}{' with changes' if found['changed'] else ''}"
    return f"version {found['version'] or 'not known'} (wear code {found['parts']['wear']})"


def newer_parts(version: Simulated, now: Mapping[str, Any]) -> list[str]:
    """Return the parts of the code that are not as they were when a version simulated; all where it is not known.

    now: the present code, as from `provenance.simulating_code`
    """
    before = version.found["parts"] if version.found else {}
    names = dict.fromkeys([*now["parts"], *before])
    return [name for name in names if before.get(name) != now["parts"].get(name)]


def said_of(versions: Sequence[Simulated]) -> str:
    """Return in a phrase which versions simulated how much."""
    if len(versions) == 1:
        return f"by {versions[0].name}"
    return "; ".join(f"by {version.name} ({len(version.runs)} of the simulations)" for version in versions)


def warnings_of(versions: Sequence[Simulated], now: Mapping[str, Any], cases: Iterable[str]) -> list[str]:
    """Return a sentence for the versions since which the same parts of the code are newer: runs, parts, commits.

    cases: folders of the package's cases whose code counts
    """
    groups: dict[tuple[str, ...], list[Simulated]] = {}
    for version in versions:
        if parts := newer_parts(version, now):
            groups.setdefault(tuple(parts) if version.found else (), []).append(version)
    return [_warning(parts, group, now, tuple(cases)) for parts, group in groups.items()]


def _warning(
    parts: tuple[str, ...], versions: Sequence[Simulated], now: Mapping[str, Any], cases: tuple[str, ...]
) -> str:
    """Return the sentences about versions since which those parts are newer; none: nothing is known of their code."""
    runs = list(dict.fromkeys(name for version in versions for name in version.runs))
    which = ", ".join(runs) if len(runs) <= MOST_RUNS else f"{len(runs)} simulations"
    head = f"{which}: simulated {' and '.join(f'by {version.name}' for version in versions)}."
    if not parts:
        return f"{head} What of the code is newer is not known."
    newer = ", ".join(PLACES.get(name, name) for name in parts)
    between = max((_commits(version, now, parts, cases) for version in versions), default=(0, ""))[1]
    old = any(version.found["wear_version"] != now["wear_version"] for version in versions)
    numbers = " The version of the wear code is another one: the same loads wear other volumes now." if old else ""
    return f"{head} Newer since then: {newer}{between}.{numbers}"


def _commits(
    version: Simulated, now: Mapping[str, Any], parts: Sequence[str], cases: tuple[str, ...]
) -> tuple[int, str]:
    """Return how many commits changed those parts since a version, and the phrase that says so; (0, "") without git."""
    before = version.found["commit"]
    if not (before and now["commit"]):
        return 0, ""
    files = part_files(cases)
    paths = [file for name in parts for file in files.get(name, ())]
    said = git(PACKAGE, "rev-list", "--count", f"{before}..HEAD", "--", *paths) if paths else None
    count = int(said or 0)
    return count, f" ({count} commit{'s' * (count > 1)} in {before}..{now['commit']})" if count else ""


def figure_remark(
    versions: Sequence[Simulated], now: Mapping[str, Any], checked: Sequence[Simulated] | None = None
) -> str:
    """Return the phrase that a figure has of what simulated it: commits, days, parts of the code that are newer.

    checked: the versions as new as spot checks make them (`spot_checks.as_new_as`), where there are any
    """
    if not versions:
        return ""
    names = [_short(version) for version in versions]
    days = sorted(day for version in versions for day in version.dates if day)
    when = f", {days[0]}{f' to {days[-1]}' if days[0] != days[-1] else ''}" if days else ""
    known = [version for version in (versions if checked is None else checked) if version.found]
    parts = list(dict.fromkeys(part for version in known for part in newer_parts(version, now)))
    newer = f" (code newer since: {', '.join(parts)})" if parts else ""
    return f"simulated by {', '.join(names)}{when}{newer}"


def _short(version: Simulated) -> str:
    if version.found is None or not version.found["commit"]:
        return version.name
    return version.found["commit"][:SHORT] + ("+" if version.found["changed"] else "")
