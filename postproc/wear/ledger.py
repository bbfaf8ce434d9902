"""Load ledger: what particles did to each triangle of one mesh during a cycle, free of any wear coefficient.

Either the solver sums it at every step (`columns_of_solver`), or `LedgerBuilder` sums sampled contacts, each standing
for the interval between two samples. Wear laws that are linear in the sums (Archard 1953) are arithmetic on the
finished table; others add a sum of their own (kernels.py).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType, SimpleNamespace

import numpy as np

from bulkwear.postproc.wear.kernels import kernel_column, kernel_rate

CONTACTS_PER_BATCH = 100_000
LEDGER_FIELDS = (
    "sliding_work_J",
    "normal_impulse_N_s",
    "rolling_work_J",
    "impact_energy_J",
    "contact_time_s",
    "contact_radius_m",
    "contact_position_x_m",
    "contact_position_y_m",
    "contact_position_z_m",
)
_ARRAYS = (
    "triangle",
    "mesh",
    "particle",
    "contact_point",
    "centre",
    "wall_velocity",
    "particle_velocity",
    "angular_velocity",
    "force",
    "radius",
)


def contact_kinematics(contacts, wall_angular_velocity=(0.0, 0.0, 0.0)) -> SimpleNamespace:
    """Normal, normal force and relative velocities of each contact.

    contacts: anything with the arrays of `postproc.readers.contacts.Contacts`, n rows
    wall_angular_velocity: (3,) rad/s, of a mesh that rotates; `contacts.wall_velocity` is that at the contact point
    Returns
    relative_velocity: (n, 3) m/s, of the centre over the wall at the contact point, spin left out
    normal: (n, 3), from contact point to centre
    signed_force: (n,) N, force along the normal
    normal_force: (n,) N, the same, zero where the contact pulls
    sliding_speed: (n,) m/s, at the contact point, spin included
    rolling_speed: (n,) m/s, R times the part of the spin, relative to the wall's, about axes in the surface
    approach_speed: (n,) m/s, of the centre along the normal, without sign

    The lever arm is R - overlap/2, the one LIGGGHTS itself uses: with it pure rolling leaves nothing.
    """
    offset = contacts.centre - contacts.contact_point
    distance = np.sqrt(np.einsum("ij,ij->i", offset, offset))
    normal = offset / np.where(distance > 0.0, distance, 1.0)[:, None]
    lever = 0.5 * (contacts.radius + distance)
    spin_across = np.cross(contacts.angular_velocity, normal)
    relative = contacts.particle_velocity - contacts.wall_velocity
    approach = np.einsum("ij,ij->i", relative, normal)
    sliding = relative - approach[:, None] * normal - lever[:, None] * spin_across
    rolling = spin_across - np.cross(np.asarray(wall_angular_velocity, np.float64), normal)
    signed_force = np.einsum("ij,ij->i", contacts.force, normal)
    return SimpleNamespace(
        relative_velocity=relative,
        normal=normal,
        signed_force=signed_force,
        normal_force=np.maximum(signed_force, 0.0),
        sliding_speed=np.sqrt(np.einsum("ij,ij->i", sliding, sliding)),
        rolling_speed=contacts.radius * np.sqrt(np.einsum("ij,ij->i", rolling, rolling)),
        approach_speed=np.abs(approach),
    )


def hertz_contact_radius(force, radius, effective_modulus):
    """Radius (m) of the contact circle of a sphere on a flat, a = (3 F R / (4 E*))^(1/3) (Hertz 1882)."""
    return np.cbrt(0.75 * force * radius / effective_modulus)


def hertz_elastic_energy(force, radius, effective_modulus):
    """Energy (J) stored in the contact of a sphere on a flat, 2/5 F delta with delta = a^2/R (Hertz 1882)."""
    return 0.4 * force * hertz_contact_radius(force, radius, effective_modulus) ** 2 / radius


def columns_of_solver(
    columns: Mapping[str, np.ndarray], corners: np.ndarray, kernels: Iterable[str] = ()
) -> dict[str, np.ndarray]:
    """Return the ledger that the solver has summed: the columns that `LedgerBuilder.table` returns.

    columns: {name: (n,)}, as `postproc.readers.load_ledger.LoadLedger.columns`; contact points are barycentric
        there, contact_weight_1 ... 3 in the order of the corners
    corners: (n, 3, 3) m, corners of the triangles where the positions are wanted
    kernels: names of the kernels whose sums are wanted

    Raises KeyError when a column is missing, ValueError for an unknown kernel.
    """
    weights = np.column_stack([columns[f"contact_weight_{k}"] for k in (1, 2, 3)])
    position = np.einsum("ik,ikj->ij", weights, corners)
    found = {**columns, **{name: position[:, axis] for axis, name in enumerate(LEDGER_FIELDS[6:])}}
    return {name: found[name] for name in (*LEDGER_FIELDS, *map(kernel_column, kernels))}


class LedgerBuilder:
    """Sums the loads of sampled contacts per triangle.

    n_triangles: triangles of the mesh
    mesh_index: which mesh of the wall fix this ledger is for (0-based); contacts on other meshes are ignored
    effective_modulus: E* of particle and wall as simulated, Pa
    density: of the particles as simulated, kg/m3
    touching: ids of the particles that touch the mesh in the sample before the first one (carry it from the
        previous cycle's builder, so that a lasting contact is no new impact); None: unknown, so nothing in
        the first sample counts as an impact
    kernels: {name in `postproc.wear.kernels.KERNELS`: {parameter: value}} to sum as well, one column each
    face_normals: (n_triangles, 3) normals of the triangles, needed by kernels only
    wall_angular_velocity: (3,) rad/s, of a mesh that rotates

    Raises ValueError for an unknown kernel, for parameters that are not its own, and for kernels without normals of
    every triangle.
    """

    def __init__(
        self,
        n_triangles: int,
        mesh_index: int,
        effective_modulus: float,
        density: float,
        touching=None,
        kernels: Mapping[str, Mapping[str, float]] = MappingProxyType({}),
        face_normals=None,
        wall_angular_velocity=(0.0, 0.0, 0.0),
    ):
        self.n_triangles, self.mesh_index = n_triangles, mesh_index
        self.effective_modulus, self.density = effective_modulus, density
        self.wall_angular_velocity = wall_angular_velocity
        self._kernels = {kernel_column(name): kernel_rate(name, given) for name, given in kernels.items()}
        self._face_normals = None if face_normals is None else np.asarray(face_normals, np.float64)
        found = None if self._face_normals is None else self._face_normals.shape
        if kernels and found != (n_triangles, 3):
            raise ValueError(f"face_normals for kernels have the shape {found}, allowed is {(n_triangles, 3)}.")
        self._touching = None if touching is None else np.unique(np.asarray(touching, np.int64))
        self._samples, self._time_s = 0, 0.0
        self._sums = {
            name: np.zeros(n_triangles)
            for name in (*LEDGER_FIELDS[:5], *self._kernels, *(f"{kind}_{what}" for kind in "wf" for what in "axyz"))
        }
        self._buffer: list = []
        self._buffered, self._interval_s = 0, None

    @property
    def touching(self) -> np.ndarray | None:
        """(k,) sorted ids of the particles touching the mesh in the last sample; None before any sample."""
        self._flush()
        return self._touching

    @property
    def samples(self) -> int:
        """Number of samples added."""
        return self._samples + len(self._buffer)

    @property
    def time_s(self) -> float:
        """Time that the samples added stand for, s."""
        self._flush()
        return self._time_s

    def add(self, contacts, interval_s: float) -> None:
        """Adds one sample.

        contacts: as `postproc.readers.contacts.Contacts`; may be empty
        interval_s: time the sample stands for, s
        Raises ValueError when a contact names a triangle the mesh does not have.
        """
        if interval_s != self._interval_s:
            self._flush()
        self._interval_s = interval_s
        self._buffer.append(contacts)
        self._buffered += len(contacts.triangle)
        if self._buffered >= CONTACTS_PER_BATCH or len(self._buffer) >= CONTACTS_PER_BATCH:
            self._flush()

    def add_batch(self, batch, interval_s: float) -> None:
        """Adds many samples at once (`postproc.readers.contacts.ContactBatch`): the sums of `add`, faster."""
        self._flush()
        self._account(batch, np.diff(batch.starts), interval_s)

    def table(self) -> dict[str, np.ndarray]:
        """The ledger: one (n_triangles,) array per field of LEDGER_FIELDS and per kernel, units in the names.

        Contact radius and position are means weighted with the sliding work (with the normal impulse on
        triangles loaded without any sliding), NaN on triangles that were not loaded.
        """
        self._flush()
        sums, means = self._sums, {}
        slid = sums["sliding_work_J"] > 0.0
        weight = np.where(slid, sums["sliding_work_J"], sums["normal_impulse_N_s"])
        for letter, name in zip("axyz", LEDGER_FIELDS[5:], strict=True):
            moment = np.where(slid, sums[f"w_{letter}"], sums[f"f_{letter}"])
            means[name] = np.divide(moment, weight, out=np.full(weight.size, np.nan), where=weight > 0.0)
        copies = {name: sums[name].copy() for name in (*LEDGER_FIELDS[:5], *self._kernels)}
        return {name: {**copies, **means}[name] for name in (*LEDGER_FIELDS, *self._kernels)}

    def _flush(self) -> None:
        if not self._buffer:
            return
        parts, self._buffer, self._buffered = self._buffer, [], 0
        joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _ARRAYS}
        counts = np.array([len(part.triangle) for part in parts])
        self._account(SimpleNamespace(**joined), counts, self._interval_s)

    def _account(self, contacts, counts: np.ndarray, interval_s: float) -> None:
        """Adds samples that hold counts[k] contacts each."""
        sample = np.repeat(np.arange(counts.size), counts)
        mine = np.asarray(contacts.mesh) == self.mesh_index
        if not mine.all():
            contacts = SimpleNamespace(**{name: getattr(contacts, name)[mine] for name in _ARRAYS})
            sample = sample[mine]
        triangle = contacts.triangle
        if triangle.size and not 0 <= triangle.min() <= triangle.max() < self.n_triangles:
            raise ValueError(
                f"mesh {self.mesh_index}: found triangles {triangle.min()} ... {triangle.max()}, "
                f"allowed are 0 ... {self.n_triangles - 1}."
            )
        motion = contact_kinematics(contacts, self.wall_angular_velocity)
        pairs = _pairs(sample, contacts.particle, motion)
        work = motion.normal_force * motion.sliding_speed * interval_s
        impulse = motion.normal_force * interval_s
        self._sum("sliding_work_J", triangle, work)
        self._sum("normal_impulse_N_s", triangle, impulse)
        self._sum("rolling_work_J", triangle, motion.normal_force * motion.rolling_speed * interval_s)
        self._sum("contact_time_s", triangle, np.full(triangle.size, interval_s))
        for name, kernel in self._kernels.items():
            self._sum(name, triangle, kernel(contacts, motion, self._face_normals[triangle]) * interval_s)
        pair_force = pairs.force[pairs.of_contact]
        contact_radius = hertz_contact_radius(pair_force, contacts.radius, self.effective_modulus)
        for kind, weight in (("w", work), ("f", impulse)):
            self._sum(f"{kind}_a", triangle, weight * contact_radius)
            for axis, letter in enumerate("xyz"):
                self._sum(f"{kind}_{letter}", triangle, weight * contacts.contact_point[:, axis])
        self._impacts(contacts, motion, pairs, counts.size)
        self._samples += counts.size
        self._time_s += counts.size * interval_s

    def _sum(self, name: str, triangle: np.ndarray, values: np.ndarray) -> None:
        self._sums[name] += np.bincount(triangle, weights=values, minlength=self.n_triangles)

    def _impacts(self, contacts, motion, pairs, n_samples: int) -> None:
        """Energy brought by particles that touch now and did not in the sample before.

        An estimate from one sample: m v_n^2/2 plus the elastic energy stored by then, exact for an elastic
        contact at whatever moment it is sampled; contacts shorter than the interval can be missed altogether.
        Attributed to the triangle with the particle's largest normal force.
        """
        if n_samples == 0:
            return
        known = self._touching
        earlier = np.empty(0, np.int64) if known is None else known
        begins = _episode_begins(pairs.sample, pairs.particle, earlier)
        if known is None:
            begins &= pairs.sample > 0
        at = pairs.strongest[begins]
        radius, force = contacts.radius[at], pairs.force[begins]
        mass = 4.0 / 3.0 * np.pi * radius**3 * self.density
        energy = 0.5 * mass * motion.approach_speed[at] ** 2
        energy += hertz_elastic_energy(force, radius, self.effective_modulus)
        self._sum("impact_energy_J", contacts.triangle[at], energy)
        self._touching = pairs.particle[pairs.sample == n_samples - 1]


def _pairs(sample: np.ndarray, particle: np.ndarray, motion: SimpleNamespace) -> SimpleNamespace:
    """Contacts gathered into (sample, particle) pairs: a sphere can touch several triangles at once.

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


def _episode_begins(sample: np.ndarray, particle: np.ndarray, touching_before: Iterable[int]) -> np.ndarray:
    """Pairs (sorted by sample, unique) whose particle has no pair in the sample before."""
    order = np.lexsort((sample, particle))
    continues = np.zeros(sample.size, bool)
    now, before = order[1:], order[:-1]
    continues[now] = (particle[now] == particle[before]) & (sample[now] == sample[before] + 1)
    first = sample == 0
    continues[first] = np.isin(particle[first], touching_before)
    return ~continues
