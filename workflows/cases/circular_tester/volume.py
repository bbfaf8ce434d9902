"""Volume worn in the circular wear tester, revolution by revolution: fits, what it says of hours, patterned or plain.

A table of volumes, see `volumes`, has one row per run and wear cycle. One revolution is one turn of the simulated
sector, 150 degrees in Yan 2022 (chapter 6). A surface is plain or has the name of its pattern; the
source's is convex.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN, read_surface, worn_faces
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.postproc.wear.coefficient import coefficient_of_volume, laboratory_coefficient
from bulkwear.postproc.wear.pattern_left import pattern_volume
from bulkwear.workflows.cases.circular_tester.runs import SURFACE, TesterRun

CONVEX = "convex"  # the source's pattern
PATTERNED = "patterned"  # stands for any surface that is not plain
ORDERS = {"linear": 1, "quadratic": 2}  # of the fits
CASE = ["run", "surface", "particle_scale"]  # columns that tell one case from another
TERMS = ["linear_mm3_per_revolution", "quadratic_mm3_per_revolution2"]
SECONDS_PER_HOUR = 3600.0
SURE = 2.0  # standard errors from zero that a quadratic term must be to be told from none
SHORT, LONG = "short_test", "long_test"  # published hours


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


def origin_fit(x: np.ndarray, y: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Least-squares polynomial without constant, as Eq 6.2 to 6.6: coefficients of x, x2 ... (order,), their standard
    errors (order,), and the share R2 (-) of the variance that they explain.

    x = 0 adds nothing and may be there. NaN where there are fewer points beside it than coefficients, errors also where
    there are as many.
    """
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    x, y = x[x != 0.0], y[x != 0.0]
    if len(x) < order:
        return np.full(order, np.nan), np.full(order, np.nan), float("nan")
    powers = x[:, None] ** np.arange(1, order + 1)
    found = np.linalg.lstsq(powers, y, rcond=None)[0]
    left = y - powers @ found
    spare = len(x) - order
    covariance = np.linalg.inv(powers.T @ powers) * (left @ left / spare if spare else np.nan)
    variance = float(((y - y.mean()) ** 2).sum())
    return found, np.sqrt(np.diag(covariance)), 1.0 - float(left @ left) / variance if variance > 0.0 else 1.0


def volume_fits(volumes: pd.DataFrame) -> pd.DataFrame:
    """Linear and quadratic fits (mm3) of every run through no wear at revolution 0, one row per run and order.

    Columns: those of CASE, fit, TERMS, their errors <term>_error, r_squared, revolutions (the last one), and
    curved: whether the quadratic term is more than SURE errors from zero.
    """
    rows = []
    for case, of_run in volumes.groupby(CASE, sort=False):
        for name, order in ORDERS.items():
            x, y = of_run["revolution"].to_numpy(float), CUBIC_MILLIMETRES * of_run["volume_m3"].to_numpy()
            found, error, r_squared = origin_fit(x, y, order)
            found, error = np.append(found, 0.0)[:2], np.append(error, 0.0)[:2]
            row = dict(zip(CASE, case, strict=True)) | {"fit": name} | dict(zip(TERMS, found, strict=True))
            row |= {f"{term}_error": each for term, each in zip(TERMS, error, strict=True)}
            curved = bool(order > 1 and abs(found[1]) > SURE * error[1])
            rows.append(row | {"r_squared": r_squared, "revolutions": x.max(), "curved": curved})
    return pd.DataFrame(rows)


def chosen_fit(fits: pd.DataFrame, run: str) -> np.ndarray:
    """Terms (2,) of a run's fit: the quadratic one where its curvature is sure, else the linear one. mm3."""
    of_run = fits[fits["run"] == run].set_index("fit")
    return of_run.loc["quadratic" if of_run.loc["quadratic", "curved"] else "linear", TERMS].to_numpy(float)


def fit_at(fits: pd.DataFrame, run: str, revolution: float) -> np.ndarray:
    """Terms (2,) of a run's fit for a revolution: beyond its last one a curve that flattens gives way to the line, as
    it would turn down somewhere. mm3.
    """
    terms, of_run = chosen_fit(fits, run), fits[fits["run"] == run].set_index("fit")
    beyond = revolution > of_run["revolutions"].iloc[0]
    return of_run.loc["linear", TERMS].to_numpy(float) if beyond and terms[1] < 0.0 else terms


def fit_up_to(fits: pd.DataFrame, run: str, volume: float) -> np.ndarray:
    """Terms (2,) of a run's fit that say when it has lost a volume (mm3), by the same rule."""
    line = fits[(fits["run"] == run) & (fits["fit"] == "linear")].iloc[0]
    last = chosen_fit(fits, run)
    reached = float(volume_at(last, line["revolutions"])) >= volume
    return fit_at(fits, run, line["revolutions"] if reached else np.inf)


def published_terms(published: pd.DataFrame, surface: str, scale: float) -> np.ndarray:
    """Terms (2,) of Eq 6.2 to 6.6, mm3; NaN for a case that is not published."""
    found = published[(published["surface"] == surface) & np.isclose(published["particle_scale"], scale)]
    return found[TERMS].to_numpy(float)[0] if len(found) else np.full(len(TERMS), np.nan)


def volume_at(terms: np.ndarray, revolution: np.ndarray | float) -> np.ndarray:
    """Volume (mm3) after revolutions by the terms (2,) of a fit."""
    x = np.asarray(revolution, dtype=float)
    return terms[0] * x + terms[1] * x**2


def element_increments(volumes: pd.DataFrame) -> pd.DataFrame:
    """Mean volume that an element loses from one revolution to the next (Yan 2022, Eq 6.7), per run and revolution.

    The sum of depth times area over the elements is the lost volume, so Eq 6.7 is its increment over their number.
    Columns: those of CASE, revolution (the earlier of both), increment_mm3 (of the sample), element_increment_mm3.
    """
    parts = []
    for case, of_run in volumes.groupby(CASE, sort=False):
        ordered = of_run.sort_values("revolution")
        grown = CUBIC_MILLIMETRES * np.diff(ordered["volume_m3"]) / np.diff(ordered["revolution"])
        table = pd.DataFrame({"revolution": ordered["revolution"].to_numpy()[:-1], "increment_mm3": grown})
        table["element_increment_mm3"] = grown / ordered["elements"].to_numpy()[1:]
        parts.append(table.assign(**dict(zip(CASE, case, strict=True)))[[*CASE, *table.columns]])
    return pd.concat(parts, ignore_index=True)


def crossing(plain: np.ndarray, patterned: np.ndarray) -> float:
    """Revolution (-) from which on patterned has lost more than plain, by their fits' terms (2,); infinite for none.

    0 where patterned wears more from the start and never less.
    """
    linear, quadratic = np.asarray(patterned, dtype=float) - np.asarray(plain, dtype=float)
    if linear >= 0.0 and quadratic >= 0.0:
        return 0.0
    if quadratic <= 0.0:
        return float("inf")
    return float(-linear / quadratic)


def rate_crossing(plain: np.ndarray, patterned: np.ndarray) -> float:
    """Revolution (-) from which on patterned wears faster than plain: half of where its lost volume is as much."""
    return 0.5 * crossing(plain, patterned)


@dataclass(frozen=True)
class TimeScale:
    """What simulated wear stands for.

    hours_per_revolution: at the simulated coefficient, so that the plain sample wears as in the test
    wear_coefficient: 1/Pa, that makes the published number of revolutions stand for the test instead
    simulated_coefficient: 1/Pa; laboratory_coefficient: 1/Pa, of the test itself by its pressure and distance
    distance_scale: -, distance of the test over that of the revolutions which stand for it
    """

    hours_per_revolution: float
    wear_coefficient: float
    simulated_coefficient: float
    laboratory_coefficient: float
    distance_scale: float

    def revolutions(self, hours: float) -> float:
        """Revolutions that stand for hours of the test."""
        return hours / self.hours_per_revolution


def time_scale(
    plain: np.ndarray,
    simulated_coefficient: float,
    published: pd.DataFrame,
    distance_per_revolution: float,
    sample_area: float,
) -> TimeScale:
    """Coefficient and time scale from the plain sample's 56 hours: the patterned sample has no part in them.

    plain: terms (2,) of the plain run's fit, mm3; simulated_coefficient: 1/Pa, of that run; published: as
    config/published/circular_tester.csv; distance_per_revolution: m, of the bed past the sample's middle; sample_area:
    m2.
    Hours are told by the volume, on the fitted curve. The laboratory's coefficient uses its pressure on the sample's
    area, and 0.6 m/s for 56 h (121 km); the source's own 84.6 km do not fit these. Raises ValueError as
    `coefficient_of_volume`.
    """

    def laboratory(quantity: str) -> float:
        return published_value(published, quantity, "laboratory")

    volume, hours = laboratory("plain_volume_56_h"), laboratory(SHORT)
    stand_for = published_value(published, "revolutions_of_short_test", "simulation")
    needed = _revolution_of(plain, volume)
    at_theirs = volume_at(plain, stand_for) / CUBIC_MILLIMETRES
    coefficient, _ = coefficient_of_volume(
        np.array([simulated_coefficient]), np.array([at_theirs]), volume / CUBIC_MILLIMETRES
    )
    distance = laboratory("velocity_at_centre") * hours * SECONDS_PER_HOUR
    load = 1e3 * laboratory("normal_pressure") * sample_area
    of_laboratory, _ = laboratory_coefficient(volume / CUBIC_MILLIMETRES, 0.0, load, distance)
    return TimeScale(
        hours_per_revolution=hours / needed,
        wear_coefficient=coefficient,
        simulated_coefficient=simulated_coefficient,
        laboratory_coefficient=of_laboratory,
        distance_scale=distance / (needed * distance_per_revolution),
    )


def _revolution_of(terms: np.ndarray, volume: float) -> float:
    """First revolution at which a fit reaches a volume (mm3). Raises ValueError when it never does."""
    linear, quadratic = terms
    if quadratic == 0.0:
        return volume / linear
    roots = np.roots([quadratic, linear, -volume])
    found = roots[np.isreal(roots) & (roots.real > 0.0)].real
    if not found.size:
        raise ValueError(f"the plain sample's fit never reaches {volume} mm3, allowed is one that does")
    return float(found.min())


def predictions(fits: pd.DataFrame, scale: TimeScale, hours: list[float]) -> pd.DataFrame:
    """Volume of every run after hours of the test, and the reduction against the plain run of the same particle scale.

    fits: as from `volume_fits`. Columns: those of CASE, hours, revolution, volume_mm3, reduction_percent (NaN without
    a plain run), extrapolated (True: beyond the run's last revolution).
    """
    rows = []
    for case, of_run in fits.groupby(CASE, sort=False):
        plain = fits[(fits["surface"] == PLAIN) & (fits["particle_scale"] == case[2])]["run"]
        for each in hours:
            revolution = scale.revolutions(each)
            volume = float(volume_at(fit_at(fits, case[0], revolution), revolution))
            beside = volume_at(fit_at(fits, plain.iloc[0], revolution), revolution) if len(plain) else np.nan
            row = dict(zip(CASE, case, strict=True)) | {"hours": each, "revolution": revolution, "volume_mm3": volume}
            row |= {"reduction_percent": 100.0 * (1.0 - volume / beside)}
            rows.append(row | {"extrapolated": revolution > of_run["revolutions"].iloc[0]})
    return pd.DataFrame(rows)
