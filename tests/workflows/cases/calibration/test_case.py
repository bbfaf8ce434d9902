"""A calibration study: what it asks for, and what is refused."""

import io
import re
from functools import cache

import pandas as pd
import pytest

from bulkwear.postproc.inference.loop import packing_seed
from bulkwear.workflows.cases.calibration import box_checks, case
from bulkwear.workflows.cases.calibration.driver import pair_of, repeat_seeds
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.layers import Layer
from bulkwear.workflows.config.run_checks import CheckedRun
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.project import Project
from tests.support.calibration_study import MEASURED, PAIRS, ROLLING, SLIDING, study

WALL = [
    {"name": SLIDING, "low": 0.1, "high": 0.7},
    {"name": "wall_material.contact.sliding_friction", "low": 0.1, "high": 0.7},
]


def show(monkeypatch, table, text):
    """Let a published table hold another text."""
    real = case.published

    def shown(name):
        return pd.read_csv(io.StringIO(text)) if name == table else real(name)

    monkeypatch.setattr(case, "published", shown)


@pytest.mark.parametrize("fidelity", ["quick", "standard", "paper"])
def test_every_fidelity_loads(fidelity):
    """Each fidelity is a valid study; quick takes the shear box alone, the others both tests."""
    found = load_study("calibration", overrides={"fidelity": fidelity})
    tests = found.runs[0].parameters["calibration"]["tests"]
    assert tests == (["shear_box"] if fidelity == "quick" else ["shear_box", "draw_down"])
    lengths = {run.parameters["shear_box"]["length_m"] for run in found.runs}
    assert len(lengths) == 3  # three sizes of box


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"draw_down": {"length_mm": 20}}, r"draw_down\.length_mm is 20.*allowed is at least 106"),
        ({"draw_down": {"opening_mm": 300}}, r"draw_down\.opening_mm is 300.*allowed is from"),
        (
            {"calibration": {"compared_pair": "nobody"}},
            r"calibration\.compared_pair is 'nobody'.*allowed is one of size-test",
        ),
        ({"calibration": {"most": {"shear_box": 3}}}, r"calibration\.most is .*allowed is for shear_box at least"),
        (
            {"wall_shear": {"drag_mm": 30}, "calibration": {"tests": ["shear_box", "wall_shear"]}},
            r"wall_shear\.drag_mm is 30.*allowed is at least 63\.6, six particle diameters",
        ),
        (
            {"calibration": {"parameters": WALL}},
            r"shear_box\.wall_material is 'perspex'.*allowed is steel, as of draw_down",
        ),
        (
            {"solver": {"rolling_friction": "none"}},
            r"solver\.rolling_friction is 'none'.*allowed is a model, where .* has particle\.contact\.rolling_friction",
        ),
        (
            {"bulk": {"shape": "pair"}},
            r"solver\.rolling_friction is 'own_spin'.*allowed is none, or a model of LIGGGHTS, with clumps",
        ),
        (
            {"draw_down": {"front_and_back": "walls", "width_mm": 20}},
            r"draw_down\.width_mm is 20.*allowed is at least 38\.16, three of the largest particles between walls",
        ),
        (
            {"draw_down": {"length_mm": 160}},
            r"draw_down\.length_mm is 160.*allowed is at least 183\.4, the opening as simulated, 56\.13, and six",
        ),
        (
            {"draw_down": {"lower_height_mm": 60}},
            r"draw_down\.lower_height_mm is 60.*allowed is at least 268\.4: in a lower box the heap, as steep as",
        ),
        (
            {"draw_down": {"fill_mass_kg_per_m": 1968}},
            r"draw_down\.fill_mass_kg_per_m is 1968.*allowed is from 101\.6 to 304\.7",
        ),
        (
            {"particle_scale": 1, "shear_box": {"width_mm": 5000}},
            r"particle_scale is 1 .*allowed is at least .*, or a smaller box: shear_box holds about .* particles",
        ),
        (
            {"rest": {"check_interval_s": 1, "calm_checks": 30}},
            r"rest\.longest_s is 20.*allowed is at least 3.*looks that rest\.calm_checks asks for 30 s",
        ),
        (
            {"rest": {"longest_s": 0.35}, "calibration": {"tests": ["shear_box"]}},
            r"rest\.longest_s is 0\.35.*allowed is at least 0\.4028: a fall through the filling of shear_box",
        ),
        ({"rest": {"longest_s": 4}}, r"rest\.longest_s is 4.*allowed is at least 4\..*: the outflow of draw_down"),
        ({"bulk": {"shape": "cube"}}, r"bulk\.shape is 'cube'.*allowed is one of sphere, pair, tetrahedron"),
        ({"calibration": {"measured": "none.txt"}}, r"the name of a \.csv file in config/published"),
    ],
)
def test_what_cannot_be_calibrated_is_refused(overrides, words):
    """A fault is one sentence that names the key, the value and what is allowed, before anything is simulated."""
    with pytest.raises(ConfigError, match=words):
        load_study("calibration", overrides={"fidelity": "standard", **overrides})


@cache
def scaled(scale):
    """Parameters of the study at standard with another particle scale."""
    return load_study("calibration", overrides={"fidelity": "standard", "particle_scale": scale}).runs[0].parameters


@pytest.mark.parametrize("scale", [3.7, 3.9013, 4.111])
@pytest.mark.parametrize(
    ("section", "key", "value"),
    [
        ("shear_box", "length_mm", 20),
        ("draw_down", "length_mm", 150),
        ("draw_down", "opening_mm", 5),
        ("draw_down", "fill_mass_kg_per_m", 1),
        ("wall_shear", "drag_mm", 1),
        ("rest", "longest_s", 1),
    ],
)
def test_the_limit_that_a_refusal_names_is_allowed(scale, section, key, value):
    """Limits are shown in four digits: rounded down, the value that a sentence asks for was refused again."""
    tests = ["shear_box", "wall_shear" if section == "wall_shear" else "draw_down"]
    parameters = {**scaled(scale), "calibration": {**scaled(scale)["calibration"], "tests": tests}}

    def fault(number):
        changed = {**parameters, section: {**parameters[section], **to_si({key: float(number)})}}
        checked = CheckedRun((), {}, Layer("", {}, {}), changed)
        return next(filter(None, (check(checked) for check in box_checks.BOX_CHECKS)), None)

    found = fault(value)
    assert found is not None and found[0] == f"{section}.{key}"
    after = fault(re.search(r"(?:at least|from) ([\d.]+)", found[1])[1])
    assert after is None or after[0] != found[0]  # another setting may be at fault then


def test_the_particle_scale_that_is_named_is_enough_for_all_boxes():
    """Of two boxes that hold too many particles the fuller one decides: here the draw-down test."""
    overrides = {"fidelity": "paper", "particle_scale": 1, "draw_down": {"width_mm": 3000}}
    with pytest.raises(ConfigError, match=r"particle_scale is 1 .*a smaller box: draw_down holds about") as refused:
        study(shear_box={"width_mm": 5000}, **overrides)
    named = float(re.search(r"at least ([\d.]+)", str(refused.value))[1])
    assert study(shear_box={"width_mm": 5000}, **{**overrides, "particle_scale": named}).runs


def test_an_opening_of_half_the_box_is_allowed():
    """The refusal of a longer one says: to half the box's length."""
    run = study(fidelity="standard").runs[0].parameters
    for opening, allowed in ((0.25, True), (0.251, False)):
        changed = {**run, "draw_down": {**run["draw_down"], "opening_m": opening}}
        found = box_checks.opening_lets_particles_pass(CheckedRun((), {}, Layer("", {}, {}), changed))
        assert (found is None) == allowed


@pytest.mark.parametrize(
    ("check", "key", "words"),
    [
        (box_checks.box_holds_particles, "shear_box.length_mm", "at least 318, three of the largest particles"),
        (box_checks.box_wide_enough, "shear_box.width_mm", "at least 212, two of the largest particles"),
        (
            box_checks.opening_lets_particles_pass,
            "draw_down.opening_mm",
            "from 306.9 (three of the largest particles as simulated) to half the box's length",
        ),
    ],
)
def test_boxes_hold_the_largest_particles(check, key, words):
    """Of particles of 10.6 mm in the middle, and of 106 mm at most, the largest ones decide."""
    run = load_study("calibration", overrides={"fidelity": "standard"}).runs[0].parameters
    particle = {**run["particle"], "diameters_m": [0.00848, 0.0106, 0.106]}
    found = check(CheckedRun((), {}, Layer("", {}, {}), {**run, "particle": particle}))
    assert found is not None and found[0] == key and found[1].startswith(words)


def test_a_test_of_which_nothing_was_measured_is_refused():
    """It would say nothing of the parameters: the responses that it has are named."""
    words = (
        r"calibration\.tests is .*allowed is with wall_shear a table gravel_tests\.csv that has wall_friction_angle_deg"
    )
    with pytest.raises(ConfigError, match=words):
        study(calibration={"tests": ["shear_box", "wall_shear"]})


@pytest.mark.parametrize(
    ("others", "words"),
    [
        ([{"name": ROLLING, "low": 0.7, "high": 0.1}], f"every parameter; {ROLLING} has low 0.7 and high 0.1"),
        ([{"name": ROLLING, "low": 0.3, "high": 0.3}], f"every parameter; {ROLLING} has low 0.3 and high 0.3"),
        ([{"name": SLIDING, "low": 0.1, "high": 0.7}], f"each parameter once; {SLIDING} stands there twice"),
        ([{"name": ROLLING, "low": 0.1, "high": 0.7}] * 5, "a list of two to five blocks with name, low and high"),
    ],
)
def test_ranges_must_be_ranges(others, words):
    """A low that is not below its high and a parameter named twice are told by name; there are five that may be."""
    parameters = [{"name": SLIDING, "low": 0.1, "high": 0.7}, *others]
    with pytest.raises(ConfigError, match=rf"calibration\.parameters .*{words}"):
        study(calibration={"parameters": parameters})


@pytest.mark.parametrize(
    ("name", "low", "high", "words"),
    [
        ("particle.contact.restitution", 0.0, 0.9, "a number above 0.05 and at most 1; its low is 0"),
        ("particle.contact.restitution", 0.05, 0.9, "a number above 0.05 and at most 1; its low is 0.05"),
        ("particle.contact.restitution", 0.3, 5, "a number above 0.05 and at most 1; its high is 5"),
    ],
)
def test_ranges_hold_what_a_contact_may_have(name, low, high, words):
    """The solver ends with an error at a restitution of 0.05 or less, or above 1, whenever one is drawn."""
    parameters = [{"name": SLIDING, "low": 0.1, "high": 0.7}, {"name": name, "low": low, "high": high}]
    with pytest.raises(ConfigError, match=rf"calibration\.parameters is .*allowed is {name} {words}"):
        study(calibration={"parameters": parameters})


def test_packings_that_are_repeated_are_others():
    """A calibration of 501 simulations or more would have one of the seeds with which pairs are repeated."""
    most = {"shear_box": 400, "draw_down": 101}
    with pytest.raises(ConfigError, match=r"calibration\.most is .*allowed is at most 500 for all .* have 501"):
        study(fidelity="standard", calibration={"most": most})
    run = study(fidelity="standard", calibration={"most": {**most, "draw_down": 100}}).runs[0].parameters
    assert packing_seed(run["calibration"]["seed"], 499) < min(repeat_seeds(run))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name,source\ncalibrated,me\n", "allowed is a table with the column row"),
        ("row,source\n1,me\n2,me\n", "names of letters, each its own; its line 2 has row 1, a number"),
        ("row\ncalibrated\nsize-test\ncalibrated\n", "each its own; its line 4 has row calibrated, as another line"),
        (f"row,{SLIDING}\nother,-1\ncalibrated,-0.4\nsize-test,0.2\n", "from 0 to 5; its line 3 has -0.4"),
        (f"row,{SLIDING}\ncalibrated,0.4\nsize-test,much\n", "from 0 to 5; its line 3 has much"),
    ],
)
def test_pairs_that_cannot_be_simulated_are_refused(monkeypatch, text, words):
    """They are simulated last, after hours: a fault of theirs is named with its line before."""
    show(monkeypatch, "gravel_pairs.csv", text)
    with pytest.raises(ConfigError, match=rf"calibration\.simulated_before is 'gravel_pairs\.csv'.*{words}"):
        study()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("response,value\nrepose_angle_deg,33\n", "it has no deviation"),
        ("response,value,deviation\nshear_angle_deg,36,0.4\nrepose_angle_deg,33,0\n", "its line 3 has deviation 0"),
        ("response,value,deviation,model_discrepancy\nshear_angle_deg,36,0.4,-1\n", "line 2 has model_discrepancy -1"),
        ("response,value,deviation,model_discrepancy\nshear_angle_deg,36,0.4,some\n", "has model_discrepancy some"),
        ("response,value,deviation\nshear_angle_deg,steep,0.4\n", "line 2 has value steep"),
        ("response,value,deviation\nsheer_angle_deg,36,0.4\n", "one of shear_angle_deg, .* line 2 has .* sheer_angle"),
        (
            "response,value,deviation\nshear_angle_deg,36,1\nshear_angle_deg,35,1\n",
            "each response once; its line 2 has response shear_angle_deg, as another line",
        ),
        ("response,value,deviation\nshear_angle_deg,0.63,0.4\n", "2 to below 90 degrees; its line 2 has .* 0.63"),
        ("response,value,deviation\nshear_angle_deg,3600,0.4\n", "2 to below 90 degrees; its line 2 has .* 3600"),
        ("response,value,deviation\ndischarge_time_s,-5.4,0.4\n", "above 0 to 3600 s; its line 2 has .* -5.4"),
    ],
)
def test_a_table_of_measurements_that_says_nothing_is_refused(monkeypatch, text, words):
    """A column that is missing, or a number that is none, is named with its line."""
    show(monkeypatch, "gravel_tests.csv", text)
    with pytest.raises(ConfigError, match=rf"calibration\.measured is 'gravel_tests\.csv'.*{words}"):
        study()


@pytest.mark.parametrize(
    ("content", "words"), [(b"", "the file is empty"), (b"response,value\na,b,c,d\n", "line 2"), (b"\xff\xfea\0", "")]
)
def test_a_table_that_cannot_be_read_is_named(tmp_path, monkeypatch, content, words):
    """By its file, before it is taken for numbers."""
    (tmp_path / "config/published").mkdir(parents=True)
    (tmp_path / "config/published/gravel_tests.csv").write_bytes(content)
    monkeypatch.setattr(case, "current_project", lambda: Project(tmp_path))
    with pytest.raises(ConfigError, match=rf"config/published/gravel_tests\.csv.*{words}"):
        case.published("gravel_tests.csv")


def test_published_data_are_those_of_the_source():
    """The example is that of Yan 2022: four measured responses, six pairs of the draw-down test, the chosen one."""
    measured, pairs = pd.read_csv(MEASURED), pd.read_csv(PAIRS)
    assert dict(zip(measured["response"], measured["value"], strict=True))["shear_angle_deg"] == 36.0
    assert measured["source"].str.contains("Table 3.1").all()
    assert pairs["discharge_time_s"].notna().sum() == 6
    names = [SLIDING, ROLLING]
    assert pair_of(pairs, "calibrated", names, study().runs[0].parameters) == {SLIDING: 0.21, ROLLING: 0.4}


def test_a_calibration_has_the_decks_of_its_tests_and_no_runs(tmp_path):
    """Decks are those of all tests; simulations are the bulk tests that its tables name, not those of design rows or of
    other settings; all that are there where tables of an earlier version name none.
    """
    found = study()
    runs = [run.name for run in found.runs]
    assert found.case.deck_files(runs, []) == [f"{test}/deck.in" for test in ("shear_box", "draw_down", "wall_shear")]
    assert not found.case.wears and found.beds == {}
    there = ["draw_down_1", "shear_box_0", "shear_box_2"]
    for name in there:
        (tmp_path / "simulations" / name).mkdir(parents=True)
    (tmp_path / "simulations" / "lock").touch()
    pd.DataFrame({"folders": ["shear_box_0", "draw_down_1 shear_box_0"]}).to_csv(tmp_path / "repeats.csv")
    assert [path.name for path in found.case.simulation_folders(tmp_path, runs)] == there[:2]
    pd.DataFrame({"seed": [1]}).to_csv(tmp_path / "simulations.csv")
    assert [path.name for path in found.case.simulation_folders(tmp_path, runs)] == there
