"""Packings: closed forms of lattices and of spheres cut by planes; the source's rule beside the exact one."""

import itertools
import math

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.packing import (
    inner_means,
    layer_edges,
    loose_and_dense,
    packing_profile,
    porosity,
    porosity_of_whole_particles,
    slabs_remark,
    volume_below,
    within,
)
from tests.support.touching import contacts_of

ROUNDING = 1e-12  # relative
RADIUS = 0.001  # m
SIDE = 6  # spheres along an edge of a lattice


def lattice(spacing=2.0 * RADIUS, side=SIDE):
    """Centres (k, 3) of a simple cubic lattice whose lowest spheres stand on z = 0."""
    one = spacing * np.arange(side)
    return np.stack(np.meshgrid(one, one, one, indexing="ij"), axis=-1).reshape(-1, 3) + RADIUS


def as_bed(places, contacts=6.0):
    return pd.DataFrame(
        {"x_m": places[:, 0], "y_m": places[:, 1], "z_m": places[:, 2], "radius_m": RADIUS, "contacts": contacts}
    )


def test_a_cut_sphere_has_the_volume_of_its_segment():
    """pi h^2 (3 R - h) / 3 of height h; nothing below the sphere, all of it above; unequal spheres at once."""
    radius, whole = np.array([1.0, 2.0]), 4.0 / 3.0 * math.pi * np.array([1.0, 8.0])
    centres = np.zeros(2)
    assert np.array_equal(volume_below(centres, radius, -2.0), [0.0, 0.0])
    assert np.allclose(volume_below(centres, radius, 0.0), whole / 2.0, rtol=ROUNDING)
    assert np.allclose(volume_below(centres, radius, 2.5), whole, rtol=ROUNDING)
    height = 0.3 + radius
    expected = math.pi * height**2 * (3.0 * radius - height) / 3.0
    assert np.allclose(volume_below(centres, radius, 0.3), expected, rtol=ROUNDING)


@pytest.mark.parametrize("shift", [0.0, 0.37, 1.0, 1.9])
def test_layers_share_out_every_sphere(shift):
    """However the layers' edges cut them, the pieces add up to the spheres."""
    places = lattice()[:, 2]
    edges = np.linspace(-RADIUS, 2.0 * SIDE * RADIUS + RADIUS, 12) + shift * RADIUS - RADIUS
    edges = np.concatenate([[-RADIUS], edges[edges > 0.0], [1.0]])
    solid = ((1.0 - porosity(places, np.full(len(places), RADIUS), edges, 1.0)) * np.diff(edges)).sum()
    assert solid == pytest.approx(len(places) * 4.0 / 3.0 * math.pi * RADIUS**3, rel=ROUNDING)


def test_a_simple_cubic_lattice():
    """Periodic across: porosity 1 - pi/6 in layers of any height; six contacts inside, five at bottom and top."""
    places, period = lattice(), 2.0 * RADIUS * SIDE
    radius = np.full(len(places), RADIUS)
    for edges in (np.arange(0.0, SIDE + 1) * 2.0 * RADIUS, np.array([0.0, 4.0, 8.0, 12.0]) * RADIUS):
        found = porosity(places[:, 2], radius, edges, period**2)
        assert np.allclose(found, 1.0 - math.pi / 6.0, rtol=1e-9)
    number = contacts_of(places, radius * (1.0 + 1e-9), (period, period, 0.0))
    outer = np.isin(places[:, 2].round(9), [RADIUS, round((2 * SIDE - 1) * RADIUS, 9)])
    assert set(number[~outer]) == {6} and set(number[outer]) == {5}


def test_contacts_need_touch_and_know_the_period():
    """Spheres a little apart touch nothing; without a period those at the sides have fewer."""
    places, radius = lattice(), np.full(SIDE**3, RADIUS)
    assert contacts_of(places, radius * (1.0 - 1e-9), (2 * RADIUS * SIDE,) * 3).sum() == 0
    corner = contacts_of(places, radius * (1.0 + 1e-9))[0]
    assert corner == 3


def test_contacts_are_those_of_all_pairs():
    """Random spheres of three sizes in a periodic box against every pair, images included."""
    random = np.random.default_rng(3)
    places = random.random((200, 3)) * [0.02, 0.03, 0.05] - [0.01, 0.0, 0.0]
    radius = random.choice([0.8, 1.0, 1.2], 200) * 1.5 * RADIUS
    period = np.array([0.02, 0.03, 0.0])
    apart = places[:, None] - places[None]
    apart[..., :2] -= period[:2] * np.round(apart[..., :2] / period[:2])
    touching = np.linalg.norm(apart, axis=-1) <= radius[:, None] + radius[None]
    expected = touching.sum(axis=1) - 1
    assert expected.sum() > 50
    assert np.array_equal(contacts_of(places, radius, period), expected)


def test_the_whole_particle_rule_is_off_where_edges_cut():
    """A sheet of spheres across an edge: whole, one layer has it all; cut, each has half."""
    places = lattice(side=4)
    sheet = places[places[:, 2] == RADIUS]
    edges, area = np.array([0.0, RADIUS, 2.0 * RADIUS]), (8.0 * RADIUS) ** 2
    radius = np.full(len(sheet), RADIUS)
    half = len(sheet) * 2.0 / 3.0 * math.pi * RADIUS**3 / (area * RADIUS)
    assert np.allclose(porosity(sheet[:, 2], radius, edges, area), 1.0 - half, rtol=ROUNDING)
    whole = porosity_of_whole_particles(sheet[:, 2], radius, edges, area)
    assert whole == pytest.approx([1.0, 1.0 - 2.0 * half], rel=ROUNDING)


def test_profile_and_its_inner_means():
    """Layers of a lattice: their particles and contacts; means leave out the lowest and the highest layer."""
    places = lattice()
    bed = as_bed(
        places, contacts_of(places, np.full(len(places), RADIUS * (1.0 + 1e-9)), (2 * RADIUS * SIDE,) * 2 + (0,))
    )
    profile = packing_profile(bed, np.arange(0.0, SIDE + 1) * 2.0 * RADIUS, (2.0 * RADIUS * SIDE) ** 2)
    assert list(profile["coordination_number"]) == [5.0, 6.0, 6.0, 6.0, 6.0, 5.0]
    assert list(profile["particles"]) == [SIDE**2] * SIDE
    assert profile["height_m"].iloc[0] == pytest.approx(RADIUS)
    means = inner_means(profile)
    assert means["coordination_number"] == 6.0
    assert means["porosity"] == pytest.approx(1.0 - math.pi / 6.0) == means["porosity_whole_particles"]


def test_an_empty_layer_has_no_coordination_number():
    """Not zero: there is no particle to have contacts."""
    profile = packing_profile(as_bed(lattice(side=2)), np.array([0.0, 4.0, 5.0]) * RADIUS, 1.0)
    assert profile["coordination_number"].isna().tolist() == [False, True]
    assert profile["porosity"].iloc[1] == 1.0


def test_layers_reach_to_the_surface_and_three_are_needed():
    """Layers are four median diameters high and lie wholly in the bed; too few of them are refused in words."""
    places = lattice(side=14)[:, 2]
    edges = layer_edges(places, np.full(len(places), RADIUS), 2.0 * RADIUS)
    assert edges == pytest.approx([0.0, 0.008, 0.016, 0.024])
    with pytest.raises(ValueError, match=r"holds 1 layers of 8 mm .*allowed are at least 3"):
        layer_edges(lattice()[:, 2], np.full(SIDE**3, RADIUS), 2.0 * RADIUS)


def test_differences_are_dense_minus_loose():
    """A lattice stretched by 2 % sidewards is looser: its porosity falls by what the stretch gave."""
    loose, dense = lattice(2.02 * RADIUS, 14), lattice(side=14)
    loose[:, 2] = dense[:, 2]
    area = (2.02 * RADIUS * 14) ** 2
    table = loose_and_dense(as_bed(loose, 4.0), as_bed(dense, 6.0), 2.0 * RADIUS, area)
    assert list(dict.fromkeys(table["state"])) == ["loose", "dense", "difference"]
    difference = table[table["state"] == "difference"]
    assert set(difference["coordination_number"]) == {2.0}
    assert np.allclose(difference["porosity"], 0.0, atol=1e-9)  # the same spheres over the same area
    fewer = loose_and_dense(as_bed(dense[::2], 4.0), as_bed(dense, 6.0), 2.0 * RADIUS, area)
    assert (fewer.loc[fewer["state"] == "difference", "porosity"] < -0.1).all()


def test_a_piece_of_bed_has_the_centres_between_its_ends():
    """The start belongs to the piece, the end to the next one, so pieces share out the bed."""
    bed = as_bed(lattice())
    cuts = [0.0, RADIUS, 5.0 * RADIUS, 1.0]
    pieces = [within(bed, start, end) for start, end in itertools.pairwise(cuts)]
    assert [len(piece) for piece in pieces] == [0, 2 * SIDE**2, 4 * SIDE**2]


def test_a_figure_counts_its_slabs():
    """By scale, as many as there are, never a fixed number."""
    table = pd.DataFrame({"layer": [1, 2, 3, 1, 2, 3, 4], "particle_scale": [8.0] * 3 + [4.0] * 4})
    assert slabs_remark(table) == "slabs of 4 median diameters: 4 at scale 4, 3 at scale 8"
