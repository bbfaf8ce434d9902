"""A project loaded in a process of its own, as a start of Snakemake does it."""

import os
import sys
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
