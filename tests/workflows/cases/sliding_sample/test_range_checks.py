"""What lies in its range and makes no bed, no mesh or no wear of a sliding sample is refused at the start."""

import math
import re

import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sliding_sample
from bulkwear.workflows.cases.sliding_sample.range_checks import LEAST_SKIRT, MESHED_STEEPNESS
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.engine.project import Project

STUDY = """\
title: Mine
question: Does it wear?
design: mine.csv
surfaces: [convex, plain]
packings: 1
particle_scale: {scale}
sample: {{width_mm: {side}, length_mm: {side}, element_size_mm: 1.5, {sample}}}
bed: {{width_mm: {width}, material: {ore}, allow_thin_bed: true, {bed}}}
sliding: {{run_in_mm: 0, {sliding}}}
wear: {{{wear}}}
"""
DESIGN = """\
row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm
A,8,2,20,{height},1.0,{thickness}
"""
GIVEN = {
    **{"scale": 2.5, "sample": "skirt_radius_mm: 0", "width": 80, "bed": "ahead_mm: 60, behind_mm: 40", "wear": ""},
    **{"sliding": "travel_mm: 60, cycles: 3", "height": 6, "thickness": 40, "ore": "river_gravel", "side": 60},
}
SLICK = """\
particles:
  coarse:
    {density_kg_per_m3: 2460, poissons_ratio: 0.24, shear_modulus_pa: 0.07e9, bulk_solid_fraction: 0.59,
     median_diameter_mm: 20, size_distribution: {relative_diameter: [0.8, 1.2], mass_fraction: [0.5, 0.5]},
     contact: {restitution: 0.45, sliding_friction: 0.21, rolling_friction: 0.4}}
walls:
  slick:
    {density_kg_per_m3: 7932, poissons_ratio: 0.3, shear_modulus_pa: 78.0e9,
     contact: {restitution: 0.6, sliding_friction: 0, rolling_friction: 0.3}}
"""
WELL = ""  # what is said of what can be simulated
COARSE = {"ore": "coarse", "scale": 3, "width": 160, "thickness": 185, "height": 2, "side": 24}
ROUNDED = 0.001  # mm, more than what a sentence leaves out of a length


@pytest.fixture
def said(tmp_path):
    """A function: what is said of a study of one's own, without what follows; WELL where nothing is wrong."""
    for folder in ("studies", "designs"):
        (tmp_path / "config" / folder).mkdir(parents=True)

    def of(**changes):
        given = GIVEN | changes
        (tmp_path / "config/studies/mine.yaml").write_text(STUDY.format(**given), encoding="utf-8")
        (tmp_path / "config/designs/mine.csv").write_text(DESIGN.format(**given), encoding="utf-8")
        (tmp_path / "config/materials.yaml").write_text(SLICK, encoding="utf-8")
        try:
            study = load_study("mine", project=Project(tmp_path))
        except ConfigError as fault:
            return str(fault)
        assert all(study.beds.values())
        return WELL

    return of


def named(sentence, bound):
    """The number that a sentence names after a bound."""
    return float(re.search(rf"allowed (?:is|are) {bound} (\S+)", sentence)[1])


# ---------------------------------------------------------------- beds


def test_a_bed_thinner_than_half_a_particle_is_refused_though_thin_ones_are_allowed(said):
    """It would hold one particle, or none; the thickness that is named is enough."""
    thin = {"scale": 12, "height": 0.6}
    assert said(**thin, thickness=1).endswith(
        "line 2, row A: bed_thickness_mm is 1, allowed is at least 15.9 mm, 0.5 layers of particles (particle_scale"
        " 12), where thin beds are allowed too."
    )
    assert said(**thin, thickness=15.9) == WELL


@pytest.mark.parametrize(("ends", "ahead_mm"), [("walls", 8), ("periodic", 22)])
def test_a_bed_shorter_than_two_particles_is_refused(said, ends, ahead_mm):
    """Particles hang between its ends, or find no room, which ended in a root of a negative number; the length that is
    named is one.
    """

    def short(ahead):
        bed = f"ends: {ends}, ahead_mm: {ahead}, behind_mm: 8"
        return said(**COARSE, bed=bed, sliding="travel_mm: 24, cycles: 1")

    sentence = short(ahead_mm)
    assert "bed.ahead_mm" in sentence and "longer than two of the largest particles, 144 mm" in sentence
    assert short(named(sentence, "above") + ROUNDED) == WELL


def test_a_periodic_bed_has_a_floor_that_drives_it(said):
    """Without friction there is no length that helps: one beyond what is allowed was named."""
    bed = "ends: periodic, ahead_mm: 60, behind_mm: 40, floor_material: slick"
    for sample in ("material: steel", "material: slick"):
        assert (
            "bed.floor_material is 'slick' for row A, allowed is a wall with more sliding friction than 0 with"
            " bed.ends: periodic, where the floor drives the bed, or bed.ends: walls."
        ) in said(bed=bed, sample=sample)
    assert said(bed=bed.replace("periodic", "walls")) == WELL


# ---------------------------------------------------------------- meshes


def test_a_bump_too_steep_for_a_mesh_is_refused(said):
    """Meshes of steeper ones ended in an IndexError; the height that is named can be meshed."""
    sentence = said(height=30)
    assert "line 2, row A: bump too high for a mesh: 30 mm, allowed is at most 24 mm, 12 times the smaller" in sentence
    assert said(height=named(sentence, "at most")) == WELL
    lattice = {"row_spacing": 20e-3, "column_spacing": 20e-3}
    for radius in (1e-3, 5e-3):
        pattern = ConvexPattern(radius, radius, MESHED_STEEPNESS * radius, **lattice)
        assert pattern.shell(radius)


def test_a_skirt_too_narrow_for_triangles_is_refused(said):
    """It ended in a fault of the mesh; the height that is named can be meshed."""
    slope = "skirt_slope_deg: 45, height_above_floor_mm: {}"
    sentence = said(sample=slope.format(0.1))
    assert "sample.height_above_floor_mm is 0.1 for row A, allowed is at least 0.1625 mm, so that a skirt" in sentence
    least = named(sentence, "at least")
    assert said(sample=slope.format(least)) == WELL
    element = 1.5e-3
    assert sliding_sample(0.06, 0.06, element, None, 1e-3 * least, math.pi / 4).triangles.size
    with pytest.raises(ValueError, match="a gap between pattern, rim and skirt is too narrow"):
        sliding_sample(0.06, 0.06, element, None, 1e-3 * least * 0.8, math.pi / 4)
    assert LEAST_SKIRT * element == pytest.approx(1.2e-3 * least)


# ---------------------------------------------------------------- wear


def test_wear_beyond_what_updates_can_take_is_refused(said):
    """A coefficient in mm3/(N m) that is taken for one in 1/Pa; the one that is named passes."""
    sentence = said(wear="wear_coefficient_per_pa: 1.0e-6")
    assert (
        "line 2, row A: the bed's weight alone would wear 0.00341718 mm or more off the sample, allowed are 0.0005886"
        " mm, what 3 updates can take: a wear coefficient, with its acceleration, of "
    ) in sentence
    most = float(re.search(r"of (\S+) 1/Pa at most \(found 1e-06\)", sentence)[1])
    assert said(wear=f"wear_coefficient_per_pa: {most}") == WELL
    assert said(wear="wear_coefficient_per_pa: 1.0e-6, deform: false") == WELL


def test_wear_down_to_the_floor_is_refused(said):
    """Also where cycles are as long as wear lets them be; such a run stopped on its way."""
    sentence = said(wear="acceleration: 1.0e+9", sliding="travel_mm: 60, cycles: adaptive")
    assert "the sample's height above the floor: a wear coefficient, with its" in sentence


def test_the_longest_test_duration_that_is_named_is_allowed(said):
    """100 m at 1 m/s are 0.02777... h."""
    sliding = "test_duration_h: {}, cycles: 3"
    most = named(said(sliding=sliding.format(10)), "at most")
    assert said(sliding=sliding.format(most)) == WELL
