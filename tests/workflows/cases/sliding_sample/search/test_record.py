"""The record of a search, what its figures and its page say of it."""

import shutil

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.tables.summary import read_summary, summary_table
from bulkwear.workflows.cases.sliding_sample.search import page
from bulkwear.workflows.cases.sliding_sample.search.findings import lowest_tried, strongest_factor
from bulkwear.workflows.cases.sliding_sample.search.record import best_confirmed
from bulkwear.workflows.report.products import job_of, outputs_of, paths_of, products_of_study, told_to, write_product
from tests.support.finished_samples import embedded, page_of_results, write_results
from tests.support.searched import BEST_HEIGHT_MM, LEAST, STUDY, small_search, write_runs

WITHIN = 0.03  # -, of wear over plain: scatter of packings, 0.01
FIGURES = ("search_record", "search_slices", "search_sensitivity")


@pytest.fixture(scope="module")
def results(finished, tmp_path_factory):
    """The study, the folder of its finished search with the tables of its figures, and what its rounds decided."""
    before, decided = finished
    root = tmp_path_factory.mktemp("record")
    shutil.copytree(before, root, dirs_exist_ok=True)
    study = small_search(root).with_packings(decided[-1]["packings"])
    folder = root / "results" / STUDY
    write_runs(study, folder)
    pd.DataFrame(study.design_table()).to_csv(folder / "design.csv", index=False)
    wear = [folder / run.name / "wear.csv" for run in study.runs]
    summary_table(folder / "design.csv", wear).to_csv(folder / "summary.csv", index=False)
    for name in ("figures", "search"):
        (folder / name).mkdir()
    for name in FIGURES:
        product = products_of_study(study)[name]
        files = {key: paths_of(source, study) for key, source in product.inputs.items()}
        placed = {
            key: [str(root / each) for each in value] if isinstance(value, list) else str(root / value)
            for key, value in files.items()
        }
        outputs = {key: str(root / path) for key, path in outputs_of(product, study.name).items()}
        write_product(product, job_of(placed, told_to(product, study), ["a remark"]), outputs)
    return study, folder, decided


@pytest.mark.verify
def test_the_record_has_every_pattern_with_its_prediction(results):
    """In the order of the rounds; the first ones were not predicted, the others near to what they wear."""
    _, folder, decided = results
    record = pd.read_csv(folder / "figures" / "search_record.csv")
    assert len(record) == sum(count > 0 for count in decided[-1]["packings"].values())
    assert record["round"].is_monotonic_increasing and (record["round"] == 0).sum() == 5
    predicted = record[record["round"] > 0]
    assert record[record["round"] == 0]["predicted"].isna().all() and len(predicted) >= 4
    inside = predicted["wear_over_plain"].between(
        predicted["predicted_low"] - WITHIN, predicted["predicted_high"] + WITHIN
    )
    assert inside.mean() > 0.5
    own = record.set_index("setting").loc["R5"]
    assert own["wear_over_plain"] == pytest.approx(LEAST * np.exp(0.2), abs=WITHIN) and own["packings"] == 3
    said = lowest_tried(record)
    assert said.startswith(f"{len(record)} patterns were tried; of those in the most packings of which enough is left")
    lucky = record.assign(wear_over_plain=record["wear_over_plain"].where(record["packings"] > 2, 0.01))
    assert lowest_tried(lucky) == said
    none = lowest_tried(record.assign(enough_left="no"))
    assert none == f"{len(record)} patterns were tried; of none is enough left."


@pytest.mark.verify
def test_key_numbers_are_those_of_the_best_confirmed(results):
    """Not of a pattern that was lower in fewer packings; a study that looks for nothing keeps all its runs."""
    _, folder, _ = results
    summary = read_summary(folder / "summary.csv")
    best = best_confirmed(pd.read_csv(folder / "search" / "confirmed.csv"))["setting"]
    assert set(page.of_best(summary, folder)["setting"]) == {best}
    assert len(page.of_best(summary, folder / "search")) == len(summary)


def test_a_search_of_an_earlier_choice_answers_nothing(tmp_path):
    """Its confirmed patterns are not in the design of a study that looks for none, of which all runs are told."""
    (tmp_path / "search").mkdir()
    pd.DataFrame({"setting": ["O5", "R5"]}).to_csv(tmp_path / page.CONFIRMED, index=False)
    summary = pd.DataFrame({"setting": ["R5", "R9"]})
    summary.to_csv(tmp_path / "design.csv", index=False)
    assert page.answers(tmp_path) == [] and page.of_best(summary, tmp_path) is summary


@pytest.mark.verify
def test_confirmed_patterns_stand_beside_the_reference(results):
    """The best wears less than R5 by what their heights make, in the same packings."""
    _, folder, decided = results
    confirmed = pd.read_csv(folder / "search" / "confirmed.csv")
    assert confirmed["setting"].tolist() == decided[-1]["confirmed"]
    reference, best = confirmed.iloc[-1], best_confirmed(confirmed)
    assert reference["over_reference"] == pytest.approx(1.0) and reference["enough_left"] == "yes"
    expected = np.exp(0.1 * (abs(best["height_mm"] - BEST_HEIGHT_MM) - abs(6.0 - BEST_HEIGHT_MM)))
    assert best["over_reference"] == pytest.approx(expected, abs=WITHIN)
    assert best["over_reference_low"] <= best["over_reference"] <= best["over_reference_high"]
    assert best["left_low_percent"] <= best["left_percent"] <= best["left_high_percent"]


def test_the_best_is_one_of_which_enough_may_be_left():
    """A pattern that goes too early is not the best, however little it wears."""
    table = pd.DataFrame(
        {"setting": ["O1", "O2", "R5"], "wear_over_plain": [0.3, 0.5, 0.7], "enough_left": ["no", "open", "yes"]}
    )
    assert best_confirmed(table)["setting"] == "O2"
    assert best_confirmed(table.assign(enough_left="no"))["setting"] == "O1"


@pytest.mark.verify
def test_the_surrogate_is_drawn_along_every_factor(results):
    """Least near the best height; the other factor changes nothing."""
    _, folder, _ = results
    table = pd.read_csv(folder / "figures" / "search_slices.csv")
    assert table.groupby("factor")["value"].count().to_dict() == {"height_mm": 9, "minor_radius_mm": 13}
    along = table[table["factor"] == "height_mm"]
    assert abs(along["value"].iloc[along["predicted"].to_numpy().argmin()] - BEST_HEIGHT_MM) <= 1.0
    assert "changes most with height" in strongest_factor(table)
    assert all((folder / "figures" / f"{name}.png").stat().st_size > 1000 for name in FIGURES)


@pytest.mark.verify
def test_the_height_decides_wear(results):
    """Of wear, which the other measure has no part in; the loss per hour is that of all patterns over their volumes."""
    _, folder, _ = results
    table = pd.read_csv(folder / "figures" / "search_sensitivity.csv").set_index(["response", "factor"])
    wear = table.loc["ln wear over plain"]
    assert wear.loc["height", "total"] > 0.8 > 0.2 > wear.loc["minor radius", "total"]
    assert (wear["total_low"] <= wear["total"]).all() and (wear["total"] <= wear["total_high"]).all()
    assert set(table.index.get_level_values(0)) == {"ln wear over plain", "ln loss of the pattern per hour"}


@pytest.mark.verify
def test_the_page_answers_which_pattern_is_best(results):
    """With its measures, beside plain and the reference, as predicted, and what is left of it."""
    study, folder, decided = results
    sections = page.sections({"told": page.told(study)}, folder)
    assert [section.title for section in sections] == ["The best pattern", "How it was found"]
    assert decided[-1]["said"] in sections[1].blocks[0].text
    first, second = page.answers(folder)
    best = best_confirmed(pd.read_csv(folder / "search" / "confirmed.csv"))
    assert first.startswith(f"The best pattern, {best['setting']} (height {best['height_mm']:g} mm, minor radius")
    assert first.endswith("of that of R5.") and "% of it are left after its hours, enough" in second
    assert page.answers(folder / "figures") == []


@pytest.mark.verify
def test_a_whole_page_has_the_search(results, tmp_path):
    """Beside all that any study of samples has: the confirmed patterns for download, reasons, figures."""
    study, folder, decided = results
    made_up = tmp_path / "results" / STUDY
    write_results(made_up, study)
    for name in ("rounds", "search"):
        shutil.copytree(folder / name, made_up / name)
    for name in FIGURES:
        shutil.copy(folder / "figures" / f"{name}.csv", made_up / "figures")
    text = page_of_results(made_up, study)
    assert embedded(text, f"{STUDY}_confirmed.csv")["setting"].tolist() == decided[-1]["confirmed"]
    assert all(f'id="{name}"' in text for name in FIGURES)
    assert "bump too high for its foot" in text and text.count(decided[-1]["said"]) == 1
