"""The table of the beds of a study: which settings start from each, what was asked of it, and what it has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.engine.beds import MEASURES
from bulkwear.workflows.report.products import Job, tables
from bulkwear.workflows.report.sections import Block, Table

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.config.design import Study

BEDS = "beds.csv"  # in a study's folder of results
MILLIMETRES = {"level": 1e3, "depth": 1e3}
NOTE = """
Asked: the mass of a level bed at the bulk density of the material, and its height. Level: twice the height of the
centre of mass; on the floor grains lie looser, so that a bed's level is some tenths of a grain high. A bed outside a
tolerance is refused before any run starts from it.
"""


def every_bed(study: Study) -> list[str]:
    """Return the files that say that the beds of a study are there."""
    return [f"results/{study.name}/beds/{bed}/cost.csv" for bed in study.beds]


def values_of_beds(study: Study) -> dict[str, dict[str, Any]]:
    """Return by bed the settings and the packing of the runs that start from it, and its particle scale."""
    found: dict[str, dict[str, Any]] = {}
    for run in study.runs:
        bed = study.bed_of(run.name)
        words = {"packing": study.packing_of[run.row], "particle_scale": study.beds[bed]["particle"]["scale"]}
        settings = found.setdefault(bed, {"settings": [], **words})["settings"]
        if study.setting_of[run.row] not in settings:
            settings.append(study.setting_of[run.row])
    return found


@tables(inputs={"beds": every_bed}, told={"beds": values_of_beds}, tables={"beds": BEDS}, digits=9)
def beds(job: Job) -> dict[str, pd.DataFrame]:
    """Make the table of the beds that runs started from."""
    return {"beds": beds_table(job.told.beds, job.files.beds)}


def beds_table(values: Mapping[str, Mapping[str, Any]], files: Sequence[str | Path]) -> pd.DataFrame:
    """Return a row per bed: asked, found and tolerance of each measure.

    values: as from `values_of_beds`; files: as from `every_bed`
    """
    import pandas as pd

    folders = {Path(file).parent.name: Path(file).parent for file in files}
    rows = []
    for bed, words in values.items():
        row = {"bed": bed, **words, "settings": ", ".join(words["settings"])}
        for each in pd.read_csv(folders[bed] / MEASURES).itertuples():
            unit, factor = ("mm", MILLIMETRES[each.measure]) if each.measure in MILLIMETRES else (each.unit, 1.0)
            for what in ("asked", "found", "tolerance"):
                row[f"{each.measure}_{what}_{unit}"] = factor * getattr(each, what)
        rows.append(row)
    return pd.DataFrame(rows)


def blocks_of_beds(folder: Path, note: str = NOTE) -> list[Block]:
    """Return the table of a study's beds as a page shows it."""
    import pandas as pd

    return [Table(pd.read_csv(folder / BEDS), "beds", note)]
