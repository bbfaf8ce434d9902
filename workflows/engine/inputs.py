"""What runs and beds are simulated from, as hashes: whether finished cycles still hold, and whether a job runs again.

The hash of a run holds what solver and wear step consume: the decks of cycle 0 and of the first wear cycle, the
sections of parameters that the driver itself reads, and the version of the wear code. A setting that changes none of
them changes no hash, so nothing is simulated again for it. Where later cycles may be longer than the first, the hash
has what their decks take besides.
"""

from __future__ import annotations

import json
import math
import tempfile
import textwrap
from collections.abc import Mapping
from itertools import zip_longest
from pathlib import Path
from typing import Any

from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.postproc.wear import WEAR_VERSION
from bulkwear.postproc.wear.kernel_sums import kernel_sums
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.case import Case, Parameters
from bulkwear.workflows.engine.chain import DECK, WORN_THROUGH, Chain, bed_deck_text, write_bed
from bulkwear.workflows.engine.derived import ADAPTIVE, ROUNDING, laws_beside
from bulkwear.workflows.engine.own_code import code_of_case, code_of_law
from bulkwear.workflows.engine.schedule import first_span, known_spans
from bulkwear.workflows.engine.worn_pair import BESIDE

DERIVED = (
    "time_step_s",
    "travel_steps",
    "physical_patch_factor",
)  # what the driver reads of what follows


SIMULATED_FROM = "simulated_from.json"  # in cycle 0 of a run
LONGER_CYCLES = "longer_cycles"  # key of what only the decks of later cycles have
LONGEST_LINE = 100  # characters of a deck's line or a setting in a sentence


class SimulatedFrom(dict):
    """Parameters that a job of Snakemake gets; what it compares with those of before is the hash, not the values.

    A job so runs again when the hash changes, whatever keys the parameters have, and Snakemake's reason is one line.
    """

    def __init__(self, values: Mapping[str, Any], digest: str):
        super().__init__(values)
        self.digest = digest

    def __repr__(self) -> str:
        return f"simulated from {self.digest[: state.DIGEST_LETTERS]}"

    def __reduce__(self) -> tuple[type, tuple[dict[str, Any], str]]:
        return SimulatedFrom, (dict(self), self.digest)

    @staticmethod
    def all_of(values: Mapping[str, Any]) -> SimulatedFrom:
        """Return parameters of which every one counts."""
        return SimulatedFrom(values, state.digest(values))


def run_digest(case: Case, parameters: Parameters, bed: Parameters | None) -> str:
    """Return the hash of what a run is simulated from besides its surface and the restart file of its bed."""
    return digest_of(simulated_from(case, parameters, bed))


def digest_of(found: Mapping[str, Any]) -> str:
    """Return the hash of what `simulated_from` returns."""
    return state.digest(found["settings"], *found["decks"])


def job_digest(case: Case, parameters: Parameters, digest: str) -> str:
    """Return the hash by which the job of a run is done again: that of `digest_of`, and how long the run is.

    A longer run goes on from the cycles of the shorter one, which are the same; of a case whose cycles depend on the
    length the hash has it already.
    """
    length = {f"{section}.{key}": parameters[section].get(key) for section, key in case.length}
    return state.digest(digest, length) if length else digest


def simulated_from(case: Case, parameters: Parameters, bed: Parameters | None) -> dict[str, Any]:
    """Return what a run is simulated from besides its surface and the restart file of its bed, JSON-able.

    settings: what the driver reads; decks: texts of one of each kind; surface, bed: what these are made from. How many
    cycles there are is left out where the case says that it changes none of them.
    """
    spans = (None, first_span(parameters))
    sections = {name: parameters[name] for name in case.consumed} | {
        "derived": {name: parameters["derived"][name] for name in DERIVED}
    }
    settings = {
        "wear_version": WEAR_VERSION,
        "ledger": parameters["ledger"],
        "pieces": [case.piece_ends(parameters, bed, span) for span in spans],
        **{section: _simulated(case, section, values) for section, values in sections.items()},
        **({BESIDE: beside} if (beside := kernel_sums(laws_beside(parameters))) else {}),
        **_of_longer_cycles(parameters),
        **_code_of_project(case, parameters),
    }
    return {
        "settings": settings,
        "decks": list(case.sample_decks(parameters, bed)),
        "surface": _simulated(case, "surface", surface_from(case, parameters)),
        "bed": bed or {},
    }


def _of_longer_cycles(parameters: Parameters) -> dict[str, Any]:
    """Return what decks of adaptive cycles longer than the first one take, where that one's deck does not tell it.

    It tells the interval of pictures up to its own length, and an interval of looks at the wear that is a whole part of
    it, if its steps are enough to tell that part from the others.
    """
    sliding, derived = parameters["sliding"], parameters["derived"]
    if sliding["cycles"] != ADAPTIVE:
        return {}
    steps, found = derived["first_cycle_steps"], {}
    if (pictures := derived.get("picture_interval_steps", 0)) > steps:
        found["picture_interval_steps"] = pictures
    looks = parameters["solver"].get("wear_interval_m") if parameters["ledger"] == "solver" else None
    if looks:
        parts = max(round(sliding["first_cycle_m"] / looks), 1)
        if parts**2 > steps or not math.isclose(parts * looks, sliding["first_cycle_m"], rel_tol=ROUNDING):
            found["wear_interval_m"] = looks
    return {LONGER_CYCLES: found} if found else {}


def _simulated(case: Case, section: str, values: Any) -> Any:
    """Return a section without what only says how long a run is, and what only tables read."""
    if isinstance(values, list):
        return [_simulated(case, section, each) for each in values]
    if not isinstance(values, Mapping):
        return values
    left_out = {key for name, key in case.length if name == section} | set(case.only_told)
    return {key: _simulated(case, section, value) for key, value in values.items() if key not in left_out}


def other_inputs(run_folder: Path, found: Mapping[str, Any]) -> str | None:
    """Return in a phrase from what else a finished run was simulated; None where its cycles hold, or nothing is known.

    found: as from `simulated_from`; keys that came with a newer version and change no deck are none
    """
    try:
        before = json.loads((state.cycle_folder(run_folder, 0) / SIMULATED_FROM).read_text())
        if digest_of(before) == digest_of(json.loads(json.dumps(found))):
            return None
    except (OSError, ValueError, KeyError):
        return None
    return why_again(run_folder, found)


def other_length(run_folder: Path, case: Case, parameters: Parameters) -> str | None:
    """Return in a phrase how many cycles a finished run has where another number is asked for; None where it has them,
    of one that ended as it was worn through, and of a case whose cycles themselves depend on how long it is.
    """
    if not case.length:
        return None
    asked, there = len(known_spans(parameters)), len(cycle_folders(run_folder)) - 1
    if asked == there or (there > 0 and state.read_state(run_folder, there).get(WORN_THROUGH)):
        return None
    return f"{asked} wear cycles are asked for, it has {there}"


def other_bed(bed_folder: Path, case: Case, bed: Parameters) -> str | None:
    """Return in a phrase by what other deck a filled bed was filled; None where it was this one, or none is left."""
    filled = bed_folder / DECK
    if not filled.is_file():
        return None
    before, now = filled.read_text(encoding="utf-8"), bed_deck_text(case, bed)
    return None if before == now else f"its deck changed, {_first_change(before, now)}"


def why_again(run_folder: Path, found: Mapping[str, Any]) -> str | None:
    """Return in a phrase what a run is simulated from now that its finished cycles were not; None if nothing is known.

    found: as from `simulated_from`; cycle 0 keeps it
    """
    try:
        before = json.loads((state.cycle_folder(run_folder, 0) / SIMULATED_FROM).read_text())
    except (OSError, ValueError):
        return None
    now = json.loads(json.dumps(found))
    if before == now:
        return None
    for number, (old, new) in enumerate(zip_longest(before["decks"], now["decks"], fillvalue="")):
        if old != new:
            return f"its deck of {'a wear cycle' if number else 'cycle 0'} changed, {_first_change(old, new)}"
    for name in ("settings", "surface", "bed"):
        old = _named_now(before.get(name), now[name]) if name == "surface" else before.get(name)
        if name in before and old != now[name]:
            return _changed_setting(old, now[name], "" if name == "settings" else name)
    return None


def _named_now(before: Any, now: Any) -> Any:
    """Return what was kept of a surface without the keys that no surface is made from any more."""
    if isinstance(before, dict) and isinstance(now, dict):
        return {key: _named_now(before[key], now[key]) for key in before.keys() & now}
    if isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        return [_named_now(*pair) for pair in zip(before, now, strict=True)]
    return before


def _first_change(old: str, new: str) -> str:
    """Return the first line in which two decks differ."""
    lines = enumerate(zip_longest(old.splitlines(), new.splitlines(), fillvalue=""), start=1)
    number, was, now = next((number, *map(_one_line, pair)) for number, pair in lines if pair[0] != pair[1])
    return f"line {number}: '{now}', it was '{was}'"


def _one_line(text: str) -> str:
    return textwrap.shorten(text, LONGEST_LINE, placeholder=" ...")


def _changed_setting(old: Any, new: Any, name: str = "") -> str:
    """Return the first setting that differs."""
    if isinstance(old, dict) and isinstance(new, dict):
        key = next(key for key in {**old, **new} if old.get(key) != new.get(key))
        return _changed_setting(old.get(key), new.get(key), f"{name}.{key}" if name else key)
    return f"{name} is {_one_line(str(new))}, it was {_one_line(str(old))}"


def _code_of_project(case: Case, parameters: Parameters) -> dict[str, Any]:
    """Return the hashes of a project's own files that a run depends on; nothing where all is the package's."""
    laws = [*case.laws(parameters), *laws_beside(parameters)]
    law = {file: found for name, _ in laws for file, found in code_of_law(name).items()}
    return {name: value for name, value in {"law": law, "case": code_of_case(case)}.items() if value}


def surface_from(case: Case, parameters: Parameters) -> dict[str, Any]:
    """Return the parameters of a run that its surface is made from; of a project's case with its code.

    Those of a machine are compared by their hash too: its parts are many.
    """
    sections, code = case.surface_sections(parameters), code_of_case(case)
    return SimulatedFrom(sections, state.digest(sections, code)) if code or case.by_part else sections


def inputs_digest(chain: Chain) -> str:
    """Return the hash of all that the cycles of a run depend on: see `run_digest`, its surface and its bed."""
    files = [path for path in (chain.surface, chain.bed_restart) if path]
    return state.digest(run_digest(chain.case, chain.parameters, chain.bed), *map(state.file_digest, files))


def bed_digest(case: Case, bed: Parameters) -> str:
    """Return the hash of what a bed is filled from: its deck and what the deck reads."""
    with tempfile.TemporaryDirectory() as folder:
        write_bed(case, bed, Path(folder))
        return state.digest(*(state.file_digest(path) for path in sorted(Path(folder).rglob("*")) if path.is_file()))
