"""Figures and tables of studies whose flow regimes are found: wear over the plain twin, runs by regime, the flow, and
the source's findings beside them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.sliding_sample import charts
from bulkwear.workflows.cases.sliding_sample.figures import DESIGN, SUMMARY, WEAR
from bulkwear.workflows.cases.sliding_sample.screening import figure_findings
from bulkwear.workflows.cases.sliding_sample.study import (
    compares_rows,
    equivalent_size_ratios,
    finds_regimes,
    flow_runs,
    flow_velocities,
    has_findings,
    named_factors,
    passing_beds,
    published_flow,
    published_rows,
    run_in,
)
from bulkwear.workflows.config.claims import CLAIMS_FILE
from bulkwear.workflows.report.products import Job, every_run, figure, tables

if TYPE_CHECKING:
    import pandas as pd

REGIMES, PROFILES = "results/{study}/flow/regimes.csv", "results/{study}/flow/profiles.csv"
ALONG = "results/{study}/figures/relative_velocity.csv"
PUBLISHED_RESULTS = "config/published/screening_results.csv"


@figure(
    "Wear",
    "Wear of patterned over plain samples",
    finding=figure_findings.pattern_over_plain,
    inputs={
        "summary": SUMMARY,
        "published": PUBLISHED_RESULTS,
    },
    told={"size_ratios": equivalent_size_ratios, "published_rows": published_rows},
    tables={"published": "figures/relative_wear_published.csv"},
    charts=(charts.RELATIVE_WEAR,),
    when=compares_rows,
    caption="""
    Worn volume of the patterned sample over that of the plain sample in the same packing, geometric mean over the
    packings, lowest first. Below 1 (dashed line) the pattern wears less in total. Black bars: 95 % interval of the
    mean, by Student's t from the scatter of the row's own packings; without a cap it goes on beyond the axis.
    Hollow marks: what the source's text gives of the same rows. Above each bar: the equivalent size ratio of
    particle to bump (Yan 2022, Eq 4.18).
    """,
)
def relative_wear(job: Job) -> Any:
    """Draw patterned over plain wear."""
    import pandas as pd

    from bulkwear.postproc.tables.packings import packings_remark
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.comparison import relative_wear_table
    from bulkwear.workflows.cases.sliding_sample.plots import bars
    from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import published_relative_wear

    files, told = job.files, job.told
    table = relative_wear_table(read_summary(files.summary), told.size_ratios)
    published = published_relative_wear(pd.read_csv(files.published), told.published_rows)
    drawn = bars.relative_wear(table, published, [*job.remarks, packings_remark(table["packings"])])
    return drawn, table, {"published": published[published["row"].isin(table["setting"])]}


# ---------------------------------------------------------------- the flow


@figure(
    "Bed",
    "Relative velocity of the particles",
    finding=figure_findings.relative_velocity,
    # the snapshots of the bed lie beside the tables of wear
    inputs={"design": DESIGN, "wear": WEAR, "costs": every_run("cost.csv"), "published": published_flow},
    told={"runs": flow_runs, "run_in": run_in},
    tables={"bins": "flow/moving_bins.csv", "regimes": "flow/regimes.csv"},
    charts=(charts.RELATIVE_VELOCITY,),
    when=finds_regimes,
    digits={"table": 6, "bins": 6},
    caption="""
    Mean velocity of the particles over the sample, inside the thickness of the original bed, over that of the sample,
    both seen from the bed at rest, averaged over 10 mm of travel (Yan 2022, Eq 3.7): 0 % for a bed that lets the
    sample pass, 100 % for particles that ride along. A flow is called discontinuous if the steady value is 85 % or
    more and particles have heaped up over the sample. Grey: the source's steady window, where the travel gets there.
    There is a point only where a snapshot of the bed was taken. Means over the packings; the regime is that of all of
    them. The counterpart of Yan 2022, Fig 3.10.
    """,
)
def relative_velocity(job: Job) -> Any:
    """Bin the motion of the bed over every sample along its travel, and draw its relative velocity by regime."""
    import pandas as pd

    from bulkwear.postproc.tables.history import RUN, runs_of
    from bulkwear.postproc.tables.packings import mean_along
    from bulkwear.workflows.cases.sliding_sample.flow_history import RunFlow, flow_tables, published_window
    from bulkwear.workflows.cases.sliding_sample.plots.flow import along_travel
    from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import by_group, regime_remarks

    names = runs_of(job.files.design)
    folders = dict(zip(names["run"], [Path(path).parent for path in job.files.wear], strict=True))
    bins, along, regimes = flow_tables(
        folders, {run: RunFlow(**values) for run, values in job.told.runs.items()}, names
    )
    published = pd.read_csv(job.files.published)
    window = published_window(published, job.told.run_in)
    lines = published[published["quantity"] == "relative_velocity"] if "of" in published else None
    label, remarks = "Relative velocity of the particles (%)", [*job.remarks, *regime_remarks(regimes)]
    column = "relative_velocity_percent"
    means = mean_along(by_group(along.drop(columns="regime").merge(names[RUN]), regimes), "travel_mm", column)
    return along_travel(means, column, label, window, remarks, lines), along, {"bins": bins, "regimes": regimes}


@figure(
    "Wear",
    "Relative wear gradient",
    finding=figure_findings.wear_gradient,
    # the stretches of travel within cycles lie beside the tables of wear
    inputs={"design": DESIGN, "wear": WEAR, "regimes": REGIMES, "along": ALONG, "published": published_flow},
    told={"run_in": run_in},
    tables={"steady": "flow/steady.csv"},
    charts=(charts.WEAR_GRADIENT,),
    when=finds_regimes,
    caption="""
    Wear volume per length of travel over stretches of some 10 mm (of whole cycles, where contacts are sampled), over
    the largest of all runs and stretches (Yan 2022, Eq 3.8 and 3.9). Rows stand in the panel of their patterned run's
    flow regime, plain twins with them; curves are means over the packings and over a tenth of the travel. Grey: the
    source's steady window, where the travel gets there. The counterpart of Yan 2022, Fig 3.12, which gives no numbers
    in its text: the gradient is significantly higher where the flow is continuous.
    """,
)
def wear_gradient(job: Job) -> Any:
    """Draw the relative wear gradient along the travel by regime; where flow and wear are steady, in a table."""
    import pandas as pd

    from bulkwear.postproc.tables.history import RUN, runs_of, wear_within_cycles
    from bulkwear.postproc.tables.packings import mean_along
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.evaluation import steady_table
    from bulkwear.workflows.cases.sliding_sample.flow_history import published_window
    from bulkwear.workflows.cases.sliding_sample.plots.flow import along_travel
    from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import gradients_by_group, regime_remarks

    regimes, folders = read_summary(job.files.regimes), [Path(path).parent for path in job.files.wear]
    table = gradients_by_group(wear_within_cycles(job.files.design, folders), regimes)
    window = published_window(pd.read_csv(job.files.published), job.told.run_in)
    steady = steady_table(read_summary(job.files.along), table, window)
    label, remarks = "Wear gradient over the largest of all runs (-)", [*job.remarks, *regime_remarks(regimes)]
    means = mean_along(table.merge(runs_of(job.files.design)[RUN]), "travel_mm", "relative_gradient")
    drawn = along_travel(means, "relative_gradient", label, window, remarks, smoothed=True)
    return drawn, table, {"steady": steady}


@tables(
    inputs={"summary": SUMMARY, "along": ALONG, "bins": "results/{study}/flow/moving_bins.csv"},
    told={"velocities": flow_velocities},
    tables={"profiles": "flow/profiles.csv"},
    when=finds_regimes,
    digits=6,
)
def profiles(job: Job) -> dict[str, pd.DataFrame]:
    """Make the profiles of the motion by layer of all rows."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.flow_history import row_profiles

    rows = list(dict.fromkeys(read_summary(job.files.summary)["row"]))
    bins = pd.read_csv(job.files.bins, dtype={"run": str})
    return {"profiles": row_profiles(bins, read_summary(job.files.along), job.told.velocities, rows)}


OF_PROFILES = {
    "inputs": {
        "summary": SUMMARY,
        "regimes": REGIMES,
        "profiles": PROFILES,
        "published": "config/published/screening_profiles.csv",
    },
    "told": {"published_rows": published_rows},
    "when": finds_regimes,
    "digits": 6,
}


@figure(
    "Bed",
    "Velocity profiles",
    finding=figure_findings.bottom_velocities,
    **OF_PROFILES,
    caption="""
    Mean velocity of the particles with the sample by layer, seen from the bed at rest, and its sideways and upward
    components over it, over the sample and beside it (in side bins sideways is outwards). Means over the steady window
    of the relative velocity, or over all of the travel where there is none; bins with fewer than five particles are
    left out. Layers are 5 mm times the particle scale high, the published ones 5 mm. Single values that the source's
    text gives stand as hollow marks; triangles where it gives a bound. Means over the packings. The counterpart of
    Yan 2022, Fig 3.19 and 3.20, of the rows of least wear in the two flow regimes.
    """,
)
def velocity_profiles(job: Job) -> Any:
    """Draw the velocity by layers over the rows that are shown in detail."""
    from bulkwear.workflows.cases.sliding_sample.plots import flow

    table, published = _profiles_in_detail(job)
    return flow.velocity_profiles(table, published, job.remarks), table


@figure(
    "Bed",
    "Profiles of the angular velocity",
    finding=figure_findings.bottom_spins,
    **OF_PROFILES,
    caption="""
    Magnitude of the averaged angular velocity by layer, over the sample and beside it, in the same windows and layers
    as the velocity profiles, means over the packings. As in the source, components are averaged first; the table has
    the mean of the particles' own angular speeds as well, which is higher where they do not turn alike. Rolling instead
    of sliding next to the surface is the source's explanation of the lower wear.
    Coarse-grained particles turn more slowly than real ones at the same difference of velocity, in inverse proportion
    to their size: speeds compare within a row only. Hollow marks: single values of the source's text; its "top layer"
    of R5 is read as the layer next to the sample. The counterpart of Yan 2022, Fig 3.21 and 3.22.
    """,
)
def angular_velocity_profiles(job: Job) -> Any:
    """Draw the averaged angular velocity by layers over the rows that are shown in detail."""
    from bulkwear.workflows.cases.sliding_sample.plots import flow

    table, published = _profiles_in_detail(job)
    return flow.angular_velocity_profiles(table, published, job.remarks), table


def _profiles_in_detail(job: Job) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the profiles of the rows shown in detail, means over the packings, and what is published of them."""
    import pandas as pd

    from bulkwear.postproc.tables.packings import mean_profiles
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import (
        of_published_rows,
        published_rows_in_detail,
        rows_in_detail,
    )

    summary, every, regimes = (read_summary(getattr(job.files, name)) for name in ("summary", "profiles", "regimes"))
    same = job.told.published_rows
    rows = rows_in_detail(summary, regimes, published_rows_in_detail(same))
    table = mean_profiles(every, summary.drop_duplicates("row").set_index("row")["setting"], rows)
    return table, of_published_rows(pd.read_csv(job.files.published), same)


# ---------------------------------------------------------------- wear and force by regime


@figure(
    "Wear",
    "Relative wear by flow regime",
    charts=(charts.WEAR_BY_REGIME,),
    finding=figure_findings.least_by_regime,
    inputs={"summary": SUMMARY, "regimes": REGIMES},
    told={"beds": passing_beds},
    when=finds_regimes,
    caption="""
    Wear per length of travel over the largest of the rows of the same flow regime, patterned and plain together
    (Yan 2022, Eq 3.10), least patterned wear first. Patterned samples are split into base and pattern. Rows stand in
    the panel of their patterned run's regime, plain twins with them. Black bars: 95 % interval of the geometric mean
    over the packings. Unlike wear over the plain twin's, this compares runs of different
    velocity, thickness and, where the line below the figure says so, particle scale. The counterpart of Yan 2022, Fig
    3.13. The table has the wear rate too, wear of the travel over the flow of mass (Eq 3.11).
    """,
)
def wear_by_regime(job: Job) -> Any:
    """Draw the relative wear of all runs by regime."""
    from bulkwear.postproc.tables.packings import packings_remark
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.plots import regimes as figures
    from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import regime_remarks, wear_by_group

    summary, regimes = read_summary(job.files.summary), read_summary(job.files.regimes)
    table = wear_by_group(summary, regimes, job.told.beds)
    remarks = [*job.remarks, *regime_remarks(regimes), packings_remark(table["packings"])]
    return figures.wear_by_regime(table, remarks), table


@figure(
    "Bed",
    "Normal force by flow regime",
    charts=(charts.FORCE_BY_REGIME,),
    finding=figure_findings.forces_by_regime,
    inputs={"summary": SUMMARY, "regimes": REGIMES},
    when=finds_regimes,
    caption="""
    Contact forces square to the faces, added up over the sample without its ramp, mean over the travel. Bars of error:
    95 % interval of the geometric mean over the packings; from moment to moment the force scatters more. On a pattern
    this sum holds forces that push one another, up and down the two sides of each of its shapes: it exceeds the weight
    of the bed, which the vertical force in the figure "Forces on the sample" does not. The counterpart of Yan 2022, Fig
    3.16.
    """,
)
def normal_force_by_regime(job: Job) -> Any:
    """Draw the normal force on all samples by regime."""
    from bulkwear.postproc.tables.packings import packings_remark
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.plots import regimes as figures
    from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import force_by_group, regime_remarks

    regimes = read_summary(job.files.regimes)
    table = force_by_group(read_summary(job.files.summary), regimes)
    remarks = [*job.remarks, *regime_remarks(regimes), packings_remark(table["packings"])]
    return figures.normal_force_by_regime(table, remarks), table


# ---------------------------------------------------------------- the source's findings

OF_RUNS = ("summary", "regimes", "profiles", "steady")  # tables whose names are text


@tables(
    inputs={
        "summary": SUMMARY,
        "regimes": REGIMES,
        "profiles": PROFILES,
        "steady": "results/{study}/flow/steady.csv",
        "claims": CLAIMS_FILE,
        "published_regimes": "config/published/screening_regimes.csv",
        "published_results": PUBLISHED_RESULTS,
        "published_coefficients": "config/published/screening_coefficients.csv",
        "published_design": "config/designs/screening.csv",
    },
    told={"factors": named_factors, "run_in": run_in, "published_rows": published_rows},
    tables={"findings": "findings/findings.csv", "runs": "findings/runs.csv"},
    when=has_findings,
)
def findings(job: Job) -> dict[str, pd.DataFrame]:
    """Tell the verdicts on the source's findings, and its rows beside what the source tells of them."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.finding_tests import findings_table
    from bulkwear.workflows.cases.sliding_sample.screening.findings import gather, runs_beside_source
    from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import published_wear_by_row
    from bulkwear.workflows.config.claims import claims_of

    told, paths = job.told, dict(vars(job.files))
    claims = claims_of("screening", paths.pop("claims"))
    read = {name: (read_summary if name in OF_RUNS else pd.read_csv)(path) for name, path in paths.items()}
    evidence = gather(read, told.run_in, told.published_rows, told.factors)
    model = published_wear_by_row(read["published_design"], read["published_coefficients"], told.factors)
    return {"findings": findings_table(evidence, claims), "runs": runs_beside_source(evidence, model)}
