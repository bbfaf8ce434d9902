"""The page for people who see little, or use no mouse: what axe-core finds on a desk and a phone, light and dark."""

import pytest

from bulkwear.workflows.config.design import load_study
from tests.support.accessibility import NEEDS_BROWSER, SCHEMES, WIDTHS, axe_findings
from tests.support.finished_samples import finished_page

pytestmark = NEEDS_BROWSER
FEWEST_RULES = 20  # of which a page with tables, pictures and frames keeps some 40
LOW_CONTRAST = '<p style="color: #999; background: #777">hardly seen</p><img src="data:,">'


@pytest.fixture
def page(config, tmp_path):
    """The text of a page, its results made up."""
    study = load_study("small", config.project)
    return finished_page(tmp_path / "results" / study.name, study)


def test_nobody_is_kept_from_a_page(page, tmp_path):
    """No fault at any width in any scheme, all folded parts open; the schemes differ."""
    found = axe_findings(page, tmp_path)
    assert set(found) == {(width, scheme) for width in WIDTHS for scheme in SCHEMES}
    for key, each in found.items():
        assert each["faults"] == [], key
        assert each["passed"] > FEWEST_RULES
    assert len({each["paper"] for each in found.values()}) == len(SCHEMES)


def test_a_fault_is_found(tmp_path):
    """Grey on grey and a picture without words, in a page that is whole otherwise."""
    whole = '<!DOCTYPE html><html lang="en"><head><title>a</title></head><body><main><h1>a</h1>{}</main></body></html>'
    found = axe_findings(whole.format(LOW_CONTRAST), tmp_path, schemes=["light"])
    assert len(found) == len(WIDTHS)
    for each in found.values():
        assert sorted(fault["id"] for fault in each["faults"]) == ["color-contrast", "image-alt"]
