"""The schemas of settings: JSON schemas, a unit and a range for every number, all that can be chosen."""

from __future__ import annotations

import re

import pytest

from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.cases.sliding_sample.decks import LEDGERS
from bulkwear.workflows.config.layers import dotted, read_yaml
from bulkwear.workflows.config.patterns import with_patterns
from bulkwear.workflows.config.readme import readme
from bulkwear.workflows.config.schema import OF_PACKAGE, SCHEMA_FOLDER, leaves, load_schema, validator
from bulkwear.workflows.config.validation import ALL_SUFFIXES, UNIT_OF_SUFFIX
from bulkwear.workflows.engine.cases import case_names, find_case
from bulkwear.workflows.engine.ledgers import PRODUCERS
from bulkwear.workflows.report.page_parameters import page_of
from tests import REPOSITORY

SUFFIX = ".schema.yaml"
SCHEMAS = sorted(
    path.relative_to(SCHEMA_FOLDER).as_posix().removesuffix(SUFFIX)
    for path in SCHEMA_FOLDER.rglob("*.yaml")
    if path.stem != "published.schema"  # of tables: a row says its unit, and where it is from
)


def test_schemas_of_the_package_are_json_schemas():
    """Nobody looks at them again when they are read."""
    files = sorted(OF_PACKAGE.rglob("*.schema.yaml"))
    assert SCHEMA_FOLDER / "settings.schema.yaml" in files and any("cases" in path.parts for path in files)
    for path in files:
        validator().check_schema(with_patterns(read_yaml(path, REPOSITORY).values))


@pytest.mark.parametrize("name", SCHEMAS)
def test_units_of_the_schemas_agree_with_the_keys(name):
    """The unit that a schema states is the one that the key's suffix spells, for every number."""
    for path, schema in leaves(load_schema(name)):
        if "x-unit" in schema:
            suffix = next((s for s in ALL_SUFFIXES if str(path[-1]).endswith(f"_{s}")), None)
            assert UNIT_OF_SUFFIX.get(suffix, "-") == schema["x-unit"], dotted(path)


@pytest.mark.parametrize("name", SCHEMAS)
def test_every_number_has_a_range_a_unit_and_a_meaning(name):
    """No number without lower and upper bound, unit and description."""
    numbers = [(p, s) for p, s in leaves(load_schema(name)) if s.get("type") in ("number", "integer")]
    for path, schema in numbers:
        bounds = [key for key in schema if re.fullmatch(r"(exclusive)?(minimum|maximum)", key, re.IGNORECASE)]
        assert len(bounds) == 2, dotted(path)
        assert {"x-unit", "description"} <= set(schema), dotted(path)


def test_every_folder_of_a_case_can_be_chosen_and_has_its_page():
    """The study's schema offers the cases whose folders are there; each registers itself and has a page."""
    offered = load_schema("study")["properties"]["case"]["enum"]
    assert offered == case_names() and len(offered) >= 4
    assert [find_case(name).name for name in offered] == offered
    assert all(callable(page_of(name).sections) for name in offered)


def test_every_law_and_every_producer_can_be_chosen():
    """The schema offers the wear laws and the producers of ledgers that there are, and no others."""
    properties = load_schema("settings")["properties"]
    assert set(properties["wear"]["properties"]["law"]["enum"]) == set(LAWS)
    assert set(properties["ledger"]["enum"]) == set(PRODUCERS) == set(LEDGERS)


def test_the_page_of_keys_is_up_to_date(repository):
    """config/README.md is what `python -m bulkwear.workflows.config.readme` writes."""
    assert (repository / "config" / "README.md").read_text(encoding="utf-8") == readme()
