"""Forces, torques and power of parts against closed forms and invariances."""

import numpy as np
import pytest

from bulkwear.postproc.wear.ledger import vector_columns
from bulkwear.postproc.wear.part_loads import part_loads

ROUND_OFF = 1e-12  # sums of a few dozen terms of order one
TRIANGLES, DURATION = 40, 0.25  # -, s
FORCES, TORQUES = ([f"{what}_{axis}_{unit}" for axis in "xyz"] for what, unit in (("force", "N"), ("torque", "N_m")))


def case(seed=3):
    """Corners, parts and a ledger of random loads: (corners, part, columns)."""
    random = np.random.default_rng(seed)
    vectors = {name: random.normal(size=(TRIANGLES, 3)) for name in ("impulse", "moment")}
    columns = columns_of(vectors) | {"drive_work_J": random.normal(size=TRIANGLES)}
    return random.normal(size=(TRIANGLES, 3, 3)), random.integers(3, 6, TRIANGLES), columns


def columns_of(vectors):
    """Vectors as columns of a ledger."""
    return {
        field: values[:, axis] for name, values in vectors.items() for axis, field in enumerate(vector_columns(name))
    }


def rows(loads, names):
    return np.column_stack([loads[name] for name in names])


def test_loads_are_sums_over_the_part_by_time():
    """Labels sorted; force, torque about the origin and power of each, from its facets alone."""
    corners, part, columns = case()
    loads = part_loads(columns, corners, part, DURATION)
    assert loads["part"].tolist() == [3, 4, 5]
    for k, label in enumerate(loads["part"]):
        mine = part == label
        impulse, moment = (
            np.column_stack([columns[n][mine] for n in vector_columns(v)]) for v in ("impulse", "moment")
        )
        torque = (np.cross(corners[mine].mean(axis=1), impulse) + moment).sum(axis=0) / DURATION
        np.testing.assert_allclose(rows(loads, FORCES)[k], impulse.sum(axis=0) / DURATION, rtol=ROUND_OFF)
        np.testing.assert_allclose(rows(loads, TORQUES)[k], torque, rtol=ROUND_OFF, atol=ROUND_OFF)
        assert loads["power_W"][k] == pytest.approx(columns["drive_work_J"][mine].sum() / DURATION, rel=ROUND_OFF)


def test_torques_about_two_points_differ_by_the_lever_of_the_force():
    """M_b = M_a + (a - b) x F."""
    corners, part, columns = case()
    one, other = np.array([0.3, -1.0, 2.0]), np.array([-0.5, 0.2, 0.1])
    about_one, about_other = (part_loads(columns, corners, part, DURATION, about=each) for each in (one, other))
    expected = rows(about_one, TORQUES) + np.cross(one - other, rows(about_one, FORCES))
    np.testing.assert_allclose(rows(about_other, TORQUES), expected, atol=1e3 * ROUND_OFF)


def test_a_force_on_one_facet_turns_about_where_it_acts():
    """The moment brings a force from the centroid to its point: 3 N at 2 m make 6 N m, wherever the centroid is."""
    point, impulse = np.array([2.0, 0.0, 0.0]), np.array([0.0, 3.0, 0.0]) * DURATION
    corners = np.random.default_rng(4).normal(size=(1, 3, 3))
    moment = np.cross(point - corners[0].mean(axis=0), impulse)
    columns = columns_of({"impulse": impulse[None], "moment": moment[None]}) | {"drive_work_J": np.zeros(1)}
    loads = part_loads(columns, corners, np.zeros(1, int), DURATION)
    np.testing.assert_allclose(rows(loads, TORQUES)[0], [0.0, 0.0, 6.0], atol=ROUND_OFF)


def test_turning_the_mesh_turns_force_and_torque():
    """Rotation invariance; power stays."""
    corners, part, columns = case()
    rotation, _ = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))
    rotation *= np.sign(np.linalg.det(rotation))
    vectors = {name: np.column_stack([columns[n] for n in vector_columns(name)]) for name in ("impulse", "moment")}
    turned_columns = columns_of({name: values @ rotation.T for name, values in vectors.items()})
    plain = part_loads(columns, corners, part, DURATION)
    turned = part_loads(columns | turned_columns, corners @ rotation.T, part, DURATION)
    for names in (FORCES, TORQUES):
        np.testing.assert_allclose(rows(turned, names), rows(plain, names) @ rotation.T, atol=1e3 * ROUND_OFF)
    np.testing.assert_array_equal(turned["power_W"], plain["power_W"])


@pytest.mark.parametrize("duration", [0.0, -1.0, np.nan])
def test_a_ledger_without_duration_has_no_means(duration):
    """Nothing is divided by nothing."""
    corners, part, columns = case()
    with pytest.raises(ValueError, match=rf"duration of a ledger is {duration} s, allowed is a number above 0"):
        part_loads(columns, corners, part, duration)
