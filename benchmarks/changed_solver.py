"""A solver program of which one function is another than ours: for what no setting can ask for.

`solver_programs` has the functions. A program is built in the folder of a benchmark, which keeps it and its simulations
apart from ours; needs what `make -C solver` needs.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from bulkwear.workflows.engine import solver, state
from bulkwear.workflows.engine.machine import program_hashes
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.engine.provenance import PROVENANCE

PROGRAMS = Path(__file__).parent / "solver_programs"
COMPILED, HASH_DIGITS = {".cpp", ".h"}, 12  # files of the solver; of a hash of them, in the name of a folder


@dataclass(frozen=True)
class Change:
    """A function in another text: its file in PROGRAMS, the solver's file that has it, and how it begins there."""

    program: str
    changed: str
    function: str

    def text(self) -> str:
        """Return the C++ file of the function."""
        return (PROGRAMS / self.program).read_text(encoding="utf-8")

    def source(self, source: str) -> str:
        """Return the solver's file with the other text. Raises ValueError unless it has the function once."""
        pattern = re.compile(rf"^{re.escape(self.function)} \{{\n.*?^\}}\n", re.MULTILINE | re.DOTALL)
        text = self.text()
        new, count = pattern.subn(lambda _: text[text.index(self.function) :], source)
        if count != 1:
            raise ValueError(f"{self.changed}: found {self.function} {count} times, allowed is once.")
        return new


def built(change: Change, folder: Path) -> Path:
    """Return the changed program, built in a folder of its own in `folder` unless it is there.

    The compiler's words go to standard error. Raises SolverError.
    """
    ours = PACKAGE / "solver"
    sources = {str(path): path.read_text("utf-8") for path in sorted(ours.rglob("*")) if path.suffix in COMPILED}
    place = folder / f"solver_{state.digest({change.program: change.text(), **sources})[:HASH_DIGITS]}"
    if not (build := place / "build").is_dir():
        shutil.copytree(ours, place, ignore=shutil.ignore_patterns("build"), dirs_exist_ok=True)
        changed = change.source((ours / change.changed).read_text("utf-8"))
        (place / change.changed).write_text(changed, encoding="utf-8")
        if code := subprocess.run(["make", "-C", place, "BUILD=unfinished"], stdout=subprocess.DEVNULL).returncode:
            raise solver.SolverError(f"{place}: make ended with code {code}, and why stands above.")
        (place / "unfinished").rename(build)
    return (build / Path(solver.LEDGER_EXECUTABLE).name).resolve()


def use(change: Change, folder: Path) -> Path:
    """Build the changed program, take it for all that this process simulates, and return where its runs may lie."""
    program = built(change, folder)
    solver.LEDGER_EXECUTABLE = str(program)
    return program.parents[1] / "runs"


def check_simulated(folder: Path) -> None:
    """Raise SolverError where another program than the one in use has simulated a run."""
    programs = state.read_state(folder, 0)[PROVENANCE]["programs"]
    if not programs.items() >= program_hashes(solver.LEDGER_EXECUTABLE).items():
        raise solver.SolverError(f"{folder}: not simulated by {solver.LEDGER_EXECUTABLE}, allowed is that alone.")
