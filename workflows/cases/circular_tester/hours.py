"""Hours of the test that revolutions of a circular wear tester stand for, and what samples lose in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.increments import FARTHEST
from bulkwear.postproc.statistics.intervals import Estimate, estimate
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.postproc.wear.coefficient import laboratory_coefficient
from bulkwear.workflows.cases.circular_tester.packings import PACKING, interval_columns
from bulkwear.workflows.cases.circular_tester.runs import TesterRun
from bulkwear.workflows.cases.circular_tester.volume import settings_of, shared_revolutions, volumes_at

SECONDS_PER_HOUR = 3600.0
SHORT, LONG = "short_test", "long_test"  # published hours
TOO_FEW = "too few revolutions to go beyond them"
TOO_FAR = f"more than {FARTHEST:g} times the simulated revolutions"


@dataclass(frozen=True)
class TimeScale:
    """What simulated wear stands for.

    revolutions_of_short_test: in which the plain sample loses what it lost in the short test, over its packings
    short_test: hours of it; simulated_revolutions: of the plain sample
    wear_coefficient: 1/Pa, that makes the published number of revolutions stand for the short test instead
    simulated_coefficient: 1/Pa; laboratory_coefficient: 1/Pa, of the test itself by its pressure and distance
    distance_scale: -, distance of the test over that of the revolutions which stand for it
    """

    revolutions_of_short_test: Estimate
    short_test: float
    simulated_revolutions: float
    wear_coefficient: Estimate
    simulated_coefficient: float
    laboratory_coefficient: float
    distance_scale: float

    @property
    def hours_per_revolution(self) -> float:
        """Return hours per revolution."""
        return self.short_test / self.revolutions_of_short_test.value

    def revolutions(self, hours: float) -> float:
        """Return the revolutions that stand for hours of the test."""
        return hours / self.hours_per_revolution

    def table(self) -> pd.DataFrame:
        """Return one row with all numbers, intervals as <name>_low and <name>_high."""
        needed = interval_columns("revolutions_of_short_test", self.revolutions_of_short_test)
        numbers = {
            "packings": self.revolutions_of_short_test.packings,
            "hours_per_revolution": self.hours_per_revolution,
            **needed,
            "simulated_revolutions": self.simulated_revolutions,
            **interval_columns("wear_coefficient", self.wear_coefficient),
            "simulated_coefficient": self.simulated_coefficient,
            "laboratory_coefficient": self.laboratory_coefficient,
            "distance_scale": self.distance_scale,
        }
        return pd.DataFrame([numbers])


def time_scale(lost: pd.DataFrame, plain: TesterRun, published: pd.DataFrame) -> TimeScale:
    """Coefficient and time scale from the plain sample's short test: patterned samples have no part in them.

    lost: volumes of the plain setting of series `volume`, all its packings; plain: one of its runs; published: as
    config/published/circular_tester.csv
    Hours are told by the volume. Beyond the run the plain sample goes on at its mean rate, as it has no other in the
    source. The laboratory's coefficient uses its pressure on the sample's area, and 0.6 m/s for 56 h (121 km); the
    source's own 84.6 km do not fit these.
    """

    def laboratory(quantity: str) -> float:
        return published_value(published, quantity, "laboratory")

    volume, hours = laboratory("plain_volume_56_h"), laboratory(SHORT)
    stand_for = published_value(published, "revolutions_of_short_test", "simulation")
    packings = [one.sort_values("revolution") for _, one in lost.groupby(PACKING, sort=False)]
    needed = estimate([revolution_of(one, volume) for one in packings], log=True)
    coefficient = estimate([plain.coefficient * volume / _at_mean_rate(one, stand_for) for one in packings], log=True)
    distance = laboratory("velocity_at_centre") * hours * SECONDS_PER_HOUR
    load = 1e3 * laboratory("normal_pressure") * plain.width * plain.length
    of_laboratory, _ = laboratory_coefficient(volume / CUBIC_MILLIMETRES, 0.0, load, distance)
    return TimeScale(
        revolutions_of_short_test=needed,
        short_test=hours,
        simulated_revolutions=shared_revolutions(lost),
        wear_coefficient=coefficient,
        simulated_coefficient=plain.coefficient,
        laboratory_coefficient=of_laboratory,
        distance_scale=distance / (needed.value * plain.distance_per_revolution),
    )


def _volumes(one: pd.DataFrame) -> tuple[np.ndarray, np.ndarray]:
    return one["revolution"].to_numpy(float), CUBIC_MILLIMETRES * one["volume_m3"].to_numpy(float)


def revolution_of(one: pd.DataFrame, volume: float) -> float:
    """Revolution at which a run has lost a volume (mm3), at its mean rate beyond its end."""
    revolutions, lost = _volumes(one)
    if volume > lost[-1]:
        return volume * revolutions[-1] / lost[-1]
    return float(np.interp(volume, lost, revolutions))


def _at_mean_rate(one: pd.DataFrame, revolution: float) -> float:
    """Volume (mm3) that a run has lost after a revolution, at its mean rate beyond its end."""
    revolutions, lost = _volumes(one)
    if revolution > revolutions[-1]:
        return lost[-1] * revolution / revolutions[-1]
    return float(np.interp(revolution, revolutions, lost))


def predictions(lost: pd.DataFrame, scale: TimeScale, hours: Sequence[float]) -> pd.DataFrame:
    """Volume of every setting after hours of the test, and the reduction against plain in equal machines.

    lost: volumes of settings, all packings. Columns: those of SETTING, hours, revolution, packings, volume_mm3,
    reduction_percent (of a volume over that of the plain sample in the same packing, NaN without one), each with
    <name>_low and <name>_high: the prediction interval, in which one further packing falls, NaN of one packing. As the
    plain sample tells the hours, a patterned volume is as unsure as its ratio to that of a plain sample beside it.
    extrapolated (True: beyond the run's last revolution), reason: why there is no volume.
    """
    rows = []
    for setting, own in settings_of(lost):
        same = (lost["shape"] == setting["shape"]) & (lost["particle_scale"] == setting["particle_scale"])
        plain = lost[same & (lost["surface"] == PLAIN)]
        for each in hours:
            revolution = scale.revolutions(each)
            found, beside = (volumes_at(table, revolution) for table in (own, plain))
            volume, ratio = estimate(found, log=True), estimate((found / beside).dropna(), log=True)
            row = {**setting, "hours": each, "revolution": revolution, "packings": len(found)}
            told_beside = setting["surface"] != PLAIN and not beside.empty
            row |= _volume(volume, ratio if told_beside else volume) | _reduction(ratio)
            ratio_to_run = revolution / shared_revolutions(own)
            lacking = "" if np.isfinite(volume.value) else (TOO_FAR if ratio_to_run > FARTHEST else TOO_FEW)
            rows.append(row | {"extrapolated": ratio_to_run > 1.0, "reason": lacking})
    return pd.DataFrame(rows)


def _volume(volume: Estimate, unsure: Estimate) -> dict[str, float]:
    low, high = (volume.value * end / unsure.value for end in unsure.of_one_more())
    return {"volume_mm3": volume.value, "volume_mm3_low": low, "volume_mm3_high": high}


def _reduction(ratio: Estimate) -> dict[str, float]:
    low, high = ratio.of_one_more()
    ends = {"": ratio.value, "_low": high, "_high": low}
    return {f"reduction_percent{ending}": 100.0 * (1.0 - value) for ending, value in ends.items()}
