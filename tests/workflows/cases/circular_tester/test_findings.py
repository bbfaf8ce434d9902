"""Verdicts on the source's findings: on runs that do what it tells, on runs that do not, and on runs of chance."""

from dataclasses import fields, replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.statistics.verdicts import AGREES, CONTRADICTS, OTHER_SIZE, UNSAID, VERDICTS
from bulkwear.workflows.cases.circular_tester.comparison import ratios_by_revolution
from bulkwear.workflows.cases.circular_tester.findings import BUILDERS, OF_ANY_PATTERN, OURS, findings_table, verdict_on
from bulkwear.workflows.cases.circular_tester.flow import revolution_means
from bulkwear.workflows.cases.circular_tester.observed import Observed
from bulkwear.workflows.cases.circular_tester.volume import element_increments
from bulkwear.workflows.config.claims import claims_of
from tests.support import tester_study as study

CLAIMS = claims_of("circular_tester")
# mm3 per revolution, per revolution2: what the source measured within its margins, curved as its model says, and its
# own equation of scale 4, the plain sample of that made up
TOLD = {
    ("plain", 1): (73.64, 0.0),
    ("plain", 4): (70.0, 0.0),
    ("convex", 1): (35.8, 0.365),
    ("convex", 4): (41.62, 1.57),
}
CONTRARY = {
    ("plain", 1): (10.0, 10.0),
    ("plain", 4): (5.0, 2.0),
    ("convex", 1): (700.0, -4.0),
    ("convex", 4): (60.0, -1.5),
}
BUMPS = [(row, number) for row in range(1, 6) for number in range(1, 6 - (row + 1) % 2)]
FLOW = {  # measure -> plain, convex at first, convex at last
    "bottom_averaged_angular_velocity_rad_per_s": (1.5, 3.5, 1.75),
    "bottom_velocity_m_per_s": (0.5, 0.2, 0.25),
    "normal_force_N": (16.5, 28.0, 18.0),
}
STEADY = ("velocity_m_per_s", "bed_height_m", "wear_rate_m3_per_s")
HOURS = 28.0  # per revolution, as the source's
SCATTER = 0.002  # relative, of packings that tell the source's sizes for sure
TRIALS, FEW = 100, 20
MOST_FALSE = 0.05 + 3.0 * np.sqrt(
    0.05 * 0.95 / TRIALS
)  # of verdicts: the rules' rate and three deviations of its count


def scattered(value, seed, scatter=SCATTER, size=None):
    return value * (1.0 + scatter * np.random.default_rng(seed).normal(size=size))


def flow(packings, measures=FLOW, revolutions=17):
    """Means per revolution: a plain sample that stays, a convex one that goes from first to last."""
    number, parts = np.arange(1, revolutions + 1), []
    for packing in range(1, packings + 1):
        for measure, (plain, first, last) in measures.items():
            for surface, ends in (("plain", (plain, plain)), ("convex", (first, last))):
                mean = scattered(np.linspace(*ends, revolutions), [packing, len(parts)], size=revolutions)
                same = {"surface": surface, "packing": packing, "measure": measure}
                parts.append(pd.DataFrame({"revolution": number, "mean": mean}).assign(**same))
    return pd.concat(parts, ignore_index=True)


def columns(packings, convex=(50.0, 20.0, 25.0, 20.0, 25.0), plain=(20.0, 21.0, 22.0, 23.0, 24.0), share=0.56):
    parts = []
    for packing in range(1, packings + 1):
        for surface, wear, on_bumps in (("convex", convex, share), ("plain", plain, 0.0)):
            total = scattered(np.array(wear), [packing, len(surface)], size=5)
            table = pd.DataFrame({"column": [1, 2, 3, 4, 5], "base_mm3": (1.0 - on_bumps) * total})
            parts.append(table.assign(bumps_mm3=on_bumps * total, surface=surface, packing=packing))
    return pd.concat(parts, ignore_index=True)


def bumps(packings, outer=30.0, inner=8.0):
    rows = [
        {"bump": f"C{row}{n}", "part": part, "row": row, "packing": packing}
        | {"volume_mm3": scattered(v, [packing, row, n])}
        for packing in range(1, packings + 1)
        for part, (row, n) in enumerate(BUMPS, start=1)
        for v in [(outer if row % 2 else 0.5 * (outer + inner) - 5.0) if n in (1, 5) else inner]
    ]
    return pd.DataFrame(rows).sample(frac=1.0, random_state=1)


def meshes(packings, coarse=0.99):
    rows = [
        {"surface": surface, "packing": packing, "element_size_mm": size, "volume_m3": scattered(volume, [packing, k])}
        for packing in range(1, packings + 1)
        for k, (surface, size, volume) in enumerate(
            [("plain", 0.2, 1.0), ("plain", 1.0, coarse), ("convex", 0.2, 0.57), ("convex", 1.0, 0.57 * coarse)]
        )
    ]
    return pd.DataFrame(rows)


def observed(packings=3, laws=TOLD, ring=1.0, revolutions=17, **others):
    """What runs would have seen; ring: its convex samples' wear over the channel's."""
    channel = study.volumes(laws, packings, SCATTER, revolutions=revolutions)
    turned = study.volumes(laws, packings, SCATTER, shape="ring", revolutions=revolutions, seed=2)
    turned["volume_m3"] *= np.where(turned["surface"] == "convex", ring, 1.0)
    lost = pd.concat([channel, turned.assign(series="ring")], ignore_index=True)
    steady = flow(packings, {name: (1.0, 1.0, 1.0) for name in STEADY}, revolutions)
    return replace(
        Observed(
            lost=lost,
            increments=element_increments(lost),
            ratios=ratios_by_revolution(lost),
            columns=columns(packings),
            bumps=bumps(packings),
            means=flow(packings, revolutions=revolutions),
            steady_means=steady,
            hours_per_revolution=HOURS,
            shape="channel",
            scale=1.0,
            meshes=meshes(packings),
        ),
        **others,
    )


def verdicts(seen):
    return findings_table(seen, CLAIMS).set_index("key")


@pytest.fixture(scope="module")
def theirs():
    return observed()


def test_every_claim_has_evidence():
    assert set(CLAIMS) == set(BUILDERS) and set(OF_ANY_PATTERN) < set(CLAIMS)


def test_runs_that_do_what_the_source_tells_agree(theirs):
    """Flow, forces, distribution, rates and reductions as it tells them; numbers and intervals beside the verdicts."""
    table = verdicts(theirs)
    assert (table["verdict"] == AGREES).all(), table[table["verdict"] != AGREES].T
    assert (table["reason"] == "").all() and table["factor"].isna().all()
    assert table["found"].str.contains("3 packings").all()
    assert "scale 4 over 1" in table.loc["convex_sizes", "found"]
    assert "scale 1: 0.6" in table.loc["overtakes", "found"]


def test_runs_that_do_the_opposite_contradict(theirs):
    """A plain sample that wears ever faster, a convex one that wears more and slows down, flow the other way round."""
    turned = {measure: (last, 0.5 * plain, 0.6 * plain) for measure, (plain, _, last) in FLOW.items()}
    turned["bottom_velocity_m_per_s"] = (0.2, 0.5, 0.5)
    drift = {name: (1.0, 1.0, 2.0) for name in STEADY}
    seen = observed(
        laws=CONTRARY,
        ring=0.5,
        columns=columns(3, (20.0, 50.0, 25.0, 20.0, 25.0), (30.0, 26.0, 22.0, 18.0, 14.0), 0.2),
        bumps=bumps(3, 4.0, 60.0),
        means=flow(3, turned),
        steady_means=flow(3, drift),
        meshes=meshes(3, 0.8),
    )
    table = verdicts(seen)
    assert (table["verdict"] == CONTRADICTS).all(), table[table["verdict"] != CONTRADICTS].T


@pytest.mark.parametrize(
    ("key", "changes", "factor"),
    [
        ("less_short", {"laws": TOLD | {("convex", 1): (73.64 / 4.0, 0.0)}}, 0.75 / 0.43),
        ("convex_quadratic", {"laws": TOLD | {("convex", 4): (35.8, 0.1)}}, 9.07 / 29.6),
        ("bump_share", {"columns": columns(3, share=0.9)}, 40.0 / 6.0),
        ("spin", {"means": flow(3, {"bottom_averaged_angular_velocity_rad_per_s": (1.0, 4.0, 4.0)})}, 3.0 / 1.33),
        ("force_falls", {"means": flow(3, {"normal_force_N": (1.0, 11.0, 10.0)})}, 9.52 / 43.5),
    ],
)
def test_the_claimed_direction_with_another_size_has_a_factor(key, changes, factor):
    """What was found over what is published, both as differences from the reference."""
    seen = observed(**{name: value for name, value in changes.items() if name == "laws"})
    found = verdict_on(key, replace(seen, **{k: v for k, v in changes.items() if k != "laws"}), CLAIMS[key])
    assert found.verdict == OTHER_SIZE
    assert found.factor == pytest.approx(factor, rel=0.1)  # packings scatter, of small differences the most


def test_one_packing_says_nothing():
    """Whatever its revolutions, cycles and instants: the scatter is unknown, and is said to be."""
    table = verdicts(observed(packings=1))
    assert (table["verdict"] == UNSAID).all() and (table["reason"] == UNKNOWN).all()
    assert table["found"].str.contains(UNKNOWN).all()


def test_runs_that_do_not_reach_the_claimed_range_say_nothing():
    """Four revolutions: nothing of seventeen, of revolution 15, of 184 h; what is extrapolated is marked."""
    table = verdicts(observed(revolutions=4))
    short = ["plain_linear", "convex_quadratic", "less_long", "overtakes", "spin_falls", "force_falls", "steady"]
    short += ["odd_bumps", "even_bumps"]
    assert (table.loc[short, "verdict"] == UNSAID).all()
    assert table.loc[short, "reason"].str.contains("the runs cover").all()
    assert "of 15 to 17 revolutions, the runs cover 0 to 4" in table.loc["overtakes", "reason"]
    assert "extrapolated beyond 112 h" in table.loc["less_long", "found"]
    assert (table.drop(index=short)["verdict"] == AGREES).all()


def test_too_little_says_nothing(theirs):
    """One particle scale, no meshes, no ring, no bump between those at the sides."""
    one = {name: getattr(theirs, name) for name in ("lost", "increments", "ratios")}
    one = {name: table[(table["particle_scale"] == 1.0) & (table["shape"] == "channel")] for name, table in one.items()}
    ends = theirs.bumps[theirs.bumps["bump"].str.endswith(("1", "5"))]
    table = verdicts(replace(theirs, **one, meshes=None, bumps=ends))
    keys = ["plain_sizes", "convex_sizes", "overtakes", "outer_bumps", "mesh_size", "machines"]
    assert (table.loc[keys, "verdict"] == UNSAID).all() and (table.loc[keys, "reason"] != "").all()
    assert "particle scale 4, which no pair" in table.loc["overtakes", "reason"]
    assert (table.drop(index=[*keys, "convex_quadratic"])["verdict"] == AGREES).all()


def test_bumps_at_the_sides_are_told_apart_in_rows_of_many(theirs):
    """Of twelve bumps the first and the twelfth are at the sides, whatever the order of their names."""
    rows = [
        {"bump": f"C1-{n}", "part": n, "row": 1, "packing": packing, "volume_mm3": 3.0 if n in (1, 12) else 1.0}
        for packing in (1, 2)
        for n in range(1, 13)
    ]
    evidence = BUILDERS["outer_bumps"](replace(theirs, bumps=pd.DataFrame(rows)), CLAIMS["outer_bumps"])
    assert evidence.found["column 1"].value == pytest.approx(3.0)


@pytest.mark.parametrize("count", [1, 3, 9])
def test_other_columns_than_the_sources_are_told_and_judge_nothing(theirs, count):
    """A sample with another number of rows has no five columns, which the claims on the plain sample name."""
    wear = pd.DataFrame({"column": np.arange(1, count + 1), "base_mm3": 20.0, "bumps_mm3": 0.0})
    parts = [wear.assign(surface=surface, packing=k) for surface in ("plain", "convex") for k in (1, 2, 3)]
    table = verdicts(replace(theirs, columns=pd.concat(parts, ignore_index=True)))
    keys = ["plain_columns", "plain_even"]
    assert (table.loc[keys, "verdict"] == UNSAID).all()
    assert set(table.loc[keys, "reason"]) == {f"claimed of 5 columns, the sample is told by {count}"}
    assert table.loc["plain_columns", "found"] == f"columns over their mean {', '.join(['1.00'] * count)}"


def test_a_pattern_worn_right_off_is_told_and_judges_nothing(theirs):
    """That it loses more in the end is no finding of the source, which says it of revolution 15."""
    end = pd.DataFrame({"run": ["worn-out"], "faster_revolution": [760.0], "faster_share": [0.15]})
    slower = observed(laws=TOLD | {("convex", 4): (41.62, 0.0)}, worn_out=end)
    found = verdict_on("overtakes", slower, CLAIMS["overtakes"])
    assert found.verdict == CONTRADICTS and "revolution 760 (15 % of the pattern left)" in found.found
    never = replace(theirs, worn_out=end.assign(faster_revolution=np.nan))
    assert "never faster" in verdict_on("overtakes", never, CLAIMS["overtakes"]).found


def test_another_pattern_says_nothing_of_the_sources(theirs):
    """What is found of another pattern is told, but judges only what the source says of any sample."""

    def renamed(value):
        return value.replace({"surface": {"convex": "dimpled"}}) if isinstance(value, pd.DataFrame) else value

    other = replace(theirs, **{field.name: renamed(getattr(theirs, field.name)) for field in fields(theirs)})
    why = "found of a dimpled sample, the source's is convex"
    found, own = verdicts(replace(other, foreign={"dimpled": why})), verdicts(theirs)
    kept = list(OF_ANY_PATTERN)
    assert found.loc[kept, "verdict"].tolist() == own.loc[kept, "verdict"].tolist()
    of_pattern = found.drop(index=kept)
    assert set(of_pattern["verdict"]) == {UNSAID}
    assert set(of_pattern["reason"]) == {why}
    assert found.loc["bump_share", "found"] == own.loc["bump_share", "found"]


def test_another_machine_says_nothing_of_the_sources(theirs):
    """Then what is found of its plain sample judges no claim either, and is told."""
    why = "found with tester.depth_mm 60, the source's is 90"
    found, own = verdicts(replace(theirs, foreign=dict.fromkeys(("plain", "convex"), why))), verdicts(theirs)
    of_source = found.drop(index=list(OURS))
    assert set(of_source["verdict"]) == {UNSAID} and set(of_source["reason"]) == {why}
    assert found.loc[list(OURS), "verdict"].tolist() == own.loc[list(OURS), "verdict"].tolist()
    assert found["found"].tolist() == own["found"].tolist()


def test_volumes_are_held_against_the_sources_at_its_coefficient(theirs):
    """Twice the coefficient wears bumps twice as much: the same verdict, of volumes that are told of the source's."""
    keys = ["odd_bumps", "even_bumps"]
    worn = theirs.bumps.assign(volume_mm3=2.0 * theirs.bumps["volume_mm3"])
    found, own = verdicts(replace(theirs, bumps=worn, times_source=2.0)), verdicts(theirs)
    assert found.loc[keys, "verdict"].tolist() == own.loc[keys, "verdict"].tolist() == [AGREES] * len(keys)
    assert (found.loc[keys, "found"] == own.loc[keys, "found"] + "; told at the source's wear coefficient").all()
    assert (verdicts(replace(theirs, bumps=worn)).loc[keys, "verdict"] != AGREES).all()


def test_means_of_the_flow_are_those_of_its_series():
    """The measures of findings are those of a series of a run."""
    assert set(FLOW) | set(STEADY) <= set(revolution_means(study.series(), [*FLOW, *STEADY])["measure"])


# ---------------------------------------------------------------- runs of chance


def chance(generator, change=0.0, packings=3, revolutions=17, packing_scatter=0.05, noise=0.07, memory=0.6):
    """Rates per revolution of packings that scatter, remember, and change by a share of their mean over the run."""
    parts = []
    for packing in range(1, packings + 1):
        wave = generator.normal(size=revolutions)
        for k in range(1, revolutions):
            wave[k] = memory * wave[k - 1] + np.sqrt(1.0 - memory**2) * wave[k]
        line = 1.0 + change * (np.arange(revolutions) + 0.5 - 0.5 * revolutions) / revolutions
        rate = (1.0 + packing_scatter * generator.normal()) * line * (1.0 + noise * wave)
        parts.append(pd.DataFrame({"revolution": np.arange(revolutions), "rate": rate, "packing": packing}))
    return pd.concat(parts, ignore_index=True)


def verdicts_of_chance(key, make, trials=TRIALS):
    """Return how often each verdict is given (-); make: of a generator, what of the runs is seen."""
    generator, blank = np.random.default_rng(11), observed(packings=1, revolutions=2)
    found = [verdict_on(key, replace(blank, **make(generator)), CLAIMS[key]).verdict for _ in range(trials)]
    return {verdict: np.mean([each == verdict for each in found]) for verdict in VERDICTS}


def increments(generator, surface, change):
    table = chance(generator, change).rename(columns={"rate": "increment_mm3"})
    return table.assign(end=table["revolution"] + 1.0, surface=surface, shape="channel", particle_scale=1.0)


def force(generator, change):
    table = chance(generator, change).rename(columns={"rate": "mean"})
    return table.assign(revolution=table["revolution"] + 1, surface="convex", measure="normal_force_N")


def ratios(generator, level):
    both = [chance(generator)["rate"] for _ in range(2)]
    table = chance(generator).assign(plain_mm3=both[0], patterned_mm3=level * both[1], shape="channel")
    return table.assign(end=table["revolution"] + 1.0, particle_scale=4.0, ratio=level * both[1] / both[0])


def five_columns(generator):
    wear = 20.0 * (1.0 + 0.1 * generator.normal(size=(3, 5)))
    table = pd.DataFrame({"column": np.tile(np.arange(1, 6), 3), "packing": np.repeat([1, 2, 3], 5)})
    return table.assign(surface="convex", base_mm3=wear.ravel(), bumps_mm3=0.0)


@pytest.mark.parametrize(
    ("key", "false", "make"),
    [
        pytest.param(
            *("plain_linear", [AGREES], lambda g: {"increments": increments(g, "plain", 0.10)}),
            marks=pytest.mark.verify,
        ),
        ("force_falls", [OTHER_SIZE, CONTRADICTS], lambda g: {"means": force(g, 0.0)}),
        pytest.param(
            *("plain_linear", [CONTRADICTS], lambda g: {"increments": increments(g, "plain", 0.0)}),
            marks=pytest.mark.verify,
        ),
        pytest.param(
            *("convex_quadratic", [OTHER_SIZE, CONTRADICTS], lambda g: {"increments": increments(g, "convex", 0.0)}),
            marks=pytest.mark.verify,
        ),
        pytest.param(
            *("overtakes", [AGREES, CONTRADICTS], lambda g: {"ratios": ratios(g, 1.0)}), marks=pytest.mark.verify
        ),
        pytest.param(
            *("first_column", [AGREES, CONTRADICTS], lambda g: {"columns": five_columns(g)}), marks=pytest.mark.verify
        ),
    ],
)
def test_chance_gives_few_verdicts(key, false, make):
    """Correlated rates of three packings at the edge of a claim: a verdict that is false there comes in 5 % at most."""
    shares = verdicts_of_chance(key, make)
    assert all(shares[verdict] <= MOST_FALSE for verdict in false), shares


def test_what_is_there_is_found():
    """A force that falls as published is often told; a plain sample that comes to wear 40 % faster is not linear."""
    falls = verdicts_of_chance("force_falls", lambda g: {"means": force(g, -0.435)}, FEW)
    assert falls[UNSAID] < 0.65 and falls[CONTRADICTS] == 0.0
    faster = verdicts_of_chance("plain_linear", lambda g: {"increments": increments(g, "plain", 0.4)}, FEW)
    assert faster[AGREES] == 0.0 and faster[CONTRADICTS] > 0.5
