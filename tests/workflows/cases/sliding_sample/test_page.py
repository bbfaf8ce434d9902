"""The page of a study of sliding samples: key numbers, what is simplified, and which figures it has."""

import html

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.key_numbers import answers, cards, facts, predictions
from bulkwear.workflows.cases.sliding_sample.study import published_rows, replicate_settings
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.page_parameters import answers_of_study, page_parameters
from bulkwear.workflows.report.predictions import prediction_table
from bulkwear.workflows.report.products import figures_of, products_of_study
from tests.support.finished_samples import CYCLES, embedded, finished_page

RELATIVE = 1e-9  # numbers pass through CSV text


def names_of(study):
    """The names of a study's figures."""
    return [product.name for product in figures_of(study)]


@pytest.fixture
def study(config):
    """A study of two design rows, each convex and plain."""
    return load_study("small", config.project)


@pytest.fixture
def page(study, tmp_path):
    """The text of its page."""
    return finished_page(tmp_path / "results" / study.name, study)


def test_key_numbers(page, study):
    """Relative wear, wear per metre, share of the bumps and carried share follow from what the runs wear."""
    results = embedded(page, f"{study.name}_key_numbers.csv").set_index(["setting", "surface"])
    convex = results.loc[("R9", "convex")]
    assert convex["wear_over_plain"] == pytest.approx(0.8, rel=RELATIVE)
    assert convex["worn_volume_per_metre_mm3_per_m"] == pytest.approx(CYCLES * 0.8 / (CYCLES * 0.04), rel=RELATIVE)
    assert convex["pattern_share_percent"] == pytest.approx(25.0, rel=RELATIVE)
    assert convex["carried_share_percent"] == pytest.approx(50.0, rel=RELATIVE)
    assert results.loc[("R9", "plain"), "wear_over_plain"] == 1.0


def test_the_table_of_beds(page, study):
    """A row per bed with the settings that start from it; what was asked, found and allowed in the units of heads."""
    beds = embedded(page, f"{study.name}_beds.csv").set_index("bed")
    assert list(beds.index) == list(study.beds)
    assert beds.loc["bed_R9", "level_found_mm"] == pytest.approx(42.0, rel=RELATIVE)
    assert beds.loc["bed_R9", "mass_tolerance_kg"] == pytest.approx(0.02, rel=RELATIVE)
    assert {setting for cell in beds["settings"] for setting in cell.split(", ")} == set(study.setting_of.values())


def summary_of(**ratios):
    """A summary of convex samples over their plain twins, one packing per ratio."""
    runs = [
        {"setting": setting, "packing": k, "surface": surface, "row": f"{setting}-{k}", "wear_over_plain": value}
        | {"worn_volume_per_metre_m3_per_m": value, "worn_volume_m3": value, "pattern_worn_volume_m3": 0.5 * value}
        for setting, values in ratios.items()
        for k, ratio in enumerate(values)
        for surface, value in (("convex", ratio), ("plain", 1.0))
    ]
    return pd.DataFrame(runs)


def test_a_finished_study_answers(study, tmp_path):
    """What is said at the end of a run is the sentence on the page; a case without a page of answers says nothing."""
    page = html.unescape(finished_page(tmp_path / study.name, study))
    said = answers_of_study(study.case.name, tmp_path / study.name)
    assert said and all(sentence in page for sentence in said)
    assert answers_of_study("pin_on_disc", tmp_path) == []


def test_depths_are_told_per_hour_that_a_run_stands_for():
    """0.02 mm in a second that stands for two hours are 0.01 mm per hour; of the setting that wears least."""
    summary = summary_of(A=[0.5], B=[0.9]).assign(time_s=1.0, run=["a", "b", "c", "d"])
    depths = pd.DataFrame({"run": summary["run"], "largest_depth_um": 20.0, "depth_of_99_percent_um": 10.0})
    convex, plain, hours = facts(summary, depths, 7200.0)
    assert "convex sample of A wears 0.01 mm per hour" in convex and "at least 0.005 mm" in convex
    assert "plain sample of A" in plain
    assert hours == "Its runs slide for 1 s, which stand for 2 h 0 min of wear."
    assert facts(summary, depths, 1.0)[-1] == "Its runs slide for 1 s."


def test_rates_join_packings_and_coefficient():
    """Depth per hour in a sentence, the joined interval wider than either; volumes and hours in a table."""
    depths = pd.DataFrame({"run": list("abcdef"), "largest_depth_um": [19.0, 20, 20, 20, 21, 20]})
    summary = summary_of(A=[0.5, 0.52, 0.54]).assign(time_s=1.0, travel_m=2.0, run=depths["run"])
    depths = depths.assign(depth_of_99_percent_um=10.0)
    convex, *_ = facts(summary, depths, 7200.0, 0.16)
    assert "wears 0.01 mm per hour (95 % interval 0.0081 to 0.012 mm, 3 packings; scatter makes" in convex
    assert "coefficient" not in facts(summary, depths, 7200.0)[0]
    table = prediction_table(predictions(summary, depths, 7200.0, 0.16)).set_index(["surface", "quantity"])
    per_hour, hours = (table.loc[("convex", name)] for name in table.loc["convex"].index[[1, 3]])
    assert per_hour["value"] == pytest.approx(1e9 * (0.5 * 0.52 * 0.54) ** (1 / 3) / 2.0, rel=RELATIVE)
    assert per_hour["low"] < 0.84 * per_hour["value"] < 1.16 * per_hour["value"] < per_hour["high"]
    assert per_hour["scatter_percent"] + per_hour["coefficient_percent"] == pytest.approx(100.0)
    assert hours["low"] < hours["value"] / 1.16 < hours["value"] / 0.84 < hours["high"]
    alone = prediction_table(predictions(summary[:2], depths, 7200.0, 0.16))
    assert alone["low"].isna().all() and alone["coefficient_low"].notna().all()


def test_the_page_predicts_with_both(config, page, tmp_path):
    """A table of predictions, and what its intervals join; without the coefficient's error that none is given."""
    assert "no wear_coefficient_error is given" in page
    study = load_study("small", config.project, {"wear": {"wear_coefficient_error": 0.16}})
    told = finished_page(tmp_path / "told", study)
    assert len(embedded(told, "small_predictions.csv")) == 8
    assert "16 % of it, as given) joined as squares in the logarithm" in told


def test_less_is_said_only_where_the_interval_leaves_out_one():
    """The answer has the mean, its interval and the packings; a reduction in words only where it is one."""
    sure = summary_of(R9=[0.6, 0.64, 0.68])
    (said,) = answers(sure)
    assert said.startswith("The convex sample of R9 wears 0.64 (95 % interval 0.55 to 0.75, 3 packings) of the plain")
    assert said.endswith("volume: 36 % less (25 to 45 %).")
    assert cards(sure, 1.0)[0] == ("0.64", "convex over plain wear, R9: 95 % interval 0.55 to 0.75, 3 packings")
    (open_,) = answers(summary_of(R9=[0.5, 0.9, 1.1]))
    assert open_.endswith("neither less nor more can be said.")
    (alone,) = answers(summary_of(R9=[0.5]))
    assert alone == "The convex sample of R9 wears 0.50 (one packing, scatter unknown) of the plain sample's volume."
    counted, lowest = answers(summary_of(A=[0.5, 0.51, 0.52], B=[0.4], C=[1.5, 1.51, 1.52]))
    assert counted == "1 of 3 patterns wear less than their plain twin, 1 more; of 1 it cannot be said."
    assert lowest.startswith("Lowest: the convex sample of B wears 0.40 (one packing")
    assert lowest.endswith("Whether the others wear more cannot be said.")
    _, lowest = answers(summary_of(A=[0.5, 0.51, 0.52], B=[0.49, 0.5, 0.51], C=[1.5, 1.51, 1.52]))
    assert lowest.endswith("%). Whether 1 of the 2 others wear more cannot be said.")
    _, lowest = answers(summary_of(A=[0.5, 0.51, 0.52], C=[1.5, 1.51, 1.52]))
    assert lowest.endswith("%).")
    assert answers(summary_of(A=[0.5]).query("surface == 'convex'").assign(wear_over_plain=np.nan)) == []


def test_real_volume_is_without_acceleration(config, tmp_path):
    """A study accelerated 1e4 times prints volumes per metre as simulated and divided by 1e4."""
    page = finished_page(tmp_path / "small", load_study("small", config.project, {"wear": {"acceleration": 1e4}}))
    results = embedded(page, "small_key_numbers.csv")
    ratio = results["worn_volume_per_metre_mm3_per_m"] / results["real_volume_per_metre_mm3_per_m"]
    np.testing.assert_allclose(ratio, 1e4, rtol=RELATIVE)
    assert "accelerated 10000 times" in page


def test_the_page_says_how_the_loads_were_summed(config, page, tmp_path):
    """Sampled contacts are a simplification with their interval; the solver's sum of every step is none."""
    assert "sampled" not in page
    study = load_study("small", config.project, {"ledger": "dumps", "solver": {"sampling_interval_steps": 40}})
    assert "contacts sampled every 40 steps" in finished_page(tmp_path / "sampled", study)


def test_the_page_tells_the_law(config, page, tmp_path):
    """Archard's words or Finnie's; the solver's own measure beside Archard's only; figures name another law."""
    assert "Archard: volume = coefficient times normal force" in page and "wears nothing" in page
    study = load_study("small", config.project, {"wear": {"law": "finnie"}})
    text = finished_page(tmp_path / "finnie", study)
    assert "Finnie: volume = coefficient times a function of the impact angle" in text and "wears nothing" not in text
    assert any("worn by the law finnie" in remark for remark in page_parameters(study)["remarks"])


def test_single_row_has_no_figure_of_rows(config):
    """A figure that compares design rows is left out where there is one row, and where nothing is plain."""
    assert names_of(load_study("small", config.project))[0] == "relative_wear"
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", "surfaces: [convex]")
    assert "relative_wear" not in names_of(load_study("small", config.project))
    config.edit("studies/small.yaml", "surfaces: [convex]", "surfaces: [convex, plain]")
    config.edit("designs/small.csv", "R5,4,8,60,6.0,2.0,30\n", "")
    assert "relative_wear" not in names_of(load_study("small", config.project))


@pytest.mark.parametrize("surface", ["convex", "plain"])
@pytest.mark.parametrize("rows", [{}, {"rows": ["R9"]}])
def test_one_surface_alone_makes_its_page_without_pairs(config, tmp_path, surface, rows):
    """Nothing is told over a plain twin, of one row and of two."""
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", f"surfaces: [{surface}]")
    study = load_study("small", config.project, rows)
    products = products_of_study(study)
    assert not {"relative_wear", "wear_split", "intervals"} & set(products)
    page = finished_page(tmp_path / "results" / study.name, study)
    assert "of the plain sample's volume" not in page and "over plain wear" not in page


def test_only_what_deforms_has_updates_and_a_film(config):
    """The wear updates and the film, a GIF, are of studies that apply wear to the shape."""
    deforming = figures_of(load_study("small", config.project))
    rigid = names_of(load_study("small", config.project, {"wear": {"deform": False}}))
    further = {product.name: product.suffix for product in deforming if product.name not in rigid}
    assert further == {"wear_updates": "png", "worn_film": "gif"}


def test_published_rows_have_the_published_factors(config):
    """A row is a published one by its factors, whatever its name; R5 of another thickness is none."""
    config.edit("designs/small.csv", "R9,8,2,20,6.0,1.0,40", "own,8,2,20,6.0,1.0,40")
    assert published_rows(load_study("small", config.project)) == {"own": "R9"}
    study = load_study("screening")
    screening = published_rows(study)
    assert len(set(screening.values())) == 13
    assert all(study.setting_of[ours] == theirs for ours, theirs in screening.items())


REPLICATES = """\
row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm,seed
R9-1,8,2,20,6.0,1.0,40,11000
R9-2,8,2,20,6.0,1.0,40,12000
R5,4,8,60,6.0,2.0,30,11000
"""


def test_rows_that_are_laid_out_otherwise_are_not_published_ones(config):
    """The same bumps in rows closer together, by a column of the design or by a setting, or not shifted."""
    columns = f"{REPLICATES.partition(',seed')[0]},row_spacing_mm"
    config.write("designs/small.csv", f"{columns}\nown,8,2,20,6.0,1.0,40,40\nclose,8,2,20,6.0,1.0,40,30\n")
    assert published_rows(load_study("small", config.project)) == {"own": "R9"}
    shifted = {"pattern": {"row_offset_fraction": 0.25}}
    assert published_rows(load_study("small", config.project, shifted)) == {}


def test_rows_that_differ_in_their_seed_are_packings(config, tmp_path):
    """They share a setting, a published row and an interval on the page; one alone says that its scatter is unknown."""
    one = finished_page(tmp_path / "one" / "small", load_study("small", config.project, {"packings": 1}))
    assert "One packing, scatter unknown" in one and "interval_low" not in embedded(one, "small_key_numbers.csv")
    config.write("designs/small.csv", REPLICATES)
    study = load_study("small", config.project, {"packings": 1})
    assert replicate_settings(study) == {"R9-1": "R9", "R9-2": "R9", "R5": "R5"}
    assert published_rows(study) == {"R9-1": "R9", "R9-2": "R9", "R9": "R9"}
    text = finished_page(tmp_path / "small", study)
    assert "95 % interval of the mean" in text
    table = embedded(text, "small_key_numbers.csv").set_index(["setting", "surface"])
    ends = table.loc[("R9", "convex"), ["packings", "interval_low", "interval_high"]]
    assert ends.tolist() == pytest.approx([2, 0.8, 0.8], rel=RELATIVE)  # all convex runs wear 0.8 of plain ones
    assert np.isnan(table.loc[("R5", "convex"), "interval_low"])


def test_without_factors_there_is_no_regression(study):
    """Nothing is regressed that a study does not name, and no regimes are found."""
    assert not {"regression_coefficients", "relative_velocity"} & set(names_of(study))
