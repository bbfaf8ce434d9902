"""Figures of studies of particle size without wear: packings, and single collisions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.sliding_sample.particle_size import figure_findings
from bulkwear.workflows.cases.sliding_sample.particle_size.figures import PUBLISHED_PACKING, size_figure
from bulkwear.workflows.cases.sliding_sample.particle_size.study import (
    bed_floors,
    below,
    of_template,
    plain_parameters,
    settled_beds,
)
from bulkwear.workflows.cases.sliding_sample.study import plain_runs, varies_scale
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.report.products import Job

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study


def _shaken(study: Study) -> dict[str, Any]:
    """Return what the figure of the containers says of them."""
    packing = to_si(study.settings)["packing"]
    return {key: packing[key] for key in ("width_diameters", "axis", "shaking_s")}


@size_figure(
    "Packing of a container",
    finding=figure_findings.packing,
    inputs={"profiles": "results/{study}/packings/profiles.csv", "published": PUBLISHED_PACKING},
    told={"packing": _shaken},
    caption="""
    Contacts of a particle with others and porosity by slabs, each four median diameters high, of a container that is
    filled (loose) and shaken by A sin(w t), and the difference. Porosity cuts particles at the slabs' edges; dotted,
    by the source's rule, a particle counts whole where its centre is. Grey: what the source's text gives for its
    scales 1 to 8. The counterpart of Yan 2022, Fig 4.3 and 4.4, in a narrower container.
    """,
)
def packing_profiles(job: Job) -> Any:
    """Draw how the particles of a container per particle scale are packed."""
    import pandas as pd

    from bulkwear.postproc.flow.packing import slabs_remark
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots import contacts

    table, packing = pd.read_csv(job.files.profiles), job.told.packing
    published = pd.read_csv(job.files.published).query("case == 'container'")
    sides = f"container of {packing['width_diameters']:g} median diameters to a side"
    remarks = [sides, f"shaken along {packing['axis']} for {packing['shaking_s']:g} s", slabs_remark(table)]
    return contacts.packing_profiles(table, published, remarks), table


@size_figure(
    "Packing of the bed",
    finding=figure_findings.packing,
    inputs={
        "wear": lambda study: [f"results/{study.name}/{run}/wear.csv" for run in plain_runs(study)],
        "beds": settled_beds,
        "published": PUBLISHED_PACKING,
    },
    told={
        "runs": plain_parameters,
        "floors": bed_floors,
        "folder": below("beds"),
        "template": of_template("bed_contacts"),
    },
    when=lambda study: varies_scale(study) and bool(plain_runs(study)),
    caption="""
    Contacts per particle and porosity in the lower three quarters of the bed, settled before the plain sample and at
    rest behind it: packings small, their means with 95 % intervals large. Porosity cuts particles at the slab's edges;
    dotted, they count whole at their centre. Triangles: the source's. The counterpart of Yan 2022, Fig 4.9 and 4.10.
    """,
)
def bed_packing(job: Job) -> Any:
    """Count contacts in the beds of plain runs before and after the sample passed; draw them by particle scale."""
    import pandas as pd

    from bulkwear.workflows.cases.sliding_sample.particle_size.packings import bed_packing_table
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots import contacts

    told = job.told
    folders = {run: Path(path).parent for run, path in zip(told.runs, job.files.wear, strict=True)}
    beds = dict(zip(told.runs, zip(map(Path, job.files.beds), told.floors, strict=True), strict=True))
    table = bed_packing_table(told.runs, folders, beds, Path(told.folder))
    published = pd.read_csv(job.files.published).query("case == 'bed'")
    return contacts.bed_packing(table, published, job.remarks), table


def _collision_tests(study: Study) -> list[dict[str, Any]]:
    from bulkwear.workflows.cases.sliding_sample.particle_size.collision import collision_tests

    return collision_tests({run.name: run.parameters for run in study.runs})


@size_figure(
    "Single collisions",
    finding=figure_findings.collisions,
    inputs={},
    told={"tests": _collision_tests, "folder": below("collisions"), "template": of_template("collision")},
    tables={"measures": "particle_size/collisions.csv"},
    digits={"table": 6},
    caption="""
    Two spheres, and a sphere and the sample, that collide head-on at 1 m/s, and two that collide obliquely with spin,
    without gravity, at every particle scale: in units of radius, modulus and density. Marks of all scales lie on one
    curve, which is what coarse graining asks of a contact (Yan 2022, Eq 4.1 to 4.7); head-on it is that of Hertz with
    viscoelastic damping. Gravity at a given velocity does not scale: a bed's own weight is in balance with the same
    relative overlap, a falling particle is not.
    """,
)
def collisions(job: Job) -> Any:
    """Simulate single collisions at every particle scale; draw them in units of their size."""
    from bulkwear.workflows.cases.sliding_sample.particle_size import collision
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots import contacts

    histories, measures = collision.collision_tables(job.told.tests, Path(job.told.folder))
    largest = collision.spread_over_scales(measures)["spread"].max()
    closed = collision.closed_forms(job.told.tests[0])
    remarks = [f"largest difference between scales {100.0 * largest:.1g} %"]
    return contacts.collisions(histories, closed, remarks), histories, {"measures": measures}
