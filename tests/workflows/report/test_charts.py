"""Interactive figures of a page, in a browser: they need no network, tell values, and give way to their pictures."""

import html
import json
import re
import shutil
import subprocess

import pytest

from bulkwear.postproc.plots.chart import LINES, Axis, Layer, one_panel
from bulkwear.postproc.plots.page import plotly_script, surfaces_page
from bulkwear.postproc.tables.compared_surfaces import Shown
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.charts import tables_of_charts
from bulkwear.workflows.report.products import Product
from tests.support.finished_samples import page_of_results, write_results
from tests.support.patience import LONGEST_S
from tests.support.shapes import worn_plate

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
FIRST = """<script>
const faults = [];
addEventListener("error", (event) => faults.push(event.message));
addEventListener("unhandledrejection", (event) => faults.push(String(event.reason)));
console.error = (...words) => faults.push(words.join(" "));
</script>"""
PROBE = """<script type="module">
const until = async (found) => { while (!found()) await new Promise((go) => setTimeout(go, 20)); };
const figure = document.getElementById("wear_against_travel");
const [picture, button] = ["img", ".turn"].map((each) => figure.querySelector(each));
const seen = (each) => each.getClientRects().length > 0;
const told = { faults, before: seen(picture), reachable: button.tabIndex };
button.click();
await until(() => !button.disabled);
const plot = figure.querySelector(".plot"), entries = [...figure.querySelectorAll("[data-key]")];
Plotly.Fx.hover(plot, [{ curveNumber: 0, pointNumber: 2 }]);
await until(() => plot.querySelector(".hovertext"));
told.pointed = plot.querySelector(".hovertext").textContent;
told.drawn = [seen(picture), seen(plot), plot.data[0].y[2]];
told.entries = entries.map((entry) => entry.textContent);
entries[0].click();
await until(() => plot.data[0].visible === false);
told.switched = [entries[0].getAttribute("aria-pressed"), plot.data.map((trace) => trace.visible)];
entries[0].click();
const frame = document.querySelector("iframe");
frame.loading = "eager";
await until(() => frame.contentDocument?.documentElement.dataset.ready === "yes");
const ticks = [...document.querySelectorAll("table.runs .tick")];
const full = () => plot.data.filter((trace) => trace.x.length).length;
const views = () => [...frame.contentDocument.querySelectorAll("select[name=run]")].map((each) => each.value);
told.every = [full(), views().length];
ticks.find((each) => each.ariaLabel === "Show R5_plain below").click();
await until(() => views().length === 1);
told.ticked = [full(), views()];
for (const each of ticks) if (each.checked) each.click();
await until(() => full() === told.every[0]);
button.click();
await until(() => !button.disabled);
told.after = [seen(picture), seen(plot)];
told.requests = performance.getEntriesByType("resource").map((each) => each.name);
document.title = `FOUND${JSON.stringify(told)}END`;
</script>"""


@pytest.mark.skipif(BROWSER is None, reason="needs Chromium")
def test_a_chart_takes_the_place_of_its_picture_and_gives_it_back(config, tmp_path):
    """At a button that keys reach. The pointer tells value, unit and run, the legend switches curves, ticks of
    runs choose what it and the compared surfaces show; nothing is asked of a network and nothing goes wrong; the frame
    of compared surfaces takes its script from the page."""
    study = load_study("small", config.project)
    folder = tmp_path / "results" / study.name
    write_results(folder, study)
    shown = [
        Shown(f"R5_{surface}", cycle, 0.1 * cycle, f"cycle {cycle}", worn_plate(1e-6 * cycle))
        for surface in ("convex", "plain")
        for cycle in range(2)
    ]
    surfaces_page(folder / "figures" / "worn_surface_3d.html", shown, True, {0: "base"}, [])
    text = page_of_results(folder, study)
    assert text.count(plotly_script()) == 1
    path = tmp_path / "probed.html"
    path.write_text(text.replace("<head>", f"<head>{FIRST}", 1).replace("</body>", f"{PROBE}</body>"), encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-3d-apis", "--dump-dom"]
    command = [
        BROWSER,
        *options,
        f"--user-data-dir={tmp_path / 'browser'}",
        "--virtual-time-budget=30000",
        path.as_uri(),
    ]
    page = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=True).stdout
    told = json.loads(html.unescape(re.search(r"FOUND(.*?)END", page).group(1)))
    assert told["faults"] == [] and told["requests"] == []
    assert told["before"] is True and told["reachable"] == 0
    run = study.runs[0]
    volume = told["drawn"].pop()
    assert told["drawn"] == [False, True]
    assert run.surface in told["pointed"] and run.name.replace("_", " ") in told["pointed"]
    assert f"{volume:.4g}" in told["pointed"] and "mm³" in told["pointed"] and "80 mm" in told["pointed"]
    names = ["convex", "plain", "convex, applied", "plain, applied"]
    assert told["entries"][:4] == names
    pressed, visible = told["switched"]
    assert pressed == "false" and visible.count(False) == sum(each.surface == "convex" for each in study.runs)
    curves, views = told["every"]
    assert views == 2 and curves > told["ticked"][0] > 0 and told["ticked"][1] == ["R5_plain"]
    assert told["after"] == [True, False]


def test_a_chart_of_an_unknown_table_is_refused():
    """The sentence names the figure, the key and what there is."""
    layer = Layer(LINES, "y", "x", table="them")
    chart = one_panel(Axis("x"), Axis("y"), layer)
    product = Product("wear", print, {"summary": "summary.csv"}, tables={"trends": "trends.csv"}, charts=(chart,))
    with pytest.raises(ValueError, match="chart of wear: table 'them', allowed are trends"):
        tables_of_charts(product, load_study("demo"))
