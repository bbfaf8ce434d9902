"""What the runs of a circular wear tester say on claims about volumes: rates, hours, sizes, elements, machines."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import Estimate, difference, estimate
from bulkwear.postproc.statistics.verdicts import Claim
from bulkwear.workflows.cases.circular_tester.comparison import ratio_of_sums, shared_ratios
from bulkwear.workflows.cases.circular_tester.decks import CHANNEL, RING
from bulkwear.workflows.cases.circular_tester.distribution import on_finest_mesh
from bulkwear.workflows.cases.circular_tester.hours import TOO_FAR
from bulkwear.workflows.cases.circular_tester.observed import PERCENT, Builder, Evidence, Observed, change, reached
from bulkwear.workflows.cases.circular_tester.packings import estimates_by
from bulkwear.workflows.cases.circular_tester.runs import SIZE, VOLUME
from bulkwear.workflows.cases.circular_tester.volume import (
    PATTERNED,
    chosen,
    of_surface,
    settings_of,
    shared_revolutions,
    volumes_at,
)

OVERTAKING_SCALE = 4.0  # particle scale of which the source says it


def _plain_linear(seen: Observed, claim: Claim) -> Evidence:
    rows = of_surface(seen.of_main(seen.increments), PLAIN)
    return Evidence({"": change(rows, "increment_mm3", claim.reach)}, reached(rows))


def _convex_quadratic(seen: Observed, claim: Claim) -> Evidence:
    rows = of_surface(seen.of_sizes(seen.increments), PATTERNED)
    found = {
        f"scale {scale:g}": change(each, "increment_mm3", claim.reach)
        for scale, each in rows.sort_values("particle_scale").groupby("particle_scale")
    }
    return Evidence(found, reached(rows))


def _overtakes(seen: Observed, claim: Claim) -> Evidence:
    ratios = seen.of_sizes(seen.ratios)
    of_scales = ratios.sort_values("particle_scale").groupby("particle_scale")
    last = ", ".join(f"scale {scale:g}: {_last_ratio(each)}" for scale, each in of_scales)
    further = "; ".join(filter(None, (last, _worn_out_words(seen.worn_out))))
    rows = ratios[np.isclose(ratios["particle_scale"], OVERTAKING_SCALE)]
    if rows.empty:
        reason = f"claimed of particle scale {OVERTAKING_SCALE:g}, which no pair of runs has"
        return Evidence(further=further, reason=reason)
    inside = rows[(rows["revolution"] >= claim.reach[0]) & (rows["end"] <= claim.reach[1])]
    found = {"": ratio_of_sums(inside)} if len(inside) else {}
    return Evidence(found, reached(rows), further)


def _last_ratio(ratios: pd.DataFrame) -> str:
    """Return patterned over plain in the last revolution of a machine in words."""
    shared = shared_ratios(ratios)
    last = shared[shared["revolution"] == shared["revolution"].max()]
    return f"{ratio_of_sums(last).text()} in revolution {last['end'].iloc[0]:g}"


def _worn_out_words(worn_out: pd.DataFrame | None) -> str:
    """Return when patterns that are worn right off come to lose more than plain."""
    if worn_out is None:
        return ""
    rows = worn_out.dropna(subset="faster_revolution")
    if rows.empty:
        return "worn right off, never faster"
    told = [
        f"{row.faster_revolution:.3g} ({PERCENT * row.faster_share:.3g} % of the pattern left)"
        for row in rows.itertuples()
    ]
    return f"worn right off, first faster at revolution {', '.join(told)}"


# ---------------------------------------------------------------- hours, sizes, machines


def _less(seen: Observed, claim: Claim) -> Evidence:
    """Return patterned over plain, lost between the hours of the claim's range."""
    rows = seen.of_main(chosen(seen.lost, VOLUME))
    ends = [hours / seen.hours_per_revolution for hours in claim.reach]
    first, last = ([volumes_at(of_surface(rows, each), end) for each in (PATTERNED, PLAIN)] for end in ends)
    ratio = ((last[0] - first[0]) / (last[1] - first[1])).dropna()
    found = {"": estimate(ratio, log=True)} if len(ratio) else {}
    ended = shared_revolutions(rows) * seen.hours_per_revolution
    further = (f"extrapolated beyond {ended:.3g} h" if found else TOO_FAR) if ended < claim.reach[1] else ""
    return Evidence(found, (0.0, ended), further)


def _at_first(seen: Observed, claim: Claim) -> Evidence:
    """Return patterned over plain, lost in the revolutions of the claim's range."""
    rows = seen.of_main(seen.ratios)
    inside = rows[rows["end"] <= claim.reach[1]]
    return Evidence({"": ratio_of_sums(inside)} if len(inside) else {}, reached(rows))


def _scales(seen: Observed, surface: str) -> dict[float, Estimate]:
    """Return the volume that a surface loses over the revolutions which all particle scales have, by scale."""
    rows = of_surface(seen.of_sizes(chosen(seen.lost, VOLUME, SIZE)), surface)
    if rows.empty:
        return {}
    last = shared_revolutions(rows)
    found = {each["particle_scale"]: estimate(volumes_at(of, last), log=True) for each, of in settings_of(rows)}
    return dict(sorted(found.items()))


def _by_size(seen: Observed, surface: str, every: bool) -> Evidence:
    """Return the volume at each particle scale over that at every smaller one, or at the next smaller one."""
    volumes = _scales(seen, surface)
    if len(volumes) < 2:
        return Evidence(reason="one particle scale only")
    scales = list(volumes)
    pairs = [(low, high) for low in scales for high in scales if low < high] if every else list(pairwise(scales))
    found = {f"scale {high:g} over {low:g}": difference(volumes[high], volumes[low]) for low, high in pairs}
    return Evidence(found, (scales[0], scales[-1]))


def _machines(seen: Observed, claim: Claim) -> Evidence:
    """Return patterned over plain in the ring over the same in the channel, over the revolutions that both have."""
    counts = seen.ratios.groupby("particle_scale")["shape"].nunique()
    both = counts[counts > 1].index
    if both.empty:
        return Evidence(reason="no ring beside a channel of the same particles")
    rows = shared_ratios(seen.ratios[seen.ratios["particle_scale"] == both[0]])
    of = {shape: ratio_of_sums(each) for shape, each in rows.groupby("shape")}
    further = ", ".join(f"{shape} {found.text()}" for shape, found in of.items())
    return Evidence({"": difference(of[RING], of[CHANNEL])}, further=further)


def _mesh_size(seen: Observed, claim: Claim) -> Evidence:
    if seen.meshes is None:
        return Evidence(reason="no series of meshes")
    found = {
        f"{surface}, {size:g} mm": each
        for (surface, size), each in estimates_by(
            on_finest_mesh(seen.meshes), ["surface", "element_size_mm"], "ratio", log=True
        ).items()
    }
    sizes = seen.meshes["element_size_mm"]
    return Evidence(found, (float(sizes.min()), float(sizes.max())))


ON_VOLUMES: Mapping[str, Builder] = {
    "plain_linear": _plain_linear,
    "convex_quadratic": _convex_quadratic,
    "less_short": _less,
    "less_long": _less,
    "less_at_first": _at_first,
    "plain_sizes": lambda seen, claim: _by_size(seen, PLAIN, every=True),
    "convex_sizes": lambda seen, claim: _by_size(seen, PATTERNED, every=False),
    "overtakes": _overtakes,
    "mesh_size": _mesh_size,
    "machines": _machines,
}
