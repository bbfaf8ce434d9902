"""What a second rank saves: the bed of the other benchmarks by one rank, and by two that share it across or along the
travel. Efficiency is the time of one rank over twice that of two. Needs two idle cores.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from benchmarks.bed_case import cycle_deck, particles_of, prepared_chain
from benchmarks.ledger_overhead import PARTICLE_SCALE, QUICK_PARTICLE_SCALE, Variant, seconds, variants
from benchmarks.measure import Measure, in_turn, measured

STEPS, QUICK_STEPS = 1500, 150
ROUNDS, QUICK_ROUNDS = 5, 2
PROCESSORS = re.compile(r"^processors\s+\S+ \S+ \S+", re.MULTILINE)
ONE, ACROSS, ALONG = "one rank", "two ranks across the travel", "two ranks along the travel"
GRIDS = {ONE: "1 1 1", ACROSS: "2 1 1", ALONG: "1 2 1"}


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the wall time of the time steps on each grid, and of two ranks the efficiency as their ratio."""
    chain = prepared_chain(folder, QUICK_PARTICLE_SCALE if quick else PARTICLE_SCALE)
    steps = QUICK_STEPS if quick else STEPS
    cycle, _, _ = cycle_deck(chain, "ranks")
    deck = variants(chain, steps)["solver"]

    def way(grid: str, ranks: int) -> Callable[[], float]:
        variant: Variant = replace(deck, deck=PROCESSORS.sub(f"processors {grid}", deck.deck))
        return lambda: seconds(cycle, variant, ranks)[0]

    ways = {name: way(grid, 1 if name == ONE else 2) for name, grid in GRIDS.items()}
    found = in_turn(ways, QUICK_ROUNDS if quick else ROUNDS)
    one, across, along = found.values()
    told = [measured(f"one rank, {particles_of(chain)} particles, {steps} steps", "s", one)]
    for name, two in ((ACROSS, across), (ALONG, along)):
        rates = [steps / time for time in two]
        told.append(measured(name, "steps/s", rates, "two times one rank", [2.0 * steps / time for time in one]))
    told.append(measured("split across the travel", "s", across, "split along it", along))
    return told
