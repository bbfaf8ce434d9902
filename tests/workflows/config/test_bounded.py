"""Hostile files: each costs a sentence that names it, no traceback, no hang, and nothing of what stands in it."""

import os
import time

import pytest

from bulkwear.workflows.config.bounded import DEEPEST, LARGEST_YAML, MOST_VALUES
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError, read_csv_rows, read_yaml

SECRET = "root:x:0:0:secret"
SECONDS = 30.0  # far more than any bound needs, far less than any bomb


def bomb(levels: int = 12, width: int = 9) -> str:
    """YAML of a few hundred letters whose values are width to the power of levels."""
    lines = ["a0: &a0 [x]", *(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * width)}]" for k in range(1, levels))]
    return "\n".join(lines)


HOSTILE = {
    "a NUL byte": ("title: a\0b", "line 1: there is a NUL byte"),
    "deep nesting": ("a: " + "[" * 10_000, f"allowed are {DEEPEST}"),
    "deep blocks": ("\n".join(" " * k + "a:" for k in range(100)), f"allowed are {DEEPEST}"),
    "a bomb of aliases": (bomb(), f"more than {MOST_VALUES} values"),
    "a block in itself": ("a: &a {b: *a}", r"\*a refers to the block that it stands in"),
    "a huge integer": ("a: " + "9" * 10_000, "a number of 10000 letters"),
    "a tag of Python": ("a: !!python/object/apply:os.system [ls]", "there is a tag"),
    "a tag of YAML": ("a: !!binary aGVsbG8=", "there is a tag"),
    "many keys": ("\n".join(f"k{n}: 1" for n in range(MOST_VALUES)), f"more than {MOST_VALUES} values"),
    "half a letter": (r'a: "\ud800"', "half a letter"),
    "a key with a space of a web page": ("pack\u00a0ings: 1", "in which a letter does not print"),
    "a long key": (f"? {'k' * 10_000}\n: 1", "a key of 10000 letters"),
    "a block as key": ("? [a]\n: b", "a block as a key"),
    "no YAML": ("a: [", "allowed is valid YAML"),
    "a list": (f"- {SECRET}", "found a list"),
    "one value": (SECRET, "found one value"),
    "too large a file": ("a: " + "x" * LARGEST_YAML, f"allowed are at most {LARGEST_YAML}"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_yaml_is_a_sentence(tmp_path, name):
    """At once, with the file's name, and without its contents."""
    text, said = HOSTILE[name]
    path = tmp_path / "study.yaml"
    path.write_text(text)
    started = time.monotonic()
    with pytest.raises(ConfigError, match=said) as fault:
        read_yaml(path, tmp_path)
    assert time.monotonic() - started < SECONDS
    assert str(fault.value).startswith("study.yaml") and SECRET not in str(fault.value)


def test_what_is_no_file_is_a_sentence(tmp_path):
    """Folders, devices, pipes and what may not be read."""
    os.mkfifo(tmp_path / "pipe")
    for path, said in ((tmp_path, "it is a folder"), (tmp_path / "pipe", "device or pipe"), ("/dev/zero", "device")):
        with pytest.raises(ConfigError, match=said):
            read_yaml(type(tmp_path)(path), tmp_path)


def test_references_within_the_bounds_are_read(tmp_path):
    """An anchor and what refers to it, as people use them."""
    path = tmp_path / "study.yaml"
    path.write_text("a: &a {b: 1}\nc: *a\nd: [*a, *a]\n")
    assert read_yaml(path, tmp_path).values == {"a": {"b": 1}, "c": {"b": 1}, "d": [{"b": 1}, {"b": 1}]}


@pytest.mark.parametrize(
    "text, said",
    [
        ('row,a\n"R\n9",1\n', r"line 3: found 'R\\n9', a cell of 3 letters"),
        ("row,a\nR\x079,1\n", "line 2: found"),
        (f"row,a\n{'R' * 5000},1\n", "a cell of 5000 letters"),
        (f"row,a\n{'R' * 200_000},1\n", "field larger than field limit"),
        ("row,a\nR9,\0\n", "line 2: there is a NUL byte"),
    ],
)
def test_hostile_tables_are_a_sentence(tmp_path, text, said):
    """A line break in a name does not disappear, it is refused; so is what no cell needs."""
    path = tmp_path / "design.csv"
    path.write_text(text)
    with pytest.raises(ConfigError, match=said):
        read_csv_rows(path, tmp_path)


def test_lines_may_end_as_on_other_systems(tmp_path):
    """CR LF, and a byte order mark, are no part of the values."""
    path = tmp_path / "design.csv"
    path.write_bytes(b"\xef\xbb\xbfrow,a\r\nR1,2\r\n")
    assert read_csv_rows(path, tmp_path) == (["row", "a"], [(2, {"row": "R1", "a": "2"})])


@pytest.mark.parametrize("name", ["/etc/passwd", "..", "materials", "", "a\\0.yaml", f"{300 * 'a'}.yaml"])
def test_materials_are_a_yaml_file(config, name):
    """No other file of the machine is opened as materials."""
    config.edit("studies/small.yaml", "design: small.csv", f'design: small.csv\nmaterials: "{name}"')
    with pytest.raises(ConfigError, match=r"small\.yaml, line \d: (materials is|there is|it cannot)|a.*yaml") as fault:
        load_study("small", project=config.project)
    assert "root:" not in str(fault.value)


def test_a_bad_study_does_not_stop_another(config):
    """Only the study that is asked for is read."""
    config.write("studies/bad.yaml", bomb())
    assert load_study("small", project=config.project).runs
    with pytest.raises(ConfigError, match=r"bad\.yaml"):
        load_study("bad", project=config.project)
