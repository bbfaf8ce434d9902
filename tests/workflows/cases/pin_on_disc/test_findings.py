"""What the page of pins on discs says of a study: its tables are those of the figures, its words follow from them."""

import pandas as pd
import pytest

from bulkwear.workflows.cases.pin_on_disc import findings
from bulkwear.workflows.report.sections import Table, Text
from tests import PUBLISHED

NORMALITY = pd.read_csv(PUBLISHED / "pin_on_disc_normality.csv")
STABILITY = pd.DataFrame(
    [
        ("conserving", "depth", 2, 1.5, True),
        ("conserving", "opening width", 2, 3.25, True),
        ("per_triangle", "depth", 1, float("nan"), False),
    ],
    columns=["scheme", "size", "meshes", "difference_percent", "stable"],
)


@pytest.fixture
def finished(pins, figures):
    """Folder of the small study with the tables of its figures."""
    return pins[0]


def tables(blocks):
    """The tables among blocks, by the name of their file."""
    return {block.file: block.data for block in blocks if isinstance(block, Table)}


def words(blocks):
    """What blocks say in sentences."""
    return " ".join(block.text for block in blocks if isinstance(block, Text))


def test_the_comparison_is_that_of_the_figure(finished):
    """All rows and numbers, without the names of runs."""
    (table,) = tables(findings.comparison_blocks(finished)).values()
    of_figure = pd.read_csv(finished / "figures" / "pin_comparison.csv")
    pd.testing.assert_frame_equal(table, of_figure.drop(columns="run"))


def test_factors_are_those_that_the_figure_shows(finished):
    """The rows of the figure; the sentence of the published groove names no formula."""
    blocks = findings.excess_blocks(finished)
    of_figure = pd.read_csv(finished / "figures" / "excess_volume.csv")
    table = tables(blocks)["factors"]
    pd.testing.assert_frame_equal(table, of_figure[list(table)])
    assert words(blocks).endswith("3.5 times the published volume and 13 times alpha F L.")


def test_fits_stand_beside_the_published_ones(finished):
    """Of conserving runs what the surface loses, of others Eq 5.9 over touched triangles too; five published fits."""
    (table,) = tables(findings.fit_blocks(finished)).values()
    conserving = table[table["scheme"] == "conserving"]
    assert set(conserving["volume"]) == {"removed"} and "run" not in table
    assert set(table.loc[table["scheme"] == "per_triangle", "volume"]) == {"removed", "Eq 5.9, touched"}
    assert table.loc[table["volume"] == "published", "scheme"].tolist()[0] == "Yan 2022, Eq 5.11"
    assert (table["volume"] == "published").sum() == 5


def test_published_volumes_stand_beside_those_by_the_sources_rule(finished):
    """Per-triangle runs of a published coefficient alone, after their last revolution; Eq 5.13 at 3 is 0.105 mm3."""
    volumes = pd.DataFrame(
        [(run, scheme, 1.7e-11, revolution, 1e-10 * revolution, published)
         for run, scheme, published in (("d", "per_triangle", 0.105e-9), ("c", "conserving", 0.105e-9),
                                        ("e", "per_triangle", float("nan"))) for revolution in (1.0, 3.0)],
        columns=["run", "scheme", "wear_coefficient_per_pa", "revolution", "touched_centroid_path_volume_m3",
                 "published_volume_m3"],
    )  # fmt: skip
    (line,) = findings.volumes_beside_source(volumes).to_dict("records")
    assert (line["quantity"], line["setting"]) == ("volume after 3 revolutions", "1.7e-11 1/Pa")
    assert line["published_value"] == pytest.approx(0.105) and line["computed_value"] == pytest.approx(0.3)
    (block,) = findings.fit_blocks(finished)
    assert set(block.beside_source["setting"]) <= {f"{each}e-11 1/Pa" for each in ("1", "1.5", "1.7", "2", "5")}


def test_the_run_in_is_told_by_scheme_and_source(finished):
    """A smooth wave is never normal, the source's table is from revolution 8; p values of both by revolution."""
    blocks = findings.run_in_blocks(finished)
    found = tables(blocks)
    assert found["run_in"]["run"].tolist() == ["c", "d", "Yan 2022, Table 5.3"]
    assert found["run_in"]["run_in_revolution"].tolist()[-1] == 8
    assert "depth: normal from: conserving never, per triangle never, Yan 8" in words(blocks)
    theirs = found["p_values"].set_index("revolution")["Yan depth_p_value"]
    assert theirs.tolist() == NORMALITY["depth_p_value"].tolist()
    assert found["p_values"]["conserving, depth"].notna().sum() == 3


def test_sizes_stand_beside_the_published_bound(finished):
    """The one scaled pin, and under what the source has its differences."""
    blocks = findings.size_blocks(finished)
    assert tables(blocks)["size_invariance"]["difference_percent"].tolist() == pytest.approx([2.0])
    assert words(blocks) == "Published (Yan 2022, Fig 4.6): under 0.6 %."


def write_series(folder):
    """A series of two meshes of each scheme as the figure leaves it."""
    rows = [
        (scheme, element, size, mean)
        for scheme, factor in (("conserving", 1.0), ("per_triangle", 3.0))
        for element, depth, width in ((0.1, 0.003, 0.9), (1.0, 0.001, 1.4))
        for size, mean in (("depth", factor * depth), ("opening width", width))
    ]
    (folder / "figures").mkdir()
    table = pd.DataFrame(rows, columns=["scheme", "element_size_mm", "size", "mean_mm"])
    table.assign(revolution=12).to_csv(folder / "figures" / "mesh_series.csv", index=False)


def test_sentence_of_the_meshes(tmp_path):
    """Both ends of the series are named, the largest difference, and whether it is within 5 %; one mesh alone is no
    comparison.
    """
    write_series(tmp_path)
    STABILITY.to_csv(tmp_path / "figures" / "mesh_stability.csv", index=False)
    blocks = findings.mesh_blocks(tmp_path)
    pd.testing.assert_frame_equal(tables(blocks)["mesh_stability"], STABILITY)
    assert words(blocks) == (
        "After revolution 12: conserving, elements of 0.1 to 1 mm: depth 3 to 1 µm, opening 0.9 to 1.4 mm; per "
        "triangle, elements of 0.1 to 1 mm: depth 9 to 3 µm, opening 0.9 to 1.4 mm. Meshes "
        "with elements up to 1/5 of the groove's width differ by: conserving: up to 3.2 % among 2 meshes, "
        "within 5 %; per triangle: fewer than two meshes are that fine, nothing is compared."
    )


def test_coefficient_of_the_laboratory_is_stated(finished):
    """(6.28 +- 0.99)e-13 beside the published (6.3 +- 1)e-13; the limit by the cap names cycles and elements."""
    blocks = findings.coefficient_blocks(finished)
    said = words(blocks)
    assert "(6.28 ± 0.99)e-13 1/Pa; published (6.3 ± 1)e-13." in said
    assert "holds for 2 wear cycles per revolution and elements of 0.5 mm on the track only." in said
    assert "A run-in that ends with revolution 1 sets no limit" in said
    limits = tables(blocks)["scaling_limits"].set_index("run")
    assert limits.loc["Yan 2022, Table 5.3", "largest_factor"] == pytest.approx(162.8, abs=0.05)


def test_first_revolution_of_conserving_runs():
    """The product of rise and slip less 1, in per cent, least to largest; other runs and revolutions do not count."""
    factors = pd.DataFrame(
        [
            ("conserving", 1, 1.001, 1.0),
            ("conserving", 1, 1.002, 1.001),
            ("conserving", 2, 1.5, 1.0),
            ("per_triangle", 1, 2.0, 1.0),
        ],
        columns=["scheme", "revolution", "force_rise", "slip"],
    )
    assert "by 0.1 to 0.3 %." in findings.first_revolution(factors)


def test_scheme_without_runs_is_not_spoken_of():
    """A study of one scheme says nothing of the other."""
    columns = ["run", "scheme", "revolution", "wear_coefficient_per_pa", "force_rise", "slip", "published"]
    one = pd.DataFrame([("a", "per_triangle", 1, 1.7e-11, 1.0, 1.0, 3.1)], columns=columns)
    assert findings.first_revolution(one) == ""
    assert findings.what_is_left(one.assign(scheme="conserving")) == ""


def test_what_the_rules_leave():
    """Ranges over per-triangle runs with a published fit, and what is left at the end of each."""
    rows = [
        ("a", "per_triangle", 1, 1.7e-11, 1.0, 6.1, 0.5, 3.1, 1.02),
        ("a", "per_triangle", 2, 1.7e-11, 1.01, 6.3, 0.7, 4.0, 0.9),
        ("b", "per_triangle", 1, 6.8e-11, 1.5, 9.0, 0.1, float("nan"), float("nan")),
        ("c", "conserving", 1, 1.7e-11, 1.0, 1.0, 1.0, 3.1, 3.1),
    ]
    names = ("run", "scheme", "revolution", "wear_coefficient_per_pa", "force_rise", "displacement_rule")
    factors = pd.DataFrame(rows, columns=[*names, "summing_rule", "published", "unexplained"])
    text = findings.what_is_left(factors)
    assert "1 to 1.01 of the load" in text and "takes 6.1 to 6.3 times" in text and "finds 0.5 to 0.7 of that" in text
    assert text.endswith("0.9 to 1.02 times this product, after the last revolution 0.9 at 1.7e-11 1/Pa.")
