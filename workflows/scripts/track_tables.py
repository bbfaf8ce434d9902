"""Take the radial contours of a worn disc after each revolution, and collect its volumes."""

from pathlib import Path

from bulkwear.workflows.cases.pin_on_disc.run_in import contours_of_run
from bulkwear.workflows.cases.pin_on_disc.runs import pin_runs
from bulkwear.workflows.cases.pin_on_disc.volume import volumes_of_run
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    folder = Path(snakemake.input.wear).parent
    track = pin_runs(snakemake.input.design).set_index("run").loc[snakemake.wildcards.run, "track_radius_m"]
    contours_of_run(folder, track).to_csv(snakemake.output.contours, index=False)
    volumes_of_run(folder).to_csv(snakemake.output.volumes, index=False)
