"""Draw the angular speed of the lowest layer along the samples round a circle, a curve per particle scale."""

from pathlib import Path

from postproc.plots.style import save
from postproc.tables.display import MILLIMETRES, in_display_units
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.flow_history import RunFlow, spin_profiles
from workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import spider_charts
from workflows.engine.job import job_log

LABELS = ("angular speed of the lowest layer (°/s)", "distance behind the front edge (mm)")

with job_log(snakemake.log[0]):
    summary = read_summary(snakemake.input.summary)[["run", "row", "surface", "particle_scale"]]
    starts = read_summary(snakemake.input.profiles).groupby("run")["window_start_mm"].first() / MILLIMETRES
    runs = {run: RunFlow(**values) for run, values in snakemake.params.runs.items()}
    folders = dict(zip(summary["run"], [Path(path).parent for path in snakemake.input.wear], strict=True))
    table = in_display_units(summary.merge(spin_profiles(folders, runs, starts.to_dict()), on="run"))
    figure = spider_charts(table, "angular_speed_deg_per_s", "along_mm", LABELS, snakemake.params.remarks)
    save(figure, snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
