"""The sliding path with and without the spin of the particles: which runs are asked for, and what is compared."""

import pandas as pd
import pytest

from benchmarks.path_of_centres import KEYS, WHICH, compared


def test_each_run_is_asked_for_once(tmp_path):
    """Both surfaces of every setting, which share a bed; no two runs share a folder."""
    for of_study in WHICH.values():
        asked = pd.DataFrame(
            [told | {"folder": chain.folder, "bed": chain.bed_restart} for told, chain in of_study(tmp_path)]
        )
        assert asked["folder"].is_unique and not asked.duplicated(KEYS).any()
        assert (asked.groupby(KEYS[:-1])["bed"].agg(["nunique", "size"]) == [1, 2]).all(axis=None)


def test_paths_are_compared_by_surface():
    """Centres over contacts of either surface, and the ratio of the two by either path."""
    told = dict(zip(KEYS[:-1], ("study", 4, "as it is"), strict=True))
    rows = [("plain", 10.0, 11.0), ("convex", 4.0, 8.0)]
    runs = pd.DataFrame(
        [told | dict(zip([KEYS[-1], "of_contacts_J", "of_centres_J"], row, strict=True)) for row in rows]
    )
    (found,) = compared(runs).to_numpy()
    assert found == pytest.approx([1.1, 2.0, 0.4, 8.0 / 11.0])
