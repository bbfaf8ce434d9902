"""Candidates for the critical particle scale: what they change and what they leave, their table, page and figure."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.stats import bartlett

from benchmarks import critical_scale, scale_case, scale_page
from benchmarks.critical_scale import (
    comparison,
    critical_scales,
    finished,
    main,
    ordered,
    publish,
    remarks,
    simulate_all,
    where_it_lies,
    without_reference,
)
from benchmarks.plots.critical_scale import ratio_by_scale
from benchmarks.runs import BY, FIRST_SEED, failure_file, with_earlier
from benchmarks.scale_case import CANDIDATES, REFERENCE, SETTINGS, Case, cases, chain_of
from benchmarks.scale_page import conclusion, needed_factor, source_ratio, touched_by_scale
from bulkwear.postproc.statistics.crossing import Crossing
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import merge
from tests.support.loaded_once import loaded_once

OTHER = "neighbouring rows 40 mm apart"
TINY = {
    "fidelity": "quick",
    "sample": {"width_mm": 40, "length_mm": 40, "element_size_mm": 4, "skirt_radius_mm": 0, "skirt_slope_deg": 1},
    "bed": {"width_mm": 80, "ahead_mm": 60, "behind_mm": 60},
    "sliding": {"run_in_mm": 20, "travel_mm": 100},
    "solver": {"picture_interval_mm": 10, "wear_interval_mm": 50},
}
STUDENT_95_1 = 12.7062  # two-sided 95 % point of Student's t with one degree of freedom; tables


@pytest.fixture(scope="module", autouse=True)
def study_loaded_once():
    """Every case is a change of one row of one study."""
    with loaded_once(scale_case):
        yield


def rows(ratios=((REFERENCE, (0.5, 0.5 * np.e)), (OTHER, (1.0,)))):
    """Runs whose convex sample wears so many times as much as the plain one; half of it on the bumps."""
    told = {"normal_force_N": 10.0, "slip_percent": 50.0, "velocity_percent": 40.0, "processor_s": 1.0}
    told[scale_page.BY] = "commit a"
    return pd.DataFrame(
        {
            **{"particle_scale": 6, "candidate": name, "surface": surface, "seed": seed},
            **{"wear_mm3_per_m": wear, "bumps_mm3_per_m": 0.5 * wear * (surface == "convex"), **told},
        }
        for name, values in ratios
        for seed, ratio in enumerate(values)
        for surface, wear in (("plain", 2.0), ("convex", 2.0 * ratio))
    )


def test_reference_is_the_row_of_the_study(tmp_path):
    """Nothing is changed in it but the seed, which for the first packing is the study's own."""
    (run,) = (run for run in load_study("particle_size", overrides=SETTINGS).runs if run.name == "S6_convex")
    assert chain_of(Case(REFERENCE, "convex", 6, FIRST_SEED), tmp_path, SETTINGS).parameters == run.parameters


def test_every_candidate_changes_something_and_only_that(tmp_path):
    """Given parameters differ in the sections named, in both surfaces or, for the pattern, in the convex one."""
    reference = {name: chain_of(Case(REFERENCE, name, 6, 1), tmp_path, SETTINGS) for name in scale_case.SURFACES}
    for name, candidate in CANDIDATES.items():
        for surface, before in reference.items():
            chain = chain_of(Case(name, surface, 6, 1), tmp_path, SETTINGS)
            given = set(before.parameters) - {"derived"}
            moved = {key for key in given if chain.parameters[key] != before.parameters[key]}
            same = surface == "plain" and set(candidate.change) == {"pattern"}
            assert moved == (set() if same else set(candidate.change)), name
            assert (chain.folder == before.folder) == (same or name == REFERENCE), name


def test_mass_fractions_add_up_and_keep_the_median():
    """Half of the mass is in particles below the median, half of the middle class counted to each side."""
    for candidate in CANDIDATES.values():
        particle = candidate.change.get("particle", {})
        if scale_case.SIZES not in particle:
            continue
        sizes, masses = np.array(particle[scale_case.SIZES]), np.array(particle["mass_fractions"])
        assert masses.sum() == pytest.approx(1.0)
        assert masses[sizes < 1.0].sum() + 0.5 * masses[sizes == 1.0].sum() == pytest.approx(0.5)


def test_beds_are_shared_where_they_are_the_same(tmp_path):
    """What concerns the sample alone starts from the reference's packing; another seed or another bed does not."""
    bed = {
        (name, seed): chain_of(Case(name, "convex", 6, seed), tmp_path, SETTINGS).bed_restart
        for name in CANDIDATES
        for seed in (1, 2)
    }
    shared = {name for name, seed in bed if bed[name, seed] == bed[REFERENCE, 1]}
    assert {REFERENCE, OTHER, "bumps turned", "sliding friction of the sample 0.5"} <= shared
    assert not {"one size of particles", "bed of 92 mm", "bed between walls", "time step 0.2"} & shared
    assert bed[REFERENCE, 1] != bed[REFERENCE, 2]


def test_the_reference_has_more_packings():
    """It alone has an interval then; candidates that are not asked for are left out, and so is the reference."""
    assert [case.candidate for case in cases((6,), (OTHER,), 1, 3)] == [OTHER, OTHER]
    found = cases((6,), (REFERENCE, OTHER), 1, 3)
    assert [case.candidate for case in found if case.surface == "convex"] == [REFERENCE, OTHER, REFERENCE, REFERENCE]
    assert len({case.seed for case in found}) == 3


def test_a_scale_without_the_reference_is_refused_before_it_is_simulated(tmp_path, monkeypatch, capsys):
    """Unless the table of earlier runs has it there."""
    file = tmp_path / "critical_scale.csv"
    rows().to_csv(file, index=False)
    known = int(rows()["particle_scale"].iloc[0])
    assert without_reference(cases((known, 5), (OTHER,), 1, 3), file) == [5]
    assert without_reference(cases((5,), (OTHER, REFERENCE), 1, 3), file) == []
    arguments = ["--scales", "5", "--candidates", OTHER, "--output", str(tmp_path)]
    monkeypatch.setattr("sys.argv", ["critical_scale", *arguments])
    with pytest.raises(SystemExit):
        main()
    assert "at scale 5 nothing is compared with" in capsys.readouterr().err


def test_packings_are_what_is_repeated():
    """Logarithms 0 and 1 of one candidate: deviation sqrt(1/2), one degree of freedom, mean sqrt(e); a candidate of one
    packing has its value and no interval.
    """
    table = comparison(rows()).set_index("candidate")
    assert list(table["wear_over_plain"]) == pytest.approx([0.5 * np.sqrt(np.e), 1.0])
    assert table["over_reference"][OTHER] == pytest.approx(2.0 / np.sqrt(np.e))
    reach = STUDENT_95_1 * 0.5
    assert table["ratio_high"][REFERENCE] == pytest.approx(0.5 * np.exp(0.5 + reach), rel=1e-4)
    ends = ["ratio_low", "ratio_high", "over_reference_low", "over_reference_high"]
    assert table.loc[OTHER, ends].isna().all()
    assert table["share_of_bumps_percent"].to_numpy() == pytest.approx([50.0, 50.0])
    assert table["kind"].to_list() == ["", "open"]


def test_scales_share_one_scatter():
    """Two packings that happen to agree at one scale leave it the scatter of the others: of logarithms 0 and 1 at two
    candidates of scale 6 and none at scale 8 the variance is a half of 1/2; ratios are those of a scale.
    """
    apart, alike = (0.5, 0.5 * np.e), (2.0, 2.0)
    at_6, at_8 = rows(((REFERENCE, apart), (OTHER, apart))), rows(((REFERENCE, alike), (OTHER, alike)))
    table = comparison(pd.concat([at_6, at_8.assign(particle_scale=8)], ignore_index=True))
    assert table["particle_scale"].tolist() == [6, 6, 8, 8] and (table["freedom"] == 4).all()
    assert table["scatter"].to_numpy() == pytest.approx(np.full(4, 0.5))
    assert table["over_reference"].to_numpy() == pytest.approx(np.ones(4))


def test_whether_scales_scatter_alike_is_told():
    """Each with its own, and a test that is scipy's of the residuals where every scale has one candidate."""
    generator = np.random.default_rng(3)
    values = {scale: np.exp(generator.normal(0.0, size, 4)) for scale, size in ((4, 0.02), (6, 0.03), (8, 0.04))}
    at = [rows(((REFERENCE, tuple(found)),)).assign(particle_scale=scale) for scale, found in values.items()]
    said = scale_page.scatter_words(comparison(pd.concat(at, ignore_index=True)))
    own = ", ".join(f"{100.0 * np.log(found).std(ddof=1):.1f} at {scale}" for scale, found in values.items())
    chance = bartlett(*(np.log(found) for found in values.values())).pvalue
    assert (
        f"By particle scale it is {own} %, and Bartlett's test does not reject one for all (p = {chance:.2g})." in said
    )
    values[8] = np.exp([0.0, 1.0, -1.0, 2.0])
    at[2] = rows(((REFERENCE, tuple(values[8])),)).assign(particle_scale=8)
    assert "Bartlett's test rejects one" in scale_page.scatter_words(comparison(pd.concat(at, ignore_index=True)))


def test_a_scale_without_the_reference_has_no_ratio():
    """It is named, beside what there is."""
    alone = rows(((OTHER, (1.0,)),)).assign(particle_scale=8)
    with pytest.raises(ValueError, match=f"no run of {REFERENCE} at 8, found are {OTHER}"):
        comparison(pd.concat([rows(), alone], ignore_index=True))


def test_candidates_of_several_scales_are_drawn_against_the_scale(tmp_path, monkeypatch):
    """A line for each of them beside the source's; a candidate of one scale is in the other figure alone."""
    monkeypatch.setattr(scale_page, "SPHERES", 20)
    scales = [rows(((REFERENCE, (0.1 * scale, 0.11 * scale)),)).assign(particle_scale=scale) for scale in (4, 6, 8)]
    runs = pd.concat([*scales, rows(((OTHER, (1.0,)),))], ignore_index=True)
    page, table = publish(tmp_path, runs), comparison(runs)
    assert "(critical_scale_curves.png)" in page and (tmp_path / "critical_scale_curves.png").is_file()
    figure = ratio_by_scale(table, {scale: source_ratio(scale) for scale in (4, 6, 8)}, ["tiny"])
    lines = {line.get_label(): line for line in figure.axes[0].get_lines()}
    assert REFERENCE in lines and OTHER not in lines
    assert lines["Yan 2022, Eq 4.14, 4.15"].get_ydata() == pytest.approx([source_ratio(scale) for scale in (4, 6, 8)])
    of_reference = table[table["candidate"] == REFERENCE]["wear_over_plain"]
    assert lines[REFERENCE].get_ydata() == pytest.approx(of_reference.to_numpy())


def test_the_sources_ratio_is_that_of_its_lines():
    """Eq 4.14 and 4.15 at scale 6: 1.48 over 0.998; the bumps' part of 0.5 + 0.5 has to be 1.97 times as large."""
    assert source_ratio(6) == pytest.approx(1.48 / 0.998)
    reference = pd.Series({"base_over_plain": 0.5, "bumps_over_plain": 0.5})
    assert needed_factor(reference, 6) == pytest.approx((1.48 / 0.998 - 0.5) / 0.5)


def test_page_and_figure(tmp_path, monkeypatch):
    """A row per candidate, what moved the ratio most, and a picture; one packing alone has no interval."""
    monkeypatch.setattr(scale_page, "SPHERES", 20)
    page = publish(tmp_path, rows())
    assert (tmp_path / "critical_scale_results.md").read_text() == page
    assert (tmp_path / "critical_scale.png").stat().st_size > 10_000
    assert f"| 6 | {OTHER} | open | 1 | 1 |" in page
    assert "Above the source's ratio: none of them." in " ".join(page.split())
    assert not (tmp_path / "critical_scale_curves.png").exists()  # one scale
    single = rows(((REFERENCE, (0.5,)), (OTHER, (1.5,))))
    table = comparison(single)
    assert table["ratio_low"].isna().all()
    assert f"Above the source's ratio: {OTHER}. Intervals that hold it: none." in conclusion(table)
    around = table.assign(ratio_low=1.4, ratio_high=1.6)  # the source's lines have 1.48
    assert f"Intervals that hold it: {OTHER}." in conclusion(around)
    assert "Intervals that hold it: none." in conclusion(around.assign(ratio_low=1.5))
    for base, off in ((0.139, "none"), (0.15, "none"), (0.2, f"{OTHER} (0.200)")):  # the source's lines have 0.138
        assert f"Base more than 15 % off the source's: {off}." in conclusion(table.assign(base_over_plain=base))
    said = " ".join(remarks(single, table))
    assert "at most 1 packings of the study with the source's pair" in said and "not known" in said
    assert "not known" in scale_page.scatter_words(table) and "bumps turned" not in page


def test_large_particles_touch_more_triangles(monkeypatch):
    """The number grows with scale and load, on the bump and on the flat."""
    monkeypatch.setattr(scale_page, "SPHERES", 60)
    monkeypatch.setattr(scale_page, "SCALES", (1, 8))
    small, large = touched_by_scale().drop(columns="particle_scale").to_numpy()
    assert (small >= 1.0).all() and (large > small).all()


@pytest.mark.verify
def test_a_stopped_comparison_goes_on(tmp_path, monkeypatch):
    """Tiny runs, both surfaces; what is finished is not simulated again, and a failure stops nothing else."""
    monkeypatch.setattr(critical_scale, "SETTINGS", TINY)
    wanted = [Case(REFERENCE, surface, 6, FIRST_SEED) for surface in scale_case.SURFACES]
    chains = [chain_of(case, tmp_path, TINY) for case in wanted]
    assert "2 runs" in critical_scale.said_beforehand(chains)
    simulate_all(chains, 1, lambda: None)
    found = finished([*wanted, replace(wanted[0], seed=1)], tmp_path)
    assert list(found["surface"]) == ["plain", "convex"]
    assert (found["wear_mm3_per_m"] > 0.0).all() and found["slip_percent"].between(1.0, 150.0).all()
    assert list(found["bumps_mm3_per_m"] > 0.0) == [False, True]
    monkeypatch.setattr("benchmarks.runs.run_chain", lambda chain: pytest.fail("was done before"))
    simulate_all(chains, 1, lambda: None)
    broken = chain_of(replace(wanted[0], seed=1), tmp_path, TINY)
    critical_scale.kept(broken, lambda: (_ for _ in ()).throw(ValueError("no bed")))
    assert failure_file(broken).read_text() == "no bed"
    critical_scale.kept(broken, lambda: pytest.fail("failed before"))


def test_a_failure_is_told_again_and_of_its_settings_alone(tmp_path, monkeypatch, capsys):
    """Asked for once more it is not tried but told; a candidate with other settings is."""
    case, tried = Case(REFERENCE, "convex", 6, FIRST_SEED), []
    chain = chain_of(case, tmp_path, TINY)
    critical_scale.kept(chain, lambda: (_ for _ in ()).throw(ValueError("no bed")))
    critical_scale.kept(chain, lambda: tried.append("same"))
    assert capsys.readouterr().out.count("failed: no bed") == 2
    other = chain_of(case, tmp_path, merge(TINY, {"solver": {"rayleigh_fraction": 0.3}}))
    critical_scale.kept(other, lambda: tried.append("other"))
    assert tried == ["other"]


def test_a_sample_of_other_elements_is_another_file(tmp_path):
    """A finished run counts by the bytes of its surface, so that one is never taken for another."""
    of = {
        size: chain_of(
            Case(REFERENCE, "convex", 6, FIRST_SEED), tmp_path, merge(TINY, {"sample": {"element_size_mm": size}})
        )
        for size in (3, 4)
    }
    assert of[3].folder == of[4].folder and of[3].surface != of[4].surface


def test_nothing_finished_is_told_before_the_table_is_touched(tmp_path, monkeypatch, capsys):
    """Neither a table nor a page without a run; a table of earlier runs stays."""
    file = tmp_path / "critical_scale.csv"
    critical_scale.write_table(file, [Case(REFERENCE, "convex", 6, FIRST_SEED)], tmp_path)
    assert not file.exists()
    monkeypatch.setattr("sys.argv", ["x", "--finished", "--folder", str(tmp_path), "--output", str(tmp_path)])
    with pytest.raises(SystemExit, match="2"):
        critical_scale.main()
    assert "no run is finished; without --finished they are simulated" in capsys.readouterr().err


def test_rows_of_earlier_runs_stay(tmp_path):
    """One that was simulated again is replaced; the page says which version simulated which scale, where two did."""
    before, now = rows(), rows(((REFERENCE, (0.7,)),)).assign(**{BY: "commit b"})
    before.assign(candidate=before["candidate"].replace(OTHER, "an older name")).to_csv(
        tmp_path / "table.csv", index=False
    )
    added = now.assign(particle_scale=3)
    table = ordered(with_earlier(tmp_path / "table.csv", pd.concat([now, added]), critical_scale.KEYS))
    assert "an older name" in set(table["candidate"])  # kept, and on no page
    assert set(comparison(table)["candidate"]) == {REFERENCE}
    assert table["particle_scale"].tolist() == [3, 3] + [6] * 6
    wear = table.set_index(critical_scale.KEYS)["wear_mm3_per_m"]
    assert [wear[6, REFERENCE, "convex", seed] for seed in (0, 1)] == pytest.approx([1.4, np.e])
    assert scale_page.versions_words(table) == " Simulated scale 3, 6 by commit b; scale 6 by commit a."
    assert scale_page.versions_words(before) == ""


def table_of(ends):
    """Of `comparison`, what tells a side: lowest and highest ratio of each candidate at scales 4 and 8."""
    rows = [(name, scale, (low + high) / 2.0, low, high) for name, (low, high) in ends.items() for scale in (4, 8)]
    return pd.DataFrame(rows, columns=["candidate", "particle_scale", "wear_over_plain", "ratio_low", "ratio_high"])


@pytest.mark.parametrize(
    ("low", "high", "ends", "words"),
    [
        (4.5, 6.0, (0.5, 2.0), "4.5 to 6"),
        (4.5, np.inf, (0.5, 2.0), "4.5 to beyond 8"),
        (-np.inf, 6.0, (0.5, 2.0), "below 4 to 6"),
        (np.nan, np.nan, (0.5, 0.9), "above 8, if anywhere: the convex sample wears less from 4 on"),
        (np.nan, np.nan, (1.1, 2.0), "below 4, if anywhere: the convex sample wears more up to 8"),
        (np.nan, np.nan, (0.9, 1.1), "not told: none between the smallest and the largest"),
    ],
)
def test_an_open_end_is_told_with_its_side(low, high, ends, words):
    """An end beyond the scales, and no crossing at all, say on which side of them it would be."""
    found = Crossing(
        np.nan, low, high, np.nan, np.nan, 3, 3, 2, "none between the smallest and the largest" if np.isnan(low) else ""
    )
    assert where_it_lies(found, table_of({REFERENCE: ends})) == words


def test_an_open_end_is_closed_by_a_scale_that_tells_a_side():
    """The convex sample wears less at 4 and more at 8 by their intervals: it cannot pass one beyond them."""
    found = Crossing(np.nan, -np.inf, np.inf, np.nan, np.nan, 3, 3, 2, "")
    table = table_of({REFERENCE: (0.5, 2.0)})
    table["ratio_low"], table["ratio_high"] = [0.5, 1.1], [0.9, 2.0]
    assert where_it_lies(found, table) == "4 to 8"


def test_a_scale_of_one_packing_decides_nothing():
    """The convex sample wears more at 8; what one packing has at 4 is told and counts for nothing."""
    found = Crossing(np.nan, np.nan, np.nan, np.nan, np.nan, 3, 3, 2, "none between the smallest and the largest")
    table = table_of({REFERENCE: (1.1, 2.0)})
    table.loc[0, ["ratio_low", "ratio_high"]] = np.nan
    said = "below 8, if anywhere: the convex sample wears more up to 8; in one packing at 4 it wears"
    assert where_it_lies(found, table) == f"{said} more"
    table.loc[0, "wear_over_plain"] = 0.9
    assert where_it_lies(found, table) == f"{said} less"
    table["ratio_low"] = np.nan
    assert where_it_lies(found, table) == "not told: none between the smallest and the largest"


def test_where_no_form_fits_two_scales_tell_it():
    """By their own packings; never where forms were found or a side is missing."""
    found = Crossing(np.nan, np.nan, np.nan, 4.0, 8.0, 0, 5, 2, "no form tried")
    table = table_of({REFERENCE: (0.9, 1.1)})
    assert where_it_lies(found, table) == "between 4 and 8, each by its own packings; no form tried"
    for other in (replace(found, forms=1), replace(found, above=np.nan)):
        assert where_it_lies(other, table) == "not told: no form tried"


def test_a_candidate_has_a_critical_scale():
    """Ratio 0.25 times the scale, with a scatter of a hundredth: one at scale 4. Two scales tell none."""
    runs = [
        {"candidate": name, "particle_scale": scale, "seed": seed, "surface": surface}
        | {"wear_mm3_per_m": 1.0 if surface == "plain" else 0.25 * scale * (1.0 + 0.01 * (seed - 2))}
        for name, scales in ((REFERENCE, (3, 4, 5, 6)), (OTHER, (3, 6)))
        for scale in scales
        for seed in (1, 2, 3)
        for surface in ("plain", "convex")
    ]
    found = critical_scales(pd.DataFrame(runs), table_of({REFERENCE: (1.0, 1.0)}))
    assert found["candidate"].tolist() == [REFERENCE] and found["scales"].tolist() == ["3, 4, 5, 6"]
    assert found["critical_scale"].iloc[0] == pytest.approx(4.0, abs=0.01)
    assert found["interval_low"].iloc[0] < 4.0 < found["interval_high"].iloc[0]
    text = "\n".join(scale_page.critical_part(found))
    assert "critical scale" in text and scale_page.critical_part(found.iloc[:0]) == []
