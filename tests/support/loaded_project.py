"""A project loaded, or planned by Snakemake, in a process of its own."""

import os
import runpy
import sys
from collections.abc import Sequence
from pathlib import Path

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.project import enter_project


def load_project(folder: Path, study: str, said: Path) -> None:
    """Enter a project and load a study of it; a ValueError ends the process with its sentence, exit code 1.

    said: file that gets all of standard error
    """
    os.dup2(os.open(said, os.O_WRONLY | os.O_CREAT), sys.stderr.fileno())
    try:
        enter_project(folder)
        load_study(study)
    except ValueError as fault:
        sys.exit(str(fault))


def plan(folder: Path, arguments: Sequence[str], said: Path) -> None:
    """Do in a folder what `python -m snakemake` does there; said: file that gets all that it says."""
    stream = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for of_process in (sys.stdout, sys.stderr):
        os.dup2(stream, of_process.fileno())
    os.chdir(folder)
    sys.argv = ["snakemake", *arguments]
    runpy.run_module("snakemake", run_name="__main__")
