"""Tables of a calibration: responses over the parameters, the family that fits, and what is said about pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.ndimage import gaussian_filter

from bulkwear.postproc.inference.acquisition import expected_information
from bulkwear.postproc.inference.loop import Posterior
from bulkwear.postproc.inference.posterior import FAMILY_SHARE, denser_shares, densest, interval, posterior_weights
from bulkwear.postproc.inference.problem import Measured, Problem
from bulkwear.postproc.inference.surrogate import predictions
from bulkwear.workflows.cases.calibration.charts import RESPONSES

GRID_POINTS = 41  # along each of the two parameters of a map
PICTURE_CELLS = 160  # along each of two parameters: a family is a tenth of the range wide, or less
PICTURE_POWER = 15  # 32,768 points carry the picture of a posterior of more parameters
PICTURE_BINS = 40  # along each of these
RECOMMENDED = "recommended"  # name of the pair that a calibration found
FOUND_FIRST = "found_first"  # of the one that its simulations led to before any pair was repeated
RESPONSE_NAMES = {name: axis.label for name, axis in RESPONSES.items()}
PARAMETER_NAMES = {
    "particle.contact.sliding_friction": "Sliding friction, particles (-)",
    "particle.contact.rolling_friction": "Rolling friction, particles (-)",
    "particle.contact.restitution": "Restitution, particles (-)",
    "wall_material.contact.sliding_friction": "Sliding friction, wall (-)",
    "wall_material.contact.rolling_friction": "Rolling friction, wall (-)",
}
BAND = 1.0  # -, standard deviations of the measurement: what counts as inside its band


def response_name(response: str) -> str:
    """Return a response as figures and tables show it."""
    return RESPONSE_NAMES.get(response, response.replace("_", " "))


def parameter_name(parameter: str) -> str:
    """Return a parameter as figures and tables show it."""
    return PARAMETER_NAMES.get(parameter, parameter.rpartition(".")[2].replace("_", " "))


def read_measured(path: str | Path, model_discrepancy: float) -> dict[str, Measured]:
    """Return the measured responses of a table with the columns response, value, deviation.

    model_discrepancy: -, of the model over a measurement's deviation; a column model_discrepancy, in the response's
    unit, takes its place in the rows that have a value there
    """
    table = pd.read_csv(path)
    given = table.get("model_discrepancy", pd.Series(np.nan, table.index))
    own = given.fillna(model_discrepancy * table["deviation"])
    rows = zip(table["response"], table["value"], table["deviation"], own, strict=True)
    return {name: Measured(float(value), float(deviation), float(off)) for name, value, deviation, off in rows}


def response_grid(problem: Problem, known: Posterior) -> pd.DataFrame:
    """Return the responses over a grid of the first two parameters, the others at their recommended values.

    Columns: the parameters; per response its mean and `<response>_doubt`, the surrogate's standard deviation.
    """
    line = np.linspace(0.0, 1.0, GRID_POINTS)
    points = np.tile(known.points[known.recommended], (GRID_POINTS**2, 1))
    points[:, :2] = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    table = pd.DataFrame(problem.from_unit(points), columns=problem.names)
    for name, surrogate in known.surrogates.items():
        mean, variance = surrogate.predict(points)
        table[name], table[f"{name}_doubt"] = mean, np.sqrt(variance)
    return table


def family_table(problem: Problem, known: Posterior) -> pd.DataFrame:
    """Return the posterior on bins of every two parameters: first, second, their values, density over its largest, and
    denser_share, the share of the posterior in denser bins (at most 0.95 in the family).

    Of two parameters it is evaluated in the middle of each bin, of more gathered in wider bins and smoothed.
    """
    if len(problem.names) == 2:
        middles = (np.arange(PICTURE_CELLS) + 0.5) / PICTURE_CELLS
        density = _density_at(problem, known, np.stack(np.meshgrid(middles, middles, indexing="ij"), -1).reshape(-1, 2))
        ends = [(each.low, each.high) for each in problem.parameters]
        values = [low + (high - low) * middles for low, high in ends]
        return _binned(problem.names, values, density.reshape(PICTURE_CELLS, -1))
    points = problem.spread_points(PICTURE_POWER)
    weights, values, tables = _density_at(problem, known, points), problem.from_unit(points), []
    for i, j in combinations(range(len(problem.names)), 2):
        ranges = [(problem.parameters[k].low, problem.parameters[k].high) for k in (i, j)]
        counts, *edges = np.histogram2d(values[:, i], values[:, j], PICTURE_BINS, ranges, weights=weights)
        density = gaussian_filter(counts, 0.7, mode="nearest")
        names = [problem.names[k] for k in (i, j)]
        tables.append(_binned(names, [(edge[1:] + edge[:-1]) / 2.0 for edge in edges], density))
    return pd.concat(tables, ignore_index=True)


def _density_at(problem: Problem, known: Posterior, points: np.ndarray) -> np.ndarray:
    """Return the weights (n,) of points (n, p) of the unit cube by the surrogates of a posterior."""
    return posterior_weights(predictions(known.surrogates, points), problem.measured)


def _binned(names: Sequence[str], middles: Sequence[np.ndarray], density: np.ndarray) -> pd.DataFrame:
    """Return the rows of two parameters; middles: of the bins along each, density: (bins, bins)."""
    x, y = np.meshgrid(*middles, indexing="ij")
    return pd.DataFrame(
        {
            "first": names[0],
            "second": names[1],
            "first_value": x.ravel(),
            "second_value": y.ravel(),
            "density": (density / density.max()).ravel(),
            "denser_share": _denser_share(density).ravel(),
        }
    )


def _denser_share(density: np.ndarray) -> np.ndarray:
    """Return for every bin the share of all that lies in denser bins."""
    flat = density.ravel()
    order = np.argsort(flat)[::-1]
    before = np.concatenate([[0.0], np.cumsum(flat[order])[:-1]]) / flat.sum()
    shares = np.empty_like(flat)
    shares[order] = before
    return shares.reshape(density.shape)


def interval_table(problem: Problem, known: Posterior, compared: Mapping[str, float]) -> pd.DataFrame:
    """Return one row per parameter: its range, the recommended value, the interval with 95 % of the posterior, and the
    value of the pair that ours is compared with."""
    values = problem.from_unit(known.points)
    rows = []
    for column, parameter in enumerate(problem.parameters):
        low, high = interval(values[:, column], known.weights)
        rows.append(
            {
                "parameter": parameter.name,
                "searched_from": parameter.low,
                "searched_to": parameter.high,
                "recommended": values[known.recommended, column],
                "low": low,
                "high": high,
                "compared": compared.get(parameter.name, np.nan),
            }
        )
    return pd.DataFrame(rows)


def statement_table(
    problem: Problem, known: Posterior, repeats: pd.DataFrame, pairs: Mapping[str, Mapping[str, float]]
) -> pd.DataFrame:
    """Return one row per pair and response: what was measured, simulated and predicted, and how far apart they are.

    repeats: as from `repeat_table`. deviations: simulated minus measured, over the measured standard deviation; inside:
    at most one of these, or closer than the standard uncertainty of the simulated mean; denser_share: of the posterior
    in pairs that fit better, at most 0.95 in the family, NaN of a pair outside of the range that was searched.
    """
    rows = []
    for pair, values in pairs.items():
        point = np.array([[values[name] for name in problem.names]])
        (share,) = shares_at(problem, known, point) if is_searched(problem, point)[0] else (np.nan,)
        for name, (mean, variance) in predictions(known.surrogates, problem.to_unit(point)).items():
            found = repeats[(repeats["pair"] == pair) & (repeats["response"] == name)]
            aim = problem.measured.get(name)
            simulated = float(found["mean"].iloc[0]) if len(found) else np.nan
            uncertainty = float(found["uncertainty"].iloc[0]) if len(found) else np.nan
            rows.append(
                {
                    "pair": pair,
                    **values,
                    "response": name,
                    "measured": aim.value if aim else np.nan,
                    "measured_deviation": aim.deviation if aim else np.nan,
                    "simulated": simulated,
                    "simulated_uncertainty": uncertainty,
                    "between_seeds": float(found["deviation"].iloc[0]) if len(found) else np.nan,
                    "seeds": int(found["seeds"].iloc[0]) if len(found) else 0,
                    "predicted": float(mean[0]),
                    "predicted_deviation": float(np.sqrt(variance[0])),
                    "deviations": (simulated - aim.value) / aim.deviation if aim else np.nan,
                    "inside": _inside(simulated, uncertainty, aim) if aim else "",
                    "denser_share": share,
                }
            )
    return pd.DataFrame(rows)


def _inside(simulated: float, uncertainty: float, aim: Measured) -> str:
    """Return inside, within uncertainty, outside, or not simulated."""
    if np.isnan(simulated):
        return "not simulated"
    away = abs(simulated - aim.value)
    if away <= BAND * aim.deviation:
        return "inside"
    return "within its uncertainty" if away <= BAND * np.hypot(aim.deviation, uncertainty) else "outside"


def is_searched(problem: Problem, pairs: np.ndarray) -> np.ndarray:
    """Return which (k,) of some pairs lie in the range that was searched; pairs: (k, p) values of the parameters."""
    points = problem.to_unit(pairs)
    return ((points >= 0.0) & (points <= 1.0)).all(axis=1)


def shares_at(problem: Problem, known: Posterior, pairs: np.ndarray) -> np.ndarray:
    """Return the share (k,) of the posterior in points denser than k pairs; pairs: (k, p) values of the parameters."""
    at = predictions(known.surrogates, problem.to_unit(pairs))
    return denser_shares(known.weights, known.predicted, problem.measured, at)


def repeat_table(repeats: pd.DataFrame, responses: Sequence[str]) -> pd.DataFrame:
    """Return mean and scatter between seeds of every response and pair.

    repeats: a row per simulation with pair and responses. Columns: pair, response, seeds, mean, deviation (between
    seeds; NaN with one), uncertainty (of the mean: a single one's is at least that of its measurement).
    """
    rows = []
    for pair, table in repeats.groupby("pair", sort=False):
        for name in (name for name in responses if name in table and table[name].notna().any()):
            known = table[table[name].notna()]
            values, several = known[name].to_numpy(float), len(known) > 1
            deviation = float(np.std(values, ddof=1)) if several else np.nan
            single = float(known[f"{name}_uncertainty"].mean())
            uncertainty = max(deviation, single) / np.sqrt(len(values)) if several else single
            head = {"pair": pair, "response": name, "seeds": len(values), "mean": float(values.mean())}
            rows.append(head | {"deviation": deviation, "uncertainty": float(uncertainty)})
    return pd.DataFrame(rows, columns=["pair", "response", "seeds", "mean", "deviation", "uncertainty"])


def with_bands(repeats: pd.DataFrame, measured: Mapping[str, Measured]) -> pd.DataFrame:
    """Return a table as from `repeat_table` with measured, measured_deviation, deviations and inside, as in
    `statement_table`; only the responses that were measured."""
    table = repeats[repeats["response"].isin(measured)].reset_index(drop=True)
    aims = [measured[name] for name in table["response"]]
    table["measured"], table["measured_deviation"] = [aim.value for aim in aims], [aim.deviation for aim in aims]
    table["deviations"] = (table["mean"] - table["measured"]) / table["measured_deviation"]
    each = zip(table["mean"], table["uncertainty"], aims, strict=True)
    table["inside"] = [_inside(mean, uncertainty, aim) for mean, uncertainty, aim in each]
    return table


def information_table(problem: Problem, known: Posterior) -> pd.DataFrame:
    """Return one row per measured response: the bits that measuring it once more is expected to tell about the
    parameters, and its spread over the family, in the response's unit and in standard deviations of its measurement."""
    bits = expected_information(known.weights, known.predicted, problem.measured, problem.seed)
    family = densest(known.weights, FAMILY_SHARE)
    rows = []
    for name, value in bits.items():
        mean = known.predicted[name][0][family]
        spread = float(np.ptp(mean))
        rows.append(
            {
                "response": name,
                "information_bits": value,
                "spread_over_family": spread,
                "spread_in_deviations": spread / problem.measured[name].deviation,
            }
        )
    return pd.DataFrame(rows).sort_values("information_bits", ascending=False, ignore_index=True)
