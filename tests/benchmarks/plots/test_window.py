"""The picture of a travelling window beside a full bed."""

import numpy as np
import pandas as pd

from benchmarks.plots.window import wear_side_by_side

BEDS = ["bed of 2 m", "window"]


SEEDS = (1, 2)


def test_packings_and_their_ratios_are_drawn_as_tabled():
    """Per surface and bed a line per packing and one of their mean, over the middle of its blocks; and the ratio, with
    its interval where there is one, over what the bed costs.
    """
    work = pd.DataFrame(
        {"surface": surface, "bed": bed, "seed": seed, "block": block, "sliding_work_J": 0.1 * block * seed + len(bed)}
        for surface in ("plain", "convex")
        for bed in BEDS
        for seed in SEEDS
        for block in (1, 2, 3)
    )
    table = work[["surface", "bed"]].drop_duplicates().assign(wear_over_full=[1.0, 0.9, 1.0, 1.3])
    table = table.assign(ratio_low=[np.nan, 0.8, np.nan, 1.2], ratio_high=[np.nan, 1.1, np.nan, 1.5])
    table = table.assign(cheaper_in_particle_steps=[1.0, 5.0, 1.0, 4.0])
    figure = wear_side_by_side(work, table, 0.1, ["scale 5"])
    for (along, ratios), surface in zip(np.reshape(figure.axes, (2, 2)), ("plain", "convex"), strict=True):
        rows, lines = table[table["surface"] == surface], iter(along.get_lines())
        for bed in BEDS:
            one = work[(work["surface"] == surface) & (work["bed"] == bed)]
            of_packings = [one.loc[one["seed"] == seed, "sliding_work_J"].to_numpy() / 0.1 for seed in SEEDS]
            for expected in (*of_packings, np.mean(of_packings, axis=0)):
                line = next(lines)
                np.testing.assert_allclose(line.get_xdata(), [50.0, 150.0, 250.0])
                np.testing.assert_allclose(line.get_ydata(), expected)
        assert next(lines, None) is None
        drawn = [container.lines[0].get_xydata()[0] for container in ratios.containers]
        np.testing.assert_allclose(drawn, rows[["cheaper_in_particle_steps", "wear_over_full"]])
        (bar,) = (part for container in ratios.containers for part in container.lines[2])
        np.testing.assert_allclose(bar.get_segments()[0][:, 1], rows[["ratio_low", "ratio_high"]].iloc[1])
        assert ratios.get_ylim()[0] < rows["ratio_low"].min() and ratios.get_ylim()[1] > rows["ratio_high"].max()
        assert surface in along.get_title(loc="left")
