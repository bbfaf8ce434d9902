"""How often the 95 % region of a calibration holds the truth: 200 calibrations by a formula, with noise and with bias.

    python -m benchmarks.calibration_coverage     # in the root of the repository: about 5 minutes on an idle core
    python -m benchmarks.calibration_coverage --number 10 --output /tmp
    python -m benchmarks.calibration_coverage --redraw    # the page from its table; only the river gravel is new

Hidden values of two frictions, drawn evenly from their range, give three responses by a formula in the solver's place.
Each is measured with its error and, in some cases, with a bias: what the formula is off by. Then all of a calibration
is done: simulations that scatter between packings, surrogates, acquisition and stopping rule. Coverage is the share of
calibrations whose region, or whose interval, holds the hidden values. Besides, what the discrepancy makes of the
example of Yan 2022, from the simulations of the page at standard, and how often a parameter that no response tells is
said to be one: the friction of a wall, looked for with and without a wall shear test. Writes calibration_coverage.csv,
calibration_told.csv and calibration_coverage.md.
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

from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.page import markdown
from bulkwear.postproc.flow.bulk_test import RESPONSES as BULK_RESPONSES
from bulkwear.postproc.inference.loop import Request, calibrate, posterior
from bulkwear.postproc.inference.posterior import FAMILY_SHARE, densest, interval
from bulkwear.postproc.inference.problem import MODEL_DISCREPANCY, Experiment, Measured, Parameter, Problem
from bulkwear.postproc.inference.told import NOT_TOLD, TOGETHER, TOLD, told_table
from bulkwear.workflows.cases.calibration.responses import (
    PARAMETER_NAMES,
    interval_table,
    parameter_name,
    read_measured,
    shares_at,
)

NUMBER = 200  # calibrations per case
LOW, HIGH = 0.1, 0.7  # of both frictions
DEVIATIONS = {"angle": 0.4, "repose": 0.9, "time": 0.1}  # degrees, degrees, s: of the measurement, Yan 2022, Table 3.1
WALL_DEVIATION = 0.5  # degrees, of the wall friction angle
SEED_SCATTER = {"angle": 0.7, "repose": 0.5, "time": 0.05, "wall_angle": 0.3}  # of a simulation, in the same units
FIT_ERROR = 0.3  # of each simulated response, over its scatter
RESPONSES = {"box": ("angle",), "draw_down": ("repose", "time"), "wall_shear": ("wall_angle",)}
TESTS = (Experiment("box", RESPONSES["box"], 8, 12), Experiment("draw_down", RESPONSES["draw_down"], 4, 8))
WALL_TEST = Experiment("wall_shear", RESPONSES["wall_shear"], 6, 8)
NAMES = ("sliding", "rolling", "wall")
BIASES = {
    "none": lambda random: np.zeros(3),
    "2 deviations, each up or down": lambda random: 2.0 * random.choice([-1.0, 1.0], 3),
    "2 deviations, all up": lambda random: np.full(3, 2.0),
}
CASES = tuple((bias, discrepancy) for bias in BIASES for discrepancy in (0.0, MODEL_DISCREPANCY))
SCALES = {"half-normal": stats.halfnorm, "half-Cauchy": stats.halfcauchy}
SIMULATIONS = "tables/calibration_standard_simulations.csv"  # in docs
GRAVEL, PUBLISHED_PAIR = Path("config/published/gravel_tests.csv"), (0.21, 0.40)  # Yan 2022, Tables 3.1 and 3.6
GRAVEL_HEAD = ["discrepancy assumed", "parameter", "recommended", "95 % interval", "left (-)", "told"]
GRAVEL_HEAD += ["posterior in pairs that fit better than (0.21, 0.40) (%)"]
SAID = (TOLD, TOGETHER, NOT_TOLD)
TOLD_HEAD = ["wall shear test", "friction", "calibrations", *SAID]
NODES = 12  # of a scale that is marginalised
GRID = 48  # points along each parameter where the surrogate is exact
EXACT = 400  # calibrations per case with exact surrogates


def responses(sliding: np.ndarray, rolling: np.ndarray, wall: float = 0.0) -> dict[str, np.ndarray]:
    """Return what bulk tests give: angles grow with both frictions and level off, time grows with sliding friction."""
    return {
        "wall_angle": np.degrees(np.arctan(wall)),
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
    simulated = np.array([responses(*values.T)[name] for name in DEVIATIONS]) / units
    random, variance = np.random.default_rng(41), 1.0 + deviations[:, None, None] ** 2
    found = []
    for _ in range(EXACT):
        hidden = random.uniform(LOW, HIGH, 2)
        exact = np.array([responses(*hidden)[name] for name in DEVIATIONS]) / units[:, 0]
        seen = exact + random.standard_normal(3) + BIASES[bias](random)
        logs = -0.5 * ((seen[:, None] - simulated) ** 2 / variance + np.log(variance))
        total = logsumexp(logs, axis=0).sum(axis=0)
        weights = np.exp(total - total.max())
        found.append(held(weights / weights.sum(), values, hidden))
    return dict(pd.DataFrame(found).mean())


# ---------------------------------------------------------------- what is told


def one_told(asked: tuple[bool, int]) -> dict[str, str]:
    """Calibrate three frictions once, with or without a wall shear test; return what is said of each."""
    wall_test, seed = asked
    random = np.random.default_rng([seed, 29])
    hidden = random.uniform(LOW, HIGH, 3)
    aims = measured(hidden, "none", MODEL_DISCREPANCY, random)
    if wall_test:
        angle = float(responses(*hidden)["wall_angle"]) + WALL_DEVIATION * random.standard_normal()
        aims["wall_angle"] = Measured(angle, WALL_DEVIATION)
    tests = (*TESTS, WALL_TEST) if wall_test else TESTS
    problem = Problem(tuple(Parameter(name, LOW, HIGH) for name in NAMES), tests, aims, seed=seed)
    table = told_table(problem, calibrate(problem, simulate).posterior)
    return dict(zip(table["parameter"], table["told"], strict=True))


def told_rates(answers: Sequence[Mapping[str, str]], wall_test: bool) -> list[dict[str, object]]:
    """Return one row per friction: the shares of calibrations that say each of the three things of it."""
    table = pd.DataFrame(answers)
    head = {"wall_shear_test": "yes" if wall_test else "no", "calibrations": len(table)}
    return [head | {"friction": name} | {each: float((table[name] == each).mean()) for each in SAID} for name in NAMES]


# ---------------------------------------------------------------- the river gravel


def of_gravel(docs: Path, discrepancy: float) -> pd.DataFrame:
    """Return intervals, what they leave of the ranges, and where the published pair lies, by simulations in docs."""
    names = ("particle.contact.sliding_friction", "particle.contact.rolling_friction")
    tests = tuple(Experiment(kind, BULK_RESPONSES[kind], 3, 3) for kind in ("shear_box", "draw_down"))
    aims = read_measured(GRAVEL, discrepancy)
    problem = Problem(tuple(Parameter(name, LOW, HIGH) for name in names), tests, aims, seed=20220317)
    keys = {name: key for key, name in PARAMETER_NAMES.items()}
    known = posterior(problem, pd.read_csv(docs / SIMULATIONS).rename(columns=keys))
    (share,) = shares_at(problem, known, np.array([PUBLISHED_PAIR]))
    table = interval_table(problem, known, {}).merge(told_table(problem, known), on="parameter")
    return table.assign(discrepancy=f"given, {discrepancy:g}", published_denser_share=share)


def told_cells(table: pd.DataFrame) -> list[list[str]]:
    """Return the rows of `told_rates` as the page shows them."""
    return [
        [
            row["wall_shear_test"],
            row["friction"],
            str(row["calibrations"]),
            *(f"{100.0 * row[each]:.1f}" for each in SAID),
        ]
        for row in table.to_dict("records")
    ]


def gravel_cells(table: pd.DataFrame) -> list[list[str]]:
    """Return the rows of such tables as the page shows them."""
    return [
        [
            *(
                row.discrepancy,
                parameter_name(row.parameter),
                f"{row.recommended:.2f}",
                f"{row.low:.2f} to {row.high:.2f}",
            ),
            *(f"{row.left:.2f}", row.told, f"{100.0 * row.published_denser_share:.1f}"),
        ]
        for row in table.itertuples()
    ]


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


def page(table: pd.DataFrame, told: pd.DataFrame, gravel: pd.DataFrame) -> str:
    """Return docs/calibration_coverage.md. told: rows of `told_rates`; gravel: tables of `of_gravel`."""
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
                "## What is said to be told",
                "Three frictions looked for, hidden values drawn evenly: how often (%) a friction is said to be told by"
                " what was measured. Without a wall shear test no response depends on the wall's.",
                markdown(TOLD_HEAD, told_cells(told)),
                "## The river gravel",
                f"What the discrepancy makes of the [simulations]({SIMULATIONS}) of the [calibration at standard]"
                "(calibration_results_standard.md), without the repeated packings. Left: of the range's 95 % interval.",
                markdown(GRAVEL_HEAD, gravel_cells(gravel)),
            ]
        )
        + "\n"
    )


def whole_table(number: int, pool: ProcessPoolExecutor) -> pd.DataFrame:
    """Return the table of all cases, with exact and with fitted surrogates."""
    rows = []
    for kind, scale in (("given", 0.0), ("given", 2.0), *((name, scale) for name in SCALES for scale in (1.0, 2.0))):
        for bias in BIASES:
            row = row_of("exact", bias, EXACT, with_scale(kind, scale, bias))
            rows.append(row | {"discrepancy": f"{kind}, {scale:g}"})
    for bias, discrepancy in CASES:
        found = pool.map(one, [(bias, discrepancy, seed) for seed in range(number)], chunksize=2)
        row = row_of("fitted", bias, number, dict(pd.DataFrame(list(found)).mean()))
        rows.append(row | {"discrepancy": f"given, {discrepancy:g}"})
        print(rows[-1], flush=True)
    return pd.DataFrame(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=at_least_one, default=NUMBER, help="calibrations per case")
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--redraw", action="store_true", help="write the page from the table of an earlier run")
    given = parser.parse_args()
    gravel = pd.concat([of_gravel(Path("docs"), size) for size in (0.0, MODEL_DISCREPANCY)])
    file, told_file = (given.output / f"calibration_{name}.csv" for name in ("coverage", "told"))
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        if not given.redraw:
            whole_table(given.number, pool).to_csv(file, index=False, float_format="%.4g")
        if not given.redraw or not told_file.is_file():
            rows: list[dict[str, object]] = []
            for wall_test in (False, True):
                asked = [(wall_test, seed) for seed in range(given.number)]
                rows += told_rates(list(pool.map(one_told, asked, chunksize=2)), wall_test)
            pd.DataFrame(rows).to_csv(told_file, index=False, float_format="%.4g")
    text = page(read_table(file), read_table(told_file, keep_default_na=False), gravel)
    file.with_suffix(".md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    command(main)
