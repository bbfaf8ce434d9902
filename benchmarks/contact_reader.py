"""Speed of the contact reader and of the sampled load ledger on a synthetic dump, by one core.

MB are those of the contact dump; the spin dump, nearly half as much text, is read along with it. A child process writes
both and keeps its memory.
"""

from __future__ import annotations

import resource
import tempfile
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from benchmarks.measure import Measure, in_turn, measured, processor_times
from bulkwear.postproc.readers.contacts import CONTACT_COLUMNS, read_contact_batches, read_contacts
from bulkwear.postproc.readers.dump_text import read_frames
from bulkwear.postproc.wear.ledger import LedgerBuilder

MEGABYTES, QUICK_MEGABYTES = 300.0, 10.0  # of the contact dump
CONTACTS = 1000  # per frame
REPEATS, QUICK_REPEATS = 3, 2
TRIANGLES = 50_000
PARTICLES = 400_000
DISTINCT_FRAMES = 8
SPIN_NAMES = "id radius omegax omegay omegaz f_force_walls[1] f_force_walls[2] f_force_walls[3]"
BOX = "ITEM: BOX BOUNDS pp ff ff\n-0.15 0.15\n-0.6 0.6\n0 0.12\n"


def _frame_texts(contacts: int, seed: int) -> tuple[str, str]:
    """Contact rows and spin rows of one frame with the number formats of the solver."""
    random = np.random.default_rng(seed)
    particle = np.sort(random.choice(PARTICLES, contacts, replace=False)) + 1
    centre = random.uniform(-0.1, 0.1, (contacts, 3))
    normal = random.normal(size=(contacts, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    velocities = random.normal(size=(contacts, 6))
    ids = np.column_stack([np.zeros(contacts), random.integers(0, TRIANGLES, contacts), particle])
    force = normal * random.exponential(0.1, (contacts, 1))
    rows = np.column_stack([centre - 0.001325 * normal, centre, velocities, ids, force])
    spins = np.column_stack([particle, np.full(contacts, 0.001325), random.normal(0.0, 50.0, (contacts, 3)), force])
    return tuple("".join(" ".join(f"{x:g}" for x in row) + " \n" for row in table) for table in (rows, spins))


def write_dumps(folder: Path, megabytes: float, contacts: int) -> int:
    """Writes contacts.dump of about this size and the matching spins.dump; returns the number of frames."""
    names = " ".join(f"c_wall_contact[{k + 1}]" for k in range(CONTACT_COLUMNS))
    texts = [_frame_texts(contacts, seed) for seed in range(DISTINCT_FRAMES)]
    step, written = 0, 0
    with open(folder / "contacts.dump", "w") as local, open(folder / "spins.dump", "w") as custom:
        while written < megabytes * 1e6:
            rows, spins = texts[step % DISTINCT_FRAMES]
            step += 1
            head = f"ITEM: TIMESTEP\n{step * 20}\nITEM: NUMBER OF {{}}\n{contacts}\n{BOX}"
            written += local.write(f"{head.format('ENTRIES')}ITEM: ENTRIES {names} \n{rows}")
            custom.write(f"{head.format('ATOMS')}ITEM: ATOMS {SPIN_NAMES} \n{spins}")
    return step


def _ledger(folder: Path, batched: bool) -> None:
    corners = np.random.default_rng(1).uniform(-0.1, 0.1, (TRIANGLES, 3, 3))
    builder = LedgerBuilder(TRIANGLES, 0, 2e8, 2460.0, corners=corners)
    paths = folder / "contacts.dump", folder / "spins.dump"
    for contacts in read_contact_batches(*paths) if batched else read_contacts(*paths):
        (builder.add_batch if batched else builder.add)(contacts, 1e-4)
    builder.table()


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the rates (MB/s of processor time) of parsing, reading and accounting, and the peak memory."""
    with tempfile.TemporaryDirectory() as name:
        with get_context("spawn").Pool(1) as pool:
            pool.apply(write_dumps, (Path(name), QUICK_MEGABYTES if quick else MEGABYTES, CONTACTS))
        paths = Path(name) / "contacts.dump", Path(name) / "spins.dump"
        size = paths[0].stat().st_size / 1e6
        next(iter(read_contact_batches(*paths)))  # compiles or loads the parser

        def rate(task: Callable[[], object]) -> Callable[[], float]:
            return lambda: size / processor_times(task, 1)[0]

        ways = {
            "parse": rate(lambda: [None for _ in read_frames(paths[0], "ENTRIES")]),
            "read": rate(lambda: [None for _ in read_contact_batches(*paths)]),
            "frames": rate(lambda: [None for _ in read_contacts(*paths)]),
            "ledger": rate(lambda: _ledger(Path(name), batched=True)),
            "slow ledger": rate(lambda: _ledger(Path(name), batched=False)),
        }
        found = in_turn(ways, QUICK_REPEATS if quick else REPEATS)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    single = "one frame at a time"
    return [
        measured(f"parse a contact dump of {size:.0f} MB", "MB/s", found["parse"]),
        measured("read contacts and spins, batches of frames", "MB/s", found["read"], single, found["frames"]),
        measured("read and account, batches of frames", "MB/s", found["ledger"], single, found["slow ledger"]),
        measured("most memory of this process so far", "MB", [peak]),
    ]
