"""Findings of the source put to the test, on evidence that is made to agree, to disagree and to be too little."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.verdicts import CONFIRMED, REFUTED, UNSAID
from bulkwear.workflows.cases.sliding_sample.evaluation import CONTINUOUS, DISCONTINUOUS, MEASURES
from bulkwear.workflows.cases.sliding_sample.screening.finding_tests import findings_table
from bulkwear.workflows.cases.sliding_sample.screening.findings import gather, runs_beside_source, side_of_one
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import (
    published_wear_by_row,
    regression_tables,
    screen_summary,
)
from tests import REPOSITORY as ROOT
from tests.support.screening_study import FACTORS

PUBLISHED = ROOT / "config" / "published"
DIGITS = 0.01  # -, relative: coefficients of Table 3.10 have three digits
LAYERS = 4
CONTINUOUS_ROWS = ("R1", "R3", "R5", "R8", "R9", "R11", "R12", "R13")
RATIOS = {"R5": 0.34, "R12": 1.2, "R2": 0.5}  # wear over plain as the source has it; others 0.8
SELF = {f"R{k}": f"R{k}" for k in range(1, 14)}


def read(name):
    return pd.read_csv(PUBLISHED / f"screening_{name}.csv")


@pytest.fixture(scope="module")
def tables():
    """A study that wears by the published model and flows, turns and presses as the source tells."""
    design = pd.read_csv(ROOT / "config/designs/screening.csv")
    wear = design["row"].map(published_wear_by_row(design, read("coefficients"), FACTORS)).to_numpy()
    wear = 1e-9 * wear * np.exp(np.random.default_rng(3).normal(0.0, 0.02, 13))
    ratio = design["row"].map(RATIOS).fillna(0.8).to_numpy()
    base = np.where(design["row"] == "R12", 0.2, 0.7)
    shared = {"travel_m": 0.7, "particle_scale": 1.0}
    convex = design.assign(surface="convex", worn_volume_m3=0.7 * wear, base_worn_volume_m3=0.7 * wear * base)
    convex = convex.assign(wear_over_plain=ratio, mean_normal_force_N=6.0, **shared)
    plain = design.assign(surface="plain", worn_volume_m3=0.7 * wear / ratio, base_worn_volume_m3=0.7 * wear / ratio)
    plain = plain.assign(wear_over_plain=1.0, mean_normal_force_N=4.0, **shared)
    summary = pd.concat([convex, plain], ignore_index=True)
    summary["run"] = summary["row"] + "_" + summary["surface"]
    summary["pattern_worn_volume_m3"] = summary["worn_volume_m3"] - summary["base_worn_volume_m3"]
    summary["worn_volume_per_metre_m3_per_m"] = summary["worn_volume_m3"] / summary["travel_m"]
    flows = summary["row"].isin(CONTINUOUS_ROWS)
    regimes = summary[["run", "row", "surface"]].assign(
        relative_velocity=np.where(flows, 0.4, 0.97), regime=np.where(flows, CONTINUOUS, DISCONTINUOUS), steady=True
    )
    gradients = regimes.assign(travel_mm=1.0, relative_gradient=np.where(flows, 0.6, 0.1))
    study = screen_summary(summary, FACTORS)
    found = regression_tables(study, read("coefficients"), read("contours"))
    return {
        "summary": summary,
        "regimes": regimes,
        "profiles": profiles_of(summary),
        "gradients": gradients,
        "steady": steady_of(regimes),
        "coefficients": found["coefficients"],
        "models": found["models"],
        "published_results": read("results"),
        "published_coefficients": read("coefficients"),
    }


def steady_of(regimes):
    """Both measures of every run steady, within 3 % of their mean."""
    line = regimes[["run", "row", "surface"]].assign(mean=1.0, deviation=0.03, steady=True)
    return pd.concat([line.assign(measure=measure) for measure in MEASURES], ignore_index=True)


def profiles_of(summary):
    """Layers that slow down and turn less upwards; R5 takes its bottom layer along, R2 turns particles as its twin."""
    parts = []
    for zone, strength in (("central", 1.0), ("side", 0.3)):
        for layer in range(1, LAYERS + 1):
            convex = np.where(summary["row"] == "R2", 110.0, 300.0)
            spin = np.where(summary["surface"] == "plain", 100.0, convex) * strength / layer
            share = np.where(summary["surface"] == "plain", 0.05, 0.75) / layer
            parts.append(
                summary[["run", "row", "surface"]].assign(
                    zone=zone,
                    layer=layer,
                    velocity_m_per_s=share * summary["velocity_m_per_s"],
                    averaged_angular_velocity_deg_per_s=spin,
                )
            )
    return pd.concat(parts, ignore_index=True)


def verdicts(tables, run_in=1000.0, settings=SELF):
    """Verdict and reason by key."""
    study = screen_summary(tables["summary"], FACTORS)
    evidence = gather(tables, study, run_in, settings, SELF)
    return findings_table(evidence, read("findings"), read("regimes")).set_index("key")


def test_what_agrees_is_confirmed(tables):
    """Runs that do in all what the source tells confirm every finding, with numbers and without reserve."""
    table = verdicts(tables)
    assert table["verdict"].to_dict() == dict.fromkeys(table.index, CONFIRMED)
    assert (table["found"] != "").all()
    assert (table["reason"] == "").all()
    assert "R5 -66 %" in table.loc["r5_lowest", "found"]
    assert "t +1.4" in table.loc["thickness_strongest", "found"]


def test_what_disagrees_is_not_confirmed(tables):
    """R12 wearing less, R3 wearing more, forces and spins as on plain samples, bumps wearing most."""
    summary = tables["summary"].assign(mean_normal_force_N=4.0)
    summary["wear_over_plain"] = summary["wear_over_plain"].mask(summary["run"] == "R12_convex", 0.7)
    summary["wear_over_plain"] = summary["wear_over_plain"].mask(summary["run"] == "R3_convex", 1.3)
    summary[["base_worn_volume_m3", "pattern_worn_volume_m3"]] = summary[["pattern_worn_volume_m3"] * 2].to_numpy()
    profiles = tables["profiles"].assign(averaged_angular_velocity_deg_per_s=lambda each: 10.0 * each["layer"])
    table = verdicts({**tables, "summary": summary, "profiles": profiles})
    keys = ["convex_wears_less", "r12_wears_more", "base_wears_most", "normal_force_up", "force_up_wear_down"]
    assert table.loc[[*keys, "rolling_at_surface", "rolling_falls"], "verdict"].unique().tolist() == [REFUTED]
    assert "R3 1.30" in table.loc["convex_wears_less", "found"]


def test_an_unsteady_flow_decides_no_regime(tables):
    """Where the travel ends before the source's flow is steady, regimes cannot be said and the rest has a reserve."""
    table = verdicts({**tables, "regimes": tables["regimes"].assign(steady=False)}, run_in=40.0)
    regimes = ["continuous_runs", "discontinuous_runs", "continuous_range", "discontinuous_range", "gradient_by_regime"]
    assert table.loc[regimes, "verdict"].unique().tolist() == [UNSAID]
    assert "the travel ends after 740 mm, the source's flow is steady from 800 mm on" in table.loc[regimes[0], "reason"]
    assert table.loc["normal_force_up", ["verdict", "reason"]].tolist() == [
        CONFIRMED,
        "the flow over 13 of 13 is not shown to be steady",
    ]


def test_steadiness_is_of_flow_and_wear(tables):
    """A run whose wear is not steady, or a scatter of 10 %, refute it; a short travel tells nothing."""
    unsteady = tables["steady"]["steady"] & (tables["steady"]["run"] != "R4_convex")
    for changed in ({"steady": unsteady}, {"deviation": 0.1}):
        table = verdicts({**tables, "steady": tables["steady"].assign(**changed)})
        assert table.loc["steady_flow", "verdict"] == REFUTED
    assert verdicts(tables, run_in=40.0).loc["steady_flow", "verdict"] == UNSAID


def test_an_aliased_scale_leaves_the_thickness_open(tables):
    """Where the particle scale follows the thickness, neither its effect nor the terms can be said."""
    scale = np.where(tables["summary"]["bed_thickness_mm"] > 10.0, 2.0, 1.26)
    table = verdicts({**tables, "summary": tables["summary"].assign(particle_scale=scale)})
    for key in ("thickness_strongest", "same_terms"):
        assert table.loc[key, "verdict"] == UNSAID
        assert table.loc[key, "reason"] == "t cannot be told from the particle scale"


def test_a_model_by_chance_tells_of_no_term(tables):
    """Where permutations find as good a model, neither a term that it has nor one that it lacks is judged."""
    models = tables["models"].assign(p_value_permutation=0.2)
    table = verdicts({**tables, "models": models})
    for key in ("thickness_strongest", "same_terms", "no_effect_of_height"):
        assert table.loc[key, "verdict"] == UNSAID
        assert table.loc[key, "reason"] == "a model as good comes by chance in 20 % of permutations"


def test_a_term_of_a_model_as_good_is_not_absent(tables):
    """That the best model lacks the height says nothing where one as good has it."""
    best = tables["models"].iloc[[0]]
    models = pd.concat([best, best.assign(model=f"{best['model'].iloc[0]} + h"), tables["models"].iloc[1:]])
    table = verdicts({**tables, "models": models})
    assert table.loc["no_effect_of_height", "verdict"] == UNSAID
    assert table.loc["no_effect_of_height", "reason"] == "models as good as the best have h"


def test_without_a_regression_the_other_findings_stand(tables):
    """Too few rows for a regression: what it would tell cannot be said, the rest is judged as ever."""
    few = {name: table for name, table in tables.items() if name not in ("coefficients", "models")}
    evidence = gather(few, None, 1000.0, SELF, SELF)
    table = findings_table(evidence, read("findings"), read("regimes")).set_index("key")
    of_regression = ["thickness_strongest", "same_terms", "no_effect_of_height"]
    assert table.loc[of_regression, "verdict"].unique().tolist() == [UNSAID]
    assert table.loc["same_terms", "reason"] == "the study has no regression on the source's factors"
    assert table.drop(index=of_regression)["verdict"].unique().tolist() == [CONFIRMED]
    assert runs_beside_source(evidence, read("regimes"), {})["published_model"].isna().all()


def test_rows_that_were_not_run_are_named(tables):
    """Without R5, R2 and R12 what is told of them cannot be said; the rest is."""
    names = ("summary", "regimes", "profiles", "gradients", "steady")
    left = {name: tables[name][~tables[name]["row"].isin(["R5", "R2", "R12"])] for name in names}
    table = verdicts({**tables, **left})
    for key in (
        "r5_lowest",
        "r12_wears_more",
        "rolling_at_surface",
        "rolling_falls",
        "discontinuous_runs",
        "r2_lowest",
    ):
        assert table.loc[key, "verdict"] == UNSAID and table.loc[key, "reason"]
    assert table.loc["normal_force_up", "verdict"] == CONFIRMED


def test_one_regime_alone_compares_nothing(tables):
    """Where all runs flow continuously, what is told of the other regime cannot be said."""
    one = {name: tables[name].assign(regime=CONTINUOUS, relative_velocity=0.4) for name in ("regimes", "gradients")}
    table = verdicts({**tables, **one})
    for key in ("discontinuous_range", "gradient_by_regime", "r2_lowest", "rolling_discontinuous"):
        assert table.loc[key, "verdict"] == UNSAID
    assert table.loc["discontinuous_runs", "verdict"] == REFUTED


def test_what_was_not_measured_decides_nothing(tables):
    """Without plain twins, with one layer, or without particles over a twin nothing is confirmed or refuted."""
    convex = tables["summary"]["surface"] != "plain"
    summary = tables["summary"].assign(wear_over_plain=tables["summary"]["wear_over_plain"].mask(convex))
    table = verdicts({**tables, "summary": summary})
    assert table.loc[["r5_lowest", "r2_lowest"], "verdict"].unique().tolist() == [UNSAID]
    profiles = tables["profiles"]
    assert verdicts({**tables, "profiles": profiles[profiles["layer"] == 1]}).loc["rolling_falls", "verdict"] == UNSAID
    table = verdicts({**tables, "profiles": profiles[~profiles["run"].isin(["R2_plain", "R5_plain"])]})
    keys = ["rolling_discontinuous", "bottom_layer_taken_along", "rolling_at_surface"]
    assert table.loc[keys, "verdict"].unique().tolist() == [UNSAID]
    assert not table["found"].str.contains("nan").any()


def test_best_run_of_another_regime_is_not_compared(tables):
    """R5 flowing discontinuously is no case of what the source tells of continuous runs."""
    regimes = tables["regimes"].assign(
        regime=tables["regimes"]["regime"].mask(tables["regimes"]["row"] == "R5", DISCONTINUOUS)
    )
    assert verdicts({**tables, "regimes": regimes}).loc["r5_lowest", "verdict"] == UNSAID


def test_layers_of_replicates_are_averaged(tables):
    """Two packings whose layers fall alike confirm that speeds fall, though one lies above the other everywhere."""
    study = screen_summary(tables["summary"], FACTORS)
    evidence = gather(tables, study, 1000.0, SELF, SELF)
    other = evidence.profiles.assign(
        averaged_angular_velocity_deg_per_s=1.02 * evidence.profiles["averaged_angular_velocity_deg_per_s"]
    )
    evidence = replace(evidence, profiles=pd.concat([evidence.profiles, other], ignore_index=True))
    table = findings_table(evidence, read("findings"), read("regimes")).set_index("key")
    assert table.loc["rolling_falls", "verdict"] == CONFIRMED


def test_a_ratio_near_one_needs_replicates():
    """1.03 is not told from 1 without replicates; with them it is, if their interval leaves out 1."""
    alone = {"interval_low": np.nan, "interval_high": np.nan}
    for value, interval, side in (
        (1.03, alone, 0),
        (0.97, alone, 0),
        (1.06, alone, 1),
        (0.9, alone, -1),
        (1.03, {"interval_low": 1.01, "interval_high": 1.05}, 1),
        (0.8, {"interval_low": 0.6, "interval_high": 1.05}, 0),
    ):
        assert side_of_one(pd.Series({"wear_over_plain": value, **interval})) == side


def test_published_model_at_its_own_runs():
    """At the middle of all factors it gives exp(-1.859), at R5 (v, t, b and d high) the sum of Table 3.10."""
    design = pd.read_csv(ROOT / "config/designs/screening.csv")
    found = published_wear_by_row(design, read("coefficients"), FACTORS)
    assert found["R6"] == pytest.approx(np.exp(-1.859), rel=DIGITS)
    assert found["R5"] == pytest.approx(np.exp(-1.859 + 0.650 + 1.426 - 0.633), rel=DIGITS)
    assert published_wear_by_row(design, read("coefficients"), {"a": "major_radius_mm"}) == {}


def test_runs_stand_beside_the_source(tables):
    """Regime, published regime and wear of every row; what the source does not tell is empty."""
    study = screen_summary(tables["summary"], FACTORS)
    evidence = gather(tables, study, 1000.0, SELF, SELF)
    table = runs_beside_source(evidence, read("regimes"), {"R5": 0.66}).set_index("row")
    assert table.loc["R5", ["regime", "published_regime", "published_wear_over_plain"]].tolist() == [
        CONTINUOUS,
        CONTINUOUS,
        "0.34",
    ]
    assert table.loc["R12", "published_wear_over_plain"] == "above 1"
    assert table.loc["R4", ["published_regime", "published_wear_over_plain"]].tolist() == ["", ""]
    assert table["normalised_wear"].max() == 1.0
    assert table.loc["R5", "published_model"] == 0.66
    assert np.isnan(table.loc["R6", "published_model"])


def test_without_plain_twins_no_relative_wear_is_judged(tables):
    """Rows that flow but have no plain twin say so, instead of being called too near to 1."""
    alone = tables["summary"].assign(wear_over_plain=np.nan)
    alone = alone[alone["surface"] != "plain"]
    table = verdicts(tables | {"summary": alone})
    keys = ["convex_wears_less", "r12_wears_more", "force_up_wear_down"]
    assert table.loc[keys, "verdict"].unique().tolist() == [UNSAID]
    assert table.loc[keys, "reason"].str.contains("plain twin with a result").all()
