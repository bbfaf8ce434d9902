"""Runs `snakemake --lint` and fails on every hint but one: that each rule should name a conda environment.

All rules share the one locked environment that `make setup` builds, and Snakemake offers no way to waive a
single hint.
"""

import re
import subprocess
import sys

WAIVED = "Specify a conda environment or container for each rule."
SECTION = re.compile(r"^(?=Lints for )", flags=re.MULTILINE)
HINT = re.compile(r"^ {4}\* ", flags=re.MULTILINE)


def remaining(output: str, waived: str = WAIVED) -> tuple[int, str]:
    """Number of hints in the linter's output, and those not waived, each under the rule it is for."""
    hints, kept = 0, []
    for section in SECTION.split(output)[1:]:
        head, *blocks = HINT.split(section)
        hints += len(blocks)
        wanted = [block for block in blocks if not block.startswith(waived)]
        if wanted:
            kept.append(head.rstrip() + "\n" + "".join(f"    * {block.rstrip()}\n" for block in wanted))
    return hints, "\n".join(kept)


def main() -> int:
    """Lint the workflow in this folder; 1 if a hint remains, the linter's own code if it could not lint."""
    done = subprocess.run(
        ["snakemake", "--lint"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
    )
    output = done.stdout + done.stderr
    hints, kept = remaining(output)
    if done.returncode != 0 and hints == 0:
        print(output, file=sys.stderr)
        return done.returncode
    print(kept or "snakemake --lint: nothing to improve")
    return 1 if kept else 0


if __name__ == "__main__":
    sys.exit(main())
