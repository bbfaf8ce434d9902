"""Numbers that docs/particle_size.md tells in sentences of its own are those of the tables beside it, rounded."""

import math
import re

import yaml

from benchmarks.path_of_centres import OF_GRAVEL, compared
from benchmarks.scale_case import APART, DEVIATION, REFERENCE
from benchmarks.scale_page import source_ratio
from bulkwear.postproc.reference.dragged_bed import largest_dragged_share
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.beds import BedMeasure, over_asked_density
from tests import REPOSITORY
from tests.support.told import rows, table, told

GRAVEL = yaml.safe_load((REPOSITORY / "config/materials.yaml").read_text(encoding="utf-8"))["particles"]["river_gravel"]
MEDIAN = 1e-3 * GRAVEL["median_diameter_mm"]  # m
UNITS = {"mass": "kg", "level": "mm"}  # of measures in tables of beds


def known_causes():
    """The reasons of differences that are known, each on one line."""
    return " ".join((REPOSITORY / "config/published/differences.yaml").read_text(encoding="utf-8").split())


def test_the_critical_scale_and_what_bumps_do_to_a_bed():
    """Critical scale, forces and sliding over the plain sample, of both pages with three packings of every scale."""
    page, said = told("particle_size.md"), []
    sums, slides, levels = [], [], []
    for fidelity, scales in (("quick", [4, 6, 8, 9, 10, 12]), ("standard", [3, 4, 6, 8, 9, 10, 12])):
        results = f"particle_size_results_{fidelity}.md"
        found = table(f"published/{results.replace('.md', '.csv')}").set_index("finding")["found"][
            "critical scale, convex"
        ]
        said.append([float(each) for each in re.findall(r"\d[\d.]*(?=[ )])", found.replace("95 %", ""))])
        sizes = rows(results, "setting", "particle scale", "layers of particles")
        assert sizes["particle scale"].astype(float).tolist() == scales
        levels.append(table(f"tables/particle_size_{fidelity}_beds.csv").set_index("bed")["level_found_mm"])
        sums += sizes["normal force over plain"].astype(float).tolist()
        slides += sizes["sliding over plain"].astype(float).tolist()
    assert levels[0].equals(levels[1][levels[0].index]) and "finer elements under the same beds, and scale 3" in page
    words = (
        "is {:.1f} (95 %: {:.1f} to {:.1f}) by the page at quick and {:.1f} ({:.1f} to {:.1f}) by the one at standard"
    )
    assert words.format(*said[0], *said[1]) in page
    assert (
        f"is {min(sums):.1f} to {max(sums):.1f} times as large, and sliding {min(slides):.2f} to {max(slides):.2f}"
        in page
    )
    standard = rows("particle_size_results_standard.md", "setting", "surface", "packings").set_index("surface")
    wear, force = (
        standard.loc["plain", name].astype(float).to_numpy()
        for name in ("worn volume per metre mm3 per m", "mean normal force N")
    )
    alike = math.ceil(100.0 * (wear.max() / wear.min() - 1.0))
    assert f"it wears within {alike} % alike from scale 3 to 12" in page
    assert f"under a force that grows by {100.0 * (force[-1] / force[0] - 1.0):.0f} %" in page
    forms = rows("particle_size_results_standard.md", "form", "crossing")
    assert (forms["rejected"] == "no").sum() == 1 and "after which only one form of the curve fits;" in page
    next_best = forms[forms["rejected"] == "yes"].set_index("form").astype({"p value": float})["p value"]
    crossing = forms.set_index("form").loc[next_best.idxmax(), ["crossing", "interval low", "interval high"]]
    words = "a parabola of the ratio, {:.1f} ({:.1f} to {:.1f}), is only just rejected".format(*map(float, crossing))
    assert next_best.idxmax() == "ratio, parabola" and f"{words} (p = {next_best.max():.2f})" in page
    windows = [
        re.search(r"(\d+ of \d+) windows are steady", told(f"particle_size_results_{each}.md"))[1]
        for each in ("quick", "standard")
    ]
    assert "criterion {} of its windows are steady at quick and {} at standard, none".format(*windows) in page
    for each in ("quick", "standard"):
        found = table(f"tables/particle_size_{each}_steady_by_scale.csv").query("measure == 'relative_wear_rate'")
        assert not found.loc[found["run"].str.contains("convex"), "steady"].any()


def test_how_loose_coarse_beds_lie():
    """Bulk density by mass and level over the asked one, at three scales, and how many grains the level is too high."""
    beds, page = table("tables/particle_size_quick_beds.csv"), told("particle_size.md")
    columns = [[f"{name}_{what}_{unit}" for what in ("asked", "found")] for name, unit in UNITS.items()]
    beds["ratio"] = [
        over_asked_density(*(BedMeasure(name, "", *row[own], 0.0) for name, own in zip(UNITS, columns, strict=True)))
        for _, row in beds.iterrows()
    ]
    ratio = beds.groupby("particle_scale")["ratio"].mean()
    assert ratio.is_monotonic_decreasing
    asked = GRAVEL["density_kg_per_m3"] * GRAVEL["bulk_solid_fraction"]
    words = f"{ratio[4]:.2f} of the bulk density that is asked ({asked:.0f} kg/m³) at scale 4, {ratio[8]:.2f} at 8"
    assert f"{words} and {ratio[12]:.2f} at 12" in page
    used = table("tables/particle_size_standard_beds.csv")
    used["scale"] = used["bed"].str.extract(r"bed_S(\d+)")[0].astype(float)
    denser = used["bulk_density_over_asked"] * used["level_found_mm"] / used["level_in_use_found_mm"]
    in_use = denser.groupby(used["scale"]).mean()
    assert f"has [{in_use[4]:.2f}, {in_use[8]:.2f} and {in_use[12]:.2f}](" in page
    high = 1e-3 * (beds["level_found_mm"] - beds["level_asked_mm"]) / (MEDIAN * beds["particle_scale"])
    assert f"the level is {high.min():.2f} to {high.max():.2f} of a median grain too high" in page


def test_why_the_critical_scale_differs():
    """Ratios of convex to plain wear with one size of particles and other rolling models, beside the source's lines."""
    page, key = told("particle_size.md"), ["candidate", "particle scale"]
    found = rows("critical_scale_results.md", "particle scale", "candidate", "kind").set_index(key)
    one, both = (found.loc[each] for each in ("one size of particles", "one size, rolling as rvd"))
    ratio, alone = (each["wear over plain"].astype(float)[["3", "4", "6", "8"]] for each in (both, one))
    assert "wears {:.2f}, {:.2f}, {:.2f} and {:.2f} of the plain".format(*ratio) in page
    assert "lines {:.2f}, {:.2f}, {:.2f} and {:.2f}.".format(*map(source_ratio, (3, 4, 6, 8))) in page
    assert "{:.2f} (one packing), {:.2f}, {:.2f} and {:.2f} at 3, 4, 6 and 8".format(*alone) in page
    critical = rows("critical_scale_results.md", "candidate", "scales", "packings", "critical scale")
    where = critical.set_index("candidate")["where"]
    assert where["one size of particles"].startswith("below 4, if anywhere") and (alone > 1.0).all()
    assert where["one size, rolling as rvd"].startswith("below 3, if anywhere") and "is below 3, if it has one." in page
    ends = "{:.1f} to {:g}".format(*map(float, where[REFERENCE].split(" to ")))
    assert f"bring it from {ends} down to" in page and "none or one below 4. With" in page
    of_cdt = where["one size, rolling on relative spin"].removesuffix(" to beyond 8")
    words = f"hangs on the time step: {float(of_cdt):.1f} or beyond with 0.4 of the Rayleigh time, between 3 and 5 with"
    assert words in page and "in one packing, the convex sample wears more at 4, 6 and 8." in page
    spin = "one size, rolling on relative spin"
    assert where[f"{spin}, time step 0.1"].startswith("between 3 and 5, each by its own packings; no form tried")
    by_step = [
        found.loc[f"{spin}{step}", "wear over plain"].astype(float).map("{:.2f}".format)
        for step in ("", ", time step 0.1", ", time step 5e-6 s")
    ]
    long, short, source_step = (each.tolist() for each in by_step)
    assert "wears {}, {} and {} of the plain one at scales 4, 6 and 8 with 0.4".format(*long) in page
    assert "{}, {}, {}, {} and {} at 3, 4, 5, 6 and 8 with 0.1;".format(*short) in page
    assert "{}, {} and {} at 4, 6 and 8 with 5e-6 s (one packing)".format(*source_step) in page
    assert min(map(float, source_step)) > 1.0
    source = map(source_ratio, (3, 4, 5, 6, 8))
    assert "The source's lines have {:.2f}, {:.2f}, {:.2f}, {:.2f} and {:.2f}: those with 0.1".format(*source) in page
    alike = rows("particle_size_one_size_results_quick.md", "setting", "particle scale", "layers of particles")
    ends = alike.set_index("setting")[["wear over plain", "interval low", "interval high"]].astype(float)
    at_4, at_12 = ("{:.2f} ({:.2f} to {:.2f})".format(*ends.loc[name]) for name in ("S4", "S12"))
    assert f"(particle_size_one_size_results_quick.md): {at_4} at scale 4, {at_12} at 12." in page
    at_4 = one.loc["4", ["over reference", "over reference low", "over reference high"]].astype(float)
    assert "the ratio {:.1f} times ({:.1f} to {:.1f}) as large at scale 4".format(*at_4) in page
    off = [
        100.0 * (1.0 - float(found.loc[(f"rolling {how}", "8"), "over reference"]))
        for how in ("as rvd", "on relative spin")
    ]
    assert "takes {:.0f} and {:.0f} % off the ratio at 8".format(*off) in page
    runs = table("critical_scale.csv").query("particle_scale == 6 and seed == 20220317")
    wear = runs.pivot(index="candidate", columns="surface", values="wear_mm3_per_m")
    steps = (wear["convex"] / wear["plain"])[["one size, rolling as rvd, time step 0.1", "one size, rolling as rvd"]]
    assert "{:.2f} at scale 6, where the same packing has {:.2f}.".format(*steps) in page
    of_ours, of_source = [
        "{:.2f} | {:.2f} | {:.2f} |".format(*each) for each in (ratio[1:], map(source_ratio, (4, 6, 8)))
    ]
    assert f"ours, two packings | {of_ours}" in page and f"the source | {of_source}" in page


def test_the_two_chapters_on_one_pattern():
    """Wear of R5 at the real particle size by the line of chapter 4, beside the number of chapter 3."""
    less = 100.0 * (1.0 - source_ratio(1))
    words = f"(section 3.5.2), by the lines of chapter 4 at the same particle size {less:.0f} % less."
    assert f"R5 wears 66 % less than its plain twin {words}" in told("screening.md")


def candidates():
    """Ratios of the candidates of the critical scale, and their parts, by particle scale and candidate."""
    names = ["particle scale", "candidate"]
    first = ((*names, "kind"), (*names, "wear mm3 per m convex"))
    return [rows("critical_scale_results.md", *columns).set_index(names) for columns in first]


def number(of, name, column):
    """A column of one candidate by particle scale."""
    return of.xs(name, level="candidate")[column].astype(float)


def critical_scales():
    """What the page tells of the critical scale of each candidate."""
    return rows("critical_scale_results.md", "candidate", "scales", "packings", "critical scale").set_index("candidate")


def test_what_else_moves_the_ratio():
    """Friction of the sample, and the other candidates at scale 6."""
    page, friction, (ratios, parts) = told("particle_size.md"), "sliding friction of the sample 0.21", candidates()
    ratio = number(ratios, friction, "wear over plain").map("{:.2f}".format)
    moved, of_study = (number(parts, name, "velocity percent convex") for name in (friction, REFERENCE))
    assert "wears {}, {} and {} of the plain one at 4, 6 and 8, critical".format(*ratio) in page
    assert "moves at {:.0f}, {:.0f} and {:.0f} % of its".format(*moved) in page
    assert f"the study has {of_study['5']:.0f} and {of_study['8']:.0f} %." in page
    where = critical_scales().loc[friction, ["critical scale", "where"]]
    low, high = map(float, where["where"].split(" to "))
    assert f"critical scale {float(where['critical scale']):.1f} ({low:.1f} to {high:.1f})" in page
    over = ratios.loc["6", "over reference"].drop(REFERENCE).astype(float)
    for name, words in (
        ("bumps turned", "instead of across it, {:.2f}"),
        ("neighbouring rows 40 mm apart", "40 mm apart {:.2f}"),
        ("sizes 0.5 to 1.5", "of the median {:.2f}"),
        ("sliding friction of the sample 0.5", "sample 0.5 {:.2f}."),
    ):
        assert words.format(over.pop(name)) in page
    rest = over[
        ~over.index.str.startswith(("one size", "rolling as", "rolling on", "sizes 0.88 to 1.12"))
        & ~over.index.isin([friction])
    ]
    assert len(rest) == 11 and f"c and d exchanged: {rest.min():.2f} to {rest.max():.2f}." in page


def test_how_the_studys_curve_lies_to_the_sources():
    """Ratios and bases of the study, of narrower sizes and of other candidates over those of the source's lines."""
    page, (ratios, parts) = told("particle_size.md"), candidates()
    half = [each / source_ratio(float(at)) for at, each in number(ratios, REFERENCE, "wear over plain").items()]
    base = number(parts, REFERENCE, "base over plain")
    of_source = [source_ratio(float(at), "base") for at in base.index]
    assert f"is {min(half):.2f} to {max(half):.2f} of the source's, and" in page
    assert f"wears {base.min():.3f} to {base.max():.3f} of the plain sample" in page
    assert f"source's lines {min(of_source):.3f} to {max(of_source):.3f}:" in page
    words = re.findall(r"the bumps would have to wear ([\d.]+) times", told("critical_scale_results.md"))
    assert f"would have to wear {words[0]} (scale 3, one packing) to {words[-1]} times (scale 8)" in page
    relative = parts[parts.index.get_level_values("candidate").str.contains("relative")]["base over plain"].astype(
        float
    )
    alone = number(parts, "one size of particles", "base over plain")
    assert f"with `cdt` the base is {relative.min():.2f} to {relative.max():.2f}, with one" in page
    assert f"with one size {alone.min():.2f} to {alone.max():.2f}, with bumps" in page
    turned = number(parts, "bumps turned", "base over plain")
    assert f"with bumps turned {turned.loc['6']:.2f}." in page and turned.max() - turned.min() < 0.01
    narrow = number(parts, "sizes 0.88 to 1.12", "base over plain")
    of_narrow = number(ratios, "sizes 0.88 to 1.12", "wear over plain")
    share = [each / source_ratio(float(at)) for at, each in of_narrow.items()]
    assert f"make {min(share):.2f} to {max(share):.2f} of it, with a base of {narrow.min():.2f} to" in page
    assert f"a base of {narrow.min():.2f} to {narrow.max():.2f}." in page
    assert (
        "{:.2f} (one packing), {:.2f}, {:.2f} and {:.2f} of the plain one at 3, 4, 6 and 8:".format(*of_narrow) in page
    )
    told_where = critical_scales().loc["sizes 0.88 to 1.12", ["critical scale", "where"]]
    ends = "{:.1f} to {:.1f}".format(*map(float, told_where["where"].split(" to ")))
    assert f"critical scale {float(told_where['critical scale']):.1f} ({ends}), the nearest" in page
    printed = number(ratios, "sizes 0.88 to 1.12, rolling on relative spin, time step 5e-6 s", "wear over plain")
    assert printed.index.tolist() == ["6", "8"]
    of_three = [f"{each:.3g}" for each in (*printed, *number(ratios, REFERENCE, "wear over plain")[["6", "8"]])]
    assert (
        "wears {} and {} of the plain one at 6 and 8, in one packing; the study has {} and {},".format(*of_three)
        in page
    )
    assert f"lines {source_ratio(6):.2f} and {source_ratio(8):.2f}. So far as one packing tells" in page
    single = ratios.xs("sizes 0.88 to 1.12", level="candidate")["packings"]
    assert single.tolist() == ["1", "2", "2", "2"] and "leans on scale 3 with its one packing" in page
    assert f"down to {float(told_where['critical scale']):.1f}. With one" in page
    assert (
        f"deviation would be {DEVIATION:.3f} of the median" in page
        and f"{1.0 - APART:g}, 1 and {1.0 + APART:g} the" in page
    )
    assert f"1.2 of it, have {0.2 * 0.5**0.5:.3f}." in page
    assert f"as narrow as that share have {float(told_where['critical scale']):.1f}" in known_causes()
    standing = number(parts, "sample 5 mm above the floor", "velocity percent plain")["6"]
    assert f"floor it is {standing:.0f} % (scale 6" in page
    runs = table("critical_scale.csv").query("particle_scale == 6 and surface == 'plain'").groupby("candidate")
    force = runs["normal_force_N"].first()
    pressed = force["sample 5 mm above the floor"], force[REFERENCE]
    assert "on the sample with {:.0f} N, the flat one's with {:.0f}.".format(*pressed) in page
    assert f"a front edge of 5 mm by {standing:.0f} %" in known_causes()


def test_what_the_path_of_the_centres_would_make():
    """The ratio by either path at scale 8, in the order of the words."""
    page, told_of = told("particle_size.md"), compared(table("path_of_centres.csv")).loc["particle_size", 8]
    by = told_of[["convex over plain by centres", "convex over plain by contacts"]].map("{:.2f}".format)
    study, spin, both = (by.loc[name].tolist() for name in OF_GRAVEL)
    assert "at scale 8 {} instead of {}, under `cdt` {} instead of {}, with".format(*study, *spin) in page
    assert "Rayleigh time) {} instead of {}, by".format(*both) in page
    largest = told_of["centres over contacts, convex"] / told_of["centres over contacts, plain"]
    assert f"(path_of_centres.csv). That is up to {largest.max():.2f} times as large;" in page


def test_how_far_friction_alone_takes_a_bed_along():
    """By hand, with the sizes of the study, and what is published and found."""
    page, run = told("particle_size.md"), load_study("particle_size", overrides={"rows": ["S4"]}).run("S4_plain")
    given = run.parameters
    friction, length = given["sample_material"]["contact"]["sliding_friction"], given["sample"]["length_m"]
    speed = given["sliding"]["velocity_m_per_s"]
    share = 100.0 * largest_dragged_share(friction, length, speed)
    words = f"friction of {friction:g} on {1e3 * length:g} mm of sample takes a bed that nothing holds back along by"
    assert f"{words} {share:.0f} % at {speed:g} m/s" in page
    assert f"takes a bed along by {share:.0f} % of the plain" in known_causes()
    found = [
        float(each)
        for fidelity in ("quick", "standard")
        for each in re.findall(
            r"relative velocity \(plain\) ([\d.]+) % at scale \d+ and ([\d.]+) %",
            told(f"particle_size_results_{fidelity}.md"),
        )[0]
    ]
    assert f"velocity, here at {min(found):.0f} to {max(found):.0f} %" in page and max(found) < share


def test_the_table_of_a_constant_torque():
    """Convex over plain by time step and scale, and where it would pass one."""
    page = told("particle_size.md")
    runs = table("constant_torque.csv").pivot(
        index=["rayleigh_fraction", "particle_scale"], columns="surface", values="wear_mm3_per_m"
    )
    ratios = (runs["convex"] / runs["plain"]).unstack()
    short = ratios.index < 0.05  # one step, 5e-6 s, over the Rayleigh time of each scale
    for fraction, line in ratios[~short].iterrows():
        cells = " | ".join("-" if math.isnan(each) else f"{each:.2f}" for each in line)
        assert f"| {fraction:g} | {cells} |" in page
    cells = " | ".join(f"{each:.2f}" for each in ratios[short].max())
    assert f"the step of the source's bulk tests | {cells} |" in page
    lower, upper = ratios.loc[0.23, [4, 6]]
    assert lower < 1.0 < upper and "With 0.23 the side changes between 4 and 6, with 5e-6 s the" in page
    assert (ratios[short].max() > 1.0).all() and "wears more at all three." in page
