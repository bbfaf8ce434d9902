"""A project with everything of its own: study, design, material, template with a word, wear law, case, rules."""

from __future__ import annotations

from pathlib import Path

from bulkwear.workflows.engine.project import PACKAGE

STUDY, SECOND = "mine", "second"
WORD = "what the dimples do"
FEW = """\
packings: 1
fidelities:
  quick:
    particle_scale: 4
    sample: {width_mm: 40, length_mm: 40, element_size_mm: 2}
    bed: {width_mm: 60, ahead_mm: 20, behind_mm: 20, material: my_ore}
    sliding: {run_in_mm: 10, travel_mm: 20, cycles: 2}
    solver: {rayleigh_fraction: 0.4}
"""
FILES = {
    "config/studies/mine.yaml": f"""\
title: A dimpled sample
question: Does it wear?
case: dimpled
design: mine.csv
surfaces: [plain]
wear: {{law: hardened, parameters: {{hardening: 3}}}}
deck: {{remark: {WORD}}}
{FEW}""",
    "config/studies/second.yaml": f"""\
title: A plain sample and one with bumps
question: Does it wear?
design: mine.csv
surfaces: [convex, plain]
deck: {{remark: nothing}}
{FEW}""",
    "config/designs/mine.csv": """\
row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm
A,8,2,20,6.0,1.0,40
""",
    "config/materials.yaml": """\
particles:
  my_ore:
    density_kg_per_m3: 3300
    poissons_ratio: 0.24
    shear_modulus_pa: 0.07e9
    bulk_solid_fraction: 0.59
    median_diameter_mm: 2.65
    size_distribution: {relative_diameter: [0.8, 1.2], mass_fraction: [0.5, 0.5]}
    contact: {restitution: 0.45, sliding_friction: 0.21, rolling_friction: 0.40}
""",
    "config/cases/dimpled.yaml": "dimples: {radius_mm: 8, depth_mm: 0.05}\n",
    "laws/hardened.py": '''\
"""Archard's law on a surface that hardens."""

from bulkwear.postproc.wear.laws import Law, Parameter, archard


def volume(columns, parameters):
    """Return Archard's volume (m3) over the hardening (-)."""
    return archard(columns, parameters) / parameters["hardening"]


LAW = Law(
    volume,
    "volume = Archard's with the coefficient {wear_coefficient_per_pa} 1/Pa, over {hardening}.",
    "measured by ourselves",
    parameters=(Parameter("hardening", "hardness of the worn over the new surface", 1.0, 10.0, unit="-"),),
)
''',
    "cases/dimpled/settings.schema.yaml": """\
$schema: https://json-schema.org/draft/2020-12/schema
title: Settings of a dimpled sample
type: object
additionalProperties: false
required: [dimples]
properties:
  dimples:
    type: object
    additionalProperties: false
    required: [radius_mm, depth_mm]
    properties:
      radius_mm: {type: number, minimum: 1, maximum: 50, x-unit: mm, description: of the dimple in the middle}
      depth_mm: {type: number, minimum: 0, maximum: 0.25, x-unit: mm, description: of the dimple}
""",
    "cases/dimpled/case.py": '''\
"""A sliding sample with a dimple."""

from dataclasses import replace

import numpy as np

from bulkwear.workflows.cases.sliding_sample.case import SlidingSample
from bulkwear.workflows.engine.case import register


class DimpledSample(SlidingSample):
    """A plain sample with a round dimple in its middle."""

    name = "dimpled"
    geometry = (*SlidingSample.geometry, "dimples")

    def run_parameters(self, settings, materials, factors, surface):
        """Return the parameters of a run, those of the dimple included."""
        return {**super().run_parameters(settings, materials, factors, surface), "dimples": settings["dimples"]}

    def surface_mesh(self, geometry):
        """Return the plain sample with the dimple pressed into it."""
        plain, dimple = super().surface_mesh(geometry), geometry["dimples"]
        within = 1.0 - (plain.points[:, :2] ** 2).sum(axis=1) / dimple["radius_m"] ** 2
        depth = dimple["depth_m"] * np.clip(within, 0.0, None)
        return replace(plain, points=plain.points - depth[:, None] * (0.0, 0.0, 1.0))


register(DimpledSample())
''',
    "Snakefile": """\
module bulkwear:
    snakefile:
        "{package}/Snakefile"
    config:
        config

use rule * from bulkwear as bw_*

onstart:
    bulkwear.onstart()

rule all:
    default_target: True
    input:
        "results/ranking.txt",

rule ranking:
    input:
        summary="results/mine/summary.csv",
        figure="results/mine/figures/wear_against_travel.png",
        forecast="results/mine/forecast.csv",
    output:
        "results/ranking.txt",
    shell:
        "cut -d, -f1 {input.summary} | tail -n +2 >{output}"
""",
}
TEMPLATE = "templates/sliding_sample/sliding_sample.in.j2"  # of the package, of which the project has its own


def own_project(folder: Path, package: Path = PACKAGE) -> Path:
    """Write the project into a folder and return it."""
    for name, text in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text.replace("{package}", str(package)), encoding="utf-8")
    template = folder / TEMPLATE
    template.parent.mkdir(parents=True)
    template.write_text((PACKAGE / TEMPLATE).read_text() + 'print "{{ remark }}"\n')
    return folder
