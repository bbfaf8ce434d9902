"""The table of the filled boxes of bulk tests: what was asked of them, and what they have."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.engine.bulk_simulations import kept_filling
from bulkwear.workflows.engine.pouring import bulk_density

if TYPE_CHECKING:
    import pandas as pd

MASS, LEVEL = "mass_found_kg", "level_found_mm"  # columns of what is found, as the next two
DENSITY, RATIO = "bulk_density_found_kg_per_m3", "bulk_density_over_asked"
ASKED = ("mass_asked_kg", "mass_tolerance_kg", "level_asked_mm")  # columns, of boxes of a size alike
NOTE = """
Every filled box, at rest before it is opened or sheared; least and largest of the boxes of a size. Level: twice the
height of the centre of mass. Bulk density: of the found mass, level to that height, over the material's. A box outside
the tolerance of its mass is refused; its level alone refuses none, since how dense a filling settles is what its
frictions decide.
"""


def filling_columns(kept: Path) -> dict[str, Any]:
    """Return mass, level and bulk density of the filled box of a simulation, asked and found, by columns.

    kept: its folder
    """
    test, (mass, level) = kept_filling(kept)
    box, asked = test["box"], bulk_density(test["particle"])
    density = mass.found / (box["length_m"] * box["width_m"] * level.found)
    return {
        **dict(zip(ASKED, (mass.asked, mass.tolerance, 1e3 * level.asked), strict=True)),
        **{MASS: mass.found, LEVEL: 1e3 * level.found, DENSITY: density, RATIO: density / asked},
    }


def fillings_of(folders: Iterable[Path]) -> pd.DataFrame:
    """Return a row per simulation: its test, and its `filling_columns`; folders: theirs."""
    import pandas as pd  # slow to import, and every job reads this module

    rows = [{"test": kept_filling(kept)[0]["kind"].replace("_", " "), **filling_columns(kept)} for kept in folders]
    return pd.DataFrame(rows)


def fillings_table(fillings: pd.DataFrame, names: Sequence[str] = ("test",)) -> pd.DataFrame:
    """Return a row per test and size of box: how many fillings, what was asked, least and largest that was found.

    fillings: a row each, `names`, by which they are told apart, and `filling_columns`
    """
    import pandas as pd  # as in `fillings_of`

    groups = fillings.groupby([*names, *ASKED], sort=False)
    columns = {"fillings": groups.size()}
    for name in (MASS, LEVEL, DENSITY, RATIO):
        columns |= {f"least_{name}": groups[name].min(), f"largest_{name}": groups[name].max()}
    return pd.DataFrame(columns).reset_index()
