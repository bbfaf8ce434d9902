"""The page of a study: complete, self-contained, its numbers those of the tables."""

import base64
import html
import json
import re

import pytest

from bulkwear.postproc.plots.page import plotly_script
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.made_by import commit
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.products import figures_of
from bulkwear.workflows.report.text import UNDEFINED, name_and_unit, number, setting_rows
from tests.support.finished_samples import (
    BED_SOLVER,
    BED_WALL,
    CYCLES,
    INNER_PAGE,
    OTHER_WALL,
    PICTURE,
    RUN_SOLVER,
    RUN_WALL,
    embedded,
    finished_page,
)

RELATIVE = 1e-9  # numbers pass through CSV text


@pytest.fixture(scope="module")
def study(config_of_file):
    """A study of two design rows, each convex and plain."""
    return load_study("small", config_of_file.project)


@pytest.fixture(scope="module")
def page(study, tmp_path_factory):
    """The text of its page."""
    return finished_page(tmp_path_factory.mktemp("page") / "results" / study.name, study)


def test_each_figure_stands_once_with_its_number(page, study):
    """Figures are numbered as they stand, each with its own picture or page, caption and table."""
    products = {product.name: product for product in figures_of(study)}
    names = re.findall(r'<figure id="(\w+)"', page)
    assert sorted(names) == sorted(products)
    assert re.findall(r"<b>Figure (\d+)\.", page) == [str(k + 1) for k in range(len(names))]
    for name, product in products.items():
        assert product.paragraphs[0] in html.unescape(page)
        picture = base64.b64encode(PICTURE + name.encode()).decode()
        shown = page.count(f'src="data:image/{product.suffix};base64,{picture}"')
        assert shown == (product.suffix in ("png", "gif"))
        assert page.count(f'href="#{name}"') == 1


def test_page_needs_nothing_else(page):
    """No address to load from leaves the page: everything is data, an anchor or a frame's own text."""
    loads = re.findall(r"""(?:src|href|action|poster)\s*=\s*["']([^"']*)["']""", page)
    assert loads
    assert [address for address in loads if not address.startswith(("data:", "#"))] == []
    assert re.findall(r"@import|url\(", page) == []


def test_charts_stand_beside_pictures(page, study):
    """An interactive figure is made of the table behind the picture's link; the picture needs no script."""
    _, _, shown = page.partition('<figure id="wear_against_travel">')
    picture, _, chart = shown.partition("</figure>")[0].partition('<script type="application/json">')
    found, table = json.loads(chart.partition("</script>")[0]), embedded(page, f"{study.name}_wear_against_travel.csv")
    assert picture.strip().startswith("<img") and "<button" not in picture
    drawn = [value for trace in found["panels"][0]["data"] for value in trace["y"]]
    volumes = [*table["worn_volume_mm3"], *table.loc[table["applied_volume_mm3"] > 0.0, "applied_volume_mm3"]]
    assert sorted(drawn) == pytest.approx(sorted(volumes), rel=1e-5)  # six digits are drawn


def test_the_script_of_all_charts_is_there_once(page):
    """A page is as large as one copy of it and its content."""
    assert page.count(plotly_script()) == 1


def test_inner_page_survives_embedding(page):
    """The interactive page is escaped into its frame and comes out as it went in."""
    frames = re.findall(r'srcdoc="([^"]*)"', page)
    assert [html.unescape(frame) for frame in frames] == [INNER_PAGE]


def test_figures_say_what_they_show_and_come_in_every_form(page, study):
    """The alternative text of a figure with a finding is the finding, which comes first in its caption; without rows
    that tell it, and without a finding, the title stands there. SVG and PDF lie behind links.
    """
    for product in figures_of(study):
        _, _, shown = page.partition(f'<figure id="{product.name}"')
        shown = html.unescape(shown.partition("</figure>")[0])
        said = re.search(r'(?:alt|title)="([^"]+)"', shown).group(1)
        told = product.finding is not None and len(embedded(page, f"{study.name}_{product.name}.csv")) > 0
        assert (said == product.title) != told
        assert f"</b> {said if told else product.title + '.'}</p>\n<p>{told * f'{product.title}. '}" in shown
        for kind, name in product.vectors.items():
            content = base64.b64encode(PICTURE + name.encode()).decode()
            assert f'download="{study.name}_{name}"' in shown and content in shown
            assert f">{kind.upper()}</a>" in shown


def test_tables_round_trip(page, study):
    """The tables behind the links are those on disk."""
    for product in figures_of(study):
        found = embedded(page, f"{study.name}_{product.name}.csv")
        if product.finding is None:
            assert found["name"].tolist() == [product.name]


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


def test_every_figure_says_what_it_shows():
    """A figure has a title, a place in the report, and a caption of whole sentences."""
    for name in ("demo", "screening"):
        for product in figures_of(load_study(name)):
            assert product.title and product.category
            assert product.paragraphs and all(paragraph.endswith(".") for paragraph in product.paragraphs)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.5, "0.5"),
        (1234567, "1\u202f234\u202f567"),
        (12345.6, "12\u202f350"),
        (999_999.9, "1e+06"),
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
        ("rate_t_per_h", "rate", "t/h"),
        ("speed_rpm", "speed", "rpm"),
        ("throughput_mt", "throughput", "Mt"),
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


def test_settings_tell_all_blocks_that_have_equal_keys():
    """Each of them with its name: two parts of a machine both have an edge."""
    parts = {"liner": {"edge_mm": 20, "law": "archard"}, "wall": {"edge_mm": 90}}
    found = {
        row["name"]: (row["value"], row["unit"]) for row in setting_rows({"parts": parts}, {"parts": parts})["parts"]
    }
    assert found == {"liner edge": (20, "mm"), "liner law": ("archard", ""), "wall edge": (90, "mm")}


def test_commit_is_not_needed(tmp_path):
    """Outside a repository the page says that the commit is not known."""
    assert commit(tmp_path) == "commit not known"
