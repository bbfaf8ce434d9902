"""Of a study that compares wear laws the page says first where they disagree."""

import pandas as pd
import pytest

from bulkwear.workflows.cases.equipment.page import _answer_on_laws
from tests.support.law_cases import told_of


def volumes(worn_by: str, *beside: str) -> pd.DataFrame:
    """Worn volumes of a liner in two designs; every further law makes twice as much of B as the one before."""
    laws = [worn_by, *(law for law in (*beside, "archard", "tangential_work") if law != worn_by)]
    rows = [
        told_of(setting, packing, law, 2.0**place if setting == "B" else 1.0)
        | {"part": "liner", "over_study_law": 1.0 if law == worn_by else 0.5, "front_share": float("nan")}
        for setting in "AB"
        for packing in (1, 2)
        for place, law in enumerate(laws)
    ]
    return pd.DataFrame(rows)


@pytest.mark.parametrize(
    ("worn_by", "beside", "said"),
    [
        ("oka", ("finnie", "impact_threshold"), True),
        ("archard", ("oka", "finnie"), True),
        ("oka", (), False),
        ("archard", (), False),
    ],
)
def test_laws_beside_make_a_comparison(tmp_path, worn_by, beside, said):
    """Not the two that every ledger tells: a study of one law alone has an answer of its own."""
    volumes(worn_by, *beside).to_csv(tmp_path / "volume_by_law.csv", index=False)
    found = _answer_on_laws(tmp_path / "volume_by_law.csv")
    assert bool(found) == said
    assert not said or found[0].startswith("Laws disagree most on the liner of B: over that of A it wears 1 ")
