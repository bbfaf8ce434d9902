"""The life of parts from folders whose rates are known: thickness over rate, its interval, the worn shape."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, write_surface
from bulkwear.workflows.cases.equipment import life, life_findings, life_tables, pictures, tables
from bulkwear.workflows.cases.equipment.change_out import BY_MASS, FRACTION, REMAINING
from bulkwear.workflows.cases.equipment.life import AS_BUILT, EXTRAPOLATED, FOLLOWED, WHOLE_PART
from tests.support.shapes import box
from tests.workflows.cases.equipment.synthetic import (
    DENSITY,
    OPERATION,
    SIDE,
    SyntheticPart,
    SyntheticRun,
    write_study,
)

RELATIVE = 1e-9  # numbers pass through CSV text
THICKNESS, RATE = 0.03, 2e-6  # m, m/h
UNIFORM = SyntheticPart("liner", (RATE,) * 4, thickness=THICKNESS)
ONE = SyntheticRun("plain", (UNIFORM,))
TWO_PARTS = {"parts": {"hood": {"wears": False}, "liner": {"wears": True}}, "operation": {BY_MASS: 0.1}}
T_TWO = 4.302652729911275  # Student's t at 95 % on two degrees of freedom


def with_rule(run, **rule):
    """A run with another change-out rule."""
    kept = {name: value for name, value in OPERATION.items() if not name.startswith("change_out")}
    return replace(run, operation=kept | rule)


def packings(run, factors):
    """A run of each factor, of one setting."""
    return [
        replace(run, name=f"{run.name}-{k}", setting=run.name, packing=k, factor=factor)
        for k, factor in enumerate(factors, start=1)
    ]


@pytest.fixture
def lives(tmp_path):
    """What makes runs, lives and the life table of a synthetic study."""

    def made(*given, volumes=None):
        runs = tables.read_runs(write_study(tmp_path, given), tmp_path)
        found = life.part_lives(runs, volumes or {})
        return runs, found, life_tables.life_table(runs, found)

    return made


# ---------------------------------------------------------------- uniform wear


def test_life_is_thickness_over_rate(lives):
    """Of a liner that wears evenly, in h, in Mt of feed and in years, and so by the rate as built."""
    row = lives(ONE)[2].iloc[0]
    hours = THICKNESS / RATE
    assert row["life_h"] == pytest.approx(hours, rel=RELATIVE)
    assert row["pristine_life_h"] == pytest.approx(hours, rel=RELATIVE)
    assert row["life_Mt"] == pytest.approx(hours * 50.0 * 3600.0 / 1e9, rel=RELATIVE)
    assert row["life_years"] == pytest.approx(hours / 6000.0, rel=RELATIVE)
    assert row["allowed_mm"] == pytest.approx(30.0) and row["rule"] == "worn through"


def test_a_plate_that_wears_on_both_faces_lasts_half_as_long(lives):
    """Where its thickness is measured, by which it is told; and so is what is left of it."""
    runs, found, table = lives(replace(ONE, parts=(replace(UNIFORM, behind=1.0),)))
    assert table["life_h"].iloc[0] == pytest.approx(0.5 * THICKNESS / RATE, rel=RELATIVE)
    left = life_tables.remaining_table(runs, found).set_index("operation_h")["remaining_mm"]
    assert left[300.0] == pytest.approx(1e3 * (THICKNESS - 2.0 * 300.0 * RATE))


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_twice_the_rate_halves_the_life(lives, factor):
    """Load, coefficient and hours enter the rate as factors."""
    whole, other = (lives(replace(ONE, factor=each))[2]["life_h"].iloc[0] for each in (1.0, factor))
    assert other == pytest.approx(whole / factor, rel=RELATIVE)


@pytest.mark.parametrize(
    ("rule", "depth", "words"),
    [
        ({"change_out_remaining_m": 0.01}, 0.02, "10 mm left"),
        ({"change_out_remaining_fraction": 0.25}, 0.0225, "25 % of the thickness left"),
        ({}, 0.03, "worn through"),
    ],
)
def test_rules_of_thickness(lives, rule, depth, words):
    """A part is changed when so much is left of it."""
    row = lives(with_rule(ONE, **rule))[2].iloc[0]
    assert row["life_h"] == pytest.approx(depth / RATE, rel=RELATIVE)
    assert row["rule"] == words


def test_a_part_has_a_rule_of_its_own(lives, tmp_path):
    """Its own stands for that of the operation, of whatever kind, in lives, worst places and maps of what is left."""
    plate, cone = (replace(UNIFORM, name=name) for name in ("plate", "cone"))
    parts = (UNIFORM, replace(plate, rule={REMAINING: 0.02}), replace(cone, rule={BY_MASS: 0.5}))
    run = with_rule(replace(ONE, parts=parts), **{FRACTION: 0.1})
    volume = 4 * SIDE**2 * THICKNESS
    runs, found, table = lives(run, volumes={("plain", "cone"): volume})
    table = table.set_index("part")
    allowed = {"liner": 0.9 * THICKNESS, "plate": THICKNESS - 0.02, "cone": 0.5 * THICKNESS}
    for name, depth in allowed.items():
        assert table.loc[name, "life_h"] == pytest.approx(depth / RATE, rel=RELATIVE), name
    assert table["rule"].to_dict() == {
        "liner": "10 % of the thickness left",
        "plate": "20 mm left",
        "cone": "50 % of the mass worn",
    }
    worst = life_tables.worst_places(runs, tables.rates_table(runs), found).groupby("part")["life_h"].first()
    assert worst["plate"] == pytest.approx(allowed["plate"] / RATE, rel=RELATIVE)
    due = pictures.change_out_mm(runs.values)
    assert due == pytest.approx({"liner": 3.0, "plate": 20.0, "cone": np.nan}, nan_ok=True)
    assert life_tables.part_volumes(tmp_path / "plain" / "surface.vtu", runs.values[0]) == {}  # the cone is open


def test_rule_of_mass(lives):
    """A tenth of the mass is a tenth of the volume, lost by all patches together; no place decides."""
    volume = 4 * SIDE**2 * THICKNESS
    rule = {BY_MASS: 0.1}
    row = lives(with_rule(ONE, **rule), volumes={("plain", "liner"): volume})[2].iloc[0]
    assert row["life_h"] == pytest.approx(0.1 * THICKNESS / RATE, rel=RELATIVE)
    assert row["patch"] == WHOLE_PART and np.isnan(row["x_mm"])


def test_rule_of_mass_tells_a_rate_that_wear_was_changing(lives):
    """As a rule of thickness does; the rate is that of the whole part."""
    run = with_rule(replace(ONE, parts=(replace(UNIFORM, worn=1.5),), worn=4), change_out_worn_mass_fraction=0.5)
    row = lives(run, volumes={("plain", "liner"): 4 * SIDE**2 * THICKNESS})[2].iloc[0]
    assert "the last rate goes on, 1.5 times that as built" in life_findings.life_sentence(row, False)


@pytest.mark.parametrize("own", [False, True])
def test_volume_of_a_part_is_that_of_its_body(tmp_path, own):
    """Labels are the numbers of the parts; a rigid one has none. The rule may be the operation's or its own."""
    mesh = box((0.4, 0.2, 0.1), 2)
    both = SurfaceMesh(mesh.points, mesh.triangles, {"part": np.full(len(mesh.triangles), 1)})
    write_surface(tmp_path / "surface.vtu", both)
    run = {**TWO_PARTS, "periodic": None}
    if own:
        run |= {"parts": {"hood": {"wears": False}, "liner": {"wears": True, BY_MASS: 0.1}}, "operation": {}}
    found = life_tables.part_volumes(tmp_path / "surface.vtu", run)
    assert found == {"liner": pytest.approx(0.4 * 0.2 * 0.1)}


@pytest.mark.parametrize("axis", ["x", "y"])
def test_volume_of_a_part_in_a_slice_is_that_between_its_ends(tmp_path, axis):
    """It goes on in its image, without faces there; a part that is open elsewhere, too, has none."""
    mesh, k = box((0.4, 0.2, 0.1), 2), "xyz".index(axis)
    points = np.add(mesh.points, (0.03, 0.01, 0.02))
    low, high = points[:, k].min(), points[:, k].max()
    kept = mesh.triangles[np.ptp(points[mesh.triangles][:, :, k], axis=1) > 0.0]
    assert len(kept) < len(mesh.triangles)
    slices = {"axis": axis, "low_m": low, "high_m": high}
    for triangles, periodic, volumes in (
        (kept, slices, {"liner": pytest.approx(0.4 * 0.2 * 0.1)}),
        (mesh.triangles, slices, {"liner": pytest.approx(0.4 * 0.2 * 0.1)}),
        (kept, None, {}),
        (kept, {**slices, "low_m": low - 0.01}, {}),
        (kept[1:], slices, {}),
    ):
        write_surface(tmp_path / "surface.vtu", SurfaceMesh(points, triangles, {"part": np.full(len(triangles), 1)}))
        run = {**TWO_PARTS, "periodic": periodic}
        assert life_tables.part_volumes(tmp_path / "surface.vtu", run) == volumes


def test_open_part_has_no_mass(lives, tmp_path):
    """Its life by its mass is unknown, and why is told."""
    rule = {BY_MASS: 0.1}
    runs, _, table = lives(with_rule(ONE, **rule))
    assert life_tables.part_volumes(tmp_path / "plain" / "surface.vtu", runs.values[0]) == {}
    assert table["reason"].iloc[0] == life.NO_VOLUME


# ---------------------------------------------------------------- the place that decides


def test_place_that_decides_is_the_one_of_the_shortest_life(lives):
    """It is told with its coordinates and its rates; thinner ones may come before faster ones."""
    runs, found, table = lives(replace(ONE, parts=(SyntheticPart("liner", (1e-6, 3e-6, 2e-6)),)))
    row = table.iloc[0]
    assert row["patch"] == 1
    assert [row[f"{axis}_mm"] for axis in "xyz"] == pytest.approx([150.0, 50.0, 0.0])
    assert row["pristine_mm_per_1000h"] == pytest.approx(3.0)
    worst = life_tables.worst_places(runs, tables.rates_table(runs), found)
    assert worst["patch"].tolist() == [1, 2, 0] and worst["rank"].tolist() == [1, 2, 3]
    assert worst["life_h"].tolist() == pytest.approx([1e4, 1.5e4, 3e4])


def test_worst_places_are_those_that_wear(lives):
    """Five of a part at most, and none that nothing touches."""
    parts = SyntheticPart("liner", tuple(1e-6 * k for k in range(1, 9))), SyntheticPart("plate", (1e-6, 0.0))
    runs, found, _ = lives(replace(ONE, parts=parts))
    worst = life_tables.worst_places(runs, tables.rates_table(runs), found)
    assert worst["part"].tolist() == ["liner"] * life.WORST + ["plate"]
    assert worst["patch"].tolist() == [7, 6, 5, 4, 3, 8]


def test_without_thickness_there_is_no_life(lives):
    """The reason is told, and what is fastest is listed all the same."""
    runs, found, table = lives(replace(ONE, parts=(SyntheticPart("liner", (1e-6, 3e-6), thickness=None),)))
    assert np.isnan(table["life_h"].iloc[0]) and table["reason"].iloc[0] == life.NO_THICKNESS
    assert life_tables.worst_places(runs, tables.rates_table(runs), found)["patch"].tolist() == [1, 0]
    assert life_tables.remaining_table(runs, found).empty


def test_a_faster_place_of_unknown_thickness_is_told(lives):
    """It decides nothing, and the sentence on the life says where it is; a slower one is not told."""
    runs, _, _ = lives(replace(ONE, parts=(SyntheticPart("liner", (1e-5, 1e-6, 5e-7)),)))
    for unknown, rate in ((0, 10.0), (2, np.nan)):
        thickness = runs.patches["thickness_m"].where(runs.patches["patch"] != unknown)
        changed = replace(runs, patches=runs.patches.assign(thickness_m=thickness))
        row = life_tables.life_table(changed, life.part_lives(changed, {})).iloc[0]
        assert row["faster_mm_per_1000h"] == pytest.approx(rate, nan_ok=True)
        said = life_findings.life_sentence(row, False)
        assert ("mm loses more, 10 mm per 1,000 h, and is left out" in said) == np.isfinite(rate)


def test_a_place_that_is_thinner_as_built_than_what_shall_remain_is_told(lives):
    """Its thickness is known: that is not why it has no life; nor of a part that is so thin all over."""
    part = SyntheticPart("liner", (1e-5, 1e-6, 5e-7))
    runs, _, _ = lives(with_rule(replace(ONE, parts=(part,)), change_out_remaining_m=0.01))
    left_out = "the 8.0 mm that it has as built are no more than what shall remain"
    for thin, words in (((0,), left_out), (range(3), life.TOO_THIN)):
        thickness = runs.patches["thickness_m"].where(~runs.patches["patch"].isin(thin), 0.008)
        changed = replace(runs, patches=runs.patches.assign(thickness_m=thickness))
        row = life_tables.life_table(changed, life.part_lives(changed, {})).iloc[0]
        said = life_findings.life_sentence(row, False)
        assert words in said and "its thickness is not known" not in said


def test_part_that_nothing_wears_has_no_life(lives):
    """Its reason is another one."""
    table = lives(replace(ONE, parts=(UNIFORM, SyntheticPart("shelf", (0.0, 0.0)))))[2]
    assert table.set_index("part").loc["shelf", "reason"] == life.NO_WEAR


@pytest.mark.parametrize("recession", [((1e-9, 0.0), (0.0, 0.0), (0.0, 0.0)), ((1e-9, 0.0), (0.0, 1e-9), (1e-9, 0.0))])
def test_part_that_some_packings_do_not_wear_has_no_life(lives, recession):
    """One packing's hit is no life of all, whichever places are hit; the tables are there all the same."""
    runs = [
        SyntheticRun(f"p-{k}", (UNIFORM, SyntheticPart("hood", each)), setting="p", packing=k)
        for k, each in enumerate(recession, start=1)
    ]
    table = lives(*runs)[2].set_index("part")
    assert table.loc["hood", "reason"] == life.RARE and np.isnan(table.loc["hood", "life_h"])
    assert table.loc["liner", "life_h"] > 0.0


# ---------------------------------------------------------------- the worn shape


def test_last_rate_goes_on_from_what_was_worn(lives):
    """300 h at the rate as built, the rest at half of it."""
    part = replace(UNIFORM, worn=0.5)
    row = lives(replace(ONE, parts=(part,), worn=4))[2].iloc[0]
    assert row["how"] == EXTRAPOLATED and row["simulated_h"] == 300.0
    assert row["life_h"] == pytest.approx(300.0 + (THICKNESS - 300.0 * RATE) / (0.5 * RATE), rel=RELATIVE)
    assert row["worn_mm_per_1000h"] == pytest.approx(1.0) and row["pristine_mm_per_1000h"] == pytest.approx(2.0)


def test_what_caps_hold_back_counts_as_lost(lives, tmp_path):
    """The life goes by what the law takes; the depth that is on the surface may lag behind."""
    whole = lives(ONE)[2]["life_h"].iloc[0]
    values = write_study(tmp_path, [ONE])
    for path in (tmp_path / "plain").glob("cycle_*/patches.csv"):
        table = pd.read_csv(path)
        table.assign(depth_m=0.5 * table["depth_m"]).to_csv(path, index=False)
    found = life.part_lives(tables.read_runs(values, tmp_path), {})
    assert found["plain", "liner"].life.value == pytest.approx(whole, rel=RELATIVE)


def test_life_that_the_shape_was_worn_to_is_followed(lives):
    """What is worn through within the updates is not extrapolated: the rate on the worn shape says nothing."""
    part = replace(UNIFORM, worn=100.0)
    row = lives(replace(ONE, parts=(part,), updates=4, stands_for=5000.0))[2].iloc[0]
    assert row["how"] == FOLLOWED and row["life_h"] == pytest.approx(THICKNESS / RATE, rel=RELATIVE)


def test_shape_as_built_alone(lives):
    """Without updates the life is that of the rate as built."""
    row = lives(replace(ONE, updates=0, worn=0))[2].iloc[0]
    assert row["how"] == AS_BUILT and row["life_h"] == pytest.approx(THICKNESS / RATE, rel=RELATIVE)
    assert np.isnan(row[["worn_mm_per_1000h", "worn_over_built"]].to_numpy(float)).all()


@pytest.mark.parametrize(("worn", "share"), [(0, 0.0), (1, 0.25), (3, 0.75), (4, 1.0), (6, 1.0)])
def test_few_blocks_on_the_worn_shape_are_made_up_with_updates(lives, worn, share):
    """The mean rate of four blocks goes on at least: of so many at half the rate as built, and of updates at it."""
    part = replace(UNIFORM, worn=0.5)
    row = lives(replace(ONE, parts=(part,), updates=4, worn=worn))[2].iloc[0]
    rate = (1.0 - 0.5 * share) * RATE
    assert row["how"] == EXTRAPOLATED and row["blocks"] == max(worn, life.LATEST)
    assert row["worn_mm_per_1000h"] == pytest.approx(1e6 * rate)


def test_what_is_left_along_the_operation(lives):
    """Thickness less rate times hours: at each update, and extrapolated to the hours that are asked for."""
    runs, found, _ = lives(ONE)
    left = life_tables.remaining_table(runs, found)
    assert left["operation_h"].tolist() == [0.0, 100.0, 200.0, 300.0, 8000.0]
    assert left["remaining_mm"].tolist() == pytest.approx([30.0 - 2e-3 * hours for hours in left["operation_h"]])
    assert left["how"].tolist() == [life_tables.SIMULATED] * 4 + [life_tables.BEYOND]


def test_what_is_worn_through_has_nothing_left(lives):
    """A faster place at 8,000 h: 0, not less, in the table and in its interval."""
    runs, found, _ = lives(*packings(replace(ONE, parts=(replace(UNIFORM, recession=(5.0 * RATE,)),)), (0.9, 1.0, 1.1)))
    last = life_tables.remaining_table(runs, found).iloc[-1]
    names = ["remaining_mm", "remaining_mm_low", "remaining_mm_high", "least_remaining_mm"]
    assert last["operation_h"] == 8000.0 and last[names].tolist() == [0.0] * 4


def test_wanted_hours_are_told_besides(lives):
    """Between updates by the block's rate, beyond the asked ones by the last; one that is told anyway stands once."""
    wanted = (9000.0, 150.0, 300.0)
    run = replace(ONE, operation={**OPERATION, "told_at_s": [3600.0 * hours for hours in wanted]})
    left = life_tables.remaining_table(*lives(run)[:2])
    assert left["operation_h"].tolist() == [0.0, 100.0, 150.0, 200.0, 300.0, 8000.0, 9000.0]
    assert left["remaining_mm"].tolist() == pytest.approx([30.0 - 2e-3 * hours for hours in left["operation_h"]])
    assert left["how"].tolist() == [life_tables.SIMULATED] * 5 + [life_tables.BEYOND] * 2


def test_hours_that_differ_by_rounding_are_told_once():
    """Those of the last update are summed from shares, the hours asked for are not."""
    asked = {"duration_s": 3600.0 * 2000.0 / 3.0}
    told = life_tables._hours_told(np.array([0.0, 333.333333333, 666.666666]), 666.66666667, asked)
    assert told == pytest.approx([0.0, 333.3333333, 666.6666667])
    assert len(life_tables._hours_told(np.array([0.0, 300.0]), 300.0, asked)) == 3


# ---------------------------------------------------------------- intervals


def test_interval_of_three_packings(lives):
    """Of the logarithm of the life, by Student's t; the coefficient's interval has its own ends, both together more.

    There is one patch: of several alike ones nobody knows which is the worst, and intervals are wider.
    """
    part = replace(UNIFORM, recession=(RATE,), error=0.2)
    factors = (0.9, 1.0, 1.1)
    row = lives(*packings(replace(ONE, parts=(part,)), factors))[2].iloc[0]
    scatter = T_TWO * np.std(np.log(factors), ddof=1) / np.sqrt(3.0)
    middle = THICKNESS / RATE * np.exp(-np.mean(np.log(factors)))
    assert row["life_h"] == pytest.approx(middle, rel=RELATIVE)
    assert [row["scatter_low_h"], row["scatter_high_h"]] == pytest.approx(middle * np.exp([-scatter, scatter]))
    assert [row["coefficient_low_h"], row["coefficient_high_h"]] == pytest.approx([middle / 1.2, middle / 0.8])
    reaches = np.hypot(scatter, np.log([1.2, 1.0 / 0.8]))
    assert [row["life_low_h"], row["life_high_h"]] == pytest.approx(middle * np.exp(reaches * [-1.0, 1.0]))


def test_what_one_packing_alone_would_have_changed_is_told_beside(lives):
    """A jam in the first packing does not decide the life; its place and hours stand in the table."""
    steady, jam = SyntheticPart("liner", (RATE, 1e-3 * RATE)), SyntheticPart("liner", (RATE, 10.0 * RATE))
    first, *others = packings(ONE, (1.0, 1.0, 1.0))
    table = lives(replace(first, parts=(jam,)), *(replace(each, parts=(steady,)) for each in others))[2]
    row = table.iloc[0]
    assert (row["patch"], row["agreement"]) == (0, 1.0)
    assert row["life_h"] == pytest.approx(THICKNESS / RATE, rel=RELATIVE)
    assert (row["earlier_packing"], row["earlier_h"]) == (1, pytest.approx(0.1 * THICKNESS / RATE, rel=RELATIVE))
    assert row["earlier_x_mm"] == pytest.approx(150.0)
    same = lives(*packings(replace(ONE, parts=(steady,)), (0.9, 1.0, 1.1)))[2]
    assert np.isnan(same["earlier_h"].iloc[0])


def test_one_packing_knows_its_own_blocks_alone(lives):
    """Of four blocks or more there is an interval of this run, of fewer the coefficient's alone; packings is 1."""
    part = replace(UNIFORM, error=0.2)
    many = lives(replace(ONE, parts=(part,), scatter=0.1, worn=6))[2].iloc[0]
    assert many["packings"] == 1 and many["scatter_low_h"] < many["life_h"] < many["scatter_high_h"]
    few = lives(replace(ONE, parts=(part,), scatter=0.1, pristine=1, updates=1, worn=1))[2].iloc[0]
    assert np.isnan(few["life_low_h"]) and np.isnan(few["scatter_low_h"])
    assert few["coefficient_high_h"] == pytest.approx(few["life_h"] / 0.8)


def test_error_of_one_packing_is_that_of_the_blocks_behind_its_life():
    """Eight updates and four blocks: of a life that is extrapolated the four count, of one that was followed the eight,
    though never better than all twelve.
    """
    places = np.zeros((9, 1))
    rates = [np.ones((count, 1)) for count in (3, 12, 4)]
    course = life.Course(1, np.arange(0.0, 900.0, 100.0), places, *rates)
    assert course.variance(1e9) == pytest.approx(1.0 / 4.0, rel=1e-5)
    assert course.variance(800.0) == pytest.approx(1.0 / 8.0)
    assert course.variance(1000.0) == pytest.approx(max(0.8**2 / 8.0 + 0.2**2 / 4.0, 1.0 / 12.0))
    as_built = life.Course(1, np.zeros(1), places[:1], rates[0], np.empty((0, 1)), rates[0])
    assert as_built.variance(800.0) == pytest.approx(1.0 / 3.0)


def test_interval_of_one_packing_holds_its_life():
    """Of forty runs of one place whose blocks scatter by 20 %, fewer than 33 intervals that hold it are too few."""
    rng, held = np.random.default_rng(5), 0
    for _ in range(40):
        pristine, wearing, worn = (RATE * (1.0 + 0.2 * rng.standard_normal((count, 1))) for count in (4, 6, 4))
        hours = 500.0 * np.arange(7)
        lost = np.vstack([np.zeros((1, 1)), np.cumsum(500.0 * wearing, axis=0)])
        course = life.Course(1, hours, lost, pristine, np.vstack([wearing, worn]), worn)
        low, high = life._life(np.zeros(1, dtype=int), np.array([THICKNESS]), [course], 0.0).ends()
        held += low <= THICKNESS / RATE <= high
    assert held >= 33  # fewer of 40 come once in 10,000 times where each interval holds at 95 %


@pytest.mark.verify
def test_interval_holds_the_life_as_often_as_it_says(lives):
    """Of twenty studies of three packings 95 % of the intervals hold the life; of fewer than 15 something is wrong."""
    held = 0
    rng = np.random.default_rng(7)
    for _ in range(20):
        factors = np.exp(0.2 * rng.standard_normal(3))
        row = lives(*packings(replace(ONE, pristine=1, updates=0, worn=0), factors))[2].iloc[0]
        held += row["life_low_h"] <= THICKNESS / RATE <= row["life_high_h"]
    assert held >= 15  # fewer of 20 come once in 3,000 times where each interval holds at 95 %


# ---------------------------------------------------------------- steel


def test_steel_that_is_lost(lives):
    """Density times area times recession; until the change all of the thickness of an even liner."""
    runs, found, _ = lives(ONE)
    row = life_tables.steel_table(runs, found).iloc[0]
    per_hour = DENSITY * 4 * SIDE**2 * RATE
    assert row["pristine_kg_per_h"] == pytest.approx(per_hour)
    assert row["pristine_kg_per_Mt"] == pytest.approx(per_hour / (50.0 * 3600.0 / 1e9))
    assert row["until_change_kg"] == pytest.approx(DENSITY * 4 * SIDE**2 * THICKNESS)
