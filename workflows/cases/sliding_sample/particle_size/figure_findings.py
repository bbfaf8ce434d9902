"""What the figures of particle size show, in one sentence each, from the tables beside them."""

from __future__ import annotations

import pandas as pd

from bulkwear.postproc.flow.packing import inner_means
from bulkwear.workflows.report.sentences import PERCENT, listed, measured, spoken, with_interval
from bulkwear.workflows.report.text import number, range_text

SPIN = "averaged_angular_velocity_deg_per_s"
PEAKS = ["overlap", "normal_force", "tangential_force", "spin"]
WALLS = 2  # slabs of a container that are left out, at its floor and at its top
EXACT = 1e-5  # -, below which a difference is that of the digits that are kept
STATES = {"loose": "filled", "dense": "shaken", "before": "before the sample", "after": "behind it"}


def ratio_at(row: pd.Series) -> str:
    """Return patterned over plain wear at a scale, with its interval."""
    ratio = with_interval(row["wear_over_plain"], row["interval_low"], row["interval_high"], row["packings"])
    return f"{ratio} at scale {row['particle_scale']:g}"


def ratios_by_scale(wear: pd.DataFrame) -> str:
    """Return patterned over plain wear at the smallest and at the largest scale; wear: `wear_by_scale`."""
    from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import ratio_by_scale  # slow to import

    return _ends(ratio_by_scale(wear))


def ratios_by_size(table: pd.DataFrame) -> str:
    """Return the same with the ratios of particle to bump; table: as from `wear_by_size_ratio`."""
    if table.empty:
        return ""
    sizes = range_text(table["equivalent_radius"].tolist())
    return f"{_ends(table)[:-1]}, where particles are {sizes} times as large as bumps."


def _ends(table: pd.DataFrame) -> str:
    if table.empty:
        return ""
    ordered = table.sort_values("particle_scale")
    ends = [ratio_at(ordered.iloc[place]) for place in dict.fromkeys((0, len(ordered) - 1))]
    return f"The patterned sample wears over the plain one {listed(ends)}."


def steady_ends(table: pd.DataFrame) -> str:
    """Return relative velocity and wear rate at the smallest and largest scale, means over the runs of a surface.

    table: as from `published_sizes.steady_by_scale`
    """
    said = []
    for (measure, surface), rows in table.groupby(["measure", "surface"], sort=False):
        means = rows.groupby("particle_scale")["mean_percent"].mean().dropna()
        if len(means):
            ends = [f"{number(means[scale], 2)} % at scale {scale:g}" for scale in dict.fromkeys(means.index[[0, -1]])]
            said.append(f"{spoken(measure)} ({surface}) {listed(ends)}")
    steady = f"{int(table['steady'].sum())} of {len(table)} windows are steady"
    return f"{steady}; {'; '.join(said)}."


def over_scales(column: str, words: str, unit: str, lowest: bool = False):
    """Return the finding of a chart of layers or places: the largest size of a column by surface, over the scales.

    words: what is told; lowest: of the lowest layer alone
    """

    def finding(table: pd.DataFrame) -> str:
        rows = table[table["layer"] == table["layer"].min()] if lowest else table
        said = []
        for surface, own in rows.groupby("surface", sort=False):
            each = own.groupby("particle_scale")[column].apply(lambda values: values.abs().max()).dropna()
            if len(each):
                said.append(f"{range_text(each.tolist())} {unit} ({surface})")
        scales = range_text(table["particle_scale"].tolist())
        return f"{words} {listed(said)} at particle scales {scales}." if said else ""

    return finding


velocity = over_scales("velocity_m_per_s", "With the sample the lowest layer moves at", "m/s", lowest=True)
upward = over_scales("upward_m_per_s", "Upwards or downwards layers move at most at", "m/s")
sideways = over_scales("sideways_m_per_s", "Sideways layers move at most at", "m/s")


def spin_along(table: pd.DataFrame) -> str:
    """Return how the lowest layer turns at the front and at the back of the samples, mean over the scales."""
    said = []
    for surface, rows in table.dropna(subset=SPIN).groupby("surface", sort=False):
        middle = 0.5 * rows.groupby("run")["along_mm"].transform("max")
        front, back = (rows.loc[(rows["along_mm"] <= middle) == first, SPIN].mean() for first in (True, False))
        said.append(f"{measured(front, '°/s')} in front and {measured(back, '°/s')} at the back ({surface})")
    return f"The lowest layer turns with {listed(said)}, mean over the scales." if said else ""


def packing(table: pd.DataFrame) -> str:
    """Return contacts and porosity by state over the particle scales; table: of containers or of beds."""
    said = []
    for state, rows in table[table["state"].isin(list(STATES))].groupby("state", sort=False):
        of_scales = rows.groupby("particle_scale")
        slabs = "layer" in rows and of_scales.size().min() > WALLS
        means = pd.DataFrame([inner_means(of) for _, of in of_scales]) if slabs else of_scales.mean(numeric_only=True)
        means = means[["coordination_number", "porosity"]]
        contacts, pores = (range_text(means[name].dropna().tolist() or [float("nan")], 3) for name in means)
        said.append(f"{STATES[str(state)]} {contacts} contacts and a porosity of {pores}")
    return f"Over the particle scales particles have {'; '.join(said)}." if said else ""


def collisions(histories: pd.DataFrame) -> str:
    """Return how far the peaks of single collisions differ between scales. histories: of every collision and scale."""
    kinds = ["collision", "rolling_friction", "particle_scale"]
    peaks = histories.assign(**histories[PEAKS].abs()).groupby(kinds, sort=False)[PEAKS].max()
    of_kind = peaks.groupby(level=kinds[:2], sort=False)
    spread = ((of_kind.max() - of_kind.min()) / of_kind.max().where(of_kind.max() > 0.0)).max().max()
    scales = range_text(sorted(set(histories["particle_scale"])))
    differ = f"{PERCENT * spread:.1g} % at most" if spread > EXACT else f"less than {PERCENT * EXACT:g} %"
    return f"Largest overlap, forces and spin at scale {scales} differ by {differ}."
