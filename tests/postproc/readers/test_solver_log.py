"""Progress, failures and triangle counts from what LIGGGHTS really printed."""

import re
import subprocess

import numpy as np
import pytest

from bulkwear.postproc.readers.solver_log import (
    KNOWN_CAUSES,
    SolverLogError,
    failure,
    last_step,
    reported_triangles,
    solver_version,
    thermo_rows,
    thermo_table,
    warnings,
)
from tests import DATA
from tests.support.patience import LONGEST_S

LOG, SCREEN = DATA / "bed_log.txt", DATA / "bed_screen.txt"
MESSAGES = dict(
    re.findall(r"^=== (\w+)\n(.*?)(?=^===|\Z)", (DATA / "solver_failures.txt").read_text(), re.MULTILINE | re.DOTALL)
)

CAUSES = {
    "ledger_refused": "this deck runs with solver/build/liggghts-ledger",
    "unknown_command": "a command that this LIGGGHTS does not know",
    "no_property": "does not define this material property",
    "badtypes": "one value for each pair of materials",
    "no_restart": "the restart file is missing",
    "bad_restart": "the restart file is damaged",
    "no_memory": "the memory is exhausted",
    "lost": "particles left the domain",
    "lostwarn": "particles left the domain",
    "timestep_check": "the time step is too large",
    "hard": "needs `hard_particles yes`",
    "nomesh": "the surface file is missing",
    "nofix": "names a mesh that the deck does not define",
    "mesh_duplicate": "two facets of the surface are the same",
    "mesh_sliver": "sliver triangle",
    "mesh_outside": "outside the simulation box",
    "insert_fail": "do not fit into the region",
    "var": "uses a variable it does not define",
    "computelate": "must define the contact compute before its first run",
    "inc": "a file it includes, is missing",
    "unknown_fix": "a keyword that this command does not take",
    "badwall": "a keyword that this command does not take",
    "nan": "no finite position",
    "prime": "primes above 10000",
    "timestep_warn": "no particle is left",
}


def test_thermo_rows_of_all_runs_are_read():
    """Two runs: steps 0 and 1, then 1 to 6001, printed every 500; columns as printed."""
    table = thermo_table(LOG)
    assert list(table) == ["run", "Step", "Atoms", "KinEng", "CPU"]
    np.testing.assert_array_equal(table["Step"], [0, 1, 1, *range(500, 6001, 500), 6001])
    np.testing.assert_array_equal(table["run"], [0, 0] + [1] * 14)
    np.testing.assert_array_equal(table["Atoms"], [0] + [54] * 15)
    assert table["KinEng"][1] == 5.8257069e-05


def test_a_row_being_written_is_not_read(tmp_path):
    """The log of a running solver ends anywhere; its unfinished line is left out."""
    text = LOG.read_text()
    path = tmp_path / "log.liggghts"
    for cut in ("    3500 ", "    3500       54  2.1", "    3500       54  2.1774"):
        whole = text[: text.rindex("\n    3500") + 1]
        path.write_text(whole + cut)
        assert thermo_table(path)["Step"][-1] == 3000
        assert last_step(path) == 3000


def test_runs_with_different_columns_share_a_table(tmp_path):
    """A column a run does not print is NaN there."""
    path = tmp_path / "log.liggghts"
    path.write_text("Step Atoms\n0 5\nWARNING: not a row\n10 5\nLoop time of 1\nStep KinEng\n10 0.5\n20 0.25\n")
    table = thermo_table(path)
    np.testing.assert_array_equal(table["Atoms"], [5, 5, np.nan, np.nan])
    np.testing.assert_array_equal(table["KinEng"], [np.nan, np.nan, 0.5, 0.25])


@pytest.mark.parametrize("read", [thermo_table, thermo_rows])
def test_a_column_that_no_run_prints_is_named(read):
    """One sentence instead of a KeyError: log, column, those there are, and the word of the deck that brings it."""
    with pytest.raises(SolverLogError) as fault:
        read(LOG)["force_x"]
    assert str(fault.value) == (
        f"{LOG}: found no column force_x among those that the solver printed, Step, Atoms, KinEng, CPU; allowed is the"
        " log of a deck whose thermo_style has v_force_x (templates)."
    )


def test_some_rows_of_a_table_name_its_log_too():
    """The second run's rows alone, and the same fault."""
    table = thermo_table(LOG)
    second = table.of_rows(table["run"] == 1)
    np.testing.assert_array_equal(second["Step"], table["Step"][2:])
    with pytest.raises(SolverLogError, match="no column level_h"):
        second["level_h"]


def test_the_last_step_is_found_in_the_tail():
    """The last thermo row, not the timings after it."""
    assert last_step(LOG) == 6001


def test_no_step_yet(tmp_path):
    """Before the first row there is no step, nor a table."""
    path = tmp_path / "log.liggghts"
    for text in ("", LOG.read_text().partition("Step ")[0]):
        path.write_text(text)
        assert last_step(path) is None
        assert thermo_table(path)["run"].size == 0


def test_the_last_step_is_found_behind_a_long_silence(tmp_path):
    """Warnings longer than the tail that is read do not hide the last row."""
    path = tmp_path / "log.liggghts"
    path.write_text("    Step    Atoms\n     700       54\n" + "WARNING: nothing to see\n" * 5000)
    assert last_step(path) == 700


@pytest.mark.parametrize("case", CAUSES)
def test_real_failures_are_explained(case):
    """One line with the solver's words and the cause, from messages provoked in small decks."""
    explained = failure(MESSAGES[case])
    assert explained.startswith("LIGGGHTS stopped: ")
    assert CAUSES[case] in explained
    assert "\n" not in explained
    assert "./src/" not in explained


def test_every_message_has_a_cause_and_every_cause_a_message():
    """No message without an explanation, no explanation that never happened."""
    assert set(MESSAGES) == set(CAUSES)
    explained = [failure(text) for text in MESSAGES.values()]
    assert [cause for _, cause in KNOWN_CAUSES if not any(cause in one for one in explained)] == []


def test_an_unknown_failure_is_passed_on():
    """Words without a known cause stand alone."""
    assert failure("ERROR: Something new (./src/x.cpp:1)\n") == "LIGGGHTS stopped: Something new"


def test_a_run_that_worked_has_no_failure():
    """Neither warnings nor the deck's own words (`error yes`) are failures."""
    assert failure(LOG) is None
    assert failure(SCREEN) is None
    assert failure("fix check all check/timestep/gran 1 0.2 0.2 error yes\n# ERROR: no\n") is None


def test_warnings_are_counted_once_per_kind():
    """The same warning with other numbers is the same warning."""
    text = "WARNING: time-step is 279.03 % of rayleigh time (./src/a.cpp:200)\n" * 3
    text += "WARNING: time-step is 80.1 % of rayleigh time (./src/a.cpp:200)\n"
    assert warnings(text) == {"time-step is # % of rayleigh time": 4}
    assert warnings(SCREEN) == {"Particle insertion: Less insertions than requested": 1}
    text = "WARNING: \n\tThe contact model you specified is not located in any whitelist.\n\tBecause of this"
    assert warnings(text) == {"The contact model you specified is not located in any whitelist.": 1}


def test_the_triangle_count_is_on_the_screen_not_in_the_log():
    """LIGGGHTS prints it to standard output only."""
    assert reported_triangles(SCREEN, "plate") == 24
    with pytest.raises(SolverLogError, match=r"bed_log\.txt: no triangle count of mesh 'plate'.*allowed"):
        reported_triangles(LOG, "plate")
    with pytest.raises(SolverLogError, match="mesh 'plat'"):
        reported_triangles(SCREEN, "plat")


DECK = """units si
atom_style granular
boundary f f f
newton off
communicate single vel yes
region domain block -0.02 0.02 -0.02 0.04 -0.01 0.02 units box
create_box 1 domain
neighbor 0.001 bin
fix youngs_modulus all property/global youngsModulus peratomtype 1e7
fix poissons_ratio all property/global poissonsRatio peratomtype 0.3
fix restitution all property/global coefficientRestitution peratomtypepair 1 0.5
fix friction all property/global coefficientFriction peratomtypepair 1 0.5
pair_style gran model hertz tangential history
pair_coeff * *
create_atoms 1 single 0.0 0.0 0.01 units box
set group all density 2500 diameter 0.003
timestep 1e-6
fix plate all mesh/surface file plate.stl type 1
fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes plate
fix integrate all nve/sphere
run 1
"""


def run_mesh(folder, facets):
    """Exit code and screen of a run with a mesh of these facets (their text in an STL file)."""
    (folder / "plate.stl").write_text("solid s\n" + "".join(facets) + "endsolid s\n")
    (folder / "deck.in").write_text(DECK)
    with open(folder / "screen.txt", "w") as screen:
        command = ["stdbuf", "-oL", "liggghts", "-in", "deck.in"]
        done = subprocess.run(command, cwd=folder, stdout=screen, stderr=subprocess.STDOUT, timeout=LONGEST_S)
    return done.returncode, folder / "screen.txt"


def plate_facets():
    text = (DATA / "plate.stl").read_text()
    return re.findall(r" facet.*?endfacet\n", text, re.DOTALL)


@pytest.mark.solver
def test_a_facet_that_liggghts_drops_shows_in_the_count(tmp_path):
    """LIGGGHTS itself drops a facet with coinciding corners without a word; only the count tells."""
    facets = plate_facets()
    corner = re.findall(r"vertex .*\n", facets[5])
    flat = facets[5].replace(corner[1], corner[0])
    code, screen = run_mesh(tmp_path, [*facets[:5], flat, *facets[6:]])
    assert code == 0
    assert failure(screen) is None
    assert reported_triangles(screen, "plate") == len(facets) - 1


@pytest.mark.solver
def test_liggghts_refuses_a_facet_given_twice(tmp_path):
    """LIGGGHTS itself: the words of the tested version are those explained here."""
    code, screen = run_mesh(tmp_path, [*plate_facets(), plate_facets()[3]])
    assert code != 0
    assert "two facets of the surface are the same" in failure(screen)


def test_version_is_what_the_solver_says():
    """Real screen output names program, version and build in its first line; other text names none."""
    assert solver_version(DATA / "bed_screen.txt").startswith("Version LIGGGHTS-PUBLIC 3.8.0")
    assert solver_version(DATA / "plate.stl") is None
