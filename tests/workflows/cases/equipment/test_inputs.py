"""What simulates a machine again: the operation that its shape is worn for, not how that is judged."""

import pytest

from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.schema import case_schema, load_schema
from bulkwear.workflows.engine.inputs import run_digest
from tests.support.own_machine_project import machine_study

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
    kept = {"updates": {"most": 0}}
    assert digest(tmp_path / "a", **kept) == digest(tmp_path / "b", operation=SHORTER, **kept)


@pytest.mark.parametrize(
    "operation",
    [
        {"hours_per_year_h": 8000},
        {"change_out_remaining_mm": 1},
        {"change_out_remaining_mm": None, "change_out_worn_mass_fraction": 0.2},
    ],
)
def test_judging_simulates_nothing(tmp_path, before, operation):
    """When a liner is changed, and how many hours a year has, is told of the same runs."""
    assert digest(tmp_path, operation=operation) == before


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
    assert digest(tmp_path, **own_law('0.5 * columns["sliding_work_J"]')) != first


def test_the_own_law_of_a_part_is_tried_first(tmp_path, own_law):
    """One that takes a volume without load is refused where the study is read."""
    with pytest.raises(ConfigError, match="law ours: on a ledger of two triangles without load it returns"):
        digest(tmp_path, **own_law('1.0 + columns["sliding_work_J"]'))
