"""Numbers of the circular wear tester that its page tells are those of the tables beside it, rounded."""

import math
import re

from benchmarks.path_of_centres import OF_TESTER, TESTER_SCALE, compared
from benchmarks.scale_case import SURFACES
from tests.support.told import rows, table, told

BUMPS = [f"Largest loss of {bump} after 240.3 mm3" for bump in ("C11", "C13", "C15")]  # findings


def reached():
    """Published numbers of the tester by pair of samples (rows) and quantity (columns): values, whether they agree."""
    found = table("tables/tester_sensitivity_quick_sensitivity.csv")
    return found.pivot(index="pair", columns="quantity", values="value"), found.groupby("pair")["reached"].sum()


def test_what_seventeen_revolutions_of_the_tester_show():
    """Volumes after 56 and 184 h with their intervals, growth over the run, convex over plain."""
    page, results = told("circular_tester.md"), "circular_tester_results_quick.md"
    lost = rows(results, "hours", "quantity").set_index(["hours", "quantity"])
    columns = ["ours", "interval low", "interval high"]
    told_56, told_184 = (lost.loc[(hours, "convex volume"), columns].astype(float) for hours in ("56", "184"))
    assert "After 56 h the convex sample has lost {:.0f} mm³ ({:.0f} to {:.0f} for".format(*told_56) in page
    assert "After 184 h it has lost {:.0f} mm³ ({:.0f} to {:.0f}; measured".format(*told_184) in page
    reduction = lost.loc[("56", "reduction"), columns].astype(float)
    assert "{:.0f} % less than the plain one ({:.0f} to {:.0f}; measured".format(*reduction) in page
    means = table("published/circular_tester_results_quick.csv").set_index("finding")["found"]
    low, high = re.search(r"interval (\S+) to (\S+)\)", means["convex volume, experiment after 56 h"]).groups()
    assert f"the interval of the mean, {float(low):.0f} to {float(high):.0f}, lies above it" in page
    assert told_56.iloc[1] < 82.8 < float(low)
    rates = rows(results, "surface", "shape", "particle scale", "packings", "revolutions", "rate mm3 per revolution")
    columns = ["change percent", "change percent low", "change percent high"]
    plain, convex = (rates.set_index("surface").loc[each, columns].astype(float) for each in ("plain", "convex"))
    assert (
        f"falls by {-plain.iloc[0]:.1f} % of the mean ({-plain.iloc[1]:.1f} less to {plain.iloc[2]:.1f} more)" in page
    )
    assert "The convex one's grows by {:.0f} % ({:.0f} to {:.0f})".format(*convex) in page
    ratio = rows(results, "shape", "particle scale", "revolutions", "packings", "ratio").iloc[0]
    assert (
        f"it loses {ratio['ratio']} of the plain one's volume ({ratio['ratio low']} to {ratio['ratio high']})" in page
    )


def test_what_presses_on_the_tester_and_how_fast_it_passes():
    """Weights of level bed and heap (N) at the bulk densities of bed and source; velocity over the sample and of the
    whole bed.
    """
    page, results = told("circular_tester.md"), "circular_tester_results_quick.md"
    beds = rows(results, "bed", "settings", "packing")
    found = beds["bulk density found kg per m3"].str.replace("\u202f", "").astype(float).mean()
    loose, dense = (density * 9.81 * 0.1 * 0.1 / 1e3 for density in (found, 1455.0))  # N per mm
    depth = beds["depth found mm"].astype(float).mean()
    means = table("tables/circular_tester_quick_steadiness.csv").query("surface == 'plain'").groupby("measure")["mean"]
    height, speed = 1e3 * means.mean()["bed_height_m"], means.mean()["velocity_m_per_s"]
    assert f"At {found:.0f} kg/m³, which" in page
    assert f"the level bed weighs {loose * depth:.1f} to {dense * depth:.1f} N" in page
    assert f"[{height:.0f} mm high](" in page and f", {loose * height:.1f} to {dense * height:.1f}. At standard" in page
    runs = rows(results, "run", "series", "surface").query("series == 'volume' and surface == 'plain'")
    bed = runs["bed over floor velocity"].astype(float).mean()
    share = speed / (0.395 * math.pi / 2.0)  # the trough's mean radius (m), 90 degrees a second
    assert f"{speed:.2f} m/s, {share:.2f} of the trough's speed; the whole bed has {bed:.2f}." in page


def test_how_much_lower_bumps_of_the_tester_are():
    """Losses of the bumps that the laboratory measured."""
    page, found = told("circular_tester.md"), table("published/circular_tester_results_quick.csv").set_index("finding")
    losses = [re.match(r"(\S+) mm \(95 % interval (\S+) to (\S+),", each) for each in found.loc[BUMPS, "found"]]
    first, second, third = [[float(value) for value in each.groups()] for each in losses]
    assert "have lost up to {:.2f} mm ({:.2f} to {:.2f}), ".format(*first) in page
    assert "{:.2f} ({:.2f} to {:.2f}) and {:.2f} ({:.2f} to {:.2f}) of height, three".format(*second, *third) in page
    measured = [
        float(value) for value in re.search(r"times the (\S+), (\S+) and (\S+) that are measured", page).groups()
    ]
    factors = [loss[0] / lost for loss, lost in zip((first, second, third), measured, strict=True)]
    assert measured == [float(re.search(r"published (\S+)\)", each)[1]) for each in found.loc[BUMPS, "published"]]
    assert round(sum(factors) / 3.0) == 3


def test_what_the_incline_of_the_tester_does():
    """Forces and volumes with either end up, heaps over samples of both, and of 2 and 10 mm."""
    values, page = reached()[0], told("circular_tester.md")
    force, volume = (values[name] for name in ("Normal force, plain", "Volume per revolution, plain"))
    assert f"bears {force['incline']:.1f} N instead of {force['reference']:.1f} and" in page
    assert f"{volume['incline']:.1f} mm³ a revolution instead of {volume['reference']:.1f}, under" in page
    assert f"their mean, {force[['incline', 'reference']].mean():.1f} N, is about the heap's weight" in page
    heap = table("tables/tester_sensitivity_quick_beds_in_use.csv").set_index("run")["over_sample_in_use_mm"]
    usual = heap[["plain", "plain-2", "plain-3"]]
    assert f"({heap['thin-plain']:.0f} mm of {usual.min():.0f} to {usual.max():.0f}, under" in page
    newtons = 1455.0 * 9.81 * 0.1 * 0.1 / 1e3 * usual.mean()
    assert abs(force[["incline", "reference"]].mean() / newtons - 1.0) < 0.05 and abs(heap["incline-plain"] - 114) < 2


def test_what_settings_of_the_tester_reach():
    """Most and fewest numbers, the fastest layer, and what the settings that are named reach."""
    values, counts = reached()
    page, total = told("circular_tester.md"), values.shape[1]
    slides, volume = values["Sliding over travel, plain"], values["Volume per revolution, plain"]
    ratio, fastest = values["Convex over plain"], values["Velocity of the lowest layer, plain"].max()
    both, smooth = ["friction-rolling-bed", "friction-rolling-thin"], "friction-bed-thin"
    assert (
        f"No setting reaches more than {counts.max()} of the {total} numbers**, the reference {counts['reference']}."
        in page
    )
    assert f"(up to {fastest:.0f} mm/s of 500)" in page
    nearest = values.loc["friction", "Spin of the lowest layer, convex, at first"]
    assert f"({nearest:.0f} of 168 to 228 degrees a second), by one packing" in page and nearest < 168.0
    alone = values["Spin of the lowest layer, plain"] / values.loc["reference", "Spin of the lowest layer, plain"]
    left = f"{alone['friction']:.2f} of the plain layer's spin, `own_spin` {alone['rolling']:.2f} and `rvd`"
    assert f"{left} {alone['rvd']:.2f}, by one packing each." in page
    assert f"together leave {alone['friction-rolling-thin']:.3f}, so" in page
    assert "reach sliding over travel, {:.2f} to {:.2f}, and".format(*slides[both]) in page
    assert "plain sample's volume, {:.0f} and {:.0f} mm³ a revolution".format(*volume[both]) in page
    assert "the convex one then loses {:.2f} and {:.2f} of it".format(*ratio[both]) in page
    assert f"reaches sliding over travel ({slides[smooth]:.2f}) and the plain layer's spin" in page
    layer = values["Spin of the lowest layer, plain"]
    assert f"`own_spin`, {volume['rvd']:.1f} mm³ a revolution and {ratio['rvd']:.2f} of it" in page
    assert (
        f"turns the layer twice as fast, {layer['rvd']:.0f} degrees" in page
        and 1.5 < layer["rvd"] / layer["rolling"] < 2.5
    )
    together = volume["friction-rolling-bed"]
    source = 73.6  # mm3 per revolution, the least that is published
    left = [f"{source / volume[name]:.1f}" for name in ("reference", "rolling")]
    assert f"({volume['reference']:.1f}, three packings). {left[0]} is left under `cdt`, {left[1]}" in page
    assert f"under `own_spin` ({volume['rolling']:.1f}; the page" in page
    assert f"leaves {source / together:.1f} ({together:.1f}); either" in page
    firsts = volume[["rolling", "friction"]] / volume["reference"]
    assert f"alone takes {firsts.mean():.1f} ({volume['friction']:.1f} by friction), one" in page
    assert f"It loses {volume[smooth]:.0f} mm³ a revolution, its convex sample {ratio[smooth]:.2f} of the plain" in page


def test_what_moves_the_volume_of_the_tester():
    """Factors of friction, rolling model, height and thickness with their intervals."""
    found = table("tables/tester_sensitivity_quick_effects.csv").set_index(["quantity", "change"])
    lines, bumps = found.loc["Volume per revolution, plain"], found.loc["Volume per revolution, convex, at first"]
    changes = ("friction of the", "rolling model own_spin", "height of the bed", "thickness of the")
    friction, rolling, height, thickness = [
        lines.loc[next(name for name in lines.index if name.startswith(change)), ["factor", "low", "high"]]
        for change in changes
    ]
    page, interval = told("circular_tester.md"), "{:.2f} ({:.2f} to {:.2f})".format
    other_end, thin = lines.loc["incline of the sample -2 degrees"], bumps.loc["thickness of the sample 2 mm"]
    assert f"makes {interval(*other_end).replace(' (', ' times (')} on the plain sample" in page
    assert f"{interval(*thin).replace(' (', ' times (')} on the convex one." in page
    of_bumps = (bumps.loc[change.name] for change in (friction, rolling))
    convex = " and ".join("{:.1f} ({:.1f} to {:.1f})".format(*each) for each in of_bumps)
    assert f"on the plain sample, {convex} on the convex one, by sliding over travel: means" in page
    alone = reached()[0][["Volume per revolution, plain", "Volume per revolution, convex, at first"]]
    plain, pattern = (alone.loc[["friction", "rolling"]] / alone.loc["reference"]).T.to_numpy()
    words = "{:.2f} and {:.2f} times on the plain sample, {:.2f} and {:.2f} on the convex one. The".format
    assert words(*plain, *pattern) in page
    told_apart = lines[(lines["low"] > 1.0) | (lines["high"] < 1.0)].index
    assert set(told_apart) == {friction.name, rolling.name, "rolling model rvd", other_end.name}
    assert f"{interval(*friction)} and {interval(*rolling).replace(' (', ' times (')} on the plain sample" in page
    unsaid = "{:.2f}, {:.2f} to {:.2f}".format
    assert f"cannot be said ({unsaid(*height)}), nor of thickness on the plain one ({unsaid(*thickness)})." in page


def test_when_the_testers_pattern_is_worn_out():
    """Revolutions until it is gone and until its sample wears faster, what it lost over plain, what caps hold back."""
    page, results = told("circular_tester.md"), "circular_tester_results_quick.md"
    gone = rows(results, "run", "last share", "worn out revolution").set_index("run").loc["worn-out"]
    columns = ["revolutions", "wear coefficient per pa", "carried share percent"]
    run = rows(results, "run", "series", "surface").set_index("run").loc["worn-out", columns].astype(float)
    revolutions = run["revolutions"] * run["wear coefficient per pa"] / 5e-9  # those of the study's coefficient
    assert f"gone after {gone['worn out revolution']} revolutions" in page
    assert f"From {gone['faster revolution']} on, with {100.0 * float(gone['faster share']):.0f} % of it left" in page
    assert f"it has lost {gone['lost over plain']} of what" in page and f"makes of all {revolutions:.0f}; caps" in page
    assert f"caps hold back {run['carried share percent']:.0f} % of it" in page


def test_what_the_path_of_the_centres_would_make_of_the_tester():
    """Centres over contacts under cdt, the volume and the ratio by their path; under own_spin the two are alike."""
    page = told("circular_tester.md")
    found = compared(table("path_of_centres.csv")).loc["tester_sensitivity", TESTER_SCALE]
    columns = [f"centres over contacts, {surface}" for surface in SURFACES]
    relative, own = (found.loc[setting, columns] for setting in (OF_TESTER[""], OF_TESTER["rolling-"]))
    assert "centres move {:.2f} (plain) and {:.2f} times (convex) as far".format(*relative) in page
    values, _ = reached()
    volume = values["Volume per revolution, plain"]["reference"] * relative.iloc[0]
    ratios = found.loc[OF_TESTER[""], ["convex over plain by centres", "convex over plain by contacts"]]
    assert f"would lose {volume:.0f} mm³ a revolution, published" in page
    assert "and the convex one {:.2f} of it instead of {:.2f}, the source's".format(*ratios) in page
    assert own.max() < 1.02 and "`own_spin` the two are within 2 %." in page


def test_what_finer_particles_of_the_tester_do():
    """Volumes, forces and sliding at particle scales 4 and 6, the experiment, and the heap's weight."""
    page, results = told("circular_tester.md"), "circular_tester_results_standard.md"
    runs = rows(results, "run", "series", "surface").set_index("run")
    volume = runs["lost per revolution mm3"].astype(float).map("{:.1f}".format)
    assert (
        "takes {} mm³ off the plain sample at scale 4 and {} at 6, and {} and {} off".format(
            *volume[["plain", "scale6-plain", "convex", "scale6-convex"]]
        )
        in page
    )
    force, slides = (
        runs.loc[["plain", "scale6-plain"], name] for name in ("mean normal force N", "sliding over travel")
    )
    assert "bears {} N instead of {} and".format(*force) in page
    assert f"over {slides.iloc[0]} of the travel instead of {float(slides.iloc[1]):.3f}" in page
    assert f"it is {slides.iloc[0]}, under a smaller force." in page
    assert f"slide over {runs.loc['convex', 'sliding over travel']} of the trough's way" in page
    shares = runs.loc[["convex", "scale6-convex"], "pattern share percent"].astype(float)
    assert "Its pattern has {:.0f} % of its wear, the source's 56; at scale 6 it is {:.0f} %.".format(*shares) in page
    lost = rows(results, "hours", "quantity").set_index(["hours", "quantity"])["ours"].astype(float)
    at_56, at_184 = (lost[(hours, "convex volume")] for hours in ("56", "184"))
    assert f"has lost {at_56:.0f} mm³ (measured 82.8), after 184 h" in page
    assert f"are extended, {at_184:.0f} (measured 240.3; quick has" in page
    assert (
        f"presses on the pattern {float(runs.loc['convex', 'mean normal force N']) / float(force.iloc[0]):.1f} times"
        in told(results)
    )
    heap = rows(results, "run", "bed", "mass in use kg").set_index("run").loc["plain", "over sample in use mm"]
    density = float(
        rows(results, "bed", "settings", "packing")["bulk density found kg per m3"].iloc[0].replace("\u202f", "")
    )
    weight = density * 9.81 * 0.1 * 0.1 * float(heap) / 1e3
    words = f"it is {heap} mm high, weighs {weight:.1f} N at {density:.0f} kg/m³ and presses with {force.iloc[0]}."
    assert words in page
