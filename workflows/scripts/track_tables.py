"""Take the radial contours of a worn disc after each revolution, and collect its volumes."""

from pathlib import Path

from postproc.analysis.pin_runs import pin_runs
from postproc.analysis.pin_volume import volumes_of_run
from postproc.analysis.run_in import contours_of_run
from workflows.job import job_log

with job_log(snakemake.log[0]):
    folder = Path(snakemake.input.wear).parent
    track = pin_runs(snakemake.input.design).set_index("run").loc[snakemake.wildcards.run, "track_radius_m"]
    contours_of_run(folder, track).to_csv(snakemake.output.contours, index=False)
    volumes_of_run(folder).to_csv(snakemake.output.volumes, index=False)
