"""Look at the patterns that were simulated, and say which come next."""

import json
from pathlib import Path

from bulkwear.workflows.cases.sliding_sample.search.rounds import decide_round
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.job import project_job, write_table

with project_job(snakemake.log[0]):
    files, number = snakemake.input, int(snakemake.wildcards.round)
    write_table(Path(snakemake.output.design), snakemake.params.rows)
    study = load_study(snakemake.wildcards.study, overrides=snakemake.params.settings)
    decided = decide_round(study, number, snakemake.output.design, files.wear, files.surface, files.costs)
    Path(snakemake.output.decided).write_text(json.dumps(decided, indent=1) + "\n", encoding="utf-8")
    print(f"{study.name}: {decided['said']}.")
