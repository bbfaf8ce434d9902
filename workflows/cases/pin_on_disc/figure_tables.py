"""Tables behind the figures of the pin-on-disc study, chosen from those of all its runs.

runs : as from `analysis.pin_runs.pin_runs`; contours, volumes : of all runs, as from `of_runs`; folder : of the study.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from postproc.mesh import SurfaceMesh, read_surface
from postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES, MILLIMETRES
from postproc.tables.published import published_value
from workflows.cases.pin_on_disc.coefficient import calibration_table
from workflows.cases.pin_on_disc.contours import CONTOURS, depth_map, section_table, track_radii
from workflows.cases.pin_on_disc.run_in import SIZES, revolution_statistics, run_in_revolution, whole_revolutions
from workflows.cases.pin_on_disc.runs import CALIBRATED, SCHEMES, reference_runs, same_coefficient, size_histogram
from workflows.cases.pin_on_disc.series import circular_segment
from workflows.cases.pin_on_disc.volume import groove_volume, law_volume, published_volume

TESTED = {"depth": "depth_p_value", "opening width": "width_p_value"}  # size -> column of Table 5.3
EXAMPLE_ANGLES = tuple(range(20, 380, 45))  # degrees, of the eight sections that are shown
LABORATORY_ANGLES = (40, 160, 280)  # degrees; the thesis takes three at random
MESH_ANGLE = 90  # degrees, of the section that is shown of every mesh
LAST_REVOLUTIONS = 3  # shown on top of each other
HISTOGRAM_CLASSES = 20
MAP_SPACING = 20e-6  # m, of the places across the unrolled track
MAP_SIDE = 1.2e-3  # m, shown either side of the track
SAME_VOLUME = 0.02  # -, in which the law's volume of a run is the laboratory's
CALIBRATED_FROM = 8  # revolutions on, where the thesis has its run-in behind it
TOUCHED = "per triangle, volume by Eq 5.9 over touched triangles"
PUBLISHED_FITS = "Yan 2022, Eq 5.11 to 5.15"


def only_reference(table: pd.DataFrame, runs: pd.DataFrame, published: pd.DataFrame, of: str) -> pd.DataFrame:
    """Rows of the runs that stand for the thesis', the conserving one first; of : as in `reference_runs`."""
    chosen = reference_runs(runs, published, of)
    return pd.concat([table[table["run"] == run] for run in chosen.values()], ignore_index=True)


def statistics_of(runs: pd.DataFrame, contours: pd.DataFrame) -> pd.DataFrame:
    """Statistics per run and revolution with the scheme of the run."""
    return revolution_statistics(contours).merge(runs[["run", "scheme"]], on="run")


def run_in_words(statistics: pd.DataFrame, normality: pd.DataFrame) -> dict[str, str]:
    """What the test says of each tested size: from which revolution on it is normal, by scheme and in the thesis.

    statistics : of one run per scheme; normality : Table 5.3.
    """
    words = {}
    for size, column in TESTED.items():
        of_size = statistics[statistics["size"] == size]
        found = {
            scheme.replace("_", " "): run_in_revolution(rows["revolution"], rows["p_value"])
            for scheme, rows in of_size.groupby("scheme", sort=False)
        }
        found["Yan"] = run_in_revolution(normality["revolution"], normality[column])
        words[size] = "normal from: " + ", ".join(f"{name} {number or 'never'}" for name, number in found.items())
    return words


def histograms(contours: pd.DataFrame) -> pd.DataFrame:
    """Histograms of depth and opening (m) of one revolution per scheme: `scheme`, `size` and as `size_histogram`."""
    return pd.concat(
        [
            size_histogram(rows[SIZES[size]].to_numpy(), HISTOGRAM_CLASSES).assign(scheme=scheme, size=size)
            for scheme, rows in contours.groupby("scheme", sort=False)
            for size in TESTED
        ],
        ignore_index=True,
    )


def published_ranges(published: pd.DataFrame) -> pd.DataFrame:
    """Published ranges of depth and opening after ten revolutions: `size`, `least_m`, `largest_m`, `source`."""
    rows = []
    for size, name in (("depth", "depth"), ("opening width", "width")):
        least, largest = (
            published_value(published, f"{part}_{name}_after_10", "simulation") / MILLIMETRES
            for part in ("least", "largest")
        )
        source = published.loc[published["quantity"] == f"least_{name}_after_10", "source"].iloc[0]
        rows.append({"size": size, "least_m": least, "largest_m": largest, "source": source})
    return pd.DataFrame(rows)


def common_revolution(table: pd.DataFrame, at_most: int) -> int:
    """Last revolution that all runs of a table have, not beyond `at_most`."""
    return int(min(table.groupby("run")["revolution"].max().min(), at_most))


def _sections(folder: Path, run: pd.Series, revolution: int, angles: Sequence[int]) -> pd.DataFrame:
    """Sections of a run after a whole revolution."""
    ends = whole_revolutions(pd.read_csv(folder / run["run"] / "wear.csv")).set_index("revolution")["cycle"]
    surface = read_surface(folder / run["run"] / f"cycle_{ends[revolution]:03d}" / "surface.vtu")
    return section_table(surface, run["track_radius_m"], angles).assign(
        run=run["run"], scheme=run["scheme"], revolution=revolution, element_size_mm=run["element_size_mm"]
    )


def example_sections(folder: str | Path, runs: pd.DataFrame, contours: pd.DataFrame) -> pd.DataFrame:
    """Sections at eight angles after the last revolutions that all `runs` have, as from `section_table`."""
    of_these = contours[contours["run"].isin(runs["run"])]
    last = common_revolution(of_these, of_these["revolution"].max())
    return pd.concat(
        [
            _sections(Path(folder), run, revolution, EXAMPLE_ANGLES)
            for _, run in runs.iterrows()
            for revolution in range(max(last - LAST_REVOLUTIONS + 1, 1), last + 1)
        ],
        ignore_index=True,
    )


def mesh_sections(folder: str | Path, runs: pd.DataFrame, series: pd.DataFrame) -> pd.DataFrame:
    """One section of every mesh of the series after the first revolution (Yan 2022, Fig 5.8)."""
    chosen = runs[runs["run"].isin(series["run"])].sort_values("element_size_mm")
    parts = [_sections(Path(folder), run, 1, [MESH_ANGLE]) for _, run in chosen.iterrows()]
    order = {scheme: place for place, scheme in enumerate(SCHEMES)}
    return pd.concat(parts, ignore_index=True).sort_values("scheme", key=lambda names: names.map(order), kind="stable")


def compared_runs(runs: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Runs that are compared with thesis and laboratory: the reference runs, then those with the laboratory's volume.

    The law gives a run that volume if its coefficient times its revolutions is the laboratory's.
    """
    of_test, revolutions = (
        published_value(published, name, "laboratory") for name in ("wear_coefficient", "revolutions")
    )
    reach = runs["wear_coefficient_per_pa"] * runs["revolutions"] / (of_test * revolutions)
    same = (runs["series"] == "coefficient") & (np.abs(reach - 1.0) <= SAME_VOLUME)
    chosen = dict.fromkeys([*reference_runs(runs, published, CALIBRATED).values(), *runs.loc[same, "run"]])
    return runs.set_index("run", drop=False).loc[list(chosen)].reset_index(drop=True)


def case_name(run: pd.Series, revolution: int) -> str:
    """What a compared run is called."""
    scheme = run["scheme"].replace("_", " ")
    return f"{scheme}, {1e11 * run['wear_coefficient_per_pa']:.3g}e-11/Pa, {revolution} rev."


def compared_cases(compared: pd.DataFrame, contours: pd.DataFrame, volumes: pd.DataFrame, published) -> pd.DataFrame:
    """Mean depth, mean opening (mm) and removed volume (mm3) of compared runs after the thesis' revolutions, or fewer.

    Last comes the groove of the pin's own shape with the laboratory's volume. Columns: case, run, depth_mm, width_mm,
    volume_mm3.
    """
    rows = []
    for _, run in compared.iterrows():
        of_run = contours[contours["run"] == run["run"]]
        last = common_revolution(of_run, int(published_value(published, "revolutions", "simulation")))
        sizes = MILLIMETRES * of_run[of_run["revolution"] == last][["depth_m", "opening_width_m"]].mean()
        at_end = (volumes["run"] == run["run"]) & (volumes["revolution"] == last)
        volume = CUBIC_MILLIMETRES * float(volumes.loc[at_end, "removed_volume_m3"].iloc[0])
        values = {"depth_mm": sizes["depth_m"], "width_mm": sizes["opening_width_m"], "volume_mm3": volume}
        rows.append({"case": case_name(run, last), "run": run["run"]} | values)
    depth, width = laboratory_segment(published)
    volume = published_value(published, "volume", "laboratory")
    rows.append({"case": "pin's shape", "run": "", "depth_mm": depth, "width_mm": width, "volume_mm3": volume})
    return pd.DataFrame(rows)


def laboratory_segment(published: pd.DataFrame) -> tuple[float, float]:
    """Depth and width (mm) of a groove of the pin's own shape that has the laboratory's volume all round the track."""
    circumference = 2.0 * np.pi * published_value(published, "track_radius", "laboratory")
    area = published_value(published, "volume", "laboratory") / circumference
    return circular_segment(area, published_value(published, "pin_radius", "laboratory"))


def laboratory_boxes(published: pd.DataFrame) -> pd.DataFrame:
    """Least and largest depth and width (mm) of the laboratory's contours."""
    parts = (("laboratory, least", "least_"), ("laboratory, largest", ""))
    return pd.DataFrame(
        [
            {"of": words}
            | {f"{size}_mm": published_value(published, f"{part}{size}", "laboratory") for size in ("depth", "width")}
            for words, part in parts
        ]
    )


def laboratory_sections(folder: str | Path, compared: pd.DataFrame, cases: pd.DataFrame) -> pd.DataFrame:
    """Sections of the worn discs of compared runs at three angles: `case` and as from `section_table`."""
    names = cases.set_index("run")["case"]
    return pd.concat(
        [
            section_table(
                read_surface(Path(folder) / run["run"] / "worn_surface.vtu"), run["track_radius_m"], LABORATORY_ANGLES
            ).assign(case=names[run["run"]])
            for _, run in compared.iterrows()
        ],
        ignore_index=True,
    )


def calibrated(volumes: pd.DataFrame, fits: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Calibration of both schemes, of Eq 5.9 and of the published fits against the laboratory's volume.

    volumes : of all runs; each number of revolutions from CALIBRATED_FROM on (or the last, if a run is shorter) is
    calibrated with the runs that have it; the published fits where they grow with the coefficient. As from
    `analysis.coefficient.calibration_table`.
    """
    ours = volumes[volumes["series"] == "coefficient"].rename(columns={"removed_volume_m3": "volume_m3"})
    touched = ours[ours["scheme"] == "per_triangle"]
    touched = touched.assign(volume_m3=touched["touched_centroid_path_volume_m3"], scheme=TOUCHED)
    ours = pd.concat([ours, touched], ignore_index=True)
    longest = int(ours["revolution"].max())
    shown = range(min(CALIBRATED_FROM, longest), longest + 1)
    simulated = pd.concat([ours[ours["revolution"].isin(shown)], growing_fits(fits, shown)], ignore_index=True)
    volume, error = laboratory_volume(published)
    return calibration_table(simulated, volume, error, published_value(published, "revolutions", "laboratory"))


def growing_fits(fits: pd.DataFrame, revolutions: Sequence[int]) -> pd.DataFrame:
    """Volumes (m3) by the published fits after those revolutions where they grow with the wear coefficient.

    After 1 and 2 the fit of 2e-11 1/Pa lies below that of 1.7e-11 (Yan 2022, Eq 5.11 to 5.15): no coefficient
    follows from a volume. Columns: scheme, revolution, wear_coefficient_per_pa, volume_m3.
    """
    coefficients = np.sort(fits["wear_coefficient_per_pa"].to_numpy())
    parts = []
    for revolution in revolutions:
        volume = np.array([float(published_volume(fits, coefficient, revolution)) for coefficient in coefficients])
        if volume[0] > 0.0 and (np.diff(volume) > 0.0).all():
            columns = {"scheme": PUBLISHED_FITS, "revolution": revolution, "wear_coefficient_per_pa": coefficients}
            parts.append(pd.DataFrame(columns | {"volume_m3": volume}))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()


def laboratory_volume(published: pd.DataFrame) -> tuple[float, float]:
    """The laboratory's volume and its error, m3."""
    row = published[(published["quantity"] == "volume") & (published["of"] == "laboratory")].iloc[0]
    return row["value"] / CUBIC_MILLIMETRES, row["uncertainty"] / CUBIC_MILLIMETRES


def shown_factors(factors: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Rows of `excess_factors` that the figure shows: least, thesis' and largest coefficient, first and last.

    Only of coefficients with a published fit; of the conserving scheme, which has little to separate, the last one,
    and not for the least coefficient.
    """
    factors = factors[factors["published"].notna()]
    coefficients = factors["wear_coefficient_per_pa"]
    thesis = published_value(published, "wear_coefficient", "simulation")
    wanted = dict.fromkeys((coefficients.min(), thesis, coefficients.max()))
    parts = []
    for scheme, coefficient in ((s, c) for s in SCHEMES for c in wanted):
        rows = same_coefficient(factors[factors["scheme"] == scheme], coefficient)
        if scheme == SCHEMES[0] and len(wanted) > 1 and coefficient == coefficients.min():
            continue
        ends = rows.sort_values("revolution").iloc[[-1] if scheme == SCHEMES[0] else [0, -1]] if len(rows) else rows
        parts.append(ends.drop_duplicates("revolution"))
    return pd.concat(parts, ignore_index=True)


def size_cases(volumes: pd.DataFrame) -> pd.DataFrame:
    """The series of scales after its last revolution, with `alpha_F_L_volume_m3`."""
    sizes = volumes[volumes["series"] == "size"]
    last = sizes.loc[sizes.groupby("run", sort=False)["revolution"].idxmax()]
    fixed = (last["wear_coefficient_per_pa"], last["load_n"], last["track_radius_m"], last["revolution"])
    return last.assign(alpha_F_L_volume_m3=law_volume(*fixed))


def reference_discs(
    folder: str | Path, runs: pd.DataFrame, published: pd.DataFrame
) -> tuple[dict[str, SurfaceMesh], float]:
    """Worn discs of the runs that stand for the thesis' Fig 5.17, by scheme, and the radius (m) of their track."""
    chosen = reference_runs(runs, published, CALIBRATED)
    meshes = {scheme: read_surface(Path(folder) / run / "worn_surface.vtu") for scheme, run in chosen.items()}
    track = runs.loc[runs["run"].isin(chosen.values()), "track_radius_m"]
    return meshes, float(track.iloc[0])


def track_map(mesh: SurfaceMesh, track_radius: float) -> pd.DataFrame:
    """Depth (um) of the unrolled track: one row per radius (index `radius_mm`), one column per whole degree."""
    radii = track_radii(mesh, track_radius, MAP_SPACING)
    radii = radii[np.abs(radii - track_radius) <= MAP_SIDE]
    index = pd.Index(MILLIMETRES * radii, name="radius_mm")
    return pd.DataFrame(MICROMETRES * depth_map(mesh, radii).T, index=index, columns=range(CONTOURS))


def groove_remark(published: pd.DataFrame) -> str:
    """What a groove of the published depth and width would hold, in words."""
    groove = published_groove(published)
    return (
        f"a round groove of the published depth and width (Yan 2022, Table 5.4) holds "
        f"{groove['groove_volume_mm3']:.2f} mm³, {groove['groove_over_published']:.1f} times the published volume "
        f"and {groove['groove_over_alpha_F_L']:.0f} times $\\alpha F L$"
    )


def published_groove(published: pd.DataFrame) -> dict[str, float]:
    """What the published depth and width hold against the published volume (mm3) and alpha F L.

    groove_volume_mm3, published_volume_mm3, alpha_F_L_volume_mm3, groove_over_published, groove_over_alpha_F_L.
    """
    depth, width, volume, coefficient, revolutions = (
        published_value(published, name, "simulation")
        for name in ("depth", "width", "volume", "wear_coefficient", "revolutions")
    )
    track = published_value(published, "track_radius", "laboratory") / MILLIMETRES
    held = CUBIC_MILLIMETRES * groove_volume(depth / MILLIMETRES, width / MILLIMETRES, track)
    load = published_value(published, "load", "laboratory")
    law = CUBIC_MILLIMETRES * float(law_volume(coefficient, load, track, revolutions))
    return {
        "groove_volume_mm3": held,
        "published_volume_mm3": volume,
        "alpha_F_L_volume_mm3": law,
        "groove_over_published": held / volume,
        "groove_over_alpha_F_L": held / law,
    }
