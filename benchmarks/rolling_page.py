"""The page of `benchmarks.rolling_models`: how far each model is from what the source prints, and which is nearest."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from benchmarks.rolling_case import MODELS, PLATE, study_of, time_steps_said
from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate, difference, estimate
from bulkwear.workflows.cases.calibration.responses import response_name
from bulkwear.workflows.report.fillings import MASS, NOTE, fillings_table
from bulkwear.workflows.report.markdown_text import bullet, markdown, prose

ALL_RESPONSES = tuple(name for responses in RESPONSES.values() for name in responses)
(WALL_ANGLE,) = RESPONSES["wall_shear"]  # of which the source prints nothing
NO_REST = "no_rest"  # column with the words of a test that has no responses
TWO = 2  # pairs, between which a response changes
ENOUGH = 3  # packings that two models share, to be compared one by one
NEAREST, APART, ALIKE, OPEN = "nearest", "yes", "no", "unknown"  # whether a model is told from the nearest one


def differences(runs: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return response, model, pair, packing, published, ours and difference (ours less published), a row for every
    value that both have.

    runs: model, pair, packing and responses, a row per simulation; published: a row per pair (`row`)
    """
    names = [name for name in ALL_RESPONSES if name in runs and name in published]
    ours = runs.melt(["model", "pair", "packing"], names, "response", "ours").dropna()
    theirs = published.melt(["row"], names, "response", "published").dropna().rename(columns={"row": "pair"})
    both = ours.merge(theirs, on=["pair", "response"])
    return both.assign(difference=both["ours"] - both["published"])


def of_shared_pairs(found: pd.DataFrame) -> pd.DataFrame:
    """Return those rows whose pair was simulated under every model that the response has; found: from `differences`."""
    models = found.groupby("response")["model"].transform("nunique")
    with_pair = found.groupby(["response", "pair"])["model"].transform("nunique")
    return found[models == with_pair]


def summary(found: pd.DataFrame) -> pd.DataFrame:
    """Return a row per response and model: how many pairs, mean difference with its interval over packings (a packing
    counts by the mean of its pairs), the root of the mean square of the pairs' differences, and whether the mean
    difference is told from that of the model of which that root is least.

    found: as from `differences`
    """
    rows = []
    for response, of_response in found.groupby("response", sort=False):
        packings = {model: by_packing(of) for model, of in of_response.groupby("model", sort=False)}
        means = {model: estimate(values.to_numpy()) for model, values in packings.items()}
        by_pair = of_response.groupby(["model", "pair"])["difference"].mean()
        off = (by_pair**2).groupby("model").mean() ** 0.5
        for model, mean in means.items():
            low, high = mean.interval()
            rows.append(
                {"response": response, "model": model, "pairs": len(by_pair[model]), "packings": mean.packings}
                | {"mean_difference": mean.value, "low": low, "high": high, "root_mean_square": float(off[model])}
                | {"told_from_nearest": _told_from(packings[off.idxmin()], packings[model])}
            )
    return pd.DataFrame(rows)


def less(values: pd.Series, others: pd.Series) -> Estimate:
    """Return by how much one mean over packings is more than another one; both by packing (index).

    Models have the same packings, which scatter alike under some of them, so those that both have are subtracted one by
    one. Of fewer than ENOUGH of these that tells less than the two means do, taken as independent.
    """
    both = (values - others).dropna()
    if len(both) >= ENOUGH:
        return estimate(both.to_numpy())
    return difference(estimate(values.to_numpy()), estimate(others.to_numpy()))


def _told_from(nearest: pd.Series, values: pd.Series) -> str:
    """Return whether the mean difference of a model is told from that of the nearest one; both by packing."""
    if values is nearest:
        return NEAREST
    low, high = less(values, nearest).interval()
    if math.isnan(low):
        return OPEN
    return ALIKE if low <= 0.0 <= high else APART


def by_packing(of: pd.DataFrame) -> pd.Series:
    """Return the mean difference of each packing that has all pairs; of: rows of one response and model."""
    found = of.groupby("packing")["difference"].agg(["mean", "size"])
    return found.loc[found["size"] == of["pair"].nunique(), "mean"]


def nearest(table: pd.DataFrame, response: str) -> str:
    """Return in a sentence which model is nearest to the source in a response, and whether any holds it.

    table: as from `summary`
    """
    rows = table[table["response"] == response].sort_values("root_mean_square")
    best, last = rows.iloc[0], rows.iloc[-1]
    unit = response_name(response)
    holding = rows[(rows["low"] <= 0.0) & (rows["high"] >= 0.0)]
    if rows["low"].isna().all() or math.isinf(rows["high"].max()):
        said = UNKNOWN
    elif len(holding):
        cancel = ", in which pairs may cancel," if best["pairs"] > 1 else ""
        said = f"the interval of the mean difference{cancel} holds 0 for {', '.join(holding['model'])}"
    else:
        said = "no interval of a mean difference holds 0"
    alike = rows.loc[rows["told_from_nearest"] == ALIKE, "model"]
    said += f"; not told from it: {', '.join(alike)}" if len(alike) else ""
    return (
        f"{unit}: {best['model']} is nearest (off by {best['root_mean_square']:.2g}, root mean square of"
        f" {best['pairs']:.0f} pair{'s' if best['pairs'] > 1 else ''}; mean {best['mean_difference']:+.2g}),"
        f" {last['model']} farthest"
        f" ({last['root_mean_square']:.2g}; mean {last['mean_difference']:+.2g}); {said}."
    )


def trend(found: pd.DataFrame, response: str) -> list[str]:
    """Return in a sentence by how much a response changes from one of two pairs to the other, in the source and under
    each model; nothing where there are more pairs, or one.

    found: of `of_shared_pairs`
    """
    of = found[found["response"] == response]
    means = of.groupby(["pair", "published"])[["ours"]].mean().reset_index().sort_values("published")
    if len(means) != TWO:
        return []
    (first, second), change = means["pair"], float(np.diff(means["published"])[0])
    by_model = of.groupby(["model", "pair"])["ours"].mean().unstack()
    ours = by_model[second] - by_model[first]
    told = ", ".join(f"{model} {value:+.1f}" for model, value in ours.items())
    return [
        f"{response_name(response)}: from the pair {first} to {second} the source changes by {change:+.1f}; {told}."
    ]


def restless(runs: pd.DataFrame) -> list[str]:
    """Return a sentence for each model and test of which packings never came to rest."""
    if NO_REST not in runs:
        return []
    given_up = runs[runs[NO_REST].notna()].groupby(["model", "test", "pair", NO_REST], sort=False)["packing"].nunique()
    return [
        f"`{model}`, {test.replace('_', ' ')}, pair {pair}, packings: {count}; {words}, so it has no angle."
        for (model, test, pair, words), count in given_up.items()
    ]


def wall_friction(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row per model: packings, wall friction angle with its interval, and that of the plate's coefficient."""
    if WALL_ANGLE not in runs:
        return pd.DataFrame()
    rows = []
    for model, of in runs.dropna(subset=[WALL_ANGLE]).groupby("model", sort=False):
        mean = estimate(of[WALL_ANGLE].to_numpy())
        low, high = mean.interval()
        rows.append({"model": model, "packings": mean.packings, WALL_ANGLE: mean.value, "low": low, "high": high})
        rows[-1]["angle_of_the_coefficient_deg"] = math.degrees(math.atan(of[PLATE].iloc[0]))
    return pd.DataFrame(rows)


def by_pair(found: pd.DataFrame, response: str) -> pd.DataFrame:
    """Return a row per pair: published, and the mean of the packings under every model."""
    of = found[found["response"] == response]
    wide = of.pivot_table(index=["pair", "published"], columns="model", values="ours", sort=False).reset_index()
    return wide[["pair", "published", *(model for model in MODELS if model in wide)]].rename_axis(columns=None)


def results_page(runs: pd.DataFrame, published: pd.DataFrame) -> str:
    """Return the page; runs, published: as in `differences`."""
    found = differences(runs, published)
    parts = [
        "# Which rolling model did the source run?",
        prose(
            "Generated by `python -m benchmarks.rolling_models`; not to be edited. The models are those of"
            " [rolling friction](rolling_friction.md). [Every simulation](rolling_models.csv)."
        ),
        *(beside_the_source(found, restless(runs)) if len(found) else map(bullet, restless(runs))),
        *wall_section(wall_friction(runs)),
        *filling_section(runs),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def beside_the_source(found: pd.DataFrame, further: Sequence[str]) -> list[str]:
    """Return the parts of the page on what the source prints; found: of `differences`; further: sentences."""
    shared = of_shared_pairs(found)
    table = summary(shared)
    responses = list(dict.fromkeys(table["response"]))
    scale = study_of(MODELS[0]).settings["particle_scale"]
    trends = [sentence for response in responses for sentence in trend(shared, response)]
    parts = [
        "## Nearest to what the source simulated",
        "\n".join(map(bullet, (*(nearest(table, response) for response in responses), *trends, *further))),
        prose(
            "The source simulated these pairs of frictions itself (Yan 2022, Tables 3.3, 3.5 and 3.6). It prints the"
            " law of type A, a constant torque against the relative spin (Equation 3.3), as `cdt` has it; whether its"
            " code ran that one or one of its own two it does not say. The particles here are"
            f" {scale:g} times as large, and the opening of the draw-down test is an assumption, a slot: the discharge"
            " time tells of that first."
            " Compared are the pairs that were simulated under every model of a response. Low and high: 95 % interval"
            " of the mean difference over packings; told from the nearest: where the 95 % interval of the difference to"
            f" that model's mean does not hold 0. {time_steps_said()}"
        ),
        markdown(table.assign(response=table["response"].map(response_name))),
        "![Ours over what the source simulated](rolling_models.png)",
    ]
    for response in responses:
        parts += [f"## {response_name(response)}", markdown(by_pair(found, response))]
    return parts


def filling_section(runs: pd.DataFrame) -> list[str]:
    """Return the part of the page on the boxes as they were filled, of those simulations whose filling is told."""
    if MASS not in runs:
        return []
    table = fillings_table(runs.dropna(subset=[MASS]), ("model", "test"))
    return ["## Fillings", prose(NOTE), markdown(table)]


def wall_section(walls: pd.DataFrame) -> list[str]:
    """Return the part of the page on wall shear tests; walls: of `wall_friction`."""
    if walls.empty:
        return []
    off = (walls[WALL_ANGLE] - walls["angle_of_the_coefficient_deg"]).abs().max()
    said = (
        "The plate, drawn away under a filled box, has the coefficient whose angle is the last column; what the bed"
        f" shows is less where particles roll on it, under these models by {off:.2g} degrees at most. The source has no"
        " such test."
    )
    return [f"## {response_name(WALL_ANGLE)}, of a wall shear test", prose(said), markdown(walls)]
