"""Figures of a calibration, its statements about pairs and its materials file: one declaration each."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.calibration import charts, figure_findings
from bulkwear.workflows.cases.calibration.case import calibration_box, measured_file, pairs_file
from bulkwear.workflows.report import sensitivity
from bulkwear.workflows.report.products import Job, figure, tables

if TYPE_CHECKING:
    from bulkwear.workflows.cases.calibration.outcome import Calibrated

CATEGORY = "Calibration"
SIZES_BEFORE = "config/published/shear_box_sizes.csv"
SIMULATED = {
    "measured": measured_file,
    "pairs": pairs_file,
    "simulations": "results/{study}/simulations.csv",
    "repeats": "results/{study}/repeats.csv",
}
TOLD = {"parameters": calibration_box}


def _calibrated(job: Job) -> Calibrated:
    """Return the finished calibration of a job with the inputs `SIMULATED` and told `TOLD`."""
    from bulkwear.workflows.cases.calibration.outcome import read_calibrated

    folder = Path(job.files.simulations).parent
    return read_calibrated(job.told.parameters, Path(job.files.measured), Path(job.files.pairs), folder)


@tables(
    inputs=SIMULATED,
    told={**TOLD, "materials": lambda study: study.materials, "study": lambda study: study.name},
    tables={"summary": "summary.csv", "materials": "materials.yaml"},
    digits=6,
)
def statements(job: Job) -> Any:
    """Return what is said about the recommended and the compared pair, and a materials file with the former."""
    from bulkwear.workflows.cases.calibration.outcome import calibrated_materials

    done = _calibrated(job)
    return {"summary": done.statements, "materials": calibrated_materials(done, job.told.materials, job.told.study)}


@figure(
    CATEGORY,
    "Heaps of the recommended pair",
    finding=figure_findings.heap_angles,
    inputs=SIMULATED,
    told=TOLD,
    digits=6,
    caption="""
    Particles at rest, seen along the periodic width. The free surface is what a scanner above the heap would see; the
    line is the robust straight fit to it (median of the gradients between all pairs of surface points), drawn over the
    stretch that it uses: between 10 and 95 % of the slope's height, one diameter away from walls and edges. Beside it
    the angle with its standard uncertainty.
    """,
)
def heaps(job: Job) -> Any:
    """Draw the heaps of the recommended pair, one per test, with the slopes that were fitted."""
    import pandas as pd

    from bulkwear.workflows.cases.calibration.outcome import recommended_heaps
    from bulkwear.workflows.cases.calibration.plots.heaps import heaps as draw

    pictures, slopes = recommended_heaps(_calibrated(job))
    return draw(pictures, job.remarks), pd.concat(slopes, ignore_index=True)


@figure(
    CATEGORY,
    "Responses over the parameters",
    finding=figure_findings.ranges,
    inputs=SIMULATED,
    told=TOLD,
    digits=6,
    caption="""
    Mean of the surrogate (colours and white lines), our simulations (circles, same colours), pairs that others
    simulated (diamonds) and the measured value within one standard deviation (hatched); the tables beside name their
    sources. Fig 3.6 of Yan 2022 is the same map of the shear angle of river gravel, on which pairs between 36 and 38
    degrees are kept. Where a circle differs from the colour around it, its packing does: one simulation is one packing.
    """,
)
def response_maps(job: Job) -> Any:
    """Draw every response over the first two parameters."""
    from bulkwear.workflows.cases.calibration.plots import responses
    from bulkwear.workflows.cases.calibration.responses import response_grid

    done = _calibrated(job)
    grid = response_grid(done.problem, done.known)
    marked = done.everything, done.problem.measured, done.published, done.problem.names
    return responses.response_maps(grid, *marked, job.remarks), grid


@figure(
    CATEGORY,
    "Which parameter decides",
    finding=sensitivity.finding,
    inputs=SIMULATED,
    told=TOLD,
    charts=(sensitivity.CHART,),
    digits=6,
    caption="""
    Sobol indices with 95 % intervals: the part of the response's variance that a factor makes over the range of the
    design, alone and with all its interactions. All parameters vary evenly and independently over the ranges in which
    they were looked for. The intervals are those of draws of the surrogate, so that they hold what it does not know.
    Nothing is told of a surrogate of too few simulations, or of one that predicts simulations that are left out no
    better than their mean does.
    """,
)
def calibration_sensitivity(job: Job) -> Any:
    """Draw the Sobol indices of every response."""
    from bulkwear.postproc.plots.sensitivity import sensitivity_bars
    from bulkwear.workflows.cases.calibration.sensitivity import sensitivity_table

    table = sensitivity_table(_calibrated(job))
    return sensitivity_bars(table, job.remarks), table


@figure(
    CATEGORY,
    "Pairs that fit what was measured",
    finding=figure_findings.family,
    inputs=SIMULATED,
    told=TOLD,
    digits=6,
    caption="""
    Regions that hold 50 and 95 % of the posterior: every pair in them gives the measured responses, within what
    measurement and surrogate leave open. All pairs in the range count as equally likely before. Star: recommended, the
    pair of the inner region nearest to the mean. Diamond: the pair that it is compared with. Rolling friction is in the
    stated convention.
    """,
)
def family(job: Job) -> Any:
    """Draw which pairs fit what was measured."""
    from bulkwear.workflows.cases.calibration.plots import responses

    done = _calibrated(job)
    return responses.family(done.family, done.everything, done.pairs, job.remarks), done.family


@figure(
    CATEGORY,
    "Recommended and published pair",
    finding=figure_findings.first_reproduced,
    charts=(charts.PAIRS,),
    inputs={"statements": "results/{study}/summary.csv", "pairs": pairs_file},
    told={"compared": lambda study: calibration_box(study)["calibration"]["compared_pair"]},
    digits=6,
    caption="""
    Responses of both pairs simulated here with several packings (mean and its standard uncertainty), what the surrogate
    had predicted there, and the measured band. Open diamond: what others simulated with the compared pair. The tables
    beside name the sources.
    """,
)
def pairs_against_bands(job: Job) -> Any:
    """Draw the responses of both pairs beside the measured bands."""
    import pandas as pd

    from bulkwear.workflows.cases.calibration.plots import responses

    said, published = pd.read_csv(job.files.statements), pd.read_csv(job.files.pairs)
    other = published[published["row"] == job.told.compared].iloc[0]
    return responses.pairs_against_bands(said, other, job.remarks), said


@figure(
    CATEGORY,
    "Size and width of the shear box",
    finding=figure_findings.box_effect,
    charts=(charts.BOX_SIZES,),
    inputs={"sizes": "results/{study}/box_sizes.csv", "before": SIZES_BEFORE},
    digits=6,
    caption="""
    Shear angle at the pair of calibration.sizes_pair in boxes of other lengths (filled as high as they are long) and
    widths of the periodic slice; bars are the standard deviation between packings. Dashed: Yan 2022, Table 3.3, at
    sliding and rolling friction 0.24, with particles of true size in slices of 20 mm.
    """,
)
def box_sizes(job: Job) -> Any:
    """Draw the shear angle in boxes of other sizes."""
    import pandas as pd

    from bulkwear.workflows.cases.calibration.plots import responses

    sizes = pd.read_csv(job.files.sizes)
    return responses.box_sizes(sizes, pd.read_csv(job.files.before), job.remarks), sizes


@figure(
    CATEGORY,
    "Stopping rule, and what to measure next",
    finding=figure_findings.progress,
    charts=(charts.PROGRESS,),
    inputs={**SIMULATED, "looks": "results/{study}/looks.csv"},
    told=TOLD,
    digits=6,
    caption="""
    Left: share of the surrogate in the variance of prediction and measurement, mean over the posterior, at every look.
    The calibration stops where it falls below the dashed line, or at the largest number of simulations. Right: what
    measuring a response once more is expected to tell about the parameters; 1 bit halves the family.
    """,
)
def calibration_progress(job: Job) -> Any:
    """Draw how the calibration stopped, and what each response would still tell."""
    import pandas as pd

    from bulkwear.workflows.cases.calibration.plots import responses
    from bulkwear.workflows.cases.calibration.responses import information_table

    done, looks = _calibrated(job), pd.read_csv(job.files.looks)
    information = information_table(done.problem, done.known)
    drawn = responses.progress_and_information(looks, done.problem.surrogate_share, information, job.remarks)
    return drawn, pd.concat([looks, information])
