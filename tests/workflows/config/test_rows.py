"""Any rows of any design can be chosen: what was not refuses nothing, and no figure asks for what is not there."""

import random

import pytest

from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.report.products import outputs_of, paths_of, products_of_study, told_to

SINGLE_ROWS, SUBSETS = 6, 3  # of each study
PRODUCED = ("/figures/", "/tester/", "/tables/")  # folders of what products make


@pytest.mark.parametrize("name", list_studies())
def test_every_product_of_any_subset_has_what_it_is_made_of(name):
    """Each row alone and some rows together: a figure or table that needs more than was chosen is not asked for, so
    what the others are made of is made, or simulated. A search chooses its rows itself."""
    quick, chance = {"fidelity": "quick"}, random.Random(name)
    whole = load_study(name, overrides=quick)
    rows = whole.chosen_settings
    if whole.optimise:
        with pytest.raises(ConfigError, match="rows stands beside optimise"):
            load_study(name, overrides=quick | {"rows": rows[:1]})
        return
    chosen = [[row] for row in chance.sample(rows, min(SINGLE_ROWS, len(rows)))]
    chosen += [chance.sample(rows, chance.randint(1, len(rows))) for _ in range(SUBSETS)]
    for subset in chosen:
        study = load_study(name, overrides=quick | {"rows": subset})
        assert {study.setting_of[run.row] for run in study.runs} == set(subset)
        products = products_of_study(study).values()
        made = {path for product in products for path in outputs_of(product, name).values()}
        for product in products:
            told_to(product, study)
            found = [paths_of(source, study) for source in product.inputs.values()]
            paths = [path for each in found for path in ([each] if isinstance(each, str) else each)]
            asked = {path for path in paths if any(folder in path for folder in PRODUCED)}
            assert asked <= made, (subset, product.name)


@pytest.mark.parametrize(
    "wrong",
    [
        "R5,4,8,60,6.0,2.0,much",  # no number
        "R5,4,8,60,6.0,2000,30",  # out of its range
        "R5,4,8,60,6.0,2.0,2",  # too thin a bed: only a check of the whole run sees it
    ],
)
def test_a_row_that_was_not_chosen_refuses_nothing(config, wrong):
    """A fault in a row counts where the row is simulated."""
    config.edit("designs/small.csv", "R5,4,8,60,6.0,2.0,30", wrong)
    with pytest.raises(ConfigError, match="row R5"):
        load_study("small", project=config.project)
    with pytest.raises(ConfigError, match="row R5"):
        load_study("small", project=config.project, overrides={"rows": ["R5"]})
    study = load_study("small", project=config.project, overrides={"rows": ["R9"]})
    assert [run.name for run in study.runs] == ["R9_convex", "R9_plain"]


@pytest.mark.parametrize(("rows", "left_out"), [(["R9"], ["R5"]), (["R5", "R9"], [])])
def test_a_study_knows_what_was_not_chosen(config, rows, left_out):
    """The settings of the design of which no row is run."""
    assert load_study("small", project=config.project, overrides={"rows": rows}).settings_left_out == left_out


def test_an_unknown_row_is_named(config):
    """With the rows that there are."""
    with pytest.raises(ConfigError, match=r"row is 'R7', allowed is one of R9, R5"):
        load_study("small", project=config.project, overrides={"rows": ["R7"]})
