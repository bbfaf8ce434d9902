"""Discharge time and mass flow are those of the curve they are read from; no particle goes missing unseen."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.outflow import (
    BlockedError,
    OutflowError,
    check_count,
    check_not_blocked,
    discharge_time,
    outflow_curve,
)
from bulkwear.postproc.readers.solver_log import SolverLogError

EXACT = 1e-9  # relative: interpolation on a straight line


def constant_flow(rate=2.0, duration=5.0, after=3.0, interval=0.02):
    """Outflow at a constant rate (kg/s) for a duration (s), then nothing."""
    time = np.arange(0.0, duration + after, interval)
    mass = np.minimum(rate * time, rate * duration)
    return pd.DataFrame(
        {"time_s": time, "mass_kg": mass, "count": np.round(100 * mass), "particles": np.full(len(time), 2000)}
    )


def test_discharge_of_a_constant_flow():
    """At a constant rate 99 % have passed after 99 % of the time, however long the log goes on."""
    seconds, uncertainty = discharge_time(constant_flow())
    assert seconds == pytest.approx(0.99 * 5.0, rel=EXACT)
    assert uncertainty == pytest.approx(0.5 * (0.995 - 0.98) * 5.0, rel=EXACT)
    assert discharge_time(constant_flow(after=30.0))[0] == pytest.approx(seconds, rel=EXACT)


def test_a_blocked_opening_is_refused():
    """Without outflow there is no discharge time."""
    with pytest.raises(OutflowError, match="blocked"):
        discharge_time(constant_flow(rate=0.0))


def test_an_arch_over_the_slot_is_refused():
    """A box of which only a few per cent flowed out is blocked, not discharged."""
    check_not_blocked(constant_flow(), "log")
    with pytest.raises(OutflowError, match="5% of the particles"):
        check_not_blocked(constant_flow(rate=0.2), "log")


def test_missing_particles_are_refused():
    """Particles present and counted must add up, whether outflow is removed or stays in the lower box."""
    stays = constant_flow()
    check_count(stays, False, "log")
    removed = stays.assign(particles=2000 - stays["count"])
    check_count(removed, True, "log")
    with pytest.raises(OutflowError, match="1000 particles"):
        check_count(removed, False, "log")
    with pytest.raises(OutflowError, match="3 particles"):
        check_count(removed.assign(particles=removed["particles"] - 3 * (removed["time_s"] > 1.0)), True, "log")


LOG = """Step    Atoms         KinEng       rotation         opened         out_kg          out_n
       1      100            1.0            0.0              0              0              0
     101      100            0.0            0.0              0              0              0
Loop time of 0.1
Step    Atoms         KinEng       rotation         opened         out_kg          out_n
     101      100            0.0            0.0              1            0.0              0
     102      100            0.1            0.0              1            0.0              0
Loop time of 0.1
Step    Atoms         KinEng       rotation         opened         out_kg          out_n
     102      100            0.1            0.0              1            0.0              0
     202       60            0.1            0.0              1            0.4             40
Loop time of 0.1
"""


def test_curve_starts_with_the_opening(tmp_path):
    """Time and mass count from the opening on; steps that two runs print count once."""
    (tmp_path / "log").write_text(LOG)
    curve = outflow_curve(tmp_path / "log", time_step=1e-3)
    np.testing.assert_allclose(curve["time_s"], [0.0, 0.001, 0.101])
    np.testing.assert_allclose(curve["mass_kg"], [0.0, 0.0, 0.4])
    check_count(curve, True, tmp_path / "log")


def test_a_box_that_was_never_opened_is_refused(tmp_path):
    """A log that ends before the opening has no outflow."""
    (tmp_path / "log").write_text(LOG[: LOG.index("Loop") + 18])
    with pytest.raises(OutflowError, match="never opened"):
        outflow_curve(tmp_path / "log", time_step=1e-3)


@pytest.mark.parametrize(("column", "word"), [("out_n", "v_out_n"), ("Atoms", "atoms")])
def test_a_column_that_the_deck_does_not_print_is_named(tmp_path, column, word):
    """The fault has the log, the column, and the word that thermo_style lacks."""
    (tmp_path / "log").write_text(LOG.replace(column, "other"))
    with pytest.raises(SolverLogError, match=f"log: found no column {column} .*whose thermo_style has {word} "):
        outflow_curve(tmp_path / "log", time_step=1e-3)


def test_a_clump_is_one_particle(tmp_path):
    """The solver has its spheres, and counts what flows out by clumps: 20 of 50 pairs are 40 %."""
    (tmp_path / "log").write_text(
        LOG.replace("             40", "       19.99999").replace("202       60", "202      100")
    )
    curve = outflow_curve(tmp_path / "log", time_step=1e-3, spheres=2)
    assert curve["particles"].tolist() == [50.0, 50.0, 50.0]
    check_count(curve, False, tmp_path / "log")
    check_not_blocked(curve, tmp_path / "log")
    with pytest.raises(BlockedError, match="20% of the particles flowed out"):
        check_not_blocked(curve.assign(count=[0.0, 0.0, 9.999]), tmp_path / "log")
