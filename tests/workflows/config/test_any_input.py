"""Whatever stands in a study, in its design or in a file of a run: it is taken, or refused in one sentence."""

import csv
import io
import math

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from benchmarks.chaos import SAMPLES, spoilt_project
from benchmarks.chaos_files import CAD_MACHINES, READERS, SPINS, is_of_configuration
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.schema import load_schema

SOME = settings(
    max_examples=25, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
WORDS = some.text(max_size=12)
NUMBERS = some.one_of(some.integers(), some.floats(), some.sampled_from([0, -1, math.inf, 1e-320, 10**40]))
KEYS = some.one_of(some.sampled_from(sorted(load_schema("settings")["properties"])), WORDS)
VALUES = some.recursive(
    some.one_of(some.none(), some.booleans(), NUMBERS, WORDS),
    lambda inner: some.one_of(some.lists(inner, max_size=3), some.dictionaries(KEYS, inner, max_size=3)),
    max_leaves=6,
)
HEAD = {"title": "Any", "question": "Is it told?", "design": "demo.csv", "surfaces": ["plain"]}
COLUMNS = some.sampled_from(["row", "seed", "height_mm", "velocity_m_per_s", "bed_thickness_mm", "x", ""])


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    return spoilt_project(tmp_path_factory.mktemp("any") / "project")


def is_told(project) -> bool:
    """Whether the study loads, or is refused in one sentence."""
    try:
        load_study("any", project=project)
    except Exception as fault:
        return is_of_configuration(fault) and len(str(fault).splitlines()) == 1
    return True


@SOME
@given(found=some.dictionaries(KEYS, VALUES, max_size=4))
def test_any_settings(project, found):
    """Keys that there are and others, with values of any kind, nested."""
    (project.folder / "config" / "studies" / "any.yaml").write_text(yaml.safe_dump(HEAD | found), encoding="utf-8")
    assert is_told(project)


@SOME
@given(
    head=some.lists(COLUMNS, max_size=5),
    rows=some.lists(some.lists(some.one_of(WORDS, NUMBERS), max_size=5), max_size=3),
)
def test_any_design(project, head, rows):
    """Columns that there are and others, cells of any kind, rows of any length."""
    text = io.StringIO()
    csv.writer(text).writerows([head, *rows])
    (project.folder / "config" / "designs" / "any.csv").write_text(text.getvalue(), encoding="utf-8")
    study = yaml.safe_dump(HEAD | {"design": "any.csv"})
    (project.folder / "config" / "studies" / "any.yaml").write_text(study, encoding="utf-8")
    assert is_told(project)


@settings(SOME, max_examples=100)
@given(
    name=some.sampled_from(sorted(set(READERS) - set(CAD_MACHINES))), begins=some.integers(0, 400), then=some.binary()
)
def test_any_bytes(tmp_path, name, begins, then):
    """A file of a run, a mesh or a scan that begins as a whole one may, and goes on as it likes."""
    kinds = {"contacts.dump": "slide_contacts.dump", "loads.vtk": "bed_loads.vtk", "log.liggghts": "bed_log.txt"}
    whole = (SAMPLES / kinds.get(name, "plate.stl")).read_bytes()
    (tmp_path / SPINS).write_bytes((SAMPLES / "slide_spins.dump").read_bytes())
    (tmp_path / name).write_bytes(whole[:begins] + then)
    try:
        READERS[name](tmp_path / name)
    except Exception as fault:
        assert str(tmp_path) in str(fault) and len(str(fault).splitlines()) == 1
