"""Which frictions does each rolling model ask for? River gravel's calibration on the shear box under each of our four
models: the family that fits, the pair that each recommends, and whether a pair holds under another model.

    python -m benchmarks.calibration_models --cores 2    # in the root of the repository: about an hour
    python -m benchmarks.calibration_models --models own_spin epsd2 --output /tmp
    python -m benchmarks.calibration_models --redraw    # page and figure from the table

Simulations stay in `--folder`, where a stopped one goes on; a model is done before the next. Writes into docs:
calibration_models.csv (every simulation; models that were not asked for stay in it), figure and
calibration_models_results.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from benchmarks.calibration_models_page import FIDELITY, MODEL, SEARCHED, results_page
from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.plots.rolling_models import families
from benchmarks.rolling_case import MODELS, study_of
from benchmarks.rolling_page import NO_REST
from benchmarks.runs import BY, DIGITS, attempted, simulated_by
from bulkwear.postproc.plots.style import save, save_small
from bulkwear.workflows.cases.calibration.boxes import SIMULATIONS
from bulkwear.workflows.cases.calibration.case import calibration_box, measured_file, pairs_file
from bulkwear.workflows.cases.calibration.driver import run_calibration
from bulkwear.workflows.cases.calibration.outcome import Calibrated, read_calibrated
from bulkwear.workflows.cases.calibration.simulations import FOLDERS
from bulkwear.workflows.config.design import Study
from bulkwear.workflows.engine.state import digest

FILE, PAGE, FIGURE = "calibration_models.csv", "calibration_models_results.md", "calibration_models.png"
TABLES = {"simulations.csv": True, "repeats.csv": False}  # of a calibration: whether its rows were searched
EXACT = "%.10g"  # of the table, so that a page that is drawn again recommends the same pairs


def calibrate(model: str, folder: Path, cores: int) -> pd.DataFrame:
    """Return a row per simulation of the calibration under a model, those that were searched and those of repeated
    pairs; of one that cannot end, one row with the solver's words in NO_REST.

    folder: where its simulations stay, in a folder of the model. Raises SolverStoppedError.
    """
    study, place = study_of(model, FIDELITY), folder / model
    place.mkdir(parents=True, exist_ok=True)
    files = Path(measured_file(study)), Path(pairs_file(study))
    found: list[pd.DataFrame] = []

    def task() -> None:
        simulations, _, repeats = run_calibration(calibration_box(study), *files, place, cores)
        found.extend((simulations.assign(pair=SEARCHED), repeats))

    failed = failure_file(place, study)
    attempted(task, failed)
    if not found:
        return pd.DataFrame({MODEL: [model], NO_REST: failed.read_text(encoding="utf-8").strip()})
    table = pd.concat(found, ignore_index=True)
    by = [simulated_by(place / SIMULATIONS / names.split()[-1]) for names in table[FOLDERS]]
    return table.drop(columns=FOLDERS).assign(**{MODEL: model, BY: by})


def failure_file(place: Path, study: Study) -> Path:
    """Return the file in a model's folder that says why it has no calibration; other settings have another one."""
    return place / f"failed_{digest(calibration_box(study))[:DIGITS]}.txt"


def calibrated(table: pd.DataFrame) -> dict[str, Calibrated]:
    """Return {model: finished calibration} of a table of all simulations, as from `calibrate`."""
    found = {}
    for model in (name for name in MODELS if (table.loc[table[MODEL] == name, "test"].notna()).any()):
        rows, study = table[table[MODEL] == model].dropna(axis=1, how="all"), study_of(model, FIDELITY)
        with TemporaryDirectory() as place:
            for name, searched in TABLES.items():
                rows[(rows["pair"] == SEARCHED) == searched].to_csv(Path(place, name), index=False)
            files = Path(measured_file(study)), Path(pairs_file(study))
            found[model] = read_calibrated(calibration_box(study), *files, Path(place))
    return found


def publish(output: Path, table: pd.DataFrame) -> str:
    """Write page and figure of a table of all simulations; return the page."""
    done = calibrated(table)
    failed = table.set_index(MODEL)[NO_REST].dropna().to_dict() if NO_REST in table else {}
    page = results_page(done, failed)
    (output / PAGE).write_text(page, encoding="utf-8")
    save(families(done, remarks_of(done)), output / FIGURE)
    save_small(output / FIGURE, output / FIGURE)
    return page


def remarks_of(done: Mapping[str, Calibrated]) -> list[str]:
    """Return what stands below the figure."""
    scale = next(iter(done.values())).parameters["particle"]["scale"]
    return [
        f"study calibration at {FIDELITY} fidelity: shear box, particles at scale {scale:g}; coefficients for the full"
        f" radius; {sum(len(each.everything) for each in done.values())} simulations",
        f"made by benchmarks/calibration_models.py, {date.today():%Y-%m-%d}",
    ]


def kept(file: Path, found: pd.DataFrame) -> pd.DataFrame:
    """Return a table of simulations, and before it the models of an earlier one that it does not have."""
    if not file.is_file():
        return found
    earlier = read_table(file, (MODEL,))
    return pd.concat([earlier[~earlier[MODEL].isin(found[MODEL])], found], ignore_index=True)


def parser_of() -> argparse.ArgumentParser:
    """Return the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--models", nargs="+", choices=MODELS, default=MODELS, help="else all")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full/calibration_models"))
    parser.add_argument("--cores", type=at_least_one, default=1, help="simulations side by side")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    return parser


def main(given: Sequence[str] | None = None) -> None:
    """Simulate what is missing, then write table, figure and page."""
    parser = parser_of()
    asked = parser.parse_args(given)
    file = asked.output / FILE
    for model in () if asked.redraw else asked.models:
        table = kept(file, calibrate(model, asked.folder, asked.cores))
        table.sort_values(MODEL, kind="stable").to_csv(file, index=False, float_format=EXACT)
    table = read_table(file, (MODEL,))
    if "test" not in table:
        parser.error(f"{file}: no model has a calibration; {table[NO_REST].iloc[0]}")
    print(publish(asked.output, table), flush=True)


if __name__ == "__main__":
    command(main)
