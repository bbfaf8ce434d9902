"""Look at the intervals that the packings of a round give, and say how many packings come next."""

import json
from pathlib import Path

from bulkwear.postproc.tables.summary import summary_table
from bulkwear.workflows.config.rounds import core_hours, read_round
from bulkwear.workflows.config.until import Until, answers, next_round
from bulkwear.workflows.engine.job import project_job, write_table

with project_job(snakemake.log[0]):
    files, rows, possible = snakemake.input, snakemake.params.rows, snakemake.params.possible
    write_table(Path(snakemake.output.design), rows)
    summary = summary_table(snakemake.output.design, files.wear)
    packings = {setting: int(count) for setting, count in summary.groupby("setting")["packing"].max().items()}
    finished = read_round(files.before[0])["finished"] if files.before else {}
    until, hours = Until(**snakemake.params.until), core_hours(files.costs)
    decided = next_round(until, answers(summary), packings, possible, finished, hours)
    Path(snakemake.output.decided).write_text(json.dumps(decided, indent=1) + "\n", encoding="utf-8")
    print(f"{snakemake.wildcards.study}: {decided['said']}.")
