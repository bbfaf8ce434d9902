"""What is said of a project: by Snakemake where it makes nothing, and where the project cannot be worked in."""

import multiprocessing
from pathlib import Path

from bulkwear.workflows.engine.project import PACKAGE
from tests.support.loaded_project import load_project, plan
from tests.support.own_project import STUDY

# Each process is forked from one that has read modules and entered no project: starting Snakemake costs 1.5 seconds.
CLEAN = multiprocessing.get_context("forkserver")
CLEAN.set_forkserver_preload(
    [load_project.__module__, "snakemake.cli", "snakemake.report", "snakemake.script", "jsonschema"]
)
PROFILE = ("--workflow-profile", str(PACKAGE / "workflows/profiles/default"))


def said_of(folder: Path, *arguments: str, code: int = 0) -> str:
    """What Snakemake says in a folder where it makes nothing; code: with which it ends."""
    said = folder.parent / "plan.txt"
    process = CLEAN.Process(target=plan, args=(folder, arguments, said))
    process.start()
    process.join()
    output = said.read_text(encoding="utf-8")
    assert process.exitcode == code, output
    return output


def outside_of(folder: Path) -> tuple[str, ...]:
    """How a project is named from outside it, for the package's own Snakefile."""
    return "--snakefile", str(PACKAGE / "Snakefile"), "--directory", str(folder)


def told_of(folder: Path, study: str = STUDY) -> str:
    """What is said of a project that cannot be worked in, and nothing else: one line."""
    said = folder.parent / "said.txt"
    process = CLEAN.Process(target=load_project, args=(folder, study, said))
    process.start()
    process.join()
    told = said.read_text()
    assert process.exitcode == 1 and told.count("\n") == 1, told
    assert not (folder / "results").exists()
    return told
