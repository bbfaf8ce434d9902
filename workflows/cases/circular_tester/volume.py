"""Volume worn in the circular wear tester, revolution by revolution: means over packings, rates and their trends.

A table of volumes, see `volumes`, has one row per run and wear cycle. One revolution is one turn of the simulated
sector, 150 degrees in Yan 2022 (chapter 6). A surface is plain or has the name of its pattern; the source's is convex.
Volumes add up, so what is said of straight and curved growth is said of the increments from revolution to revolution.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN, read_surface, worn_faces
from bulkwear.postproc.statistics.increments import FARTHEST, blocks_of, prediction, rate_trend
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.postproc.wear.pattern_left import pattern_volume
from bulkwear.workflows.cases.circular_tester.packings import PACKING, interval_columns, over_packings
from bulkwear.workflows.cases.circular_tester.runs import SURFACE, TesterRun

PATTERNED = "patterned"  # stands for any surface that is not plain
SETTING = ["surface", "shape", "particle_scale"]  # columns that tell runs apart which are no packings of each other
TERMS = ["linear_mm3_per_revolution", "quadratic_mm3_per_revolution2"]  # of the source's fits


def volumes(runs: Sequence[TesterRun]) -> pd.DataFrame:
    """What every run has lost after each wear cycle, from revolution 0 of wear on.

    Columns: those of `TesterRun.case`, cycle, revolution, volume_m3 (lost), law_volume_m3 (what the law takes, carried
    included), bump_volume_m3 (of it from the pattern), pattern_volume_m3 (what is left of it), elements (triangles
    that wear).
    """
    parts = []
    for run in runs:
        wear = pd.read_csv(run.folder / "wear.csv")
        pristine = read_surface(run.folder / SURFACE)
        table = pd.DataFrame(
            {
                "cycle": wear["cycle"],
                "revolution": wear["revolution"],
                "volume_m3": wear["total_applied_volume_m3"],
                "law_volume_m3": wear["total_worn_volume_m3"],
                "bump_volume_m3": wear["pattern_worn_volume_m3"].cumsum(),
                "pattern_volume_m3": wear["pattern_volume_m3"],
            }
        )
        start = {name: [0.0] for name in table} | {"cycle": [0], "pattern_volume_m3": [pattern_volume(pristine)]}
        table = pd.concat([pd.DataFrame(start), table], ignore_index=True)
        parts.append(
            table.assign(**run.case, elements=int(worn_faces(pristine).sum()))[[*run.case, *table, "elements"]]
        )
    return pd.concat(parts, ignore_index=True)


def whole_revolutions(table: pd.DataFrame) -> pd.DataFrame:
    """The rows of a table of volumes at whole revolutions, and at the last one of each run."""
    whole = np.isclose(table["revolution"], table["revolution"].round(), atol=1e-6)
    last = table["revolution"] == table.groupby("run")["revolution"].transform("max")
    return table[whole | last]


def chosen(table: pd.DataFrame, *names: str) -> pd.DataFrame:
    """The rows of some series."""
    return table[table["series"].isin(names)]


def of_surface(table: pd.DataFrame, surface: str) -> pd.DataFrame:
    """The rows of plain samples (PLAIN), or of samples with a pattern, whichever it is (PATTERNED)."""
    return table[(table["surface"] == PLAIN) == (surface == PLAIN)]


def settings_of(table: pd.DataFrame) -> Iterator[tuple[dict[str, object], pd.DataFrame]]:
    """Yield {column of SETTING: value} and the rows of each setting."""
    for key, rows in table.groupby(SETTING, sort=False):
        yield dict(zip(SETTING, key, strict=True)), rows


def shared_revolutions(table: pd.DataFrame) -> float:
    """The last revolution that all runs of a table have."""
    return float(table.groupby("run")["revolution"].max().min())


def mean_volumes(lost: pd.DataFrame) -> pd.DataFrame:
    """Lost volume (mm3) of each setting over its packings, at the revolutions that all of them have.

    lost: at whole revolutions. Columns: those of SETTING, revolution, volume_mm3, and those of `over_packings`.
    """
    reached = [rows[rows["revolution"] <= shared_revolutions(rows)] for _, rows in settings_of(lost)]
    table = pd.concat(reached).assign(volume_mm3=lambda rows: CUBIC_MILLIMETRES * rows["volume_m3"])
    return over_packings(table, [*SETTING, "revolution"], "volume_mm3")


def blocks(rows: pd.DataFrame) -> pd.DataFrame:
    """The increments (mm3) of runs of one setting from whole revolution to whole revolution, as from `blocks_of`."""
    rows = whole_revolutions(rows).sort_values([PACKING, "revolution"])
    return blocks_of(rows["revolution"], CUBIC_MILLIMETRES * rows["volume_m3"], rows[PACKING])


def rates(lost: pd.DataFrame) -> pd.DataFrame:
    """What each setting loses per revolution, and how that changes over the revolutions that its packings share.

    Columns: those of SETTING, packings, revolutions, and with their intervals (<name>_low, <name>_high; NaN of one
    packing) rate_mm3_per_revolution and change_percent: from the first to the last revolution, by a straight line
    through the increments, over their mean.
    """
    parts = []
    for setting, rows in settings_of(lost):
        last = shared_revolutions(rows)
        trend = rate_trend(blocks(rows[rows["revolution"] <= last]))
        parts.append(
            {**setting, "packings": rows[PACKING].nunique(), "revolutions": last}
            | interval_columns("rate_mm3_per_revolution", trend.rate)
            | interval_columns("change_percent", trend.change, 100.0)
        )
    return pd.DataFrame(parts)


def volumes_at(rows: pd.DataFrame, revolution: float) -> pd.Series:
    """Volume (mm3) of each packing of one setting after a revolution, by packing.

    Between wear cycles it is interpolated. Beyond the run it goes on as its increments do, up to FARTHEST times the
    run; farther it is NaN.
    """
    return pd.Series({name: _volume_at(one, revolution) for name, one in rows.groupby(PACKING, sort=False)})


def _volume_at(one: pd.DataFrame, revolution: float) -> float:
    one = one.sort_values("revolution")
    if revolution > one["revolution"].iloc[-1]:
        return prediction(blocks(one), revolution, farthest=FARTHEST).value
    return float(np.interp(revolution, one["revolution"], CUBIC_MILLIMETRES * one["volume_m3"]))


def element_increments(volumes: pd.DataFrame) -> pd.DataFrame:
    """Mean volume that an element loses from one revolution to the next (Yan 2022, Eq 6.7), per run and revolution.

    The sum of depth times area over the elements is the lost volume, so Eq 6.7 is its increment over their number.
    Columns: run, those of SETTING, packing, revolution (the earlier of both), end (the later one), increment_mm3 (of
    the sample, per revolution), element_increment_mm3.
    """
    parts = []
    for run, of_run in volumes.groupby("run", sort=False):
        ordered = of_run.sort_values("revolution")
        grown = CUBIC_MILLIMETRES * np.diff(ordered["volume_m3"]) / np.diff(ordered["revolution"])
        ends = ordered["revolution"].to_numpy()
        table = pd.DataFrame({"revolution": ends[:-1], "end": ends[1:], "increment_mm3": grown})
        table["element_increment_mm3"] = grown / ordered["elements"].to_numpy()[1:]
        same = {"run": run} | {name: ordered[name].iloc[0] for name in (*SETTING, PACKING)}
        parts.append(table.assign(**same)[[*same, *table.columns]])
    return pd.concat(parts, ignore_index=True)


def mean_increments(lost: pd.DataFrame) -> pd.DataFrame:
    """What each setting loses in each revolution, over its packings.

    lost: at whole revolutions. Columns: those of SETTING, revolution (counted from 1), increment_mm3, those of
    `over_packings`, element_increment_mm3.
    """
    grown, keys = element_increments(lost), [*SETTING, "revolution"]
    grown["revolution"] = grown["end"]
    of_elements = grown.groupby(keys, sort=False)["element_increment_mm3"].mean().reset_index()
    return over_packings(grown, keys, "increment_mm3").merge(of_elements, on=keys)


def times_source(coefficient: float, published: pd.DataFrame) -> float:
    """A wear coefficient (1/Pa) over that of the source's simulations; volumes are linear in it.

    published: as config/published/circular_tester.csv
    """
    return coefficient / published_value(published, "wear_coefficient", "simulation")


def fits_beside(published_fits: pd.DataFrame, foreign: Collection[str], times: float = 1.0) -> pd.DataFrame:
    """Eq 6.2 to 6.6 as they may stand beside a study's samples: without those of surfaces that are not the source's.

    foreign: these, as from `source.unlike_source`; times: as from `times_source`, by which the terms are multiplied
    """
    own = published_fits[~published_fits["surface"].isin(list(foreign))]
    return own.assign(**{term: times * own[term] for term in TERMS})


def published_terms(published: pd.DataFrame, surface: str, scale: float) -> np.ndarray:
    """Terms (2,) of Eq 6.2 to 6.6, mm3; NaN for a case that is not in the table, as from `fits_beside`."""
    found = published[(published["surface"] == surface) & np.isclose(published["particle_scale"], scale)]
    return found[TERMS].to_numpy(float)[0] if len(found) else np.full(len(TERMS), np.nan)


def volume_of_terms(terms: np.ndarray, revolution: np.ndarray | float) -> np.ndarray:
    """Volume (mm3) after revolutions by the source's terms (2,)."""
    x = np.asarray(revolution, dtype=float)
    return terms[0] * x + terms[1] * x**2


def beside_fits(means: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return a table as from `mean_volumes` with published_volume_mm3, by Eq 6.2 to 6.6; NaN of other cases."""
    of_rows = [
        float(volume_of_terms(published_terms(published, row.surface, row.particle_scale), row.revolution))
        for row in means.itertuples()
    ]
    return means.assign(published_volume_mm3=of_rows)


def change_of_terms(terms: np.ndarray, revolutions: float) -> float:
    """Change (%) of what the source's terms (2,) take per revolution, up to a revolution, over its mean."""
    linear, quadratic = terms
    return 200.0 * quadratic * revolutions / (linear + quadratic * revolutions)
