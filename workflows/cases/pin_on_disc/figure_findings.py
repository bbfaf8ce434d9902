"""What the figures of pins on discs show, in one sentence each, from the tables beside them. Each run is made once."""

from __future__ import annotations

import pandas as pd

from bulkwear.workflows.report.sentences import PERCENT, capital, listed, measured, spoken
from bulkwear.workflows.report.text import number, range_text

END = ["scheme", "wear_coefficient_per_pa"]


def at_coefficient(coefficient: float) -> str:
    """Return a wear coefficient in words."""
    return f"{coefficient:.3g} 1/Pa"


def by_scheme(table: pd.DataFrame, values: pd.Series, unit: str = "") -> str:
    """Return the range of values by scheme: 1 (conserving) and 6.1 to 6.4 (per triangle)."""
    ending = f" {unit}" if unit else ""
    said = [
        f"{range_text(each.tolist())}{ending} ({spoken(str(scheme))})"
        for scheme, each in values.groupby(table["scheme"], sort=False)
    ]
    return listed(said)


# ---------------------------------------------------------------- set-up


def setup(runs: pd.DataFrame) -> str:
    """Return size and load of the pin and the radius of its track. runs: the run that is drawn."""
    run = runs.iloc[0]
    radius, track = (measured(run[f"{name}_radius_mm"], "mm") for name in ("pin", "track"))
    return f"A pin with a radius of {radius} goes round a track of {track} under {measured(run['load_n'], 'N')}."


def groove(section: pd.DataFrame) -> str:
    """Return how deep the groove of a section is, and where. section: as from `contours.section_table`."""
    deepest = section.loc[section["depth_um"].idxmax()]
    place = f"at {deepest['angle_deg']:.0f} degrees"
    if not deepest["depth_um"] > 0.0:
        return f"The disc has no groove {place}."
    across = round(deepest["across_mm"], 2)
    return (
        f"The groove is {measured(deepest['depth_um'], 'µm')} deep {place}, {across:g} mm from the middle of the track."
    )


# ---------------------------------------------------------------- volume


def beside_laboratory(table: pd.DataFrame) -> list[str]:
    """Return volume, depth and width of each of our runs over those of laboratory and thesis.

    table: as from `comparison.comparison`
    """
    said = []
    for _, row in table[table["run"].notna() & (table["run"] != "")].iterrows():
        volume, depth, width = (
            [number(1.0 + row[f"{each}_to_{source}_percent"] / PERCENT, 2) for source in ("laboratory", "thesis")]
            for each in ("volume", "depth", "width")
        )
        said.append(
            f"{capital(row['case'])}, removes {measured(row['volume_mm3'], 'mm³')}, {volume[0]} times the laboratory's"
            f" and {volume[1]} times the thesis' volume; the groove is {depth[0]} and {depth[1]} times as deep and"
            f" {width[0]} and {width[1]} times as wide as theirs."
        )
    return said


def compared(table: pd.DataFrame) -> str:
    """Return the first of our runs beside the laboratory's test."""
    return next(iter(beside_laboratory(table)), "")


def excess(shown: pd.DataFrame) -> str:
    """Return how much of the published excess the rules make after the last revolutions; shown: `shown_factors`."""
    last = shown.loc[shown.groupby(END, sort=False)["revolution"].idxmax()]
    said = [
        f"{number(row.product, 2)} of {number(row.published, 2)} ({spoken(row.scheme)},"
        f" {at_coefficient(row.wear_coefficient_per_pa)})"
        for row in last.itertuples()
    ]
    return f"Of the published multiples of alpha F L the rules make {listed(said)}."


def over_law(volumes: pd.DataFrame) -> str:
    """Return what discs have lost over alpha F L by scheme; volumes: of all revolutions of the coefficients' runs."""
    from bulkwear.workflows.cases.pin_on_disc.volume import FIXED, law_volume  # slow to import

    last = volumes.loc[volumes.groupby("run", sort=False)["revolution"].idxmax()]
    ratio = last["removed_volume_m3"] / law_volume(*(last[name] for name in FIXED), last["revolution"])
    times = by_scheme(last, ratio)
    return f"In the end discs have lost {times} times alpha F L."


def force_over_load(factors: pd.DataFrame) -> str:
    """Return the summed normal force over the load, and contacts at once, after the last revolution of each run."""
    last = factors.loc[factors.groupby("run", sort=False)["revolution"].idxmax()]
    rise, contacts = (by_scheme(last, last[name]) for name in ("force_rise", "contacts"))
    return f"The summed normal force is in the end {rise} times the load, with {contacts} contacts at once."


def coefficients(table: pd.DataFrame) -> str:
    """Return the coefficients that make the most revolutions stand for the laboratory's test.

    table: as from `coefficient.calibration_table`
    """
    count = table["revolutions"].max()
    said = []
    for row in table[table["revolutions"] == count].itertuples():
        how = "" if row.interpolated else ", extrapolated"
        said.append(f"{at_coefficient(row.wear_coefficient_per_pa)} ({spoken(row.scheme)}{how})")
    return f"{count:g} revolutions remove the laboratory's volume with {listed(said)}."


def sizes(table: pd.DataFrame) -> str:
    """Return how far volumes of scaled pins are off alpha F L; table: as from `volume.size_invariance`."""
    off, scales = table["difference_percent"].abs().max(), range_text(table["particle_scale"].tolist())
    return f"Volumes of pins of scale {scales} differ from alpha F L by up to {off:.2g} %."


# ---------------------------------------------------------------- groove


def depth_by_mesh(sections: pd.DataFrame) -> str:
    """Return how deep a contour is on the finest and on the coarsest elements, by scheme."""
    said = []
    for scheme, rows in sections.groupby("scheme", sort=False):
        deepest = rows.groupby("element_size_mm")["depth_um"].max()
        ends = listed(
            [f"{measured(deepest[size], 'µm')} on {size:g} mm" for size in dict.fromkeys(deepest.index[[0, -1]])]
        )
        said.append(f"{ends} ({spoken(str(scheme))})")
    return f"After one revolution the contour is as deep as {'; '.join(said)}."


def forces(boxes: pd.DataFrame) -> str:
    """Return the mean forces of the last revolution of each run; boxes: as from `runs.force_boxes`."""
    last = boxes[boxes["revolution"] == boxes.groupby("run")["revolution"].transform("max")]
    means = last.pivot_table(index="run", columns="force", values="mean_N", sort=False)
    said = [
        f"{measured(row['vertical_force'], 'N', 3)} of vertical and {measured(row['normal_force'], 'N', 3)} of summed"
        f" normal force ({run})"
        for run, row in means.iterrows()
    ]
    return f"Means of the last revolution: {'; '.join(said)}."


def normality(bars: pd.DataFrame) -> str:
    """Return which sizes are distributed normally round the disc; bars: as from `run_in.histograms`."""
    from bulkwear.workflows.cases.pin_on_disc.run_in import SIGNIFICANCE  # slow to import

    found = bars.groupby(["scheme", "size"], sort=False)["p_value"].first()
    names = {
        passed: [
            f"{size} ({spoken(scheme)}, p {p:.2g})"
            for (scheme, size), p in found.items()
            if (p > SIGNIFICANCE) == passed
        ]
        for passed in (True, False)
    }
    said = [f"{listed(each)} {'pass' if passed else 'fail'}" for passed, each in names.items() if each]
    return f"Of the tests of normality {'; '.join(said)}."


def ended(statistics: pd.DataFrame) -> str:
    """Return how many run-ins have ended by the source's rule; statistics: as from `run_in.statistics_of`."""
    from bulkwear.workflows.cases.pin_on_disc.run_in import TESTED, run_in_revolution  # slow to import

    ends = []
    for _, rows in statistics[statistics["size"].isin(TESTED)].groupby("run", sort=False):
        p_values = rows.pivot(index="revolution", columns="size", values="p_value")
        ends.append(run_in_revolution(p_values.index, *p_values.to_numpy(float).T))
    known = [end for end in ends if end is not None]
    said = (
        f"By the source's rule the run-in of {len(known)} of {len(ends)} discs has ended in the revolutions simulated"
    )
    return f"{said}, with revolution {range_text(known)}." if known else f"{said}."


def deepest_contours(sections: pd.DataFrame, by: str = "scheme", at: str = "angle_deg") -> str:
    """Return the mean depth of the contours shown; sections: depth_um by angle, of the last revolution shown."""
    if "revolution" in sections:
        sections = sections[sections["revolution"] == sections["revolution"].max()]
    means = sections.groupby([by, at], sort=False)["depth_um"].max().groupby(level=0, sort=False).mean()
    said = [f"{measured(depth, 'µm')} ({spoken(str(name))})" for name, depth in means.items()]
    return f"The contours are on average {listed(said)} deep."


def contours_by_case(sections: pd.DataFrame) -> str:
    """Return the mean depth of the contours beside the laboratory's."""
    return deepest_contours(sections, "case")


def deepest_places(track: pd.DataFrame) -> str:
    """Return where each track is deepest, and its mean; track: as from `contours.track_table`."""
    said = []
    for scheme, rows in track.groupby("scheme", sort=False):
        along = rows.drop(columns=["radius_mm", "scheme"]).max()
        mean, most = measured(along.mean(), "µm"), measured(along.max(), "µm")
        said.append(f"{mean} ({spoken(str(scheme))}; deepest {most}, at {along.idxmax()} degrees)")
    return f"Round the disc the track is on average as deep as {listed(said)}."
