"""The load ledger: as the solver wrote it, `load_ledger.bin` of `fix load/ledger`, and the table kept of a wear cycle.

The solver's file: one line of ASCII JSON, then float64, little-endian, column after column, each with one value per
triangle in the order of the mesh's facets. The solver has summed every contact of every step; nothing is left to sum.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

TABLE = "ledger.parquet"  # of a finished cycle
FORMAT = 2  # of the file, value of `load_ledger` in its header
LONGEST_HEADER = 100_000  # bytes; a file without a line that short is no ledger
SUMS = ("sliding_work_J", "normal_impulse_N_s", "rolling_work_J", "impact_energy_J", "contact_time_s")
RADIUS = "contact_radius_m"
WEIGHTS = ("contact_weight_1", "contact_weight_2", "contact_weight_3")
WORKS = ("tangential_work_J", "drive_work_J")  # signed, unlike SUMS
VECTORS = tuple(  # on the mesh, in the frame of each facet: along its first edge, across it, normal
    f"{name}_{direction}_{unit}"
    for name, unit in (("impulse", "N_s"), ("back_impulse", "N_s"), ("moment", "N_m_s"))
    for direction in ("along", "across", "normal")
)
_KEYS = {"mesh": str, "triangles": int, "steps": int, "time_s": (int, float), "columns": list}
_ANNOUNCED = re.compile(r"^Load ledger \S+: .*$", re.MULTILINE)


class LoadLedgerError(ValueError):
    """A file that is not the load ledger asked for, in one sentence: file, what was found, what is allowed."""


@dataclass(frozen=True, eq=False)
class LoadLedger:
    """Loads of one mesh, summed over the steps of a run.

    mesh: fix id of the mesh; steps: steps accounted; time_s: their duration, s
    columns: {name: (n,) float64}, units in the names; SUMS, WORKS, RADIUS, WEIGHTS (barycentric coordinates of the mean
        contact point in the order of the facet's corners), VECTORS and sums of kernels; radius and weights are NaN on
        triangles that were never loaded
    header: all that the file says about itself
    """

    mesh: str
    steps: int
    time_s: float
    columns: dict[str, np.ndarray]
    header: Mapping[str, Any]

    @property
    def triangles(self) -> int:
        """Number of triangles."""
        return self.header["triangles"]


def read_load_ledger(
    path: Path | str, mesh: str | None = None, n_triangles: int | None = None, steps: int | None = None
) -> LoadLedger:
    """Read a load ledger.

    mesh, n_triangles, steps: what the file must be about, where given

    Raises LoadLedgerError, one sentence naming the file, what was found and what is allowed.
    """
    path = Path(path)
    try:
        content = path.read_bytes()
    except OSError as fault:
        raise LoadLedgerError(
            f"{path}: cannot be read ({fault.strerror}), allowed is a file of fix load/ledger."
        ) from fault
    header, start = _header(content, path)
    for what, found, allowed in (
        ("mesh", header["mesh"], mesh),
        ("triangles", header["triangles"], n_triangles),
        ("steps", header["steps"], steps),
    ):
        if allowed is not None and found != allowed:
            raise LoadLedgerError(f"{path}: {what} is {found}, allowed is {allowed}.")
    columns = _columns(content, start, header, path)
    return LoadLedger(header["mesh"], header["steps"], float(header["time_s"]), columns, header)


def read_ledger(path: Path | str) -> pd.DataFrame:
    """Return the ledger of a finished wear cycle, a row per triangle, units in the names of its columns.

    path: of the cycle's folder, or of its ledger.parquet

    Raises LoadLedgerError, one sentence, where there is none.
    """
    path = Path(path)
    file = path / TABLE if path.is_dir() else path
    try:
        return pd.read_parquet(file)
    except (OSError, ValueError) as fault:
        found = ", ".join(sorted(each.name for each in file.parent.glob("*"))) or "nothing"
        raise LoadLedgerError(
            f"{file}: no ledger can be read from it, allowed is the {TABLE} of a wear cycle, or its folder; found in "
            f"that folder: {found}."
        ) from fault


def announcement(screen_path: Path | str) -> str | None:
    """What the solver said about its load ledger at the start of a run (screen or log file); None without."""
    found = _ANNOUNCED.search(Path(screen_path).read_text("utf-8", "replace"))
    return found[0] if found else None


def _header(content: bytes, path: Path) -> tuple[dict[str, Any], int]:
    """Return the header and the place of the first number."""
    end = content.find(b"\n", 0, LONGEST_HEADER)
    try:
        header = json.loads(content[: max(end, 0)].decode("ascii"))
        version = header["load_ledger"]
    except (ValueError, KeyError, TypeError):
        raise LoadLedgerError(
            f"{path}: found no header of a load ledger, allowed is a line of JSON that begins with load_ledger."
        ) from None
    if version != FORMAT:
        raise LoadLedgerError(
            f"{path}: load_ledger is {version!r}, allowed is format {FORMAT}, of a program built from the present "
            "solver/ (make -C solver)."
        )
    for key, kind in _KEYS.items():
        value = header.get(key)
        if not isinstance(value, kind) or isinstance(value, bool):
            raise LoadLedgerError(f"{path}: {key} in its header is {value!r}, allowed is {_words(kind)}.")
    for name in (*SUMS, *WORKS, RADIUS, *WEIGHTS, *VECTORS):
        if header["columns"].count(name) != 1:
            times = header["columns"].count(name)
            raise LoadLedgerError(f"{path}: column {name} stands there {times} times, allowed is once.")
    return header, end + 1


def _words(kind: Any) -> str:
    return {str: "text", int: "a whole number", list: "a list of names"}.get(kind, "a number")


def _columns(content: bytes, start: int, header: Mapping[str, Any], path: Path) -> dict[str, np.ndarray]:
    names, triangles = header["columns"], header["triangles"]
    expected, found = 8 * len(names) * triangles, len(content) - start
    if found != expected:
        raise LoadLedgerError(
            f"{path}: found {found} bytes of numbers, allowed are {expected}, {len(names)} columns of "
            f"{triangles} triangles; the file is truncated or was written by something else."
        )
    table = np.frombuffer(content, "<f8", offset=start).reshape(len(names), triangles).astype(np.float64)
    columns = dict(zip(names, table, strict=True))
    loaded = columns["normal_impulse_N_s"] > 0.0
    for name, values in columns.items():
        wrong, allowed = ~np.isfinite(values), "a finite number"
        if name == RADIUS or name in WEIGHTS:
            wrong, allowed = wrong & loaded, "a finite number where the triangle is loaded"
        elif name in SUMS:
            wrong, allowed = wrong | (values < 0.0), "a finite number, at least 0"
        if wrong.any():
            at = int(np.argmax(wrong))
            raise LoadLedgerError(f"{path}: {name} of triangle {at} is {values[at]:g}, allowed is {allowed}.")
    return columns
