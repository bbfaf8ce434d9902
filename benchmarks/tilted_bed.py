"""At which slope does a bed begin to flow, and does it stand before? A layer of grains without walls is tilted slowly,
under each rolling model.

    python -m benchmarks.tilted_bed --cores 2    # in the root of the repository; an hour
    python -m benchmarks.tilted_bed --finished    # of the layers so far
    python -m benchmarks.tilted_bed --redraw
    python -m benchmarks.tilted_bed --sliding-friction 0.5 --rolling-friction 0.1 --output tilted   # another layer

Its grains are those of `benchmarks.rolling_models`, in the source's calibrated pair. Layers stay in `--folder`. Writes
into docs: tilted_bed.csv (every layer; those not asked for stay in it, with the version of the code that tilted them),
figure and tilted_bed_results.md; `--redraw` makes the last two from the first. A table holds layers of one friction,
depth and tilt: others go into another `--output`.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, fields
from datetime import date
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.command_line import at_least_one, command, number_within, output_folder, read_table
from benchmarks.plots.rolling_models import packings_by_model
from benchmarks.rolling_case import CALIBRATED, MODELS, SHEAR_BOX, wanted
from benchmarks.rolling_page import less
from benchmarks.runs import BY, side_by_side, simulated_by, with_earlier
from benchmarks.tilted_layer import (
    CREEPING,
    FLOWING,
    LENGTH,
    LOOK,
    MILLIMETRES,
    WIDTH,
    Tilt,
    TiltError,
    is_tilted,
    layer_folder,
    tilt_deck,
    tilted,
)
from bulkwear.postproc.plots.style import save, save_small
from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate, estimate
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.solver import SolverError, SolverStoppedError
from bulkwear.workflows.report.markdown_text import bullet, markdown, prose

PACKINGS = 5
REFERENCE = "own_spin"  # the studies' own: the others are compared with it
REFUSED = "refused"  # column with the reason why nothing is measured on a layer
KEYS = ["model", "packing"]  # of a row in the table of every layer
FRICTIONS = ["sliding_friction", "rolling_friction"]  # of the grains, -
SETTING = [*FRICTIONS, *(each.name for each in fields(Tilt))]  # columns that are alike in a table
ALLOWED = {  # of each; faster than that few looks tell of creep
    **dict.fromkeys(FRICTIONS, (0.0, 2.0)),
    "grains": (100, 5000),
    "start_deg": (0.0, 90.0 - CREEPING),
    "end_deg": (CREEPING, 90.0),
    "rate_deg_per_s": (0.1, 10.0),
}
ANSWERS = ["flow_angle_deg", "creep_mm_per_s"]  # columns of what is measured
DIGITS = ".6g"  # of numbers in the table
FILE, PAGE, FIGURE = "tilted_bed.csv", "tilted_bed_results.md", "tilted_bed.png"


def layers(packings: int, models: Sequence[str], frictions: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return the layers wanted: model, packing, and what is asked, with those frictions in place of the calibrated."""
    rows = wanted(packings, models, (SHEAR_BOX,), (CALIBRATED,))
    for row in rows:
        row["asked"]["particle"]["contact"].update(frictions)
    return rows


def is_finished(row: Mapping[str, Any], tilt: Tilt, root: Path) -> bool:
    """Return whether the layer of a row was tilted."""
    return is_tilted(tilt_deck(row["asked"], tilt), root)


def all_tilted(
    rows: Sequence[Mapping[str, Any]], tilt: Tilt, root: Path, cores: int, alone: bool = True
) -> pd.DataFrame:
    """Return model, packing, `SETTING`, what is `measured` of layers, or why it is not (REFUSED), and the version of
    the code that simulated them, up to `cores` of them at the same time.

    alone: waits until nobody else simulates in that folder; else what is finished is read beside them
    """
    name = "tilted bed"
    with state.only_driver(root, Progress(name, 1).say) if alone else nullcontext():
        found = side_by_side(
            name, rows, lambda row: is_finished(row, tilt, root), lambda row: told_of(row, tilt, root), cores
        )
    return pd.DataFrame([_told(row, tilt) | layer for row, layer in zip(rows, found, strict=True)])


def _told(row: Mapping[str, Any], tilt: Tilt) -> dict[str, Any]:
    contact = row["asked"]["particle"]["contact"]
    return {key: row[key] for key in KEYS} | {name: contact[name] for name in FRICTIONS} | asdict(tilt)


def told_of(row: Mapping[str, Any], tilt: Tilt, root: Path) -> dict[str, Any]:
    """Return what is `measured` on the layer of a row, or why it is not, which ends no other layer; and its version.

    Raises SolverStoppedError: the machine ended that simulation.
    """
    try:
        found: dict[str, Any] = dict(tilted(row["asked"], tilt, root))
    except SolverStoppedError:
        raise
    except (SolverError, TiltError) as fault:
        found = {REFUSED: str(fault).partition(": ")[2]}
    return found | {BY: simulated_by(layer_folder(tilt_deck(row["asked"], tilt), root))}


def angles(runs: pd.DataFrame) -> dict[str, pd.Series]:
    """Return the flow angles (degrees) of each model by packing."""
    of_packings = runs.reindex(columns=[*KEYS, "flow_angle_deg"]).dropna().set_index("packing")
    return {model: of["flow_angle_deg"] for model, of in of_packings.groupby("model", sort=False)}


def means(runs: pd.DataFrame) -> dict[str, Estimate]:
    """Return the mean flow angle (degrees) of each model over its packings."""
    return {model: estimate(of.to_numpy()) for model, of in angles(runs).items()}


def creep_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row per model: its mean creep (mm/s), and that of the slowest and the fastest packing."""
    creep = runs.groupby("model", sort=False)["creep_mm_per_s"]
    return creep.agg(
        packings="count", creep_mm_per_s="mean", slowest_mm_per_s="min", fastest_mm_per_s="max"
    ).reset_index()


def summary(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row per model: its mean with interval, and what it is more or less than REFERENCE, with interval."""
    rows, found = [], angles(runs)
    for model, mean in means(runs).items():
        low, high = mean.interval()
        rows.append({"model": model, "packings": mean.packings, "flow_angle_deg": mean.value})
        rows[-1] |= {"low_deg": low, "high_deg": high}
        if REFERENCE in found and model != REFERENCE:
            apart = less(found[model], found[REFERENCE])
            ends = dict(zip(("less_low_deg", "less_high_deg"), apart.interval(), strict=True))
            rows[-1] |= {"less_reference_deg": apart.value, **ends}
    return pd.DataFrame(rows)


def said_of(model: str, found: pd.Series, reference: pd.Series) -> str:
    """Return in a sentence at what slope a model's bed flows, and whether that is told from the reference's.

    found, reference: degrees, by packing
    """
    mean = estimate(found.to_numpy())
    if not mean.known:
        return f"`{model}`: {mean.value:.1f} degrees ({UNKNOWN})."
    low, high = mean.interval()
    said = f"`{model}`: {mean.value:.1f} degrees (95 %: {low:.1f} to {high:.1f})"
    apart = less(found, reference)
    if found is reference or not apart.known:
        return f"{said}."
    low, high = apart.interval()
    told = "not told from" if low <= 0.0 <= high else f"{apart.value:+.1f} ({low:+.1f} to {high:+.1f}) of"
    return f"{said}, {told} `{REFERENCE}`."


def refused(runs: pd.DataFrame) -> list[str]:
    """Return a sentence for each layer on which nothing is measured."""
    if REFUSED not in runs:
        return []
    return [
        f"`{row.model}`, packing {row.packing}: {row.refused}" for row in runs.dropna(subset=[REFUSED]).itertuples()
    ]


def level_said(runs: pd.DataFrame) -> str:
    """Return in a sentence how deep the layers lie, beside what was asked; nothing of those that did not tell."""
    if "level_mm" not in runs:
        return ""
    low, high = runs["level_mm"].min(), runs["level_mm"].max()
    return f"Layers lie {low:.1f} to {high:.1f} mm deep at rest; asked are {runs['level_asked_mm'].mean():.1f} mm."


def setting_said(tilt: Mapping[str, float]) -> str:
    """Return in sentences what the layers of a table are and how they are tilted; tilt: by the names of `SETTING`."""
    sliding, rolling = (tilt[name] for name in FRICTIONS)
    start, rate = tilt["start_deg"], tilt["rate_deg_per_s"]
    return (
        f"A layer of {tilt['grains']:g} grains, {LENGTH:g} by {WIDTH:g} median diameters, lies on grains that are held,"
        " and is periodic along and across; the material and time steps of [the rolling models]"
        f"(rolling_models_results.md), with sliding friction {sliding:g} and rolling friction {rolling:g}. After rest"
        f" it is tilted from {start:g} degrees by {rate:g} degree/s until its grains move downhill at"
        f" {MILLIMETRES * FLOWING:g} mm/s in the mean, looked at every {LOOK * rate:g} degrees, up to"
        f" {tilt['end_deg']:g} degrees. It has neither walls nor a toe: that is no angle of repose, and tells what a"
        " model does alone."
    )


def results_page(runs: pd.DataFrame) -> str:
    """Return the page; runs: as from `all_tilted`, of one `SETTING`."""
    found, tilt = angles(runs), runs[SETTING].iloc[0]
    reference = found.get(REFERENCE, next(iter(found.values())))
    start = tilt["start_deg"]
    parts = [
        "# At which slope does a bed begin to flow?",
        prose(
            "Generated by `python -m benchmarks.tilted_bed`; not to be edited. The models are those of [rolling"
            " friction](rolling_friction.md). [Every layer](tilted_bed.csv)."
        ),
        "\n".join(map(bullet, (*(said_of(model, of, reference) for model, of in found.items()), *refused(runs)))),
        f"![Slope at which a bed flows, by rolling model]({FIGURE})",
        prose(f"{setting_said(tilt)} {level_said(runs)}".rstrip()),
        markdown(summary(runs)),
        "## Does it stand before?",
        prose(
            f"How fast the layer moves downhill while it is tilted from {start:g} to {start + CREEPING:g} degrees: of"
            " each packing the median of all looks, which a slip of a moment does not move; the mean, the least and the"
            " most of the packings."
        ),
        markdown(creep_table(runs)),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def publish(output: Path, runs: pd.DataFrame) -> str:
    """Write figure and page of the layers; return the page."""
    page = results_page(runs)
    (output / PAGE).write_text(page, encoding="utf-8")
    remarks = [
        f"layers of {runs['grains'].iloc[0]} grains on held ones, periodic; small: packings, large: mean and its 95 %"
        " interval",
        f"made by benchmarks/tilted_bed.py, {date.today():%Y-%m-%d}",
    ]
    figure = packings_by_model(runs, "flow_angle_deg", "Slope at which the bed flows (degrees)", means(runs), remarks)
    save(figure, output / FIGURE)
    save_small(output / FIGURE, output / FIGURE)
    return page


def other_setting(file: Path, asked: Mapping[str, float]) -> str | None:
    """Return a sentence that says where the `SETTING` of an earlier table is not what is asked; None where it is."""
    if not file.is_file():
        return None
    earlier = read_table(file, [*KEYS, *SETTING], SETTING).iloc[0]
    found = {name: (f"{earlier[name]:{DIGITS}}", f"{asked[name]:{DIGITS}}") for name in SETTING}
    apart = [f"{name} {of_table}, not {other}" for name, (of_table, other) in found.items() if of_table != other]
    if not apart:
        return None
    return f"{file} holds layers of {', '.join(apart)}: allowed is another folder as --output."


def parser_of(frictions: Mapping[str, float]) -> argparse.ArgumentParser:
    """Return the command line; frictions: the calibrated pair, by the names of `FRICTIONS`."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--packings", type=at_least_one, default=PACKINGS, help=f"of each model, else {PACKINGS}")
    parser.add_argument("--models", nargs="+", choices=MODELS, default=MODELS, help="else all")
    for name, allowed in ALLOWED.items():
        default = (frictions | asdict(Tilt()))[name]
        number = number_within(*allowed, kind=type(default))
        parser.add_argument(f"--{name.replace('_', '-')}", type=number, default=default, help=f"else {default:g}")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full/tilted_bed"))
    parser.add_argument("--cores", type=at_least_one, default=1, help="simulations side by side")
    parser.add_argument("--finished", action="store_true", help="simulate nothing, take what is finished")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    return parser


def main() -> None:
    """Simulate what is missing, then write table, figure and page."""
    calibrated = layers(1, (REFERENCE,), {})[0]["asked"]["particle"]["contact"]
    parser = parser_of({name: calibrated[name] for name in FRICTIONS})
    given = parser.parse_args()
    tilt = Tilt(**{each.name: getattr(given, each.name) for each in fields(Tilt)})
    frictions = {name: getattr(given, name) for name in FRICTIONS}
    if tilt.end_deg < tilt.start_deg + CREEPING:
        parser.error(
            f"--end-deg {tilt.end_deg:g}: allowed is {CREEPING:g} degrees more than --start-deg"
            f" ({tilt.start_deg:g}) and above, between which creep is measured."
        )
    file = given.output / FILE
    if not given.redraw:
        if other := other_setting(file, frictions | asdict(tilt)):
            parser.error(other)
        rows = layers(given.packings, given.models, frictions)
        rows = [row for row in rows if is_finished(row, tilt, given.folder)] if given.finished else rows
        if not rows:
            parser.error(f"{given.folder}: no layer asked for is finished; without --finished they are tilted.")
        found = all_tilted(rows, tilt, given.folder, given.cores, alone=not given.finished)
        with_earlier(file, found, KEYS).sort_values(KEYS).to_csv(file, index=False, float_format=f"%{DIGITS}")
    if not means(runs := read_table(file, [*KEYS, *SETTING], [*SETTING, *ANSWERS])):
        parser.error(f"{file}: no layer tells at which slope it flows: {' '.join(refused(runs))}")
    print(publish(given.output, runs), flush=True)


if __name__ == "__main__":
    command(main)
