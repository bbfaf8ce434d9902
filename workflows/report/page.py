"""Assemble a study's page: one HTML file that needs nothing else, read from what the study's jobs left.

`study` is `page_parameters.page_parameters`, `folder` is results/<study>. Numbers come from the tables beside the
figures."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd

from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import NAMES, read_summary
from bulkwear.workflows.config.rounds import last_round
from bulkwear.workflows.config.until import UNTIL
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.report.charts import chart_text
from bulkwear.workflows.report.cost import cost_parts
from bulkwear.workflows.report.made_by import simulated, solver_warnings, versions
from bulkwear.workflows.report.page_parameters import REPORT_FOLDER, page_of
from bulkwear.workflows.report.products import Product, products_of
from bulkwear.workflows.report.sections import DIGITS, Block, Table, with_all_figures
from bulkwear.workflows.report.text import data_uri, decks_of, name_and_unit, number, setting_rows, simplifications
from bulkwear.workflows.report.verdict import with_verdict

LARGEST_EMBEDDED_BYTES = {"csv": 60_000, "svg": 20_000, "pdf": 20_000}  # a larger file stays on disk, linked
MEDIA_TYPES = {"csv": "text/csv", "svg": "image/svg+xml", "pdf": "application/pdf"}
PERCENT = 100.0
PERCENT_DECIMALS = 6  # of a share: below is what sums leave of zero
LARGE_VOLUME = 1e5  # mm3, of the most worn run, from which on cm3 are read more easily
CUBIC_CENTIMETRE = 1e3  # mm3
LONGEST_NAME = 40  # characters of a cell that is not broken into lines


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
        **(cost_parts(study, folder) if study["wears"] else {}),
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


def _picture(file: Path) -> str:
    from bulkwear.postproc.plots.small import small_picture  # slow to import

    return data_uri(*small_picture(file))


def _plotly() -> str:
    from bulkwear.postproc.plots.page import plotly_script  # slow to import

    return plotly_script()


def _within(page: str) -> str:
    from bulkwear.postproc.plots.page import within_a_page  # slow to import

    return within_a_page(page)
