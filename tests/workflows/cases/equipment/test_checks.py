"""Wrong inputs of equipment that are seen without a drawing: one sentence each, with the key and what is allowed."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.postproc.wear.laws import LAWS, Parameter
from bulkwear.workflows.cases.equipment.checks import (
    EQUIPMENT_CHECKS,
    MOST_PARTICLES,
    MOST_STEPS,
    contact_time,
    walls_of_one_patch,
)
from bulkwear.workflows.cases.equipment.motion_checks import WRITTEN
from bulkwear.workflows.cases.equipment.motions import FREE, NEEDED
from bulkwear.workflows.cases.equipment.placing import (
    DEPTH_DIAMETERS,
    PLACED_FRACTION,
    largest_filling,
    largest_rate,
    normal_velocity,
    placing_room,
)
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.run_checks import check_files
from bulkwear.workflows.engine.solver import cycle_fault
from tests.support.law_cases import LONG_SLIP, long_slip_registered
from tests.support.own_machine_project import FASTER, SETTINGS, machine_study
from tests.support.wrong_machine import (
    BLOCK_S,
    DOMAIN,
    EFFORT,
    FEED,
    FILLING,
    MOTIONS,
    ONLY_FILLED,
    PARTS,
    ROOM,
    SLICE,
    STILL,
    SWINGS,
    TURNS,
    WEAR,
    motion,
)

FILE = "config/studies/machine.yaml"
TABLE = "config/designs/machine.csv"
LARGEST_MM = 14.4  # of the ore: 1.2 times 3 mm, at a particle scale of 4
SLOW = {**TURNS, "speed_rpm": 1}


@pytest.mark.parametrize(
    ("patch", "types", "refused"),
    [("physical", (2, 3), True), ("physical", (2, 4), False), ("simulated", (2, 3), False)],
)
def test_one_factor_of_contact_patches_is_for_walls_of_one_modulus(patch, types, refused):
    """Steel and perspex that both wear have none in common; two steels have."""
    walls = [("steel", 78e9), ("perspex", 0.1e9), ("mild_steel", 78e9)]
    walls = [{"name": name, "shear_modulus_pa": modulus, "poissons_ratio": 0.3} for name, modulus in walls]
    parts = [{"wears": True, "type": kind} for kind in types] + [{"wears": False, "type": 3}]
    run = SimpleNamespace(settings={"wear": {"patch": patch}}, parameters={"walls": walls, "parts": parts})
    fault = walls_of_one_patch(run)
    assert (fault is not None) == refused
    assert not refused or (fault[0] == "wear.patch" and "as steel and perspex" in fault[1])


def message_of(folder, rows="row\nA\n", **changes) -> str:
    with pytest.raises(ConfigError) as caught, machine_study(folder, rows, **changes):
        pass
    return str(caught.value)


@pytest.mark.parametrize(("changes", "found", "allowed"), [*PARTS, *MOTIONS, *FEED, *ROOM, *WEAR, *EFFORT])
def test_a_wrong_input_is_named_with_its_key_and_what_is_allowed(tmp_path, changes, found, allowed):
    """One fault gives one sentence: file, key, what was found, for which row, what is allowed."""
    message = message_of(tmp_path, **changes)
    assert f": {found} " in f"{message} " and " for row A, allowed is " in message, message
    assert allowed in message.split(", allowed is ", 1)[1], message
    assert message.startswith("config/") and message.endswith(".") and "\n" not in message and ". " not in message


def test_what_a_row_asks_for_is_named_with_its_line(tmp_path):
    """A tonnage of the design that is too high for the inlet: the second row, not the study."""
    message = message_of(tmp_path, "row,inlet.rate_t_per_h\nlow,1\nhigh,20\n")
    assert message.startswith(f"{TABLE}, line 3, row high: inlet.rate_t_per_h is 20, allowed is at most 14.31 t/h")


def test_what_is_wrong_with_a_drawing_of_a_row_is_named_with_it(tmp_path):
    """The second row's drawing has no body of the name that the study asks for."""
    rows = "row,parts.liner.file\nA,\nB,plate.stl\n"
    words = r"^study machine, row B: parts\.liner\.solid is 'liner', allowed is one of plate\.$"
    with (
        machine_study(tmp_path, rows, parts={"liner": {"solid": "liner"}, "plate": None}) as study,
        pytest.raises(ConfigError, match=words),
    ):
        check_files(study.name, study.case, study.runs)


def test_a_column_of_a_part_that_is_misspelt_is_told_of_the_one_that_is_near(tmp_path):
    """A part that only a design has needs all of its keys."""
    assert message_of(tmp_path, "row,parts.linr.file\nA,liner.stl\n") == (
        "config/designs/machine.csv, line 2, row A: parts.linr.unit is missing, allowed is one of m, mm, cm, um, in, ft"
        " (or was parts.liner meant)."
    )


def test_a_design_may_choose_which_parts_wear(tmp_path):
    """What says how a part wears stands in the study, and a row makes the part rigid."""
    with machine_study(tmp_path, "row,parts.liner.role\nA,\nB,rigid\n") as study:
        assert [run.parameters["parts"][0]["wears"] for run in study.runs] == [True, False]


def test_the_particle_scale_may_be_a_column(tmp_path):
    """It is a setting as any other, though it stands in no block."""
    with machine_study(tmp_path, "row,particle_scale\nA,4\nB,5\n") as study:
        assert [run.parameters["particle"]["scale"] for run in study.runs] == [4, 5]


def test_a_law_of_a_part_finds_its_parameters(tmp_path):
    """Parameters are those of wear.law: another law with parameters is refused for what wears."""
    with long_slip_registered():
        message = message_of(tmp_path, parts={"liner": {"law": "long_slip"}})
        assert "parts.liner.law is 'long_slip' for row A, allowed is wear.law (archard)" in message
        without = ", ".join(name for name, law in LAWS.items() if not law.parameters)
        assert f"or one without any: {without}" in message
        chosen = {"law": "long_slip", "parameters": {"exponent": 2}}
        with machine_study(tmp_path, wear=chosen) as study:
            assert study.runs[0].parameters["parts"][0]["law_parameters"] == {"exponent": 2.0, "length_m": 0.002}


@pytest.mark.parametrize(
    "parameters",
    [
        (Parameter("exponent", "as long_slip has it", 0.5, 3.0, unit="-"), Parameter("share", "of it", 0, 1, unit="-")),
        (Parameter("exponent", "with another range", 2.5, 3.0, unit="-"),),
    ],
)
def test_a_law_of_a_part_finds_all_its_parameters_in_their_range(tmp_path, monkeypatch, parameters):
    """One of them missing beside one that wear.law has too, and one that wear.law allows but the part's does not."""
    monkeypatch.setitem(LAWS, "shares", replace(LONG_SLIP, words="shares.", parameters=parameters, kernels=()))
    with long_slip_registered():
        chosen = {"law": "long_slip", "parameters": {"exponent": 2}}
        message = message_of(tmp_path, wear=chosen, parts={"liner": {"law": "shares"}})
        assert "parts.liner.law is 'shares' for row A, allowed is wear.law (long_slip)" in message


def test_kernels_of_a_part_s_own_law_are_asked_of_the_solver(tmp_path):
    """A program without them is refused before it starts, though wear.law needs none; parts that keep their shape need
    none either.
    """
    with machine_study(tmp_path / "a") as study:
        assert "no contact kernel finnie_work" in cycle_fault(sys.executable, study.case, study.runs[0].parameters)
    rolling = {"rolling_friction": "cdt"}  # LIGGGHTS' own
    with machine_study(tmp_path / "b", "row,parts.plate.role\nA,rigid\n", solver=rolling) as study:
        assert cycle_fault(sys.executable, study.case, study.runs[0].parameters) is None


def test_a_drawing_that_is_not_there_is_named_with_its_part(tmp_path):
    message = message_of(tmp_path, parts={"plate": {"file": "gone.step"}})
    assert "machine.yaml, line 19: parts.plate.file: meshes/gone.step: there is no such file" in message


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {**ONLY_FILLED},
        {"filling": FILLING},
        {"periodic": SLICE},
        {"domain": DOMAIN},
        {"updates": {"most": 0}, "wear": {"deform": False}, "parts": FASTER},
        {"operation": {"duration_h": None, "throughput_mt": 0.01}},
        {"operation": {"change_out_remaining_mm": None, "change_out_worn_mass_fraction": 0.3}},
        {"parts": {"liner": {"edge_mm": 30, "thickness_mm": 30}}},
        {"parts": {"liner": {"change_out_worn_mass_fraction": 0.3}}},
        {"parts": {"liner": {"change_out_remaining_mm": 5}}, "operation": {"change_out_remaining_mm": 30}},
        {"parts": {"hood": {"thickness_mm": 1}}},
        STILL,
        {**STILL, "outlets": {"side": {"centre_mm": [400, 0, 345], "normal": [1, 0, 0], "size_mm": [900, 800]}}},
        {"sampling": {"pictures_per_block": 7}},
        {"wear": {"patch": "radius", "patch_radius_mm": 30}},
        {"wear": {"patch_radius_mm": 100}},  # which counts for nothing: the patch is the simulated one
        *(
            {"outlets": {"other": {**SETTINGS["outlets"]["below"], "centre_mm": centre}}}
            for centre in ([0, 0, -347], [900, 0, -345], [900, 0, 180])
        ),
        {"inlet": {"normal": [0, 0, -5], "velocity_m_per_s": [3, 0, -0.5]}},
        {
            "parts": {"hood": None, "inlet": SETTINGS["parts"]["hood"]},
            "outlets": {"below": None, "liner": SETTINGS["outlets"]["below"]},
        },
        *(motion(**given) for given in ({**TURNS, "ramp_s": 0.2}, {"kind": "belt", "velocity_m_per_s": [0, 1, 0]})),
        *(motion(**SWINGS, period_s=BLOCK_S / swings) for swings in (1, 3, 0.96, 10.5)),
        motion(**{**TURNS, "speed_rpm": 1, "stop_s": 0.4}),
        {"parts": {"plate": {"role": "rigid", "law": None, "wear_coefficient_per_pa": None, "motion": SLOW}}},
        {"parts": {"plate": {"motion": {**SLOW, "kind": "turning_surface"}}}},
    ],
)
def test_what_is_right_passes(tmp_path, changes):
    """Feed, filling or both, slices, domains, rules, motions and any names: nothing is refused."""
    with machine_study(tmp_path, **changes) as study:
        assert len(study.runs) == 1


def test_the_motion_of_every_kind_needs_its_keys():
    """Keys of motions are told as a study writes them."""
    needed = {name for kind in NEEDED for name in (*NEEDED[kind], *FREE.get(kind, ()))}
    assert not {name for name in needed if name.endswith(("_m", "_rad", "rad_per_s"))} - set(WRITTEN)


def test_every_check_says_what_it_is_for():
    """The page of keys lists the checks in one sentence each."""
    said = [" ".join(check.__doc__.split()) for check in EQUIPMENT_CHECKS]
    assert len(set(said)) == len(said) and all(text.endswith(".") for text in said)


# ---------------------------------------------------------------- closed forms behind the limits


def test_largest_feed_is_what_is_placed_in_a_stream(tmp_path):
    """Solid fraction of rectangle less half a diameter, times normal velocity and density; oblique feeds count less."""
    with machine_study(tmp_path, inlet={"velocity_m_per_s": [3, 0, -0.5]}) as study:
        run = study.runs[0].parameters
    area = ((80 - 0.5 * LARGEST_MM) / 1e3) ** 2
    assert normal_velocity(run["inlet"]) == 0.5
    assert largest_rate(run) == pytest.approx(PLACED_FRACTION * area * 0.5 * 2500)
    room = placing_room(run)
    assert room[:4, 2] == pytest.approx(0.16) and room[4:, 2] == pytest.approx(
        0.16 + DEPTH_DIAMETERS * LARGEST_MM / 1e3
    )


def test_largest_filling_counts_bulk_volume(tmp_path):
    """Fraction of solids over that of the bulk material, less a diameter at the ends."""
    with machine_study(tmp_path, **ONLY_FILLED) as study:
        run = study.runs[0].parameters
    assert largest_filling(run) == pytest.approx(PLACED_FRACTION / 0.6 * (1 - LARGEST_MM / 80))


def test_a_contact_lasts_as_long_as_hertz_says(tmp_path):
    """2.87 (m*^2 / (R* E*^2 v))^(1/5), of two equal spheres."""
    with machine_study(tmp_path) as study:
        run = study.runs[0].parameters
    radius = LARGEST_MM / 2e3
    mass = 2500 * 4 / 3 * math.pi * radius**3 / 2
    modulus = 2 * 4e6 * 1.24 / (1 - 0.24**2) / 2
    assert contact_time(run) == pytest.approx(2.87 * (mass**2 / (radius / 2 * modulus**2 * 1.0)) ** 0.2)


def test_start_up_lasts_as_long_as_a_fall_to_an_outlet(tmp_path):
    """By Galileo from 160 mm to -345 mm, and to the higher one of two outlets; two blocks are always part of it.

    Not where a part moves, which may throw material down, nor in a machine that is filled before.
    """
    fall_s = (math.sqrt(1.0 + 2.0 * GRAVITY * 0.505) - 1.0) / GRAVITY
    short = {"start_up": {"most_s": 0.5 * fall_s}, "sampling": {"block_s": 0.3 * fall_s}}
    for number, outlets in enumerate(({}, {"far": {**SETTINGS["outlets"]["below"], "centre_mm": [0, 0, -900]}})):
        words = message_of(tmp_path / f"{number}", **STILL, **short, outlets=outlets)
        assert f"start_up.most_s is {0.5 * fall_s:.10g} for row A, allowed is at least " in words
        assert " s, which a free fall from the inlet to outlets.below takes: wear would be counted before " in words
        least = float(words.split("allowed is at least ")[1].split(" ")[0])
        assert fall_s <= least < fall_s + 1e-3
    still = {**STILL, "inlet": {"rate_t_per_h": 10}}
    enough = [{**still, **short, "start_up": {"most_s": least}}, {**still, "start_up": {"most_s": 0.5 * fall_s}}]
    throws = motion(kind="belt", velocity_m_per_s=[0, 1, 0])["parts"]
    thrown = {**short, "inlet": still["inlet"], "parts": {"paddle": None, **throws}}
    for number, changes in enumerate((*enough, thrown, {**still, **short, "filling": FILLING})):
        with machine_study(tmp_path / f"right_{number}", **changes) as study:
            assert study.runs


def test_limits_of_effort_are_met_where_they_say(tmp_path):
    """What a message allows is allowed."""
    few = {"updates": {"most": 0}, "sampling": {"block_s": 1000, "fewest_blocks": 1, "most_blocks": 1}}
    assert "start_up.most_s is 9000 for row A, allowed is at most 5000 s:" in message_of(
        tmp_path, **few, start_up={"most_s": 9000}
    )
    with machine_study(tmp_path, **few, start_up={"most_s": 5000}) as study:
        derived = study.runs[0].parameters["derived"]
    assert 0.9 * MOST_STEPS < derived["run_in_steps"] + derived["travel_steps"] <= MOST_STEPS
    fed = {"inlet": {"size_mm": [500, 500], "rate_t_per_h": 500}, "start_up": {"most_s": 1000}}
    with machine_study(tmp_path, particle_scale=5.0, **fed) as study:
        assert 0.9 * MOST_PARTICLES < study.runs[0].parameters["derived"]["held_particles"] <= MOST_PARTICLES
