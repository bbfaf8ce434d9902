"""The documentation as a site: Sphinx takes every page without a warning, and its sidebar lists what the index does."""

import subprocess
import sys
from pathlib import Path

from tests import REPOSITORY
from tests.test_house import text_of

SPHINX = Path(sys.executable).with_name("sphinx-build")


def test_every_page_is_taken_without_a_warning(tmp_path):
    """As `make docs` builds it, without writing: links, anchors and pictures are there, no page is left out."""
    command = [SPHINX, "-q", "-W", "--keep-going", "-b", "dummy", "-c", "docs/site", ".", tmp_path]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_make_builds_what_is_tested():
    """The same configuration and the same sources, warnings as errors."""
    recipe = text_of("Makefile").partition("\ndocs:")[2].partition("\n\n")[0]
    assert "sphinx-build -q -W --keep-going -b html -c docs/site" in recipe
