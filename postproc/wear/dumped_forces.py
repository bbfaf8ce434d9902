"""Friction of dumped contacts as the time step had it."""

from __future__ import annotations

import numpy as np


def step_forces(contacts, sample: np.ndarray) -> np.ndarray:
    """Return the forces on the particles, (n, 3) N, their tangential parts put right by what the walls did in the step.

    contacts: of all meshes of the wall, as `postproc.readers.contacts.Contacts`; sample: (n,) int, of each contact

    A dump evaluates the contact law once more without advancing its history (LIGGGHTS, tangential_model_history.h). A
    contact that slides has its spring exactly at the limit of friction then, and the law may take it for one that
    sticks, with viscous damping of the whole sliding speed on top. `contacts.wall_force` is what the contacts of a
    particle did together in the step itself: what is missing from it goes to them by the share of their tangential
    forces. A single contact gets its tangential force exactly. Normal parts stay; without a wall force all stays.
    """
    known = np.isfinite(contacts.wall_force).all(axis=1)
    if not known.any():
        return contacts.force
    normal = contacts.centre - contacts.contact_point
    distance = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / np.where(distance > 0.0, distance, 1.0)
    magnitude = np.linalg.norm(_tangential(contacts.force, normal), axis=1)
    particle = np.asarray(contacts.particle)
    _, pair = np.unique(sample * (1 + particle.max()) + particle, return_inverse=True)
    together = np.column_stack([np.bincount(pair, contacts.force[:, axis])[pair] for axis in range(3)])
    whole = np.bincount(pair, magnitude)[pair]
    share = np.divide(magnitude, whole, out=np.zeros_like(whole), where=known & (whole > 0.0))
    missing = np.where(known[:, None], contacts.wall_force - together, 0.0)
    return contacts.force + _tangential(share[:, None] * missing, normal)


def _tangential(vectors: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return vectors - np.einsum("ij,ij->i", vectors, normal)[:, None] * normal
