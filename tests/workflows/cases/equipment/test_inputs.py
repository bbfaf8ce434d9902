"""What simulates a machine again: the operation that its shape is worn for, not how that is judged."""

import json

import pytest

from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.schema import case_schema, load_schema
from bulkwear.workflows.engine.inputs import SIMULATED_FROM, run_digest, simulated_from, surface_from, why_again
from bulkwear.workflows.engine.state import cycle_folder
from tests.support.own_machine_project import FASTER, machine_study

SHORT = 40  # letters, of what Snakemake shows of a surface
SHORTER = {"duration_h": 300}
TONNES = {"duration_h": None, "throughput_mt": 0.0003}
OURS = """\
from bulkwear.postproc.wear.laws import Law

LAW = Law(lambda columns, given: {}, "ours.", "nobody")
"""


def digest(folder, **changes):
    """The hash of what the run of the tiny machine is simulated from, its settings changed."""
    with machine_study(folder, **changes) as study:
        return run_digest(study.case, study.runs[0].parameters, None)


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    return digest(tmp_path_factory.mktemp("before"))


@pytest.mark.parametrize("operation", [SHORTER, TONNES])
def test_other_hours_are_another_simulation(tmp_path, before, operation):
    """The updates of the shape stand for shares of them."""
    assert digest(tmp_path, operation=operation) != before


def test_hours_of_a_shape_that_is_kept_are_not(tmp_path):
    """Without updates nothing is simulated from them."""
    kept = {"updates": {"most": 0}, "parts": FASTER}
    assert digest(tmp_path / "a", **kept) == digest(tmp_path / "b", operation=SHORTER, **kept)


@pytest.mark.parametrize(
    "changes",
    [
        {"inlet": {"centre_mm": [-60, 0, 161]}},
        {"inlet": {"size_mm": [70, 80]}},
        {"inlet": {"normal": [0.1, 0, -1]}},
        {"outlets": {"below": {"centre_mm": [0, 0, -346]}}},
        {"outlets": {"below": {"size_mm": [890, 800]}}},
        {"domain": {"low_mm": [-600, -300, -500], "high_mm": [600, 300, 300]}},
    ],
)
def test_what_the_solver_reads_beside_its_decks_is_another_simulation(tmp_path, before, changes):
    """Inlet, outlets and domain stand in files of their own: neither decks nor surface change with them."""
    assert digest(tmp_path, **changes) != before


@pytest.mark.parametrize(
    "operation",
    [
        {"hours_per_year_h": 8000},
        {"told_at_h": [100, 9000]},
        {"change_out_remaining_mm": 1},
        {"change_out_remaining_mm": None, "change_out_worn_mass_fraction": 0.2},
    ],
)
def test_judging_simulates_nothing(tmp_path, before, operation):
    """When a liner is changed, what is told at which hours, and how many a year has, is told of the same runs."""
    assert digest(tmp_path, operation=operation) == before


@pytest.mark.parametrize("rule", [{"change_out_remaining_mm": 1}, {"change_out_worn_mass_fraction": 0.2}])
def test_judging_a_part_by_a_rule_of_its_own_simulates_nothing(tmp_path, before, rule):
    """As that of all parts."""
    assert digest(tmp_path, parts={"liner": rule}) == before


def told(folder, **changes):
    """What Snakemake compares of the surface of the tiny machine, its settings changed."""
    with machine_study(folder, **changes) as study:
        return repr(surface_from(study.case, study.runs[0].parameters))


def test_a_surface_is_made_again_for_its_shape_and_room_alone(tmp_path):
    """Not for how it wears, how that is judged, nor for another seed; in one word, however many parts there are."""
    first = told(tmp_path)
    assert first.startswith("simulated from ") and len(first) < SHORT
    same = (
        {"parts": {"liner": {"wear_coefficient_error": 0.1, "wear_coefficient_per_pa": 1e-12, "law": "finnie"}}},
        {
            "operation": {"duration_h": 500, "hours_per_year_h": 8000, "told_at_h": [100]},
            "sampling": {"patch_mm": 70, "pictures_per_block": 4},
        },
        {"bulk": {"seed": 7}},
    )
    for changes in same:
        assert told(tmp_path, **changes) == first, changes
    other = (
        {"parts": {"liner": {"edge_mm": 26}}},
        {"parts": {"paddle": {"motion": {"speed_rpm": 70}}}},
        {"sampling": {"most_blocks": 4}},  # parts move and particles fly for longer
        {"inlet": {"centre_mm": [-60, 0, 161]}},
        {"operation": {"change_out_remaining_mm": 3}},  # which a drawing may be too thin for
        {"parts": {"liner": {"change_out_remaining_mm": 3}}},
    )
    for changes in other:
        assert told(tmp_path, **changes) != first, changes


def test_a_record_of_more_than_surfaces_are_made_from_is_no_difference(tmp_path):
    """Cycle 0 of an older version kept more of the parameters; of what counts now the first difference is told."""
    with machine_study(tmp_path) as study:
        run = study.runs[0].parameters
        found = simulated_from(study.case, run, None)
    whole = {**found, "surface": {name: run[name] for name in (*study.case.geometry, "derived", "bulk")}}
    cycle_folder(tmp_path, 0).mkdir()
    (cycle_folder(tmp_path, 0) / SIMULATED_FROM).write_text(json.dumps(whole))
    assert why_again(tmp_path, found) is None
    assert "change_out_remaining_m" not in found["surface"]  # another one is checked, and simulates nothing
    longer = {**found["surface"], "derived": {**found["surface"]["derived"], "travel_steps": 7}}
    phrase = why_again(tmp_path, {**found, "surface": longer})
    assert phrase == f"surface.derived.travel_steps is 7, it was {run['derived']['travel_steps']}"


@pytest.fixture
def own_law(tmp_path):
    """What writes the law `ours` of a project's own and returns the change by which a part wears by it; the schemas,
    which remember the laws, forget it afterwards.
    """

    def written(volume):
        (tmp_path / "laws").mkdir(exist_ok=True)
        (tmp_path / "laws/ours.py").write_text(OURS.format(volume))
        return {"parts": {"liner": {"law": "ours"}}}

    forgotten = (load_schema, case_schema)
    for each in forgotten:
        each.cache_clear()
    yield written
    LAWS.pop("ours")
    for each in forgotten:
        each.cache_clear()


def test_a_run_hangs_on_the_own_law_of_a_part(tmp_path, own_law):
    """Another line in the project's law of one part is another simulation, though wear.law is the package's."""
    first = digest(tmp_path, **own_law('given["wear_coefficient_per_pa"] * columns["sliding_work_J"]'))
    assert digest(tmp_path, **own_law('0.5 * given["wear_coefficient_per_pa"] * columns["sliding_work_J"]')) != first


def test_the_own_law_of_a_part_is_tried_first(tmp_path, own_law):
    """One that takes a volume without load is refused where the study is read."""
    with pytest.raises(ConfigError, match=r"laws/ours\.py: of two triangles, the first without load, the law ours"):
        digest(tmp_path, **own_law('1.0 + columns["sliding_work_J"]'))
