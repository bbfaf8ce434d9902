"""Parameters of a run of equipment: units, what parts take from the section `wear`, sizes, what follows from them."""

import math

import numpy as np
import pytest

from bulkwear.workflows.cases.equipment.parameters import (
    REPORTS,
    filled_mass,
    most_blocks,
    start_up_blocks,
)
from bulkwear.workflows.config.design import ConfigError
from bulkwear.workflows.engine.pouring import particles_of_mass
from tests.support.own_machine_project import ORE, SETTINGS, SHAFT, SPEED_RPM, machine_study

ROUND_OFF = 1e-12  # relative; a few products of decimal fractions
FILLING = {"fraction": 0.3, "axis": "y", "centre_mm": [0, 10, 20], "radius_mm": 200, "length_mm": 100}
SIEVES = {"sieve_mm": [1, 2, 4, 8], "fraction": [0.0, 0.2, 0.6, 1.0]}


def parameters_of(folder, row=0, **changes):
    """The parameters of a run of the tiny machine, changed."""
    with machine_study(folder, **changes) as study:
        return study.runs[row].parameters


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return parameters_of(tmp_path_factory.mktemp("parameters"))


def named(run):
    return {part["name"]: part for part in run["parts"]}


def test_everything_is_in_si(run):
    """t/h, mm, rpm and hours are kg/s, m, rad/s and seconds, and no key says otherwise."""
    inlet, paddle, liner = run["inlet"], named(run)["paddle"], named(run)["liner"]
    assert inlet["rate_kg_per_s"] == pytest.approx(1.5e3 / 3600.0, rel=ROUND_OFF)
    assert inlet["size_m"] == [0.08, 0.08] and inlet["velocity_m_per_s"] == [0, 0, -1.0]
    assert run["outlets"]["below"]["centre_m"] == [0, 0, -0.345]
    assert paddle["motion"]["speed_rad_per_s"] == pytest.approx(SPEED_RPM * 2.0 * math.pi / 60.0, rel=ROUND_OFF)
    assert paddle["motion"]["point_m"] == pytest.approx([value / 1e3 for value in SHAFT], rel=ROUND_OFF)
    assert liner["edge_m"] == 0.025 and liner["thickness_m"] == 0.03
    assert run["operation"]["duration_s"] == run["derived"]["operation_s"] == 400 * 3600.0
    assert run["operation"]["change_out_remaining_m"] == 0.002
    keys = [key for section in (run, inlet, run["sampling"], run["operation"], *run["parts"]) for key in section]
    assert not [key for key in keys if key.endswith(("_mm", "_h", "_rpm", "_mt", "_deg"))]


def test_parts_take_from_wear_what_they_do_not_say(run):
    """Coefficient, its error and the law are those of the part where it has its own, else those of the section."""
    parts, wear = named(run), run["wear"]
    assert list(parts) == list(SETTINGS["parts"])
    assert [part["wears"] for part in parts.values()] == [True, True, True, False]
    assert parts["liner"]["wear_coefficient_per_pa"] == wear["wear_coefficient_per_pa"]
    assert parts["plate"]["wear_coefficient_per_pa"] == 1e-12 != wear["wear_coefficient_per_pa"]
    assert [parts[name]["law"] for name in ("liner", "plate", "paddle")] == ["archard", "finnie", "archard"]
    assert parts["liner"]["wear_coefficient_error"] == 0.2
    assert parts["paddle"]["wear_coefficient_error"] == wear["wear_coefficient_error"] != 0.2
    assert "thickness_m" in parts["liner"] and "thickness_m" not in parts["paddle"]
    assert "role" not in parts["liner"] and parts["liner"]["motion"] is None


def test_each_wall_is_one_type(run):
    """Types of the solver: the bulk is 1, walls follow in the order in which parts name them, each once."""
    assert [wall["name"] for wall in run["walls"]] == ["steel", "perspex"]
    assert [part["type"] for part in run["parts"]] == [2, 2, 2, 3]
    assert len(run["derived"]["youngs_moduli_pa"]) == len(run["derived"]["rolling_frictions"]) == 3
    assert run["sample_material"]["name"] == "steel"


def test_sample_material_is_that_of_the_first_part_that_wears(tmp_path):
    """Whose contact radius wear goes by."""
    changes = {
        "parts": {"liner": {"role": "rigid", "wear_coefficient_error": None}, "plate": {"material": "polyethylene"}}
    }
    run = parameters_of(tmp_path, **changes)
    assert run["sample_material"]["name"] == "polyethylene"
    assert [wall["name"] for wall in run["walls"]] == ["steel", "polyethylene", "perspex"]


def test_unknown_wall_is_one_sentence(tmp_path):
    """It names file, key, what was found and what there is."""
    with pytest.raises(ConfigError, match=r"machine\.yaml.*parts\.hood\.material.*stel.*steel"):
        parameters_of(tmp_path, parts={"hood": {"material": "stel"}})


def test_sizes_are_those_of_the_material_or_of_sieves(tmp_path, run):
    """By sieves: classes of the given number, scaled; their mass is whole and the smallest has the fines."""
    assert run["particle"]["diameters_m"] == pytest.approx([4 * 3e-3 * 0.8, 4 * 3e-3 * 1.2], rel=ROUND_OFF)
    bulk = {"passing": SIEVES, "finest_fraction": 0.2, "size_classes": 4}
    sieved = parameters_of(tmp_path, bulk=bulk, sampling={"patch_mm": 100}, inlet={"size_mm": [90, 90]})["particle"]
    assert len(sieved["diameters_m"]) == 4 and sum(sieved["mass_fractions"]) == pytest.approx(1.0, rel=ROUND_OFF)
    assert sieved["mass_fractions"] == pytest.approx([0.4, 0.2, 0.2, 0.2], rel=ROUND_OFF)
    middles = [2e-3 * 2 ** ((share - 0.2) / 0.4) for share in (0.3, 0.5, 0.7, 0.9)]  # straight in the logarithm
    assert sieved["diameters_m"] == pytest.approx([4 * middle for middle in middles], rel=1e-9)
    assert sieved["median_diameter_m"] == pytest.approx(4 * 2e-3 * 2**0.75, rel=1e-9)
    assert "20 %" in sieved["sizes"] and sieved["sizes"] != run["particle"]["sizes"]


def test_sieves_that_fall_are_one_sentence(tmp_path):
    """What passes a coarser sieve is at least what passes a finer one; the file and the line are told."""
    words = r"0\.3 passes the sieve of 4 mm, allowed is 0\.6 or more"
    with pytest.raises(ConfigError, match=rf"^config/studies/machine\.yaml, line \d+: bulk\.passing: {words}"):
        parameters_of(tmp_path, bulk={"passing": {"sieve_mm": [1, 2, 4, 8], "fraction": [0, 0.6, 0.3, 1]}})


def test_packings_differ_in_their_seed_alone(tmp_path):
    """Each packing of a row has another seed, and nothing else."""
    with machine_study(tmp_path, packings=3) as study:
        runs = [run.parameters for run in study.runs]
        names = [run.name for run in study.runs]
    assert len(set(names)) == 3 and len({run["bulk"]["seed"] for run in runs}) == 3
    assert all({**run, "bulk": None} == {**runs[0], "bulk": None} for run in runs)


def test_columns_of_a_design_are_any_settings(tmp_path):
    """A row has its own tonnage, file, thickness and speed; another row that of the study where its cell says so."""
    rows = (
        "row,inlet.rate_t_per_h,parts.liner.file,parts.liner.thickness_mm,parts.paddle.motion.speed_rpm\n"
        "plain,1.5,liner.stl,30,60\nfast,3,paddle.stl,32,90\n"
    )
    with machine_study(tmp_path, rows) as study:
        plain, fast = (run.parameters for run in study.runs)
        table = study.design_table()
    assert fast["inlet"]["rate_kg_per_s"] == pytest.approx(2.0 * plain["inlet"]["rate_kg_per_s"], rel=ROUND_OFF)
    assert named(fast)["liner"]["file"] == "paddle.stl" and named(fast)["liner"]["thickness_m"] == 0.032
    turning = [named(each)["paddle"]["motion"]["speed_rad_per_s"] for each in (plain, fast)]
    assert turning[1] == pytest.approx(1.5 * turning[0], rel=ROUND_OFF)
    assert named(plain)["liner"]["drawing"] != named(fast)["liner"]["drawing"] == named(plain)["paddle"]["drawing"]
    assert [row["feed_t_per_h"] for row in table] == pytest.approx([1.5, 3.0], rel=ROUND_OFF)


def test_operation_is_hours_or_tonnes(tmp_path, run):
    """0.006 Mt at 1.5 t/h are 4,000 h; a machine that nothing is fed to has hours."""
    tonnes = parameters_of(tmp_path / "a", operation={"duration_h": None, "throughput_mt": 0.006})
    assert tonnes["derived"]["operation_s"] == pytest.approx(4000 * 3600.0, rel=ROUND_OFF)
    filled = parameters_of(tmp_path / "b", inlet=None, outlets=None, filling=FILLING)
    assert filled["inlet"] is None and filled["outlets"] is None
    assert filled["derived"]["operation_s"] == run["derived"]["operation_s"]


def test_blocks_are_whole_numbers_of_reports_and_pictures(run):
    """A block lasts exactly what the study says, with a time step not above the largest one."""
    derived = run["derived"]
    assert derived["time_step_s"] * derived["first_cycle_steps"] == pytest.approx(0.15, rel=ROUND_OFF)
    assert 0.9 * derived["largest_time_step_s"] < derived["time_step_s"] <= derived["largest_time_step_s"]
    assert derived["largest_time_step_s"] == pytest.approx(0.3 * derived["rayleigh_time_s"], rel=ROUND_OFF)
    assert derived["report_steps"] * REPORTS == derived["first_cycle_steps"] == derived["run_in_steps"]
    assert derived["picture_steps"] * run["sampling"]["pictures_per_block"] == derived["first_cycle_steps"]


@pytest.mark.parametrize(
    ("most_s", "blocks"), [(0.45, 3), (0.46, 4), (0.44, 3), (0.3, 2), (0.1, 2)], ids=lambda value: str(value)
)
def test_longest_run_has_all_blocks_that_there_may_be(run, most_s, blocks):
    """Whole blocks of start-up, the first and the second always; no worn blocks without an update."""
    changed = {**run, "start_up": {"most_s": most_s}}
    assert start_up_blocks(changed) == blocks
    assert most_blocks(changed) == blocks + 3 + 2 + 1
    assert most_blocks({**changed, "updates": {"most": 0, "worn_blocks": 5}}) == blocks + 3


def test_travel_is_that_of_all_wear_cycles(run):
    """What the driver counts to: every block but the first."""
    assert run["derived"]["travel_steps"] == (most_blocks(run) - 1) * run["derived"]["first_cycle_steps"]


def test_a_tonne_has_the_particles_of_its_classes(run):
    """A tonne has as many particles as its classes have together."""
    particle = run["particle"]
    masses = [2500 * math.pi / 6.0 * diameter**3 for diameter in particle["diameters_m"]]
    count = sum(1000.0 * share / mass for share, mass in zip(particle["mass_fractions"], masses, strict=True))
    assert particles_of_mass(particle, 1000.0) == pytest.approx(count, rel=ROUND_OFF)
    assert masses[0] < 1000.0 / count < masses[1]


def test_filled_mass_is_bulk_volume_times_bulk_density(tmp_path, run):
    """0.3 of the cylinder at the bulk's solid fraction; with what is fed it makes the particles that are held."""
    assert filled_mass(run) == 0.0
    filled = parameters_of(tmp_path, filling=FILLING)
    mass = 0.3 * math.pi * 0.2**2 * 0.1 * ORE["bulk_solid_fraction"] * ORE["density_kg_per_m3"]
    assert filled_mass(filled) == pytest.approx(mass, rel=ROUND_OFF)
    fed = run["inlet"]["rate_kg_per_s"] * 0.5 * 0.45
    expected = [particles_of_mass(run["particle"], each) for each in (fed, fed + mass)]
    found = [each["derived"]["held_particles"] for each in (run, filled)]
    np.testing.assert_allclose(found, expected, rtol=ROUND_OFF)
