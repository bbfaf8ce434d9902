"""Contact kernels: what a wear law that is not linear in the ledger's sums takes from every contact.

A kernel is one function and one line in `KERNELS`. It returns a value per contact and unit time, which the ledger sums,
times the time step, over the contacts of every triangle; or a value per impact, of which the ledger takes the sum. The
solver has the same kernels with the same parameters (`solver/kernels.h`), so that both producers of a ledger write the
same columns.

A ledger may hold sums of one kernel with several sets of parameters. The label of a sum is the kernel's name, of its
second set `name.2`, and so on; a kernel's name has no point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import SimpleNamespace

import numpy as np

SLOWEST = 1e-7  # m/s; the solver's Finnie wear ignores contacts that move slower
IMPACT_BRANCH = 0.33333  # -, of cos^2: the factor as the solver writes it, not 1/3


def finnie_work(contacts, motion: SimpleNamespace, face_normal: np.ndarray) -> np.ndarray:
    """Return 2 E(gamma) |v_rel| |F| of each contact in W: the sum that Finnie's wear is proportional to.

    contacts: anything with `contact_point`, `centre` (n, 3) m and `force` (n, 3) N
    motion: with `relative_velocity` (n, 3) m/s, of the particle's centre over the wall, spin left out
    face_normal: (n, 3), normal of the triangle that is touched; its sign does not matter

    Counted as the solver's `wear finnie` counts: only while the centre approaches the contact point, with the whole
    contact force. gamma is the angle between v_rel and the triangle; E = sin 2 gamma - 3 sin^2 gamma where
    3 sin gamma <= cos gamma, 0.33333 cos^2 gamma otherwise (I. Finnie, Wear 3 (1960) 87).
    """
    velocity = motion.relative_velocity
    speed = np.sqrt(np.einsum("ij,ij->i", velocity, velocity))
    approaching = np.einsum("ij,ij->i", contacts.contact_point - contacts.centre, velocity) >= 0.0
    counts = approaching & (speed >= SLOWEST)
    moving = np.where(counts, speed, 1.0)
    length = np.sqrt(np.einsum("ij,ij->i", face_normal, face_normal))
    sine = np.minimum(np.abs(np.einsum("ij,ij->i", velocity, face_normal)) / (moving * length), 1.0)
    across = np.cross(velocity, face_normal)
    cosine = np.minimum(np.sqrt(np.einsum("ij,ij->i", across, across)) / (moving * length), 1.0)
    steep = 3.0 * sine > cosine
    share = np.where(steep, IMPACT_BRANCH * cosine**2, 2.0 * sine * cosine - 3.0 * sine**2)
    force = np.sqrt(np.einsum("ij,ij->i", contacts.force, contacts.force))
    return np.where(counts, 2.0 * share * speed * force, 0.0)


def impact_above_threshold(
    contacts, motion: SimpleNamespace, face_normal: np.ndarray, threshold_velocity_m_per_s: float
) -> np.ndarray:
    """Return the energy (n,) J of each impact above a threshold, m (v_n - K)^2 / 2 where v_n is above K.

    motion: with `mass` (n,) kg and `approach_speed` (n,) m/s, v_n
    threshold_velocity_m_per_s: K, at least 0; 0 gives the impact energy

    The threshold is a velocity because a surface yields from a velocity on whatever the particle's size, and so from
    the same one under particles `scale` times as large. J. G. A. Bitter, Wear 6 (1963) 5.
    """
    return 0.5 * motion.mass * np.maximum(motion.approach_speed - threshold_velocity_m_per_s, 0.0) ** 2


def oka_energy(
    contacts,
    motion: SimpleNamespace,
    face_normal: np.ndarray,
    angle_exponent: float,
    hardness_exponent: float,
    hardness_pa: float,
    velocity_exponent: float,
    reference_velocity_m_per_s: float,
) -> np.ndarray:
    """Return m V^2 / 2 (v / V)^k2 g(a) of each impact in J: the energy of one square to the surface that wears as much.

    motion: with `mass` (n,) kg, `approach_speed` (n,) m/s, `relative_velocity` and `normal` (n, 3) m/s, -
    angle_exponent, hardness_exponent: n1 and n2, -; hardness_pa: of the wall, Pa, which the law takes in GPa
    velocity_exponent: k2, -; reference_velocity_m_per_s: V, m/s

    g = sin^n1 a (1 + H (1 - sin a))^n2, a the angle between the velocity of the centre and the plane of the contact, v
    its speed, both at the first touch; g(90 degrees) = 1. Y. I. Oka, K. Okamura, T. Yoshida, Wear 259 (2005) 95.
    """
    velocity, approach = motion.relative_velocity, motion.approach_speed
    across = np.cross(velocity, motion.normal)
    speed = np.sqrt(approach**2 + np.einsum("ij,ij->i", across, across))
    sine = np.divide(approach, speed, out=np.zeros_like(speed), where=speed > 0.0)
    angle_function = sine**angle_exponent * (1.0 + 1e-9 * hardness_pa * (1.0 - sine)) ** hardness_exponent
    energy = 0.5 * motion.mass * reference_velocity_m_per_s**2
    return energy * (speed / reference_velocity_m_per_s) ** velocity_exponent * angle_function


@dataclass(frozen=True)
class Kernel:
    """A contact kernel.

    value: (contacts, motion, normals of their triangles, parameters by name) -> (n,) array per unit time, as
        `finnie_work`, or of impacts, as `impact_above_threshold`; motion as of
        `postproc.wear.ledger.contact_kinematics`, of impacts with their mass too; None of one that is there in the
        solver alone, which sampled contacts then cannot do with
    unit: of the sum, as the ledger's column spells it
    parameters: names of the numbers that `value` takes, SI, each with its unit; a law that needs the kernel has them
        too
    per_impact: summed over the first touches of episodes, not over time
    """

    value: Callable[..., np.ndarray] | None
    unit: str = "J"
    parameters: tuple[str, ...] = ()
    per_impact: bool = False


KERNELS: dict[str, Kernel] = {
    "finnie_work": Kernel(finnie_work),
    "impact_above_threshold": Kernel(
        impact_above_threshold, parameters=("threshold_velocity_m_per_s",), per_impact=True
    ),
    "oka_energy": Kernel(
        oka_energy,
        parameters=(
            *("angle_exponent", "hardness_exponent", "hardness_pa"),
            *("velocity_exponent", "reference_velocity_m_per_s"),
        ),
        per_impact=True,
    ),
}


def register_kernel(name: str, kernel: Kernel) -> None:
    """Make a kernel known under a name, in place of one of that name. Raises ValueError for what is no kernel."""
    if not isinstance(kernel, Kernel):
        raise ValueError(f"contact kernel {name} is {type(kernel).__name__}, allowed is a Kernel(...)")
    KERNELS[name] = kernel


def sum_label(name: str, number: int) -> str:
    """Return the label of the sum of a kernel with its first, second, ... set of parameters."""
    return name if number == 1 else f"{name}.{number}"


def kernel_of(label: str) -> str:
    """Return the name of the kernel of a sum."""
    return label.partition(".")[0]


def kernel_column(label: str) -> str:
    """Return the ledger column of a kernel's sum, unit included. Raises ValueError for a name that is no kernel."""
    return f"{label}_{_kernel(kernel_of(label)).unit}"


def kernel_parameters(name: str) -> tuple[str, ...]:
    """Return the names of a kernel's parameters. Raises ValueError for a name that is no kernel."""
    return _kernel(name).parameters


def is_per_impact(name: str) -> bool:
    """Return whether a kernel is summed over impacts. Raises ValueError for a name that is no kernel."""
    return _kernel(name).per_impact


def kernel_value(name: str, parameters: Mapping[str, float]) -> Callable[..., np.ndarray]:
    """Return a kernel as a function of (contacts, motion, normals of their triangles).

    Raises ValueError for a name that is no kernel, for parameters that are not exactly those of the kernel, and for one
    that is there in the solver alone.
    """
    kernel = _kernel(name)
    if kernel.value is None:
        raise ValueError(f"contact kernel '{name}' is there in C++ alone, allowed for sampled contacts is a function")
    if set(parameters) != set(kernel.parameters):
        found, allowed = (", ".join(names) or "nothing" for names in (parameters, kernel.parameters))
        raise ValueError(f"parameters of the contact kernel '{name}' are {found}, allowed are: {allowed}")
    return partial(kernel.value, **parameters)


def _kernel(name: str) -> Kernel:
    if name not in KERNELS:
        raise ValueError(f"contact kernel '{name}' is unknown, allowed are: {', '.join(sorted(KERNELS))}")
    return KERNELS[name]
