"""Tables of a study of equipment; what is drawn of them is in the other modules of figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.equipment.tables import values_of_runs
from bulkwear.workflows.report.products import Job, OfStudy, every_run, outputs_of, products_of_study, tables

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.config.design import Study

ANCHORS = {"anchors": "config/published/equipment_anchors.csv"}
RUNS = {
    "wear": every_run("wear.csv"),
    "surfaces": every_run("surface.vtu"),
}  # with the tables of the cycles beside them
DIGITS = 9
TABLES = {
    name: f"equipment/{name}.csv"
    for name in (
        *("rates", "life", "worst_places", "remaining", "steel", "loads"),
        *("flow", "mass_balance", "designs"),
    )
}
BESIDE_PUBLISHED = {name: f"equipment/{name}.csv" for name in ("key_numbers", "anchors")}
NUMBERS = ("life", "loads", "steel", "remaining", "designs", "flow")  # tables with numbers that may be published
LIFTERS = {"lifters": "equipment/lifters.csv"}
OF_MILLS = {"charge": ("charge_shape", "table"), "lifters": ("lifters", "lifters")}  # table: its product, key there


def of_mills(table: str) -> OfStudy:
    """Return a source: the path of a table of OF_MILLS; nothing where a study has none."""
    product, key = OF_MILLS[table]

    def path(study: Study) -> str | list[str]:
        found = products_of_study(study)
        return outputs_of(found[product], study.name)[key] if product in found else []

    return path


def runs_with_laws(study: Study) -> list[dict[str, Any]]:
    """Return `tables.values_of_runs`, with the parameters (SI) of the wear law of each part: law_parameters."""
    found = values_of_runs(study)
    for run, values in zip(study.runs, found, strict=True):
        for part in run.parameters["parts"]:
            values["parts"][part["name"]]["law_parameters"] = part["law_parameters"]
    return found


@tables(
    inputs=RUNS,
    told={"runs": runs_with_laws},
    tables=TABLES,
    digits=DIGITS,
)
def equipment_tables(job: Job) -> dict[str, pd.DataFrame]:
    """Make the tables of which the page and most figures are made."""
    from bulkwear.workflows.cases.equipment.comparison import designs_table
    from bulkwear.workflows.cases.equipment.flow_tables import flow_table, mass_balance
    from bulkwear.workflows.cases.equipment.life import part_lives
    from bulkwear.workflows.cases.equipment.life_tables import (
        life_table,
        part_volumes,
        remaining_table,
        steel_table,
        worst_places,
    )
    from bulkwear.workflows.cases.equipment.tables import loads_table, rates_table, read_runs

    folder = Path(job.files.wear[0]).parents[1]
    runs = read_runs(job.told.runs, folder)
    volumes = {
        (run["setting"], part): volume
        for run, surface in zip(job.told.runs, job.files.surfaces, strict=True)
        if run is runs.first(run["setting"])
        for part, volume in part_volumes(surface, run).items()
    }
    lives, rates = part_lives(runs, volumes), rates_table(runs)
    return {
        "rates": rates,
        "life": life_table(runs, lives),
        "worst_places": worst_places(runs, rates, lives),
        "remaining": remaining_table(runs, lives),
        "steel": steel_table(runs, lives),
        "loads": loads_table(runs),
        "flow": flow_table(runs),
        "mass_balance": mass_balance(runs),
        "designs": designs_table(runs, lives),
    }


@tables(
    inputs={
        **{name: f"results/{{study}}/{TABLES[name]}" for name in NUMBERS},
        **{name: of_mills(name) for name in OF_MILLS},
        **ANCHORS,
    },
    told={"runs": values_of_runs, "study": lambda study: study.name},
    tables=BESIDE_PUBLISHED,
    digits=DIGITS,
)
def beside_published(job: Job) -> dict[str, pd.DataFrame]:
    """Put what the study computes beside what is published of such machines."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import read_named
    from bulkwear.workflows.cases.equipment.published import beside_anchors, key_numbers

    names = (*NUMBERS, *(name for name in OF_MILLS if getattr(job.files, name)))
    found = {name: read_named(getattr(job.files, name), "part") for name in names}
    computed, anchors = key_numbers(found, job.told.runs), pd.read_csv(job.files.anchors)
    anchors = anchors[anchors["study"] == job.told.study]
    return {"key_numbers": computed, "anchors": beside_anchors(anchors, computed)}
