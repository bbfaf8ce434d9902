"""What a study of pins on discs found: the blocks of the sections of its page, from the tables beside its figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.pin_on_disc.beside_source import (
    coefficients_beside_source,
    differences_beside_source,
    sizes_beside_source,
)
from bulkwear.workflows.cases.pin_on_disc.coefficient import coefficient_of_laboratory
from bulkwear.workflows.cases.pin_on_disc.comparison import EDGES_PER_WIDTH, STABLE_PERCENT
from bulkwear.workflows.cases.pin_on_disc.run_in import TESTED, rate_of_no_run_in, run_in_table, run_in_words
from bulkwear.workflows.cases.pin_on_disc.runs import REFERENCE, only_reference, pin_runs, whole_revolutions
from bulkwear.workflows.cases.pin_on_disc.volume import (
    CANDIDATES,
    LARGEST_CHANGE,
    PERCENT,
    QUADRATIC,
    VOLUMES,
    groove_remark,
    shown_factors,
)
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.report.sections import Block, Table, Text

NEEDED_OF_VERDICTS = ("wear_volume", "run_in")  # figures whose tables they rest on
SIMULATED_DISCS, SEED = 1000, 20261123  # to tell how often a rule errs
CHANGE_POINTS_NOTE = (
    "A broken line, from a transient to a level; the interval is at 95 %, for values correlated with their neighbours. "
    "In a series that is level all along a run-in is found in 5 %, however long it is."
)
SOURCES_SUM = "Eq 5.9, touched"  # of volume.VOLUMES
PUBLISHED = PACKAGE / "config" / "published"
VOLUME_HEADS = {
    "volume_mm3": ("volume", "mm³"),
    "constant_mm3": ("constant", "mm³"),
    "linear_mm3_per_revolution": ("linear", "mm³ per revolution"),
    "quadratic_mm3_per_revolution2": ("quadratic", "mm³ per revolution²"),
    "least_quadratic_mm3_per_revolution2": ("quadratic, least", "mm³ per revolution²"),
    "largest_quadratic_mm3_per_revolution2": ("quadratic, largest", "mm³ per revolution²"),
    "simulated_volume_mm3": ("simulated volume", "mm³"),
    "theoretical_volume_mm3": ("theoretical volume", "mm³"),
}  # of columns whose name ends with no unit that heads know


FITS_NOTE = (
    "Linear and quadratic term of the volume over revolutions, from the line through what each revolution adds."
    " Change: of that line over the run, over its mean. Least and largest: 95 % intervals of the one run that is"
    " simulated, for increments correlated with their neighbours; with fewer than four revolutions the scatter is"
    " unknown. Linear: "
    f"surely a change of less than {PERCENT * LARGEST_CHANGE:.0f} %; faster and slower: surely more and less than none."
    " The published fits are those of the cumulated volumes, without intervals."
)


def published_values() -> pd.DataFrame:
    """Return what the source prints of thesis and laboratory."""
    return pd.read_csv(PUBLISHED / "pin_on_disc.csv")


def table_of(folder: Path, figure: str) -> pd.DataFrame:
    """Return a table beside the figures of a study."""
    return pd.read_csv(folder / "figures" / f"{figure}.csv")


# ---------------------------------------------------------------- volume


def comparison_blocks(folder: Path) -> list[Block]:
    """Return laboratory, thesis and ours with their differences in per cent."""
    compared = table_of(folder, "pin_comparison")
    beside = sizes_beside_source(compared, published_values())
    return [Table(compared.drop(columns="run"), "comparison", heads=VOLUME_HEADS, beside_source=beside)]


def excess_blocks(folder: Path) -> list[Block]:
    """Return the factors of the volume, one candidate at a time."""
    factors, published = table_of(folder, "force_rise"), published_values()
    columns = ["scheme", "wear_coefficient_per_pa", "revolution", *CANDIDATES, "product", "published", "unexplained"]
    note = groove_remark(published).replace(r"$\alpha F L$", "alpha F L")
    parts = (first_revolution(factors), what_is_left(factors), f"{note[0].upper()}{note[1:]}.")
    shown = shown_factors(factors, published)[[*columns, "summing_over_all", "contacts"]]
    return [Table(shown, "factors"), Text(" ".join(part for part in parts if part))]


def first_revolution(factors: pd.DataFrame) -> str:
    """Return how far the law's volume of the first revolution is from alpha F L, over all conserving runs, if any."""
    first = factors[(factors["scheme"] == "conserving") & (factors["revolution"] == 1)]
    if first.empty:
        return ""
    excess = 100.0 * (first["force_rise"] * first["slip"] - 1.0)
    return (
        f"In the first revolution of conserving runs alpha times the sliding work differs from alpha F L by "
        f"{excess.min():.2g} to {excess.max():.2g} %."
    )


def what_is_left(factors: pd.DataFrame) -> str:
    """Return the two rules' factors over all per-triangle runs that have a published fit, and what they leave.

    Empty without such runs.
    """
    chosen = factors[(factors["scheme"] == "per_triangle") & factors["published"].notna()]
    if chosen.empty:
        return ""
    names = ("force_rise", "displacement_rule", "summing_rule", "unexplained")
    rise, moved, summed, left = (f"{chosen[name].min():.3g} to {chosen[name].max():.3g}" for name in names)
    last = chosen.loc[chosen.groupby("run", sort=False)["revolution"].idxmax()]
    ends = ", ".join(f"{row.unexplained:.3g} at {row.wear_coefficient_per_pa:.2g} 1/Pa" for row in last.itertuples())
    return (
        f"By the per-triangle rule the summed normal force is {rise} of the load, the displacement rule takes {moved} "
        f"times the wear taken up and Eq 5.9 over the touched triangles finds {summed} of that; the published volume "
        f"is {left} times this product, after the last revolution {ends}."
    )


def fit_blocks(folder: Path) -> list[Block]:
    """Return how removed volumes, and those by Eq 5.9, grow with the revolutions, beside the published fits."""
    trends = table_of(folder, "wear_volume_trends")
    summed = (trends["scheme"] == "per_triangle") & (trends["volume"] == "Eq 5.9, touched")
    ours = trends[(trends["volume"] == "removed") | summed].drop(columns="run")
    theirs = pd.read_csv(PUBLISHED / "pin_on_disc_volume.csv").rename(columns={"source": "scheme"})
    together = pd.concat([ours, published_growth(theirs)], ignore_index=True).drop(columns="r_squared")
    beside = volumes_beside_source(table_of(folder, "wear_volume"))
    return [Table(together, "fits", FITS_NOTE, heads=VOLUME_HEADS, beside_source=beside)]


def volumes_beside_source(volumes: pd.DataFrame) -> pd.DataFrame:
    """Return the volumes of the published fits beside ours by the source's own rule and sum, after the last revolution
    of each run; volumes: as from `volume.beside_laws`. No run is repeated, so that none has an interval.
    """
    ours = volumes[(volumes["scheme"] == "per_triangle") & volumes["published_volume_m3"].notna()]
    last = ours.loc[ours.groupby("run", sort=False)["revolution"].idxmax()]
    return pd.DataFrame(
        {
            "quantity": [f"volume after {revolution:g} revolutions" for revolution in last["revolution"]],
            "setting": [f"{each:.2g} 1/Pa" for each in last["wear_coefficient_per_pa"]],
            "unit": "mm³",
            "published_value": CUBIC_MILLIMETRES * last["published_volume_m3"].to_numpy(),
            "computed_value": CUBIC_MILLIMETRES * last[VOLUMES[SOURCES_SUM]].to_numpy(),
            "source": "Yan 2022, Eq 5.11 to 5.15",
        }
    )


def published_growth(fits: pd.DataFrame) -> pd.DataFrame:
    """Return the published fits as rows of `volume.volume_trends`: the change over the revolutions of the source."""
    last = published_value(published_values(), "revolutions", "simulation")
    slope = 2.0 * fits[QUADRATIC]
    rate = fits["linear_mm3_per_revolution"] + 0.5 * last * slope
    return fits.assign(volume="published", revolutions=last, change_percent=PERCENT * last * slope / rate)


def size_blocks(folder: Path) -> list[Block]:
    """Return simulated over theoretical volumes by scale."""
    table, published = table_of(folder, "size_invariance"), published_values()
    bound = published_value(published, "size_invariance_difference", "simulation")
    beside = differences_beside_source(table, published)
    digits = dict.fromkeys(table, 5)
    return [
        Table(table, "size_invariance", digits=digits, heads=VOLUME_HEADS, beside_source=beside),
        Text(f"Published (Yan 2022, Fig 4.6): under {bound:g} %."),
    ]


# ---------------------------------------------------------------- wear coefficient


def coefficient_blocks(folder: Path) -> list[Block]:
    """Return the laboratory's coefficient, those of the simulated revolutions, and the limits of scaling."""
    published, limits = published_values(), table_of(folder, "scaling_limits")
    value, error = coefficient_of_laboratory(published)
    printed = published_value(published, "wear_coefficient", "laboratory")
    laboratory = (
        f"The laboratory's coefficient by Archard's law, V / (F L): ({1e13 * value:.2f} ± {1e13 * error:.2f})e-13 "
        f"1/Pa; published ({1e13 * printed:.1f} ± 1)e-13."
    )
    calibration = table_of(folder, "calibration")
    return [
        Text(laboratory),
        Table(calibration, "calibration", beside_source=coefficients_beside_source(calibration, published)),
        Text(limits_sentence(folder, limits)),
        Table(limits, "scaling_limits", digits=dict.fromkeys(limits, 4)),
    ]


def limits_sentence(folder: Path, limits: pd.DataFrame) -> str:
    """Return what the limits of scaling are, and for which wear cycles and elements the one by the cap holds."""
    runs = pin_runs(folder / "design.csv").set_index("run")
    shown = runs.loc[[run for run in limits["run"] if run in runs.index]]
    cycles = whole_revolutions(pd.read_csv(folder / shown.index[0] / "wear.csv"))["cycle"].iloc[0]
    sizes = ", ".join(f"{size:g}" for size in sorted(shown["element_size_mm"].unique()))
    return (
        "Largest scaling factor that the run-in allows, and at which a wear update reaches its cap. The second holds "
        f"for {cycles} wear cycles per revolution and elements of {sizes} mm on the track only. A run-in that ends "
        "with revolution 1 sets no limit: its factor is that of the whole test in one revolution."
    )


# ---------------------------------------------------------------- groove


def run_in_blocks(folder: Path) -> list[Block]:
    """Return the run-in of the reference runs and of the thesis by the same rule, and their p values."""
    normality = pd.read_csv(PUBLISHED / "pin_on_disc_normality.csv")
    runs = pin_runs(folder / "design.csv")
    shown = only_reference(table_of(folder, "run_in"), runs, published_values(), REFERENCE)
    tested = shown[shown["size"].isin(TESTED)]
    near = tested.groupby(["scheme", "size"])["neighbour_correlation"].agg(["min", "max"])
    words = "; ".join(f"{size}: {said}" for size, said in run_in_words(shown, normality).items())
    correlated = ", ".join(
        f"{scheme.replace('_', ' ')} {size} {row['min']:.2f} to {row['max']:.2f}"
        for (scheme, size), row in near.iterrows()
    )
    together = p_values(tested, normality)
    found = run_in_table(shown, normality)
    return [
        Table(found, "run_in"),
        Text(f"{words}. Correlation of neighbouring contours: {correlated}."),
        Text(rate_of_rules(int(found["revolutions"].max()))),
        Table(table_of(folder, "run_in_change_points"), "change_points", CHANGE_POINTS_NOTE),
        Text("p values of normality:"),
        Table(together, "p_values", digits=dict.fromkeys(together, 2)),
    ]


def rate_of_rules(revolutions: int) -> str:
    """Return how often the rules find discs that are normal from the start to be so, by simulation."""
    rates = [
        PERCENT * rate_of_no_run_in(revolutions, SIMULATED_DISCS, np.random.default_rng(SEED), corrected)
        for corrected in (False, True)
    ]
    return (
        f"Of {SIMULATED_DISCS} simulated discs whose contours are normal from the start, in {revolutions} revolutions, "
        f"the source's rule ends the run-in with revolution 1 in {rates[0]:.0f} %; with the significance corrected for "
        f"the number of tests it is {rates[1]:.0f} %."
    )


def verdict_blocks(folder: Path) -> list[Block]:
    """Return the source's findings with the verdicts on them."""
    from bulkwear.workflows.cases.pin_on_disc import verdicts  # slow to import, and every job reads this page
    from bulkwear.workflows.config.claims import claims_of, date_of_rules

    runs, meshes = pin_runs(folder / "design.csv"), folder / "figures" / "mesh_series.csv"
    tables = verdicts.Tables(
        volumes=table_of(folder, "wear_volume"),
        statistics=only_reference(table_of(folder, "run_in"), runs, published_values(), REFERENCE),
        meshes=pd.read_csv(meshes) if meshes.exists() else pd.DataFrame(columns=["scheme", "size"]),
    )
    found = verdicts.verdict_table(tables, claims_of("pin_on_disc"))
    said = (
        f"Rules and margins: config/published/verdicts.yaml, of {date_of_rules('pin_on_disc')}. No run is repeated:"
        " intervals are of the run that was simulated, and verdicts hold for it."
    )
    return [Text(said), Table(found.drop(columns="key"), "findings", beside_source=True)]


def p_values(tested: pd.DataFrame, normality: pd.DataFrame) -> pd.DataFrame:
    """Return p values by revolution: a column per scheme and tested size, then those of the source."""
    ours = tested.pivot(index="revolution", columns=["scheme", "size"], values="p_value")
    ours.columns = [f"{scheme}, {size}" for scheme, size in ours.columns]
    theirs = normality.drop(columns="source").set_index("revolution").add_prefix("Yan ")
    return ours.join(theirs, how="outer").reset_index()


def mesh_blocks(folder: Path) -> list[Block]:
    """Return how far fine meshes agree, in one sentence per scheme and in a table."""
    series, stability = table_of(folder, "mesh_series"), table_of(folder, "mesh_stability")
    return [Text(f"{trend(series)} {agreement(stability)}"), Table(stability, "mesh_stability")]


def trend(series: pd.DataFrame) -> str:
    """Return how depth and opening change from the finest to the coarsest mesh, by scheme."""
    said = []
    for scheme, rows in series.groupby("scheme", sort=False):
        sizes = rows.pivot(index="element_size_mm", columns="size", values="mean_mm")
        (fine, coarse), depth, opening = sizes.index[[0, -1]], 1e3 * sizes["depth"], sizes["opening width"]
        said.append(
            f"{scheme.replace('_', ' ')}, elements of {fine:g} to {coarse:g} mm: depth {depth.iloc[0]:.3g} to "
            f"{depth.iloc[-1]:.3g} µm, opening {opening.iloc[0]:.3g} to {opening.iloc[-1]:.3g} mm"
        )
    return f"After revolution {series['revolution'].iloc[0]}: {'; '.join(said)}."


def agreement(stability: pd.DataFrame) -> str:
    """Return how far the meshes of each scheme differ that are fine enough, and whether that is within the bound."""
    said = []
    for scheme, rows in stability.groupby("scheme", sort=False):
        meshes, largest = rows["meshes"].max(), rows["difference_percent"].max()
        name = scheme.replace("_", " ")
        if meshes < 2:
            said.append(f"{name}: fewer than two meshes are that fine, nothing is compared")
        else:
            verdict = "within" if rows["stable"].all() else "not within"
            said.append(f"{name}: up to {largest:.2g} % among {meshes} meshes, {verdict} {STABLE_PERCENT:g} %")
    return f"Meshes with elements up to 1/{EDGES_PER_WIDTH:g} of the groove's width differ by: {'; '.join(said)}."
