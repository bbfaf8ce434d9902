"""Make a project: a folder with a small study that works, whose Snakefile takes the package's workflow as a module.

python -m bulkwear project DIR
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from bulkwear.workflows.environment.new_project import make_project


def main(words: list[str] | None = None) -> int:
    """Make the project of the command line; 1 where there is something in its folder."""
    parser = argparse.ArgumentParser(prog="python -m bulkwear", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("command", choices=["project"])
    parser.add_argument("folder", type=Path, metavar="DIR")
    given = parser.parse_args(words)
    try:
        print(make_project(given.folder))
    except ValueError as fault:
        print(fault, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
