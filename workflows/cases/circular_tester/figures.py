"""Tables and figures of a circular wear tester from its runs: what the scripts of its rules call.

Every function takes the paths that it writes by name; a figure <name> is a picture with its table beside it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from postproc.mesh import read_surface
from postproc.plots.style import save
from postproc.scans.comparison import bump_names
from postproc.tables.published import published_value
from workflows.cases.circular_tester import comparison as tester_comparison
from workflows.cases.circular_tester import distribution as tester_distribution
from workflows.cases.circular_tester import findings as tester_findings
from workflows.cases.circular_tester import flow as tester_flow
from workflows.cases.circular_tester import volume as tester_volume
from workflows.cases.circular_tester.plots import comparison as comparison_plots
from workflows.cases.circular_tester.plots import flow as tester
from workflows.cases.circular_tester.plots import volume as volume_plots
from workflows.cases.circular_tester.runs import (
    MESH,
    RING,
    SIZE,
    SURFACE,
    VOLUME,
    WORN_OUT,
    WORN_SURFACE,
    TesterRun,
    cycle_surfaces,
    layer_particles,
    mean_force_by_column,
    outlines,
    series,
    surfaces_alike,
    top_of,
    volumes,
    whole_revolutions,
)

SHOWN_BUMPS = ["C11", "C13", "C15"]  # of Fig 6.5 and 6.16
MESH_BUMP = ["C15"]  # of Fig 6.9
FLOW_REVOLUTION = 5.0  # of Fig 6.19 and 6.20
TOLD_HOURS = (tester_volume.SHORT, tester_volume.LONG)
MOTION = {  # figure -> column of relative_motion, its colour bar
    "tester_spin_map": ("relative_angular_speed", "Angular speed over the plain sample's mean (-)"),
    "tester_velocity_map": ("relative_speed", "Speed over the plain sample's mean (-)"),
}
BY_REVOLUTION = {
    "tester_spin": "bottom_angular_speed_rad_per_s",
    "tester_velocity": "bottom_velocity_m_per_s",
    "tester_force": "normal_force_N",
}


def tester_run(values: Mapping[str, Any], results: Path) -> TesterRun:
    """Return a run from JSON-able values, see `pages.circular_tester.run_values`, below the folder of its study."""
    names = {field.name for field in fields(TesterRun)} - {"folder", "bed_folder", "rotation"}
    return TesterRun(
        **{name: values[name] for name in names},
        folder=results / values["name"],
        bed_folder=results / "beds" / values["bed"],
        rotation=np.array(values["rotation"]),
    )


def tester_runs(study: Sequence[Mapping[str, Any]], results: Path) -> list[TesterRun]:
    """Return all runs of a study."""
    return [tester_run(values, results) for values in study]


def flow_means(flow: pd.DataFrame) -> pd.DataFrame:
    """Return spin and velocity of the lowest layer and normal force per revolution of wear."""
    worn = flow[flow["worn_revolution"] > 0.0]
    return tester_flow.revolution_means(worn.assign(revolution=worn["worn_revolution"]), list(BY_REVOLUTION.values()))


def main_runs(runs: Sequence[TesterRun]) -> list[TesterRun]:
    """Return the convex and the plain run of which most figures are made."""
    return sorted(of_series(runs, VOLUME), key=lambda run: run.surface)


def volumes_of_meshes(lost: pd.DataFrame) -> pd.DataFrame | None:
    """Return volumes after equal revolutions of runs that differ in their elements, finest first; None without any."""
    of_meshes = chosen(lost, MESH)
    if of_meshes.empty:
        return None
    same = of_meshes.groupby("run")["revolution"].max().min()
    at = chosen(lost, MESH, VOLUME, SIZE)
    at = at[np.isclose(at["revolution"], same) & at["particle_scale"].isin(of_meshes["particle_scale"])]
    return at.sort_values("element_size_mm")


def patterns_left(lost: pd.DataFrame, fits: pd.DataFrame, coefficient: float) -> pd.DataFrame | None:
    """Return what is left of patterns that are worn right off, and of others in equal beds, against revolutions at
    `coefficient` (1/Pa), as from `tester_comparison.pattern_left`; None without a run for that.
    """
    scales = chosen(lost, WORN_OUT)["particle_scale"].unique()
    beside = fits[fits["particle_scale"].isin(scales) & (fits["surface"] == "plain")]["run"]
    if beside.empty:
        return None
    shown = chosen(lost, VOLUME, SIZE, WORN_OUT)
    rate = float(tester_volume.chosen_fit(fits, beside.iloc[0])[0])
    return tester_comparison.pattern_left(shown[shown["particle_scale"].isin(scales)], coefficient, rate)


def published_tables(paths: Mapping[str, str]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return published values and fits."""
    return pd.read_csv(paths["published"]), pd.read_csv(paths["published_fits"])


def of_series(runs: Sequence[TesterRun], *names: str) -> list[TesterRun]:
    """Return the runs of some series."""
    return [run for run in runs if run.series in names]


def chosen(table: pd.DataFrame, *names: str) -> pd.DataFrame:
    """Return the rows of some series."""
    return table[table["series"].isin(names)]


def main_plain(runs: Sequence[TesterRun]) -> TesterRun:
    """Return the plain run that sets the scale of time."""
    return next(run for run in of_series(runs, VOLUME) if run.surface == "plain")


# ---------------------------------------------------------------- tables


def write_tables(runs: Sequence[TesterRun], folder: Path, paths: Mapping[str, str]) -> None:
    """Write volumes, fits, time scale, predictions, comparison, ratios, series, findings of a study as <name>.csv."""
    published, published_fits = published_tables(paths)
    lost, plain = volumes(runs), main_plain(runs)
    fits = tester_volume.volume_fits(whole_revolutions(chosen(lost, VOLUME, SIZE)))
    terms = tester_volume.fit_up_to(fits, plain.name, published_value(published, "plain_volume_56_h", "laboratory"))
    scale = tester_volume.time_scale(
        terms, plain.coefficient, published, plain.distance_per_revolution, plain.width * plain.length
    )
    hours = [published_value(published, name, "laboratory") for name in TOLD_HOURS]
    predicted = tester_volume.predictions(fits, scale, hours)
    main = predicted[predicted["run"].isin([run.name for run in of_series(runs, VOLUME)])]
    compared = [
        tester_volume.comparison_table(main, published, published_fits, plain.particle_scale),
        measured_losses(main_runs(runs)[0], published, scale.revolutions(hours[-1])),
    ]
    ratios = tester_comparison.ratios_by_revolution(whole_revolutions(chosen(lost, VOLUME, SIZE, RING)))
    tables = {
        "lost_volumes": lost,
        "fits": fits,
        "time_scale": pd.DataFrame([vars(scale)]),
        "predictions": predicted,
        "comparison": pd.concat([table for table in compared if len(table)], ignore_index=True),
        "crossings": crossings(fits),
        "ratios": ratios,
        "mean_ratios": tester_comparison.mean_ratios(ratios, shared=False),
        "series": pd.concat([series(run) for run in of_series(runs, VOLUME)], ignore_index=True),
    }
    tables["findings"] = tester_findings.findings_table(
        evidence(runs, tables, hours), pd.read_csv(paths["published_findings"])
    )
    for name, table in tables.items():
        table.to_csv(folder / f"{name}.csv", index=False, float_format="%.9g")


def measured_losses(convex: TesterRun, published: pd.DataFrame, wanted: float) -> pd.DataFrame:
    """Return rows of the comparison: the largest loss of the bumps that were scanned, after `wanted` revolutions."""
    (revolution, worn), *_ = cycle_surfaces(convex, [wanted]).items()
    pristine = top_of(read_surface(convex.folder / SURFACE))
    losses = tester_distribution.contour_losses(pristine, worn, SHOWN_BUMPS)
    return tester_volume.loss_rows(losses, published, float(revolution), wanted)


def evidence(
    runs: Sequence[TesterRun], tables: Mapping[str, pd.DataFrame], hours: Sequence[float]
) -> tester_findings.Evidence:
    """Return what findings are judged by; tables: those of `write_tables`; hours: of the short and the long test."""
    main, meshes = main_runs(runs), volumes_of_meshes(tables["lost_volumes"])
    left = patterns_left(tables["lost_volumes"], tables["fits"], main_plain(runs).coefficient)
    _, worn = surfaces_alike(main)
    columns = tester_distribution.wear_by_column({run.surface: worn[run.name] for run in main})
    return tester_findings.Evidence(
        **{name: tables[name] for name in ("fits", "predictions", "crossings", "ratios")},
        columns=columns.assign(surface=columns["run"]),
        bumps=tester_distribution.wear_by_bump(read_surface(main[0].folder / WORN_SURFACE)),
        means=flow_means(tables["series"]),
        steady=tester_flow.steady_revolutions(tables["series"]),
        meshes=None if meshes is None else tester_distribution.mesh_size_effect(meshes),
        worn_out=None if left is None else tester_comparison.worn_out_at(left),
        main=main_plain(runs).particle_scale,
        short=hours[0],
        long=hours[-1],
    )


def crossings(fits: pd.DataFrame) -> pd.DataFrame:
    """Return when convex overtakes plain of equal particles: particle_scale, rate_crossing, crossing (revolutions)."""
    rows = []
    for scale, of_scale in fits.groupby("particle_scale"):
        names = of_scale.drop_duplicates("run").set_index("surface")["run"]
        if {"plain", "convex"} <= set(names.index):
            terms = [tester_volume.chosen_fit(fits, names[surface]) for surface in ("plain", "convex")]
            found = {"rate_crossing": tester_volume.rate_crossing(*terms), "crossing": tester_volume.crossing(*terms)}
            rows.append({"particle_scale": scale} | found)
    return pd.DataFrame(rows, columns=["particle_scale", "rate_crossing", "crossing"])


# ---------------------------------------------------------------- figures


@dataclass(frozen=True)
class Drawing:
    """What a job of figures has: runs, folders of tables and of figures, published tables by name, remarks."""

    runs: Sequence[TesterRun]
    tables: Path
    folder: Path
    paths: Mapping[str, str]
    remarks: Sequence[str]

    def table(self, name: str) -> pd.DataFrame:
        """Return a table of the study."""
        return pd.read_csv(self.tables / f"{name}.csv")

    def write(self, name: str, figure: Any, table: pd.DataFrame) -> None:
        """Write a figure and its table."""
        save(figure, self.folder / f"{name}.png")
        table.to_csv(self.folder / f"{name}.csv", index=False, float_format="%.9g")


def draw_volumes(job: Drawing) -> None:
    """Draw what the tables of volumes tell: Fig 6.4, 6.10, 6.11, 6.12."""
    published, published_fits = published_tables(job.paths)
    fits, predicted, compared = (job.table(name) for name in ("fits", "predictions", "comparison"))
    compared["note"] = compared["note"].fillna("")
    lost = whole_revolutions(chosen(job.table("lost_volumes"), VOLUME, SIZE))
    main = fits[fits["run"].isin([run.name for run in of_series(job.runs, VOLUME)])]
    hours = job.table("time_scale")["hours_per_revolution"].iloc[0]
    figure = volume_plots.volume_by_hours(main, hours, compared, published, job.remarks)
    job.write("tester_hours", figure, compared)
    figure = volume_plots.volume_by_revolution(lost, fits, published_fits, job.remarks)
    job.write("tester_volume", figure, lost)
    job.write("tester_benchmark", volume_plots.benchmark(predicted, published, published_fits, job.remarks), predicted)
    grown = tester_volume.element_increments(lost)
    figure = volume_plots.element_increments(grown, job.table("crossings"), published, job.remarks)
    job.write("tester_increments", figure, grown)


def draw_flow(job: Drawing) -> None:
    """Draw steadiness and what the lowest layer does: Fig 6.7 and 6.17 to 6.21."""
    published, _ = published_tables(job.paths)
    flow = job.table("series")
    means = tester_flow.revolution_means(flow, tester_flow.STEADINESS)
    steady = tester_flow.steady_revolutions(flow)
    job.write("tester_steadiness", tester.steadiness(means, steady, published, job.remarks), means)
    means = flow_means(flow)
    for name, measure in BY_REVOLUTION.items():
        figure = tester.by_revolution(means, measure, published, job.remarks)
        job.write(name, figure, means[means["measure"] == measure])
    main = of_series(job.runs, VOLUME)
    parts = [layer_particles(run, FLOW_REVOLUTION) for run in main]
    particles = tester_flow.relative_motion(pd.concat(parts, ignore_index=True))
    lines = {run.surface: outlines(top_of(read_surface(run.folder / SURFACE))) for run in main}
    for name, (quantity, label) in MOTION.items():
        figure = tester.relative_motion(particles, quantity, label, lines, job.remarks)
        job.write(name, figure, particles)


def draw_distribution(job: Drawing) -> None:
    """Draw where the samples wear and are loaded: Fig 6.13, 6.14, 6.16, 6.22."""
    published, _ = published_tables(job.paths)
    main = main_runs(job.runs)
    shared, worn = surfaces_alike(main)
    table = tester_distribution.wear_by_column(worn)
    remarks = [f"after {shared:g} revolutions", *job.remarks]
    figure = tester.by_column(table, "mm3", "Worn volume (mm³)", published, remarks)
    job.write("tester_columns", figure, table)
    forces = pd.concat([mean_force_by_column(run) for run in main], ignore_index=True)
    figure = tester.by_column(forces, "N", "Normal force (N)", published, job.remarks)
    job.write("tester_force_columns", figure, forces)
    convex = main[0]
    bumps = tester_distribution.wear_by_bump(read_surface(convex.folder / WORN_SURFACE))
    last = job.table("lost_volumes").groupby("run")["revolution"].max()[convex.name]
    theirs = published_value(published, "last_revolution", "simulation")
    said = f"ours after {last:.3g} revolutions, Yan 2022 after {theirs:g}"
    job.write("tester_bumps", tester.by_bump(bumps, published, said, job.remarks), bumps)
    pristine = top_of(read_surface(convex.folder / SURFACE))
    contours = tester_distribution.worn_contours(pristine, cycle_surfaces(convex), SHOWN_BUMPS)
    job.write("tester_contours", tester.worn_contours(contours, "revolution", job.remarks), contours)


def draw_meshes(job: Drawing) -> None:
    """Draw what the size of the elements changes: Fig 6.8 and 6.9."""
    published, _ = published_tables(job.paths)
    at = volumes_of_meshes(job.table("lost_volumes"))
    same = at["revolution"].iloc[0]
    effect = tester_distribution.mesh_size_effect(at)
    remarks = [f"after {same:g} revolutions", *job.remarks]
    job.write("tester_mesh", tester.mesh_size(effect, published, remarks), effect)
    convex = [run for run in job.runs if run.surface == "convex" and run.name in set(at["run"])]
    convex.sort(key=lambda run: run.element_size_mm)
    worn = {f"{run.element_size_mm:g} mm": next(iter(cycle_surfaces(run, [same]).values())) for run in convex}
    pristine = top_of(read_surface(convex[0].folder / SURFACE))
    there = bump_names(pristine)["bump"].tolist()  # a sample smaller than the source's has fewer
    shown = [name for name in MESH_BUMP if name in there] or there[:1]
    contours = tester_distribution.worn_contours(pristine, worn, shown)
    job.write("tester_mesh_contours", tester.worn_contours(contours, "elements", remarks), contours)


def draw_ring(job: Drawing) -> None:
    """Draw what the straight channel changes against the whole ring."""
    lost = chosen(job.table("lost_volumes"), VOLUME, SIZE, RING)
    scales = lost[lost["series"] == RING]["particle_scale"].unique()
    lost, ratios = (table[table["particle_scale"].isin(scales)] for table in (lost, job.table("ratios")))
    means = tester_comparison.mean_ratios(ratios, shared=True)
    figure = comparison_plots.channel_and_ring(whole_revolutions(lost), means, ratios, job.remarks)
    job.write("tester_ring", figure, means)


def draw_worn_out(job: Drawing) -> None:
    """Draw a pattern that is worn right off, beside the one of the study's coefficient."""
    left = patterns_left(job.table("lost_volumes"), job.table("fits"), main_plain(job.runs).coefficient)
    ends = tester_comparison.worn_out_at(left)
    patches = "; ".join(f"{run.name}: {run.patch}" for run in job.runs if run.name in set(left["run"]))
    remarks = [*job.remarks, f"a contact wears over: {patches}"]
    job.write("tester_worn_out", comparison_plots.worn_out(left, ends, remarks), left)


JOBS = {  # name of a rule -> what draws its figures
    "tester_volumes": draw_volumes,
    "tester_flow": draw_flow,
    "tester_distribution": draw_distribution,
    "tester_meshes": draw_meshes,
    "tester_machines": draw_ring,
    "tester_worn_out_pattern": draw_worn_out,
}
