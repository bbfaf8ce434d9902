"""Contact kernels with parameters, in a solver built with one: read from the deck, summed, part of a restart file."""

import re
import subprocess

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.workflows.engine.solver import missing_kernels
from tests.support.law_cases import long_slip_registered
from tests.verification.ledger_cases import (
    DUMP_LINES,
    LEDGER_LINE,
    PIN_MOTION,
    build,
    ledger_of_dumps,
    pin,
    run,
    said_when_refused,
    write_case,
)

pytestmark = [pytest.mark.solver, pytest.mark.verify]  # a program is built

LIST = "constexpr Kernel KERNELS[] = {\n"
KERNEL = """\
inline double long_slip(const Contact& contact, const double* given) {
  return contact.sliding_speed * std::pow(given[1] / 1e-3, given[0]);
}

"""
LINE = '    {"long_slip", "long_slip_m", long_slip, {"exponent", "length_m"}},\n'
ASKED = LEDGER_LINE + " long_slip length_m 0.003 exponent 1.25 long_slip exponent 2 length_m 0.003"
TIME_STEP, STEPS = 2e-6, 1000
MAP_TOLERANCE = 1e-9  # relative; the dump has twelve digits
EVEN = 1e-3  # relative; force and speed hardly change, so their mean product is that of their means
DRAGGED = [*pin(1.31234567e-4, -0.0040007123456), "velocity all set 0.0 1.0 0.0 units box"]


@pytest.fixture(scope="module")
def solver(tmp_path_factory):
    """The solver with the kernel `long_slip` of law_cases.py."""
    edit = ("kernels.h", LIST, KERNEL + LIST + LINE)
    return build(tmp_path_factory.mktemp("built"), edit=edit, CXXFLAGS="-O0")


def drag(folder, solver, outputs=()):
    """Drag a pin over a plate; return the plate and the ledger."""
    mesh = flat_plate(0.006, 0.012, 1e-3)
    write_case(folder, mesh, DRAGGED, PIN_MOTION, steps=STEPS)
    (folder / "ledger.in").write_text("\n".join([ASKED, *outputs]) + "\n")
    run(folder, solver=solver)
    return mesh, read_load_ledger(folder / "load_ledger.bin", "sample", len(mesh.triangles))


def test_both_producers_sum_the_same(tmp_path, solver):
    """|v_t| (L / 1 mm)^n dt with L = 3 mm and n = 1.25, triangle by triangle, beside a kernel without parameters and
    the same one with n = 2.
    """
    mesh, ledger = drag(tmp_path, solver, outputs=DUMP_LINES)
    sets = {"long_slip": {"exponent": 1.25, "length_m": 0.003}, "long_slip.2": {"exponent": 2.0, "length_m": 0.003}}
    with long_slip_registered():
        table = ledger_of_dumps(tmp_path, mesh, TIME_STEP, after_step=0, kernels={"finnie_work": {}, **sets})
    assert list(ledger.columns)[-3:] == ["finnie_work_J", "long_slip_m", "long_slip.2_m"]
    for name in ("long_slip_m", "long_slip.2_m"):
        np.testing.assert_allclose(ledger.columns[name], table[name], rtol=MAP_TOLERANCE)
    sums = {name: ledger.columns[name].sum() for name in ledger.columns}
    slip = sums["sliding_work_J"] / sums["normal_impulse_N_s"] * sums["contact_time_s"]
    assert sums["long_slip_m"] == pytest.approx(3.0**1.25 * slip, rel=EVEN) and slip > 0.0
    assert sums["long_slip.2_m"] == pytest.approx(3.0**2 * slip, rel=EVEN)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            "exponent 2",
            r"found nothing after 1 parameters of the kernel long_slip, allowed are exponent, length_m",
        ),
        ("exponent 2 length_m", r"found 'length_m' after 1 parameters of the kernel long_slip"),
        ("exponent 2 length_mm 3", r"found 'length_mm' after 1 parameters of the kernel long_slip"),
        ("exponent 2 exponent 3", r"found 'exponent' after 1 parameters of the kernel long_slip"),
        ("exponent 2 length_m 3mm", r"found length_m '3mm' of the kernel long_slip, allowed is a number"),
        ("exponent inf length_m 3", r"found exponent 'inf' of the kernel long_slip, allowed is a number"),
        ("exponent 2 length_m 3 oka", r"found kernel 'oka', allowed are long_slip, finnie_work"),
    ],
)
def test_wrong_parameters_in_the_deck(tmp_path, solver, words, sentence):
    """Missing, without value, unknown, given twice, no number; and what follows them must be a kernel."""
    said = said_when_refused(tmp_path, solver=solver, ledger=f"{LEDGER_LINE} long_slip {words}")
    assert re.search(sentence, said)


@pytest.mark.parametrize(("exponent", "steps"), [("1.25", STEPS), ("1.5", STEPS // 2)])
def test_other_parameters_start_an_empty_ledger(tmp_path, solver, exponent, steps):
    """Sums of one exponent are never gone on with for another one."""
    drag(tmp_path, solver, outputs=[f"restart {STEPS // 2} a.restart b.restart"])
    (tmp_path / "ledger.in").write_text(ASKED.replace("1.25", exponent) + "\n")
    said = run(tmp_path, solver=solver, resumed=1, restart_file="a.restart", particles="nothing")
    assert ("this one starts empty" in said) == (exponent != "1.25")
    assert read_load_ledger(tmp_path / "load_ledger.bin", "sample").steps == steps


def test_the_program_tells_its_kernels(solver):
    """One line each: name, column, parameters; with these the program is good for the law."""
    told = subprocess.run([solver, "-kernels"], capture_output=True, text=True, check=True).stdout
    assert "long_slip long_slip_m exponent length_m" in told.splitlines()
    with long_slip_registered():
        assert missing_kernels(str(solver), ["long_slip", "finnie_work"]) is None
