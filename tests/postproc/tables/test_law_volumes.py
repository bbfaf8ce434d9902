"""Laws side by side from the ledgers of one run: sums, ratios and places in closed form, and what is not comparable."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh, read_surface, write_surface
from bulkwear.postproc.tables.law_volumes import WornBy, law_maps, law_volumes, laws_beside, laws_of_settings, map_table
from bulkwear.postproc.wear.coefficient import PER_PA
from bulkwear.postproc.wear.laws import LAWS

FRICTION, ALPHA, CYCLES = 0.4, 1e-12, 3  # -, 1/Pa, -
ROUNDING = 1e-12  # relative; a few sums
EVEN = np.array([1.0, 1.0, 1.0, 1.0])  # J, on the four triangles that wear
ROOF = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 1], [1, 2, 0], [0, 2, 0]]) * 1e-3  # m; a bump across y
SIDES = np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]])  # the first two look to -y, against the flow


def write_run(folder, without=(), tangential=FRICTION * EVEN, phases=None):
    """A run of some cycles over a bump of four triangles with equal areas, and a holder; Archard wears them alike."""
    flat = flat_plate(1e-3, 1e-3, 1e-3)
    points = np.vstack([ROOF, flat.points + 5e-3])
    triangles = np.vstack([SIDES, flat.triangles + len(ROOF)])
    part = np.r_[np.ones(4, int), np.full(len(flat.triangles), HOLDER_PART)]
    surface, rest = SurfaceMesh(points, triangles, cell_data={"part": part}), np.ones(len(flat.triangles))
    ledger = {"sliding_work_J": EVEN, "tangential_work_J": tangential, "finnie_work_J": 0.1 * EVEN}
    for cycle in range(CYCLES + 1):
        at = folder / f"cycle_{cycle:03d}"
        at.mkdir(parents=True)
        if cycle:
            write_surface(at / "surface.vtu", surface)
            columns = {name: np.r_[values, rest] for name, values in ledger.items() if name not in without}
            pd.DataFrame(columns).to_parquet(at / "ledger.parquet")
    write_surface(folder / "surface.vtu", surface)
    if phases:
        pd.DataFrame({"cycle": range(1, CYCLES + 1), "phase": phases}).to_csv(folder / "wear.csv", index=False)


def table_of(folder, law="archard", laws=None, **given):
    """The table of one run of one packing, by law."""
    write_run(folder / "A_plain", **given)
    run = {"run": "A_plain", "row": "A", "setting": "A", "packing": 1, "surface": "plain"}
    pd.DataFrame([run]).to_csv(folder / "design.csv", index=False)
    worn = laws or [WornBy(law, {"wear_coefficient_per_pa": ALPHA})]
    return law_volumes(folder / "design.csv", [folder / "A_plain"], {"A_plain": worn}, (0.0, 1.0, 0.0))


def test_laws_are_told_from_the_same_ledgers(tmp_path):
    """alpha times the sum of each law over cycles, holder left out; where all slides, shear work over Archard is mu."""
    table = table_of(tmp_path).set_index("law")
    assert table.index.tolist() == ["archard", "tangential_work"]
    assert table.loc["archard", "worn_volume_m3"] == pytest.approx(ALPHA * EVEN.sum() * CYCLES, rel=ROUNDING)
    for name in ("over_study_law", "over_archard"):
        assert table[name].tolist() == pytest.approx([1.0, FRICTION], rel=ROUNDING)
    assert table["overlap"].tolist() == pytest.approx([1.0, 1.0], rel=ROUNDING)
    assert table["front_share"].tolist() == pytest.approx([0.5, 0.5], rel=ROUNDING)


def test_a_ledger_of_touched_faces_and_surfaces_that_are_gone(tmp_path):
    """As of a pin: rows of touched faces alone count as all rows do; cycles whose first surface is gone do not."""
    whole = table_of(tmp_path / "a", tangential=FRICTION * np.array([1.0, 0.0, 1.0, 1.0]))
    touched = table_of(tmp_path / "b", tangential=FRICTION * np.array([1.0, 0.0, 1.0, 1.0]))
    for path in sorted((tmp_path / "b").rglob("ledger.parquet")):
        ledger = pd.read_parquet(path)
        ledger.insert(0, "triangle", np.arange(len(ledger)))
        ledger.iloc[:4].to_parquet(path)  # the holder's are left out
    worn = {"A_plain": [WornBy("archard", {"wear_coefficient_per_pa": ALPHA})]}

    def again():
        return law_volumes(tmp_path / "b" / "design.csv", [tmp_path / "b" / "A_plain"], worn, (0.0, 1.0, 0.0))

    pd.testing.assert_frame_equal(again(), whole)
    (tmp_path / "b" / "A_plain" / "cycle_001" / "surface.vtu").unlink()
    assert (touched["cycles"] == CYCLES).all() and (again()["cycles"] == CYCLES - 1).all()


def test_where_contacts_stick_shear_work_lies_elsewhere(tmp_path):
    """All of it on the front: half of Archard's wear is not there."""
    table = table_of(tmp_path, tangential=FRICTION * np.array([1.0, 1.0, 0.0, 0.0])).set_index("law")
    assert table.loc["tangential_work", ["over_archard", "overlap", "front_share"]].tolist() == pytest.approx(
        [FRICTION / 2.0, 0.5, 1.0], rel=ROUNDING
    )
    assert np.isnan(table.loc["tangential_work", "correlation"])  # of a depth that Archard wears evenly


def test_maps_of_laws_correlate_by_area(tmp_path, monkeypatch):
    """1 with itself, -1 with its mirror image."""
    monkeypatch.setattr("tests.postproc.tables.test_law_volumes.EVEN", np.array([3.0, 3.0, 1.0, 1.0]))
    table = table_of(tmp_path, tangential=np.array([1.0, 1.0, 3.0, 3.0])).set_index("law")
    assert table["correlation"].tolist() == pytest.approx([1.0, -1.0], rel=ROUNDING)
    assert table.loc["tangential_work", "overlap"] == pytest.approx(0.5, rel=ROUNDING)


def test_a_coefficient_of_another_kind_is_not_compared(tmp_path):
    """Ledgers with Finnie's sum serve the laws without kernels too; its volume is set over none of theirs."""
    table = table_of(tmp_path, "finnie").set_index("law")
    assert table.index.tolist() == ["finnie", "archard", "tangential_work"]
    assert table.loc["archard", "over_study_law"] == pytest.approx(10.0, rel=ROUNDING)
    assert table["over_archard"].isna().tolist() == [True, False, False]
    assert table.loc["finnie", "overlap"] == pytest.approx(1.0, rel=ROUNDING)


def test_ledgers_of_an_older_program_leave_a_law_out(tmp_path):
    """Without the work of friction there is no volume by it."""
    assert table_of(tmp_path, without=["tangential_work_J"])["law"].tolist() == ["archard"]


def test_parts_have_laws_and_coefficients_of_their_own(tmp_path):
    """Each with its faces; a label that no face has wears nothing. Blocks of a start-up do not count."""
    worn = WornBy("archard", {"wear_coefficient_per_pa": ALPHA}, "liner", 1)
    both = [worn, replace(worn, part="none", label=7)]
    table = table_of(tmp_path, laws=both, phases=["start_up", "pristine", "worn"])
    assert table["part"].tolist() == ["liner", "liner", "none", "none"]
    volumes = table.set_index(["part", "law"])["worn_volume_m3"]
    assert volumes["liner", "archard"] == pytest.approx(ALPHA * EVEN.sum() * (CYCLES - 1), rel=ROUNDING)
    assert volumes["none"].tolist() == [0.0, 0.0]


def test_laws_of_other_parts_serve_all(tmp_path):
    """A part worn by Archard beside one worn by Finnie has Finnie's volume too, with its own coefficient."""
    worn = WornBy("archard", {PER_PA: ALPHA}, "liner", 1, {"archard": {PER_PA: ALPHA}, "finnie": {PER_PA: 1.0}})
    table = table_of(tmp_path, laws=[worn]).set_index("law")
    assert table.index.tolist() == ["archard", "finnie", "tangential_work"]
    assert table.loc["finnie", "over_study_law"] == pytest.approx(0.1, rel=ROUNDING)


@pytest.mark.parametrize("law", LAWS)
def test_no_other_law_needs_what_the_ledger_lacks(law):
    """Beside the study's law stand laws without parameters whose kernels it has summed."""
    own, *others = laws_beside(law)
    assert own == law and law not in others
    assert all(not LAWS[other].parameters and set(LAWS[other].kernels) <= set(LAWS[law].kernels) for other in others)


def test_only_laws_of_sliding_work_are_set_beside_archard():
    """Their coefficients are volumes over works of contacts that slide; energies of impacts are another thing."""
    assert {name for name, law in LAWS.items() if law.comparable} >= {"archard", "combined", "tangential_work"}
    assert not {name for name in ("finnie", "impact_threshold", "oka") if LAWS[name].comparable}


def test_settings_have_intervals_over_packings():
    """Volumes scatter by a factor, shares do not; one packing leaves the scatter unknown."""
    rows = [("A", 1, 0.2, 0.5), ("A", 2, 0.8, 0.7), ("B", 1, 0.3, 0.9)]
    names = ["setting", "packing", "over_archard", "overlap"]
    volumes = pd.DataFrame(rows, columns=names).assign(law="tangential_work", surface=None, run="", row="")
    found = laws_of_settings(
        volumes.assign(correlation=1.0, front_share=np.nan, worn_volume_m3=[1.0, 4.0, 3.0])
    ).set_index("setting")
    assert found["over_archard"].tolist() == pytest.approx([0.4, 0.3], rel=ROUNDING)  # geometric mean
    assert found["overlap"].tolist() == pytest.approx([0.6, 0.9], rel=ROUNDING)
    assert found["packings"].tolist() == [2, 1]
    assert np.isnan(found.loc["A", "over_first"]) and found.loc["B", "over_first"] == pytest.approx(1.5, rel=ROUNDING)
    assert found.loc["A", "overlap_low"] < 0.6 < found.loc["A", "overlap_high"] and np.isnan(
        found.loc["B", "overlap_low"]
    )


def test_maps_are_over_their_mean(tmp_path):
    """The mean over the area is 1 by each law, and no coefficient matters; all cycles on the same triangles count."""
    write_run(tmp_path, tangential=np.array([3.0, 1.0, 0.0, 0.0]))
    archard, shear = law_maps(tmp_path, [WornBy("archard", {"wear_coefficient_per_pa": ALPHA})])
    assert (archard.law, shear.law, archard.cycles) == ("archard", "tangential_work", CYCLES)
    assert archard.relative_depth[:4].tolist() == pytest.approx([1.0] * 4, rel=ROUNDING)
    assert shear.relative_depth[:4].tolist() == pytest.approx([3.0, 1.0, 0.0, 0.0], rel=ROUNDING)
    assert np.isnan(shear.relative_depth[4:]).all()
    table = map_table("A", [archard, shear])
    assert table.groupby("law")["relative_depth"].mean().tolist() == pytest.approx([1.0, 1.0], rel=ROUNDING)


def test_the_longest_stretch_of_cycles_on_the_same_triangles_is_shown(tmp_path):
    """Remeshed before the last cycle: the two before count, with the areas of their own surface."""
    write_run(tmp_path)
    before = tmp_path / f"cycle_{CYCLES - 1:03d}" / "surface.vtu"  # that the last cycle began with
    surface = read_surface(before)
    write_surface(
        before, SurfaceMesh(surface.points, np.roll(surface.triangles, 1, axis=1), cell_data=surface.cell_data)
    )
    assert law_maps(tmp_path, [WornBy("archard", {"wear_coefficient_per_pa": ALPHA})])[0].cycles == CYCLES - 1
