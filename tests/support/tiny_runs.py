"""Runs of the tiny chain: the same elsewhere, their tables, one cycle of them."""

import shutil
from dataclasses import replace
from pathlib import Path

import pandas as pd

from bulkwear.postproc.mesh import read_surface
from bulkwear.workflows.engine import cycles, state
from bulkwear.workflows.engine.accounting import account
from bulkwear.workflows.engine.chain import write_cycle, write_shared_files
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.schedule import first_span

SHORT_STEPS = {"rayleigh_fraction": 0.2}  # where forces that are evaluated once more are compared
LOOKS = {"wear_interval_mm": 2, "picture_interval_mm": 1}


def twin(chain, folder: Path):
    """The same run elsewhere, nothing of it done yet."""
    copy = folder / chain.name
    copy.mkdir(parents=True)
    shutil.copy(chain.surface, copy / "surface.vtu")
    return replace(chain, folder=copy, surface=copy / "surface.vtu")


def wear_cycles(chain) -> int:
    return chain.parameters["sliding"]["cycles"]


def wear_table(chain) -> pd.DataFrame:
    return pd.read_csv(chain.folder / "wear.csv")


def first_ledger(chain, finished) -> pd.DataFrame:
    """Ledger of a chain's first wear cycle, from the restart file of the undisturbed run."""
    shutil.copytree(state.cycle_folder(finished.folder, 0), state.cycle_folder(chain.folder, 0))
    folder = state.cycle_folder(chain.folder, 1)
    folder.mkdir()
    surface = read_surface(chain.surface)
    write_shared_files(chain)
    span = first_span(chain.parameters)
    write_cycle(chain, span, folder, surface)
    cycles.simulate(chain, span, folder, {f"sample_{span.cycle}": len(surface.triangles)}, Progress(chain.name, 1))
    return account(chain, span, folder, chain.case.pieces(chain.parameters, span, surface))


def copy_cycles(source, target) -> None:
    for cycle in range(wear_cycles(source) + 1):
        shutil.copytree(state.cycle_folder(source.folder, cycle), state.cycle_folder(target.folder, cycle))
