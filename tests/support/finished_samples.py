"""What the jobs of a study of sliding samples leave, made up, as far as its page reads it; and the page made of it."""

import base64
import io
import json
import re
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.tables.history import wear_history
from bulkwear.postproc.tables.summary import summary_table
from bulkwear.workflows.config.design import Study
from bulkwear.workflows.engine.beds import BedMeasure, write_measures
from bulkwear.workflows.report.beds import BEDS, beds_table, values_of_beds
from bulkwear.workflows.report.page import write_page
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.products import figures_of

CYCLES = 2
MEASURED = [BedMeasure("mass", "kg", 2.0, 2.01, 0.02), BedMeasure("level", "m", 0.04, 0.042, 0.003)]
RUN_WALL, RUN_SOLVER, BED_WALL, BED_SOLVER, OTHER_WALL = 100.0, 90.0, 50.0, 48.0, 2.0  # s, of each job
PICTURE = b"\x89PNG picture of "
INNER_PAGE = "<!doctype html><html><body><script>const text = \"a < b && 'c'\";</script></body></html>"


def wear_table(volume: float) -> pd.DataFrame:
    """Return wear.csv of a run that wears `volume` m3 in each cycle and applies half of it."""
    cycle = np.arange(1, CYCLES + 1)
    return pd.DataFrame(
        {
            "cycle": cycle,
            "time_s": 0.04 * cycle,
            "travel_m": 0.04 * cycle,
            "sliding_work_J": 1.0,
            "worn_volume_m3": volume,
            "applied_volume_m3": 0.5 * volume,
            "carried_volume_m3": 0.5 * volume * cycle,
            "total_worn_volume_m3": volume * cycle,
            "total_applied_volume_m3": 0.5 * volume * cycle,
            "base_worn_volume_m3": 0.75 * volume,
            "pattern_worn_volume_m3": 0.25 * volume,
            "finnie_volume_m3": 0.01 * volume,
            "mean_normal_force_N": 5.0,
            "largest_depth_m": 1e-6,
            "smallest_angle_deg": 30.0,
            "balance_error": 1e-15,
        }
    )


def write_results(folder: Path, study: Study) -> None:
    """Write what every study leaves. Convex runs wear 0.8 of plain ones."""
    for name in ("figures", "logs"):
        (folder / name).mkdir(parents=True)
    pd.DataFrame(study.design_table()).to_csv(folder / "design.csv", index=False)
    for run in study.runs:
        first = folder / run.name / "cycle_001"
        first.mkdir(parents=True)
        wear_table(0.8e-9 if run.surface == "convex" else 1e-9).to_csv(folder / run.name / "wear.csv", index=False)
        cost = {"cycle": [0, 1], "solver_s": RUN_SOLVER / 2, "other_s": 1.0, "steps": 1000, "particles": 500}
        pd.DataFrame(cost).to_csv(folder / run.name / "cost.csv", index=False)
        (first / "deck.in").write_text("# a deck with <angles> & more\n")
        (first / "log.liggghts").write_text("LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, compiled)\n")
        (first / "state.json").write_text(json.dumps({"solver_warnings": {"something odd": 2}}))
    files = [folder / run.name / "wear.csv" for run in study.runs]
    summary_table(folder / "design.csv", files).to_csv(folder / "summary.csv", index=False)
    _write_figures(folder, study, files)
    _write_costs(folder, study)


def _write_figures(folder: Path, study: Study, wear_files: list[Path]) -> None:
    """Write figures as marked bytes, and the tables of those that the page reads."""
    for product in figures_of(study):
        content = INNER_PAGE.encode() if product.suffix == "html" else PICTURE + product.name.encode()
        (folder / "figures" / product.file).write_bytes(content)
        for file in (*product.vectors.values(), *product.stills.values()):
            (folder / "figures" / file).write_bytes(PICTURE + file.encode())
        row = "" if product.finding else f"{product.name}\n"  # a finding reads its own columns
        (folder / "figures" / f"{product.name}.csv").write_text(f"name\n{row}")
    runs = pd.DataFrame([{"run": run.name, "surface": run.surface} for run in study.runs])
    faces = runs.assign(depth_um=1.0, area_mm2=2.0)
    tables = {
        "worn_surface": faces,
        "worn_surface_3d": faces,
        "wear_against_travel": wear_history(folder / "design.csv", wear_files),
        "depth_distribution": runs.assign(depth_um=1.0, area_share_percent=60.0),
        "wear_split": runs.assign(wear_over_plain=0.8, pattern_over_plain=0.2),
        "forces": runs.assign(vertical_force_N=2.0, drag_force_N=1.0),
        "wear_updates": runs.assign(step_taken=1.0),
        "worn_film": runs.assign(bumps_left_percent=99.0, largest_depth_um=1.0),
    }
    for name, table in tables.items():
        table.to_csv(folder / "figures" / f"{name}.csv", index=False)


def _write_costs(folder: Path, study: Study) -> None:
    """Write benchmark files of every job, the cost of the beds, and a forecast of half of what each run takes."""
    jobs = {f"worn_run_{run.name}": RUN_SOLVER / 2 for run in study.runs}
    jobs |= {f"settled_bed_{bed}": BED_SOLVER for bed in study.beds}
    forecast = pd.DataFrame({"job": jobs.keys(), "solver_s": jobs.values()}).assign(by="rates of a test")
    forecast.to_csv(folder / "forecast.csv", index=False)
    for bed in study.beds:
        (folder / "beds" / bed).mkdir(parents=True)
        (folder / "beds" / bed / "cost.csv").write_text(f"solver_s,steps,particles\n{BED_SOLVER},1000,500\n")
        write_measures(MEASURED, folder / "beds" / bed)
    files = [folder / "beds" / bed / "cost.csv" for bed in study.beds]
    beds_table(values_of_beds(study), files).to_csv(folder / BEDS, index=False)
    for job in page_parameters(study)["jobs"]:
        wall = next((wall for start, wall in (("worn", RUN_WALL), ("settled", BED_WALL)) if job.startswith(start)), 0.0)
        (folder / "logs" / f"{job}.benchmark.tsv").write_text(f"s\th:m:s\n{wall or OTHER_WALL}\t0:00:01\n")


def write_flow(folder: Path, study: Study) -> None:
    """Write the regimes of all runs, at a relative velocity of 30 %, and a steady window of each."""
    runs = pd.DataFrame(study.design_table())[["run", "row", "setting", "packing", "surface"]]
    (folder / "flow").mkdir()
    regimes = runs.assign(regime="continuous", steady=True, relative_velocity=0.3)
    regimes.to_csv(folder / "flow" / "regimes.csv", index=False)
    steady = runs[["run", "row", "surface"]].assign(measure="relative_gradient", mean=0.6, steady=True)
    steady.assign(published_mean=0, published_deviation=0).to_csv(folder / "flow" / "steady.csv", index=False)


def write_findings(folder: Path) -> None:
    """Write the two tables of findings, a line each."""
    (folder / "findings").mkdir()
    finding = {"key": "x", "finding": "R12 wears more", "source": "Yan 2022", "claimed": "above 1", "found": "0.98"}
    finding |= {"verdict": "cannot be said", "factor": np.nan, "reason": "the direction is open"}
    pd.DataFrame([finding]).to_csv(folder / "findings" / "findings.csv", index=False)
    run = {"row": "R5", "regime": "continuous", "published_regime": "", "steady": False}
    numbers = ("relative_velocity_percent", "wear_over_plain", "normalised_wear", "force_over_plain")
    numbers += ("packings", "interval_low", "interval_high", "published_model", "bottom_spin_over_plain")
    run |= {"published_wear_over_plain": "", **dict.fromkeys(numbers, 0.5)}
    pd.DataFrame([run]).to_csv(folder / "findings" / "runs.csv", index=False)


def page_of_results(folder: Path, study: Study) -> str:
    """Return the text of the page of a study whose results stand in a folder."""
    write_page(folder / "report.html", page_parameters(study))
    return (folder / "report.html").read_text(encoding="utf-8")


def finished_page(folder: Path, study: Study) -> str:
    """Return the text of the page of a study, its results made up in a folder."""
    write_results(folder, study)
    return page_of_results(folder, study)


def embedded(page: str, name: str) -> pd.DataFrame:
    """Return the table behind a link for download."""
    address = re.search(rf'download="{name}" href="data:text/csv;base64,([^"]+)"', page).group(1)
    return pd.read_csv(io.BytesIO(base64.b64decode(address)))
