"""The page in a browser: tables sort and are sifted, nothing is wider than a phone, many runs are no burden."""

import html
import re
import shutil
import subprocess
from collections import Counter

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, write_surface
from bulkwear.postproc.plots.page import surfaces_page
from bulkwear.postproc.tables.compared_surfaces import shown_surfaces
from bulkwear.workflows.config.design import load_study
from tests.support.finished_samples import finished_page, page_of_results, write_results
from tests.support.patience import LONGEST_S
from tests.support.shapes import plate

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
NARROW = 500  # pixels, the least that the browser's window takes
PROBE = """<script>addEventListener("load", () => {
  const table = document.querySelector("table.sortable"), heads = [...table.querySelectorAll("th")];
  const column = heads.findIndex((head) => head.textContent.startsWith("worn volume"));
  const seen = () => [...table.tBodies[0].rows].map((row) => row.cells[column].textContent.trim()).join(" ");
  const found = [];
  for (let click = 0; click < 2; click += 1) {
    heads[column].querySelector("button").click();
    found.push(heads[column].getAttribute("aria-sort"), seen());
  }
  document.title = ["FOUND", ...found, document.documentElement.scrollWidth].join("|");
});</script>"""


@pytest.mark.skipif(BROWSER is None, reason="needs Chromium")
def test_runs_sort_and_the_page_fits_a_phone(config, tmp_path):
    """Buttons of headings sort up, then down, and say so; beside tables that scroll nothing is wider than the page."""
    study = load_study("small", config.project)
    page = finished_page(tmp_path / "results" / study.name, study)
    path = tmp_path / "page.html"
    path.write_text(page.replace("</body>", f"{PROBE}</body>"), encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--window-size={NARROW},900", "--dump-dom"]
    folder = f"--user-data-dir={tmp_path / 'browser'}"
    command = [BROWSER, *options, folder, "--virtual-time-budget=3000", path.as_uri()]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=True).stdout
    _, first, rising, second, falling, width = html.unescape(re.search(r"FOUND\|[^<]*", shown).group()).split("|")
    volumes = [float(word) for word in rising.split()]
    assert (first, second) == ("ascending", "descending")
    assert len(set(volumes)) > 1 and volumes == sorted(volumes)
    assert [float(word) for word in falling.split()] == volumes[::-1]
    assert int(width) <= NARROW


ROWS = 13  # each convex and plain
LARGEST_PAGE = 8_000_000  # bytes
PICTURES = 2_500_000  # bytes of a real page that are none here: its figures
SIDE, CYCLES = 74, 4  # cells of a surface, which then has as many nodes as the demo's; cycles of a run
SIFTED = """<script>addEventListener("load", async () => {
  const frame = document.querySelector("figure.interactive iframe"), words = document.querySelector(".sift input");
  frame.loading = "eager";
  while (frame.contentDocument?.documentElement.dataset.ready !== "yes") await new Promise((go) => setTimeout(go, 20));
  const runs = frame.contentDocument.querySelector("select[name=run]").options.length;
  words.value = "T7_plain";
  words.dispatchEvent(new Event("input"));
  const rows = [...document.querySelector("table.sortable").tBodies[0].rows].filter((row) => !row.hidden);
  const found = rows.map((row) => row.cells[0].textContent.trim());
  document.title = ["FOUND", found, runs, performance.getEntriesByType("resource").length, ""].join("|");
});</script>"""


def worn_by_chance(depth: float, random: np.random.Generator) -> SurfaceMesh:
    """Return a fine sample with numbers that hardly compress."""
    fine = plate(0.08, 0.08, SIDE)
    if not depth:
        return fine
    nodes = {name: depth * random.random(len(fine.points)) for name in ("removed_thickness_m", "carried_volume_m3")}
    names = ("worn_volume_m3", "normal_impulse_N_s", "sliding_work_J", "impact_energy_J")
    faces = {name: random.random(len(fine.triangles)) for name in names}
    points = fine.points - np.outer(nodes["removed_thickness_m"], [0.0, 0.0, 1.0])
    return SurfaceMesh(points, fine.triangles, {"part": np.zeros(len(fine.triangles), dtype=int)} | faces, nodes)


@pytest.mark.verify
@pytest.mark.skipif(BROWSER is None, reason="needs Chromium")
def test_a_page_of_many_runs_is_small_and_finds_one(config, tmp_path):
    """Four cycles of 26 runs at the demo's mesh; rows are sifted by words, all runs can be compared, nothing is
    asked."""
    head = config.path("designs/small.csv").read_text(encoding="utf-8").splitlines()[0]
    config.write(
        "designs/small.csv", "\n".join([head, *(f"T{k},8,2,20,{6.0 + 0.1 * k:.1f},1.0,40" for k in range(ROWS)), ""])
    )
    study, random = load_study("small", config.project), np.random.default_rng(26)
    folder = tmp_path / "results" / study.name
    write_results(folder, study)
    wear = pd.DataFrame({"cycle": np.arange(1, 1 + CYCLES), "time_s": 1.0, "travel_m": 0.1})
    runs = {run.name: tmp_path / "runs" / run.name for run in study.runs}
    for of_run in runs.values():
        for cycle in range(1, 1 + CYCLES):
            (of_run / f"cycle_{cycle:03d}").mkdir(parents=True)
            write_surface(of_run / f"cycle_{cycle:03d}" / "surface.vtu", worn_by_chance(1e-6, random))
        write_surface(of_run / "surface.vtu", worn_by_chance(0.0, random))
    shown = shown_surfaces(runs, dict.fromkeys(runs, wear))
    assert Counter(each.run for each in shown) == dict.fromkeys(runs, 1 + CYCLES)
    surfaces_page(folder / "figures" / "worn_surface_3d.html", shown, True, {0: "base"}, [])
    page = page_of_results(folder, study)
    assert len(page) + PICTURES <= LARGEST_PAGE
    path = tmp_path / "page.html"
    path.write_text(page.replace("</body>", f"{SIFTED}</body>"), encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-3d-apis", "--dump-dom"]
    folder = f"--user-data-dir={tmp_path / 'browser'}"
    command = [BROWSER, *options, folder, "--virtual-time-budget=30000", path.as_uri()]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout
    _, rows, runs, requests, _ = html.unescape(re.search(r"FOUND\|[^<]*", shown).group()).split("|")
    assert (rows, int(runs), int(requests)) == ("T7_plain", 2 * ROWS, 0)
