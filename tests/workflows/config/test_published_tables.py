"""Tables of published numbers: those of the package are sound, a wrong cell is one sentence before anything runs."""

import shutil

import pytest

from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.published_tables import FOLDER, check_published
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.engine.project import PACKAGE, Project

TABLES = sorted(path.name for path in (PACKAGE / FOLDER).glob("*.csv"))


@pytest.fixture
def project(tmp_path):
    """A project with copies of all tables."""
    shutil.copytree(PACKAGE / FOLDER, tmp_path / FOLDER)
    return Project(tmp_path)


def test_every_table_of_the_package_has_a_schema_and_follows_it(project):
    """No table without, no schema left over."""
    assert sorted(load_schema("published")["properties"]) == TABLES
    check_published(project)


@pytest.mark.parametrize(
    "name, old, new, sentence",
    [
        (
            "pin_on_disc.csv",
            "laboratory,0.565",
            "laboratory,0.565 mm3",
            "line 2: unit mm3 is not allowed for value, write value, a number",
        ),
        ("pin_on_disc.csv", "laboratory,0.565", "workshop,0.565", "line 2.*of is 'workshop'.*laboratory, simulation"),
        ("pin_on_disc.csv", "laboratory,0.565", "laboratory,", "line 2.*value is missing, allowed is a number"),
        ("pin_on_disc.csv", "0.565,0.089", "0.565,-0.089", "line 2.*uncertainty is -0.089, allowed is a number from 0"),
        ("pin_on_disc.csv", "quantity,of", "quantity,by", "header: .*by"),
        ("screening_coefficients.csv", "0.032", "32", "line 3.*p_value is 32.*from 0 to 1"),
        ("gravel_tests.csv", "36.0", "1e999", "line 2.*value is"),
    ],
)
def test_a_wrong_cell_is_one_sentence(project, name, old, new, sentence):
    """File, line and column, what was found, what is allowed."""
    path = project.folder / FOLDER / name
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ConfigError, match=f"config/published/{name}.*{sentence}") as told:
        check_published(project)
    assert len(str(told.value).splitlines()) == 1


def test_a_table_of_ones_own_needs_whole_rows_only(project):
    """The package does not know its columns."""
    path = project.folder / FOLDER / "mine.csv"
    path.write_text("what,ever\n1,2\n", encoding="utf-8")
    check_published(project)
    path.write_text("what,ever\n1\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"mine.csv, line 2"):
        check_published(project)
