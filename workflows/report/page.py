"""Assemble a study's page: one HTML file that needs nothing else, read from what the study's jobs left.

`study` is `page_parameters.page_parameters`, `folder` is results/<study>. Numbers come from the tables beside the
figures."""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd

from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.readers.solver_log import solver_version
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import NAMES, read_summary
from bulkwear.workflows.config.rounds import last_round
from bulkwear.workflows.config.until import UNTIL
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.project import PACKAGE, current_project
from bulkwear.workflows.engine.provenance import commit_of, git, package_cases, package_commit, simulating_code
from bulkwear.workflows.engine.provenance import package_version as installed_version
from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.solver import LOG
from bulkwear.workflows.report.charts import chart_text
from bulkwear.workflows.report.cost import (
    BENCHMARK_SUFFIX,
    against_forecast,
    benchmark_seconds,
    job_costs,
    outside_solver_share,
)
from bulkwear.workflows.report.page_parameters import REPORT_FOLDER, page_of
from bulkwear.workflows.report.products import Product, products_of
from bulkwear.workflows.report.sections import DIGITS, Block, Table, with_all_figures
from bulkwear.workflows.report.simulated import said_of, versions_of, warnings_of
from bulkwear.workflows.report.text import data_uri, decks_of, name_and_unit, number, setting_rows, simplifications
from bulkwear.workflows.report.verdict import with_verdict

LARGEST_EMBEDDED_BYTES = {"csv": 60_000, "svg": 20_000, "pdf": 20_000}  # a larger file stays on disk, linked
MEDIA_TYPES = {"csv": "text/csv", "svg": "image/svg+xml", "pdf": "application/pdf"}
PERCENT = 100.0
PERCENT_DECIMALS = 6  # of a share: below is what sums leave of zero
LARGE_VOLUME = 1e5  # mm3, of the most worn run, from which on cm3 are read more easily
CUBIC_CENTIMETRE = 1e3  # mm3
LONGEST_NAME = 40  # characters of a cell that is not broken into lines
FORECAST = "forecast.csv"
PACKAGES = (
    "numpy",
    "scipy",
    "pandas",
    "numba",
    "meshio",
    "gmsh",
    "pyvista",
    "vtk",
    "matplotlib",
    "snakemake",
)


def write_page(path: Path, study: Mapping[str, Any]) -> None:
    """Write the page of a study beside its tables. Raises FileNotFoundError or ValueError when one is
    missing.
    """
    text = environment().get_template("study.html.j2").render(page_context(study, path.parent))
    part = path.with_suffix(".html.part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)


def environment() -> jinja2.Environment:
    """Return the Jinja environment of the page and of captions: strict, everything escaped."""
    found = jinja2.Environment(
        loader=jinja2.FileSystemLoader(REPORT_FOLDER),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters |= {"number": number, "kind": kind, "cells": cells, "css": css_text}
    return found


def css_text(text: str) -> str:
    """Return a text as it stands between quotes in a style sheet."""
    return "".join(letter if letter.isalnum() or letter == " " else f"\\{ord(letter):x} " for letter in text)


def page_context(study: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return everything that the template shows."""
    summary, page = read_summary(folder / "summary.csv"), page_of(study["case"])
    sections = with_all_figures(with_verdict(study, folder), list(study["figures"]))
    names = [name for section in sections for block in section.blocks for name in getattr(block, "names", ())]
    products = products_of(find_case(study["case"]))
    figures = {name: figure(study, products[name], k, folder) for k, name in enumerate(names, start=1)}
    return {
        "study": study,
        "made": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "sections": sections,
        "figures": figures,
        "plotly": _plotly() if any(each["page"] or each["chart"] for each in figures.values()) else "",
        "run_columns": run_columns(study, summary),
        "runs_note": page.RUNS_NOTE,
        "thumbnails": thumbnails(folder / "figures" / "worn_surface.csv"),
        "settings": setting_rows(study["settings"], study["paper_settings"]),
        "runs": run_rows(study, summary),
        "simplified": simplifications(study, summary, page),
        "versions": versions(study, folder),
        **simulated(study, folder),
        "packings": last_round(folder) if UNTIL in study["settings"] else "",
        "parameters": {run: json.dumps(values, indent=1) for run, values in study["parameters"].items()},
        "decks": decks_of(study, folder, page.DECKS),
        "warnings": solver_warnings(study, folder),
        **(costs(study, folder) if study["wears"] else {}),
        **({"balance": float(summary["largest_balance_error"].max())} if study["wears"] else {}),
    }


# ---------------------------------------------------------------- results


def kind(block: Block) -> str:
    """Return the name of a block's class, by which the template tells them apart."""
    return type(block).__name__.lower()


def cells(table: Table) -> dict[str, Any]:
    """Return heads and cells of a table as text: numbers with few digits, aligned to the right; `words`: whether its
    first column has sentences, not names.
    """
    columns = []
    for name in table.data:
        title, unit = table.heads.get(name, name_and_unit(str(name)))
        numeric = pd.api.types.is_numeric_dtype(table.data[name]) and not pd.api.types.is_bool_dtype(table.data[name])
        values = [number(value, table.digits.get(name, DIGITS)) for value in table.data[name].tolist()]
        shown = values if numeric else ["" if pd.isna(value) else number(value) for value in table.data[name].tolist()]
        columns.append({"title": title, "unit": unit, "numeric": numeric, "cells": shown})
    return {
        "columns": columns,
        "rows": list(zip(*(column["cells"] for column in columns), strict=True)),
        "words": any(len(cell) > LONGEST_NAME for column in columns[:1] for cell in column["cells"]),
        "csv": data_uri(table.data.to_csv(index=False).encode(), "text/csv"),
    }


def figure(study: Mapping[str, Any], product: Product, index: int, folder: Path) -> dict[str, Any]:
    """Return one figure of the page: number, title, what it shows in a sentence, caption, picture and chart, or page,
    what stands for it in print, and files.
    """
    told, figures = study["figures"][product.name], folder / "figures"
    file, table = figures / told["file"], figures / f"{product.name}.csv"
    interactive = file.suffix == ".html"
    still = product.stills.get("still")
    return {
        "name": product.name,
        "number": index,
        "title": told["title"],
        "finding": finding_of(product, folder),
        "caption": told["caption"],
        "page": _within(file.read_text(encoding="utf-8")) if interactive else None,
        "chart": chart_text(product, told["beside"], folder),
        "picture": None if interactive else _picture(file),
        "still": _picture(figures / still) if still else None,
        "files": [linked(study, figures / name) for name in (table.name, *product.vectors.values())],
    }


def finding_of(product: Product, folder: Path) -> str:
    """Return in a sentence what a figure of results/<study> shows; "" where its table has no row that tells it."""
    if product.finding is None:
        return ""
    table = pd.read_csv(folder / "figures" / f"{product.name}.csv", dtype=NAMES)
    return "" if table.empty else product.finding(table)


def linked(study: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """Return what a link to a file of the folder of figures needs: a small one is in the page, others lie beside it."""
    kind = path.suffix[1:]
    embedded = path.stat().st_size <= LARGEST_EMBEDDED_BYTES[kind]
    return {
        "kind": kind.upper(),
        "embedded": embedded,
        "name": f"{study['name']}_{path.name}",
        "address": data_uri(path.read_bytes(), MEDIA_TYPES[kind]) if embedded else f"figures/{path.name}",
    }


# ---------------------------------------------------------------- setting


def run_rows(study: Mapping[str, Any], summary: pd.DataFrame) -> list[dict[str, Any]]:
    """Return one row per run: what it found, design factors, its bed where it has one, what its case tells of it."""
    found = results_of_runs(summary) if study["wears"] else {}
    factors = {row["row"]: {k: v for k, v in row.items() if k != "row"} for row in study["design_rows"]}
    columns = dict.fromkeys(name for row in factors.values() for name in row)
    return [
        {"run": run}
        | found.get(run, {})
        | {name: factors[names["row"]].get(name) for name in columns}
        | ({"bed": study["bed_of"][run]} if study["beds"] else {})
        | page_of(study["case"]).run_columns(study["parameters"][run])
        for run, names in study["runs"].items()
    ]


def results_of_runs(summary: pd.DataFrame) -> dict[str, dict[str, float]]:
    """Return of each run what its wear was, as far as the summary tells it."""
    volumes = summary["worn_volume_m3"] * CUBIC_MILLIMETRES
    large = volumes.max() >= LARGE_VOLUME
    told = {
        "wear_over_plain": summary.get("wear_over_plain"),
        "worn_volume_cm3" if large else "worn_volume_mm3": volumes / CUBIC_CENTIMETRE if large else volumes,
        "carried_share_percent": (PERCENT * summary["carried_volume_m3"] / summary["worn_volume_m3"]).round(
            PERCENT_DECIMALS
        ),
    }
    columns = pd.DataFrame({"run": summary["run"], **{name: each for name, each in told.items() if each is not None}})
    return columns.set_index("run").to_dict("index")


def thumbnails(table: Path) -> dict[str, str]:
    """Return {run: address of its worn surface seen from above}, all on one scale; none without a table of faces."""
    columns = {"run", "x_mm", "y_mm", "depth_um"}
    if not table.is_file() or not columns <= set(pd.read_csv(table, nrows=0)):
        return {}
    from bulkwear.postproc.plots.pictures import colour_limits  # slow to import, and few studies have them
    from bulkwear.postproc.plots.thumbnail import thumbnail

    faces = pd.read_csv(table, usecols=[*columns, "area_mm2"], dtype=NAMES)
    top = colour_limits(faces)[1]
    return {run: data_uri(thumbnail(one, top), "image/png") for run, one in faces.groupby("run", sort=False)}


def run_columns(study: Mapping[str, Any], summary: pd.DataFrame) -> list[dict[str, str]]:
    """Return key, name and unit of the columns of the table of runs."""
    pairs = ((key, *name_and_unit(_last_words(key))) for key in run_rows(study, summary)[0])
    return [{"key": key, "name": name, "unit": unit} for key, name, unit in pairs]


def _last_words(key: str) -> str:
    """Return the last two words of a dotted key, parts.liner.file: liner file."""
    return " ".join(key.split(".")[-2:])


# ---------------------------------------------------------------- cost and provenance


def costs(study: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what the template shows of the cost of a study's jobs."""
    jobs = jobs_of(study, folder)
    return {
        "jobs": solver_jobs(jobs),
        "jobs_csv": data_uri(jobs.to_csv(index=False).encode(), "text/csv"),
        "totals": cost_totals(jobs),
        "forecast_by": pd.read_csv(folder / FORECAST)["by"].iloc[0],
    }


def jobs_of(study: Mapping[str, Any], folder: Path) -> pd.DataFrame:
    """Return the cost of every job behind the page, see `analysis.cost.job_costs`."""
    files = [folder / "logs" / f"{job}{BENCHMARK_SUFFIX}" for job in study["jobs"]]
    costs = {f"worn_run_{run}": folder / run / "cost.csv" for run in study["runs"]}
    costs |= {f"settled_bed_{bed}": folder / "beds" / bed / "cost.csv" for bed in study["beds"]}
    costs |= {job: folder / path for job, path in study["told"].get("costs", {}).items()}
    tables = {job: pd.read_csv(path) for job, path in costs.items() if path.is_file()}
    jobs = job_costs(benchmark_seconds([path for path in files if path.is_file()]), tables)
    return against_forecast(jobs, pd.read_csv(folder / FORECAST))


def solver_jobs(jobs: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the jobs that call the solver, and all others in one row."""
    solving = jobs[jobs["solver_s"] > 0.0]
    rest = jobs[jobs["solver_s"] == 0.0]
    others = {"job": f"{len(rest)} other jobs (meshes, tables, figures)", "wall_s": rest["wall_s"].sum()}
    rows = [
        *solving.to_dict("records"),
        {**dict.fromkeys(jobs.columns), **others, "outside_s": others["wall_s"]},
    ]
    return [{**row, "solver_share": share_of(row["solver_s"], row["wall_s"])} for row in rows]


def share_of(part: float | None, whole: float) -> float:
    """Return a share in percent, 0 where nothing was taken."""
    return 100.0 * (part or 0.0) / whole if whole else 0.0


def cost_totals(jobs: pd.DataFrame) -> dict[str, float]:
    """Return the sums of all jobs: wall_s, solver_s, outside_s, outside_percent, particle steps per second, forecast_s,
    measured_over_forecast.
    """
    solver_seconds, expected = (float(jobs[name].sum()) for name in ("solver_s", "forecast_s"))
    measured = float((jobs["measured_over_forecast"] * jobs["forecast_s"]).sum())
    steps = float((jobs["particle_steps_per_s"] * jobs["solver_s"]).sum()) if solver_seconds else 0.0
    return {
        "jobs": len(jobs),
        "wall_s": float(jobs["wall_s"].sum()),
        "solver_s": solver_seconds,
        "outside_s": float(jobs["outside_s"].sum()),
        "outside_percent": 100.0 * outside_solver_share(jobs),
        "particle_steps_per_s": steps / solver_seconds if solver_seconds else float("nan"),
        "forecast_s": expected,
        "measured_over_forecast": measured / expected if expected else float("nan"),
    }


def simulation_folders(study: Mapping[str, Any], folder: Path) -> list[Path]:
    """Return the folders of a study's simulations."""
    return find_case(study["case"]).simulation_folders(folder, list(study["runs"]))


def simulated(study: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what the template says of the versions that simulated a study, and what of the code is newer."""
    case = find_case(study["case"])
    found = versions_of(simulation_folders(study, folder), [folder / "beds" / bed for bed in study["beds"]])
    days = sorted(day for version in found for day in version.dates if day)
    return {
        "simulated": said_of(found),
        "simulated_on": " to ".join(dict.fromkeys([days[0], days[-1]])) if days else "",
        "page_by": package_version(),
        "older": warnings_of(found, simulating_code(case), package_cases(case)),
    }


def versions(study: Mapping[str, Any], folder: Path) -> dict[str, str]:
    """Return the versions of everything that made the results."""
    log = next((log for run in simulation_folders(study, folder) for log in cycle_files(run, LOG)), None)
    said = solver_version(log) if log else None
    found = {"LIGGGHTS": said.removeprefix("Version ") if said else "not reported"}
    project = current_project()
    found["bulkwear, which wrote this page"] = package_version()
    if not project.is_package:
        found["this project"] = commit(project.folder)
    found["Python"] = f"{platform.python_version()} on {platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def package_version() -> str:
    """Return the commit of the package, or the version that was installed."""
    if package_commit():
        return commit(PACKAGE)
    version = installed_version()
    return f"version {version}" if version else "version not known"


def commit(repository: Path) -> str:
    """Return the commit of a repository, and whether files differ from it; what is known where git is not there."""
    found = commit_of(repository)
    if not found:
        return "commit not known"
    return f"commit {found}{' with changes' if git(repository, 'status', '--porcelain') else ''}"


def solver_warnings(study: Mapping[str, Any], folder: Path) -> list[dict[str, Any]]:
    """Return the solver's warnings over all cycles of all simulations: what was said, how often."""
    counts: dict[str, int] = {}
    for said, count in _warnings_of(simulation_folders(study, folder)):
        counts[said] = counts.get(said, 0) + count
    return [{"said": said, "count": count} for said, count in sorted(counts.items(), key=lambda item: -item[1])]


def _warnings_of(folders: Iterable[Path]) -> Iterable[tuple[str, int]]:
    for folder in folders:
        for path in cycle_files(folder, "state.json"):
            yield from read_record(path).get("solver_warnings", {}).items()


def _picture(file: Path) -> str:
    from bulkwear.postproc.plots.small import small_picture  # slow to import

    return data_uri(*small_picture(file))


def _plotly() -> str:
    from bulkwear.postproc.plots.page import plotly_script  # slow to import

    return plotly_script()


def _within(page: str) -> str:
    from bulkwear.postproc.plots.page import within_a_page  # slow to import

    return within_a_page(page)
