"""Faults in files: bits that flip, files that are cut or mixed up, configurations that nobody means."""

from __future__ import annotations

import random
import re
import signal
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import yaml

from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.postproc.mesh import read_surface
from bulkwear.postproc.readers.contacts import read_contacts
from bulkwear.postproc.readers.load_ledger import read_ledger, read_load_ledger
from bulkwear.postproc.readers.mesh_loads import read_mesh_loads
from bulkwear.postproc.readers.point_cloud import point_blocks
from bulkwear.postproc.readers.restart_file import read_restart
from bulkwear.postproc.readers.solver_log import last_step, thermo_table
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.study_files import EXTENDS
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.accounting import LEDGER
from bulkwear.workflows.engine.project import Project, ProjectError
from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.row_check import RowCheck
from bulkwear.workflows.engine.template_files import DeckError

SPINS = "spins.dump"  # is read with contacts
MACHINES = tuple(f"parts.{kind}" for kind in ("stl", "obj", "ply", "vtk", "vtu", "msh"))  # files of a machine's parts
CAD_MACHINES = ("parts.step", "parts.brep")
LONGEST_S = 240.0  # that one file or configuration may take, on a busy machine
NONSENSE = (
    *("0", "-1", "1e-320", "1e300", "1e999", ".nan", "9" * 5000, "yes", "null", "''", "[]", "{}", "[20, 20, 20]"),
    *("!!python/name:os.system", "*missing", "/etc/passwd", "..", '"a\\nb"', "'" + "x" * 300 + "'", "4096", "0.01"),
)
NUMBER = re.compile(r"(?<=[ ,:\[])-?\d[\d.eE+-]*")
LETTERS = "{}[]:,&*!|>'\"%@`#-?\n\t\0 0aé\u2028"


@dataclass
class Outcome:
    """What came of faults of one kind; all but `tried`, `refused` and `unchanged` should be 0.

    refused: with a sentence; unchanged: nothing that counts had changed
    """

    what: str
    tried: int = 0
    refused: int = 0
    unchanged: int = 0
    lost: int = 0
    wrong: int = 0
    tracebacks: int = 0
    hangs: int = 0
    said: list[str] = field(default_factory=list)  # what went wrong, for the terminal

    def note(self, kind: str, said: str = "") -> None:
        """Count an outcome."""
        self.tried += 1
        setattr(self, kind, getattr(self, kind) + 1)
        if said:
            self.said.append(said)


class _TooLongError(Exception):
    """It took longer than it may."""


def _ring(*_: object) -> None:
    raise _TooLongError


def attempt(outcome: Outcome, do: Callable[[], object], what: str, is_told: Callable[[Exception], bool]) -> None:
    """Do something that may be refused, and count what came. is_told: whether a fault is the sentence of a refusal"""
    before = signal.signal(signal.SIGALRM, _ring)
    signal.setitimer(signal.ITIMER_REAL, LONGEST_S)
    try:
        do()
    except _TooLongError:
        outcome.note("hangs", what)
    except Exception as fault:
        if is_told(fault) and len(str(fault).splitlines()) == 1:
            outcome.note("refused")
        else:
            outcome.note("tracebacks", f"{what}: {traceback.format_exc(limit=-3)}")
    else:
        outcome.note("unchanged")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


# ---------------------------------------------------------------- finished cycles


def flipped_bits(run_folder: Path, inputs: str, count: int, chance: random.Random) -> Outcome:
    """Flip a bit at a time in the files of finished cycles that the next one or a table is made of.

    A flip is noticed where its cycle does not count any more; one that changes nothing that a record says is none.
    """
    outcome = Outcome("flipped bits in finished cycles")
    folders = state.cycle_folders(run_folder)
    sealed = [
        [folder / name for name in (state.STATE, *read_record(folder / state.STATE)["files"])] for folder in folders
    ]
    before = state.finished_cycles(run_folder, inputs, faulty=RowCheck().fault)
    for _ in range(count):
        path = chance.choice(chance.choice(sealed))
        content = path.read_bytes()
        record = read_record(path) if path.name == state.STATE else None
        place, bit = chance.randrange(len(content)), chance.randrange(8)
        path.write_bytes(content[:place] + bytes([content[place] ^ 1 << bit]) + content[place + 1 :])
        found = state.finished_cycles(run_folder, inputs, faulty=RowCheck().fault)
        same = record is not None and found == before and read_record(path) == record
        outcome.note(
            "refused" if found < before else "unchanged" if same else "wrong", "" if found < before else str(path)
        )
        path.write_bytes(content)
    return outcome


# ---------------------------------------------------------------- readers


UNIT, EDGE_M = "mm", 0.02  # of the machine's parts, whose formats follow
READERS: dict[str, Callable[[Path], object]] = {
    "run.restart": read_restart,
    "surface.vtu": read_surface,
    state.STATE: read_record,
    "log.liggghts": lambda path: (thermo_table(path), last_step(path)),
    "load_ledger.bin": read_load_ledger,
    LEDGER: read_ledger,
    "loads.vtk": read_mesh_loads,
    "contacts.dump": lambda path: list(read_contacts(path, path.with_name(SPINS))),
    **dict.fromkeys(("points.ply", "points.stl", "points.xyz"), lambda path: list(point_blocks(path))),
    **dict.fromkeys(MACHINES, lambda path: own_mesh(path, UNIT)),
    **dict.fromkeys(CAD_MACHINES, lambda path: own_mesh(path, UNIT, EDGE_M)),
}


def mutated(content: bytes, chance: random.Random) -> bytes:
    """Return a file as faults leave it: cut, without or with a piece too many, with other bytes or line ends."""
    kind, place = chance.randrange(7), chance.randrange(len(content) + 1)
    length = chance.choice((1, 8, 100, 4096))
    return (
        content[:place],
        content[:place] + content[place + length :],
        content[:place] + content[max(0, place - length) : place] + content[place:],
        content[:place] + bytes(chance.randrange(256) for _ in range(min(length, 100))) + content[place + length :],
        content[:place] + bytes(length) + content[place + length :],
        content.replace(b"\n", b"\r\n"),
        content[:place] + b"9" * length + content[place:],
    )[kind]


def mutated_files(samples: Sequence[Path], folder: Path, count: int, chance: random.Random, what: str) -> Outcome:
    """Let readers read mutated samples, which are named as in `READERS`."""
    outcome = Outcome(what)
    for _ in range(count):
        sample = chance.choice(samples)
        path = folder / sample.name
        path.write_bytes(mutated(sample.read_bytes(), chance))
        attempt(outcome, partial(READERS[path.name], path), path.name, lambda fault: str(folder) in str(fault))
        path.write_bytes(sample.read_bytes())
    return outcome


# ---------------------------------------------------------------- configurations


def mutated_text(text: str, chance: random.Random) -> str:
    """Return a configuration that nobody means: a value, a letter, a line that is gone or there twice."""
    kind = chance.randrange(4)
    numbers = list(NUMBER.finditer(text))
    if kind < 2 and numbers:
        found = chance.choice(numbers)
        return text[: found.start()] + chance.choice(NONSENSE) + text[found.end() :]
    if kind == 2:
        lines = text.splitlines(keepends=True)
        place = chance.randrange(len(lines))
        return "".join([*lines[:place], *lines[place : place + 1] * chance.choice((0, 2)), *lines[place + 1 :]])
    place = chance.randrange(len(text))
    return text[:place] + chance.choice(LETTERS) * chance.choice((1, 1, 1, 200)) + text[place:]


def is_of_configuration(fault: Exception) -> bool:
    """Return whether a fault is one that the configuration's own checks tell."""
    return isinstance(fault, ConfigError | DeckError | ProjectError)


def files_of_studies(project: Project) -> dict[str, list[str]]:
    """Return {study: files of its settings, those of a study that it extends among them, and the tables that they
    name}, as paths from a project's folder.
    """
    folder, found = project.folder, {}
    for path in sorted((folder / "config" / "studies").glob("*.yaml")):
        case = load_study(path.stem, project=project).case.name
        studies = [path.stem]
        while base := yaml.safe_load((path.parent / f"{studies[-1]}.yaml").read_text(encoding="utf-8")).get(EXTENDS):
            studies.append(base)
        settings = [f"config/studies/{name}.yaml" for name in studies]
        settings += [f"config/cases/{case}.yaml", "config/default.yaml"]
        named = "".join((folder / name).read_text(encoding="utf-8") for name in settings)
        tables = [table for table in sorted((folder / "config").rglob("*.csv")) if table.name in named]
        found[path.stem] = [*settings, "config/materials.yaml", *(str(table.relative_to(folder)) for table in tables)]
    return found


def mutated_configurations(
    project: Project, studies: Mapping[str, Sequence[str]], count: int, chance: random.Random
) -> Outcome:
    """Load studies in turn whose files, {study: files}, one or two at a time, are mutated."""
    outcome = Outcome("configurations")
    texts = {name: (project.folder / name).read_text(encoding="utf-8") for files in studies.values() for name in files}
    for number in range(count):
        study, files = list(studies.items())[number % len(studies)]
        spoiled = chance.sample(list(files), chance.choice((1, 1, 2)) if len(files) > 1 else 1)
        for name in spoiled:
            (project.folder / name).write_text(mutated_text(texts[name], chance), encoding="utf-8")
        attempt(outcome, partial(load_study, study, project=project), f"{spoiled}", is_of_configuration)
        for name in spoiled:
            (project.folder / name).write_text(texts[name], encoding="utf-8")
    return outcome
