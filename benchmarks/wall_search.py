"""What our search for contacts with meshes saves against the library's: the same time steps of four decks by either.

Each way runs over few and over more time steps; the difference of the processor times is that of the steps alone. Both
give the same ledger to the last bit, which is checked in every round. Before our search the skin of neighbour lists was
also thinner than it is: that of the library is told with that skin as well.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from benchmarks.measure import Measure, in_turn, measured
from benchmarks.runs import cycle_deck, prepared_chain, prepared_tester
from benchmarks.time_step_and_stiffness import CONVEX
from bulkwear.meshes.disc import track_disc
from bulkwear.postproc.mesh import PLAIN, write_stl
from bulkwear.workflows.engine.derived import SKIN_OVER_RADIUS
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, processor_seconds, run_deck
from tests.verification.pin_cases import DISC_RADIUS, INNER_RADIUS, TRACK_RADIUS, PinCase, set_down, write_arc

DEMO_SCALE, TESTER_SCALE = 3.4, 6.0  # -, of particles; those of the studies at quick
ELEMENT, BAND = 1e-4, 0.8e-3  # m; some 80,000 triangles
QUICK_DEMO_SCALE, QUICK_ELEMENT = 4.0, 4e-4
FEW, MANY, QUICK_MANY = 100, 1600, 200  # time steps
ROUNDS, QUICK_ROUNDS = 5, 1
OURS, STOCK, FORMER = "our search", "the library's search", "the library's search, thinner skin"
PIN = "pin on a whole disc"
FORMER_SKIN = 0.4  # -, of neighbour lists over the smallest radius, of beds before our search
SKIN = re.compile(r"^(variable\s+skin\s+equal )(\S+)", re.MULTILINE)
LENGTH = re.compile(r"^(variable\s+(?:end_step|cycle_steps)\s+equal )\d+", re.MULTILINE)


class SearchError(RuntimeError):
    """The two searches gave two ledgers."""


def pin_deck(folder: Path, element: float) -> Path:
    """Return a folder with the deck of a pin that goes round on a whole disc at rest."""
    mesh = track_disc(TRACK_RADIUS, INNER_RADIUS, DISC_RADIUS, element, BAND)
    folder.mkdir(parents=True, exist_ok=True)
    set_down(folder, PinCase(), mesh)
    write_arc(folder / "cycle_1", PinCase(), mesh, 1, 0, MANY)
    write_stl(folder / "cycle_1" / "surface.stl", mesh.points, mesh.triangles)
    return folder / "cycle_1"


def with_former_skin(deck: str) -> str:
    """Return a deck of a bed with the skin that it had before our search; its lists have room for the thicker one."""
    return SKIN.sub(lambda line: f"{line[1]}{FORMER_SKIN / SKIN_OVER_RADIUS * float(line[2])!r}", deck)


def decks(folder: Path, quick: bool) -> dict[str, Path]:
    """Return {what is simulated: folder with its deck}."""
    demo = prepared_chain(folder, QUICK_DEMO_SCALE if quick else DEMO_SCALE)
    found = {"bed past a convex sample (demo)": cycle_deck(demo, "wall_search")[0]}
    if not quick:
        for surface in (PLAIN, CONVEX):
            tester = prepared_tester(folder / "tester", TESTER_SCALE, surface)
            found[f"circular tester, channel, {surface}"] = cycle_deck(tester, "wall_search")[0]
    return found | {PIN: pin_deck(folder / "pin", QUICK_ELEMENT if quick else ELEMENT)}


def steps_alone(folder: Path, deck: str, search: str, many: int) -> tuple[float, bytes]:
    """Return the processor time (ms) of a time step of a deck by a search, and the ledger of the longer run."""
    spent = []
    for steps in (FEW, many):
        (folder / "deck.in").write_text(LENGTH.sub(rf"\g<1>{steps}", deck))
        before = processor_seconds()
        run_deck(folder, executable=LEDGER_EXECUTABLE, search=search)
        spent.append(processor_seconds() - before)
    return 1e3 * (spent[1] - spent[0]) / (many - FEW), (folder / "load_ledger.bin").read_bytes()


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the processor time of a time step by the library's search over that by ours. Raises SearchError."""
    told = []
    for name, here in decks(folder, quick).items():
        deck = (here / "deck.in").read_text()

        def way(search: str, deck: str, here: Path = here) -> Callable[[], tuple[float, bytes]]:
            return lambda: steps_alone(here, deck, search, QUICK_MANY if quick else MANY)

        ways = {OURS: way("ours", deck), STOCK: way("stock", deck)}
        if name != PIN:  # its skin is as it was
            ways[FORMER] = way("stock", with_former_skin(deck))
        found = in_turn(ways, QUICK_ROUNDS if quick else ROUNDS)
        if len({ledger for search in (OURS, STOCK) for _, ledger in found[search]}) > 1:
            raise SearchError(f"{here}: the ledgers of {OURS} and {STOCK} differ.")
        ours, *others = ([time for time, _ in each] for each in found.values())
        told += [measured(f"{name}, {OURS}", "ms a step", ours)]
        told += [
            measured(f"{name}, {search}", "ms a step", times, OURS, ours)
            for search, times in zip(list(found)[1:], others, strict=True)
        ]
    return told
