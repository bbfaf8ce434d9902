"""Other codes beside ours: what all are given, what is computed of their answers, and when no ratio is told."""

import math
import runpy

import numpy as np
import pandas as pd
import pytest

from benchmarks.peer_case import (
    DENSITY,
    LOADED_OVERLAP,
    STATE_COLUMNS,
    PeerRun,
    answer,
    contact_number,
    hertz_force,
    kinetic_energy,
    one_sphere,
    read_states,
)
from benchmarks.peer_codes import KRATOS, LAMMPS, OURS, PROGRAMS, STOCK, WITHOUT, YADE, codes, run_code
from benchmarks.peer_decks import lammps_deck, liggghts_deck
from benchmarks.peer_page import MOST_APART, QUANTITIES, agreement, results_page, speeds
from benchmarks.peers import MOVED, available, bed, publish, version
from benchmarks.peers import rounds as take_turns
from bulkwear.workflows.engine.solver import SolverError
from tests import REPOSITORY

RUN = PeerRun(steps=200, samples=2)
MACHINE = {"processor": "a processor", "system": "a system"}


def rounds(rates, apart=0.0):
    """A table of rounds: ours, and LAMMPS `apart` (-) from it in one quantity; rates: (ours, LAMMPS) per round."""
    same = dict.fromkeys(QUANTITIES, 2.0)
    rows = [
        {"round": number, "code": code, "version": "1", "date": "2026-11-26", "particles": 10, "steps": 100}
        | {"particle_steps_per_s": rate, **same, "wear_over_archard": 1.0 if code == OURS else math.nan}
        | ({"force_z_N": 2.0 * (1.0 + apart)} if code == LAMMPS else {})
        for number, pair in enumerate(rates, 1)
        for code, rate in zip((OURS, LAMMPS), pair, strict=True)
    ]
    return pd.DataFrame(rows)


def test_ratios_are_those_of_a_round():
    """Median and range over rounds, not the ratio of medians."""
    found = speeds(rounds([(1.0, 2.0), (2.0, 3.0), (10.0, 40.0)])).set_index("code").loc[LAMMPS]
    assert (found["ratio"], found["ratio_low"], found["ratio_high"]) == (2.0, 1.5, 4.0)


@pytest.mark.parametrize(("apart", "told"), [(0.99 * MOST_APART, True), (1.01 * MOST_APART, False)])
def test_no_ratio_where_the_physics_are_apart(apart, told):
    table = rounds([(1.0, 2.0)], apart)
    assert agreement(table).set_index("code").loc[LAMMPS, "apart"] == pytest.approx(apart)
    assert math.isnan(speeds(table).set_index("code").loc[LAMMPS, "ratio"]) is not told
    assert ("physics apart" in results_page(table, [], MACHINE)) is not told


def test_energy_and_contacts_of_spheres():
    """Two that overlap and a third that does not: 1/2 m v^2 + 1/2 2/5 m R^2 w^2."""
    radii = np.array([1.0e-3, 2.0e-3, 1.0e-3])
    state = np.zeros((3, len(STATE_COLUMNS)))
    state[:, 1] = 0.0, 2.999e-3, 6.001e-3
    state[0, 4], state[1, 9] = 2.0, 3.0
    assert contact_number(state, radii) == 1
    masses = DENSITY * 4.0 / 3.0 * np.pi * radii**3
    expected = 0.5 * masses[0] * 2.0**2 + 0.5 * 0.4 * masses[1] * radii[1] ** 2 * 3.0**2
    assert kinetic_energy(state, radii) == pytest.approx(expected)


def test_what_programs_write_is_read_as_a_dump(tmp_path, monkeypatch):
    """Rows in any order, all digits; another table is refused."""
    monkeypatch.chdir(tmp_path)
    write_sample = runpy.run_path(str(PROGRAMS / "samples.py"))["write_sample"]
    rows = [(2, 0.1, *([0.0] * 8)), (1, 1.0 / 3.0, *([0.0] * 8))]
    write_sample(5, rows, (0.0, 0.0, -1.0))
    found = read_states(tmp_path)
    assert list(found) == [5] and found[5][:, 0].tolist() == [1.0, 2.0] and found[5][0, 1] == 1.0 / 3.0
    text = (tmp_path / "states.dump").read_text()
    (tmp_path / "states.dump").write_text(text.replace("omegaz", "omega"))
    with pytest.raises(ValueError, match="omega"):
        read_states(tmp_path)


def test_the_ledger_is_all_that_differs():
    more = set(liggghts_deck(RUN, True).splitlines()) - set(liggghts_deck(RUN, False).splitlines())
    assert [line.split()[1] for line in more] == ["load_ledger"]


def test_lammps_has_the_same_numbers():
    """Time step, modulus, friction, walls; tangential over normal damping is the root of their stiffnesses' ratio."""
    deck, ours = lammps_deck(RUN), liggghts_deck(RUN, False)
    for number in (f"timestep {RUN.time_step:.17g}", f"xplane {-RUN.half_width}", str(RUN.youngs_modulus)):
        assert number in deck and number.split()[-1] in ours
    shear = RUN.youngs_modulus / (4.0 * (2.0 - RUN.poissons_ratio) * (1.0 + RUN.poissons_ratio))
    assert RUN.tangential_damping == pytest.approx(math.sqrt(4.0 * shear / RUN.effective_modulus))


def test_a_peer_that_is_not_there_is_named_and_left_out(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PATH", "")
    known = codes(tmp_path)
    left = {code.name for code in known} - {code.name for code in available(known)}
    said = capsys.readouterr().out
    assert left == {STOCK, LAMMPS, YADE, KRATOS}
    assert all(f"{name} was not found and is left out: " in said for name in left)
    page = results_page(rounds([(1.0, 2.0)]), known, MACHINE)
    assert "measured 2026-11-26." in " ".join(page.split())
    assert page.count("* Kratos DEM: pip install KratosDEMApplication") == 1


def test_every_round_has_every_code_and_keeps_what_there_is(tmp_path, monkeypatch):
    """Codes in another order in each round; one that stops is left out; the table so far is handed on."""
    known, asked, tables = codes(tmp_path)[:3], [], []

    def made_up(code, folder, run, particles):
        asked.append((code.name, float(particles[0, 0])))
        if code.name == STOCK:
            raise SolverError("it stopped")
        return {"code": code.name, "particle_steps_per_s": 1.0}

    monkeypatch.setattr("benchmarks.peers.row", made_up)
    take_turns(tmp_path, RUN, one_sphere(), 2, known, tables.append)
    assert [name for name, _ in asked] == [OURS, MOVED, WITHOUT, STOCK, MOVED, WITHOUT, STOCK, OURS]
    places = {name: place for name, place in asked}
    assert places[MOVED] - places[OURS] == pytest.approx(1e-9, rel=1e-6) and places[WITHOUT] == places[OURS]
    assert [len(table) for table in tables] == [1, 2, 3, 4, 5, 6]
    assert tables[-1]["code"].tolist() == [OURS, MOVED, WITHOUT] * 2


def test_versions_are_those_that_programs_say():
    assert version("LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, compiled") == "LIGGGHTS-PUBLIC 3.8.0"
    assert version("LAMMPS (22 Jul 2025 - Update 4)") == "22 Jul 2025 - Update 4"
    assert version("Welcome to Yade 2023.02a") == "Yade 2023.02a" and version("nothing") == ""


def test_a_dragged_sphere_wears_as_the_closed_form_says(tmp_path):
    """The force on the floor is Hertz's, Archard's volume by our ledger exact; LIGGGHTS' own law sees no impact."""
    run, sphere = PeerRun(steps=400, samples=1, dragged=True), one_sphere()
    force = hertz_force(run, sphere[0, 3], LOADED_OVERLAP)
    by_name = {code.name: code for code in codes(tmp_path)}
    for name, expected in ((OURS, run.archard * force * run.travel), (STOCK, 0.0)):
        assert run_code(by_name[name], tmp_path / name, run, sphere) > 0.0
        told = answer(tmp_path / name, run, sphere).iloc[-1]
        assert (told["force_z_N"], told["force_x_N"]) == pytest.approx((-force, run.friction * force), rel=1e-9)
        assert by_name[name].wear(tmp_path / name, run) == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert by_name[WITHOUT].wear is None


def test_page_and_figure(tmp_path):
    page = publish(tmp_path, rounds([(1.0, 2.0)]), codes(tmp_path))
    assert page == (tmp_path / "peers.md").read_text() and "nan" not in page
    assert (tmp_path / "peers.png").stat().st_size > 0


def test_a_bed_comes_to_rest_in_its_box(tmp_path):
    """As many spheres as asked for, all inside, on the floor; made once."""
    found = bed(tmp_path, 30, 4000)
    assert found.shape == (30, 4) and (np.abs(found[:, :2]) <= RUN.half_width).all() and (found[:, 2] > 0.0).all()
    written = (tmp_path / "deck.in").stat().st_mtime_ns
    assert np.array_equal(bed(tmp_path, 30, 4000), found) and (tmp_path / "deck.in").stat().st_mtime_ns == written


def test_the_published_page_is_that_of_its_table(tmp_path):
    """All but the machine, which is where it was made."""
    docs = REPOSITORY / "docs"
    made = results_page(pd.read_csv(docs / "peers.csv"), codes(tmp_path), MACHINE)
    assert (docs / "peers.md").read_text().partition("## Speed")[2] == made.partition("## Speed")[2] != ""
