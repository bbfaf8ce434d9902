"""Tables of a study of the circular wear tester: beside experiment and thesis, and what findings are judged by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN, read_surface
from bulkwear.postproc.tables.summary import patterned_name, published_value
from bulkwear.workflows.cases.circular_tester import comparison, distribution, flow, volume
from bulkwear.workflows.cases.circular_tester.findings import Evidence, findings_table
from bulkwear.workflows.cases.circular_tester.runs import RING, SIZE, SURFACE, VOLUME, WORN_SURFACE, TesterRun, pair_of
from bulkwear.workflows.cases.circular_tester.volume import (
    CONVEX,
    LONG,
    SHORT,
    chosen,
    chosen_fit,
    of_surface,
    published_terms,
    volume_at,
    whole_revolutions,
)

LABORATORY, THESIS, OURS = "experiment", "thesis' model", "ours"
THESIS_ALIKE = "thesis, our particle scale"
COMPARED = ["hours", "quantity", "unit", LABORATORY, THESIS, THESIS_ALIKE, OURS, "note"]
ALIKE = 0.1  # relative; of revolutions: wear cycles end at a few places only
THESIS_SCALE = 1.0  # particle scale of Eq 6.2 and 6.3, which the thesis itself holds against its experiment
TOLD_HOURS = (SHORT, LONG)


def tables_of_runs(
    runs: Sequence[TesterRun], published: pd.DataFrame, published_fits: pd.DataFrame, published_findings: pd.DataFrame
) -> dict[str, pd.DataFrame]:
    """Return volumes, fits, time scale, predictions, comparison, crossings, ratios, series, findings of a study."""
    lost, (patterned, plain) = volume.volumes(runs), pair_of(runs)
    fits = volume.volume_fits(whole_revolutions(chosen(lost, VOLUME, SIZE)))
    terms = volume.fit_up_to(fits, plain.name, published_value(published, "plain_volume_56_h", "laboratory"))
    scale = volume.time_scale(
        terms, plain.coefficient, published, plain.distance_per_revolution, plain.width * plain.length
    )
    hours = [published_value(published, name, "laboratory") for name in TOLD_HOURS]
    predicted = volume.predictions(fits, scale, hours)
    main = predicted[predicted["run"].isin([patterned.name, plain.name])]
    compared = [comparison_table(main, published, published_fits, plain.particle_scale)]
    if patterned.surface == CONVEX:
        compared.append(_measured_losses(patterned, published, scale.revolutions(hours[-1])))
    ratios = comparison.ratios_by_revolution(whole_revolutions(chosen(lost, VOLUME, SIZE, RING)))
    tables = {
        "lost_volumes": lost,
        "fits": fits,
        "time_scale": pd.DataFrame([vars(scale)]),
        "predictions": predicted,
        "comparison": pd.concat([table for table in compared if len(table)], ignore_index=True),
        "crossings": crossings(fits),
        "ratios": ratios,
        "mean_ratios": comparison.mean_ratios(ratios, shared=False),
        "series": pd.concat([flow.series_of(run) for run in runs if run.series == VOLUME], ignore_index=True),
    }
    return tables | {"findings": findings_table(_evidence(runs, tables, hours), published_findings)}


def comparison_table(
    predicted: pd.DataFrame, published: pd.DataFrame, published_fits: pd.DataFrame, particle_scale: float
) -> pd.DataFrame:
    """Experiment, the thesis' model and ours side by side, one row per hours and quantity.

    predicted: as from `volume.predictions`; published, published_fits: config/published/circular_tester.csv and
    circular_tester_volume.csv; particle_scale: -, of our runs. The thesis' volumes come from its own fits at its own
    two revolutions for 56 h: of particle scale 1, which it holds against its experiment, and, where published, of ours.
    Columns: hours, quantity, unit, <the four>, note.
    """
    per_hour = published_value(published, "revolutions_of_short_test", "simulation") / published_value(
        published, SHORT, "laboratory"
    )
    patterned = patterned_name(predicted["surface"])
    rows = []
    for hours, of_hours in predicted[predicted["particle_scale"] == particle_scale].groupby("hours"):
        volumes = {}
        for surface in (PLAIN, patterned):
            theirs = [
                float(volume_at(published_terms(published_fits, surface, each), per_hour * hours))
                for each in (THESIS_SCALE, particle_scale)
            ]
            ours = of_surface(of_hours, surface)["volume_mm3"]
            measured = published[
                (published["quantity"] == f"{surface}_volume_{hours:g}_h") & (published["of"] == "laboratory")
            ]["value"]
            volumes[surface] = [
                measured.iloc[0] if len(measured) else np.nan,
                *theirs,
                ours.iloc[0] if len(ours) else np.nan,
            ]
        reduction = 100.0 * (1.0 - np.array(volumes[patterned]) / np.array(volumes[PLAIN]))
        beyond = "ours extrapolated" if of_hours["extrapolated"].any() else ""
        rows += [[hours, f"{surface} volume", "mm3", *values, beyond] for surface, values in volumes.items()]
        rows.append([hours, "reduction", "%", *reduction, beyond])
    table = pd.DataFrame(rows, columns=COMPARED)
    short, long = (table["hours"] == published_value(published, name, "laboratory") for name in (SHORT, LONG))
    printed = published_value(published, "reduction_56_h", "simulation")
    _note(table, short & (table["unit"] == "%"), f"the thesis' text has {printed:g} % for its model")
    _note(table, long & (table["unit"] == "mm3"), "the thesis' text swaps experiment and model here")
    return table


def _note(table: pd.DataFrame, where: pd.Series, words: str) -> None:
    """Put words before the notes of some rows."""
    table.loc[where, "note"] = [f"{words}; {said}" if said else words for said in table.loc[where, "note"]]


def _measured_losses(patterned: TesterRun, published: pd.DataFrame, wanted: float) -> pd.DataFrame:
    """Return rows of the comparison: the largest loss of the bumps that were scanned, after `wanted` revolutions."""
    (revolution, worn), *_ = distribution.cycle_surfaces(patterned, [wanted]).items()
    pristine = distribution.top_of(read_surface(patterned.folder / SURFACE))
    losses = distribution.contour_losses(pristine, worn, distribution.SHOWN_BUMPS)
    return loss_rows(losses, published, float(revolution), wanted)


def loss_rows(losses: pd.Series, published: pd.DataFrame, revolution: float, wanted: float) -> pd.DataFrame:
    """Rows of a comparison table for the largest vertical loss (mm) of bumps after the long test (Fig 6.5).

    losses: by bump, of the surface after `revolution`; wanted: revolutions that the long test stands for.
    """
    hours = published_value(published, LONG, "laboratory")
    short = revolution < wanted * (1.0 - ALIKE)
    note = f"ours after {revolution:.3g} revolutions, {hours:g} h are {wanted:.3g}" if short else ""
    table = pd.DataFrame({"quantity": [f"largest loss of {bump}" for bump in losses.index], OURS: losses.to_numpy()})
    table[LABORATORY] = [published_value(published, f"largest_loss_{bump}", "laboratory") for bump in losses.index]
    return table.assign(hours=hours, unit="mm", note=note).reindex(columns=COMPARED)


def _evidence(runs: Sequence[TesterRun], tables: Mapping[str, pd.DataFrame], hours: Sequence[float]) -> Evidence:
    """Return what findings are judged by; tables: those of `tables_of_runs`; hours: of the short and the long test."""
    patterned, plain = pair_of(runs)
    meshes = distribution.volumes_of_meshes(tables["lost_volumes"])
    left = comparison.patterns_left(tables["lost_volumes"], tables["fits"], plain.coefficient)
    _, worn = distribution.surfaces_alike([patterned, plain])
    columns = distribution.wear_by_column({run.surface: worn[run.name] for run in (patterned, plain)})
    return Evidence(
        **{name: tables[name] for name in ("fits", "predictions", "crossings", "ratios")},
        columns=columns.assign(surface=columns["run"]),
        bumps=distribution.wear_by_bump(read_surface(patterned.folder / WORN_SURFACE)),
        means=flow.flow_means(tables["series"]),
        steady=flow.steady_revolutions(tables["series"]),
        meshes=None if meshes is None else distribution.mesh_size_effect(meshes),
        worn_out=None if left is None else comparison.worn_out_at(left),
        main=plain.particle_scale,
        short=hours[0],
        long=hours[-1],
    )


def crossings(fits: pd.DataFrame) -> pd.DataFrame:
    """Return when patterns overtake plain of equal particles: particle_scale, rate_crossing, crossing (revolutions)."""
    rows = []
    for scale, of_scale in fits.groupby("particle_scale"):
        names = of_scale.drop_duplicates("run").set_index("surface")["run"]
        patterned = names[names.index != PLAIN]
        if PLAIN in names.index and len(patterned):
            terms = [chosen_fit(fits, run) for run in (names[PLAIN], patterned.iloc[0])]
            found = {"rate_crossing": volume.rate_crossing(*terms), "crossing": volume.crossing(*terms)}
            rows.append({"particle_scale": scale} | found)
    return pd.DataFrame(rows, columns=["particle_scale", "rate_crossing", "crossing"])
