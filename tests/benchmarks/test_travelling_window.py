"""The comparison of a full bed with windows: means over packings, their intervals, costs, and that runs go on."""

import numpy as np
import pandas as pd
import pytest

import benchmarks.runs as whole_runs
import benchmarks.window_case as window
from benchmarks import travelling_window
from benchmarks.ratios import ratio_intervals
from benchmarks.travelling_window import BLOCK, at_source_size, comparison, publish, run_row
from benchmarks.window_case import BEDS, FULL, OWN_SEARCH, SOURCE_FRACTION, Case, chain_of, packing, said_beforehand
from bulkwear.workflows.engine.derived import SKIN_OVER_RADIUS
from tests.support.loaded_once import loaded_once

WINDOW, COARSE = "window 100 + 50", "window 150 + 200, time step 0.4"
STUDENT_95_2 = 4.302653  # two-sided 95 % point of Student's t with two degrees of freedom; tables


@pytest.fixture(scope="module", autouse=True)
def studies_loaded_once():
    """Every comparison asks for the source's settings, and both surfaces of a bed are of one study."""
    with loaded_once(travelling_window, window):
        yield


def runs(surface="plain", per_bed=((FULL, (1.0, 4.0), 1000.0, 60.0), (WINDOW, (2.0, 8.0), 200.0, 15.0))):
    """A table of two packings in two beds: J/m, particle-steps, processor seconds."""
    names = {
        "settled_particles_per_m": 25.0,
        "bed_length_m": 2.0,
        "time_step_s": 1e-5,
        "triangles": 100,
        "particles": 50.0,
        "bed_processor_s": 1.0,
    }
    return pd.DataFrame(
        {
            **{"surface": surface, "bed": bed, "seed": seed, "sliding_work_J_per_m": value, "normal_force_N": value},
            "settled_particles_per_m": 25.0,
            "second_half_J_per_m": value * (1.5 if bed == WINDOW else 1.0),
            **{**names, "particle_steps": steps, "processor_s": seconds},
        }
        for bed, values, steps, seconds in per_bed
        for seed, value in enumerate(values)
    )


def blocks(surface="plain"):
    """Two blocks of travel of each of those runs."""
    return pd.DataFrame(
        {**row, "block": block, "sliding_work_J": BLOCK * row["sliding_work_J_per_m"]}
        for row in runs(surface)[["surface", "bed", "seed", "sliding_work_J_per_m"]].to_dict("records")
        for block in (1, 2)
    )


def test_packings_are_what_is_repeated():
    """Logarithms 0, ln 4 and ln 2, ln 8: means ln 2 and ln 4, pooled variance 2 (ln 2)^2, two degrees of freedom; the
    error of a difference of two means of two is then sqrt(2) ln 2.
    """
    table = comparison(runs()).set_index("bed")
    assert list(table["sliding_work_J_per_m"]) == pytest.approx([2.0, 4.0])
    assert list(table["packings"]) == [2, 2]
    assert list(table["scatter"]) == pytest.approx([np.sqrt(2.0) * np.log(2.0)] * 2)
    assert list(table["wear_over_full"]) == pytest.approx([1.0, 2.0])
    reach = STUDENT_95_2 * np.sqrt(2.0) * np.log(2.0)
    assert table["ratio_low"][WINDOW] == pytest.approx(2.0 * np.exp(-reach), rel=1e-6)
    assert table["ratio_high"][WINDOW] == pytest.approx(2.0 * np.exp(reach), rel=1e-6)
    assert table.loc[FULL, ["ratio_low", "ratio_high"]].isna().all()
    assert list(table["freedom"]) == [2, 2]
    assert list(table["second_half_over_full"]) == pytest.approx([1.0, 3.0])
    assert table["second_half_high"][WINDOW] == pytest.approx(3.0 * np.exp(reach), rel=1e-6)
    assert list(table["force_over_full"]) == pytest.approx([1.0, 2.0])  # 2.5 and 5 N, arithmetic means
    assert list(table["cheaper_in_particle_steps"]) == [1.0, 5.0]
    cost = table["cheaper_in_processor_time"]
    assert list(cost) == pytest.approx([1.0, (60.0 + 1.0) / (15.0 + 0.5)])  # beds take 1 s
    longer = (1.0 + 1000.0 / 700.0) / (1.0 + 300.0 / 1200.0)  # the source's run-in and travel (mm), and ours
    assert table["cheaper_with_its_run_in"][WINDOW] == pytest.approx(longer * cost[WINDOW])
    assert list(table["second_half_over_whole"]) == pytest.approx([1.0, 1.5])
    assert table["cheaper_low"][WINDOW] == pytest.approx(cost[WINDOW])  # processor times of these packings are equal


def test_runs_that_another_search_repeats_count_once():
    """Equal to the last digit they add no degrees of freedom; where one differs they are a sample of their own."""
    full, windows = (FULL, (1.0, 4.0), 1.0, 1.0), (WINDOW, (2.0, 8.0), 1.0, 1.0)
    alone = comparison(runs(per_bed=(full, windows))).set_index("bed").loc[WINDOW]
    repeated = comparison(runs(per_bed=(full, (OWN_SEARCH, (1.0, 4.0), 1.0, 1.0), windows))).set_index("bed")
    assert list(repeated.index) == [FULL, OWN_SEARCH, WINDOW]
    assert repeated.loc[WINDOW, "ratio_high"] == alone["ratio_high"] and repeated["freedom"].eq(2).all()
    assert repeated.loc[OWN_SEARCH, "wear_over_full"] == 1.0 and np.isnan(repeated.loc[OWN_SEARCH, "ratio_low"])
    other = comparison(runs(per_bed=(full, (OWN_SEARCH, (1.0, 4.1), 1.0, 1.0), windows))).set_index("bed")
    assert other["freedom"].eq(3).all() and np.isfinite(other.loc[OWN_SEARCH, "ratio_low"])


def test_nothing_finished_leaves_the_tables(tmp_path, monkeypatch, capsys):
    """One sentence, and what an earlier run told stays; of other surfaces its rows stay beside new ones."""
    files = [tmp_path / f"travelling_window{part}.csv" for part in ("", "_blocks")]
    for file, table in zip(files, (runs("convex"), blocks("convex")), strict=True):
        table.to_csv(file, index=False)
    before = [file.read_text() for file in files]
    monkeypatch.setattr("sys.argv", ["x", "--finished", "--folder", str(tmp_path / "none"), "--output", str(tmp_path)])
    with pytest.raises(SystemExit, match="2"):
        travelling_window.main()
    assert "no run is finished" in capsys.readouterr().err and [file.read_text() for file in files] == before
    monkeypatch.setattr(travelling_window, "finished", lambda *asked: ["one"])
    monkeypatch.setattr(travelling_window, "tables_of", lambda done: (runs("plain"), blocks("plain")))
    monkeypatch.setattr(travelling_window, "publish", lambda output, *tables: "")
    travelling_window.main()
    assert all(set(pd.read_csv(file)["surface"]) == {"plain", "convex"} for file in files)


def test_a_window_of_another_width_has_a_bed_of_its_own(tmp_path):
    """And a sample of its own; finished runs are told by what these files hold."""
    case = Case("plain", WINDOW, 1)
    wide = {**window.SETTINGS, "bed": {**window.SETTINGS["bed"], "width_mm": 160}}
    usual, other = (chain_of(case, tmp_path, settings) for settings in (window.SETTINGS, wide))
    assert usual.folder == other.folder and usual.bed_restart != other.bed_restart


def test_cheaper_has_the_interval_of_the_scatter_of_processor_times():
    """Run-ins move both its ends alike. Costs of full bed and window are e and 1/e times 16 s: a ratio of 1."""
    some = runs().assign(bed_processor_s=0.0)
    some["processor_s"] = 16.0 * np.exp(np.where(some["seed"] == 0, 1.0, -1.0))
    found = comparison(some).set_index("bed").loc[WINDOW]
    reach = STUDENT_95_2 * np.sqrt(2.0)  # of a difference of two means of two, each of variance 2
    assert found["cheaper_low"] == pytest.approx(np.exp(-reach), rel=1e-6)
    assert found["cheaper_high"] == pytest.approx(np.exp(reach), rel=1e-6)
    for end in ("low", "high"):
        longer = found[f"with_its_run_in_{end}"] / found[f"cheaper_{end}"]
        assert longer == pytest.approx(found["cheaper_with_its_run_in"])


def test_beds_may_have_unequal_packings():
    """A run that is not finished yet takes nothing from the others; one packing has no interval."""
    some = runs().iloc[:3]
    table = comparison(some).set_index("bed")
    assert list(table["packings"]) == [2, 1] and list(table["freedom"]) == [1, 0]
    assert table["wear_over_full"][WINDOW] == pytest.approx(1.0) and np.isnan(table["ratio_low"][WINDOW])
    assert np.isfinite(table["high"][FULL])
    assert "1 to 2 packings per bed" in travelling_window.remarks(some)[1]


def test_the_scatter_of_one_surface_does_not_widen_the_other():
    """Packings that agree exactly on one surface leave its interval without width, whatever the other does."""
    calm = runs("convex", ((FULL, (3.0, 3.0), 1.0, 1.0), (WINDOW, (3.0, 3.0), 1.0, 1.0)))
    table = comparison(pd.concat([runs(), calm])).set_index(["surface", "bed"])
    assert table["ratio_low"]["convex", WINDOW] == pytest.approx(1.0)
    assert table["ratio_high"]["convex", WINDOW] == pytest.approx(1.0)
    assert table["ratio_high"]["plain", WINDOW] > 2.0


def test_a_single_packing_has_no_interval():
    """One packing says nothing of the scatter: no interval, rather than one without width."""
    table = comparison(runs(per_bed=((FULL, (1.0,), 1.0, 1.0), (WINDOW, (2.0,), 1.0, 1.0))))
    assert list(table["wear_over_full"]) == pytest.approx([1.0, 2.0])
    assert table[["low", "high", "ratio_low", "ratio_high", "scatter"]].isna().all(axis=None)


def test_nothing_to_compare_with_is_refused():
    """Without a run in the full bed there is no ratio."""
    with pytest.raises(ValueError, match="no run of bed of 2 m, stock search, found are window"):
        ratio_intervals(np.array(["window"]), np.array([1.0]), FULL)


def test_page_and_figure_show_both_surfaces(tmp_path):
    """A row per surface and bed, what the intervals rest on, and a picture."""
    both = pd.concat([runs(), runs("convex")], ignore_index=True)
    work = pd.concat([blocks(), blocks("convex")], ignore_index=True)
    page = publish(tmp_path, both, work)
    assert (tmp_path / "travelling_window_results.md").read_text() == page
    assert (tmp_path / "travelling_window.png").stat().st_size > 10_000
    assert f"| plain | {FULL} | 2 | 2 |" in page and f"| convex | {WINDOW} | 2 | 4 |" in page
    assert "2 degrees of freedom" in page and "2 packings" in page


def test_a_row_at_the_sources_size_is_several_times_cheaper():
    """Sample, bed ahead and behind, 20 mm between exchanges, three particles and their skin; and longer steps."""
    rows = at_source_size().set_index("bed")
    short = 0.2 + 0.1 + 0.05 + 0.02 + 3 * 1.2 * 2.65e-3 + 0.5 * SKIN_OVER_RADIUS * 0.8 * 2.65e-3
    length = short + 0.2  # 150 and 200 mm in place of 100 and 50
    assert rows["length_m"][COARSE] == pytest.approx(length, rel=1e-9)
    assert rows["length_m"][WINDOW] == pytest.approx(short, rel=1e-9)
    assert rows["length_m"][OWN_SEARCH] == pytest.approx(2.0)
    assert FULL not in rows.index  # rates know no other search
    assert rows["cheaper_in_particle_steps"][WINDOW] == pytest.approx(2.0 / short)
    steps = BEDS[COARSE]["fraction"] / SOURCE_FRACTION
    assert rows["cheaper_in_particle_steps"][COARSE] == pytest.approx(steps * 2.0 / length, rel=1e-3)  # whole steps
    # of a machine's rates only so much is sure: what goes with steps and surfaces does not shrink with the bed
    assert 0.5 < rows["cheaper_in_core_hours"][COARSE] / rows["cheaper_in_particle_steps"][COARSE] < 1.0


def test_every_run_is_a_chain_of_its_own(tmp_path):
    """Beds, packings and surfaces differ in what they should and in nothing else."""
    cases = packing(window.SURFACES, 0) + packing(window.SURFACES[:1], 1)
    assert len({case.folder for case in cases}) == len(cases) == 3 * len(BEDS)
    chains = {case: chain_of(case, tmp_path, window.SETTINGS) for case in cases}
    full = [chain for case, chain in chains.items() if case.bed == FULL]
    searches = {chain.parameters["solver"]["search"]: case.bed for case, chain in chains.items()}
    assert searches["stock"] == FULL and len(searches) == 2
    assert all(chain.bed["length_m"] == pytest.approx(2.0) for chain in full)
    plain, convex, other = full
    assert plain.bed == convex.bed and plain.parameters["pattern"] is None
    assert convex.parameters["pattern"]["minor_radius_m"] == window.BUMPS["minor_radius_m"]
    assert {**other.bed, "seed": plain.bed["seed"]} == plain.bed and other.bed["seed"] != plain.bed["seed"]
    steps = [chains[Case("plain", bed, cases[0].seed)].parameters["derived"]["time_step_s"] for bed in (WINDOW, COARSE)]
    assert steps[1] / steps[0] == pytest.approx(BEDS[COARSE]["fraction"] / SOURCE_FRACTION, rel=1e-3)


def test_what_there_is_to_do_is_said_beforehand():
    """Twice the packings are twice the particle-steps."""
    words = [said_beforehand(("plain",), packings, window.SETTINGS) for packings in (1, 2)]
    one, two = (float(said.split("runs: ")[1].split()[0]) for said in words)
    assert two == pytest.approx(2.0 * one, rel=0.05)  # two digits are said
    assert one > 1e8


def test_packings_are_published_one_after_another(tmp_path, monkeypatch):
    """After each packing all runs so far are told, in their order, though two processes share them."""
    monkeypatch.setattr(travelling_window, "simulated", as_it_is)
    monkeypatch.setattr(travelling_window, "tables_of", lambda done: (list(done), None))
    told = []
    travelling_window.simulate_all(("plain",), 2, tmp_path, 2, lambda done, _: told.append(done))
    assert [len(done) for done in told] == [len(BEDS), 2 * len(BEDS)]
    cases = packing(("plain",), 0) + packing(("plain",), 1)
    assert told[-1] == list(zip(cases, cases, strict=True))


def as_it_is(case, folder, settings):
    """Stands for a simulation."""
    return case


@pytest.mark.verify
def test_a_stopped_comparison_goes_on(tmp_path, monkeypatch):
    """What is finished is not simulated again; a tiny bed, one window, both looked at block by block."""
    tiny = {
        **window.QUICK,
        "particle_scale": 5.0,
        "bed": {"width_mm": 80, "exchange_mm": 80, "allow_thin_bed": True},
        "sliding": {"run_in_mm": 20, "travel_mm": 200, "cycles": 2},
        "solver": {"picture_interval_mm": 100, "wear_interval_mm": 100},
    }
    case = Case("plain", WINDOW, window.FIRST_SEED)
    window.simulated(case, tmp_path, tiny)
    monkeypatch.setattr(whole_runs, "run_chain", lambda chain: pytest.fail("was done before"))
    monkeypatch.setattr(whole_runs, "fill_bed", lambda *given: pytest.fail("was done before"))
    again = window.simulated(case, tmp_path, tiny)
    monkeypatch.setattr(travelling_window, "SETTINGS", tiny)
    (one,) = travelling_window.finished(("plain",), 2, tmp_path)
    assert one[0] == case
    row_table, found = travelling_window.tables_of([one])
    assert len(row_table) == 1
    assert list(found["block"]) == [1, 2]
    row = run_row(case, again)
    assert found["sliding_work_J"].sum() == pytest.approx(row["sliding_work_J_per_m"] * 2 * BLOCK, rel=1e-3)
    assert found["normal_force_N"].mean() == pytest.approx(row["normal_force_N"], rel=1e-3)
    assert row["second_half_J_per_m"] == pytest.approx(found["sliding_work_J"].iloc[1] / BLOCK, rel=1e-2)
    assert row["particle_steps"] > 0.0 and row["processor_s"] > 0.0
