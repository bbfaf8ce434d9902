"""Parameters of a run: units, what follows from the settings, beds as the sample meets them."""

from __future__ import annotations

import math

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.derived import rayleigh_time, rolling_coefficient_for_solver, whole_steps, youngs_modulus
from bulkwear.workflows.report.page_parameters import figure_remarks
from tests.support.small_study import parameters_of

ROUNDING = 1e-12  # relative; a few floating-point operations
DIGITS_GIVEN = 1e-6  # relative; numbers worked out by hand to seven digits


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
