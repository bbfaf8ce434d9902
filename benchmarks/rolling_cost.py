"""What a rolling model costs: the same time steps of a bed past a convex sample under each.

The two of our own, which act on all contacts of a particle at once, beside the library's `cdt`, and none. Those that
keep a history of each contact, as `epsd2`, cannot go on from the same restart. The bed flows on as its model lets it, a
few hundred steps long.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from benchmarks.measure import Measure, in_turn, measured
from benchmarks.runs import cycle_deck, particles_of, prepared_chain
from benchmarks.solver_speed import DEMO_SCALE, MANY, QUICK_DEMO_SCALE, QUICK_MANY, QUICK_ROUNDS, ROUNDS, steps_alone

OURS = "own_spin"  # of the studies, in the deck
MODELS = (OURS, "rvd", "cdt", "off")  # words of the deck
NAMED = "rolling_friction {}"


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the processor time of a time step under each model, over that under the studies' own."""
    chain = prepared_chain(folder, QUICK_DEMO_SCALE if quick else DEMO_SCALE)
    here, _, deck = cycle_deck(chain, "rolling_cost")
    many = QUICK_MANY if quick else MANY

    def way(model: str) -> float:
        return steps_alone(here, deck.replace(NAMED.format(OURS), NAMED.format(model)), (), many)[0]

    times = in_turn({model: partial(way, model) for model in MODELS}, QUICK_ROUNDS if quick else ROUNDS)
    name = f"bed past a convex sample, {particles_of(chain)} particles, rolling_friction {{}}".format
    others = MODELS[1:]
    return [
        measured(name(OURS), "ms a step", times[OURS]),
        *(measured(name(model), "ms a step", times[model], OURS, times[OURS]) for model in others),
    ]
