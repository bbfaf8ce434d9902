"""The load ledger against closed forms and its invariances."""

from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.postproc.wear.ledger import (
    LEDGER_FIELDS,
    MEAN_FIELDS,
    POSITION_FIELDS,
    SUMMED_FIELDS,
    VECTOR_UNITS,
    LedgerBuilder,
    columns_of_solver,
    hertz_contact_radius,
    hertz_elastic_energy,
    vector_columns,
)
from bulkwear.postproc.wear.mesh_frame import facet_frames
from tests.support.law_cases import long_slip_registered

ROUND_OFF = 1e-12  # sums of up to a few thousand float64 terms
CANCELLATION = 1e-15  # of F_n L: what equal and opposite velocities of order one leave in float64
EFFECTIVE_MODULUS, DENSITY, RADIUS = 2e8, 2500.0, 0.0015
MASS = 4.0 / 3.0 * np.pi * RADIUS**3 * DENSITY
ADDITIVE = [name for name in LEDGER_FIELDS if name not in MEAN_FIELDS]
SCALARS = (*SUMMED_FIELDS, "contact_radius_m")
VECTORS = [POSITION_FIELDS, *map(vector_columns, VECTOR_UNITS)]
FACET = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # m, at z = 0, its normal upwards
CORNERS = np.tile(FACET, (12, 1, 1)) + np.arange(12.0)[:, None, None] * [0.1, 0.0, 0.0]


def sample(n=1, **given):
    """n contacts on a wall at z = 0 that is at rest, 2 N upwards, without overlap, particles at rest."""
    centre = np.column_stack([np.arange(n) * 0.01, np.zeros(n), np.full(n, RADIUS)])
    arrays = {
        "step": 0,
        "triangle": np.arange(n),
        "mesh": np.zeros(n, np.int64),
        "particle": np.arange(n) + 1,
        "contact_point": centre * [1.0, 1.0, 0.0],
        "centre": centre,
        "wall_velocity": np.zeros((n, 3)),
        "particle_velocity": np.zeros((n, 3)),
        "angular_velocity": np.zeros((n, 3)),
        "force": np.tile([0.0, 0.0, 2.0], (n, 1)),
        "radius": np.full(n, RADIUS),
        "wall_force": np.full((n, 3), np.nan),
    }
    assert set(given) <= set(arrays)
    return SimpleNamespace(**{**arrays, **{name: np.asarray(value) for name, value in given.items()}})


def random_samples(seed=7, samples=40, triangles=12, straight=0.4):
    """Samples of a tumbling crowd: 0 to 9 contacts, several triangles per particle, some of them pulling.

    straight: -, share of contacts over or behind their facet, square to it; others are beside it
    """
    random = np.random.default_rng(seed)
    result = []
    for step in range(samples):
        n = random.integers(0, 10)
        normal = random.normal(size=(n, 3))
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        triangle, sign = random.integers(0, triangles, n), random.choice([-1.0, 1.0], (n, 1))
        square = random.random((n, 1)) < straight
        normal = np.where(square, sign * facet_frames(CORNERS)[triangle, 2], normal)
        centre, overlap = random.normal(size=(n, 3)), random.uniform(0.0, 0.02, (n, 1)) * RADIUS
        vectors = {name: random.normal(size=(n, 3)) for name in ("wall_velocity", "particle_velocity", "force")}
        contacts = sample(
            n,
            triangle=triangle,
            particle=random.integers(1, 6, n),
            centre=centre,
            contact_point=centre - (RADIUS - overlap) * normal,
            angular_velocity=random.normal(0.0, 300.0, (n, 3)),
            **vectors,
        )
        contacts.step = step
        result.append(contacts)
    return result


def batch_of(samples):
    """The same samples in one piece, as the reader hands them over."""
    names = [name for name in vars(samples[0]) if name != "step"]
    arrays = {name: np.concatenate([getattr(one, name) for one in samples]) for name in names}
    starts = np.cumsum([0] + [len(one.triangle) for one in samples])
    return SimpleNamespace(steps=np.array([one.step for one in samples]), starts=starts, **arrays)


def ledger(samples, interval_s=1e-3, triangles=12, **options):
    settings = {"mesh_index": 0, "effective_modulus": EFFECTIVE_MODULUS, "density": DENSITY, "corners": CORNERS}
    settings |= options
    builder = LedgerBuilder(triangles, **settings)
    for contacts in samples:
        builder.add(contacts, interval_s)
    return builder.table()


def assert_same(one, other, fields=LEDGER_FIELDS):
    for name in fields:
        scale = np.nanmax(np.abs(other[name]), initial=0.0)
        np.testing.assert_allclose(one[name], other[name], rtol=ROUND_OFF, atol=ROUND_OFF * scale, err_msg=name)


def test_pure_sliding_does_the_work_of_force_times_distance():
    """W = F_n L: 2 N over 100 samples of 1 ms at 0.3 m/s."""
    table = ledger([sample(particle_velocity=[[0.3, 0.0, 0.0]])] * 100)
    assert table["sliding_work_J"][0] == pytest.approx(2.0 * 0.3 * 0.1, rel=ROUND_OFF)
    assert table["normal_impulse_N_s"][0] == pytest.approx(2.0 * 0.1, rel=ROUND_OFF)
    assert table["contact_time_s"][0] == pytest.approx(0.1, rel=ROUND_OFF)
    assert table["rolling_work_J"][0] == 0.0


def test_a_moving_wall_under_a_resting_particle_slides_as_well():
    """Only the relative velocity counts."""
    moving = ledger([sample(wall_velocity=[[-0.3, 0.0, 0.0]])])
    assert_same(moving, ledger([sample(particle_velocity=[[0.3, 0.0, 0.0]])]))


def test_rolling_without_slip_slides_nothing_and_rolls_force_times_distance():
    """omega = n x v / R: no sliding work, rolling work F_n L."""
    table = ledger([sample(particle_velocity=[[0.3, 0.0, 0.0]], angular_velocity=[[0.0, 0.3 / RADIUS, 0.0]])] * 100)
    assert table["sliding_work_J"][0] <= CANCELLATION * 2.0 * 0.3 * 0.1
    assert table["rolling_work_J"][0] == pytest.approx(2.0 * 0.3 * 0.1, rel=ROUND_OFF)


def test_the_lever_arm_is_the_radius_less_half_the_overlap():
    """Rolling about R - delta/2 slides nothing; the sign of the spin matters."""
    overlap = 0.1 * RADIUS
    spin = 0.3 / (RADIUS - overlap / 2)
    touching = {"contact_point": [[0.0, 0.0, overlap]], "particle_velocity": [[0.3, 0.0, 0.0]]}
    forward = ledger([sample(**touching, angular_velocity=[[0.0, spin, 0.0]])])
    backward = ledger([sample(**touching, angular_velocity=[[0.0, -spin, 0.0]])])
    assert forward["sliding_work_J"][0] <= CANCELLATION * 2.0 * 0.3e-3
    assert backward["sliding_work_J"][0] == pytest.approx(2.0 * 0.6e-3, rel=ROUND_OFF)


def test_torsion_about_the_normal_neither_slides_nor_rolls():
    """omega parallel to n turns the contact on the spot."""
    table = ledger([sample(angular_velocity=[[0.0, 0.0, 500.0]])])
    assert table["sliding_work_J"][0] == 0.0
    assert table["rolling_work_J"][0] == 0.0
    assert table["normal_impulse_N_s"][0] > 0.0


def test_approach_along_the_normal_is_no_sliding():
    """v_t is v_rel without its normal part, on a wall that leans too."""
    normal = np.array([0.6, 0.0, 0.8])
    leaning = sample(centre=[RADIUS * normal], force=[2.0 * normal], particle_velocity=[[0.0, 0.3, 0.0] - 0.7 * normal])
    assert ledger([leaning])["sliding_work_J"][0] == pytest.approx(2.0 * 0.3e-3, rel=ROUND_OFF)


def test_a_pulling_contact_counts_as_zero_force():
    """Tensile normal forces come from damping; the contact still lasts."""
    table = ledger([sample(force=[[0.5, 0.0, -2.0]], particle_velocity=[[0.3, 0.0, 0.0]])], touching=[1])
    for name in ("sliding_work_J", "normal_impulse_N_s", "rolling_work_J"):
        assert table[name][0] == 0.0
    assert table["contact_time_s"][0] == 1e-3
    assert np.isnan(table["contact_radius_m"][0])


def test_friction_adds_nothing_to_the_normal_force():
    """F_n = F . n, whatever the tangential force."""
    rubbing = sample(force=[[7.0, -3.0, 2.0]], particle_velocity=[[0.3, 0.0, 0.0]])
    plain = sample(particle_velocity=[[0.3, 0.0, 0.0]])
    assert_same(ledger([rubbing]), ledger([plain]), (*SUMMED_FIELDS[:5], *MEAN_FIELDS))


def test_triangles_never_touched_have_zero_sums_and_no_mean():
    """NaN is the mean of nothing."""
    table = ledger([sample()])
    assert all(table[name][5] == 0.0 for name in ADDITIVE)
    assert all(np.isnan(table[name][5]) for name in MEAN_FIELDS)


def test_contacts_on_other_meshes_are_left_out():
    """A second mesh among the contacts changes nothing, impacts included."""
    crowd = random_samples()
    mixed = []
    for contacts in crowd:
        foreign = SimpleNamespace(**{**vars(contacts), "mesh": np.ones_like(contacts.mesh)})
        pieces = {name: np.concatenate([getattr(one, name) for one in (foreign, contacts)]) for name in
                  vars(contacts) if name != "step"}  # fmt: skip
        mixed.append(SimpleNamespace(step=contacts.step, **pieces))
    assert_same(ledger(mixed), ledger(crowd))


def test_an_unknown_triangle_is_refused():
    """A triangle id the mesh does not have means the solver changed the mesh."""
    with pytest.raises(ValueError, match=r"mesh 0: found triangles 12 \.\.\. 12, allowed are 0 \.\.\. 11"):
        ledger([sample(triangle=[12])])


def rotated(contacts, rotation):
    names = ("contact_point", "centre", "wall_velocity", "particle_velocity", "angular_velocity", "force")
    return SimpleNamespace(**{**vars(contacts), **{name: getattr(contacts, name) @ rotation.T for name in names}})


def turn(seed):
    """A rotation about no particular axis."""
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return rotation * np.sign(np.linalg.det(rotation))


def vector(table, names):
    """Three columns as vectors."""
    return np.column_stack([table[name] for name in names])


def test_rotating_the_world_changes_no_scalar_and_turns_the_vectors():
    """Rotation invariance, of samples and facets together."""
    rotation, crowd = turn(3), random_samples()
    plain = ledger(crowd)
    turned = ledger([rotated(contacts, rotation) for contacts in crowd], corners=CORNERS @ rotation.T)
    assert_same(turned, plain, SCALARS)
    for names in VECTORS:
        expected = vector(plain, names) @ rotation.T
        np.testing.assert_allclose(vector(turned, names), expected, rtol=0, atol=1e-11)  # of order one, F . n


def test_changing_the_units_changes_only_the_units():
    """Unit neutrality: lengths x 1000, masses x 50, times x 0.2."""
    length, mass, time = 1000.0, 50.0, 0.2
    force, energy = mass * length / time**2, mass * length**2 / time**2
    factors = {
        **dict.fromkeys(("contact_point", "centre", "radius"), length),
        **dict.fromkeys(("wall_velocity", "particle_velocity"), length / time),
        "angular_velocity": 1.0 / time,
        "force": force,
    }
    crowd = random_samples()
    scaled = [
        SimpleNamespace(**{**vars(one), **{name: getattr(one, name) * factor for name, factor in factors.items()}})
        for one in crowd
    ]
    table = ledger(
        scaled,
        1e-3 * time,
        effective_modulus=EFFECTIVE_MODULUS * force / length**2,
        density=DENSITY * mass / length**3,
        corners=CORNERS * length,
    )
    units = {"J": energy, "N_s": force * time, "N_m_s": force * length * time, "s": time, "m": length}
    plain = ledger(crowd)
    unit_of = {name: next(unit for unit in units if name.endswith(f"_{unit}")) for name in LEDGER_FIELDS}
    unit_of |= dict.fromkeys(vector_columns("moment"), "N_m_s")
    assert_same(table, {name: plain[name] * units[unit_of[name]] for name in LEDGER_FIELDS})


def test_relabelling_the_triangles_permutes_the_ledger():
    """Face-order invariance."""
    relabel = np.random.default_rng(5).permutation(12)
    crowd = random_samples()
    renamed = [SimpleNamespace(**{**vars(one), "triangle": relabel[one.triangle]}) for one in crowd]
    table, plain = ledger(renamed, corners=CORNERS[np.argsort(relabel)]), ledger(crowd)
    assert_same({name: table[name][relabel] for name in LEDGER_FIELDS}, plain)


def test_the_order_of_contacts_within_a_sample_does_not_matter():
    """A sample is a set."""
    crowd = random_samples()
    reverse = [
        SimpleNamespace(step=one.step, **{name: value[::-1] for name, value in vars(one).items() if name != "step"})
        for one in crowd
    ]
    assert_same(ledger(reverse), ledger(crowd))


def test_two_cycles_add_up_to_one():
    """Sums are additive, and contacts that outlast a cycle's end are no new impacts."""
    crowd = random_samples()
    whole = ledger(crowd, touching=[])
    first, options = LedgerBuilder(12, 0, EFFECTIVE_MODULUS, DENSITY, touching=[], corners=CORNERS), {}
    for contacts in crowd[:17]:
        first.add(contacts, 1e-3)
    options["touching"] = first.touching
    second = ledger(crowd[17:], **options)
    assert_same({name: first.table()[name] + second[name] for name in ADDITIVE}, whole, ADDITIVE)
    forgetful = ledger(crowd[17:], touching=[])
    assert forgetful["impact_energy_J"].sum() > second["impact_energy_J"].sum()


def test_batches_give_the_same_ledger_as_single_samples():
    """add_batch is only faster."""
    crowd = random_samples()
    builder = LedgerBuilder(12, 0, EFFECTIVE_MODULUS, DENSITY, corners=CORNERS)
    for first in range(0, len(crowd), 16):
        builder.add_batch(batch_of(crowd[first : first + 16]), 1e-3)
    assert builder.samples == len(crowd)
    assert builder.time_s == pytest.approx(len(crowd) * 1e-3, rel=ROUND_OFF)
    assert_same(builder.table(), ledger(crowd))


def test_each_sample_counts_with_its_own_interval():
    """Sum of F_n v dt with dt changing between samples."""
    builder = LedgerBuilder(12, 0, EFFECTIVE_MODULUS, DENSITY)
    for interval_s in (1e-3, 4e-3, 4e-3, 2e-3):
        builder.add(sample(particle_velocity=[[0.3, 0.0, 0.0]]), interval_s)
    assert builder.table()["sliding_work_J"][0] == pytest.approx(2.0 * 0.3 * 11e-3, rel=ROUND_OFF)


def test_contact_radius_is_hertz_of_the_force_on_one_triangle():
    """a^3 = 3 F R / (4 E*) (Hertz 1882)."""
    table = ledger([sample(particle_velocity=[[0.3, 0.0, 0.0]])])
    assert table["contact_radius_m"][0] ** 3 == pytest.approx(
        3.0 * 2.0 * RADIUS / (4.0 * EFFECTIVE_MODULUS), rel=ROUND_OFF
    )


def test_two_triangles_under_one_particle_share_its_total_force():
    """Two halves of a load make the contact circle of the whole load; another particle keeps its own."""
    halves = sample(
        3,
        particle=[1, 1, 2],
        force=[[0.0, 0.0, 0.8], [0.0, 0.0, 1.2], [0.0, 0.0, 1.0]],
        contact_point=np.zeros((3, 3)),
        centre=np.tile([0.0, 0.0, RADIUS], (3, 1)),
        particle_velocity=[[0.3, 0.0, 0.0]] * 3,
    )
    table = ledger([halves])
    expected = hertz_contact_radius(np.array([2.0, 2.0, 1.0]), RADIUS, EFFECTIVE_MODULUS)
    np.testing.assert_allclose(table["contact_radius_m"][:3], expected, rtol=ROUND_OFF)
    assert table["sliding_work_J"][:2] == pytest.approx([0.8 * 0.3e-3, 1.2 * 0.3e-3], rel=ROUND_OFF)


def test_means_are_weighted_with_the_sliding_work():
    """3 parts of work at x = 1 and 1 part at x = 5 lie at x = 2; a resting contact has no vote."""
    places = [
        sample(contact_point=[[x, 0, 0]], centre=[[x, 0, RADIUS]], particle_velocity=[[v, 0, 0]])
        for x, v in ((1.0, 0.3), (5.0, 0.1), (9.0, 0.0))
    ]
    assert ledger(places)["contact_position_x_m"][0] == pytest.approx(2.0, rel=ROUND_OFF)


def test_without_sliding_the_means_are_weighted_with_the_impulse():
    """A triangle that is only rolled on has a position too."""
    places = [
        sample(contact_point=[[x, 0, 0]], centre=[[x, 0, RADIUS]], force=[[0, 0, f]])
        for x, f in ((1.0, 3.0), (5.0, 1.0))
    ]
    assert ledger(places)["contact_position_x_m"][0] == pytest.approx(2.0, rel=ROUND_OFF)


@pytest.mark.parametrize("fraction", [0.0, 0.3, 0.9, 1.0])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_bounce_brings_its_kinetic_energy_whenever_it_is_sampled(fraction, sign):
    """Elastic Hertz bounce: m v^2/2 + 2/5 F delta = m v0^2/2, coming or going, slide and spin left out."""
    speed = 0.7
    energy = 0.5 * MASS * speed**2
    stiffness = 4.0 / 3.0 * EFFECTIVE_MODULUS * np.sqrt(RADIUS)
    overlap = fraction * (energy / (0.4 * stiffness)) ** 0.4
    rest = np.sqrt(max(speed**2 - 2.0 * 0.4 * stiffness * overlap**2.5 / MASS, 0.0))
    contact = sample(
        centre=[[0.0, 0.0, RADIUS - overlap]],
        force=[[1.0, 0.0, stiffness * overlap**1.5]],
        particle_velocity=[[0.4, 0.2, sign * rest]],
        angular_velocity=[[10.0, 20.0, 30.0]],
    )
    table = ledger([contact, contact, contact], touching=[])
    assert table["impact_energy_J"][0] == pytest.approx(energy, rel=ROUND_OFF)


def test_stored_energy_is_the_integral_of_the_hertz_force():
    """2/5 F delta = integral of 4/3 E* sqrt(R) x^1.5 dx."""
    overlap = 1e-5
    stiffness = 4.0 / 3.0 * EFFECTIVE_MODULUS * np.sqrt(RADIUS)
    stored = hertz_elastic_energy(stiffness * overlap**1.5, RADIUS, EFFECTIVE_MODULUS)
    assert stored == pytest.approx(stiffness * overlap**2.5 / 2.5, rel=ROUND_OFF)


@pytest.mark.parametrize("pose", [None, lambda step: (np.eye(3), np.zeros(3))])
def test_kernels_of_impacts_count_each_episode_once(pose):
    """Its speed is that of the impact energy E, with the threshold 0 it is E, else m (sqrt(2 E / m) - K)^2 / 2."""
    crowd, threshold = random_samples(), 0.4  # m/s
    free, held = (
        ledger(crowd, kernels={"impact_above_threshold": {"threshold_velocity_m_per_s": given}}, touching=[], pose=pose)
        for given in (0.0, threshold)
    )
    assert free["impact_energy_J"].any()
    np.testing.assert_allclose(free["impact_above_threshold_J"], free["impact_energy_J"], rtol=ROUND_OFF)
    assert 0.0 < held["impact_above_threshold_J"].sum() < free["impact_energy_J"].sum()
    hit, mass = (
        sample(particle_velocity=[[0.1, 0.0, -0.7]], force=[[0, 0, 0.0]]),
        4.0 / 3.0 * np.pi * RADIUS**3 * DENSITY,
    )
    once = ledger(
        [hit, hit], kernels={"impact_above_threshold": {"threshold_velocity_m_per_s": threshold}}, touching=[]
    )
    assert once["impact_above_threshold_J"][0] == pytest.approx(0.5 * mass * (0.7 - threshold) ** 2, rel=ROUND_OFF)


def test_crossing_to_the_next_triangle_is_no_impact():
    """One episode per particle and mesh: only the first touch counts, on the triangle that carries most."""
    falling = {"particle_velocity": [[0.0, 0.0, -0.7]], "force": [[0.0, 0.0, 0.0]]}
    table = ledger([sample(triangle=[k], **falling) for k in (3, 4, 5)], touching=[])
    assert np.flatnonzero(table["impact_energy_J"]).tolist() == [3]
    shared = sample(2, particle=[1, 1], force=[[0, 0, 1.0], [0, 0, 1.5]], centre=[[0, 0, RADIUS]] * 2,
                    contact_point=np.zeros((2, 3)))  # fmt: skip
    assert np.flatnonzero(ledger([shared], touching=[])["impact_energy_J"]).tolist() == [1]


def test_a_particle_that_left_hits_again():
    """A sample without the particle ends its episode, also when that sample is empty."""
    falling = sample(particle_velocity=[[0.0, 0.0, -0.7]], force=[[0.0, 0.0, 0.0]])
    once = 0.5 * MASS * 0.7**2
    for gap, impacts in (([sample(0)], 2), ([falling], 1)):
        table = ledger([falling, *gap, falling], touching=[])
        assert table["impact_energy_J"][0] == pytest.approx(impacts * once, rel=ROUND_OFF)


def test_contacts_of_unknown_past_are_no_impacts():
    """Without a sample before the first one, only touches that begin later count."""
    crowd = [sample(2), sample(3)]
    table = ledger(crowd)
    assert np.flatnonzero(table["impact_energy_J"]).tolist() == [2]


def test_on_a_turning_wall_only_the_difference_of_spins_rolls():
    """A particle that turns with the wall does not roll; held still on it, it rolls R times the wall's spin."""
    spin = [0.0, 40.0, 0.0]
    carried = ledger([sample(angular_velocity=[spin])], wall_angular_velocity=spin)
    held = ledger([sample()], wall_angular_velocity=spin)
    assert carried["rolling_work_J"][0] == 0.0
    assert held["rolling_work_J"][0] == pytest.approx(2.0 * RADIUS * 40.0 * 1e-3, rel=ROUND_OFF)


def test_the_wall_spin_changes_the_rolling_only():
    """The wall's velocity at the contact point holds its rotation already; torsion of the wall rolls nothing."""
    crowd = random_samples()
    plain, turning = ledger(crowd), ledger(crowd, wall_angular_velocity=[3.0, -2.0, 1.0])
    assert_same(turning, plain, [name for name in LEDGER_FIELDS if name != "rolling_work_J"])
    about_normal = ledger([sample()], wall_angular_velocity=[0.0, 0.0, 9.0])
    assert about_normal["rolling_work_J"][0] == 0.0


def test_kernels_add_their_sum_and_change_nothing_else():
    """finnie_work_J = sum of 2 E v F dt per triangle; batches give the same."""
    crowd = random_samples()
    options = {"kernels": {"finnie_work": {}}, "corners": CORNERS}
    table = ledger(crowd, **options)
    assert list(table) == [*LEDGER_FIELDS, "finnie_work_J"]
    assert_same(table, ledger(crowd))
    whole = LedgerBuilder(12, 0, EFFECTIVE_MODULUS, DENSITY, **options)
    whole.add_batch(batch_of(crowd), 1e-3)
    assert_same(whole.table(), table, ["finnie_work_J"])
    falling = sample(particle_velocity=[[0.4, 0.0, -0.3]])  # sin gamma 0.6, cos gamma 0.8: the steep branch
    single = ledger([falling], **options)["finnie_work_J"]
    assert single[0] == pytest.approx(2.0 * 0.33333 * 0.64 * 0.5 * 2.0 * 1e-3, rel=ROUND_OFF)
    assert not single[1:].any()


def test_a_kernel_gets_its_parameters():
    """|v_t| (L / 1 mm)^n dt with n = 2 and L = 3 mm is nine times the slip; the column ends in the kernel's unit."""
    with long_slip_registered():
        given = {"long_slip": {"length_m": 3e-3, "exponent": 2.0}}
        table = ledger([sample(particle_velocity=[[0.4, 0.0, -0.3]])], kernels=given)
    assert table["long_slip_m"][0] == pytest.approx(9.0 * 0.4 * table["contact_time_s"][0], rel=ROUND_OFF)


def solver_columns(weights, frames):
    """Columns of the solver's file for as many triangles as there are weights; its vectors in the facets' frames."""
    count = len(weights)
    columns = {name: np.arange(float(count)) for name in (*SUMMED_FIELDS, "contact_radius_m", "finnie_work_J")}
    columns |= {f"contact_weight_{k + 1}": weights[:, k] for k in range(3)}
    for name, vectors in frames.items():
        parts = vector_columns(name, ("along", "across", "normal"))
        columns |= {part: vectors[:, k] for k, part in enumerate(parts)}
    return columns


def test_columns_of_the_solver_are_those_of_the_samples():
    """Same names in the same order; weights 1, 0, 0 lie on the first corner, thirds on the centroid."""
    corners = np.random.default_rng(2).normal(size=(3, 3, 3))
    weights = np.array([[1.0, 0.0, 0.0], [1 / 3, 1 / 3, 1 / 3], [np.nan] * 3])
    columns = solver_columns(weights, dict.fromkeys(VECTOR_UNITS, np.zeros((3, 3))))
    table = columns_of_solver(columns, corners)
    assert list(table) == list(LEDGER_FIELDS) == list(ledger([sample()]))
    found = vector(table, POSITION_FIELDS)
    np.testing.assert_allclose(found[:2], [corners[0, 0], corners[1].mean(axis=0)], rtol=ROUND_OFF)
    assert np.isnan(found[2]).all()
    assert list(columns_of_solver(columns, corners, ("finnie_work",)))[-1] == "finnie_work_J"
