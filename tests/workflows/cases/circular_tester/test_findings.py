"""Findings of the source on runs that do what it tells, and on runs that do not."""

from dataclasses import fields, replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.verdicts import CONFIRMED, REFUTED, UNSAID
from bulkwear.workflows.cases.circular_tester import volume as tester_volume
from bulkwear.workflows.cases.circular_tester.comparison import ratios_by_revolution
from bulkwear.workflows.cases.circular_tester.distribution import mesh_size_effect
from bulkwear.workflows.cases.circular_tester.findings import OF_ANY_PATTERN, TESTS, Evidence, findings_table
from bulkwear.workflows.cases.circular_tester.flow import revolution_means, steady_revolutions
from bulkwear.workflows.cases.circular_tester.tables import crossings
from tests.support import tester_study as study

THESIS = {  # surface, particle scale -> mm3 per revolution, per revolution2: the source's own, plain of scale 4 made up
    ("plain", 1.0): (73.64, 0.0),
    ("plain", 4.0): (70.0, 0.0),
    ("convex", 1.0): (30.29, 0.31),
    ("convex", 4.0): (41.62, 1.57),
}
BUMPS = [(row, number) for row in range(1, 6) for number in range(1, 6 - (row + 1) % 2)]
FLOW = {  # measure -> plain, convex at first, convex at last
    "bottom_averaged_angular_velocity_rad_per_s": (1.5, 3.5, 1.7),
    "bottom_velocity_m_per_s": (0.5, 0.2, 0.25),
    "normal_force_N": (16.0, 28.0, 18.0),
}


def volumes(laws):
    x = np.arange(18.0)
    return pd.concat(
        [
            pd.DataFrame(
                {"revolution": x, "volume_m3": 1e-9 * tester_volume.volume_at(np.array(terms), x), "elements": 10}
            ).assign(run=f"{surface}{scale:g}", surface=surface, particle_scale=scale)
            for (surface, scale), terms in laws.items()
        ],
        ignore_index=True,
    )


def flow(measures):
    """Twelve revolutions of the convex sample, of which the last three have settled at the second value."""
    number, parts = np.arange(1, 13), []
    for measure, (plain, first, last) in measures.items():
        means = {"plain": np.full(12, plain), "convex": np.linspace(first, last, 12)}
        parts += [
            pd.DataFrame({"revolution": number, "mean": mean, "surface": surface, "measure": measure})
            for surface, mean in means.items()
        ]
    return pd.concat(parts, ignore_index=True)


def evidence(laws=THESIS, measures=FLOW):
    fits = tester_volume.volume_fits(volumes(laws))
    scale = tester_volume.time_scale(tester_volume.chosen_fit(fits, "plain1"), 5e-9, study.PUBLISHED, 1.071, 0.01)
    terms = {each: [np.array(laws[surface, each]) for surface in ("plain", "convex")] for each in (1.0, 4.0)}
    crossings = [
        {
            "particle_scale": each,
            "rate_crossing": tester_volume.rate_crossing(*both),
            "crossing": tester_volume.crossing(*both),
        }
        for each, both in terms.items()
    ]
    machines = {("plain", 6.0): (80.0, 0.0), ("convex", 6.0): (50.0, 0.2)}
    machine = pd.concat([volumes(machines).assign(shape=shape) for shape in ("channel", "ring")])
    machine.loc[(machine["shape"] == "ring") & (machine["surface"] == "convex"), "volume_m3"] *= 0.999
    columns = pd.DataFrame({"run": np.repeat(["convex", "plain"], 5), "column": [1, 2, 3, 4, 5] * 2})
    columns["surface"] = columns["run"]
    columns["base_mm3"] = [20.0, 10.0, 10.0, 10.0, 10.0, 20.0, 21.0, 22.0, 23.0, 24.0]
    columns["bumps_mm3"] = [30.0, 10.0, 15.0, 10.0, 15.0] + [0.0] * 5
    bumps = pd.DataFrame(
        [{"bump": f"C{row}{n}", "row": row, "volume_mm3": 30.0 if n in (1, 5) else 8.0} for row, n in BUMPS]
    )
    meshes = pd.DataFrame({"surface": ["plain", "plain", "convex", "convex"], "element_size_mm": [0.5, 1.0] * 2})
    return Evidence(
        fits=fits,
        predictions=tester_volume.predictions(fits, scale, [56.0, 184.0]),
        crossings=pd.DataFrame(crossings),
        ratios=ratios_by_revolution(machine),
        columns=columns,
        bumps=bumps.sample(frac=1.0, random_state=1),
        means=flow(measures),
        steady=steady_revolutions(study.series(revolutions=12)),
        meshes=mesh_size_effect(meshes.assign(volume_m3=[1.0, 0.98, 0.57, 0.56])),
        worn_out=None,
        main=1.0,
        short=56.0,
        long=184.0,
    )


@pytest.fixture(scope="module")
def theirs():
    return evidence()


def verdicts(found):
    return findings_table(found, study.PUBLISHED_FINDINGS).set_index("key")


def test_every_published_finding_has_a_test():
    assert study.PUBLISHED_FINDINGS["key"].tolist() == list(TESTS)
    assert study.PUBLISHED_FINDINGS["source"].str.contains("Yan 2022|none").all()


def test_runs_that_do_what_the_source_tells_confirm_it(theirs):
    """Its own fits, and flow, forces and distribution as it tells them; numbers stand beside the verdicts."""
    table = verdicts(theirs)
    assert (table["verdict"] == CONFIRMED).all(), table[table["verdict"] != CONFIRMED].T
    assert "R² 1.00000 over 17 revolutions" in table.loc["plain_linear", "found"]
    assert "58 % less after 1.97" in table.loc["less_short", "found"]
    assert "scale 4: faster from revolution 9.04" in table.loc["overtakes", "found"]


def test_runs_that_do_the_opposite_refute_it(theirs):
    """A plain sample that wears ever faster, a convex one that wears more and slows down, flow the other way round."""
    laws = {
        ("plain", 1.0): (10.0, 30.0),
        ("plain", 4.0): (5.0, 10.0),
        ("convex", 1.0): (700.0, -4.0),
        ("convex", 4.0): (300.0, -2.0),
    }
    opposite = {measure: (last, 0.5 * plain, 0.6 * plain) for measure, (plain, _, last) in FLOW.items()}
    opposite["bottom_velocity_m_per_s"] = (0.2, 0.5, 0.5)
    found = verdicts(evidence(laws, opposite))["verdict"]
    wrong = ["plain_linear", "convex_quadratic", "less_short", "plain_sizes", "convex_sizes"]
    assert (found[[*wrong, "spin", "velocity", "force"]] == REFUTED).all()
    turned = theirs.columns.assign(base_mm3=[10.0, 10.0, 10.0, 10.0, 30.0, 24.0, 23.0, 22.0, 21.0, 20.0], bumps_mm3=1.0)
    ratios = theirs.ratios.assign(ratio=theirs.ratios["ratio"] * np.where(theirs.ratios["shape"] == "ring", 0.5, 1.0))
    ratios["convex_mm3"] *= np.where(ratios["shape"] == "ring", 0.5, 1.0)
    other = replace(
        theirs,
        columns=turned,
        ratios=ratios,
        bumps=theirs.bumps.assign(volume_mm3=38.0 - theirs.bumps["volume_mm3"]),
        meshes=theirs.meshes.assign(deviation_percent=9.0),
        crossings=theirs.crossings.assign(rate_crossing=np.inf),
    )
    found = verdicts(other)["verdict"]
    keys = ["bump_share", "first_column", "plain_columns", "outer_bumps", "mesh_size", "machines", "overtakes"]
    assert (found[keys] == REFUTED).all()


def test_too_little_says_nothing(theirs):
    """One particle scale, no meshes, no ring, two revolutions; what lies beyond a run is a reserve, not a refusal."""
    one = theirs.predictions[theirs.predictions["particle_scale"] == 1.0]
    short = theirs.fits.assign(revolutions=2.0)
    channel = theirs.ratios[theirs.ratios["shape"] == "channel"]
    found = verdicts(replace(theirs, predictions=one, fits=short, meshes=None, ratios=channel))
    keys = ["plain_linear", "convex_quadratic", "plain_sizes", "convex_sizes", "mesh_size", "machines"]
    assert (found.loc[keys, "verdict"] == UNSAID).all() and (found.loc[keys, "reason"] != "").all()
    beyond = replace(theirs, predictions=theirs.predictions.assign(extrapolated=True))
    row = verdicts(beyond).loc["less_long"]
    assert row["verdict"] == CONFIRMED and "beyond" in row["reason"]


def test_what_the_sources_own_equations_say():
    """After two revolutions particles of scale 4 wear less than those of scale 3. Convex of scale 4 wears faster than
    Eq 6.2 from revolution 10 on, not 15: its increments are means over elements, of which a convex sample has more.
    """
    terms = {
        scale: tester_volume.published_terms(study.PUBLISHED_FITS, "convex", scale) for scale in (1.0, 2.0, 3.0, 4.0)
    }
    after = {scale: float(tester_volume.volume_at(each, 2.0)) for scale, each in terms.items()}
    assert after[4.0] < after[3.0] and sorted(after.values()) != list(after.values())
    plain = tester_volume.published_terms(study.PUBLISHED_FITS, "plain", 1.0)
    assert tester_volume.rate_crossing(plain, terms[4.0]) == pytest.approx(10.2, abs=0.05)
    assert 100.0 * (1.0 - after[1.0] / tester_volume.volume_at(plain, 2.0)) == pytest.approx(58.0, abs=0.1)


def test_means_of_the_flow_are_those_of_its_series():
    """The measures of findings are those of a series of a run."""
    assert set(FLOW) <= set(revolution_means(study.series(), list(FLOW))["measure"])


def test_a_pattern_worn_right_off_may_overtake_where_no_fit_does(theirs):
    """Fits without curvature never cross; a run that wears the pattern off says when it is faster, or never."""
    straight = replace(theirs, crossings=theirs.crossings.assign(rate_crossing=np.inf))
    assert verdicts(straight).loc["overtakes", "verdict"] == REFUTED
    end = pd.DataFrame({"run": ["worn-out"], "faster_revolution": [760.0], "faster_share": [0.15]})
    told = verdicts(replace(straight, worn_out=end)).loc["overtakes"]
    assert told["verdict"] == CONFIRMED
    assert told["reason"] == "only when 15 % of the pattern are left" and "revolution 760" in told["found"]
    never = verdicts(replace(straight, worn_out=end.assign(faster_revolution=np.nan)))
    assert never.loc["overtakes", "verdict"] == REFUTED


def test_a_force_that_wavers_does_not_fall(theirs):
    """Ups and downs that end a little lower than they began are no fall; the force is still higher than on plain."""
    means = theirs.means.copy()
    convex = (means["measure"] == "normal_force_N") & (means["surface"] == "convex")
    means.loc[convex, "mean"] = 20.0 + 0.1 * (-1.0) ** np.arange(convex.sum())
    found = verdicts(replace(theirs, means=means)).loc["force"]
    assert found["verdict"] == REFUTED and verdicts(theirs).loc["force", "verdict"] == CONFIRMED


def test_another_pattern_says_nothing_of_the_sources(theirs):
    """What is found of another pattern is told, but judges only what the source says of any sample."""

    def renamed(value):
        return value.replace({"surface": {"convex": "dimpled"}}) if isinstance(value, pd.DataFrame) else value

    other = replace(theirs, **{field.name: renamed(getattr(theirs, field.name)) for field in fields(theirs)})
    found, own = verdicts(other), verdicts(theirs)
    assert found.loc[list(OF_ANY_PATTERN), "verdict"].tolist() == own.loc[list(OF_ANY_PATTERN), "verdict"].tolist()
    of_pattern = found.drop(index=list(OF_ANY_PATTERN))
    assert set(of_pattern["verdict"]) == {UNSAID}
    assert set(of_pattern["reason"]) == {"found of a dimpled sample, the source's is convex"}
    assert found.loc["bump_share", "found"] == own.loc["bump_share", "found"]
    assert found.loc["force", "found"].startswith("dimpled over plain")
    crossing = crossings(theirs.fits[theirs.fits["particle_scale"] == 1.0])
    pd.testing.assert_frame_equal(crossings(other.fits[other.fits["particle_scale"] == 1.0]), crossing)
    assert len(crossing) == 1
