"""Numbers that pages of docs tell in sentences of their own are those of the tables beside them, rounded."""

import re

import pandas as pd
import yaml

from benchmarks.rolling_case import MODELS
from benchmarks.time_step_page import answers
from bulkwear.workflows.engine.beds import (
    DENSITY_TOLERANCE,
    LEVEL_TOLERANCE,
    MASS_TOLERANCE,
    ROUNDED_PARTICLES,
    level_measure,
)
from bulkwear.workflows.report.provenance_of_pages import read_origins
from bulkwear.workflows.report.time_step import SHORTEST, SHOWN
from tests import PUBLISHED, REPOSITORY
from tests.support.told import rows, table, told

GRAVEL = yaml.safe_load((REPOSITORY / "config/materials.yaml").read_text(encoding="utf-8"))["particles"]["river_gravel"]
MEDIAN = 1e-3 * GRAVEL["median_diameter_mm"]  # m
CHOSEN = "0.4"  # time step over the Rayleigh time


def less(ratio):
    """How far a ratio is below or above 1, in per cent and words."""
    return f"{100.0 * abs(1.0 - ratio):.1f} {'less' if ratio < 1.0 else 'more'}"


def test_what_a_sphere_of_a_clump_costs():
    """Processor time of a sphere and step, over that of single spheres in beds and in runs of the same surface."""
    found = table("tables/grain_shape_quick_durations.csv")
    parts = found["job"].str.extract(
        r"(?P<what>bed|run)_(?P<shape>sphere|pair|tetrahedron)\S*?(?P<surface>_convex|_plain|)$"
    )
    found["cost"] = found["processor (min)"] / found["particles"] / found["steps"]
    means = found.join(parts).groupby(["what", "surface", "shape"])["cost"].mean().unstack()
    over = means.div(means["sphere"], axis=0)[["tetrahedron", "pair"]]
    bed, runs = over.loc["bed"].iloc[0], over.loc["run"].to_numpy()
    words = f"costs {bed['tetrahedron']:.1f} (four in a clump) and {bed['pair']:.1f} times (two) that of a single one"
    assert f"{words}, in runs {runs.min():.1f} to {runs.max():.1f} times" in told("grain_shape.md")


def test_by_how_much_a_bed_may_miss_what_is_asked():
    """The tolerances as numbers, and what they are of the tester's depth and of the beds of the series of sizes."""
    page, sizes = told("decisions.md"), table("tables/particle_size_quick_beds.csv")
    assert f"Its mass by {100.0 * MASS_TOLERANCE:.0f} %, or by two of the largest grains." in page
    assert LEVEL_TOLERANCE == 0.5 and ROUNDED_PARTICLES == 2.0
    assert f"and by {100.0 * DENSITY_TOLERANCE:.0f} % of the level or depth" in page
    grain = MEDIAN * sizes["particle_scale"]
    tester = level_measure({"median_diameter_m": 6.0 * MEDIAN}, 0.15, 0.15, "depth", covering=0.06)
    assert f"at scale 6 the tester's 90 mm of depth by {1e3 * tester.tolerance:.1f} mm" in page
    coarse = [
        1e3 * level_measure({"median_diameter_m": scale * MEDIAN}, 0.046, 0.046).tolerance for scale in (4.0, 12.0)
    ]
    half = 1e3 * LEVEL_TOLERANCE * 12.0 * MEDIAN
    words = "a bed of 46 mm by {:.1f} mm at scale 4 and by {:.1f} mm at 12, of which {:.1f} are half a grain"
    assert words.format(*coarse, half) in page
    off = (1e-3 * (sizes["level_found_mm"] - sizes["level_asked_mm"])).abs()
    assert (off <= LEVEL_TOLERANCE * grain + DENSITY_TOLERANCE * 1e-3 * sizes["level_asked_mm"]).all()


def test_how_a_bump_is_worn_through():
    """Travel, cycles, what is left, updates that were remeshed and the smallest angle."""
    found, page = table("worn_bump.csv"), told("wear.md")
    last = found.iloc[-1]
    travel, left = last["travel_mm"] / 1e3, last["bumps_left_percent"]
    assert f"After {travel:.0f} m and {last['cycle']:.0f} cycles {left:.1f} % of the bump is left." in page
    assert f"followed {(found['remeshed_faces'] > 0.0).sum()} updates" in page
    assert found["smallest_angle_deg"].min() >= float(re.search(r"no angle fell below ([\d.]+) degrees", page)[1])
    assert found["balance_error"].abs().max() <= float(re.search(r"the balance closes to (\S+)\.", page)[1])


def test_how_far_grooves_depend_on_the_mesh():
    """Spreads of depth and width over the meshes, and the rise of the work."""
    found, page = table("groove_convergence.csv"), told("wear.md")
    deep = found[(found["scheme"] == "conserving") & (found["strokes"] == found["strokes"].max())]
    depth, width = (100.0 * (deep[each].max() / deep[each].min() - 1.0) for each in ("depth_um", "width_mm"))
    work = 100.0 * (deep["work_over_load_times_distance"] - 1.0)
    assert f"depths differ by {depth:.1f} %, widths (holding 95 % of the area) by {width:.1f} %" in page
    assert f"by {work.min():.0f} to {work.max():.0f} % in the last stroke" in page
    each = found[found["scheme"] == "per_triangle"]["depth_um"]
    assert "the grooves are {:.0f}, {:.0f} and {:.0f} µm deep".format(*each) in page


def test_how_a_pins_volume_grows():
    """Changes of the rate with their intervals and verdicts, and the source's."""
    found, page = table("tables/pin_on_disc_standard_fits.csv"), told("pin_on_disc.md")
    found = found[found["wear_coefficient_per_pa"] == 1.7e-11].set_index(["scheme", "volume"])
    kept, moved, touched = (
        found.loc[each]
        for each in (
            ("conserving", "removed"),
            ("per_triangle", "removed"),
            ("per_triangle", "Eq 5.9, touched"),
        )
    )
    assert (kept["growth"], moved["growth"], touched["growth"]) == ("linear", "cannot be said", "cannot be said")
    columns = ["change_percent", "least_change_percent", "largest_change_percent"]
    assert "its rate changes by {:.1f} % ({:.1f} to {:.1f}), where".format(*kept[columns]) in page
    assert f"the source's fit makes {found.loc[('Yan 2022, Eq 5.13', 'published'), 'change_percent']:.0f} %" in page
    assert "cannot be said: {:.1f} % ({:.0f} to {:.0f}), and".format(*moved[columns]) in page
    assert "in contact alone {:.0f} % ({:.0f} to {:.0f})".format(*touched[columns]) in page


def test_what_too_long_a_time_step_makes_of_a_pin():
    """Contacts in round grooves, and the work beyond the stable step."""
    found, page = table("pin_time_step.csv"), told("pin_on_disc.md")
    beyond = found[(found["restitution"] == 0.5) & (found["time_step_over_limit"] == 1.15)]
    beyond = beyond[beyond["groove"].str.startswith("round")]
    assert "mm deep have {:.0f} and {:.0f}: there a step of 1.15".format(*beyond["contacts"]) in page
    assert "makes {:.1f} and {:.1f} times the work".format(*beyond["work_over_FL"]) in page


def test_how_studies_took_their_forecasts():
    """Least and largest share of the forecast that a study's solver took."""
    found = table("benchmarks.csv").query("benchmark == 'study_share' and against == 'its forecast'")["ratio"]
    assert f"{found.min():.1f} to {found.max():.1f} of their forecast" in told("forecast.md")


def test_what_the_order_of_particles_saves():
    """Processor time in the library's order over that in ours, with its range over the repeats."""
    found = table("benchmarks.csv").query("benchmark == 'solver_speed'").set_index("name")
    line = found.loc["bed past a convex sample, 19800 particles, the library's order of particles"]
    assert "one of 19,800 ({:.2f}, {:.2f} to {:.2f})".format(
        *line[["ratio", "ratio_low", "ratio_high"]].astype(float)
    ) in told("decisions.md")


def test_which_rolling_model_is_nearest_and_when_a_layer_flows():
    """Angles below the source's with their intervals, slopes at which a layer flows, and its creep before."""
    page, results = told("rolling_friction.md"), "rolling_models_results.md"
    found = rows(results, "response", "model", "pairs").set_index(["response", "model"])
    off = found.loc["Shear angle, shear box (°)", "root mean square"].astype(float).sort_values()
    (nearest, least), *others = off.items()
    words = ", ".join(f"`{model.replace(' ', '_')}` ({value:.1f})" for model, value in others)
    assert f"`{nearest}` is nearest, off by {least:.1f} degrees (root mean square), then" in page
    assert f"then {' and '.join(words.rsplit(', ', 1))}; two" in page
    apart = found.loc["Shear angle, shear box (°)", "told from nearest"].drop(nearest)
    assert (
        set(apart[apart == "yes"].index) == set(off.index[-2:]) and "tell the last two from it, but not `cdt`" in page
    )
    pairs = rows(results, "pair", "published", "cdt").set_index("pair").astype(float)
    misses = (pairs["own spin"] - pairs["published"]).loc[["calibrated", "size-test"]]
    assert "as that of `own_spin` does ({:+.1f} and {:+.1f})".format(*misses) in page and misses.prod() < 0.0
    off_by = found["mean difference"].astype(float)
    heap = ("Shear angle, draw-down (°)", "Angle of repose (°)", "Discharge time (s)")
    rvd, own_spin, epsd2 = ([off_by[response, model] for response in heap] for model in ("rvd", "own spin", "epsd2"))
    angles = [f"by {each[0]:+.1f} and {each[1]:+.1f}" for each in (rvd, own_spin, epsd2)]
    assert "off {} degrees under `rvd`, {} under `own_spin` and {} under `epsd2`".format(*angles) in page
    assert "times, {:+.2f}, {:+.2f} and {:+.2f} s, hang".format(*(each[2] for each in (rvd, own_spin, epsd2))) in page
    assert found.loc[heap[0], "packings"].astype(int).eq(1).all() and ("cdt" not in found.loc[heap[0]].index)
    changes = dict(re.findall(r"(\w+) ([+-]\d+\.\d)", re.search(r"the source changes by [^*]*", told(results))[0]))
    falls = [-float(changes[model]) for model in ("rvd", "own_spin")]
    assert f"rises by {float(changes['by']):.1f} degrees, under `rvd` and `own_spin` it falls by" in page
    assert "it falls by {:.1f} and {:.1f}: none rises as much".format(*falls) in page
    assert max(float(changes[model]) for model in MODELS) < float(changes["by"])
    angles = (
        rows(results, "pair", "published", "cdt").set_index("pair").loc["calibrated"].drop("published").astype(float)
    )
    measured = pd.read_csv(PUBLISHED / "gravel_tests.csv").set_index("response")["value"]
    short = measured["shear_angle_deg"] - angles
    assert f"by {short.min():.1f} to {short.max():.1f} degrees in the mean of two or three packings" in told(
        "decisions.md"
    )
    layers = table("tilted_bed.csv").groupby("model")[["flow_angle_deg", "creep_mm_per_s"]].mean()
    flow, creep = layers["flow_angle_deg"], layers["creep_mm_per_s"]
    words = ", ".join(f"{flow[model]:.0f} (`{model}`)" for model in ("cdt", "epsd2", "rvd"))
    assert f"begins to flow at {words} and {flow['own_spin']:.0f} degrees (`own_spin`)" in page
    assert "not told from `own_spin`" in re.search(r"\* `rvd`: [^*]*", told("tilted_bed_results.md"))[0]
    scatter = table("tilted_bed.csv").groupby("model")["flow_angle_deg"].agg(lambda each: each.max() - each.min())
    assert f"scatter over {scatter['own_spin']:.0f} degrees, as those of `rvd` do" in page
    assert round(scatter["own_spin"]) == round(scatter["rvd"])
    assert f"creeps at {creep['cdt']:.1f} mm/s, under the others at {creep.drop('cdt').max():.3f} and less" in page


def test_what_rolling_models_cost():
    """Processor time of a time step over that under own_spin, with the extremes of its rounds."""
    found = table("benchmarks.csv").query("benchmark == 'rolling_cost'").set_index("name")
    rvd, cdt = (
        "{:.2f} times ({:.2f} to {:.2f})".format(*line[["ratio", "ratio_low", "ratio_high"]].astype(float))
        for model in ("rvd", "cdt")
        for line in [found.loc[next(name for name in found.index if name.endswith(f"rolling_friction {model}"))]]
    )
    page = told("rolling_friction.md")
    assert f"takes {rvd} the processor time of `own_spin` under `rvd` and {cdt} under `cdt`" in page


def test_what_the_calibrations_pairs_give():
    """What the recommended pair and the published one are off by, and the source's pair under three rolling models."""
    page, results = told("calibration.md"), "calibration_results_standard.md"
    found = rows(results, "pair", "response", "measured").set_index(["pair", "response"])
    off = found["simulated"].astype(float) - found["measured"].astype(float)
    box, draw, repose, time = (
        "Shear angle, shear box (°)",
        "Shear angle, draw-down (°)",
        "Angle of repose (°)",
        "Discharge time (s)",
    )
    ours, published = off.loc["recommended"], off.loc["calibrated"]
    assert f"gives the discharge time ({ours[time]:+.1f} s)" in page and f"shear box ({ours[box]:+.1f} degrees" in page
    assert f"draw-down ({ours[draw]:+.1f} degrees) and angle of repose ({ours[repose]:+.1f} degrees)" in page
    kept = found.loc["calibrated", "inside"]
    assert kept[box] == "outside" and not (kept.drop(box) == "outside").any()
    assert f"a shear angle of the shear box {-published[box]:.1f} degrees below the measured one" in page
    shares = found["denser share"].groupby("pair").first().astype(float)
    fits = f"{shares['calibrated']:.0%} of the posterior fits better than it, {shares['recommended']:.0%} than that"
    assert fits.replace("%", " %") in page
    of_gravel = re.search(r"materials file \(.*?\) is in the family: ([\d.]+) %", told(results))[1]
    assert f"because it is in the family: {float(of_gravel):.0f} % of the posterior fits better" in page
    ends = rows(results, "parameter", "searched from").set_index("parameter")[["low", "high"]].astype(float)
    (low, high), (rolling_low, rolling_high) = ends.to_numpy()
    assert f"a band at sliding friction {low:.2f} to {high:.2f} with rolling friction anywhere" in page
    assert f"from {rolling_low:.2f} to {rolling_high:.2f}, which is told" in page
    angles = rows("rolling_models_results.md", "pair", "published", "cdt").iloc[0]
    told_of = [f"{angles[model.replace('_', ' ')]}° under `{model}`" for model in ("cdt", "epsd2", "rvd", "own_spin")]
    assert f"gives {', '.join(told_of[:-1])} and {told_of[-1]}, at particle scale 4, two or three packings" in page


def test_what_the_best_pattern_wears():
    """The best pattern, the other confirmed one and R5 over plain with their intervals, what is left of their bumps and
    what they cost, and how R5 wears at standard.
    """
    page, key = told("optimised_pattern.md"), ["setting", "surface"]
    confirmed = rows("optimised_pattern_results_quick.md", "setting", "major radius mm", "minor radius mm")
    name = re.search(r"The best pattern, (\w+) \(", told("optimised_pattern_results_quick.md"))[1]
    (best,) = (row for _, row in confirmed.iterrows() if row["setting"] == name)
    (other,) = (row for _, row in confirmed.iterrows() if row["setting"] not in (name, "R5"))
    found = table("tables/optimised_pattern_quick_key_numbers.csv").set_index(key)
    interval, over = "{:.2f} ({:.2f} to {:.2f})".format, ["wear_over_plain", "interval_low", "interval_high"]
    best_one, r5 = (interval(*found.loc[(each, "convex"), over]) for each in (best["setting"], "R5"))
    predicted = interval(*best[["predicted", "predicted low", "predicted high"]].astype(float))
    of_r5 = interval(*best[["over reference", "over reference low", "over reference high"]].astype(float))
    assert f"wears {best_one} of a plain plate**, predicted {predicted}, and {of_r5} of R5." in page
    tried = table("tables/optimised_pattern_quick_search_record.csv").set_index("setting")
    left = tried["left_percent"]
    assert f"Of its bumps {left[name]:.0f} % are left after 200 h, of R5's {left['R5']:.0f} %" in page
    alike = tried.loc[tried["row_spacing_mm"] == 12, "wear_over_plain"].round(2)  # of one phase: rows 6 mm apart
    assert alike.between(0.21, 0.29).mean() > 0.5 and "patterns with such rows lie between 0.21 and 0.29" in page
    of_other = interval(*found.loc[(other["setting"], "convex"), over])
    assert f"the other confirmed pattern, with columns 4 mm closer, wears {of_other}" in page
    assert float(other["column spacing mm"]) + 4 == float(best["column spacing mm"])
    force = found["mean_normal_force_N"]
    sums = [force[each, "convex"] / force[each, "plain"] for each in (name, "R5")]
    assert "add up to {:.1f} times those on a plain one, R5's to {:.1f};".format(*sums) in page
    assert f"wear is on bumps ({found.loc[(name, 'convex'), 'pattern_share_percent']:.0f} %)" in page
    standard = rows("screening_results_standard.md", "setting", "surface", "packings").set_index(key)
    long = standard.loc[("R5", "convex"), ["wear over plain", "interval low", "interval high"]].astype(float)
    assert f"R5 wears {r5} of plain there, and {interval(*long)} on the source's sample" in page


def test_which_frictions_each_rolling_model_asks_for():
    """Models of relative spin and of own spin ask for other sliding frictions, and reject the pairs of one another."""
    page = told("calibration.md")
    found = rows("calibration_models_results.md", "model", "simulations").set_index("model")
    names = found.columns[found.columns.str.startswith(("sliding", "angle at "))]
    found = found[names].astype(float).rename(index=lambda name: name.replace(" ", "_"))
    relative, own = ["cdt", "epsd2"], ["own_spin", "rvd"]
    low, high = found.loc[relative, "sliding"].agg(["min", "max"])
    assert f"of their bands at sliding friction {low:.2f} to {high:.2f}, `own_spin` and `rvd` at" in page
    assert {f"{each:.2f}" for each in found.loc[own, "sliding"]} == {"0.24"} and "and `rvd` at 0.24, and" in page
    width = found["sliding high"] - found["sliding low"]
    assert width["own_spin"] < 0.1 and width.drop("own_spin").min() > 0.4 and "band of `own_spin` is narrow" in page
    at_source = [f"{each:.1f}" for each in found.loc[[*own, *relative], "angle at calibrated deg"]]
    words = "{} and {} degrees at particle scale 5, measured 36, and does under `cdt` and `epsd2` ({} and {})"
    words = words.format(*at_source)
    assert words in told("rolling_friction.md")
    angles = found.loc[[*relative, *own], "angle at recommended deg"]
    assert "the box gives {:.1f}°, {:.1f}°, {:.1f}° and {:.1f}°, measured".format(*angles) in page
    of_pairs = rows("calibration_models_results.md", "pair", "sliding", "rolling").set_index("pair")
    better = of_pairs[[f"under {name.replace('_', ' ')} percent" for name in (*relative, *own)]].astype(float)
    better.columns = [*relative, *own]
    assert (better.loc[[f"of {name}" for name in relative], own] > 95.0).all(axis=None)
    assert (better.loc[[f"of {name}" for name in own], relative] > 95.0).all(axis=None)
    assert (better.loc["calibrated", relative] > 95.0).all() and (better.loc["calibrated", own] < 95.0).all()


def test_what_decisions_say_of_softness_and_time_steps():
    """Wear that the source's modulus adds, and what the chosen time step changes where runs start without a kick."""
    page, softness = told("decisions.md"), told("stiffness.md")
    plain, convex = re.findall(r"7e\+07 Pa: \+([\d.]+) % \(95 %: \+([\d.]+) to \+([\d.]+)\)", softness)
    assert (
        "{} % ({} to {}) of wear on a plain sample and {} % ({} to {}) on a convex one".format(*plain, *convex) in page
    )
    found = answers(table("time_step_limits.csv"))
    change = {key: told.set_index("value").loc[float(CHOSEN)] for key, told in found.items()}
    ends = ["change", "change_low", "change_high"]
    work, impact = ["sliding_work_J_per_m", "impact_energy_J_per_m"]
    said = [
        "{:.1f} % ({:.1f} to {:.1f})".format(*(100.0 * change["own_spin", "convex", each][ends]))
        for each in (work, impact)
    ]
    assert f"it adds {said[0]} of sliding work and {said[1]} of impact energy under `own_spin`, in 60 packings" in page
    assert change["own_spin", "convex", work]["runs"] == 60
    of_cdt = [
        "{:.1f} % ({:.1f} to {:.1f})".format(*(100.0 * change["cdt", surface, work][ends]))
        for surface in ("plain", "convex")
    ]
    assert "on a plain sample by {}, on a convex one by {}, three".format(*of_cdt) in told("grain_shape.md")
    for other in ("rolling_friction.md", "particle_size.md"):
        assert f"on a plain sample by less than 2 % and adds {said[0]} on a convex one" in told(other)
    plain = [change[model, "plain", work] for model in MODELS]
    assert {each["verdict"] for each in plain} == {
        "within"
    } and f"{CHOSEN} of the Rayleigh time under a sliding" in page
    told_of = {model: found[model, "convex", work].set_index("value")["verdict"] for model in MODELS}
    assert told_of["cdt"][0.5] == "beyond" and told_of["epsd2"][0.6] == "beyond"
    others = [each for model in ("cdt", "epsd2", "rvd") for each in told_of[model].loc[0.2:0.4]]
    assert set(others) == {"undecided"} and "beyond" not in set(told_of["rvd"])


def test_what_a_travelling_window_changes():
    """Wear in the window with the longer wake over that in the full bed, and how much cheaper it is."""
    page, results = told("travelling_window.md"), "travelling_window_results.md"
    window, key = "window 150 + 200, time step 0.4", ["surface", "bed"]
    wear = rows(results, "surface", "bed", "packings").set_index(key)[["wear over full", "ratio low", "ratio high"]]
    plain, convex = ([less(ratio) for ratio in wear.loc[(each, window)].astype(float)] for each in ("plain", "convex"))
    of_plain, of_convex = (each[0].replace(" ", " % ") for each in (plain, convex))
    assert f"wears {of_plain} than a bed of 2 m under a plain sample (95 %: {plain[1]} to {plain[2]})" in page
    assert f"and {of_convex} under a convex one ({convex[1]} to {convex[2]})" in page
    cost = rows(results, "surface", "bed", "bed length m").set_index(key)
    columns = ["cheaper in processor time", "cheaper low", "cheaper high"]
    cells = [
        "{:.1f} ({:.1f} to {:.1f})".format(*cost.loc[(each, window), columns].astype(float))
        for each in ("plain", "convex")
    ]
    assert f"| window 150 + 200, time step 0.4, shared bed too | {cells[0]} | {cells[1]} |" in page
    columns = ["cheaper with its run in", "with its run in low", "with its run in high"]
    plain, convex = (cost.loc[(each, window), columns].astype(float) for each in ("plain", "convex"))
    assert (
        "so {:.0f} times cheaper than the source's set-up with a plain sample (95 %: {:.1f} to".format(*plain) in page
    )
    assert "and {:.0f} times with a convex one ({:.1f} to {:.1f})".format(*convex) in page


def test_what_the_row_at_true_size_wears():
    """R12 over its plain twin, force, layers and bumps, beside the page at quick."""
    page, key = told("screening.md"), ["setting", "surface"]
    found = rows("screening_results_paper.md", "setting", "surface", "packings").set_index(key)
    convex, plain = (found.loc[("R12", surface)] for surface in ("convex", "plain"))
    assert f"R12 at true size** wears {float(convex['wear over plain']):.2f} of its plain twin" in page
    assert f"the plain sample with {float(plain['mean normal force N']):.1f} N; their" in page
    assert f"Bumps take {float(convex['pattern share percent']):.0f} % of the wear" in page
    bed = rows("screening_results_paper.md", "bed", "settings", "packing", "particle scale").iloc[0]
    assert float(bed["particle scale"]) == 1.0
    quick = rows("screening_results_quick.md", "row", "particle scale", "regime").set_index("row").loc["R12"]
    words = "at scale {:.2f}, has {:.2f}.".format(*quick[["particle scale", "wear over plain"]].astype(float))
    assert words in page
    (origin,) = [each for each in read_origins(REPOSITORY / "docs") if each.page == "screening_results_paper.md"]
    assert f"has taken {origin.core_hours:.1f}:" in page


def test_what_sampling_costs():
    """Work on the wrong triangles at two strides, and what is left at a stride of 1."""
    found, page = table("sampling_error.csv").set_index("stride_steps"), told("ledger.md")
    wrong = 100.0 * found["map_error"] / 2.0  # what one triangle has too much another has too little
    assert 45.0 < wrong[100] < 55.0 and "At 100 steps between samples about half of the work" in page
    assert f"lies on the wrong triangles, at 10 some {wrong[10]:.0f} %" in page
    assert f"left at a stride of 1, {100.0 * found.loc[1, 'total_error']:.1f} %" in page


def test_what_machines_pages_say_of_sliding_contacts_and_of_a_patterned_liner():
    """The light of contacts that slide of three machines, and the life of a patterned liner over a plain one's."""
    page, light = told("equipment.md"), r"\*\*Contacts slide: \w+\.\*\* Friction does (\d+) % or more"
    lights = [re.search(light, told(f"{machine}_results_quick.md"))[1] for machine in ("chute", "screw", "mill")]
    assert "has 0.{} on the part where it is least, the [screw](screw_results_quick.md) 0.{},".format(*lights) in page
    assert f"the [mill](mill_results_quick.md) 0.{lights[2]}." in page
    life = r"The liner of R9 lasts ([\d.]+) times as long as that of plain \(([\d.]+) to ([\d.]+), 95 %\)"
    quick, standard = (
        [float(number) for number in re.search(life, told(f"chute_results_{each}.md")).groups()]
        for each in ("quick", "standard")
    )
    page = told("rolling_friction.md")
    assert "lasts {:.1f} times as long as the plain one under `own_spin` ({:.1f} to {:.1f})".format(*quick) in page
    assert "at quick, {:.1f} ({:.1f} to {:.1f}) at [standard]".format(*standard) in page


def test_the_time_steps_that_pages_call_shown_are_those_of_the_table():
    """The light on a page goes by the limits that all four responses keep."""
    found = rows("time_step_limits_results.md", "model", "plain, sliding work", "plain, impact energy")
    limits = pd.to_numeric(found.set_index("model")["all of them"], errors="coerce").dropna()
    assert {model.replace(" ", "_"): limit for model, limit in limits.items()} == SHOWN
    tried = rows("time_step_limits_results.md", "time step over Rayleigh time (-)", "packings", "change percent")
    assert tried["time step over Rayleigh time (-)"].astype(float).min() == SHORTEST
