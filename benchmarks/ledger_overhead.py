"""What a load ledger costs: one bed of some 20,000 particles with the plain solver, the ledger, and dumps, in turn.

    python benchmarks/ledger_overhead.py --rounds 7

Each round runs the same time steps three times: without any accounting, with every contact summed in the solver
(`ledger: solver`), and with contacts dumped at intervals (`ledger: dumps`). Their order changes from round to
round, so that a drift of the machine's speed favours nobody. Prints the time of the time steps ("Loop time") and the
processor time of the solver, and the medians of their ratios to the plain solver of the same round.
"""

from __future__ import annotations

import argparse
import re
import resource
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from bed_case import cycle_deck, prepared_chain

from workflows.chain import Chain, deck_text
from workflows.schedule import first_span
from workflows.solver import CYCLE_EXECUTABLES, SCREEN, run_deck

PARTICLE_SCALE = 1.85  # makes some 20,000 particles of the demo's bed
SAMPLING_INTERVAL = 20  # steps, the default of studies with `ledger: dumps`
LOOP_TIME = re.compile(r"^Loop time of ([\d.eE+-]+) on (\d+) procs for (\d+) steps with (\d+) atoms", re.MULTILINE)
OF_LEDGER = re.compile(r"^(fix\s+load_ledger|unfix\s+load_ledger).*\n", re.MULTILINE)
OTHER_OUTPUT = re.compile(r"^(dump\s+(bed|loads)\s|write_restart\s).*\n", re.MULTILINE)


@dataclass(frozen=True)
class Variant:
    """A deck and the program that runs it."""

    deck: str
    program: str


def variants(chain: Chain, steps: int) -> dict[str, Variant]:
    """Return the three ways to run the first wear cycle, `steps` long, without pictures and restart file."""
    solver = {**chain.parameters["solver"], "sampling_interval_steps": SAMPLING_INTERVAL}
    derived = {**chain.parameters["derived"], "first_cycle_steps": steps}
    texts = {}
    for ledger in CYCLE_EXECUTABLES:
        parameters = {**chain.parameters, "ledger": ledger, "solver": solver, "derived": derived}
        texts[ledger] = OTHER_OUTPUT.sub("", deck_text(replace(chain, parameters=parameters), first_span(parameters)))
    ways = {ledger: Variant(text, CYCLE_EXECUTABLES[ledger]) for ledger, text in texts.items()}
    return {"plain": Variant(OF_LEDGER.sub("", texts["solver"]), CYCLE_EXECUTABLES["dumps"]), **ways}


def seconds(folder: Path, variant: Variant, ranks: int) -> tuple[float, float]:
    """Run a variant; return the wall time of its time steps and the processor time of the whole solver run, in s."""
    (folder / "deck.in").write_text(variant.deck)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run_deck(folder, ranks, executable=variant.program)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return float(LOOP_TIME.findall((folder / SCREEN).read_text())[-1][0]), processor


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/ledger_overhead"))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--steps", type=int, default=1500, help="time steps per run")
    parser.add_argument("--ranks", type=int, default=1)
    given = parser.parse_args()
    chain = prepared_chain(given.folder, PARTICLE_SCALE)
    folder, surface, _ = cycle_deck(chain, "overhead")
    ways = variants(chain, given.steps)
    names, measured = list(ways), {name: [] for name in ways}
    for number in range(given.rounds):
        shift = number % len(names)
        for name in names[shift:] + names[:shift]:
            measured[name].append(seconds(folder, ways[name], given.ranks))
        last = ", ".join(f"{name} {measured[name][-1][0]:.2f} s" for name in names)
        print(f"round {number + 1}, time of the steps: {last}", flush=True)
    atoms = LOOP_TIME.findall((folder / SCREEN).read_text())[-1][3]
    print(f"{atoms} particles, {len(surface.triangles)} triangles, {given.steps} steps, {given.ranks} rank(s)")
    plain = np.array(measured["plain"])
    for name in names[1:]:
        ratios = np.array(measured[name]) / plain
        for column, what in enumerate(("time of the steps", "processor time")):
            low, middle, high = np.quantile(ratios[:, column], (0.0, 0.5, 1.0))
            print(f"{name} over plain, {what}: median {middle:.4f}, from {low:.4f} to {high:.4f}")


if __name__ == "__main__":
    main()
