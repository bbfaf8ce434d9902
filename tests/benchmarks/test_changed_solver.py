"""A solver of which one function is another than ours: what is changed, and what is refused."""

import pytest

from benchmarks import constant_torque, path_of_centres
from bulkwear.workflows.engine.project import PACKAGE

CHANGES = [constant_torque.CHANGE, path_of_centres.CHANGE]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.program)
def test_one_function_of_the_solver_is_another_and_no_more(change):
    """Its text stands in place of ours; lines before and behind stay."""
    source = (PACKAGE / "solver" / change.changed).read_text()
    changed, text = change.source(source), change.text()
    start = source.index(change.function)
    end = start + source[start:].index("\n}\n")
    assert changed == source[:start] + text[text.index(change.function) :].removesuffix("\n}\n") + source[end:]
    assert changed != source and changed.count(change.function) == 1


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.program)
def test_a_solver_without_that_function_is_refused(change):
    with pytest.raises(ValueError, match=r"found void \w+::.* 0 times, allowed is once"):
        change.source("int main() {\n}\n")
