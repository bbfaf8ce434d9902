"""How many packings an interval of a given width takes, and when to stop adding them.

Stopping at the first interval that is narrow enough chooses packings that happen to lie close together, and such
intervals hold the truth too seldom: 90 % instead of 95 % from three packings on. FEWEST packings before the first look
and FURTHER ones after the interval was narrow enough, come what may, mend that (docs/interval_coverage.md).
"""

from __future__ import annotations

import math

from bulkwear.postproc.statistics.intervals import CONFIDENCE, Estimate, students_t

FEWEST = 4  # packings before an interval is looked at
FURTHER = 3  # packings after it was narrow enough


def packings_needed(found: Estimate, width: float, most: int) -> int:
    """Return the number of packings that gives an interval of that width if they scatter as those that there are.

    width: -, of the whole interval over the mean; most: the number returned where more would be needed.
    Raises ValueError for an estimate whose scatter is unknown.
    """
    if not found.known:
        raise ValueError(f"found {found.packings} packing(s), allowed are two or more to tell how many are needed")
    deviation = found.error * math.sqrt(found.packings)
    for number in range(2, most + 1):
        reach = students_t(0.5 + 0.5 * CONFIDENCE, number - 1) * deviation / math.sqrt(number)
        expected = 2.0 * math.sinh(reach) if found.log else 2.0 * reach / abs(found.value)
        if expected <= width:
            return number
    return most


def next_number(found: Estimate, width: float, most: int) -> tuple[int, bool]:
    """Return how many packings to simulate altogether, and whether these are the last.

    Until the interval is as narrow as `width` (-, of the mean): as many as its scatter lets expect to suffice, at most
    twice those there are. Once it is: FURTHER more. Never more than `most`.
    """
    if found.packings < min(FEWEST, most):
        return min(FEWEST, most), most <= FEWEST
    if found.known and found.width() <= width:
        return min(found.packings + FURTHER, most), True
    if found.packings >= most:
        return found.packings, True
    needed = packings_needed(found, width, most) if found.known else found.packings + 1
    return min(max(found.packings + 1, min(needed, 2 * found.packings)), most), False
