"""Figures and page of a calibration are made of its tables, those of one by a formula."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib.figure import Figure

from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.workflows.cases.calibration.answers import in_family
from bulkwear.workflows.cases.calibration.boxes import SIMULATIONS
from bulkwear.workflows.cases.calibration.boxes import test_of as bulk_test_of
from bulkwear.workflows.cases.calibration.findings import (
    DISCHARGE,
    at_published,
    beside_measured,
    cards,
    measured_beside,
    opening_words,
    sizes_beside_source,
)
from bulkwear.workflows.cases.calibration.page import remarks
from bulkwear.workflows.cases.calibration.responses import RECOMMENDED, interval_table
from bulkwear.workflows.cases.calibration.simulations import FOLDERS
from bulkwear.workflows.engine.bulk_tests import filled_mass
from bulkwear.workflows.report import markdown
from bulkwear.workflows.report.page import write_page
from bulkwear.workflows.report.page_parameters import page_of, page_parameters, page_templates
from bulkwear.workflows.report.products import (
    job_of,
    outputs_of,
    paths_of,
    products_of_study,
    told_to,
    write_product,
)
from bulkwear.workflows.report.sections import Pictures, Points, Table
from bulkwear.workflows.report.verdict import verdict
from tests import REPOSITORY
from tests.support.calibration_study import study
from tests.support.tiny import OF_ANY_MODEL

FIGURES = [
    *("heaps", "response_maps", "calibration_sensitivity", "family"),
    *("pairs_against_bands", "box_sizes", "calibration_progress"),
]


def test_figures_say_that_grains_are_clumps():
    """A friction found for pairs is none of round grains."""
    clumps = study(solver={"rolling_friction": "cdt"}, bulk={"shape": "pair", "material": "river_gravel_published"})
    assert "clumps of spheres (pair)" in remarks(clumps)
    assert not any("clumps" in said for said in remarks(study()))


def test_published_angles_of_shorter_boxes_stand_beside_ours(tmp_path):
    """In the slice of the longest box alone, which two rows may be; a box that was not simulated has no angle.

    Student's t of two packings is 12.71.
    """
    rows = [*[(200.0, 85.0, 37.0)] * 2, (150.0, 85.0, 30.0), (150.0, 53.0, 99.0), (135.0, 85.0, 36.0)]
    table = pd.DataFrame(rows, columns=["length_mm", "width_mm", "mean"]).assign(row="a", deviation=0.5, seeds=2)
    table.to_csv(tmp_path / "box_sizes.csv", index=False)
    found = sizes_beside_source(tmp_path).set_index("setting")
    assert found["published_value"].to_dict() == {"box of 150 mm": 30.4, "box of 100 mm": 31.1}
    middle = found.loc["box of 150 mm"]
    assert middle["computed_value"] == 30.0 and middle["margin"] == 1.0
    assert middle["computed_high"] - 30.0 == pytest.approx(12.7062 * 0.5 / 2**0.5, rel=1e-5)
    assert pd.isna(found.loc["box of 100 mm", "computed_value"])


def test_measured_responses_stand_beside_the_simulated_pairs():
    """The mean over packings with its interval (t of two degrees of freedom: 4.303), margin two measured deviations; a
    response that is predicted alone is none.
    """
    alike = {"pair": "recommended", "measured": 36.0, "measured_deviation": 0.4, "simulated_uncertainty": 0.5}
    rows = [
        {**alike, "response": "shear_angle_deg", "simulated": 35.2, "seeds": 3},
        {**alike, "response": "repose_angle_deg", "simulated": np.nan, "seeds": 0},
        {**alike, "response": "slope", "measured": np.nan, "simulated": 1.0, "seeds": 3},
    ]
    (row,) = measured_beside(pd.DataFrame(rows), {"shear_angle_deg": "Table 3.1"}).to_dict("records")
    assert (row["quantity"], row["setting"]) == ("Shear angle, shear box, measured", "recommended pair")
    assert (row["published_value"], row["margin"], row["source"]) == (36.0, 0.8, "Table 3.1")
    assert row["computed_high"] - row["computed_value"] == pytest.approx(4.3027 * 0.5, rel=1e-4)


def make(product, folder):
    """Make a figure or tables of the study, with a folder in the place of results/calibration."""

    def here(path):
        path = Path(path)
        return folder / path.relative_to("results/calibration") if path.parts[0] == "results" else REPOSITORY / path

    outputs = {key: here(path) for key, path in outputs_of(product, "calibration").items()}
    for path in outputs.values():
        path.parent.mkdir(exist_ok=True)
    files = {key: here(paths_of(source, study())) for key, source in product.inputs.items()}
    write_product(product, job_of(files, told_to(product, study()), ["a remark"]), outputs)


@pytest.fixture(scope="module")
def folder(done, tmp_path_factory):
    """The folder of the study with figures, summary, materials, forecast and what one simulation left, beside one of
    other settings.
    """
    folder = tmp_path_factory.mktemp("results") / "calibration"
    shutil.copytree(done.folder, folder)
    pd.DataFrame({"solver_s": [3.0, 4.0], "by": "rates of a test"}).to_csv(folder / "forecast.csv", index=False)
    cost = {"steps": 1000, "solver_s": 2.0, "particles": 30}
    test = bulk_test_of(study().runs[0].parameters, "shear_box", {}, 1)
    filling = {"mass": 0.995 * filled_mass(test), "level": 1.1 * test["box"]["fill_height_m"]}
    told = {"test": test, "cost": cost, "filling": filling, "solver_warnings": {"a small step": 3}}
    for name in (done.simulations[FOLDERS][0], "shear_box_of_other_settings"):
        cycle = folder / SIMULATIONS / name / "cycle_000"
        cycle.mkdir(parents=True)
        (cycle / "state.json").write_text(json.dumps(told))
        (cycle / "log.liggghts").write_text("LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, compiled once)\n")
    with pytest.MonkeyPatch.context() as patch:
        room = "bulkwear.workflows.cases.calibration"
        patch.setattr(f"{room}.outcome.recommended_heaps", lambda done: ([], [pd.DataFrame({"response": []})]))
        patch.setattr(f"{room}.plots.heaps.heaps", lambda pictures, remarks: Figure())
        for product in products_of_study(study()).values():
            make(product, folder)
    return folder


def sections(folder):
    """Sections of the page."""
    found = page_of("calibration").sections(page_parameters(study()), folder)
    return {section.title: section.blocks for section in found}


def test_figures_are_those_of_the_case():
    """Seven figures, and a job that writes the statements as the study's summary and the materials file."""
    products = products_of_study(study())
    assert [name for name, product in products.items() if product.is_figure] == FIGURES
    assert set(products["statements"].tables.values()) == {"summary.csv", "materials.yaml"}


def test_figures_are_made_of_the_tables(folder, done):
    """Each figure has its table; the statements that are drawn are those of the summary."""
    assert all((folder / "figures" / f"{name}.{kind}").is_file() for name in FIGURES for kind in ("png", "csv"))
    summary, drawn = (pd.read_csv(folder / name) for name in ("summary.csv", "figures/pairs_against_bands.csv"))
    pd.testing.assert_frame_equal(summary, drawn)
    assert list(summary["pair"]) == [RECOMMENDED, "calibrated"]
    written = yaml.safe_load((folder / "materials.yaml").read_text())["particles"]["river_gravel"]["contact"]
    assert written["sliding_friction"] == pytest.approx(done.statements.iloc[0][done.problem.names[0]], abs=1e-4)


def test_sections_tell_every_response(folder, done):
    """Both pairs stand beside the measured bands; what was measured but not simulated is said to be so."""
    table, points, _ = sections(folder)["Against what was measured"]
    assert isinstance(table, Table) and len(table.data) == 2 and isinstance(points, Points)
    assert any("Angle of repose" in said and "not simulated" in said for said in points.items)
    simulated = next(block for block in sections(folder)["Responses over both frictions"] if isinstance(block, Table))
    assert len(simulated.data) == len(done.simulations)


def test_a_response_that_was_not_measured_stands_without_a_band(done):
    """Its mean is told, with no number that is none."""
    rows = done.statements.assign(measured=np.nan, measured_deviation=np.nan, deviations=np.nan, inside="")
    said = [beside_measured(row) for row in rows.itertuples()]
    assert all(each.startswith("Shear angle, shear box (°) ") and each.endswith(", not measured") for each in said)
    assert not any("nan" in each for each in said)
    assert " against 36 ± 0.4, " in beside_measured(next(done.statements.itertuples()))


def test_a_compared_pair_that_was_not_searched_is_neither_kept_nor_rejected(done):
    """Where its friction is outside of the range nothing was simulated, so that the surrogate says nothing there."""
    sliding = done.problem.names[0]
    beyond = {
        **done.pairs,
        done.compared: {**done.pairs[done.compared], sliding: 2.0 * done.problem.parameters[0].high},
    }
    told = replace(done, pairs=beyond)
    assert np.isnan(told.statements.set_index("pair").loc[done.compared, "denser_share"])
    assert cards(told, interval_table(told.problem, told.known, beyond[done.compared]))[-1][0] == "not searched"
    assert in_family(told.statements, done.compared).endswith("lies outside of the range that was searched.")
    assert "in the family" in in_family(done.statements, done.compared)


def test_discharge_times_are_told_with_the_opening_that_is_assumed():
    """Beside those that others simulated: form and size, as the study has them."""
    assert DISCHARGE in RESPONSES["draw_down"]
    assert "with the slot of 45 mm that is assumed" in opening_words(study().runs[0].parameters["draw_down"])


def test_discharge_times_are_told_over_that_of_the_compared_pair(done):
    """No size of the opening makes that ratio: ours at each pair that others simulated, beside theirs."""
    if DISCHARGE not in done.known.surrogates:  # of a fidelity that has no draw-down test
        times = done.known.surrogates | {DISCHARGE: next(iter(done.known.surrogates.values()))}
        done = replace(done, known=replace(done.known, surrogates=times))
    table = at_published(done).data.query("quantity == 'Discharge time'")
    reasons = table.set_index("published_value")["reason"]
    ours = table.set_index("published_value")["computed_value"]
    assert "over that" not in reasons[5.6]  # the compared pair itself, Table 3.6
    ratio = ours[12.3] / ours[5.6]
    assert reasons[12.3].endswith(f"over that of the calibrated pair it is {ratio:.2f}, published {12.3 / 5.6:.2f}")


def test_sections_show_every_figure_once(folder):
    """No figure is left for the end of the page."""
    blocks = [block for found in sections(folder).values() for block in found if isinstance(block, Pictures)]
    assert sorted(name for block in blocks for name in block.names) == sorted(FIGURES)


def test_sections_tell_the_cost_and_its_forecast(folder):
    """One simulation of 2 s, against the 7 s of the forecast; that of other settings does not count."""
    (table,) = sections(folder)["Cost of the simulations"]
    assert table.data[["test", "simulations", "solver_s"]].to_numpy().tolist() == [["shear box", 1, 2.0]]
    assert "LIGGGHTS took 2 s" in table.note and "estimated: 7 s" in table.note and "rates of a test" in table.note


def test_sections_tell_the_filling(folder):
    """Of the one simulation that counts: 0.995 of the mass of a level box, 1.1 times as high."""
    (table,) = sections(folder)["Fillings"]
    (row,) = table.data.to_dict("records")
    assert row["fillings"] == 1 and "Bulk density" in table.note
    assert row["largest_mass_found_kg"] == pytest.approx(0.995 * row["mass_asked_kg"], rel=1e-12)
    assert row["least_level_found_mm"] == pytest.approx(1.1 * row["level_asked_mm"], rel=1e-12)
    assert row["least_bulk_density_over_asked"] == pytest.approx(0.995 / 1.1, rel=1e-12)


def test_the_page_is_that_of_every_study(folder):
    """The HTML page holds the sections, boxes, versions and warnings, and nothing about wear."""
    assert all(Path(template).is_file() for template in page_templates(study()))
    write_page(folder / "report.html", page_parameters(study()))
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("<img ") == len(FIGURES) and "LIGGGHTS-PUBLIC 3.8.0" in page and "3 times" in page
    assert all(f"<td>{run.name}</td>" in page for run in study().runs)
    assert "Wear law" not in page and "Balance of volumes" not in page and 'href="#cost"' not in page


def test_the_verdict_answers_without_wear(folder):
    """Pairs, intervals and what decides, with lights of a calibration and the assumption that matters most."""
    points, lights, weightiest = verdict(page_parameters(study()), folder).blocks
    assert points.items[0].startswith("The recommended pair (sliding friction 0.") and len(points.items) == 7
    assert points.items[-1].startswith("The pair of the materials file (sliding friction 0.")
    assert [each.what for each in lights.lights] == ["Reproduced", "Enough simulations", "Replicated", "Scale"]
    assert "discrepancy of the model" in weightiest.text


@pytest.mark.verify
def test_the_page_in_docs_has_the_same_sections(folder, tmp_path):
    """It names date, version and scale, and its pictures lie beside it."""
    path = markdown.write_results(folder, tmp_path, study())
    page = path.read_text(encoding="utf-8")
    told = " ".join(page.split())
    assert "LIGGGHTS-PUBLIC 3.8.0" in told and "particles at scale 5" in told
    assert "no response measured here is made to tell it. A wall shear test is" in told
    assert [line[3:] for line in page.splitlines() if line.startswith("## ")] == ["Verdict", *sections(folder)]
    assert {found.name for found in tmp_path.glob("*.png")} == {f"calibration_quick_{name}.png" for name in FIGURES}


@pytest.mark.parametrize("model", ["own_spin", "epsd2", "cdt"])
def test_slopes_are_told_to_creep_under_a_constant_torque_alone(model):
    """Other models hold a grain at rest."""
    told = page_parameters(study(solver={"rolling_friction": model}))
    said = dict(page_of("calibration").simplifications(told))["Rolling friction stands for shape"]
    assert f"Model {model};" in said and ("creep" in said) == (model == "cdt")


@pytest.mark.parametrize(("shape", "words"), [("sphere", "Spheres, 5 times"), ("pair", "Clumps of spheres (pair) as")])
def test_grains_are_told_by_their_shape(shape, words):
    """A calibration of clumps is not one of spheres."""
    material = {"material": OF_ANY_MODEL, "shape": shape}
    told = page_parameters(study(solver={"rolling_friction": "cdt"}, bulk=material))
    assert dict(page_of("calibration").simplifications(told))["Coarse-grained particles"].startswith(words)


def test_what_is_simplified_is_that_of_the_boxes():
    """Particles of true size are not called larger, and a draw-down test with walls in front is told to have them."""
    walled = {"draw_down": {"front_and_back": "walls"}, "calibration": {"tests": ["shear_box", "draw_down"]}}
    told = dict(page_of("calibration").simplifications(page_parameters(study(fidelity="paper", **walled))))
    assert "as large as the real ones" in told["Shape of particles"]
    assert "No front and back: shear box." in told["Periodic slices"]
    assert told["Periodic slices"].endswith("With walls there: draw down.")
    quick = dict(page_of("calibration").simplifications(page_parameters(study())))
    assert "fewer particles" in quick["Coarse-grained particles"] and "Opening of the draw-down test" not in quick
