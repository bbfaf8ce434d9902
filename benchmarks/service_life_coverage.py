"""How often the interval of a service life holds the truth, on made-up places whose truth is known.

    python -m benchmarks.service_life_coverage            # two minutes on one core
    python -m benchmarks.service_life_coverage --quick    # few trials, printed only

Writes docs/service_life_coverage.csv: of the mean and the change over blocks of one packing, of the worst of many
places, and of its life with a coefficient that is known to some error. Values are those of blocks, each one with its
own factor of the packing at that place; neighbouring blocks are correlated. Beside the worst place stands what is not
done: to name it by all blocks but one, and to take the error as if they were independent.
"""

from __future__ import annotations

import argparse
import math
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.command_line import command
from bulkwear.postproc.statistics.block_means import change_of_blocks, mean_of_blocks
from bulkwear.postproc.statistics.intervals import CONFIDENCE, Estimate, students_t
from bulkwear.postproc.statistics.worst_place import worst_place
from bulkwear.postproc.wear.service_life import life

TABLE = Path(__file__).parents[1] / "docs" / "service_life_coverage.csv"
COLUMNS = ["what", "case", "nominal_percent", "found_percent", "median_width_percent", "trials"]
TRIALS, FEW = 2000, 20
BETWEEN, WITHIN = 0.05, 0.1  # -, scatter of packings and of blocks at a place
CORRELATIONS = (0.0, 0.2, 0.4, 0.6)
RAMP = 0.2  # -, rise of a series over its whole length
DISTANT = math.inf

Trial = Callable[[np.random.Generator], tuple[float, float, float]]  # both ends and the truth


@dataclass(frozen=True)
class Places:
    """Made-up places: their number, how far the last one is below the first (-), packings and blocks of each."""

    count: int = 1
    grade: float = 0.0
    packings: int = 3
    blocks: int = 6
    correlation: float = 0.2

    @property
    def truth(self) -> np.ndarray:
        """Return the truth (count,) of each place; the worst one has 1."""
        return 1.0 - self.grade * np.linspace(0.0, 1.0, self.count)

    def values(self, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Return block values (b, count) and the packing (b,) of each; a packing that stands alone is the truth."""
        noise = random.standard_normal((self.packings, self.blocks, self.count))
        for k in range(1, self.blocks):
            noise[:, k] *= math.sqrt(1.0 - self.correlation**2)
            noise[:, k] += self.correlation * noise[:, k - 1]
        between = BETWEEN * (self.packings > 1)
        factors = np.exp(between * random.standard_normal((self.packings, 1, self.count)))
        values = self.truth * factors * (1.0 + WITHIN * noise)
        return values.reshape(-1, self.count), np.repeat(np.arange(self.packings), self.blocks)

    def told(self) -> str:
        """Return the case in words."""
        alike = "alike" if not self.grade else f"graded by {100.0 * self.grade:g} %"
        place = "one place" if self.count == 1 else f"{self.count} places {alike}"
        packing = "one packing" if self.packings == 1 else f"{self.packings} packings"
        return f"{place}, {packing} of {self.blocks} blocks, r = {self.correlation:g}"


MADE = [
    Places(count, grade, packings, blocks)
    for packings, blocks in ((1, 8), (1, 20), (1, 40), (2, 6), (3, 6), (5, 6))
    for count, grade in ((1, 0.0), (2, 0.0), (20, 0.0), (200, 0.0), (5, 0.1), (20, 0.5), (200, 1.0), (2, 0.5))
]


def rows(trials: int = TRIALS) -> pd.DataFrame:
    """Return COLUMNS: what is told, of which case, how often intervals shall and do hold the truth, their width."""
    found = []
    for what, case, trial in (*_of_blocks(), *_of_places()):
        random = np.random.default_rng(zlib.crc32(f"{what}{case}".encode()))
        low, high, truth = np.array([trial(random) for _ in range(trials)]).T
        held = 100.0 * float(np.mean((low <= truth) & (truth <= high)))
        width = 100.0 * float(np.median((high - low) / truth))
        found.append((what, case, 100.0 * CONFIDENCE, held, width, trials))
    return pd.DataFrame(found, columns=COLUMNS)


def _of_blocks() -> Iterator[tuple[str, str, Trial]]:
    for correlation in CORRELATIONS:
        for blocks in (4, 8, 12, 20, 40):
            made = Places(packings=1, blocks=blocks, correlation=correlation)
            ramp = RAMP * ((np.arange(blocks) + 0.5) / blocks - 0.5)

            def mean(random: np.random.Generator, made: Places = made) -> tuple[float, float, float]:
                return *mean_of_blocks(made.values(random)[0][:, 0]).interval(), 1.0

            def change(
                random: np.random.Generator, made: Places = made, ramp: np.ndarray = ramp
            ) -> tuple[float, float, float]:
                return *change_of_blocks(made.values(random)[0][:, 0] + ramp).interval(), 0.5 * RAMP

            yield "mean over the blocks of one packing", made.told(), mean
            yield "change over the blocks of one packing", made.told(), change


def _of_places() -> Iterator[tuple[str, str, Trial]]:
    for made in MADE:

        def by_others(random: np.random.Generator, made: Places = made) -> tuple[float, float, float]:
            values, packings = made.values(random)
            return *worst_place(values, packings=packings).value().interval(), 1.0

        def of_life(random: np.random.Generator, made: Places = made) -> tuple[float, float, float]:
            values, packings = made.values(random)
            assumed = math.exp(random.normal(0.0, math.atanh(0.2) / students_t(0.5 + 0.5 * CONFIDENCE, DISTANT)))
            found = life(worst_place(assumed * values, packings=packings).value(), 0.2, 1.0)
            return found.low_h, found.high_h, 1.0

        yield "load of the worst place", made.told(), by_others
        yield "its life, coefficient known to 20 %", made.told(), of_life
        if made.packings == 1 and made.count > 1:
            yield "not done: place named by all blocks but one", made.told(), _leave_one_out(made)


def _leave_one_out(made: Places) -> Trial:
    def trial(random: np.random.Generator) -> tuple[float, float, float]:
        values, _ = made.values(random)
        named = (values.sum(axis=0) - values).argmax(axis=1)
        chosen = values[np.arange(len(values)), named]
        error = chosen.std(ddof=1) / math.sqrt(len(chosen))
        return *Estimate(chosen.mean(), error, len(chosen) - 1, 1).interval(), 1.0

    return trial


def main() -> None:
    """Run the benchmark from the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few trials, printed only")
    quick = parser.parse_args().quick
    table = rows(FEW if quick else TRIALS)
    print(table.to_string())
    if not quick:
        table.to_csv(TABLE, index=False, float_format="%.4g")


if __name__ == "__main__":
    command(main)
