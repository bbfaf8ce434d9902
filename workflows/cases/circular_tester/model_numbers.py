"""Numbers that the source prints of its tester's model beside ours, as values beside values (`report.published`)."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.circular_tester.tables import THESIS
from bulkwear.workflows.report.published import COMPUTED, GIVEN

MODEL, FITS = "Yan 2022, section 6.4.1", "Yan 2022, Eq 6.2 to 6.6, section 6.4.1"
UNLIKE_ITS_EQUATIONS = "said of particle scale 1; the source's own Eq 6.2 and 6.3 make 58 % of it"


def of_the_model(compared: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return rows of the comparison with the volumes and the reduction that the source prints of its model; nothing of
    samples that are not its. Plain volumes are given: a measured one sets the scale of time.

    compared: as from `tables.comparison_table`; published: config/published/circular_tester.csv
    """
    theirs = compared[compared[THESIS].notna()]
    first = compared["hours"].min()
    volumes = [
        theirs[(theirs["quantity"] == row["quantity"]) & (theirs["hours"] == row["hours"])].assign(**row)
        for row in _printed_volumes(published)
    ]
    reduction = theirs[(theirs["quantity"] == "reduction") & (theirs["hours"] == first)].assign(
        published_value=published_value(published, "reduction_56_h", "simulation"),
        setting="model after 56 h, particle scale 1",
        note=UNLIKE_ITS_EQUATIONS,
        source=MODEL,
    )
    table = pd.concat([*volumes, reduction], ignore_index=True)
    return table.assign(**{GIVEN: np.where(table["quantity"] == f"{PLAIN} volume", "yes", "")})


def _printed_volumes(published: pd.DataFrame) -> list[dict[str, object]]:
    """Return quantity, hours, value, setting and source of each volume that the source prints of its model."""
    printed = published["quantity"].str.extract(r"^(?P<surface>\w+)_volume_(?P<hours>\d+)_h$")
    found = published.join(printed)[printed["hours"].notna() & (published["of"] == "simulation")]
    return [
        {
            "quantity": f"{row.surface} volume",
            "hours": float(row.hours),
            "published_value": row.value,
            "setting": f"model after {row.hours} h",
            "source": row.source,
        }
        for row in found.itertuples()
    ]


def fits_beside_ours(rates: pd.DataFrame) -> pd.DataFrame:
    """Return what the source's fits lose per revolution beside ours of the same surface and particle scale, over as
    many revolutions; nothing where there are none.

    rates: as from `key_numbers.with_fits`
    """
    alike = rates[rates["fit_mm3_per_revolution"].notna()]
    rate = "rate_mm3_per_revolution"
    settings = [f"{row.surface}, particle scale {row.particle_scale:g}, {row.shape}" for row in alike.itertuples()]
    return pd.DataFrame(
        {
            "quantity": "worn volume per revolution",
            "setting": settings,
            "unit": "mm³",
            "published_value": alike["fit_mm3_per_revolution"].to_numpy(),
            COMPUTED: alike[rate].to_numpy(),
            "computed_low": alike[f"{rate}_low"].to_numpy(),
            "computed_high": alike[f"{rate}_high"].to_numpy(),
            "packings": alike["packings"].to_numpy(),
            "source": FITS,
        }
    )
