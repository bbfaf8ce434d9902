"""Comparison of two folders of results: the same numbers pass, another one does not, renamed columns are found."""

import pandas as pd

from benchmarks.same_results import main


def folder_with(path, **columns):
    """Write one table of a run."""
    (path / "demo").mkdir(parents=True)
    pd.DataFrame(columns).to_csv(path / "demo" / "wear.csv", index=False)
    return str(path)


def test_the_same_numbers_pass_under_another_name(tmp_path):
    """Empty and infinite cells agree with themselves; a renamed column is the same one."""
    before = folder_with(tmp_path / "a", archard_m3=[1.0, float("nan"), float("inf")], surface=["convex", "plain", ""])
    after = folder_with(tmp_path / "b", worn_m3=[1.0, float("nan"), float("inf")], surface=["convex", "plain", ""])
    assert main([before, after, "--renamed", "archard=worn"]) == 0
    assert main([before, after]) == 1


def test_another_number_fails_beyond_the_tolerance(tmp_path):
    """A difference in the last digits counts, unless a tolerance is given."""
    before, after = folder_with(tmp_path / "a", v=[1.0]), folder_with(tmp_path / "b", v=[1.0 + 1e-9])
    assert main([before, after]) == 1
    assert main([before, after, "--tolerance", "1e-8"]) == 0
    assert main([before, folder_with(tmp_path / "c", other=[1.0])]) == 1
