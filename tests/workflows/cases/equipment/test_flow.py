"""The flow of blocks from what the solver printed: sums over blocks, the balance, and where particles were lost."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.equipment import flow
from bulkwear.workflows.cases.equipment.parameters import drawn_mass_scatter, filled_mass

MASS = 0.5  # kg, of a particle
ROUND_OFF = 1e-12
COLUMNS = "id x y z vx vy vz omegax omegay omegaz radius"
HELD = ("time_s", "particles", "held_mass_kg", "fed_particles", "fed_mass_kg", "kinetic_energy_J")


def run_of(outlets=("below",), moving=("screw",)):
    """Parameters of a machine with a part that moves and one that does not; two reports of 0.1 s in a block."""
    parts = [{"name": name, "motion": {"kind": "belt"}} for name in moving] + [{"name": "hood", "motion": None}]
    return {
        "parts": parts,
        "outlets": {name: {} for name in outlets} or None,
        "derived": {"report_steps": 100, "time_step_s": 1e-3},
    }


def write_block(run, folder, number, rows, filled=0, ended=".part"):
    """Write flow.txt of a block; rows: (particles, fed so far, {outlet: (mass so far, particles in the block)})."""
    block = folder / f"cycle_{number:03d}{ended}"
    block.mkdir(parents=True)
    outlets = list(run["outlets"] or {})
    header = [*HELD, *(f"out_{name}_{what}" for name in outlets for what in ("mass_kg", "particles"))]
    header += ["filled_particles", "filled_mass_kg"] if number == 0 else ["screw_work_J", "hood_work_J"]
    lines = [" ".join(header)]
    for k, (particles, fed, out) in enumerate(rows, start=1):
        values = [0.1 * (2 * number + k), particles, MASS * particles, fed, MASS * fed, 0.25 * particles]
        values += [value for name in outlets for value in (MASS * out[name][0], out[name][1])]
        values += [filled, MASS * filled] if number == 0 else [3.0 * k**2, 0.0]
        lines.append(" ".join(map(repr, values)))
    (block / flow.PRINTED).write_text("\n".join(lines) + "\n")
    return block


def finish(block):
    return block.rename(block.with_suffix(""))


@pytest.fixture
def three_blocks(tmp_path):
    """A machine filled with 7 particles and fed 5 in each row; a sieve lets 1 through in each row, below 2 leave."""
    run, blocks, held = run_of(("below", "sieve")), [], 7
    fed = 0
    below = sieve = 0
    for number in range(3):
        rows = []
        for k in (1, 2):
            fed, below, sieve, held = fed + 5, below + 2, sieve + 1, held + 2
            rows.append((held, fed, {"below": (below, 2 * k), "sieve": (sieve, k)}))
        blocks.append(finish(write_block(run, tmp_path, number, rows, filled=7)))
    return run, blocks


def test_counts_go_on_over_blocks(three_blocks):
    """The solver counts particles of an outlet anew in every block, masses and the feed since the run began."""
    run, blocks = three_blocks
    tables = [flow.flow_table(run, block) for block in blocks]
    whole = pd.concat(tables, ignore_index=True)
    assert whole["time_s"].tolist() == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], rel=ROUND_OFF)
    assert whole["inserted_particles"].tolist() == [12, 17, 22, 27, 32, 37]
    assert whole["inserted_mass_kg"].tolist() == [MASS * count for count in whole["inserted_particles"]]
    assert whole["out_particles"].tolist() == [3, 6, 9, 12, 15, 18]
    assert whole["out_below_mass_kg"].tolist() == [MASS * count for count in (2, 4, 6, 8, 10, 12)]
    assert whole["out_sieve_mass_kg"].tolist() == [MASS * count for count in (1, 2, 3, 4, 5, 6)]
    assert whole["out_mass_kg"].tolist() == [MASS * count for count in whole["out_particles"]]
    assert (whole["inserted_particles"] - whole["out_particles"] == whole["particles"]).all()
    assert [flow.lost_particles(table) for table in tables] == [0, 0, 0]


def test_power_is_the_work_between_reports(three_blocks):
    """Of parts that move, 3 J and then 9 J in a tenth of a second; the first block has no ledger to tell it."""
    run, blocks = three_blocks
    tables = [flow.flow_table(run, block) for block in blocks]
    assert [table.filter(like="power").columns.tolist() for table in tables] == [[], *[["power_screw_W"]] * 2]
    assert tables[2]["power_screw_W"].tolist() == pytest.approx([30.0, 90.0], rel=ROUND_OFF)


def test_whole_flow_is_all_blocks_by_their_numbers(three_blocks):
    """The unfinished one behind the others; tables that are missing are made once."""
    run, blocks = three_blocks
    last = flow.flow_table(run, blocks[2])
    made = blocks[1] / flow.FLOW
    found = flow.whole_flow(blocks[0].parent, run, 1, last)
    assert found["cycle"].tolist() == [0, 0, 1, 1, 2, 2] and made.exists()
    assert found["out_particles"].tolist() == [3, 6, 9, 12, 15, 18]
    made.write_text(made.read_text().replace("0.4", "0.44"))
    assert flow.whole_flow(blocks[0].parent, run, 1)["time_s"].iloc[-1] == 0.44


def test_machine_without_outlets_holds_what_it_was_filled_with(tmp_path):
    """Nothing leaves; what it was filled with came in."""
    run = run_of(outlets=())
    block = write_block(run, tmp_path, 0, [(9, 0, {}), (9, 0, {})], filled=9)
    table = flow.flow_table(run, block)
    assert table["inserted_particles"].tolist() == [9, 9] and table["out_particles"].tolist() == [0, 0]
    assert not [
        name for name in table if name.startswith("out_") and name.endswith("_mass_kg") and name != "out_mass_kg"
    ]
    assert flow.lost_phrase(run, block, table) is None


# ---------------------------------------------------------------- lost particles


def dump(path, frames):
    """Write a text dump; frames: {step: rows as of `particle`}."""
    lines = []
    for step, rows in frames.items():
        lines += ["ITEM: TIMESTEP", str(step), "ITEM: NUMBER OF ATOMS", str(len(rows)), "ITEM: BOX BOUNDS ff ff ff"]
        lines += ["-1 1"] * 3 + [f"ITEM: ATOMS {COLUMNS} ", *(" ".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n")


def particle(number, place, velocity=(0.1, 0.0, -2.0)):
    return (number, *place, *velocity, 0.0, 0.0, 0.0, 0.01)


def test_lost_particles_are_named_with_their_last_place(tmp_path):
    """Two of those that were seen near the domain's faces are gone, one came back."""
    run = run_of()
    finish(write_block(run, tmp_path, 0, [(5, 5, {"below": (0, 0)})] * 2))
    block = write_block(run, tmp_path, 1, [(8, 10, {"below": (0, 0)})] * 2)
    dump(block / "picture_200.dump", {200: [particle(k, (0, 0, 0)) for k in range(1, 11)]})
    dump(block / "picture_1000.dump", {1000: [particle(k, (0, 0, 0)) for k in range(1, 9)]})
    frames = {
        200: [particle(9, (0.1, 0.2, -0.2)), particle(3, (0.5, 0.0, 0.0))],
        400: [particle(9, (0.1, 0.2, -0.4)), particle(10, (0.9, 0.0, 0.0), (3.0, 0.0, -1.0))],
    }
    dump(block / flow.STRAYS, frames)
    assert flow.lost_phrase(run, block, flow.flow_table(run, block)) == (
        "2 particles are missing in the balance of what came in, is there and left through outlets, allowed is none: "
        "last seen at (100, 200, -400) mm, going -z; last seen at (900, 0, 0) mm, going +x; "
        "close the gap there, or put an outlet there"
    )


def test_machine_that_lost_all_its_particles(tmp_path):
    """A picture of none and a block without a look at strays."""
    run = run_of()
    block = write_block(run, tmp_path, 0, [(0, 2, {"below": (0, 0)})] * 2)
    dump(block / "picture_400.dump", {400: []})
    dump(block / flow.STRAYS, {200: [particle(2, (0.0, -0.7, 0.0), (0.0, -1.0, 0.5))], 400: []})
    assert "(0, -700, 0) mm, going -y" in flow.lost_phrase(run, block, flow.flow_table(run, block))
    (block / flow.STRAYS).write_text("")
    assert "none of them was seen" in flow.lost_phrase(run, block, flow.flow_table(run, block))


def test_places_are_those_of_the_latest_picture(tmp_path):
    """Pictures are in the order of their steps, not of their names."""
    run = run_of()
    block = write_block(run, tmp_path, 0, [(1, 2, {"below": (0, 0)})] * 2)
    for step, there in ((900, (1, 2)), (1000, (1,))):
        dump(block / f"picture_{step}.dump", {step: [particle(k, (0, 0, 0)) for k in there]})
    dump(block / flow.STRAYS, {800: [particle(2, (0.0, -0.7, 0.0), (0.0, -1.0, 0.5))]})
    assert [path.name for path in flow.pictures_of(block)] == ["picture_900.dump", "picture_1000.dump"]
    phrase = flow.lost_phrase(run, block, flow.flow_table(run, block))
    assert phrase.startswith("1 particle is missing") and "(0, -700, 0) mm, going -y" in phrase


def test_what_the_first_block_lost_is_named_in_the_second(tmp_path):
    """Whose balance is the first one that is made."""
    run = run_of()
    first = write_block(run, tmp_path, 0, [(4, 5, {"below": (0, 0)})] * 2)
    dump(first / flow.STRAYS, {200: [particle(5, (0.0, 0.0, -0.9))]})
    finish(first)
    block = write_block(run, tmp_path, 1, [(9, 10, {"below": (0, 0)})] * 2)
    dump(block / "picture_400.dump", {400: [particle(k, (0, 0, 0)) for k in range(1, 5)]})
    dump(block / flow.STRAYS, {400: []})
    assert "(0, 0, -900) mm, going -z" in flow.lost_phrase(run, block, flow.flow_table(run, block))


def test_particles_that_were_never_seen_are_counted_all_the_same(tmp_path):
    """Lost or too many, without a place."""
    run = run_of()
    block = write_block(run, tmp_path, 0, [(4, 5, {"below": (0, 0)})] * 2)
    assert "none of them was seen" in flow.lost_phrase(run, block, flow.flow_table(run, block))
    more = write_block(run, tmp_path / "more", 0, [(7, 5, {"below": (0, 0)})] * 2)
    dump(more / "picture_400.dump", {400: [particle(1, (0, 0, 0))]})
    dump(more / flow.STRAYS, {200: [], 400: []})
    assert flow.lost_phrase(run, more, flow.flow_table(run, more)).startswith("2 particles are too many")


@pytest.mark.parametrize(("found", "refused"), [(1000, False), (920, False), (900, True), (1100, True)])
def test_a_machine_that_is_not_filled_as_asked_is_refused(tmp_path, found, refused):
    """Of a thousand particles of two sizes half a kilogram each on average, drawn by number, within four standard
    deviations: masses of 1 and 1/4 kg, two of the small to one of the large, scatter by 0.354 kg, a thousand of them by
    11.2 kg.
    """
    diameters = [(6.0 * mass / (np.pi * 2000.0)) ** (1.0 / 3.0) for mass in (1.0, 0.25)]
    particle = {"diameters_m": diameters, "mass_fractions": [2 / 3, 1 / 3], "density_kg_per_m3": 2000.0}
    particle["bulk_solid_fraction"] = 0.5
    filling = {"fraction": 0.5, "radius_m": 1.0, "length_m": MASS * 1000 / (0.5 * np.pi * 1000.0)}
    run = run_of() | {"filling": filling, "particle": particle}
    finish(write_block(run, tmp_path, 0, [(found, 0, {"below": (0, 0)})], filled=found))
    assert filled_mass(run) == pytest.approx(500.0)
    assert drawn_mass_scatter(particle, 500.0) == pytest.approx(np.sqrt(1000 / 8.0))
    phrase = flow.filling_phrase(run, tmp_path)
    assert (phrase is not None) == refused
    if refused:
        said = f"the machine is not filled as asked: mass {MASS * found:.4g} kg (asked 500 within 45); its room needs"
        assert phrase.startswith(said)


def test_a_machine_without_a_filling_is_not_asked_for_one(tmp_path):
    """Fed machines begin empty."""
    assert flow.filling_phrase({"filling": None, "particle": {}}, tmp_path) is None
