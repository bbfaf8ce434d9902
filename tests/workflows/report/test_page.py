"""The page of a study: complete, self-contained, its numbers those of the tables."""

import base64
import html
import io
import json
import re
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from workflows.report.figures import (
    FIGURES,
    OF_SERIES,
    figure_file,
    figures_of,
    page_parameters,
    published_rows,
    replicate_settings,
)

from postproc.tables.history import wear_history
from postproc.tables.summary import read_summary, summary_table
from workflows.cases.sliding_sample.screening.plots.regression import DRAWN
from workflows.cases.sliding_sample.screening.regression_tables import regression_tables, screen_summary
from workflows.config.design import REPOSITORY, load_study
from workflows.report.page import TABLE_OF, caption, commit, write_page
from workflows.report.text import UNDEFINED, name_and_unit, number, setting_rows

PUBLISHED = REPOSITORY / "config" / "published"
CYCLES = 2
RUN_WALL, RUN_SOLVER, BED_WALL, BED_SOLVER, OTHER_WALL = 100.0, 90.0, 50.0, 48.0, 2.0  # s, of each job
RELATIVE = 1e-9  # numbers pass through CSV text
PICTURE = b"\x89PNG picture of "
INNER_PAGE = "<!doctype html><html><body><script>const text = \"a < b && 'c'\";</script></body></html>"


def wear_table(volume):
    """wear.csv of a run that wears `volume` m3 in each cycle and applies half of it."""
    cycle = np.arange(1, CYCLES + 1)
    return pd.DataFrame(
        {
            "cycle": cycle,
            "time_s": 0.04 * cycle,
            "travel_m": 0.04 * cycle,
            "sliding_work_J": 1.0,
            "archard_volume_m3": volume,
            "applied_volume_m3": 0.5 * volume,
            "carried_volume_m3": 0.5 * volume * cycle,
            "total_archard_volume_m3": volume * cycle,
            "total_applied_volume_m3": 0.5 * volume * cycle,
            "base_archard_volume_m3": 0.75 * volume,
            "bump_archard_volume_m3": 0.25 * volume,
            "finnie_volume_m3": 0.01 * volume,
            "mean_normal_force_N": 5.0,
            "largest_depth_m": 1e-6,
            "smallest_angle_deg": 30.0,
            "balance_error": 1e-15,
        }
    )


def write_results(folder, study):
    """What the jobs of a study leave, as far as its page reads it. Convex runs wear 0.8 of plain ones."""
    (folder / "figures").mkdir(parents=True)
    (folder / "logs").mkdir()
    pd.DataFrame(study.design_table()).to_csv(folder / "design.csv", index=False)
    for run in study.runs:
        first = folder / run.name / "cycle_001"
        first.mkdir(parents=True)
        wear_table(0.8e-9 if run.surface == "convex" else 1e-9).to_csv(folder / run.name / "wear.csv", index=False)
        cost = {"cycle": [0, 1], "solver_s": RUN_SOLVER / 2, "other_s": 1.0, "steps": 1000, "particles": 500}
        pd.DataFrame(cost).to_csv(folder / run.name / "cost.csv", index=False)
        (first / "deck.in").write_text("# a deck with <angles> & more\n")
        (first / "log.liggghts").write_text("LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, compiled)\n")
        (first / "state.json").write_text(json.dumps({"solver_warnings": {"something odd": 2}}))
    files = [folder / run.name / "wear.csv" for run in study.runs]
    summary_table(folder / "design.csv", files).to_csv(folder / "summary.csv", index=False)
    write_figures(folder, study, files)
    write_costs(folder, study)


def write_figures(folder, study, wear_files):
    """Figures as marked bytes, tables of the two figures that the page reads."""
    for name in figures_of(study):
        path = folder / "figures" / figure_file(name)
        path.write_bytes(INNER_PAGE.encode() if path.suffix == ".html" else PICTURE + name.encode())
        (folder / "figures" / f"{name}.csv").write_text(f"name\n{name}\n")
    faces = [{"run": run.name, "depth_um": 1.0, "area_mm2": 2.0} for run in study.runs]
    pd.DataFrame(faces).to_csv(folder / "figures" / "worn_surface.csv", index=False)
    history = wear_history(folder / "design.csv", wear_files)
    history.to_csv(folder / "figures" / "wear_against_travel.csv", index=False)


def write_costs(folder, study):
    """Benchmark files of every job, the cost of the beds, and a forecast of half of what each run takes."""
    jobs = {f"worn_run_{run.name}": RUN_SOLVER / 2 for run in study.runs}
    jobs |= {f"settled_bed_{bed}": BED_SOLVER for bed in study.beds}
    forecast = pd.DataFrame({"job": jobs.keys(), "solver_s": jobs.values()}).assign(by="rates of a test")
    forecast.to_csv(folder / "forecast.csv", index=False)
    for bed in study.beds:
        (folder / "beds" / bed).mkdir(parents=True)
        (folder / "beds" / bed / "cost.csv").write_text(f"solver_s,steps,particles\n{BED_SOLVER},1000,500\n")
    for job in page_parameters(study)["jobs"]:
        wall = {"worn": RUN_WALL, "settled": BED_WALL}.get(job.split("_")[0], OTHER_WALL)
        wall = OTHER_WALL if job.startswith(("worn_surface", "worn_film")) else wall
        (folder / "logs" / f"{job}.benchmark.tsv").write_text(f"s\th:m:s\n{wall}\t0:00:01\n")


@pytest.fixture
def study(config):
    """A study of two design rows, each convex and plain."""
    return load_study("small", config.root)


@pytest.fixture
def page(study, tmp_path):
    """The text of its page."""
    folder = tmp_path / "results" / study.name
    write_results(folder, study)
    write_page(folder / "report.html", page_parameters(study))
    return (folder / "report.html").read_text(encoding="utf-8")


def embedded(page, name):
    """The table behind a link for download."""
    address = re.search(rf'download="{name}" href="data:text/csv;base64,([^"]+)"', page).group(1)
    return pd.read_csv(io.BytesIO(base64.b64decode(address)))


def test_each_figure_stands_once_with_its_number(page, study):
    """Figures are numbered in order, each with its own picture or page, caption and table."""
    names = figures_of(study)
    assert re.findall(r'<figure id="(\w+)"', page) == names
    assert re.findall(r"<b>Figure (\d+)\.", page) == [str(k + 1) for k in range(len(names))]
    for name in names:
        assert caption(name)[0].replace("'", "&#39;") in page
        picture = base64.b64encode(PICTURE + name.encode()).decode()
        kind = figure_file(name).rpartition(".")[2]
        assert page.count(f'src="data:image/{kind};base64,{picture}"') == (kind in ("png", "gif"))
        assert page.count(f'href="#{name}"') == 1


def test_page_needs_nothing_else(page):
    """No address to load from leaves the page: everything is data, an anchor or a frame's own text."""
    loads = re.findall(r"""(?:src|href|action|poster)\s*=\s*["']([^"']*)["']""", page)
    assert loads
    assert [address for address in loads if not address.startswith(("data:", "#"))] == []
    assert re.findall(r"@import|url\(", page) == []


def test_inner_page_survives_embedding(page):
    """The interactive page is escaped into its frame and comes out as it went in."""
    import html

    frames = re.findall(r'srcdoc="([^"]*)"', page)
    assert [html.unescape(frame) for frame in frames] == [INNER_PAGE]


def test_tables_round_trip(page, study):
    """The tables behind the links are those on disk."""
    for name in figures_of(study):
        table = TABLE_OF.get(name, name)
        found = embedded(page, f"{study.name}_{table}.csv")
        if table not in ("worn_surface", "wear_against_travel"):
            assert found["name"].tolist() == [table]


def test_key_numbers(page, study):
    """Relative wear, wear per metre, share of the bumps and carried share follow from what the runs wear."""
    results = embedded(page, f"{study.name}_key_numbers.csv").set_index("run")
    convex = results.loc["R9_convex"]
    assert convex["wear_over_plain"] == pytest.approx(0.8, rel=RELATIVE)
    assert convex["archard_volume_per_metre_mm3_per_m"] == pytest.approx(CYCLES * 0.8 / (CYCLES * 0.04), rel=RELATIVE)
    assert convex["bump_share_percent"] == pytest.approx(25.0, rel=RELATIVE)
    assert convex["carried_share_percent"] == pytest.approx(50.0, rel=RELATIVE)
    assert convex["lowest_cycle_ratio"] == pytest.approx(0.8, rel=RELATIVE)
    assert results.loc["R9_plain", "wear_over_plain"] == 1.0


def test_real_volume_is_without_acceleration(config, tmp_path):
    """A study accelerated 1e4 times prints volumes per metre as simulated and divided by 1e4."""
    study = load_study("small", config.root, {"wear": {"acceleration": 1e4}})
    write_results(tmp_path / "small", study)
    write_page(tmp_path / "small" / "report.html", page_parameters(study))
    page = (tmp_path / "small" / "report.html").read_text(encoding="utf-8")
    results = embedded(page, "small_key_numbers.csv")
    ratio = results["archard_volume_per_metre_mm3_per_m"] / results["real_volume_per_metre_mm3_per_m"]
    np.testing.assert_allclose(ratio, 1e4, rtol=RELATIVE)
    assert "accelerated 10000 times" in page


def test_share_outside_the_solver(page, study):
    """The number printed is (sum of wall - sum of solver) / sum of wall over all jobs."""
    runs, beds = len(study.runs), len(study.beds)
    others = len(page_parameters(study)["jobs"]) - runs - beds
    wall = runs * RUN_WALL + beds * BED_WALL + others * OTHER_WALL
    share = (wall - runs * RUN_SOLVER - beds * BED_SOLVER) / wall
    assert f"<b>{100.0 * share:.1f} %</b>" in page
    jobs = embedded(page, f"{study.name}_cost.csv")
    assert len(jobs) == runs + beds + others
    assert jobs["wall_s"].sum() == pytest.approx(wall, rel=RELATIVE)


def test_measured_over_forecast(page, study):
    """Each run took twice what was forecast, each bed as long: so says the table, with all in its last row."""
    jobs = embedded(page, f"{study.name}_cost.csv").dropna(subset="measured_over_forecast")
    ratios = {True: 1.0, False: 2.0}
    assert jobs["measured_over_forecast"].tolist() == [ratios[name.startswith("settled")] for name in jobs["job"]]
    runs, beds = len(study.runs), len(study.beds)
    whole = (runs * RUN_SOLVER + beds * BED_SOLVER) / (0.5 * runs * RUN_SOLVER + beds * BED_SOLVER)
    assert f'<td class="n">{whole:.3g}</td></tr>\n</tbody>' in page
    assert "(rates of a test)" in page


def test_provenance_is_there_and_escaped(page, study):
    """Solver version, deck, every run's parameters and the solver's warnings are printed, nothing as markup."""
    assert "LIGGGHTS-PUBLIC 3.8.0" in page
    assert "a deck with &lt;angles&gt; &amp; more" in page
    assert all(f"All parameters of {run.name}" in page for run in study.runs)
    assert f">{CYCLES * len(study.runs)} times<" in page
    for remark in page_parameters(study)["remarks"]:
        assert remark in page


def test_the_page_says_how_the_loads_were_summed(config, page, tmp_path):
    """Sampled contacts are a simplification with their interval; the solver's sum of every step is none."""
    assert "sampled" not in page
    study = load_study("small", config.root, {"ledger": "dumps", "solver": {"sampling_interval_steps": 40}})
    write_results(tmp_path / "sampled", study)
    write_page(tmp_path / "sampled" / "report.html", page_parameters(study))
    text = (tmp_path / "sampled" / "report.html").read_text(encoding="utf-8")
    assert "contacts sampled every 40 steps" in text


def test_the_page_tells_the_law(config, page, tmp_path):
    """Archard's words or Finnie's; the solver's own measure beside Archard's only; figures name another law."""
    assert "Archard: volume = coefficient times normal force" in page and "wears nothing" in page
    study = load_study("small", config.root, {"wear": {"law": "finnie"}})
    write_results(tmp_path / "finnie", study)
    write_page(tmp_path / "finnie" / "report.html", page_parameters(study))
    text = (tmp_path / "finnie" / "report.html").read_text(encoding="utf-8")
    assert "Finnie: volume = coefficient times a function of the impact angle" in text and "wears nothing" not in text
    assert any("worn by the law finnie" in remark for remark in page_parameters(study)["remarks"])


def test_single_row_has_no_figure_of_rows(config):
    """A figure that compares design rows is left out where there is one row, and where nothing is plain."""
    assert figures_of(load_study("small", config.root))[0] == "relative_wear"
    config.edit("studies/small.yaml", "surfaces: [convex, plain]", "surfaces: [convex]")
    assert "relative_wear" not in figures_of(load_study("small", config.root))
    config.edit("studies/small.yaml", "surfaces: [convex]", "surfaces: [convex, plain]")
    config.edit("designs/small.csv", "R5,4,8,60,6.0,2.0,30\n", "")
    assert "relative_wear" not in figures_of(load_study("small", config.root))


def test_only_what_deforms_has_updates_and_a_film(config):
    """The wear updates and the film, a GIF, are of studies that apply wear to the shape."""
    deforming = figures_of(load_study("small", config.root))
    rigid = figures_of(load_study("small", config.root, {"wear": {"deform": False}}))
    assert [name for name in deforming if name not in rigid] == ["worn_film", "wear_updates"]
    assert figure_file("worn_film").endswith(".gif")


def test_captions_have_titles(tmp_path):
    """A caption without an underlined title is refused with its name."""
    (tmp_path / "odd.rst").write_text("Title\ntext\n")
    with pytest.raises(ValueError, match=r"odd\.rst"):
        caption("odd", tmp_path)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.5, "0.5"),
        (1234567, "1\u202f234\u202f567"),
        (20220317, "20\u202f220\u202f317"),
        (6.3e-13, "6.300e-13"),
        (0, "0"),
        (True, "yes"),
        (None, UNDEFINED),
        (float("nan"), UNDEFINED),
        (float("inf"), UNDEFINED),
        ("along_travel", "along travel"),
    ],
)
def test_numbers_for_people(value, shown):
    """Whole numbers keep all digits, others four; what is not there is a dash."""
    assert number(value) == shown


@pytest.mark.parametrize(
    ("key", "name", "unit"),
    [
        ("width_mm", "width", "mm"),
        ("wear_coefficient_per_pa", "wear coefficient", "1/Pa"),
        ("velocity_m_per_s", "velocity", "m/s"),
        ("skirt_slope_deg", "skirt slope", "°"),
        ("sampling_interval_steps", "sampling interval steps", "steps"),
        ("law", "law", ""),
    ],
)
def test_unit_follows_the_suffix(key, name, unit):
    """The name and unit of a setting are those of its key."""
    assert name_and_unit(key) == (name, unit)


def test_settings_tell_what_differs_from_paper():
    """The value at paper fidelity is shown only where it is another one."""
    rows = setting_rows(
        {"scale": 2, "bed": {"width_mm": 1, "seed": 3}}, {"scale": 1, "bed": {"width_mm": 9, "seed": 3}}
    )
    assert rows["study"][0]["paper"] == 1
    assert [row["paper"] for row in rows["bed"]] == [9, None]


def test_commit_is_not_needed(tmp_path):
    """Outside a repository the page says that the commit is not known."""
    assert commit(tmp_path) == "commit not known"


def test_the_page_of_a_pin_needs_no_bed_and_no_sample(tmp_path):
    """Key numbers of a pin on a disc are those of its summary; no run has a bed, and each tells its revolutions."""
    study = load_study("pin_on_disc")
    folder = tmp_path / "results" / study.name
    for name in ("figures", "logs"):
        (folder / name).mkdir(parents=True)
    design = pd.DataFrame(study.design_table())
    due = design["wear_coefficient_per_pa"] * design["load_n"] * design["sliding_distance_m"]
    summary = design.assign(
        **dict.fromkeys(("archard_volume_m3", "removed_volume_m3", "alpha_F_L_volume_m3"), due),
        **dict.fromkeys(("mean_normal_force_N", "mean_vertical_force_N"), 5.0),
        **dict.fromkeys(("carried_volume_m3", "balance_error", "largest_balance_error"), 0.0),
        centroid_path_volume_m3=2.0 * due,
        largest_depth_m=1e-6,
        most_contacts_per_step=3.0,
    )
    summary.to_csv(folder / "summary.csv", index=False)
    for name in figures_of(study):
        path = folder / "figures" / figure_file(name)
        path.write_bytes(PICTURE)
        (folder / "figures" / f"{TABLE_OF.get(name, name)}.csv").write_text("name\n1\n")
    for run in study.runs:
        (folder / run.name).mkdir()
        (folder / run.name / "cost.csv").write_text(f"solver_s,other_s,steps,particles\n{RUN_SOLVER},1,1000,1\n")
    write_costs(folder, study)
    write_page(folder / "report.html", page_parameters(study))
    page = (folder / "report.html").read_text(encoding="utf-8")
    table = embedded(page, f"{study.name}_key_numbers.csv").set_index("run")
    np.testing.assert_allclose(table["removed_over_alpha_F_L"], 1.0, rtol=RELATIVE)
    np.testing.assert_allclose(table["centroid_path_over_alpha_F_L"], 2.0, rtol=RELATIVE)
    assert table.loc["s4", "particle_scale"] == 4.0
    assert "Damping assumed" in page and "Skirt not counted" not in page and "Layers:" not in page


def write_prediction(folder):
    """The prediction of one best design."""
    folder.mkdir()
    row = {"row": "continuous", "major_radius_mm": 2.0, "minor_radius_mm": 4.0, "not_in_model": "a"}
    volumes = dict.fromkeys(("predicted_m3_per_m", "run_low_m3_per_m", "run_high_m3_per_m"), 1e-9)
    pd.DataFrame([row | volumes]).to_csv(folder / "prediction.csv", index=False)


def write_findings(folder):
    """The two tables of findings, a line each."""
    folder.mkdir()
    finding = {
        "key": "x",
        "finding": "R12 wears more",
        "source": "Yan 2022",
        "found": "0.98",
        "verdict": "cannot be said",
    }
    pd.DataFrame([finding | {"reason": "too near to 1"}]).to_csv(folder / "findings.csv", index=False)
    run = {
        "row": "R5",
        "regime": "continuous",
        "published_regime": "",
        "steady": False,
        "published_wear_over_plain": "",
    }
    numbers = ("relative_velocity_percent", "wear_over_plain", "normalised_wear", "force_over_plain")
    numbers += ("interval_low", "interval_high", "published_model", "bottom_spin_over_plain")
    pd.DataFrame([run | dict.fromkeys(numbers, 0.5)]).to_csv(folder / "runs.csv", index=False)


def test_a_study_with_factors_has_a_regression(config, tmp_path):
    """Its figures are drawn, and its page shows models, best designs and every warning."""
    config.edit(
        "studies/small.yaml",
        "surfaces: [convex, plain]",
        "surfaces: [convex, plain]\nfactors: {a: major_radius_mm, b: minor_radius_mm}",
    )
    path = config.path("designs/small.csv")
    path.write_text(path.read_text() + "R1,2,2,20,1.5,0.5,30\nR2,4,2,20,1.5,0.5,30\nR3,4,4,20,1.5,0.5,30\n")
    study = load_study("small", config.root)
    assert {"wear_gradient", "wear_by_regime", "velocity_profiles", "flow_views_second"} <= set(figures_of(study))
    names = [name for name in figures_of(study) if name.startswith("regression_")]
    assert names == [f"regression_{name}" for name in DRAWN]
    assert [job for job in page_parameters(study)["jobs"] if "regression" in job] == ["regression"]
    write_results(tmp_path / "small", study)
    published = [pd.read_csv(PUBLISHED / f"screening_{name}.csv") for name in ("coefficients", "contours")]
    screening = screen_summary(read_summary(tmp_path / "small" / "summary.csv"), study.factors)
    tables = regression_tables(screening, *published)
    (tmp_path / "small" / "regression").mkdir()
    for name, table in tables.items():
        table.to_csv(tmp_path / "small" / "regression" / f"{name}.csv", index=False)
    write_findings(tmp_path / "small" / "findings")
    write_prediction(tmp_path / "small" / "confirmation")
    write_page(tmp_path / "small" / "report.html", page_parameters(study))
    text = html.unescape((tmp_path / "small" / "report.html").read_text(encoding="utf-8"))
    assert "<td>R12 wears more</td>" in text.replace(' <small class="note">Yan 2022</small>', "")
    assert "1 cannot be said" in " ".join(text.split())
    assert embedded(text, "small_findings.csv")["verdict"].tolist() == ["cannot be said"]
    assert len(embedded(text, "small_findings_runs.csv")) == 1
    assert "findings" in page_parameters(study)["jobs"]
    assert "Regression of the wear" in text
    assert "<code>snakemake small_confirmation</code>" in text and "<td>continuous</td>" in text
    assert tables["models"]["model"][0] in text
    for warning in tables["warnings"]["warning"]:
        assert f"Mind: {warning}." in text


def test_published_rows_have_the_published_factors(config):
    """A row is a published one by its factors, whatever its name; R5 of another thickness is none."""
    config.edit("designs/small.csv", "R9,8,2,20,6.0,1.0,40", "own,8,2,20,6.0,1.0,40")
    assert published_rows(load_study("small", config.root)) == {"own": "R9"}
    screening = published_rows(load_study("screening"))
    assert len(screening) == 13 and all(ours == theirs for ours, theirs in screening.items())


REPLICATES = """\
row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm,seed
R9-1,8,2,20,6.0,1.0,40,1000
R9-2,8,2,20,6.0,1.0,40,2000
R5,4,8,60,6.0,2.0,30,1000
"""


def test_rows_that_differ_in_their_seed_are_replicates(config, tmp_path, page):
    """They share a setting, a published row and an interval on the page; without any it says what is not known."""
    assert "scatter from packing to packing is not known" in " ".join(page.split())
    config.write("designs/small.csv", REPLICATES)
    study = load_study("small", config.root)
    assert replicate_settings(study) == {"R9-1": "R9", "R9-2": "R9", "R5": "R5"}
    assert published_rows(study) == {"R9-1": "R9", "R9-2": "R9", "R9": "R9"}
    write_results(tmp_path / "small", study)
    write_page(tmp_path / "small" / "report.html", page_parameters(study))
    text = (tmp_path / "small" / "report.html").read_text(encoding="utf-8")
    assert "95 % of the mean<small>" in text and "is not known" not in text
    assert '<td class="n">0.800 to 0.800</td>' in text  # all convex runs wear 0.8 of plain ones


def test_without_factors_there_is_no_regression(config):
    """Nothing is regressed that a study does not name."""
    assert not any(name.startswith("regression_") for name in figures_of(load_study("small", config.root)))


@pytest.mark.parametrize("left_out", ["mesh", "size"])
def test_pins_without_a_series_have_no_figures_of_it(left_out):
    """A design of pins without its mesh or size series leaves out the figures of that series, and no other."""
    rows = [{"series": series} for series in ("coefficient", *OF_SERIES)]
    whole, fewer = (
        FIGURES["pin_on_disc"](SimpleNamespace(design_rows=chosen))
        for chosen in (rows, [row for row in rows if row["series"] != left_out])
    )
    assert set(whole) - set(fewer) == set(OF_SERIES[left_out])
