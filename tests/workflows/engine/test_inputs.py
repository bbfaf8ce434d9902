"""What a run is simulated from: what changes its hash, and what does not."""

import copy
import pickle
import shutil

import pytest

from bulkwear.workflows.cases.sliding_sample import case
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine import chain, inputs, templates
from bulkwear.workflows.engine.inputs import SimulatedFrom, bed_digest, job_digest, other_length, run_digest
from bulkwear.workflows.engine.schedule import known_spans
from bulkwear.workflows.engine.state import STATE, cycle_folder
from tests.support.tiny import tiny_study
from tests.support.tiny_tester import tiny_tester


def digest_of(study, run, change=lambda parameters: None):
    """Hash of a run of a study after a change of its parameters."""
    parameters = copy.deepcopy(study.run(run).parameters)
    change(parameters)
    return run_digest(study.case, parameters, study.beds[study.bed_of(run)])


@pytest.fixture(scope="module")
def study():
    return tiny_study()


def test_a_setting_that_nothing_consumes_simulates_nothing_again(study):
    """A key of the solver that no deck uses, and what follows from settings for tables only, leave the hash alone."""
    before = digest_of(study, "R9_convex")
    assert digest_of(study, "R9_convex", lambda run: run["solver"].update(new_option="none")) == before
    assert digest_of(study, "R9_convex", lambda run: run["derived"].update(told_in_tables=1.0)) == before
    assert digest_of(study, "R9_convex", lambda run: run["solver"].update(ranks=2)) == before


@pytest.mark.parametrize(
    ("section", "key", "value"),
    [
        ("wear", "accelerated_wear_coefficient_per_pa", 1e-9),
        ("wear", "patch", "physical"),
        ("remeshing", "largest_aspect", 20.0),
        ("sliding", "velocity_m_per_s", 0.5),
        ("derived", "travel_steps", 7),
    ],
)
def test_what_solver_or_wear_step_consume_changes_the_hash(study, section, key, value):
    """Wear settings, bounds of remeshing, velocity and length each make another run."""
    assert digest_of(study, "R9_convex", lambda run: run[section].update({key: value})) != digest_of(study, "R9_convex")


def test_changed_wear_code_changes_the_hash(study, monkeypatch):
    """The number that is raised beside the wear code makes every run another one."""
    before = digest_of(study, "R9_convex")
    monkeypatch.setattr(inputs, "WEAR_VERSION", inputs.WEAR_VERSION + 1)
    assert digest_of(study, "R9_convex") != before


LATER = {"picture_interval_mm": (20, 100, 1000), "wear_interval_mm": (10, 9.6, 10.4, 40)}  # the first one is told


@pytest.mark.parametrize("key", LATER)
def test_what_only_longer_adaptive_cycles_take_changes_the_hash(key):
    """Intervals of pictures and of looks at the wear that the first cycle's deck does not tell apart; the hash of the
    study as it is has none of them.
    """

    def settings(value):
        found = load_study("worn_bump", overrides={"fidelity": "quick", "solver": {key: value}})
        (run,) = found.runs
        return inputs.simulated_from(found.case, run.parameters, found.beds[found.bed_of(run.name)])

    hashes = {value: settings(value) for value in LATER[key]}
    assert len({inputs.digest_of(found) for found in hashes.values()}) == len(LATER[key])
    told = [inputs.LONGER_CYCLES not in found["settings"] for found in hashes.values()]
    assert told == [True] + [False] * (len(LATER[key]) - 1)


def test_looks_that_one_number_of_steps_stands_for_are_told_apart():
    """So many in the first adaptive cycle that their steps, rounded, are those of others."""
    found = load_study("worn_bump", overrides={"fidelity": "quick"}).runs[0].parameters
    steps, first = found["derived"]["first_cycle_steps"], found["sliding"]["first_cycle_m"]
    deck_has = {}
    for parts in range(1, steps):
        solver = {**found["solver"], "wear_interval_m": first / parts}
        besides = inputs._of_longer_cycles({**found, "solver": solver})
        deck_has.setdefault((-(-steps // parts), str(besides)), []).append(parts)
    assert all(len(same) == 1 for same in deck_has.values())


def test_equal_cycles_have_nothing_besides(study):
    """Whatever their intervals, their hash is that of the first one's deck."""
    parameters = copy.deepcopy(study.run("R9_convex").parameters)
    parameters["solver"].update(wear_interval_m=1.0)
    parameters["derived"].update(picture_interval_steps=10 * parameters["derived"]["travel_steps"])
    assert inputs._of_longer_cycles(parameters) == {}


def test_an_edited_template_changes_the_hash(study, monkeypatch):
    """A word more in a deck makes another run and another bed."""
    before = digest_of(study, "R9_convex"), bed_digest(study.case, study.beds["bed_R5"])
    for module in (case, chain):
        monkeypatch.setattr(module, "render", lambda *given: templates.render(*given) + "# a word more\n")
    assert digest_of(study, "R9_convex") != before[0]
    assert bed_digest(study.case, study.beds["bed_R5"]) != before[1]


def test_a_longer_run_of_the_tester_is_the_same_one():
    """Where a case says that its length changes no cycle, the hash leaves it out; the machine's shape is in it."""
    short, long = (tiny_tester(sliding={"revolutions": revolutions}) for revolutions in (2, 3))
    assert digest_of(short, "convex") == digest_of(long, "convex")
    assert digest_of(short, "convex", lambda run: run["tester"].update(incline_rad=0.1)) != digest_of(long, "convex")


def test_a_longer_run_is_another_job():
    """Finished cycles of a shorter run hold, and its job goes on from them; a sliding sample's hash is enough."""
    jobs = {
        job_digest(study.case, study.run("convex").parameters, digest_of(study, "convex"))
        for study in (tiny_tester(sliding={"revolutions": revolutions}) for revolutions in (2, 3))
    }
    assert len(jobs) == 2
    study = tiny_study()
    digest = digest_of(study, "R9_convex")
    assert job_digest(study.case, study.run("R9_convex").parameters, digest) == digest


def test_a_run_of_another_length_is_told(tmp_path):
    """Unless it ended as it was worn through; of a sliding sample the hash tells."""
    study = tiny_tester(sliding={"revolutions": 2})
    parameters = study.run("convex").parameters
    asked = len(known_spans(parameters))
    for cycle in range(asked):
        cycle_folder(tmp_path, cycle).mkdir()
        (cycle_folder(tmp_path, cycle) / STATE).write_text("{}")
    assert other_length(tmp_path, study.case, parameters) == f"{asked} wear cycles are asked for, it has {asked - 1}"
    state = cycle_folder(tmp_path, asked - 1) / STATE
    state.write_text('{"worn_through": "in the middle"}')
    assert other_length(tmp_path, study.case, parameters) is None
    shutil.copytree(cycle_folder(tmp_path, 0), cycle_folder(tmp_path, asked))
    assert other_length(tmp_path, study.case, parameters) is None
    sliding = tiny_study()
    assert other_length(tmp_path, sliding.case, sliding.run("R9_convex").parameters) is None


def test_jobs_compare_the_hash_and_get_the_values():
    """Snakemake compares what a parameter looks like: the hash alone; a pickled copy has the values."""
    first, second = SimulatedFrom({"a": 1}, "f" * 64), SimulatedFrom({"a": 1, "new": "none"}, "f" * 64)
    assert repr(first) == repr(second) == "simulated from ffffffffffff"
    assert pickle.loads(pickle.dumps(second)) == {"a": 1, "new": "none"}


def test_where_every_value_counts_the_hash_is_of_all():
    """As of a calibration, whose job keeps its simulations itself."""
    first, again, other = (SimulatedFrom.all_of({"box": {"width_m": width}}) for width in (0.1, 0.1, 0.2))
    assert repr(first) == repr(again) != repr(other) and "width_m" not in repr(first)
    assert pickle.loads(pickle.dumps(other)) == other == {"box": {"width_m": 0.2}}
