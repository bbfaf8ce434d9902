"""The page of the benchmarks: every line of their table, the model of more ranks where two were measured."""

import importlib
import inspect
from dataclasses import asdict

import pandas as pd

from benchmarks.__main__ import BY_STUDY, MODULES, lines_of, replaced, write_page
from benchmarks.measure import measured
from benchmarks.page import page, table_text
from benchmarks.ranks import ACROSS
from benchmarks.scaling import RANKS, measured_cost, scaling_table

MACHINE = {"processor": "Abacus", "cores": 2, "memory_gb": 0.5, "system": "Wood"}


def table(benchmark: str, *found) -> pd.DataFrame:
    told = {"benchmark": benchmark, "date": "2026-11-21", "load_before": 0.1}
    return pd.DataFrame([told | asdict(measure) for measure in found])


def ranks(efficiency: float) -> pd.DataFrame:
    return table("ranks", measured(ACROSS, "steps/s", [efficiency], "two times one rank", [1.0]))


def test_every_benchmark_has_one_way_to_be_asked():
    """All take a folder and whether it is a trial, and say in their first lines what they measure."""
    for name in MODULES:
        module = importlib.import_module(f"benchmarks.{name}")
        assert list(inspect.signature(module.measures).parameters) == ["folder", "quick"], name
        assert inspect.getdoc(module).endswith("."), name


def test_a_benchmark_becomes_lines(tmp_path):
    """The quickest one, run: its rates are above zero, and named in the text for the terminal."""
    lines = lines_of("meshing", tmp_path, quick=True)
    assert set(lines["benchmark"]) == {"meshing"} and (lines["value"] > 0.0).all()
    assert all(name in table_text(lines) for name in lines["name"])


def test_the_page_has_every_line_and_the_model():
    """Machine, values with units and ranges, ratios; efficiencies of more ranks only where two were measured."""
    lines = table("meshing", measured("sample", "triangles/s", [1e4, 2e4, 4e4], "before", [1e4, 1e4, 1e4]))
    text = page(lines, MACHINE)
    assert "Abacus, 2 cores, 0.5 GB, Wood" in text
    assert "| sample | 20,000 triangles/s (10,000 to 40,000) | before | 2.000 (1 to 4) | 3 |" in text
    assert "More ranks" not in text
    modelled = page(pd.concat([lines, ranks(0.8)]), MACHINE)
    assert modelled.count("| screening |") == modelled.count("| screening, window 150 + 200 |") == len(RANKS)


def test_lines_are_replaced_by_benchmark():
    """What was run now stands instead of what was, the rest stays, in the order of the command."""
    before = pd.concat([ranks(0.5), table("meshing", measured("sample", "s", [1.0]))])
    after = replaced(before, [ranks(0.9)])
    assert after["benchmark"].tolist() == ["meshing", "ranks"]
    assert after["ratio"].iloc[1] == 0.9
    assert replaced(pd.DataFrame(), [ranks(0.9)])["ratio"].tolist() == [0.9]
    nothing = pd.DataFrame()  # as of `study_share` where no study is finished
    assert replaced(before, [nothing]).equals(before) and len(table_text(nothing).splitlines()) == 1


def test_studies_without_results_here_keep_their_lines():
    """Of the shares of studies those that were looked at are replaced; the page says from when to when all are."""
    share = "{} (quick), outside the solver"
    before = table(BY_STUDY, measured(share.format("mill"), "%", [3.0]), measured(share.format("screw"), "%", [4.0]))
    now = table(BY_STUDY, measured(share.format("mill"), "%", [2.0])).assign(date="2026-11-27", load_before=2.5)
    after = replaced(before, [now])
    assert dict(zip(after["name"], after["value"], strict=True)) == {
        share.format("mill"): 2.0,
        share.format("screw"): 4.0,
    }
    assert "(2026-11-21 to 2026-11-27, load 0.1 to 2.5; `--only study_share`)" in page(after, MACHINE)


def test_the_page_can_be_written_again(tmp_path):
    """From its table alone, nothing measured."""
    table("meshing", measured("sample", "triangles/s", [1e4])).to_csv(tmp_path / "benchmarks.csv", index=False)
    write_page(tmp_path / "benchmarks.csv")
    assert "| sample | 10,000 triangles/s |" in (tmp_path / "benchmarks.md").read_text()


def test_more_ranks_lose_more_and_the_best_grid_least():
    """Efficiencies fall with the ranks; the grid chosen is never worse than the split across alone."""
    found = scaling_table(measured_cost(ranks(0.8)))
    assert measured_cost(table("meshing", measured("sample", "s", [1.0]))) is None
    for name, study in found.groupby("study"):
        assert study["split_across"].is_monotonic_decreasing and (study["split_across"] < 1.0).all()
        assert (study["best"] >= study["split_across"]).all() and (study["best"] >= study["of_decks"]).all()
        walls = name in ("demo", "screening")
        assert walls == (study["of_decks"] == study["split_across"]).all()
        assert study["bed_as_wide_again"].nunique() == 1
