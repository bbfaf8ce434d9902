"""What the reader of a screening regression must know before believing it, one sentence each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bulkwear.postproc.statistics.model_terms import aliased_pairs, aliasing, term_name
from bulkwear.postproc.statistics.regression import SINGULAR, press
from bulkwear.postproc.statistics.selection import AS_GOOD, largest_size
from bulkwear.workflows.cases.sliding_sample.screening.study_regression import Screening

FEW_FREEDOM = 4  # degrees of freedom of the error; Student's t at 95 % is 2.8 there, and grows fast below
CLEAR = 0.01  # -, correlation below which a main effect counts as clear of a term of second order
CONFOUNDED = 0.3  # -, correlation with a nuisance from which on a factor's effect may be the nuisance's
VARIES = 1e-9  # -, relative range of a nuisance that counts as a difference


def screening_warnings(study: Screening) -> list[str]:
    """Return what is lost, aliased, or too little in a screening study's regression; empty when nothing is."""
    parts = (
        _lost_runs,
        _lost_mirrors,
        _lost_terms,
        _nuisances,
        _few_runs,
        _equals,
        _neighbours,
        _two_steps,
        _no_replicates,
    )
    return [sentence for part in parts for sentence in part(study)]


def warnings_for_figures(study: Screening) -> list[str]:
    """Return those that stand on every figure: runs that are lost, and what else differs between runs."""
    return [*_lost_runs(study), *_nuisances(study)]


def _listed(names) -> str:
    return ", ".join(str(name) for name in names)


def _lost_runs(study: Screening) -> Iterator[str]:
    if not study.used.all():
        yield (
            f"{_listed(study.design_rows[~study.used])}: no wear above zero, missing or failed;"
            f" {study.used.sum()} of {len(study.used)} runs are used"
        )


def _lost_mirrors(study: Screening) -> Iterator[str]:
    """A main effect is clear of second order only while every run has its mirror image."""
    pairs = [term for term in study.candidates if len(term) == 2]
    mains = [term for term in study.candidates if len(term) == 1]
    if not pairs or not mains:
        return
    between = aliasing([*mains, *pairs], study.coded, study.names).iloc[: len(mains), len(mains) :].abs()
    worst = between.max(axis=1)
    if worst.max() > CLEAR:
        main = worst.idxmax()
        yield (
            "main effects are not clear of interactions and squares: the largest correlation is"
            f" {worst.max():.2f}, of {main} with {between.loc[main].idxmax()}"
        )


def _lost_terms(study: Screening) -> Iterator[str]:
    for term, other in study.lost:
        name = term_name(term, study.names)
        if other is None:
            yield f"{name} does not change over the runs and is left out"
        else:
            yield f"{name} cannot be told from {term_name(other, study.names)} and is left out"


def confounded(study: Screening) -> dict[str, dict[str, float]]:
    """Return, for every nuisance that differs between runs, {factor: correlation (-)} of those it is aliased with.

    The strongest factor comes first; a nuisance that varies without being aliased has none.
    """
    found = {}
    for what, values in study.nuisances.items():
        if np.ptp(values) <= VARIES * np.abs(values).max():
            continue
        columns = np.column_stack([study.coded, values])
        with np.errstate(invalid="ignore", divide="ignore"):
            correlation = np.nan_to_num(np.corrcoef(columns, rowvar=False)[-1, :-1])
        order = np.argsort(-np.abs(correlation), kind="stable")
        found[what] = {study.names[k]: correlation[k] for k in order if abs(correlation[k]) >= CONFOUNDED}
    return found


def _nuisances(study: Screening) -> Iterator[str]:
    for what, factors in confounded(study).items():
        values = study.nuisances[what]
        differs = f"the {what} is not the same in all runs ({values.min():.3g} to {values.max():.3g})"
        named = _listed(f"{name} ({correlation:+.2f})" for name, correlation in factors.items())
        yield f"{differs}: it is aliased with {named}, whose effect cannot be told from it" if factors else differs


def _few_runs(study: Screening) -> Iterator[str]:
    runs, count = len(study.response), len(study.candidates)
    judged = largest_size(count, runs)
    if judged < len(study.factors):
        yield f"{runs} runs are few for {len(study.factors)} factors, models of up to {judged} terms are compared"
    if count > runs - 2:
        yield (
            f"{count} candidate terms compete for {runs} runs: p values of chosen terms are too small,"
            " the permutation test beside them repeats the choice"
        )
    if study.model.freedom < FEW_FREEDOM:
        yield f"the error is estimated from {study.model.freedom} degree(s) of freedom, intervals are wide and unsure"
    if study.model.leverage.max() > 1.0 - SINGULAR or not np.isfinite(press(study.model)):
        row = study.design_rows[study.used][study.model.leverage.argmax()]
        yield f"run {row} alone decides a coefficient of the model (leverage 1)"


def _equals(study: Screening) -> Iterator[str]:
    count = len(study.choices["strong"])
    if count > 1:
        yield f"{count} models are as good as the best within {AS_GOOD:g} of the criterion, see the table of models"


def _neighbours(study: Screening) -> Iterator[str]:
    """Terms outside the model that look much like terms inside it."""
    pairs = aliased_pairs(aliasing(study.candidates, study.coded, study.names))
    for term in study.model.terms:
        name = term_name(term, study.names)
        near = pairs[(pairs["first"] == name) | (pairs["second"] == name)]
        others = [
            f"{second if first == name else first} ({correlation:+.2f})"
            for first, second, correlation in near.itertuples(index=False)
        ]
        if others:
            yield f"{name} looks much like {_listed(others)}: one may stand for another"


def _two_steps(study: Screening) -> Iterator[str]:
    found = study.by_two_steps
    if isinstance(found, str):
        yield f"the two-step method cannot be used: {found}"
        return
    both = (_listed(term_name(term, study.names) for term in terms) for terms in (found.terms, study.model.terms))
    theirs, ours = (words or "none" for words in both)
    if set(found.terms) != set(study.model.terms):
        yield f"the two-step method finds other terms ({theirs}) than the search ({ours}), see the table of methods"
    if not found.own_freedom:
        yield (
            "no fake factor and no repeated row tells the error: the two-step method takes it from main effects that"
            " it counts as none"
        )


def _no_replicates(study: Screening) -> Iterator[str]:
    if len(np.unique(study.coded, axis=0)) == len(study.coded):
        yield "no row is repeated: the error of the model is the scatter of packings and misfit together"
