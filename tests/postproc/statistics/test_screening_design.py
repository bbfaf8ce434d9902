"""Definitive screening designs: their structure, their tables, and what Table 3.8 is."""

import csv
import itertools
import os
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.factors import Factor
from bulkwear.postproc.statistics.screening_design import coded_design, design_rows, design_text, main, parse_factor
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.validation import read_design
from tests import REPOSITORY
from tests.support.models import coded_table
from tests.support.screening_study import factors_of

COUNTS = range(4, 13)
ROUNDING = 1e-12  # of logarithms of levels that double
LEVELS = 1e-9  # relative, of levels written with ten digits

SIX = (
    "major_radius_mm=2:8:log",
    "minor_radius_mm=2:8:log",
    "column_spacing_mm=20:60",
    "height_mm=1.5:6:log",
    "velocity_m_per_s=0.5:2:log",
    "bed_thickness_mm=10:40:log",
)


def second_order(design):
    """Squares and products of two columns, (runs, k (k + 1) / 2)."""
    pairs = itertools.combinations_with_replacement(range(design.shape[1]), 2)
    return np.column_stack([design[:, i] * design[:, j] for i, j in pairs])


@pytest.fixture
def table_of_yan():
    """Table 3.8 (Yan 2022), coded by its own levels, and its rows."""
    table = pd.read_csv(REPOSITORY / "config/designs/screening.csv")
    return np.round(coded_table(table, factors_of(table, list(table.columns[1:])))).astype(int), table


def check_structure(design):
    """Main effects are orthogonal to each other and to every term of second order; each run has its mirror image."""
    count = design.shape[1]
    squares = np.diag(design.T @ design)
    assert (design.T @ design == np.diag(squares)).all()
    assert (squares == squares[0]).all()
    assert (design.T @ second_order(design) == np.zeros((count, count * (count + 1) // 2))).all()
    assert (design.sum(axis=0) == 0).all()
    runs = sorted(map(tuple, design))
    assert runs == sorted(map(tuple, -design))


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("fake", [0, 1, 2])
def test_structure(count, fake):
    """Orthogonal main effects, fold-over pairs, a centre run, three zeros per column; exact, in whole numbers."""
    design = coded_design(count, fake)
    check_structure(design)
    assert (design[0:-1:2] == -design[1:-1:2]).all()
    assert (design[-1] == 0).all()
    assert ((design == 0).sum(axis=0) == 3).all()
    assert len(design) >= 2 * (count + fake) + 1
    assert set(np.unique(design)) == {-1, 0, 1}


@pytest.mark.parametrize("count", [count for count in COUNTS if count % 2 == 0])
def test_fewest_runs(count):
    """An even number m of factors takes 2 m + 1 runs; an odd one takes those of m + 1, whose spare column is fake."""
    assert len(coded_design(count)) == 2 * count + 1
    assert len(coded_design(count - 1)) == 2 * count + 1


@pytest.mark.parametrize("count", COUNTS)
def test_squares_and_interactions_can_be_told_apart(count):
    """No two terms of second order are aliased: their columns about the mean are nowhere parallel."""
    terms = second_order(coded_design(count)).astype(float)
    correlation = np.corrcoef(terms.T) - np.eye(terms.shape[1])
    assert np.abs(correlation).max() < 1.0 - ROUNDING


def test_centre_runs_are_added():
    """More centre runs leave the pairs as they are."""
    assert (coded_design(6, centres=3)[:13] == coded_design(6)).all()
    assert (coded_design(6, centres=3)[13:] == 0).all()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((2,), "found 2 factors, allowed are 3 or more"),
        ((0,), "found 0 factors, allowed are 3 or more"),
        ((4, -1), "found -1 fake factors, allowed are none or more"),
        ((4, 0, 0), "found 0 centre runs, allowed is one or more"),
    ],
)
def test_impossible_numbers_are_refused(arguments, sentence):
    """What no design has is said in one sentence."""
    with pytest.raises(ValueError, match=sentence):
        coded_design(*arguments)


# --- Table 3.8


def test_table_of_yan_is_such_a_design(table_of_yan):
    """Table 3.8 has the whole structure; its pairs are as noted, its centre is R6, and it has no fake factor."""
    design, table = table_of_yan
    check_structure(design)
    assert len(design) == 2 * design.shape[1] + 1
    names = table["row"].tolist()
    mirrors = {names[i]: names[j] for i in range(13) for j in range(13) if (design[i] == -design[j]).all()}
    pairs = {frozenset(pair) for pair in mirrors.items()}
    expected = ["R1 R11", "R2 R9", "R3 R8", "R4 R5", "R7 R13", "R10 R12", "R6"]
    assert pairs == {frozenset(pair.split()) for pair in expected}


def test_aliasing_of_the_table_of_yan(table_of_yan):
    """Main effects are clear; b d is correlated with other interactions by up to 1/2 in size, no term is lost in
    another, but 13 runs cannot hold all 21 terms of second order: they span 6 dimensions besides the mean.
    """
    design, _ = table_of_yan
    terms = second_order(design).astype(float)
    names = [a + b for a, b in itertools.combinations_with_replacement("abdhvt", 2)]
    correlation = pd.DataFrame(np.corrcoef(terms.T), names, names)
    products = [name for name in names if name[0] != name[1]]
    squares = [name for name in names if name[0] == name[1]]
    others = correlation.loc["bd", [name for name in products if name != "bd"]].abs()
    np.testing.assert_allclose(others.max(), 0.5, atol=ROUNDING)
    between = correlation.loc[squares, squares].to_numpy()[~np.eye(6, dtype=bool)]
    np.testing.assert_allclose(between, 1 / 3 - 1 / 5, atol=ROUNDING)  # 1/3 - 1/(m - 1): Jones and Nachtsheim 2011
    assert np.linalg.matrix_rank(terms - terms.mean(axis=0)) == 6


def test_the_generated_design_is_like_the_table_of_yan(table_of_yan):
    """For its six factors the generator gives runs, levels and correlations in size as Table 3.8 has them."""
    design, table = table_of_yan
    rows = pd.read_csv(pd.io.common.StringIO(design_text(design_rows([parse_factor(text) for text in SIX], fake=0))))
    assert list(rows.columns) == list(table.columns)
    for column in table.columns[1:]:
        np.testing.assert_allclose(np.unique(rows[column]), np.unique(table[column]), rtol=LEVELS)
    ours, theirs = (np.sort(np.abs(np.corrcoef(second_order(each).T)), None) for each in (coded_design(6), design))
    np.testing.assert_allclose(ours, theirs, atol=ROUNDING)


# --- tables


def test_a_new_design_has_two_fake_factors():
    """Unless it is asked for fewer runs, a table has those of two columns more, which it leaves out."""
    factors = [Factor(name, 0.0, 1.0) for name in "abcdef"]
    assert len(design_rows(factors)) == len(coded_design(6)) + 4 == 17
    assert len(design_rows(factors, fake=0)) == 13
    assert list(design_rows(factors)[0]) == ["row", *"abcdef"]


def test_table_passes_the_checks_of_a_study(tmp_path):
    """What the command writes is read as a study reads a design of its own."""
    path = tmp_path / "mine.csv"
    words = [word for text in SIX[:5] for word in ("--factor", text)]
    assert main([*words, "--constant", "bed_thickness_mm=40", "--fake", "0", "--output", str(path)]) == 0
    rows = read_design(path, tmp_path, load_schema("cases/sliding_sample/design"))
    assert len(rows) == 13
    assert {row.values["bed_thickness_mm"] for row in rows} == {40.0}
    assert rows[-1].values == {
        "row": "R13",
        "major_radius_mm": 4.0,
        "minor_radius_mm": 4.0,
        "column_spacing_mm": 40.0,
        "height_mm": 3.0,
        "velocity_m_per_s": 1.0,
        "bed_thickness_mm": 40.0,
    }


def test_coded_levels_can_be_written():
    """Coded, a table holds -1, 0 and 1 only."""
    rows = design_rows([Factor(name, 2.0, 8.0, "log") for name in "abcde"], coded=True)
    assert {row["c"] for row in rows} == {"-1", "0", "1"}


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--factor", "a=1"], "--factor: found 'a=1', allowed is NAME=LOW:HIGH or NAME=LOW:HIGH:log."),
        (["--factor", "a=1:x"], "--factor: found 'x' in 'a=1:x', allowed are numbers."),
        (["--factor", "a=2:1"], "factor a: found 2 to 1, allowed is a low below a high."),
        (["--factor", "a=0:1:log"], "factor a: found the low 0, allowed with log is above 0."),
        (["--factor", "a=0:1"], "found 1 factors, allowed are 3 or more."),
        (["--factor", "a=0:1"] * 3, "column a comes twice, allowed is each column once."),
        (["--factor", "row=0:1"], "column row comes twice, allowed is each column once."),
        (["--factor", "a=0:1", "--constant", "b"], "--constant: found 'b', allowed is NAME=VALUE."),
    ],
)
def test_faults_are_one_sentence(words, sentence, capsys):
    """A fault of the command line is one sentence on stderr, and nothing is written."""
    assert main(words) == 1
    streams = capsys.readouterr()
    assert (streams.out, streams.err) == ("", sentence + "\n")


def test_a_file_is_never_overwritten(tmp_path, capsys):
    """A table that is there stays as it is."""
    path = tmp_path / "mine.csv"
    path.write_text("precious")
    words = [word for text in SIX for word in ("--factor", text)]
    assert main([*words, "--output", str(path)]) == 1
    assert path.read_text() == "precious"
    assert capsys.readouterr().err == f"--output: {path} cannot be written (File exists).\n"


def test_command_prints_a_table():
    """Without --output the table goes to stdout, with two fake factors, and nothing else does."""
    words = [word for text in SIX for word in ("--factor", text)]
    command = [sys.executable, "-m", "bulkwear.postproc.statistics.screening_design", *words]
    done = subprocess.run(command, cwd=REPOSITORY, env=dict(os.environ), capture_output=True, text=True, check=True)
    assert len(list(csv.DictReader(done.stdout.splitlines()))) == 17
    assert done.stderr == ""
