"""Command lines of benchmarks: what they read, and one sentence where they cannot go on."""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import pandas as pd

from bulkwear.workflows.engine.job import INTERRUPTED, sentence

OURS = ("bulkwear", "benchmarks")  # packages whose errors are sentences for the user


class TableError(ValueError):
    """A table of an earlier run that cannot be read or goes with another benchmark; the message is for the user."""


def command(main: Callable[[], int | None]) -> NoReturn:
    """Do what a command line asks for and end the process: 1 and a sentence on stderr where it cannot go on."""
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("stopped by Ctrl-C", file=sys.stderr)
        sys.exit(INTERRUPTED)
    except Exception as fault:
        if type(fault).__module__.partition(".")[0] not in OURS and not isinstance(fault, OSError | MemoryError):
            raise
        print(_told(fault), file=sys.stderr)
        sys.exit(1)


def _told(fault: Exception) -> str:
    if isinstance(fault, OSError) and fault.filename:
        return f"{fault.filename}: {fault.strerror}, allowed is what can be read and written."
    return sentence(fault)


def at_least_one(text: str) -> int:
    """Return a number of a command line, as of packings. Raises ArgumentTypeError where it is none from 1 on."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"found {text!r}, allowed is a whole number from 1 on")
    return int(text)


def number_within(low: float, high: float, kind: type = float) -> Callable[[str], float]:
    """Return what reads a number from low to high of a command line. It raises ArgumentTypeError where it is none.

    kind: int of whole numbers, else float
    """

    def number(text: str) -> float:
        try:
            found = kind(text)
        except ValueError:
            found = math.nan
        if not low <= found <= high:
            whole = "whole " if kind is int else ""
            raise argparse.ArgumentTypeError(f"found {text!r}, allowed is a {whole}number from {low:g} to {high:g}")
        return found

    return number


def output_folder(text: str) -> Path:
    """Return the folder of a command line that results go into, made unless it is there. Raises ArgumentTypeError."""
    folder = Path(text)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise argparse.ArgumentTypeError(f"{text}: {fault.strerror}, allowed is a folder") from fault
    if not os.access(folder, os.W_OK):
        raise argparse.ArgumentTypeError(f"{text} cannot be written into, allowed is a folder that can")
    return folder


def read_table(file: Path, columns: Sequence[str] = (), numbers: Sequence[str] = (), **how: Any) -> pd.DataFrame:
    """Return the table that an earlier run wrote.

    columns: that it has
    numbers: columns that hold nothing but numbers and gaps, if it has them
    how: for pandas.read_csv

    Raises TableError where it is none, with its line where a number is none.
    """
    if not file.is_file():
        raise TableError(f"{file} is missing, allowed is --redraw where an earlier run has written it.")
    allowed = "allowed is a table that this benchmark wrote"
    try:
        table = pd.read_csv(file, **how)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeDecodeError) as fault:
        raise TableError(f"{file} is no table ({str(fault).strip()}), {allowed}.") from fault
    if missing := [name for name in columns if name not in table]:
        raise TableError(f"{file} has no column {', '.join(missing)}; {allowed}, or another folder as --output.")
    if table.empty:
        raise TableError(f"{file} has no row, {allowed}.")
    for name in table.columns.intersection(numbers):
        if (wrong := pd.to_numeric(table[name], errors="coerce").isna() & table[name].notna()).any():
            line = int(wrong.to_numpy().argmax())
            raise TableError(f"{file}, line {line + 2}: {name} is {table[name][line]!r}, allowed is a number.")
    return table
