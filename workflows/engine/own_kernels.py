"""Contact kernels that a project has of its own in C++: `laws/<kernel>.h`, compiled when a run first needs them.

The file holds one function of the kernel's name, `inline double name(const Contact& contact, const double* given)`, as
those of solver/kernels.h; a module of laws/ declares the unit of its sum and the names of its parameters, in KERNELS.
They become a small shared library below results/, named by the hash of what it is made of, which our program of the
solver loads. So the package need not be written to, and a changed kernel is another library.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from bulkwear.postproc.wear.kernels import KERNELS, is_per_impact, kernel_column, kernel_of, kernel_parameters
from bulkwear.workflows.engine.project import KERNELS_OF_PACKAGE, LAWS, PACKAGE, ProjectError, current_project
from bulkwear.workflows.engine.records import digest

SUFFIX = ".h"
BUILT = "results/own_kernels"  # folder of a project
COMPILERS = ("c++", "g++", "clang++", "mpicxx")  # the first that there is, where CXX names none
FLAGS = ("-std=c++17", "-O2", "-Wall", "-fPIC", "-shared")  # of the solver's own Makefile, and of a library
HEADER = PACKAGE / "solver" / "kernels.h"
FAULT = re.compile(r"^(?P<file>[^:\n]+):(?P<line>\d+):(?:\d+:)? (?:fatal )?error: (?P<words>.+)$", re.MULTILINE)
LONGEST_S = 120.0  # for which a compiler may take


def own_sources(kernels: Iterable[str]) -> dict[str, Path]:
    """Return {kernel: its file} of those kernels that the project has in C++; kernels: names, or labels of sums."""
    project = current_project()
    if project.is_package:
        return {}
    files = {name: project.folder / LAWS / f"{name}{SUFFIX}" for name in map(kernel_of, kernels)}
    return {name: path for name, path in files.items() if path.is_file()}


def own_library(kernels: Iterable[str]) -> Path | None:
    """Return the library of those kernels that the project has in C++, compiled where it is not there yet.

    None where it has none of them in C++.

    Raises ProjectError where a kernel of the project has no file, where there is no compiler, or where it refuses:
    file, line and its words.
    """
    kernels = [kernel_of(label) for label in kernels]
    sources = own_sources(kernels)
    if not current_project().is_package:
        for name in (name for name in kernels if name not in {*sources, *KERNELS_OF_PACKAGE}):
            raise ProjectError(
                f"{LAWS}/{name}{SUFFIX}: there is no such file, allowed is the contact kernel {name} in C++; its"
                " function in Python serves `ledger: dumps`."
            )
    if not sources:
        return None
    compiler, text = _compiler(), library_text(sources)
    made_of = [text, *(path.read_text(encoding="utf-8") for path in (HEADER, *sources.values()))]
    folder = current_project().folder / BUILT
    library = folder / f"{digest(compiler, *FLAGS, *made_of)[:16]}.so"
    if not library.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as here:
            os.replace(_compiled([compiler, *FLAGS, f"-I{HEADER.parent}"], text, Path(here), sources), library)
    return library


def library_text(sources: dict[str, Path]) -> str:
    """Return the C++ of a library of some kernels: their files, and the list that the program reads."""
    lines = ['#include "kernels.h"', "namespace load_ledger {"]
    lines += [f'#include "{path.resolve()}"' for path in sources.values()]
    lines += ["}", 'extern "C" const load_ledger::Kernel OWN_KERNELS[];', "const load_ledger::Kernel OWN_KERNELS[] = {"]
    for name in sources:
        given = ", ".join(f'"{parameter}"' for parameter in kernel_parameters(name))
        per_impact = str(is_per_impact(name)).lower()
        lines.append(f'    {{"{name}", "{kernel_column(name)}", load_ledger::{name}, {{{given}}}, {per_impact}}},')
    return "\n".join([*lines, "    {nullptr, nullptr, nullptr, {}, false}};", ""])


def python_fault(kernels: Iterable[str]) -> str | None:
    """Return a sentence where sampled contacts cannot be summed because a kernel is there in C++ alone, else None."""
    if missing := [name for name in map(kernel_of, kernels) if KERNELS[name].value is None]:
        return (
            f"contact kernel {missing[0]}: it has no function in Python, which `ledger: dumps` needs, allowed is"
            " `ledger: solver`, or a Kernel(function, ...)."
        )
    return None


def _compiler() -> str:
    for name in (os.environ.get("CXX", ""), *COMPILERS):
        if name and (found := shutil.which(name)):
            return found
    raise ProjectError(
        f"{LAWS}/: found none of the compilers {', '.join(COMPILERS)}, which its kernels in C++ need; on Debian:"
        " apt-get install g++."
    )


def _compiled(command: Sequence[str], text: str, here: Path, sources: dict[str, Path]) -> Path:
    """Return the library, compiled in a folder. Raises ProjectError."""
    written, library = here / "own_kernels.cpp", here / "own_kernels.so"
    written.write_text(text, encoding="utf-8")
    words, plain = [*command, str(written), "-o", str(library)], {**os.environ, "LC_ALL": "C"}
    done = subprocess.run(words, capture_output=True, text=True, timeout=LONGEST_S, env=plain)
    if done.returncode:
        raise ProjectError(_sentence(done.stderr, sources))
    return library


def _sentence(said: str, sources: dict[str, Path]) -> str:
    """Return in one sentence what a compiler does not take: the first fault in a project's file, else the first one."""
    names = {str(path.resolve()): f"{LAWS}/{path.name}" for path in sources.values()}
    faults = list(FAULT.finditer(said))
    for fault in faults:
        if fault["file"] in names:
            return f"{names[fault['file']]}, line {fault['line']}: {fault['words']}; allowed is C++ that compiles."
    words = faults[0]["words"] if faults else (said.strip().splitlines() or ["the compiler gives no reason"])[-1]
    files = ", ".join(names.values())
    return (
        f"{files}: {words}; allowed is a function of the kernel's name, `inline double name(const Contact& contact, "
        "const double* given)`."
    )
