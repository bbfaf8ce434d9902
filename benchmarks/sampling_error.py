"""How far a sampled load ledger is from the exact one: a bed's contacts at every step, accounted at several strides.

    python -m benchmarks.sampling_error --output docs        # in the root of the repository

One run of the demo's bed writes every contact of every step into dumps and sums them in the solver as well, so that
both see the same motion. The dumps are then accounted at strides of 1 to 100 steps. Writes sampling_error.csv and .png.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping
from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.command_line import command, output_folder
from benchmarks.runs import cycle_deck, prepared_chain
from bulkwear.postproc.plots.curves import sampling_error
from bulkwear.postproc.plots.style import save
from bulkwear.postproc.readers.contacts import read_contact_batches
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.wear.ledger import LedgerBuilder
from bulkwear.workflows.engine.case import LOAD_LEDGER
from bulkwear.workflows.engine.chain import Chain, deck_text
from bulkwear.workflows.engine.ledgers import CONTACTS, SAMPLE_MESH, SPINS, effective_modulus
from bulkwear.workflows.engine.schedule import first_span
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, run_deck

PARTICLE_SCALE = 2.0  # of the demo at its quick fidelity
STRIDES = (1, 5, 10, 50, 100)  # steps between two samples
BLOCKS = 10  # windows into which the travel is cut, for the error of a short one
RESET_LINE = re.compile(r'^if .* "reset_timestep 0"', re.MULTILINE)
LEDGER_LINE = f"fix load_ledger all load/ledger mesh sample_1 file {LOAD_LEDGER}\n\n"


def with_whole_windows(chain: Chain) -> Chain:
    """Return the chain with a cycle in which every window holds the same number of samples at every stride."""
    derived = chain.parameters["derived"]
    window = BLOCKS * max(STRIDES)
    steps = derived["first_cycle_steps"] // window * window
    return replace(chain, parameters={**chain.parameters, "derived": {**derived, "first_cycle_steps": steps}})


def deck_of_both(chain: Chain) -> str:
    """Return the deck of the first wear cycle that dumps every contact of every step and has the ledger as well."""
    parameters = chain.parameters
    every_step = {**parameters, "ledger": "dumps", "solver": {**parameters["solver"], "sampling_interval_steps": 1}}
    text = deck_text(replace(chain, parameters=every_step), first_span(every_step))
    return RESET_LINE.sub(lambda found: LEDGER_LINE + found[0], text)


def sampled_work(folder: Path, chain, triangles: int, strides, blocks: int) -> dict[int, np.ndarray]:
    """Return {stride: (blocks, triangles) sliding work in J} of the dumps; one pass over them."""
    steps, dt = chain.parameters["derived"]["first_cycle_steps"], chain.parameters["derived"]["time_step_s"]
    length = steps // blocks
    density = chain.parameters["particle"]["density_kg_per_m3"]
    arguments = (triangles, SAMPLE_MESH, effective_modulus(chain.parameters), density)
    builders = {stride: [LedgerBuilder(*arguments) for _ in range(blocks)] for stride in strides}
    for batch in read_contact_batches(folder / CONTACTS, folder / SPINS, after_step=0):
        for contacts in batch:
            block = (contacts.step - 1) // length
            for stride in strides:
                if block < blocks and contacts.step % stride == 0:
                    builders[stride][block].add(contacts, stride * dt)
    return {
        stride: np.array([builder.table()["sliding_work_J"] for builder in of_blocks])
        for stride, of_blocks in builders.items()
    }


def sampling_errors(
    sampled: Mapping[int, np.ndarray], exact: np.ndarray, dump_bytes: int, ledger_bytes: int
) -> pd.DataFrame:
    """Return one row per stride: errors of the sliding work, relative, and the disk that each way takes.

    sampled: {stride in steps: (windows, m) sliding work in J per window of the travel and triangle}, with stride 1
    exact: (m,) sliding work in J of the whole travel, summed in the solver
    dump_bytes, ledger_bytes: what the dumps at stride 1, and the solver's ledger, take

    total_error: of the sum over all triangles and windows, against `exact`
    short_window_error: root mean square over the windows of the error of a window's sum, against stride 1
    map_error: sum over triangles of the error's magnitude over the total, against `exact`
    """
    every_window = sampled[1].sum(axis=1)
    rows = []
    for stride, work in sampled.items():
        short = work.sum(axis=1) / every_window - 1.0
        rows.append(
            {
                "stride_steps": stride,
                "total_error": abs(work.sum() / exact.sum() - 1.0),
                "short_window_error": float(np.sqrt(np.mean(short**2))),
                "map_error": float(np.abs(work.sum(axis=0) - exact).sum() / exact.sum()),
                "dumps_MB": dump_bytes / stride / 1e6,
                "solver_ledger_MB": ledger_bytes / 1e6,
            }
        )
    return pd.DataFrame(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/sampling_error"))
    parser.add_argument("--output", type=output_folder, default="docs")
    given = parser.parse_args()
    chain = with_whole_windows(prepared_chain(given.folder, PARTICLE_SCALE))
    folder, surface, _ = cycle_deck(chain, "every_step")
    (folder / "deck.in").write_text(deck_of_both(chain))
    if not (folder / LOAD_LEDGER).exists():
        run_deck(folder, executable=LEDGER_EXECUTABLE)
    derived, triangles = chain.parameters["derived"], len(surface.triangles)
    exact = read_load_ledger(folder / LOAD_LEDGER, "sample_1", triangles, derived["first_cycle_steps"])
    sampled = sampled_work(folder, chain, triangles, STRIDES, BLOCKS)
    dump_bytes = sum((folder / name).stat().st_size for name in (CONTACTS, SPINS))
    table = sampling_errors(sampled, exact.columns["sliding_work_J"], dump_bytes, (folder / LOAD_LEDGER).stat().st_size)
    travel = derived["first_cycle_steps"] * derived["time_step_s"] * chain.parameters["sliding"]["velocity_m_per_s"]
    remarks = [
        f"convex sample of the demo, particle scale {PARTICLE_SCALE:g}, one cycle of {1e3 * travel:.0f} mm travel "
        f"({derived['first_cycle_steps']} steps), short windows of {1e3 * travel / BLOCKS:.0f} mm, "
        f"{triangles} triangles",
        f"made by benchmarks/sampling_error.py, {date.today():%Y-%m-%d}, {exact.header['solver'].split(',')[0]}",
    ]
    table.to_csv(given.output / "sampling_error.csv", index=False, float_format="%.4g")
    save(sampling_error(table, remarks), given.output / "sampling_error.png")
    print(table.to_string(index=False))


if __name__ == "__main__":
    command(main)
