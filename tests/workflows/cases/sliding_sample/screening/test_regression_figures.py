"""Declarations of a regression: tables once, figures from these tables, and what is drawn beside."""

from functools import cache

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import remarks_of
from bulkwear.workflows.cases.sliding_sample.screening import regression_figures as declared
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.products import job_of, write_product
from tests import PUBLISHED, REPOSITORY
from tests.support.screening_study import FACTORS

FIGURES = {
    "regression_coefficients": "coefficients",
    "regression_residuals": "residuals",
    "regression_half_normal": "effects",
    "regression_contours": "surface",
}  # and the table that each draws


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A function of factors: the folder of a regression on them, with a summary and all tables."""
    design = pd.read_csv(REPOSITORY / "config/designs/screening.csv")
    noise = np.random.default_rng(2).normal(0.0, 0.05, 13)
    wear = 1e-9 * (design["bed_thickness_mm"] / 20.0) ** 2 * design["velocity_m_per_s"] * np.exp(noise)
    scale = np.where(design["row"] == "R1", 1.9, 2.0)
    summary = design.assign(surface="convex", particle_scale=scale, worn_volume_per_metre_m3_per_m=wear)

    @cache
    def make(names):
        factors = {name: FACTORS[name] for name in names}
        folder = tmp_path_factory.mktemp("regression")
        summary.to_csv(folder / "summary.csv", index=False)
        job = job_of({**files_of(folder), "published": PUBLISHED / "screening_coefficients.csv"}, told_of(factors), [])
        paths = {name: folder / f"{name}.csv" for name in declared.regression.product.tables}
        write_product(declared.regression.product, job, paths)
        return folder

    return lambda factors: make("".join(factors))


def files_of(folder):
    return {"summary": folder / "summary.csv", "published_contours": PUBLISHED / "screening_contours.csv"}


def told_of(factors):
    return {"factors": factors, "labels": {name: f"{name} (mm)" for name in FACTORS}}


def figure_of(name, folder, factors):
    """The figure and the table of a declaration."""
    files = files_of(folder) | {"table": folder / f"{FIGURES[name]}.csv"}
    files |= {"published": PUBLISHED / "screening_coefficients.csv"}
    return getattr(declared, name)(job_of(files, told_of(factors), ["a remark"]))


def test_a_figure_has_the_table_of_the_regression(made, tmp_path):
    """What stands beside a figure is to the last digit what the regression wrote; remarks tell what differs."""
    folder = made(FACTORS)
    for name, table in FIGURES.items():
        figure, beside = figure_of(name, folder, FACTORS)
        beside.to_csv(tmp_path / "beside.csv", index=False)
        assert (tmp_path / "beside.csv").read_text() == (folder / f"{table}.csv").read_text()
        assert remarks_of(figure).startswith("a remark; the particle scale is not the same in all runs")


def test_published_coefficients_stand_beside_the_same_factors_only(made):
    """A study of other factors is drawn without those of the source."""

    def labels(factors):
        figure, _ = figure_of("regression_coefficients", made(factors), factors)
        return [text.get_text() for text in figure.legends[0].get_texts()]

    assert "Yan 2022, Table 3.10" in labels(FACTORS)
    assert "Yan 2022, Table 3.10" not in labels({name: FACTORS[name] for name in "vt"})


def test_every_figure_reads_a_table_that_the_regression_writes():
    """Inputs of the figures are outputs of the one job of tables."""
    written = {f"results/{{study}}/{path}" for path in declared.regression.product.tables.values()}
    for name in FIGURES:
        assert getattr(declared, name).product.inputs["table"] in written


def test_best_designs_name_their_fidelity(made, tmp_path):
    """The design table has the columns of a pattern, the prediction the fidelity that its confirmation must have."""
    folder = made(FACTORS)
    summary = pd.read_csv(folder / "summary.csv")
    regimes = tmp_path / "regimes.csv"
    runs = summary.assign(run=summary["row"] + "_convex", setting=summary["row"], regime="continuous", steady=True)
    runs[["run", "row", "setting", "surface", "regime", "steady"]].to_csv(regimes, index=False)
    files = {"summary": folder / "summary.csv", "regimes": regimes}
    tables = declared.best_designs(job_of(files, {"factors": FACTORS, "fidelity": "quick"}, []))
    assert tables["prediction"]["fidelity"].tolist() == ["quick"]
    assert list(tables["design"]) == list(pd.read_csv(REPOSITORY / "config/designs/screening.csv", nrows=0))[:7]
    assert tables["design"]["bed_thickness_mm"].tolist() == [10.0]


def test_only_a_confirming_study_has_a_confirmation():
    """A study with a regression predicts, the one that confirms it draws."""
    study = load_study("screening")
    assert declared.best_designs.product.when(study)
    assert not declared.confirmation.product.when(study)
