"""Every relative link of README and docs leads to a file and heading that is there; every page is reached."""

import pytest

from tests import REPOSITORY
from tests.support.doc_pages import anchors, links, pages, read
from tests.test_house import name_of

INDEX = REPOSITORY / "docs" / "index.md"


def relative(path):
    """Links of a page that lead to a place in the repository: (target file, anchor)."""
    targets = [target for _, target in links(read(path)) if "://" not in target and not target.startswith("mailto:")]
    for target in targets:
        name, _, anchor = target.partition("#")
        yield target, (path.parent / name).resolve() if name else path, anchor


@pytest.mark.parametrize("path", pages(), ids=name_of)
def test_links_lead_somewhere(path):
    """Files are there; anchors are headings of their page."""
    lost = [target for target, file, _ in relative(path) if not file.exists()]
    assert lost == []
    assert [
        target
        for target, file, anchor in relative(path)
        if anchor and file.suffix == ".md" and anchor not in anchors(read(file))
    ] == []


def test_every_page_is_reached_from_the_index():
    """From docs/index.md over links of pages, each page of docs and each README is reached, but those of test data."""
    reached, waiting = set(), [INDEX]
    while waiting:
        path = waiting.pop()
        if path not in reached:
            reached.add(path)
            waiting += [file for _, file, _ in relative(path) if file.suffix == ".md" and file.is_file()]
    assert [path for path in map(name_of, set(pages()) - reached) if not path.startswith("tests/")] == []


@pytest.mark.parametrize("path", pages(), ids=name_of)
def test_pictures_have_words(path):
    """Who cannot see a picture reads what it shows."""
    assert [target for words, target in links(read(path)) if not words.strip()] == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("## The distance c between rows\n", {"the-distance-c-between-rows"}),
        ("# A, b: c's [d](e.md)\n## `x_y` - z\n", {"a-b-cs-d", "x_y---z"}),
        ("# A\n```sh\n# no heading\n```\n# A\n", {"a", "a-1"}),
    ],
)
def test_anchors_are_those_of_github(text, expected):
    """Small letters, spaces as hyphens, no punctuation but hyphens and underscores; twins are numbered."""
    assert anchors(text) == expected


def test_links_within_links_are_found():
    """A picture that is a link has both targets; code has none."""
    assert {target for _, target in links("[![a](b.png)](c.md) `[d](e.md)`\n```\n[f](g.md)\n```\n")} == {
        *("b.png", "c.md"),
    }
