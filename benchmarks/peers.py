"""How fast are other codes with the same bed, and what do they tell of wear? LIGGGHTS, LAMMPS, Yade and Kratos DEM
beside ours, each on one core.

    python -m benchmarks.peers             # in the root of the repository
    python -m benchmarks.peers --quick     # tiny; nothing is written into docs
    python -m benchmarks.peers --redraw

Peers are optional: one that is not found is named, with how to get it, and left out. Nothing is installed; `--peers` is
the folder of their environment and programs, none of which are the project's. Writes into docs: peers.csv (every
round), figure and peers.md; `--redraw` makes the last two from the first.
"""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable
from dataclasses import replace
from datetime import date
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.peer_case import LOADED_OVERLAP, PeerRun, answer, hertz_force, one_sphere
from benchmarks.peer_codes import OURS, Code, codes, run_code, step_rate
from benchmarks.peer_decks import FILL, filling_deck
from benchmarks.peer_page import QUANTITIES, results_page, speeds
from benchmarks.plots.peers import rates_by_code
from bulkwear.postproc.plots.style import save
from bulkwear.workflows.engine.solver import DECK, SCREEN, SolverError, run_deck
from bulkwear.workflows.forecast.rates import machine_facts

PARTICLES, STEPS, SAMPLES, ROUNDS, DRAGGED_STEPS = 2000, 6000, 20, 3, 4000
QUICK_PARTICLES, QUICK_STEPS = 200, 200
FILLING_STEPS, QUICK_FILLING_STEPS = 40_000, 20_000  # some 0.3 and 0.15 s, of which falling takes a third
MOVED, BY = f"{OURS}, one particle moved by 1 nm", 1e-9  # m; how far chaos alone goes
VERSIONS = (
    r"Version (LIGGGHTS-PUBLIC [\d.]+)",
    r"LAMMPS \((.+?)\)",
    r"Welcome to (Yade \S+)",
    r"Multi-Physics (.+?)-R",
)
FILE, PAGE, FIGURE = "peers.csv", "peers.md", "peers.png"


def bed(folder: Path, count: int, steps: int) -> np.ndarray:
    """Return centres and radii (n, 4) in m of particles at rest, filled by LIGGGHTS unless that was done before."""
    if not (folder / FILL).exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / DECK).write_text(filling_deck(PeerRun(steps, 1), count, steps))
        run_deck(folder)
    lines = (folder / FILL).read_text().splitlines()
    last = max(number for number, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    rows = np.loadtxt(lines[last + 1 :], ndmin=2)
    return rows[np.argsort(rows[:, 0]), 1:]


def row(code: Code, folder: Path, run: PeerRun, particles: np.ndarray) -> dict[str, float | str]:
    """Return what a code makes of the bed, and of the dragged sphere where it tells of wear. Raises SolverError."""
    rate = step_rate(code, folder, run, replace(run, steps=1, samples=1), particles)
    told = answer(folder / "run", run, particles)[list(QUANTITIES)].mean()
    wear = math.nan
    if code.wear is not None:
        dragged = replace(run, steps=DRAGGED_STEPS, samples=1, dragged=True)
        sphere = one_sphere()
        run_code(code, folder / "dragged", dragged, sphere)
        closed = run.archard * hertz_force(run, sphere[0, 3], LOADED_OVERLAP) * dragged.travel
        wear = code.wear(folder / "dragged", dragged) / closed
    return {
        "code": code.name,
        "version": version((folder / "run" / SCREEN).read_text("utf-8", "replace")),
        "date": f"{date.today():%Y-%m-%d}",
        "particles": len(particles),
        "steps": run.steps,
        "particle_steps_per_s": rate,
        **told,
        "wear_over_archard": wear,
    }


def version(screen: str) -> str:
    """Return what a program says of its version when it starts, "" where it says nothing known."""
    found = (re.search(pattern, screen) for pattern in VERSIONS)
    return next((each[1].replace('"', "") for each in found if each), "")


def rounds(
    folder: Path,
    run: PeerRun,
    particles: np.ndarray,
    count: int,
    known: list[Code],
    each: Callable[[pd.DataFrame], None],
) -> None:
    """Run all codes in every round, in an order that turns; hand the table so far, a row per round and code, to `each`
    after every run.
    """
    moved = particles.copy()
    moved[0, 0] += BY
    chaos = replace(known[0], name=MOVED, wear=None)
    entries, rows = [(known[0], particles), (chaos, moved), *((code, particles) for code in known[1:])], []
    names = [code.name for code, _ in entries]
    for number in range(count):
        shift = number % len(entries)
        for code, given in entries[shift:] + entries[:shift]:
            try:
                rows.append({"round": number + 1, **row(code, folder / code.name, run, given)})
            except SolverError as fault:
                print(f"{code.name} is left out: {fault}", flush=True)
                continue
            print(f"round {number + 1}, {code.name}: {rows[-1]['particle_steps_per_s']:.3g} 1/s", flush=True)
            each(pd.DataFrame(sorted(rows, key=lambda told: (told["round"], names.index(told["code"])))))


def available(known: list[Code]) -> list[Code]:
    """Return the codes that are there; say of each other one how to get it."""
    for code in known:
        if code.command is None:
            print(f"{code.name} was not found and is left out: {code.how_to_get}.", flush=True)
    return [code for code in known if code.command is not None]


def publish(output: Path, table: pd.DataFrame, known: list[Code]) -> str:
    """Write figure and page of the rounds; return the page."""
    page = results_page(table, known, machine_facts())
    (output / PAGE).write_text(page, encoding="utf-8")
    remarks = [
        f"a bed of {table['particles'].iloc[0]} spheres on a floor that is pulled away; median and range of"
        f" {table['round'].nunique()} rounds in turn, one core",
        f"made by benchmarks/peers.py, {date.today():%Y-%m-%d}",
    ]
    save(rates_by_code(speeds(table), remarks), output / FIGURE)
    return page


def main() -> None:
    """Run all codes that are there, then write table, figure and page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full/peers"), help="for simulations")
    parser.add_argument("--peers", type=Path, default=Path("results/peers"), help="of the peers' environment")
    parser.add_argument("--rounds", type=at_least_one, default=ROUNDS)
    parser.add_argument("--quick", action="store_true", help="tiny sizes; nothing is written into docs")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    given = parser.parse_args()
    known, output = codes(given.peers), given.folder if given.quick else given.output
    if not given.redraw:
        count, steps, filling = (
            (QUICK_PARTICLES, QUICK_STEPS, QUICK_FILLING_STEPS) if given.quick else (PARTICLES, STEPS, FILLING_STEPS)
        )
        particles = bed(given.folder / f"bed_{count}", count, filling)
        write = partial(pd.DataFrame.to_csv, path_or_buf=output / FILE, index=False, float_format="%.6g")
        rounds(given.folder, PeerRun(steps, SAMPLES), particles, given.rounds, available(known), write)
    print(publish(output, read_table(output / FILE), known), flush=True)


if __name__ == "__main__":
    command(main)
