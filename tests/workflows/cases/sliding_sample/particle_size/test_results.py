"""Pages of a study of particle size, the HTML one and the one in docs, on tables of three made-up rows."""

import pandas as pd
import pytest
from matplotlib.figure import Figure
from workflows.report.figures import bumps_and_particles, figures_of, page_parameters

from tests.support.finished_runs import leave_runs
from workflows.cases.sliding_sample.key_numbers import sizes
from workflows.cases.sliding_sample.particle_size.guidance import Particles, Pattern, guidance_table
from workflows.cases.sliding_sample.particle_size.published_sizes import (
    beside_the_source,
    critical_sentences,
    packing_beside_the_source,
)
from workflows.cases.sliding_sample.particle_size.results import PICTURES, write_results
from workflows.cases.sliding_sample.particle_size.wear_by_scale import (
    beside_published,
    critical_scale,
    wear_by_scale,
    wear_lines,
)
from workflows.config.design import REPOSITORY, load_study
from workflows.report.page import environment

PUBLISHED = REPOSITORY / "config" / "published"
WEAR = {4.0: 1.1, 6.0: 1.4, 8.0: 2.1}  # -, of the convex sample, over its plain twin's
PRINTED = 0.005  # three digits of numbers around 1
FORCE = {4.0: 1.5, 6.0: 1.6, 8.0: 1.7}  # -, of the convex sample, over its plain twin's
LAYERS = {"S4": 4.3, "S6": 2.9, "S8": 2.2}  # 46 mm over 2.65 mm times the scale


@pytest.fixture
def study():
    return load_study("particle_size")


def summary(study):
    rows = []
    for run in study.runs:
        scale, convex = run.parameters["particle"]["scale"], run.surface == "convex"
        volume = 2e-9 * (WEAR[scale] if convex else 1.0)
        bumps = 0.8 * volume if convex else 0.0
        rows.append(
            {
                "run": run.name,
                "row": run.row,
                "surface": run.surface,
                "particle_scale": scale,
                "archard_volume_m3": volume,
                "base_archard_volume_m3": volume - bumps,
                "bump_archard_volume_m3": bumps,
                "archard_volume_per_metre_m3_per_m": volume / 0.8,
                "mean_normal_force_N": 20.0 * (FORCE[scale] if convex else 1.0),
            }
        )
    return pd.DataFrame(rows)


def write_sizes(folder, study, table):
    """What the jobs of the figures leave in particle_size/ and figures/."""
    (folder / "particle_size").mkdir()
    (folder / "figures").mkdir()
    lines = pd.read_csv(PUBLISHED / "particle_size_lines.csv")
    wear = wear_by_scale(table)
    beside_published(wear_lines(wear), lines).to_csv(folder / "particle_size" / "lines.csv", index=False)
    given = bumps_and_particles(study)
    patterns = {row: Pattern(**each["pattern"]) for row, each in given.items()}
    real, scales = Particles(**given["S4"]["particles"]), {row: each["scale"] for row, each in given.items()}
    guidance_table(patterns, real, scales, lines).to_csv(folder / "particle_size" / "guidance.csv", index=False)
    names = table[["run", "row", "surface", "particle_scale"]]
    steady = names.assign(measure="relative_velocity", mean_percent=12.0, deviation_percent=1.0, steady=True)
    steady.to_csv(folder / "figures" / "steady_by_scale.csv", index=False)
    profiles = names.assign(height_mm=10.0, velocity_m_per_s=0.3)
    measures = {"coordination_number": 5.2, "porosity": 0.42, "porosity_whole_particles": 0.43}
    container = pd.DataFrame(
        {"state": state, "particle_scale": scale, "layer": layer, "particles": 50, **measures}
        for state in ("loose", "dense", "difference")
        for scale in WEAR
        for layer in (1, 2, 3)
    )
    bed = pd.DataFrame([{"run": "S4_plain", "particle_scale": 4.0, "state": "before", "particles": 90, **measures}])
    container.to_csv(folder / "figures" / "packing_profiles.csv", index=False)
    bed.to_csv(folder / "figures" / "bed_packing.csv", index=False)
    critical, results = critical_scale(wear), pd.read_csv(PUBLISHED / "particle_size_results.csv")
    found = beside_the_source(
        results[~results["quantity"].str.startswith("relative_wear_rate")], steady, profiles, critical, 0.29
    )
    packing = packing_beside_the_source(pd.read_csv(PUBLISHED / "packing.csv"), container, bed)
    both = pd.concat([found, packing], ignore_index=True)
    both.to_csv(folder / "particle_size" / "published.csv", index=False)
    said = pd.DataFrame({"sentence": critical_sentences(critical, 4.0, wear, 0)})
    said.to_csv(folder / "particle_size" / "sentences.csv", index=False)
    collisions = [
        {"rolling_friction": "cdt", "collision": "pair", "particle_scale": s, "restitution": 0.45} for s in WEAR
    ]
    pd.DataFrame(collisions).to_csv(folder / "particle_size" / "collisions.csv", index=False)


@pytest.fixture
def folder(study, tmp_path):
    """A folder with what the pages read."""
    table = summary(study)
    table.to_csv(tmp_path / "summary.csv", index=False)
    write_sizes(tmp_path, study, table)
    (tmp_path / "packings").mkdir()
    cost = {"solver_s": [40.0, 20.0], "processor_s": [36.0, 18.0], "steps": [5000, 4000], "particles": [300, 200]}
    pd.DataFrame(cost).to_csv(tmp_path / "packings" / "solver_cost.csv", index=False)
    leave_runs(study, tmp_path, "packing_profiles")
    return tmp_path


def test_the_page_in_docs_tells_what_the_tables_do(study, folder, tmp_path):
    """Every section: rows with their layers, ours beside the source, guidance, durations; pictures that are there."""
    docs = tmp_path / "docs"
    docs.mkdir()
    Figure(figsize=(1.0, 1.0)).savefig(folder / "figures" / "wear_maps.png")
    write_results(folder, docs, study)
    text = (docs / "particle_size_results_quick.md").read_text(encoding="utf-8")
    told = " ".join(text.split())
    assert text.startswith("# Particle size at quick fidelity: results")
    assert "and not less in S4, S6, S8" in told and "6 runs of 3 rows" in told
    for row, layers in LAYERS.items():
        line = next(line for line in text.splitlines() if line.startswith(f"| {row} | {row[1]} |"))
        cells = line.split("|")
        assert round(float(cells[3]), 1) == layers and f"{row} {layers}" in told
        wear, force, sliding = (float(cell) for cell in cells[5:8])
        scale = float(row[1])
        assert [wear, force] == [WEAR[scale], FORCE[scale]]
        assert sliding == pytest.approx(wear / force, abs=PRINTED)
    assert "| convex | 3 |" in told and "Yan 2022, Eq 4.15" in told
    verdicts = pd.read_csv(folder / "particle_size" / "published.csv")["verdict"].value_counts()
    assert (
        f"agree with {verdicts['agrees']} and differ from {verdicts['differs']}; of {verdicts['cannot be said']}"
        in told
    )
    assert "| cdt | pair | restitution | 0 |" in told
    assert "major radius mm" in told and "largest scale" in told and "| 3.46 |" in told
    assert "took 16 minutes of wall time" in told  # of runs 150 s each, of packings 60 s
    assert "| packing profiles | 300 | 9 000 | 1 | 0.9 | 0.833 | 1.08 |" in told  # 54 of 50 s
    assert "![wear maps](particle_size_quick_wear_maps.png)" in text and text.count("![") == 1
    assert (docs / "particle_size_quick_wear_maps.png").is_file()


def test_pictures_of_the_page_are_figures_of_the_study(study):
    """None is named that no job draws."""
    assert {name for names in PICTURES.values() for name in names} <= set(figures_of(study))


def test_the_report_shows_the_same(study, folder):
    """Sentences, verdicts, lines and guidance stand in the part of the report on particle size."""
    page = page_parameters(study)
    assert page["varies_scale"] and "size_findings" in page["jobs"]
    template = environment().get_template("particle_size.html.j2")
    text = " ".join(template.render(sizes=sizes(folder / "particle_size"), study=page).split())
    assert "and not less in S4, S6, S8" in text and "<td>cannot be said</td>" in text
    assert '<td class="n">4</td><td class="n">8</td>' in text and "<td>yes</td>" in text  # a, b in mm; it helps
    assert "nan" not in text.lower().replace("tenance", "")


def test_figures_tell_the_layers_of_every_bed(study):
    """Computed for every row: not all scales have the same."""
    said = next(remark for remark in page_parameters(study)["remarks"] if remark.startswith("layers of particles"))
    assert said == "layers of particles in the bed: S4 4.3, S6 2.9, S8 2.2"
