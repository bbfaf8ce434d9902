"""The page of `benchmarks.search_library`, from its table."""

from __future__ import annotations

import pandas as pd

from benchmarks.page import markdown
from benchmarks.search_truths import HALF
from bulkwear.postproc.statistics.intervals import estimate

OURS, LIBRARY, SPREAD = "ours", "BoTorch", "spread evenly"
MARGIN = (
    0.05  # -, of the way from a design at random to the least: what one may miss more than the other and be as good
)
HEAD = [
    *("response", "method", "missed of the way to the least (%)", "worst search (%)", "limit kept"),
    *("best in its interval", "processor time of a search (s)"),
]


def difference(table: pd.DataFrame) -> tuple[float, float, float] | None:
    """Return by how much (-) ours misses more than the library, and both ends of its 95 % interval. None without the
    library.

    Pairs are searches of one response with the same first designs and errors. A search has the same ones in all
    responses, so a search counts by its mean over them.
    """
    missed = table.pivot(index=["response", "search"], columns="method", values="missed")
    if LIBRARY not in missed:
        return None
    mean = estimate((missed[OURS] - missed[LIBRARY]).groupby("search").mean().to_numpy())
    return mean.value, *mean.interval()


def verdict(low: float, high: float) -> str:
    """Return what an interval of the difference says by the margin."""
    if high < -MARGIN:
        return "ours comes nearer"
    if low > MARGIN:
        return f"{LIBRARY} comes nearer"
    if low >= -MARGIN and high <= MARGIN:
        return "both come as near"
    return "ours comes as near or nearer" if high <= MARGIN else "not decided"


def page(table: pd.DataFrame, noise: float) -> str:
    """Return docs/search_library.md; table: a line per search; noise: standard deviation of errors over the spread."""
    first, library = table.iloc[0], " ".join([LIBRARY, *table.loc[table["method"] == LIBRARY, "version"].unique()])
    parts = [
        "# The search beside a library",
        "Written by `python -m benchmarks.search_library`, every search in [search_library.csv](search_library.csv).",
        f"The search for the [best pattern](optimised_pattern.md) on responses in closed form, whose least value under"
        f" the limit is known: {first['simulations']} simulations, the study's rounds, errors of"
        f" {100 * noise:.0f} % of the response's standard deviation, a second response with such errors that at most"
        f" {100 * HALF:.0f} % of the range may have. The processes of {library} have its own kernel, priors and known"
        " noise; its logarithmic noisy expected improvement chooses from the same candidates. Missed is the distance of"
        " the best design from the least one over that of a median design; one beyond the limit counts as a median one."
        f" Intervals are 95 % over {table['search'].nunique()} searches. Processor time of {LIBRARY} has its share of"
        " one start of the library a round.",
    ]
    found = difference(table)
    if found is not None:
        mean, low, high = (100.0 * each for each in found)
        parts.append(
            f"**Over all responses ours misses {mean:+.1f} points ({low:+.1f} to {high:+.1f}) more than {LIBRARY}:"
            f" {verdict(*found[1:])}**, by a margin of {100 * MARGIN:g} points that was set before."
        )
    return "\n\n".join([*parts, markdown(HEAD, rows(table))]) + "\n"


def rows(table: pd.DataFrame) -> list[list[str]]:
    """Return the cells of `HEAD`, a row per response and method."""
    found = []
    for (response, method), group in table.sort_values("response", kind="stable").groupby(
        ["response", "method"], sort=False
    ):
        missed = estimate(group["missed"].to_numpy())
        mean, low, high = (100.0 * each for each in (missed.value, *missed.interval()))
        of = f"of {len(group)}"
        found.append(
            [
                *(response, method, f"{mean:.1f} ({max(low, 0.0):.1f} to {high:.1f})"),
                *(f"{100 * group['missed'].max():.0f}", f"{group['keeps_limit'].sum()} {of}"),
                *(f"{group['in_interval'].sum()} {of}", f"{group['cpu_s'].mean():.1f}"),
            ]
        )
    return found
