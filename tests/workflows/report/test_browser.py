"""The page in a browser: tables sort, nothing is wider than a phone."""

import html
import re
import shutil
import subprocess

import pytest

from bulkwear.workflows.config.design import load_study
from tests.support.finished_samples import finished_page
from tests.support.patience import LONGEST_S

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
