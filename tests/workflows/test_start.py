"""What every start of Snakemake and every job imports: nothing slow that only few of them need."""

import subprocess
import sys

import pytest

from tests import REPOSITORY

SLOW = (
    *("jsonschema", "numba", "scipy.optimize", "scipy.spatial", "scipy.special", "scipy.stats"),
    *("matplotlib", "pyvista"),
)
NEEDED = {
    "page": {"scipy.special"},  # its verdicts ask for quantiles
    "study of samples": {"jsonschema", "scipy.spatial", "scipy.special"},  # its schema; bumps ask for their nearest
}
IMPORTED = "import sys\n{code}\nprint(*(name for name in {names} if name in sys.modules))"
STARTS = {
    "every start": "import bulkwear.workflows.config.design, bulkwear.workflows.report.page_parameters",
    "figures": """
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.report.products import products_of
assert products_of(find_case("sliding_sample"))
""",
    "samples": "from bulkwear.workflows.report.page_parameters import page_of; assert page_of('sliding_sample')",
    "study of samples": """
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.page_parameters import page_parameters
assert page_parameters(load_study("demo"))["told"]
""",
    "page": "import bulkwear.workflows.report.page",
    "forecast": "import bulkwear.workflows.forecast.forecast, bulkwear.workflows.forecast.limits",
}


@pytest.mark.parametrize("start", STARTS)
def test_a_start_imports_nothing_slow(start):
    """Each of these takes 0.1 to 1 s of processor time, and a study has tens of jobs."""
    code = IMPORTED.format(code=STARTS[start], names=SLOW)
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) == NEEDED.get(start, set())
