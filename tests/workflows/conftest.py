"""A copy of the repository's configuration that a test may spoil."""

from __future__ import annotations

from pathlib import Path

import pytest

from bulkwear.workflows.engine.project import Project
from tests import REPOSITORY


class ConfigCopy:
    """A root with a copy of config/; `edit` replaces text that must stand in the file exactly once.

    project: that root as a project which nothing of the package's configuration stands behind
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.project = Project(root, package=root)

    def path(self, name: str) -> Path:
        return self.root / "config" / name

    def edit(self, name: str, old: str, new: str) -> None:
        text = self.path(name).read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {name}"
        self.path(name).write_text(text.replace(old, new), encoding="utf-8")

    def write(self, name: str, text: str) -> None:
        self.path(name).write_text(text, encoding="utf-8")


STUDY = """\
title: A small study
question: Does it load?
design: small.csv
surfaces: [convex, plain]
bed: {ahead_mm: 150}
fidelities:
  quick:
    particle_scale: 2.0
    sample: {width_mm: 80, length_mm: 90, element_size_mm: 1.5}
    bed:
      width_mm: 120
  standard:
"""
DESIGN = """\
row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm
R9,8,2,20,6.0,1.0,40
R5,4,8,60,6.0,2.0,30
"""
DEFAULT = """\
fidelity: quick
particle_scale: 1.0
wear:
  law: archard
  wear_coefficient_per_pa: 6.3e-13
  acceleration: 1.0
  deform: true
  largest_step_edge_fraction: 0.1
  scheme: conserving
  patch: simulated
  patch_radius_mm: 1.0
solver:
  ranks: 1
  rayleigh_fraction: 0.2
  contact_model: hertz
  cohesion: none
  rolling_friction: cdt
  rolling_radius: full
  sampling_interval_steps: 20
  search: ours
  kept_restarts: few
ledger: solver
remeshing: {smallest_angle_deg: 15, largest_aspect: 10, smallest_edge: 0.3, largest_edge: 2.5}
packings: 1
"""
SLIDING_SAMPLE = """\
sample:
  width_mm: 200
  length_mm: 200
  element_size_mm: 1.0
  height_above_floor_mm: 0.3
  skirt_slope_deg: 3.0
  skirt_radius_mm: 0
  material: steel
pattern: {major_axis: along_travel, row_spacing_mm: 40, row_spacing_between: neighbouring_rows, row_offset_fraction: .5}
bed:
  material: river_gravel
  floor_material: perspex
  width_mm: 300
  ends: walls
  ahead_mm: 200
  behind_mm: 300
  exchange_mm: 30
  least_layers: 0
  allow_thin_bed: false
  seed: 20220317
  shape: sphere
  rolling_friction_factor: 1.0
sliding: {run_in_mm: 300, travel_mm: 1000, cycles: 4, first_cycle_mm: 10}
wear: {gap_closing_fraction: 0.01}
solver: {picture_interval_mm: 20, wear_interval_mm: 10, checkpoint_interval_steps: 50000}
"""
MATERIALS = """\
particles:
  river_gravel:
    density_kg_per_m3: 2460
    poissons_ratio: 0.24
    shear_modulus_pa: 0.07e9
    bulk_solid_fraction: 0.59
    median_diameter_mm: 2.65
    size_distribution:
      relative_diameter: [0.8, 1.0, 1.2]
      mass_fraction: [0.25, 0.50, 0.25]
    contact: {restitution: 0.45, sliding_friction: 0.21, rolling_friction: 0.40}
walls:
  steel:
    density_kg_per_m3: 7932
    poissons_ratio: 0.3
    shear_modulus_pa: 78.0e9
    contact: {restitution: 0.6, sliding_friction: 0.38, rolling_friction: 0.3}
  perspex:
    density_kg_per_m3: 1200
    poissons_ratio: 0.49
    shear_modulus_pa: 0.1e9
    contact: {restitution: 0.4, sliding_friction: 0.36, rolling_friction: 0.36}
"""


def _small_config(root: Path) -> ConfigCopy:
    """Write a complete small configuration of its own, so that tests do not follow the shipped settings."""
    copy = ConfigCopy(root)
    for folder in ("cases", "studies", "designs"):
        copy.path(folder).mkdir(parents=True)
    for name, text in (
        ("default.yaml", DEFAULT),
        ("cases/sliding_sample.yaml", SLIDING_SAMPLE),
        ("materials.yaml", MATERIALS),
        ("studies/small.yaml", STUDY),
        ("designs/small.csv", DESIGN),
    ):
        copy.write(name, text)
    return copy


@pytest.fixture
def config(tmp_path: Path) -> ConfigCopy:
    """A small configuration that the test may spoil."""
    return _small_config(tmp_path)


@pytest.fixture(scope="module")
def config_of_file(tmp_path_factory) -> ConfigCopy:
    """A small configuration that all tests of a file share, and none spoils."""
    return _small_config(tmp_path_factory.mktemp("config"))


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the repository."""
    return REPOSITORY
