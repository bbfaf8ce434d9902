"""Values that a source printed, as tables in config/published hold them."""

from __future__ import annotations

import pandas as pd


def published_value(published: pd.DataFrame, quantity: str, of: str) -> float:
    """The value of a published quantity `of` laboratory or simulation, in the unit of the table.

    Raises ValueError when the table has none.
    """
    found = published[(published["quantity"] == quantity) & (published["of"] == of)]
    if len(found) != 1:
        raise ValueError(f"published '{quantity}' of '{of}' is there {len(found)} times, allowed is once")
    return float(found["value"].iloc[0])
