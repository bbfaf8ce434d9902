"""What LIGGGHTS says: progress and thermo rows of its log, its last words and their cause, triangle counts.

The log file holds thermo rows and the errors all ranks agree on. Errors of a single rank (a bad mesh, a
missing file) and the triangle counts go to standard output only, and vanish there when it is buffered. So
run it as ``stdbuf -oL liggghts -in deck.in > screen.txt 2>&1`` and give `failure` and `reported_triangles`
that file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import zip_longest
from pathlib import Path

import numpy as np

TAIL_BYTES = 65536
_ERROR = re.compile(r"^ERROR(?: on proc \d+)?: (.*)$", re.MULTILINE)
_SOURCE = re.compile(r"\s*\(\./src/[^)]*\)")
_LOST = re.compile(r"^(?:ERROR|WARNING): (Lost atoms: .*)$", re.MULTILINE)
_FORCED = "Forced restart written"
_EXCHANGE = re.compile(r"^Exchange at step (\d+): (\d+) particles left, (\d+) entered, (\d+) are here\.$")
_TRIANGLES = "Import and parallelization of mesh {} containing (\\d+) triangle"
_LOOP = re.compile(r"^Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", re.MULTILINE)
_NEIGHBOURS = re.compile(r"^Neigh time \(%\) = (\S+)", re.MULTILINE)
_BUILDS = re.compile(r"^Neighbor list builds = (\d+)", re.MULTILINE)


KNOWN_CAUSES = (
    (r"[Ff]ailed to (?:re)?allocate", "the memory is exhausted: run fewer simulations side by side"),
    (
        r"Lost atoms",
        "particles left the domain: too large a time step, overlapping insertion or a leaking wall",
    ),
    (
        r"are duplicate",
        "two facets of the surface are the same: repair it, healing would shift the ids",
    ),
    (r"minumum angle of mesh element", "the surface has a sliver triangle: remesh before this cycle"),
    (r"mesh elements have been lost / left the domain", "part of the mesh lies outside the simulation box"),
    (r"Cannot open mesh file", "the surface file is missing or not readable from the folder of the deck"),
    (r"could not find fix mesh id", "the wall names a mesh that the deck does not define"),
    (r"Invalid fix style: \"load/ledger", "this deck runs with solver/build/liggghts-ledger; `make setup` builds it"),
    (r"Cannot open restart file", "the restart file is missing: the cycle before did not finish"),
    (
        r"header section of restart file",
        "the restart file is damaged, or no restart file of this LIGGGHTS version",
    ),
    (r"Could not locate a fix/property", "the deck does not define this material property"),
    (r"must be a multiple of nCols", "a property does not have one value for each pair of materials"),
    (r"youngsModulus <= 1e9", "a stiff material needs `hard_particles yes`"),
    (r"% of (?:rayleigh|hertz) time", "the time step is too large for the smallest and stiffest particle"),
    (r"illegal variable", "the deck uses a variable it does not define"),
    (r"Unknown command", "the deck holds a command that this LIGGGHTS does not know"),
    (
        r"unknown keyword|Invalid model specified|[Ii]llegal",
        "the deck holds a keyword that this command does not take",
    ),
    (
        r"Need to define this compute before first run",
        "the deck must define the contact compute before its first run",
    ),
    (r"Unable to calculate region volume", "the particles do not fit into the region they are inserted in"),
    (r"random seed value", "random seeds must be primes above 10000"),
    (r"Cannot open input script", "the deck, or a file it includes, is missing"),
    (r"Atom types must start from 1", "no particle is left in the domain"),
    (r"Internal error \(\./src/tri_mesh", "a particle has no finite position any more: the run is unstable"),
)


PRINTED_AS = {"Step": "step", "Atoms": "atoms"}  # columns of a log -> words of `thermo_style`; others are variables


class SolverLogError(ValueError):
    """A log or screen file without what was looked for; the message names the file."""


class ThermoTable(dict[str, np.ndarray]):
    """The thermo columns of a log by name; one that its deck does not print raises SolverLogError, not KeyError."""

    def __init__(self, columns: Mapping[str, np.ndarray], log: Path | str):
        super().__init__(columns)
        self.log = log

    def __missing__(self, name: str) -> np.ndarray:
        found = ", ".join(column for column in self if column != "run") or "none"
        word = PRINTED_AS.get(name, f"v_{name}")
        raise SolverLogError(
            f"{self.log}: found no column {name} among those that the solver printed, {found}; allowed is the log of a"
            f" deck whose thermo_style has {word} (templates)."
        )

    def of_rows(self, chosen: np.ndarray) -> ThermoTable:
        """Return the table of some of its rows; chosen: (rows,) bool."""
        return ThermoTable({name: values[chosen] for name, values in self.items()}, self.log)


def _numbers(line: str) -> list[float] | None:
    try:
        return [float(word) for word in line.split()]
    except ValueError:
        return None


def thermo_table(path: Path | str) -> ThermoTable:
    """All thermo rows of a log file.

    Returns one (rows,) float64 array per thermo column, NaN where a run did not print it, units of the deck;
    and `run`, int64, the deck's run a row is from (0-based). The first row of each run is its set-up step.
    """
    rows: list[dict[str, float]] = []
    columns: list[str] = []
    run, inside = -1, False
    with open(path, encoding="utf-8", errors="replace") as stream:
        for line in stream:
            words = line.split()
            if words[:1] == ["Step"]:
                columns, run, inside = words, run + 1, True
            elif words[:2] == ["Loop", "time"]:
                inside = False
            elif inside and len(words) == len(columns) and line.endswith("\n") and (row := _numbers(line)):
                rows.append({"run": run, **dict(zip(columns, row, strict=True))})
    names = dict.fromkeys(name for row in rows for name in row)
    table = {name: np.array([row.get(name, np.nan) for row in rows]) for name in names}
    return ThermoTable({**table, "run": np.array([row["run"] for row in rows], np.int64)}, path)


def thermo_rows(path: Path) -> ThermoTable:
    """Return the thermo table without the set-up row of each run, which holds no force."""
    thermo = thermo_table(path)
    return thermo.of_rows(np.diff(thermo["run"], prepend=-1) == 0)


def exchanges(path: Path | str) -> dict[str, np.ndarray]:
    """Exchanges of bed of a travelling window, as its deck tells them in a log file.

    Returns (exchanges,) int64 arrays: `step`, particles that `left` and `entered`, and that are `here` afterwards.
    """
    with open(path, encoding="utf-8", errors="replace") as stream:
        rows = [found.groups() for line in stream if (found := _EXCHANGE.match(line))]
    columns = np.array(rows, np.int64).reshape(-1, 4).T
    return dict(zip(("step", "left", "entered", "here"), columns, strict=True))


def last_step(path: Path | str) -> int | None:
    """Last time step with a thermo row in the log of a running or finished run; None before the first row.

    Reads the end of the file only. The thermo style must begin with `step`.
    """
    path = Path(path)
    with open(path, "rb") as stream:
        size = stream.seek(0, 2)
        for length in (TAIL_BYTES, size):
            stream.seek(max(0, size - length))
            lines = stream.read().decode("utf-8", "replace").split("\n")[:-1]
            for line in reversed(lines if length >= size else lines[1:]):
                row = _numbers(line)
                if row and len(row) > 1 and line.split()[0].isdigit():
                    return int(row[0])
    return None


def failure(source: Path | str) -> str | None:
    """Why the solver stopped: its last words and, where known, the cause; None when it reports no error.

    source: Path of the screen (or log) file, or the text itself as str
    Lost particles count as a failure also where the deck only warns about them.
    """
    text = source.read_text("utf-8", "replace") if isinstance(source, Path) else source
    words = [match.group(1) for match in (*_ERROR.finditer(text), *_LOST.finditer(text))]
    if not words:
        return None
    raw = " ".join(dict.fromkeys(words))
    cause = next((cause for pattern, cause in KNOWN_CAUSES if re.search(pattern, raw)), None)
    said = _SOURCE.sub("", raw).strip()
    return f"LIGGGHTS stopped: {said}" if cause is None else f"LIGGGHTS stopped: {said} ({cause})"


def ended_by_signal(source: Path) -> bool:
    """Whether a signal ended the solver: it then writes a restart file of its own, and its exit code is 0 all the same.

    source: of the screen file
    """
    return _FORCED in source.read_text("utf-8", "replace")


def solver_version(path: Path | str) -> str | None:
    """What LIGGGHTS calls itself in the first lines of its log or screen file, with version and build; None without."""
    with open(path, encoding="utf-8", errors="replace") as stream:
        found = re.search(r"^LIGGGHTS \((.*)\)$", stream.read(TAIL_BYTES), re.MULTILINE)
    return found[1] if found else None


def warnings(source: Path | str) -> dict[str, int]:
    """Distinct warnings of a screen (or log) file and how often each was given; their numbers become #."""
    text = source.read_text("utf-8", "replace") if isinstance(source, Path) else source
    counts: dict[str, int] = {}
    for said in re.findall(r"^WARNING(?: on proc \d+)?:\s+(.*)$", text, re.MULTILINE):  # some start on the next line
        key = re.sub(r"(?<![\w/])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?", "#", _SOURCE.sub("", said)).strip()
        counts[key] = counts.get(key, 0) + 1
    return counts


def reported_triangles(screen_path: Path | str, mesh_id: str) -> int:
    """Number of triangles LIGGGHTS keeps of a mesh, as printed at the first run after its definition.

    screen_path: file with the solver's standard output (the log file does not hold this line)
    mesh_id: id of the mesh fix

    Fewer than the facets of the STL file means facets with coinciding corners: they are dropped without a
    word, and the ids of all later triangles shift.
    Raises SolverLogError when the file does not report this mesh.
    """
    text = Path(screen_path).read_text("utf-8", "replace")
    found = re.findall(_TRIANGLES.format(re.escape(mesh_id)), text)
    if not found:
        raise SolverLogError(
            f"{screen_path}: no triangle count of mesh '{mesh_id}', allowed is the solver's standard output "
            "(unbuffered) of a deck that defines and runs it."
        )
    return int(found[-1])


def run_times(path: Path | str) -> dict[str, np.ndarray]:
    """Return the `run` commands of a log that printed their times, in order, one (runs,) array per column.

    loop_s, neighbour_s: wall time in the time steps and of it in neighbour lists; steps; particles: at the end; builds:
    of the neighbour list. A run with `post no` tells no neighbour times and is left out.
    """
    text = Path(path).read_text("utf-8", "replace")
    found = list(_LOOP.finditer(text))
    ends = [after.start() for after in found[1:]]
    rows = []
    for loop, end in zip_longest(found, ends, fillvalue=len(text)):
        neighbours, builds = (pattern.search(text, loop.end(), end) for pattern in (_NEIGHBOURS, _BUILDS))
        if neighbours and builds:
            rows.append((float(loop[1]), float(neighbours[1]), int(loop[2]), int(loop[3]), int(builds[1])))
    columns = ("loop_s", "neighbour_s", "steps", "particles", "builds")
    return dict(zip(columns, np.array(rows, float).reshape(-1, len(columns)).T, strict=True))
