"""The process for figures: it makes what jobs ask for, with their logs and streams; faults stay with their job."""

import os
import subprocess
import sys
import time

import pandas as pd
import psutil
import pytest

from bulkwear.workflows.engine.beds import MEASURES
from bulkwear.workflows.report import figure_process
from bulkwear.workflows.report.beds import ASKED_DENSITY
from bulkwear.workflows.report.figure_process import VARIABLE
from tests import REPOSITORY

TIMEOUT = 120.0  # s, for what takes seconds on an idle machine
POLL = 0.05  # s
ASK = "from bulkwear.workflows.report.figure_process import hand_over; hand_over('{log}', {product})"
SENTENCE = "its process was ended by the machine"


@pytest.fixture(scope="module")
def process():
    """The process, and the environment of jobs that know of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, "")
        started = figure_process.start()
        yield started, dict(os.environ)
        started.communicate(timeout=TIMEOUT)


@pytest.fixture
def project(tmp_path):
    """A folder to work in, with what the table of beds is made of."""
    (tmp_path / "config").mkdir()
    (tmp_path / "bed_1").mkdir()
    (tmp_path / "bed_1" / MEASURES).write_text("measure,unit,asked,found,tolerance\nmass,kg,2.0,1.9,0.2\n")
    return tmp_path


def job(project, environment, **changes) -> subprocess.Popen:
    """The script of a job that has the table of beds made."""
    values = {"bed_1": {"settings": ["A"], "packing": 1, "particle_scale": 1.0, ASKED_DENSITY: 1500.0}}
    product = {
        **{"study": "mine", "case": "sliding_sample", "name": "beds", "files": {"beds": ["bed_1/cost.csv"]}},
        **{"told": {"beds": values}, "remarks": [], "runs": [], "outputs": {"beds": "beds.csv"}},
        **changes,
    }
    return subprocess.Popen(
        [sys.executable, "-c", ASK.format(log="job.log", product=product)],
        cwd=project,
        env={**environment, "PYTHONPATH": str(REPOSITORY)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def made(project) -> bool:
    return pd.read_csv(project / "beds.csv")["mass_found_kg"].tolist() == [1.9]


def test_what_figures_need_is_there_before_it_forks():
    """The libraries, and the code that is compared with that of the runs: read by no figure again."""
    code = (
        "import sys; from bulkwear.workflows.report import figure_process; figure_process._preload();"
        "from bulkwear.workflows.engine.code_parts import _kept, part_hashes;"
        "read = _kept.cache_info().misses; part_hashes(());"
        "print(read > 0, _kept.cache_info().misses - read, set(figure_process.LIBRARIES) <= set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "0", "True"]


@pytest.mark.verify
def test_it_makes_what_is_asked(process, project):
    """In the folder of who asks, and with the log of the job."""
    assert job(project, process[1]).wait(TIMEOUT) == 0
    assert made(project) and "--- started" in (project / "job.log").read_text()


@pytest.mark.verify
def test_without_it_a_job_works_by_itself(project):
    """Where none is named, and where the named one is gone."""
    assert job(project, {key: value for key, value in os.environ.items() if key != VARIABLE}).wait(TIMEOUT) == 0
    assert made(project)
    (project / "beds.csv").unlink()
    assert job(project, {**os.environ, VARIABLE: str(project / "gone")}).wait(TIMEOUT) == 0
    assert made(project)


def test_a_fault_is_that_of_its_job(process, project):
    """Its sentence is on the standard error of the job, its traceback in the log; the next job is none the worse."""
    failed = job(project, process[1], files={"beds": ["nowhere/bed_1/cost.csv"]})
    _, said = failed.communicate(timeout=TIMEOUT)
    assert failed.returncode == 1 and MEASURES in said and "Traceback" not in said
    assert "Traceback" in (project / "job.log").read_text()
    unforeseen = job(project, process[1], told={})
    _, said = unforeseen.communicate(timeout=TIMEOUT)
    assert unforeseen.returncode == 1 and "AttributeError" in said
    assert job(project, process[1]).wait(TIMEOUT) == 0 and made(project)


def test_a_killed_one_is_one_sentence(process, project):
    """As when the machine has no memory left."""
    os.mkfifo(project / "never.csv")
    (project / "bed_1" / MEASURES).unlink()
    (project / "bed_1" / MEASURES).symlink_to(project / "never.csv")  # it waits for what it reads
    waiting, deadline = job(project, process[1]), time.monotonic() + TIMEOUT
    while waiting.poll() is None:
        assert time.monotonic() < deadline
        for child in psutil.Process(process[0].pid).children():
            child.kill()
        time.sleep(POLL)
    _, said = waiting.communicate(timeout=TIMEOUT)
    assert waiting.returncode == 1 and SENTENCE in said


def test_without_room_for_a_socket_jobs_work_by_themselves(tmp_path, monkeypatch):
    """A path of a socket has about a hundred letters; nothing stays behind, and no other process is named."""
    folder = tmp_path / ("long" * 30)
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    monkeypatch.setenv(VARIABLE, "another")
    assert figure_process.start() is None
    assert VARIABLE not in os.environ and not list(folder.iterdir())


@pytest.mark.verify
def test_a_module_of_the_project_is_not_taken_for_pythons(project, monkeypatch):
    """The process starts in the user's folder, whose files are not its own."""
    (project / "random.py").write_text("raise SystemExit('a module of the project ran')")
    monkeypatch.chdir(project)
    monkeypatch.setenv(VARIABLE, "")
    started = figure_process.start()
    assert job(project, {**os.environ, "PYTHONSAFEPATH": "1"}).wait(TIMEOUT) == 0 and made(project)
    started.communicate(timeout=TIMEOUT)
    assert started.returncode == 0


def test_it_ends_with_who_started_it():
    """However that ends, and leaves nothing in the temporary folder."""
    code = (
        "import os; from bulkwear.workflows.report import figure_process; process = figure_process.start();"
        f"print(process.pid, os.environ['{VARIABLE}'], flush=True); os.kill(os.getpid(), 9)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY, capture_output=True, text=True)
    number, path = done.stdout.split()
    deadline = time.monotonic() + TIMEOUT
    while os.path.exists(f"/proc/{number}") or os.path.exists(os.path.dirname(path)):
        assert time.monotonic() < deadline
        time.sleep(POLL)
