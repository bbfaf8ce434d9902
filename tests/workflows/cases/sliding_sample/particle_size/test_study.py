"""The study of particle size: scales as rows, figures of its own, and packings made of its runs' parameters."""

import pandas as pd
import pytest
from workflows.report.figures import PARTICLE_SIZE, bumps_and_particles, figures_of, page_parameters, published_flow

from workflows.cases.sliding_sample.particle_size.collision_tests import collision
from workflows.cases.sliding_sample.particle_size.guidance import Particles, Pattern, guidance
from workflows.cases.sliding_sample.particle_size.packings import (
    AT_REST_BEHIND,
    LEAVING_DIAMETERS,
    MODELS,
    by_scale,
    collision_tables,
    collision_tests,
    container,
    packed_runs,
    packing_costs,
    packing_table,
    pieces,
)
from workflows.cases.sliding_sample.particle_size.work import packing_work
from workflows.config.design import ConfigError, load_study
from workflows.config.units import to_si
from workflows.engine.bulk_tests import deck_text
from workflows.report.text import number, setting_rows

ROUNDING = 1e-9  # relative
CONTAINER = 0.25  # relative, of the forecast of the narrowest container: fewer fit between its sides. Measured: 0.19
ROWS = {"quick": [4, 6, 8], "standard": [2, 3, 4, 6, 8], "paper": [1, 2, 3, 4, 5, 6, 7, 8]}


def study(fidelity="quick", **overrides):
    return load_study("particle_size", overrides={"fidelity": fidelity, **overrides})


def runs_of(found):
    return {run.name: run.parameters for run in found.runs}


@pytest.mark.parametrize("fidelity", ROWS)
def test_rows_are_particle_scales_of_one_pattern(fidelity):
    """Each row has its scale, the pattern is run R5's, and the whole bed weighs what its thickness says."""
    found = study(fidelity)
    assert list(by_scale(runs_of(found))) == ROWS[fidelity]
    assert len(found.beds) == len(ROWS[fidelity])
    patterns = [run.parameters["pattern"] for run in found.runs if run.surface == "convex"]
    assert all(pattern == patterns[0] for pattern in patterns)
    assert [patterns[0][f"{name}_m"] for name in ("major_radius", "minor_radius", "height")] == [4e-3, 8e-3, 6e-3]


def test_paper_has_the_sources_bed():
    """2000 x 300 mm and 40 kg (Yan 2022, section 4.4.1), within the rounding of the thickness to whole millimetres."""
    derived = study("paper").runs[0].parameters["derived"]
    assert derived["bed_length_m"] == pytest.approx(2.0, rel=ROUNDING)
    assert derived["bed_mass_kg"] == pytest.approx(40.0, rel=0.5 / 46.0)


def test_a_study_of_particle_size_has_figures_of_its_own():
    """They stand first; the flow is looked at as in the screening; a study of one scale has none of them."""
    names = figures_of(study())
    assert names[: len(PARTICLE_SIZE)] == list(PARTICLE_SIZE)
    assert {"relative_velocity", "wear_gradient", "velocity_profiles", "wear_split"} <= set(names)
    assert not set(PARTICLE_SIZE) & set(figures_of(load_study("demo")))
    screening = load_study("screening")
    assert not set(PARTICLE_SIZE) & set(figures_of(screening))
    tables = [published_flow(each) for each in (study(), screening)]  # chapter 4 has a steady window of its own
    assert tables == [f"config/published/{name}_results.csv" for name in ("particle_size", "screening")]


def test_a_scale_out_of_range_is_refused_with_its_row(config):
    """One sentence: file, line, column, value, allowed."""
    config.write(
        "designs/small.csv",
        "row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm,particle_scale\n"
        "S1,8,2,20,6.0,1.0,40,0.5\n",
    )
    with pytest.raises(ConfigError, match=r"designs/small\.csv, line 2.*particle_scale is 0\.5.*from 1 to 20"):
        load_study("small", config.root)


def test_guidance_is_of_real_particles_whatever_the_scale():
    """Rows of all scales have the same real particles and pattern, so the same guidance."""
    rows = bumps_and_particles(study())
    told = [guidance(Pattern(**row["pattern"]), Particles(**row["particles"])) for row in rows.values()]
    for one in told:
        assert one == pytest.approx(told[0], rel=ROUNDING)
    assert told[0]["largest_scale"] == pytest.approx(3.456, abs=5e-4)
    assert [row["scale"] for row in rows.values()] == ROWS["quick"]


def test_containers_and_collisions_are_of_the_studys_particles():
    """Amplitude and width follow the scale; each rolling type collides at each scale."""
    found = study()
    runs, packing = runs_of(found), to_si(found.settings)["packing"]
    for scale, run in by_scale(runs).items():
        test = container(run, packing)
        assert test["shaking"]["amplitude_m"] == pytest.approx(0.1 * scale * 2.65e-3, rel=ROUNDING)
        assert "packed container" in deck_text(test).lower()
    tests = collision_tests(runs)
    assert len(tests) == len(MODELS) * len(ROWS["quick"])
    assert collision(tests[0])["solver"]["rolling_friction"] == MODELS[0]


def test_pieces_of_bed_lie_where_they_are_said_to():
    """Before: the settled bed without its ends. After: at rest behind the sample, ahead of it when it started, and
    short of where a window lets it out."""
    run = study().run("S4_plain").parameters
    found = pieces(run)
    start, end, width = found["before"]
    assert start > run["derived"]["bed_start_m"] and width == run["bed"]["width_m"]
    assert end < run["derived"]["bed_start_m"] + run["derived"]["bed_length_m"]
    start, end, width = found["after"]
    assert start == pytest.approx(0.1 + AT_REST_BEHIND) and width == run["sample"]["width_m"]
    assert end == pytest.approx(0.1 + 0.4 - LEAVING_DIAMETERS * 4 * 2.65e-3)
    start, end, width = pieces(study("paper").run("S4_plain").parameters)["after"]
    assert end == pytest.approx(0.7 + 1.0 - 0.1)  # where the bed at the front has come to, less what was behind it


@pytest.mark.parametrize("fidelity", ROWS)
def test_a_piece_of_bed_at_rest_is_left_behind_every_sample(fidelity):
    """At every scale it is at least three median diameters long, so that a packing can be told from it."""
    for run in study(fidelity).runs:
        start, end, _ = pieces(run.parameters)["after"]
        assert end - start > 3.0 * run.parameters["particle"]["median_diameter_m"]


@pytest.mark.solver
def test_collisions_of_the_study_are_alike_and_thinned_out(tmp_path):
    """Measures of two scales agree; histories are short enough for a table; the dumps are gone."""
    runs = runs_of(study(rows=["S4", "S8"]))
    histories, measures = collision_tables(runs, tmp_path)
    first, other = (measures[measures["particle_scale"] == scale].reset_index(drop=True) for scale in (4.0, 8.0))
    for name in ("restitution", "largest_overlap", "largest_force"):
        assert (first[name] / other[name] - 1.0).abs().max() < 1e-3
    assert len(histories) < 20_000 and not list(tmp_path.glob("*/*.dump"))


@pytest.mark.parametrize("fidelity", ROWS)
def test_containers_of_every_scale(fidelity):
    """Standard packs all scales of the design, in containers no higher than thirty diameters; paper fills 300 mm."""
    found = study(fidelity)
    packing, packed = to_si(found.settings)["packing"], by_scale(packed_runs(found))
    assert list(packed) == (ROWS["quick"] if fidelity == "quick" else ROWS["paper"])
    heights = {scale: container(run, packing)["box"]["fill_height_m"] for scale, run in packed.items()}
    most = {
        scale: packing["most_fill_diameters"] * run["particle"]["median_diameter_m"] for scale, run in packed.items()
    }
    assert heights == {scale: pytest.approx(min(0.3, most[scale]), rel=ROUNDING) for scale in packed}
    assert (heights[min(packed)] < 0.3) is (fidelity == "standard")


@pytest.mark.solver
def test_packings_of_the_study(tmp_path):
    """The largest scale in a narrow container, shaken for a moment: three layers of four diameters in each state."""
    found = study(packing={"width_diameters": 4, "shaking_s": 0.05})
    asked = {"S8_plain": found.run("S8_plain").parameters}, to_si(found.settings)["packing"], tmp_path
    table = packing_table(*asked)
    cost = packing_costs(*asked)
    assert cost["particle_scale"].tolist() == [8.0]
    assert (cost[["solver_s", "processor_s", "steps", "particles"]] > 0).all(axis=None)
    assert cost["processor_s"].iloc[0] <= cost["solver_s"].iloc[0]
    expected = packing_work(*asked[:2]).stages
    assert sum(stage.steps for stage in expected) == pytest.approx(cost["steps"].iloc[0], rel=CONTAINER)
    assert expected[0].particles == pytest.approx(cost["particles"].iloc[0], rel=CONTAINER)
    assert isinstance(table, pd.DataFrame) and set(table["particle_scale"]) == {8.0}
    assert table.groupby("state")["layer"].max().to_dict() == {"dense": 3, "difference": 3, "loose": 3}
    assert table.loc[table["state"] == "loose", "height_mm"].iloc[0] == pytest.approx(0.5 * 4 * 8 * 2.65, rel=ROUNDING)


@pytest.mark.parametrize("fidelity", ROWS)
def test_its_page_can_print_every_setting(fidelity):
    """Settings of the study stand in the page's tables as numbers and words, packing and rows included."""
    parameters = page_parameters(study(fidelity))
    tables = setting_rows(parameters["settings"], parameters["paper_settings"])
    printed = {row["name"]: number(row["value"]) for rows in tables.values() for row in rows}
    assert printed and all(isinstance(text, str) for text in printed.values())
