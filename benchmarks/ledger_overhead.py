"""What the load ledger costs: the same bed of some 20,000 particles with the plain solver and with the ledger, in turn.

    python benchmarks/ledger_overhead.py --pairs 7

Prints, pair by pair, the time that the solver spent in its time steps ("Loop time"), and the median of the ratios. The
order within a pair alternates, so that a drift of the machine's speed favours nobody.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import numpy as np
from bed_case import cycle_deck, prepared_chain

from workflows.solver import LEDGER_EXECUTABLE, SCREEN, run_deck

PARTICLE_SCALE = 1.85  # makes some 20,000 particles of the demo's bed
LOOP_TIME = re.compile(r"^Loop time of ([\d.eE+-]+) on (\d+) procs for (\d+) steps with (\d+) atoms", re.MULTILINE)
OF_LEDGER = re.compile(r"^(fix\s+load_ledger|unfix\s+load_ledger).*\n", re.MULTILINE)
OF_OUTPUT = re.compile(r"^(dump\s|write_restart\s).*\n", re.MULTILINE)


def decks(text: str, steps: int) -> dict[str, str]:
    """Return the deck without output, as long as asked, without and with the ledger."""
    text = re.sub(r"(variable\s+cycle_steps\s+equal\s+)\S+", rf"\g<1>{steps}", OF_OUTPUT.sub("", text))
    return {"plain": OF_LEDGER.sub("", text), "ledger": text}


def loop_time(folder: Path, deck: str, program: str, ranks: int) -> float:
    """Run a deck and return the seconds that its time steps took."""
    (folder / "deck.in").write_text(deck)
    run_deck(folder, ranks, executable=program)
    return float(LOOP_TIME.findall((folder / SCREEN).read_text())[-1][0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/ledger_overhead"))
    parser.add_argument("--pairs", type=int, default=7)
    parser.add_argument("--steps", type=int, default=1500, help="time steps per run")
    parser.add_argument("--ranks", type=int, default=1)
    given = parser.parse_args()
    chain = prepared_chain(given.folder, PARTICLE_SCALE)
    folder, surface, text = cycle_deck(chain, "overhead")
    texts, programs = decks(text, given.steps), {"plain": "liggghts", "ledger": LEDGER_EXECUTABLE}
    ratios = []
    for pair in range(given.pairs):
        order = ("plain", "ledger") if pair % 2 == 0 else ("ledger", "plain")
        seconds = {name: loop_time(folder, texts[name], programs[name], given.ranks) for name in order}
        ratios.append(seconds["ledger"] / seconds["plain"])
        print(
            f"pair {pair + 1}: plain {seconds['plain']:.2f} s, ledger {seconds['ledger']:.2f} s, ratio {ratios[-1]:.4f}"
        )
    atoms = LOOP_TIME.findall((folder / SCREEN).read_text())[-1][3]
    print(
        f"{atoms} particles, {len(surface.triangles)} triangles, {given.steps} steps, {given.ranks} rank(s): "
        f"median ratio {np.median(ratios):.4f}, from {min(ratios):.4f} to {max(ratios):.4f}"
    )


if __name__ == "__main__":
    main()
