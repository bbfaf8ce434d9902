"""Speed and memory of the contact reader and the load ledger on a synthetic dump.

    python benchmarks/contact_reader.py --megabytes 500 --contacts 1000

Prints MB of the contact dump per second of one core's time (the spin dump, a quarter more text, is read along
with it) and the peak memory of the process that reads. A child process writes the dumps and keeps its memory.
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import time
from multiprocessing import get_context
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from postproc.readers.contacts import CONTACT_COLUMNS, read_contact_batches, read_contacts
from postproc.readers.dump_text import read_frames
from postproc.wear.ledger import LedgerBuilder

TRIANGLES = 50_000
PARTICLES = 400_000
DISTINCT_FRAMES = 8
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
    spins = np.column_stack([particle, np.full(contacts, 0.001325), random.normal(0.0, 50.0, (contacts, 3))])
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
            custom.write(f"{head.format('ATOMS')}ITEM: ATOMS id radius omegax omegay omegaz \n{spins}")
    return step


def _timed(label: str, megabytes: float, action) -> None:
    start, cpu_start = time.perf_counter(), time.process_time()
    action()
    seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - cpu_start
    print(f"{label:<41} {seconds:6.2f} s wall {cpu_seconds:6.2f} s of core {megabytes / cpu_seconds:6.0f} MB/s")


def _ledger(folder: Path, batched: bool) -> None:
    builder = LedgerBuilder(TRIANGLES, 0, 2e8, 2460.0)
    paths = folder / "contacts.dump", folder / "spins.dump"
    for contacts in read_contact_batches(*paths) if batched else read_contacts(*paths):
        (builder.add_batch if batched else builder.add)(contacts, 1e-4)
    builder.table()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--megabytes", type=float, default=500.0, help="size of the contact dump")
    parser.add_argument("--contacts", type=int, default=1000, help="contacts per frame")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with get_context("spawn").Pool(1) as pool:
            frames = pool.apply(write_dumps, (folder, arguments.megabytes, arguments.contacts))
        size = (folder / "contacts.dump").stat().st_size / 1e6
        spin_size = (folder / "spins.dump").stat().st_size / 1e6
        print(f"contact dump {size:.0f} MB, spin dump {spin_size:.0f} MB, {frames} frames")
        paths = folder / "contacts.dump", folder / "spins.dump"
        for contacts in read_contact_batches(*paths):  # compiles or loads the parser
            del contacts
            break
        _timed("parse the contact dump alone", size, lambda: [None for _ in read_frames(paths[0], "ENTRIES")])
        _timed("read both dumps, batches of frames", size, lambda: [None for _ in read_contact_batches(*paths)])
        _timed("read both dumps, one frame at a time", size, lambda: [None for _ in read_contacts(*paths)])
        _timed("read and ledger, batches (add_batch)", size, lambda: _ledger(folder, batched=True))
        _timed("read and ledger, one frame at a time (add)", size, lambda: _ledger(folder, batched=False))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory {peak:.0f} MB")


if __name__ == "__main__":
    main()
