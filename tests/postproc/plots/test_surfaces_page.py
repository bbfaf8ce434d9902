"""The page of compared surfaces, read and used in a browser without WebGL."""

import html
import json
import re
import shutil
import subprocess

import pytest

from bulkwear.postproc.mesh import node_areas
from bulkwear.postproc.plots.page import surfaces_page
from bulkwear.postproc.tables.compared_surfaces import Shown
from tests.support.accessibility import NEEDS_BROWSER, axe_findings
from tests.support.patience import LONGEST_S
from tests.support.shapes import worn_plate

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
DEPTHS = {"R9": 5e-6, "plain": 2e-6}  # m, in the last cycle; a half of it before
CARRIED = 0.2  # -, of the depth
REMARKS = ["particles at scale 4", "sample < 100 mm & rigid </script>"]
PROBE = """<script type="module">
const wait = () => {
  if (document.documentElement.dataset.ready !== "yes") return setTimeout(wait, 20);
  const set = (where, value, event) => {
    const found = document.querySelector(where);
    found.value = value;
    found.dispatchEvent(new Event(event));
  };
  const legends = () => [...document.querySelectorAll(".legend")].map((each) => each.textContent);
  const found = { legends: legends(), scene: document.querySelector(".scene").textContent, words: words.textContent };
  set("select[name=as]", "difference", "change");
  found.differences = legends();
  set("select[name=section]", "0", "change");
  set("input[name=place]", 50, "input");
  const section = document.getElementById("section");
  found.section = section.data.map((line) => [line.name, line.yaxis ?? "y", line.x.filter((x) => x !== null), line.y]);
  set("select[name=as]", "values", "change");
  set("select[name=quantity]", "carried", "change");
  found.carried = section.data[2].y;
  set(".view input[name=cycle]", 1, "input");
  found.kept = document.querySelector(".view output").textContent;
  set("select[name=quantity]", "depth", "change");
  found.earlier = section.data.at(1).name;
  document.title = `FOUND${JSON.stringify(found)}END`;
};
wait();
</script>"""
DRAWN = 'document.documentElement.dataset.ready === "yes"'
WITH_SECTION = """const section = document.querySelector("select[name=section]");
section.value = "0";
section.dispatchEvent(new Event("change"));"""


def partly_carried(depth):
    """A worn plate of whose depth a share is not yet removed."""
    mesh = worn_plate((1.0 - CARRIED) * depth)
    mesh.point_data["carried_volume_m3"] = CARRIED * depth * node_areas(mesh)
    return mesh


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page of two runs, unworn and after two cycles, the first with its depth alone; a share is carried."""
    path = tmp_path_factory.mktemp("page") / "page.html"
    shown = [
        Shown(run, cycle, 0.1 * cycle, f"cycle {cycle}", partly_carried(depth * cycle / 2), cycle != 1)
        for run, depth in DEPTHS.items()
        for cycle in range(3)
    ]
    surfaces_page(path, shown, True, {0: "base"}, REMARKS)
    return path


def test_the_page_needs_no_network(page):
    """It loads nothing from elsewhere, and no mark of its template is left."""
    text = page.read_text(encoding="utf-8")
    assert re.findall(r"""(?:src|href)\s*=\s*["']?https?:""", text) == []
    assert re.findall(r"/\*[A-Z]+\*/", text) == []


@NEEDS_BROWSER
def test_views_differences_and_sections_say_what_they_show(page, tmp_path):
    """Scales, differences from the first view, and a section through all views with the unworn shape; another cycle is
    drawn when it is chosen, and what needs WebGL says so."""
    path = tmp_path / "probed.html"
    path.write_text(page.read_text(encoding="utf-8").replace("</body>", f"{PROBE}</body>"), encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-3d-apis", "--dump-dom"]
    folder = f"--user-data-dir={tmp_path / 'browser'}"
    command = [BROWSER, *options, folder, "--virtual-time-budget=20000", path.as_uri()]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=True).stdout
    found = json.loads(html.unescape(re.search(r"FOUND(.*)END", shown).group(1)))
    assert found["legends"] == ["Wear depth, carried included (µm)05"]
    assert found["differences"][1:] == ["Difference from the first view (µm)3 less3 more"]
    assert "no WebGL" in found["scene"] and all(remark in found["words"] for remark in REMARKS)
    names = [(name, axis) for name, axis, _, _ in found["section"]]
    worn = [(f"{run}, cycle 2", axis) for run in DEPTHS for axis in ("y", "y2")]
    assert [pair for pair in names if pair[0] != "unworn"] == worn and names.count(("unworn", "y")) == 2
    for (run, depth), (_, _, places, values) in zip(DEPTHS.items(), found["section"][2::3], strict=True):
        assert (min(places), max(places)) == pytest.approx((0.0, 10.0), abs=0.01), run  # mm along y
        assert [value for value in values if value is not None] == pytest.approx([1e6 * depth] * 4, abs=1e-3)
    assert found["earlier"] == "R9, cycle 1" and found["kept"] == "cycle 1: depth alone is kept"
    carried = [value for value in found["carried"] if value is not None]
    assert carried == pytest.approx([CARRIED * 1e6 * DEPTHS["R9"]] * 4, abs=1e-3)


@pytest.mark.verify
@NEEDS_BROWSER
def test_nobody_is_kept_from_it(page, tmp_path):
    """axe-core finds nothing that keeps people from choosing and reading, the section drawn."""
    for key, found in axe_findings(page.read_text(encoding="utf-8"), tmp_path, DRAWN, WITH_SECTION).items():
        assert found["faults"] == [], key
