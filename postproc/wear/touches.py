"""Which contacts belong together: those of one particle in one sample, and samples of one episode of touch."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace

import numpy as np


def touches(sample: np.ndarray, particle: np.ndarray, motion: SimpleNamespace) -> SimpleNamespace:
    """Gather contacts into (sample, particle) pairs: a sphere can touch several triangles at once.

    sample, particle: (n,) int; motion: of `postproc.wear.ledger.contact_kinematics`
    Returns, sorted by sample and particle: sample, particle, force (N, magnitude of the summed normal force
    vectors), strongest (contact with the largest normal force); and of_contact, the pair of each contact.
    """
    order = np.lexsort((motion.signed_force, particle, sample))
    last = np.ones(order.size, bool)
    same = (sample[order][1:] == sample[order][:-1]) & (particle[order][1:] == particle[order][:-1])
    last[:-1] = ~same
    of_contact = np.empty(order.size, np.int64)
    of_contact[order] = np.cumsum(last) - last
    strongest = order[last]
    vectors = motion.normal_force[:, None] * motion.normal
    total = np.stack([np.bincount(of_contact, vectors[:, axis], strongest.size) for axis in range(3)])
    return SimpleNamespace(
        sample=sample[strongest],
        particle=particle[strongest],
        force=np.sqrt(np.einsum("ij,ij->j", total, total)),
        strongest=strongest,
        of_contact=of_contact,
    )


def episode_begins(sample: np.ndarray, particle: np.ndarray, touching_before: Iterable[int]) -> np.ndarray:
    """Return which pairs (sorted by sample, unique) have a particle without a pair in the sample before, (n,) bool.

    touching_before: particles that touch in the sample before the first one
    """
    order = np.lexsort((sample, particle))
    continues = np.zeros(sample.size, bool)
    now, before = order[1:], order[:-1]
    continues[now] = (particle[now] == particle[before]) & (sample[now] == sample[before] + 1)
    first = sample == 0
    continues[first] = np.isin(particle[first], touching_before)
    return ~continues
