"""Tables of runs of equipment, from folders whose rates are known."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.tables.summary import read_named
from bulkwear.workflows.cases.equipment import flow_tables, tables
from tests.workflows.cases.equipment.synthetic import SyntheticPart, SyntheticRun, values_of, write_study

RELATIVE = 1e-9  # numbers pass through CSV text
LINER = SyntheticPart("liner", (1e-6, 2e-6, 3e-6), worn=1.2)
HOOD = SyntheticPart("hood", force=50.0)
WHEEL = SyntheticPart("wheel", (4e-6,), power=100.0)
PARTS = (LINER, HOOD, WHEEL)
SPREAD = (0.9, 1.0, 1.1)  # factors of three packings


def packings(setting="plain", factors=SPREAD, parts=PARTS, **given):
    """Runs of a setting, one for each factor."""
    return [
        SyntheticRun(f"{setting}-{k}", parts, setting=setting, packing=k, factor=factor, scatter=0.05, **given)
        for k, factor in enumerate(factors, start=1)
    ]


@pytest.fixture
def read(tmp_path):
    """What reads a synthetic study."""
    return lambda runs: tables.read_runs(write_study(tmp_path, runs), tmp_path)


def test_names_of_rows_are_text(tmp_path):
    """01 keeps its nought, and NA is a name; what is empty is no value."""
    table = pd.DataFrame({"run": ["01", "NA"], "setting": ["01", "NA"], "part": ["null", ""], "value": [1.0, np.nan]})
    table.to_csv(tmp_path / "table.csv", index=False)
    found = read_named(tmp_path / "table.csv", "part")
    assert found["run"].tolist() == found["setting"].tolist() == ["01", "NA"]
    assert found["part"].fillna("").tolist() == ["null", ""] and found["value"].isna().tolist() == [False, True]


def test_rates_are_those_of_the_blocks(read):
    """Recession per 1,000 h is the mean over packings, per Mt it is that over what is fed in as many hours."""
    found = tables.rates_table(read(packings())).set_index(["part", "patch"])
    assert found.loc["liner", "pristine_mm_per_1000h"].tolist() == pytest.approx([1.0, 2.0, 3.0], rel=RELATIVE)
    assert found.loc["liner", "worn_mm_per_1000h"].tolist() == pytest.approx([1.2, 2.4, 3.6], rel=RELATIVE)
    mt_per_1000_hours = 50.0 * 3600.0 * 1000.0 / 1e9
    per_mt = found.loc["wheel", "pristine_mm_per_Mt"].iloc[0]
    assert per_mt == pytest.approx(4.0 / mt_per_1000_hours, rel=RELATIVE)


def test_sliding_velocity_is_weighted_by_the_normal_force(read):
    """A patch that one block of a packing touches, at 8 m/s: the others do not slow it down; 0 where none touches."""
    runs = read(packings())
    touched = (runs.patches["cycle"] == 1) & (runs.patches["patch"] == 1)
    pressure = np.where(touched, 50.0, 0.0)
    told = {"pressure_Pa": pressure, "sliding_power_W_per_m2": 8.0 * pressure, "sliding_velocity_m_per_s": 8.0}
    found = tables.rates_table(replace(runs, patches=runs.patches.assign(**told))).set_index(["part", "patch"])
    velocity = found.loc["liner", "sliding_velocity_m_per_s"]
    assert velocity[1] == pytest.approx(8.0) and (velocity.drop(1) == 0.0).all()


def test_interval_is_over_packings(read):
    """Of three packings 0.1 apart it is Student's t on two degrees of freedom; of one packing there is none."""
    three, one = (tables.rates_table(read(packings(factors=factors))).iloc[0] for factors in (SPREAD, (1.0,)))
    reach = 4.302652729911275 * 0.1 / np.sqrt(3.0)
    ends = three[["pristine_low_mm_per_1000h", "pristine_high_mm_per_1000h"]].tolist()
    assert ends == pytest.approx([1.0 - reach, 1.0 + reach], rel=RELATIVE)
    assert np.isnan(one["pristine_low_mm_per_1000h"]) and one["packings"] == 1


def test_machine_without_inlet_has_no_rate_per_tonne(read):
    """A filled machine is fed nothing."""
    found = tables.rates_table(read(packings(rate=None)))
    assert found["pristine_mm_per_Mt"].isna().all() and found["pristine_mm_per_1000h"].notna().all()


def test_run_without_updates_has_no_worn_shape(read):
    """Its columns are empty, the table is there."""
    read = read(packings(updates=0, worn=0))
    assert tables.rates_table(read)["worn_mm_per_1000h"].isna().all()
    assert tables.loads_table(read)["change_percent"].isna().all()


def test_change_of_loads_is_taken_by_packing(read):
    """Packings differ by 10 %, the worn shape takes 20 % more in each of them: that is known exactly."""
    found = tables.loads_table(read(packings())).set_index(["part", "quantity"])
    force = found.loc[("liner", "force")]
    ends = force[["change_percent", "change_percent_low", "change_percent_high"]].tolist()
    assert ends == pytest.approx([20.0] * 3, rel=1e-6)
    assert force["pristine"] == pytest.approx(100.0) and force["worn"] == pytest.approx(120.0)
    assert found.loc[("wheel", "power_W"), "pristine"] == pytest.approx(100.0)
    assert ("hood", "power_W") not in found.index and ("hood", "worn_mass_kg_per_h") not in found.index


def test_a_part_that_turns_has_no_mean_force(read):
    """In its own turning frame the mean is about nothing, whatever lies in it."""
    turning = {"kind": "rotation", "point_m": (0.0, 0.0, 0.0), "axis": (0.0, 1.0, 0.0), "speed_rad_per_s": 2.0}
    quantities = {}
    for speed in (2.0, 0.0):
        part = replace(LINER, motion=turning | {"speed_rad_per_s": speed})
        found = tables.loads_table(read([replace(run, parts=(part,)) for run in packings()]))
        quantities[speed] = set(found["quantity"])
    assert quantities[0.0] - quantities[2.0] == {"force"}


def test_flow_is_what_was_fed(read):
    """180 t/h come in and go out, 20 kg are held for 0.4 s, and the flow is steady."""
    found = flow_tables.flow_table(read(packings(pristine=8)))
    pristine = found[found["phase"] == "pristine"]
    for column, value in (("in_t_per_h", 180.0), ("out_t_per_h", 180.0), ("held_kg", 20.0), ("residence_s", 0.4)):
        assert pristine[column].tolist() == pytest.approx([value] * 3)
    assert set(pristine["answer"]) == {"steady"}
    assert set(found["phase"]) == {"pristine", "worn"}


def test_power_is_that_of_the_parts_of_a_design(read):
    """Another design's moving parts, and the first block that prints no power, leave the verdict as it is."""
    other = (SyntheticPart("screw", (1e-6,), power=64.0),)
    found = flow_tables.flow_table(read([*packings(pristine=8), *packings("other", parts=other, pristine=8)]))
    pristine = found[found["phase"] == "pristine"].set_index("setting")
    assert pristine["power_W"].to_dict() == {"plain": pytest.approx(100.0), "other": pytest.approx(64.0)}
    assert set(pristine["answer"]) == {"steady"} and pristine["said"].str.contains(" W are taken").all()


def test_balance_of_particles_closes_in_every_cycle(read, tmp_path):
    """None is missing; one that is lost is."""
    runs = packings(factors=(1.0,))
    assert (flow_tables.mass_balance(read(runs))["missing"] == 0).all()
    path = tmp_path / runs[0].name / "cycle_003" / "flow.csv"
    flow = pd.read_csv(path)
    flow.loc[len(flow) - 1, "particles"] -= 1
    flow.to_csv(path, index=False)
    lost = flow_tables.mass_balance(tables.read_runs([values_of(runs[0])], tmp_path)).set_index("cycle")["missing"]
    assert lost[3] == 1 and lost[4] == -1 and (lost.drop([3, 4]) == 0).all()


def test_summary_has_hours_and_volumes(tmp_path):
    """Three updates of 100 h wear 0.3 mm off a patch of 1e-6 m/h; blocks that keep the shape wear nothing."""
    runs = packings(factors=(1.0,), parts=(SyntheticPart("liner", (1e-6,)),))
    write_study(tmp_path, runs)
    found = tables.summary(tmp_path / "design.csv", [tmp_path / run.name / "wear.csv" for run in runs], [], []).iloc[0]
    assert found["operation_h"] == pytest.approx(300.0)
    assert found["worn_volume_m3"] == pytest.approx(0.01 * 3e-4)
    assert [found[f"{phase}_cycles"] for phase in ("pristine", "wearing", "worn")] == [4, 3, 2]
    assert found["largest_balance_error"] == 0.0


def test_summary_tells_the_first_hole(tmp_path):
    """By which hours it is there, those of the update's end, and where, as the state of that cycle says."""
    runs = packings(factors=(1.0,))
    write_study(tmp_path, runs)
    folder = tmp_path / runs[0].name
    wear = pd.read_csv(folder / "wear.csv")
    wear.loc[wear["cycle"] >= 6, "through_nodes"] = 3
    wear.to_csv(folder / "wear.csv", index=False)
    (folder / "cycle_006" / "state.json").write_text('{"worn_through": "worn through at 3 nodes"}')
    found = tables.summary(tmp_path / "design.csv", [folder / "wear.csv"], [], []).iloc[0]
    assert found["through_h"] == 200.0 and found["through_said"] == "worn through at 3 nodes"
    assert found["through_nodes"] == 3


def test_run_without_blocks_is_named(tmp_path):
    """A run that has no wear cycle yet is told by its folder."""
    values = write_study(tmp_path, packings(factors=(1.0,)))
    for path in (tmp_path / "plain-1").glob("cycle_*/patches.csv"):
        path.unlink()
    with pytest.raises(FileNotFoundError, match="plain-1: no cycle"):
        tables.read_runs(values, tmp_path)
