"""Wall contacts of a run, sample by sample, from a `dump local` and a `dump custom` with the spins.

The deck writes (spins BEFORE contacts, wall fix with `store_force yes`, compute before the first run)::

    compute wall_contact all wall/gran/local pos vel id force
    variable wall_force_squared atom f_force_wall[1]^2+f_force_wall[2]^2+f_force_wall[3]^2
    dump spins all custom 20 spins.dump id radius omegax omegay omegaz f_force_wall[1] f_force_wall[2] f_force_wall[3]
    dump_modify spins thresh v_wall_force_squared > 0.0
    dump contacts all local 20 contacts.dump c_wall_contact[1] ... c_wall_contact[18]

The three forces are those that moved the particle; without them only what the dump evaluates once more is known.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bulkwear.postproc.readers.dump_text import BLOCK_BYTES, ContactDumpError, FrameBatch, dump_columns, read_frames

__all__ = ["ContactBatch", "ContactDumpError", "Contacts", "read_contact_batches", "read_contacts"]

CONTACT_COLUMNS = 18
SPIN_COLUMNS = ("id", "radius", "omegax", "omegay", "omegaz")
WALL_FORCE = re.compile(r"f_force_\w+\[[123]\]")  # columns of the force that a wall fix has stored
_CONTACT_ENDINGS = [f"{k}]" for k in range(1, CONTACT_COLUMNS + 1)]
_MESH, _TRIANGLE, _PARTICLE = 12, 13, 14


@dataclass(frozen=True, eq=False, kw_only=True)
class _ContactArrays:
    """What is known of n contacts between particles and mesh triangles.

    triangle, mesh, particle: (n,) int64 (triangle 0-based = facet order of the STL file)
    contact_point, centre: (n, 3) m; radius: (n,) m
    wall_velocity, particle_velocity: (n, 3) m/s; angular_velocity: (n, 3) rad/s
    force: (n, 3) N, on the particle, evaluated for the dump
    wall_force: (n, 3) N, of all mesh contacts of the particle together as the step had it; NaN where the dump lacks it
    """

    triangle: np.ndarray
    mesh: np.ndarray
    particle: np.ndarray
    contact_point: np.ndarray
    centre: np.ndarray
    wall_velocity: np.ndarray
    particle_velocity: np.ndarray
    angular_velocity: np.ndarray
    force: np.ndarray
    radius: np.ndarray
    wall_force: np.ndarray


CONTACT_FIELDS = tuple(_ContactArrays.__dataclass_fields__)


@dataclass(frozen=True, eq=False, kw_only=True)
class Contacts(_ContactArrays):
    """Contacts at one sampled time step; step: the time step."""

    step: int


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactBatch(_ContactArrays):
    """Contacts of consecutive samples in one piece, and the rows of each sample.

    steps: (f,) int64; starts: (f + 1,) int64, rows of sample k are starts[k]:starts[k + 1]
    """

    steps: np.ndarray
    starts: np.ndarray

    def __iter__(self) -> Iterator[Contacts]:
        arrays = {name: getattr(self, name) for name in CONTACT_FIELDS}
        bounds = self.starts.tolist()
        for step, first, last in zip(self.steps.tolist(), bounds, bounds[1:], strict=False):
            yield Contacts(step=step, **{name: array[first:last] for name, array in arrays.items()})


def _after(batches: Iterator[FrameBatch], after_step: int | None) -> Iterator[FrameBatch]:
    for batch in batches:
        first = 0 if after_step is None else int(np.searchsorted(batch.steps, after_step, side="right"))
        if first < batch.steps.size:
            yield batch.frames(first, batch.steps.size)


def _joined(parts: list[FrameBatch]) -> FrameBatch:
    if len(parts) == 1:
        return parts[0]
    offsets = np.cumsum([0] + [part.table.shape[0] for part in parts])
    starts = [part.starts[:-1] + offset for part, offset in zip(parts, offsets, strict=False)]
    return FrameBatch(
        np.concatenate([part.steps for part in parts]),
        np.concatenate([*starts, offsets[-1:]]),
        np.concatenate([part.table for part in parts]),
        parts[0].columns,
    )


def _paired(contacts: Iterator[FrameBatch], spins: Iterator[FrameBatch], contact_path: Path, spin_path: Path):
    """Batches of both dumps that hold the same frames."""
    pending: list[FrameBatch] = []
    for batch in contacts:
        while sum(part.steps.size for part in pending) < batch.steps.size:
            part = next(spins, None)
            if part is None:
                break
            pending.append(part)
        spin = _joined(pending) if pending else None
        found = spin.steps[: batch.steps.size] if spin else np.empty(0, np.int64)
        _check_steps(batch.steps, found, contact_path, spin_path)
        pending = [spin.frames(batch.steps.size, spin.steps.size)]
        yield batch, spin.frames(0, batch.steps.size)
    extra = [part for part in (*pending, next(spins, None)) if part is not None and part.steps.size]
    if extra:
        raise ContactDumpError(
            f"{spin_path}: found step {extra[0].steps[0]}, which {contact_path} lacks, "
            "allowed are the same steps in both."
        )


def _check_steps(expected: np.ndarray, found: np.ndarray, contact_path: Path, spin_path: Path) -> None:
    same = found == expected[: found.size]
    if same.all() and found.size == expected.size:
        return
    k = found.size if same.all() else int(np.argmin(same))
    there = f"step {found[k]}" if k < found.size else "the end of the file"
    raise ContactDumpError(
        f"{spin_path}: found {there} where {contact_path} has step {expected[k]}, allowed are the same steps in both."
    )


def _spin_rows(contact: FrameBatch, spin: FrameBatch, particle: np.ndarray, spin_path: Path) -> np.ndarray:
    """Row of the spin table that belongs to each contact, -1 where the spin dump lacks the particle."""
    identity = spin.table[:, spin.columns.index("id")].astype(np.int64)
    stride = 1 + max(identity.max(initial=0), particle.max(initial=0))
    key = np.repeat(np.arange(spin.steps.size), np.diff(spin.starts)) * stride + identity
    order = np.argsort(key, kind="stable")
    key = key[order]
    if (key[1:] == key[:-1]).any():
        frame, which = divmod(int(key[1:][key[1:] == key[:-1]][0]), int(stride))
        raise ContactDumpError(
            f"{spin_path}, step {spin.steps[frame]}: particle {which} appears twice, allowed is once."
        )
    wanted = np.repeat(np.arange(contact.steps.size), np.diff(contact.starts)) * stride + particle
    place = np.minimum(np.searchsorted(key, wanted), max(key.size - 1, 0))
    if key.size == 0:
        return np.full(wanted.size, -1)
    return np.where(key[place] == wanted, order[place], -1)


def _check_missing(rows, contact: FrameBatch, particle: np.ndarray, spin_path: Path) -> None:
    """A contact without force may lack its spin (the deck selects particles by force); others may not."""
    missing = (rows < 0) & contact.table[:, 15:18].any(axis=1)
    if missing.any():
        k = int(np.argmax(missing))
        step = contact.steps[np.searchsorted(contact.starts, k, side="right") - 1]
        raise ContactDumpError(
            f"{spin_path}, step {step}: particle {particle[k]} is missing, "
            "allowed is a spin for every particle that a wall pushes (thresh on the force's square)."
        )


def _batch(contact: FrameBatch, spin: FrameBatch, spin_path: Path) -> ContactBatch:
    table = contact.table
    particle = table[:, _PARTICLE].astype(np.int64)
    rows = _spin_rows(contact, spin, particle, spin_path)
    _check_missing(rows, contact, particle, spin_path)
    known = rows >= 0
    radius_column, *spin_columns = (spin.columns.index(name) for name in SPIN_COLUMNS[1:])
    angular_velocity = np.zeros((particle.size, 3))
    angular_velocity[known] = spin.table[rows[known]][:, spin_columns]
    radius = np.linalg.norm(table[:, 3:6] - table[:, 0:3], axis=1)
    radius[known] = spin.table[rows[known], radius_column]
    wall_force = np.full((particle.size, 3), np.nan)
    if force_columns := _wall_force_columns(spin.columns):
        wall_force[known] = spin.table[rows[known]][:, force_columns]
    return ContactBatch(
        steps=contact.steps,
        starts=contact.starts,
        triangle=table[:, _TRIANGLE].astype(np.int64),
        mesh=table[:, _MESH].astype(np.int64),
        particle=particle,
        contact_point=table[:, 0:3],
        centre=table[:, 3:6],
        wall_velocity=table[:, 6:9],
        particle_velocity=table[:, 9:12],
        angular_velocity=angular_velocity,
        force=table[:, 15:18],
        radius=radius,
        wall_force=wall_force,
    )


def _wall_force_columns(names: tuple[str, ...]) -> list[int]:
    return [k for k, name in enumerate(names) if WALL_FORCE.fullmatch(name)]


def _check_columns(contact_path: Path, spin_path: Path) -> None:
    _, names = dump_columns(contact_path, "ENTRIES")
    if [name.rpartition("[")[2] for name in names] != _CONTACT_ENDINGS:
        raise ContactDumpError(
            f"{contact_path}, line 9: found {len(names)} columns {' '.join(names)}, allowed are the "
            f"{CONTACT_COLUMNS} columns c_ID[1] ... of `wall/gran/local pos vel id force`."
        )
    _, names = dump_columns(spin_path, "ATOMS")
    if not set(SPIN_COLUMNS) <= set(names):
        raise ContactDumpError(
            f"{spin_path}, line 9: found {' '.join(names)}, allowed are at least {' '.join(SPIN_COLUMNS)}."
        )
    forces = [names[k] for k in _wall_force_columns(tuple(names))]
    if [name[-3:] for name in forces] not in ([], ["[1]", "[2]", "[3]"]):
        raise ContactDumpError(
            f"{spin_path}, line 9: found {' '.join(forces)}, allowed are f_force_ID[1] f_force_ID[2] f_force_ID[3] of "
            "one wall, or none of them."
        )


def read_contact_batches(
    contact_dump: Path | str,
    spin_dump: Path | str,
    after_step: int | None = None,
    block_bytes: int = BLOCK_BYTES,
) -> Iterator[ContactBatch]:
    """Streams the wall contacts in batches of samples (fast path; `LedgerBuilder.add_batch` takes them).

    contact_dump, spin_dump: files written as in the module's docstring
    after_step: frames up to and including this step are dropped (a dump may begin with its run's set-up step)
    block_bytes: bytes of text read at a time

    Raises ContactDumpError, one sentence with file, line or step, and what is allowed.
    """
    contact_path, spin_path = Path(contact_dump), Path(spin_dump)
    _check_columns(contact_path, spin_path)
    contacts = read_frames(contact_path, "ENTRIES", (_MESH, _TRIANGLE, _PARTICLE), block_bytes)
    spins = read_frames(spin_path, "ATOMS", ("id",), block_bytes)
    pairs = _paired(_after(contacts, after_step), _after(spins, after_step), contact_path, spin_path)
    for contact, spin in pairs:
        yield _batch(contact, spin, spin_path)


def read_contacts(contact_dump: Path | str, spin_dump: Path | str, after_step: int | None = None) -> Iterator[Contacts]:
    """Streams the wall contacts, one `Contacts` per sampled step; samples without contacts are yielded too.

    Arguments and errors as `read_contact_batches`.
    """
    for batch in read_contact_batches(contact_dump, spin_dump, after_step):
        yield from batch
