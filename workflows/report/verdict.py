"""The verdict at the top of a page: what the study answers, how far that can be trusted, what it hangs on most."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.steady import DRIFTING, FEWEST_VALUES, STEADY, UNSAID, steady_window
from bulkwear.postproc.tables.summary import read_summary
from bulkwear.workflows.report.friction import friction_light
from bulkwear.workflows.report.page_parameters import answers_of_study, page_of
from bulkwear.workflows.report.sections import CARE, SOUND, WEAK, Block, Light, Lights, Points, Section, Text
from bulkwear.workflows.report.text import largest_carried_share, number, range_text, simplifications
from bulkwear.workflows.report.time_step import time_step_light

TITLE = "Verdict"
LEAST_CARRIED, MUCH_CARRIED = 0.01, 0.1  # -, of the worn volume: less changes no digit; more is another shape
ENOUGH_PACKINGS = 3  # from which on an interval tells something
UNEVEN = 0.01  # -, of a distance between cycles: more is no series for `steady_window`
UNEVEN_CYCLES = "cannot be said of uneven cycles"  # an answer beside those of `statistics.steady`
PERCENT = 100.0
MOST_SAID, FEWEST_FOLDED = 8, 3  # sentences that stand open: more hide the answer; fewer are not worth folding
MOST_NAMED = 5  # settings of the design that were not run


def with_verdict(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a study's page, its verdict first; a case without wear has one if it has lights.

    study: as from `page_parameters.page_parameters`; folder: results/<study>
    """
    page = page_of(study["case"])
    sections = page.sections(study, folder)
    return [verdict(study, folder), *sections] if study["wears"] or hasattr(page, "lights") else sections


def verdict(study: Mapping[str, Any], folder: Path) -> Section:
    """Return the verdict on a study that was run.

    A case's module `page` may have `answers(folder)` and `facts(study, folder)`, sentences; `steadiness(folder)`, an
    answer of `statistics.steady` per run, where wear per metre does not tell it; and WEIGHTIEST, the name of the
    simplification that its answers hang on most; ROLLS, false where nothing rolls. A case without wear has
    `lights(study, folder)` of its own.
    """
    page, summary = page_of(study["case"]), read_summary(folder / "summary.csv")
    facts = page.facts(study, folder) if hasattr(page, "facts") else []
    said = [*answers_of_study(study["case"], folder), *facts, *left_out_words(study["left_out"])]
    lights = lights_of_wear(study, folder, summary) if study["wears"] else page.lights(study, folder)
    shown = Lights([*lights, scale_light(study)])
    blocks: list[Block] = [*([leading(said)] if said else []), shown, *weightiest(study, summary)]
    return Section(TITLE, blocks)


def leading(said: Sequence[str]) -> Points:
    """Return sentences as points, all but the first few folded."""
    open_ = MOST_SAID if len(said) >= MOST_SAID + FEWEST_FOLDED else len(said)
    return Points(said[:open_], said[open_:])


def lights_of_wear(study: Mapping[str, Any], folder: Path, summary: pd.DataFrame) -> list[Light]:
    """Return how far the wear of a study can be trusted."""
    page = page_of(study["case"])
    return [
        steady_light(*_judged_steady(page, study, folder)),
        cap_light(study, summary),
        friction_light(study, folder),
        *([time_step_light(study)] if getattr(page, "ROLLS", True) else []),
        packings_light(pd.read_csv(folder / "design.csv", dtype=str)),
    ]


def left_out_words(settings: Sequence[str]) -> list[str]:
    """Return what is not told where no row of some settings of the design was run; nothing where all were."""
    if not settings:
        return []
    first, more = settings[:MOST_NAMED], len(settings) - MOST_NAMED
    named = ", ".join(first) + (f" and {more} more" if more > 0 else "")
    return [f"Not run: {named} of the design. What needs them, or is over the whole design, is not told."]


def steadiness(study: Mapping[str, Any], folder: Path) -> list[str]:
    """Return of each run whether its wear per metre is steady over the cycles; UNSAID where it has no wear.csv, or too
    few cycles, UNEVEN_CYCLES where these are not equally long.
    """
    paths = [folder / run / "wear.csv" for run in study["runs"]]
    return [_steady(pd.read_csv(path)) if path.is_file() else UNSAID for path in paths]


def _steady(wear: pd.DataFrame) -> str:
    distances = np.diff(wear["travel_m"], prepend=0.0)
    if len(wear) < FEWEST_VALUES:
        return UNSAID
    if np.ptp(distances) > UNEVEN * distances.max():
        return UNEVEN_CYCLES
    return steady_window(wear["travel_m"].to_numpy(), (wear["worn_volume_m3"] / distances).to_numpy()).answer


def _judged_steady(page: Any, study: Mapping[str, Any], folder: Path) -> tuple[list[str], str]:
    """Return an answer per run, and of what: a case of its own way judges the shape as built."""
    if hasattr(page, "steadiness"):
        return page.steadiness(folder), ", on the shape as built"
    return steadiness(study, folder), ""


def steady_light(answers: Sequence[str], of: str = "") -> Light:
    """Return whether runs are steady, from an answer of `statistics.steady`, or UNEVEN_CYCLES, per run; of: what of
    them, in words.
    """
    counts, runs = Counter(answers), len(answers)
    if counts[STEADY] == runs:
        return Light("Steady", SOUND, f"All runs are{of}.")
    if counts[DRIFTING]:
        return Light("Steady", WEAK, f"{counts[DRIFTING]} of {runs} runs still change: longer ones would tell more.")
    why = {UNSAID: "too short", UNEVEN_CYCLES: "of wear cycles of unequal travel"}
    told = {answer: f"they are {words}" for answer, words in why.items() if counts[answer]}
    if len(told) > 1:
        told = {answer: f"{counts[answer]} {why[answer]}" for answer in told}
    unsaid = sum(counts[answer] for answer in told)
    return Light("Steady", CARE, f"Of {unsaid} of {runs} runs it cannot be said: {', '.join(told.values())}.")


def cap_light(study: Mapping[str, Any], summary: pd.DataFrame) -> Light:
    """Return whether caps on a step hold back wear."""
    what = "Not limited by a cap"
    share = largest_carried_share(summary)
    if not study["settings"]["wear"]["deform"] or np.isnan(share):  # of a machine without updates nothing is worn
        return Light(what, CARE, "The shape is kept as built: wear is told, not applied.")
    state = SOUND if share < LEAST_CARRIED else CARE if share < MUCH_CARRIED else WEAK
    if state == SOUND:
        return Light(what, state, "All wear is in the shape.")
    held = f"Caps on a step hold back up to {number(PERCENT * share, 2)} % of a run's wear at the end"
    return Light(what, state, f"{held}: volumes count it, the shape lags behind.")


def packings_light(design: pd.DataFrame) -> Light:
    """Return whether settings were replicated. design: the design table of the study."""
    counts = design.groupby("setting")["packing"].nunique().tolist() if "packing" in design else [1]
    state = SOUND if min(counts) >= ENOUGH_PACKINGS else CARE if min(counts) > 1 else WEAK
    said = f"{range_text(counts)} random packing{'s' * (max(counts) > 1)} of each setting"
    unknown = ", the scatter is unknown" if max(counts) < 2 else ", the scatter is unknown of those with one"
    return Light("Replicated", state, f"{said}{unknown if min(counts) < 2 else ''}.")


def scale_light(study: Mapping[str, Any]) -> Light:
    """Return whether particles, machine and travel have their true size."""
    scales = [run["particle"]["scale"] for run in study["parameters"].values() if "particle" in run] or [1.0]
    if max(scales) == 1.0:
        return Light("Scale", SOUND, "Particles have their true size.")
    return Light("Scale", CARE, f"Particles are {range_text(scales, 3)} times as large as the real ones.")


def weightiest(study: Mapping[str, Any], summary: pd.DataFrame) -> list[Text]:
    """Return the simplification that answers hang on most: the one that the case names, else what is scaled most."""
    page = page_of(study["case"])
    found = dict(simplifications(study, summary, page))
    scales = [run["particle"]["scale"] for run in study["parameters"].values() if "particle" in run]
    acceleration = study["settings"]["wear"]["acceleration"]
    names = [
        getattr(page, "WEIGHTIEST", ""),
        *(["Particles"] if max(scales, default=1.0) > 1.0 else []),
        *(["Wear acceleration"] if acceleration != 1.0 else []),
        "Wear law",
    ]
    name = next(each for each in names if each in found)
    return [Text(f"The assumption that matters most: {name[0].lower()}{name[1:]}. {found[name]}")]
