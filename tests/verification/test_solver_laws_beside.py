"""Laws beside a run's own, on the solver: from one rigid run each law has the map that a run of its own has."""

from dataclasses import replace

import numpy as np
import pytest

from bulkwear.postproc.tables.law_volumes import WornBy, law_maps, maps_of_cycles, told_laws
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.report.laws import what_wears
from tests.support.law_cases import OKA
from tests.support.tiny import tiny_chain, tiny_study
from tests.support.tiny_runs import twin

pytestmark = pytest.mark.solver

RUN = "R9_convex"
THRESHOLD, LOWER = {"threshold_velocity_m_per_s": 0.05}, {"threshold_velocity_m_per_s": 0.02}
COMBINED = {"rolling_ratio": 0.1, "impact_ratio": 10.0, **LOWER}  # the kernel of impact_threshold, otherwise
BESIDE = {"finnie": {}, "oka": OKA, "impact_threshold": THRESHOLD, "combined": COMBINED}


def rigid(**wear):
    """A study of one cycle that keeps its shape."""
    return tiny_study(wear={"deform": False, **wear}, sliding={"cycles": 1})


def maps_of(study, chain, folder):
    """What laws make of the ledger of a run's only wear cycle; the chain brings its surface and bed."""
    chain = replace(twin(chain, folder), parameters=study.run(RUN).parameters)
    cycles.run_chain(chain)
    worn = [WornBy(*each) for each in what_wears(study)[RUN]]
    (maps,) = maps_of_cycles(chain.folder, worn[0], (0.0, 1.0, 0.0))
    return maps, law_maps(chain.folder, worn)


@pytest.mark.verify
def test_one_rigid_run_has_the_maps_of_all_laws(tmp_path):
    """Triangle by triangle, to the last bit, what a run worn by that law alone has; and each law draws a map."""
    chain = tiny_chain(rigid(), tmp_path)
    together, drawn = maps_of(rigid(beside=BESIDE), chain, tmp_path / "together")
    assert told_laws([together]) == ["archard", *BESIDE, "tangential_work"]
    assert [each.law for each in drawn] == ["archard", *BESIDE, "tangential_work"]
    for law in BESIDE:
        alone, _ = maps_of(rigid(law=law, parameters=BESIDE[law]), chain, tmp_path / law)
        assert alone.volumes[law].any()
        np.testing.assert_array_equal(together.volumes[law], alone.volumes[law])
