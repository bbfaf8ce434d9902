"""Candidate terms of a regression on coded factors: main effects, squares, products of two; and how they alias."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Literal

import numpy as np
import pandas as pd

Term = tuple[int, ...]
"""Positions of the factors in a product: (2,) a main effect, (1, 2) an interaction, (2, 2) a square."""

Heredity = Literal["none", "weak", "strong"]
SAME = 1e-9  # -, correlations closer to 1 than this are of one and the same column
PARALLEL = 0.5  # -, correlation from which on two terms are named to the reader


def candidate_terms(factors: int) -> list[Term]:
    """Return all main effects, then all squares and two-factor interactions."""
    pairs = itertools.combinations_with_replacement(range(factors), 2)
    return [*((k,) for k in range(factors)), *pairs]


def term_name(term: Term, names: Sequence[str]) -> str:
    """Return how people write a term: a, b*d, t^2."""
    if len(term) == 2 and term[0] == term[1]:
        return f"{names[term[0]]}^2"
    return "*".join(names[k] for k in term)


def parse_term(text: str, names: Sequence[str]) -> Term:
    """Return a term from its name. Raises ValueError naming the factors there are."""
    parts = [text[:-2]] * 2 if text.endswith("^2") else text.split("*")
    if len(parts) > 2 or not set(parts) <= set(names):
        raise ValueError(f"term '{text}' is not known, allowed are products of at most two of {', '.join(names)}")
    return tuple(sorted(names.index(part) for part in parts))


def term_columns(terms: Sequence[Term], coded: np.ndarray) -> np.ndarray:
    """Return the columns (runs, terms) of terms for factors in coded units (runs, factors)."""
    coded = np.asarray(coded, dtype=float)
    columns = [coded[:, list(term)].prod(axis=1) for term in terms]
    return np.column_stack(columns) if columns else np.empty((len(coded), 0))


def told_apart(terms: Sequence[Term], coded: np.ndarray) -> tuple[list[Term], list[tuple[Term, Term | None]]]:
    """Return the terms that these runs can tell apart, and what was left out.

    Left out is (term, None) when a term does not change over the runs, and (term, other) when it is, about the mean,
    the same column as another one before it, up to its size and sign.
    """
    columns = term_columns(terms, coded)
    centred = columns - columns.mean(axis=0)
    size = np.linalg.norm(centred, axis=0)
    changing = size > SAME * np.sqrt(len(columns))
    unit = np.divide(centred, size, out=np.zeros_like(centred), where=changing)
    same = np.triu(np.abs(unit.T @ unit) > 1.0 - SAME, 1)
    first = np.where(same.any(axis=0), same.argmax(axis=0), -1)
    kept = [term for term, moves, of in zip(terms, changing, first, strict=True) if moves and of < 0]
    lost = [
        (term, terms[of] if moves else None)
        for term, moves, of in zip(terms, changing, first, strict=True)
        if not moves or of >= 0
    ]
    return kept, lost


def aliasing(terms: Sequence[Term], coded: np.ndarray, names: Sequence[str]) -> pd.DataFrame:
    """Return the correlation matrix (-) of the columns of candidate terms, labelled with their names.

    NaN where a term does not change over the runs.
    """
    labels = [term_name(term, names) for term in terms]
    columns = term_columns(terms, coded)
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.atleast_2d(np.corrcoef(columns, rowvar=False))
    return pd.DataFrame(correlation, labels, labels)


def aliased_pairs(correlation: pd.DataFrame, least: float = PARALLEL) -> pd.DataFrame:
    """Return pairs of terms (first, second, correlation) correlated by `least` or more in size, strongest first."""
    values = correlation.to_numpy()
    rows, columns = np.nonzero(np.triu(np.abs(values) >= least - SAME, 1))
    labels = correlation.index.to_numpy()
    pairs = pd.DataFrame({"first": labels[rows], "second": labels[columns], "correlation": values[rows, columns]})
    return pairs.sort_values("correlation", key=np.abs, ascending=False, kind="stable", ignore_index=True)


def parents_of(terms: Sequence[Term], heredity: Heredity) -> tuple[np.ndarray, np.ndarray]:
    """Return (T, T) which main effects are parents of each term, and (T,) how many of them it needs by a heredity.

    A term of second order whose parents are no candidates can never be taken where it needs them.
    """
    parents = np.array([[len(t) == 2 and len(p) == 1 and p[0] in t for p in terms] for t in terms], dtype=bool)
    second = np.array([len(term) == 2 for term in terms], dtype=bool)
    factors = np.array([len(set(term)) for term in terms])
    least = {"strong": factors, "weak": np.ones(len(terms), dtype=int), "none": np.zeros(len(terms), dtype=int)}
    return parents.reshape(len(terms), len(terms)), np.where(second, least[heredity], 0)
