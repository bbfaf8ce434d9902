"""Best designs by regime and their confirmation, on wear that follows a known model."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.evaluation import CONTINUOUS, DISCONTINUOUS
from bulkwear.workflows.cases.sliding_sample.screening.confirmation import (
    best_of_regimes,
    check_fidelity,
    confirmation_remarks,
    confirmation_table,
    design_of,
)
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import screen_summary
from bulkwear.workflows.config.design import load_study
from tests import REPOSITORY as ROOT
from tests.support.screening_study import FACTORS

CONDITIONS = ("velocity_m_per_s", "bed_thickness_mm")
NOISE = 0.02  # of ln(wear): small beside effects of 0.45 to 1.4 per coded unit


@pytest.fixture(scope="module")
def design():
    """Table 3.8."""
    return pd.read_csv(ROOT / "config/designs/screening.csv")


@pytest.fixture(scope="module")
def summary(design):
    """Wear that grows with a, v and t, and is least with b and d both low or both high."""
    a, b, v, t = (np.log2(design[FACTORS[name]] / design[FACTORS[name]].median()) for name in "abvt")
    d = (design["column_spacing_mm"] - 40.0) / 20.0
    noise = np.random.default_rng(7).normal(0.0, NOISE, len(design))
    wear = 1e-9 * np.exp(0.449 * a + 0.650 * v + 1.425 * t - 0.629 * b * d + noise)
    convex = design.assign(surface="convex", particle_scale=1.0, worn_volume_per_metre_m3_per_m=wear)
    plain = convex.assign(surface="plain", worn_volume_per_metre_m3_per_m=2.0 * wear)
    return pd.concat([convex, plain], ignore_index=True)


@pytest.fixture(scope="module")
def regimes(design):
    """Thick beds flow continuously, all others do not; plain runs do not count."""
    regime = np.where(design["bed_thickness_mm"] == 40.0, CONTINUOUS, DISCONTINUOUS)
    convex = design[["row"]].assign(setting=design["row"], surface="convex", regime=regime)
    return pd.concat([convex, convex.assign(surface="plain", regime=CONTINUOUS)], ignore_index=True)


@pytest.fixture(scope="module")
def predictions(summary, regimes):
    """The best designs of both regimes."""
    return best_of_regimes(screen_summary(summary, FACTORS), summary, regimes, FACTORS, CONDITIONS)


def test_best_designs_of_a_known_model(predictions):
    """Smallest a; b and d both low or both high; v and t the least of the pairs at which the regime was seen."""
    table = predictions.set_index("row")
    assert table.index.tolist() == [CONTINUOUS, DISCONTINUOUS]
    assert table["major_radius_mm"].tolist() == [2.0, 2.0]
    assert table.loc[CONTINUOUS, list(CONDITIONS)].tolist() == [0.5, 40.0]
    assert table.loc[DISCONTINUOUS, list(CONDITIONS)].tolist() == [0.5, 10.0]
    corners = {(2.0, 20.0), (8.0, 60.0)}
    assert {tuple(pair) for pair in table[["minor_radius_mm", "column_spacing_mm"]].to_numpy()} <= corners
    expected = 1e-9 * np.exp(-0.449 - 0.650 + 1.425 - 0.629)
    assert table.loc[CONTINUOUS, "run_low_m3_per_m"] < expected < table.loc[CONTINUOUS, "run_high_m3_per_m"]
    assert "h" in table.loc[CONTINUOUS, "not_in_model"].split()
    assert table["height_mm"].tolist() == [3.0, 3.0]  # the model says nothing about it


def test_the_design_can_be_a_study(predictions, summary):
    """Row and the six columns of a design, columns that are no factor at their only value."""
    columns = list(FACTORS.values())
    assert design_of(predictions, summary, columns).columns.tolist() == ["row", *columns]
    constant = predictions.drop(columns="height_mm")
    assert design_of(constant, summary.assign(height_mm=4.5), columns)["height_mm"].tolist() == [4.5, 4.5]
    with pytest.raises(ValueError, match="column height_mm is no factor and has 3 values"):
        design_of(constant, summary, columns)


def test_only_regimes_that_were_seen_have_a_design(summary, regimes):
    """Where all runs flow continuously there is one design, of the thinnest bed."""
    study = screen_summary(summary, FACTORS)
    table = best_of_regimes(study, summary, regimes.assign(regime=CONTINUOUS), FACTORS, CONDITIONS)
    assert table[["row", "bed_thickness_mm"]].to_numpy().tolist() == [[CONTINUOUS, 10.0]]


def test_simulated_runs_against_their_intervals(predictions):
    """A run of the predicted wear is inside, one of ten times as much outside, each packing by itself; another regime
    is said.
    """
    settings = np.repeat(predictions["row"].to_numpy(), 2)
    wear = np.repeat(predictions["predicted_m3_per_m"].to_numpy(), 2) * [1.0, 10.0, 1.0, 1.0]
    rows = [CONTINUOUS, f"{CONTINUOUS}-2", DISCONTINUOUS, f"{DISCONTINUOUS}-2"]
    runs = pd.DataFrame({"row": rows, "setting": settings, "surface": "convex", "worn_volume_per_metre_m3_per_m": wear})
    plain = runs.assign(surface="plain", worn_volume_per_metre_m3_per_m=5e-9)
    regimes = runs[["row", "setting", "surface"]].assign(regime=CONTINUOUS)
    table = confirmation_table(predictions, pd.concat([runs, plain], ignore_index=True), regimes)
    assert table["inside"].tolist() == [True, False, True, True]
    assert table["over_predicted"].tolist() == pytest.approx([1.0, 10.0, 1.0, 1.0])
    assert table["simulated_mm3_per_m"].tolist() == pytest.approx(1e9 * wear)
    assert table["plain_mm3_per_m"].tolist() == pytest.approx([5.0] * 4)
    said = confirmation_remarks(table)
    assert said == [f"the run {row} for discontinuous flow is found continuous" for row in rows[2:]]


def test_every_packing_of_the_confirming_study_is_held_against_its_prediction(config, predictions):
    """By the names that the study's own design table gives runs, rows and settings, not by those of first packings."""
    design = config.path("designs/small.csv")
    design.write_text(design.read_text() + "R1,2,2,20,1.5,0.5,30\nR2,4,2,20,1.5,0.5,30\nR3,4,4,20,1.5,0.5,30\n")
    factors = "surfaces: [convex, plain]\nfactors: {a: major_radius_mm, t: bed_thickness_mm}"
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", factors)
    best = config.root / "results/small/confirmation/design.csv"
    best.parent.mkdir(parents=True)
    head = design.read_text().splitlines()[0]
    best.write_text(f"{head}\n{CONTINUOUS},2,4,40,3,0.5,30\n{DISCONTINUOUS},2,2,20,3,0.5,10\n")
    settings = {"packings": 3, "bed": {"allow_thin_bed": True}}
    summary = pd.DataFrame(load_study("small_confirmation", config.project, settings).design_table())
    summary = summary.assign(worn_volume_per_metre_m3_per_m=1e-9 * np.arange(1.0, len(summary) + 1.0))
    table = confirmation_table(predictions, summary, summary.assign(regime=CONTINUOUS))
    convex = summary[summary["surface"] == "convex"]
    assert table["setting"].value_counts().to_dict() == {CONTINUOUS: 3, DISCONTINUOUS: 3}
    assert sorted(table["row"]) == sorted(convex["row"]) and len(set(table["row"])) == 6
    expected = convex.set_index("row")["worn_volume_per_metre_m3_per_m"].reindex(table["row"])
    assert table["simulated_mm3_per_m"].tolist() == pytest.approx((1e9 * expected).tolist())
    assert (table["plain_mm3_per_m"] > table["simulated_mm3_per_m"]).all()


def test_another_fidelity_confirms_nothing(predictions):
    """Runs of another fidelity than the prediction's are refused, in one sentence."""
    made = predictions.assign(fidelity="quick")
    check_fidelity(made, "quick", "prediction.csv")
    with pytest.raises(ValueError, match=r"prediction\.csv: predicted at fidelity quick, the runs are at standard"):
        check_fidelity(made, "standard", "prediction.csv")
