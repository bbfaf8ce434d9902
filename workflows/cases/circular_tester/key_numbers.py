"""Numbers and sentences of the page of a circular wear tester, section by section, from the study's tables."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import patterned_name, read_summary
from bulkwear.workflows.cases.circular_tester.comparison import worn_out_at
from bulkwear.workflows.cases.circular_tester.distribution import share_of_bumps
from bulkwear.workflows.cases.circular_tester.flow import steady_revolutions
from bulkwear.workflows.cases.circular_tester.tables import LABORATORY, OURS, THESIS, THESIS_ALIKE
from bulkwear.workflows.cases.circular_tester.volume import TERMS
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.report.sections import Block, Cards, Table, Text
from bulkwear.workflows.report.text import UNDEFINED

PUBLISHED_FITS = PACKAGE / "config" / "published" / "circular_tester_volume.csv"
FIT_DIGITS = 5
FIT_HEADS = {
    TERMS[0]: ("linear", "mm³ per revolution"),
    TERMS[1]: ("quadratic", "mm³ per revolution²"),
    f"{TERMS[0]}_error": ("error of linear", "mm³ per revolution"),
    f"{TERMS[1]}_error": ("error of quadratic", "mm³ per revolution²"),
    "r_squared": ("R²", "-"),
}
CROSSING_HEADS = {"rate_crossing": ("faster from", "revolution"), "crossing": ("more in sum from", "revolution")}
STEADY_HEADS = {"start": ("start", "revolution"), "mean": ("mean", "of the measure"), "drift": ("drift", "-")}
REDUCED = "At the reduced scale told at the top of the page: a finding that is not confirmed here is not thereby wrong."
RESULTS_NOTE = (
    "Lost: removed from the sample; per revolution: what the law takes. Normal force: on the faces that wear. Sliding: "
    "of contacts on them, over the travel of the trough; wear is the product of both. Carried: worn by the law, not "
    "applied to the shape."
)
RESULT_HEADS = {
    "shape": ("machine", ""),
    "lost_volume_mm3": ("lost", "mm³"),
    "lost_per_revolution_mm3": ("lost per revolution", "mm³"),
    "pattern_share_percent": ("on pattern", "%"),
    "mean_normal_force_N": ("mean normal force", "N"),
    "sliding_over_travel": ("sliding over travel", "-"),
    "bed_over_floor_velocity": ("velocity of bed over trough", "-"),
    "linear_r_squared": ("linear fit", "R²"),
    "carried_share_percent": ("carried", "%"),
}


def of_study(folder: Path, name: str) -> pd.DataFrame:
    """Return a table of the study."""
    return pd.read_csv(folder / "tester" / f"{name}.csv")


def beside_the_experiment(folder: Path) -> list[Block]:
    """Return the reductions, what sets the scale of time, and the comparison with the source."""
    compared = of_study(folder, "comparison")
    compared["note"] = compared["note"].fillna("")
    scale = of_study(folder, "time_scale").iloc[0]
    return [
        Cards(cards(compared, of_study(folder, "crossings"), _patterned(folder))),
        Text(
            "The plain sample's volume after 56 h sets the scale, all else is predicted: a revolution stands for "
            f"{scale['hours_per_revolution']:.3g} h. The coefficient that makes the source's two revolutions stand for "
            f"56 h would be {scale['wear_coefficient']:.3g} 1/Pa (simulated {scale['simulated_coefficient']:.3g}), the "
            f"laboratory's own, by its pressure and 121 km, is {scale['laboratory_coefficient']:.3g} 1/Pa. Distance of "
            f"the test over that of the revolutions: {scale['distance_scale']:.3g}."
        ),
        Table(compared, "comparison", digits=dict.fromkeys((LABORATORY, THESIS, THESIS_ALIKE, OURS), 4)),
    ]


def cards(compared: pd.DataFrame, crossings: pd.DataFrame, name: str) -> list[tuple[str, str]]:
    """Return the few numbers that answer the question: the reductions beside the measured ones, and their future.

    name: the surface of the patterned samples
    """
    found = [
        (
            f"{row[OURS]:.3g} %",
            f"less wear of the {name} sample after {row['hours']:g} h{_beside(row)}",
        )
        for _, row in compared[compared["quantity"] == "reduction"].iterrows()
    ]
    for row in crossings.itertuples():
        never = not np.isfinite(row.crossing)
        words = f"{name} never loses more" if never else f"revolutions until the {name} sample has lost more"
        found.append((UNDEFINED if never else f"{row.crossing:.3g}", f"{words}, scale {row.particle_scale:g}"))
    return found


def _beside(row: pd.Series) -> str:
    """Return what experiment and thesis have of a reduction; nothing of a surface that they did not have."""
    if np.isnan(row[LABORATORY]):
        return ""
    return f"; measured {row[LABORATORY]:.3g} %, thesis' model {row[THESIS]:.3g} %"


def _patterned(folder: Path) -> str:
    """Return the name of the surfaces of a study that are not plain."""
    return patterned_name(of_study(folder, "fits")["surface"])


def findings(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return the source's findings with their verdicts, words all of them."""
    table = pd.read_csv(folder / "tester" / "findings.csv", keep_default_na=False)
    said = [*([REDUCED] if study["remarks"] else []), "A reason with a verdict is a reserve."]
    return [Text(" ".join(said)), Table(table[["verdict", "finding", "found", "reason", "source"]], "findings")]


def fits(folder: Path) -> list[Block]:
    """Return the fits of every run beside those of the source, and when patterned overtakes plain."""
    columns, errors = ["surface", "particle_scale", *TERMS, "r_squared"], [f"{term}_error" for term in TERMS]
    ours = of_study(folder, "fits")[["run", "fit", *columns, *errors, "curved"]]
    theirs = pd.read_csv(PUBLISHED_FITS)[[*columns, "source"]]
    digits = dict.fromkeys([*TERMS, *errors, "r_squared"], FIT_DIGITS)
    crossings = of_study(folder, "crossings")
    name, never = _patterned(folder), np.isinf(crossings[["rate_crossing", "crossing"]]).any(axis=None)
    words = f"; no crossing ({UNDEFINED}) means never by the fits" if never else ""
    return [
        Table(ours, "fits", digits=digits, heads=FIT_HEADS),
        Table(theirs, digits=digits, heads=FIT_HEADS),
        Text(f"Revolution from which {name} wears faster, and from which it has lost more in sum{words}."),
        Table(crossings, heads=CROSSING_HEADS),
    ]


def ratios(folder: Path) -> list[Block]:
    """Return patterned over plain of each machine and particle scale with its deviation."""
    note = "Over all revolutions of a machine; deviation and standard error are those of its revolutions."
    return [Table(of_study(folder, "mean_ratios"), "convex_over_plain", note, {"ratio": 4})]


def every_run(folder: Path) -> list[Block]:
    """Return the key numbers of every run."""
    results = result_table(read_summary(folder / "summary.csv"), of_study(folder, "fits"))
    digits = {"lost_volume_mm3": 4, "lost_per_revolution_mm3": 4, "linear_r_squared": FIT_DIGITS}
    return [Table(results, "key_numbers", RESULTS_NOTE, digits, RESULT_HEADS)]


def result_table(summary: pd.DataFrame, fits: pd.DataFrame) -> pd.DataFrame:
    """Return the key numbers of each run in display units.

    sliding_over_travel (-): how far contacts slide over how far the trough goes, from sliding work and normal force
    """
    names = ["run", "series", "surface", "shape", "particle_scale", "element_size_mm", "wear_coefficient_per_pa"]
    volume = summary["worn_volume_m3"]
    linear = fits[fits["fit"] == "linear"].set_index("run")["r_squared"]
    return summary[[*names, "revolutions"]].assign(
        lost_volume_mm3=summary["applied_volume_m3"] * CUBIC_MILLIMETRES,
        lost_per_revolution_mm3=volume * CUBIC_MILLIMETRES / summary["revolutions"],
        pattern_share_percent=100.0 * summary["pattern_worn_volume_m3"] / volume,
        mean_normal_force_N=summary["mean_normal_force_N"],
        sliding_over_travel=summary["sliding_work_J"] / (summary["mean_normal_force_N"] * summary["travel_m"]),
        bed_over_floor_velocity=summary["bed_over_floor_velocity"],
        linear_r_squared=summary["run"].map(linear),
        carried_share_percent=100.0 * (summary["carried_volume_m3"] / volume).abs(),
    )


def steadiness(folder: Path) -> list[Block]:
    """Return from which revolution of the bed each measure is steady."""
    return [Table(steady_revolutions(of_study(folder, "series")), heads=STEADY_HEADS)]


def by_column(folder: Path) -> list[Block]:
    """Return wear by column, and what the pattern bears."""
    table = pd.read_csv(folder / "figures" / "tester_columns.csv")
    shares = "; ".join(f"{run}: {100.0 * share:.1f} % on the pattern" for run, share in share_of_bumps(table).items())
    return [Text(f"{shares}."), Table(table)]


def until_worn_out(folder: Path) -> list[Block]:
    """Return when less than a twentieth of the pattern is left; nothing where no row is for that."""
    path = folder / "figures" / "tester_worn_out.csv"
    return [Table(worn_out_at(pd.read_csv(path)))] if path.is_file() else []


def by_elements(folder: Path) -> list[Block]:
    """Return what the size of elements changes; nothing where no row is for that."""
    path = folder / "figures" / "tester_mesh.csv"
    return [Table(pd.read_csv(path))] if path.is_file() else []
