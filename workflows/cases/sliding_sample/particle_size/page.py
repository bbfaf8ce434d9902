"""What the page of a study of particle size tells: its critical scale first, then what stands behind it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from bulkwear.postproc.flow.packing import inner_means
from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.reference.size_ratios import size_ratios
from bulkwear.postproc.statistics.verdicts import VERDICTS
from bulkwear.postproc.tables.display import MILLIMETRES, in_display_units
from bulkwear.postproc.tables.packings import SETTING, over_packings
from bulkwear.postproc.tables.summary import patterned_name, read_summary
from bulkwear.workflows.cases.sliding_sample.particle_size.collision import spread_over_scales
from bulkwear.workflows.cases.sliding_sample.particle_size.figures import PUBLISHED_LINES
from bulkwear.workflows.cases.sliding_sample.particle_size.guidance import Pattern, published_at_scales
from bulkwear.workflows.cases.sliding_sample.particle_size.study import bumps_and_particles, has_published_pattern
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import (
    bed_sentences,
    lines_beside,
    wear_by_scale,
)
from bulkwear.workflows.cases.sliding_sample.study import compares_sizes, plain_runs
from bulkwear.workflows.config.claims import ABOUT
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.report.sections import Block, Pictures, Section, Table, Text

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

WEAR, FORCE, RATE = "worn_volume_mm3", "mean_normal_force_N", "worn_volume_per_metre_mm3_per_m"
PATTERN = "pattern_worn_volume_mm3"
SENTENCES, OF_SCALES = "particle_size/sentences.csv", 2  # the first ones are those of the critical scale
BRACKETS, UNITS = re.compile(r"(.*) \((.*)\)"), {"mm3/m": "mm³/m", "%": "%"}  # of columns whose unit is in brackets


def told(study: Study) -> dict[str, Any]:
    """Return what the page is told besides what every page is: bumps and particles, whether wear is told over that of
    plain samples, whether their pattern is the source's, whether there are plain samples, and the costs of the
    packings.
    """
    return {
        "bumps": bumps_and_particles(study),
        "compares_sizes": compares_sizes(study),
        "same_pattern": has_published_pattern(study),
        "has_plain": bool(plain_runs(study)),
        "costs": {"packing_profiles": "packings/solver_cost.csv"},
    }


def answers(folder: Path) -> list[str]:
    """Return at which scales the pattern wears less, and its critical scale; nothing of a study of other things."""
    path = folder / SENTENCES
    return pd.read_csv(path)["sentence"].tolist()[:OF_SCALES] if path.is_file() else []


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a study of particle size, those of wear over plain where it has both surfaces; folder:
    results/<study>.
    """
    steady = ("steady_by_scale", "relative_velocity", "wear_gradient")
    flow = (*(f"{name}velocity_by_layer" for name in ("", "upward_", "sideways_")), "angular_velocity_along_sample")
    compares = study["told"]["compares_sizes"]
    helps = [*critical_scale(study, folder), Pictures(["wear_against_scale"])] if compares else []
    advice = [*guidance(study, folder), Pictures(["wear_against_size_ratios"])] if compares else []
    return [
        Section("Up to which particle scale does the pattern help?", helps),
        Section("Numbers of the source beside ours", beside_the_source(folder) if compares else []),
        Section("Relative velocity and wear rate", [*steady_windows(folder), Pictures(steady)]),
        Section("Wear of small and of large particles", [Pictures(["wear_maps"])]),
        Section("Guidance", advice),
        Section("The flow by layer and along the sample", [Pictures([*flow, "flow_views"])]),
        Section("Packing", [*packing(study, folder), Pictures(["packing_profiles", "bed_packing"])]),
        Section("Single contacts", [*single_contacts(folder), Pictures(["collisions"])]),
    ]


def critical_scale(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return what is told of the critical scale and of the beds, wear and sizes of every row, and the lines beside the
    source's.
    """
    said = pd.read_csv(folder / SENTENCES)["sentence"]
    summary = in_display_units(read_summary(folder / "summary.csv"))
    rows = wear_by_row(study, summary)
    return [
        Text(" ".join([*said, *bed_sentences(plain_beds(study, summary))])),
        Table(
            rows,
            "wear_by_row",
            "Wear over plain, with its 95 % interval over packings, is the product of two factors: of the sums of"
            " normal forces, and of how far contacts slide under them while the sample travels as far.",
            heads={name: (found[1], UNITS[found[2]]) for name in rows if (found := BRACKETS.fullmatch(name))},
        ),
        Table(
            pd.read_csv(folder / "particle_size" / "lines.csv"),
            "lines",
            "Straight lines of wear over that of the plain sample with the smallest particles simulated, against"
            " particle scale; the source's are over its plain sample at scale 1. Lack of fit: how probable it is that"
            " packings alone scatter the means of the scales so far off the line.",
            beside_source=lines_beside_source(study, folder),
        ),
        Table(
            pd.read_csv(folder / "particle_size" / "critical_scale_forms.csv"),
            "critical_scale_forms",
            "Forms of that ratio against the scale. A form that misses the scales' means by more than the scatter of"
            " packings lets expect is rejected; the interval of the critical scale is what the others leave open.",
        ),
    ]


def lines_beside_source(study: Mapping[str, Any], folder: Path) -> pd.DataFrame:
    """Return the source's lines at two scales beside our wear there."""
    wear = wear_by_scale(read_summary(folder / "summary.csv"))
    lines = pd.read_csv(current_project().file(PUBLISHED_LINES))
    return published_at_scales(wear, lines_beside(lines, study["told"]["same_pattern"]))


def plain_beds(study: Mapping[str, Any], summary: pd.DataFrame) -> pd.DataFrame:
    """Return a line per plain run for `bed_sentences`; summary: in display units."""
    plain = summary[summary["surface"] == PLAIN]
    of_run = [study["parameters"][run] for run in plain["run"]]
    return plain[["particle_scale", FORCE]].assign(
        layers=[each["derived"]["layers"] for each in of_run],
        bed_thickness_mm=[MILLIMETRES * each["bed"]["thickness_m"] for each in of_run],
    )


def wear_by_row(study: Mapping[str, Any], summary: pd.DataFrame) -> pd.DataFrame:
    """Return a line per setting, means over its packings: its scale, layers and sizes, and patterned over plain wear.

    summary: in display units
    """
    layers = {run: each["derived"]["layers"] for run, each in study["parameters"].items()}
    sizes = {run: each["derived"]["equivalent_size_ratio"] for run, each in study["parameters"].items()}
    patterned = summary[summary["surface"] != PLAIN].set_index("row")
    plain = summary[summary["surface"] == PLAIN].set_index("row").reindex(patterned.index)
    over = patterned[[WEAR, FORCE]] / plain[[WEAR, FORCE]]
    columns = {
        SETTING: patterned[SETTING],
        "particle_scale": patterned["particle_scale"],
        "layers_of_particles": patterned["run"].map(layers),
        "equivalent_size_ratio": patterned["run"].map(sizes),
        "wear_over_plain": over[WEAR],
        "normal_force_over_plain": over[FORCE],
        "sliding_over_plain": over[WEAR] / over[FORCE],
        f"wear, {patterned_name(summary['surface'])} (mm3/m)": patterned[RATE],
        "wear, plain (mm3/m)": plain[RATE],
        "share of the pattern (%)": 100.0 * patterned[PATTERN] / patterned[WEAR],
    }
    return over_packings(pd.DataFrame(columns), "wear_over_plain", by=(SETTING,))


def beside_the_source(folder: Path) -> list[Block]:
    """Return every number of the source with ours and a verdict."""
    table = pd.read_csv(folder / "particle_size" / "published.csv", dtype={"scales": str}).fillna(
        {"found": "", "reason": ""}
    )
    counts = table["verdict"].value_counts().reindex(VERDICTS, fill_value=0)
    return [
        Text(
            f"Of {len(table)} numbers that the text of Yan 2022, chapter 4, gives: "
            + ", ".join(f"{verdict} {count}" for verdict, count in counts.items())
            + "."
        ),
        Table(
            table,
            "published",
            "A number is claimed of every scale in question, of each of which there is an estimate over packings; of"
            " the critical scale its interval over forms counts. Relative velocity and wear rate are means, or standard"
            f" deviations, over steady windows. About: within {100.0 * ABOUT:.0f} %. Factor: ours over the source's.",
            beside_source=True,
        ),
    ]


def steady_windows(folder: Path) -> list[Block]:
    """Return means, deviations and windows of all runs."""
    table = read_summary(folder / "figures" / "steady_by_scale.csv")
    said = f"{int(table['steady'].sum())} of {len(table)} windows are steady. Travel counts from where wear does."
    return [Text(said), Table(table.drop(columns=["row", "surface"]), "steady_by_scale")]


def guidance(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return what the sizes of real particles and bumps let expect, and the ratios at every scale."""
    table = in_display_units(pd.read_csv(folder / "particle_size" / "guidance.csv", dtype={"row": str}))
    if not study["told"]["bumps"]:
        return [Text("The samples have no bumps that particles could be compared with.")]
    ratios = []
    for row, given in study["told"]["bumps"].items():
        pattern, scale = Pattern(**given["pattern"]), given["scale"]
        found = size_ratios(scale * given["particles"]["median_diameter"], *pattern.bump)
        ratios.append({"row": row, "particle_scale": scale, **vars(found)})
    return [
        Text(
            "Is the pattern expected to help, and how far may a study of it be coarse-grained? First the ratios of real"
            " particle to bump (Yan 2022, Eq 4.18 to 4.21): the pattern is expected to help where that of the"
            " equivalent radius is below 1, which it reaches at the largest scale. Bias: how many times a finer bed's"
            " wear that of the patterned sample is, by a straight line, with its 95 % interval. The published one is"
            " the source's (Eq 4.15), over wear at real size, if particle over bump is all that matters. The own one is"
            " this study's, over wear at its smallest scale: below that it tells nothing, nor where the scatter of"
            " packings rejects a line. Then the ratios of the particles simulated."
        ),
        Table(table, "guidance"),
        Table(pd.DataFrame(ratios), "size_ratios"),
    ]


def packing(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return contacts and porosity of the containers' inner slabs, and of the beds, which are told at plain samples."""
    profiles = pd.read_csv(folder / "figures" / "packing_profiles.csv")
    rows = [
        {"particle_scale": scale, "state": state, "slabs": int(one["layer"].max()), **inner_means(one)}
        for (scale, state), one in profiles[profiles["state"] != "difference"].groupby(["particle_scale", "state"])
    ]
    beds = [pd.read_csv(folder / "figures" / "bed_packing.csv")] if study["told"]["has_plain"] else []
    then = "; then the beds" if beds else ""
    return [
        Text(f"Containers, loose and shaken (dense), without the lowest and the highest slab{then}."),
        Table(pd.DataFrame(rows), "containers"),
        *(Table(each, "bed_packing") for each in beds),
    ]


def single_contacts(folder: Path) -> list[Block]:
    """Return how far single contacts differ between scales: of each collision the measure that differs most."""
    spread = spread_over_scales(pd.read_csv(folder / "particle_size" / "collisions.csv"))
    most = spread.loc[spread.groupby(["rolling_friction", "collision"], sort=False)["spread"].idxmax()]
    said = (
        "Single collisions in units of their size, at all scales simulated: the measure that differs most between them,"
        " largest minus smallest over the largest."
    )
    return [Text(said), Table(most, "collisions")]
