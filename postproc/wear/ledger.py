"""Load ledger: what particles did to each triangle of one mesh during a cycle, free of any wear coefficient.

Either the solver sums it at every step (`columns_of_solver`), or `LedgerBuilder` sums sampled contacts, each standing
for the interval between two samples. Wear laws that are linear in the sums (Archard 1953) are arithmetic on the
finished table; others add a sum of their own (kernels.py). Vectors and places are those of the frame of the mesh's
own file, wherever the mesh has moved since.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType, SimpleNamespace

import numpy as np

from bulkwear.postproc.wear.dumped_forces import step_forces
from bulkwear.postproc.wear.kernels import is_per_impact, kernel_column, kernel_of, kernel_value
from bulkwear.postproc.wear.mesh_frame import MeshFrame, Pose, facet_frames
from bulkwear.postproc.wear.touches import episode_begins, touches

CONTACTS_PER_BATCH = 100_000
SUMMED_FIELDS = (
    "sliding_work_J",
    "normal_impulse_N_s",
    "rolling_work_J",
    "impact_energy_J",
    "contact_time_s",
    "tangential_work_J",
    "drive_work_J",
)
POSITION_FIELDS = ("contact_position_x_m", "contact_position_y_m", "contact_position_z_m")
MEAN_FIELDS = ("contact_radius_m", *POSITION_FIELDS)
VECTOR_UNITS = {"impulse": "N_s", "back_impulse": "N_s", "moment": "N_m_s"}  # on the mesh, in the frame of its file


def vector_columns(name: str, components: Iterable[str] = "xyz") -> tuple[str, ...]:
    """Return the three columns of a vector of VECTOR_UNITS; components: x, y, z or those of a facet's own frame."""
    return tuple(f"{name}_{component}_{VECTOR_UNITS[name]}" for component in components)


STRAIGHT = 0.999  # -, cosine, 2.6 degrees: contacts over a facet are square to it, those of its edges lean
LEDGER_FIELDS = (*SUMMED_FIELDS, *MEAN_FIELDS, *(field for name in VECTOR_UNITS for field in vector_columns(name)))
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
    "wall_force",
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
    sliding_velocity: (n, 3) m/s, in the surface at the contact point, spin included
    sliding_speed: (n,) m/s, its magnitude
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
        sliding_velocity=sliding,
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
    columns: Mapping[str, np.ndarray],
    corners: np.ndarray,
    kernels: Iterable[str] = (),
    frames: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Return the ledger that the solver has summed: the columns that `LedgerBuilder.table` returns.

    columns: {name: (n,)}, as `postproc.readers.load_ledger.LoadLedger.columns`; contact points are barycentric
        there, contact_weight_1 ... 3 in the order of the corners, and vectors in the frame of each facet
    corners: (n, 3, 3) m, corners of the facets as the solver got them (`postproc.mesh.stl_corners`), in the frame
        where positions and vectors are wanted
    kernels: labels of the sums of contact kernels that are wanted
    frames: (n, 3, 3) of the facets (`facet_frames`), where they are known

    Raises KeyError when a column is missing, ValueError for an unknown kernel.
    """
    weights = np.column_stack([columns[f"contact_weight_{k}"] for k in (1, 2, 3)])
    found = {**columns, **_by_axis(POSITION_FIELDS, np.einsum("ik,ikj->ij", weights, corners))}
    frames = facet_frames(corners) if frames is None else frames
    for name in VECTOR_UNITS:
        parts = np.column_stack([columns[part] for part in vector_columns(name, ("along", "across", "normal"))])
        found |= _by_axis(vector_columns(name), np.einsum("ik,ikj->ij", parts, frames))
    return {name: found[name] for name in (*LEDGER_FIELDS, *map(kernel_column, kernels))}


def pressed_sides(columns: Mapping[str, np.ndarray], normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how much particles pressed on the front and on the back of each facet, two (m,) arrays >= 0 in N s.

    columns: of a ledger, with impulse and back_impulse
    normals: (m, 3) unit normals of the facets in the ledger's frame; the front is where they point

    The normal impulse of contacts whose particle lies straight behind the facet, and of all others, into the facet; a
    side that was pulled rather than pressed has 0. Raises KeyError when a column is missing.
    """
    whole, behind = (
        np.einsum("ij,ij->i", np.column_stack([columns[field] for field in vector_columns(name)]), normals)
        for name in ("impulse", "back_impulse")
    )
    return np.maximum(behind - whole, 0.0), np.maximum(behind, 0.0)


def _by_axis(names: Iterable[str], vectors: np.ndarray) -> dict[str, np.ndarray]:
    return {name: vectors[:, axis] for axis, name in enumerate(names)}


class LedgerBuilder:
    """Sums the loads of sampled contacts per triangle.

    n_triangles: triangles of the mesh
    mesh_index: which mesh of the wall fix this ledger is for (0-based); contacts on other meshes are ignored
    effective_modulus: E* of particle and wall as simulated, Pa
    density: of the particles as simulated, kg/m3
    touching: ids of the particles that touch the mesh in the sample before the first one (carry it from the
        previous cycle's builder, so that a lasting contact is no new impact); None: unknown, so nothing in
        the first sample counts as an impact
    kernels: {label as in kernels.py: {parameter: value}} of sums of contact kernels, one column each
    corners: (n_triangles, 3, 3) m, of the facets as they stand in the mesh's file; kernels need them, and without them
        the table lacks the columns back_impulse and moment
    wall_angular_velocity: (3,) rad/s, of a mesh that rotates, in the simulation's frame
    pose: time step -> (rotation (3, 3), translation (3,) m) of a mesh that moves, x_space = rotation @ x_file +
        translation, for the steps of the samples; None: at rest where its file has it
    periods: (3,) m, lengths of the simulation's box in its periodic directions, 0 in others; needed, with corners,
        where contacts reach the mesh across a periodic boundary

    Raises ValueError for an unknown kernel, for parameters that are not its own, and for kernels or periods without the
    corners of every triangle.
    """

    def __init__(
        self,
        n_triangles: int,
        mesh_index: int,
        effective_modulus: float,
        density: float,
        touching=None,
        kernels: Mapping[str, Mapping[str, float]] = MappingProxyType({}),
        corners=None,
        wall_angular_velocity=(0.0, 0.0, 0.0),
        pose: Pose | None = None,
        periods=(0.0, 0.0, 0.0),
    ):
        self.n_triangles, self.mesh_index = n_triangles, mesh_index
        self.effective_modulus, self.density = effective_modulus, density
        self.wall_angular_velocity = wall_angular_velocity
        self._kernels = {
            kernel_column(label): kernel_value(kernel_of(label), given) for label, given in kernels.items()
        }
        self._of_impacts = {kernel_column(label) for label in kernels if is_per_impact(kernel_of(label))}
        self._pose, self._periods = pose, np.asarray(periods, np.float64)
        self._corners = None if corners is None else np.asarray(corners, np.float64)
        found = None if corners is None else self._corners.shape
        if found != (n_triangles, 3, 3) and (kernels or self._periods.any() or found is not None):
            raise ValueError(f"corners of the facets have the shape {found}, allowed is {(n_triangles, 3, 3)}.")
        if corners is not None:
            self._centroids, self._normals = self._corners.mean(axis=1), facet_frames(self._corners)[:, 2]
        self._touching = None if touching is None else np.unique(np.asarray(touching, np.int64))
        self._samples, self._time_s = 0, 0.0
        without = () if corners is not None else (*vector_columns("back_impulse"), *vector_columns("moment"))
        self._fields = [name for name in (*LEDGER_FIELDS, *self._kernels) if name not in without]
        weighted = [f"{kind}_{what}" for kind in "wf" for what in "axyz"]
        summed = [name for name in self._fields if name not in MEAN_FIELDS]
        self._sums = {name: np.zeros(n_triangles) for name in (*summed, *weighted)}
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
        self._account(batch, batch.steps, np.diff(batch.starts), interval_s)

    def table(self) -> dict[str, np.ndarray]:
        """The ledger: one (n_triangles,) array per field of LEDGER_FIELDS and per kernel, units in the names.

        Without the corners of the facets it lacks the columns back_impulse and moment.

        Contact radius and position are means weighted with the sliding work (with the normal impulse on
        triangles loaded without any sliding), NaN on triangles that were not loaded.
        """
        self._flush()
        sums, means = self._sums, {}
        slid = sums["sliding_work_J"] > 0.0
        weight = np.where(slid, sums["sliding_work_J"], sums["normal_impulse_N_s"])
        for letter, name in zip("axyz", MEAN_FIELDS, strict=True):
            moment = np.where(slid, sums[f"w_{letter}"], sums[f"f_{letter}"])
            means[name] = np.divide(moment, weight, out=np.full(weight.size, np.nan), where=weight > 0.0)
        return {name: means[name] if name in means else sums[name].copy() for name in self._fields}

    def _flush(self) -> None:
        if not self._buffer:
            return
        parts, self._buffer, self._buffered = self._buffer, [], 0
        joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _ARRAYS}
        counts = np.array([len(part.triangle) for part in parts])
        steps = np.array([part.step for part in parts])
        self._account(SimpleNamespace(**joined), steps, counts, self._interval_s)

    def _account(self, contacts, steps: np.ndarray, counts: np.ndarray, interval_s: float) -> None:
        """Adds samples, taken at the time steps `steps`, that hold counts[k] contacts each."""
        sample = np.repeat(np.arange(counts.size), counts)
        force = step_forces(contacts, sample)
        mine = np.asarray(contacts.mesh) == self.mesh_index
        if not mine.all():
            contacts = SimpleNamespace(**{name: getattr(contacts, name)[mine] for name in _ARRAYS})
            sample, force = sample[mine], force[mine]
        triangle = contacts.triangle
        if triangle.size and not 0 <= triangle.min() <= triangle.max() < self.n_triangles:
            raise ValueError(
                f"mesh {self.mesh_index}: found triangles {triangle.min()} ... {triangle.max()}, "
                f"allowed are 0 ... {self.n_triangles - 1}."
            )
        motion = contact_kinematics(contacts, self.wall_angular_velocity)
        frame = MeshFrame.at(self._pose, steps, sample)
        point = frame.body_points(contacts.contact_point)
        if self._corners is not None:
            point = frame.images_near(point, self._centroids[triangle], self._periods)
        pairs = touches(sample, contacts.particle, motion)
        self._loads(contacts, motion, force, interval_s)
        self._means(contacts, motion, pairs, point, interval_s)
        self._vectors(contacts, motion, force, frame, point, interval_s)
        self._impacts(contacts, motion, pairs, counts.size, frame)
        self._samples += counts.size
        self._time_s += counts.size * interval_s

    def _loads(self, contacts, motion, force: np.ndarray, interval_s: float) -> None:
        """Adds what is a scalar of each contact; force: (n, 3) N, on the particle in the time step."""
        triangle = contacts.triangle
        self._sum("sliding_work_J", triangle, motion.normal_force * motion.sliding_speed * interval_s)
        self._sum("normal_impulse_N_s", triangle, motion.normal_force * interval_s)
        self._sum("rolling_work_J", triangle, motion.normal_force * motion.rolling_speed * interval_s)
        self._sum("contact_time_s", triangle, np.full(triangle.size, interval_s))
        # the sliding velocity lies in the surface, so only the tangential part of the force counts
        friction = -np.einsum("ij,ij->i", force, motion.sliding_velocity)
        self._sum("tangential_work_J", triangle, friction * interval_s)
        drive = np.einsum("ij,ij->i", force, contacts.wall_velocity)
        self._sum("drive_work_J", triangle, drive * interval_s)

    def _means(self, contacts, motion, pairs, point: np.ndarray, interval_s: float) -> None:
        """Adds Hertz radius and place of each contact, weighted with sliding work and with normal impulse."""
        pair_force = pairs.force[pairs.of_contact]
        contact_radius = hertz_contact_radius(pair_force, contacts.radius, self.effective_modulus)
        work = motion.normal_force * motion.sliding_speed * interval_s
        for kind, weight in (("w", work), ("f", motion.normal_force * interval_s)):
            self._sum(f"{kind}_a", contacts.triangle, weight * contact_radius)
            for axis, letter in enumerate("xyz"):
                self._sum(f"{kind}_{letter}", contacts.triangle, weight * point[:, axis])

    def _vectors(self, contacts, motion, force, frame: MeshFrame, point: np.ndarray, interval_s: float) -> None:
        """Adds impulses and moments on the mesh, in its own frame, and the kernels that are summed over time."""
        triangle = contacts.triangle
        impulse = frame.in_body(-interval_s * force)
        self._sum_vectors("impulse", triangle, impulse)
        if self._corners is None:
            return
        back = np.einsum("ij,ij->i", self._normals[triangle], frame.in_body(motion.normal)) < -STRAIGHT
        self._sum_vectors("back_impulse", triangle[back], impulse[back])
        self._sum_vectors("moment", triangle, np.cross(point - self._centroids[triangle], impulse))
        self._sum_kernels(self._kernels.keys() - self._of_impacts, contacts, motion, frame, interval_s)

    def _sum_kernels(self, names, contacts, motion, frame: MeshFrame, weight: float) -> None:
        """Adds the values of the kernels of some columns, each times the weight."""
        if names:
            normals = frame.in_space(self._normals[contacts.triangle])
            for name in names:
                self._sum(name, contacts.triangle, self._kernels[name](contacts, motion, normals) * weight)

    def _sum_vectors(self, name: str, triangle: np.ndarray, vectors: np.ndarray) -> None:
        if triangle.size:
            for axis, column in enumerate(vector_columns(name)):
                self._sum(column, triangle, vectors[:, axis])

    def _sum(self, name: str, triangle: np.ndarray, values: np.ndarray) -> None:
        self._sums[name] += np.bincount(triangle, weights=values, minlength=self.n_triangles)

    def _impacts(self, contacts, motion, pairs, n_samples: int, frame: MeshFrame) -> None:
        """Energy brought by particles that touch now and did not in the sample before, and what kernels make of it.

        An estimate from one sample: m v_n^2/2 plus the elastic energy stored by then, exact for an elastic
        contact at whatever moment it is sampled; contacts shorter than the interval can be missed altogether.
        Attributed to the triangle with the particle's largest normal force. Kernels see the speed of that energy.
        """
        if n_samples == 0:
            return
        known = self._touching
        earlier = np.empty(0, np.int64) if known is None else known
        begins = episode_begins(pairs.sample, pairs.particle, earlier)
        self._touching = pairs.particle[pairs.sample == n_samples - 1]
        if known is None:
            begins &= pairs.sample > 0
        at = pairs.strongest[begins]
        radius, force = contacts.radius[at], pairs.force[begins]
        mass = 4.0 / 3.0 * np.pi * radius**3 * self.density
        energy = 0.5 * mass * motion.approach_speed[at] ** 2
        energy += hertz_elastic_energy(force, radius, self.effective_modulus)
        self._sum("impact_energy_J", contacts.triangle[at], energy)
        if not self._of_impacts:
            return
        of_impacts = SimpleNamespace(**{name: getattr(contacts, name)[at] for name in _ARRAYS})
        moving = {name: values[at] for name, values in vars(motion).items()}
        moving |= {"mass": mass, "approach_speed": np.sqrt(2.0 * energy / mass)}
        self._sum_kernels(self._of_impacts, of_impacts, SimpleNamespace(**moving), frame.of(at), 1.0)
