"""The page of a calibration: remarks of its figures, what is simplified."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from workflows.engine.bulk_tests import simulated_width

if TYPE_CHECKING:
    from workflows.config.design import Study

KEY_NUMBERS = "calibration.html.j2"  # the whole page; it has nothing of a page about wear
FURTHER_TEMPLATES = ()  # that it includes


def page_parameters(study: Study, remarks: list[str]) -> dict[str, Any]:
    """Return what the page says about a study's configuration, JSON-able."""
    return {
        "name": study.name,
        "title": study.title,
        "question": study.question,
        "fidelity": study.fidelity,
        "settings": study.settings,
        "paper_settings": study.paper_settings,
        "remarks": remarks,
        "run": study.all_runs[0].parameters,
    }


def remarks(study: Study) -> list[str]:
    """Return what figures must say about model, convention and width."""
    run = study.all_runs[0].parameters
    solver = run["solver"]
    scale = run["particle"]["scale"]
    said = [
        *([f"particles at scale {scale:g}"] if scale != 1.0 else []),
        f"rolling friction {solver['rolling_friction']}, coefficients for the {solver['rolling_radius']} radius",
    ]
    for section in run["calibration"]["tests"]:
        width, real = simulated_width(run[section], run["particle"]), run[section]["width_m"]
        widened = f" instead of {1e3 * real:g} mm" if width > real else ""
        said.append(f"{section.replace('_', ' ')} {1e3 * width:.3g} mm wide{widened}")
    if "draw_down" in run["calibration"]["tests"]:
        said.append(f"slot of {1e3 * run['draw_down']['opening_m']:g} mm assumed")
    return said


def simplifications(settings: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return (what, how) of what is simpler here than in the laboratory."""
    solver, draw_down = settings["solver"], settings["draw_down"]
    return [
        (
            "Coarse-grained particles",
            f"Spheres, {settings['particle_scale']:g} times as large as the real ones, in the same boxes. Slopes are "
            "then fewer particles high: angles scatter more between packings, which the calibration counts as noise.",
        ),
        (
            "Rolling friction stands for shape",
            f"Model {solver['rolling_friction']}; coefficients are for the {solver['rolling_radius']} radius of the "
            "particle and valid in this model and convention only. A constant torque (cdt, type A) cannot hold a grain "
            "at rest: it changes sign at every step, and slopes creep, the faster the larger the time step.",
        ),
        (
            "Slot of the draw-down test",
            f"Its size is not published. A slot of {draw_down['opening_mm']:g} mm across the whole width is assumed, "
            "chosen so that the published pair discharges in about the published time. How discharge times differ "
            "between pairs is a result; their level is not.",
        ),
        (
            "Periodic slices",
            "Boxes have no front and back here; particles that leave a slice on one side come back on the other.",
        ),
        (
            "Independent responses",
            "Each response has a surrogate of its own, and measured responses are taken to err independently.",
        ),
    ]
