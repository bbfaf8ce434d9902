"""Tables of a study of the circular wear tester: beside experiment and thesis, and what findings are judged by."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN, read_surface
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.statistics.verdicts import Claim
from bulkwear.postproc.tables.summary import patterned_name, published_value
from bulkwear.workflows.cases.circular_tester import comparison, distribution, flow, hours, volume
from bulkwear.workflows.cases.circular_tester.findings import findings_table
from bulkwear.workflows.cases.circular_tester.hours import LONG, SHORT
from bulkwear.workflows.cases.circular_tester.observed import Observed
from bulkwear.workflows.cases.circular_tester.packings import HIGH, LOW, PACKING, over_packings
from bulkwear.workflows.cases.circular_tester.runs import RING, SIZE, SURFACE, VOLUME, TesterRun, pairs_of
from bulkwear.workflows.cases.circular_tester.volume import (
    chosen,
    of_surface,
    published_terms,
    volume_of_terms,
    whole_revolutions,
)

LABORATORY, THESIS, OURS = "experiment", "thesis' model", "ours"
THESIS_ALIKE = "thesis, our particle scale"
COMPARED = ["hours", "quantity", "unit", LABORATORY, THESIS, THESIS_ALIKE, OURS, "packings", LOW, HIGH, "note"]
ALIKE = 0.1  # relative; of revolutions: wear cycles end at a few places only
THESIS_SCALE = 1.0  # particle scale of Eq 6.2 and 6.3, which the thesis itself holds against its experiment
TOLD_HOURS = (SHORT, LONG)
BEYOND = "ours extrapolated"


def tables_of_runs(
    runs: Sequence[TesterRun],
    published: pd.DataFrame,
    published_fits: pd.DataFrame,
    claims: Mapping[str, Claim],
    foreign: Mapping[str, str],
) -> dict[str, pd.DataFrame]:
    """Return volumes, rates, time scale, predictions, comparison, ratios, series and findings of a study.

    foreign: as from `source.unlike_source`
    """
    lost, (patterned, plain) = volume.volumes(runs), pairs_of(runs)[0]
    of_sizes = chosen(lost, VOLUME, SIZE)
    scale = hours.time_scale(of_surface(chosen(lost, VOLUME), PLAIN), plain, published)
    told = [published_value(published, name, "laboratory") for name in TOLD_HOURS]
    predicted = hours.predictions(of_sizes, scale, told)
    main = predicted[(predicted["shape"] == plain.shape) & (predicted["particle_scale"] == plain.particle_scale)]
    compared = [comparison_table(main, published, published_fits, plain.particle_scale, foreign)]
    if patterned.surface not in foreign:
        compared.append(_measured_losses(runs, published, scale.revolutions(told[-1])))
    tables = {
        "lost_volumes": lost,
        "rates": volume.rates(of_sizes),
        "time_scale": scale.table(),
        "predictions": predicted,
        "comparison": pd.concat([table for table in compared if len(table)], ignore_index=True),
        "ratios": comparison.ratios_by_revolution(whole_revolutions(chosen(lost, VOLUME, SIZE, RING))),
        "series": pd.concat([flow.series_of(run) for run in runs if run.series == VOLUME], ignore_index=True),
    }
    tables["mean_ratios"] = comparison.mean_ratios(tables["ratios"], shared=False)
    seen = replace(
        observed(runs, tables, scale.hours_per_revolution),
        foreign=foreign,
        times_source=volume.times_source(plain.coefficient, published),
    )
    return tables | {"findings": findings_table(seen, claims)}


def comparison_table(
    predicted: pd.DataFrame,
    published: pd.DataFrame,
    published_fits: pd.DataFrame,
    particle_scale: float,
    foreign: Collection[str] = (),
) -> pd.DataFrame:
    """Experiment, the thesis' model and ours side by side, one row per hours and quantity.

    predicted: as from `hours.predictions`; published, published_fits: config/published/circular_tester.csv and
    circular_tester_volume.csv; particle_scale: -, of our runs. The thesis' volumes come from its own fits at its own
    two revolutions for 56 h: of particle scale 1, which it holds against its experiment, and, where published, of ours.
    foreign: surfaces that are not the source's, of which it has no volumes; that which sets the scale of time stays.
    Columns: hours, quantity, unit, <the four>, packings, interval_low and interval_high (of ours: the prediction
    interval, in which one further packing falls), note.
    """
    per_hour = published_value(published, "revolutions_of_short_test", "simulation") / published_value(
        published, SHORT, "laboratory"
    )
    patterned, own_fits = patterned_name(predicted["surface"]), volume.fits_beside(published_fits, foreign)
    short_test = published_value(published, SHORT, "laboratory")
    rows = []
    for test_hours, of_hours in predicted.groupby("hours"):
        volumes, ours = {}, {surface: of_surface(of_hours, surface).iloc[0] for surface in (PLAIN, patterned)}
        for surface in (PLAIN, patterned):
            theirs = [
                float(volume_of_terms(published_terms(own_fits, surface, each), per_hour * test_hours))
                for each in (THESIS_SCALE, particle_scale)
            ]
            measured = published[
                (published["quantity"] == f"{surface}_volume_{test_hours:g}_h") & (published["of"] == "laboratory")
            ]["value"]
            if surface in foreign and not (surface == PLAIN and test_hours == short_test):
                measured = measured.iloc[:0]
            volumes[surface] = [
                measured.iloc[0] if len(measured) else np.nan,
                *theirs,
            ]
        reduction = 100.0 * (1.0 - np.array(volumes[patterned]) / np.array(volumes[PLAIN]))
        rows += [
            [test_hours, f"{surface} volume", "mm3", *values, *_told(ours[surface], "volume_mm3")]
            for surface, values in volumes.items()
        ]
        rows.append([test_hours, "reduction", "%", *reduction, *_told(ours[patterned], "reduction_percent")])
    table = pd.DataFrame(rows, columns=COMPARED)
    short, long = (table["hours"] == published_value(published, name, "laboratory") for name in (SHORT, LONG))
    printed = published_value(published, "reduction_56_h", "simulation")
    short, long = short & table[THESIS].notna(), long & table[THESIS].notna()
    _note(table, short & (table["unit"] == "%"), f"the thesis' text has {printed:g} % for its model")
    _note(table, long & (table["unit"] == "mm3"), "the thesis' text swaps experiment and model here")
    return table


def _told(row: pd.Series, name: str) -> list[object]:
    """Return ours, packings, the ends of the interval and the note of a prediction."""
    said = [row["reason"] or (BEYOND if row["extrapolated"] else ""), UNKNOWN if row["packings"] < 2 else ""]
    return [row[name], row["packings"], row[f"{name}_low"], row[f"{name}_high"], "; ".join(filter(None, said))]


def _note(table: pd.DataFrame, where: pd.Series, words: str) -> None:
    """Put words before the notes of some rows."""
    table.loc[where, "note"] = [f"{words}; {said}" if said else words for said in table.loc[where, "note"]]


def _measured_losses(runs: Sequence[TesterRun], published: pd.DataFrame, wanted: float) -> pd.DataFrame:
    """Return rows of the comparison: the largest loss of the bumps that were scanned, after `wanted` revolutions."""
    parts, reached = [], np.inf
    for patterned, _ in pairs_of(runs):
        (revolution, worn), *_ = distribution.cycle_surfaces(patterned, [wanted]).items()
        pristine = distribution.top_of(read_surface(patterned.folder / SURFACE))
        losses = distribution.contour_losses(pristine, worn, distribution.SHOWN_BUMPS)
        parts.append(losses.rename("loss_mm").rename_axis("bump").reset_index().assign(packing=patterned.packing))
        reached = min(reached, float(revolution))
    return loss_rows(pd.concat(parts), published, reached, wanted)


def loss_rows(losses: pd.DataFrame, published: pd.DataFrame, revolution: float, wanted: float) -> pd.DataFrame:
    """Rows of a comparison table for the largest vertical loss of bumps after the long test (Fig 6.5).

    losses: bump, packing, loss_mm, of the surface after `revolution`; wanted: revolutions that the long test stands for
    """
    test_hours = published_value(published, LONG, "laboratory")
    short = revolution < wanted * (1.0 - ALIKE)
    notes = [f"ours after {revolution:.3g} revolutions, {test_hours:g} h are {wanted:.3g}" if short else ""]
    notes.append(UNKNOWN if losses[PACKING].nunique() < 2 else "")
    table = over_packings(losses, ["bump"], "loss_mm").rename(columns={"loss_mm": OURS})
    table["quantity"] = "largest loss of " + table["bump"]
    table[LABORATORY] = [published_value(published, f"largest_loss_{bump}", "laboratory") for bump in table["bump"]]
    note = "; ".join(filter(None, notes))
    return table.assign(hours=test_hours, unit="mm", note=note).reindex(columns=COMPARED)


def observed(runs: Sequence[TesterRun], tables: Mapping[str, pd.DataFrame], hours_per_revolution: float) -> Observed:
    """Return what findings are judged by; tables: those of `tables_of_runs`."""
    pairs, lost = pairs_of(runs), tables["lost_volumes"]
    both = [run for pair in pairs for run in pair]
    plain = pairs[0][1]
    left = comparison.patterns_left(lost, tables["rates"], plain.coefficient)
    _, worn = distribution.surfaces_alike(both)
    return Observed(
        lost=lost,
        increments=volume.element_increments(whole_revolutions(chosen(lost, VOLUME, SIZE, RING))),
        ratios=tables["ratios"],
        columns=distribution.of_runs(distribution.wear_by_column(worn, distribution.borders_of(pairs[0][0])), both),
        bumps=distribution.wear_by_bump({patterned.packing: worn[patterned.name] for patterned, _ in pairs}),
        means=flow.flow_means(tables["series"]),
        steady_means=flow.revolution_means(tables["series"], flow.STEADINESS),
        hours_per_revolution=hours_per_revolution,
        shape=plain.shape,
        scale=plain.particle_scale,
        meshes=distribution.volumes_of_meshes(lost),
        worn_out=None if left is None else comparison.worn_out_at(left),
    )
