"""What runs of equipment will cost: all blocks that there may be, of the particles that a machine holds."""

import pytest

from bulkwear.workflows.cases.equipment.parameters import most_blocks
from bulkwear.workflows.cases.equipment.surfaces import machine_surface
from bulkwear.workflows.cases.equipment.work import MOVING_PER_PARTICLE, run_bytes, run_stages, triangles_of
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.forecast.forecast import work_of
from tests.support.own_machine_project import machine_study
from tests.support.own_solids import write_ascii
from tests.workflows.cases.equipment.scenes import box


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    with machine_study(tmp_path_factory.mktemp("work")) as study:
        yield study.runs[0].parameters


def test_all_blocks_are_counted(run):
    """The first one, in which the machine fills, and all others, each with a deck of its own and a wear update."""
    first, others = run_stages(run)
    steps = run["derived"]["first_cycle_steps"]
    assert first.decks + others.decks == most_blocks(run) and first.decks == 1
    assert first.steps + others.steps == most_blocks(run) * steps
    assert others.particles == run["derived"]["held_particles"] == 2.0 * first.particles
    assert first.surface_triangles == 0.0 < others.surface_triangles < others.triangles  # the hood does not wear


def test_more_pictures_and_blocks_need_more_disk(run):
    """Pictures have all particles, every block its surface and restart file."""
    more = {**run, "sampling": {**run["sampling"], "pictures_per_block": 20}}
    longer = [{**run, "derived": {**run["derived"], "travel_steps": k * 1220}} for k in (10, 20, 30)]
    first, second, third = map(run_bytes, longer)
    assert run_bytes(more) > run_bytes(run)
    assert 0.0 < second - first == pytest.approx(third - second)


def test_a_mesh_that_moves_costs_more_than_one_at_rest(run):
    """Each particle looks for its walls more often, without more memory; a belt's surface moves on a mesh at rest."""
    still = [{**part, "motion": None} for part in run["parts"]]
    axis = {"point_m": [0, 0, 0], "axis": [0, 1, 0], "speed_rad_per_s": 1.0}
    stages = {}
    for kind in ("rest", "turning_surface", "rotation"):
        motion = None if kind == "rest" else {"kind": kind, **axis}
        stages[kind] = run_stages({**run, "parts": [{**still[0], "motion": motion}, *still[1:]]})[1]
    rest, turning = stages["rest"], stages["rotation"]
    assert rest == stages["turning_surface"] and turning.triangles == rest.triangles
    more = MOVING_PER_PARTICLE * rest.particles * rest.steps
    assert turning.terms()["triangle_steps"] - rest.terms()["triangle_steps"] == pytest.approx(more)


COUNT = 0.2  # relative: `work.OVER_EQUILATERAL` is the middle of 1.04 to 1.19, and edges of plates are not finer


def test_triangles_are_counted_by_the_area_of_the_drawing(run):
    """About as many as the mesh has that is made later; four times as many with half the edge."""
    part = run["parts"][0]
    assert triangles_of(part) == pytest.approx(len(machine_surface([part]).triangles), rel=COUNT)
    assert triangles_of({**part, "edge_m": 0.5 * part["edge_m"]}) == pytest.approx(4.0 * triangles_of(part))


def test_triangles_that_a_file_has_are_counted(run, tmp_path):
    """A scan has more than its area asks for, and none is taken away; without a solid each body counts for itself."""
    part = {**run["parts"][0], "file": str(tmp_path / "scan.stl")}
    scan = box((0.24, 0.1, 0.03), 0.004)
    plate = box((0.4, 0.2, 0.2), 0.2)
    write_ascii(
        tmp_path / "scan.stl", {name: (1e3 * m.points, m.triangles) for name, m in (("scan", scan), ("plate", plate))}
    )
    of_scan = triangles_of({**part, "solid": "scan"})
    assert of_scan == len(scan.triangles) == len(machine_surface([{**part, "solid": "scan"}]).triangles)
    of_plate = triangles_of({**part, "solid": "plate"})
    assert of_plate > 2 * len(plate.triangles)
    assert triangles_of(part) == pytest.approx(of_scan + of_plate)


def test_a_drawing_that_cannot_be_read_has_no_forecast(run, tmp_path):
    """What is wrong with it is told with the part, in place of a size that nobody knows."""
    with pytest.raises(ConfigError, match=r"^parts.liner: meshes/nothing.step: there is no such file"):
        triangles_of({**run["parts"][0], "file": "nothing.step"})
    (tmp_path / "broken.stl").write_text("solid liner\nendsolid\n")
    with pytest.raises(ConfigError, match=r"^parts.liner: .*broken.stl"):
        triangles_of({**run["parts"][0], "file": str(tmp_path / "broken.stl")})


def test_a_solid_that_is_not_there_and_a_wrong_unit_are_told_with_the_forecast(run):
    """The drawing is read for its area: what is wrong with it is told then."""
    part = run["parts"][0]
    with pytest.raises(ConfigError, match=r"^parts.liner.solid is 'nobody', allowed is one of liner\.$"):
        triangles_of({**part, "solid": "nobody"})
    with pytest.raises(ConfigError, match=r"^parts.liner.unit is m, in which liner.stl is 286.4 m large"):
        run_stages({**run, "parts": [{**part, "unit": "m"}, *run["parts"][1:]]})


def test_jobs_of_a_study_are_its_runs(tmp_path):
    """One job a row and packing; twice the tonnes are twice the particles."""
    with machine_study(tmp_path, "row,inlet.rate_t_per_h\nA,1.5\nB,3\n", packings=2) as study:
        jobs = {job.wildcards[0]: job for job in work_of(study)}
    assert list(jobs) == ["A", "A-2", "B", "B-2"]
    assert jobs["B"].stages[1].particles == pytest.approx(2.0 * jobs["A"].stages[1].particles)
