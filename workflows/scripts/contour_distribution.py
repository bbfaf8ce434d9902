"""Draw how depth and opening are distributed round the disc."""

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import common_revolution, histograms, only_reference, published_ranges
from workflows.cases.pin_on_disc.plots.contours import contour_distribution
from workflows.cases.pin_on_disc.runs import REFERENCE, of_runs, pin_runs, reference_remark
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    contours = only_reference(of_runs(runs, snakemake.input.contours), runs, published, REFERENCE)
    ranges = published_ranges(published)
    ranges["label"] = ranges["source"] + f", revolution {snakemake.params.revolution}"
    last = common_revolution(contours, snakemake.params.revolution)
    shown = contours[contours["revolution"] == last]
    bars = histograms(shown)
    remarks = [f"after revolution {last}", reference_remark(runs, published, REFERENCE), *snakemake.params.remarks]
    by_panel = dict(list(bars.groupby(["scheme", "size"])))
    save(contour_distribution(shown, by_panel, ranges, remarks), snakemake.output.figure)
    bars.to_csv(snakemake.output.table, index=False)
