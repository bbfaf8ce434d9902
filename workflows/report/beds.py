"""The table of the beds of a study: which settings start from each, what was asked of it, and what it has."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.engine.beds import over_asked_density, read_measures
from bulkwear.workflows.engine.pouring import bulk_density
from bulkwear.workflows.report.products import Job, tables
from bulkwear.workflows.report.sections import Block, Table

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.config.design import Study
    from bulkwear.workflows.engine.beds import BedMeasure

ASKED_DENSITY = "asked_density_kg_per_m3"  # what is told of a bed's material
BEDS = "beds.csv"  # in a study's folder of results
MILLIMETRES = 1e3  # per metre
NOTE = """
Asked: the mass of a level bed at the bulk density of the material, and its height. Level: twice the height of the
centre of mass; on the floor grains lie looser, so that a bed's level is some tenths of a grain high. Bulk density: of
a level bed of the found mass and level, and over the material's, which is asked. In use: once more on the floor of a
window, where the bed has fallen a second time. A bed outside a tolerance is refused before any run starts from it.
"""


def every_bed(study: Study) -> list[str]:
    """Return the files that say that the beds of a study are there."""
    return [f"results/{study.name}/beds/{bed}/cost.csv" for bed in study.beds]


def values_of_beds(study: Study) -> dict[str, dict[str, Any]]:
    """Return by bed the settings and the packing of the runs that start from it, its scale, its asked bulk density."""
    found: dict[str, dict[str, Any]] = {}
    for run in study.runs:
        bed = study.bed_of(run.name)
        particle = study.beds[bed]["particle"]
        words = {"packing": study.packing_of[run.row], "particle_scale": particle["scale"]}
        words |= {ASKED_DENSITY: bulk_density(particle)}
        settings = found.setdefault(bed, {"settings": [], **words})["settings"]
        if study.setting_of[run.row] not in settings:
            settings.append(study.setting_of[run.row])
    return found


@tables(inputs={"beds": every_bed}, told={"beds": values_of_beds}, tables={"beds": BEDS}, digits=9)
def beds(job: Job) -> dict[str, pd.DataFrame]:
    """Make the table of the beds that runs started from."""
    return {"beds": beds_table(job.told.beds, job.files.beds)}


def beds_table(values: Mapping[str, Mapping[str, Any]], files: Sequence[str | Path]) -> pd.DataFrame:
    """Return a row per bed: asked, found and tolerance of each measure, and the bulk density by mass and level.

    values: as from `values_of_beds`; files: as from `every_bed`
    """
    import pandas as pd

    folders = {Path(file).parent.name: Path(file).parent for file in files}
    rows = []
    for bed, words in values.items():
        told = {name: value for name, value in words.items() if name != ASKED_DENSITY}
        measures = read_measures(folders[bed])
        row = {"bed": bed, **told, "settings": ", ".join(words["settings"])}
        rows.append(row | columns_of(measures) | density_columns(measures, words[ASKED_DENSITY]))
    return pd.DataFrame(rows)


def columns_of(measures: Iterable[BedMeasure]) -> dict[str, float]:
    """Return asked, found and tolerance of each measure by columns, lengths in mm."""
    columns = {}
    for each in measures:
        unit, factor = ("mm", MILLIMETRES) if each.unit == "m" else (each.unit, 1.0)
        for what in ("asked", "found", "tolerance"):
            columns[f"{each.measure.replace(' ', '_')}_{what}_{unit}"] = factor * getattr(each, what)
    return columns


def density_columns(measures: Iterable[BedMeasure], asked: float) -> dict[str, float]:
    """Return the bulk density (kg/m3) of a level bed of the mass and level that were found, and its ratio to the one
    asked for; none of a bed of which either is not known. asked: kg/m3
    """
    known = {each.measure: each for each in measures}
    if not {"mass", "level"} <= set(known):
        return {}
    ratio = over_asked_density(known["mass"], known["level"])
    return {"bulk_density_found_kg_per_m3": ratio * asked, "bulk_density_over_asked": ratio}


def blocks_of_beds(folder: Path, note: str = NOTE) -> list[Block]:
    """Return the table of a study's beds as a page shows it."""
    import pandas as pd

    return [Table(pd.read_csv(folder / BEDS), "beds", note)]
