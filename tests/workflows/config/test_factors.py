"""Factors of a regression, replicates, and the best designs that a study confirms."""

from __future__ import annotations

import re

import pytest

from bulkwear.workflows.cases.sliding_sample.study import finds_regimes
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError

BEST = "row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm\n"
FACTORS = "surfaces: [convex, plain]\nfactors: {a: major_radius_mm, t: bed_thickness_mm}"


def with_factors(config, factors, design="R1,2,2,20,1.5,0.5,30\nR2,4,2,20,1.5,0.5,30\nR3,4,4,20,1.5,0.5,30\n"):
    """The small study with factors of a regression, and with more rows."""
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", f"surfaces: [convex, plain]\nfactors: {factors}")
    path = config.path("designs/small.csv")
    path.write_text(path.read_text() + design)


def test_factors_of_a_regression(config):
    """Factors come with short names of the study's own; without them there is no regression."""
    assert load_study("small", config.project).factors == {}
    with_factors(config, "{a: major_radius_mm, x: minor_radius_mm}")
    assert load_study("small", config.project).factors == {"a": "major_radius_mm", "x": "minor_radius_mm"}


@pytest.mark.parametrize(
    ("factors", "design", "sentence"),
    [
        ("{a: major_radius_mm, b: colour}", "", "factors.b is 'colour', allowed is one of major_radius_mm,"),
        ("{a: major_radius_mm}", "", "factors"),
        ("{a: major_radius_mm, b: minor_radius_mm}", "", "found a design of 2 settings, allowed are 5 or more."),
        (
            "{a: major_radius_mm, t: height_mm}",
            "R1,2,2,20,6.0,0.5,30\nR2,4,2,20,6.0,0.5,30\nR3,4,4,20,6.0,0.5,30\n",
            "factors.t is height_mm, which is 6 in every row of the design, allowed are columns with two levels",
        ),
    ],
)
def test_factors_that_tell_nothing_are_refused(config, factors, design, sentence):
    """Unknown columns, a single factor, too few rows and factors that stay the same are named, with the line."""
    with_factors(config, factors, design)
    with pytest.raises(ConfigError, match=re.escape(sentence)) as fault:
        load_study("small", config.project)
    assert "studies/small.yaml, line 5" in str(fault.value)


def test_rows_with_seeds_are_replicates(config):
    """Rows that differ in their seed alone have beds of their own; without the column all have the setting's."""
    assert load_study("small", config.project).run("R9_convex").parameters["bed"]["seed"] == 20220317
    path = config.path("designs/small.csv")
    header, first, *_ = path.read_text().splitlines()
    name, _, rest = first.partition(",")
    path.write_text(f"{header},seed\n{name}-1,{rest},20220317\n{name}-2,{rest},20221317\n")
    study = load_study("small", config.project)
    seeds = [run.parameters["bed"]["seed"] for run in study.runs if run.surface == "convex"]
    assert seeds == [20220317, 20221317]
    assert all(isinstance(seed, int) for seed in seeds)
    assert len(study.beds) == 2


@pytest.mark.parametrize("rows", [{}, {"rows": ["R9"]}])
def test_factors_without_a_pattern_are_refused(config, rows):
    """A regression is of patterned samples, whichever rows are chosen; the line and the surfaces are named."""
    with_factors(config, "{t: bed_thickness_mm, v: velocity_m_per_s}")
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", "surfaces: [plain]")
    with pytest.raises(ConfigError, match=r"small\.yaml, line 5: factors ask .*, found surfaces plain, allowed are"):
        load_study("small", config.project, rows)


def test_best_designs_are_a_study_of_their_own(config):
    """<study>_confirmation has the settings of its study and the rows of its regression, each convex and plain."""
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", FACTORS)
    path = config.path("designs/small.csv")
    path.write_text(path.read_text() + "R1,2,2,20,1.5,0.5,30\nR2,4,2,20,1.5,0.5,30\nR3,4,4,20,1.5,0.5,30\n")
    with pytest.raises(
        ConfigError, match=r"small/confirmation/design\.csv: there is no such file yet, `snakemake small`"
    ):
        load_study("small_confirmation", config.project)
    folder = config.root / "results/small/confirmation"
    folder.mkdir(parents=True)
    (folder / "design.csv").write_text(BEST + "continuous,2,4,40,3,0.5,30\n")
    study, base = (load_study(name, config.project) for name in ("small_confirmation", "small"))
    assert [run.name for run in study.runs] == ["continuous_convex", "continuous_plain"]
    assert (study.confirms, study.factors, base.confirms) == ("small", {}, "")
    assert finds_regimes(study) and finds_regimes(base)
    assert study.settings == base.settings
    assert study.title == "A small study: the best designs simulated"
    (folder / "design.csv").write_text(BEST + "continuous,2,4,40,3,0.5,thick\n")
    with pytest.raises(ConfigError, match=r"results/small/confirmation/design\.csv, line 2"):
        load_study("small_confirmation", config.project)


def test_a_study_without_factors_has_nothing_to_confirm(config):
    """Without a regression there is no best design; of a study that is not there neither."""
    with pytest.raises(ConfigError, match="small has nothing to confirm, allowed is a study with factors"):
        load_study("small_confirmation", config.project)
    with pytest.raises(ConfigError, match="other"):
        load_study("other_confirmation", config.project)
