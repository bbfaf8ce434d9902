"""Sizes of a bulk material as percent passing, for beds of any case: classes by the stated rule, told, or refused."""

import pytest
import yaml

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.report.page_parameters import page_of, page_parameters

MATERIALS, STUDY = "materials.yaml", "studies/small.yaml"
MEDIAN, CLASSES = "    median_diameter_mm: 2.65\n", "relative_diameter: [0.8, 1.0, 1.2]\n"
FRACTIONS = "      mass_fraction: [0.25, 0.50, 0.25]\n"
SIEVES = "passing: {sieve_mm: [1, 2, 4], fraction: [0, 0.5, 1]}\n      finest_fraction: 0.2\n      size_classes: 4\n"
ROUNDING = 1e-12  # -, of sums and logarithms of a few numbers
SCALE = 2.0  # of the study


def sieved(config, sieves=SIEVES, without=(MEDIAN, FRACTIONS)):
    """A study whose gravel is given by sieves; without: lines that are taken out."""
    config.edit(MATERIALS, CLASSES, sieves)
    for line in without:
        config.edit(MATERIALS, line, "")
    return load_study("small", config.project)


def test_classes_have_the_diameters_at_their_middle_mass(config):
    """A straight line in the logarithm of the size: d = 4^p mm at the mass p above the cut; the median is 2 mm."""
    study = sieved(config)
    particle = study.runs[0].parameters["particle"]
    middles = [0.3, 0.5, 0.7, 0.9]
    assert particle["diameters_m"] == pytest.approx([SCALE * 1e-3 * 4.0**p for p in middles], rel=ROUNDING)
    assert particle["mass_fractions"] == pytest.approx([0.4, 0.2, 0.2, 0.2], rel=ROUNDING)
    assert particle["median_diameter_m"] == pytest.approx(SCALE * 2e-3, rel=ROUNDING)
    bed = study.beds[study.bed_of(study.runs[0].name)]
    assert bed["particle"]["diameters_m"] == particle["diameters_m"]


def test_the_rule_is_told_on_the_page(config):
    """With the cut and the classes, of the true diameters; materials with classes of their own say nothing."""
    told = dict(page_of("sliding_sample").simplifications(page_parameters(sieved(config))))["Particles"]
    assert "True sizes: The finest 20 % by mass are counted to the smallest class; the rest is divided into 4" in told
    assert "1.52 mm (40 %)" in told


def test_what_they_become_is_a_file_of_materials_again(config):
    """As a calibration writes it."""
    study = sieved(config)
    config.write(MATERIALS, yaml.safe_dump(study.materials))
    again = load_study("small", config.project)
    assert again.runs[0].parameters["particle"] == study.runs[0].parameters["particle"]


@pytest.mark.parametrize(
    ("sieves", "without", "fault"),
    [
        (
            SIEVES,
            (FRACTIONS,),
            "line 7: particles.river_gravel.median_diameter_mm stands beside"
            " particles.river_gravel.size_distribution.passing, from which it follows, allowed is one of them.",
        ),
        (
            SIEVES.replace("      size_classes: 4\n", ""),
            (MEDIAN, FRACTIONS),
            "line 7: particles.river_gravel.size_distribution.size_classes is missing, allowed is a whole number from 1"
            " to 20.",
        ),
        (
            SIEVES.replace("0.5, 1]", "0.5, 0.9]"),
            (MEDIAN, FRACTIONS),
            "line 8: particles.river_gravel.size_distribution.passing: 0.9 passes the largest sieve, allowed is 1;"
            " passing is a fraction, not percent.",
        ),
        (
            SIEVES.replace("[0, 0.5, 1]", "[4, 55, 100]"),
            (MEDIAN, FRACTIONS),
            "line 8: particles.river_gravel.size_distribution.passing.fraction[1] is 4, allowed is a number from 0 to"
            " 1, no percentage.",
        ),
        (
            CLASSES,
            (MEDIAN,),
            "line 2: particles.river_gravel.median_diameter_mm is missing, allowed is a number from 0.01 to 200 mm.",
        ),
        (
            CLASSES,
            (FRACTIONS,),
            "line 8: particles.river_gravel.size_distribution.mass_fraction is missing, allowed is a list of numbers"
            " from 1e-9 with the sum 1.",
        ),
    ],
)
def test_sizes_that_are_no_sizes_are_one_sentence(config, sieves, without, fault):
    """In both ways, without a key, or no curve: file, line, what was found and what is allowed."""
    with pytest.raises(ConfigError) as caught:
        sieved(config, sieves, without)
    assert str(caught.value) == f"config/materials.yaml, {fault}"
