"""The runs of a circular wear tester as its tables and figures know them.

A revolution of wear is counted from where wear begins to be; a revolution of the bed from where it began to turn. What
most figures show is series `volume`: a setting with a pattern and a plain one in equal machines, of one packing or
several. A pair is two such runs of one packing: they start from the same bed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.workflows.cases.circular_tester.decks import pose

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Run, Study

LOG, SURFACE = "log.liggghts", "surface.vtu"  # files of a run
VOLUME, SIZE, MESH, WORN_OUT, RING = "volume", "size", "mesh", "worn_out", "ring"  # series of the design
VARIED = "varied"  # another one: pairs in machines of their own


@dataclass(frozen=True, eq=False)
class TesterRun:
    """A run and how its bed has turned before wear was counted.

    packing: number among those of its setting, from 1 on; equal machines and particles share the bed of a number
    shape: channel or ring; element_size_mm: mm; folder: of the run; bed_folder: of the bed that it started from
    bed_revolution_steps, revolution_steps: time steps of a revolution of bed and run; revolution_s: s
    bed_revolutions, run_in_revolutions: of the bed alone, and with the sample before wear is counted
    width, length, layer_height: m, of the sample and of the lowest layer over it; rotation: (3, 3) of the sample
    coefficient: 1/Pa; patch: over what a contact wears, in words
    distance_per_revolution: m of the bed past the sample's middle
    pair: name of the machine of a run of series `varied`
    """

    name: str
    surface: str
    series: str
    packing: int
    shape: str
    particle_scale: float
    element_size_mm: float
    coefficient: float
    patch: str
    folder: Path
    bed_folder: Path
    bed_revolution_steps: int
    revolution_steps: int
    revolution_s: float
    bed_revolutions: float
    run_in_revolutions: float
    width: float
    length: float
    layer_height: float
    rotation: np.ndarray
    distance_per_revolution: float
    pair: str = ""

    @property
    def case(self) -> dict[str, object]:
        """Columns that tell a run from others in all tables."""
        return {"run": self.name, "surface": self.surface, "particle_scale": self.particle_scale} | {
            name: getattr(self, name) for name in ("packing", "series", "shape", "element_size_mm", "coefficient")
        }

    @property
    def before(self) -> float:
        """Revolutions of the bed before wear is counted."""
        return self.bed_revolutions + self.run_in_revolutions


# ---------------------------------------------------------------- from a study to its runs


def has_series(name: str) -> Callable[[Study], bool]:
    """Return what says whether a study has rows of a series beside a pair."""
    return lambda study: has_pairs(study) and any(row["series"] == name for row in study.design_rows)


def has_pairs(study: Study) -> bool:
    """Return whether a packing of series `volume` has a plain and a patterned run, of which most figures are made."""
    try:
        return bool(pairs_of(runs_of_values(values_of_pairs(study), Path())))
    except ValueError:
        return False


def values_of_runs(study: Study) -> list[dict[str, Any]]:
    """Return what the analysis of every run of a study needs to know of it, JSON-able, see `TesterRun`."""
    return [_values(study, run) for run in study.runs]


def values_of_pairs(study: Study) -> list[dict[str, Any]]:
    """Return the same of the runs of series `volume` alone."""
    return [values for values in values_of_runs(study) if values["series"] == VOLUME]


def _values(study: Study, run: Run) -> dict[str, Any]:
    parameters, bed = run.parameters, study.beds[study.bed_of(run.name)]
    design_row = next(row for row in study.design_rows if row["row"] == run.row)
    sample, sliding, derived = (parameters[name] for name in ("sample", "sliding", "derived"))
    columns = study.case.table_columns(parameters)
    return {
        "name": run.name,
        "bed": study.bed_of(run.name),
        "packing": study.packing_of[run.row],
        "series": design_row["series"],
        "pair": design_row.get("pair") or "",
        **{name: columns[name] for name in ("surface", "shape", "particle_scale", "element_size_mm")},
        "coefficient": columns["wear_coefficient_per_pa"],
        "patch": patch_words(parameters["wear"]),
        "bed_revolution_steps": round(bed["revolution_s"] / bed["time_step_s"]),
        "revolution_steps": derived["revolution_steps"],
        "revolution_s": derived["revolution_s"],
        "bed_revolutions": sliding["steady_revolutions"],
        "run_in_revolutions": sliding["run_in_revolutions"],
        "width": sample["width_m"],
        "length": sample["length_m"],
        "layer_height": parameters["particle"]["median_diameter_m"],
        "rotation": pose(parameters["tester"]).tolist(),
        "distance_per_revolution": sliding["velocity_m_per_s"] * derived["revolution_s"],
    }


def patch_words(wear: Mapping[str, Any]) -> str:
    """Return over what a contact wears."""
    return {
        "none": "single elements",
        "simulated": "its Hertz patch in the solver",
        "physical": "the Hertz patch of the real material",
        "radius": f"{1e3 * wear.get('patch_radius_m', 0.0):g} mm round it",
    }[wear["patch"]]


def runs_of_values(values: Sequence[Mapping[str, Any]], results: Path) -> list[TesterRun]:
    """Return runs from their values, as from `values_of_runs`, below the folder of their study."""
    return [_run_of_values(dict(each), results) for each in values]


def _run_of_values(values: dict[str, Any], results: Path) -> TesterRun:
    folders = {"folder": results / values["name"], "bed_folder": results / "beds" / values.pop("bed")}
    return TesterRun(**values | folders | {"rotation": np.array(values["rotation"])})


def pairs_of(runs: Sequence[TesterRun], series: str = VOLUME) -> list[tuple[TesterRun, TesterRun]]:
    """Return the run with a pattern and the plain one of every packing of a series that has both.

    Raises ValueError where no packing has both.
    """
    from bulkwear.postproc.mesh import PLAIN  # slow to import, and Snakemake reads this module first

    of_packing: dict[int, dict[bool, TesterRun]] = {}
    for run in runs:
        if run.series == series:
            of_packing.setdefault(run.packing, {}).setdefault(run.surface == PLAIN, run)
    pairs = [(both[False], both[True]) for _, both in sorted(of_packing.items()) if len(both) == 2]
    if not pairs:
        raise ValueError(f"no packing of series {series} has a plain and a patterned run, allowed is one or more")
    return pairs


def shown_pair(runs: Sequence[TesterRun]) -> tuple[TesterRun, TesterRun]:
    """Return the pair that is shown where only one can be, as in maps and sections: that of the first packing."""
    return pairs_of(runs)[0]
