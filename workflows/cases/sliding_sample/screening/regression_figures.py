"""Figures and tables of a screening's regression: what it says of the factors, the best designs that it predicts, and
one run of each of these against the prediction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.sliding_sample.figures import SUMMARY
from bulkwear.workflows.cases.sliding_sample.screening import figure_findings
from bulkwear.workflows.cases.sliding_sample.screening.figures import REGIMES
from bulkwear.workflows.cases.sliding_sample.study import CONDITIONS, PATTERN, factor_labels
from bulkwear.workflows.report import sensitivity
from bulkwear.workflows.report.products import Job, figure, tables

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.cases.sliding_sample.screening.study_regression import Screening

COEFFICIENTS = "config/published/screening_coefficients.csv"
OF_REGRESSION = {"told": {"factors": lambda study: study.factors}, "when": lambda study: bool(study.factors)}
FIDELITY = {"fidelity": lambda study: study.fidelity}


@figure(
    "Regression",
    "Best designs, predicted and simulated",
    finding=figure_findings.confirmed,
    inputs={
        "summary": SUMMARY,
        "regimes": REGIMES,
        "prediction": lambda study: f"results/{study.confirms}/confirmation/prediction.csv",
    },
    told=FIDELITY,
    when=lambda study: bool(study.confirms),
    caption="""
    The design of least wear inside the ranges of the factors for each flow regime that was found, by the best model of
    the screening's regression: predicted wear per length of travel, with the interval in which one further setting
    falls at 95 %, the mean over as many packings, and what its runs wear, with their plain twins. Velocity and
    thickness stand at the pair, of those at which a run of the screening had the regime, where the least is predicted.
    The interval takes the terms of the model as given; they were chosen with the same runs, so it is too narrow. A run
    inside it does not prove the model, one outside it refutes it at these levels.
    """,
)
def confirmation(job: Job) -> Any:
    """Draw what the runs of the best designs wear against what was predicted of them."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import patterned_name, read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.confirmation import (
        check_fidelity,
        confirmation_remarks,
        confirmation_table,
    )
    from bulkwear.workflows.cases.sliding_sample.screening.plots import regimes as figures

    predictions = pd.read_csv(job.files.prediction)
    check_fidelity(predictions, job.told.fidelity, job.files.prediction)
    summary = read_summary(job.files.summary)
    table = confirmation_table(predictions, summary, read_summary(job.files.regimes))
    remarks = [*job.remarks, *confirmation_remarks(table)]
    return figures.confirmation(table, patterned_name(summary["surface"]), remarks), table


@tables(
    inputs={
        "summary": SUMMARY,
        "published": COEFFICIENTS,
        "published_contours": "config/published/screening_contours.csv",
    },
    tables={
        name: f"regression/{name}.csv"
        for name in (
            "coefficients",
            "models",
            "methods",
            "residuals",
            "effects",
            "surface",
            "aliasing",
            "best_designs",
            "warnings",
        )
    },
    **OF_REGRESSION,
)
def regression(job: Job) -> dict[str, pd.DataFrame]:
    """Regress the wear of a study on its factors."""
    import pandas as pd

    from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import regression_tables

    published = pd.read_csv(job.files.published), pd.read_csv(job.files.published_contours)
    return regression_tables(_screening(job)[0], *published)


@figure(
    "Regression",
    "Coefficients of the regression",
    finding=figure_findings.strongest_terms,
    inputs={
        "summary": SUMMARY,
        "table": "results/{study}/regression/coefficients.csv",
        "published": COEFFICIENTS,
    },
    **OF_REGRESSION,
    caption="""
    Least-squares coefficients of ln(wear / largest wear) of the patterned samples on the factors in coded units, where
    -1, 0 and 1 are the low, middle and high level, with one standard error. The terms are those of the best model of
    main effects, squares and two-factor interactions in which every square and interaction has the main effects of its
    factors (strong heredity), by the Bayesian criterion corrected for few runs and many models. The first p value is
    computed as if these terms had been given beforehand and is therefore too small; the one by permutation is the
    share of random assignments of the results to the runs in which the same search finds a term with as large a t
    value. Hollow: the published regression (Yan 2022, Table 3.10), of other runs. Models as good as this one, and what
    other methods choose, stand in the tables of the page.
    """,
)
def regression_coefficients(job: Job) -> Any:
    """Draw the coefficients beside the published ones, where the study has all their factors."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.plots import regression as figures
    from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import has_factors

    (study, remarks), table = _screening(job), read_summary(job.files.table)
    published = pd.read_csv(job.files.published)
    beside = published if has_factors(published, study.names) else published[:0]
    return figures.coefficients(table, beside, remarks), table


@figure(
    "Regression",
    "Residuals of the regression",
    finding=figure_findings.largest_residual,
    inputs={"summary": SUMMARY, "table": "results/{study}/regression/residuals.csv"},
    **OF_REGRESSION,
    caption="""
    Residuals of the best model. Left: against the scores of a normal distribution; on the line they would be normal.
    Right: against the fitted value; a pattern would say that terms are missing. The runs with the largest residuals
    are named. The counterpart of Yan 2022, Fig 3.23.
    """,
)
def regression_residuals(job: Job) -> Any:
    """Draw the residuals."""
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.plots import regression as figures

    table = read_summary(job.files.table)
    return figures.residual_plots(table, _screening(job)[1]), table


@figure(
    "Regression",
    "Half-normal plot of effects",
    finding=figure_findings.largest_contrast,
    inputs={"summary": SUMMARY, "table": "results/{study}/regression/effects.csv"},
    **OF_REGRESSION,
    caption="""
    Sizes of orthogonal contrasts of ln(wear / largest wear), each time the largest that is left, against half-normal
    scores. Contrasts of pure error would lie along the line, whose slope is the pseudo standard error; effects stand
    above it. There are more candidate terms than runs, so a point's name is that of the term that fits best, not of
    the only one that could.
    """,
)
def regression_half_normal(job: Job) -> Any:
    """Draw the sizes of contrasts."""
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.plots import regression as figures

    table = read_summary(job.files.table)
    return figures.half_normal(table, _screening(job)[1]), table


@figure(
    "Regression",
    "Contours of the predicted wear",
    finding=figure_findings.least_predicted,
    inputs={"summary": SUMMARY, "table": "results/{study}/regression/surface.csv"},
    told={**OF_REGRESSION["told"], "labels": factor_labels},
    when=OF_REGRESSION["when"],
    caption="""
    Wear over the largest wear as the best model predicts it over pairs of factors, all others at their middle level.
    Factors whose levels double have logarithmic axes. The counterpart of Yan 2022, Fig 3.24: its four pairs come
    first, then those that tell most about the best model here; a factor that is not in the model changes nothing.
    Dashed: the published regression (Table 3.10), over the source's own largest wear.
    """,
)
def regression_contours(job: Job) -> Any:
    """Draw the response over pairs of factors."""
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.plots import regression as figures

    (study, remarks), table = _screening(job), read_summary(job.files.table)
    doubling = [factor.name for factor in study.factors if factor.spacing == "log"]
    return figures.response_contours(table, job.told.labels, doubling, remarks), table


@figure(
    "Regression",
    "Which factor decides",
    finding=sensitivity.finding,
    inputs={"summary": SUMMARY},
    **OF_REGRESSION,
    charts=(sensitivity.CHART,),
    digits=6,
    caption="""
    Sobol indices with 95 % intervals: the part of the response's variance that a factor makes over the range of the
    design, alone and with all its interactions. All factors vary evenly and independently over their ranges, in coded
    units. Left: of the page's regression; right: of wear over plain, whose regression is found by the same search. The
    intervals hold the error of the coefficients, with the terms taken as given, and that of the sample. Nothing is
    told of a regression that is as good in more than 5 % of random results, or predicts runs that are left out no
    better than their mean does.
    """,
)
def regression_sensitivity(job: Job) -> Any:
    """Draw the Sobol indices of the regression."""
    from bulkwear.postproc.plots.sensitivity import sensitivity_bars
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.regression_sensitivity import sensitivity_table

    table = sensitivity_table(read_summary(job.files.summary), job.told.factors)
    return sensitivity_bars(table, _screening(job)[1]), table


@tables(
    inputs={"summary": SUMMARY, "regimes": REGIMES},
    tables={"design": "confirmation/design.csv", "prediction": "confirmation/prediction.csv"},
    told={**OF_REGRESSION["told"], **FIDELITY},
    when=OF_REGRESSION["when"],
)
def best_designs(job: Job) -> dict[str, pd.DataFrame]:
    """Make a design table of the best design of each flow regime, which <study>_confirmation simulates."""
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.confirmation import best_of_regimes, design_of

    summary, regimes = read_summary(job.files.summary), read_summary(job.files.regimes)
    found = best_of_regimes(_screening(job)[0], summary, regimes, job.told.factors, CONDITIONS)
    return {"design": design_of(found, summary, PATTERN), "prediction": found.assign(fidelity=job.told.fidelity)}


def _screening(job: Job) -> tuple[Screening, list[str]]:
    """Return a study's regression, and what its figures must say."""
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import screen_summary
    from bulkwear.workflows.cases.sliding_sample.screening.regression_warnings import warnings_for_figures

    study = screen_summary(read_summary(job.files.summary), job.told.factors)
    return study, [*job.remarks, *warnings_for_figures(study)]
