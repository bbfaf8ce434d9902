"""Studies that modules load again and again are loaded once for all tests of a file; nothing changes a loaded one."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

import pytest


@contextmanager
def loaded_once(*modules: ModuleType) -> Iterator[None]:
    """Let modules that load studies of the package by `load_study` remember them by name and overrides."""
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        for module in modules:
            patch.setattr(module, "load_study", _remembering(module.load_study, found))
        yield


def _remembering(load, found):
    def remembered(*given, **named):
        key = repr((given, sorted(named.items())))
        if key not in found:
            found[key] = load(*given, **named)
        return found[key]

    return remembered
