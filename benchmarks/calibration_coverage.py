"""How often the 95 % region of a calibration holds the truth: 200 calibrations by a formula, with noise and with bias.

    python -m benchmarks.calibration_coverage     # in the root of the repository: about 5 minutes on an idle core
    python -m benchmarks.calibration_coverage --number 10 --output /tmp

Hidden values of two frictions, drawn evenly from their range, give three responses by a formula in the solver's place.
Each is measured with its error and, in some cases, with a bias: what the formula is off by. Then all of a calibration
is done: simulations that scatter between packings, surrogates, acquisition and stopping rule. Coverage is the share of
calibrations whose region, or whose interval, holds the hidden values. Writes calibration_coverage.csv and .md.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats
from scipy.special import logsumexp

from benchmarks.page import markdown
from bulkwear.postproc.inference.loop import Request, calibrate
from bulkwear.postproc.inference.posterior import FAMILY_SHARE, densest, interval
from bulkwear.postproc.inference.problem import MODEL_DISCREPANCY, Experiment, Measured, Parameter, Problem

NUMBER = 200  # calibrations per case
LOW, HIGH = 0.1, 0.7  # of both frictions
DEVIATIONS = {"angle": 0.4, "repose": 0.9, "time": 0.1}  # degrees, degrees, s: of the measurement, Yan 2022, Table 3.1
SEED_SCATTER = {"angle": 0.7, "repose": 0.5, "time": 0.05}  # of a simulation, in the same units
FIT_ERROR = 0.3  # of each simulated response, over its scatter
RESPONSES = {"box": ("angle",), "draw_down": ("repose", "time")}
TESTS = (Experiment("box", RESPONSES["box"], 8, 12), Experiment("draw_down", RESPONSES["draw_down"], 4, 8))
BIASES = {
    "none": lambda random: np.zeros(3),
    "2 deviations, each up or down": lambda random: 2.0 * random.choice([-1.0, 1.0], 3),
    "2 deviations, all up": lambda random: np.full(3, 2.0),
}
CASES = tuple((bias, discrepancy) for bias in BIASES for discrepancy in (0.0, MODEL_DISCREPANCY))
SCALES = {"half-normal": stats.halfnorm, "half-Cauchy": stats.halfcauchy}
NODES = 12  # of a scale that is marginalised
GRID = 48  # points along each parameter where the surrogate is exact
EXACT = 400  # calibrations per case with exact surrogates


def responses(sliding: np.ndarray, rolling: np.ndarray) -> dict[str, np.ndarray]:
    """Return what bulk tests give: angles grow with both frictions and level off, time grows with sliding friction."""
    return {
        "angle": 20.0 + 45.0 * (1.0 - np.exp(-3.0 * sliding)) * (1.0 - np.exp(-3.5 * rolling)) + 6.0 * sliding,
        "repose": 18.0 + 40.0 * (1.0 - np.exp(-2.0 * sliding)) * (1.0 - np.exp(-5.0 * rolling)),
        "time": 5.0 + 3.0 * sliding + 0.5 * rolling,
    }


def simulate(requests: Sequence[Request]) -> list[dict[str, float]]:
    """Return the answers of the formula with the scatter of each request's seed."""
    answers = []
    for request in requests:
        random, exact = np.random.default_rng(request.seed), responses(**request.values)
        names = RESPONSES[request.test]
        row = {name: float(exact[name]) + SEED_SCATTER[name] * random.standard_normal() for name in names}
        answers.append(row | {f"{name}_uncertainty": FIT_ERROR * SEED_SCATTER[name] for name in names})
    return answers


def measured(hidden: np.ndarray, bias: str, discrepancy: float, random: np.random.Generator) -> dict[str, Measured]:
    """Return the responses of hidden frictions (2,) with errors and a bias, and the discrepancy that is assumed."""
    off = random.standard_normal(3) + BIASES[bias](random)
    exact = responses(*hidden)
    return {
        name: Measured(float(exact[name] + each * deviation), deviation, discrepancy * deviation)
        for (name, deviation), each in zip(DEVIATIONS.items(), off, strict=True)
    }


def one(asked: tuple[str, float, int]) -> dict[str, float]:
    """Calibrate once: does region, and do the intervals, hold the hidden values; the region's share of the range."""
    bias, discrepancy, seed = asked
    random = np.random.default_rng([seed, 23])
    hidden = random.uniform(LOW, HIGH, 2)
    parameters = tuple(Parameter(name, LOW, HIGH) for name in ("sliding", "rolling"))
    problem = Problem(parameters, TESTS, measured(hidden, bias, discrepancy, random), seed=seed)
    result = calibrate(problem, simulate)
    weights, values = result.posterior.weights, problem.from_unit(result.posterior.points)
    return held(weights, values, hidden) | {"simulations": len(result.simulations)}


def held(weights: np.ndarray, values: np.ndarray, hidden: np.ndarray) -> dict[str, float]:
    """Return whether region and intervals of a posterior on values (n, 2) hold hidden ones, and the region's share."""
    region = densest(weights, FAMILY_SHARE)
    ends = [interval(values[:, column], weights) for column in range(2)]
    return {
        "region": float(region[np.argmin(np.linalg.norm(values - hidden, axis=1))]),
        "intervals": float(np.mean([low < value < high for (low, high), value in zip(ends, hidden, strict=True)])),
        "area": float(region.mean()),
    }


# ---------------------------------------------------------------- scales that are marginalised


def with_scale(kind: str, scale: float, bias: str) -> dict[str, float]:
    """Return the means of `held` with exact surrogates, where the discrepancy's deviation is itself unknown.

    kind: of `SCALES`, with `scale` deviations of the measurement; "given" for a known one
    """
    shares = (np.arange(NODES) + 0.5) / NODES
    deviations = scale * SCALES[kind].ppf(shares) if kind in SCALES else np.array([scale])
    line = LOW + (HIGH - LOW) * (np.arange(GRID) + 0.5) / GRID
    values = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    units = np.array(list(DEVIATIONS.values()))[:, None]
    simulated = np.array(list(responses(*values.T).values())) / units
    random, variance = np.random.default_rng(41), 1.0 + deviations[:, None, None] ** 2
    found = []
    for _ in range(EXACT):
        hidden = random.uniform(LOW, HIGH, 2)
        exact = np.array(list(responses(*hidden).values())) / units[:, 0]
        seen = exact + random.standard_normal(3) + BIASES[bias](random)
        logs = -0.5 * ((seen[:, None] - simulated) ** 2 / variance + np.log(variance))
        total = logsumexp(logs, axis=0).sum(axis=0)
        weights = np.exp(total - total.max())
        found.append(held(weights / weights.sum(), values, hidden))
    return dict(pd.DataFrame(found).mean())


# ---------------------------------------------------------------- table and page


def row_of(method: str, bias: str, number: int, means: Mapping[str, float]) -> dict[str, object]:
    """Return a row of the table; the error of a share is binomial, of a share that one more and one less have moved."""
    share = (number * means["region"] + 1.0) / (number + 2.0)
    error = math.sqrt(share * (1.0 - share) / number)
    return {"surrogates": method, "bias": bias, "calibrations": number, **means, "region_error": error}


def cells(table: pd.DataFrame) -> list[list[str]]:
    """Return the rows of a table as the page shows them."""
    return [
        [
            *(row["discrepancy"], row["bias"], str(row["calibrations"])),
            f"{100.0 * row['region']:.1f} ± {100.0 * row['region_error']:.1f}",
            *(f"{100.0 * row[name]:.1f}" for name in ("intervals", "area")),
            "" if pd.isna(row.get("simulations")) else f"{row['simulations']:.1f}",
        ]
        for row in table.to_dict("records")
    ]


def page(table: pd.DataFrame) -> str:
    """Return docs/calibration_coverage.md."""
    head = ["discrepancy assumed", "bias", "calibrations", "95 % region holds (%)", "95 % intervals hold (%)"]
    head += ["region, of the range (%)", "simulations"]
    whole, exact = (table[table["surrogates"] == name] for name in ("fitted", "exact"))
    return (
        "\n\n".join(
            [
                "# How often a calibration holds the truth",
                "Written by `python -m benchmarks.calibration_coverage` from [calibration_coverage.csv]"
                "(calibration_coverage.csv). Two frictions, three responses by a formula, measured with noise, and with"
                " a bias that the model has; hidden values drawn evenly from the range. Deviations are those of the"
                " measurement; ± is one standard error.",
                "## Whole calibrations",
                "Scatter between packings, fitted surrogates, acquisition and stopping rule.",
                markdown(head, cells(whole)),
                "## What the discrepancy's size is worth",
                "The same without surrogates. Given: normal with that standard deviation. Half-normal, half-Cauchy: the"
                " standard deviation of each response's discrepancy is unknown, of that scale, and marginalised.",
                markdown(head[:-1], [row[:-1] for row in cells(exact)]),
            ]
        )
        + "\n"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=NUMBER, help="calibrations per case")
    parser.add_argument("--output", type=Path, default=Path("docs"))
    given = parser.parse_args()
    rows = []
    for kind, scale in (("given", 0.0), ("given", 2.0), *((name, scale) for name in SCALES for scale in (1.0, 2.0))):
        for bias in BIASES:
            rows.append(
                row_of("exact", bias, EXACT, with_scale(kind, scale, bias)) | {"discrepancy": f"{kind}, {scale:g}"}
            )
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for bias, discrepancy in CASES:
            found = pool.map(one, [(bias, discrepancy, seed) for seed in range(given.number)], chunksize=2)
            means = dict(pd.DataFrame(list(found)).mean())
            rows.append(row_of("fitted", bias, given.number, means) | {"discrepancy": f"given, {discrepancy:g}"})
            print(rows[-1], flush=True)
            table = pd.DataFrame(rows)
            table.to_csv(given.output / "calibration_coverage.csv", index=False, float_format="%.4g")
            (given.output / "calibration_coverage.md").write_text(page(table), encoding="utf-8")


if __name__ == "__main__":
    main()
