"""The page of a study that runs: the same as on the terminal, with pictures, loading itself anew until the end."""

import pandas as pd
import pytest

from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import write_surface
from bulkwear.workflows.engine.records import write_record
from bulkwear.workflows.forecast.status import read_status, rows_of
from bulkwear.workflows.results import live
from tests.support.accessibility import NEEDS_BROWSER, axe_findings

RUNS = [f"r{k}" for k in range(live.MOST_PICTURES + 1)]


@pytest.fixture
def study(tmp_path):
    """results/ with a study of five runs that have worn for a cycle, r0 first of all."""
    folder = tmp_path / "results" / "demo"
    table = pd.DataFrame({"job": [f"worn_run_{run}" for run in RUNS], "wall_h": 1.0, "cores": 1, "cycles": 2})
    folder.mkdir(parents=True)
    table.assign(needs="", fidelity="quick").to_csv(folder / "forecast.csv", index=False)
    for run in RUNS:
        for cycle in range(2):
            (folder / run / f"cycle_{cycle:03d}").mkdir(parents=True)
            write_record(folder / run / f"cycle_{cycle:03d}" / "state.json", {"wear": {"total_worn_volume_m3": 1e-9}})
    return tmp_path / "results"


def wear(folder):
    """Leave the surface of a wear cycle, as it was made."""
    sample = sliding_sample(0.02, 0.02, 0.004, None, 3e-4, 0.05)
    sample.cell_data["worn_volume_m3"] = 1e-12 * (sample.points[sample.triangles, 0].mean(axis=1) > 0.0)
    write_surface(folder / "surface.vtu", sample)


def test_the_page_tells_what_the_terminal_does(study, tmp_path):
    """Every cell of the table; it loads itself anew as long as another one follows, and then no more."""
    status = read_status("demo", results=study)
    for goes_on in (True, False):
        live.write_live_page(status, "data:,", goes_on)
        page = (study / "demo" / "live.html").read_text(encoding="utf-8")
        assert ("location.reload()" in page) == goes_on
    for cell in {cell for row in rows_of(status) for cell in row}:
        assert f">{cell}</td>" in page
    assert [path.name for path in (study / "demo").glob("live*")] == ["live.html"]


@pytest.mark.verify
@NEEDS_BROWSER
def test_nobody_is_kept_from_it(study, tmp_path):
    """axe-core finds nothing."""
    live.write_live_page(read_status("demo", results=study), "data:,", True)
    page = (study / "demo" / "live.html").read_text(encoding="utf-8")
    for key, found in axe_findings(page, tmp_path).items():
        assert found["faults"] == [], key


def test_pictures_are_those_of_the_last_cycles(study, monkeypatch):
    """Of the runs whose cycles ended last, drawn once until there are others."""
    calls = []
    monkeypatch.setattr(live, "drawn", lambda surfaces: calls.append(surfaces) or f"data:,{len(calls)}")
    pictures, status = live.LastPictures(), read_status("demo", results=study)
    assert pictures.of(status) == ""
    for run in RUNS:
        wear(study / "demo" / run / "cycle_001")
    assert [pictures.of(status), pictures.of(status)] == ["data:,1"] * 2
    assert [path.parts[-3] for path in calls[0]] == RUNS[1:]
    wear(study / "demo" / RUNS[0] / "cycle_001")
    pictures.of(status)
    assert [path.parts[-3] for path in calls[1]] == [RUNS[0], *RUNS[2:]]


def test_surfaces_are_drawn(study):
    """A PNG of a rigid sample's equivalent depth."""
    folder = study / "demo" / RUNS[0] / "cycle_001"
    wear(folder)
    assert live.drawn([folder / "surface.vtu"]).startswith("data:image/png;base64,")
