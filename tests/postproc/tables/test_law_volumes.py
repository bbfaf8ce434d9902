"""Laws side by side from the ledgers of one run: sums over cycles, ratios, and what a ledger does not suffice for."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh, write_surface
from bulkwear.postproc.tables.law_volumes import law_volumes, laws_beside
from bulkwear.postproc.wear.laws import LAWS

FRICTION, ALPHA, CYCLES = 0.4, 1e-12, 3  # -, 1/Pa, -
ROUNDING = 1e-12  # relative; a few sums


def write_run(folder, without=()):
    """A run of some cycles in which all contacts slide, those on the triangle 1, of the holder, too."""
    plate = flat_plate(1e-3, 1e-3, 1e-3)
    part = np.where(np.arange(len(plate.triangles)) == 1, HOLDER_PART, 0)
    surface = SurfaceMesh(plate.points, plate.triangles, cell_data={"part": part})
    work = np.ones(len(part))  # J
    ledger = {"sliding_work_J": work, "tangential_work_J": FRICTION * work, "finnie_work_J": 0.1 * work}
    for cycle in range(CYCLES + 1):
        at = folder / f"cycle_{cycle:03d}"
        at.mkdir(parents=True)
        if cycle:
            write_surface(at / "surface.vtu", surface)
            columns = {name: values for name, values in ledger.items() if name not in without}
            pd.DataFrame(columns).to_parquet(at / "ledger.parquet")
    write_surface(folder / "surface.vtu", surface)
    return int((part > HOLDER_PART).sum())


def table_of(folder, law, **given):
    """The table of one run, by law, and the number of its triangles that wear."""
    worn = write_run(folder / "A_plain", **given)
    run = {"run": "A_plain", "row": "A", "setting": "A", "packing": 1, "surface": "plain"}
    pd.DataFrame([run]).to_csv(folder / "design.csv", index=False)
    parameters = {"A_plain": (law, {"wear_coefficient_per_pa": ALPHA})}
    return law_volumes(folder / "design.csv", [folder / "A_plain"], parameters).set_index("law"), worn


def test_laws_are_told_from_the_same_ledgers(tmp_path):
    """alpha times the sum of each law over cycles, holder left out; where all slides, shear work over Archard is mu."""
    table, worn = table_of(tmp_path, "archard")
    assert table.index.tolist() == ["archard", "tangential_work"]
    assert table.loc["archard", "worn_volume_m3"] == pytest.approx(ALPHA * worn * CYCLES, rel=ROUNDING)
    assert table["over_study_law"].tolist() == pytest.approx([1.0, FRICTION], rel=ROUNDING)


def test_a_law_of_the_study_comes_first_and_lends_its_kernels(tmp_path):
    """Ledgers with Finnie's sum serve the laws without kernels too, and are the measure of them."""
    table, _ = table_of(tmp_path, "finnie")
    assert table.index.tolist() == ["finnie", "archard", "tangential_work"]
    assert table.loc["archard", "over_study_law"] == pytest.approx(10.0, rel=ROUNDING)


def test_ledgers_of_an_older_program_leave_a_law_out(tmp_path):
    """Without the work of friction there is no volume by it."""
    assert table_of(tmp_path, "archard", without=["tangential_work_J"])[0].index.tolist() == ["archard"]


@pytest.mark.parametrize("law", LAWS)
def test_no_other_law_needs_what_the_ledger_lacks(law):
    """Beside the study's law stand laws without parameters whose kernels it has summed."""
    own, *others = laws_beside(law)
    assert own == law and law not in others
    assert all(not LAWS[other].parameters and set(LAWS[other].kernels) <= set(LAWS[law].kernels) for other in others)
