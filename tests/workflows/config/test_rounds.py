"""What all rounds of studies share: their files, and what runs and beds have cost."""

import json

import pandas as pd
import pytest

from bulkwear.workflows.config.rounds import core_hours, last_round


def test_the_last_round_is_told(tmp_path):
    """Of ten and more rounds too; nothing where packings are a fixed number."""
    assert last_round(tmp_path) == ""
    (tmp_path / "rounds").mkdir()
    for number in (1, 2, 10):
        (tmp_path / "rounds" / f"round_{number}.json").write_text(json.dumps({"said": f"round {number}"}))
    assert last_round(tmp_path) == "round 10"


def test_core_hours_are_the_processors(tmp_path):
    """Of runs and beds together."""
    for name, seconds in (("run", [1800.0, 900.0]), ("bed", [900.0])):
        pd.DataFrame({"processor_s": seconds}).to_csv(tmp_path / f"{name}.csv", index=False)
    assert core_hours([tmp_path / "run.csv", tmp_path / "bed.csv"]) == pytest.approx(1.0)
