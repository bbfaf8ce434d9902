"""The undisturbed run that tests of the driver compare with."""

import pytest

from bulkwear.workflows.engine import cycles
from tests.support.tiny import tiny_chain, tiny_study


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """An undisturbed run of the convex sample."""
    chain = tiny_chain(tiny_study(), tmp_path_factory.mktemp("undisturbed"))
    cycles.run_chain(chain)
    return chain
