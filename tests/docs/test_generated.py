"""Pages and pictures that are made by code are as it makes them; the README fits in two minutes."""

import importlib.util
import io

import pandas as pd
import pytest
import yaml

from bulkwear.workflows.config.design import load_study
from tests import REPOSITORY
from tests.support import verification_page
from tests.test_house import text_of

LONGEST_README = 120  # lines


def test_what_is_checked_is_told_in_the_tests_own_words():
    """docs/verification.md is what `python -m tests.support.verification_page` writes."""
    assert verification_page.FILE.read_text(encoding="utf-8") == verification_page.page()


def test_the_picture_of_the_pipeline_is_that_of_its_program():
    """docs/pipeline.svg is what `python docs/site/pipeline.py` writes, and each folder that it names is there."""
    found = importlib.util.spec_from_file_location("pipeline", REPOSITORY / "docs" / "site" / "pipeline.py")
    program = importlib.util.module_from_spec(found)
    found.loader.exec_module(program)
    assert text_of("docs/pipeline.svg") == program.picture()
    folders = [each.strip() for boxes, _, _ in program.ROWS for _, named, _ in boxes for each in named.split(",")]
    places = [each for each in folders if " " not in each]
    assert len(places) > len(program.ROWS)
    homes = (REPOSITORY, REPOSITORY / "postproc")
    assert [each for each in places if not any((home / each).exists() for home in homes)] == []


def test_the_readme_is_short():
    """What a reader takes in within two minutes, with both commands."""
    readme = text_of("README.md")
    assert len(readme.splitlines()) <= LONGEST_README
    assert "\nmake demo " in readme and "\nmake test " in readme


def test_what_the_readme_says_of_the_demo_fits_together():
    """The runs are those of the study; wear over plain is that of the volumes beside it, in the same bed."""
    block = text_of("README.md").partition("results/demo/summary.csv\n")[2].partition("```")[0]
    table = pd.read_csv(io.StringIO(block)).set_index("run")
    study = load_study("demo")
    assert list(table.index) == [run.name for run in study.runs]
    plain = [table["worn_volume_m3"][f"{name.rpartition('_')[0]}_plain"] for name in table.index]
    assert (table["worn_volume_m3"] / plain).tolist() == pytest.approx(table["wear_over_plain"].tolist(), rel=1e-9)


def test_the_citation_is_of_this_package():
    """CITATION.cff is whole, and has version and licence of pyproject.toml."""
    told = yaml.safe_load(text_of("CITATION.cff"))
    assert {"cff-version", "message", "title", "authors", "license"} <= set(told)
    project = text_of("pyproject.toml")
    assert f'version = "{told["version"]}"' in project and f'license = "{told["license"]}"' in project
