"""The page of keys: what a study has to give, blocks that may be left out, columns by path."""

import pytest

from bulkwear.workflows.config.readme import readme


@pytest.fixture(scope="module")
def equipment():
    """The section about the case whose studies give most of their settings themselves, by lines."""
    (section,) = (each for each in readme().split("\n## ") if each.startswith("Case `equipment`"))
    return section.splitlines()


def row_of(lines, key):
    """The cells of the row of a key."""
    (line,) = (line for line in lines if line.startswith(f"| `{key}` |"))
    return [cell.strip() for cell in line.strip("|").split(" | ")]


@pytest.mark.parametrize(
    ("key", "unit", "end"),
    [
        ("parts", "-", "; needed"),  # a block
        ("parts.<name>.edge_mm", "mm", "; needed"),  # below a free name
        ("parts.<name>.motion", "-", "; may be left out"),
        ("parts.<name>.motion.kind", "-", "; needed"),
        ("inlet", "-", "; may be left out"),
        ("inlet.rate_t_per_h", "t/h", "; needed"),
        ("parts.<name>", "-", "a block of keys"),  # one of many
        ("bulk", "-", "a block of keys"),  # has defaults, so it is always there
        ("parts.<name>.thickness_mm", "mm", "to 10000"),
        ("operation.duration_h", "h", "to 500000"),
    ],
)
def test_what_a_study_has_to_give(equipment, key, unit, end):
    """Keys without a default are told from others, at any depth; so are blocks."""
    _, found, allowed, meaning = row_of(equipment, key)
    assert found == unit
    assert allowed.endswith(end)
    assert meaning


@pytest.mark.parametrize(
    ("key", "end"),
    [
        ("walls.<name>.shear_modulus_pa", "; needed"),
        ("walls.<name>.contact.restitution", "; needed"),
        ("walls.<name>.hardness_pa", "to 1e+11"),
        ("particles.<name>.median_diameter_mm", "to 200"),
        ("solver.ranks", "to 4096"),  # has a default, which some file must give
    ],
)
def test_what_a_material_has_to_have(key, end):
    """What its schema requires, for materials have no defaults; settings have."""
    assert row_of(readme().splitlines(), key)[2].endswith(end)


def test_columns_by_path(equipment):
    """Only tables of a case that allows it say that any setting may be a column."""
    assert any(
        "any setting of the case that is a number, a word or a list of numbers may be" in line for line in equipment
    )
    assert readme().count("any setting of the case") == 1


def test_a_docstring_over_two_lines_is_told_whole(equipment):
    """The first paragraph of the case, not its first line."""
    assert equipment[2].endswith(".")
