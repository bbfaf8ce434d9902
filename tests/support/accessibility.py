"""What axe-core finds in a page: faults that keep people from reading it, at two widths, light and dark."""

import html
import importlib.resources
import json
import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest

from bulkwear.workflows.report.printed import browser
from tests.support.patience import LONGEST_S

NEEDS_BROWSER = pytest.mark.skipif(browser() is None, reason="needs Chromium")
WIDTHS = (1440, 390)  # pixels: a desk and a phone
SCHEMES = {"dark": 0, "light": 1}  # as the browser numbers what a user prefers
GRAVE = ("moderate", "serious", "critical")  # plotly's own fault, ids that two views share, is minor
PROBE = """<script src="{axe}"></script>
<script>addEventListener("load", async () => {{
  while (!({ready})) await new Promise((then) => setTimeout(then, 20));
  {use}
  for (const folded of document.querySelectorAll("details")) folded.open = true;
  const found = await axe.run(document, {{ iframes: false, resultTypes: ["violations"] }});
  const faults = found.violations.flatMap(({{ id, impact, nodes }}) =>
    nodes.map((node) => ({{ id, impact, where: node.target.join(" "), said: node.failureSummary }})));
  const paper = getComputedStyle(document.body).backgroundColor;
  parent.postMessage({{ width: innerWidth, paper, faults, passed: found.passes.length }}, "*");
}});</script>"""
FRAMES = """<!DOCTYPE html><style>:root {{ color-scheme: light dark; }} iframe {{ height: 900px; border: 0; }}</style>
{frames}
<script>const found = [];
addEventListener("message", ({{ data }}) => {{
  if (data.faults) found.push(data);
  if (found.length === {count}) document.title = `FOUND${{JSON.stringify(found)}}END`;
}});</script>"""


def axe_findings(
    page: str, folder: Path, ready: str = "true", use: str = "", schemes: Iterable[str] = SCHEMES
) -> dict[tuple[int, str], dict]:
    """Return by width and scheme what axe-core finds in the text of a page: `faults` that are grave, how many rules
    `passed`, and `paper`, the colour behind the text. Folded parts are opened first.

    ready: expression of JavaScript that is true when the page is drawn; use: what is then done with it
    """
    axe = importlib.resources.files("axe_core_python").joinpath("axe.min.js")
    head, end, tail = page.rpartition("</body>")
    probe = PROBE.format(axe=Path(str(axe)).as_uri(), ready=ready, use=use)
    (folder / "probed.html").write_text(f"{head}{probe}{end}{tail}", encoding="utf-8")
    frames = "".join(f'<iframe src="probed.html" style="width: {width}px"></iframe>' for width in WIDTHS)
    (folder / "frames.html").write_text(FRAMES.format(frames=frames, count=len(WIDTHS)), encoding="utf-8")
    return {(each["width"], scheme): each for scheme in schemes for each in _asked(folder, scheme)}


def _asked(folder: Path, scheme: str) -> list[dict]:
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--window-size={max(WIDTHS) + 60},2000", "--dump-dom"]
    options += [f"--blink-settings=preferredColorScheme={SCHEMES[scheme]}", f"--user-data-dir={folder / scheme}"]
    command = [browser(), *options, "--virtual-time-budget=60000", (folder / "frames.html").as_uri()]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=True).stdout
    found = json.loads(html.unescape(re.search(r"<title>FOUND(.*)END</title>", shown).group(1)))
    return [each | {"faults": [fault for fault in each["faults"] if fault["impact"] in GRAVE]} for each in found]
