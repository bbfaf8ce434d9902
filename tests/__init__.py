"""Tests of everything in the repository; they mirror its folders."""

from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
DATA = REPOSITORY / "tests" / "data"  # real files of the solver, and decks as they should be
PUBLISHED = REPOSITORY / "config" / "published"  # what the source and others printed
