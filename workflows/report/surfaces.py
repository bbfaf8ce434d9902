"""Figures and tables of worn surfaces, which any case may show (`Case.shared_figures`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bulkwear.workflows.report import figure_findings
from bulkwear.workflows.report.page_parameters import is_deformed, part_names
from bulkwear.workflows.report.products import Job, every_run, figure

DESIGN, SUMMARY = "results/{study}/design.csv", "results/{study}/summary.csv"
SURFACES, WEAR = every_run("worn_surface.vtu"), every_run("wear.csv")


@figure(
    "Wear",
    "Worn surfaces",
    finding=figure_findings.deepest_run,
    inputs={"design": DESIGN, "surfaces": SURFACES},
    told={"deformed": is_deformed},
    digits=6,
    caption="""
    Wear depth on the sample, obliquely and from above; studies of several design rows show views from above without
    skirt. Depth is the thickness removed along the path of the surface, and what caps on a step hold back of the
    wear; for a rigid study it is the worn volume of a triangle over its area, which was not applied to the shape.
    All runs share one colour scale, which ends at the depth that 99 % of the area of the most worn sample does not
    exceed; deeper spots take the top colour, as do samples that are worn many times as deep as most. Grey: the
    skirt, whose wear is not counted. The bed moves towards +y, up.
    """,
)
def worn_surface(job: Job) -> Any:
    """Draw the worn surfaces of a study."""
    from bulkwear.postproc.plots import pictures
    from bulkwear.postproc.tables.depths import carried_remark, depth_quantity, depth_table, read_worn_surfaces
    from bulkwear.postproc.tables.history import runs_of
    from bulkwear.postproc.tables.packings import first_packings, shown_remark

    runs, deformed = runs_of(job.files.design), job.told.deformed
    meshes = read_worn_surfaces(runs["run"], job.files.surfaces)
    depths = depth_table(meshes, deformed)
    remarks = [*job.remarks, carried_remark(meshes, deformed), *shown_remark(runs)]
    shown, quantity = first_packings(runs), depth_quantity(deformed)
    drawn = pictures.worn_surface(meshes, shown, deformed, depths, quantity, remarks)
    return drawn, depths.merge(runs[["run", "setting", "packing"]], on="run")


@figure(
    "Wear",
    "Worn surfaces, compared",
    finding=figure_findings.deepest_run,
    # the surfaces of the cycles, whose number may follow from the wear, lie beside these
    inputs={"design": DESIGN, "wear": WEAR, "surfaces": SURFACES, "pristine": every_run("surface.vtu")},
    told={"deformed": is_deformed, "parts": part_names},
    suffix="html",
    still=True,
    digits=6,
    caption="""
    One to four runs beside one another, each at a cycle of choice: drag to turn all of them, scroll to zoom, point at a
    place for its value. What is shown is chosen: depth, what is removed and what caps hold back, remaining thickness,
    and loads, as means over the time until then. One scale holds for all views; it ends at the value that 99 % of the
    area of the surface with the largest ones does not exceed. Differences from the first view are taken between nodes
    nearest to one another, on one scale as well. A section cuts all views at one place, with the unworn shape dotted
    and what is shown along it below. What does not wear is left out. Of many cycles some are shown; of many runs the
    cycles before the last have their depth alone. Of several packings the first is shown.
    """,
)
def worn_surface_3d(job: Job) -> Any:
    """Draw the surfaces of all runs and of some of their cycles on a page of their own."""
    import pandas as pd

    from bulkwear.postproc.plots.page import surfaces_page
    from bulkwear.postproc.plots.pictures import surface_views
    from bulkwear.postproc.plots.style import save
    from bulkwear.postproc.tables.compared_surfaces import shown_surfaces
    from bulkwear.postproc.tables.depths import carried_remark, depth_quantity, depth_table, read_worn_surfaces
    from bulkwear.postproc.tables.packings import first_packings, shown_remark
    from bulkwear.postproc.tables.summary import NAMES

    design, deformed = pd.read_csv(job.files.design, dtype=NAMES), job.told.deformed
    files = dict(zip(design["run"], job.files.surfaces, strict=True))
    first = list(first_packings(design)["run"])
    wear = {Path(path).parent.name: pd.read_csv(path) for path in job.files.wear}
    shown = shown_surfaces({run: Path(files[run]).parent for run in first}, wear)
    meshes = read_worn_surfaces(first, [files[run] for run in first])
    left_out = len(first) - len({each.run for each in shown})
    remarks = [*job.remarks, *shown_remark(design)]
    remarks += [f"{left_out} runs are left out, so that the page stays small"] if left_out else []
    if not all(each.whole for each in shown):
        remarks.append("cycles before the last have their depth alone, so that the page stays small")
    depths = depth_table(meshes, deformed)

    def write(path: str) -> None:
        if Path(path).suffix == ".html":
            told = [*remarks, carried_remark(meshes, deformed, hatched=False)]
            surfaces_page(path, shown, deformed, job.told.parts, told)
        else:
            last = {each.run: each.mesh for each in shown}
            told = [*remarks, carried_remark(meshes, deformed)]
            save(surface_views(last, deformed, depths, depth_quantity(deformed), told), path)

    return write, depths


@figure(
    "Wear",
    "What each wear update did",
    finding=figure_findings.largest_step,
    inputs={"design": DESIGN, "wear": WEAR},
    told={"angle_bound": lambda study: study.settings["remeshing"]["smallest_angle_deg"]},
    when=is_deformed,
    caption="""
    One point per wear cycle. Volumes: what the update took off the surface (full line) and what is carried on after
    it (dashed), both of what the wear law takes in the cycle; above 100 % is also what earlier cycles left. Steps:
    the largest step that the cycle's wear asked of a node, over the cap that the edges of the mesh set (full), and
    the largest step taken over the largest cap in force (dashed), which the closing gap between particles and
    sample can set far lower. Where a line reaches 1, wear is carried on. Smallest angle of the mesh after
    remeshing, with the bound below which faces are remeshed (dotted); the bars are the faces remeshed. Balance:
    pristine minus present volume, plus carried, against the wear law's volume of all cycles, over that volume; no
    point where it closes exactly. Studies of more than two design rows show the worst cycle of all packings of each
    row, and all remeshed faces.
    """,
)
def wear_updates(job: Job) -> Any:
    """Draw the updates along the travel, or the worst per run where there are many design rows."""
    from bulkwear.postproc.plots import curves, updates
    from bulkwear.postproc.tables.packings import first_packings, shown_remark
    from bulkwear.postproc.tables.updates import update_summary
    from bulkwear.postproc.tables.updates import wear_updates as table_of

    table, bound = table_of(job.files.design, job.files.wear), job.told.angle_bound
    if table["setting"].nunique() > curves.FEW_ROWS:
        worst = update_summary(table)
        return updates.worst_updates(worst, bound, job.remarks), worst
    return updates.wear_updates(first_packings(table), bound, [*job.remarks, *shown_remark(table)]), table


@figure(
    "Wear",
    "The sample wears, a film",
    finding=figure_findings.pattern_in_film,
    # the surfaces of the cycles, whose number may follow from the wear, lie beside these
    inputs={"summary": SUMMARY, "wear": WEAR, "surfaces": SURFACES, "pristine": every_run("surface.vtu")},
    when=is_deformed,
    suffix="gif",
    still=True,
    caption="""
    Film of the worn surface without skirt, one picture per wear cycle, evenly thinned to at most 60; it starts with
    the unworn surface and repeats. Colour: wear depth, on one scale for all pictures, which ends at the
    depth that 99 % of the sample's area does not exceed in the end. Wear is drawn as many times deeper than it is as
    the remark says, so that it is seen. Below: section along the travel through the shape of the pattern that loses
    most, with the unworn section dotted. What is left of the pattern is its volume over the mean height of its feet.
    In studies of several design rows the row with the lowest relative wear is shown.
    """,
)
def worn_film(job: Job) -> Any:
    """Film how a run of the row that is shown in detail wears, cycle by cycle."""
    import pandas as pd

    from bulkwear.postproc.plots.film import film_pictures, save_film, save_still
    from bulkwear.postproc.tables.depths import depth_quantity
    from bulkwear.postproc.tables.film import film_frames, film_run, film_surfaces, frame_table
    from bulkwear.postproc.tables.summary import read_summary

    summary = read_summary(job.files.summary)
    run = film_run(summary)
    wear_file = Path(dict(zip(summary["run"], job.files.wear, strict=True))[run])
    frames = film_frames(pd.read_csv(wear_file))
    surfaces = film_surfaces(wear_file.parent, frames)
    table = frame_table(frames, surfaces)
    pictures = film_pictures(run, surfaces, table, depth_quantity(True), job.remarks)

    def write(path: str) -> None:
        (save_film if Path(path).suffix == ".gif" else save_still)(pictures, path)

    return write, table.assign(run=run)
