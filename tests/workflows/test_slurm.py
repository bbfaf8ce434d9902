"""A study on a real Slurm: the profile of clusters through Snakemake's executor, killed by Slurm in the middle."""

import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.pieces import PIECES
from bulkwear.workflows.engine.project import Project
from bulkwear.workflows.engine.solver import DECK
from bulkwear.workflows.environment.doctor import MPI_PROBE_DECK
from tests.support.killed import solver_processes
from tests.support.slurm import Slurm, missing_cgroups, missing_programs
from tests.support.tiny import tiny_chain
from tests.workflows.test_snakemake import REPOSITORY, TINY, workspace

ABSENT = missing_programs()
pytestmark = [
    pytest.mark.solver,
    pytest.mark.skipif(bool(ABSENT), reason=f"no Slurm on this machine: {', '.join(ABSENT)} (apt-packages.txt)"),
    pytest.mark.skipif(missing_cgroups(), reason="no cgroup file system is mounted here, without which slurmd ends"),
]

TIMEOUT = 1200.0  # s, for a study that takes about a minute on an idle machine
POLL = 0.2  # s
# Polling of jobs that take seconds; the cluster of the tests has no accounting and no network file system.
OF_TEST = "--slurm-status-command squeue --slurm-init-seconds-before-status-checks 3 --latency-wait 5"
SIDE_BY_SIDE = min(4, os.cpu_count() or 1)  # jobs; the four of the profile would wait for ever on a node of fewer cores
RUN = "R9_plain"
PLAIN = TINY.replace("surfaces: [convex, plain]", "surfaces: [plain]")
# Restart files within its cycles, and so short time steps that a cycle takes the seconds in which it can be caught.
IN_PIECES = PLAIN + "solver: {checkpoint_interval_steps: 200, rayleigh_fraction: 0.01}\n"
# What Slurm keeps of a job's environment for it hides an allocation from Open MPI, or promises one that is not there.
START_RANKS = """
from bulkwear.workflows.engine.solver import SCREEN, run_deck
folder = Path(__file__).parent
try:
    run_deck(folder, ranks=2)
finally:
    print((folder / SCREEN).read_text())
"""


# Ranks that a job starts which asks for two tasks and has one core of Snakemake's.
RANKS_TOLD = """
def ranks(resources, threads):
    from bulkwear.workflows.engine.ranks import ranks_to_start
    return ranks_to_start(resources.tasks, threads, resources.submitted)

%s

rule told:
    output: "{name}.txt"
    resources: tasks=2, cpus_per_task=1, mpi="mpirun", submitted=submitted, runtime=1, mem_mb=100
    run: Path(output[0]).write_text(str(ranks(resources, threads)))
"""


@pytest.fixture(scope="module")
def cluster():
    with Slurm() as running:
        yield running


def snakemake(folder: Path, cluster: Slurm, *arguments: str) -> subprocess.Popen:
    """Start Snakemake with the profile of clusters."""
    profile = ["--workflow-profile", "profiles/slurm", *OF_TEST.split(), "--cores", str(SIDE_BY_SIDE)]
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", *arguments, *profile],
        cwd=folder,
        env=cluster.environment,
        stdout=open(folder / "snakemake.txt", "wb"),
        stderr=subprocess.STDOUT,
    )


def study(folder: Path, text: str) -> Path:
    workspace(folder)
    (folder / "config/studies/tiny.yaml").write_text(text)
    return folder


def finish(process: subprocess.Popen, folder: Path) -> None:
    try:
        code = process.wait(TIMEOUT)
    finally:
        process.kill()
    assert code == 0, (folder / "snakemake.txt").read_text()


def wait_for(moment, process: subprocess.Popen, folder: Path) -> None:
    deadline = time.monotonic() + TIMEOUT
    while not moment():
        assert process.poll() is None, (folder / "snakemake.txt").read_text()
        assert time.monotonic() < deadline, "the moment never came"
        time.sleep(POLL)


def of_rule(cluster: Slurm, rule: str) -> list[dict[str, str]]:
    return [job for job in cluster.jobs() if job["comment"].startswith(f"rule_{rule}")]


def wear_without_slurm(folder: Path, elsewhere: Path) -> bytes:
    """Return wear.csv of the same run by the driver alone, from the same surface and bed."""
    (elsewhere / RUN).mkdir(parents=True)
    chain = tiny_chain(load_study("tiny", Project(folder, package=folder)), folder / "results/tiny", RUN)
    cycles.run_chain(replace(chain, folder=elsewhere / RUN))
    return (elsewhere / RUN / "wear.csv").read_bytes()


@pytest.mark.verify  # waits for a minute
def test_a_study_runs_on_slurm_and_resumes_after_scancel(cluster, tmp_path):
    """Meshes, bed and run are a submission each. The run is cancelled in its second wear cycle, submitted again,
    resumes after the first, and ends in the table of an undisturbed one."""
    folder, before = study(tmp_path / "study", PLAIN), len(cluster.jobs())
    process = snakemake(folder, cluster, f"results/tiny/{RUN}/wear.csv")
    try:
        wait_for((folder / f"results/tiny/{RUN}/cycle_002.part/screen.txt").exists, process, folder)
        (running,) = of_rule(cluster, "worn_run")
        cluster.ask("scancel", running["id"])
    finally:
        finish(process, folder)
    assert [job["state"] for job in of_rule(cluster, "worn_run")] == ["CANCELLED", "COMPLETED"]
    assert len(cluster.jobs()) - before == 4, cluster.jobs()
    assert f"{RUN}: resumes after cycle 1 of 2" in (folder / f"results/tiny/logs/worn_run_{RUN}.log").read_text()
    found = (folder / f"results/tiny/{RUN}/wear.csv").read_bytes()
    assert found == wear_without_slurm(folder, tmp_path / "elsewhere")


def submitted(folder: Path, cluster: Slurm, count: int, *arguments: str) -> dict[str, tuple[str, str]]:
    """{comment: (cores, time limit)} of so many submissions of a study. The queue is stopped: nothing runs."""
    before = len(cluster.jobs())
    cluster.ask("scontrol", "update", "PartitionName=main", "State=DOWN")
    process = snakemake(folder, cluster, *arguments)
    try:
        wait_for(lambda: len(cluster.jobs()) == before + count, process, folder)
        asked = {job["comment"]: (job["cpus"], job["limit"]) for job in cluster.jobs()[before:]}
    finally:
        process.kill()
        process.wait()
        cluster.cancel_all()
        cluster.ask("scontrol", "update", "PartitionName=main", "State=UP")
    assert {job["state"] for job in cluster.jobs()[before:]} == {"CANCELLED"}
    return asked


def test_ranks_are_tasks(cluster, tmp_path):
    """A study's ranks are the tasks that its beds ask for."""
    folder = study(tmp_path, PLAIN + "solver: {ranks: 2}\n")
    assert submitted(folder, cluster, 2, f"results/tiny/{RUN}/wear.csv") == {
        "rule_meshes_surface_mesh": ("1", "20:00"),
        "rule_settled_bed_wildcards_tiny_bed_R5": ("2", "11:00"),
    }


def test_the_batch_of_a_calibration_is_its_cores(cluster, tmp_path):
    """Also where they are more than a submission of small jobs has."""
    folder = workspace(tmp_path)
    shutil.copy(REPOSITORY / "config/studies/calibration.yaml", folder / "config/studies")
    batch = ("--config", "calibration={batch: 2}", "--cores", "1")
    asked = submitted(folder, cluster, 1, "results/calibration/simulations.csv", *batch)
    assert [cores for cores, _ in asked.values()] == ["2"]


@pytest.mark.parametrize("within", ["", "srun --ntasks=1 --cpus-per-task=2 "])
def test_ranks_start_inside_a_job(cluster, tmp_path, within):
    """Two ranks share one box, in a job and in a step of it, whatever Snakemake hands on of the job's environment."""
    (tmp_path / DECK).write_text(MPI_PROBE_DECK)
    (tmp_path / "ranks.py").write_text(f"from pathlib import Path\n{START_RANKS}")
    kept = "env -u SLURM_NODELIST -u SLURM_JOB_NODELIST -u SLURM_TASKS_PER_NODE -u SLURM_NTASKS"
    cluster.run(2, f"{kept} PYTHONPATH={REPOSITORY} {within}{sys.executable} {tmp_path}/ranks.py", tmp_path)
    assert "1 by 1 by 2 MPI processor grid" in (tmp_path / "job.txt").read_text()


@pytest.mark.verify  # waits for a minute
def test_an_allocation_is_no_submission(cluster, tmp_path):
    """Snakemake called within salloc keeps to its cores; the job that it submits has its tasks."""
    rules = (REPOSITORY / "workflows/jobs.smk").read_text()
    told = next(part for part in rules.split("\n\n\n") if part.startswith("def submitted("))
    (tmp_path / "Snakefile").write_text(f"from pathlib import Path\n{RANKS_TOLD % told}")
    words = [sys.executable, "-m", "snakemake", "--cores", "1"]
    slurm = ["--executor", "slurm", "--jobs", "1", "--default-resources", "nodes=1", *OF_TEST.split()]
    environment = {**cluster.environment, "PYTHONPATH": str(REPOSITORY)}
    for call in (["salloc", "--ntasks=1", *words, "here.txt"], [*words, "there.txt", *slurm]):
        subprocess.run(call, cwd=tmp_path, env=environment, check=True, capture_output=True, timeout=TIMEOUT)
    assert [(tmp_path / f"{name}.txt").read_text() for name in ("here", "there")] == ["1", "2"]


def files_of(folder: Path) -> set[str]:
    """What a study leaves besides logs and locks."""
    results = folder / "results/tiny"
    found = (path.relative_to(results) for path in results.rglob("*") if path.is_file())
    return {str(path) for path in found if path.parts[0] != "logs" and path.name != ".lock"}


def is_stopped(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "T"
    except FileNotFoundError:
        return False


def is_solver(process: int) -> bool:
    """Return whether a process is a solver, and not the daemon of Open MPI that outlives it for a moment."""
    try:
        return Path(f"/proc/{process}/comm").read_text().startswith("liggghts")
    except FileNotFoundError:
        return False


def hang(folder: Path) -> bool:
    """Stop the solvers that work in a folder for good; False if none did, or one was just ending."""
    solvers = [process for process in solver_processes(folder) if is_solver(process)]
    for solver in solvers:
        try:
            os.kill(solver, signal.SIGSTOP)
        except ProcessLookupError:
            return False
    time.sleep(POLL)
    return bool(solvers) and all(map(is_stopped, solvers))


@pytest.mark.verify  # waits for minutes
def test_a_time_limit_within_a_cycle_changes_nothing(cluster, tmp_path):
    """The run hangs within its second wear cycle until its time limit of a minute ends it. Submitted again, with more
    time, it goes on within that cycle, and ends in the table of an undisturbed one."""
    folder, before = study(tmp_path / "study", IN_PIECES), len(cluster.jobs())
    part = folder / f"results/tiny/{RUN}/cycle_002.part"
    target = f"results/tiny/{RUN}/wear.csv"
    process = snakemake(folder, cluster, target, "--set-resources", "worn_run:runtime=attempt")
    try:
        wait_for(lambda: (part / PIECES).exists() and hang(part), process, folder)
    finally:
        finish(process, folder)
    runs = [job for job in cluster.jobs()[before:] if job["comment"].startswith("rule_worn_run")]
    *first, last = [job["state"] for job in runs]  # how many attempts it takes depends on the machine
    assert first and set(first) == {"TIMEOUT"} and last == "COMPLETED"
    assert [job["limit"] for job in runs] == [f"{attempt}:00" for attempt in range(1, len(runs) + 1)]
    assert "cycle 2 of 2 goes on after step" in (folder / f"results/tiny/logs/worn_run_{RUN}.log").read_text()
    assert (folder / target).read_bytes() == wear_without_slurm(folder, tmp_path / "elsewhere")


@pytest.mark.verify
def test_a_whole_study_leaves_what_one_machine_leaves(cluster, tmp_path):
    """A study to its report, with the files and tables of the profile of one machine. All tables and figures are one
    submission."""
    here, there = study(tmp_path / "here", PLAIN), study(tmp_path / "there", PLAIN)
    before = len(cluster.jobs())
    finish(snakemake(there, cluster, "tiny"), there)
    jobs = cluster.jobs()[before:]
    assert sum(job["comment"].startswith("rule_tables_and_figures") for job in jobs) == 1, jobs
    subprocess.run([sys.executable, "-m", "snakemake", "tiny"], cwd=here, check=True, capture_output=True)
    assert files_of(there) == files_of(here)
    for name in ("summary.csv", "design.csv"):
        assert (there / "results/tiny" / name).read_bytes() == (here / "results/tiny" / name).read_bytes()
