"""The page of a screening: convex beside plain, findings, regression and best designs; as HTML and as Markdown."""

import html

import pandas as pd
import pytest
from PIL import Image

from bulkwear.postproc.tables.summary import read_summary
from bulkwear.workflows.cases.sliding_sample.page import sections
from bulkwear.workflows.cases.sliding_sample.screening import page as screening
from bulkwear.workflows.cases.sliding_sample.screening.regression_sensitivity import sensitivity_table
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import regression_tables, screen_summary
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report import markdown as page_in_markdown
from bulkwear.workflows.report.markdown_text import markdown
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.products import products_of_study
from bulkwear.workflows.report.sections import Pictures
from tests import PUBLISHED
from tests.support.finished_runs import leave_runs
from tests.support.finished_samples import (
    embedded,
    page_of_results,
    write_findings,
    write_flow,
    write_results,
)

DRAWN = ("coefficients", "residuals", "half_normal", "contours")  # figures of its tables
CONVEX, PLAIN = 1.5e-9, 2.0e-9  # m3 over 0.06 m of travel


@pytest.fixture
def few():
    """Two rows of the screening, too few for a regression."""
    return load_study("screening", overrides={"rows": ["R5", "R9"]})


@pytest.fixture
def folder(few, tmp_path):
    """A folder with what the page reads of these rows, all alike."""
    rows = [
        {
            "run": run.name,
            "row": run.row,
            "setting": few.setting_of[run.row],
            "packing": few.packing_of[run.row],
            "surface": run.surface,
            "travel_m": 0.06,
            "worn_volume_m3": CONVEX if run.surface == "convex" else PLAIN,
            "pattern_worn_volume_m3": 0.5e-9 if run.surface == "convex" else 0.0,
            "mean_normal_force_N": 30.0 if run.surface == "convex" else 20.0,
            "worn_volume_per_metre_m3_per_m": (CONVEX if run.surface == "convex" else PLAIN) / 0.06,
            "wear_over_plain": CONVEX / PLAIN if run.surface == "convex" else 1.0,
        }
        for run in few.runs
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "summary.csv", index=False)
    write_flow(tmp_path, few)
    leave_runs(few, tmp_path)
    return tmp_path


def test_a_row_stands_beside_its_plain_twin(few, folder):
    """Ratios of the two surfaces with their interval, wear in mm3 per metre, and the regime over the convex one."""
    lines = markdown(screening.wear_by_row(page_parameters(few), folder)).splitlines()
    assert lines[0].startswith(
        "| row | particle scale | regime | flow steady | packings | wear over plain | interval low"
    )
    assert lines[2] == "| R5 | 1.25 | continuous | yes | 3 | 0.75 | 0.75 | 0.75 | 30 | 25 | 33.3 | 33.3 | 1.5 |"
    assert len(lines) == 4


def test_a_few_rows_make_a_page_without_a_regression(few, tmp_path):
    """The Markdown page names its fidelity and its rows; what needs many rows is left out; pictures lie beside it."""
    folder, docs = tmp_path / "screening", tmp_path / "docs"
    docs.mkdir()
    write_results(folder, few)
    write_flow(folder, few)
    write_findings(folder)
    for path in (folder / "figures").glob("*.png"):
        Image.new("RGB", (2, 2)).save(path)
    text = page_in_markdown.write_results(folder, docs, few).read_text(encoding="utf-8")
    assert text.startswith("# Screening of the convex pattern, Table 3.8: results at quick fidelity")
    assert "12 runs of" in " ".join(text.split()) and "## Durations" in text
    assert "Of 1 claims: 1 cannot be said." in " ".join(text.split()) and "| R12 wears more |" in text
    assert "12 of 12 windows are steady" in text
    assert "## Regression" not in text
    assert "](screening_quick_wear_by_regime.png)\n\n**Relative wear by flow regime.** " in text
    assert (docs / "screening_quick_wear_by_regime.png").is_file()


@pytest.fixture
def study(config):
    """A small study that names two factors, with rows enough to tell of them."""
    config.edit(
        "studies/small.yaml",
        "surfaces: [convex, plain]",
        "surfaces: [convex, plain]\nfactors: {a: major_radius_mm, b: minor_radius_mm}",
    )
    path = config.path("designs/small.csv")
    path.write_text(path.read_text() + "R1,2,2,20,1.5,0.5,30\nR2,4,2,20,1.5,0.5,30\nR3,4,4,20,1.5,0.5,30\n")
    return load_study("small", config.project)


def test_a_study_with_factors_has_figures_and_tables_of_them(study):
    """Runs by regime, the flow, the regression and its best designs, and findings: it has a row of the source."""
    products = products_of_study(study)
    assert {"wear_gradient", "wear_by_regime", "velocity_profiles", "flow_views_second"} <= set(products)
    drawn = [name for name, product in products.items() if name.startswith("regression_") and product.is_figure]
    assert drawn == [f"regression_{name}" for name in (*DRAWN, "sensitivity")]
    assert "confirmation" not in products
    jobs = page_parameters(study)["jobs"]
    assert {"tables_regression", "tables_best_designs", "tables_findings", "tables_profiles"} <= set(jobs)


@pytest.fixture
def results(study, tmp_path):
    """A folder with its results, and the tables of its regression."""
    folder = tmp_path / "small"
    write_results(folder, study)
    write_flow(folder, study)
    write_findings(folder)
    published = [pd.read_csv(PUBLISHED / f"screening_{name}.csv") for name in ("coefficients", "contours")]
    tables = regression_tables(screen_summary(read_summary(folder / "summary.csv"), study.factors), *published)
    for name in ("regression", "confirmation"):
        (folder / name).mkdir()
    for name, table in tables.items():
        table.to_csv(folder / "regression" / f"{name}.csv", index=False)
    indices = sensitivity_table(read_summary(folder / "summary.csv"), study.factors)
    indices.to_csv(folder / screening.SENSITIVITY, index=False)
    row = {"row": "continuous", "major_radius_mm": 2.0, "minor_radius_mm": 4.0, "not_in_model": "a"}
    volumes = dict.fromkeys(("predicted_m3_per_m", "run_low_m3_per_m", "run_high_m3_per_m"), 1e-9)
    pd.DataFrame([row | volumes]).to_csv(folder / "confirmation" / "prediction.csv", index=False)
    return folder, tables


def test_a_study_with_factors_has_a_regression(study, results):
    """Its page shows models, best designs, findings and every warning."""
    folder, tables = results
    text = html.unescape(page_of_results(folder, study))
    assert "<td>R12 wears more</td>" in text
    assert "Of 1 claims: 1 cannot be said." in text
    assert embedded(text, "small_findings.csv")["verdict"].tolist() == ["cannot be said"]
    assert len(embedded(text, "small_findings_runs.csv")) == 1
    assert "Regression of the wear" in text and tables["models"]["model"][0] in text
    assert "The target small_confirmation simulates these designs" in text and "<td>continuous</td>" in text
    assert "Not simulated." in text
    assert "Of ln wear per metre no index is told: the best model has no term" in text
    for warning in tables["warnings"]["warning"]:
        assert f"Mind: {warning}." in text


def test_what_the_best_designs_wore_stands_beside_them(study, results):
    """The table of the confirming study is shown where that study was run."""
    folder, _ = results
    figures = folder.with_name("small_confirmation") / "figures"
    figures.mkdir(parents=True)
    pd.DataFrame([{"row": "continuous", "simulated_mm3_per_m": 12.5}]).to_csv(figures / "confirmation.csv", index=False)
    text = page_of_results(folder, study)
    assert "Not simulated." not in text and '<td class="n">12.5</td>' in text


def test_no_figure_stands_twice(study, results):
    """Sections of several kinds of study name the same figures: each stands where it is named first."""
    found = sections(page_parameters(study), results[0])
    names = [
        name for section in found for block in section.blocks if isinstance(block, Pictures) for name in block.names
    ]
    assert "flow_views" in names
    assert len(names) == len(set(names))


def test_of_particle_size_only_its_own_tables(few, folder):
    """A study of particle size tells wear and steady windows by scale: here its figures of the flow alone are shown."""
    parameters = page_parameters(few)
    parameters["told"] |= {"varies_scale": True, "findings": False}
    blocks = [block for section in screening.sections(parameters, folder) for block in section.blocks]
    assert all(isinstance(block, Pictures) for block in blocks)
    assert any("relative_velocity" in block.names for block in blocks)
