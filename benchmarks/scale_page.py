"""The page of `benchmarks.critical_scale`: what each candidate does, and what geometry tells of a code's contacts."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from benchmarks.ratios import ASSUMED, equal_scatter
from benchmarks.runs import BY
from benchmarks.scale_case import CANDIDATES, REFERENCE
from benchmarks.touched import mean_touched, mean_touched_on_flat, met_from_above, met_from_the_front
from bulkwear.meshes.bump import bump_shell
from bulkwear.meshes.sample import sample_top
from bulkwear.postproc.reference.size_ratios import PUBLISHED_DIAMETER, PUBLISHED_PATTERN
from bulkwear.postproc.reference.sphere_contact import effective_modulus, hertz_overlap
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.config.claims import ABOUT
from bulkwear.workflows.engine.derived import youngs_modulus
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.report.markdown_text import markdown, prose

FIGURE, CURVES = "critical_scale.png", "critical_scale_curves.png"
LINES = Path("config/published/particle_size_lines.csv")
SCALES = (1, 2, 4, 6, 8)
EDGE = 1e-3  # m, of the triangles, as on the source's disc; those of its sample are not told
FLAT_SIDE = 0.03  # m
SPHERES = 1000  # at random places, of each scale and way
GRAVEL = (youngs_modulus(0.07e9, 0.24), 0.24)  # Pa, -: Young's modulus and Poisson's ratio (Yan 2022, Table 3.2)
BULK_DENSITY, THICKNESS = 1450.0, 0.046  # kg/m3, m, of the source's bed
PERCENT = 100.0
SIGNIFICANT = 0.05  # -, below which a test rejects
NEWTONS_TIMES = (1.0, 10.0)  # loads, over the bed's weight on a square as wide as the particle


def source_ratio(scale: float, part: str = "convex") -> float:
    """Return the wear of the convex sample, or of its base or bumps, over the plain one's by the source's lines (-)."""
    lines = pd.read_csv(PACKAGE / LINES).set_index("curve")
    found, plain = (lines.loc[name, "intercept"] + lines.loc[name, "slope"] * scale for name in (part, "plain"))
    return float(found / plain)


def touched_by_scale() -> pd.DataFrame:
    """Return how many triangles of EDGE a particle touches at once, mean of random places, by particle scale.

    On a bump of run R5, met from the front or from above, and on a flat; pressed in by the bed's weight on a square as
    wide as it is, and by ten times that. The overlap over the radius is then the same at all scales.
    """
    half_length, half_width, height = PUBLISHED_PATTERN
    points, triangles, _ = bump_shell(half_width, half_length, height, EDGE)
    flat = sample_top(FLAT_SIDE, FLAT_SIDE, EDGE, None)
    bump, level = points[triangles], flat.points[flat.triangles]
    steel = (youngs_modulus(78.0e9, 0.3), 0.3)
    modulus, rows = effective_modulus(*GRAVEL, *steel), []
    for scale in SCALES:
        radius, row = 0.5 * scale * PUBLISHED_DIAMETER, {"particle_scale": scale}
        for times in NEWTONS_TIMES:
            load = times * BULK_DENSITY * GRAVITY * THICKNESS * (2.0 * radius) ** 2
            overlap, ending = hertz_overlap(load, radius, modulus), "" if times == 1.0 else f"_{times:g}_loads"
            shape = (half_width, height, half_length)
            for way, name in ((met_from_the_front, "front"), (met_from_above, "above")):
                row[f"bump_from_{name}{ending}"] = mean_touched(way, shape, radius, overlap, bump, SPHERES)
            row[f"flat{ending}"] = mean_touched_on_flat(radius, overlap, level, SPHERES)
        rows.append(row)
    return pd.DataFrame(rows)


def needed_factor(reference: pd.Series, scale: float) -> float:
    """Return by how much the reference's bumps would have to wear more to give the source's ratio, base kept (-)."""
    return (source_ratio(scale) - reference["base_over_plain"]) / reference["bumps_over_plain"]


def conclusion(rows: pd.DataFrame) -> str:
    """Return in words what moved the ratio at a particle scale, and whether anything reaches the source's."""
    scale, others = rows["particle_scale"].iloc[0], rows[rows["candidate"] != REFERENCE]
    reference, source = rows[rows["candidate"] == REFERENCE].iloc[0], source_ratio(scale)
    base = source_ratio(scale, "base")
    head = (
        f"Particle scale {scale:g}: {REFERENCE} has {reference['wear_over_plain']:.2f}, the source's lines"
        f" {source:.2f}, {source / reference['wear_over_plain']:.1f} times as much. With base and plain sample as they"
        f" are here, the bumps would have to wear {needed_factor(reference, scale):.1f} times as much. The source's"
        f" base has {base:.3f} of the plain sample's wear, here it has {reference['base_over_plain']:.3f}."
    )
    if others.empty:
        return head
    ranked = others.sort_values("over_reference", ascending=False)
    moved = [f"{row.candidate} ({row.over_reference:.2f})" for row in ranked.itertuples()]
    above = [row.candidate for row in ranked.itertuples() if row.wear_over_plain >= source]
    holds = [row.candidate for row in ranked.itertuples() if row.ratio_low <= source <= row.ratio_high]
    off = [f"{row.candidate} ({row.base_over_plain:.3f})" for row in ranked.itertuples() if is_off(row, base)]
    return (
        f"{head} Over that ratio, largest first: {'; '.join(moved)}. Above the source's ratio:"
        f" {'; '.join(above) or 'none of them'}. Intervals that hold it: {'; '.join(holds) or 'none'}. Base more than"
        f" {PERCENT * ABOUT:g} % off the source's: {'; '.join(off) or 'none'}."
    )


def is_off(row, base: float) -> bool:
    """Return whether a candidate's base misses the source's by more than the margin of what is told as one value."""
    return abs(row.base_over_plain / base - 1.0) > ABOUT


def versions_words(runs: pd.DataFrame) -> str:
    """Return what simulated which scales, where that was more than one version of the code."""
    by = {name: sorted(of["particle_scale"].unique()) for name, of in runs.groupby(BY, sort=False)}
    if len(by) < 2:
        return ""
    told = (f"scale {', '.join(f'{scale:g}' for scale in scales)} by {name}" for name, scales in by.items())
    return f" Simulated {'; '.join(told)}."


def scatter_words(table: pd.DataFrame) -> str:
    """Return what the intervals rest on, or why there are none."""
    freedom = table["freedom"].max()
    if not freedom:
        return "Every line is one packing, convex and plain sample in the same bed: the scatter is not known."
    return (
        "Low and high are 95 % intervals: what is repeated is the packing, convex and plain sample in the same bed, and"
        f" {ASSUMED} candidates and scales, {100.0 * table['scatter'].max():.1f} % of the ratio ({freedom} degrees of"
        f" freedom). {_of_scales(table)}Without an interval: {UNKNOWN}."
    )


def _of_scales(table: pd.DataFrame) -> str:
    """Return the scatter of each particle scale, and whether it may be one for all."""
    found = table.drop_duplicates("particle_scale").dropna(subset="scatter_of_scale").set_index("particle_scale")
    found = found[found["scatter_of_scale"] > 0.0]
    if len(found) < 2:
        return ""
    told = ", ".join(f"{PERCENT * row.scatter_of_scale:.1f} at {scale:g}" for scale, row in found.iterrows())
    chance = equal_scatter(found["scatter_of_scale"].to_numpy(), found["freedom_of_scale"].to_numpy())
    said = "rejects" if chance < SIGNIFICANT else "does not reject"
    return f"By particle scale it is {told} %, and Bartlett's test {said} one for all (p = {chance:.2g}). "


def critical_part(critical: pd.DataFrame) -> list[str]:
    """Return the section of the critical scales of candidates, if three scales of any were simulated."""
    if critical.empty:
        return []
    return [
        "## Critical particle scale",
        prose(
            "Where convex and plain sample wear alike, by the forms of the study's own page: those that the packings do"
            " not reject leave an interval together, which stands under where. Nothing is extended beyond the scales;"
            " the source has about 4."
        ),
        markdown(critical[["candidate", "scales", "packings", "critical_scale", "where", "forms"]]),
        f"![Wear, convex over plain, against the particle scale, of candidates of several scales]({CURVES})",
    ]


def results_page(table: pd.DataFrame, critical: pd.DataFrame, runs: pd.DataFrame) -> str:
    """Return the page; table: as from `critical_scale.comparison`, critical: from `critical_scales`, of the runs."""
    ratio = ["kind", "packings", "wear_over_plain", "ratio_low", "ratio_high", "over_reference"]
    ratio += ["over_reference_low", "over_reference_high"]
    parts_of = ["wear_mm3_per_m_convex", "wear_mm3_per_m_plain", "base_over_plain", "bumps_over_plain"]
    parts_of += ["share_of_bumps_percent", "force_over_plain", "slip_percent_convex", "slip_percent_plain"]
    parts_of += ["velocity_percent_convex", "velocity_percent_plain", "processor_over_reference"]
    names = ["particle_scale", "candidate"]
    here = [(name, told) for name, told in CANDIDATES.items() if name in set(table["candidate"])]
    said = pd.DataFrame([{"candidate": name, "kind": told.kind, "what": told.why} for name, told in here])
    parts = [
        "# Why the critical particle scale differs: candidates",
        prose(
            "Generated by `python -m benchmarks.critical_scale`; not to be edited. What the question is, is said in"
            " [particle_size.md](particle_size.md). [Every run](critical_scale.csv);"
            f" {runs['processor_s'].sum() / 60.0:.0f} minutes of the solver's processor time.{versions_words(runs)}"
        ),
        "## Wear of the convex sample over the plain one's",
        *(prose(conclusion(rows)) for _, rows in table.groupby("particle_scale", sort=False)),
        prose(
            f"{scatter_words(table)} Kind: what the source leaves open; what is a choice of this simulation (ours);"
            " what it publishes, changed only to see how much hangs on it."
        ),
        markdown(table[[*names, *ratio]]),
        f"![Wear, convex over plain, of every candidate]({FIGURE})",
        prose(
            "Wear per metre of travel, and its two parts over the plain sample's. Force: mean normal force, convex over"
            " plain. Slip: sliding work per metre over the mean normal force, which is the velocity at the contacts"
            " over the sample's, spin included, in %. Velocity: of the particles over the sample, in % of the sample's;"
            " the source has about 45 % at scale 5 and 40 % at 8 (convex), and 10 to 15 % (plain)."
            f" Processor: the solver's processor time over that of {REFERENCE}; machines are never quite idle."
        ),
        markdown(table[[*names, *parts_of]]),
        *critical_part(critical),
        "## What was changed",
        markdown(said),
        "## Triangles that one particle touches",
        prose(
            "A candidate that these runs cannot test: the source's code is closed. Here a particle that touches several"
            " triangles at an edge or a corner of the surface has one contact. A code that gave each touched triangle"
            " the particle's whole force, in the flow or only in the sum of wear, would count the wear of a bump"
            f" several times. By geometry alone, on triangles of {1e3 * EDGE:g} mm: how many a particle touches, mean"
            f" of {SPHERES} random places, pressed in by the bed's weight on a square as wide as the particle (overlap"
            " over radius is then the same at all scales), and by ten times that."
        ),
        markdown(touched_by_scale()),
        prose(
            "On a bump the number grows with the particles, which rest on corners where six triangles meet. But on a"
            " flat it grows as well, so a code that counted every touched triangle everywhere would multiply the plain"
            " sample's wear too, and the source's pin on a flat disc of triangles of 1 mm wears what Archard's law says"
            " within 0.6 % at all scales. The candidate needs a code that counts triangles of one plane once and others"
            " each; nothing published says so. The triangles of the source's sample may also have another size."
        ),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"
