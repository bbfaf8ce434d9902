"""Where every page of results in docs comes from, as `docs/results.json` keeps it, and what is newer than its runs.

A page outlives its runs: what simulated it is written down when the page is. `docs/results_changes.csv` names the
changes of the code that are known to move numbers; all others are found by comparing hashes, or counted with git.
"""

from __future__ import annotations

import csv
import json
import os
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from bulkwear.workflows.engine.code_parts import OF_CASE, PARTS, SHARED_TEMPLATES
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.engine.provenance import git
from bulkwear.workflows.report.simulated import UNRECORDED, Simulated, version_name, warnings_of
from bulkwear.workflows.report.spot_checks import SpotCheck, as_new_as, failed, passed

FILE, CHANGES = "results.json", "results_changes.csv"  # in docs
LINE = 118  # characters of a line of prose
BEGIN, END = "<!-- older than the code -->", "<!-- end -->"
# Study, or page of none, -> the cheapest study whose spot checks speak for it: of the same case, with what it goes
# through as it is. What it does not go through, as beds in a window or other rolling models, it does not check.
STANDS_FOR = {
    **dict.fromkeys(("demo", "screening", "particle_size", "optimised_pattern", "stiffness.md"), "demo"),
    **dict.fromkeys(("critical_scale_results.md", "travelling_window_results.md", "worn_bump.csv"), "demo"),
    **dict.fromkeys(
        ("tilted_bed_results.md", "calibration_models_results.md", "rolling_models_results.md"), "calibration"
    ),
}
BLOCK = re.compile(rf"{BEGIN}\n.*?{END}\n\n", re.DOTALL)


class ResultsError(ValueError):
    """What is known of the pages of results is damaged or missing; the message names the file."""


@dataclass(frozen=True)
class Origin:
    """Where a page of results, or a table or picture that a page shows, comes from.

    page: file in docs; case: of the package, whose code counts
    study, fidelity, settings: what was run, settings besides those of the configuration; figure: of it, where the page
        is one picture
    command: what makes a page that is of no study; runs: folder of its simulations, "" where it keeps none
    simulated: from when to when, UTC
    versions: what each version of the code simulated, {"runs", "found"} as in `simulated.Simulated`; none where that
        was not recorded
    commits: what the code was by the time, where versions are not recorded
    page_by: commit that wrote the page; core_hours: the solver's processor time, None where nobody kept it
    """

    page: str
    case: str
    study: str = ""
    fidelity: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    figure: str = ""
    command: str = ""
    runs: str = ""
    simulated: tuple[str, str] = ("", "")
    versions: Sequence[Mapping[str, Any]] = ()
    commits: Sequence[str] = ()
    page_by: str = ""
    core_hours: float | None = None

    @property
    def overrides(self) -> dict[str, Any]:
        """Return the settings that a study is loaded with."""
        return {**({"fidelity": self.fidelity} if self.fidelity else {}), **self.settings}

    @property
    def checked_by(self) -> str:
        """Return the study whose spot checks concern the page, "" where there is none."""
        return STANDS_FOR.get(self.study or self.page, self.study)


@dataclass(frozen=True)
class Change:
    """A change of the code that is known to move numbers; date: UTC; concerns: cases and pages, apart by spaces."""

    date: str
    commit: str
    part: str
    concerns: str
    change: str

    @property
    def words(self) -> str:
        """Return when it was made and what it moves."""
        return f"{self.date} UTC ({self.commit}), {self.part}: {self.change}."


def read_origins(docs: Path) -> list[Origin]:
    """Return where the pages of a folder come from. Raises ResultsError."""
    path = docs / FILE
    try:
        return [Origin(**each) for each in json.loads(path.read_text(encoding="utf-8"))]
    except (OSError, ValueError, TypeError) as fault:
        raise ResultsError(f"{path}: found no list of pages ({fault}), it is in the repository's docs.") from fault


def write_origins(docs: Path, origins: Iterable[Origin]) -> None:
    """Write where pages come from, whole or not at all."""
    part = docs / f"{FILE}.part"
    part.write_text(json.dumps([asdict(each) for each in origins], indent=1) + "\n", encoding="utf-8")
    os.replace(part, docs / FILE)


def keep_origin(docs: Path, origin: Origin) -> None:
    """Write down where a page that was made now comes from; of one known before, how it is made stays, but for the
    settings of a study.
    """
    known = read_origins(docs)
    if origin.page not in (each.page for each in known):
        known.append(origin)
    write_origins(docs, [_renewed(each, origin) if each.page == origin.page else each for each in known])


def _renewed(before: Origin, now: Origin) -> Origin:
    kept = now.settings if now.study else before.settings
    return replace(now, settings=kept, figure=before.figure, command=before.command, runs=before.runs)


def read_changes(docs: Path) -> list[Change]:
    """Return the changes of the code that are known to move numbers. Raises ResultsError."""
    try:
        with open(docs / CHANGES, newline="", encoding="utf-8") as table:
            return [Change(**row) for row in csv.DictReader(table)]
    except (OSError, TypeError) as fault:
        raise ResultsError(f"{docs / CHANGES}: found no table of changes ({fault}).") from fault


def recorded(versions: Iterable[Simulated]) -> list[dict[str, Any]]:
    """Return versions as `Origin.versions` keeps them; none if any run did not record itself."""
    found = list(versions)
    whole = all(each.found for each in found)
    return (
        [{"runs": list(each.runs), "dates": list(each.dates), "found": each.found} for each in found] if whole else []
    )


def versions_in(origin: Origin) -> list[Simulated]:
    """Return the versions that simulated a page."""
    found = origin.versions
    return [Simulated(version_name(v["found"]), tuple(v["runs"]), v["found"], tuple(v["dates"])) for v in found]


def older(
    origin: Origin, changes: Iterable[Change], now: Mapping[str, Any], checks: Sequence[SpotCheck] = ()
) -> list[str]:
    """Return what is newer than a page's simulations, a sentence each; none where nothing that matters is.

    now: the present code of the page's case, as from `provenance.code_of_cases`
    checks: a version that passed them counts as the code that it was held against; known changes still count
    """
    known = _known_changes(origin, changes)
    if origin.versions:
        versions = versions_in(origin)
        if not warnings_of(versions, now, [origin.case]):
            return []
        checked = [as_new_as(each, passed(each, origin.checked_by, checks)) for each in versions]
        found = warnings_of(checked, now, [origin.case])
        return [*found, *failed(versions, origin.checked_by, checks), *known]
    return [_unrecorded(origin), *known, *_touched(origin)]


def _known_changes(origin: Origin, changes: Iterable[Change]) -> list[str]:
    """Return a sentence for each known change that came after the first simulation, or was made while they ran."""
    first, last = origin.simulated
    return [
        f"{'Since then' if change.date > last else 'While it was simulated'}, {change.words}"
        for change in changes
        if {origin.case, origin.page} & {*change.concerns.split()} and change.date > first
    ]


def _unrecorded(origin: Origin) -> str:
    when = " to ".join(dict.fromkeys(origin.simulated))
    commits = f": by the time, commit {' to '.join(origin.commits)}" if origin.commits else ""
    return f"Simulated {when} UTC by {UNRECORDED}{commits}."


def _touched(origin: Origin) -> list[str]:
    """Return the sentence that counts the commits since a page's simulations by part of the code, with git."""
    if not origin.commits:
        return []
    patterns = {**PARTS, "case": (f"{OF_CASE['case']}/{origin.case}/*.py",)}
    patterns["templates"] = [f"{OF_CASE['templates']}/{folder}/*" for folder in (SHARED_TEMPLATES, origin.case)]
    counts = {part: _commits_since(origin.commits[-1], globs) for part, globs in patterns.items()}
    said = ", ".join(f"{part} {count}" for part, count in counts.items() if count)
    return (
        [f"Commits since then by part of the code: {said}; what of them moves these numbers is not known."]
        if said
        else []
    )


def _commits_since(commit: str, patterns: Iterable[str]) -> int:
    paths = [f":(glob){pattern}" for pattern in patterns]
    return int(git(PACKAGE, "rev-list", "--count", f"{commit}..HEAD", "--", *paths) or 0)


def with_banner(text: str, sentences: Sequence[str]) -> str:
    """Return a page with a warning of what is newer than its simulations below its title, instead of an earlier one."""
    text = BLOCK.sub("", text)
    if not sentences:
        return text
    title, _, rest = text.partition("\n\n")
    said = textwrap.fill(
        f"**Older than the code.** {' '.join(sentences)}", LINE, initial_indent="> ", subsequent_indent="> "
    )
    return f"{title}\n\n{BEGIN}\n{said}\n{END}\n\n{rest}"
