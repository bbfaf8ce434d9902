"""The terminal: one line after Ctrl-C, and what follows from jobs that end."""

import logging
import signal

import pytest

from bulkwear.workflows.engine.job import STOPPED
from bulkwear.workflows.engine.terminal import LONGEST_REASON, Terminal


@pytest.fixture
def heard():
    """A logger whose lines are kept, and the terminal that listens to it."""
    lines, said = [], []
    logger = logging.Logger("of a test")
    handler = logging.Handler()
    handler.emit = lambda record: lines.append(record.getMessage())
    logger.addHandler(handler)
    terminal = Terminal(said.append)
    logger.addFilter(terminal)
    return logger, terminal, lines, said


def test_ctrl_c_is_one_line(heard):
    """It says how to go on; the errors of the jobs that it ends are not shown, nor is it itself."""
    logger, terminal, lines, said = heard
    logger.error("before")
    with pytest.raises(KeyboardInterrupt):
        terminal.stop(signal.SIGINT, None)
    logger.error("Error in rule worn_run")
    assert lines == ["before"] and [line.strip() for line in said] == [STOPPED]


def test_what_nothing_handles_is_shown_but_ctrl_c(heard, capsys):
    """A fault of the program keeps its traceback, also after Ctrl-C."""
    _, terminal, _, _ = heard
    with pytest.raises(KeyboardInterrupt):
        terminal.stop(signal.SIGINT, None)
    terminal.unhandled(KeyboardInterrupt, KeyboardInterrupt(), None)
    assert capsys.readouterr().err == ""
    terminal.unhandled(KeyError, KeyError("worn_um"), None)
    assert "worn_um" in capsys.readouterr().err


def test_jobs_that_end_are_told(heard):
    """Each once, until Ctrl-C."""
    logger, terminal, lines, _ = heard
    ended = []
    terminal.on_finished = ended.append
    for number in (3, 5):
        logger.info("Finished", extra={"event": "job_finished", "job_id": number})
    logger.info("Started", extra={"event": "job_started", "jobs": [6]})
    assert ended == [3, 5] and len(lines) == 3


def test_a_reason_of_a_hundred_files_is_a_line(heard):
    """It names the first ones and counts the others; a short one is as it was."""
    logger, *_ = heard
    kept = []
    logger.handlers[0].emit = lambda record: kept.append(record.reason)
    files = [f"results/demo/figures/figure_{number:03}.png" for number in range(100)]
    for reason in ("Missing output files: a, b", f"Missing output files: {', '.join(files)}"):
        logger.info("Job", extra={"event": "job_info", "reason": reason})
    assert kept[0] == "Missing output files: a, b"
    shown = kept[1].count(".png")
    assert len(kept[1]) <= LONGEST_REASON + len(" and 100 more") and shown > 1
    assert kept[1].endswith(f"figure_{shown - 1:03}.png and {100 - shown} more")
