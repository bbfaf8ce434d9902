"""The page of a study of pins on discs: key numbers of its summary, a section for each figure that it has."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.pin_on_disc import page
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.markdown_text import written
from bulkwear.workflows.report.page import write_page
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.predictions import error_of, prediction_note, prediction_table
from bulkwear.workflows.report.sections import Cards, Pictures, Table
from bulkwear.workflows.report.text import range_text
from tests.support import pin_study

RELATIVE = 1e-9  # numbers pass through CSV text


def write_summary(study, folder):
    """The summary of a study whose runs lose what the law says; Eq 5.9 counts twice that."""
    design = pd.DataFrame(study.design_table())
    due = design["wear_coefficient_per_pa"] * design["load_n"] * design["sliding_distance_m"]
    design.to_csv(folder / "design.csv", index=False)
    design.assign(
        **dict.fromkeys(("worn_volume_m3", "removed_volume_m3", "alpha_F_L_volume_m3"), due),
        **dict.fromkeys(("mean_normal_force_N", "mean_vertical_force_N"), 5.0),
        **dict.fromkeys(("carried_volume_m3", "balance_error", "largest_balance_error"), 0.0),
        centroid_path_volume_m3=2.0 * due,
        largest_depth_m=1e-6,
        most_contacts_per_step=3.0,
    ).to_csv(folder / "summary.csv", index=False)


@pytest.fixture
def summarised(tmp_path):
    """A study and its folder with a summary, without figures."""
    study = load_study("pin_on_disc", overrides={"fidelity": "standard"})
    write_summary(study, tmp_path)
    return study, tmp_path


def test_key_numbers_are_those_of_the_summary(summarised):
    """Ratios to alpha F L by hand, the scale of each pin; cards of the first run of each scheme."""
    study, folder = summarised
    (section,) = page.sections({"figures": {}, "settings": study.settings}, folder)
    cards, table, *_ = section.blocks
    assert isinstance(cards, Cards) and isinstance(table, Table)
    results = table.data.set_index("run")
    np.testing.assert_allclose(results["law_over_alpha_F_L"], 1.0, rtol=RELATIVE)
    np.testing.assert_allclose(results["removed_over_alpha_F_L"], 1.0, rtol=RELATIVE)
    np.testing.assert_allclose(results["centroid_path_over_alpha_F_L"], 2.0, rtol=RELATIVE)
    assert results.loc["s4", "particle_scale"] == 4.0 and len(results) == len(study.runs)
    assert [value for value, _ in cards.cards] == ["1", "1"] * 2
    assert cards.cards[2][1].startswith("volume removed over coefficient x load x distance, by the per-triangle rule, ")


def test_predictions_have_the_error_of_the_coefficient(summarised):
    """No run is repeated: no interval, and 0.84 to 1.16 times the volume by the coefficient alone; rigid discs none."""
    study, folder = summarised
    summary = pd.read_csv(folder / "summary.csv").assign(removed_volume_m3=lambda rows: rows["worn_volume_m3"])
    summary.loc[summary.index[0], "removed_volume_m3"] = 0.0
    rows = page.predictions(summary, error_of(study.settings))
    table = prediction_table(rows)
    assert len(table) == 2 * (len(summary) - 1) and table["low"].isna().all()
    np.testing.assert_allclose(table["coefficient_low"] / table["value"], 0.84, rtol=RELATIVE)
    np.testing.assert_allclose(table["coefficient_high"] / table["value"], 1.16, rtol=RELATIVE)
    assert "One packing, scatter unknown: the coefficient's part alone." in prediction_note(rows, 0.16)
    assert "coefficient's part" not in prediction_note(rows, 0.0)
    assert "One packing, scatter unknown: no interval." in prediction_note(rows, 0.0)


def test_a_scheme_without_runs_has_no_card(summarised):
    """A study of one scheme has the two cards of that one, one without the series of coefficients none."""
    _, folder = summarised
    results = page.result_table(pd.read_csv(folder / "summary.csv"))
    assert len(page.cards(results[results["scheme"] == "conserving"])) == 2
    assert page.cards(results[results["series"] == "mesh"]) == []


@pytest.mark.verify
def test_only_sections_with_a_figure_are_there(pins, tmp_path):
    """A study without series of meshes and sizes has no section on them; every figure that it has is in one."""
    folder = pin_study.without(pins[0], ["e", "f", "g"], tmp_path)
    figures = pin_study.drawn(folder)
    write_summary(load_study("pin_on_disc"), tmp_path / "figures")
    (tmp_path / "figures" / "summary.csv").rename(tmp_path / "summary.csv")
    found = page.sections({"figures": figures, "settings": {"wear": {}}}, folder)
    titles = [section.title for section in found]
    assert titles[:3] == ["Key numbers", "Findings of the source", "Depth, width and volume"]
    assert {"Dependence on the mesh", "Size invariance"}.isdisjoint(titles) and "Run-in" in titles
    pictures = [block for section in found for block in section.blocks if isinstance(block, Pictures)]
    assert {name for block in pictures for name in block.names} == set(figures)


def test_every_figure_has_a_section():
    """Each of a study with all series stands in one section, and in no other."""
    study = load_study("pin_on_disc", overrides={"fidelity": "standard"})
    named = [name for _, figures, _ in page.SECTIONS for name in figures]
    assert sorted(named) == sorted(page_parameters(study)["figures"])


def test_a_table_in_markdown():
    """A head, a line, and a row per row; numbers with few digits, words without underscores."""
    table = pd.DataFrame({"scheme": ["per_triangle"], "depth_mm": [0.0123456], "revolutions": [12]})
    assert written(Table(table), "pin").splitlines() == [
        "| scheme | depth mm | revolutions |",
        "| --- | --- | --- |",
        "| per triangle | 0.0123 | 12 |",
    ]


def test_a_study_that_is_not_finished_is_refused(tmp_path):
    """Its summary is missing, and is named."""
    with pytest.raises(FileNotFoundError, match=r"summary.csv"):
        page.sections({"figures": {}}, tmp_path)


def test_the_weight_of_the_pin_is_that_of_its_runs():
    """A range over the load: that of the pin of the quick study's series of scales is 4 cubed times that of scale 1."""
    study = load_study("pin_on_disc", overrides={"fidelity": "quick"})
    parameters = {run.name: run.parameters for run in study.runs}
    told = dict(page.simplifications({"settings": study.settings, "parameters": parameters}))["The pin goes round"]
    shares = {
        run: 100.0 * GRAVITY * each["derived"]["pin_mass_kg"] / each["pin"]["load_n"]
        for run, each in parameters.items()
    }
    assert shares["s4"] == pytest.approx(4.0**3 * shares["s1"]) and shares["s4"] == max(shares.values())
    assert f"weight would be {range_text(list(shares.values()))} % of the load" in told


def test_the_page_needs_no_bed_and_no_sample(pins, tmp_path):
    """No run has a bed, and each tells its revolutions; what is simplified is of pins alone."""
    study = load_study("pin_on_disc")
    folder = tmp_path / study.name
    for name in ("figures", "logs", *(run.name for run in study.runs)):
        (folder / name).mkdir(parents=True)
    write_summary(study, folder)
    told = page_parameters(study) | {"figures": {}}
    cost = "solver_s,processor_s,other_s,steps,particles\n90,80,1,1000,1\n"
    for run in study.runs:
        (folder / run.name / "cost.csv").write_text(cost)
    jobs = pd.DataFrame({"job": [f"worn_run_{run.name}" for run in study.runs], "solver_s": 50.0})
    jobs.assign(by="rates of a test").to_csv(folder / "forecast.csv", index=False)
    write_page(folder / "report.html", told)
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert f'download="{study.name}_key_numbers.csv"' in text
    assert "Damping assumed" in text and "Skirt not counted" not in text and "Layers:" not in text
    assert "wear cycles<small>" in text and "<th>bed" not in text
