"""In which order test files run, and which of them share a process.

First those that compile, then those that take longest, so that no process waits for one of them at the end. Folders
whose files read one made-up study stay on one process, which makes it once.
"""

import gc
import os

import pytest

# Each process of the tests computes by one thread, as jobs of a study do: threads of linear algebra that wait for one
# another on cores that others use spin, forty times as long as the work takes. Set before numpy is imported.
os.environ["OMP_NUM_THREADS"] = "1"

# What is read stays: to look among it for what may go takes a twentieth of the tests' time.
gc.disable()

COMPILE = (  # nearly all that numba compiles, each another part; what comes after them need not do it as well
    "wear/test_remesh.py",
    "readers/test_contacts.py",
    "wear/test_update.py",
)
LONGEST_FIRST = (  # measured on two cores: a quarter of a minute to one each
    "workflows/test_project.py",
    "test_chains.py",
    "engine/test_cycles.py",
    "engine/test_killed_runs.py",
    "engine/test_reused_cycles.py",
    "test_solver_ledger_ranks.py",
    "test_read.py",
    "report/test_accessibility.py",
    "docs/test_site.py",
    "report/test_figure_process.py",
    "test_wheel.py",
)
FIRST = (*COMPILE, *LONGEST_FIRST)
TOGETHER = (  # folders with a fixture of their own that takes seconds
    "tests/workflows/cases/calibration/",
    "tests/workflows/cases/pin_on_disc/",
    "tests/workflows/cases/sliding_sample/search/",
)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """Let each process begin to read elsewhere: what one compiles (libraries, modules, asserts), others then find."""
    report = yield
    worker = getattr(collector.config, "workerinput", None)
    if worker and isinstance(collector, pytest.Directory):
        start = len(report.result) * int(worker["workerid"].removeprefix("gw")) // worker["workercount"]
        report.result = report.result[start:] + report.result[:start]
    return report


def pytest_collection_finish():
    """Look for what may go among what tests make alone."""
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items):
    """Sort files by their place in the lists, all others after them by name."""

    def place(item):
        path = item.path.as_posix()
        return next((k for k, name in enumerate(FIRST) if path.endswith(name)), len(FIRST)), path

    items.sort(key=place)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Hand out tests by file, or by folder where its files belong together."""
    from xdist.scheduler import LoadFileScheduling

    class ByFileOrFolder(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return next((folder for folder in TOGETHER if nodeid.startswith(folder)), super()._split_scope(nodeid))

    return ByFileOrFolder(config, log)
