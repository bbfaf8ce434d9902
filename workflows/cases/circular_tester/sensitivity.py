"""What the source does not tell of its tester, varied: which published numbers each setting reaches together.

A setting is a pair of a plain and a patterned run in one machine: that of series `volume`, the reference, and those of
series `varied`. Numbers are taken packing by packing; what is published of them are the claims `tester_sensitivity` of
config/published/verdicts.yaml.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.workflows.cases.circular_tester.runs import VARIED, TesterRun, pairs_of
from bulkwear.workflows.report.text import range_text

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.postproc.statistics.verdicts import Claim
    from bulkwear.workflows.config.design import Study

REFERENCE = "reference"  # the pair of series `volume`
# What may be varied: path in the parameters, and what a value is multiplied by. The consolidator's level is the bed's.
FACTORS = {
    "friction of the sample": (("sample_material", "contact", "sliding_friction"), 1.0),
    "rolling friction of the sample": (("sample_material", "contact", "rolling_friction"), 1.0),
    "rolling model": (("solver", "rolling_friction"), None),
    "height of the bed, mm": (("tester", "bed_height_m"), 1e3),
    "depth of the sample, mm": (("tester", "depth_m"), 1e3),
    "thickness of the sample, mm": (("sample", "thickness_m"), 1e3),
    "incline of the sample, degrees": (("tester", "incline_rad"), 180.0 / np.pi),
    "particle scale": (("particle", "scale"), 1.0),
    "shape of the machine": (("tester", "shape"), None),
    "size of elements, mm": (("sample", "element_size_m"), 1e3),
    "wear coefficient, 1/Pa": (("wear", "accelerated_wear_coefficient_per_pa"), 1.0),
    "patch radius, mm": (("wear", "patch_radius_m"), 1e3),
    "largest step of an update, edges": (("wear", "largest_step_edge_fraction"), 1.0),
    "revolutions": (("sliding", "revolutions"), 1.0),
    "wear cycles per revolution": (("sliding", "cycles_per_revolution"), 1.0),
}
LABORATORY_HOURS = (56, 184)  # after which the laboratory's samples were weighed
NO_VALUE = "none"  # of a setting that a run does not use


def settings_of_pairs(study: Study) -> dict[str, dict[str, str]]:
    """Return {pair: {factor: value in words}} of the reference and of all pairs of series `varied`."""
    series = {row["row"]: (row["series"], row.get("pair")) for row in study.design_rows}
    found: dict[str, dict[str, str]] = {}
    for run in study.runs:
        of, pair = series[run.row]
        if of not in ("volume", VARIED):
            continue
        name = pair if of == VARIED else REFERENCE
        found.setdefault(name, {factor: _told(run.parameters, *how) for factor, how in FACTORS.items()})
    return found


def _told(parameters: Mapping[str, Any], path: Sequence[str], factor: float | None) -> str:
    value: Any = parameters
    for key in path:
        value = value.get(key, {})
    if value == {}:
        return NO_VALUE
    return str(value) if factor is None else f"{factor * value:.4g}"


def changes_of(settings: Mapping[str, Mapping[str, str]]) -> dict[str, dict[str, str]]:
    """Return {pair: {factor: value}} of what differs from the reference, which has none itself."""
    usual = settings[REFERENCE]
    return {pair: {name: each for name, each in own.items() if each != usual[name]} for pair, own in settings.items()}


def pairs_by_setting(runs: Sequence[TesterRun]) -> dict[str, list[tuple[TesterRun, TesterRun]]]:
    """Return {pair: [(patterned, plain) of every packing]}, the reference first; pairs that lack one are left out."""
    found = {REFERENCE: pairs_of(runs)}
    varied = [run for run in runs if run.series == VARIED]
    for name in dict.fromkeys(run.pair for run in varied):
        try:
            found[name] = pairs_of([run for run in varied if run.pair == name], VARIED)
        except ValueError:
            continue
    return found


def numbers_of_pair(patterned: TesterRun, plain: TesterRun, published: pd.DataFrame) -> dict[str, float]:
    """Return {key of a claim: value in its unit} of a packing of a setting, those that its revolutions reach.

    published: as config/published/circular_tester.csv
    """
    found = {
        **_of_volumes(patterned, plain, published),
        **_of_flow(patterned, plain),
        **_of_places(patterned, plain, published),
    }
    return {key: value for key, value in found.items() if not np.isnan(value)}


def _of_volumes(patterned: TesterRun, plain: TesterRun, published: pd.DataFrame) -> dict[str, float]:
    """Volumes (mm3) at the source's wear coefficient, of the plain sample per revolution, of the convex one in the
    first; their ratio, the convex one's at the laboratory's volumes of the plain one, and how far contacts slide over
    how far the trough goes.
    """
    import pandas as pd

    from bulkwear.postproc.tables.summary import run_summary
    from bulkwear.workflows.cases.circular_tester.hours import revolution_of
    from bulkwear.workflows.cases.circular_tester.key_numbers import sliding_over_travel
    from bulkwear.workflows.cases.circular_tester.volume import shared_revolutions, times_source, volumes, volumes_at

    lost = volumes([patterned, plain])
    last, times = shared_revolutions(lost), times_source(plain.coefficient, published)
    convex, bare = (lost[lost["run"] == run.name] for run in (patterned, plain))
    of_convex, of_bare = (float(volumes_at(rows, last).iloc[0]) for rows in (convex, bare))
    summary = run_summary(pd.read_csv(plain.folder / "wear.csv"))
    return {
        "plain_volume": of_bare / last / times,
        "convex_volume": float(volumes_at(convex, 1.0).iloc[0]) / times,
        "loss_ratio": of_convex / of_bare,
        **{
            f"convex_volume_{hours}_h": float(volumes_at(convex, revolution_of(bare, volume)).iloc[0])
            for hours in LABORATORY_HOURS
            for volume in [_measured(published, f"plain_volume_{hours}_h")]
        },
        "plain_slip": float(sliding_over_travel(summary)),
    }


def _measured(published: pd.DataFrame, quantity: str) -> float:
    from bulkwear.postproc.tables.summary import published_value

    return published_value(published, quantity, "laboratory")


def _of_flow(patterned: TesterRun, plain: TesterRun) -> dict[str, float]:
    """Normal force (N), spin (deg/s) and velocity (mm/s) of the lowest layer: mean, or of the first revolution."""
    from bulkwear.workflows.cases.circular_tester.flow import FORCE, SPIN, VELOCITY, flow_means, series_of

    means = {run.name: flow_means(series_of(run)) for run in (patterned, plain)}

    def of(run: TesterRun, measure: str, last: float = np.inf) -> float:
        rows = means[run.name]
        return float(rows[(rows["measure"] == measure) & (rows["revolution"] <= last)]["mean"].mean())

    return {
        "plain_force": of(plain, FORCE),
        "convex_force": of(patterned, FORCE, last=1),
        "plain_spin": float(np.degrees(of(plain, SPIN))),
        "convex_spin": float(np.degrees(of(patterned, SPIN, last=1))),
        "plain_velocity": 1e3 * of(plain, VELOCITY),
        "convex_velocity": 1e3 * of(patterned, VELOCITY),
    }


def _of_places(patterned: TesterRun, plain: TesterRun, published: pd.DataFrame) -> dict[str, float]:
    """Where it wears: columns, pattern, force on the first column, largest losses of bumps (mm) when the sample has
    lost what the laboratory's had after the long test.
    """
    from bulkwear.workflows.cases.circular_tester import distribution

    _, worn = distribution.surfaces_alike([patterned, plain])
    borders = distribution.borders_of(patterned)
    columns = distribution.wear_by_column(worn, borders).assign(total=lambda rows: rows["base_mm3"] + rows["bumps_mm3"])
    of = {run.name: columns[columns["run"] == run.name].set_index("column") for run in (patterned, plain)}
    total, bare = of[patterned.name]["total"], of[plain.name]["total"]
    first = distribution.mean_force_by_column(patterned, borders).set_index("column").loc[1]
    measured = _measured(published, f"convex_volume_{LABORATORY_HOURS[-1]}_h")
    losses = distribution.losses_at_volume(patterned, measured, distribution.SHOWN_BUMPS)
    return {
        "plain_columns": float(bare.iloc[-1] / bare.iloc[0]),
        "first_column": float(total.iloc[0] / total.mean()),
        "first_column_force": 100.0 * float(first["bumps_N"] / (first["bumps_N"] + first["base_N"])),
        "bump_share": 100.0 * float(of[patterned.name]["bumps_mm3"].sum() / total.sum()),
        **{f"loss_{bump}": float(loss) for bump, loss in losses.items()},
    }


def sensitivity_table(
    numbers: Mapping[str, Sequence[Mapping[str, float]]], claims: Mapping[str, Claim]
) -> pd.DataFrame:
    """Return a row per setting and claim.

    Columns: pair, key, quantity, unit, published (in words), published_low and published_high (the magnitude, NaN of a
    direction alone), value (mean over packings), packings, interval_low, interval_high, over (-, value over the nearest
    value that agrees, 1 where it does itself), reached (whether it agrees), verdict, reason, source.

    numbers: by pair, those of each packing; a claim has no row of pairs that have no number of it. One packing has a
    value and no verdict: reached is then of that packing.
    """
    import pandas as pd

    from bulkwear.postproc.statistics.intervals import estimate
    from bulkwear.postproc.statistics.verdicts import judged

    rows = []
    for pair, packings in numbers.items():
        for key, claim in claims.items():
            if not (values := [each[key] for each in packings if key in each]):
                continue
            found = estimate(values, log=True)
            verdict, (low, high) = judged(claim, found), found.interval()
            nearest = float(np.clip(found.value, *claim.region))
            row = {"pair": pair, "key": key, "quantity": claim.finding, "unit": claim.unit, "published": claim.words}
            row |= dict(zip(("published_low", "published_high"), claim.magnitude or (np.nan, np.nan), strict=True))
            row |= {"value": found.value, "packings": found.packings, "interval_low": low, "interval_high": high}
            row |= {"over": found.value / nearest, "reached": bool(nearest == found.value)}
            rows.append(row | {"verdict": verdict.verdict, "reason": verdict.reason, "source": claim.source})
    return pd.DataFrame(rows)


def numbers_table(numbers: Sequence[Mapping[str, float]], claims: Mapping[str, Claim]) -> pd.DataFrame:
    """Return finding, claim, found, verdict, reason, factor and source, a row per claim that a packing has a number of.

    numbers: of each packing of one setting
    """
    import pandas as pd

    from bulkwear.postproc.statistics.intervals import estimate
    from bulkwear.postproc.statistics.verdicts import judged

    rows = []
    for key, claim in claims.items():
        values = [each[key] for each in numbers if key in each]
        if values:
            found = estimate(values, log=True)
            told = judged(claim, found, found.text(unit="" if claim.unit == "-" else claim.unit))
            said = {"found": told.found, "verdict": told.verdict, "reason": told.reason, "factor": told.factor}
            rows.append({"finding": claim.finding, "claim": claim.words, **said, "source": claim.source})
    return pd.DataFrame(rows, columns=["finding", "claim", "found", "verdict", "reason", "factor", "source"])


def effects_table(table: pd.DataFrame, changes: Mapping[str, Mapping[str, str]]) -> pd.DataFrame:
    """Return what each change does to each number: key, quantity, change, factor (-, with the change over without), and
    its 95 % interval, low and high, from how far the settings are off a product of such factors.

    table: as from `sensitivity_table`; changes: as from `changes_of`. Least squares of the logarithm over all settings
    that have the number, each once. Nothing where these cannot tell the changes apart.
    """
    import pandas as pd

    from bulkwear.postproc.statistics.intervals import CONFIDENCE, students_t

    columns, rows = ["key", "quantity", "change", "factor", "low", "high"], []
    for key, of in table.groupby("key", sort=False):
        pairs, logarithms = list(of["pair"]), np.log(of["value"].to_numpy(float))
        named = list(dict.fromkeys((name, value) for pair in pairs for name, value in changes[pair].items()))
        design = np.array([[1.0, *(changes[pair].get(name) == value for name, value in named)] for pair in pairs])
        freedom = len(pairs) - design.shape[1]
        if np.linalg.matrix_rank(design) < design.shape[1]:
            continue
        inverse = np.linalg.pinv(design)
        found = inverse @ logarithms
        error = np.full(len(found), np.nan)
        if freedom > 0:
            scatter = np.sum((logarithms - design @ found) ** 2) / freedom
            error = students_t(0.5 + 0.5 * CONFIDENCE, freedom) * np.sqrt(scatter * np.sum(inverse**2, axis=1))
        for (name, value), middle, reach in zip(named, found[1:], error[1:], strict=True):
            ends = np.exp([middle, middle - reach, middle + reach])
            rows.append((key, of["quantity"].iloc[0], change_words(name, value), *ends))
    return pd.DataFrame(rows, columns=columns)


def sentences(table: pd.DataFrame, changes: Mapping[str, Mapping[str, str]], claims: Mapping[str, Claim]) -> list[str]:
    """Return how many published numbers the settings with most of them reach, which are out of reach of all, which
    have no value, and what is left of the factor in the plain volume.
    """
    counts = table.groupby("pair", sort=False)["reached"].agg(["sum", "size"])
    best, usual = most_reached(counts["sum"]), counts.loc[REFERENCE]
    settings = "; ".join(words_of(changes[pair]) for pair in best)
    left = [_plain_volume(table, pair) for pair in best]
    of_all = table.groupby("key", sort=False).agg(quantity=("quantity", "first"), reached=("reached", "any"))
    missed = "; ".join(of_all.loc[~of_all["reached"], "quantity"])
    without = "; ".join(claim.finding for key, claim in claims.items() if key not in of_all.index)
    return [
        f"The reference reaches {usual['sum']} of {usual['size']} published numbers; most, {counts['sum'].max()}, are"
        f" reached by {len(best)} of {len(counts)} settings ({settings}).",
        f"The source's plain sample loses {_plain_volume(table, REFERENCE):.3g} times what ours does in the reference,"
        f" and {range_text(left, 3)} times where most is reached.",
        f"Reached by no setting: {missed or 'none'}.",
        *([f"Without a value, as these samples lose too little or lack the place: {without}."] if without else []),
    ]


def most_reached(counts: pd.Series) -> list[str]:
    """Return the settings that reach most published numbers; counts: of each."""
    return [str(pair) for pair in counts.index[counts == counts.max()]]


def words_of(changes: Mapping[str, str]) -> str:
    """Return the changes of a setting in words."""
    return ", ".join(change_words(*change) for change in changes.items()) or REFERENCE


def change_words(factor: str, value: str) -> str:
    """Return a factor and its value in words, its unit last."""
    name, _, unit = factor.partition(", ")
    unit = "" if value == NO_VALUE else unit
    return " ".join(filter(None, (name, value, unit)))


def _plain_volume(table: pd.DataFrame, pair: str) -> float:
    """Return the published plain volume over ours."""
    row = table[(table["pair"] == pair) & (table["key"] == "plain_volume")].iloc[0]
    return float(row["published_low"] / row["value"])
