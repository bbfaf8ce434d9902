"""Contact kernels that a project has in C++ of its own: compiled, loaded, summed as the solver's are, or refused."""

import shutil
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.wear.kernels import KERNELS, Kernel
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.engine.cycles import own_kernels
from bulkwear.workflows.engine.own_code import code_of_law
from bulkwear.workflows.engine.own_kernels import own_library, python_fault
from bulkwear.workflows.engine.project import ProjectError, enter_project, leave_project
from bulkwear.workflows.engine.solver import (
    missing_kernels,
    own_kernels_words,
    solver_command,
    solver_environment,
)
from tests.verification.ledger_cases import (
    LEDGER_LINE,
    MASS,
    PIN_MOTION,
    SOLVER,
    hertz_force,
    hertz_overlap,
    pin,
    said_when_refused,
    write_case,
)

pytestmark = pytest.mark.solver

TWIN = """\
// Finnie's, as the solver has it, under another name.
inline double twin(const Contact& contact, const double* given) { return finnie_work(contact, given); }
"""
POWER = """\
// Work of the normal force on slip to a power, F_n |v_t| (|v_t| / V)^n. given: n (-), V (m/s)
inline double slip_power(const Contact& contact, const double* given) {
  const double speed = contact.sliding_speed;
  return contact.normal_force * speed * std::pow(speed / given[1], given[0]);
}
"""
HIT = """\
// m v_n^3 / 2 V of an impact. given: V (m/s)
inline double hard_hit(const Contact& contact, const double* given) {
  return 0.5 * contact.mass * std::pow(contact.approach_speed, 3.0) / given[0];
}
"""
LAW = '''\
"""A law that is not linear in force and speed, with kernels in C++."""

from bulkwear.postproc.wear.kernels import Kernel
from bulkwear.postproc.wear.laws import Law, Parameter

KERNELS = {
    "twin": Kernel(None),
    "slip_power": Kernel(None, parameters=("exponent", "speed_m_per_s")),
    "hard_hit": Kernel(None, parameters=("speed_m_per_s",), per_impact=True),
}


def volume(columns, parameters):
    """Return the volume (m3) by the power of slip and by hits."""
    return parameters["wear_coefficient_per_pa"] * (columns["slip_power_J"] + columns["hard_hit_J"])


LAW = Law(
    volume,
    "coefficient {wear_coefficient_per_pa} 1/Pa, exponent {exponent}, speed {speed_m_per_s} m/s.",
    "nobody",
    kernels=("slip_power", "hard_hit"),
    parameters=(
        Parameter("exponent", "of the slip", 0.0, 3.0, unit="-"),
        Parameter("speed_m_per_s", "to which the coefficient belongs", 0.01, 10.0, unit="m/s"),
    ),
)
'''
NAMES = ("twin", "slip_power", "hard_hit")
EXPONENT, REFERENCE = 1.5, 0.5  # -, m/s
SPEED, TIME_STEP, STEPS = 1.0, 2e-6, 1000  # m/s, s
START = (1.31234567e-4, -0.0020007123456)  # m, no node and no edge below it
FORCE = hertz_force(hertz_overlap())  # N
EXACT = 1e-6  # relative; the nine digits of the STL move the overlap (test_solver_ledger_vectors.py)
PLATE = flat_plate(0.006, 0.012, 1e-3)
ASKED = (
    f"{LEDGER_LINE} twin slip_power exponent {EXPONENT} speed_m_per_s {REFERENCE} hard_hit speed_m_per_s {REFERENCE}"
)


@pytest.fixture
def project(tmp_path):
    """A project with a law and its kernels, entered for the test."""
    laws, known, kernels = tmp_path / "project" / "laws", dict(LAWS), dict(KERNELS)
    laws.mkdir(parents=True)
    (tmp_path / "project" / "config").mkdir()
    (laws / "own.py").write_text(LAW)
    for name, text in zip(NAMES, (TWIN, POWER, HIT), strict=True):
        (laws / f"{name}.h").write_text(text)
    enter_project(tmp_path / "project")
    yield tmp_path / "project"
    leave_project()
    for registry, before in ((LAWS, known), (KERNELS, kernels)):
        registry.clear()
        registry.update(before)


def ledger(folder, particles, motion, library, **case):
    """The ledger of a sphere with all kernels, by triangle."""
    write_case(folder, PLATE, particles, motion, **case)
    (folder / "ledger.in").write_text(ASKED + "\n")
    command = [str(SOLVER), *own_kernels_words(library), "-in", "deck.in", "-log", "log.liggghts"]
    done = subprocess.run(command, cwd=folder, env=solver_environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:]
    return read_load_ledger(folder / "load_ledger.bin", "sample", len(PLATE.triangles)).columns


def test_a_dragged_sphere(tmp_path, project):
    """The twin of a built-in kernel has its sums to the last bit; the power of slip its closed form, F v (v/V)^n t."""
    dragged = [*pin(*START), f"velocity all set 0.0 {SPEED} 0.0 units box"]
    case = {"settling": 300, "steps": STEPS, "time_step": TIME_STEP, "friction": 0.4}
    found = ledger(tmp_path / "drag", dragged, PIN_MOTION, own_library(NAMES), **case)
    np.testing.assert_array_equal(found["twin_J"], found["finnie_work_J"])
    expected = FORCE * SPEED * (SPEED / REFERENCE) ** EXPONENT * STEPS * TIME_STEP
    assert found["slip_power_J"].sum() == pytest.approx(expected, rel=EXACT)
    assert not found["hard_hit_J"].any()


def test_a_sphere_that_hits(tmp_path, project):
    """One impact: Finnie's sums again to the last bit, and m v^3 / 2 V, not the energy."""
    speed = 0.4
    particles = [*pin(*START, 0.003 + 1e-4), f"velocity all set 0.0 0.1 -{speed} units box"]
    case = {"modulus": 5e6, "time_step": 1e-5, "steps": 400}
    found = ledger(tmp_path / "hit", particles, ["fix integrate all nve/sphere"], own_library(NAMES), **case)
    assert found["finnie_work_J"].sum() > 0.0
    np.testing.assert_array_equal(found["twin_J"], found["finnie_work_J"])
    assert found["hard_hit_J"].sum() == pytest.approx(0.5 * MASS * speed**3 / REFERENCE, rel=EXACT)


def test_the_program_has_them_with_the_library_alone(project):
    """With the project's library nothing is missing; without one the kernel is no kernel; it is compiled once."""
    assert missing_kernels(str(SOLVER), NAMES) is None
    library = own_library(NAMES)
    assert library == own_library(NAMES) and library.parent == project / "results" / "own_kernels"
    assert own_library(["finnie_work"]) is None
    told = subprocess.run([SOLVER, "-own-kernels", library, "-kernels"], capture_output=True, text=True, check=True)
    assert "slip_power slip_power_J exponent speed_m_per_s" in told.stdout.splitlines()
    leave_project()
    assert "it has no contact kernel twin" in missing_kernels(str(SOLVER), ["twin"])


def test_a_run_loads_them(project):
    """A run whose law has kernels in C++ starts the solver with their library; sampled contacts need none."""
    case = SimpleNamespace(kernels=lambda parameters: {"slip_power": {}, "finnie_work": {}})
    chain = SimpleNamespace(case=case, parameters={"ledger": "solver"})
    library = own_kernels(chain)
    assert library == own_library(["slip_power"])
    assert solver_command(1, "ours", own_kernels=library)[-2:] == ["-own-kernels", str(library)]
    chain.parameters["ledger"] = "dumps"
    assert own_kernels(chain) is None


def test_a_changed_kernel_is_another_one(project):
    """Another library, and another hash of the law, so that its runs are made again; a comment is a change too."""
    before, library = code_of_law("own"), own_library(NAMES)
    assert set(before) == {"own.py", "slip_power.h", "hard_hit.h"}
    (project / "laws" / "slip_power.h").write_text(POWER.replace("speed *", "2.0 * speed *"))
    assert code_of_law("own")["slip_power.h"] != before["slip_power.h"]
    assert own_library(NAMES) != library


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            POWER.replace("contact.sliding_speed", "contact.slip"),
            r"laws/slip_power.h, line 3: .*slip.*; allowed is C",
        ),
        (POWER.replace("slip_power(", "slip("), r"laws/slip_power.h: .*slip_power.*; allowed is a function of the ker"),
    ],
)
def test_what_does_not_compile_is_refused(project, text, sentence):
    """File, line and the compiler's words, in one sentence; nothing is left to be loaded."""
    (project / "laws" / "slip_power.h").write_text(text)
    with pytest.raises(ProjectError, match=sentence) as refused:
        own_library(["slip_power"])
    assert "\n" not in str(refused.value)
    assert not list((project / "results" / "own_kernels").iterdir())


def test_a_missing_file_is_told(project):
    """Of a kernel that is declared, with the name that the file must have."""
    (project / "laws" / "slip_power.h").unlink()
    with pytest.raises(ProjectError, match=r"^laws/slip_power\.h: there is no such file, allowed is the con"):
        own_library(["finnie_work", "slip_power"])


def test_a_missing_compiler_is_told(project, monkeypatch):
    """Which ones were looked for, and what to install."""
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(ProjectError, match=r"found none of the compilers c\+\+.*apt-get install g\+\+"):
        own_library(["twin"])


def test_sampled_contacts_need_a_function(project):
    """A kernel in C++ alone is refused where contacts are sampled; one with a function is not."""
    assert python_fault(["twin"]).startswith("contact kernel twin: it has no function in Python, which `ledger: dumps`")
    KERNELS["twin"] = Kernel(lambda contacts, motion, normals: np.zeros(len(normals)))
    assert python_fault(["twin", "finnie_work"]) is None


def test_a_library_that_is_none_is_refused(tmp_path, project):
    """One sentence with the file; and a deck that asks for a kernel of a project without its library."""
    told = subprocess.run([SOLVER, "-own-kernels", "/nowhere.so", "-kernels"], capture_output=True, text=True)
    assert told.returncode == 1 and "-own-kernels: found /nowhere.so: " in told.stderr
    assert "found kernel 'twin', allowed are finnie_work" in said_when_refused(tmp_path / "deck", ledger=ASKED)
