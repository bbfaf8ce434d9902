"""Declarations of figures of the circular wear tester: which studies have them, and what they need of the runs."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.circular_tester import figures, flow, hours, place_figures, tables, volume
from bulkwear.workflows.cases.circular_tester.comparison import ratios_by_revolution
from bulkwear.workflows.cases.circular_tester.runs import (
    has_pairs,
    pairs_of,
    runs_of_values,
    shown_pair,
    values_of_pairs,
    values_of_runs,
)
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.report.products import figures_of, job_of, products_of
from tests.support import tester_study as study
from tests.support.charts import drawn_chart, names, values

RUN = SimpleNamespace(coefficient=5e-9, width=0.1, length=0.1, distance_per_revolution=1.071)
PUBLISHED_BOTH = study.PUBLISHED, study.PUBLISHED_FITS
SERIES_OF = {
    "tester_mesh": "mesh",
    "tester_mesh_contours": "mesh",
    "tester_worn_out": "worn_out",
    "tester_ring": "ring",
    "tester_sensitivity": "varied",
}


@pytest.mark.parametrize("fidelity", ["quick", "standard", "paper"])
def test_a_figure_of_a_series_needs_rows_of_it(fidelity):
    """Elements, worn-out patterns and machines are drawn where the design has them, all others always."""
    of = load_study("circular_tester", overrides={"fidelity": fidelity})
    series = {row["series"] for row in of.design_rows}
    there = {product.name for product in figures_of(of)}
    declared = {product.name for product in products_of(of.case).values() if product.is_figure}
    assert declared - there == {name for name, needed in SERIES_OF.items() if needed not in series}


def test_every_table_keeps_nine_digits():
    """The tester's own tables are written with nine significant digits."""
    own = [
        product for product in products_of(find_case("circular_tester")).values() if product.name.startswith("tester")
    ]
    assert len(own) == 21 and {product.digits for product in own} == {figures.DIGITS}


@pytest.fixture
def charts():
    """What draws the chart of a figure by name, with its published table."""
    products = products_of(find_case("circular_tester"))
    return lambda name, table: drawn_chart(products[name], table, published=study.PUBLISHED)


def test_charts_of_volumes_show_their_tables(charts):
    """With intervals of three packings, the source's fit where it has the particle scale, and measured volumes."""
    lost = study.volumes(packings=3, scatter=0.02)
    means = volume.beside_fits(volume.mean_volumes(lost), study.PUBLISHED_FITS)
    found = charts("tester_volume", means)
    for name, rows in means.groupby(["surface", "particle_scale"], sort=False):
        words = f"{name[0]}, particle scale {name[1]:g}"
        assert values(found, words) == [pytest.approx(rows["volume_mm3"], rel=1e-5)]
        assert values(found, f"{words}, Yan 2022") == [pytest.approx(rows["published_volume_mm3"], rel=1e-5)]
    assert "error_y" in found["panels"][0]["data"][0]
    grown = charts("tester_increments", volume.mean_increments(lost))
    settings = len(means.groupby(volume.SETTING))
    assert [len(panel["data"]) for panel in grown["panels"]] == [settings + 2, settings]  # first and last published
    main = lost[lost["particle_scale"] == 3.0]
    scale = hours.time_scale(main[main["surface"] == "plain"], RUN, study.PUBLISHED)
    predicted = hours.predictions(lost, scale, [56.0, 184.0])
    bars = charts("tester_benchmark", predicted)
    assert values(bars, "plain volume 56 h, measured") == [[145.2, 145.2]]
    compared = tables.comparison_table(predicted[predicted["particle_scale"] == 3.0], *PUBLISHED_BOTH, 3.0)
    assert [panel["layout"]["yaxis"]["title"]["text"] for panel in charts("tester_hours", compared)["panels"]] == [
        "Volume (mm³)",
        "Reduction (%)",
    ]


def test_charts_of_the_flow_show_their_measure(charts):
    """In the unit of the axis, with the source's values and deviations as fields; each criterion has its panel."""
    series = study.series(packings=3)
    means = flow.revolutions_over_packings(flow.flow_means(series.assign(worn_revolution=series["revolution"])), "mean")
    for name, measure, factor in (
        ("tester_spin", flow.SPIN, 180.0 / np.pi),
        ("tester_velocity", flow.VELOCITY, 1e3),
        ("tester_force", flow.FORCE, 1.0),
    ):
        found = charts(name, means[means["measure"] == measure])
        drawn = [value for surface in ("plain", "convex") for curve in values(found, surface) for value in curve]
        shown = means[means["measure"] == measure]["mean"]
        assert sorted(drawn) == pytest.approx(sorted(factor * shown), rel=1e-5), name
        assert sum("Yan 2022" in entry for entry in names(found)) == (2 if name == "tester_velocity" else 4)
    variations = flow.revolutions_over_packings(flow.revolution_means(series, flow.STEADINESS), "variation")
    assert [panel["title"] for panel in charts("tester_steadiness", variations)["panels"]] == [
        "particle velocity",
        "bed height",
        "wear rate",
    ]


def test_runs_come_back_from_their_values(tmp_path):
    """Folders lie below the study's; a pair is of series volume and of one packing, which shares its bed."""
    of = load_study("circular_tester", overrides={"fidelity": "quick", "packings": 3})
    runs = runs_of_values(values_of_runs(of), tmp_path)
    assert [run.name for run in runs] == [run.name for run in of.runs]
    assert {run.folder.parent for run in runs} == {tmp_path}
    assert {run.bed_folder.name for run in runs} == set(of.beds)
    pairs = pairs_of(runs)
    assert [plain.packing for _, plain in pairs] == [1, 2, 3] and shown_pair(runs) == pairs[0]
    for patterned, plain in pairs:
        assert (patterned.series, plain.series) == ("volume", "volume")
        assert plain.surface == "plain" and patterned.surface != "plain"
        assert patterned.bed_folder == plain.bed_folder and patterned.packing == plain.packing
    assert len({plain.bed_folder for _, plain in pairs}) == 3
    assert {values["name"] for values in values_of_pairs(of)} == {run.name for pair in pairs for run in pair}
    assert next(run for run in runs if run.series == "worn_out").patch == "4 mm round it"


def test_a_run_has_the_packing_of_the_design_table():
    """The second bed alone is not called the first one."""
    of = load_study("circular_tester", overrides={"fidelity": "quick", "packings": 2, "rows": ["plain-2", "convex-2"]})
    assert {row["run"]: row["packing"] for row in of.design_table()} == {"plain-2": 2, "convex-2": 2}
    assert {values["name"]: values["packing"] for values in values_of_runs(of)} == {"plain-2": 2, "convex-2": 2}


@pytest.mark.parametrize(
    ("rows", "paired"),
    [
        (["plain", "convex-2"], True),
        (["convex-2", "plain-2"], True),
        (["plain"], False),
        (["worn-out", "mesh-plain"], False),
    ],
)
def test_rows_without_a_pair_have_no_figures_of_their_own(rows, paired):
    """The name of a setting stands for all its packings; without its other surface nothing is compared."""
    of = load_study("circular_tester", overrides={"fidelity": "quick", "packings": 2, "rows": rows})
    names = {product.name for product in figures_of(of)}
    assert has_pairs(of) == paired
    assert any(name.startswith("tester_") for name in names) == paired


def test_channel_and_ring_are_compared_at_the_particles_of_the_ring(tmp_path):
    """Runs of other particles are left out; both machines are compared over the revolutions that both have."""
    lost = study.volumes()
    lost = lost[lost["particle_scale"] == 3.0]
    channel = lost.assign(shape="channel", series="volume")
    ring = lost[lost["revolution"] < 6].assign(shape="ring", series="ring", run=lost["run"] + "_ring")
    finer = channel.assign(particle_scale=2.0, run=lost["run"] + "_finer")
    table = pd.concat([channel, ring, finer], ignore_index=True)
    files = {"lost_volumes": tmp_path / "lost.csv", "ratios": tmp_path / "ratios.csv"}
    table.to_csv(files["lost_volumes"], index=False)
    ratios_by_revolution(table).to_csv(files["ratios"], index=False)
    figure, means = place_figures.tester_ring(job_of(files, {}, study.REMARKS))
    assert means[["shape", "particle_scale", "revolutions"]].to_numpy().tolist() == [
        ["channel", 3.0, 5],
        ["ring", 3.0, 5],
    ]
    assert means["ratio"].to_numpy() == pytest.approx([0.65, 0.65])
    assert not any("scale 2" in text.get_text() for legend in figure.legends for text in legend.get_texts())
