"""The picture of a travelling window beside a full bed."""

import numpy as np
import pandas as pd

from postproc.plots.window import wear_side_by_side

BEDS = ["bed of 2 m", "window"]


def test_blocks_and_means_are_drawn_as_tabled():
    """Per surface a line per bed: sliding work per metre over the middle of its blocks; and the mean over the cost."""
    work = pd.DataFrame(
        [
            {"surface": surface, "bed": bed, "block": block, "sliding_work_J": 0.1 * block + len(bed)}
            for surface in ("plain", "convex")
            for bed in BEDS
            for block in (1, 2, 3)
        ]
    )
    table = work[["surface", "bed"]].drop_duplicates().assign(sliding_work_J_per_m=[2.0, 3.0, 4.0, 5.0])
    table = table.assign(standard_error_J_per_m=0.5, cheaper_in_particle_steps=[1.0, 5.0, 1.0, 4.0])
    figure = wear_side_by_side(work, table, 0.1, ["scale 5"])
    for (along, means), surface in zip(np.reshape(figure.axes, (2, 2)), ("plain", "convex"), strict=True):
        rows = table[table["surface"] == surface]
        for line, bed in zip(along.get_lines(), BEDS, strict=True):
            one = work[(work["surface"] == surface) & (work["bed"] == bed)]
            np.testing.assert_allclose(line.get_xdata(), [50.0, 150.0, 250.0])
            np.testing.assert_allclose(line.get_ydata(), one["sliding_work_J"] / 0.1)
        drawn = [container.lines[0].get_xydata()[0] for container in means.containers]
        np.testing.assert_allclose(drawn, rows[["cheaper_in_particle_steps", "sliding_work_J_per_m"]])
        assert surface in along.get_title(loc="left")
