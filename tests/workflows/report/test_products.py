"""Figures and tables as declarations: what a rule gets of them, what their job writes, and what is refused."""

import json
from dataclasses import replace
from types import SimpleNamespace

import pandas as pd
import pytest

from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.engine.cases import case_names, find_case
from bulkwear.workflows.report import products
from bulkwear.workflows.report.products import (
    Product,
    figure,
    figures_of,
    job_of,
    outputs_of,
    products_of,
    rules_of,
    tables,
    told_to,
    write_product,
)
from tests.support.tiny import tiny_study

CASES = [find_case(name) for name in case_names()]


@figure(
    "Wear",
    "A line",
    inputs={"summary": "results/{study}/summary.csv"},
    tables={"more": "wear/more.csv"},
    digits={"table": 3},
    suffix="html",
    caption="""
    First of two
    paragraphs.

    Second.
    """,
)
def line(job):
    """Write the remarks where a picture would be."""
    table = pd.DataFrame({"a": [1.23456789]})
    return lambda path: open(path, "w").write(job.remarks[0]), table, {"more": table}


@tables(inputs={}, tables={"only": "wear/only.csv"})
def counts(job):
    """Return one table."""
    return {"only": pd.DataFrame({"n": [job.told.n]})}


def test_a_declaration_says_what_its_rule_has():
    """Name, rule and files follow from the function's name; a job of tables has no figure."""
    assert (line.product.rule, counts.product.rule) == ("figure_line", "tables_counts")
    assert line.product.paragraphs == ["First of two paragraphs.", "Second."]
    assert outputs_of(line.product, "demo") == {
        "figure": "results/demo/figures/line.html",
        "table": "results/demo/figures/line.csv",
        "more": "results/demo/wear/more.csv",
    }
    assert outputs_of(counts.product) == {"only": "results/{study}/wear/only.csv"}


def test_a_job_writes_figure_and_tables_with_their_digits(tmp_path):
    """A figure that is a function writes its own file; digits are those of the table that they are given for."""
    paths = {key: str(tmp_path / key) for key in ("figure", "table", "more", "only")}
    write_product(line.product, job_of({"summary": "s.csv"}, {}, ["reduced"]), paths)
    assert (tmp_path / "figure").read_text() == "reduced"
    assert (tmp_path / "table").read_text() == "a\n1.23\n"
    assert (tmp_path / "more").read_text() == "a\n1.23456789\n"
    write_product(counts.product, job_of({}, {"n": 7}, []), paths)
    assert (tmp_path / "only").read_text() == "n\n7\n"


def test_a_name_declared_twice_is_refused(monkeypatch):
    """Two cases with different figures of one name would share a rule: one sentence names both places."""
    other = replace(line.product, make=counts)
    studies = [SimpleNamespace(name=name, case=name) for name in ("one", "two")]
    monkeypatch.setattr(products, "products_of", lambda case: {"line": line.product if case == "one" else other})
    with pytest.raises(ValueError, match=r"line is declared in .* allowed is each name once"):
        rules_of(studies)
    monkeypatch.setattr(products, "products_of", lambda case: {"line": line.product})
    assert rules_of(studies) == {"figure_line": (["one", "two"], line.product)}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_declaration_of_a_case_is_whole(case):
    """Each figure has a title, a category and a caption that ends a sentence; a job of tables has a table."""
    found = products_of(case)
    assert found and all(isinstance(product, Product) for product in found.values())
    for product in found.values():
        assert product.tables or product.is_figure
        assert not product.is_figure or (product.category and product.paragraphs[-1].endswith("."))
        assert product.make.__doc__


def test_no_two_products_write_the_same_file():
    """Every path is written by one declaration of a case."""
    for case in CASES:
        paths = [path for product in products_of(case).values() for path in outputs_of(product).values()]
        assert len(set(paths)) == len(paths)


def test_what_a_job_is_told_is_json_able_and_its_figures_are_those_of_the_study():
    """Snakemake compares and hands on plain values; a rigid study has no film."""
    for name in list_studies():
        study = load_study(name)
        for product in products_of(study.case).values():
            if product.when(study):
                json.dumps(told_to(product, study))
    names = [product.name for product in figures_of(tiny_study(wear={"deform": False}))]
    assert "worn_surface" in names and "worn_film" not in names
