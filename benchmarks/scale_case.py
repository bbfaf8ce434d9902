"""The runs that tell what moves the wear of a convex sample in coarse particles: a row of `particle_size`, convex and
plain, as the study has it but for the source's pair of frictions, and with one thing changed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import pi
from pathlib import Path
from statistics import NormalDist
from types import MappingProxyType
from typing import Any

from benchmarks.runs import FIRST_SEED, PUBLISHED_PAIR, changed, surface_file
from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.config.design import Run, load_study
from bulkwear.workflows.config.layers import merge
from bulkwear.workflows.config.packings import SEED_SPACING
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.chain import Chain, total_steps
from bulkwear.workflows.engine.derived import WALLS

STUDY, SURFACES = "particle_size", (PLAIN, "convex")
SETTINGS: dict[str, Any] = {"fidelity": "quick", "bed": {"material": PUBLISHED_PAIR}}
REFERENCE = "the study with the source's pair"
FOLDER_OF_REFERENCE = "as_in_the_study"  # of its runs
OPEN, PUBLISHED, NUMERICAL = "open", "published", "ours"  # what the source says of a thing
SIZES, TIME_STEP = "relative_diameters", "time_step_s"  # keys of a change: over the median; at most, at this scale
SOURCE_STEP = 5e-6  # s, of the source's bulk tests, the one step that it prints
FRACTION_DIGITS = ".4g"  # of a time step over the Rayleigh time
BELOW, LIMIT, MEDIAN = 0.0026, 2.0, 2.65  # -, mm, mm: share of the mass that is finer, and the median (section 3.3.2)
DEVIATION = (LIMIT / MEDIAN - 1.0) / NormalDist().inv_cdf(BELOW)  # -, over the median, were the sizes normal
APART = round(2.0**0.5 * DEVIATION, 3)  # -, of three sizes with 25, 50 and 25 % that have it, from the middle one


@dataclass(frozen=True)
class Candidate:
    """One thing that is changed: parameters of the runs (SI, nested), what the source says of it, and what exactly."""

    change: Mapping[str, Any]
    kind: str
    why: str


def _of_sample(**contact: float) -> dict[str, Any]:
    return {"sample_material": {"contact": contact}}


CANDIDATES: dict[str, Candidate] = {
    REFERENCE: Candidate(
        {}, "", "row of the study at quick fidelity, with the pair of frictions that the source gives"
    ),
    "one size of particles": Candidate(
        {"particle": {SIZES: [1.0], "mass_fractions": [1.0]}},
        OPEN,
        "the source prints a curve; the study assumes 0.8, 1 and 1.2 of the median with 25, 50 and 25 % of the mass",
    ),
    "rolling on relative spin": Candidate(
        {"solver": {"rolling_friction": "cdt"}},
        OPEN,
        "rolling friction against the spin of a particle relative to its neighbour (`cdt`, type A), instead of its own"
        " (`own_spin`): the law of type A that the source prints (Equation 3.3); its code offers two others, of which"
        " `own_spin` is the standard one, and which of them ran it does not say",
    ),
    "rolling as rvd": Candidate(
        {"solver": {"rolling_friction": "rvd"}},
        OPEN,
        "rolling friction against the velocity of the surfaces over the contact, the other model of the source's code",
    ),
    "one size, rolling on relative spin": Candidate(
        {"particle": {SIZES: [1.0], "mass_fractions": [1.0]}, "solver": {"rolling_friction": "cdt"}},
        OPEN,
        "both",
    ),
    "one size, rolling as rvd": Candidate(
        {"particle": {SIZES: [1.0], "mass_fractions": [1.0]}, "solver": {"rolling_friction": "rvd"}},
        OPEN,
        "both",
    ),
    "one size, rolling as rvd, time step 0.1": Candidate(
        {
            "particle": {SIZES: [1.0], "mass_fractions": [1.0]},
            "solver": {"rolling_friction": "rvd", "rayleigh_fraction": 0.1},
        },
        NUMERICAL,
        "both, with 0.1 of the Rayleigh time instead of 0.4: [what a step changes](time_step_limits_results.md)",
    ),
    "one size, rolling on relative spin, time step 0.1": Candidate(
        {
            "particle": {SIZES: [1.0], "mass_fractions": [1.0]},
            "solver": {"rolling_friction": "cdt", "rayleigh_fraction": 0.1},
        },
        NUMERICAL,
        "both, with 0.1 of the Rayleigh time instead of 0.4: the torque of `cdt` knows the step",
    ),
    "one size, rolling on relative spin, time step 5e-6 s": Candidate(
        {
            "particle": {SIZES: [1.0], "mass_fractions": [1.0]},
            "solver": {"rolling_friction": "cdt", TIME_STEP: SOURCE_STEP},
        },
        OPEN,
        "both, with the step that the source prints of its bulk tests, 0.05 of the Rayleigh time at scale 4, 0.02 at"
        " 8: which one its sliding samples had is not said",
    ),
    "sizes 0.88 to 1.12": Candidate(
        {"particle": {SIZES: [1.0 - APART, 1.0, 1.0 + APART], "mass_fractions": [0.25, 0.5, 0.25]}},
        OPEN,
        f"of the median, 25, 50 and 25 % of the mass: the standard deviation, {DEVIATION:.3f}, of a normal distribution"
        " with 0.26 % below 2 mm, as is printed; that of the study's 0.8, 1 and 1.2 is 0.141",
    ),
    "sizes 0.88 to 1.12, rolling on relative spin, time step 5e-6 s": Candidate(
        {
            "particle": {SIZES: [1.0 - APART, 1.0, 1.0 + APART], "mass_fractions": [0.25, 0.5, 0.25]},
            "solver": {"rolling_friction": "cdt", TIME_STEP: SOURCE_STEP},
        },
        OPEN,
        "all three as the source prints them: the share below 2 mm, rolling friction of type A on relative spin"
        " (Equation 3.3), and the step of its bulk tests",
    ),
    "sizes 0.5 to 1.5": Candidate(
        {"particle": {SIZES: [0.5, 0.75, 1.0, 1.25, 1.5], "mass_fractions": [0.1, 0.2, 0.4, 0.2, 0.1]}},
        OPEN,
        "of the median, 10, 20, 40, 20 and 10 % of the mass; wider than the source's 0.26 % below 2 mm allows",
    ),
    "sizes 0.8 to 1.6": Candidate(
        {"particle": {SIZES: [0.8, 1.0, 1.6], "mass_fractions": [0.3, 0.4, 0.3]}},
        OPEN,
        "of the median, 30, 40 and 30 % of the mass: a coarse tail, of which the source says nothing",
    ),
    "neighbouring rows 40 mm apart": Candidate(
        {"pattern": {"row_spacing_between": "neighbouring_rows"}},
        OPEN,
        "c = 40 mm read as the distance from one row to the next, which the source's Figure 6.1 rules out",
    ),
    "c and d exchanged": Candidate(
        {"pattern": {"row_spacing_m": 0.06, "column_spacing_m": 0.04}},
        OPEN,
        "the source's list of symbols calls c the horizontal and d the vertical distance, its text the reverse",
    ),
    "bumps turned": Candidate(
        {"pattern": {"major_axis": "across_travel"}},
        OPEN,
        "radius a = 4 mm across the travel and b = 8 mm along it",
    ),
    "sample 5 mm above the floor": Candidate(
        {"sample": {"height_above_floor_m": 0.005, "skirt_slope_rad": pi / 4, "skirt_radius_m": 0.0}},
        OPEN,
        "how the source's sample and its holder meet the floor is not said; here with a skirt of 45 degrees",
    ),
    "bed between walls": Candidate(
        {"bed": {"ends": WALLS, "ahead_m": 0.09, "behind_m": 0.01}},
        NUMERICAL,
        "1.6 m of bed instead of a window; ahead and behind as in the source",
    ),
    "time step 0.2": Candidate(
        {"solver": {"rayleigh_fraction": 0.2}},
        NUMERICAL,
        "of the Rayleigh time, instead of 0.4; the source prints 5e-6 s, 0.23 at scale 1",
    ),
    "elements of 1.5 mm": Candidate(
        {"sample": {"element_size_m": 0.0015}}, OPEN, "instead of 2.5 mm; those of the source's sample are not told"
    ),
    "rolling radius reduced": Candidate(
        {"solver": {"rolling_radius": "reduced"}},
        NUMERICAL,
        "rolling friction between particles as the solver has it, half as large; the source's code has the full radius",
    ),
    "bed of 92 mm": Candidate(
        {"bed": {"thickness_m": 0.092}}, PUBLISHED, "twice the 46 mm that follow from 40 kg: twice as many layers"
    ),
    "no rolling friction of the sample": Candidate(
        _of_sample(rolling_friction=0.0), PUBLISHED, "instead of 0.3 (Table 3.2)"
    ),
    "rolling friction of the sample 0.6": Candidate(
        _of_sample(rolling_friction=0.6), PUBLISHED, "instead of 0.3 (Table 3.2)"
    ),
    "sliding friction of the sample 0.21": Candidate(
        _of_sample(sliding_friction=0.21), PUBLISHED, "that of gravel on gravel, instead of 0.38 (Table 3.2)"
    ),
    "sliding friction of the sample 0.5": Candidate(
        _of_sample(sliding_friction=0.5), PUBLISHED, "instead of 0.38 (Table 3.2)"
    ),
    "particles ten times softer": Candidate(
        {"particle": {"shear_modulus_pa": 7.0e6}}, PUBLISHED, "shear modulus 0.007 instead of 0.07 GPa (Table 3.2)"
    ),
}


@dataclass(frozen=True)
class Case:
    """A run: name of the candidate, surface of the sample, particle scale (-), seed of the packing.

    A change of the pattern changes no plain sample: such a run is the reference's.
    """

    candidate: str
    surface: str
    scale: int
    seed: int

    @property
    def folder(self) -> str:
        """Path of its folder within that of all."""
        same = self.surface == PLAIN and set(CANDIDATES[self.candidate].change) == {"pattern"}
        reference = same or self.candidate == REFERENCE
        name = FOLDER_OF_REFERENCE if reference else self.candidate.replace(" ", "_")
        return f"scale_{self.scale}/{name}/{self.surface}/{self.seed}"


def cases(scales: Iterable[int], names: Iterable[str], packings: int, of_reference: int) -> list[Case]:
    """Return all runs of the named: packing by packing, candidates in order, the reference as often as is said."""
    told = [(name, of_reference if name == REFERENCE else packings) for name in CANDIDATES if name in set(names)]
    return [
        Case(name, surface, scale, FIRST_SEED + number * SEED_SPACING)
        for scale in scales
        for number in range(max(packings, of_reference))
        for name, count in told
        if number < count
        for surface in SURFACES
    ]


def chain_of(
    case: Case, folder: Path, settings: Mapping[str, Any], further: Mapping[str, Any] = MappingProxyType({})
) -> Chain:
    """Return a run as the driver sees it, its folder made; further: what is changed beside its candidate.

    Runs whose beds have equal parameters share one, so both surfaces of a packing, and all candidates that leave the
    bed as it is, start from the same particles.
    """
    row = f"S{case.scale}"
    study = load_study(STUDY, overrides={**settings, "rows": [row], "packings": 1})
    change = merge(dict(CANDIDATES[case.candidate].change), further)
    runs = [with_change(run, change, case.seed) for run in study.runs]
    beds, bed_of = study.case.beds(runs)
    (run,) = (run for run in runs if run.surface == case.surface)
    bed, place = beds[bed_of[run.name]], folder / case.folder
    place.mkdir(parents=True, exist_ok=True)
    return Chain(
        f"{case.candidate}, {case.surface}, scale {case.scale}, {case.seed}",
        place / "run",
        study.case,
        run.parameters,
        surface_file(place, "surface", study.case, run.parameters),
        bed,
        folder / "beds" / state.digest(bed)[:12] / "bed.restart",
    )


def with_change(run: Run, change: Mapping[str, Any], seed: int) -> Run:
    """Return the run with a candidate's change and the seed of a packing."""
    particle, solver = (dict(change.get(section, {})) for section in ("particle", "solver"))
    if SIZES in particle:
        median = run.parameters["particle"]["median_diameter_m"]
        particle["diameters_m"] = [median * size for size in particle.pop(SIZES)]
    step = solver.pop(TIME_STEP, None)
    bed = {**change.get("bed", {}), "seed": seed}
    found = changed(run, {**change, "particle": particle, "solver": solver, "bed": bed})
    if step is None:
        return found
    fraction = step / found.parameters["derived"]["rayleigh_time_s"]
    return changed(found, {"solver": {"rayleigh_fraction": float(f"{fraction:{FRACTION_DIGITS}}")}})


def particle_steps(chain: Chain) -> float:
    """Return about how many particle-steps a run has, known before it starts."""
    return chain.parameters["derived"]["bed_particles"] * total_steps(chain)
