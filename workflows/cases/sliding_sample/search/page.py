"""The section of a page about a search: the best pattern beside plain and reference, and how it was found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from bulkwear.postproc.statistics.intervals import Ends
from bulkwear.workflows.cases.sliding_sample.comparison import still_designed
from bulkwear.workflows.cases.sliding_sample.search.record import FORESEEN, best_confirmed
from bulkwear.workflows.config.rounds import last_round
from bulkwear.workflows.report.sections import Cards, Pictures, Section, Table, Text
from bulkwear.workflows.report.sensitivity import read_indices, sensitivity_blocks
from bulkwear.workflows.report.text import name_and_unit

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

CONFIRMED, EXCLUDED, RECORD = "search/confirmed.csv", "search/excluded.csv", "figures/search_record.csv"
SENSITIVITY = "figures/search_sensitivity.csv"
DIGITS = 2
ENOUGH = {"yes": "enough", "no": "too little", "open": "whether that is enough cannot be said"}


def told(study: Study) -> dict[str, Any]:
    """Return what the section is told of a study; nothing where nothing is looked for."""
    search = study.optimise
    if search is None:
        return {}
    return {"search": {"factors": search.names, "after_h": search.after_h, "least_left": search.least_left}}


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections about a search."""
    search = study["told"]["search"]
    confirmed = _read(folder / CONFIRMED)
    best = best_confirmed(confirmed)
    hours, least = search["after_h"], 100.0 * search["least_left"]
    note = (
        "Predicted: by the surrogate before the last packings were simulated. Over reference: in the same packings. "
        f"Left: of the pattern's volume after {hours:g} h at the measured loss, interval of packings and wear "
        "coefficient; the loss is taken to stay as it is, though a pattern that wears changes it. A pattern that was "
        "chosen with some of the packings that it is told by is told a little too low."
    )
    how = (
        f"Looked for is the pattern of least wear over plain of which {least:g} % or more are left after {hours:g} h. "
        f"Last round: {last_round(folder)}. Candidates that cannot be made were left out before they were meshed:"
    )
    cards = [
        (_ends(best, "wear_over_plain", "interval_low", "interval_high"), f"wear of {best['setting']} over plain"),
        (_ends(best, *FORESEEN), "predicted before"),
        (_ends(best, *_over_reference()), f"of the wear of {confirmed['setting'].iloc[-1]}"),
        (f"{best['left_percent']:.3g} %", f"of the pattern left after {hours:g} h: {ENOUGH[best['enough_left']]}"),
    ]
    return [
        Section("The best pattern", [Cards(cards), Table(confirmed, "confirmed", note), Pictures(["search_slices"])]),
        Section(
            "How it was found",
            [
                Text(how),
                Table(_read(folder / EXCLUDED), "excluded"),
                Pictures(["search_record"]),
                Table(_read(folder / RECORD), "search_record"),
                Pictures(["search_sensitivity"]),
                *sensitivity_blocks(read_indices(folder / SENSITIVITY)),
            ],
        ),
    ]


def answers(folder: Path) -> list[str]:
    """Return what a search found, in sentences; nothing where nothing was looked for."""
    confirmed = _confirmed(folder)
    if confirmed is None:
        return []
    best, reference = best_confirmed(confirmed), confirmed["setting"].iloc[-1]
    names = confirmed.columns[1 : confirmed.columns.get_loc("packings")]
    shape = ", ".join(_measure(name, best[name]) for name in names)
    wear = Ends(*best[["wear_over_plain", "interval_low", "interval_high", "packings"]])
    over = Ends(*best[[*_over_reference(), "packings"]])
    compared = "" if best["setting"] == reference else f", {over.text(DIGITS)} of that of {reference}"
    predicted = _ends(best, *FORESEEN)
    return [
        f"The best pattern, {best['setting']} ({shape}), wears {wear.text(DIGITS)} of the plain sample's"
        f" volume{compared}.",
        f"Predicted were {predicted}; {best['left_percent']:.3g} % of it are left after its hours,"
        f" {ENOUGH[best['enough_left']]}.",
    ]


def of_best(summary: pd.DataFrame, folder: Path) -> pd.DataFrame:
    """Return the runs of a summary that are of the best confirmed pattern, all of them where nothing was looked for:
    one that was tried in fewer packings may wear less by luck.
    """
    confirmed = _confirmed(folder)
    return summary if confirmed is None else summary[summary["setting"] == best_confirmed(confirmed)["setting"]]


def _confirmed(folder: Path) -> pd.DataFrame | None:
    """Return the confirmed patterns of a study; None where nothing was looked for, or by an earlier choice of settings
    whose patterns are not in the study's design any more.
    """
    if not (folder / CONFIRMED).is_file():
        return None
    confirmed = _read(folder / CONFIRMED)
    return confirmed if still_designed(confirmed["setting"], folder) else None


def _measure(name: str, value: float) -> str:
    words, unit = name_and_unit(name)
    return f"{words} {value:g} {unit}"


def _over_reference() -> tuple[str, str, str]:
    return "over_reference", "over_reference_low", "over_reference_high"


def _ends(line: pd.Series, value: str, low: str, high: str) -> str:
    return f"{line[value]:.{DIGITS}g} ({line[low]:.{DIGITS}g} to {line[high]:.{DIGITS}g})"


def _read(path: Path) -> pd.DataFrame:
    return pd.read_csv(path, dtype={"setting": str})
