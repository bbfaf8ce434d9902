"""Studies become runs: layers of settings, units, derived values, shared beds."""

from __future__ import annotations

import json
import math
import re
from dataclasses import asdict

import pytest

from bulkwear.workflows.cases.sliding_sample.case import bed_parameters
from bulkwear.workflows.cases.sliding_sample.page import BEYOND_BUMPS
from bulkwear.workflows.cases.sliding_sample.parameters import ramp_hop
from bulkwear.workflows.cases.sliding_sample.study import finds_regimes
from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.config.layers import ConfigError, command_line_layer
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.derived import rayleigh_time, rolling_coefficient_for_solver, whole_steps, youngs_modulus
from bulkwear.workflows.report.page_parameters import figure_remarks
from tests import REPOSITORY
from tests.support.tiny import tiny_study

ROUNDING = 1e-12  # relative; a few floating-point operations
DIGITS_GIVEN = 1e-6  # relative; numbers worked out by hand to seven digits
FIDELITIES = ("quick", "standard", "paper")


def parameters_of(config, run="R9_convex", overrides=None):
    return load_study("small", config.project, overrides).run(run).parameters


# ---------------------------------------------------------------- the shipped studies


@pytest.mark.parametrize("fidelity", FIDELITIES)
@pytest.mark.parametrize("name", list_studies())
def test_shipped_studies_load_at_every_fidelity(name, fidelity):
    """Every shipped study is valid at every fidelity, and its parameters survive JSON unchanged."""
    study = load_study(name, overrides={"fidelity": fidelity})
    assert study.fidelity == study.settings["fidelity"] == fidelity
    for run in study.runs:
        assert json.loads(json.dumps(run.parameters, allow_nan=False)) == run.parameters


def test_screening_is_table_3_8():
    """Thirteen rows, each with a plain twin; every factor is balanced (Yan 2022, Table 3.8)."""
    study = load_study("screening", overrides={"packings": 1})
    assert [run.name for run in study.runs][:2] == ["R1_convex", "R1_plain"]
    assert len(study.runs) == 26
    levels = {
        "major_radius_mm": (2, 4, 8),
        "minor_radius_mm": (2, 4, 8),
        "column_spacing_mm": (20, 40, 60),
        "height_mm": (1.5, 3, 6),
        "velocity_m_per_s": (0.5, 1, 2),
        "bed_thickness_mm": (10, 20, 40),
    }
    for factor, (low, middle, high) in levels.items():
        column = [row[factor] for row in study.design_rows]
        assert [column.count(level) for level in (low, middle, high)] == [5, 3, 5], factor


def test_a_thin_bed_limits_the_particle_scale():
    """A bed of 10 mm holds 3.8 layers of d50 = 2.65 mm: scale 1 passes, scale 2 does not."""
    paper = load_study("screening", overrides={"fidelity": "paper"})
    assert paper.run("R2_plain").parameters["derived"]["layers"] == pytest.approx(10 / 2.65)
    with pytest.raises(ConfigError, match=r"row R2: bed_thickness_mm is 10, allowed is at least 15.9 mm"):
        load_study("screening", overrides={"fidelity": "paper", "particle_scale": 2})


def test_least_layers_lowers_the_scale_of_thin_beds_only():
    """At scale 2 a bed of 10 mm gets the scale that leaves it its least layers; one of 40 mm keeps 2; never below 1."""
    study = load_study("screening", overrides={"particle_scale": 2, "bed": {"least_layers": 3.5}})
    thin, thick = (study.run(name).parameters for name in ("R2_plain", "R9_plain"))
    assert thin["derived"]["layers"] == pytest.approx(3.5)
    assert thin["particle"]["scale"] == pytest.approx(10 / (3.5 * 2.65))
    assert thick["particle"]["scale"] == 2
    crowded = load_study("screening", overrides={"bed": {"least_layers": 3.9}})
    assert crowded.run("R2_plain").parameters["particle"]["scale"] == 1


def test_plain_twins_under_the_same_conditions_are_one_simulation():
    """A plain sample knows no pattern: rows of equal velocity and thickness share it. Convex samples share nothing."""
    study = load_study("screening", overrides={"packings": 2})
    shared = {run.name: study.same_as(run.name) for run in study.runs if study.same_as(run.name)}
    assert shared == {
        f"{row}{packing}_plain": f"{first}{packing}_plain"
        for row, first in (("R7", "R4"), ("R8", "R1"), ("R11", "R3"), ("R13", "R5"))
        for packing in ("", "-2")
    }


@pytest.mark.parametrize("fidelity", ["quick", "paper"])
def test_one_regression_has_one_particle_scale(fidelity):
    """Rows that one regression compares differ in their factors alone: one scale, at least three layers everywhere."""
    study = load_study("screening", overrides={"fidelity": fidelity})
    assert len({run.parameters["particle"]["scale"] for run in study.runs}) == 1
    assert min(run.parameters["derived"]["layers"] for run in study.runs) >= 3.0
    assert not any("scale" in remark and "row to row" in remark for remark in figure_remarks(study))


def test_a_study_whose_scale_follows_thickness_says_so():
    """At standard fidelity a bed of 10 mm has smaller particles than one of 40 mm: every figure tells."""
    study = load_study("screening", overrides={"fidelity": "standard"})
    scale = {run.parameters["bed"]["thickness_m"]: run.parameters["particle"]["scale"] for run in study.runs}
    assert scale[0.01] < scale[0.02] == scale[0.04]
    assert any("different from row to row" in remark for remark in figure_remarks(study))


def test_an_unknown_study_is_named_with_the_nearest(config):
    """A misspelt study gives the studies there are."""
    with pytest.raises(ConfigError) as caught:
        load_study("smal", config.project)
    assert str(caught.value) == ("config/studies: study is 'smal', allowed is one of small (the nearest is small).")


# ---------------------------------------------------------------- layers of settings


def test_the_strongest_layer_wins_key_by_key(config):
    """default < study < fidelity block < command line; keys that a layer does not name come from below."""
    settings = load_study("small", config.project, {"sample": {"length_mm": 70}, "bed": {"behind_mm": 123}}).settings
    assert settings["sample"]["material"] == "steel"  # default
    assert settings["bed"]["ahead_mm"] == 150  # study
    assert (settings["sample"]["width_mm"], settings["bed"]["width_mm"]) == (80, 120)  # fidelity block
    assert (settings["sample"]["length_mm"], settings["bed"]["behind_mm"]) == (70, 123)  # command line


def test_the_fidelity_comes_from_the_strongest_layer(config):
    """Command line before study before default; other blocks do not apply, an empty block is fine."""
    assert load_study("small", config.project).fidelity == "quick"
    config.edit("studies/small.yaml", "title:", "fidelity: standard\ntitle:")
    standard = load_study("small", config.project)
    assert (standard.fidelity, standard.settings["particle_scale"]) == ("standard", 1.0)
    quick = load_study("small", config.project, {"fidelity": "quick"})
    assert (quick.fidelity, quick.settings["particle_scale"]) == ("quick", 2.0)


def test_a_fidelity_may_have_a_design_of_its_own(config):
    """The block's table replaces the study's at that fidelity, and only there; a missing one is named with its line."""
    config.edit("studies/small.yaml", "    particle_scale: 2.0", "    design: few.csv\n    particle_scale: 2.0")
    with pytest.raises(ConfigError, match=r"line 8, fidelity quick: design is 'few.csv', allowed is one of small.csv"):
        load_study("small", config.project)
    table = config.path("designs/small.csv").read_text(encoding="utf-8")
    config.write("designs/few.csv", "\n".join(table.splitlines()[:2]))
    assert [run.row for run in load_study("small", config.project).runs] == ["R9", "R9"]
    assert len(load_study("small", config.project, {"fidelity": "standard"}).design_rows) == 2


def test_whole_and_decimal_numbers_give_the_same_parameters(config):
    """2 and 2.0 are the same setting, and the same JSON (states are compared by its hash)."""
    written = [json.dumps(parameters_of(config, overrides={"particle_scale": s})) for s in (2, 2.0, "2")]
    assert len(set(written)) == 1


def test_loading_twice_gives_the_same_study_and_shares_nothing(config):
    """Parameters of one study can be changed without changing another (no shared mutable state)."""
    first, untouched = (load_study("small", config.project) for _ in range(2))
    first.runs[0].parameters["particle"]["diameters_m"].append(1.0)
    first.runs[0].parameters["solver"]["ranks"] = 99
    assert load_study("small", config.project) == untouched
    assert first.runs[1] == untouched.runs[1]


# ---------------------------------------------------------------- units


def test_units_are_converted_once_and_keys_say_so():
    """mm become m and degrees rad, at every depth; what is SI stays, 1/Pa is no length."""
    converted = to_si({"a": {"width_mm": 80.0, "slope_deg": 180.0}, "k_per_pa": 2.0, "v_m_per_s": 3.0, "n": 4})
    assert converted == {
        "a": {"width_m": 0.08, "slope_rad": math.pi},
        "k_per_pa": 2.0,
        "v_m_per_s": 3.0,
        "n": 4,
    }


def test_parameters_hold_no_other_unit(config):
    """No key of a run's parameters ends in mm or deg, at any depth."""

    def keys(value):
        return [k for key, inner in value.items() for k in (key, *keys(inner))] if isinstance(value, dict) else []

    names = keys(parameters_of(config))
    assert "skirt_slope_rad" in names
    assert [name for name in names if name.endswith(("_mm", "_deg"))] == []


def test_settings_and_factors_arrive_in_si(config):
    """Each number of the settings and of the design row stands in the parameters, converted."""
    p = parameters_of(config)
    assert p["sample"]["width_m"] == 0.08
    assert p["sample"]["height_above_floor_m"] == 0.0003
    assert p["sample"]["skirt_slope_rad"] == pytest.approx(math.pi / 60, rel=ROUNDING)
    assert p["pattern"] == {
        "shape": "convex",
        "major_axis": "along_travel",
        "row_spacing_m": 0.04,
        "row_spacing_between": "neighbouring_rows",
        "row_offset_fraction": 0.5,
        "major_radius_m": 0.008,
        "minor_radius_m": 0.002,
        "height_m": 0.006,
        "column_spacing_m": 0.02,
    }
    assert p["sliding"] == {"run_in_m": 0.3, "travel_m": 1.0, "cycles": 4, "velocity_m_per_s": 1.0}
    assert p["bed"]["thickness_m"] == 0.04
    assert p["sample_material"]["name"] == "steel"
    assert p["floor_material"]["name"] == "perspex"


def test_particles_are_scaled_and_nothing_else_of_them_is(config):
    """Coarse graining scales diameters; density, moduli and contact stay (Yan 2022, section 4)."""
    fine = parameters_of(config, overrides={"particle_scale": 1})["particle"]
    coarse = parameters_of(config, overrides={"particle_scale": 2})["particle"]
    assert fine["diameters_m"] == pytest.approx([0.00212, 0.00265, 0.00318], rel=ROUNDING)
    assert coarse["diameters_m"] == pytest.approx([0.00424, 0.0053, 0.00636], rel=ROUNDING)
    assert coarse["mass_fractions"] == [0.25, 0.5, 0.25]
    differing = {key for key in fine if fine[key] != coarse[key]}
    assert differing == {"scale", "median_diameter_m", "diameters_m"}


def test_the_plain_twin_has_no_pattern_and_is_otherwise_equal(config):
    """Convex and plain runs of a row differ in the pattern and what follows from it only."""
    convex, plain = (parameters_of(config, f"R9_{surface}") for surface in ("convex", "plain"))
    assert plain["pattern"] is None
    assert plain["derived"]["equivalent_size_ratio"] is None
    assert {k for k in convex if convex[k] != plain[k]} == {"pattern", "derived"}
    assert {k for k in convex["derived"] if convex["derived"][k] != plain["derived"][k]} == {
        "equivalent_size_ratio",
        "highest_point_m",
    }


def test_the_design_table_has_one_row_per_run_with_units_in_the_names(config):
    """run, row, setting, packing and surface, then the factors as written."""
    table = load_study("small", config.project).design_table()
    assert [row["run"] for row in table] == ["R9_convex", "R9_plain", "R5_convex", "R5_plain"]
    assert table[3] == {
        "run": "R5_plain",
        "row": "R5",
        "setting": "R5",
        "packing": 1,
        "surface": "plain",
        "major_radius_mm": 4,
        "minor_radius_mm": 8,
        "column_spacing_mm": 60,
        "height_mm": 6,
        "velocity_m_per_s": 2,
        "bed_thickness_mm": 30,
        "particle_scale": 2.0,
        "layers": pytest.approx(30 / 5.3),
        "equivalent_size_ratio": None,
    }


# ---------------------------------------------------------------- derived values


def test_youngs_modulus_of_steel():
    """E = 2 G (1 + nu): 78 GPa and 0.3 give 202.8 GPa."""
    assert youngs_modulus(78e9, 0.3) == pytest.approx(202.8e9, rel=ROUNDING)


def test_rayleigh_time_against_numbers_worked_out_by_hand(config):
    """T_R = pi R sqrt(rho/G)/(0.1631 nu + 0.8766): gravel of 0.8 x 2.65 mm at scale 2 has R = 2.12 mm.

    sqrt(2460/7e7) = 5.928142e-3 s/m, times half the circumference of 6.660176 mm: 39.48247e-6 s; over
    0.915744 for nu = 0.24.
    """
    assert rayleigh_time(1.0, 1.0, 1.0, 0.0) == pytest.approx(3.583838, rel=DIGITS_GIVEN)
    assert rayleigh_time(2.12e-3, 2460.0, 0.07e9, 0.24) == pytest.approx(4.311518e-5, rel=DIGITS_GIVEN)
    derived = parameters_of(config)["derived"]
    assert derived["rayleigh_time_s"] == pytest.approx(4.311518e-5, rel=DIGITS_GIVEN)
    assert derived["largest_time_step_s"] == pytest.approx(0.2 * 4.311518e-5, rel=DIGITS_GIVEN)


def test_equivalent_size_ratio_of_r9_at_scale_2(config):
    """alpha_ER = R50/cbrt(a b h/2): 2.65 mm at scale 2 over cbrt(48) = 3.634241 mm (Yan 2022, Eq 4.18)."""
    ratio = parameters_of(config)["derived"]["equivalent_size_ratio"]
    assert ratio == pytest.approx(2.65 / 3.634241, rel=DIGITS_GIVEN)


@pytest.mark.parametrize("diameter", [0.001, 0.004])
def test_rolling_coefficients_keep_the_torque(diameter):
    """mu (solver) x the model's radius = mu (calibrated) x its radius; reduced: of equal spheres R/2, at a wall R."""
    radius, coefficient = diameter / 2, 0.4
    reduced = radius * radius / (radius + radius)
    for model, acting in (("cdt", reduced), ("epsd2", reduced), ("rvd", reduced), ("own_spin", radius)):
        for convention, meant in (("full", radius), ("reduced", reduced)):
            solver = {"rolling_friction": model, "rolling_radius": convention}
            between = rolling_coefficient_for_solver(coefficient, solver, "particle_particle")
            assert between * acting == pytest.approx(coefficient * meant, rel=ROUNDING)
            assert rolling_coefficient_for_solver(coefficient, solver, "particle_wall") == coefficient


def test_rolling_coefficients_reach_the_runs(config):
    """Between particles 0.40 becomes 0.80 with the full radius, 0.40 with the reduced; walls never change."""
    for convention, expected in (("full", 0.8), ("reduced", 0.4)):
        derived = parameters_of(config, overrides={"solver": {"rolling_radius": convention}})["derived"]
        assert derived["rolling_friction_for_solver"] == {
            "particle": expected,
            "sample_material": 0.3,
            "floor_material": 0.36,
        }


def test_an_unknown_rolling_convention_is_refused():
    """Neither another radius nor another contact is guessed."""
    with pytest.raises(ValueError, match="rolling_radius is 'half'"):
        rolling_coefficient_for_solver(0.4, {"rolling_friction": "cdt", "rolling_radius": "half"}, "particle_wall")


@pytest.mark.parametrize(
    ("duration", "largest", "interval", "steps"),
    [(1.0, 0.1, 1, 10), (1.0, 0.1, 4, 12), (1.0, 0.3, 1, 4), (0.04, 8.62e-6, 20, 4660), (1.0, 5.0, 3, 3)],
)
def test_a_cycle_is_whole_samples_and_lasts_exactly(duration, largest, interval, steps):
    """The fewest steps that are whole samples, keep the time step below its limit and last the duration."""
    found, time_step = whole_steps(duration, largest, interval)
    assert found == steps
    assert found * time_step == pytest.approx(duration, rel=ROUNDING)
    assert time_step <= largest * (1 + 1e-9)


def test_the_travel_is_exact_and_the_time_step_close_to_its_limit(config):
    """cycles x steps x time step x velocity = travel; the time step is at most a sample per cycle lower."""
    for run in load_study("small", config.project).runs:
        derived, sliding = run.parameters["derived"], run.parameters["sliding"]
        total = derived["travel_steps"] * derived["time_step_s"] * sliding["velocity_m_per_s"]
        assert total == pytest.approx(1.0, rel=ROUNDING)
        slack = 1 - derived["time_step_s"] / derived["largest_time_step_s"]
        assert 0 <= slack <= 20 / derived["first_cycle_steps"]
        run_in = derived["run_in_steps"] * derived["time_step_s"] * sliding["velocity_m_per_s"]
        assert abs(run_in - 0.3) <= derived["time_step_s"] * sliding["velocity_m_per_s"]


def test_the_bed_is_what_the_sample_travels_through(config):
    """ahead 150 + behind 300 + sample 90 + run-in 300 + travel 1000 mm; the sample is at 0."""
    p = parameters_of(config)
    assert p["derived"]["bed_length_m"] == pytest.approx(1.84, rel=ROUNDING)
    assert p["derived"]["bed_start_m"] == pytest.approx(-(0.045 + 0.3 + 1.0 + 0.15), rel=ROUNDING)
    assert p["derived"]["bed_start_m"] + 1.84 == pytest.approx(0.045 + 0.3, rel=ROUNDING)


def test_a_periodic_bed_comes_round_again(config):
    """ahead 150 + behind 300 + sample 90 mm whatever the travel, which needs no room and no other bed."""
    studies = [
        load_study("small", config.project, {"bed": {"ends": "periodic"}, "sliding": {"travel_mm": travel}})
        for travel in (1000, 50000)
    ]
    for study in studies:
        derived = study.run("R9_convex").parameters["derived"]
        assert derived["bed_length_m"] == pytest.approx(0.54, rel=ROUNDING)
        assert derived["bed_start_m"] == pytest.approx(-(0.045 + 0.15), rel=ROUNDING)
    assert studies[0].beds == studies[1].beds
    assert all(bed["travel_m"] == 0.0 for bed in studies[0].beds.values())


def test_the_bed_holds_the_mass_of_its_volume(config):
    """mass = length x width x thickness x solid fraction x density, and the particles make up that mass."""
    p = parameters_of(config)
    mass = 1.84 * 0.12 * 0.04 * 0.59 * 2460
    assert p["derived"]["bed_mass_kg"] == pytest.approx(mass, rel=ROUNDING)
    counts = [
        mass * fraction / (2460 * math.pi / 6 * diameter**3)
        for fraction, diameter in zip((0.25, 0.5, 0.25), (0.00424, 0.0053, 0.00636), strict=True)
    ]
    assert abs(p["derived"]["bed_particles"] - sum(counts)) <= 0.5


def test_a_test_duration_becomes_a_travel(config):
    """2 h of test at 1 and 2 m/s, accelerated 3.6e4 times, are 0.2 s of simulation: 0.2 and 0.4 m of travel."""
    changes = {"wear": {"acceleration": 3.6e4}, "sliding": {"test_duration_h": 2.0}}
    study = load_study("small", config.project, changes)
    assert "travel_mm" not in study.settings["sliding"]
    assert [run.parameters["sliding"]["travel_m"] for run in study.runs[::2]] == pytest.approx([0.2, 0.4])
    travel = load_study("small", config.project, {"wear": {"acceleration": 3.6e4}, "sliding": {"travel_mm": 200}})
    assert travel.run("R9_convex").parameters == study.run("R9_convex").parameters
    assert "test duration 2 h instead of a travel of 1000 mm" in figure_remarks(study)


def test_the_nearest_of_travel_and_test_duration_counts(config):
    """A fidelity's travel replaces the test duration of the study, and the command line's duration replaces both."""
    config.edit("studies/small.yaml", "fidelities:", "sliding: {test_duration_h: 1}\nfidelities:")
    config.edit("studies/small.yaml", "      width_mm: 120\n", "      width_mm: 120\n    sliding: {travel_mm: 400}\n")
    assert "test_duration_h" not in load_study("small", config.project).settings["sliding"]
    hours = {"sliding": {"test_duration_h": 0.5}, "wear": {"acceleration": 1e4}}
    assert load_study("small", config.project, hours).settings["sliding"].get("travel_mm") is None


def test_acceleration_multiplies_the_wear_coefficient(config):
    """alpha_s of 6.3e-13 1/Pa, 1e4 times faster, is 6.3e-9 1/Pa; the measured value stays beside it."""
    wear = parameters_of(config, overrides={"wear": {"acceleration": 1e4}})["wear"]
    assert wear["accelerated_wear_coefficient_per_pa"] == pytest.approx(6.3e-9, rel=ROUNDING)
    assert wear["wear_coefficient_per_pa"] == 6.3e-13


# ---------------------------------------------------------------- beds


def test_convex_and_plain_share_a_bed_and_another_thickness_does_not(config):
    """Runs with equal bed parameters start from one bed."""
    study = load_study("small", config.project)
    assert study.bed_of("R9_convex") == study.bed_of("R9_plain") == "bed_R9"
    assert study.bed_of("R5_convex") == study.bed_of("R5_plain") == "bed_R5"
    assert list(study.beds) == ["bed_R9", "bed_R5"]
    assert [bed["thickness_m"] for bed in study.beds.values()] == [0.04, 0.03]


def test_velocity_and_pattern_do_not_make_another_bed(config):
    """Rows that differ in velocity, radii, spacing and height share a bed: it settles at rest."""
    config.edit("designs/small.csv", "R5,4,8,60,6.0,2.0,30", "R5,4,8,60,3.0,2.0,40")
    assert list(load_study("small", config.project).beds) == ["bed_R9"]


@pytest.mark.parametrize(
    "overrides",
    [
        {"particle_scale": 1.5},
        {"bed": {"seed": 7}},
        {"bed": {"width_mm": 130}},
        {"bed": {"ahead_mm": 151}},
        {"bed": {"ends": "periodic"}},
        {"bed": {"floor_material": "steel"}},
        {"sliding": {"travel_mm": 900}},
        {"solver": {"rolling_friction": "epsd2"}},
        {"solver": {"rolling_radius": "reduced"}},
        {"solver": {"rayleigh_fraction": 0.1}},
        {"solver": {"contact_model": "hooke", "characteristic_velocity_m_per_s": 1.0}},
    ],
)
def test_what_settles_differently_is_another_bed(config, overrides):
    """Each setting that changes the settled bed changes the bed's parameters."""
    run, other = (load_study("small", config.project, o).run("R9_plain") for o in (None, overrides))
    assert bed_parameters(run) != bed_parameters(other)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("sliding_friction: 0.36", "sliding_friction: 0.37"),
        ("restitution: 0.4,", "restitution: 0.5,"),
        ("sliding_friction: 0.21", "sliding_friction: 0.22"),
        ("[0.8, 1.0, 1.2]", "[0.8, 1.0, 1.3]"),
    ],
)
def test_another_contact_or_distribution_is_another_bed(config, old, new):
    """Each property of the particles, and of their contact with the floor, belongs to the bed."""
    before = bed_parameters(load_study("small", config.project).run("R9_plain"))
    config.edit("materials.yaml", old, new)
    assert bed_parameters(load_study("small", config.project).run("R9_plain")) != before


@pytest.mark.parametrize(
    "overrides",
    [
        {"sample": {"material": "perspex"}},
        {"sample": {"element_size_mm": 1.2}},
        {"wear": {"acceleration": 3}},
        {"sliding": {"cycles": 5}},
        {"solver": {"picture_interval_mm": 7}},
        {"solver": {"ranks": 2}},
        {"solver": {"characteristic_velocity_m_per_s": 2.0}},
    ],
)
def test_what_does_not_touch_the_bed_keeps_it(config, overrides):
    """Sample, wear and output settings do not ask for another bed."""
    run, other = (load_study("small", config.project, o).run("R9_plain") for o in (None, overrides))
    assert bed_parameters(run) == bed_parameters(other)


def test_beds_settle_above_the_highest_bump_of_the_study(config):
    """The temporary floor of every bed is higher than every sample of the study, and the same for all."""
    study = load_study("small", config.project)
    floors = {bed["temporary_floor_m"] for bed in study.beds.values()}
    assert len(floors) == 1
    assert floors.pop() > 0.0003 + 0.006


def test_an_unknown_run_is_refused(config):
    """Asking for the bed of a run that is not there names the nearest run."""
    with pytest.raises(ConfigError, match=r"run is 'R9_convx'.*\(the nearest is R9_convex\)"):
        load_study("small", config.project).bed_of("R9_convx")


# ---------------------------------------------------------------- remarks


def test_figures_say_what_is_reduced(config):
    """A reduced study names its scale, its smaller sample, bed and travel, and the acceleration."""
    config.edit("studies/small.yaml", "      width_mm: 120\n", "      width_mm: 120\n    sliding: {travel_mm: 400}\n")
    assert figure_remarks(load_study("small", config.project, {"wear": {"acceleration": 1e4}})) == [
        "particles at scale 2",
        "sample 80 x 90 mm of 200 x 200 mm",
        "bed width 120 mm of 300 mm",
        "travel 400 mm of 1000 mm",
        "particles hop off the ramp, up to 43 mm at the highest velocity",
        "wear accelerated 10000 times",
    ]


def test_a_full_study_has_nothing_to_say(config):
    """At full size, scale 1, with a gentle ramp and without acceleration there are no remarks."""
    gentle = {"fidelity": "standard", "sample": {"skirt_slope_deg": 0.5}}
    assert figure_remarks(load_study("small", config.project, gentle)) == []


def test_particles_scaled_beyond_their_bumps_are_said_on_every_figure(config):
    """R9's alpha_ER reaches 1 at scale 2.74 and R5's at 3.46: above, the rows are said with their scales."""
    thin = {"bed": {"allow_thin_bed": True}}
    fine, one, both = (
        load_study("small", config.project, {"particle_scale": scale, **thin}) for scale in (2.7, 3, 3.5)
    )
    assert not any(remark.startswith(BEYOND_BUMPS) for remark in figure_remarks(fine))
    assert f"{BEYOND_BUMPS}, row with scale and limit: R9 (3, 2.7)" in figure_remarks(one)
    assert f"{BEYOND_BUMPS}, row with scale and limit: R9 (3.5, 2.7), R5 (3.5, 3.5)" in figure_remarks(both)


def test_bumps_smaller_than_real_particles_are_no_matter_of_scale(config):
    """Where already real particles are larger than the bumps, the study simulates what it means to."""
    config.edit("designs/small.csv", "R9,8,2,20,6.0,1.0,40", "R9,1.5,1.5,20,1.0,1.0,40")
    study = load_study("small", config.project)
    assert not any(remark.startswith(BEYOND_BUMPS) for remark in figure_remarks(study))


def test_rows_that_are_called_by_numbers_may_be_chosen():
    """Snakemake reads rows=[1] as a number; names are text."""
    layer = command_line_layer({"rows": [1, "R5", True], "packings": "2"})
    assert layer.values == {"rows": ["1", "R5", True], "packings": 2}


def test_many_rows_are_counted_and_not_named():
    """Of a screening in coarse particles a figure says how many rows; the table of runs has each."""
    settings = {"particle_scale": 4, "bed": {"allow_thin_bed": True}}
    remarks = figure_remarks(load_study("screening", overrides=settings))
    assert f"{BEYOND_BUMPS}, rows: 12 of 13" in remarks
    assert "fewer than three layers of particles in the bed: 8 of 13" in remarks


def test_a_thin_bed_is_said_on_every_figure(config):
    """An allowed thin bed is marked in its runs and remarked with the rows it concerns and their layers."""
    study = load_study("small", config.project, {"particle_scale": 4, "bed": {"allow_thin_bed": True}})
    assert [run.parameters["derived"]["thin_bed"] for run in study.runs] == [False, False, True, True]
    assert "fewer than three layers of particles in the bed: R5 (2.8)" in figure_remarks(study)


def test_exactly_three_layers_are_enough(config):
    """31 mm over particles of a third of it is 2.9999999999999996 in floating point: still three layers."""
    config.edit("designs/small.csv", "R5,4,8,60,6.0,2.0,30", "R5,4,8,60,6.0,2.0,31")
    study = load_study("small", config.project, {"particle_scale": 31 / 3 / 2.65})
    assert study.run("R5_plain").parameters["derived"]["layers"] < 3.0
    assert study.run("R5_plain").parameters["derived"]["thin_bed"] is False


def test_the_hop_off_the_ramp_is_ballistic_and_told(config):
    """A particle leaving a slope with v tan(slope) upwards is back after 2 v tan(slope) / g; long hops are remarked."""
    assert ramp_hop(2.0, math.atan(0.01)) == pytest.approx(2.0 * (2.0 * 2.0 * 0.01 / 9.81))
    straight = load_study("screening", overrides={"sample": {"skirt_radius_mm": 0}})
    told = [remark for remark in figure_remarks(straight) if remark.startswith("particles hop off the ramp")]
    assert told == ["particles hop off the ramp, up to 14 mm at the highest velocity"]


def test_a_ramp_curved_by_v_squared_over_g_ends_the_hop():
    """A particle follows a curve of radius v^2/g in free fall; what is left is the last element's angle. A tighter
    curve than that of the fastest row is refused."""
    study = load_study("screening")
    hop = max(run.parameters["derived"]["ramp_hop_m"] for run in study.runs)
    assert hop == pytest.approx(2.0 * 2.0**2 * (0.0015 / 2.0 / 0.41) / 9.81, rel=1e-3)
    assert not any(remark.startswith("particles hop") for remark in figure_remarks(study))
    with pytest.raises(ConfigError, match=r"skirt_radius_mm is 400 for row R3, allowed is at least 407.747 mm"):
        load_study("screening", overrides={"sample": {"skirt_radius_mm": 400}})
    for fidelity in ("quick", "standard", "paper"):
        assert not any("hop" in each for each in figure_remarks(load_study("demo", overrides={"fidelity": fidelity})))


# ---------------------------------------------------------------- regression and replicates


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


BEST = "row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm\n"


@pytest.mark.parametrize("rows", [{}, {"rows": ["R9"]}])
def test_factors_without_a_pattern_are_refused(config, rows):
    """A regression is of patterned samples, whichever rows are chosen; the line and the surfaces are named."""
    with_factors(config, "{t: bed_thickness_mm, v: velocity_m_per_s}")
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", "surfaces: [plain]")
    with pytest.raises(ConfigError, match=r"small\.yaml, line 5: factors ask .*, found surfaces plain, allowed are"):
        load_study("small", config.project, rows)


FACTORS = "surfaces: [convex, plain]\nfactors: {a: major_radius_mm, t: bed_thickness_mm}"


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


# ---------------------------------------------------------------- chosen rows


def test_a_run_is_the_same_whichever_rows_are_chosen():
    """Chosen rows keep their parameters and their bed, whose height follows the highest sample of the whole design."""
    whole, chosen = (
        load_study("screening", overrides={"packings": 2, **rows}) for rows in ({}, {"rows": ["R9", "R2-2"]})
    )
    assert [run.row for run in chosen.runs[::2]] == ["R2-2", "R9", "R9-2"]
    for run in chosen.runs:
        assert run == whole.run(run.name)
        assert chosen.beds[chosen.bed_of(run.name)] == whole.beds[whole.bed_of(run.name)]
    assert set(chosen.beds) == {chosen.bed_of(run.name) for run in chosen.runs}
    assert len(chosen.design_table()) == len(chosen.runs)


def test_few_rows_have_regimes_but_no_regression():
    """A regression needs four rows and two levels of every factor; regimes need one row."""
    few = load_study("screening", overrides={"rows": ["R5", "R9"]})
    assert finds_regimes(few) and not few.factors
    assert not finds_regimes(load_study("demo"))
    enough = load_study("screening", overrides={"rows": ["R1", "R2", "R3", "R4", "R5"]})
    assert set(enough.factors) == set("abdhvt")


def test_a_row_that_is_not_in_the_design_is_refused():
    with pytest.raises(
        ConfigError, match=r"command line: row is 'R99', allowed is one of R1, R1-2, R1-3, R2.*\(the nearest is R9\)"
    ):
        load_study("screening", overrides={"rows": ["R9", "R99"]})
    with pytest.raises(ConfigError, match="rows is 'R9', allowed is a list of rows of the design"):
        load_study("screening", overrides={"rows": "R9"})


def test_worn_through_needs_a_thickness():
    """What a run does where it is worn through is refused without the thickness, in a sentence; with it it is taken."""
    with pytest.raises(ConfigError, match=r"wear\.worn_through is 'cap' for row R9, allowed is a study that gives"):
        tiny_study(wear={"worn_through": "cap"})
    study = tiny_study(wear={"worn_through": "cap", "local_thickness_mm": 2})
    assert study.run("R9_convex").parameters["wear"]["local_thickness_m"] == pytest.approx(0.002)


@pytest.mark.parametrize(
    "name", ["further_packings", "proposed_rows", "default_studies", "figure_forces", "tables_beds"]
)
def test_a_study_that_is_called_as_a_rule_is_refused(name):
    """Snakemake would have two of that name: rules, checkpoints, and those that are made of figures and tables."""
    with pytest.raises(ConfigError, match=f"a study cannot be called {name}, allowed are small letters"):
        load_study(name)


def test_what_rounds_depend_on_is_of_types_that_snakemake_compares():
    """An object of a class of ours would never count as changed: a wider goal would do nothing."""
    of_class = re.compile(r"=lambda wildcards: study_of\(wildcards\)\.(until|optimise),")
    found = [path.name for path in (REPOSITORY / "workflows").rglob("*.smk") if of_class.search(path.read_text())]
    assert found == []
    asked = load_study("demo", overrides={"until": {"width_fraction": 0.05, "most_packings": 6, "most_core_h": 3}})
    for goal in (asked.until, load_study("optimised_pattern").optimise):
        json.dumps(asdict(goal))
