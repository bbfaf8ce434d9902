"""Figures of where the parts of a machine wear, how long they last, and what is left of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.equipment import charts, figure_findings
from bulkwear.workflows.cases.equipment.figures import TABLES
from bulkwear.workflows.cases.equipment.tables import values_of_runs
from bulkwear.workflows.report.products import Job, every_run, figure

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.config.design import Study

DIGITS = 6
MOST_MAPS, MOST_STATES = 8, 3  # designs on a figure of maps; where each has several maps of a part
WORN = every_run("worn_surface.vtu")
SURFACES = {"surfaces": every_run("surface.vtu"), "worn": WORN, "wear": every_run("wear.csv")}
BESIDE = "wear.csv"  # of every run, with the folders of its cycles beside it


def runs_as_told(study: Study) -> list[dict[str, Any]]:
    """Return what figures are told of every run: as `tables.values_of_runs`, with patch_m, time_step_s and filling."""
    found = []
    for run, values in zip(study.runs, values_of_runs(study), strict=True):
        parameters = run.parameters
        own = {"patch_m": parameters["sampling"]["patch_m"], "time_step_s": parameters["derived"]["time_step_s"]}
        found.append(values | own | {"filling": parameters["filling"]})
    return found


def of_study(*names: str) -> dict[str, str]:
    """Return inputs: tables of a study by name."""
    return {name: f"results/{{study}}/{TABLES[name]}" for name in names}


def read(job: Job, *names: str) -> list[pd.DataFrame]:
    """Return tables by the names of a job's inputs; settings are words."""
    from bulkwear.postproc.tables.summary import read_named

    return [read_named(getattr(job.files, name), "part") for name in names]


def folder_of(job: Job) -> Path:
    """Return results/<study>; one of the inputs of the job is wear.csv of every run."""
    return Path(job.files.wear[0]).parents[1]


def deforms(study: Study) -> bool:
    """Return whether wear is applied to the shape in a run of a study; the updates may be a column of its design."""
    return any(run.parameters["updates"]["most"] > 0 for run in study.runs)


def tells_what_is_left(study: Study) -> bool:
    """Return whether something is left of parts at other hours than 0."""
    return deforms(study) or any(run.parameters["operation"].get("told_at_s") for run in study.runs)


TOLD = {"runs": runs_as_told}
PACKINGS = "means over blocks and packings, told by area patches"


# ---------------------------------------------------------------- life


@figure(
    "Life",
    "Life of the parts",
    finding=figure_findings.shortest_life,
    charts=(charts.LIFE,),
    inputs=of_study("life"),
    told={"runs": values_of_runs},
    digits=DIGITS,
    caption="""
    Hours of operation until a part has to be changed, by the rule at its name, at the place that decides. Bars of
    error: 95 % interval from the scatter of packings, of one packing that of its blocks, and from the wear coefficient
    as given; without one the scatter is unknown. An upper axis is in megatonnes of feed, where all designs have one
    feed.
    """,
)
def life_bars(job: Job) -> Any:
    """Draw the life of every part and design."""
    from bulkwear.workflows.cases.equipment.pictures import hours_per_mt
    from bulkwear.workflows.cases.equipment.plots.curves import life_bars as draw

    (lives,) = read(job, "life")
    factors = {setting: hours for setting, hours in hours_per_mt(job.told.runs).items() if hours == hours}
    return draw(lives, factors, job.remarks), lives


@figure(
    "Life",
    "Depth of the deciding place against hours of operation",
    finding=figure_findings.depth_reached,
    charts=(charts.RECESSION,),
    inputs={**of_study("life", "worst_places"), "wear": every_run(BESIDE)},
    told={"runs": values_of_runs},
    digits=DIGITS,
    caption="""
    Thickness removed at the area patch that decides when a part is changed. Points: updates of the shape. From the
    last one on the mean rate of the last shape goes on (dashed) until the depth at which the part is changed
    (dotted; named in the title where it is far off), if that comes soon enough to be shown. The mark is the part's
    life. It may lie beside the line: in it each packing, or block of a single one, counts by the place that the
    others name, so that no place decides because of its scatter.
    """,
)
def recession_against_time(job: Job) -> Any:
    """Draw the depth of deciding places against hours of operation."""
    from bulkwear.workflows.cases.equipment.histories import deciding_depths
    from bulkwear.workflows.cases.equipment.plots.curves import recession_against_time as draw
    from bulkwear.workflows.cases.equipment.tables import read_runs

    lives, worst = read(job, "life", "worst_places")
    depths = deciding_depths(read_runs(job.told.runs, folder_of(job)), lives, worst)
    return draw(depths, lives, job.remarks), depths


# ---------------------------------------------------------------- maps


@figure(
    "Wear",
    "Where it wears",
    finding=figure_findings.fastest_place,
    inputs={**of_study("rates", "worst_places"), **SURFACES},
    told=TOLD,
    digits=DIGITS,
    caption="""
    Recession of the shape as built, each part alone and seen square to its worn side, or from where most of its wear is
    seen; two sides where one hides much of it. A part that closes round its axis is shown unrolled. All designs and
    parts share one scale, which ends at the value that 99 % of the area of the most worn part does not exceed; it is of
    decades where a part wears less than a tenth as fast as another. Values are means over blocks and packings of area
    patches; colours run from face to face. Numbers: the worst places of each part, as in the table. Lengths are true to
    scale, bars tell them.
    """,
)
def wear_map(job: Job) -> Any:
    """Draw the recession as built on all parts that wear."""
    from bulkwear.workflows.cases.equipment.pictures import (
        designs_remark,
        mm_per_mt,
        patch_rows,
        recession_maps,
        rigid_parts,
        shown_runs,
    )
    from bulkwear.workflows.cases.equipment.plots.maps import wear_map as draw

    (rates, worst), folder = read(job, "rates", "worst_places"), folder_of(job)
    runs = shown_runs(job.told.runs, MOST_MAPS)
    maps = recession_maps(runs, folder, rates, worst)
    table = patch_rows(rates, "pristine_mm_per_1000h", "pristine_mm_per_Mt", "packings")
    remarks = [*job.remarks, PACKINGS, *designs_remark(job.told.runs, MOST_MAPS)]
    return draw(maps, rigid_parts(runs, folder), mm_per_mt(runs), remarks), table


@figure(
    "Wear",
    "Remaining thickness",
    finding=figure_findings.thinnest_place,
    inputs=SURFACES,
    told=TOLD,
    when=tells_what_is_left,
    digits=DIGITS,
    caption="""
    Thickness left as built, after the last simulated hour, and at the hours that the study wants told, of the first
    packing of each design. Between updates, and from the last one on, each face loses as much as its area patch,
    after the last one at the mean rate of the last shape. What caps on the updates hold back counts as lost, evenly
    over each area patch. Red: as thin as the part is changed at, or thinner. Grey:
    no back lies behind, so no thickness is known. The scale ends at the thickness as built below which three
    quarters of the wear is; thicker places take the top colour. Views as in the map of wear.
    """,
)
def remaining_thickness(job: Job) -> Any:
    """Draw what is left of the parts that wear."""
    from bulkwear.workflows.cases.equipment.pictures import (
        change_out_mm,
        designs_remark,
        packings_remark,
        shown_runs,
    )
    from bulkwear.workflows.cases.equipment.plots.maps import remaining_thickness as draw
    from bulkwear.workflows.cases.equipment.remaining import most_designs, remaining_maps, remaining_rows

    every, folder = job.told.runs, folder_of(job)
    most = most_designs(every, MOST_MAPS)
    runs = shown_runs(every, most)
    remarks = [*job.remarks, *packings_remark(every), *designs_remark(every, most)]
    return draw(remaining_maps(runs, folder), change_out_mm(runs), remarks), remaining_rows(every, folder)


@figure(
    "Loads",
    "Impact and sliding",
    finding=figure_findings.impact_share,
    inputs={**of_study("rates"), **SURFACES},
    told=TOLD,
    digits=DIGITS,
    caption="""
    What wears the parts as built, each on a scale that all designs share and that ends at the value which 99 % of the
    area of the most loaded part does not exceed: pressure, the mean normal force over area and time; sliding velocity,
    weighted by the normal force; sliding power, normal force times sliding velocity over area; impact power, the energy
    of the motion against the face at first touches over area and time. Views as in the map of wear.
    """,
)
def impact_and_sliding(job: Job) -> Any:
    """Draw pressure, sliding and impacts on all parts that wear."""
    from bulkwear.workflows.cases.equipment.pictures import designs_remark, load_maps, patch_rows, shown_runs
    from bulkwear.workflows.cases.equipment.plots.maps import impact_and_sliding as draw
    from bulkwear.workflows.cases.equipment.tables import AT_A_PATCH

    (rates,), every = read(job, "rates"), job.told.runs
    maps = load_maps(shown_runs(every, MOST_STATES), folder_of(job), rates)
    remarks = [*job.remarks, PACKINGS, *designs_remark(every, MOST_STATES)]
    return draw(maps, remarks), patch_rows(rates, *AT_A_PATCH)


@figure(
    "Wear",
    "Sections through the worst places",
    finding=figure_findings.deepest_section,
    inputs={**of_study("worst_places"), **SURFACES},
    told=TOLD,
    when=deforms,
    digits=DIGITS,
    caption="""
    Outlines as built and after hours of operation in planes through the worst place of each part, which is the origin:
    square to the long direction of the part and along the normal of the worn face; of a part that turns, square to its
    axis, which is above, and the part moves to the left. True to scale. Below, of parts that do not turn: the thickness
    removed along the whole section. First packing of each design.
    """,
)
def profile_sections(job: Job) -> Any:
    """Draw sections through the worst place of every part."""
    from bulkwear.workflows.cases.equipment.pictures import packings_remark
    from bulkwear.workflows.cases.equipment.plots.sections import MOST_SECTIONS
    from bulkwear.workflows.cases.equipment.plots.sections import profile_sections as draw
    from bulkwear.workflows.cases.equipment.sections import worst_sections

    lines, sections = worst_sections(job.told.runs, folder_of(job), *read(job, "worst_places"))
    remarks = [*job.remarks, *packings_remark(job.told.runs)]
    if len(sections) > MOST_SECTIONS:
        remarks.append(f"{MOST_SECTIONS} of {len(sections)} sections are shown, all are in the table")
    return draw(lines, sections, remarks), lines
