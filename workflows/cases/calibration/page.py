"""The page of a calibration: its sections, table of boxes, remarks, what is simplified."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.calibration import boxes
from bulkwear.workflows.cases.calibration.case import calibration_box
from bulkwear.workflows.engine.derived import PERIODIC
from bulkwear.workflows.engine.grains import SPHERE
from bulkwear.workflows.report.sections import Light, Section
from bulkwear.workflows.report.sentences import listed

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

RUNS_NOTE = (
    "Each row is a box in which the shear angle is compared; the calibration uses that of the first one. Width: of the "
    "periodic slice as simulated, at least four particle diameters."
)
WEIGHTIEST = "Discrepancy of the model"
DECKS = ()  # `snakemake <study>_decks` renders them
CREEPS = (
    " A constant torque cannot hold a grain at rest: it changes sign at every step, and slopes creep, the faster the "
    "larger the time step."
)
OPENINGS = {
    boxes.SLOT: "slot of {:g} mm across the whole width",
    boxes.SQUARE: "square of {:g} mm in the middle of the floor",
}


def told(study: Study) -> dict[str, Any]:
    """Return what the page is told besides what every page is."""
    return {"parameters": calibration_box(study)}


def answers(folder: Path) -> list[str]:
    """Return in sentences what the recommended pair reproduces, and whether the published one is kept."""
    import pandas as pd  # slow to import, as what follows, and every job reads this page

    from bulkwear.workflows.cases.calibration.answers import on_pairs

    summary = folder / "summary.csv"
    return on_pairs(pd.read_csv(summary)) if summary.is_file() else []


def facts(study: Mapping[str, Any], folder: Path) -> list[str]:
    """Return in sentences what the measurements leave of the parameters, which one decides, and what they reject."""
    from bulkwear.workflows.cases.calibration.answers import on_posterior
    from bulkwear.workflows.cases.calibration.findings import read_finished

    return on_posterior(read_finished(study, folder))


def lights(study: Mapping[str, Any], folder: Path) -> list[Light]:
    """Return how far the answers can be trusted."""
    from bulkwear.workflows.cases.calibration.answers import lights_of

    return lights_of(study, folder)


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a calibration's page from the tables that its jobs left."""
    from bulkwear.workflows.cases.calibration.findings import (  # slow to import, and few jobs need it
        read_finished,
        sections_of,
    )

    return sections_of(read_finished(study, folder), study["name"])


def run_columns(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the table of boxes tells of a box's parameters."""
    width = boxes.simulated_width(run["shear_box"], run["particle"])
    return {
        "particle_scale": run["particle"]["scale"],
        "simulated_width_mm": 1e3 * width,
        "width_diameters": width / run["particle"]["median_diameter_m"],
    }


def remarks(study: Study) -> list[str]:
    """Return what figures must say about model, convention and width."""
    run = calibration_box(study)
    solver = run["solver"]
    scale, shape = run["particle"]["scale"], study.settings["bulk"]["shape"]
    said = [
        *([f"particles at scale {scale:g}"] if scale != 1.0 else []),
        *([f"clumps of spheres ({shape})"] if shape != SPHERE else []),
        f"rolling friction {solver['rolling_friction']}, coefficients for the {solver['rolling_radius']} radius",
    ]
    for section in run["calibration"]["tests"]:
        width, real = boxes.simulated_width(run[section], run["particle"]), run[section]["width_m"]
        widened = f" instead of {1e3 * real:g} mm" if width > real else ""
        said.append(f"{section.replace('_', ' ')} {1e3 * width:.3g} mm wide{widened}")
    if "draw_down" in run["calibration"]["tests"]:
        said.append(f"{run['draw_down']['opening']} of {1e3 * run['draw_down']['opening_m']:g} mm assumed")
    return said


def simplifications(study: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return (what, how) of what is simpler here than in the laboratory."""
    settings = study["settings"]
    solver, tests = settings["solver"], settings["calibration"]["tests"]
    return [
        *_coarse_graining(settings),
        (
            "Rolling friction stands for shape",
            f"Model {solver['rolling_friction']}; coefficients are for the {solver['rolling_radius']} radius of the "
            "particle and valid in this model and convention only."
            + (CREEPS if solver["rolling_friction"] == "cdt" else ""),
        ),
        *(_opening(settings["draw_down"]) if boxes.DRAW_DOWN in tests else ()),
        ("Periodic slices", _slices(settings, tests)),
        (
            "Discrepancy of the model",
            "What the model is off by with the right parameters is normal about 0, with a standard deviation of "
            f"{settings['calibration']['model_discrepancy']:g} times the measurement's where the table of measured "
            "responses gives none. As many responses as parameters say nothing of its size: it is an assumption.",
        ),
        (
            "Independent responses",
            "Each response has a surrogate of its own, and measured responses are taken to err independently.",
        ),
    ]


def _coarse_graining(settings: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what is to be said of particles larger than the real ones, and of their shape."""
    scale, shape = settings["particle_scale"], settings["bulk"]["shape"]
    grains = "Spheres" if shape == SPHERE else f"Clumps of spheres ({shape}) as large as spheres"
    if scale == 1.0:
        return [("Shape of particles", f"{grains}, as large as the real ones.")]
    larger = (
        f"{grains}, {scale:g} times as large as the real ones, in the same boxes. Slopes are then fewer particles "
        "high: angles scatter more between packings, which the calibration counts as noise."
    )
    return [("Coarse-grained particles", larger)]


def _opening(draw_down: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what is assumed of a draw-down test's opening."""
    assumed = OPENINGS[draw_down["opening"]].format(draw_down["opening_mm"])
    told = (
        f"The source calls it square and tells no size. A {assumed} is assumed. How discharge times differ between "
        "pairs is a result; their level is not."
    )
    return [("Opening of the draw-down test", told)]


def _slices(settings: Mapping[str, Any], tests: Sequence[str]) -> str:
    """Return which boxes have no front and back; that of the box sizes is always a shear box."""
    ends = {test: settings[test].get("front_and_back", PERIODIC) for test in dict.fromkeys([boxes.SHEAR_BOX, *tests])}
    open_ended = listed([test.replace("_", " ") for test, end in ends.items() if end == PERIODIC])
    walled = listed([test.replace("_", " ") for test, end in ends.items() if end != PERIODIC])
    told = f"No front and back: {open_ended}. Particles that leave a slice on one side come back on the other."
    return f"{told} With walls there: {walled}." if walled else told
