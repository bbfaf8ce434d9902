"""What a search keeps of its budget for the confirmation, against what that takes."""

import itertools

import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.search.budget import spent_on
from bulkwear.workflows.config.optimise import CONFIRMED
from tests.support.searched import small_search

PATTERNS, PACKINGS, CONFIRMING = 20, 2, 5
RUN_S, BED_S = 36.0, 90.0
HOUR_S = 3600.0


def table_of_costs(folder, taken):
    """A table of what a run or a bed has taken."""
    path = folder / f"{len(list(folder.iterdir()))}.csv"
    pd.DataFrame({"processor_s": [taken]}).to_csv(path, index=False)
    return str(path)


def test_the_confirmation_is_kept_with_its_beds_and_plain_twins(tmp_path):
    """Twenty patterns have shared those of two packings; three patterns in three further packings share three more.

    By the mean that a packing of a pattern took, bed and twin in it, the confirmation would get too little.
    """
    columns, lines, costs = ("setting", "packing", "surface"), [], []
    for line in itertools.product(range(PATTERNS), range(1, PACKINGS + 1), ("convex", "plain")):
        lines.append(line)
        costs.append(table_of_costs(tmp_path, 0.0 if line[0] and line[2] == "plain" else RUN_S))
    costs += [table_of_costs(tmp_path, BED_S) for _ in range(PACKINGS)]
    spent = spent_on(pd.DataFrame(lines, columns=columns), costs)
    assert spent.total * HOUR_S == pytest.approx(PACKINGS * (PATTERNS * RUN_S + RUN_S + BED_S))
    assert (spent.pattern * HOUR_S, spent.packing * HOUR_S) == pytest.approx((RUN_S, RUN_S + BED_S))
    search = small_search(tmp_path, confirming_packings=CONFIRMING).optimise
    further = CONFIRMING - PACKINGS
    taken = PACKINGS * RUN_S + further * (
        CONFIRMED * RUN_S + RUN_S + BED_S
    )  # the best predicted one is simulated first
    assert spent.kept(search, 0) * HOUR_S == pytest.approx(taken)
    assert spent.total / (PATTERNS * PACKINGS) * (PACKINGS + CONFIRMED * further) < taken / HOUR_S
    assert spent.kept(search, 3) - spent.kept(search, 0) == pytest.approx(3 * PACKINGS * RUN_S / HOUR_S)
