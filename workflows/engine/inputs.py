"""What runs and beds are simulated from, as hashes: whether finished cycles still hold, and whether a job runs again.

The hash of a run holds what solver and wear step consume: the decks of cycle 0 and of the first wear cycle, the
sections of parameters that the driver itself reads, and the version of the wear code. A setting that changes none of
them changes no hash, so nothing is simulated again for it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bulkwear.postproc.wear import WEAR_VERSION
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.case import Case, Parameters, code_of_project
from bulkwear.workflows.engine.chain import Chain, write_bed
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.engine.schedule import first_span

DERIVED = (
    "time_step_s",
    "travel_steps",
    "physical_patch_factor",
)  # what the driver reads of what follows


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


def run_digest(case: Case, parameters: Parameters, bed: Parameters | None) -> str:
    """Return the hash of what a run is simulated from besides its surface and the restart file of its bed.

    How many cycles there are is left out where the case says that it changes none of them.
    """
    spans = (None, first_span(parameters))
    sections = {name: parameters[name] for name in case.consumed} | {
        "derived": {name: parameters["derived"][name] for name in DERIVED}
    }
    consumed = {
        "wear_version": WEAR_VERSION,
        "ledger": parameters["ledger"],
        "pieces": [case.piece_ends(parameters, bed, span) for span in spans],
        **{
            section: {key: value for key, value in values.items() if (section, key) not in case.length}
            for section, values in sections.items()
        },
    }
    consumed |= _code_of_project(case, parameters)
    return state.digest(consumed, *case.sample_decks(parameters, bed))


def _code_of_project(case: Case, parameters: Parameters) -> dict[str, Any]:
    """Return the hashes of Python files of the project that a run depends on; nothing where all is the package's."""
    law = dict(current_project().own_laws).get(parameters["wear"]["law"]) if "wear" in parameters else None
    found = {"law": state.file_digest(law) if law else "", "case": code_of_project(case)}
    return {name: value for name, value in found.items() if value}


def surface_from(case: Case, parameters: Parameters) -> dict[str, Any]:
    """Return the sections of a run's parameters that its surface is made from; of a project's case with its code."""
    sections = {name: parameters[name] for name in case.geometry}
    code = code_of_project(case)
    return SimulatedFrom(sections, state.digest(sections, code)) if code else sections


def inputs_digest(chain: Chain) -> str:
    """Return the hash of all that the cycles of a run depend on: see `run_digest`, its surface and its bed."""
    files = [path for path in (chain.surface, chain.bed_restart) if path]
    return state.digest(run_digest(chain.case, chain.parameters, chain.bed), *map(state.file_digest, files))


def bed_digest(case: Case, bed: Parameters) -> str:
    """Return the hash of what a bed is filled from: its deck and what the deck reads."""
    with tempfile.TemporaryDirectory() as folder:
        write_bed(case, bed, Path(folder))
        return state.digest(*(state.file_digest(path) for path in sorted(Path(folder).rglob("*")) if path.is_file()))
