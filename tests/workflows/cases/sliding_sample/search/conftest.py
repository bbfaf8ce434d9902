"""A finished search, made up once for all tests of its rounds, record and page."""

import pytest

from tests.support.searched import search_to_its_end


@pytest.fixture(scope="package")
def finished(tmp_path_factory):
    """A root with the results of a whole search, and what its rounds decided; not to be written to."""
    root = tmp_path_factory.mktemp("search")
    return root, search_to_its_end(root)
