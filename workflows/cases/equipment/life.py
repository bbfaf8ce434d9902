"""When a part has to be changed: the place that decides, its life with an interval, what is left there along the way.

A place is an area patch, or the whole part where the rule speaks of its mass. Where its thickness is measured it gets
thinner from behind as well. What it loses is followed as long as the shape was worn, and goes on from there at the mean
rate of the last blocks. The load of a place is one over its life; the place that decides has the largest. Each
packing's value is that of the place which all others name, so that it is not lifted by being chosen
(`postproc.statistics.worst_place`); of one packing see `_of_one`. A place that a single packing would have changed much
earlier is told beside.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import Estimate
from bulkwear.postproc.statistics.worst_place import worst_place
from bulkwear.postproc.wear.service_life import allowed_volume, hour_reached, life_interval
from bulkwear.workflows.cases.equipment.change_out import BY_MASS, allowed_depths, rule_of
from bulkwear.workflows.cases.equipment.phases import PRISTINE, WEARING, WORN
from bulkwear.workflows.cases.equipment.tables import Runs

WHOLE_PART = -1  # in place of a patch
FOLLOWED, PARTLY, EXTRAPOLATED, AS_BUILT = "followed", "partly followed", "last rate goes on", "rate as built goes on"
NO_THICKNESS, NO_VOLUME = "its thickness is not known", "its mass is not known: its surface is open"
TOO_THIN = "it is nowhere thicker as built than what shall remain"
NO_WEAR = "nothing wears it in the time simulated"
RARE = "some packings do not wear it at all where it wears most, so that more has to be simulated"
LATEST = 4  # blocks at least whose mean rate goes on: where fewer are on the worn shape, those of updates before too
WORST = 5  # patches of a part that are listed
MUCH_EARLIER = 0.5  # -, of a life: the shortest in one packing of alike places, which scatter by 5 to 20 %, is above it


@dataclass(frozen=True)
class Earlier:
    """A place that one packing alone would have changed much earlier than all packings together; hours: h."""

    packing: Any
    patch: int
    hours: float


@dataclass(frozen=True)
class Faster:
    """A place that wears faster than the one that decides, and may lose nothing that is known: its thickness is not, or
    is no more than what shall remain; rate: m/h, the last one.
    """

    patch: int
    rate: float


@dataclass(frozen=True, eq=False)
class Course:
    """What p places of a part lose along the operation of one packing; m, or m3 of the whole part.

    hours: (k,) of operation, from 0; lost: (k, p) by then, all that the law takes: what the caps of the updates held
        back and carry is not on the surface yet, but it is lost
    pristine, worn, last: (b, p) per hour: of the blocks on the pristine shape, of all that follow, and of those whose
    mean goes on: on one worn shape, LATEST at least with the updates before them
    """

    packing: Any
    hours: np.ndarray
    lost: np.ndarray
    pristine: np.ndarray
    worn: np.ndarray
    last: np.ndarray

    def at(self, hours: float) -> np.ndarray:
        """Return what (p,) is lost after so many hours, beyond the last ones at the mean last rate."""
        if hours >= self.hours[-1]:
            return self.lost[-1] + (hours - self.hours[-1]) * self.last.mean(axis=0)
        return np.array([np.interp(hours, self.hours, lost) for lost in self.lost.T])

    def variance(self, life: float) -> float:
        """Return the variance of a life (h) over that of one block: no less than that of the mean of all behind it."""
        followed, updates = min(self.hours[-1] / life, 1.0), len(self.hours) - 1
        parts = (1.0 - followed) ** 2 / len(self.last) + (followed**2 / updates if updates else 0.0)
        return max(parts, 1.0 / (len(self.worn) or len(self.pristine)))

    def until(self, allowed: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return after how many hours (p,) what is allowed (p,) is lost; rates: (p,) per hour from the last ones on."""
        places = zip(self.lost.T, allowed, rates, strict=True)
        return np.array([hour_reached(self.hours, lost, limit, rate).hours for lost, limit, rate in places])


@dataclass(frozen=True, eq=False)
class PartLife:
    """The life of a part in a setting.

    patch: that decides, WHOLE_PART by its mass; allowed: m it may lose there, m3 by its mass
    life, pristine_life: h, of the logarithm, with scatter alone: followed on the worn shape, and by the rate as built
    recession: per hour at the worst place as built, each packing judged by the others, of the logarithm
    pristine, worn: mean rate per hour at the deciding place on the shape as built and as worn
    error: -, half width of the coefficient's interval over it; how: FOLLOWED, PARTLY or EXTRAPOLATED
    blocks: behind the last rate, of all packings; agreement: -, share of packings (blocks) that name that very place
    earlier: the shortest life of one packing where that is much shorter, None where it is not
    faster: the fastest place that wears faster than the deciding one and has no life, None without
    reason: why there is no life, "" where there is one
    """

    patch: int
    allowed: float
    life: Estimate
    pristine_life: Estimate
    recession: Estimate
    pristine: float
    worn: float
    error: float
    how: str
    simulated_h: float
    blocks: int
    agreement: float
    earlier: Earlier | None = None
    faster: Faster | None = None
    reason: str = ""

    def ends(self, scatter: bool = True, coefficient: bool = True) -> tuple[float, float]:
        """Return the interval of the life (h) from what is asked for; NaN where scatter is and is unknown."""
        life = self.life if scatter else Estimate(self.life.value, 0.0, math.inf, self.life.packings, log=True)
        return life_interval(life, self.error if coefficient else 0.0)


# ---------------------------------------------------------------- courses


def thinning(patches: pd.DataFrame) -> pd.Series:
    """Return by how much each patch gets thinner (m/h): by its own recession, and by that of its back where the
    thickness is measured. patches: rows as from `blocks.patch_rows`
    """
    return patches["recession_m_per_h"] + patches["back_recession_m_per_h"]


def patch_courses(runs: Runs, setting: str, part: str) -> tuple[pd.DataFrame, list[Course]]:
    """Return the places of a part in a setting, a row per patch, and the course of each packing."""
    chosen = (runs.patches["setting"] == setting) & (runs.patches["part"] == part)
    rows = runs.patches[chosen]
    places = rows.drop_duplicates("patch").sort_values("patch").set_index("patch")
    courses = []
    for packing, table in rows.groupby("packing", sort=False):
        table = table.assign(rate=thinning(table))
        rates = table.pivot(index="cycle", columns="patch", values="rate").reindex(columns=places.index)
        courses.append(_course(packing, _cycles(table), rates.fillna(0.0).to_numpy()))
    return places, courses


def mass_courses(runs: Runs, setting: str, part: str) -> list[Course]:
    """Return what each packing takes of a whole part, m3."""
    rows = runs.parts[(runs.parts["setting"] == setting) & (runs.parts["part"] == part)]
    courses = []
    for packing, table in rows.groupby("packing", sort=False):
        rates = table.sort_values("cycle")[["worn_volume_m3_per_h"]].to_numpy()
        courses.append(_course(packing, _cycles(table), rates))
    return courses


def _cycles(table: pd.DataFrame) -> pd.DataFrame:
    """Return phase and stands_for_h of each cycle, in order."""
    return table.drop_duplicates("cycle").sort_values("cycle")[["phase", "stands_for_h"]]


def _course(packing: Any, cycles: pd.DataFrame, rates: np.ndarray) -> Course:
    """Return the course of a packing; rates: (cycles, p) per hour of operation."""
    phase = cycles["phase"].to_numpy()
    wearing = np.flatnonzero(phase == WEARING)
    stood = cycles["stands_for_h"].to_numpy()[wearing]
    hours = np.append(0.0, np.cumsum(stood))
    lost = np.vstack([np.zeros((1, rates.shape[1])), np.cumsum(stood[:, None] * rates[wearing], axis=0)])
    pristine, one_shape, worn = (rates[np.isin(phase, names)] for names in ((PRISTINE,), (WORN,), (WEARING, WORN)))
    last = one_shape if len(one_shape) >= LATEST else worn[-LATEST:] if len(worn) else pristine
    return Course(packing, hours, lost, pristine, worn, last)


# ---------------------------------------------------------------- life


def part_lives(runs: Runs, volumes: Mapping[tuple[str, str], float]) -> dict[tuple[str, str], PartLife]:
    """Return the life of every part that wears by setting; volumes: m3 of parts as built, for rules by mass."""
    return {pair: part_life(runs, *pair, volumes.get(pair, math.nan)) for pair in runs.wearing_parts}


def part_life(runs: Runs, setting: str, part: str, volume: float = math.nan) -> PartLife:
    """Return the life of a part in a setting; volume: m3 of it as built, for rules by mass, NaN unknown."""
    run = runs.first(setting)
    rule = rule_of(run["operation"], run["parts"][part])
    error = run["parts"][part]["wear_coefficient_error"] or 0.0
    if BY_MASS in rule:
        patches, courses = np.array([WHOLE_PART]), mass_courses(runs, setting, part)
        allowed = np.array([allowed_volume(volume, rule[BY_MASS]) if math.isfinite(volume) else math.nan])
    else:
        places, courses = patch_courses(runs, setting, part)
        patches, allowed = places.index.to_numpy(), allowed_depths(places["thickness_m"].to_numpy(), rule)
        if places["thickness_m"].notna().any():
            return _life(patches, allowed, courses, error, TOO_THIN)
    return _life(patches, allowed, courses, error, NO_VOLUME if BY_MASS in rule else NO_THICKNESS)


def _life(
    patches: np.ndarray,
    allowed: np.ndarray,
    courses: Sequence[Course],
    error: float,
    none_allowed: str = NO_THICKNESS,
) -> PartLife:
    """Return the life of a part; none_allowed: the reason why there is none where no place may lose anything."""
    nothing = Estimate(math.nan, math.nan, 0, len(courses), log=True)
    simulated = float(np.mean([course.hours[-1] for course in courses]))
    blocks = sum(len(course.last) for course in courses)

    def without(reason: str) -> PartLife:
        return PartLife(
            WHOLE_PART,
            math.nan,
            *[nothing] * 3,
            math.nan,
            math.nan,
            error,
            "",
            simulated,
            blocks,
            math.nan,
            reason=reason,
        )

    if not np.isfinite(allowed).any():
        return without(none_allowed)
    loads = np.array([1.0 / course.until(allowed, course.last.mean(axis=0)) for course in courses])
    pristine = np.vstack([course.pristine for course in courses])
    of_blocks = np.repeat([course.packing for course in courses], [len(course.pristine) for course in courses])
    if not (loads[:, np.isfinite(allowed)] > 0.0).any():
        return without(NO_WEAR)
    place, life, agreement = _of_packings(loads) if len(courses) > 1 else _of_one(loads[0], allowed, courses[0])
    if not (loads[:, place] > 0.0).all():
        return without(RARE)
    as_built = worst_place(pristine, allowed, of_blocks)
    reached = [course.lost[-1, place] >= allowed[place] for course in courses]
    how = FOLLOWED if all(reached) else PARTLY if any(reached) else EXTRAPOLATED if simulated > 0.0 else AS_BUILT
    return PartLife(
        patch=int(patches[place]),
        allowed=float(allowed[place]),
        life=life,
        pristine_life=_inverse(as_built.mean_load(), as_built.load, len(courses)),
        recession=as_built.value(),
        pristine=float(np.mean([course.pristine[:, place].mean() for course in courses])),
        worn=float(np.mean([course.last[:, place].mean() for course in courses])),
        error=error,
        how=how,
        simulated_h=simulated,
        blocks=blocks,
        agreement=agreement,
        earlier=_much_earlier(loads, life.value, patches, [course.packing for course in courses]),
        faster=_faster(np.mean([course.last.mean(axis=0) for course in courses], axis=0), allowed, place, patches),
    )


def _faster(rates: np.ndarray, allowed: np.ndarray, place: int, patches: np.ndarray) -> Faster | None:
    """Return the fastest place without a life that wears faster than the one that decides; rates: (p,)."""
    unknown = np.where(np.isfinite(allowed), -math.inf, rates)
    fastest = int(unknown.argmax())
    return Faster(int(patches[fastest]), float(rates[fastest])) if unknown[fastest] > rates[place] else None


def _much_earlier(loads: np.ndarray, life: float, patches: np.ndarray, packings: Sequence[Any]) -> Earlier | None:
    """Return the shortest life of one packing where it is much shorter than that of all; loads: (packings, p)."""
    packing, place = np.unravel_index(np.nanargmax(loads), loads.shape)
    hours = 1.0 / float(loads[packing, place])
    if len(packings) == 1 or not hours < MUCH_EARLIER * life:
        return None
    return Earlier(packings[packing], int(patches[place]), hours)


def _of_packings(loads: np.ndarray) -> tuple[int, Estimate, float]:
    """Return the place that decides, the life there and the agreement; loads: (packings, p), one over the life."""
    worst = worst_place(loads, packings=np.arange(len(loads)))
    return worst.place, _inverse(worst.value(), worst.load, len(loads)), worst.agreement


def _of_one(loads: np.ndarray, allowed: np.ndarray, course: Course) -> tuple[int, Estimate, float]:
    """Return the same of one packing; loads: (p,).

    All its blocks tell by how much the worst place is lifted by being chosen, and each over the mean of its shape, so
    that what the shape changes is no scatter, how much they scatter. What was followed of the life is made of the
    blocks that wore the shape, the rest of the last ones; its error is that of as many.
    """
    place, shapes = int(np.nanargmax(loads)), [each for each in (course.pristine, course.worn) if len(each)]
    lifted = worst_place(np.vstack(shapes), allowed)
    lift = lifted.load / lifted.mean_load().value
    life = (lift if math.isfinite(lift) else 1.0) / loads[place]
    factors = np.vstack([_over_their_mean(each) for each in shapes])
    scatter = worst_place(loads * factors).mean_load()
    error = scatter.error * math.sqrt(len(factors) * course.variance(1.0 / loads[place]))
    return place, Estimate(life, error, scatter.freedom, 1, log=True), lifted.agreement


def _over_their_mean(blocks: np.ndarray) -> np.ndarray:
    """Return rates (b, p) over their mean over blocks; 1 where nothing is worn."""
    mean = blocks.mean(axis=0)
    return np.divide(blocks, mean, out=np.ones_like(blocks), where=mean > 0.0)


def _inverse(load: Estimate, lifted: float, packings: int) -> Estimate:
    """Return one over an estimate of the logarithm; of a single block one over the load of the place that it names."""
    if not math.isfinite(load.value):
        return Estimate(1.0 / lifted if lifted > 0.0 else math.nan, math.nan, 0, packings, log=True)
    return Estimate(1.0 / load.value, load.error, load.freedom, load.packings, log=True)
