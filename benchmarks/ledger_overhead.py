"""What a deck and its load ledger cost: the same time steps of one bed by several decks, in turn.

Bare is a deck with nothing but the physics: no ledger, no pictures, no restart file, no loads or wear per triangle, no
checks. Each of these decks has the same bed, sample and time steps. What a deck writes once per cycle, and once per
picture, is written once in so many steps; in a study cycles are longer, so its decks cost less than here. Our program
runs all of them.
"""

from __future__ import annotations

import re
import resource
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from benchmarks.measure import Measure, in_turn, measured
from benchmarks.runs import cycle_deck, particles_of, prepared_chain
from bulkwear.workflows.engine.chain import Chain, deck_text
from bulkwear.workflows.engine.schedule import first_span
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, SCREEN, run_deck

PARTICLE_SCALE, QUICK_PARTICLE_SCALE = 2.4, 4.0  # the former makes some 20,000 particles of the demo's bed
STEPS, QUICK_STEPS = 1200, 200  # time steps per run
ROUNDS, QUICK_ROUNDS = 5, 2
SAMPLING_INTERVAL = 20  # steps, the default of studies with `ledger: dumps`
LOOP_TIME = re.compile(r"^Loop time of ([\d.eE+-]+) on (\d+) procs for (\d+) steps with (\d+) atoms", re.MULTILINE)
OF_LEDGER = re.compile(r"^(fix\s+load_ledger|unfix\s+load_ledger).*\n", re.MULTILINE)
OTHER_OUTPUT = re.compile(r"^(dump\s+(bed|loads)\s|write_restart\s).*\n", re.MULTILINE)
CHECKS = re.compile(r"^(fix\s+step_check\s|variable\s+force_|compute\s+rotational_energy\s).*\n", re.MULTILINE)
BARE = {" store_force yes": "", "mesh/surface/stress": "mesh/surface", " wear finnie": ""}


def variants(chain: Chain, steps: int) -> dict[str, str]:
    """Return the decks of the first wear cycle, `steps` long; "plain" is that of "solver" without the ledger."""
    solver = {**chain.parameters["solver"], "sampling_interval_steps": SAMPLING_INTERVAL}
    derived = {**chain.parameters["derived"], "first_cycle_steps": steps}
    whole, ways = {}, {}
    for ledger in ("solver", "dumps"):
        parameters = {**chain.parameters, "ledger": ledger, "solver": solver, "derived": derived}
        whole[ledger] = deck_text(replace(chain, parameters=parameters), first_span(parameters))
        ways[ledger] = OTHER_OUTPUT.sub("", whole[ledger])
    plain = OF_LEDGER.sub("", ways["solver"])
    return {"bare": bare(plain), "plain": plain, **ways, "whole": whole["solver"]}


def bare(deck: str) -> str:
    """Return a deck without ledger and output that does not ask for loads, wear and checks either."""
    deck = re.sub(r"^(thermo_style\s+custom step atoms).*$", r"\1", CHECKS.sub("", deck), flags=re.MULTILINE)
    for old, new in BARE.items():
        deck = deck.replace(old, new)
    return deck


def seconds(folder: Path, deck: str, ranks: int = 1) -> tuple[float, float]:
    """Run a deck; return the wall time of its time steps and the processor time of the whole solver run, in s."""
    (folder / "deck.in").write_text(deck)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run_deck(folder, ranks, executable=LEDGER_EXECUTABLE)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return float(LOOP_TIME.findall((folder / SCREEN).read_text())[-1][0]), processor


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the processor time of a run by each deck, against the bare or the plain one."""
    chain = prepared_chain(folder, QUICK_PARTICLE_SCALE if quick else PARTICLE_SCALE)
    steps = QUICK_STEPS if quick else STEPS
    cycle, surface, _ = cycle_deck(chain, "overhead")

    def way(deck: str) -> Callable[[], float]:
        return lambda: seconds(cycle, deck)[1]

    ways = {name: way(deck) for name, deck in variants(chain, steps).items()}
    found = in_turn(ways, QUICK_ROUNDS if quick else ROUNDS)
    size = f"{particles_of(chain)} particles, {len(surface.triangles)} triangles, {steps} steps"
    return [
        measured(f"bare deck, {size}", "s", found["bare"]),
        measured("deck of a study, all its output", "s", found["whole"], "bare deck", found["bare"]),
        measured("deck with the load ledger", "s", found["solver"], "the same without", found["plain"]),
        measured(
            f"deck with dumps every {SAMPLING_INTERVAL} steps", "s", found["dumps"], "the same without", found["plain"]
        ),
    ]
