"""The page on paper: a PDF of numbered A4 pages that shows what is evidence, or a sentence."""

import html
import json
import re
import subprocess

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.printed import PrintError, browser, print_page
from tests.support.accessibility import NEEDS_BROWSER, SCHEMES
from tests.support.finished_samples import finished_page
from tests.support.patience import LONGEST_S

A4 = (595.3, 841.9)  # pt
PIXEL = 0.75  # pt, to which the browser rounds a page
PAPER = 688  # pixels, between the margins of A4
PROBE = """<details><summary>evidence</summary><p id="evidence">told</p></details>
<script>addEventListener("load", () => {
  const shown = (each) => each.checkVisibility({ contentVisibilityAuto: true }) && each.offsetHeight > 0;
  const all = (where) => [...document.querySelectorAll(where)];
  const found = {
    frames: all("iframe, .moving, nav, button").filter(shown).length,
    stills: all(".still").filter(shown).length,
    evidence: shown(document.getElementById("evidence")),
    diagnostics: all(".diagnostics .inside").filter(shown).length,
    wide: all("table, img, pre").filter((each) => each.getBoundingClientRect().right > innerWidth + 1).length,
    page: getComputedStyle(document.body).backgroundColor,
  };
  document.title = `FOUND${JSON.stringify(found)}END`;
});</script>"""


@pytest.fixture
def page(config, tmp_path):
    """The path of a page, its results made up."""
    study = load_study("small", config.project)
    finished_page(tmp_path / "results" / study.name, study)
    return tmp_path / "results" / study.name / "report.html"


@NEEDS_BROWSER
def test_a_page_becomes_a_pdf(page):
    """Several A4 pages with the study's title and an outline of its headings; no other file is left."""
    before = set(page.parent.iterdir())
    print_page(page, page.with_suffix(".pdf"))
    content = page.with_suffix(".pdf").read_bytes()
    boxes = re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", content)
    assert len(boxes) == len(re.findall(rb"/Type /Page\b", content)) > 2
    for box in boxes:
        assert [float(side) for side in box] == pytest.approx(A4, abs=PIXEL)
    assert b"/Title (A small study)" in content and b"/Outlines" in content
    assert set(page.parent.iterdir()) - before == {page.with_suffix(".pdf")}


@NEEDS_BROWSER
def test_paper_shows_what_it_can(page, tmp_path):
    """What moves is its picture, evidence is open, diagnostics stay folded, nothing is wider than the paper, which is
    white where the screen is dark."""
    text = page.read_text(encoding="utf-8")
    on_paper = text.replace("@media print", "@media all").replace("@media screen", "@media speech")
    probed = tmp_path / "probed.html"
    probed.write_text(on_paper.replace("</main>", f"{PROBE}</main>"), encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--window-size={PAPER},900", "--dump-dom"]
    options += [f"--blink-settings=preferredColorScheme={SCHEMES['dark']}", f"--user-data-dir={tmp_path / 'b'}"]
    command = [browser(), *options, "--virtual-time-budget=3000", probed.as_uri()]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=True).stdout
    found = json.loads(html.unescape(re.search(r"FOUND(.*)END", shown).group(1)))
    assert found == {
        **dict.fromkeys(("frames", "diagnostics", "wide"), 0),
        "stills": text.count('class="still"'),
        "evidence": True,
        "page": "rgb(255, 255, 255)",
    }
    assert found["stills"] > 0


def test_without_a_browser_there_is_a_sentence(tmp_path, monkeypatch):
    """It names the file, the package that prints, and the page that is there."""
    monkeypatch.setenv("PATH", "")
    with pytest.raises(PrintError, match=r"report\.pdf: Chromium.* apt-get install chromium\. .*report\.html is there"):
        print_page(tmp_path / "report.html", tmp_path / "report.pdf")


def test_a_browser_that_prints_nothing_is_told(tmp_path, monkeypatch):
    """Its last line and exit code, and no torn file is left."""
    program = tmp_path / "programs" / "chromium"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\necho no room >&2\nexit 3\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:/usr/bin:/bin")
    with pytest.raises(PrintError, match=r"exit code 3, its last line: no room$"):
        print_page(tmp_path / "report.html", tmp_path / "report.pdf")
    assert list(tmp_path.glob("*.pdf*")) == []
