"""What a page of results in docs leaves to files beside it."""

import pandas as pd
import pytest

from bulkwear.workflows.report.beside_page import FOLDER, MOST_ROWS, remove_unlinked, short_sections
from bulkwear.workflows.report.sections import Cards, Listing, Points, Section, Table, Text

LOADS = pd.DataFrame({"part": [f"liner_{k}" for k in range(MOST_ROWS + 1)], "force_N": 1234.56789})
NAME = "chute_quick"


def test_a_long_table_is_a_file_beside_the_page(tmp_path):
    """All its rows, six digits; its note stays on the page."""
    (section,) = short_sections([Section("Loads", [Table(LOADS, "loads", "Mean force.")])], tmp_path, NAME)
    (text,) = section.blocks
    assert text == Text(f"[Table of {len(LOADS)} rows]({FOLDER}/chute_quick_loads.csv). Mean force.")
    kept = pd.read_csv(tmp_path / FOLDER / "chute_quick_loads.csv")
    pd.testing.assert_frame_equal(kept, LOADS, rtol=1e-5)


def test_what_an_earlier_page_left_is_removed(tmp_path):
    """Of the same study and fidelity, unless the page of today links it."""
    (tmp_path / FOLDER).mkdir()
    for name in ("chute_quick_loads.csv", "chute_quick_beds.csv", "chute_standard_beds.csv"):
        (tmp_path / FOLDER / name).write_text("")
    remove_unlinked(tmp_path, NAME, f"[Table of 50 rows]({FOLDER}/chute_quick_loads.csv). Mean force.")
    assert {path.name for path in (tmp_path / FOLDER).iterdir()} == {"chute_quick_loads.csv", "chute_standard_beds.csv"}


def test_what_is_short_stays(tmp_path):
    """A table and a listing at the limit; no folder is made."""
    blocks = [Table(LOADS.head(MOST_ROWS), "loads"), Listing("materials.yaml", "a: 1\n" * MOST_ROWS)]
    (section,) = short_sections([Section("Loads", blocks)], tmp_path, NAME)
    assert section.blocks == blocks and not (tmp_path / FOLDER).exists()


def test_a_long_listing_is_a_file_too(tmp_path):
    """Its title leads to it."""
    listing = Listing("How the flow was judged", "steady\n" * (MOST_ROWS + 1))
    (section,) = short_sections([Section("The flow", [Text("Judged."), listing])], tmp_path, NAME)
    file = f"{FOLDER}/chute_quick_the_flow_1.txt"
    assert section.blocks[1] == Text(f"How the flow was judged: [{MOST_ROWS + 1} lines]({file}).")
    assert (tmp_path / file).read_text() == listing.content


@pytest.mark.parametrize(("listed", "kept"), [("chute_results_quick.md", Text), ("", Table)])
def test_published_numbers_stand_on_their_page(tmp_path, listed, kept):
    """A page that is listed leads there; of any other one the table stays."""
    claims = pd.DataFrame({"finding": ["less wear"], "verdict": ["agrees"]})
    sections = [Section("Beside the source", [Table(claims, "claims", beside_source=True)])]
    (section,) = short_sections(sections, tmp_path, NAME, listed)
    (block,) = section.blocks
    assert isinstance(block, kept)
    if listed:
        assert "with verdicts: 1 (" in block.text
        assert "(published_numbers.md)" in block.text and "(published/chute_results_quick.csv)" in block.text


def test_one_line_leads_to_all_published_numbers_of_a_section(tmp_path):
    """A section with claims and numbers says once how many both are, in place of the first; the rest stays."""
    claims, numbers = pd.DataFrame({"finding": ["less", "more"]}), pd.DataFrame({"finding": ["force", "wear", "spin"]})
    tables = [Table(data, name, beside_source=True) for data, name in ((claims, "claims"), (numbers, "numbers"))]
    sections = [Section("Beside the source", [tables[0], Text("Margins are ours."), tables[1]])]
    (section,) = short_sections(sections, tmp_path, NAME, "circular_tester_results_quick.md")
    led, words = section.blocks
    assert "with verdicts: 5 (" in led.text and words.text == "Margins are ours."


def test_cards_repeat_nothing(tmp_path):
    """They go where a verdict in words begins the page, and with them a section of nothing else."""
    wear = Section("Wear", [Cards([("0.6", "over plain")])])
    words = Section("Verdict", [Points(["A wears less."])])
    assert short_sections([words, wear], tmp_path, NAME) == [words]
    assert short_sections([wear], tmp_path, NAME) == [wear]
