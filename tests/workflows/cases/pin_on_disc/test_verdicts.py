"""Verdicts on the source's findings, of runs whose trends are known."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.verdicts import AGREES, CONTRADICTS, OTHER_SIZE, UNSAID
from bulkwear.workflows.cases.pin_on_disc.run_in import TESTED
from bulkwear.workflows.cases.pin_on_disc.verdicts import EVIDENCE, Tables, verdict_table
from bulkwear.workflows.cases.pin_on_disc.volume import VOLUMES, law_volume
from bulkwear.workflows.config.claims import claims_of

CLAIMS = claims_of("pin_on_disc")
LOAD, TRACK = 5.0, 22e-3  # N, m
REVOLUTION = np.arange(1, 13)
SCATTER = 0.005  # -, of what a revolution adds
SCHEMES = ("conserving", "per_triangle")
FITS = {1.7e-11: (0.03, 0.001), 5e-11: (0.098, 0.011)}  # mm3: Eq 5.13 and 5.15 without their constants
READINGS = 3
ELEMENTS = np.linspace(0.1, 1.0, 10)  # mm


def volumes(touched=None):
    """Runs of both schemes and coefficients; what is removed grows linearly, 2 alpha F L.

    touched: linear and quadratic term (mm3) of Eq 5.9 over touched triangles, by coefficient; linear as well without
    """
    rng, parts = np.random.default_rng(1), []
    for scheme in SCHEMES:
        for coefficient, (linear, quadratic) in FITS.items():
            law = 2.0 * law_volume(coefficient, LOAD, TRACK, 1.0)
            noise = SCATTER * rng.standard_normal(len(REVOLUTION))
            same = law * np.cumsum(1.0 + noise)
            bent = 1e-9 * np.cumsum((linear + quadratic * (2 * REVOLUTION - 1)) * (1.0 + noise)) if touched else same
            named = dict.fromkeys(VOLUMES.values(), same) | {VOLUMES["Eq 5.9, touched"]: bent}
            names = {"run": f"{scheme}{coefficient}", "scheme": scheme, "wear_coefficient_per_pa": coefficient}
            fixed = {"load_n": LOAD, "track_radius_m": TRACK, "revolution": REVOLUTION}
            parts.append(pd.DataFrame({**names, **fixed, **named}))
    return pd.concat(parts, ignore_index=True)


def statistics(settled):
    """Contours of the reference runs: depth grows linearly, the opening ever more slowly; their deviation over their
    mean is level from a revolution on.
    """
    rng, parts = np.random.default_rng(2), []
    for scheme in SCHEMES:
        for size, mean in (("depth", 1e-5 * REVOLUTION), ("opening width", 1e-4 * (REVOLUTION - 0.03 * REVOLUTION**2))):
            noise = 1.0 + SCATTER * rng.standard_normal(len(REVOLUTION))
            ratio = (0.1 + 0.02 * np.maximum(settled - REVOLUTION, 0)) * noise
            names = {"run": f"{scheme}{5e-11}", "scheme": scheme, "size": size, "revolution": REVOLUTION}
            parts.append(pd.DataFrame({**names, "mean_m": mean, "deviation_m": ratio * mean}))
    return pd.concat(parts, ignore_index=True)


def meshes(elements):
    """Depth falls and opening rises with the size of the elements (mm)."""
    noise = SCATTER * np.random.default_rng(3).standard_normal(len(elements))
    sizes = {"depth": 0.02 - 0.01 * elements + 0.02 * noise, "opening width": 0.8 + elements + noise}
    parts = [pd.DataFrame({"size": name, "element_size_mm": elements, "mean_mm": mean}) for name, mean in sizes.items()]
    return pd.concat(parts, ignore_index=True).assign(scheme="per_triangle")


def verdicts(of_volumes, settled=8, elements=ELEMENTS):
    """The table of verdicts, by claim and what it is of."""
    table = verdict_table(Tables(of_volumes, statistics(settled), meshes(elements)), CLAIMS)
    return table.set_index(["key", "of"])


@pytest.fixture(scope="module")
def straight():
    """Of runs whose volumes grow linearly."""
    return verdicts(volumes())


def test_every_claim_has_evidence():
    """The file of claims and the evidence name the same."""
    assert set(EVIDENCE) == set(CLAIMS)


def test_the_published_growth_agrees_with_itself():
    """Volumes of the published fits agree in excess and in curvature, of the reading that has them."""
    found = verdicts(volumes(touched=FITS)).xs("per triangle, Eq 5.9, touched", level="of")["verdict"]
    for key in ("excess_calibrated", "excess_reference", "curved_calibrated", "curved_reference", "curved_more"):
        assert found[key] == AGREES, key


def test_linear_growth_is_no_curvature(straight):
    """Linear volumes at twice alpha F L: above it as claimed, by another size; whether they bend up cannot be said."""
    excess = straight.loc["excess_reference"]
    assert excess["verdict"].tolist() == [OTHER_SIZE] * READINGS
    assert excess["factor"].tolist() == pytest.approx([1.0 / 5.85] * READINGS, rel=0.05)  # of the excess over 1
    assert straight.loc["curved_reference", "verdict"].isin([UNSAID, OTHER_SIZE]).all()
    assert (straight.loc["depth_linear", "verdict"] == AGREES).all()
    assert (straight.loc["width_slows", "verdict"] == AGREES).all()


def test_a_run_in_at_eight_agrees_and_one_at_four_does_not(straight):
    """The corner of a broken line with its interval, inside the margin or outside of it; none found says nothing."""
    sizes = [f"{scheme.replace('_', ' ')}, deviation of {size} over its mean" for scheme in SCHEMES for size in TESTED]
    early = verdicts(volumes(), settled=4)
    assert (straight.loc["run_in", "verdict"][sizes] == AGREES).all()
    assert (early.loc["run_in", "verdict"][sizes] == CONTRADICTS).all()
    level = straight.loc[("run_in", "conserving, volume removed per revolution")]
    assert (level["verdict"], level["reason"]) == (UNSAID, "no run-in found")


def test_meshes_are_judged_over_the_claimed_sizes(straight):
    """Ten meshes from 0.1 to 1 mm agree; of three up to 0.3 mm nothing can be said."""
    keys = ["shallower_on_coarse_meshes", "wider_on_coarse_meshes"]
    assert (straight.loc[keys, "verdict"] == AGREES).all()
    few = verdicts(volumes(), elements=np.array([0.1, 0.2, 0.3]))
    assert (few.loc[keys, "verdict"] == UNSAID).all()


def test_runs_that_are_not_there_say_nothing():
    """Without the reference coefficient, and of fewer revolutions than are claimed, nothing can be said."""
    one = volumes()
    only = verdicts(one[one["wear_coefficient_per_pa"] < 2e-11])["verdict"]
    assert (only["excess_reference"] == UNSAID).all() and (only["curved_more"] == UNSAID).all()
    short = verdicts(one[one["revolution"] <= 6])
    assert (short.loc["excess_calibrated", "reason"] == "claimed of 0 to 12 revolutions, the runs cover 0 to 6").all()
