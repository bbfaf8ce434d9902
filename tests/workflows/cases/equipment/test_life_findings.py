"""Which part is changed first: named where intervals tell it."""

import math

import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.workflows.cases.equipment.life_findings import OF_ONE_COEFFICIENT, answers_on_first_change, interval_words


def lives_of(*rows, packings=3):
    """Tables of lives and of steel: part, material (or material, law), life, by what factor scatter and all reach."""
    table = pd.DataFrame(rows, columns=["part", "material", "life_h", "scatter", "both"]).assign(setting="plain")
    of_law = table["material"].str.partition(", ")
    table = table.assign(material=of_law[0], law=of_law[2], wear_coefficient_per_pa=1e-12)
    ends = {
        f"{name}_{end}_h": table["life_h"] * table[of] ** sign
        for name, of in (("scatter", "scatter"), ("life", "both"))
        for end, sign in (("low", -1.0), ("high", 1.0))
    }
    life = table.assign(**ends, packings=packings, coefficient_error=0.3, reason="")
    return life.drop(columns=[*OF_ONE_COEFFICIENT]), table[["setting", "part", *OF_ONE_COEFFICIENT]]


def test_a_part_is_changed_first_where_the_intervals_tell_so():
    """Of one steel and law its coefficient decides nothing, of two it does; of lives too near the shortest is told."""
    near, far = ("plate", "steel", 750.0, 1.1, 1.5), ("liner", "steel", 900.0, 1.1, 1.5)
    (said,) = answers_on_first_change(*lives_of(far, near))
    assert said == "The plate is changed first, after 750 h (500 to 1,100 h, 95 %)."
    (said,) = answers_on_first_change(*lives_of(("liner", "rubber", *far[2:]), near))
    open_ = "whether the liner is changed before it cannot be said."
    assert said == f"The plate has the shortest life, 750 h (500 to 1,100 h, 95 %); {open_}"
    (said,) = answers_on_first_change(*lives_of(("liner", "steel, finnie", *far[2:]), near))
    assert said.endswith(open_)  # by a law of its own
    (said,) = answers_on_first_change(*lives_of(("liner", "steel", 800.0, 1.1, 1.5), near))
    assert said.endswith(open_)  # the ratio is 1.07, its interval reaches by a factor of 1.14
    assert answers_on_first_change(*lives_of(near)) == []


def test_one_packing_does_not_tell_which_part_is_changed_first():
    """Its own blocks may, and nothing of another packing."""
    both = lives_of(("liner", "steel", 9000.0, 1.1, 1.5), ("plate", "steel", 750.0, 1.1, 1.5), packings=1)
    (said,) = answers_on_first_change(*both)
    assert said.startswith(f"The plate has the shortest life, 750 h ({UNKNOWN}; ")
    assert said.endswith("whether the liner is changed before it cannot be said.")


@pytest.mark.parametrize(
    ("packings", "said"),
    [
        (3, "3 packings do not tell it within a factor of 100"),
        (1, f"{UNKNOWN}; its blocks do not tell it within a factor of 100"),
    ],
)
def test_an_interval_that_tells_nothing_is_not_written_out(packings, said):
    """Of packings, and of the blocks of one; up to that factor its ends are told."""
    wide, narrow = (lives_of(("liner", "steel", 600.0, factor, factor), packings=packings)[0] for factor in (11.0, 9.0))
    assert interval_words(wide.iloc[0]) == said
    assert "67 to 5,400 h" in interval_words(narrow.iloc[0])


def test_what_is_open_is_told_together():
    """A part that may last shorter, and one of which no life is known."""
    life, steel = lives_of(("plate", "steel", 750.0, 1.1, 1.5), ("liner", "steel", 800.0, 1.1, 1.5))
    unknown = {"setting": "plain", "part": "lip", "life_h": math.nan, "reason": "its thickness is not known"}
    (said,) = answers_on_first_change(pd.concat([life, pd.DataFrame([unknown])]), steel)
    assert said.endswith("; whether the liner or the lip is changed before it cannot be said.")
