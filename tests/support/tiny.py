"""A chain small enough for tests: 200 particles, two cycles, a few seconds."""

from pathlib import Path

from bulkwear.postproc.mesh import write_surface
from bulkwear.workflows.config.design import Study, load_study
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.cycles import fill_bed

# Gravel with the source's friction: it may have any rolling model, and no calibration moves it.
OF_ANY_MODEL = "river_gravel_published"
TINY = {
    "rows": ["R9"],  # its bumps stand close enough for so small a sample
    "packings": 1,
    "wear": {"acceleration": 4.0e3},
    "particle_scale": 4,
    "sample": {
        **{"width_mm": 40, "length_mm": 40, "element_size_mm": 2},
        **{"height_above_floor_mm": 0.1, "skirt_radius_mm": 0},
    },
    "bed": {"material": OF_ANY_MODEL, "width_mm": 60, "ahead_mm": 20, "behind_mm": 20},
    "sliding": {"run_in_mm": 10, "travel_mm": 20, "cycles": 2},
    "solver": {"rayleigh_fraction": 0.4},  # as in studies
}


def tiny_study(**changes) -> Study:
    """Return the demo, shrunk; `changes` are further settings, merged by section."""
    settings = {key: dict(value) if isinstance(value, dict) else value for key, value in TINY.items()}
    for key, value in changes.items():
        settings[key] = {**settings.get(key, {}), **value} if isinstance(value, dict) else value
    return load_study("demo", overrides=settings)


def tiny_chain(study: Study, folder: Path, run: str = "R9_convex") -> Chain:
    """Return a chain in `folder`, its surface built and its bed filled unless they are there."""
    bed_name = study.bed_of(run)
    bed_folder, run_folder = folder / "beds" / bed_name, folder / run
    if not (bed_folder / "bed.restart").exists():
        fill_bed(study.case, bed_name, study.beds[bed_name], bed_folder)
    parameters = study.run(run).parameters
    surface = run_folder / "surface.vtu"
    if not surface.exists():
        run_folder.mkdir(parents=True, exist_ok=True)
        write_surface(surface, study.case.surface_mesh(parameters))
    return Chain(
        name=run,
        folder=run_folder,
        case=study.case,
        parameters=parameters,
        surface=surface,
        bed=study.beds[bed_name],
        bed_restart=bed_folder / "bed.restart",
    )
