"""Pages of results that commands make, such as benchmarks: run again, and where what stands on them comes from."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from bulkwear.workflows.engine.provenance import code_of_cases
from bulkwear.workflows.engine.state import STATE
from bulkwear.workflows.report.made_by import package_version
from bulkwear.workflows.report.markdown import SECONDS_PER_HOUR, simulated_between
from bulkwear.workflows.report.provenance_of_pages import Origin, keep_origin, recorded, versions_in
from bulkwear.workflows.report.simulated import Simulated, versions_of
from bulkwear.workflows.results.index import redo

if TYPE_CHECKING:
    import pandas as pd

WRITTEN = "written from"  # begins what is said of a page that was remade
BY, COST = "simulated_by", "processor_s"  # columns of a table to which earlier versions of the code have left rows


class CommandError(RuntimeError):
    """A command did not make its page; the message says how it ended."""


def remake_by_command(origin: Origin, docs: Path, run: bool) -> str:
    """Run the command that makes a page, or return what it took and how to run it."""
    if run:
        call(["bash", "-c", origin.command])
    if run or has_written(origin, docs):
        keep_origin(docs, with_earlier(origin_of_command(origin), origin, docs))
        return f"{WRITTEN} what `{origin.command}` simulated"
    hours = "its cost was not kept" if origin.core_hours is None else f"it took {origin.core_hours:.2g} core hours"
    return f"no study but a command, {hours}: {redo(origin)}"


def states_of(origin: Origin) -> list[Path]:
    """Return the states of the simulations that a command keeps."""
    found = Path(origin.runs).glob(f"**/cycle_*/{STATE}") if origin.runs else ()
    return [path for path in found if "superseded" not in path.parts and not path.parent.suffix]


def has_written(origin: Origin, docs: Path) -> bool:
    """Return whether a command has written its page since the last of its simulations that are there.

    The table beside the page tells it: warnings are written into the page itself.
    """
    newest = max((path.stat().st_mtime for path in states_of(origin)), default=None)
    table = table_file(origin, docs)
    written = table if table.is_file() else docs / origin.page
    return newest is not None and newest <= written.stat().st_mtime


def origin_of_command(origin: Origin) -> Origin:
    """Return where the page of a command that was run comes from: of its simulations, or of now where it keeps none."""
    states = states_of(origin)
    if not states:
        now = datetime.now(UTC)
        found = [Simulated("", (origin.page,), code_of_cases((origin.case,)), (f"{now:%Y-%m-%d}",) * 2)]
        hours, when = None, (f"{now:%Y-%m-%d %H:%M}",) * 2
    else:
        found = versions_of(dict.fromkeys(path.parents[1] for path in states), within=Path(origin.runs))
        costs = [json.loads(path.read_text()).get("cost", {}) for path in states]
        spent = [cost["processor_s"] for cost in costs if "processor_s" in cost]  # bulk tests keep wall time alone
        hours, when = round(sum(spent) / SECONDS_PER_HOUR, 2) if spent else None, simulated_between(states)
    by = package_version()
    return Origin(origin.page, origin.case, simulated=when, versions=recorded(found), page_by=by, core_hours=hours)


def call(command: Sequence[str]) -> None:
    """Run a command to its end, its words on standard error. Raises CommandError."""
    beside = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    done = subprocess.run(command, stdout=sys.stderr, env={**os.environ, "PATH": beside})
    if done.returncode != 0:
        raise CommandError(f"{' '.join(command)} ended with exit code {done.returncode}.")


def with_earlier(now: Origin, before: Origin, docs: Path) -> Origin:
    """Return where a page comes from, with the earlier versions of the code that have rows in its table still.

    now: of the simulations that are here; before: as it was recorded. Of what is here the record is the present one.
    What the others cost is told where the table has the processor time of its rows.
    """
    table = table_of(before, docs)
    if BY not in table:
        return now
    names, here = set(table[BY]), {run for version in versions_in(now) for run in version.runs}
    earlier = [
        replace(version, runs=tuple(run for run in version.runs if run not in here))
        for version in versions_in(before)
        if version.name in names
    ]
    if not (earlier := [version for version in earlier if version.runs]):
        return now
    ends = (min(now.simulated[0], before.simulated[0]), max(now.simulated[1], before.simulated[1]))
    hours = round(table[COST].sum() / SECONDS_PER_HOUR, 2) if COST in table else None
    return replace(now, versions=recorded([*versions_in(now), *earlier]), simulated=ends, core_hours=hours)


def table_of(origin: Origin, docs: Path) -> pd.DataFrame:
    """Return the table of every simulation beside a page, empty where there is none."""
    import pandas as pd

    path = table_file(origin, docs)
    return pd.read_csv(path) if path.is_file() else pd.DataFrame()


def table_file(origin: Origin, docs: Path) -> Path:
    """Return where the table of every simulation beside a page lies, or would."""
    return docs / f"{Path(origin.page).stem.removesuffix('_results')}.csv"
