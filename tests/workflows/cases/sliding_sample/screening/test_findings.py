"""Claims of the source held against made-up runs that do as it tells, the opposite, another size, or too little."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.statistics.verdicts import AGREES, CONTRADICTS, ERROR_RATE, OTHER_SIZE, UNSAID
from bulkwear.workflows.cases.sliding_sample.evaluation import CONTINUOUS, DISCONTINUOUS, MEASURES
from bulkwear.workflows.cases.sliding_sample.screening.finding_tests import (
    BUILDERS,
    findings_table,
    main_effects,
    verdict_on,
)
from bulkwear.workflows.cases.sliding_sample.screening.findings import MIXED, SPIN, VELOCITY, gather, runs_beside_source
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import published_wear_by_row
from bulkwear.workflows.config.claims import claims_of
from tests import REPOSITORY as ROOT
from tests.support.screening_study import FACTORS

PUBLISHED = ROOT / "config" / "published"
DIGITS = 0.01  # -, relative: coefficients of Table 3.10 have three digits
ROUNDING = 1e-9
LAYERS, PACKINGS, NOISE = 4, 3, 0.01  # -, deviation of ln between packings: far below every margin
RUN_IN, TRAVEL = 1000.0, 700.0  # mm, of the source
CONTINUOUS_ROWS = ("R1", "R5", "R8", "R9", "R12", "R13")
RATIOS = {"R5": 0.34, "R12": 1.2, "R2": 0.5}  # wear over plain as the source has it; others 0.8
CLAIMS = claims_of("screening")
DESIGN = pd.read_csv(ROOT / "config/designs/screening.csv")
TRIALS = 100
POWER_TRIALS = 15
SCATTER = 0.07  # -, of ln between packings: that of wear over plain per 100 mm of travel
SURE = 3.0  # standard deviations of a count of trials


def read(name):
    return pd.read_csv(PUBLISHED / f"screening_{name}.csv")


def study(packings=PACKINGS, noise=NOISE, seed=1):
    """The thirteen rows in some packings, which wear by the published model and flow, turn and press as told.

    Patterned and plain samples of a packing share what their bed does to the wear, and scatter by `noise` besides.
    """
    rng = np.random.default_rng(seed)
    model = DESIGN["row"].map(published_wear_by_row(DESIGN, read("coefficients"), FACTORS)).to_numpy()
    ratio = DESIGN["row"].map(RATIOS).fillna(0.8).to_numpy()
    runs = []
    for packing in range(1, packings + 1):
        bed, own = np.exp(rng.normal(0.0, noise, (2, len(DESIGN))))
        rows = DESIGN.assign(setting=DESIGN["row"], packing=packing, travel_m=0.001 * TRAVEL, particle_scale=1.0)
        rows["row"] = rows["row"] + (f"-{packing}" if packing > 1 else "")
        convex = 0.7e-9 * model * bed * own
        for surface, volume in (("convex", convex), ("plain", convex / (ratio * own))):
            runs.append(rows.assign(surface=surface, worn_volume_m3=volume))
    summary = pd.concat(runs, ignore_index=True)
    patterned = summary["surface"] == "convex"
    plain = summary[~patterned].set_index("row")["worn_volume_m3"]
    base = np.where(patterned, np.where(summary["setting"] == "R12", 0.2, 0.7), 1.0)
    force = np.where(patterned, 6.0, 4.0) * np.exp(rng.normal(0.0, noise, len(summary)))
    return summary.assign(
        run=summary["row"] + "_" + summary["surface"],
        base_worn_volume_m3=base * summary["worn_volume_m3"],
        wear_over_plain=summary["worn_volume_m3"] / summary["row"].map(plain),
        mean_normal_force_N=force,
    )


def tables_of(summary, noise=NOISE, seed=2):
    """All tables of a study with that summary."""
    rng = np.random.default_rng(seed)
    flows = summary["setting"].isin(CONTINUOUS_ROWS)
    velocity = np.where(flows, 0.4, 0.99) * np.exp(rng.normal(0.0, noise, len(summary)))
    regimes = summary[["run", "row", "surface"]].assign(
        relative_velocity=velocity, regime=np.where(flows, CONTINUOUS, DISCONTINUOUS)
    )
    deviation = 0.03 * np.exp(rng.normal(0.0, noise, len(summary)))
    line = regimes[["run", "row", "surface"]].assign(published_mean=1.0, published_deviation=deviation, steady=True)
    return {
        "summary": summary,
        "regimes": regimes,
        "profiles": profiles_of(summary, rng, noise),
        "steady": pd.concat([line.assign(measure=measure) for measure in MEASURES], ignore_index=True),
        "published_regimes": read("regimes"),
        "published_results": read("results"),
        "published_coefficients": read("coefficients"),
        "published_design": DESIGN,
    }


def profiles_of(summary, rng, noise):
    """Layers that slow down and turn less upwards; R5 takes its bottom layer along, R2 turns particles as its twin."""
    parts = []
    plain, twin = summary["surface"] == "plain", summary["setting"] == "R2"
    for zone, strength in (("central", 1.0), ("side", 0.3)):
        for layer in range(1, LAYERS + 1):
            spin = np.where(plain, 100.0, np.where(twin, 101.0, 300.0)) * strength / layer
            share = np.where(plain, 0.05, 0.75) / layer * np.exp(rng.normal(0.0, noise, len(summary)))
            names = {"zone": zone, "layer": layer, VELOCITY: share * summary["velocity_m_per_s"]}
            spins = spin * np.exp(rng.normal(0.0, noise, len(summary)))
            parts.append(summary[["run", "row", "surface"]].assign(**names, **{SPIN: spins}))
    return pd.concat(parts, ignore_index=True)


def rows_of(summary):
    """The row of the source of every row of a study."""
    return dict(summary[["row", "setting"]].to_numpy())


def evidence_of(tables, run_in=RUN_IN, factors=FACTORS):
    return gather(tables, run_in, rows_of(tables["summary"]), factors)


def verdicts(tables, **how):
    """Verdict, factor and reason by key."""
    return findings_table(evidence_of(tables, **how), CLAIMS).set_index("key")


@pytest.fixture(scope="module")
def tables():
    return tables_of(study())


def changed(tables, setting, column, value, surface="convex"):
    """Tables whose summary has another value for one setting."""
    summary = tables["summary"]
    here = (summary["setting"] == setting) & (summary["surface"] == surface)
    return {**tables, "summary": summary.assign(**{column: summary[column].mask(here, value)})}


def test_every_claim_has_a_builder_and_a_reason():
    """Claims of the file and builders of the code are the same; each claim says why its margin is what it is."""
    assert set(BUILDERS) == set(CLAIMS)
    text = Path(PUBLISHED / "verdicts.yaml").read_text(encoding="utf-8")
    section = text[text.index("\n  screening:\n") : text.rindex("  particle_size:")]
    assert section.count("      why: ") == len(CLAIMS)


def test_runs_that_do_as_told_agree(tables):
    """Three packings that do in all what the source tells agree with every claim, with numbers and intervals."""
    table = verdicts(tables)
    assert table["verdict"].to_dict() == dict.fromkeys(table.index, AGREES)
    assert table["found"].str.endswith("95 % intervals, 3 packings").all() and (table["reason"] == "").all()
    assert "R5 0.339" in table.loc["r5_reduction", "found"] and "published 0.34" in table.loc["r5_reduction", "claimed"]


def test_the_opposite_contradicts(tables):
    """R12 wearing less, R9 more, forces lower, bumps wearing most, layers the other way round, R2 riding along."""
    summary = tables["summary"]
    convex = summary["surface"] == "convex"
    summary = summary.assign(mean_normal_force_N=summary["mean_normal_force_N"].mask(convex, 3.0))
    summary["base_worn_volume_m3"] = (0.3 * summary["worn_volume_m3"]).where(convex, summary["base_worn_volume_m3"])
    profiles = tables["profiles"].assign(**{SPIN: lambda each: each[SPIN] * each["layer"] ** 2})
    regimes = tables["regimes"].assign(relative_velocity=0.97)
    here = {**tables, "summary": summary, "profiles": profiles, "regimes": regimes}
    for setting, value in (("R12", 0.7), ("R9", 1.3)):
        here = changed(here, setting, "wear_over_plain", value * (1.0 + 0.001 * summary["packing"]))
    table = verdicts(here)
    keys = ["convex_wears_less", "r12_wears_more", "base_wears_most", "normal_force_up", "force_up_wear_down"]
    keys += ["rolling_falls", "continuous_runs", "continuous_range"]
    assert table.loc[keys, "verdict"].to_dict() == dict.fromkeys(keys, CONTRADICTS)


def test_another_size_is_told_with_its_factor(tables):
    """R5 at 0.67 of its twin instead of 0.34 is half of the reduction; twice the effect of all factors is twice."""
    ratio = 0.67 * (1.0 + 0.001 * tables["summary"]["packing"])
    found = verdicts(changed(tables, "R5", "wear_over_plain", ratio)).loc["r5_reduction"]
    assert found["verdict"] == OTHER_SIZE and found["factor"] == pytest.approx(0.5, abs=0.01)
    summary = tables["summary"]
    double = summary.assign(worn_volume_m3=summary["worn_volume_m3"] ** 2 / 1e-9)
    terms = verdicts({**tables, "summary": double}).loc["same_terms"]
    assert terms["verdict"] == OTHER_SIZE and terms["factor"] == pytest.approx(2.0, abs=0.2)


def test_one_packing_says_nothing(tables):
    """Values without a scatter decide no claim, and say so."""
    one = tables["summary"]["packing"] == 1
    runs = set(tables["summary"]["run"][one])
    left = {name: tables[name][tables[name]["run"].isin(runs)] for name in ("regimes", "profiles", "steady")}
    table = verdicts({**tables, **left, "summary": tables["summary"][one]})
    assert (table["verdict"] == UNSAID).all()
    assert (table["reason"] == UNKNOWN).all()
    assert "R5 0.3" in table.loc["r5_reduction", "found"] and "interval" not in table.loc["r5_reduction", "found"]


def test_a_short_travel_says_nothing_unless_it_is_steady(tables):
    """Runs from 40 to 740 mm say nothing of 1000 to 1700 mm where one is not shown to be steady, and else they do."""
    short = verdicts(tables, run_in=40.0)
    assert short.loc["steady_flow", "verdict"] == UNSAID
    assert (short.drop(index="steady_flow")["verdict"] == AGREES).all()
    unsteady = tables["steady"].assign(steady=tables["steady"]["row"] != "R8-2")
    table = verdicts({**tables, "steady": unsteady}, run_in=40.0)
    assert table.loc["normal_force_up", "verdict"] == UNSAID
    said = "claimed of 1000 to 1700 mm of travel, the runs cover 40 to 740; R8 is not shown to be steady"
    assert table.loc["normal_force_up", "reason"] == said
    assert table.loc["r5_reduction", "verdict"] == AGREES
    assert verdicts({**tables, "steady": unsteady}).loc["normal_force_up", "verdict"] == AGREES


def test_packings_of_different_regimes_are_of_none(tables):
    """R5 flowing discontinuously in one packing is no case of what the source tells of continuous runs."""
    regimes = tables["regimes"].assign(
        regime=tables["regimes"]["regime"].mask(tables["regimes"]["row"] == "R5-3", DISCONTINUOUS)
    )
    here = {**tables, "regimes": regimes}
    assert evidence_of(here).regimes["R5"] == MIXED
    table = verdicts(here)
    assert table.loc[["r5_reduction", "r5_lowest"], "verdict"].unique().tolist() == [UNSAID]
    assert "R5 is not found to flow" in table.loc["r5_reduction", "reason"]


def test_one_regime_alone_compares_nothing(tables):
    """Where all runs flow continuously, what is told of the other regime cannot be said, and R2 contradicts."""
    regimes = tables["regimes"]
    flow = 0.4 * (1.0 + 0.01 * regimes["row"].str.endswith("-2"))
    table = verdicts({**tables, "regimes": regimes.assign(regime=CONTINUOUS, relative_velocity=flow)})
    for key in ("discontinuous_range", "gradient_by_regime", "r2_lowest", "rolling_discontinuous"):
        assert table.loc[key, "verdict"] == UNSAID and table.loc[key, "reason"]
    assert table.loc["discontinuous_runs", "verdict"] == CONTRADICTS


def test_rows_that_were_not_run_are_named(tables):
    """Without R5, R2 and R12 what is told of them cannot be said, nor that all rows are as claimed; one of the others
    still contradicts.
    """
    names = ("summary", "regimes", "profiles", "steady")
    gone = [f"{row}{ending}" for row in ("R5", "R2", "R12") for ending in ("", "-2", "-3")]
    table = verdicts({**tables, **{name: tables[name][~tables[name]["row"].isin(gone)] for name in names}})
    of_them = ["r5_reduction", "r5_lowest", "r12_wears_more", "rolling_at_surface", "rolling_falls", "same_terms"]
    of_them += ["discontinuous_runs", "r2_lowest", "bottom_layer_left_behind", "thickness_strongest"]
    assert table.loc[of_them, "verdict"].unique().tolist() == [UNSAID] and (table.loc[of_them, "reason"] != "").all()
    assert "R2, R5, R12 are not there" in table.loc["same_terms", "reason"]
    of_all = ["normal_force_up", "convex_wears_less", "steady_flow", "continuous_runs", "base_wears_most"]
    assert table.loc[of_all, "verdict"].unique().tolist() == [UNSAID]
    assert table.loc["normal_force_up", "reason"].endswith("do as claimed; R2, R5, R12 are not there")
    assert table.loc["convex_wears_less", "reason"].endswith("do as claimed; R2, R5 are not there")
    summary = tables["summary"]
    without = summary["wear_over_plain"].mask(summary["row"].str.startswith("R8"))
    lacks = verdicts({**tables, "summary": summary.assign(wear_over_plain=without)})
    assert lacks.loc[["convex_wears_less", "force_up_wear_down"], "verdict"].unique().tolist() == [UNSAID]
    assert lacks.loc["convex_wears_less", "reason"].endswith("do as claimed; R8 is not there")
    more = summary["wear_over_plain"].mask(summary["row"].str.startswith("R8"), 2.0 + 0.01 * summary.index % 3)
    here = {**tables, "summary": summary.assign(wear_over_plain=more)}
    one = verdicts({**here, **{name: here[name][~here[name]["row"].isin(gone)] for name in names}})
    assert one.loc["convex_wears_less", "verdict"] == CONTRADICTS


def test_without_plain_twins_or_layers_nothing_is_judged_of_them(tables):
    """What was not measured decides nothing, and no sentence tells of a missing number."""
    alone = tables["summary"].assign(wear_over_plain=np.nan)
    alone = alone[alone["surface"] != "plain"]
    table = verdicts({**tables, "summary": alone})
    keys = ["convex_wears_less", "r12_wears_more", "r5_reduction", "normal_force_up", "force_up_wear_down"]
    assert table.loc[keys, "verdict"].unique().tolist() == [UNSAID]
    profiles = tables["profiles"]
    flat = verdicts({**tables, "profiles": profiles[profiles["layer"] == 1]})
    assert flat.loc["rolling_falls", "reason"] == "R5 has too few layers to compare"
    lost = verdicts({**tables, "profiles": profiles[profiles["surface"] != "plain"]})
    keys = ["rolling_discontinuous", "bottom_layer_left_behind", "rolling_at_surface"]
    assert lost.loc[keys, "verdict"].unique().tolist() == [UNSAID]
    assert not pd.concat([table, lost])["found"].str.contains("nan").any()


def test_an_aliased_scale_leaves_the_effects_open(tables):
    """Where the particle scale follows the thickness, no effect of a factor is told."""
    scale = np.where(tables["summary"]["bed_thickness_mm"] > 10.0, 2.0, 1.26)
    table = verdicts({**tables, "summary": tables["summary"].assign(particle_scale=scale)})
    for key in ("thickness_strongest", "same_terms", "no_effect_of_height"):
        assert table.loc[key, "verdict"] == UNSAID and "particle scale" in table.loc[key, "reason"]
    assert verdicts(tables, factors={}).loc["same_terms", "reason"] == "the study has not the source's factors"


def test_settings_of_several_particle_sizes_are_judged_by_the_smallest(tables):
    """A row that a study has at two particle scales stands for the source's at the smaller one alone."""
    summary, twice = tables["summary"], {}
    for name in ("summary", "regimes", "profiles", "steady"):
        coarse = tables[name].assign(row="S" + tables[name]["row"], run="S" + tables[name]["run"])
        if name == "summary":
            coarse = coarse.assign(setting="S" + coarse["setting"], particle_scale=4.0, wear_over_plain=3.0)
        twice[name] = pd.concat([coarse, tables[name]], ignore_index=True)
    rows = rows_of(summary) | {f"S{row}": setting for row, setting in rows_of(summary).items()}
    found = gather({**tables, **twice}, RUN_IN, rows, FACTORS)
    alone = evidence_of(tables)
    pd.testing.assert_frame_equal(found.rows, alone.rows)


def test_main_effects_are_those_of_the_model():
    """Of a response that is exactly linear in the factors, with squares and interactions added, they are its slopes."""
    levels = evidence_of(tables_of(study(1, 0.0))).levels
    slopes = pd.Series([0.4, -0.1, 0.2, 0.0, 0.6, 1.4], index=levels.columns)
    response = levels @ slopes + levels["a"] * levels["b"] - 2.0 * levels["t"] ** 2 + 5.0
    found = main_effects(pd.DataFrame([response]), levels)
    np.testing.assert_allclose(found.iloc[0], slopes, atol=ROUNDING)


def test_published_model_at_its_own_runs():
    """At the middle of all factors it gives exp(-1.859), at R5 (v, t, b and d high) the sum of Table 3.10."""
    found = published_wear_by_row(DESIGN, read("coefficients"), FACTORS)
    assert found["R6"] == pytest.approx(np.exp(-1.859), rel=DIGITS)
    assert found["R5"] == pytest.approx(np.exp(-1.859 + 0.650 + 1.426 - 0.633), rel=DIGITS)
    assert published_wear_by_row(DESIGN, read("coefficients"), {"a": "major_radius_mm"}) == {}


def test_runs_stand_beside_the_source(tables):
    """Regime, published regime, wear with its interval of every row; what the source does not tell is empty."""
    table = runs_beside_source(evidence_of(tables), {"R5": 0.66}).set_index("row")
    assert table.loc["R5", ["regime", "published_regime", "published_wear_over_plain"]].tolist() == [
        CONTINUOUS,
        CONTINUOUS,
        "0.34",
    ]
    assert table.loc["R12", "published_wear_over_plain"] == "above 1"
    assert table.loc["R4", ["published_regime", "published_wear_over_plain"]].tolist() == ["", ""]
    assert table["normalised_wear"].max() == 1.0 and (table["packings"] == PACKINGS).all()
    assert (
        (table["interval_low"] < table["wear_over_plain"]) & (table["wear_over_plain"] < table["interval_high"])
    ).all()
    assert table.loc["R5", "published_model"] == 0.66 and np.isnan(table.loc["R6", "published_model"])


# ---------------------------------------------------------------- how often verdicts err


def at_the_edge(key):
    """Return what draws the evidence of a study that is just not as claimed, so that "agrees" is false."""
    rng, template = np.random.default_rng(11), evidence_of(tables_of(study(PACKINGS, 0.0), 0.0))
    rows, levels = template.rows, template.levels
    truth = {
        "convex_wears_less": ("wear_over_plain", np.where(rows["row"] == "R9", 1.0, 0.5)),
        "r5_reduction": ("wear_over_plain", np.full(len(rows), 0.41)),
        "r5_lowest": ("wear_rate", np.where(rows["row"].isin(["R5", "R13"]), 1.0, 2.0)),
        "thickness_strongest": ("wear_m3_per_m", np.exp(rows["row"].map(levels["t"] + levels["v"]))),
    }
    column, values = truth[key]
    return lambda: replace(template, rows=rows.assign(**{column: values * np.exp(rng.normal(0.0, SCATTER, len(rows)))}))


DEARER = ("r5_reduction", "r5_lowest", "thickness_strongest")  # claims


@pytest.mark.parametrize(
    "key",
    ["convex_wears_less", *(pytest.param(each, marks=pytest.mark.verify) for each in DEARER)],
)
def test_false_verdicts_are_rare(key):
    """Where one row is at the very edge of what is claimed, "agrees" comes in 5 % of studies at most, and a false
    "contradicts" likewise: three packings that scatter as wear over plain does.
    """
    draw, claim = at_the_edge(key), CLAIMS[key]
    found = [verdict_on(claim, draw()).verdict for _ in range(TRIALS)]
    most = ERROR_RATE * TRIALS + SURE * np.sqrt(TRIALS * ERROR_RATE * (1.0 - ERROR_RATE))
    assert found.count(AGREES) <= most and found.count(CONTRADICTS) <= most


@pytest.mark.parametrize("key", ["convex_wears_less", "r5_lowest", "thickness_strongest"])
def test_clear_truths_are_told(key):
    """Where every row is as claimed by six deviations of a packing, nearly all studies of three packings agree."""
    evidence, rng, claim = evidence_of(tables_of(study(PACKINGS, 0.0), 0.0)), np.random.default_rng(5), CLAIMS[key]
    rows, levels = evidence.rows, evidence.levels
    column, values = {
        "convex_wears_less": ("wear_over_plain", 0.5),
        "r5_lowest": ("wear_rate", np.where(rows["row"] == "R5", 1.0, 2.0)),
        "thickness_strongest": ("wear_m3_per_m", np.exp(rows["row"].map(1.4 * levels["t"] + 0.6 * levels["v"]))),
    }[key]
    agreed = 0
    for _ in range(POWER_TRIALS):
        scattered = rows.assign(**{column: values * np.exp(rng.normal(0.0, SCATTER, len(rows)))})
        agreed += verdict_on(claim, replace(evidence, rows=scattered)).verdict == AGREES
    assert agreed >= 0.8 * POWER_TRIALS
