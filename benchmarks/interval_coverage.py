"""How often intervals hold the truth and verdicts err, on synthetic truths: the page docs/interval_coverage.md.

    python -m benchmarks.interval_coverage            # some minutes on one core
    python -m benchmarks.interval_coverage --quick    # few trials, printed only

Writes docs/interval_coverage.csv and .md, and config/published/verdict_error_rates.csv: the errors of the verdicts'
rules beside the claims that they judge.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.command_line import command
from benchmarks.series_rates import rows as series_rows
from bulkwear.postproc.statistics import crossing as crossings
from bulkwear.postproc.statistics import intervals, verdicts
from bulkwear.postproc.statistics.intervals import CONFIDENCE, Estimate, difference, estimate
from bulkwear.postproc.statistics.verdicts import AGREES, ALLOWED, CONTRADICTS, Claim, judged
from bulkwear.workflows.config.claims import date_of_rules
from bulkwear.workflows.report.markdown_text import markdown, prose

ROOT = Path(__file__).parents[1]
TABLE, PAGE = ROOT / "docs" / "interval_coverage.csv", ROOT / "docs" / "interval_coverage.md"
RATES = ROOT / "config" / "published" / "verdict_error_rates.csv"
TRIALS, FEW = 4000, 200
TRUTH = 0.6  # of the made-up ratio
NOMINAL = 100.0 * CONFIDENCE
HALF = 50.0  # %, nominal shares below are of errors
CLOSE = 2.0  # points, to what is meant


@dataclass(frozen=True)
class Bed:
    """A made-up bed: scatter of packings and of blocks (-, relative), correlation of blocks, their drift and number."""

    packings: int = 3
    between: float = 0.04
    within: float = 0.08
    correlation: float = 0.0
    drift: float = 0.0
    blocks: tuple[int, int] = (6, 6)  # least and most of a packing

    def values(self, random: np.random.Generator, truth: float = TRUTH) -> tuple[np.ndarray, np.ndarray]:
        """Return block values and the packing of each, their mean over the travel being the truth."""
        lengths = random.integers(self.blocks[0], self.blocks[1] + 1, self.packings)
        series = [self._packing(random, length) for length in lengths]
        return truth * np.concatenate(series), np.repeat(np.arange(self.packings), lengths)

    def _packing(self, random: np.random.Generator, length: int) -> np.ndarray:
        noise = random.normal(size=length)
        series = np.empty(length)
        series[0] = noise[0]
        for k in range(1, length):
            series[k] = self.correlation * series[k - 1] + np.sqrt(1.0 - self.correlation**2) * noise[k]
        ramp = self.drift * (np.linspace(-0.5, 0.5, length) if length > 1 else 0.0)
        return np.exp(random.normal(0.0, self.between)) * (1.0 + self.within * series + ramp)


BEDS = {
    "two packings": Bed(2),
    "three packings": Bed(),
    "five packings": Bed(5),
    "ten packings": Bed(10),
    "packings alike, blocks scatter": Bed(between=0.0, within=0.15),
    "packings scatter, blocks alike": Bed(between=0.15, within=0.01),
    "blocks correlated by 0.7": Bed(correlation=0.7, blocks=(12, 12)),
    "blocks drift by 20 %": Bed(drift=0.2),
    "drift and correlation": Bed(drift=0.2, correlation=0.7, blocks=(17, 17)),
    "4 to 12 blocks": Bed(blocks=(4, 12)),
    "one block each": Bed(blocks=(1, 1)),
}
Trial = Callable[[np.random.Generator], bool | None]


def share(trial: Trial, name: str, trials: int) -> tuple[float, int]:
    """Return in how many per cent of the trials something was so, of those that gave an answer, and their number."""
    random = np.random.default_rng(zlib.crc32(name.encode()))
    found = [each for each in (trial(random) for _ in range(trials)) if each is not None]
    return 100.0 * float(np.mean(found)), len(found)


def interval_rows(trials: int) -> Iterator[dict[str, object]]:
    """Yield a row per case of an interval: how often it holds the truth."""
    for name, bed in BEDS.items():

        def holds(random: np.random.Generator, bed: Bed = bed) -> bool:
            low, high = estimate(*bed.values(random), log=True).interval()
            return low <= TRUTH <= high

        yield _row("mean over packings", name, NOMINAL, *share(holds, name, trials))
    yield _row("one further packing", "three packings", NOMINAL, *share(_one_more, "one more", trials))
    for name, other in (("alike", Bed()), ("the other scatters twice as much", Bed(5, 0.08, 0.16))):

        def ratio_holds(random: np.random.Generator, other: Bed = other) -> bool:
            first, second = (estimate(*bed.values(random), log=True) for bed in (Bed(), other))
            low, high = difference(first, second).interval()
            return low <= 1.0 <= high

        yield _row("ratio of independent means", name, NOMINAL, *share(ratio_holds, name, trials))


def _one_more(random: np.random.Generator) -> bool:
    low, high = estimate(*Bed().values(random), log=True).of_one_more()
    return low <= estimate(*Bed(1).values(random), log=True).value <= high


def crossing_rows(trials: int) -> Iterator[dict[str, object]]:
    """Yield a row per form of truth: how often the interval of a crossing holds it."""
    places, truth = np.repeat([4.0, 6.0, 8.0, 9.0, 10.0, 12.0], 3), 8.5
    shapes = {
        "line": lambda s: 1.0 + 0.12 * (s - truth),
        "power law": lambda s: (s / truth) ** 0.7,
        "saturating": lambda s: 1.6 - 0.6 * np.exp(-(s - truth) / 10.0),
    }
    for name, shape in shapes.items():

        def holds(random: np.random.Generator, shape: Callable = shape) -> bool | None:
            found = crossings.crossing(places, shape(places) * np.exp(random.normal(0.0, 0.04, len(places))))
            return None if found.reason else found.low <= truth <= found.high

        told = f"truth a {name}, six scales, three packings"
        yield _row("crossing, over forms", told, NOMINAL, *share(holds, name, max(trials // 5, FEW)), "at least")

    def line_holds(random: np.random.Generator) -> bool:
        ratio = shapes["line"](places) + random.normal(0.0, 0.04, len(places))
        one = crossings.form_table(places, ratio).set_index("form").loc["ratio, line"]
        return one["interval_low"] <= truth <= one["interval_high"]

    told = "the line of a line, six scales, three packings"
    yield _row("crossing, one form", told, NOMINAL, *share(line_holds, "one form", max(trials // 5, FEW)))


def _row(what: str, case: str, nominal: float, found: float, trials: int, meant: str = "equal") -> dict[str, object]:
    return {
        "what": what,
        "case": case,
        "nominal_percent": nominal,
        "meant": meant,
        "found_percent": found,
        "trials": trials,
    }


# ---------------------------------------------------------------- verdicts

SIZE = Claim("size", "", "", "ratio", direction="below", reference=1.0, magnitude=(TRUTH, TRUTH), margin=0.1)
SIDE = Claim("side", "", "", "ratio", direction="below", reference=1.0)
RANGE = Claim("range", "", "", "ratio", magnitude=(0.5, 0.7), margin=0.05)
PACKINGS, SCATTER, SEVERAL = (2, 3, 5), (0.01, 0.03, 0.1, 0.3), 5


@dataclass(frozen=True)
class Rule:
    """A claim and truths at which an answer would be false: truths of one estimate or of several that are claimed."""

    name: str
    claim: Claim
    not_agrees: tuple[tuple[float, ...], ...]
    not_contradicts: tuple[tuple[float, ...], ...]


RULES = (
    Rule("direction", SIDE, ((1.0,),), ((1.0,), (0.99,))),
    Rule("magnitude with direction", SIZE, ((0.5,), (0.7,), (0.75,)), ((1.0,), (0.9,))),
    Rule("magnitude alone", RANGE, ((0.45,), (0.75,), (0.8,)), ((0.45,), (0.75,), (0.6,))),
    Rule("direction of five", SIDE, ((0.6,) * 4 + (1.0,), (1.0,) * SEVERAL), ((1.0,) * SEVERAL, (0.99,) * SEVERAL)),
    Rule("magnitude of five", SIZE, ((0.6,) * 4 + (0.7,),), ((1.0,) * SEVERAL, (0.9,) * SEVERAL)),
)


def verdict_rows(trials: int) -> Iterator[dict[str, object]]:
    """Yield a row per rule, kind of error and number of packings: the largest rate over truths and scatters."""
    for rule in RULES:
        for verdict, truths in ((AGREES, rule.not_agrees), (CONTRADICTS, rule.not_contradicts)):
            for packings in PACKINGS:
                rates = [
                    share(_errs(rule.claim, truth, scatter, packings, verdict), f"{rule.name}{truth}{scatter}", trials)[
                        0
                    ]
                    for truth in truths
                    for scatter in SCATTER
                ]
                yield {
                    "rule": rule.name,
                    "error": f'false "{verdict}"',
                    "packings": packings,
                    "largest_percent": max(rates),
                    "allowed_percent": 100.0 * ALLOWED,
                    "cases": len(rates),
                    "trials_each": trials,
                }


def _errs(claim: Claim, truths: tuple[float, ...], scatter: float, packings: int, verdict: str) -> Trial:
    def errs(random: np.random.Generator) -> bool:
        found = {str(k): _mean(truth * np.exp(random.normal(0.0, scatter, packings))) for k, truth in enumerate(truths)}
        return judged(claim, found).verdict == verdict

    return errs


def _mean(values: np.ndarray) -> Estimate:
    """Return `estimate` of one value per packing, without the cost of its labels."""
    logs = np.log(values)
    count = len(logs)
    return Estimate(float(np.exp(logs.mean())), float(logs.std(ddof=1) / np.sqrt(count)), count - 1, count, True)


def rules_hash() -> str:
    """Return a hash of the code that makes estimates and verdicts, comments, docstrings and imports aside."""
    total = hashlib.sha256()
    for module in (intervals, verdicts):
        tree = ast.parse(Path(module.__file__).read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
                node.body = node.body[1:]
            if isinstance(node, ast.Module | ast.FunctionDef):
                node.body = [each for each in node.body if not isinstance(each, ast.Import | ast.ImportFrom)]
        total.update(ast.dump(tree).encode())
    return total.hexdigest()[:12]


# ---------------------------------------------------------------- the page


def _meant(row: tuple) -> str:
    """Return how the share of a row of `series_rates` is meant: intervals of one run are to be wide enough for every
    correlation of its values, so they hold the truth more often where there is none.
    """
    if row.what.startswith("contours normal"):
        return "compared"
    if row.nominal_percent < HALF:
        return "at most"
    return "equal" if "packings" in row.case else "at least"


def not_kept(coverage: pd.DataFrame) -> list[str]:
    """Return the rows whose share is further than CLOSE from what is meant."""
    beyond = coverage["found_percent"] - coverage["nominal_percent"]
    meant = coverage["meant"]
    off = (meant.isin(["equal", "at least"]) & (beyond < -CLOSE)) | (
        meant.isin(["equal", "at most"]) & (beyond > CLOSE)
    )
    return [f"{row.what} ({row.case}): {row.found_percent:.1f} %" for row in coverage[off].itertuples()]


def page(coverage: pd.DataFrame, rates: pd.DataFrame) -> str:
    """Return docs/interval_coverage.md."""
    held = coverage[(coverage["meant"] == "equal") & np.isclose(coverage["nominal_percent"], NOMINAL)]
    ends = f"{held['found_percent'].min():.1f} to {held['found_percent'].max():.1f} %"
    worst = rates["largest_percent"].max()
    told = [
        "Generated by `python -m benchmarks.interval_coverage`; not to be edited. Made-up beds and series whose truth"
        " is known, as many seeded trials as a row says.",
        f"{NOMINAL:.0f} % intervals over packings hold the truth in {ends} of the trials. The largest rate of a false"
        f" verdict is {worst:.1f} %, allowed are {100.0 * ALLOWED:.0f} %. Further than {CLOSE:g} points from what is"
        f" meant: {'; '.join(not_kept(coverage)) or 'none'}.",
        "[Table](interval_coverage.csv). Meant: whether a share is to equal the nominal one, or to be at least or at"
        " most that. Values of one run follow one another with a correlation r that a short run cannot tell; its"
        " intervals are wide enough for any r up to 0.7, and so hold the truth more often where there is less.",
        f"Claims and margins of {date_of_rules()}, rules of `postproc/statistics/verdicts.py` (code {rules_hash()}). Of"
        " each rule the largest rate over truths at which the answer is false, those on the very edge of what is"
        f" claimed among them, and over scatters of packings from {100.0 * min(SCATTER):.0f} to"
        f" {100.0 * max(SCATTER):.0f} %. [Table](../config/published/verdict_error_rates.csv).",
    ]
    first, answer, meant, rules = (prose(each) for each in told)
    parts = ["# How often intervals hold the truth, and verdicts err", first, answer, "## Intervals and tests", meant]
    parts += [markdown(coverage), "## Verdicts", rules, markdown(rates.drop(columns="code"))]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def main() -> None:
    """Run the benchmark from the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few trials, printed only")
    quick = parser.parse_args().quick
    trials = FEW if quick else TRIALS
    coverage = pd.DataFrame([*interval_rows(trials), *crossing_rows(trials)])
    rates = pd.DataFrame(verdict_rows(trials)).assign(code=rules_hash())
    if not quick:
        series = series_rows()
        series.insert(3, "meant", [_meant(row) for row in series.itertuples()])
        coverage = pd.concat([coverage, series], ignore_index=True)
    print(coverage.to_string(), rates.to_string(), sep="\n")
    if quick:
        return
    coverage.to_csv(TABLE, index=False, float_format="%.4g")
    rates.to_csv(RATES, index=False, float_format="%.3g")
    PAGE.write_text(page(coverage, rates), encoding="utf-8")


if __name__ == "__main__":
    command(main)
