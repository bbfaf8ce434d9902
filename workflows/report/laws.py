"""Figures and tables of wear laws side by side, from the ledgers of the same runs, which any case may show."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.postproc.plots.chart import BARS, Axis, Chart, Layer, Panel
from bulkwear.postproc.wear.laws import LAWS, NEUTRAL_LAW
from bulkwear.workflows.engine.derived import laws_beside
from bulkwear.workflows.report import figure_findings
from bulkwear.workflows.report.products import Job, every_run, figure, tables

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.config.design import Study

DESIGN, VOLUMES = "results/{study}/design.csv", "results/{study}/volume_by_law.csv"
WEAR = every_run("wear.csv")
ALONG_TRAVEL = (0.0, 1.0, 0.0)  # in which bulk material passes a sample
SETTINGS = Axis("Setting")
OVER_ARCHARD, OVERLAP = Axis("Volume over Archard's, same coefficient", "-"), Axis("Wear where Archard's lies", "-")
OVER_FIRST = Axis("Volume over that of the first setting, same law", "-")
FRONT = Axis("Share on the fronts of bumps", "-")
WITHOUT_PARTS, WITH_PARTS = ("setting", "surface"), ("setting", "part")


def _chart(places: tuple[str, ...], measures: dict[str, Axis]) -> Chart:
    panels = tuple(
        Panel(SETTINGS, axis, (Layer(BARS, name, places, f"{name}_low", f"{name}_high", group=("law",)),))
        for name, axis in measures.items()
    )
    return Chart(panels)


BOTH = {"over_archard": OVER_ARCHARD, "over_first": OVER_FIRST, "overlap": OVERLAP}
CHARTS = (
    _chart(WITH_PARTS, BOTH),
    _chart(WITHOUT_PARTS, BOTH | {"front_share": FRONT}),
    _chart(WITHOUT_PARTS, BOTH),
)


def what_wears(study: Study) -> dict[str, list[tuple[Any, ...]]]:
    """Return {run: (wear law, its parameters, name and label of the faces, {law: parameters} of all parts and of laws
    beside them, sums of contact kernels in the ledgers) of each part that wears}; one without a name or a label where
    all faces are one. Of a law with several sets of parameters others have that of wear.beside, or the first part's.
    """
    found = {}
    for run in study.runs:
        parts = [("", None)]
        if study.case.by_part:
            numbered = enumerate(run.parameters["parts"])
            parts = [(part["name"], number) for number, part in numbered if part["wears"]]
        laws = study.case.laws(run.parameters)
        every: dict[str, dict[str, float]] = {}
        for name, given in (*laws_beside(run.parameters), *laws):
            every.setdefault(name, given)
        sums = study.case.kernels(run.parameters)
        found[run.name] = [(*law, *part, every, sums) for law, part in zip(laws, parts, strict=True)]
    return found


def flow_of(study: Study) -> tuple[float, ...] | None:
    """Return the direction in which material passes what wears, None where parts have each their own."""
    return None if study.case.by_part else ALONG_TRAVEL


def _worn_by(job: Job, run: str) -> list[Any]:
    from bulkwear.postproc.tables.law_volumes import WornBy

    return [WornBy(*each) for each in job.told.laws[run]]


@tables(
    inputs={"design": DESIGN, "wear": WEAR},
    told={"laws": what_wears, "flow": flow_of},
    tables={"volume_by_law": "volume_by_law.csv"},
    digits=6,
)
def volume_by_law(job: Job) -> dict[str, pd.DataFrame]:
    """Tell each run's worn volume by all laws that its ledgers suffice for, with the coefficient of the study's own."""
    from bulkwear.postproc.tables.law_volumes import law_volumes

    folders = [Path(path).parent for path in job.files.wear]
    laws = {run: _worn_by(job, run) for run in job.told.laws}
    return {"volume_by_law": law_volumes(job.files.design, folders, laws, job.told.flow)}


@figure(
    "Wear",
    "Wear by several laws",
    finding=figure_findings.laws_apart,
    charts=CHARTS,
    inputs={"volumes": VOLUMES},
    digits=6,
    caption="""
    Wear of the same ledgers by several laws, nothing simulated again. Volume over Archard's: by the same
    coefficient, shown of laws whose coefficient is a volume over a work of sliding as Archard's is; where all
    contacts slide, shear work over Archard's is the coefficient of friction. Volume over that of the first setting
    by the same law, of machines per block, as if packings shared nothing, needs no coefficient: where it differs,
    laws disagree on which design wears less. Where wear lies needs no coefficient: the share of a law's wear that
    lies where Archard's does, triangle by triangle and cycle by cycle, is 1 where maps are alike and 0 where they
    are apart; on samples with bumps, the share of the wear that is on faces of bumps which look against the flow.
    Of machines the cycles count in which wear does.
    """,
)
def wear_by_law(job: Job) -> Any:
    """Draw volumes and distributions of all laws, per setting."""
    import pandas as pd

    from bulkwear.postproc.plots.laws import law_bars
    from bulkwear.postproc.tables.law_volumes import laws_of_settings
    from bulkwear.postproc.tables.packings import packings_remark
    from bulkwear.postproc.tables.summary import NAMES

    volumes = pd.read_csv(job.files.volumes, dtype=NAMES)
    table = laws_of_settings(volumes)
    remarks = [*job.remarks, packings_remark(table["packings"]), *coefficients_remark(list(table["law"].unique()))]
    return law_bars(table, remarks), table


def coefficients_remark(laws: list[str]) -> list[str]:
    """Return of which laws volumes cannot be set beside Archard's, nothing where they can of all."""
    apart = [law for law in laws if not LAWS[law].comparable]
    if not apart:
        return []
    names = ", ".join(law.replace("_", " ") for law in apart)
    return [f"the coefficient of {names} is another quantity than {NEUTRAL_LAW.capitalize()}'s: compare places alone"]


@figure(
    "Wear",
    "Where it wears by several laws",
    finding=figure_findings.steepest_map,
    inputs={"design": DESIGN, "wear": WEAR},
    told={"laws": what_wears},
    digits=6,
    caption="""
    Depth over the mean depth of all that wears, by each law that the ledgers serve, on one scale, so that coefficients
    do not matter: 1 is wear that is even everywhere. The scale ends at the value that 99 % of the area of the most
    uneven map does not exceed, of the area that wears where that is less than a hundredth. The first run is shown, the
    most cycles in a row on the same triangles whose ledgers are kept.
    """,
)
def maps_by_law(job: Job) -> Any:
    """Draw the map of every law of the first run."""
    from bulkwear.postproc.plots.laws import law_pictures
    from bulkwear.postproc.tables.history import runs_of
    from bulkwear.postproc.tables.law_volumes import law_maps, map_table

    run = runs_of(job.files.design)["run"].iloc[0]
    maps = law_maps(Path(job.files.wear[0]).parent, _worn_by(job, run))
    cycles = f", wear cycles on the same triangles: {maps[0].cycles}" if maps else ""
    return law_pictures(maps, [*job.remarks, f"run {run}{cycles}"]), map_table(run, maps)
