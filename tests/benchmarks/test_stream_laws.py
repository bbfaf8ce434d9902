"""The table of laws in a stream in docs: how its program makes it of a study, and what the page of that study says."""

import re

import numpy as np
import pandas as pd
import pytest

from benchmarks.impact_angle import OVER
from benchmarks.stream_laws import (
    BEGIN,
    END,
    LAWS,
    LOADS,
    RATIOS,
    SLOPES,
    arriving,
    ratios,
    sentence,
    slope_over_plate,
    table,
    with_table,
)
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.sentences import spoken
from tests import REPOSITORY

OVER_A90 = {"A90": np.nan, "A60": 2.0, "A30": 4.0, "A15": 3.0}  # of the first law; n-th laws have n times as much
ROUNDED = 0.006  # -, two decimals here, three digits there


def page(name):
    """A page of docs."""
    return (REPOSITORY / "docs" / name).read_text(encoding="utf-8")


def made_up():
    """Wear by each law over that of A90, of the plate and of another part."""
    lines = [
        {"setting": setting, "part": part, "law": law, "over_first": number * value * scale}
        for setting, value in OVER_A90.items()
        for part, scale in (("slide", 7.0), ("plate", 1.0))
        for number, law in enumerate(LAWS, 1)
    ]
    return pd.DataFrame(lines)


def test_ratios_are_of_plates_that_are_hit_at_other_angles():
    """Over 30 degrees, of the plate alone: 1 / 4, 2 / 4 and 3 / 4 by the first law."""
    found = ratios(made_up())
    assert found.loc[next(iter(LAWS))].tolist() == [0.25, 0.5, 0.75]
    assert found.iloc[1].tolist() == [0.125, 0.5, 0.75]
    with pytest.raises(KeyError):
        ratios(made_up()[lambda rows: rows["law"] != "oka"])


def test_slopes_are_set_over_the_plates_above_them():
    """In each packing, then their geometric mean: 2 and 8 make 4; the page has a line per law, a column per angle."""
    rows = [
        {"setting": setting, "packing": packing, "part": part, "law": law, "worn_volume_m3": value}
        for setting in OVER_A90
        for law in LAWS
        for packing, over in ((1, 2.0), (2, 8.0))
        for part, value in (("plate", 3.0 * packing), ("slide", 3.0 * packing * over))
    ]
    found = slope_over_plate(pd.DataFrame(rows))
    assert list(found) == [90, 60, 30, 15] and found.index.tolist() == list(LAWS)
    np.testing.assert_allclose(found, 4.0)
    told, new = page("wear.md").partition(BEGIN)[2].split("\n\n")[2], table(found, SLOPES)
    assert told.splitlines()[:2] == new.splitlines()[:2] and told.count("|") == new.count("|")


def test_the_page_gets_the_table_between_its_marks():
    """All else stays; the page in docs has a table of that form."""
    told = page("wear.md")
    new = table(ratios(made_up()))
    changed = with_table(told, new)
    before, _, rest = told.partition(BEGIN)
    assert changed == f"{before}{BEGIN}\n\n{new}\n{END}{rest.partition(END)[2]}"
    old = [line for line in rest.split("\n\n")[1].splitlines() if line.startswith("|")]
    assert [line.split("|")[1] for line in old] == [line.split("|")[1] for line in new.splitlines()]
    with pytest.raises(ValueError, match="found no table between"):
        with_table(before, new)


def test_ratios_are_those_of_the_page_of_the_study():
    """By each law, where laws disagree most, and at all angles by the study's own: what the page of which_law says."""
    said = " ".join(page("which_law_results_quick.md").split())
    angle, sentence = re.search(
        r"disagree most on the plate of A(\d+): over that of A90 it wears (.*?)\. ", said
    ).groups()
    found = {law: float(ratio) for ratio, law in re.findall(r"([\d.]+) \([^)]*\) by ([a-z ]+?)(?=,| and|$)", sentence)}
    assert set(found) == {spoken(law) for law in LAWS}
    told = page("wear.md").partition(BEGIN)[2].split("\n\n")[1]
    lines = [line.split("|")[1:-1] for line in told.splitlines() if line.startswith("|")][2:]
    rows = {name.strip(): [float(cell) for cell in cells] for name, *cells in lines}
    for law, name in LAWS.items():
        over_30 = dict(zip(RATIOS, rows[name], strict=True)) | {OVER: 1.0}
        rounded = sum(ROUNDED / over_30[each] for each in (int(angle), 90))
        assert over_30[int(angle)] / over_30[90] == pytest.approx(found[spoken(law)], rel=rounded), law
    steel = re.findall(r"The plate of A(\d+) loses ([\d.]+) times as much steel per hour as that of A90", said)
    over = {int(angle): float(ratio) for angle, ratio in steel}
    assert rows[LAWS["oka"]] == pytest.approx([1.0 / over[30], over[60] / over[30], over[15] / over[30]], abs=ROUNDED)


def test_what_arrives_is_by_the_loads_of_the_page():
    """All of 8 t/h at 8 m/s on an upright plate is 71.1 W; the page in docs tells what its table of loads has."""
    inlet = {"rate_t_per_h": 8.0, "velocity_m_per_s": [8.0, 0.0, 0.0]}
    all_of_it = {90: 640.0 / 9.0, 60: 480.0 / 9.0, 30: 160.0 / 9.0, 15: 640.0 / 9.0 * np.sin(np.pi / 12.0) ** 2}
    rows = [(f"A{angle}", "plate", "impact power", watt) for angle, watt in all_of_it.items()]
    rows += [(setting, "slide", "impact power", 1.0) for setting, *_ in rows] + [("A90", "plate", "force", 20.0)]
    loads = pd.DataFrame(rows, columns=["setting", "part", "quantity", "pristine"])
    assert arriving(loads, inlet) == pytest.approx(dict.fromkeys(all_of_it, 1.0))
    assert load_study("which_law").settings["inlet"].items() >= inlet.items()
    assert sentence(arriving(pd.read_csv(REPOSITORY / LOADS), inlet)) in page("wear.md")
