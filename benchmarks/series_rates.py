"""How often the answers on series that follow a travel are wrong: linearity, predictions, steadiness, run-ins.

    from benchmarks.series_rates import rows

Synthetic series whose truth is known, with noises that forget exponentially (AR(1) of correlation r). Of one run the
intervals must hold for every r between 0 and 0.7, which the series are too short to tell: they hold the truth too often
at r = 0, and about as often as they say at 0.7.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.change_point import NONE_FOUND, run_in
from bulkwear.postproc.statistics.increments import blocks_of, prediction, rate_trend
from bulkwear.postproc.statistics.steady import BELOW, DRIFTING, STEADY, steady_window
from bulkwear.workflows.cases.pin_on_disc.run_in import rate_of_no_run_in

COLUMNS = ["what", "case", "nominal_percent", "found_percent", "trials"]
TRIALS = 600
SEED = 20261123
MISSED, HELD = 5.0, 95.0  # %, nominal
CHANGE = 0.2  # -, of the rate over the run, where there is one
SCATTER = 0.1  # -, of a block's rate
PACKING_SCATTER = 0.1  # -, of what packings differ by
BEYOND = 1.5  # times the run: where is predicted
VALUES = 74  # of a measure along a travel of 740 mm, each over 10 mm
BLOCKS, CORRELATIONS = (4, 12, 40), (0.0, 0.5, 0.7)

Row = tuple[str, str, float, float]


def rows(trials: int = TRIALS, seed: int = SEED) -> pd.DataFrame:
    """Return COLUMNS: what is said, of which series, how often it may be or should be, and how often it is."""
    rng = np.random.default_rng(seed)
    found = [(*row, trials) for part in (trends, packings, steadiness, run_ins, contours) for row in part(trials, rng)]
    return pd.DataFrame(found, columns=COLUMNS)


def noise(rng: np.random.Generator, count: int, correlation: float) -> np.ndarray:
    """Return a series (count,) of deviation 1 whose neighbours are correlated."""
    fresh = rng.standard_normal(count)
    fresh[1:] *= np.sqrt(1.0 - correlation**2)
    for place in range(1, count):
        fresh[place] += correlation * fresh[place - 1]
    return fresh


def shares(trials: int, try_one: Callable[[], tuple[bool, ...]]) -> np.ndarray:
    """Return how often (%) each of what a trial says is so."""
    return 100.0 * np.mean([try_one() for _ in range(trials)], axis=0)


def cumulated(rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return places (k + 1,) of the travel and the sum of the rates (k,) up to there, from 0 on."""
    return np.arange(len(rates) + 1.0), np.append(0.0, np.cumsum(rates))


def drifting_rates(count: int, change: float, beyond: float = 1.0) -> np.ndarray:
    """Return rates along a run of so many blocks and beyond: 1 in its mean, rising by `change` (-) over it."""
    return 1.0 + change * ((np.arange(int(beyond * count)) + 0.5) / count - 0.5)


def trends(trials: int, rng: np.random.Generator) -> Iterator[Row]:
    """Yield how often a run's own trend and prediction are wrong."""
    for count in BLOCKS:
        for correlation in CORRELATIONS:
            case = f"one run, {count} blocks, r = {correlation:g}"

            def one(count: int = count, correlation: float = correlation) -> tuple[bool, ...]:
                fluctuation = SCATTER * noise(rng, int(BEYOND * count), correlation)
                straight = rate_trend(blocks_of(*cumulated(1.0 + fluctuation[:count])))
                places, volumes = cumulated(drifting_rates(count, CHANGE, BEYOND) + fluctuation)
                run = blocks_of(places[: count + 1], volumes[: count + 1])
                grows, later = rate_trend(run), prediction(run, places[-1])
                low, high = grows.change.interval()
                return (
                    bool(straight.curved),
                    bool(grows.constant_within(CHANGE)),
                    low <= CHANGE <= high,
                    later.low <= volumes[-1] <= later.high,
                )

            curved, constant, held, met = shares(trials, one)
            yield "a constant rate called curved", case, MISSED, curved
            yield f"a change of {CHANGE:.0%} called constant within {CHANGE:.0%}", case, MISSED, constant
            yield "the interval holds the change of the rate", case, HELD, held
            yield f"the prediction at {BEYOND:g} times the run holds", case, HELD, met


def packings(trials: int, rng: np.random.Generator) -> Iterator[Row]:
    """Yield how often trends and predictions over packings hold the truth."""
    for number in (2, 3, 5):
        case = f"{number} packings, 12 blocks each, r = 0.5"

        def one(number: int = number) -> tuple[bool, bool]:
            labels = np.repeat(np.arange(number + 1), 19)
            runs = [
                cumulated(
                    (1.0 + PACKING_SCATTER * rng.standard_normal())
                    * (drifting_rates(12, CHANGE, BEYOND) + SCATTER * noise(rng, 18, 0.5))
                )
                for _ in range(number + 1)
            ]
            places, volumes = np.concatenate([run[0] for run in runs]), np.concatenate([run[1] for run in runs])
            shown = (labels < number) & (places <= 12)
            blocks = blocks_of(places[shown], volumes[shown], labels[shown])
            low, high = rate_trend(blocks).change.interval()
            later = prediction(blocks, 18.0)
            return low <= CHANGE <= high, later.low <= volumes[-1] <= later.high

        held, met = shares(trials, one)
        yield "the interval holds the change of the rate", case, HELD, held
        yield f"the prediction at {BEYOND:g} times the run holds one further packing", case, HELD, met


def steadiness(trials: int, rng: np.random.Generator) -> Iterator[Row]:
    """Yield how often windows are called steady or drifting that are not, and how often fluctuations hold."""
    travel = np.arange(VALUES) + 0.5
    for variation, drift, correlation in ((0.2, 0.2, 0.0), (0.07, 0.1, 0.0), (0.02, 0.1, 0.7)):
        case = f"fluctuation {variation:.0%}, drift {drift:.0%} over the run, r = {correlation:g}"

        def drifts(variation: float = variation, drift: float = drift, r: float = correlation) -> tuple[bool]:
            series = drifting_rates(VALUES, drift) + variation * noise(rng, VALUES, r)
            return (steady_window(travel, series).answer == STEADY,)

        yield "called steady", case, MISSED, shares(trials, drifts)[0]
    for variation, correlation, start in ((0.02, 0.0, 0.0), (0.07, 0.7, 0.0), (0.07, 0.7, 1.0)):
        transient = "after a transient" if start else "from the start"
        case = f"steady {transient}, fluctuation {variation:.0%}, r = {correlation:g}"

        def rests(variation: float = variation, r: float = correlation, start: float = start) -> tuple[bool, ...]:
            series = 1.0 + start * np.exp(-travel / 8.0) + variation * noise(rng, VALUES, r)
            window = steady_window(travel, series)
            held = window.variation_low <= variation <= window.variation_high
            return window.answer == DRIFTING, held, window.fluctuates(variation) == BELOW

        drifting, held, below = shares(trials, rests)
        yield "called drifting", case, MISSED, drifting
        yield "the interval holds the fluctuation", case, HELD, held
        yield f"called below {variation:.0%}", case, 0.5 * MISSED, below


def run_ins(trials: int, rng: np.random.Generator) -> Iterator[Row]:
    """Yield how often a run-in is found in a level series, and how often its interval holds its end."""
    for count in (12, 40):
        places, end = np.arange(1.0, count + 1.0), float(count // 3)
        transient = np.maximum(end - places, 0.0) / (end - 1.0)
        for correlation in CORRELATIONS:

            def one(places=places, transient=transient, end=end, r: float = correlation) -> tuple[bool, bool]:
                series = 1.0 + SCATTER * noise(rng, len(places), r)
                found = run_in(places, series + 10.0 * SCATTER * transient)
                return run_in(places, series).answer != NONE_FOUND, found.low <= end <= found.high

            false, held = shares(trials, one)
            yield "a run-in found in a level series", f"{count} places, r = {correlation:g}", MISSED, false
            case = f"{count} places, r = {correlation:g}, transient of 10 deviations over a third of them"
            yield "the interval holds the end of the run-in", case, HELD, held


def contours(trials: int, rng: np.random.Generator) -> Iterator[Row]:
    """Yield how often contours that are normal from the start are said to be, by the source's rule and corrected."""
    for name, corrected in (("the source's rule", False), ("corrected for the number of tests", True)):
        found = 100.0 * rate_of_no_run_in(12, trials, rng, corrected=corrected)
        yield f"contours normal from the start are found so, {name}", "12 revolutions, 2 sizes", HELD, found
