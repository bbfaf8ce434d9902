"""A search in a study whose runs are made up: its rounds, decided one after the other, and what its runs leave."""

import json
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import write_surface
from bulkwear.workflows.cases.sliding_sample.search.rounds import decide_round
from bulkwear.workflows.config.design import Study, load_study
from bulkwear.workflows.engine.project import Project
from tests.support.finished_samples import wear_table

STUDY = "optimised_pattern"
BEST_HEIGHT_MM, LEAST = 4.0, 0.5  # where wear over plain is least, and how much it is there
PER_MM, NOISE = 0.1, 0.01  # -, of ln wear over plain per mm of height beyond; scatter of packings
RUN_S, BED_S = 36.0, 72.0  # of the processor; a plain twin that was simulated for another pattern takes none
SMALL = {  # two factors and few rows, on a sample of which a mesh takes no time
    "packings": 2,
    "particle_scale": 4,
    "sample": {"width_mm": 40, "length_mm": 40, "element_size_mm": 4},
    "bed": {"width_mm": 60, "ahead_mm": 20, "behind_mm": 20},
    "sliding": {"run_in_mm": 10, "travel_mm": 20, "cycles": 1},
    "optimise": {
        "factors": [
            {"name": "height_mm", "low": 2, "high": 6, "step": 0.5},
            {"name": "minor_radius_mm", "low": 2, "high": 8, "step": 0.5},
        ],
        "first_rows": 4,
        "rows_of_round": 2,
        "most_rows": 9,
        "confirming_packings": 3,
        "after_h": 0.001,
    },
}


def small_search(root: Path, **asked) -> Study:
    """Return the study with what its rounds below a root have found; asked: other goals of its search."""
    settings = {**SMALL, "optimise": {**SMALL["optimise"], **asked}}
    return load_study(STUDY, Project(root), overrides=settings)


def wear_over_plain(row: dict, packing: int) -> float:
    """What a pattern wears over plain, by its height alone, with the scatter of a packing."""
    scatter = NOISE * np.random.default_rng([packing, round(100 * row["height_mm"])]).standard_normal()
    return LEAST * float(np.exp(PER_MM * abs(row["height_mm"] - BEST_HEIGHT_MM) + scatter))


def write_runs(study: Study, folder: Path) -> None:
    """Write what the runs of a study leave, as far as rounds look at it, where it is not there yet."""
    rows = {row["row"]: row for row in study.design_rows}
    for run in study.runs:
        own = folder / run.name
        if own.exists():
            continue
        own.mkdir(parents=True)
        ratio = 1.0 if run.surface == "plain" else wear_over_plain(rows[run.row], study.packing_of[run.row])
        wear_table(ratio * 1e-9).to_csv(own / "wear.csv", index=False)
        taken = 0.0 if study.same_as(run.name) else RUN_S
        pd.DataFrame({"processor_s": [taken]}).to_csv(own / "cost.csv", index=False)
        write_surface(own / "surface.vtu", study.case.surface_mesh(run.parameters))
    for bed in study.beds:
        (folder / "beds" / bed).mkdir(parents=True, exist_ok=True)
        pd.DataFrame({"processor_s": [BED_S]}).to_csv(folder / "beds" / bed / "cost.csv", index=False)


def costs_of(study: Study, folder: Path) -> list[str]:
    """Return the tables of what runs and beds of a study have taken, as rounds are given them."""
    return [
        str(folder / name / "cost.csv") for name in (*(r.name for r in study.runs), *(f"beds/{b}" for b in study.beds))
    ]


def decided_round(root: Path, number: int, packings: dict[str, int], **asked) -> dict:
    """Decide a round that looks at so many packings of each setting, and write what it decided."""
    study, folder = small_search(root, **asked), root / "results" / STUDY
    looked_at = study.with_packings(packings)
    write_runs(looked_at, folder)
    (folder / "rounds").mkdir(exist_ok=True)
    design = folder / "rounds" / f"round_{number}_design.csv"
    pd.DataFrame(looked_at.design_table()).to_csv(design, index=False)
    wear, surface = ([str(folder / run.name / name) for run in looked_at.runs] for name in ("wear.csv", "surface.vtu"))
    decided = decide_round(study, number, design, wear, surface, costs_of(looked_at, folder))
    (folder / "rounds" / f"round_{number}.json").write_text(json.dumps(decided))
    return decided


def search_to_its_end(root: Path, **asked) -> list[dict]:
    """Decide all rounds of a search, and return what they decided."""
    packings, decided = small_search(root, **asked).first_packings, []
    while not (decided and decided[-1]["enough"]):
        decided.append(decided_round(root, len(decided) + 1, packings, **asked))
        packings = decided[-1]["packings"]
    return decided
