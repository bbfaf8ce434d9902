"""What a second rank saves: the bed of the other benchmarks by one rank, and by two that share it across or along the
travel; efficiency is the time of one rank over twice that of two. And what a second rank adds: a bed and a sample twice
as wide by two ranks; efficiency is the time of one rank with the single bed over theirs. Needs two idle cores.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from benchmarks.ledger_overhead import PARTICLE_SCALE, QUICK_PARTICLE_SCALE, seconds, variants
from benchmarks.measure import Measure, in_turn, measured
from benchmarks.runs import cycle_deck, particles_of, prepared_chain
from bulkwear.workflows.engine.chain import Chain

STEPS, QUICK_STEPS = 1500, 150
ROUNDS, QUICK_ROUNDS = 5, 2
PROCESSORS = re.compile(r"^processors\s+\S+ \S+ \S+", re.MULTILINE)
ONE, ACROSS, ALONG = "one rank", "two ranks across the travel", "two ranks along the travel"
WIDER = "two ranks across a bed twice as wide"
GRIDS = {ONE: "1 1 1", ACROSS: "2 1 1", ALONG: "1 2 1", WIDER: "2 1 1"}


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the wall time of the time steps on each grid, and of two ranks the efficiency as their ratio."""
    scale, steps = (QUICK_PARTICLE_SCALE, QUICK_STEPS) if quick else (PARTICLE_SCALE, STEPS)
    chain, wider = (prepared_chain(folder, scale, wider) for wider in (1, 2))
    found = in_turn(
        {name: way(wider if name == WIDER else chain, name, steps) for name in GRIDS},
        QUICK_ROUNDS if quick else ROUNDS,
    )
    one, across, along, twice = found.values()
    told = [measured(f"one rank, {particles_of(chain)} particles, {steps} steps", "s", one)]
    for name, two in ((ACROSS, across), (ALONG, along)):
        rates = [steps / time for time in two]
        told.append(measured(name, "steps/s", rates, "two times one rank", [2.0 * steps / time for time in one]))
    told.append(measured("split across the travel", "s", across, "split along it", along))
    rates = [steps / time for time in twice]
    name = f"{WIDER}, {particles_of(wider)} particles"
    told.append(measured(name, "steps/s", rates, "one rank, the single bed", [steps / time for time in one]))
    return told


def way(chain: Chain, name: str, steps: int) -> Callable[[], float]:
    """Return what runs so many time steps of a chain on a grid of `GRIDS`, and gives their wall time (s)."""
    deck = variants(chain, steps)["solver"]
    cycle, _, _ = cycle_deck(chain, "ranks")
    on_grid = PROCESSORS.sub(f"processors {GRIDS[name]}", deck)
    return lambda: seconds(cycle, on_grid, ranks=1 if name == ONE else 2)[0]
