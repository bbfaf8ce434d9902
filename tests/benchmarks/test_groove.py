"""The table of a groove on several meshes: volumes over the law's, and how far the meshes differ."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.groove import largest_differences, stroke_table


def two_grooves():
    """Strokes of one scheme on two meshes, and one stroke of the other scheme."""
    row = {
        "load_times_distance_J": 0.02,
        "law_volume_m3": 4e-10,
    }
    return pd.DataFrame(
        [
            {"scheme": scheme, "edges_per_width": edges, "stroke": stroke, "depth_m": depth, "width_m": 1e-3}
            | {"work_J": 0.02 * rise, "removed_volume_m3": removed, "carried_volume_m3": 1e-10}
            | row
            for scheme, edges, stroke, depth, rise, removed in (
                ("conserving", 5, 1, 10e-6, 1.0, 3e-10),
                ("conserving", 5, 2, 20e-6, 1.1, 3e-10),
                ("conserving", 10, 2, 25e-6, 1.1, 3e-10),
                ("per_triangle", 5, 1, 40e-6, 1.0, 20e-10),
            )
        ]
    )


def test_table_of_chosen_strokes():
    """Rows in the order asked for; volumes over the law's, work over F L, lengths in um and mm."""
    table = stroke_table(two_grooves(), [("conserving", 2), ("conserving", 1), ("per_triangle", 1)])
    assert list(zip(table["scheme"], table["strokes"], table["edges_per_width"], strict=True)) == [
        ("conserving", 2, 5),
        ("conserving", 2, 10),
        ("conserving", 1, 5),
        ("per_triangle", 1, 5),
    ]
    np.testing.assert_allclose(table["depth_um"], [20.0, 25.0, 10.0, 40.0])
    np.testing.assert_allclose(table["width_mm"], 1.0)
    np.testing.assert_allclose(table["removed_over_archard"], [0.75, 0.75, 0.75, 5.0])
    np.testing.assert_allclose(table["accounted_over_archard"], [1.0, 1.0, 1.0, 5.25])
    np.testing.assert_allclose(table["work_over_load_times_distance"], [1.1, 1.1, 1.0, 1.0])


def test_differences_between_meshes():
    """Largest over least minus 1 among the meshes of one scheme after the same number of strokes."""
    found = largest_differences(stroke_table(two_grooves(), [("conserving", 2), ("conserving", 1)])).set_index(
        "strokes"
    )
    assert found.loc[2, "depth_difference"] == pytest.approx(0.25)
    assert found.loc[1, "depth_difference"] == found.loc[2, "width_difference"] == 0.0
