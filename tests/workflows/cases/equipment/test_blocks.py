"""What a block does to parts, from ledgers that are made: rates by patch and part, and what decides the next block."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import areas, shortest_edge_at_nodes, unit_normals, write_surface
from bulkwear.postproc.statistics.intervals import error_of_mean, students_t
from bulkwear.postproc.wear.area_patches import patches_of
from bulkwear.postproc.wear.kernels import kernel_column
from bulkwear.postproc.wear.ledger import vector_columns
from bulkwear.postproc.wear.update import REMOVED_THICKNESS
from bulkwear.workflows.cases.equipment import blocks
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.cases.equipment.surfaces import faces_of, machine_surface
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.schedule import Span
from tests.support.own_machine_project import SHAFT, machine_study

ROUND_OFF = 1e-12  # relative; sums over some hundred faces
HOUR = 3600.0
SPAN = Span(4, 3660, 1220, 1, "wearing", 200.0 * HOUR, 50.0 * HOUR)
SUMS = ("sliding_work_J", "normal_impulse_N_s", "impact_energy_J", "drive_work_J", kernel_column("finnie_work"))


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """The tiny machine with a ledger whose sums differ from face to face; its run's folder holds the surface."""
    with machine_study(tmp_path_factory.mktemp("blocks")) as study:
        run = study.runs[0].parameters
        surface, folder = machine_surface(run["parts"]), tmp_path_factory.mktemp("run")
    write_surface(folder / "surface.vtu", surface)
    rng, count = np.random.default_rng(3), len(surface.triangles)
    names = [*SUMS, *(column for vector in ("impulse", "moment") for column in vector_columns(vector))]
    ledger = pd.DataFrame({name: rng.uniform(0.5, 1.5, count) for name in names})
    return SimpleNamespace(run=run, surface=surface, folder=folder, ledger=ledger)


def faces(machine, number):
    return faces_of(machine.surface, number, machine.run["parts"][number])


def rows(machine, **changes):
    given = {"surface": machine.surface, "ledger": machine.ledger, "span": SPAN, "run": machine.run, **changes}
    return blocks.patch_rows(given["run"], given["span"], machine.folder, given["surface"], given["ledger"])


def part_rows(machine, ledger=None, run=None):
    ledger = machine.ledger if ledger is None else ledger
    return blocks.part_rows(run or machine.run, SPAN, machine.surface, ledger).set_index("part")


# ---------------------------------------------------------------- rates


def test_each_part_wears_by_its_own_law_and_coefficient(machine):
    """Archard's of sliding work, Finnie's of its own sum; nothing on the rigid part."""
    volume = blocks.rate_volume(machine.run, machine.surface, machine.ledger)
    steel = machine.run["wear"]["wear_coefficient_per_pa"]
    laws = ((steel, "sliding_work_J"), (1e-12, kernel_column("finnie_work")), (steel, "sliding_work_J"))
    for number, (coefficient, column) in enumerate(laws):
        expected = coefficient * machine.ledger[column][faces(machine, number)]
        np.testing.assert_allclose(volume[faces(machine, number)], expected, rtol=ROUND_OFF)
    assert not volume[faces(machine, 3)].any()


def test_parts_wear_by_one_law_with_parameters_of_their_own(machine, tmp_path):
    """Each by the sum that has its threshold."""
    slow, fast = ({"threshold_velocity_m_per_s": speed} for speed in (0.2, 1.5))
    parts = {
        name: {"law": "impact_threshold", "parameters": given, "wear_coefficient_per_pa": 1e-11}
        for name, given in (("liner", slow), ("plate", fast))
    }
    with machine_study(tmp_path, parts=parts) as study:
        run = study.runs[0].parameters
    hit = "impact_above_threshold"
    names = dict(zip((part["name"] for part in run["parts"]), range(len(run["parts"])), strict=True))
    assert blocks.sums_of(run) == {hit: slow, f"{hit}.2": fast}
    ledger = machine.ledger.assign(**{f"{hit}_J": 1.0, f"{hit}.2_J": 3.0})
    volume = blocks.rate_volume(run, machine.surface, ledger)
    found = {name: set(volume[faces(machine, names[name])]) for name in ("liner", "plate")}
    assert found == {"liner": {1e-11}, "plate": {3e-11}}


def test_recession_is_volume_over_area_and_time(machine):
    """Of a patch: coefficient x sliding work over its area and the block's time, per hour of operation."""
    found = rows(machine)
    geometry = blocks.geometry_of(machine.run, machine.folder)
    size, duration = areas(machine.surface.points, machine.surface.triangles), blocks.duration_s(machine.run, SPAN)
    assert duration == pytest.approx(0.15, rel=ROUND_OFF)
    coefficient = machine.run["wear"]["wear_coefficient_per_pa"]
    on_liner = found[found["part"] == "liner"]
    for number, rate, pressure, power in zip(
        on_liner["patch"],
        on_liner["recession_m_per_h"],
        on_liner["pressure_Pa"],
        on_liner["sliding_power_W_per_m2"],
        strict=True,
    ):
        there = geometry.patch == number
        area, work = size[there].sum(), machine.ledger["sliding_work_J"][there].sum()
        assert rate == pytest.approx(coefficient * work / area / duration * HOUR, rel=ROUND_OFF)
        assert power == pytest.approx(work / area / duration, rel=ROUND_OFF)
        impulse = machine.ledger["normal_impulse_N_s"][there].sum()
        assert pressure == pytest.approx(impulse / area / duration, rel=ROUND_OFF)
    assert not np.isin(geometry.patch[faces(machine, 3)], found["patch"]).any()


def test_patches_and_parts_lose_the_same(machine):
    """Recession x area over the patches of a part is the volume of the part; mass is that of its own wall."""
    patches, parts = rows(machine), part_rows(machine)
    volume = (patches["recession_m_per_h"] * patches["area_m2"]).groupby(patches["part"]).sum()
    for name in ("liner", "plate", "paddle"):
        assert volume[name] == pytest.approx(parts.loc[name, "worn_volume_m3_per_h"], rel=1e-9)
        assert parts.loc[name, "worn_mass_kg_per_h"] == pytest.approx(7932 * volume[name], rel=1e-9)
    assert parts["worn_volume_m3_per_h"]["hood"] == parts["worn_mass_kg_per_h"]["hood"] == 0.0
    assert parts["role"].tolist() == ["wears", "wears", "wears", "rigid"]


def test_rates_do_not_depend_on_what_a_block_stands_for(machine):
    """Hours and phases are columns, rates are per hour of operation."""
    columns = ["recession_m_per_h", "pressure_Pa", "impact_power_W_per_m2", "sliding_velocity_m_per_s"]
    other = rows(machine, span=Span(2, 1220, 1220, 1, "pristine", 0.0, 0.0))
    pd.testing.assert_frame_equal(rows(machine)[columns], other[columns])
    assert set(other["phase"]) == {"pristine"} and set(rows(machine)["phase"]) == {"wearing"}
    assert set(rows(machine)["stands_for_h"]) == {50.0} and set(rows(machine)["operation_h"]) == {200.0}


def test_doubled_coefficients_double_recession_and_nothing_else(machine):
    """Of the same ledger; so do doubled loads, with the pressure."""
    parts = [
        {**part, "wear_coefficient_per_pa": 2.0 * part["wear_coefficient_per_pa"]} for part in machine.run["parts"]
    ]
    harder, once = rows(machine, run={**machine.run, "parts": parts}), rows(machine)
    np.testing.assert_allclose(harder["recession_m_per_h"], 2.0 * once["recession_m_per_h"], rtol=ROUND_OFF)
    same = [name for name in once if not name.endswith("recession_m_per_h")]
    pd.testing.assert_frame_equal(harder[same], once[same])
    loaded = rows(machine, ledger=2.0 * machine.ledger)
    for name in ("recession_m_per_h", "pressure_Pa"):
        np.testing.assert_allclose(loaded[name], 2.0 * once[name], rtol=ROUND_OFF)
    np.testing.assert_allclose(loaded["sliding_velocity_m_per_s"], once["sliding_velocity_m_per_s"], rtol=ROUND_OFF)


def test_sliding_velocity_is_work_over_impulse(machine):
    """Weighted with the load; 0 where nothing pressed."""
    velocity = machine.ledger.assign(sliding_work_J=3.0 * machine.ledger["normal_impulse_N_s"])
    np.testing.assert_allclose(rows(machine, ledger=velocity)["sliding_velocity_m_per_s"], 3.0, rtol=ROUND_OFF)
    assert not rows(machine, ledger=0.0 * machine.ledger)["sliding_velocity_m_per_s"].any()


def test_thickness_is_given_or_measured(machine):
    """The liner's is that of the study, the plate's that of the drawing through its thin side."""
    found = rows(machine).groupby("part")["thickness_m"]
    np.testing.assert_allclose(found.get_group("liner"), 0.03, rtol=ROUND_OFF)
    assert found.get_group("plate").min() == pytest.approx(0.03, rel=1e-4)
    assert blocks.given_thickness(machine.run) == {0: 0.03}


def test_a_measured_thickness_is_lost_from_behind_too(machine):
    """The recession of what lies behind a patch is that of the plate's other face; behind the liner, whose thickness is
    given, nothing counts.
    """
    across = machine.surface.points[machine.surface.triangles].mean(axis=1)[:, 0]
    plate = faces(machine, 1)
    thin = unit_normals(machine.surface.points, machine.surface.triangles)[:, 0]
    back = plate & (thin > 1.0 - ROUND_OFF)  # x is across its thin side
    assert across[back].min() > across[plate & (thin < ROUND_OFF - 1.0)].max()
    size = areas(machine.surface.points, machine.surface.triangles)
    evenly = np.where(back, size, 0.0)  # on that face alone
    found = rows(machine, ledger=machine.ledger.assign(**dict.fromkeys(machine.ledger, evenly)))
    front = found[(found["part"] == "plate") & (found["normal_x"] < -0.99)]
    there = found[(found["part"] == "plate") & (found["normal_x"] > 0.99)]
    assert len(front) and not front["recession_m_per_h"].any()
    np.testing.assert_allclose(
        front["back_recession_m_per_h"], there["recession_m_per_h"].mean(), rtol=ROUND_OFF * len(size)
    )
    assert not there["back_recession_m_per_h"].any()
    assert not found.loc[found["part"] == "liner", "back_recession_m_per_h"].any()


def test_depth_is_what_was_removed_before_the_block(machine):
    """Its mean over the area of each patch; places and numbers stay those of the shape as built."""
    assert not rows(machine)["depth_m"].any()
    removed = np.where(machine.surface.points[:, 0] > 0.0, 2e-3, 1e-3)
    worn = SimpleNamespace(**{**vars(machine.surface), "point_data": {REMOVED_THICKNESS: removed}})
    found = rows(machine, surface=worn)
    assert found["depth_m"].between(1e-3 - 1e-12, 2e-3 + 1e-12).all()
    assert found["depth_m"].nunique() > 1
    geometry, size = blocks.geometry_of(machine.run, machine.folder), areas(worn.points, worn.triangles)
    patch = patches_of(machine.surface, geometry.surface, geometry.patch)
    there = patch == 0
    of_faces = removed[worn.triangles].mean(axis=1)
    assert found["depth_m"][0] == pytest.approx(np.average(of_faces[there], weights=size[there]), rel=ROUND_OFF)
    pd.testing.assert_frame_equal(found[["x_m", "y_m", "z_m", "patch"]], rows(machine)[["x_m", "y_m", "z_m", "patch"]])


def test_force_and_power_of_parts(machine):
    """Impulse over time, work of the drive over time; torque about the axis of the part that turns, else the origin."""
    duration, found = blocks.duration_s(machine.run, SPAN), part_rows(machine)
    for number, name in enumerate(found.index):
        there = machine.ledger[faces(machine, number)]
        assert found.loc[name, "force_z_N"] == pytest.approx(there["impulse_z_N_s"].sum() / duration, rel=ROUND_OFF)
        assert found.loc[name, "power_W"] == pytest.approx(there["drive_work_J"].sum() / duration, rel=ROUND_OFF)
        assert found.loc[name, "impact_power_W"] == pytest.approx(
            there["impact_energy_J"].sum() / duration, rel=ROUND_OFF
        )
    still = [{**part, "motion": None} for part in machine.run["parts"]]
    about_origin = part_rows(machine, run={**machine.run, "parts": still})
    torque, force = ([f"{what}_{axis}_{unit}" for axis in "xyz"] for what, unit in (("torque", "N_m"), ("force", "N")))
    shift = np.cross(np.array(SHAFT) / 1e3, found.loc["paddle", force].to_numpy(float))
    np.testing.assert_allclose(
        found.loc["paddle", torque].to_numpy(float), about_origin.loc["paddle", torque].to_numpy(float) - shift
    )
    pd.testing.assert_series_equal(found.loc["plate"], about_origin.loc["plate"])


def test_wear_of_a_block_is_its_rate_for_the_operation_it_stands_for(machine):
    """Twice the hours are twice the volume; a block that stands for none wears nothing."""
    case, rate = find_case("equipment"), blocks.rate_volume(machine.run, machine.surface, machine.ledger)
    volume = case.law_volume(machine.run, SPAN, machine.surface, machine.ledger)
    np.testing.assert_allclose(volume, rate * 50.0 * HOUR / 0.15, rtol=1e-9)
    twice = Span(4, 3660, 1220, 1, "wearing", 200.0 * HOUR, 100.0 * HOUR)
    np.testing.assert_allclose(
        case.law_volume(machine.run, twice, machine.surface, machine.ledger), 2.0 * volume, rtol=ROUND_OFF
    )
    idle = Span(4, 3660, 1220, 1, "pristine", 0.0, 0.0)
    assert not case.law_volume(machine.run, idle, machine.surface, machine.ledger).any()


# ---------------------------------------------------------------- what decides the next block


def tables_of(rates, thickness=(0.01, 0.03, np.nan), edge=0.02):
    """Tables of blocks with three patches of the liner; rates: (blocks, 3) m/h."""
    same = {"thickness_m": thickness, "edge_m": edge, "phase": "pristine", "part": "liner"}
    return [
        pd.DataFrame({"recession_m_per_h": rate, "back_recession_m_per_h": 0.0, **same})
        for rate in np.asarray(rates, float)
    ]


def ruled(machine, **rule):
    """The run of the machine with a rule of change-out."""
    return {**machine.run, "operation": rule}


@pytest.mark.parametrize(
    ("rule", "depths_m"),
    [
        ({}, (0.01, 0.03, 1.0)),
        ({"change_out_remaining_m": 0.008}, (0.002, 0.022, 1.0)),
        ({"change_out_remaining_m": 0.02}, (1.0, 0.01, 1.0)),
        ({"change_out_remaining_fraction": 0.5}, (0.005, 0.015, 1.0)),
        ({"change_out_worn_mass_fraction": 0.5}, (0.01, 0.03, 1.0)),
    ],
)
def test_urgency_is_recession_over_the_depth_that_may_be_lost(machine, rule, depths_m):
    """A metre stands for it where the thickness is not known, or no more than what shall remain."""
    (table,) = tables_of([[1e-5, 6e-5, 1e-3]])
    expected = np.array([1e-5, 6e-5, 1e-3]) / depths_m
    np.testing.assert_allclose(blocks.urgency(ruled(machine, **rule), table), expected, rtol=ROUND_OFF)


def test_urgency_is_by_the_rule_of_each_part(machine):
    """A plate with 25 of its 30 mm to remain, beside a liner by the operation's 8 mm; by its mass all may be lost."""
    (table,) = tables_of([[1e-5, 1e-5, 1e-5]], thickness=0.03)
    table["part"] = ["plate", "liner", "paddle"]
    own = {"plate": {"change_out_remaining_m": 0.025}, "paddle": {"change_out_worn_mass_fraction": 0.5}}
    run = ruled(machine, change_out_remaining_m=0.008)
    run["parts"] = [part | own.get(part["name"], {}) for part in run["parts"]]
    np.testing.assert_allclose(blocks.urgency(run, table), 1e-5 / np.array([0.005, 0.022, 0.03]), rtol=ROUND_OFF)


def test_the_place_that_is_changed_first_decides(machine):
    """Of 10 mm with 8 to remain before of 30 mm, though it wears more slowly over its thickness."""
    steady, scattered = np.full(5, 1.0), np.array([5.0, 7.0, 6.0, 6.5, 5.5])
    tables = tables_of(np.column_stack([steady, scattered, steady]) * 1e-5)
    assert blocks.deciding_width(ruled(machine), tables) > 0.0
    assert blocks.deciding_width(ruled(machine, change_out_remaining_m=0.008), tables) == 0.0


def test_deciding_width_is_that_of_the_place_that_goes_first(machine):
    """Student's interval of the series of the most urgent place, whole, over its mean."""
    run, series = ruled(machine), np.array([5.0, 7.0, 6.0, 6.5, 5.5])
    rates = np.column_stack([np.full(5, 1.0), series, np.full(5, 90.0)]) * 1e-5
    expected = 2.0 * students_t(0.975, 4) * error_of_mean(series) / series.mean()
    assert blocks.deciding_width(run, tables_of(rates)) == pytest.approx(expected, rel=ROUND_OFF)
    thin = tables_of(rates, thickness=(0.001, 0.03, np.nan))
    assert blocks.deciding_width(run, thin) == 0.0  # the first place goes first, and does not scatter


@pytest.mark.parametrize("rates", [[[1e-5] * 3] * 2, [[0.0] * 3] * 5, []], ids=["two blocks", "no wear", "no block"])
def test_width_is_unknown(machine, rates):
    """Of too few blocks, and where nothing wears."""
    assert blocks.deciding_width(machine.run, tables_of(rates)) == np.inf


def test_fastest_step_is_over_the_step_that_an_update_may_take(machine):
    """The fastest patch by its mean over the latest blocks, in allowed shares of its edge."""
    share = machine.run["wear"]["largest_step_edge_fraction"]
    rates = [[1e-5, 1e-3, 0.0]] * 3 + [[2e-5, 5e-5, 0.0]] * 2 + [[4e-5, 5e-5, 0.0]] * 2
    expected = 5e-5 / HOUR / (share * 0.02)
    assert blocks.fastest_step_per_s(machine.run, tables_of(rates)) == pytest.approx(expected, rel=ROUND_OFF)
    assert blocks.fastest_step_per_s(machine.run, []) == 0.0
    assert blocks.fastest_step_per_s(machine.run, tables_of([[0.0] * 3])) == 0.0


def test_patch_that_is_gone_decides_no_step(machine):
    """It has no faces, so no edge."""
    tables = tables_of([[1e-5, 0.0, 0.0]], edge=(0.02, np.nan, 0.02))
    assert 0.0 < blocks.fastest_step_per_s(machine.run, tables) < np.inf


def test_caps_on_nodes_hold_back_a_tenth_at_most(machine):
    """Of what a block's wear would stand for: over the volume of all nodes, what is beyond their caps is that share."""
    operation = 1.0 / blocks.held_back_per_s(machine.run, SPAN, machine.surface, machine.ledger)
    corners = machine.surface.triangles.ravel()
    rate = blocks.rate_volume(machine.run, machine.surface, machine.ledger) / blocks.duration_s(machine.run, SPAN)
    size = areas(machine.surface.points, machine.surface.triangles)
    wanted, area = (np.bincount(corners, np.repeat(each / 3.0, 3)) for each in (operation * rate, size))
    share = machine.run["wear"]["largest_step_edge_fraction"]
    room = area * share * shortest_edge_at_nodes(machine.surface.points, machine.surface.triangles)
    beyond = np.maximum(wanted - room, 0.0)[wanted > 0.0].sum() / wanted.sum()
    assert beyond == pytest.approx(blocks.MOST_HELD_BACK, rel=1e-6)  # of the root that is sought
    heavier = machine.ledger.assign(**{name: 3.0 * machine.ledger[name] for name in SUMS})
    assert operation * blocks.held_back_per_s(machine.run, SPAN, machine.surface, heavier) == pytest.approx(3.0)
    idle = machine.ledger.assign(**dict.fromkeys(SUMS, 0.0))
    assert blocks.held_back_per_s(machine.run, SPAN, machine.surface, idle) == 0.0


def test_sampled_blocks_are_those_on_the_shape_as_built(tmp_path):
    """By the phase that their tables name, up to a block."""
    phases = ("start_up", "pristine", "pristine", "wearing", "worn")
    for number, phase in enumerate(phases, start=1):
        folder = tmp_path / f"cycle_{number:03d}"
        folder.mkdir()
        pd.DataFrame({"phase": [phase], "cycle": [number]}).to_csv(folder / blocks.PATCHES, index=False)
    found = [table["cycle"].iloc[0] for table in blocks.patch_tables(tmp_path, 5, (PRISTINE,))]
    assert found == [2, 3] and len(blocks.patch_tables(tmp_path, 2, (PRISTINE,))) == 1
    assert len(blocks.patch_tables(tmp_path, 4)) == 4
