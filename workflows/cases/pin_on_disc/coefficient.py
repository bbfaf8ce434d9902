"""Wear coefficient from a laboratory volume: directly, and so that few simulated revolutions stand for many."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.postproc.wear.coefficient import coefficient_of_volume, laboratory_coefficient, scaling_factor
from bulkwear.workflows.cases.pin_on_disc.runs import over_test
from bulkwear.workflows.cases.pin_on_disc.volume import published_volume

CALIBRATED_FROM = 8  # revolutions on, where the thesis has its run-in behind it
TOUCHED = "per triangle, volume by Eq 5.9 over touched triangles"
PUBLISHED_FITS = "Yan 2022, Eq 5.11 to 5.15"


def calibration_table(
    simulated: pd.DataFrame, volume: float, volume_error: float, test_revolutions: float
) -> pd.DataFrame:
    """Coefficient that makes each number of revolutions stand for the laboratory's volume, per scheme.

    simulated : `scheme`, `revolution`, `wear_coefficient_per_pa`, `volume_m3`; volume and volume_error : m3.
    Columns: scheme, revolutions, scaling_factor, wear_coefficient_per_pa, least_ and largest_ of it (volume less and
    plus its error), interpolated (False: beyond the simulated coefficients, in proportion), simulated_coefficients.
    """
    rows = []
    for (scheme, revolution), cases in simulated.groupby(["scheme", "revolution"], sort=False):
        known = (cases["wear_coefficient_per_pa"].to_numpy(), cases["volume_m3"].to_numpy())
        targets = (volume, volume - volume_error, volume + volume_error)
        (best, within), (least, _), (largest, _) = (coefficient_of_volume(*known, target) for target in targets)
        rows.append(
            {
                "scheme": scheme,
                "revolutions": revolution,
                "scaling_factor": float(scaling_factor(test_revolutions, revolution)),
                "wear_coefficient_per_pa": best,
                "least_wear_coefficient_per_pa": least,
                "largest_wear_coefficient_per_pa": largest,
                "interpolated": within,
                "simulated_coefficients": len(cases),
            }
        )
    return pd.DataFrame(rows)


def calibrated(volumes: pd.DataFrame, fits: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Calibration of both schemes, of Eq 5.9 and of the published fits against the laboratory's volume.

    volumes : of all runs, taken over load times track and times those of the laboratory; each number of revolutions
    from CALIBRATED_FROM on (or the last, if a run is shorter) is calibrated with the runs that have it; the published
    fits where they grow with the coefficient. As from `calibration_table`.
    """
    ours = volumes[volumes["series"] == "coefficient"].rename(columns={"removed_volume_m3": "volume_m3"})
    touched = ours[ours["scheme"] == "per_triangle"]
    touched = touched.assign(volume_m3=touched["touched_centroid_path_volume_m3"], scheme=TOUCHED)
    ours = pd.concat([ours, touched], ignore_index=True)
    ours["volume_m3"] /= over_test(ours, published)
    longest = int(ours["revolution"].max())
    shown = range(min(CALIBRATED_FROM, longest), longest + 1)
    simulated = pd.concat([ours[ours["revolution"].isin(shown)], growing_fits(fits, shown)], ignore_index=True)
    volume, error = laboratory_volume(published)
    return calibration_table(simulated, volume, error, published_value(published, "revolutions", "laboratory"))


def growing_fits(fits: pd.DataFrame, revolutions: Sequence[int]) -> pd.DataFrame:
    """Volumes (m3) by the published fits after those revolutions where they grow with the wear coefficient.

    After 1 and 2 the fit of 2e-11 1/Pa lies below that of 1.7e-11 (Yan 2022, Eq 5.11 to 5.15): no coefficient
    follows from a volume. Columns: scheme, revolution, wear_coefficient_per_pa, volume_m3.
    """
    coefficients = np.sort(fits["wear_coefficient_per_pa"].to_numpy())
    parts = []
    for revolution in revolutions:
        volume = np.array([float(published_volume(fits, coefficient, revolution)) for coefficient in coefficients])
        if volume[0] > 0.0 and (np.diff(volume) > 0.0).all():
            columns = {"scheme": PUBLISHED_FITS, "revolution": revolution, "wear_coefficient_per_pa": coefficients}
            parts.append(pd.DataFrame(columns | {"volume_m3": volume}))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()


def laboratory_volume(published: pd.DataFrame) -> tuple[float, float]:
    """The laboratory's volume and its error, m3."""
    row = published[(published["quantity"] == "volume") & (published["of"] == "laboratory")].iloc[0]
    return row["value"] / CUBIC_MILLIMETRES, row["uncertainty"] / CUBIC_MILLIMETRES


def coefficient_of_laboratory(published: pd.DataFrame) -> tuple[float, float]:
    """Wear coefficient of the laboratory's test by Archard's law and its error, 1/Pa."""
    load, distance = (published_value(published, name, "laboratory") for name in ("load", "sliding_distance"))
    return laboratory_coefficient(*laboratory_volume(published), load, distance)


def beside_laboratory(table: pd.DataFrame, laboratory: tuple[float, float]) -> pd.DataFrame:
    """A table as from `calibration_table` with the laboratory's coefficient and error (1/Pa) times the scaling factor:
    laboratory_per_pa and the ends of its range.
    """
    value, error = laboratory
    ends = {"laboratory_per_pa": value, "laboratory_low_per_pa": value - error, "laboratory_high_per_pa": value + error}
    return table.assign(**{name: each * table["scaling_factor"] for name, each in ends.items()})


def scaling_limits(run_in: pd.DataFrame, test_revolutions: float) -> pd.DataFrame:
    """Largest scaling factor of each run, which its run-in allows: `run`, `run_in_revolution`, `largest_factor`.

    run_in : as from `run_in.run_in_table`. NaN where the run-in has not ended: then the factor lies below that of all
    revolutions of the run. A run-in of 1 sets no limit: that factor is the whole test in one revolution. For 8
    revolutions Yan (2022, section 5.6) has 162.8.
    """
    return run_in[["run", "run_in_revolution"]].assign(
        largest_factor=scaling_factor(test_revolutions, run_in["run_in_revolution"].to_numpy(dtype=float))
    )


def step_cap_limits(volumes: pd.DataFrame, laboratory: float) -> pd.DataFrame:
    """Scaling factor at which the steps of wear updates reach their cap: `run`, `largest_factor_by_step_cap`.

    volumes : `run`, `wear_coefficient_per_pa`, `revolution` and `step_demand` (largest step asked for over its cap);
    laboratory : coefficient, 1/Pa. Steps grow with the coefficient; beyond, wear is carried and lags behind. Holds for
    the run's wear cycles per revolution and element size: steps grow with the arc of an update, caps with the edges.
    """
    last = volumes.loc[volumes.groupby("run", sort=False)["revolution"].idxmax()]
    factor = last["wear_coefficient_per_pa"] / laboratory / last["step_demand"]
    return pd.DataFrame({"run": last["run"], "largest_factor_by_step_cap": factor}).reset_index(drop=True)
