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
    "study of equipment": {"jsonschema"},
    "study of samples": {"jsonschema", "scipy.spatial", "scipy.special"},  # its schema; bumps ask for their nearest
}
IMPORTED = "import sys\n{code}\nprint(*(name for name in {names} if name in sys.modules))"
STARTS = {
    "every start": "import bulkwear.workflows.config.design, bulkwear.workflows.report.page_parameters",
    "products": """
from bulkwear.workflows.engine.cases import case_names, find_case
from bulkwear.workflows.report.products import products_of
assert all(products_of(find_case(name)) for name in case_names())
""",
    "pages": """
from bulkwear.workflows.engine.cases import case_names
from bulkwear.workflows.report.page_parameters import page_of
assert all(page_of(name) for name in case_names())
""",
    "study of samples": """
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.page_parameters import page_parameters
assert page_parameters(load_study("demo"))["told"]
""",
    "study of equipment": """
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.run_checks import check_files
study = load_study("chute")
check_files(study.name, study.case, study.runs)
assert all(study.case.run_stages(run.parameters, None) for run in study.runs)
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
