"""The study of particle size: scales as rows of one pattern, and what is told of it."""

import re
from dataclasses import replace

import pytest

from bulkwear.workflows.cases.sliding_sample.particle_size.guidance import Particles, Pattern, guidance
from bulkwear.workflows.cases.sliding_sample.particle_size.study import (
    bumps_and_particles,
    by_scale,
    has_published_pattern,
)
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.text import number, setting_rows

ROUNDING = 1e-9  # relative
ROWS = {
    "quick": [4, 6, 8, 9, 10, 12],
    "standard": [2, 3, 4, 6, 8, 9, 10, 12],
    "paper": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12],
}


def study(fidelity="quick", **overrides):
    return load_study("particle_size", overrides={"fidelity": fidelity, "packings": 1, **overrides})


@pytest.mark.parametrize("fidelity", ROWS)
def test_rows_are_particle_scales_of_one_pattern(fidelity):
    """Each row has its scale, the pattern is run R5's, and the whole bed weighs what its thickness says."""
    found = study(fidelity)
    assert list(by_scale({run.name: run.parameters for run in found.runs})) == ROWS[fidelity]
    assert len(found.beds) == len(ROWS[fidelity])
    patterns = [run.parameters["pattern"] for run in found.runs if run.surface == "convex"]
    assert all(pattern == patterns[0] for pattern in patterns)
    assert [patterns[0][f"{name}_m"] for name in ("major_radius", "minor_radius", "height")] == [4e-3, 8e-3, 6e-3]


@pytest.mark.parametrize(
    ("of_row", "of_study"), [({"height_mm": 3.0}, {}), ({}, {"row_spacing_mm": 20}), ({"column_spacing_mm": 40}, {})]
)
def test_the_sources_lines_are_of_its_pattern_alone(of_row, of_study):
    """Bumps of another height or farther apart than run R5's are another pattern, though they are convex too."""
    found = study()
    assert has_published_pattern(found)
    settings = found.settings | {"pattern": found.settings["pattern"] | of_study}
    rows = tuple(row | of_row for row in found.design_rows)
    assert not has_published_pattern(replace(found, design_rows=rows, settings=settings))


def test_paper_has_the_sources_bed():
    """2000 x 300 mm and 40 kg (Yan 2022, section 4.4.1), within the rounding of the thickness to whole millimetres."""
    derived = study("paper").runs[0].parameters["derived"]
    assert derived["bed_length_m"] == pytest.approx(2.0, rel=ROUNDING)
    assert derived["bed_mass_kg"] == pytest.approx(40.0, rel=0.5 / 46.0)


def test_a_scale_out_of_range_is_refused_with_its_row(config):
    """One sentence: file, line, column, value, allowed."""
    config.write(
        "designs/small.csv",
        "row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm,particle_scale\n"
        "S1,8,2,20,6.0,1.0,40,0.5\n",
    )
    with pytest.raises(ConfigError, match=r"designs/small\.csv, line 2.*particle_scale is 0\.5.*from 1 to 20"):
        load_study("small", config.project)


def test_guidance_is_of_real_particles_whatever_the_scale():
    """Rows of all scales have the same real particles and pattern, so the same guidance."""
    rows = bumps_and_particles(study())
    told = [guidance(Pattern(**row["pattern"]), Particles(**row["particles"])) for row in rows.values()]
    for one in told:
        assert one == pytest.approx(told[0], rel=ROUNDING)
    assert told[0]["largest_scale"] == pytest.approx(3.456, abs=5e-4)
    assert [row["scale"] for row in rows.values()] == ROWS["quick"]


@pytest.mark.parametrize("fidelity", ROWS)
def test_its_page_can_print_every_setting(fidelity):
    """Settings of the study stand in the page's tables as numbers and words, packing and rows included."""
    parameters = page_parameters(study(fidelity))
    tables = setting_rows(parameters["settings"], parameters["paper_settings"])
    printed = {row["name"]: number(row["value"]) for rows in tables.values() for row in rows}
    assert printed and all(isinstance(text, str) for text in printed.values())


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("", "packing is missing for row R9, allowed is a block of keys, as in config/studies/particle_size.yaml"),
        ("packing: {every_scale: false}\n", "packing.width_diameters is missing, allowed is a number from 4 to 200"),
    ],
)
def test_containers_are_whole(config, given, said):
    """Rows that give their particle scale are compared as packings in containers too, of which nothing is assumed."""
    header, *rows = config.path("designs/small.csv").read_text(encoding="utf-8").splitlines()
    lines = [f"{header},particle_scale", *(f"{row},6" for row in rows)]
    config.write("designs/small.csv", "\n".join(lines) + "\n")
    config.write("studies/small.yaml", config.path("studies/small.yaml").read_text(encoding="utf-8") + given)
    with pytest.raises(ConfigError, match=re.escape(said)):
        load_study("small", config.project)
