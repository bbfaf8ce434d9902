"""Tables of a study of the circular wear tester from its runs, and what its findings are judged by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd

from postproc.mesh import read_surface
from postproc.tables.published import published_value
from postproc.tables.summary import PLAIN
from workflows.cases.circular_tester import comparison, distribution, flow, volume
from workflows.cases.circular_tester.findings import Evidence, findings_table
from workflows.cases.circular_tester.runs import RING, SIZE, SURFACE, VOLUME, WORN_SURFACE, TesterRun, pair_of
from workflows.cases.circular_tester.volume import chosen, chosen_fit, whole_revolutions

TOLD_HOURS = (volume.SHORT, volume.LONG)


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
    compared = [
        volume.comparison_table(main, published, published_fits, plain.particle_scale),
        _measured_losses(patterned, published, scale.revolutions(hours[-1])),
    ]
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


def _measured_losses(patterned: TesterRun, published: pd.DataFrame, wanted: float) -> pd.DataFrame:
    """Return rows of the comparison: the largest loss of the bumps that were scanned, after `wanted` revolutions."""
    (revolution, worn), *_ = distribution.cycle_surfaces(patterned, [wanted]).items()
    pristine = distribution.top_of(read_surface(patterned.folder / SURFACE))
    losses = distribution.contour_losses(pristine, worn, distribution.SHOWN_BUMPS)
    return volume.loss_rows(losses, published, float(revolution), wanted)


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
