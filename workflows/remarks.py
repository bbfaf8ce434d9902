"""What every figure of a study must say about itself: what is smaller than at paper fidelity, and what is assumed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from workflows.derived import PERIODIC
from workflows.design import Study

TOLD_HOP = 0.05  # of the sample's length; a shorter hop off the ramp hides less than a row of elements or two
REDUCED = (
    ("bed", "width_mm", "bed width"),
    ("bed", "ahead_mm", "bed ahead of the sample"),
    ("sliding", "run_in_mm", "run-in"),
)  # settings whose reduction every figure tells


def figure_remarks(study: Study) -> list[str]:
    """Return what every figure must say: what is smaller than at paper fidelity, thin beds, law, acceleration."""
    now, full = study.settings, study.paper_settings
    remarks = []
    scales = sorted({round(run.parameters["particle"]["scale"], 3) for run in study.runs})
    if scales[0] != scales[-1]:
        remarks.append(f"particles at scale {scales[0]:g} to {scales[-1]:g}, different from row to row")
    elif scales != [1.0]:
        remarks.append(f"particles at scale {scales[0]:g}")
    sizes, whole = (f"{s['sample']['width_mm']:g} x {s['sample']['length_mm']:g} mm" for s in (now, full))
    if sizes != whole:
        remarks.append(f"sample {sizes} of {whole}")
    for section, key, words in REDUCED:
        if now[section][key] != full[section][key]:
            remarks.append(f"{words} {now[section][key]:g} mm of {full[section][key]:g} mm")
    (kind, length), (full_kind, full_length) = (travel_words(settings["sliding"]) for settings in (now, full))
    if (kind, length) != (full_kind, full_length):
        remarks.append(f"{kind} {length} {'of' if kind == full_kind else f'instead of a {full_kind} of'} {full_length}")
    if now["bed"]["ends"] == PERIODIC:
        length = study.runs[0].parameters["derived"]["bed_length_m"]
        remarks.append(f"bed in a channel of {1000.0 * length:g} mm that closes on itself")
    thin = {run.row: run.parameters["derived"]["layers"] for run in study.runs if run.parameters["derived"]["thin_bed"]}
    if thin:
        rows = ", ".join(f"{row} ({layers:.1f})" for row, layers in thin.items())
        remarks.append(f"fewer than three layers of particles in the bed: {rows}")
    hop = max(run.parameters["derived"]["ramp_hop_m"] for run in study.runs)
    if hop > TOLD_HOP * study.runs[0].parameters["sample"]["length_m"]:
        remarks.append(f"particles hop off the ramp, up to {1000.0 * hop:.0f} mm at the highest velocity")
    if now["wear"]["law"] != "archard":
        remarks.append(f"worn by the law {now['wear']['law']}, whose volume stands where Archard's is named")
    if now["wear"]["scheme"] != "conserving":
        remarks.append("worn by the per-triangle rule, which removes more than the law's volume")
    if now["wear"]["acceleration"] != 1.0:
        remarks.append(f"wear accelerated {now['wear']['acceleration']:g} times")
    return remarks


def travel_words(sliding: Mapping[str, Any]) -> tuple[str, str]:
    """Return what says how long a study's runs are, and how long: travel in mm, or the duration of the real test."""
    if "test_duration_h" in sliding:
        return "test duration", f"{sliding['test_duration_h']:g} h"
    return "travel", f"{sliding['travel_mm']:g} mm"
