"""The page of a study of particle size, on tables of three made-up rows."""

from dataclasses import replace

import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.particle_size.page import sections, told
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.markdown import durations, provenance
from bulkwear.workflows.report.markdown_text import written
from bulkwear.workflows.report.page import environment
from bulkwear.workflows.report.page_parameters import answers_of_study, page_parameters
from bulkwear.workflows.report.products import products_of_study
from bulkwear.workflows.report.sections import Pictures, shown
from tests.support.finished_runs import leave_runs
from tests.workflows.cases.sliding_sample.particle_size.test_figures import OWN, make

WEAR = {4.0: 1.1, 6.0: 1.4, 8.0: 2.1}  # -, of the convex sample, over its plain twin's
PRINTED = 0.005  # three digits of numbers around 1
FORCE = {4.0: 1.5, 6.0: 1.6, 8.0: 1.7}  # -, of the convex sample, over its plain twin's
PLAIN_FORCE = {4.0: 20.0, 6.0: 19.0, 8.0: 16.0}  # N
SCATTER = {1: 1.0, 2: 1.02, 3: 1.0 / 1.02}  # -, of packings, geometric mean 1
LAYERS = {"S4": 4.3, "S6": 2.9, "S8": 2.2}  # 46 mm over 2.65 mm times the scale


@pytest.fixture(scope="module")
def study():
    return load_study("particle_size", overrides={"rows": list(LAYERS)})


def summary(study):
    rows = []
    for run in study.runs:
        scale, convex = run.parameters["particle"]["scale"], run.surface == "convex"
        volume = 2e-9 * (WEAR[scale] * SCATTER[study.packing_of[run.row]] if convex else 1.0)
        bumps = 0.8 * volume if convex else 0.0
        rows.append(
            {
                "run": run.name,
                "row": run.row,
                "surface": run.surface,
                "setting": study.setting_of[run.row],
                "packing": study.packing_of[run.row],
                "particle_scale": scale,
                "worn_volume_m3": volume,
                "base_worn_volume_m3": volume - bumps,
                "pattern_worn_volume_m3": bumps,
                "worn_volume_per_metre_m3_per_m": volume / 0.8,
                "wear_over_plain": volume / 2e-9,
                "mean_normal_force_N": PLAIN_FORCE[scale] * (FORCE[scale] if convex else 1.0),
            }
        )
    return pd.DataFrame(rows)


def write_tables(folder, study, table):
    """What the jobs of the figures leave in particle_size/ and figures/, made by them where they read tables."""
    (folder / "figures").mkdir()
    names = table[["run", "row", "surface", "particle_scale"]]
    windows = {"mean_percent": 12.0, "deviation_percent": 1.0, "steady": True}
    steady = [names.assign(measure=measure, **windows) for measure in ("relative_velocity", "relative_wear_rate")]
    pd.concat(steady).to_csv(folder / "figures" / "steady_by_scale.csv", index=False)
    profiles = names.assign(height_mm=10.0, velocity_m_per_s=0.3)
    profiles.to_csv(folder / "figures" / "velocity_by_layer.csv", index=False)
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
    for name in ("wear_against_scale", "wear_against_size_ratios", "size_findings"):
        make(name, study, folder)
    collisions = [
        {"rolling_friction": "cdt", "collision": "pair", "particle_scale": s, "restitution": 0.45} for s in WEAR
    ]
    pd.DataFrame(collisions).to_csv(folder / "particle_size" / "collisions.csv", index=False)


@pytest.fixture(scope="module")
def folder(study, tmp_path_factory):
    """A folder with what the pages read."""
    table, folder = summary(study), tmp_path_factory.mktemp("results")
    table.to_csv(folder / "summary.csv", index=False)
    write_tables(folder, study, table)
    (folder / "packings").mkdir()
    cost = {"solver_s": [40.0, 20.0], "processor_s": [36.0, 18.0], "steps": [5000, 4000], "particles": [300, 200]}
    pd.DataFrame(cost).to_csv(folder / "packings" / "solver_cost.csv", index=False)
    leave_runs(study, folder, "packing_profiles")
    return folder


@pytest.fixture(scope="module")
def page(study):
    """What the page is told of the study."""
    return {**page_parameters(study), "told": told(study)}


def test_the_sections_tell_what_the_tables_do(folder, page):
    """Every section: rows with their layers, ours beside the source, guidance."""
    text = "\n".join(written(block, "x") for section in sections(page, folder) for block in section.blocks)
    said = " ".join(text.split())
    assert "wears less than the plain one at no scale, more at scale 4, 6, 8" in said
    assert "a level one of 46 mm" in said and "over that at scale 4, is 95 % at scale 6, 80 % at scale 8;" in said
    assert "fewer than 2 layers" not in said
    for row, layers in LAYERS.items():
        line = next(line for line in text.splitlines() if line.startswith(f"| {row} | {row[1]} |"))
        cells = line.split("|")
        assert round(float(cells[3]), 1) == layers
        wear, force, sliding = (float(cell) for cell in cells[5:8])
        packings, low, high = (float(cell) for cell in cells[11:14])
        assert packings == len(SCATTER) and low < wear < high
        scale = float(row[1])
        assert [wear, force] == [WEAR[scale], FORCE[scale]]
        assert sliding == pytest.approx(wear / force, abs=PRINTED)
    assert "| convex | 9 |" in said and "Yan 2022, Eq 4.15" in said
    verdicts = pd.read_csv(folder / "particle_size" / "published.csv")["verdict"].value_counts()
    assert f"cannot be said {verdicts['cannot be said']}" in said
    assert "| cdt | pair | restitution | 0 |" in said
    assert "major radius mm" in said and "largest scale" in said and "| 3.46 |" in said
    assert "| 4 | loose | 3 | 5.2 | 0.42 | 0.43 |" in said and "| S4 plain | 4 | before | 90 |" in said


def test_the_answer_is_the_critical_scale(folder):
    """Then what the pattern does where it wears least; scales are not counted as patterns."""
    by_scale, critical, best = answers_of_study("sliding_sample", folder)
    assert by_scale.startswith("By the intervals") and critical.startswith("Critical scale")
    assert best.startswith("Lowest: the convex sample of S4")


def test_the_page_counts_the_packings_among_its_costs(study, folder, page):
    """Eighteen runs of 150 s each, packings 60 s, 54 of them of its processor, of 50 s forecast."""
    text = " ".join("\n".join(written(block, "x") for block in durations(folder, page)).split())
    assert "took 46 minutes of wall time" in text
    assert "| packing profiles | 300 | 9 000 | 1 | 0.9 | 0.833 | 1.08 |" in text
    assert "18 runs of 3 rows" in " ".join(provenance(folder, study).split())


def test_every_figure_of_particle_size_has_its_section(folder, page):
    """What stands there besides is of the flow over any sample."""
    blocks = [block for section in sections(page, folder) for block in section.blocks]
    shown = [name for block in blocks if isinstance(block, Pictures) for name in block.names]
    assert len(shown) == len(set(shown)) and set(shown) <= set(page["figures"])
    assert set(shown) == (OWN - {"size_findings"}) | {"relative_velocity", "wear_gradient", "flow_views"}


@pytest.mark.parametrize(("surface", "needless"), [("plain", ()), ("convex", ("bed_packing",))])
def test_one_surface_alone_has_the_rest(study, folder, tmp_path, surface, needless):
    """Without wear over plain what is told of it is left out, and without plain samples the beds before and behind."""
    alone = replace(study, runs=tuple(run for run in study.runs if run.surface == surface))
    pairs = {"wear_against_scale", "wear_against_size_ratios", "size_findings"}
    assert OWN - set(products_of_study(alone)) == pairs | set(needless)
    own = tmp_path / "results"
    left = ("steady_by_scale", "packing_profiles", *({"bed_packing"} - set(needless)))
    for name in (*(f"figures/{name}.csv" for name in left), "particle_size/collisions.csv"):
        (own / name).parent.mkdir(parents=True, exist_ok=True)
        (own / name).write_bytes((folder / name).read_bytes())
    found = [shown(section, []) for section in sections({**page_parameters(alone), "told": told(alone)}, own)]
    titles = [section.title for section in found if section]
    assert titles == ["Relative velocity and wear rate", "Packing", "Single contacts"]


def test_the_html_page_shows_the_same(study, folder, page):
    """Sentences, verdicts, lines and guidance."""
    found = [shown(section, []) for section in sections(page, folder)]
    template = environment().get_template("sections.html.j2")
    text = " ".join(template.render(sections=[each for each in found if each], study=page, figures={}).split())
    assert "more at scale 4, 6, 8" in text and "<td>cannot be said</td>" in text
    assert '<td class="n">4</td><td class="n">8</td>' in text and "<td>yes</td>" in text  # a, b in mm; it helps
    assert "mm³/m" in text and ">nan<" not in text.lower()


def test_figures_tell_the_layers_of_every_bed(study):
    """Computed for every row: not all scales have the same."""
    said = next(remark for remark in page_parameters(study)["remarks"] if remark.startswith("layers of particles"))
    assert said == "layers of particles in the bed: S4 4.3, S6 2.9, S8 2.2"
