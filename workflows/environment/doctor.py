"""Checks that this machine can run the toolkit, prints one line per finding and what to do about it.

Uses the standard library only, so that it still runs where set-up failed. What may crash (rendering, gmsh,
the solver) is tried in a process of its own.
"""

from __future__ import annotations  # so that an older Python gets as far as being told so

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
OLDEST_PYTHON = (3, 11)
SOLVER_VERSION = "3.8.0"
LEAST_FREE_DISK_GB = 1.0  # the tests and the demonstration
ADVISABLE_FREE_DISK_GB = 5.0  # a larger study
ADVISABLE_MEMORY_GB = 4.0  # a standard bed with its dumps, beside one worker process
PROBE_TIMEOUT_S = 120
SET_UP = "run `make setup`"

PACKAGE_OF_LIBRARY = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libGLU.so.1": "libglu1-mesa",
    "libOSMesa.so.8": "libosmesa6",
    "libXcursor.so.1": "libxcursor1",
    "libXft.so.2": "libxft2",
    "libXinerama.so.1": "libxinerama1",
    "libXrender.so.1": "libxrender1",
    "libgomp.so.1": "libgomp1",
}

RENDER_PROBE = """
import numpy, pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere(), color="red")
picture = plotter.screenshot(return_img=True)
if numpy.ptp(picture) == 0:
    raise SystemExit("the picture is empty")
print(plotter.render_window.GetClassName())
"""
OFF_SCREEN_LIBRARIES_PROBE = """
import ctypes
for name in ("libOSMesa.so.8", "libEGL.so.1"):
    try:
        ctypes.CDLL(name)
    except OSError:
        print(name)
"""
GMSH_PROBE = "import gmsh; gmsh.initialize([], False); print(gmsh.option.getString('General.Version'))"
# Two processes of one run share this box; two unconnected runs would have a grid of 1 by 1 by 1 each.
MPI_PROBE_DECK = """atom_style granular
communicate single vel yes
units si
region domain block 0 1 0 1 0 1 units box
create_box 1 domain
"""

LEDGER_PROGRAM = REPOSITORY / "solver" / "build" / "liggghts-ledger"
LEDGER_PROBE_PLATE = """solid plate
facet normal 0 0 1
outer loop
vertex 0.1 0.1 0.5
vertex 0.9 0.1 0.5
vertex 0.5 0.9 0.5
endloop
endfacet
endsolid plate
"""
# One sphere overlapping a triangle: the ledger must find itself called.
LEDGER_PROBE_DECK = (
    "newton off\n"
    + MPI_PROBE_DECK
    + """neighbor 0.01 bin
create_atoms 1 single 0.5 0.4 0.599 units box
set group all diameter 0.2 density 1000
fix youngs_modulus all property/global youngsModulus peratomtype 1e7
fix poissons_ratio all property/global poissonsRatio peratomtype 0.3
fix restitution all property/global coefficientRestitution peratomtypepair 1 0.5
fix friction all property/global coefficientFriction peratomtypepair 1 0.5
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1e-6
fix plate all mesh/surface file plate.stl type 1
fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes plate
fix motion all nve/sphere
fix ledger all load/ledger mesh plate file ledger.bin
run 1
"""
)
LEDGER_ADVICE = "run `make -C solver`; without it studies need `ledger: dumps` (solver/README.md)"


@dataclass(frozen=True)
class Finding:
    """One line of the table: state is OK, missing, wrong or low; only `missing` and `wrong` are failures."""

    what: str
    state: str
    found: str
    advice: str = ""

    @property
    def failed(self) -> bool:
        return self.state in ("missing", "wrong")


@dataclass(frozen=True)
class Probe:
    """What a command returned; code is negative after a signal and None when it never ran or never ended."""

    code: int | None
    output: str


def run(command: list[str], folder: str | Path | None = None, environment: dict | None = None) -> Probe:
    """Run a command without input, both streams together; neither a crash nor a hang reaches the caller."""
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=PROBE_TIMEOUT_S,
            text=True,
            errors="replace",
        )
    except FileNotFoundError:
        return Probe(None, f"{command[0]}: not found")
    except subprocess.TimeoutExpired:
        return Probe(None, f"{command[0]}: no answer within {PROBE_TIMEOUT_S} s")
    return Probe(done.returncode, done.stdout)


def last_line(text: str) -> str:
    """The last line that says something, for a table cell."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else "no output"


def check_python(version: tuple[int, ...] = sys.version_info[:3]) -> Finding:
    """Python must be OLDEST_PYTHON or newer."""
    found = ".".join(map(str, version))
    if version[:2] >= OLDEST_PYTHON:
        return Finding("Python", "OK", found)
    return Finding("Python", "wrong", found, "install Python 3.11: apt-get install python3")


def locked_versions(lock: str) -> dict[str, str]:
    """Name -> version of every requirement in the text of a lock file (`name==version`)."""
    return dict(re.findall(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)", lock, flags=re.MULTILINE))


def canonical(name: str) -> str:
    """A distribution's name as the lock spells it (PEP 503)."""
    return re.sub(r"[-_.]+", "-", name).lower()


def installed_versions() -> dict[str, str]:
    """Name -> version of every distribution this interpreter sees."""
    return {canonical(found.metadata["Name"]): found.version for found in metadata.distributions()}


def check_packages(locked: dict[str, str], installed: dict[str, str]) -> Finding:
    """Every locked package must be installed in exactly the locked version."""
    absent = sorted(name for name in locked if canonical(name) not in installed)
    other = sorted(name for name in locked if installed.get(canonical(name), locked[name]) != locked[name])
    if absent:
        return Finding("Python packages", "missing", listed(absent), SET_UP)
    if other:
        versions = [f"{name} {installed[canonical(name)]} (lock: {locked[name]})" for name in other]
        return Finding("Python packages", "wrong", listed(versions), SET_UP)
    return Finding("Python packages", "OK", f"{len(locked)} as locked, in {sys.prefix}")


def listed(names: list[str], longest: int = 4) -> str:
    """The first few names and how many more there are."""
    return ", ".join(names[:longest]) + (f" and {len(names) - longest} more" if len(names) > longest else "")


def check_solver() -> Finding:
    """`liggghts -h` must name SOLVER_VERSION (it leaves a log file behind and exits with 1 even so)."""
    with tempfile.TemporaryDirectory() as folder:
        probe = run(["liggghts", "-h"], folder)
    if probe.code is None:
        return Finding("LIGGGHTS", "missing", probe.output, f"{SET_UP}, or put liggghts on PATH")
    version = re.search(r"LIGGGHTS-\w+ (\d[\d.]*)", probe.output)
    if version is None:
        return Finding("LIGGGHTS", "wrong", last_line(probe.output), "liggghts -h should print its version")
    if version[1] != SOLVER_VERSION:
        return Finding("LIGGGHTS", "wrong", version[1], f"the decks are written for {SOLVER_VERSION}")
    return Finding("LIGGGHTS", "OK", f"{version[1]} at {shutil.which('liggghts')}")


def mpi_environment() -> dict[str, str]:
    """This process' environment; as root, with the flags Open MPI then asks for."""
    flags = ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM")
    return {**os.environ, **({flag: "1" for flag in flags} if os.geteuid() == 0 else {})}


def check_mpi() -> Finding:
    """Two solver processes started by mpirun must share one simulation box."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "box.in").write_text(MPI_PROBE_DECK)
        command = ["mpirun", "-n", "2", "--oversubscribe", "--bind-to", "none", "liggghts", "-in", "box.in"]
        probe = run(command, folder, mpi_environment())
    if probe.code is None:
        return Finding("MPI", "missing", probe.output, "apt-get install openmpi-bin")
    grid = re.search(r"(\d+) by (\d+) by (\d+) MPI processor grid", probe.output)
    if probe.code != 0 or grid is None:
        return Finding("MPI", "wrong", last_line(probe.output), "`mpirun -n 2 liggghts` must run")
    if int(grid[1]) * int(grid[2]) * int(grid[3]) != 2:
        advice = "mpirun belongs to another MPI than liggghts; put Debian's first on PATH"
        return Finding("MPI", "wrong", f"two separate runs: {grid[0]}", advice)
    return Finding("MPI", "OK", f"2 processes share one box ({shutil.which('mpirun')})")


def check_ledger() -> Finding:
    """The solver with the load ledger must run, fit the LIGGGHTS library and be told of a contact."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "plate.stl").write_text(LEDGER_PROBE_PLATE)
        (Path(folder) / "deck.in").write_text(LEDGER_PROBE_DECK)
        probe = run([str(LEDGER_PROGRAM), "-in", "deck.in"], folder, mpi_environment())
    if probe.code is None:
        return Finding("load ledger", "missing", probe.output, LEDGER_ADVICE)
    if probe.code != 0 or "every contact is reported" not in probe.output:
        stopped = re.search(r"^ERROR.*", probe.output, flags=re.MULTILINE)
        return Finding("load ledger", "wrong", stopped[0] if stopped else last_line(probe.output), LEDGER_ADVICE)
    return Finding("load ledger", "OK", "accounts for every contact inside the solver")


def missing_library(text: str) -> str | None:
    """The shared library a loader error names, if it names one."""
    found = re.search(r"(lib[\w.+-]+\.so[\d.]*): cannot open shared object file", text)
    return found[1] if found else None


def library_finding(what: str, library: str) -> Finding:
    """A missing shared library and the Debian package that has it."""
    package = PACKAGE_OF_LIBRARY.get(library, f"the package that contains {library}")
    return Finding(what, "missing", library, f"{SET_UP}, or apt-get install {package}")


def check_rendering(python: str = sys.executable) -> Finding:
    """VTK must draw a picture without a screen; without OSMesa and EGL it crashes instead of saying so."""
    what = "off-screen rendering"
    probe = run([python, "-c", RENDER_PROBE])
    if probe.code == 0:
        return Finding(what, "OK", last_line(probe.output))
    if "ModuleNotFoundError" in probe.output:
        return Finding(what, "missing", last_line(probe.output), SET_UP)
    if library := missing_library(probe.output):
        return library_finding(what, library)
    absent = run([python, "-c", OFF_SCREEN_LIBRARIES_PROBE]).output.split()
    if "libOSMesa.so.8" in absent:
        return library_finding(what, "libOSMesa.so.8")
    died = probe.code is not None and probe.code < 0
    found = f"crashed with signal {-probe.code}" if died else last_line(probe.output)
    return Finding(what, "wrong", found, "try VTK_DEFAULT_OPENGL_WINDOW=vtkOSOpenGLRenderWindow")


def check_gmsh(python: str = sys.executable) -> Finding:
    """The gmsh module must load and start."""
    probe = run([python, "-c", GMSH_PROBE])
    if probe.code == 0:
        return Finding("gmsh", "OK", last_line(probe.output))
    if library := missing_library(probe.output):
        return library_finding("gmsh", library)
    return Finding("gmsh", "missing", last_line(probe.output), SET_UP)


def check_browser() -> Finding:
    """Chromium prints pages; without it they are HTML alone."""
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found:
        return Finding("browser", "OK", found)
    return Finding("browser", "low", "no Chromium on PATH", f"{SET_UP}: report.pdf needs it, all else does not")


def check_disk(folder: Path = REPOSITORY / "results") -> Finding:
    """Results need LEAST_FREE_DISK_GB on the disk they go to, and should have ADVISABLE_FREE_DISK_GB."""
    existing = next(path for path in (folder, *folder.parents) if path.exists())
    free = shutil.disk_usage(existing).free / 1e9
    found = f"{free:.1f} GB where results go"
    if free >= ADVISABLE_FREE_DISK_GB:
        return Finding("free disk", "OK", found)
    state = "low" if free >= LEAST_FREE_DISK_GB else "wrong"
    return Finding("free disk", state, found, f"make room: {ADVISABLE_FREE_DISK_GB:g} GB are advisable")


def check_cores() -> Finding:
    """Cores this process may use; one is enough, slowly."""
    cores = len(os.sched_getaffinity(0))
    if cores > 1:
        return Finding("cores", "OK", str(cores))
    return Finding("cores", "low", str(cores), "works, one run at a time")


def check_memory() -> Finding:
    """Main memory; little of it is no failure."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    if memory >= ADVISABLE_MEMORY_GB:
        return Finding("memory", "OK", f"{memory:.1f} GB")
    return Finding("memory", "low", f"{memory:.1f} GB", f"{ADVISABLE_MEMORY_GB:g} GB are advisable")


def findings() -> Iterable[Finding]:
    """All checks, in the order in which things depend on each other."""
    checks: tuple[Callable[[], Finding], ...] = (
        check_python,
        lambda: check_packages(locked_versions((REPOSITORY / "requirements.txt").read_text()), installed_versions()),
        check_solver,
        check_mpi,
        check_ledger,
        check_rendering,
        check_gmsh,
        check_browser,
        check_disk,
        check_cores,
        check_memory,
    )
    return (check() for check in checks)


def line(finding: Finding) -> str:
    """One row of the printed table."""
    advice = f"  ->  {finding.advice}" if finding.advice else ""
    return f"{finding.state:<8} {finding.what:<21} {finding.found}{advice}"


def main(arguments: list[str] | None = None) -> int:
    """Print the table; 1 if something required is missing or wrong, else 0."""
    ending = "Exit code 1 if something required is missing."
    parser = argparse.ArgumentParser(description=__doc__, epilog=ending)
    parser.parse_args(arguments)
    failures = 0
    for finding in findings():
        print(line(finding), flush=True)
        failures += finding.failed
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
