"""Two runs of a tiny circular wear tester with LIGGGHTS, and the tables and figures that are made of them."""

import re
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.bed import last_snapshot, read_snapshot
from bulkwear.postproc.mesh import read_surface, worn_faces
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.postproc.statistics.verdicts import UNSAID
from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.cases.circular_tester import distribution as tester_distribution
from bulkwear.workflows.cases.circular_tester.key_numbers import result_table
from bulkwear.workflows.cases.circular_tester.page import sections
from bulkwear.workflows.cases.circular_tester.runs import pairs_of, runs_of_values, values_of_runs
from bulkwear.workflows.cases.circular_tester.sensitivity import numbers_of_pair
from bulkwear.workflows.cases.circular_tester.sensitivity_figures import CLAIMS_PART, TOLD_ELSEWHERE
from bulkwear.workflows.cases.circular_tester.source import PUBLISHED
from bulkwear.workflows.config.claims import claims_of
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.beds import MASS_TOLERANCE, MEASURES, bed_fault, read_measures
from bulkwear.workflows.engine.derived import neighbour_skin
from bulkwear.workflows.engine.job import write_table
from bulkwear.workflows.engine.state import read_state
from bulkwear.workflows.report.beds import BEDS
from bulkwear.workflows.report.markdown import write_results
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.products import figures_of
from tests.support.tiny import tiny_chain
from tests.support.tiny_tester import ROWS, make_products, tiny_tester

pytestmark = pytest.mark.solver

REVOLUTIONS = 2
LONG_STEPS = {"rayleigh_fraction": 0.4}  # as in the study
REMARKS = ["tiny, for tests"]
AS_SOURCE = {"foreign": {}}  # published numbers stand beside the tiny machine's, which has another size
DRAWN_ELSEWHERE = ["worn_surface", "worn_surface_3d", "wear_updates"]  # of every case
ROUND_OFF = 1e-9
# Mean normal force on a plain top over the weight of the bed above it, at rest. A plough's front is loaded more; 700
# particles, three of them above one another, arch over 40 mm. Seen 0.63; the source's model has 15 to 18 N over 12.8.
LEAST_FORCE, LARGEST_FORCE = 0.35, 2.0
LEAST_PACE = 0.5  # -, of the bed over its floor: sample and consolidator hold a short channel back; seen 0.8
ON_TOP = 5e-4  # m, of mean contact points from the plain top: it wears by less, and spheres sink in by less


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Both runs, finished, below one folder of results."""
    study, root = tiny_tester(solver=LONG_STEPS), tmp_path_factory.mktemp("tester")
    folder = root / "results" / study.name
    chains = {run: tiny_chain(study, folder, run) for run in ROWS}
    for chain in chains.values():
        cycles.run_chain(chain)
    return SimpleNamespace(study=study, root=root, folder=folder, chains=chains)


@pytest.mark.parametrize("run", ROWS)
def test_no_particle_is_lost_and_revolutions_are_counted(finished, run):
    """Every log has the bed's particles in every line; cycles end at half and whole revolutions."""
    chain = finished.chains[run]
    bed = thermo_table(chain.bed_restart.parent / "log.liggghts")["Atoms"][-1]
    logs = [thermo_table(folder / "log.liggghts") for folder in sorted(chain.folder.glob("cycle_*"))]
    assert set(np.concatenate([log["Atoms"] for log in logs])) == {bed}
    wear = pd.read_csv(chain.folder / "wear.csv")
    assert wear["revolution"].tolist() == pytest.approx([0.5, 1.0, 1.5, 2.0], abs=ROUND_OFF)
    assert (wear["particles"] == bed).all()
    seconds = REVOLUTIONS * chain.parameters["derived"]["revolution_s"]
    assert wear["time_s"].iloc[-1] == pytest.approx(seconds, rel=ROUND_OFF)
    bed = read_snapshot(last_snapshot(chain.folder))
    skin = neighbour_skin(chain.parameters["particle"])  # a particle comes round when the lists are made anew
    assert (bed["x_m"].abs() < tester_deck.half_width(chain.bed)).all()
    assert (bed["y_m"].abs() < 0.5 * tester_deck.channel_length(chain.bed) + skin).all()
    assert (bed["z_m"] > tester_deck.floor(chain.bed)).all()


def test_the_bed_is_as_asked(finished):
    """What is poured stays, and the consolidator levels it; asked to be deeper it is refused with three numbers."""
    chain = next(iter(finished.chains.values()))
    measures = pd.read_csv(chain.bed_restart.parent / MEASURES).set_index("measure")
    assert measures.index.tolist() == ["mass", "level", "depth"] and not measures["missed"].any()
    poured = chain.case.bed_deck(chain.bed)["poured_mass_kg"]
    assert measures.loc["mass", "asked"] == poured == pytest.approx(measures.loc["mass", "found"], rel=MASS_TOLERANCE)
    deeper = chain.bed | {"bed_height_m": chain.bed["bed_height_m"] + 0.02}
    fault = bed_fault(chain.case.bed_measures(deeper, chain.bed_restart.parent / "log.liggghts"))
    number = r"\d[\d.e-]* {} \(asked \d[\d.e-]* within \d[\d.e-]*\)"
    words = ", ".join(
        f"{name} {number.format(unit)}" for name, unit in (("mass", "kg"), ("level", "m"), ("depth", "m"))
    )
    assert re.fullmatch(f"the bed is not as asked: {words}", fault)


@pytest.mark.parametrize("shape", ["channel", "ring"])
def test_a_bed_of_larger_particles_is_as_asked(shape, tmp_path):
    """A ring's bed as well as a channel's, at scale 6 in a narrow trough, has its mass, level and depth."""
    trough = {"inner_radius_mm": 30, "outer_radius_mm": 126, "channel_deg": 115, "depth_mm": 50}
    level = {"bed_height_mm": 104, "consolidator_level_mm": 104}
    study = tiny_tester(
        rows=["plain"],
        particle_scale=6,
        sample={"width_mm": 17, "length_mm": 17},
        tester={"shape": shape, **trough, **level},
        solver=LONG_STEPS,
    )
    ((name, bed),) = study.beds.items()
    cycles.fill_bed(study.case, name, bed, tmp_path)
    measures = read_measures(tmp_path)
    assert [each.measure for each in measures] == ["mass", "level", "depth"] and bed_fault(measures) is None
    raised = bed | {"depth_m": bed["depth_m"] + 0.02, "bed_height_m": bed["bed_height_m"] + 0.02}
    assert all(each.missed for each in study.case.bed_measures(raised, tmp_path / "log.liggghts"))


@pytest.mark.verify
def test_a_longer_run_goes_on_from_a_shorter_one(finished, tmp_path):
    """Shortened, a run keeps its first cycles, without the solver; lengthened again, also where nothing but those is
    left, it ends in the very table of the run that was that long from the start.
    """
    whole = finished.chains["plain"]
    folder = shutil.copytree(whole.folder, tmp_path / "plain")
    shorter = tiny_tester(solver=LONG_STEPS, sliding={"revolutions": 1}).run("plain").parameters
    half = replace(whole, folder=folder, parameters=shorter)
    cycles.run_chain(half)
    expected = pd.read_csv(whole.folder / "wear.csv")
    pd.testing.assert_frame_equal(pd.read_csv(folder / "wear.csv"), expected.iloc[:2])
    shutil.rmtree(folder / "superseded")
    cycles.run_chain(replace(whole, folder=folder))
    pd.testing.assert_frame_equal(pd.read_csv(folder / "wear.csv"), expected)


def test_the_trough_takes_the_bed_along(finished):
    """The bed never overtakes its trough, and follows it."""
    for chain in finished.chains.values():
        wear = pd.read_csv(chain.folder / "wear.csv")
        assert wear["bed_over_floor_velocity"].between(LEAST_PACE, 1.0).all()


def test_the_sample_carries_about_the_bed_above_it(finished):
    """Normal force on the plain top over the weight of the bed over it."""
    chain = finished.chains["plain"]
    wear, sample = pd.read_csv(chain.folder / "wear.csv"), chain.parameters["sample"]
    weight = chain.parameters["derived"]["bulk_pressure_pa"] * sample["width_m"] * sample["length_m"]
    assert LEAST_FORCE < wear["mean_normal_force_N"].mean() / weight < LARGEST_FORCE


@pytest.mark.parametrize("run", ROWS)
def test_wear_is_that_of_the_law_and_stays_in_the_samples_frame(finished, run):
    """Volume is coefficient times work; contacts lie on the sample as the master surface has it, not inclined."""
    chain = finished.chains[run]
    wear = pd.read_csv(chain.folder / "wear.csv")
    coefficient = chain.parameters["wear"]["accelerated_wear_coefficient_per_pa"]
    np.testing.assert_allclose(wear["worn_volume_m3"], coefficient * wear["sliding_work_J"], rtol=ROUND_OFF)
    assert (wear["worn_volume_m3"] > 0.0).all()
    ledger = pd.read_parquet(chain.folder / "cycle_001" / "ledger.parquet").set_index("triangle")
    surface = read_surface(chain.surface)
    worked = ledger[(ledger["sliding_work_J"] > 0.0) & (surface.cell_data["part"][ledger.index] == 0)]
    assert len(worked) and (worked["contact_position_z_m"].abs() < ON_TOP).all()
    assert not (surface.points[np.unique(surface.triangles[surface.cell_data["part"] >= 0]), 2] < 0.0).any()
    state = read_state(chain.folder, 1)
    np.testing.assert_allclose(state["pose"], tester_deck.pose(chain.parameters["tester"]))


@pytest.mark.parametrize("run", ROWS)
def test_the_front_that_ploughs_does_not_count(finished, run):
    """Volume and normal force are those of the faces that wear; front, sides and bottom of the holder bear work too."""
    chain = finished.chains[run]
    wear = pd.read_csv(chain.folder / "wear.csv").iloc[0]
    ledger = pd.read_parquet(chain.folder / "cycle_001" / "ledger.parquet").set_index("triangle")
    surface = read_surface(chain.surface)
    counts = worn_faces(surface)[ledger.index]
    coefficient = chain.parameters["wear"]["accelerated_wear_coefficient_per_pa"]
    assert ledger["sliding_work_J"][~counts].sum() > 0.0
    assert wear["worn_volume_m3"] == pytest.approx(coefficient * ledger["sliding_work_J"][counts].sum(), rel=ROUND_OFF)
    force = ledger["normal_impulse_N_s"][counts].sum() / wear["time_s"]
    assert wear["mean_normal_force_N"] == pytest.approx(force, rel=ROUND_OFF)
    worn = read_surface(chain.folder / "worn_surface.vtu")
    borders = tester_distribution.column_borders(read_surface(finished.chains["convex"].surface))
    table = tester_distribution.wear_by_column({run: worn}, borders)
    total = pd.read_csv(chain.folder / "wear.csv")["total_worn_volume_m3"].iloc[-1]
    assert 1e-9 * table[["base_mm3", "bumps_mm3"]].to_numpy().sum() == pytest.approx(total, rel=1e-6)


def test_a_convex_sample_has_a_pattern_to_lose(finished):
    """What is left of the bumps never grows; a plain sample has none."""
    left = {run: pd.read_csv(chain.folder / "wear.csv")["pattern_volume_m3"] for run, chain in finished.chains.items()}
    assert (left["plain"] == 0.0).all()
    assert (left["convex"] > 0.0).all() and (left["convex"].diff().dropna() <= 0.0).all()


def test_snapshots_become_a_table_of_the_lowest_layer(finished):
    """One snapshot per cycle stays; all of them are in the table, by revolution."""
    for folder in sorted(finished.chains["plain"].folder.glob("cycle_*"))[1:]:
        table = pd.read_csv(folder / "lowest_layer.csv")
        assert len(list(folder.glob("bed_*.dump"))) == 1
        assert len(table) >= 3 and (table["particles"] > 0).all()
        assert table["revolution"].between(0.0, REVOLUTIONS).all()


@pytest.fixture(scope="module")
def tables(finished):
    """The tables of the study by name."""
    make_products(
        finished.study, finished.root, ["tester_runs", "tester_numbers", "beds", "beds_in_use"], REMARKS, AS_SOURCE
    )
    written = [*(finished.folder / "tester").glob("*.csv"), finished.folder / BEDS]
    return {path.stem: pd.read_csv(path) for path in written}


def test_numbers_of_a_pair_are_those_of_its_tables(finished, tables):
    """Every published number of a setting is found; volumes, slip and shares are those of other tables of the runs."""
    runs = runs_of_values(values_of_runs(finished.study), finished.folder)
    patterned, plain = pairs_of(runs)[0]
    found = numbers_of_pair(patterned, plain, pd.read_csv(PUBLISHED))
    claims, bumps = claims_of(CLAIMS_PART), {f"loss_{bump}" for bump in tester_distribution.SHOWN_BUMPS}
    too_short = bumps | {
        "convex_volume_56_h",
        "convex_volume_184_h",
    }  # a small sample loses little, and has fewer bumps
    assert set(claims) - set(found) == too_short and set(found) <= set(claims)
    assert all(np.isfinite(value) and value > 0.0 for value in found.values())
    lost = tables["lost_volumes"].groupby("run")["volume_m3"].last() * 1e9
    assert found["plain_volume"] == pytest.approx(lost["plain"] / REVOLUTIONS, rel=1e-6)
    assert found["loss_ratio"] == pytest.approx(lost["convex"] / lost["plain"], rel=1e-6)
    wear = pd.read_csv(finished.chains["plain"].folder / "wear.csv")
    assert found["plain_force"] == pytest.approx(wear["mean_normal_force_N"].mean(), rel=0.02)  # by looks, by cycles
    law = plain.coefficient * found["plain_force"] * found["plain_slip"] * plain.distance_per_revolution * 1e9
    assert found["plain_volume"] == pytest.approx(law, rel=0.02)


def test_tables_are_made_of_the_runs(finished, tables):
    """Volumes, scale of time, comparison, series and findings."""
    lost = tables["lost_volumes"]
    for run, chain in finished.chains.items():
        wear = pd.read_csv(chain.folder / "wear.csv")
        of_run = lost[lost["run"] == run]
        np.testing.assert_allclose(of_run["volume_m3"].iloc[1:], wear["total_applied_volume_m3"], rtol=1e-6)
        assert of_run["volume_m3"].iloc[0] == 0.0
    (bed,) = tables["beds"].to_dict("records")
    assert bed["bed"] == "bed_plain" and abs(bed["level_found_mm"] - 72.0) <= bed["level_tolerance_mm"] < 10.0
    used = tables["beds_in_use"].set_index("run")
    assert set(used.index) == set(ROWS) and set(used["bed"]) == {"bed_plain"}
    assert used["mass_in_use_kg"].tolist() == pytest.approx([bed["mass_found_kg"]] * 2, rel=1e-3)  # by the log's digits
    assert (used["level_in_use_mm"] - bed["level_found_mm"]).abs().max() < 0.5 * bed["level_tolerance_mm"]
    heights = tables["series"].dropna(subset="bed_height_m")
    turned = finished.study.settings["sliding"]["steady_revolutions"]
    run_in = heights[(heights["revolution"] > turned) & (heights["worn_revolution"] < 0.0)]
    over = 1e3 * run_in.groupby("run")["bed_height_m"].mean()
    assert used["over_sample_in_use_mm"].to_dict() == pytest.approx(over.to_dict(), rel=0.02)  # the first row left out
    compared = tables["comparison"]
    plain = compared[(compared["hours"] == 56) & (compared["quantity"] == "plain volume")]
    assert np.isnan(plain["ours"].iloc[0]) and "more than 2 times" in plain["note"].iloc[0]  # it is 5000 revolutions
    loss = compared[compared["quantity"] == "largest loss of C11"].iloc[0]
    assert loss["experiment"] == 0.34 and loss["ours"] > 0.0
    series = tables["series"]
    sliding = finished.study.settings["sliding"]
    before = sliding["steady_revolutions"] + sliding["run_in_revolutions"]
    np.testing.assert_allclose(series["revolution"] - series["worn_revolution"], before, atol=1e-6)
    assert series["revolution"].max() == pytest.approx(before + REVOLUTIONS, abs=1e-6)
    wear = series.dropna(subset="wear_rate_m3_per_s")
    per_revolution = wear.groupby(["run", np.floor(wear["worn_revolution"])]).size()
    assert (per_revolution == finished.study.settings["solver"]["looks_per_revolution"]).all()
    assert (tables["findings"]["verdict"] == UNSAID).all()  # of one packing


def test_published_numbers_stand_beside_ours(finished, tables):
    """Those of claims that no finding judges already; the force is that of the cycles."""
    table = tables["published_numbers"].set_index("finding")
    claims = {key: claim for key, claim in claims_of(CLAIMS_PART).items() if key not in TOLD_ELSEWHERE}
    assert set(table.index) <= {claim.finding for claim in claims.values()} and len(table) >= 8
    force = pd.read_csv(finished.chains["plain"].folder / "wear.csv")["mean_normal_force_N"].mean()
    found = float(table.loc["Normal force, plain", "found"].split(" N ")[0])
    assert found == pytest.approx(force, rel=0.02)  # by looks, by cycles


@pytest.fixture(scope="module")
def drawn(finished, tables):
    """The names of the tester's own figures of a study of two rows, all of them drawn; runs are summed up."""
    study, folder = finished.study, finished.folder
    names = [product.name for product in figures_of(study) if product.name not in DRAWN_ELSEWHERE]
    write_table(folder / "design.csv", study.design_table())
    make_products(study, finished.root, ["volume_by_law", *names], REMARKS, AS_SOURCE)
    wear = [chain.folder / "wear.csv" for chain in finished.chains.values()]
    study.case.summary(folder / "design.csv", wear, [], []).to_csv(folder / "summary.csv", index=False)
    jobs = [*(f"worn_run_{run}" for run in ROWS), "settled_bed_bed_plain"]
    pd.DataFrame({"job": jobs, "solver_s": 50.0}).to_csv(folder / "forecast.csv", index=False)
    return names


@pytest.mark.verify
def test_every_figure_has_its_table(finished, drawn):
    """A study of one pair has fourteen figures of its own and two of several laws, and a table beside each."""
    there = {path.name for path in (finished.folder / "figures").iterdir()}
    assert there >= {f"{name}.{ending}" for name in drawn for ending in ("png", "csv")} and len(drawn) == 16


@pytest.mark.verify
def test_contacts_never_outrun_the_trough(finished, drawn, tables):
    """Sliding over travel is between 0 and 1 for every run."""
    told = result_table(pd.read_csv(finished.folder / "summary.csv"))
    assert told["sliding_over_travel"].between(0.0, 1.0, inclusive="neither").all()


@pytest.mark.verify
def test_every_figure_has_its_section(finished, drawn):
    """Sections name all figures of the study but the wear updates; no section is there for a series that no row has."""
    shown = sections(page_parameters(finished.study), finished.folder)
    named = [name for section in shown for block in section.blocks for name in getattr(block, "names", ())]
    assert len(named) == len(set(named)) and {*drawn, "worn_surface"} <= set(named) and "wear_updates" not in named
    empty = [section.title for section in shown if len(section.blocks) == 1]
    assert empty == ["Until the pattern is gone", "The lowest layer", "Elements"]
    alone = sections(page_parameters(finished.study) | {"told": {"paired": False, "foreign": {}}}, finished.folder)
    assert [section.title for section in alone] == [
        "Every run",
        "Beds",
    ]  # whatever tables an earlier choice of rows has left


@pytest.mark.verify
def test_the_page_of_results_is_made_of_the_tables(finished, drawn, tmp_path):
    """It shows every figure and says what was found, without a section for a pattern that no row wears off."""
    figures = finished.folder / "figures"
    shutil.copy(figures / f"{drawn[0]}.png", figures / "worn_surface.png")
    write_table(figures / "worn_surface.csv", [{"run": run, "depth_um": 1.0, "area_mm2": 1.0} for run in ROWS])
    text = write_results(finished.folder, tmp_path, finished.study).read_text(encoding="utf-8")
    words = (
        "| 56 | plain volume | mm3 | 145.2 | 147.3 |",
        "more than 2 times the simulated revolutions; one packing, scatter unknown",
        f"{len(claims_of('circular_tester'))} {UNSAID}",
        "| Normal force, plain |",
        "Eq 6.6",
        "| channel | 4 | 2 | 1 |",
        "wear rate m3 per s",
        "## Durations",
    )
    assert [word for word in words if word not in text] == []
    assert "Until the pattern" not in text and "Elements" not in text and text.count("![") == len(drawn) + 1
    assert len(list(tmp_path.glob("*.png"))) == len(drawn) + 1
