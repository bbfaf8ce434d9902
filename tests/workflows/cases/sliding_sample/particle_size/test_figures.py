"""What a study of particle size has of figures and tables, and what their jobs are told."""

from pathlib import Path

import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.particle_size import figures, packing_figures
from bulkwear.workflows.cases.sliding_sample.particle_size import study as study_of_size
from bulkwear.workflows.cases.sliding_sample.study import published_flow
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.products import (
    figures_of,
    job_of,
    outputs_of,
    paths_of,
    products_of_study,
    told_to,
    write_product,
)
from tests import REPOSITORY

OWN = {
    each.product.name
    for module in (figures, packing_figures)
    for each in vars(module).values()
    if hasattr(each, "product")
}
SIMULATING = {"collisions": "collision", "bed_packing": "bed_contacts"}  # figure -> template of its deck


def make(name, study, folder):
    """Make a figure or tables of a study, with a folder in the place of results/<study>."""
    product = products_of_study(study)[name]

    def here(path):
        path = Path(path)
        return folder / path.relative_to(f"results/{study.name}") if path.parts[0] == "results" else REPOSITORY / path

    outputs = {key: here(path) for key, path in outputs_of(product, study.name).items()}
    for path in outputs.values():
        path.parent.mkdir(exist_ok=True)
    files = {key: here(paths_of(source, study)) for key, source in product.inputs.items()}
    write_product(product, job_of(files, told_to(product, study), ["a remark"]), outputs)


@pytest.fixture
def study():
    return load_study("particle_size")


def test_a_study_of_particle_size_has_figures_of_its_own(study):
    """They stand first; the flow is looked at as in the screening; a study of one scale has none of them."""
    names = [each.name for each in figures_of(study)]
    assert set(names[: len(OWN) - 1]) == OWN - {"size_findings"}
    assert {"relative_velocity", "wear_gradient", "velocity_profiles", "wear_split"} <= set(names)
    for other in ("demo", "screening"):
        assert not OWN & set(products_of_study(load_study(other)))
    tables = [published_flow(each) for each in (study, load_study("screening"))]  # chapter 4 has a window of its own
    assert tables == [f"config/published/{name}_results.csv" for name in ("particle_size", "screening")]


@pytest.mark.parametrize("name", SIMULATING)
def test_a_changed_deck_is_simulated_again(study, name, monkeypatch):
    """Figures that call the solver are told the digest of their deck's template: another text, another digest."""
    told = told_to(products_of_study(study)[name], study)
    assert told["folder"].startswith("results/particle_size/particle_size/")
    assert told == told_to(products_of_study(study)[name], study)
    monkeypatch.setattr(study_of_size, "templates_digest", lambda template: f"{SIMULATING[name]}, changed")
    assert told_to(products_of_study(study)[name], study)["template"] != told["template"]


def test_beds_are_looked_at_under_the_plain_samples(study):
    """Runs, tables of wear, settled beds and the heights of their floors in one order."""
    product = products_of_study(study)["bed_packing"]
    told, files = told_to(product, study), {key: paths_of(source, study) for key, source in product.inputs.items()}
    assert list(told["runs"])[:4] == ["S4_plain", "S4-2_plain", "S4-3_plain", "S6_plain"]
    assert files["wear"] == [f"results/particle_size/{run}/wear.csv" for run in told["runs"]]
    beds = [study.bed_of(run) for run in told["runs"]]
    assert files["beds"] == [f"results/particle_size/beds/{bed}/bed.restart" for bed in beds]
    assert told["floors"] == [study.beds[bed]["temporary_floor_m"] for bed in beds]


def test_the_figure_of_the_containers_keeps_every_digit(study, tmp_path):
    """Its table is the one that the solver's job wrote."""
    rows = [
        {"layer": layer, "height_mm": 21.2 * layer, "particles": 71, "coordination_number": 5.0 + third, "state": state}
        for state, third in (("loose", 1.0 / 3.0), ("dense", 0.1 + 0.2), ("difference", -1.0 / 7.0))
        for layer in (1, 2, 3)
    ]
    table = pd.DataFrame(rows).assign(porosity=1.0 / 3.0, porosity_whole_particles=0.1 * 3, particle_scale=8.0)
    (tmp_path / "packings").mkdir()
    table.to_csv(tmp_path / "packings" / "profiles.csv", index=False)
    make("packing_profiles", study, tmp_path)
    made = (tmp_path / "figures" / "packing_profiles.csv").read_bytes()
    assert made == (tmp_path / "packings" / "profiles.csv").read_bytes()
