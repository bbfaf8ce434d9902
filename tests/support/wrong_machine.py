"""Wrong settings of the small machine: changes, what its sentence says was found, and what it says is allowed."""

from __future__ import annotations

from tests.support.own_machine_project import SETTINGS

TURNS = {"kind": "rotation", "point_mm": [60, 0, -220], "axis": [0, 1, 0], "speed_rpm": 60}
FILLING = {"fraction": 0.2, "axis": "y", "centre_mm": [0, 0, -280], "radius_mm": 60, "length_mm": 80}
ONLY_FILLED = {"inlet": None, "outlets": None, "filling": FILLING}
SLICE = {"axis": "y", "low_mm": -50, "high_mm": 50}
DOMAIN = {"low_mm": [-600, -300, -500], "high_mm": [600, 300, 300]}
BLOCK_S = SETTINGS["sampling"]["block_s"]
SWINGS = {"kind": "oscillation", "amplitude_mm": [0, 0, 1]}
LONG = "l" * 101


def motion(**changes):
    """Changes of the study by which its plate moves."""
    return {"parts": {"plate": {"motion": changes}}}


PARTS = [
    ({"ledger": "dumps"}, "ledger is 'dumps'", "solver for equipment"),
    ({"parts": {LONG: SETTINGS["parts"]["hood"]}}, f"parts.{LONG} is", "a name of at most 100 letters, found 101"),
    ({"outlets": {LONG: SETTINGS["outlets"]["below"]}}, f"outlets.{LONG} is", "at most 100 letters, found 101"),
    (
        {"parts": {name: {"role": "rigid"} for name in ("liner", "plate", "paddle")}},
        "parts is a block of keys",
        "one part or more with role: wears, found none",
    ),
    (
        {"parts": {"plate": {"file": "liner.stl", "solid": "b"}, "liner": {"solid": "b"}}},
        "parts.plate.solid is 'b'",
        "a solid of its own, that one is parts.liner",
    ),
    (
        {"parts": {"plate": {"file": "./liner.stl", "solid": "b"}, "liner": {"solid": "b"}}},
        "parts.plate.solid is 'b'",
        "a solid of its own, that one is parts.liner",
    ),
    ({"inlet": {"normal": [0, 0, 1e-200]}}, "inlet.normal is", "a direction: three numbers that are not all 0"),
    (
        {"parts": {"plate": {"file": "liner.stl"}, "liner": {"solid": "b"}}},
        "parts.plate.file is 'liner.stl'",
        "without it all bodies are, and solid b is parts.liner already",
    ),
    (
        {"parts": {"plate": {"file": "liner.stl", "solid": "b"}}},
        "parts.liner.file is 'liner.stl'",
        "parts.liner.solid, the body that is meant",
    ),
    (
        {"parts": {"plate": {"file": "liner.stl"}}},
        "parts.plate.file is 'liner.stl'",
        "a file of its own, that one is parts.liner",
    ),
    *(
        (
            {"parts": {"hood": {key: value}}},
            f"parts.hood.{key} is",
            "none for a part with role: rigid, which does not wear, or role: wears",
        )
        for key, value in (
            ("wear_coefficient_per_pa", 1e-12),
            ("wear_coefficient_error", 0.1),
            ("law", "archard"),
        )
    ),
    (
        {"parts": {"liner": {"thickness_mm": 20}}},
        "parts.liner.edge_mm is 25",
        "at most 20 mm, its thickness_mm: a liner that is thinner than an element would be worn through",
    ),
]

MOTIONS = [
    (
        motion(kind="rotation", axis=[0, 1, 0], speed_rpm=5),
        "parts.plate.motion.point_mm is missing",
        "rotation with point_mm, axis, speed_rpm, and as you like start_s, ramp_s, stop_s",
    ),
    (
        motion(kind="oscillation", amplitude_mm=[0, 0, 1]),
        "parts.plate.motion.period_s is missing",
        "and as you like phase",
    ),
    (motion(kind="belt"), "parts.plate.motion.velocity_m_per_s is missing", "belt with velocity_m_per_s"),
    (
        motion(kind="translation", velocity_m_per_s=[1, 0, 0], speed_rpm=5),
        "parts.plate.motion.speed_rpm is 5",
        "none for the kind translation, which has velocity_m_per_s, and as you like start_s, ramp_s, stop_s",
    ),
    (
        motion(kind="belt", velocity_m_per_s=[1, 0, 0], start_s=1),
        "parts.plate.motion.start_s is 1",
        "none for the kind belt, which has velocity_m_per_s",
    ),
    (
        motion(**{**TURNS, "axis": [0, 0, 0]}),
        "parts.plate.motion.axis is [0, 0, 0]",
        "numbers that are not all 0, or a part without motion",
    ),
    (
        motion(**{**TURNS, "axis": [0, 1e-300, 0]}),
        "parts.plate.motion.axis is [0, 1e-300, 0]",
        "numbers that are not all 0 or nearly, or a part without motion",
    ),
    (
        motion(**{**TURNS, "speed_rpm": 0}),
        "parts.plate.motion.speed_rpm is 0",
        "a number other than 0, or a part without",
    ),
    (
        motion(**{**TURNS, "speed_rpm": 1e-9}),
        "parts.plate.motion.speed_rpm is 1e-09",
        "a number other than 0 or nearly, or a part without",
    ),
    (
        motion(kind="translation", velocity_m_per_s=[0, 1e-11, 0]),
        "parts.plate.motion.velocity_m_per_s is [0, 1e-11, 0]",
        "numbers that are not all 0 or nearly",
    ),
    (
        motion(kind="translation", velocity_m_per_s=[0, 0, 0]),
        "parts.plate.motion.velocity_m_per_s is [0, 0, 0]",
        "numbers that are not all 0",
    ),
    (
        motion(kind="belt", velocity_m_per_s=[0, 0, 0]),
        "parts.plate.motion.velocity_m_per_s is",
        "numbers that are not all 0",
    ),
    (
        motion(kind="oscillation", amplitude_mm=[0, 0, 0], period_s=1),
        "parts.plate.motion.amplitude_mm is [0, 0, 0]",
        "numbers that are not all 0",
    ),
    (
        motion(kind="angular_oscillation", point_mm=[0, 0, 0], axis=[0, 1, 0], amplitude_deg=0, period_s=1),
        "parts.plate.motion.amplitude_deg is 0",
        "a number other than 0",
    ),
    (
        motion(**TURNS, ramp_s=0.2, stop_s=0.1),
        "parts.plate.motion.stop_s is 0.1",
        "at least 0.2 s, start_s and ramp_s together",
    ),
    (
        motion(**TURNS, stop_s=0),
        "parts.plate.motion.stop_s is 0",
        "above 0 s: the part would never move",
    ),
    (
        motion(**TURNS, stop_s=0.5),
        "parts.plate.motion.stop_s is 0.5",
        "at most start_up.most_s, 0.45 s, or at least the longest that the run may get, 1.35 s: hours are told",
    ),
    (
        motion(**TURNS, ramp_s=0.1, stop_s=0.4),
        "parts.plate.motion.stop_s is 0.4",
        "at most start_up.most_s, 0.45 s, less ramp_s, or at least",
    ),
    (
        {**ONLY_FILLED, "parts": {"plate": {"motion": {**TURNS, "stop_s": 0.4}}, "paddle": {"motion": None}}},
        "parts.plate.motion.stop_s is 0.4",
        "above start_up.most_s, 0.45 s, or none: nothing would move while wear is counted",
    ),
    (
        {**ONLY_FILLED, "parts": {"paddle": {"motion": None}}},
        "parts is a block of keys",
        "a part with a motion where there is neither inlet nor outlet: nothing would move",
    ),
    *(
        (
            motion(kind="oscillation", amplitude_mm=[0, 0, 1], period_s=period),
            f"parts.plate.motion.period_s is {period}",
            "20 time steps to the longest that the run may get",
        )
        for period in (0.002, 2)
    ),
    (
        motion(kind="oscillation", amplitude_mm=[0.003, 0, 0.004], period_s=0.05),
        "parts.plate.motion.amplitude_mm is [0.003, 0, 0.004]",
        "at least 0.00621 mm long at 0.05 s, a hundredth of the smallest diameter or of gravity, found 0.005 mm",
    ),
    (
        motion(kind="oscillation", amplitude_mm=[0, 0.05, 0], period_s=0.15),
        "parts.plate.motion.amplitude_mm is [0, 0.05, 0]",
        "at least 0.0559 mm long",
    ),
    *(
        (
            motion(**SWINGS, period_s=BLOCK_S / swings),
            f"sampling.block_s is {BLOCK_S}",
            f"a whole number of swings of parts.plate, {BLOCK_S / swings:g} s each, within 5 % of the block, such as"
            f" {max(round(swings), 1) * BLOCK_S / swings:.6g} s: the wear",
        )
        for swings in (0.115, 0.94, 1.4, 8.5)
    ),
    (
        motion(**{**TURNS, "speed_rpm": 40}),
        "parts.plate.motion.speed_rpm is 40",
        "at least 44.44 rpm, a turn in the longest that the run may get, 1.35 s: wear would be counted in one attitude",
    ),
    (
        motion(**TURNS, start_s=0.4, ramp_s=0.1),
        "parts.plate.motion.start_s is 0.4",
        "full speed within start_up.most_s, 0.45 s, found 0.5 s",
    ),
]

FEED = [
    ({"inlet": None, "outlets": None}, "inlet is missing", "an inlet, a block `filling`, or both"),
    ({"outlets": None}, "outlets is missing", "one outlet or more where there is an inlet"),
    ({"outlets": None, "periodic": SLICE}, "outlets is missing", "one outlet or more where there is an inlet"),
    ({"outlets": {"below": None}}, "outlets is a block of keys", "one outlet or more where there is an inlet"),
    ({"inlet": {"normal": [0, 0, 0]}}, "inlet.normal is [0, 0, 0]", "a direction: three numbers that are not all 0"),
    (
        {"outlets": {"below": {"normal": [0, 0, 0]}}},
        "outlets.below.normal is [0, 0, 0]",
        "a direction: three numbers that are not all 0",
    ),
    (
        {"inlet": {"velocity_m_per_s": [0, 0, 1]}},
        "inlet.velocity_m_per_s is [0, 0, 1]",
        "more than 0.001 m/s along inlet.normal (0, 0, -1), found -1 m/s; turn the one or the other round",
    ),
    ({"inlet": {"velocity_m_per_s": [1, 0, 0]}}, "inlet.velocity_m_per_s is [1, 0, 0]", "more than 0.001 m/s along"),
    ({"inlet": {"velocity_m_per_s": [0, 0, 0]}}, "inlet.velocity_m_per_s is [0, 0, 0]", "more than 0.001 m/s along"),
    ({"inlet": {"size_mm": [43, 80]}}, "inlet.size_mm is [43, 80]", "sides of at least 43.2 mm, 3 of the largest"),
    (
        {"inlet": {"rate_t_per_h": 15}},
        "inlet.rate_t_per_h is 15",
        "at most 14.31 t/h, which is what can be placed before 80 x 80 mm at 1 m/s; a larger inlet.size_mm or a faster",
    ),
    (
        {**ONLY_FILLED, "filling": {**FILLING, "fraction": 0.45}},
        "filling.fraction is 0.45",
        "at most 0.41, which is what can be placed at once in such a cylinder; an inlet may bring the rest",
    ),
    (
        {**ONLY_FILLED, "filling": {**FILLING, "length_mm": 35}},
        "filling.length_mm is 35",
        "at least 36 mm, 2.5 of the largest particles, as coarse-grained",
    ),
    (
        {**ONLY_FILLED, "filling": {**FILLING, "radius_mm": 17}},
        "filling.radius_mm is 17",
        "at least 18 mm, half of 2.5 of the largest particles",
    ),
]

STILL = {"parts": {"paddle": None}}  # nothing moves

ROOM = [
    (
        {"outlets": {"below": {"size_mm": [900, 14]}}},
        "outlets.below.size_mm is [900, 14]",
        "sides of at least 14.4 mm, the largest particles, as coarse-grained",
    ),
    (
        {**STILL, "outlets": {"below": {"centre_mm": [0, 0, 345]}}},
        "outlets.below.centre_mm is [0, 0, 345]",
        "a place below z = 254.",  # 160 mm, 3 diameters of 14.4 mm and 1 m/s upward
    ),
    (
        {**STILL, "outlets": {"below": {"normal": [0, 0, 1]}}},
        "outlets.below.normal is [0, 0, 1]",
        "whither material leaves: it falls, against the normal it would not be counted; turn it round",
    ),
    (
        {"outlets": {"again": {**SETTINGS["outlets"]["below"], "centre_mm": [300, 0, -345.5]}}},
        "outlets.again.centre_mm is [300, 0, -345.5]",
        "mm before or behind outlets.below, or beside it",  # 1.2 mm, at 10 m/s in a step
    ),
    *(
        (
            {"outlets": {"below": {"centre_mm": [0, 0, height]}}},
            f"outlets.below.centre_mm is [0, 0, {height}]",
            "does not cut through the room behind the inlet, in which particles are placed: they would leave",
        )
        for height in (161, 200)
    ),
    (
        {"filling": {**FILLING, "centre_mm": [0, 0, -320]}},
        "filling.centre_mm is [0, 0, -320]",
        "does not stand out through outlets.below, as it does by 35 mm",
    ),
    (
        {"periodic": {**SLICE, "axis": "z"}},
        "periodic.axis is 'z'",
        "x or y: along z material would fall for ever",
    ),
    (
        {"periodic": {**SLICE, "high_mm": -60}},
        "periodic.high_mm is -60",
        "at least -14 mm, periodic.low_mm and 2.5 of the largest particles, as coarse-grained",
    ),
    ({"periodic": {**SLICE, "high_mm": -15}}, "periodic.high_mm is -15", "at least -14 mm, periodic.low_mm and 2.5 of"),
    (
        {"domain": {**DOMAIN, "high_mm": [600, -310, 300]}},
        "domain.high_mm is [600, -310, 300]",
        "above domain.low_mm by more than",
    ),
    (
        {"domain": {**DOMAIN, "high_mm": [-500, 300, -400]}},
        "domain.high_mm is [-500, 300, -400]",
        "along x and z, the room at both ends in which particles count as strays",
    ),
    (
        {"domain": {**DOMAIN, "high_mm": [600, 300, 200]}},
        "inlet.centre_mm is [-60, 0, 160]",
        "does not stand out of domain, -500 mm to 200 mm along z, as it does by 3.2 mm",
    ),
    (
        {"periodic": {**SLICE, "low_mm": -30}},
        "inlet.centre_mm is [-60, 0, 160]",
        "a place from which the room behind it, in which particles are placed, does not stand out of periodic, -30 mm"
        " to 50 mm along y, as it does by 10 mm",
    ),
    (
        {**ONLY_FILLED, "periodic": {**SLICE, "high_mm": 30}},
        "filling.centre_mm is [0, 0, -280]",
        "the cylinder that is filled does not stand out of periodic, -50 mm to 30 mm along y, as it does by 10 mm",
    ),
    (
        {"outlets": {"below": {"centre_mm": [0, 0, -520]}}, "domain": DOMAIN},
        "outlets.below.centre_mm is [0, 0, -520]",
        "does not stand out of domain, -500 mm to 300 mm along z, as it does by 20 mm",
    ),
]

WEAR = [
    ({"wear": {"acceleration": 100}}, "wear.acceleration is 100", "1: each update of the surface stands for hours"),
    (
        {"wear": {"local_thickness_mm": 9}},
        "wear.local_thickness_mm is 9",
        "none: each part has a thickness_mm of its own",
    ),
    ({"wear": {"deform": False}}, "wear.deform is false", "true where the shape is updated (updates.most: 2), or"),
    ({"wear": {"patch": "physical"}}, "wear.patch is 'physical'", "none, simulated or radius, because ore has no"),
    (
        {**ONLY_FILLED, "operation": {"duration_h": None, "throughput_mt": 1}},
        "operation.throughput_mt is 1",
        "operation.duration_h in its place where there is no inlet to count tonnes at",
    ),
    (
        {"operation": {"duration_h": 1e-5}},
        "operation.duration_h is 1e-05",
        f"at least {BLOCK_S / 3600:.3g} h, a block (sampling.block_s)",
    ),
    (
        {"operation": {"duration_h": None, "throughput_mt": 10}},
        "operation.throughput_mt is 10",
        "at most 0.75 Mt, 500000 h at inlet.rate_t_per_h",  # 1.5 t/h
    ),
    (
        {"operation": {"change_out_remaining_fraction": 0.3}},
        "operation.change_out_remaining_fraction is 0.3",
        "one rule of change-out, operation.change_out_remaining_mm is there already",
    ),
    (
        {"operation": {"change_out_worn_mass_fraction": 0.3}},
        "operation.change_out_worn_mass_fraction is 0.3",
        "one rule of change-out, operation.change_out_remaining_mm is there already",
    ),
    (
        {"operation": {"change_out_remaining_mm": 30}},
        "operation.change_out_remaining_mm is 30",
        "at most 29.7 mm, of parts.liner.thickness_mm all but a hundredth",
    ),
    (
        {"parts": {"liner": {"change_out_remaining_mm": 30}}},
        "parts.liner.change_out_remaining_mm is 30",
        "at most 29.7 mm, of parts.liner.thickness_mm all but a hundredth",
    ),
    (
        {"parts": {"liner": {"change_out_remaining_mm": 3, "change_out_remaining_fraction": 0.3}}},
        "parts.liner.change_out_remaining_fraction is 0.3",
        "one rule of change-out, parts.liner.change_out_remaining_mm is there already",
    ),
    (
        {"parts": {"hood": {"change_out_remaining_mm": 3}}},
        "parts.hood.change_out_remaining_mm is 3",
        "none for a part with role: rigid, which does not wear, or role: wears",
    ),
]

EFFORT = [
    (
        {"inlet": {"rate_t_per_h": 0.4}},
        "inlet.rate_t_per_h is 0.4",
        "at least 0.429 t/h, 10 particles in a block, found 9.3; or a longer sampling.block_s",
    ),
    (
        {**ONLY_FILLED, "filling": {**FILLING, "fraction": 0.001}},
        "filling.fraction is 0.001",
        "10 particles or more, found",
    ),
    (
        {"sampling": {"pictures_per_block": 997}},
        "sampling.pictures_per_block is 997",
        "a number that divides 20, or another one that makes no more than 1525 time steps of a block, as this makes",
    ),
    (
        {"sampling": {"patch_mm": 29}, "parts": {"plate": {"edge_mm": 20}}},
        "sampling.patch_mm is 29",
        "at least 30 mm, 2.5 median particles, as coarse-grained",
    ),
    (
        {"sampling": {"patch_mm": 44}, "parts": {"plate": {"edge_mm": 45}}},
        "sampling.patch_mm is 44",
        "at least 45 mm, parts.plate.edge_mm",
    ),
    (
        {"wear": {"patch": "radius", "patch_radius_mm": 30.1}},
        "wear.patch_radius_mm is 30.1",
        "at most 30 mm, half of sampling.patch_mm: a wider patch spreads the wear of each contact over several",
    ),
    ({"sampling": {"fewest_blocks": 4}}, "sampling.fewest_blocks is 4", "at most 3, sampling.most_blocks"),
    ({"sampling": {"block_s": 0.001}}, "sampling.block_s is 0.001", "s, 10 contacts of the largest particles"),
    ({"sampling": {"block_s": 1000}}, "sampling.block_s is 1000", "s in up to 8 blocks: it takes"),
    (
        {"start_up": {"most_s": 9000}},
        "start_up.most_s is 9000",
        "at most 6147 s: it takes 7.3e+07 time steps of 0.00012 s, by its particles of 9.6 mm, at most",
    ),
    (
        {"particle_scale": 1, "start_up": {"most_s": 1000}, "inlet": {"size_mm": [500, 500], "rate_t_per_h": 500}},
        "particle_scale is 1",
        "at least 4.99: a filling, and what comes in within half of start_up.most_s, are about 2.5e+09 particles",
    ),
]
