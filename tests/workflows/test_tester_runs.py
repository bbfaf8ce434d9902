"""Two runs of a tiny circular wear tester with LIGGGHTS, and the tables and figures that are made of them."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from tiny_tester import ROWS, chain_of_tester, tiny_tester

from postproc.analysis.bed import last_snapshot, read_snapshot
from postproc.mesh import read_surface
from postproc.readers.solver_log import thermo_table
from workflows import cycles, tester_deck, tester_figures, tester_results
from workflows.derived import neighbour_skin
from workflows.pages.circular_tester import run_values
from workflows.state import read_state

pytestmark = pytest.mark.solver

REVOLUTIONS = 2
ROUND_OFF = 1e-9
# Mean normal force on a plain top over the weight of the bed above it, at rest. A plough's front is loaded more; 700
# particles, three of them above one another, arch over 40 mm. Seen 0.63; the source's model has 15 to 18 N over 12.8.
LEAST_FORCE, LARGEST_FORCE = 0.35, 2.0
LEAST_PACE = 0.5  # -, of the bed over its floor: sample and consolidator hold a short channel back; seen 0.8
ON_TOP = 5e-4  # m, of mean contact points from the plain top: it wears by less, and spheres sink in by less


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Both runs, finished, below one folder of results."""
    study, folder = tiny_tester(), tmp_path_factory.mktemp("tester")
    chains = {run: chain_of_tester(study, folder, run) for run in ROWS}
    for chain in chains.values():
        cycles.run_chain(chain)
    return SimpleNamespace(study=study, folder=folder, chains=chains)


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
    np.testing.assert_allclose(wear["archard_volume_m3"], coefficient * wear["sliding_work_J"], rtol=ROUND_OFF)
    assert (wear["archard_volume_m3"] > 0.0).all()
    ledger = pd.read_parquet(chain.folder / "cycle_001" / "ledger.parquet").set_index("triangle")
    surface = read_surface(chain.surface)
    worked = ledger[(ledger["sliding_work_J"] > 0.0) & (surface.cell_data["part"][ledger.index] == 0)]
    assert len(worked) and (worked["contact_position_z_m"].abs() < ON_TOP).all()
    assert not (surface.points[np.unique(surface.triangles[surface.cell_data["part"] >= 0]), 2] < 0.0).any()
    state = read_state(chain.folder, 1)
    np.testing.assert_allclose(state["pose"], tester_deck.pose(chain.parameters["tester"]))


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


def test_tables_and_figures_are_made_of_the_runs(finished, repository, tmp_path):
    """Volumes, scale of time, comparison and series; every figure of a study of two rows with its table."""
    study, published = finished.study, repository / "config" / "published"
    paths = {"published": published / "circular_tester.csv"}
    paths["published_fits"] = published / "circular_tester_volume.csv"
    runs = tester_figures.tester_runs([run_values(study, run) for run in study.runs], finished.folder)
    tester_figures.write_tables(runs, tmp_path, paths)
    lost = pd.read_csv(tmp_path / "lost_volumes.csv")
    for run, chain in finished.chains.items():
        wear = pd.read_csv(chain.folder / "wear.csv")
        of_run = lost[lost["run"] == run]
        np.testing.assert_allclose(of_run["volume_m3"].iloc[1:], wear["total_applied_volume_m3"], rtol=1e-6)
        assert of_run["volume_m3"].iloc[0] == 0.0
    compared = pd.read_csv(tmp_path / "comparison.csv")
    plain = compared[(compared["hours"] == 56) & (compared["quantity"] == "plain volume")]
    assert plain["ours"].iloc[0] == pytest.approx(145.2, rel=1e-6)  # it sets the scale of time
    series = pd.read_csv(tmp_path / "series.csv")
    sliding = study.settings["sliding"]
    before = sliding["steady_revolutions"] + sliding["run_in_revolutions"]
    np.testing.assert_allclose(series["revolution"] - series["worn_revolution"], before, atol=1e-6)
    assert series["revolution"].max() == pytest.approx(before + REVOLUTIONS, abs=1e-6)
    figures = tmp_path / "study" / "figures"
    figures.mkdir(parents=True)
    job = tester_figures.Drawing(runs, tmp_path, figures, paths, ["tiny, for tests"])
    for name in ("tester_volumes", "tester_flow", "tester_distribution"):
        tester_figures.JOBS[name](job)
    (figures.parent / "tester").symlink_to(tmp_path)
    for text, word in (
        (tester_results.comparison_text(figures.parent), "| 56 | plain volume | mm3 | 145.2 |"),
        (tester_results.fit_text(figures.parent), "Eq 6.6"),
        (tester_results.ratio_text(figures.parent), "| channel | 4 | 2 |"),
        (tester_results.steady_text(figures.parent), "wear rate m3 per s"),
        (tester_results.distribution_text(figures.parent), "% on bumps"),
    ):
        assert word in text
    assert tester_results.worn_out_text(figures.parent) == ""
    drawn = {path.stem for path in figures.glob("*.png")}
    assert drawn == {path.stem for path in figures.glob("*.csv")} and len(drawn) == 14
