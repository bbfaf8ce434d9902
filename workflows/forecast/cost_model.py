"""What work costs: processor time linear in the sizes of a simulation, and the rates that measured times tell.

Work is a table with one row per piece of work and one column per term:

    decks                   starts of the solver
    triangles_read          triangles of the meshes that it reads, summed over the starts
    steps                   time steps
    particle_steps          particles times time steps
    moving_particle_steps   of these, in bulk that flows or slides
    particle_builds         particles times builds of the neighbour list
    triangle_steps          triangles that the solver has times time steps
    loaded_triangle_steps   of these, of surfaces on which bulk lies: particles near each are looked through
    jobs                    jobs of the workflow: interpreter and imports
    meshed_triangles        triangles of pristine surfaces
    cycles                  wear cycles
    worn_triangles          triangles of the whole surface, summed over the wear cycles

A rate is what one unit of a term costs, s. The first eight are the solver's, the others are spent outside it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

SOLVER_TERMS = (
    "decks",
    "triangles_read",
    "steps",
    "particle_steps",
    "moving_particle_steps",
    "particle_builds",
    "triangle_steps",
    "loaded_triangle_steps",
)
OUTSIDE_TERMS = ("jobs", "meshed_triangles", "cycles", "worn_triangles")
TERMS = (*SOLVER_TERMS, *OUTSIDE_TERMS)

Rates = Mapping[str, float]


def seconds(work: pd.DataFrame, rates: Rates, terms: Sequence[str] = TERMS) -> np.ndarray:
    """Return the processor time (k,) s of k rows of work: the sum over terms of amount times rate.

    terms: what counts, e.g. `SOLVER_TERMS`. Raises KeyError for a term without a rate.
    """
    return work[list(terms)].to_numpy(float) @ np.array([rates[term] for term in terms])


def fitted_rates(work: pd.DataFrame, measured: Sequence[float], known: Rates | None = None) -> dict[str, float]:
    """Return the rates (s) of the columns of `work` that explain measured times (k,) s best, none of them negative.

    known: rates that are not looked for. Relative errors are made small, so that a short measurement counts as much as
    a long one (Lawson and Hanson, Solving Least Squares Problems, 1974: non-negative least squares). Raises ValueError
    where the measurements are too few or too alike to tell the rates apart, or a time is not above 0.
    """
    from scipy.optimize import nnls  # slow to import, and every study is forecast without it

    known, times = dict(known or {}), np.asarray(measured, float)
    if not (times > 0.0).all():
        raise ValueError(f"measured times must be above 0 s, found {times.min():g}")
    wanted = [term for term in work.columns if term not in known]
    matrix = work[wanted].to_numpy(float) / times[:, None]
    scale = np.linalg.norm(matrix, axis=0)
    if len(times) < len(wanted) or not scale.all() or np.linalg.matrix_rank(matrix / scale) < len(wanted):
        raise ValueError(f"{len(times)} measurements cannot tell the rates of {', '.join(wanted)} apart")
    rest = 1.0 - seconds(work, known, list(known)) / times if known else np.ones(len(times))
    found, _ = nnls(matrix / scale, rest)
    return known | dict(zip(wanted, (found / scale).tolist(), strict=True))
