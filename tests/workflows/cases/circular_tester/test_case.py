"""The circular wear tester: its decks, what is refused before the solver starts, where everything lies."""

import math
import re

import numpy as np
import pytest

from bulkwear.meshes.tester import placed, turn_angles
from bulkwear.postproc.mesh import area_vectors, edge_lengths_per_triangle, enclosed_volume
from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.cases.circular_tester.checks import enough_layers_under
from bulkwear.workflows.cases.circular_tester.work import surface_triangles
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.layers import Layer
from bulkwear.workflows.config.run_checks import CheckedRun
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.chain import Chain, bed_deck_text, deck_text, write_bed
from bulkwear.workflows.engine.schedule import known_spans
from bulkwear.workflows.forecast.forecast import work_of
from tests import DATA
from tests.support.tiny_tester import ROWS, TINY, tiny_tester

GOLDEN = DATA / "golden_circular_tester.in"
ROUND_OFF = 1e-9
# mm, bed height, depth and side of the sample where large particles need more room than those of the study
ROOM = {8.0: (170, 90, 100), 12.0: (220, 100, 50)}
TRIANGLES = 0.12  # relative; the estimate of a sample's triangles, its holder included; seen 0.06


def chain_of(study, run, folder):
    parameters = study.run(run).parameters
    return Chain(run, folder, study.case, parameters, folder / "surface.vtu", study.beds[study.bed_of(run)])


@pytest.mark.parametrize("fidelity", ["quick", "standard", "paper"])
def test_every_deck_of_every_fidelity_renders(fidelity, tmp_path):
    """Bed, run-in and first cycle of every run, with nothing left open; a ring has a trough, a channel has walls."""
    study = load_study("circular_tester", overrides={"fidelity": fidelity})
    texts = {name: bed_deck_text(study.case, bed) for name, bed in study.beds.items()}
    for run in study.runs:
        chain = chain_of(study, run.name, tmp_path)
        for span in (None, known_spans(run.parameters)[0]):
            texts[run.name, span] = deck_text(chain, span)
        ring = run.parameters["tester"]["shape"] == "ring"
        assert ("surface_ang_vel" in texts[run.name, None]) == ring
        assert ("shear y" in texts[run.name, None]) != ring
    for text in texts.values():
        assert not re.search(r"\{\{|\}\}|\{%|%\}|\t|\bNone\b|\bnan\b", text)


def test_golden_deck(tmp_path):
    """The deck of the tiny channel's second cycle, word for word; a change of it is a decision."""
    study = tiny_tester()
    chain = chain_of(study, "convex", tmp_path)
    assert deck_text(chain, known_spans(chain.parameters)[1]) == GOLDEN.read_text()


def test_no_mesh_of_a_run_has_the_fix_id_of_its_bed(tmp_path):
    """Under an id of the restart file the solver would silently take the old mesh: ids differ from deck to deck."""
    study = tiny_tester(tester={"shape": "ring"})
    chain = chain_of(study, "convex", tmp_path)
    spans = known_spans(chain.parameters)[:2]
    texts = [bed_deck_text(chain.case, chain.bed), *(deck_text(chain, span) for span in (None, *spans))]
    ids = [set(re.findall(r"^fix +(\w+) +all mesh/surface", text, re.MULTILINE)) for text in texts]
    assert [len(found) for found in ids] == [3] * 4
    assert len(set().union(*ids)) == 12


def test_one_bed_serves_all_samples():
    """Plain and convex samples and other elements start from one bed, whose block is as high as the highest bump."""
    study = load_study("circular_tester", overrides={"fidelity": "quick", "packings": 1})
    of_scale = {}
    for run in study.runs:
        key = run.parameters["particle"]["scale"], run.parameters["tester"]["shape"]
        of_scale.setdefault(key, set()).add(study.bed_of(run.name))
        headroom = study.beds[study.bed_of(run.name)]["headroom_m"]
        assert headroom >= run.parameters["derived"]["headroom_m"]
    assert all(len(beds) == 1 for beds in of_scale.values())
    assert len(study.beds) == len(of_scale)


@pytest.mark.parametrize("shape", ["channel", "ring"])
def test_everything_lies_in_the_domain(shape):
    """Sample, block, consolidator and trough; the block encloses the sample; the consolidator faces the bed below."""
    study = tiny_tester(tester={"shape": shape})
    bed = study.beds["bed_plain"]
    low, high = np.array(tester_deck.domain(bed)).reshape(3, 2).T
    meshes = {"block": tester_deck.block_mesh(bed), "consolidator": tester_deck.consolidator_mesh(bed)}
    if shape == "ring":
        meshes["trough"] = tester_deck.trough_mesh(bed)
    for mesh in meshes.values():
        assert (mesh.points > low).all() and (mesh.points < high).all()
    plate = meshes["consolidator"]
    assert (area_vectors(plate.points, plate.triangles)[:, 2] < 0.0).all()
    assert plate.points[:, 2].min() == pytest.approx(bed["depth_m"], abs=ROUND_OFF)  # here the level of the bed
    away = np.linalg.norm(plate.points[:, :2] - np.mean(meshes["block"].points[:, :2], axis=0), axis=1)
    assert away.min() > 0.5 * bed["sample_length_m"]
    parameters = study.run("convex").parameters
    sample = study.case.surface_mesh(parameters)
    there = study.case.pieces(parameters, None, sample)[0].mesh
    assert there.points[:, 2].max() < meshes["block"].points[:, 2].max()
    assert np.linalg.norm(there.points.mean(axis=0) - meshes["block"].points.mean(axis=0)) < bed["headroom_m"]


@pytest.mark.parametrize("shape", ["channel", "ring"])
def test_no_particle_passes_beside_the_consolidator(shape):
    """The gap to the walls is 2 mm, below the diameter of any particle; of finer ones it is half the smallest, so that
    the plate of a narrow trough is wider than its sample too.
    """
    bed = tiny_tester(tester={"shape": shape}).beds["bed_plain"]
    fine = [0.0006, 0.0008]
    narrow = bed | {
        "inner_radius_m": 0.0958,
        "outer_radius_m": 0.1042,  # 1.7 mm on either side of a sample of 5 mm: two of the largest particles
        "sample_width_m": 0.005,
        "particle": bed["particle"] | {"diameters_m": fine},
    }
    for asked, gap in ((bed, 0.002), (narrow, 0.0003)):
        x, y, _ = tester_deck.consolidator_mesh(asked).points.T
        mean = tester_deck.mean_radius(asked)
        across = np.abs(x if shape == "channel" else np.hypot(x + mean, y) - mean)
        assert tester_deck.half_width(asked) - across.max() == pytest.approx(gap, abs=ROUND_OFF)
        assert gap < min(asked["particle"]["diameters_m"]) and across.max() > 0.5 * asked["sample_width_m"]


@pytest.mark.parametrize(("width", "length"), [(5, 100), (5, 150), (5, 2000), (2000, 5), (100, 100)])
def test_a_narrow_sample_has_its_block(width, length):
    """The block is as wide and long as the sample, whatever their ratio, and closed."""
    bed = tiny_tester().beds["bed_plain"]
    asked = bed | {"sample_width_m": 1e-3 * width, "sample_length_m": 1e-3 * length, "incline_rad": 0.0}
    block = tester_deck.block_mesh(asked)
    size = block.points.max(axis=0) - block.points.min(axis=0)
    assert size[:2] == pytest.approx([1e-3 * width, 1e-3 * length], rel=ROUND_OFF)
    assert enclosed_volume(block.points, block.triangles) == pytest.approx(np.prod(size), rel=ROUND_OFF)


def test_the_sample_faces_the_flow():
    """Its trailing edge is higher, by its length times the sine of 2 degrees; the ledger comes back to its frame."""
    import pandas as pd

    study = tiny_tester()
    parameters, case = study.run("plain").parameters, study.case
    sample = case.surface_mesh(parameters)
    there = case.pieces(parameters, None, sample)[0].mesh
    top = np.abs(sample.points[:, 2]) < ROUND_OFF
    back, front = (there.points[top][np.isclose(sample.points[top, 1], side)] for side in (0.02, -0.02))
    rise = back[:, 2].mean() - front[:, 2].mean()
    assert rise == pytest.approx(0.04 * math.sin(math.radians(2.0)), rel=ROUND_OFF)
    vectors = ("contact_position_{}_m", "impulse_{}_N_s", "back_impulse_{}_N_s", "moment_{}_N_m_s")
    columns = [name.format(axis) for name in vectors for axis in "xyz"]
    ledger = pd.DataFrame(np.tile(there.points, (1, len(vectors))), columns=columns)
    own = np.tile(sample.points, (1, len(vectors)))
    np.testing.assert_allclose(case.on_surface(parameters, ledger).to_numpy(), own, atol=ROUND_OFF)


def test_a_ring_turns_as_fast_as_a_channel_goes():
    """At the middle of the sample the trough has the same velocity; a revolution takes as long."""
    channel, ring = (tiny_tester(tester={"shape": shape}) for shape in ("channel", "ring"))
    decks = [study.case.bed_deck(study.beds["bed_plain"]) for study in (channel, ring)]
    assert decks[0]["velocity_m_per_s"] == decks[1]["velocity_m_per_s"]
    speed = decks[1]["angular_speed_rad_per_s"]
    assert speed == pytest.approx(math.radians(235.0), rel=ROUND_OFF)
    assert speed * decks[1]["radius_m"] == pytest.approx(decks[1]["velocity_m_per_s"], rel=ROUND_OFF)
    times = [study.run("plain").parameters["derived"] for study in (channel, ring)]
    assert times[0]["revolution_s"] == times[1]["revolution_s"] == pytest.approx(30.0 / 235.0)
    for derived in times:
        assert derived["revolution_steps"] * derived["time_step_s"] == pytest.approx(derived["revolution_s"])
        assert derived["travel_steps"] == 2 * derived["revolution_steps"]


def test_the_trough_is_closed_and_holds_the_bed(tmp_path):
    """Chords are no longer than an element; files are where decks read them."""
    study = tiny_tester(tester={"shape": "ring"})
    mesh = tester_deck.trough_mesh(study.beds["bed_plain"])
    edges = np.sort(edge_lengths_per_triangle(mesh.points, mesh.triangles), axis=1)
    assert edges[:, 1].max() <= tester_deck.TROUGH_ELEMENT * (1.0 + ROUND_OFF)
    write_bed(study.case, study.beds["bed_plain"], tmp_path)
    named = set(re.findall(r"file (\S+\.stl)", (tmp_path / "deck.in").read_text()))
    assert named == {"block.stl", "consolidator.stl", "trough.stl"}
    assert all((tmp_path / name).is_file() for name in named)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"ledger": "dumps"}, "ledger is 'dumps' for row plain, allowed is solver for a circular wear tester"),
        ({"tester": {"outer_radius_mm": 90}}, "tester.outer_radius_mm is 90 for row plain, allowed is above 100 mm"),
        (
            {"sample": {"width_mm": 60}},
            "sample.width_mm is 60 for row plain, allowed is at most 45.12 mm, so that two of",
        ),
        ({"tester": {"channel_deg": 40}}, "tester.channel_deg is 40 for row plain, allowed is at least 54.2 degrees"),
        (
            {"tester": {"depth_mm": 30}},
            "tester.depth_mm is 30 for row plain, allowed is at least 32.498 mm, three layers",
        ),
        (
            {"tester": {"bed_height_mm": 65}},
            "tester.bed_height_mm is 65 for row plain, allowed is at least 65.1356 mm, two",
        ),
        (
            {"tester": {"depth_mm": 33}, "pattern": {"height_mm": 33}},
            "depth_mm is 33 for row convex, allowed is above 34.9491 mm, so that the sample's top is under",
        ),
        (
            {"tester": {"consolidator_level_mm": 37}},
            "consolidator_level_mm is 37 for row plain, allowed is 66.7 mm to 77.3 mm, the bed's height",
        ),
        (
            {"tester": {"consolidator_rise_mm": 6}},
            "consolidator_rise_mm is 6 for row plain, allowed is at least 6.36 mm, the radius of the largest particle",
        ),
        (
            {"particle_scale": 20},
            "tester.outer_radius_mm is 196 for row plain, allowed is at least 394.4 mm, so that two",
        ),
        (
            {"tester": {"bed_height_mm": 80}},
            "consolidator_level_mm is 72 for row plain, allowed is 74.7 mm to 85.3 mm, the bed's height (tester.bed",
        ),
        (
            {"tester": {"consolidator_level_mm": 78}},
            "consolidator_level_mm is 78 for row plain, allowed is 66.7 mm to 77.3 mm, the bed's height (tester.bed",
        ),
        ({"sample": {"element_size_mm": 3}}, "sample.element_size_mm is 3 for row convex, allowed is at most 2 mm"),
        ({"sliding": {"revolutions": 1.3}}, "revolutions is 1.3 for row plain, allowed is a multiple of 1/2"),
        (
            {"sliding": {"cycles_per_revolution": 200}},
            "cycles_per_revolution is 200 for row plain, allowed is at most 37",
        ),
        (
            # 5.17 m/s in 2.51 s of friction 0.21, and half as long again: 251 revolutions of 30 degrees
            {"sliding": {"angular_speed_deg_per_s": 2000}},
            "sliding.steady_revolutions is 4 for row plain, allowed is at least 250.",
        ),
        (
            {"tester": {"consolidator_ramp_mm": 2000}},
            "tester.consolidator_ramp_mm is 2000 for row plain, allowed is at most 414.955 mm, so that a channel of",
        ),
        (
            {"sliding": {"angular_speed_deg_per_s": 0.1, "steady_revolutions": 1000}},
            "sliding.steady_revolutions is 1000 for row plain, allowed is at most 246, 2147483647 time steps",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(changes, sentence, monkeypatch):
    """Key, what was found, row, what is allowed."""
    with pytest.raises(ConfigError) as fault:
        tiny_tester(**changes)
    assert sentence in str(fault.value)


SHORT = {"tester": {"channel_deg": 28, "consolidator_ramp_mm": 10, "consolidator_flat_mm": 5}}
RING = {"shape": "ring"}


@pytest.mark.parametrize(
    ("key", "wrong", "enough", "changes"),
    [
        # its quarter holds two of the largest particles: 8 of 12.72 mm over 148 mm of mean radius
        ("tester.channel_deg", 39.3, 39.4, {"sample": {"width_mm": 20, "length_mm": 20}, **SHORT}),
        # chords of 50 mm lie 0.35 of 6.36 mm inside such a circle
        ("tester.outer_radius_mm", 140, 141, {"particle_scale": 2, "tester": {**RING, "inner_radius_mm": 60}}),
        # ten steps of 3.45e-5 s for a particle of 8.48 mm at 148 mm
        (
            "sliding.angular_speed_deg_per_s",
            9600,
            9400,
            {"sliding": {"revolution_deg": 360, "steady_revolutions": 999}},
        ),
        # 7.07 rad/s: gravity at 196 mm
        ("sliding.angular_speed_deg_per_s", 406, 405, {"tester": RING, "sliding": {"steady_revolutions": 20}}),
        ("wear.patch_radius_mm", 15.1, 15, {"sample": {"width_mm": 40, "length_mm": 30}}),  # half of the shorter side
        # the last one, and a quarter of 56 degrees in ones of 30
        ("sliding.steady_revolutions", 1.46, 1.47, {"sliding": {"angular_speed_deg_per_s": 90}}),
        ("sliding.steady_revolutions", 3.99, 4, {"tester": RING}),
    ],
)
def test_bounds_that_machine_and_particles_set(key, wrong, enough, changes):
    """A little beyond each is refused, in one sentence; the bound that it names is enough."""
    block, _, name = key.partition(".")

    def tester(value):
        return tiny_tester(**{**changes, block: {**changes.get(block, {}), name: value}})

    with pytest.raises(ConfigError, match=rf"{re.escape(key)} is {wrong} for row plain, allowed is at") as fault:
        tester(wrong)
    assert tester(enough).runs
    assert tester(float(re.search(r"allowed is at (?:least|most) ([\d.]+)", str(fault.value))[1])).runs


@pytest.mark.parametrize("incline", [-30, -20, 15, 23, 30])
def test_the_length_that_a_sentence_names_is_enough(incline):
    """Though it is rounded there: bed and consolidator of a tilted sample, as high as they are asked to be."""
    tester = {"incline_deg": incline}
    for key in ("bed_height_mm", "consolidator_level_mm"):
        changes = {"fidelity": "quick", "rows": ["plain"], "packings": 1, "tester": tester}
        try:
            load_study("circular_tester", overrides=changes)
        except ConfigError as fault:
            tester[key] = float(
                re.search(rf"{key} is 150 for row plain, allowed is (?:at least )?([\d.]+)", str(fault))[1]
            )
    assert load_study("circular_tester", overrides=changes).runs and "bed_height_mm" in tester


def test_the_largest_particle_passes_under_the_sample():
    """Two of the largest, under the lower edge of the holder."""
    run = tiny_tester().run("plain")
    parameters = run.parameters | {"particle": run.parameters["particle"] | {"diameters_m": [0.005, 0.02]}}
    key, allowed = enough_layers_under(CheckedRun((), {}, Layer("row", {}), parameters))
    least = 35 + 20 * math.sin(math.radians(2)) + 4 * math.cos(math.radians(2)) + 2 * 20
    assert key == "tester.bed_height_mm"
    assert allowed.startswith(f"at least {least:.6g} mm, and tester.consolidator_level_mm with it, two of the largest ")


def test_particles_are_poured_into_the_trough():
    """Of the smallest ring allowed centres lie within the chords of its outer wall, by less than a radius."""
    tester = {**RING, "inner_radius_mm": 60, "outer_radius_mm": 141}
    bed = tiny_tester(particle_scale=2, tester=tester).beds["bed_plain"]
    chord = math.pi / (len(turn_angles(bed["outer_radius_m"], tester_deck.TROUGH_ELEMENT)) - 1)
    inside = bed["outer_radius_m"] * math.cos(chord) - tester_deck.tester_bed(bed)["outer_fill_radius_m"]
    assert 0.25 - 1e-3 < inside / max(bed["particle"]["diameters_m"]) < 0.5


def test_a_tilt_takes_room_over_and_under_the_sample():
    """By half the sample's length times its sine, up or down alike, and the holder turns with it."""
    coarse = {"fidelity": "quick", "rows": ["plain"], "particle_scale": 3}
    study = load_study("circular_tester", overrides=coarse)
    settings, of = study.settings, study.settings["tester"]
    particle = study.run("plain").parameters["particle"]
    needed = {  # mm, of the bed over and under the sample
        "depth_mm": 3e3 * particle["median_diameter_m"],
        "bed_height_mm": 2e3 * max(particle["diameters_m"]),
    }
    for incline in (30, -30):
        for length, depth, key in ((250, of["depth_mm"], "bed_height_mm"), (200, 30, "depth_mm")):
            rise = 0.5 * length * math.sin(math.radians(30))
            holder = settings["sample"]["thickness_mm"] * math.cos(math.radians(30))
            least = needed[key] + rise + (depth + holder if key == "bed_height_mm" else 0)
            tester = {"incline_deg": incline, "depth_mm": depth, "channel_deg": 150}
            changes = {"sample": {"length_mm": length}, "tester": tester}
            with pytest.raises(
                ConfigError, match=rf"tester\.{key} is .* for row plain, allowed is at least {least:.6g}"
            ):
                load_study("circular_tester", overrides=coarse | changes)


@pytest.mark.parametrize("key", ["ramp", "flat"])
def test_a_ring_has_room_for_its_consolidator(key):
    """With the sample it takes half of the mean circumference, and the chord of its flat is no longer than the inner
    radius; as much is allowed, the plate then stays clear of the sample and bed lies where the level is looked at.
    """
    tester, sample = (tiny_tester(tester={"shape": "ring"}).settings[name] for name in ("tester", "sample"))
    mean = 0.5 * (tester["inner_radius_mm"] + tester["outer_radius_mm"])
    half = math.pi * mean - sample["length_mm"] - tester["consolidator_flat_mm"]
    most = {"ramp": half, "flat": tester["inner_radius_mm"]}[key]
    allowed = {"ramp": f"a length that makes at most {math.pi * mean:.6g} mm", "flat": f"at most {most:.6g} mm"}[key]
    with pytest.raises(ConfigError, match=rf"tester\.consolidator_{key}_mm is .* for row plain, allowed is {allowed}"):
        tiny_tester(tester={"shape": "ring", f"consolidator_{key}_mm": 1.01 * most})
    bed = next(iter(tiny_tester(tester={"shape": "ring", f"consolidator_{key}_mm": 0.99 * most}).beds.values()))
    x, y, _ = tester_deck.consolidator_mesh(bed).points.T
    from_sample = np.abs(np.arctan2(y, x + 1e-3 * mean)).min() * 1e-3 * mean
    assert from_sample > 0.5e-3 * sample["length_mm"]
    assert tester_deck.past_consolidator(bed)[3] > -bed["inner_radius_m"]


def test_a_ring_has_less_room_for_corners():
    """The outer corners of a sample are farther out than its side."""
    with pytest.raises(ConfigError, match=r"sample.width_mm is 40 .* allowed is at most 37"):
        tiny_tester(tester={"shape": "ring", "outer_radius_mm": 191})


def test_a_design_needs_a_pair_of_one_particle_scale_or_one_row():
    """Without a plain and a convex row of series volume nothing sets the scale of time; one row is told by itself."""
    case = find_case("circular_tester")
    rows = [{"row": "a", "series": "volume", "surface": "convex"}, {"row": "b", "series": "mesh", "surface": "plain"}]
    assert case.design_fault(rows) is None and case.design_fault(rows[:1]) is None
    assert "series volume has no row" in case.design_fault(rows[1:])
    assert "has convex and convex" in case.design_fault([rows[0], rows[0]])
    rows[1]["series"] = "volume"
    assert case.design_fault(rows) is None
    rows[0]["height_mm"] = 4.0  # of the pattern's
    assert case.design_fault(rows) is None
    rows[1]["tester.depth_mm"] = 80.0
    assert "rows of series volume differ in tester.depth_mm, allowed are" in case.design_fault(rows)
    rows[0] |= {"tester.depth_mm": 80.0}
    rows[1]["particle_scale"] = 4
    assert "differ in particle_scale, allowed are row, surface and pattern" in case.design_fault(rows)


def test_rows_of_a_design_have_one_seed():
    """With seeds of their own, packings of one number would be different beds."""
    case = find_case("circular_tester")
    rows = [{"row": name, "series": "volume", "surface": name, "seed": 20220317} for name in ROWS]
    assert case.design_fault(rows) is None
    rows.append({"row": "fine", "series": "mesh", "surface": "plain"})
    assert "seed is 20220317, none, allowed is one for all rows" in case.design_fault(rows)


@pytest.mark.parametrize("scale", [2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0])
@pytest.mark.parametrize("shape", ["channel", "ring"])
def test_the_poured_mass_is_that_of_a_level_bed(shape, scale):
    """Whatever shape and particles: bulk density times the trough's volume less the block's; and the room it is poured
    into, off walls and block, holds it at the fraction that can be placed.
    """
    height, depth, side = ROOM.get(scale, (150, 90, 100))
    tester = {"shape": shape, "bed_height_mm": height, "consolidator_level_mm": height, "depth_mm": depth}
    room = {"tester": tester, "sample": {"width_mm": side, "length_mm": side}}
    study = load_study("circular_tester", overrides={"fidelity": "quick", "particle_scale": scale, **room})
    bed = study.beds["bed_plain"]
    width, middle, turned = 0.21, 0.395, math.radians(66.0) if shape == "channel" else 2.0 * math.pi
    block = (1e-3 * side) ** 2 * (0.01 + bed["headroom_m"])
    poured, particle = study.case.bed_deck(bed), bed["particle"]
    level = 0.59 * 2460.0 * (width * middle * turned * 1e-3 * height - block)
    assert poured["poured_mass_kg"] == pytest.approx(1.02 * level, rel=ROUND_OFF)
    gap = 0.6 * max(particle["diameters_m"])
    low, high = np.array(poured["block_m"]).reshape(3, 2).T
    assert low[2] > poured["fill_m"][4] - 2.0 * gap and high[2] < poured["fill_m"][5]  # the block lies within
    length = middle * turned - (2.0 * gap if shape == "channel" else 0.0)
    room = (width - 2.0 * gap) * length * (poured["fill_m"][5] - poured["fill_m"][4]) - np.prod(high - low)
    assert poured["poured_mass_kg"] == pytest.approx(0.34 * particle["density_kg_per_m3"] * room, rel=ROUND_OFF)


def test_work_is_that_of_beds_and_runs():
    """Runs wait for their bed; steps are those of the decks; triangles are about those of the mesh."""
    study = tiny_tester()
    work = work_of(study)
    assert [job.name for job in work] == ["settled_bed_bed_plain", "worn_run_plain", "worn_run_convex"]
    assert {job.needs for job in work[1:]} == {"settled_bed_bed_plain"}
    derived = study.run("plain").parameters["derived"]
    assert sum(stage.steps for stage in work[1].stages) == derived["run_in_steps"] + derived["travel_steps"]
    for run in ROWS:
        parameters = study.run(run).parameters
        mesh = study.case.surface_mesh(parameters)
        assert surface_triangles(parameters) == pytest.approx(len(mesh.triangles), rel=TRIANGLES)
    assert placed(mesh, np.eye(3), np.zeros(3)).points == pytest.approx(mesh.points)
    assert TINY["sample"]["width_mm"] == 40


WAYS = {  # out of a refusal: the setting, and the bound that a sentence names
    "particle_scale": r"particle_scale of at most ([\d.]+\d)",
    "tester.depth_mm": r"tester\.depth_mm of at most ([\d.]+) mm",
    "tester.inner_radius_mm": r"tester\.inner_radius_mm of at most ([\d.]+) mm",
    "tester.incline_deg": r"tester\.incline_deg of \S+ to ([\d.]+\d)",
}


@pytest.mark.parametrize(
    ("given", "refused", "ways"),
    [
        ({"particle_scale": 8}, "tester.bed_height_mm", ["particle_scale", "tester.depth_mm"]),
        ({"particle_scale": 10}, "sample.width_mm", ["particle_scale"]),
        ({"tester": {"inner_radius_mm": 400}}, "sample.width_mm", ["tester.inner_radius_mm"]),
        # a plate 7 mm over the bed is more than half of a smaller particle over it
        ({"tester": {"depth_mm": 110, "consolidator_level_mm": 157}}, "tester.bed_height_mm", ["tester.depth_mm"]),
        ({"particle_scale": 9, "tester": {"shape": "ring"}}, "sample.width_mm", ["particle_scale"]),
        (
            {"tester": {"incline_deg": 15}},
            "tester.bed_height_mm",
            ["particle_scale", "tester.depth_mm", "tester.incline_deg"],
        ),
        (
            {"tester": {"incline_deg": -18}},
            "tester.bed_height_mm",
            ["particle_scale", "tester.depth_mm", "tester.incline_deg"],
        ),
        ({"tester": {"depth_mm": 110}}, "tester.bed_height_mm", ["particle_scale", "tester.depth_mm"]),
        ({"tester": {"depth_mm": 40}}, "tester.depth_mm", ["particle_scale"]),
    ],
)
def test_a_refusal_names_what_made_it_and_a_bound_that_is_allowed(given, refused, ways):
    """Scale, depth or tilt may be at fault as well as the length that does not suffice; each bound is enough."""
    with pytest.raises(ConfigError, match=f"{refused} is ") as fault:
        load_study("circular_tester", overrides=given)
    found = {key: re.search(words, str(fault.value)) for key, words in WAYS.items()}
    assert [key for key, bound in found.items() if bound] == ways
    for key in ways:
        *block, name = key.split(".")
        bound = {name: float(found[key][1])}
        way = {"tester": given.get("tester", {}) | bound} if block else bound
        assert load_study("circular_tester", overrides=given | way).runs


def test_a_bed_that_has_to_be_higher_takes_the_consolidator_with_it():
    """Both are in one refusal, and are allowed together."""
    with pytest.raises(ConfigError, match=r"at least \S+ mm, and tester.consolidator_level_mm with it, two") as fault:
        load_study("circular_tester", overrides={"particle_scale": 6, "tester": {"depth_mm": 110}})
    least = float(re.search(r"at least (\S+) mm", str(fault.value))[1])
    tester = {"depth_mm": 110, "bed_height_mm": least, "consolidator_level_mm": least}
    assert load_study("circular_tester", overrides={"particle_scale": 6, "tester": tester}).runs


def test_radii_out_of_order_are_told_where_they_were_given():
    """An inner radius of the command line is at fault, not the outer one of the defaults."""
    with pytest.raises(ConfigError) as fault:
        load_study("circular_tester", overrides={"tester": {"inner_radius_mm": 600}})
    assert str(fault.value) == (
        "command line: tester.inner_radius_mm is 600 for row plain, allowed is below 500 mm, tester.outer_radius_mm."
    )


@pytest.mark.parametrize(
    ("wear", "said"),
    [
        (
            {"acceleration": 1e9, "largest_step_edge_fraction": 0.5, "gap_closing_fraction": 0.5},
            r"off the sample, allowed are 4 mm, sample\.thickness_mm: a wear coefficient",
        ),
        ({"largest_step_edge_fraction": 1e-6}, r"allowed are \S+ mm, what 4 updates can take: a wear coefficient"),
        ({"local_thickness_mm": 10}, r"wear\.local_thickness_mm is 10 for .*, allowed is at most 4 mm, sample\.thick"),
    ],
)
def test_wear_that_no_sample_takes(wear, said):
    """More than its thickness, more than its updates, and a thickness that it does not have."""
    with pytest.raises(ConfigError, match=said):
        tiny_tester(wear=wear)
