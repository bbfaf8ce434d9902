"""Wear and cost of a sample in a window that travels with it, against the same in a bed of 2 m: sliding work per metre
in blocks of 100 mm of travel, and processor time of the wear cycles, in which the beds take turns. The command
`python -m benchmarks.travelling_window` writes a page of its own, docs/travelling_window_results.md, with its tables
and figure; `--surface plain` or `convex`, and what is there of the other surface stays.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.measure import Measure, measured
from postproc.mesh import write_surface
from postproc.plots.style import save
from postproc.plots.window import wear_side_by_side
from postproc.readers.cycle_folders import cycle_files, cycle_folders
from workflows import cycles, state
from workflows.accounting import HISTORY
from workflows.chain import Chain, run_in_steps, total_steps
from workflows.derived import WALLS
from workflows.design import REPOSITORY, load_study
from workflows.forecast import forecast_table, work_of
from workflows.geometry import sample_surface
from workflows.progress import Progress
from workflows.rates import DEFAULT, read_rates
from workflows.results_page import bullet, markdown, prose
from workflows.schedule import known_spans

STUDY, ROW = "demo", "R9"
BLOCK = 0.1  # m of travel; blocks of a bed of 40 mm forget each other
FULL = "bed of 2 m"
BEDS: dict[str, dict[str, Any]] = {  # the first is what others are compared with
    FULL: {"ends": "walls", "ahead_mm": 200, "behind_mm": 100},
    "window 150 + 150": {"ends": "window", "ahead_mm": 150, "behind_mm": 150},
    "window 100 + 50": {"ends": "window", "ahead_mm": 100, "behind_mm": 50},
}
SETTINGS: dict[str, Any] = {
    "fidelity": "standard",
    "particle_scale": 5.0,
    "sample": {"width_mm": 100, "length_mm": 100, "element_size_mm": 2},
    "bed": {"width_mm": 150, "exchange_mm": 35},
    "sliding": {"run_in_mm": 400, "travel_mm": 1200, "cycles": 4},
    "wear": {"deform": False},
}
QUICK: dict[str, Any] = {
    **SETTINGS,
    "particle_scale": 8.0,
    "sample": {"width_mm": 40, "length_mm": 40, "element_size_mm": 2},
    "bed": {"width_mm": 60, "exchange_mm": 55, "allow_thin_bed": True},
    "sliding": {"run_in_mm": 50, "travel_mm": 200, "cycles": 2},
}
SOURCE_EXCHANGE = 20  # mm of travel, at the source's particles
CHEAPER = {"length_m": "particle_steps", "core_hours": "core_hours"}  # column -> what it is the cost in


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return of each window the sliding work per metre block by block, and the processor time cycle by cycle."""
    chains = simulated(folder, "plain", QUICK if quick else SETTINGS)
    work = {name: blocks(chain) / BLOCK for name, chain in chains.items()}
    seconds = {name: [record["processor_s"] for record in cost_records(chain)[1:]] for name, chain in chains.items()}
    told = []
    for name in list(chains)[1:]:
        told.append(measured(f"{name}: sliding work", "J/m", work[name], FULL, work[FULL]))
        told.append(measured(f"{name}: wear cycle, processor time", "s", seconds[name], FULL, seconds[FULL]))
    return told


# ---------------------------------------------------------------- simulation


def simulated(folder: Path, surface: str, settings: Mapping[str, Any], most: int | None = None) -> dict[str, Chain]:
    """Return the runs of all beds; simulates what is missing in the folder, cycle by cycle in turn.

    most: wear cycles, all if it is not given
    """
    chains = {name: chain_of(folder, name, surface, settings) for name in BEDS}
    digests = {name: cycles.inputs_digest(chain) for name, chain in chains.items()}
    spans = [None, *known_spans(chains[FULL].parameters)[:most]]
    for turn, span in enumerate(spans):
        for name, chain in chains.items():
            if state.finished_cycles(chain.folder, digests[name]) > turn:
                continue
            before = run_in_steps(chain) + span.first_step if span else 0
            cycles.run_cycle(chain, span, digests[name], Progress(name, total_steps(chain), before))
    return chains


def chain_of(folder: Path, name: str, surface: str, settings: Mapping[str, Any]) -> Chain:
    """Return the run of one bed, its sample meshed and its bed settled, unless they are there."""
    study = load_study(STUDY, overrides={**settings, "bed": {**settings["bed"], **BEDS[name]}})
    run = f"{ROW}_{surface}"
    parameters, bed = study.run(run).parameters, study.beds[study.bed_of(run)]
    place = folder / name.replace(" ", "_")
    restart, mesh = place / "bed" / "bed.restart", place / run / "surface.vtu"
    if not restart.exists():
        cycles.fill_bed(name, bed, restart.parent)
    if not mesh.exists():
        mesh.parent.mkdir()
        write_surface(mesh, sample_surface(parameters["sample"], parameters["pattern"]))
    return Chain(run, place / run, study.case, parameters, mesh, bed, restart)


# ---------------------------------------------------------------- what came out


def blocks(chain: Chain) -> np.ndarray:
    """Return the sliding work (J) of each block of the counted travel; looks at the wear do not end with blocks."""
    history = pd.concat(map(pd.read_csv, cycle_files(chain.folder, HISTORY)), ignore_index=True)
    history["stretch_m"] = np.diff(history["travel_m"], prepend=0.0)
    number = np.floor((history["travel_m"] - 0.5 * history["stretch_m"]) / BLOCK).astype(int)
    sums = history.groupby(number)[["sliding_work_J", "stretch_m"]].sum()
    return (sums["sliding_work_J"] / sums["stretch_m"] * BLOCK).to_numpy()


def cost_records(chain: Chain) -> list[dict[str, float]]:
    """Return what the state of each cycle tells of its cost, the run-in first."""
    return [state.read_state(chain.folder, cycle)["cost"] for cycle in range(len(cycle_folders(chain.folder)))]


def costs(chain: Chain) -> dict[str, float]:
    """Return length, particles and particle-steps of a run, and the solver's processor time of it and of its bed."""
    records, bed = cost_records(chain), pd.read_csv(chain.bed_restart.with_name("cost.csv")).iloc[0]
    return {
        "bed_length_m": chain.bed["length_m"],
        "particles": float(np.mean([record["particles"] for record in records])),
        "particle_steps": float(sum(record["particles"] * record["steps"] for record in records)),
        "processor_s": float(sum(record["processor_s"] for record in records)),
        "bed_processor_s": float(bed["processor_s"]),
    }


def comparison(work: pd.DataFrame, cost: pd.DataFrame) -> pd.DataFrame:
    """Return a row per surface and bed: sliding work per metre with its standard error, and both over the full bed's.

    work: columns surface, bed, block, sliding_work_J; cost: surface, bed and what `costs` gives
    deviations_apart: difference of two means over its standard error; cheaper: cost of the full bed over the bed's own
    """
    per_metre = work.assign(work=work["sliding_work_J"] / BLOCK).groupby(["surface", "bed"], sort=False)["work"]
    table = per_metre.agg(sliding_work_J_per_m="mean", standard_error_J_per_m="sem", blocks="size").reset_index()
    table = table.merge(cost, on=["surface", "bed"])
    full = table[table["bed"] == FULL].set_index("surface").loc[table["surface"]].reset_index()
    mean, of_full = table["sliding_work_J_per_m"], full["sliding_work_J_per_m"]
    joint = np.hypot(table["standard_error_J_per_m"], full["standard_error_J_per_m"])
    own = table["bed"] == FULL
    return table.assign(
        wear_over_full=mean / of_full,
        error_of_that=(joint / of_full).mask(own),
        deviations_apart=((mean - of_full) / joint).mask(own),
        cheaper_in_particle_steps=full["particle_steps"] / table["particle_steps"],
        cheaper_in_processor_time=full["processor_s"] / table["processor_s"],
    )


def at_source_size() -> pd.DataFrame:
    """Return what the source's screening costs in its bed and in the same windows, by the forecast's default rates.

    Length of the bed (m), forecast core hours, beds included, and how much cheaper than the source's bed both are; bed,
    sample and time steps of a run are the same, so the length stands for its particle-steps.
    """
    rates, rows = read_rates(REPOSITORY / DEFAULT).rates, []
    for name, bed in {FULL: {"ends": WALLS}, **dict(list(BEDS.items())[1:])}.items():
        study = load_study("screening", overrides={"fidelity": "paper", "bed": {**bed, "exchange_mm": SOURCE_EXCHANGE}})
        length = study.runs[0].parameters["derived"]["bed_length_m"]
        rows.append(
            {"bed": name, "length_m": length, "core_hours": forecast_table(work_of(study), rates)["core_h"].sum()}
        )
    table = pd.DataFrame(rows)
    cheaper = {f"cheaper_in_{to}": table[of].iloc[0] / table[of] for of, to in CHEAPER.items()}
    return table.assign(**cheaper)


# ---------------------------------------------------------------- page


def remarks() -> list[str]:
    """Return what must be known about the figure."""
    sample, bed = SETTINGS["sample"], SETTINGS["bed"]
    return [
        f"particles at scale {SETTINGS['particle_scale']:g}, sample {sample['width_mm']} x {sample['length_mm']} mm, "
        f"bed {bed['width_mm']} mm wide and 40 mm thick, 1 m/s; the sample keeps its shape; wear is proportional to "
        "the sliding work",
        "one packing per bed: errors are those of blocks of 100 mm of travel, without the scatter between packings",
        "windows are named by the bed ahead of and behind the sample in mm",
        f"made by benchmarks/travelling_window.py, {date.today():%Y-%m-%d}",
    ]


def results_page(table: pd.DataFrame) -> str:
    """Return the page of results."""
    wear = ["surface", "bed", "sliding_work_J_per_m", "standard_error_J_per_m", "blocks", "wear_over_full"]
    cost = ["surface", "bed", "bed_length_m", "particles", "particle_steps", "processor_s", "bed_processor_s"]
    parts = [
        "# A travelling window against a full bed: results",
        prose(
            "Generated by `python -m benchmarks.travelling_window`; not to be edited. What a window is, is said in"
            " [travelling_window.md](travelling_window.md). Tables: [travelling_window.csv](travelling_window.csv),"
            " [travelling_window_blocks.csv](travelling_window_blocks.csv)."
        ),
        "\n".join(bullet(text) for text in remarks()),
        "## Wear",
        markdown(table[[*wear, "error_of_that", "deviations_apart"]]),
        "![Sliding work along the travel in a full bed and in windows](travelling_window.png)",
        "## Cost",
        markdown(table[[*cost, "cheaper_in_particle_steps", "cheaper_in_processor_time"]]),
        "## The source's bed",
        prose(
            "The same windows round the source's samples of 200 x 200 mm in particles of true size, all runs of its"
            f" screening, bed exchanged every {SOURCE_EXCHANGE} mm; forecast, not simulated. The small comparison above"
            " has so few particles that the triangles of its sample weigh more."
        ),
        markdown(at_source_size()),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def with_other_surface(path: Path, surface: str, rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return these rows after those that an earlier table has of the other surface, in columns of these."""
    now = pd.DataFrame(rows)
    if not path.exists():
        return now
    before = pd.read_csv(path)
    return pd.concat([before.loc[before["surface"] != surface, list(now)], now], ignore_index=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("docs"))
    parser.add_argument("--surface", choices=("plain", "convex"), default="plain")
    parser.add_argument("--folder", type=Path, help="where runs stay and are taken up again; else a temporary one")
    parser.add_argument("--cycles", type=int, help="wear cycles that are simulated, of 300 mm of travel each; else all")
    parser.add_argument("--redraw", action="store_true", help="from the tables of an earlier run")
    given = parser.parse_args()
    table_file, block_file = (given.output / f"travelling_window{part}.csv" for part in ("", "_blocks"))
    if not given.redraw:
        with tempfile.TemporaryDirectory() as temporary:
            chains = simulated(given.folder or Path(temporary), given.surface, SETTINGS, given.cycles)
            names = {name: {"surface": given.surface, "bed": name} for name in chains}
            found = [
                {**names[name], "block": k + 1, "sliding_work_J": value}
                for name, chain in chains.items()
                for k, value in enumerate(blocks(chain))
            ]
            cost = [{**names[name], **costs(chain)} for name, chain in chains.items()]
        work = with_other_surface(block_file, given.surface, found)
        table = comparison(work, with_other_surface(table_file, given.surface, cost))
        work.to_csv(block_file, index=False, float_format="%.5g")
        table.to_csv(table_file, index=False, float_format="%.5g")
    table = pd.read_csv(table_file)
    page = results_page(table)
    (given.output / "travelling_window_results.md").write_text(page, encoding="utf-8")
    save(wear_side_by_side(pd.read_csv(block_file), table, BLOCK, remarks()), given.output / "travelling_window.png")
    print(page)


if __name__ == "__main__":
    main()
