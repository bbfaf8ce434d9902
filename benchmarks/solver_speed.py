"""What our program saves against the library that it is made of: the same time steps of decks by either.

Ours differs in the search for contacts with meshes, which gives the same ledger to the last bit (checked in every
round), in the order of particles in memory, and decks let lists of neighbours last longer than they did. Told is what
each saves alone, and all of them together, by switches of our program and of decks. Each way runs over few and over
more time steps; the difference of the processor times is that of the steps alone.
"""

from __future__ import annotations

import re
import subprocess
from functools import partial
from pathlib import Path

from benchmarks.ledger_overhead import PARTICLE_SCALE as LARGER_BED_SCALE
from benchmarks.measure import Measure, in_turn, measured
from benchmarks.runs import cycle_deck, particles_of, prepared_chain, prepared_tester
from benchmarks.stiffness import CONVEX
from bulkwear.meshes.disc import track_disc
from bulkwear.postproc.mesh import PLAIN, SurfaceMesh, write_stl
from bulkwear.workflows.engine.derived import SKIN_OVER_RADIUS
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, LOG, processor_seconds, solver_environment
from tests.verification.pin_cases import (
    DISC_RADIUS,
    INNER_RADIUS,
    TRACK_RADIUS,
    PinCase,
    round_groove,
    set_down,
    write_arc,
)

DEMO_SCALE, TESTER_SCALE = 3.4, 6.0  # -, of particles; those of the studies at quick
ELEMENT, BAND = 1e-4, 0.8e-3  # m; some 80,000 triangles; the groove is 1.1 mm wide
QUICK_DEMO_SCALE, QUICK_ELEMENT = 4.0, 4e-4
FEW, MANY, MANY_OF_PIN, QUICK_MANY = 100, 900, 3600, 200  # time steps; those of a pin are short
ROUNDS, QUICK_ROUNDS = 5, 1
FORMER_SKIN = 0.4  # -, of neighbour lists over the smallest radius, of beds before our search
SKIN = re.compile(r"^(variable\s+skin\s+equal )(\S+)", re.MULTILINE)
OF_SEARCH, OF_ORDER = ("-search", "stock"), ("-order", "stock")
OURS, SEARCH, ORDER = "ours", "the library's search", "the library's order of particles"
THINNER, FORMER = "the former skin of lists", "search, order and skin as they were"
WAYS = {OURS: (), SEARCH: OF_SEARCH, ORDER: OF_ORDER, THINNER: (), FORMER: (*OF_SEARCH, *OF_ORDER)}
PIN, PIN_IN_GROOVE = "pin on a whole disc", "pin in a groove of a whole disc"
GROOVE_DEPTH = 1e-4  # m; the pin touches some 60 triangles there
FLAT, IN_GROOVE = PinCase(), PinCase(time_step=0.25 * PinCase.time_step)  # so many contacts allow no larger step
LENGTH = re.compile(r"^(variable\s+(?:end_step|cycle_steps)\s+equal )\d+", re.MULTILINE)


class SearchError(RuntimeError):
    """The two searches gave two ledgers."""


def pin_deck(folder: Path, disc: SurfaceMesh, case: PinCase = FLAT) -> Path:
    """Return a folder with the deck of a pin that goes round on a whole disc at rest."""
    folder.mkdir(parents=True, exist_ok=True)
    set_down(folder, case, disc)
    write_arc(folder / "cycle_1", case, disc, 1, 0, MANY_OF_PIN)
    write_stl(folder / "cycle_1" / "surface.stl", disc.points, disc.triangles)
    return folder / "cycle_1"


def pin_decks(folder: Path, element: float) -> dict[str, Path]:
    """Return decks as `decks` does: of a pin on a flat disc, and in a groove of its own shape."""
    flat = track_disc(TRACK_RADIUS, INNER_RADIUS, DISC_RADIUS, element, BAND)
    return {
        PIN: pin_deck(folder / "pin", flat),
        PIN_IN_GROOVE: pin_deck(folder / "pin_in_groove", round_groove(flat, GROOVE_DEPTH), IN_GROOVE),
    }


def decks(folder: Path, quick: bool) -> dict[str, Path]:
    """Return {what is simulated: folder with its deck}."""
    found = {}
    for scale in (QUICK_DEMO_SCALE,) if quick else (DEMO_SCALE, LARGER_BED_SCALE):
        chain = prepared_chain(folder, scale)
        found[f"bed past a convex sample, {particles_of(chain)} particles"] = cycle_deck(chain, "speed")[0]
    for surface in () if quick else (PLAIN, CONVEX):
        tester = prepared_tester(folder / "tester", TESTER_SCALE, surface)
        found[f"circular tester, channel, {surface}"] = cycle_deck(tester, "speed")[0]
    return found | pin_decks(folder, QUICK_ELEMENT if quick else ELEMENT)


def with_former_skin(deck: str) -> str:
    """Return a deck of a bed with the skin that it had before our search; its lists have room for the thicker one."""
    return SKIN.sub(lambda line: f"{line[1]}{FORMER_SKIN / SKIN_OVER_RADIUS * float(line[2])!r}", deck)


def steps_alone(folder: Path, deck: str, words: tuple[str, ...], many: int) -> tuple[float, bytes]:
    """Return the processor time (ms) of a time step of a deck by our program, called with further words, and the
    ledger of the longer run. Raises CalledProcessError.
    """
    spent = []
    for steps in (FEW, many):
        (folder / "deck.in").write_text(LENGTH.sub(rf"\g<1>{steps}", deck))
        before = processor_seconds()
        command = [LEDGER_EXECUTABLE, "-in", "deck.in", "-log", LOG, *words]
        subprocess.run(command, cwd=folder, env=solver_environment(), stdout=subprocess.DEVNULL, check=True)
        spent.append(processor_seconds() - before)
    return 1e3 * (spent[1] - spent[0]) / (many - FEW), (folder / "load_ledger.bin").read_bytes()


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the processor time of a time step each way, over that of ours. Raises SearchError."""
    told = []
    for name, here in decks(folder, quick).items():
        deck = (here / "deck.in").read_text()

        pin = name in (PIN, PIN_IN_GROOVE)
        thinner = () if pin else (THINNER, FORMER)  # the pin's skin is as it was
        ways = [named for named in WAYS if not pin or named != THINNER]
        many = QUICK_MANY if quick else MANY_OF_PIN if pin else MANY

        def way(
            named: str, deck: str = deck, here: Path = here, thinner: tuple = thinner, many: int = many
        ) -> tuple[float, bytes]:
            given = with_former_skin(deck) if named in thinner else deck
            return steps_alone(here, given, WAYS[named], many)

        found = in_turn({named: partial(way, named) for named in ways}, QUICK_ROUNDS if quick else ROUNDS)
        if len({ledger for named in (OURS, SEARCH) for _, ledger in found[named]}) > 1:
            raise SearchError(f"{here}: the ledgers of our search and the library's differ.")
        times = {named: [time for time, _ in each] for named, each in found.items()}
        told += [measured(f"{name}, {OURS}", "ms a step", times[OURS])]
        others = [named for named in ways if named != OURS]
        told += [measured(f"{name}, {named}", "ms a step", times[named], OURS, times[OURS]) for named in others]
    return told
