"""The gallery of results: question, first answer and picture of each page, taken from the pages."""

import pytest

from bulkwear.workflows.report.provenance_of_pages import Origin, read_origins
from bulkwear.workflows.results.gallery import MOST_WORDS, answer_of, entry, gallery
from tests import REPOSITORY

DOCS = REPOSITORY / "docs"
BANNER = "<!-- older than the code -->\n> **Older than the code.**\n<!-- end -->\n"


def test_the_gallery_in_docs_names_every_page_of_results():
    """Each page of results has its section, and its first picture where it has one; `make results` writes it."""
    written = (DOCS / "gallery.md").read_text(encoding="utf-8")
    pages = [each.page for each in read_origins(DOCS) if each.page.endswith(".md")]
    assert [page for page in pages if f"]({page})\n" not in written] == []


@pytest.mark.parametrize(
    ("sections", "answer"),
    [
        ("## One\n\nIt wears less. It lasts longer.\n\n## Two\n\n* no\n", "It wears less. It lasts longer."),
        ("## One\n\n| a |\n| --- |\n\n![b](b.png)\n\nYes.\n", "Yes."),
        ("## One\n\n| a |\n\n## Two\n\nWords.\n\n* first\n* second\n", "* first\n* second"),
        ("## One\n\n| a |\n\n## Two\n\nOf something else.\n", ""),
        ("", ""),
    ],
)
def test_an_answer_is_what_a_page_says_first(sections, answer):
    """Words of the first section, tables and pictures passed over; else a list of the second one; else nothing."""
    assert answer_of(f"Generated.\n\n{sections}") == answer


def test_a_long_answer_ends_with_a_whole_sentence():
    """No more words than a reader takes in beside a picture."""
    sentence = " ".join(["Word", *["word"] * 24]) + "."
    kept = answer_of(f"\n## One\n\n{' '.join([sentence] * 4)}\n").split()
    assert len(kept) <= MOST_WORDS and kept[-1].endswith(".")


def test_a_section_has_question_answer_and_picture(tmp_path):
    """The question is that of the study; a page that is not there is left out."""
    origin = Origin("demo_results_quick.md", "sliding_sample", "demo")
    page = f"# Demo: results\n\n{BANNER}\nGenerated.\n\n## One\n\nLess.\n\n![wear](demo_quick_wear.png)\n"
    said = entry(origin, page)
    assert said.startswith("## [Demo: results](demo_results_quick.md)\n\nDoes the convex pattern")
    assert "\nLess.\n" in said and "[![wear](demo_quick_wear.png)](demo_results_quick.md)" in said
    assert "Older" not in said
    assert "demo_results" not in gallery(tmp_path, [origin])
