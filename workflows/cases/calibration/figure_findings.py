"""What the figures of a calibration show, in one sentence each, from the tables beside them."""

from __future__ import annotations

import pandas as pd

from bulkwear.workflows.report.sentences import PERCENT, capital, listed, measured, spoken
from bulkwear.workflows.report.text import range_text

MET = ("inside", "within its uncertainty")  # of a statement: the response is reproduced


def said_of(response: str) -> tuple[str, str]:
    """Return a response in words, without its unit, and that unit."""
    from bulkwear.workflows.cases.calibration.responses import response_name  # slow to import

    name, _, unit = response_name(response).removesuffix(")").partition(" (")
    return f"{name[0].lower()}{name[1:]}".replace(", ", " of the "), unit


def heap_angles(slopes: pd.DataFrame) -> str:
    """Return the angles of the slopes of the heaps shown; slopes: as from `flow.bulk_test.slope_table`."""
    said = []
    for response, rows in slopes.groupby("response", sort=False):
        angles = [f"{row.angle_deg:.1f} ± {row.uncertainty_deg:.1f}°" for row in rows.itertuples()]
        said.append(f"{said_of(str(response))[0]} {listed(angles)}")
    return f"Slopes of these heaps: {'; '.join(said)}."


def ranges(grid: pd.DataFrame) -> str:
    """Return from where to where each response goes over the parameters; grid: as from `responses.response_grid`."""
    said = []
    for response in (name for name in grid if f"{name}_doubt" in grid):
        name, unit = said_of(response)
        said.append(f"{name} {range_text([grid[response].min(), grid[response].max()], 3)} {unit}")
    return f"Over the parameters responses go from least to most: {'; '.join(said)}."


def family(table: pd.DataFrame) -> str:
    """Return as far as pairs of the first two parameters fit; table: as from `responses.family_table`."""
    from bulkwear.postproc.inference.posterior import FAMILY_SHARE  # slow to import

    names = [table[place].iloc[0] for place in ("first", "second")]
    rows = table[(table["first"] == names[0]) & (table["second"] == names[1])]
    inside = rows[rows["denser_share"] <= FAMILY_SHARE]
    said = [
        f"{parameter_words(name)} {inside[place].min():.2f} to {inside[place].max():.2f}"
        for name, place in zip(names, ("first_value", "second_value"), strict=True)
    ]
    return f"Pairs that hold {PERCENT * FAMILY_SHARE:.0f} % of what fits have {listed(said)}, in certain combinations."


def reproduced(statements: pd.DataFrame, pair: str) -> str:
    """Return which measured responses a pair reproduces, by the means of its packings; "" of a pair without rows.

    statements: as from `responses.statement_table`
    """
    rows = statements[(statements["pair"] == pair) & statements["measured"].notna()]
    if rows.empty:
        return ""
    asked, values = rows[rows["seeds"] > 0], values_of(rows)
    if asked.empty:
        return f"The {spoken(pair)} pair ({values}) was not simulated again, so what it gives is a prediction."
    met = asked[asked["inside"].isin(MET)]
    off = [
        f"{said_of(row.response)[0]} ({row.deviations:+.1f} standard deviations)"
        for row in asked[~asked["inside"].isin(MET)].itertuples()
    ]
    missing = [said_of(name)[0] for name in rows.loc[rows["seeds"] == 0, "response"]]
    count = int(asked["seeds"].min())
    packings = f"means of {count} packings or more" if count > 1 else "of one packing, whose scatter is unknown"
    return (
        f"The {spoken(pair)} pair ({values}) reproduces {len(met)} of {len(rows)} responses that were measured and"
        f" simulated, within their uncertainty ({packings})"
        f"{f'; off are {listed(off)}' if off else ''}{f'; not simulated: {listed(missing)}' if missing else ''}."
    )


def values_of(rows: pd.DataFrame) -> str:
    """Return the parameters of a pair in words: the columns of a statement before its response."""
    names = list(rows.columns[1 : list(rows.columns).index("response")])
    return ", ".join(f"{parameter_words(name)} {rows[name].iloc[0]:.2f}" for name in names)


def parameter_words(name: str) -> str:
    """Return a parameter in words, without a unit; one of particles without saying so."""
    from bulkwear.workflows.cases.calibration.responses import parameter_name  # slow to import

    words = parameter_name(name).removesuffix(" (-)").removesuffix(", particles")
    return f"{words[0].lower()}{words[1:]}"


def first_reproduced(statements: pd.DataFrame) -> str:
    """Return which measured responses the first pair reproduces, the recommended one."""
    return reproduced(statements, statements["pair"].iloc[0])


def box_effect(sizes: pd.DataFrame) -> str:
    """Return between what the shear angle lies over the boxes, and how far packings scatter beside that.

    sizes: length_mm, width_mm, mean, deviation (between packings)
    """
    spread = sizes["deviation"].dropna()
    scatter = f"; packings scatter by {range_text(spread.tolist())}°" if len(spread) else ""
    lengths, widths = (range_text(sizes[f"{name}_mm"].tolist(), 3) for name in ("length", "width"))
    return (
        f"In boxes {lengths} mm long and {widths} mm wide the shear angle is {range_text(sizes['mean'].tolist(), 3)}°"
        f"{scatter}."
    )


def progress(table: pd.DataFrame) -> str:
    """Return how far the surrogate is sure at the last look of each test, and what to measure next.

    table: looks (simulations, test, surrogate_share) above information (response, information_bits)
    """
    looks = table.dropna(subset="surrogate_share").groupby("test", sort=False).last()
    said = [
        f"{PERCENT * row.surrogate_share:.0f} % after {row.simulations:.0f} simulations ({spoken(str(test))})"
        for test, row in looks.iterrows()
    ]
    known = table.dropna(subset="information_bits")
    start = capital(f"of the variance the surrogate's share is {listed(said)}")
    if known.empty:
        return f"{start}."
    best = known.loc[known["information_bits"].idxmax()]
    name = said_of(best["response"])[0]
    return f"{start}; measuring the {name} once more tells most, {measured(best['information_bits'], 'bit')}."
