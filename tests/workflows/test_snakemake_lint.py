"""One hint of Snakemake's linter is waived, every other one still counts."""

import subprocess

import pytest

from bulkwear.workflows.environment import snakemake_lint

WAIVED_HINT = f"    * {snakemake_lint.WAIVED}:\n      This way, the used software\n      is documented.\n"
OTHER_HINT = "    * No log directive defined:\n      Without a log directive, output goes to the terminal.\n"


def linter(monkeypatch, output, code):
    """Put a linter in place that prints `output` and ends with `code`."""
    done = subprocess.CompletedProcess([], code, stdout="", stderr=output)
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: done)


def test_the_waived_hint_alone_is_no_failure(monkeypatch, capsys):
    """Rules that only lack a conda environment pass."""
    linter(
        monkeypatch,
        f"Lints for rule a (line 1):\n{WAIVED_HINT}\nLints for rule b (line 9):\n{WAIVED_HINT}",
        1,
    )
    assert snakemake_lint.main() == 0
    assert "conda" not in capsys.readouterr().out


@pytest.mark.parametrize("hints", [OTHER_HINT + WAIVED_HINT, WAIVED_HINT + OTHER_HINT])
def test_another_hint_is_a_failure_and_names_its_rule(monkeypatch, capsys, hints):
    """A hint beside the waived one is printed under its rule; rules without one are not."""
    linter(monkeypatch, f"Lints for rule a (line 1):\n{WAIVED_HINT}\nLints for rule b (line 9):\n{hints}", 1)
    assert snakemake_lint.main() == 1
    printed = capsys.readouterr().out
    assert "rule b" in printed and "No log directive" in printed
    assert "rule a" not in printed and "conda" not in printed


def test_a_workflow_that_cannot_be_read_is_a_failure(monkeypatch, capsys):
    """An error before linting is handed through with its code."""
    linter(monkeypatch, "SyntaxError in file Snakefile, line 3", 2)
    assert snakemake_lint.main() == 2
    assert "line 3" in capsys.readouterr().err


def test_a_clean_workflow_passes(monkeypatch):
    """No hint, no failure."""
    linter(monkeypatch, "Congratulations, your workflow is in a good condition!", 0)
    assert snakemake_lint.main() == 0
