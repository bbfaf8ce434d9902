"""Wear coefficient from a laboratory volume: directly, and so that few simulated revolutions stand for many."""

from __future__ import annotations

import pandas as pd

from postproc.wear.coefficient import coefficient_of_volume, scaling_factor


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


def scaling_limits(run_in: pd.DataFrame, test_revolutions: float) -> pd.DataFrame:
    """Largest scaling factor of each run, which its run-in allows: `run`, `run_in_revolution`, `largest_factor`.

    run_in : as from `analysis.run_in.run_in_table`. NaN where the run-in has not ended: then the factor lies below
    that of all revolutions of the run. A run-in of 1 sets no limit: that factor is the whole test in one revolution.
    For 8 revolutions Yan (2022, section 5.6) has 162.8.
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
