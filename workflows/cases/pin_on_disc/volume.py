"""Volume worn by a pin on a disc, by revolution and by size: how it grows, and what exceeds alpha F L."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import read_surface
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MILLIMETRES
from bulkwear.postproc.tables.summary import published_value, totals_of_runs
from bulkwear.workflows.cases.pin_on_disc.runs import (
    COEFFICIENT_TOLERANCE,
    SCHEMES,
    as_tested,
    same_coefficient,
    source_conditions,
    whole_revolutions,
)

if TYPE_CHECKING:
    from bulkwear.postproc.statistics.increments import RateTrend

VOLUMES = {
    "removed": "removed_volume_m3",
    "Eq 5.9": "centroid_path_volume_m3",
    "Eq 5.9, touched": "touched_centroid_path_volume_m3",
    "alpha W": "worn_volume_m3",
}
SUMMED = ("centroid_path_volume_m3", "touched_centroid_path_volume_m3")  # per cycle in wear.csv
PERCENT = 100.0
LARGEST_CHANGE = 0.1  # -, of what a revolution adds over a run that still counts as linear growth
LINEAR, FASTER, SLOWER, UNSAID = "linear", "faster than linear", "slower than linear", "cannot be said"
QUADRATIC = "quadratic_mm3_per_revolution2"
TREND = [
    *("run", "scheme", "wear_coefficient_per_pa", "volume", "revolutions", "linear_mm3_per_revolution", QUADRATIC),
    *(f"{end}_{QUADRATIC}" for end in ("least", "largest")),
    *("change_percent", "least_change_percent", "largest_change_percent", "growth"),
]
CONSERVING = "conserving"  # its patch moves triangles that nothing touches: Eq 5.9 can only be summed over all
FIXED = ("wear_coefficient_per_pa", "load_n", "track_radius_m")  # of a run
AVERAGED = ("mean_normal_force_N", "mean_vertical_force_N", "contacts_per_step")
# what a published volume over alpha F L is made of, in the order in which the factors build on one another
CANDIDATES = {
    "force_rise": "summed normal force over load",
    "slip": "path of the contact point over the track",
    "taken_up": "wear taken up, the rest is carried",
    "displacement_rule": "displacement rule",
    "summing_rule": "Eq 5.9 over touched triangles",
}


def summary_table(
    design: str | Path,
    wear_files: Sequence[str | Path],
    pristine: Sequence[str | Path],
    worn: Sequence[str | Path],
) -> pd.DataFrame:
    """Return the totals of every run of a pin on a disc beside what should come out.

    design: has columns wear_coefficient_per_pa, load_n and sliding_distance_m; pristine, worn: surfaces of the runs

    Columns more: `alpha_F_L_volume_m3`, coefficient times load times distance (Archard 1953); `excess_volume_m3`, taken
    off beyond what the law asks; `removed_volume_m3`, pristine less worn volume; `mean_vertical_force_N`, contacts.
    """
    from bulkwear.postproc.wear.balance import lost_volume  # slow to import, and every start reads the page

    table = totals_of_runs(design, wear_files)
    wear = [pd.read_csv(path) for path in wear_files]
    lost = [
        lost_volume(read_surface(before), read_surface(after))[0] for before, after in zip(pristine, worn, strict=True)
    ]
    return table.assign(
        alpha_F_L_volume_m3=table["wear_coefficient_per_pa"] * table["load_n"] * table["sliding_distance_m"],
        excess_volume_m3=[rows["excess_volume_m3"].sum() for rows in wear],
        centroid_path_volume_m3=[rows["centroid_path_volume_m3"].sum() for rows in wear],
        touched_centroid_path_volume_m3=[rows["touched_centroid_path_volume_m3"].sum() for rows in wear],
        removed_volume_m3=lost,
        mean_vertical_force_N=[rows["mean_vertical_force_N"].mean() for rows in wear],
        most_contacts_per_step=[rows["contacts_per_step"].max() for rows in wear],
    )


def volumes_of_run(folder: str | Path) -> pd.DataFrame:
    """Volumes and forces of a run after each whole revolution, from its wear.csv.

    folder : of the run. Columns: revolution, worn_volume_m3 (alpha W), removed_volume_m3, carried_volume_m3,
    centroid_path_volume_m3 (Eq 5.9 over all triangles), touched_centroid_path_volume_m3 (over those in contact during
    the update), step_demand (largest so far, of a step over its cap) and, averaged over all cycles so far, those of
    AVERAGED.
    """
    wear = pd.read_csv(Path(folder) / "wear.csv")
    duration = np.diff(wear["time_s"], prepend=0.0)
    means = {name: np.cumsum(wear[name] * duration) / np.cumsum(duration) for name in AVERAGED}
    table = pd.DataFrame(
        {
            "revolution": wear["revolution"],
            "worn_volume_m3": wear["total_worn_volume_m3"],
            "removed_volume_m3": wear["total_applied_volume_m3"],
            "carried_volume_m3": wear["carried_volume_m3"],
            **{name: wear[name].cumsum() for name in SUMMED},
            "step_demand": wear["step_demand"].cummax(),
            **means,
        }
    )
    return whole_revolutions(table).reset_index(drop=True)


def law_volume(coefficient: float, load: float, track_radius: float, revolutions: np.ndarray) -> np.ndarray:
    """Volume alpha F L (m3) of a load (N) that slides over whole circles; coefficient 1/Pa, track_radius m.

    Source: J. F. Archard, J. Appl. Phys. 24 (1953) 981.
    """
    return coefficient * load * 2.0 * np.pi * track_radius * np.asarray(revolutions, dtype=float)


def volume_trends(volumes: pd.DataFrame) -> pd.DataFrame:
    """How the volume of every run grows: the trend of what each revolution adds, one row per run and volume.

    volumes : `run`, `scheme`, `wear_coefficient_per_pa` and as from `volumes_of_run`. A fit of the volumes themselves
    would take sums for independent values; increments are tested, see `postproc.statistics.increments`. Columns: those
    of TREND. The linear and quadratic term are those of the volume over revolutions, as in the published table;
    change: of the increment over the run, by a straight line, over its mean; intervals at 95 %, of this run: what is
    simulated once says nothing of other discs. growth: LINEAR (the change is within LARGEST_CHANGE for sure), FASTER,
    SLOWER (its interval is on one side of 0, and it is not LINEAR) or UNSAID.
    """
    rows = []
    for (run, scheme, coefficient), of_run in volumes.groupby(["run", "scheme", "wear_coefficient_per_pa"], sort=False):
        for volume in VOLUMES:
            trend, last = volume_trend(of_run, volume), of_run["revolution"].max()
            start = trend.rate.value - 0.5 * last * trend.slope.value
            terms = (start, trend.quadratic.value, *trend.quadratic.interval())
            change = (PERCENT * each for each in (trend.change.value, *trend.change.interval()))
            rows.append((run, scheme, coefficient, volume, last, *terms, *change, growth(trend)))
    return pd.DataFrame(rows, columns=TREND)


def volume_trend(of_run: pd.DataFrame, volume: str) -> RateTrend:
    """Trend of one of VOLUMES (mm3) of a run over its whole revolutions, from none at revolution 0 on."""
    from bulkwear.postproc.statistics.increments import blocks_of, rate_trend  # slow to import, see `run_in`

    ordered = of_run.sort_values("revolution")
    found = CUBIC_MILLIMETRES * ordered[VOLUMES[volume]].to_numpy(float)
    return rate_trend(blocks_of(np.append(0.0, ordered["revolution"]), np.append(0.0, found)))


def growth(trend: RateTrend) -> str:
    """LINEAR, FASTER, SLOWER or UNSAID, see `volume_trends`."""
    if trend.constant_within(LARGEST_CHANGE):
        return LINEAR
    if not trend.curved:
        return UNSAID
    return FASTER if trend.change.value > 0.0 else SLOWER


def trend_words(row: Any) -> str:
    """A row of `volume_trends` in words: the interval of how what a revolution adds changes over the run."""
    if np.isnan(row.least_change_percent):
        return f"{row.change_percent:+.1f} %, scatter unknown"
    return f"{row.least_change_percent:+.1f} to {row.largest_change_percent:+.1f} %"


def published_volume(published: pd.DataFrame, coefficient: float, revolutions: np.ndarray) -> np.ndarray:
    """Volume (m3) by the published fit (Yan 2022, Eq 5.11-5.15) of a wear coefficient (1/Pa); NaN without one.

    published : `wear_coefficient_per_pa`, `constant_mm3`, `linear_mm3_per_revolution`, `quadratic_mm3_per_revolution2`.
    """
    x = np.asarray(revolutions, dtype=float)
    same = np.isclose(published["wear_coefficient_per_pa"], coefficient, rtol=COEFFICIENT_TOLERANCE, atol=0.0)
    if not same.any():
        return np.full_like(x, np.nan)
    fit = published[same].iloc[0]
    terms = (fit["constant_mm3"], fit["linear_mm3_per_revolution"], fit["quadratic_mm3_per_revolution2"])
    return np.polynomial.polynomial.polyval(x, terms) / CUBIC_MILLIMETRES


def beside_laws(volumes: pd.DataFrame, fits: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Volumes of runs with law_volume_m3, alpha F L, and published_volume_m3, by the source's fits, NaN of runs of
    another load or track.

    Arguments as for `excess_factors`.
    """
    parts = []
    for (coefficient, load, track), rows in volumes.groupby(list(FIXED), sort=False):
        theirs = published_volume(fits, coefficient, rows["revolution"].to_numpy())
        beside = np.where(as_tested(rows, published), theirs, np.nan)
        law = law_volume(coefficient, load, track, rows["revolution"])
        parts.append(rows.assign(law_volume_m3=law, published_volume_m3=beside))
    return pd.concat(parts).sort_index()


def excess_factors(volumes: pd.DataFrame, fits: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """What a volume over alpha F L is made of, per run and whole revolution, all summed since the start.

    volumes : as from `volumes_of_run` with `run`, `scheme`, `wear_coefficient_per_pa`, `load_n`, `track_radius_m`.
    The factors of CANDIDATES build on one another: their product is the volume by Eq 5.9, summed over the triangles in
    contact (of a conserving run over all), over alpha F L, exactly. `unexplained` is the published volume over alpha
    F L, with the load and the track that it is of, over that product. fits : published volumes; published : values of
    the source. Beside stand `summing_over_all`, the last factor if Eq 5.9 is summed over all triangles, and
    `contacts`, the factor that would come of it if every contact were charged with the whole load.
    """
    parts, theirs = [], source_conditions(published)
    for _, row in volumes.groupby("run", sort=False):
        coefficient, load, track = (row[name].iloc[0] for name in FIXED)
        law = law_volume(coefficient, load, track, row["revolution"])
        rise = row["mean_normal_force_N"] / load
        taken_up = row["worn_volume_m3"] - row["carried_volume_m3"]
        table = row[["run", "scheme", "wear_coefficient_per_pa", "revolution"]].assign(
            force_rise=rise,
            slip=row["worn_volume_m3"] / law / rise,
            taken_up=taken_up / row["worn_volume_m3"],
            displacement_rule=row["removed_volume_m3"] / taken_up,
            summing_rule=row[SUMMED[row["scheme"].iloc[0] != CONSERVING]] / row["removed_volume_m3"],
            summing_over_all=row["centroid_path_volume_m3"] / row["removed_volume_m3"],
            contacts=row["contacts_per_step"],
            vertical_force_over_load=row["mean_vertical_force_N"].abs() / load,
            published=published_volume(fits, coefficient, row["revolution"].to_numpy())
            / law_volume(coefficient, *theirs, row["revolution"]),
        )
        product = table[list(CANDIDATES)].prod(axis=1, skipna=False)
        parts.append(table.assign(product=product, unexplained=table["published"] / product))
    return pd.concat(parts, ignore_index=True)


def groove_volume(depth: float, width: float, track_radius: float) -> float:
    """Volume (m3) of a shallow round groove along a whole track: two thirds of depth times width, times its length.

    All in m. Two thirds is the segment of a circle whose radius is large against the depth. It says what a published
    depth and width hold, whatever rule summed the published volume.
    """
    return 2.0 / 3.0 * depth * width * 2.0 * np.pi * track_radius


def shown_factors(factors: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Rows of `excess_factors` that the figure shows: least, thesis' and largest coefficient, first and last.

    Only of coefficients with a published fit; of the conserving scheme, which has little to separate, the last one,
    and not for the least coefficient.
    """
    factors = factors[factors["published"].notna()]
    coefficients = factors["wear_coefficient_per_pa"]
    thesis = published_value(published, "wear_coefficient", "simulation")
    wanted = dict.fromkeys((coefficients.min(), thesis, coefficients.max()))
    parts = []
    for scheme, coefficient in ((s, c) for s in SCHEMES for c in wanted):
        rows = same_coefficient(factors[factors["scheme"] == scheme], coefficient)
        if scheme == SCHEMES[0] and len(wanted) > 1 and coefficient == coefficients.min():
            continue
        ends = rows.sort_values("revolution").iloc[[-1] if scheme == SCHEMES[0] else [0, -1]] if len(rows) else rows
        parts.append(ends.drop_duplicates("revolution"))
    return pd.concat(parts, ignore_index=True)


def published_groove(published: pd.DataFrame) -> dict[str, float]:
    """What the published depth and width hold against the published volume (mm3) and alpha F L.

    groove_volume_mm3, published_volume_mm3, alpha_F_L_volume_mm3, groove_over_published, groove_over_alpha_F_L.
    """
    depth, width, volume, coefficient, revolutions = (
        published_value(published, name, "simulation")
        for name in ("depth", "width", "volume", "wear_coefficient", "revolutions")
    )
    track = published_value(published, "track_radius", "laboratory") / MILLIMETRES
    held = CUBIC_MILLIMETRES * groove_volume(depth / MILLIMETRES, width / MILLIMETRES, track)
    load = published_value(published, "load", "laboratory")
    law = CUBIC_MILLIMETRES * float(law_volume(coefficient, load, track, revolutions))
    return {
        "groove_volume_mm3": held,
        "published_volume_mm3": volume,
        "alpha_F_L_volume_mm3": law,
        "groove_over_published": held / volume,
        "groove_over_alpha_F_L": held / law,
    }


def groove_remark(published: pd.DataFrame) -> str:
    """What a groove of the published depth and width would hold, in words."""
    groove = published_groove(published)
    return (
        f"a round groove of the published depth and width (Yan 2022, Table 5.4) holds "
        f"{groove['groove_volume_mm3']:.2f} mm³, {groove['groove_over_published']:.1f} times the published volume "
        f"and {groove['groove_over_alpha_F_L']:.0f} times $\\alpha F L$"
    )


def size_cases(volumes: pd.DataFrame) -> pd.DataFrame:
    """The series of scales after its last revolution, with `alpha_F_L_volume_m3`."""
    sizes = volumes[volumes["series"] == "size"]
    last = sizes.loc[sizes.groupby("run", sort=False)["revolution"].idxmax()]
    fixed = (last["wear_coefficient_per_pa"], last["load_n"], last["track_radius_m"], last["revolution"])
    return last.assign(alpha_F_L_volume_m3=law_volume(*fixed))


def size_invariance(sizes: pd.DataFrame) -> pd.DataFrame:
    """Simulated over theoretical volume of Archard's law against the scale of the pin, its difference in percent.

    sizes : `run`, `particle_scale`, `worn_volume_m3` (alpha W), `alpha_F_L_volume_m3`, one row per run.
    """
    ratio = sizes["worn_volume_m3"] / sizes["alpha_F_L_volume_m3"]
    table = sizes[["run", "particle_scale"]].assign(
        simulated_volume_mm3=CUBIC_MILLIMETRES * sizes["worn_volume_m3"],
        theoretical_volume_mm3=CUBIC_MILLIMETRES * sizes["alpha_F_L_volume_m3"],
        ratio=ratio,
        difference_percent=PERCENT * (ratio - 1.0),
    )
    return table.sort_values("particle_scale", kind="stable").reset_index(drop=True)
