"""The model of many ranks: it returns what was measured, ghosts by hand, and the grids that it must choose."""

from dataclasses import replace

import pytest

from benchmarks.scaling_model import Bed, best_grid, deck_grid, efficiency, ghost_cost, ghost_share, waiting

ROUNDING = 1e-12
CHANNEL = Bed(width=0.1, length=0.4, travel=0.0, layer=0.005, sample_length=0.1, triangle_share=0.0)
PUSHED = replace(CHANNEL, travel=0.4)


@pytest.mark.parametrize("measured", [0.5, 0.9, 1.0])
def test_two_ranks_across_are_as_measured(measured):
    """The model goes through the measurement that it rests on."""
    assert efficiency(CHANNEL, ghost_cost(CHANNEL, measured), 2, 1) == pytest.approx(measured, rel=ROUNDING)


def test_ghosts_by_hand():
    """Two faces of 5 mm beside a slab of 25 mm, and of 100 mm: 0.4 and 0.1 ghosts per particle."""
    assert ghost_share(CHANNEL, 1, 1) == 0.0
    assert ghost_share(CHANNEL, 4, 1) == pytest.approx(0.4, rel=ROUNDING)
    assert ghost_share(CHANNEL, 1, 4) == pytest.approx(0.1, rel=ROUNDING)
    assert ghost_share(CHANNEL, 4, 4) == pytest.approx(0.5, rel=ROUNDING)


def test_a_pushed_bed_fills_half_of_its_domain():
    """Half of many ranks along the travel wait, of two ranks one; in a channel none."""
    assert [waiting(PUSHED, along) for along in (1, 2, 8)] == [1.0, 2.0, 2.0]
    assert waiting(CHANNEL, 8) == 1.0


def test_triangles_stay_with_the_ranks_at_the_sample():
    """A quarter of the channel has them: eight ranks wait for those that have four times the mean of a tenth."""
    loaded = replace(CHANNEL, triangle_share=0.1)
    assert waiting(loaded, 8) == pytest.approx(0.9 + 0.1 * 4.0, rel=ROUNDING)
    assert waiting(loaded, 2) == pytest.approx(0.9 + 0.1 * 2.0, rel=ROUNDING)


def test_a_bed_as_wide_again_with_every_rank_scales_without_loss_after_two():
    """Weak scaling: ranks of equal slabs have equal ghosts."""
    cost = ghost_cost(CHANNEL, 0.8)
    wider = [efficiency(replace(CHANNEL, width=0.05 * ranks), cost, ranks, 1) for ranks in (2, 8, 32)]
    assert wider == pytest.approx([0.8] * 3, rel=ROUNDING)


def test_grids_follow_the_geometry():
    """A long channel is split along first; a bed that is pushed through its domain across, until slabs are thin."""
    assert best_grid(CHANNEL, 1.0, 2) == (1, 2)
    assert best_grid(PUSHED, 1.0, 2) == (2, 1)
    across, along = best_grid(PUSHED, 1.0, 64)
    assert across * along == 64 and along > 1
    assert best_grid(CHANNEL, 0.0, 6) == (6, 1)


def test_decks_choose_the_least_cut_surface_where_the_bed_fills_its_domain():
    """100 x 400 mm: two slabs of 100 x 200 mm, four of 100 x 100 mm, sixteen of 50 x 50 mm; a bed that travels is split
    across. Of two grids with equal surface the one with fewer ranks across is taken.
    """
    assert [deck_grid(CHANNEL, ranks) for ranks in (1, 2, 4, 16)] == [(1, 1), (1, 2), (1, 4), (2, 8)]
    assert deck_grid(CHANNEL, 7) == (1, 7)
    assert [deck_grid(PUSHED, ranks) for ranks in (2, 16)] == [(2, 1), (16, 1)]
    assert deck_grid(replace(CHANNEL, length=0.1), 2) == (1, 2)


def test_an_impossible_efficiency_is_refused():
    """Zero would make ghosts cost without end; two ranks that are more than twice as fast make them cost nothing."""
    with pytest.raises(ValueError, match="the efficiency is 0, allowed is more than 0"):
        ghost_cost(CHANNEL, 0.0)
    assert ghost_cost(CHANNEL, 1.1) == 0.0
