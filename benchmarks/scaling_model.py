"""What more ranks will do, from what two of them lost: a model, not a measurement.

Every rank computes its share of the particles, and besides them the ghosts: copies of its neighbours' particles within
the reach of a contact, in a layer along each face that it shares. What a ghost costs, over what a particle costs, is
what two ranks across the travel were measured to lose. Assumed: a bed is shared evenly across; along the travel the
ranks share the domain, through which a bed between end walls travels, so that some of them wait; triangles are where
the sample is; a ghost costs the same in every layer; messages within and between nodes cost the same; nothing else
grows with the ranks. The decks choose `processors * 1 1` for a bed between end walls, and for one that fills its domain
`processors * * 1`: of all grids of so many ranks LIGGGHTS then takes the one with the least cut surface.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Bed:
    """Width (m) across and length (m) along the travel of a bed, its travel (m) through the domain, none where it is
    closed on itself, the layer (m) in which ghosts stand: the largest particle with its neighbour skin, the sample's
    length (m) along the travel, and the share (-) of a single rank's time that its triangles take.
    """

    width: float
    length: float
    travel: float
    layer: float
    sample_length: float
    triangle_share: float


def ghost_share(bed: Bed, across: int, along: int) -> float:
    """Return ghosts over own particles (-) of a rank within a grid of so many ranks across and along the travel.

    A rank has two shared faces in each direction in which the bed is split. In one in which it is not split it is its
    own neighbour where the bed is periodic; every number of ranks pays for that alike, and it is left out.
    """
    share = 2.0 * bed.layer * across / bed.width if across > 1 else 0.0
    return share + (2.0 * bed.layer * along / bed.length if along > 1 else 0.0)


def waiting(bed: Bed, along: int) -> float:
    """Return the work of the busiest rank over the mean (-), ghosts left out, of so many along the travel.

    It has a slab full of particles and of triangles.
    """
    domain = bed.length + bed.travel
    particles, triangles = (min(float(along), domain / length) for length in (bed.length, bed.sample_length))
    return (1.0 - bed.triangle_share) * particles + bed.triangle_share * triangles


def ghost_cost(bed: Bed, measured: float) -> float:
    """Return what a ghost costs over what a particle costs (-), from the efficiency of two ranks across the travel.

    Not below zero: two ranks can gain by their caches. Raises ValueError where the efficiency is not above 0.
    """
    if not measured > 0.0:
        raise ValueError(f"the efficiency is {measured:g}, allowed is more than 0")
    return max(1.0 / measured - 1.0, 0.0) / ghost_share(bed, 2, 1)


def efficiency(bed: Bed, cost: float, across: int, along: int) -> float:
    """Return the time of one rank over so many times that of `across` by `along` ranks (-)."""
    return 1.0 / (waiting(bed, along) * (1.0 + cost * ghost_share(bed, across, along)))


def best_grid(bed: Bed, cost: float, ranks: int) -> tuple[int, int]:
    """Return the grid (across, along) of so many ranks that the model finds fastest; across the travel where equal."""
    grids = [(ranks // along, along) for along in range(1, ranks + 1) if ranks % along == 0]
    return max(grids, key=lambda grid: (efficiency(bed, cost, *grid), grid[0]))


def deck_grid(bed: Bed, ranks: int) -> tuple[int, int]:
    """Return the grid (across, along) that the decks let the solver choose for so many ranks.

    A bed that travels through its domain is split across. Else it is the grid whose sub-domains have the least surface,
    of equal ones that with the fewest ranks across (LIGGGHTS 3.8.0, `best_factors` of src/procmap.cpp): with one rank
    in height, the least sum of width and length of a sub-domain.
    """
    if bed.travel > 0.0:
        return ranks, 1
    grids = [(across, ranks // across) for across in range(1, ranks + 1) if ranks % across == 0]
    return min(grids, key=lambda grid: bed.width / grid[0] + bed.length / grid[1])
