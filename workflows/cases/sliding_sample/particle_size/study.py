"""What the figures and the page of a study of particle size are told of its configuration."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.sliding_sample.study import BUMPS, plain_runs, published_levels, row_levels
from bulkwear.workflows.config.patterns import pattern_of
from bulkwear.workflows.engine.case import Parameters
from bulkwear.workflows.engine.templates import templates_digest
from bulkwear.workflows.report.products import OfStudy

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study


PUBLISHED_RUN = "R5"  # whose pattern the source's study of particle size has (Yan 2022, section 4.5)


def of_template(name: str) -> OfStudy:
    """Return what a product that runs a deck is told of its template: another text makes it again."""
    return lambda study: templates_digest(name)


def below(folder: str) -> OfStudy:
    """Return what a product is told of the folder in which it simulates."""
    return lambda study: f"results/{study.name}/particle_size/{folder}"


def by_scale(runs: Mapping[str, Parameters]) -> dict[float, Parameters]:
    """Return the parameters of the first run of every particle scale, smallest first."""
    found: dict[float, Parameters] = {}
    for run in runs.values():
        found.setdefault(run["particle"]["scale"], run)
    return dict(sorted(found.items()))


def packed_runs(study: Study) -> dict[str, Parameters]:
    """Return the runs whose particles are packed in containers: those chosen, or those of the whole design."""
    runs = study.all_runs if study.settings["packing"]["every_scale"] else study.runs
    return {run.name: run.parameters for run in runs}


def plain_parameters(study: Study) -> dict[str, Parameters]:
    """Return the parameters of the plain runs, whose beds are looked at, by name."""
    return {name: run.parameters for name, run in plain_runs(study).items()}


def settled_beds(study: Study) -> list[str]:
    """Return the restart file of the settled bed of every plain run."""
    return [f"results/{study.name}/beds/{study.bed_of(name)}/bed.restart" for name in plain_runs(study)]


def bed_floors(study: Study) -> list[float]:
    """Return the height (m) of the floor of the settled bed of every plain run."""
    return [study.beds[study.bed_of(name)]["temporary_floor_m"] for name in plain_runs(study)]


def bumps_and_particles(study: Study) -> dict[str, dict[str, Any]]:
    """Return by setting pattern, real particles and scale of its runs with bumps, see `guidance`."""
    return {
        study.setting_of[run.row]: _bumps_and_particles(run.parameters)
        for run in study.runs
        if run.parameters["derived"]["equivalent_size_ratio"] is not None
    }


def has_published_pattern(study: Study) -> bool:
    """Return whether the samples with bumps of all rows have those that the source's lines are of, run R5's, as far
    apart and shifted as there.
    """
    theirs, patterns = (
        published_levels(BUMPS)[PUBLISHED_RUN],
        (row_levels(study, row, BUMPS) for row in study.design_rows),
    )
    return bool(bumps_and_particles(study)) and all(each == theirs for each in patterns)


def _bumps_and_particles(parameters: Parameters) -> dict[str, Any]:
    pattern, particle = pattern_of(parameters["pattern"]), parameters["particle"]
    return {
        "pattern": {
            **dict(zip(("major_radius", "minor_radius", "height"), pattern.bump_axes, strict=True)),
            "gap": pattern.column_spacing - 2.0 * pattern.half_width,
        },
        "particles": {
            "median_diameter": particle["median_diameter_m"] / particle["scale"],
            "diameters": [diameter / particle["scale"] for diameter in particle["diameters_m"]],
            "mass_fractions": particle["mass_fractions"],
        },
        "scale": particle["scale"],
    }
