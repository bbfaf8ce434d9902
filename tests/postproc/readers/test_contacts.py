"""The contact reader on real dumps, whole and spoilt."""

import subprocess
import tracemalloc

import numpy as np
import pytest

from bulkwear.postproc.readers.contacts import (
    CONTACT_FIELDS,
    ContactDumpError,
    read_contact_batches,
    read_contacts,
)
from bulkwear.postproc.readers.dump_text import read_frames
from bulkwear.postproc.wear.ledger import LedgerBuilder
from tests import DATA
from tests.support.patience import LONGEST_S

LAST_DIGIT = 2.3e-16  # one unit in the last place between this parser and Python's float
SIX_DIGITS = 1e-5  # of a number: what the dump's format %g keeps, after a difference of two of them
WORK_TOLERANCE = 1e-4  # of F L: brief of the reader; the dump's six digits and the discrete time are far below
ROLLING_LEFTOVER = 1e-5  # of F L: six digits of the velocity and of the spin, which cancel in rolling
LOAD, TIME_STEP, SETTLING = 5.0, 2e-6, 4000  # N, s, steps: as in sphere_on_plate.in
EFFECTIVE_MODULUS = 1.0 / ((1 - 0.24**2) / 2.48e8 + (1 - 0.3**2) / 2.028e11)  # Pa, as in sphere_on_plate.in
TRIANGLES = 24
SLIDE = DATA / "slide_contacts.dump", DATA / "slide_spins.dump"
BED = DATA / "bed_contacts.dump", DATA / "bed_spins.dump"


def rows_by_hand(path, first_word):
    """Frames of a dump as {step: list of rows}, read with nothing but split and float."""
    frames, rows = {}, None
    lines = iter(path.read_text().splitlines())
    for line in lines:
        if line == "ITEM: TIMESTEP":
            rows = frames[int(next(lines))] = []
        elif line.startswith(f"ITEM: {first_word}"):
            rows.append(None)
        elif rows and rows[0] is None:
            rows.append([float(word) for word in line.split()])
    return {step: rows[1:] for step, rows in frames.items()}


@pytest.mark.parametrize("paths", [SLIDE, BED])
def test_every_number_of_a_real_dump_arrives_in_its_place(paths):
    """Columns as LIGGGHTS writes them: point, centre, velocities, mesh, triangle, particle, force."""
    by_hand, spins = rows_by_hand(paths[0], "ENTRIES"), rows_by_hand(paths[1], "ATOMS")
    frames = list(read_contacts(*paths))
    assert [contacts.step for contacts in frames] == list(by_hand)
    for contacts in frames:
        rows = np.array(by_hand[contacts.step]).reshape(-1, 18)
        spin = {row[0]: row[1:] for row in spins[contacts.step]}
        expected = np.array([spin[particle] for particle in rows[:, 14]]).reshape(-1, 4)
        columns = {
            "contact_point": rows[:, 0:3],
            "centre": rows[:, 3:6],
            "wall_velocity": rows[:, 6:9],
            "particle_velocity": rows[:, 9:12],
            "mesh": rows[:, 12],
            "triangle": rows[:, 13],
            "particle": rows[:, 14],
            "force": rows[:, 15:18],
            "radius": expected[:, 0],
            "angular_velocity": expected[:, 1:4],
            "wall_force": np.full((len(rows), 3), np.nan),
        }
        assert set(columns) == set(CONTACT_FIELDS)
        for name, values in columns.items():
            np.testing.assert_allclose(getattr(contacts, name), values, rtol=LAST_DIGIT, atol=0, err_msg=name)
        assert contacts.triangle.dtype == contacts.mesh.dtype == contacts.particle.dtype == np.int64


def test_the_real_slide_is_the_one_the_deck_describes():
    """5 N on triangles 2 and 4 at 0.5 m/s, friction 1, no spin."""
    frames = list(read_contacts(*SLIDE, after_step=SETTLING))
    assert len(frames) == 15
    for contacts in frames:
        np.testing.assert_allclose(contacts.force[0, 2], LOAD, rtol=SIX_DIGITS)
        assert contacts.force[0, 0] == 0.0
        assert contacts.force[0, 1] < 0.0  # against the motion; LIGGGHTS overestimates it in this dump
        np.testing.assert_allclose(contacts.particle_velocity[0, 1], 0.5, rtol=SIX_DIGITS)
        assert contacts.radius[0] == 0.003
        assert contacts.triangle[0] in (2, 4)


def test_samples_without_contacts_are_kept():
    """A sample in which nothing touches ends every impact episode."""
    sizes = [contacts.triangle.size for contacts in read_contacts(*BED)]
    assert sizes[:3] == [0, 0, 1]
    assert sizes[-1] == 9


def test_the_set_up_frame_can_be_dropped():
    """after_step drops the frame that a run writes before its first step."""
    steps = [contacts.step for contacts in read_contacts(*SLIDE)]
    assert steps[0] == SETTLING
    assert [contacts.step for contacts in read_contacts(*SLIDE, after_step=SETTLING)] == steps[1:]
    assert list(read_contacts(*SLIDE, after_step=steps[-1])) == []


@pytest.mark.parametrize("block_bytes", [1, 700, 4096])
@pytest.mark.parametrize("paths", [SLIDE, BED])
def test_the_block_size_changes_nothing(paths, block_bytes):
    """Frames smaller and larger than a block, cut anywhere."""
    pieces = read_contact_batches(*paths, block_bytes=block_bytes)
    in_pieces = [contacts for batch in pieces for contacts in batch]
    for one, other in zip(in_pieces, read_contacts(*paths), strict=True):
        assert one.step == other.step
        for name in CONTACT_FIELDS:
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_memory_follows_the_block_not_the_file(tmp_path):
    """A dump of 400 blocks is read with the memory of a few."""
    block_bytes, copies = 20_000, 1000
    paths = tmp_path / "contacts.dump", tmp_path / "spins.dump"
    for source, path in zip(BED, paths, strict=True):
        text = source.read_text()
        steps = range(600, 6001, 600)
        with open(path, "w") as stream:
            for copy in range(copies):
                shifted = text
                for step in steps:
                    shifted = shifted.replace(f"TIMESTEP\n{step}\n", f"TIMESTEP\n{step + 6000 * copy + 10**9}\n")
                stream.write(shifted)
    list(read_contacts(*BED))  # compiled before memory is counted
    tracemalloc.start()
    frames = sum(batch.steps.size for batch in read_contact_batches(*paths, block_bytes=block_bytes))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert frames == 10 * copies
    assert paths[0].stat().st_size > 400 * block_bytes
    assert peak < 40 * block_bytes


@pytest.mark.parametrize(
    "word", ["0", "-0", "5", "-12.5", "1e-05", "2.5e+10", "-3.25E", "0.000123456", "1.7976931348e+250",
             "-9.99999e-300", "4.9e-324", "123456789012345678"]
)  # fmt: skip
def test_numbers_are_read_as_python_reads_them(tmp_path, word):
    """Decimal numbers to within one unit in the last place; a capital exponent is none of LIGGGHTS'."""
    path = tmp_path / "one.dump"
    text = SLIDE[0].read_text().replace("\n0 ", f"\n{word} ", 1)
    path.write_text(text)
    if word.endswith("E"):
        with pytest.raises(ContactDumpError, match=r"line 10: found '-3\.25E'"):
            list(read_frames(path, "ENTRIES"))
        return
    value = next(read_frames(path, "ENTRIES")).table[0, 0]
    assert value == pytest.approx(float(word), rel=LAST_DIGIT, abs=1e-307)


def spoilt(tmp_path, old, new, source=SLIDE[0], count=1):
    """Copy of a dump in which one thing is replaced."""
    text = source.read_text()
    assert old in text
    path = tmp_path / "spoilt.dump"
    path.write_text(text.replace(old, new, count))
    return path


HEAD = "ITEM: TIMESTEP\n4300\nITEM: NUMBER OF ENTRIES\n1\n"
POINT, ROW_4300 = "0 0.0043 0 ", "0 0.0043 0 0 0.0043 0.00295921 0 0 0 0 0.5 "
LINE_4300 = 3 * 10 + 1  # every frame of the slide has ten lines
FAULTS = {  # what is replaced, by what, line within the frame, words of the message
    "nan": (POINT, "nan 0.0043 0 ", 9, "found 'nan', allowed are finite numbers"),
    "infinite": (POINT, "0 -inf 0 ", 9, "found '-inf', allowed are finite numbers"),
    "overflow": (POINT, "0 1e300 0 ", 9, "found '1e300', allowed are finite numbers"),
    "letters": (POINT, "0 0.00x43 0 ", 9, "found '0.00x43', allowed are finite numbers"),
    "lone minus": (POINT, "0 - 0 ", 9, "found '-', allowed are finite numbers"),
    "lone point": (POINT, "0 . 0 ", 9, "found '.', allowed are finite numbers"),
    "too long": (POINT, f"0 {10**19} 0 ", 9, "finite numbers of up to 18 digits"),
    "column missing": (POINT, "0 0.0043 ", 9, "a wrong number of columns, allowed are 18"),
    "column too many": (ROW_4300, f"{ROW_4300} 0 0 1 1 5 5 5 5 ", 9, "a wrong number of columns"),
    "row too many": (HEAD, HEAD[:-2] + "0\n", 9, "allowed is 'ITEM: TIMESTEP'"),
    "row missing": (HEAD, HEAD[:-2] + "2\n", 10, "the frame ends early"),
    "count broken": (HEAD, HEAD[:-2] + "1.5\n", 3, "found '1.5', allowed is a whole number"),
    "step broken": ("\n4300\n", "\n43x\n", 1, "found '43x', allowed is a whole number"),
    "step repeated": ("\n4300\n", "\n4200\n", 0, "step 4200 is not larger than the one before, allowed"),
    "no count": (HEAD, HEAD.replace("NUMBER", "COUNT"), 2, "allowed is 'ITEM: NUMBER OF"),
    "lines mixed": ("4300\nITEM: N", f"4300\n{ROW_4300}ITEM: N", 2, "allowed is 'ITEM: NUMBER OF"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_spoilt_dump_is_refused_with_file_and_line(tmp_path, name):
    """One sentence with file, line, what is there and what is allowed."""
    old, new, line, words = FAULTS[name]
    path = spoilt(tmp_path, old, new)
    with pytest.raises(ContactDumpError) as caught:
        list(read_contacts(path, SLIDE[1]))
    message = str(caught.value)
    assert message.startswith(f"{path}, line {LINE_4300 + line}: ")
    assert words in message
    assert "\n" not in message
    assert "allowed" in message


def test_a_dump_cut_anywhere_is_refused_or_ends_with_a_whole_frame(tmp_path):
    """Truncation never passes for data: whatever the length kept, only whole frames are read."""
    text = SLIDE[0].read_text()
    whole = [0, *(k for k in range(1, len(text) + 1) if text.startswith("ITEM: TIMESTEP", k)), len(text)]
    path = tmp_path / "cut.dump"
    for length in range(0, len(text), 97):
        path.write_text(text[:length])
        if length in whole:
            continue
        with pytest.raises(ContactDumpError, match=r"cut\.dump, line \d+: .*allowed"):
            list(read_frames(path, "ENTRIES"))


def test_a_missing_last_frame_is_found_by_the_other_dump(tmp_path):
    """A contact dump that lost whole frames is out of step with the spins, and the other way round."""
    for which in (0, 1):
        paths = list(SLIDE)
        text = SLIDE[which].read_text()
        paths[which] = tmp_path / f"short{which}.dump"
        paths[which].write_text(text[: text.rfind("ITEM: TIMESTEP")])
        with pytest.raises(ContactDumpError, match=r"step 5500.* allowed are the same steps in both"):
            list(read_contacts(*paths))


def test_dumps_out_of_step_are_refused(tmp_path):
    """Both dumps hold the same steps."""
    path = spoilt(tmp_path, "\n4300\n", "\n4301\n", SLIDE[1])
    with pytest.raises(ContactDumpError, match=r"found step 4301 where .* has step 4300, allowed"):
        list(read_contacts(SLIDE[0], path))


def test_a_particle_without_spin_is_refused(tmp_path):
    """A contact that pushes needs its particle's spin."""
    path = spoilt(tmp_path, "34 0.001325", "35 0.001325", BED[1])
    with pytest.raises(ContactDumpError, match=r"spoilt.dump, step 3000: particle 34 is missing, allowed"):
        list(read_contacts(BED[0], path))


def test_a_contact_without_force_needs_no_spin(tmp_path):
    """The deck picks particles for the spin dump by force; where there is none, spin moves nothing."""
    row = next(line for line in SLIDE[0].read_text().splitlines() if line.startswith("0 0.0043 "))
    idle = " ".join(row.split()[:15]) + " 0 0 0 "
    contact_path = spoilt(tmp_path, row, idle)
    text = SLIDE[1].read_text()
    spin_path = tmp_path / "spins.dump"
    frames = text.split("ITEM: TIMESTEP\n")
    frames[4] = frames[4].replace("ATOMS\n1\n", "ATOMS\n0\n").rpartition("1 0.003")[0]
    spin_path.write_text("ITEM: TIMESTEP\n".join(frames))
    contacts = list(read_contacts(contact_path, spin_path))[3]
    assert contacts.step == 4300
    assert contacts.particle.tolist() == [1]
    assert not contacts.angular_velocity.any()
    assert contacts.radius[0] == pytest.approx(0.003, rel=0.02)  # distance to the contact point, less the overlap


def test_a_particle_listed_twice_is_refused(tmp_path):
    """Each particle has one spin per step."""
    path = spoilt(tmp_path, "36 0.001325", "34 0.001325", BED[1])
    with pytest.raises(ContactDumpError, match=r"step 3000: particle 34 appears twice, allowed is once"):
        list(read_contacts(BED[0], path))


@pytest.mark.parametrize("column", [12, 13, 14])
def test_rounded_ids_are_refused(tmp_path, column):
    """With %g an id of a million and more loses its last digits: 1234567 becomes 1.23457e+06."""
    row = next(line for line in SLIDE[0].read_text().splitlines() if line.startswith("0 0.0043 "))
    words = row.split()
    words[column] = "1.23457e+06"
    path = spoilt(tmp_path, row, " ".join(words))
    with pytest.raises(ContactDumpError, match=r"line 40: found '1.23457e\+06', allowed is a whole number"):
        list(read_contacts(path, SLIDE[1]))


def test_other_dumps_are_refused(tmp_path):
    """The columns must be those of `pos vel id force`; the spin dump must have its five."""
    fewer = spoilt(tmp_path, " c_wall_contact[18]", "", count=-1)
    with pytest.raises(ContactDumpError, match=r"line 9: found 17 columns .* allowed are the 18 columns"):
        list(read_contacts(fewer, SLIDE[1]))
    no_radius = spoilt(tmp_path, " radius", "", SLIDE[1], count=-1)
    with pytest.raises(ContactDumpError, match=r"line 9: found id omegax .* allowed are at least id radius"):
        list(read_contacts(SLIDE[0], no_radius))
    with pytest.raises(ContactDumpError, match=r"line 9: found 'ITEM: ATOMS id radius', allowed is 'ITEM: ENTRIES'"):
        list(read_contacts(SLIDE[1], SLIDE[1]))


def test_columns_may_not_change_within_a_file(tmp_path):
    """Two decks writing into one file are no dump."""
    text = SLIDE[0].read_text()
    path = tmp_path / "two.dump"
    cut = text.find("ITEM: TIMESTEP\n4300")
    path.write_text(text[:cut] + text[cut:].replace("c_wall_contact", "c_other"))
    with pytest.raises(ContactDumpError, match=f"line {LINE_4300 + 8}: .*column names differ"):
        list(read_contacts(path, SLIDE[1]))


def test_spin_dumps_may_hold_further_columns(tmp_path):
    """Columns are found by name."""
    text = SLIDE[1].read_text().replace("ATOMS id radius", "ATOMS v_more id radius")
    path = tmp_path / "more.dump"
    path.write_text(text.replace("\n1 0.003", "\n7.5 1 0.003"))
    for one, other in zip(read_contacts(SLIDE[0], path), read_contacts(*SLIDE), strict=True):
        np.testing.assert_array_equal(one.radius, other.radius)
        np.testing.assert_array_equal(one.angular_velocity, other.angular_velocity)


def with_wall_force(folder, names):
    """The slide's spin dump with a wall force of 0.5, -1 and 5 N in columns of these names."""
    path = folder / "forces.dump"
    text = SLIDE[1].read_text().replace("ATOMS id radius", f"ATOMS {names} id radius")
    path.write_text(text.replace("\n1 0.003", "\n0.5 -1 5 1 0.003"))
    return path


def test_the_force_of_the_step_comes_with_the_spins(tmp_path):
    """f_force_ID[1] to [3], of whatever wall, are the force on the contact's particle."""
    path = with_wall_force(tmp_path, "f_force_walls[1] f_force_walls[2] f_force_walls[3]")
    for contacts in read_contacts(SLIDE[0], path):
        np.testing.assert_array_equal(contacts.wall_force, [[0.5, -1.0, 5.0]] * contacts.triangle.size)


@pytest.mark.parametrize("last", ["f_force_walls[2]", "f_other[1]"])
def test_half_a_wall_force_is_refused(tmp_path, last):
    """Three components in order, or none."""
    path = with_wall_force(tmp_path, f"f_force_walls[1] f_force_walls[2] {last}")
    with pytest.raises(ContactDumpError, match=r"line 9: found f_force_walls\[1\] .*, allowed are f_force_ID\[1\]"):
        list(read_contacts(SLIDE[0], path))


def run_deck(folder, *options, ranks=1):
    """Runs sphere_on_plate.in in a folder; returns its dumps."""
    for name in ("sphere_on_plate.in", "plate.stl"):
        (folder / name).write_bytes((DATA / name).read_bytes())
    command = ["stdbuf", "-oL", "liggghts", "-in", "sphere_on_plate.in", *options]
    with open(folder / "screen.txt", "w") as screen:
        subprocess.run(command, cwd=folder, stdout=screen, stderr=subprocess.STDOUT, check=True, timeout=LONGEST_S)
    return folder / "contacts.dump", folder / "spins.dump"


def measured(paths, stride):
    """Ledger of a run, and the distance its samples stand for."""
    builder = LedgerBuilder(TRIANGLES, 0, EFFECTIVE_MODULUS, 4850.0)
    places = []
    for contacts in read_contacts(*paths, after_step=SETTLING):
        builder.add(contacts, stride * TIME_STEP)
        places.append(contacts.centre[0, 1])
    assert builder.samples == 4000 // stride
    distance = (places[-1] - places[0]) * builder.samples / (builder.samples - 1)
    return {name: np.nansum(values) for name, values in builder.table().items()}, distance, builder


@pytest.mark.solver
@pytest.mark.parametrize("stride", [1, 20])
def test_a_straight_drag_does_the_work_of_load_times_distance(tmp_path, stride):
    """LIGGGHTS itself: sliding work = F L, impulse = F t, no rolling, Hertz radius of the load."""
    paths = run_deck(tmp_path, "-var", "stride", str(stride))
    sums, distance, builder = measured(paths, stride)
    assert distance == pytest.approx(0.004, rel=WORK_TOLERANCE)
    assert sums["sliding_work_J"] == pytest.approx(LOAD * distance, rel=WORK_TOLERANCE)
    assert sums["normal_impulse_N_s"] == pytest.approx(LOAD * builder.time_s, rel=WORK_TOLERANCE)
    assert sums["rolling_work_J"] == 0.0
    assert sums["impact_energy_J"] == 0.0
    radius = (3.0 * LOAD * 0.003 / (4.0 * EFFECTIVE_MODULUS)) ** (1 / 3)
    assert np.nanmax(builder.table()["contact_radius_m"]) == pytest.approx(radius, rel=WORK_TOLERANCE)


@pytest.mark.solver
def test_a_rolling_sphere_hardly_slides(tmp_path):
    """LIGGGHTS itself: no sliding work, rolling work = F R omega t = F L R / (R - overlap/2)."""
    paths = run_deck(tmp_path, "-var", "rolling", "1")
    sums, distance, _ = measured(paths, 1)
    assert distance == pytest.approx(0.004, rel=1e-3)  # settling spends a little of the speed
    assert sums["sliding_work_J"] < ROLLING_LEFTOVER * LOAD * distance
    overlap = (3.0 * LOAD / (4.0 * EFFECTIVE_MODULUS * np.sqrt(0.003))) ** (2 / 3)
    expected = LOAD * distance * 0.003 / (0.003 - overlap / 2)
    assert sums["rolling_work_J"] == pytest.approx(expected, rel=WORK_TOLERANCE)
