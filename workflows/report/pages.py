"""Where a case tells what its page says: its module `page`."""

from __future__ import annotations

import importlib
from types import ModuleType

from workflows.engine.case import CASES_PACKAGE


def page_of(case: str) -> ModuleType:
    """Return the module of a case's page."""
    return importlib.import_module(f"{CASES_PACKAGE}.{case}.page")
