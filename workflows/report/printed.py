"""The page of a study as PDF, printed by Chromium without a window; how it looks on paper is in style.html.j2."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

BROWSERS = ("chromium", "chromium-browser")  # names of the program, the first one is Debian's
LONGEST = 300.0  # s; the page of a study with forty runs takes some 10 s
OPTIONS = (
    "--headless",
    "--no-sandbox",  # which root and containers have not; the page is our own and loads nothing
    "--disable-gpu",
    "--no-pdf-header-footer",  # the page's own style has them
    "--generate-pdf-document-outline",
)
PDF = b"%PDF-"  # a file's first letters


class PrintError(RuntimeError):
    """A page that was not printed, in one sentence."""


def browser() -> str | None:
    """Return the path of Chromium, None where it is not on PATH."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


def print_page(page: Path, pdf: Path) -> None:
    """Print a page, whole or not at all. Raises PrintError."""
    program = browser()
    if program is None:
        raise PrintError(
            f"{pdf}: Chromium, which prints it, is not on PATH, allowed is Debian's package: run `make setup`, or"
            f" apt-get install chromium. {page} is there and is the same page."
        )
    part = pdf.with_suffix(".pdf.part")
    with tempfile.TemporaryDirectory() as profile:
        command = [program, *OPTIONS, f"--user-data-dir={profile}", f"--print-to-pdf={part.resolve()}"]
        try:
            done = subprocess.run(
                [*command, page.resolve().as_uri()],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=LONGEST,
            )
        except subprocess.TimeoutExpired:
            raise PrintError(f"{pdf}: {program} did not end within {LONGEST:g} s; start again.") from None
    if done.returncode != 0 or not _is_pdf(part):
        said = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        part.unlink(missing_ok=True)
        raise PrintError(f"{pdf}: {program} wrote no PDF, exit code {done.returncode}, its last line: {said}")
    os.replace(part, pdf)


def _is_pdf(path: Path) -> bool:
    if not path.is_file():
        return False
    with open(path, "rb") as stream:
        return stream.read(len(PDF)) == PDF
