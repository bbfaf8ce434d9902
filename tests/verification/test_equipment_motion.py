"""Parts of equipment that move: the power of a belt, and a turning part that wears where it is hit."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import read_surface, unit_normals
from bulkwear.postproc.statistics.block_means import mean_of_blocks
from bulkwear.postproc.wear.bodies import body
from bulkwear.postproc.wear.update import REMOVED_THICKNESS
from bulkwear.workflows.cases.equipment import flow
from bulkwear.workflows.cases.equipment.motions import motion_of
from bulkwear.workflows.cases.equipment.surfaces import faces_of
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.cycles import run_chain
from tests.support.own_machine_project import Machine, machine_chain, machine_study
from tests.support.own_solids import box
from tests.support.stl import stl_facets
from tests.verification.equipment_stream import DIAMETER, MATERIALS

pytestmark = [pytest.mark.solver, pytest.mark.verify]

BLOCKS = 6
END = 2e-3  # relative; contacts with the face at the end of a belt, whose surface goes along that face; seen 9e-4
SET_UP = 0.02  # relative; sliding contacts are damped by more than friction once, when a block begins
BELT, FED = 1.5, 0.5  # m/s, of the belt and of what falls on it, along it
BELT_RATE = 2.0  # t/h
ARM, TURN_S = 150.0, 0.4  # mm, of the turning bar from its shaft; s, for a turn
BAR_RATE = 1.0  # t/h
STL_ROUNDING = 1e-9  # m; %.9g of coordinates below 1 m


def study(parts, bodies, inlet, outlet, block_s, blocks=BLOCKS, **changes) -> Machine:
    """A machine of parts with one inlet that material falls through and one outlet below."""
    settings = {
        "title": "A part that moves",
        "question": "What does it do to particles, and they to it?",
        "case": "equipment",
        "design": "machine.csv",
        "packings": 1,
        "particle_scale": 1,
        "parts": {
            name: {"file": f"{name}.stl", "unit": "mm", "material": "plate", "role": "wears", "edge_mm": 20, **part}
            for name, part in parts.items()
        },
        "bulk": {"material": "ball"},
        "inlet": {"normal": [0, 0, -1], **inlet},
        "outlets": {"below": {"normal": [0, 0, -1], **outlet}},
        "start_up": {"most_s": 0.6},
        "sampling": {"block_s": block_s, "fewest_blocks": blocks, "most_blocks": blocks, "patch_mm": 100},
        "updates": {"most": 0},
        "operation": {"duration_h": 1000, "change_out_remaining_mm": 0},
        "solver": {"rayleigh_fraction": 0.3},
    }
    return Machine({**settings, **changes}, bodies, MATERIALS)


def part_tables(chain, name) -> pd.DataFrame:
    """The rows of a part in all blocks but the start-up's."""
    count = len(list(chain.folder.glob("cycle_*")))
    found = [pd.read_csv(state.cycle_folder(chain.folder, k) / "parts.csv") for k in range(1, count)]
    rows = pd.concat(found).query("part == @name and phase != 'start_up'")
    return rows.reset_index(drop=True)


# ---------------------------------------------------------------- belt


@pytest.fixture(scope="module")
def belt(tmp_path_factory):
    """A belt of 700 mm on which balls fall, slower than it: they slide until they go with it."""
    motion = {"kind": "belt", "velocity_m_per_s": [BELT, 0, 0]}
    machine = study(
        {"belt": {"motion": motion}},
        {"belt": box((700, 100, 20), (-60, -50, -20))},
        {
            **{"rate_t_per_h": BELT_RATE, "centre_mm": [0, 0, 30], "size_mm": [60, 60]},
            "velocity_m_per_s": [FED, 0, -0.5],
        },
        {"centre_mm": [450, 0, -100], "size_mm": [1400, 400]},
        0.2,
        domain={"low_mm": [-330, -310, -380], "high_mm": [1250, 310, 240]},  # the solver's lists cost by their room
    )
    folder = tmp_path_factory.mktemp("belt")
    with machine_study(folder, machine=machine) as project:
        chain = machine_chain(project, folder / "results/machine")
        run_chain(chain)
        yield SimpleNamespace(chain=chain, rows=part_tables(chain, "belt"))


@pytest.mark.verify
def test_power_of_a_belt_is_its_force_times_its_velocity(belt):
    """In every block: what it gives to particles is minus the force on it, along its velocity, times that; at its end
    the solver lets the surface go down."""
    assert len(belt.rows) == BLOCKS
    np.testing.assert_allclose(belt.rows["power_W"], -belt.rows["force_x_N"] * BELT, rtol=END)
    assert (belt.rows["power_W"] > 0.0).all()


def test_force_of_a_belt_is_the_momentum_it_gives(belt):
    """What leaves it goes as fast as it: force = rate x (belt's velocity - that of the feed); half of the power above
    that of the feed is slid away."""
    last = len(list(belt.chain.folder.glob("cycle_*"))) - 1
    ends = flow.whole_flow(belt.chain.folder, belt.chain.parameters, last).groupby("cycle").last()
    rate = ends["inserted_mass_kg"].diff().iloc[-BLOCKS:].mean() / 0.2
    found = mean_of_blocks(-belt.rows["force_x_N"])
    low, high = found.interval()
    truth = rate * (BELT - FED)
    assert low - SET_UP * truth < truth < high + SET_UP * truth and found.width() < 0.2
    slid = mean_of_blocks(belt.rows["sliding_power_W"]).value * 0.3  # W, friction coefficient of the wall
    lost = truth * BELT - 0.5 * rate * (BELT**2 - FED**2)
    assert slid == pytest.approx(lost, rel=0.15)


# ---------------------------------------------------------------- turning bar


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    """A bar that turns about y through one of its ends; balls fall where it goes down, on its upper side as drawn."""
    motion = {"kind": "rotation", "point_mm": [0, 0, 0], "axis": [0, 1, 0], "speed_rpm": 60.0 / TURN_S}
    machine = study(
        {"bar": {"motion": motion}},
        {"bar": box((ARM, 100, 24), (0, -50, -12))},
        {
            **{"rate_t_per_h": BAR_RATE, "centre_mm": [0.6 * ARM, 0, 220], "size_mm": [60, 60]},
            "velocity_m_per_s": [0, 0, -3.0],
        },
        {"centre_mm": [0.6 * ARM, 0, -200], "size_mm": [1600, 800]},
        0.3,  # s: blocks begin with the bar at other angles
        2,  # blocks before the update, which wears by the last of them
        domain={"low_mm": [-1100, -450, -400], "high_mm": [1300, 450, 660]},
        start_up={"most_s": 0.3},
        **{"updates": {"most": 1, "worn_blocks": 1}, "operation": {"duration_h": 2000, "change_out_remaining_mm": 0}},
    )
    folder = tmp_path_factory.mktemp("bar")
    with machine_study(folder, machine=machine) as project:
        chain = machine_chain(project, folder / "results/machine")
        run_chain(chain)
        yield chain


def test_turning_part_wears_where_it_is_hit(bar):
    """On its upper side as drawn, although blocks begin and end with that side anywhere; its drive pays for the balls
    that it throws, or they drive it."""
    worn = read_surface(bar.folder / "worn_surface.vtu")
    depth = worn.point_data[REMOVED_THICKNESS][worn.triangles].mean(axis=1)
    normal = unit_normals(worn.points, worn.triangles)[:, 2]
    middle = worn.points[worn.triangles].mean(axis=1)
    upper, lower = normal > 0.9, normal < -0.9
    assert depth[upper].sum() > 20.0 * depth[lower].sum()
    assert depth[upper].max() == depth.max()
    place = np.average(middle[upper], axis=0, weights=depth[upper])
    assert 0.03 < place[0] < 1e-3 * ARM and abs(place[1]) < 0.02
    starts = [motion_of(bar.parameters["parts"][0]["motion"]).pose(0.3 * k)[0] for k in range(4)]
    assert len({tuple(np.round(each.ravel(), 6)) for each in starts}) == 4


def test_worn_place_turns_with_its_part(bar):
    """The solver gets the worn shape where the part has turned to."""
    part, last = bar.parameters["parts"][0], len(list(bar.folder.glob("cycle_*"))) - 1
    before = read_surface(state.cycle_folder(bar.folder, last - 1) / "surface.vtu")
    own = body(before, faces_of(before, 0, part))
    assert own.point_data[REMOVED_THICKNESS].max() > 1e-5
    found = stl_facets(state.cycle_folder(bar.folder, last) / "bar.stl")
    rotation, shift = motion_of(part["motion"]).pose(0.3 * last)
    expected = (own.points @ rotation.T + shift)[own.triangles]
    np.testing.assert_allclose(found, expected, atol=STL_ROUNDING)
    drawn = read_surface(bar.surface).points
    assert np.abs(own.points[: len(drawn)] - drawn).max() > 1e-5


def test_balls_are_as_large_as_the_gaps_they_fall_through():
    """Parts are wider than balls: what is tested is not a sieve."""
    assert min(ARM, 60.0) > 3.0 * DIAMETER
