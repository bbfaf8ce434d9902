"""A Slurm of one node, for tests: munged, slurmctld and slurmd of this user, in a folder of their own.

Needs no root and no configuration of the machine; ports are free ones. Every process is stopped by its id.
"""

from __future__ import annotations

import getpass
import os
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path

SEARCHED = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin"])  # not every user has the daemons on the PATH
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "scancel", "squeue", "sinfo", "scontrol")
PATIENCE = 60.0  # s, for daemons that are up after one or two
CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
KillWait=5
MinJobAge=86400
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory=8000 State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""


def missing_programs() -> list[str]:
    """Return the programs of Slurm that this machine lacks."""
    return [name for name in PROGRAMS if shutil.which(name, path=SEARCHED) is None]


def missing_cgroups() -> bool:
    """Return whether this machine has no cgroup file system, as a bare chroot: slurmd does not start without one."""
    kinds = (line.split()[2] for line in Path("/proc/mounts").read_text().splitlines() if len(line.split()) > 2)
    return not any(kind in ("cgroup", "cgroup2") for kind in kinds)


def free_ports(count: int) -> list[int]:
    """Return ports that nothing listens on."""
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Slurm:
    """A running cluster; a context manager. `environment` is that of its users."""

    def __init__(self) -> None:
        # not below pytest's folders: a socket's path must be short, and munged wants a folder that others may enter
        self.folder = Path(tempfile.mkdtemp(prefix="slurm_"))
        self.folder.chmod(0o711)
        self.processes: list[subprocess.Popen] = []
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}
        self.environment["PATH"] = os.pathsep.join([str(self.folder / "bin"), SEARCHED])

    def __enter__(self) -> Slurm:
        try:
            self._configure()
            key = [f"--{name}={self.folder}/munge.{name}" for name in ("socket", "pid-file", "log-file", "seed-file")]
            self._start("munged", "--foreground", f"--key-file={self.folder}/munge.key", *key)
            self._wait_for((self.folder / "munge.socket").exists, "munged")
            self._start("slurmctld", "-D")
            self._start("slurmd", "-D")
            self._wait_for(lambda: self.ask("sinfo", "--noheader", "--format=%T").strip() == "idle", "slurmd")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        if len(self.processes) > 1:
            self.cancel_all()
        for process in reversed(self.processes):
            process.terminate()
            try:
                process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def cancel_all(self) -> None:
        """Cancel all jobs and wait until they are gone."""
        self.ask("scancel", f"--user={getpass.getuser()}")
        deadline = time.monotonic() + PATIENCE
        while self.ask("squeue", "--noheader").strip() and time.monotonic() < deadline:
            time.sleep(0.2)

    def _configure(self) -> None:
        for name in ("state", "spool", "bin"):
            (self.folder / name).mkdir()
        (self.folder / "munge.key").write_bytes(os.urandom(1024))
        (self.folder / "munge.key").chmod(0o400)
        words = {"host": socket.gethostname(), "ports": free_ports(2), "user": getpass.getuser()}
        text = CONFIGURATION.format(folder=self.folder, cpus=min(os.cpu_count(), 2), **words)
        (self.folder / "slurm.conf").write_text(text)
        (self.folder / "cgroup.conf").write_text("CgroupAutomount=yes\nConstrainCores=no\n")
        # jobs of Snakemake call srun without SLURM_CONF, which other clusters do not need
        srun = self.folder / "bin" / "srun"
        srun.write_text(f'#!/bin/sh\nSLURM_CONF={self.folder}/slurm.conf exec {shutil.which("srun")} "$@"\n')
        srun.chmod(0o755)

    def _start(self, program: str, *arguments: str) -> None:
        with open(self.folder / f"{program}.out", "wb") as out:
            words = [shutil.which(program, path=SEARCHED), *arguments]
            self.processes.append(
                subprocess.Popen(
                    words, env=self.environment, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT
                )
            )

    def _wait_for(self, ready, program: str) -> None:
        deadline = time.monotonic() + PATIENCE
        while not ready():
            said = "".join(
                path.read_text() for path in self.folder.glob(f"{program}.*") if path.suffix in (".out", ".log")
            )
            assert all(process.poll() is None for process in self.processes), f"{program} ended:\n{said}"
            assert time.monotonic() < deadline, f"{program} is not up after {PATIENCE:g} s:\n{said}"
            time.sleep(0.1)

    def ask(self, *command: str) -> str:
        """Return what a program of Slurm prints."""
        return subprocess.run(
            command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        ).stdout

    def run(self, tasks: int, command: str, folder: Path) -> str:
        """Run a shell command as a job of so many tasks, wait for it, and return its id."""
        words = [
            "sbatch",
            "--parsable",
            "--wait",
            f"--ntasks={tasks}",
            f"--output={folder}/job.txt",
            f"--wrap={command}",
        ]
        return self.ask(*words).strip()

    def jobs(self) -> list[dict[str, str]]:
        """Return id, rule and wildcards (comment), state, CPUs and minutes (limit) of all jobs so far, in order."""
        keys = ("id", "comment", "state", "cpus", "limit")
        lines = self.ask("squeue", "--states=all", "--noheader", "--sort=i", "--format=%i|%k|%T|%C|%l").splitlines()
        return [dict(zip(keys, line.split("|"), strict=True)) for line in lines]
