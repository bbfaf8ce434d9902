"""Verdicts on published findings: a claim with direction, magnitude and margin, held against estimates with intervals.

Rules, all at one error rate e, for one estimate whose one-sided bounds at e are L and U:

    agrees        with a magnitude: L and U both inside the magnitude and its margin (two one-sided tests, D. J.
                  Schuirmann, J. Pharmacokin. Biopharm. 15, 1987); with a direction alone: L and U both beyond the
                  reference on the claimed side
    contradicts   L and U both beyond the reference on the other side; of a magnitude without direction: both outside it
                  and its margin, on one side
    same direction, other size   beyond the reference on the claimed side, and outside the magnitude and its margin
    cannot be said               all else, and whatever has no interval or does not reach the claimed range

Each false "agrees" and each false "contradicts" then has a rate of e at most. A claim about several estimates agrees
where each of them does (an intersection-union test: e for all together); it contradicts where one of k does at e/k.
Margins are fixed before the runs. The rates at which the rules err, by simulation: docs/interval_coverage.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from bulkwear.postproc.statistics.intervals import UNKNOWN, Ends, Estimate

AGREES, CONTRADICTS = "agrees", "contradicts"
OTHER_SIZE, UNSAID = "same direction, other size", "cannot be said"
VERDICTS = (AGREES, OTHER_SIZE, CONTRADICTS, UNSAID)
ALLOWED = 0.05  # -, of a false "agrees" and of a false "contradicts", each at most
ERROR_RATE = 0.04  # -, of the bounds: below what is allowed, so that rates found by simulation stay below it too

Direction = Literal["above", "below"]


@dataclass(frozen=True)
class Claim:
    """What a source says of a quantity.

    key: name of the claim; finding: in words; source: where it is said; quantity: what is estimated; unit: of it
    direction: the side of `reference` on which it lies; None for a magnitude alone
    told_side: whether the source tells that side; False where it is a number's own sign
    magnitude: (low, high) as published, equal for one number; None for a direction alone
    margin: how far beyond the magnitude still counts as the same, same unit; 0 without a magnitude
    reach: (low, high) of the range claimed, such as revolutions, and its name and unit in `reach_unit`; None for any
    """

    key: str
    finding: str
    source: str
    quantity: str
    unit: str = ""
    direction: Direction | None = None
    reference: float = 0.0
    magnitude: tuple[float, float] | None = None
    margin: float = 0.0
    reach: tuple[float, float] | None = None
    reach_unit: str = ""
    told_side: bool = True

    @property
    def region(self) -> tuple[float, float]:
        """Return the ends between which a value agrees: the magnitude with its margin, or the claimed side."""
        if self.magnitude is not None:
            return self.magnitude[0] - self.margin, self.magnitude[1] + self.margin
        return (self.reference, math.inf) if self.direction == "above" else (-math.inf, self.reference)

    @property
    def words(self) -> str:
        """Return what is claimed: side, values that agree with the published one among them, range."""
        side = f"{self.direction} {self.reference:g}" if self.direction else ""
        (low, high), size, reach = self.region, "", ""
        if self.magnitude is not None:
            least, most = self.magnitude
            published = f"{least:g}" if least == most else f"{least:g} to {most:g}"
            size = f"{low:g} to {high:g} (published {published})"
        if self.reach is not None:
            reach = f"for {self.reach[0]:g} to {self.reach[1]:g} {self.reach_unit}"
        unit = "" if self.unit == "-" else f" {self.unit}"
        return ", ".join(filter(None, (" and ".join(filter(None, (side, size))) + unit, reach)))


@dataclass(frozen=True)
class Verdict:
    """What was found, in words with numbers, the verdict, and the reason where nothing can be said.

    factor: what was found over the published magnitude where its size is another one; NaN otherwise
    """

    found: str
    verdict: str
    reason: str = ""
    factor: float = math.nan


def judged(
    claim: Claim,
    found: Estimate | Ends | Mapping[str, Estimate],
    words: str = "",
    covers: tuple[float, float] | None = None,
) -> Verdict:
    """Return the verdict on a claim.

    found: in the unit of the claim, its reference and its magnitude; several estimates, by name, are all claimed of
    words: what was found; by default the estimates' own
    covers: (low, high) of the range that the runs cover; None where the claim has no range. Outside of what is claimed
        nothing can be said.
    """
    named = {"": found} if isinstance(found, Estimate | Ends) else dict(found)
    words = words or "; ".join(f"{name}: {told}" if name else told for name, told in _told(named, claim.unit).items())
    if reason := _no_reach(claim, covers) or _no_interval(named):
        return Verdict(words, UNSAID, reason)
    shares = ERROR_RATE / len(named)
    each = [_of_one(claim, one, ERROR_RATE) for one in named.values()]
    strict = [_of_one(claim, one, shares) for one in named.values()]
    if CONTRADICTS in strict:
        return Verdict(words, CONTRADICTS)
    if all(one == AGREES for one in each):
        return Verdict(words, AGREES)
    if OTHER_SIZE in strict and all(_on_side(claim, one, ERROR_RATE) for one in named.values()):
        return Verdict(words, OTHER_SIZE, factor=_factor(claim, named))
    return Verdict(words, UNSAID, _open(claim, named))


def not_said(reason: str, words: str = "") -> Verdict:
    """Return that nothing can be said, and why."""
    return Verdict(words, UNSAID, reason)


def _of_one(claim: Claim, one: Estimate, error_rate: float) -> str:
    """Return the verdict on one estimate by the rules of this module."""
    low, high = one.bounds(error_rate)
    least, most = claim.region
    if claim.direction and _beyond(claim, low, high, opposite=True):
        return CONTRADICTS
    if claim.magnitude is None:
        return AGREES if _beyond(claim, low, high) else UNSAID
    if least < low and high < most:
        return AGREES if not claim.direction or _beyond(claim, low, high) else UNSAID
    if low > most or high < least:
        if not claim.direction:
            return CONTRADICTS
        return OTHER_SIZE if _beyond(claim, low, high) else UNSAID
    return UNSAID


def _beyond(claim: Claim, low: float, high: float, opposite: bool = False) -> bool:
    above = (claim.direction == "above") != opposite
    return low > claim.reference if above else high < claim.reference


def _on_side(claim: Claim, one: Estimate, error_rate: float) -> bool:
    return claim.direction is not None and _beyond(claim, *one.bounds(error_rate))


def _factor(claim: Claim, named: Mapping[str, Estimate]) -> float:
    """Return the value farthest from the magnitude, as a difference from the reference, over the published one."""
    low, high = claim.magnitude
    nearest = {name: min(max(one.value, low), high) for name, one in named.items()}
    worst = max(named, key=lambda name: abs(named[name].value - nearest[name]))
    published = nearest[worst] - claim.reference
    return (named[worst].value - claim.reference) / published if published else math.nan


def _told(named: Mapping[str, Estimate], unit: str) -> dict[str, str]:
    return {name: one.text(unit=unit) for name, one in named.items()}


def _no_reach(claim: Claim, covers: tuple[float, float] | None) -> str:
    if claim.reach is None or covers is None:
        return ""
    (low, high), (first, last) = claim.reach, covers
    if first <= low and high <= last:
        return ""
    return f"claimed of {low:g} to {high:g} {claim.reach_unit}, the runs cover {first:.4g} to {last:.4g}"


def _no_interval(named: Mapping[str, Estimate]) -> str:
    if not named:
        return "no run that it is claimed of has a result"
    unknown = [one for one in named.values() if not one.known]
    if not unknown:
        return ""
    return UNKNOWN if any(one.packings == 1 for one in unknown) else "no value with a known scatter"


def _open(claim: Claim, named: Mapping[str, Estimate]) -> str:
    """Return what the intervals leave open."""
    if claim.direction and not all(_on_side(claim, one, ERROR_RATE) for one in named.values()):
        side = f"the interval does not exclude {claim.reference:g}: the direction is open"
        return f"{side}, the size is not as claimed" if _is_other_size(claim, named) else side
    size = "the interval passes an end of the margin"
    if claim.direction and claim.told_side:
        return f"the direction is as claimed, the size is open: {size}"
    return size


def _is_other_size(claim: Claim, named: Mapping[str, Estimate]) -> bool:
    """Return whether an estimate lies outside a claimed magnitude and its margin, on one side."""
    least, most = claim.region
    bounds = [one.bounds(ERROR_RATE / len(named)) for one in named.values()]
    return claim.magnitude is not None and any(low > most or high < least for low, high in bounds)
