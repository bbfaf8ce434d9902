"""A small study of pins on discs that several test modules read."""

import pytest

from tests.support import pin_study


@pytest.fixture(scope="session")
def pins(tmp_path_factory):
    """Folder, runs, contours and volumes of the small study."""
    folder = pin_study.write_study(tmp_path_factory.mktemp("pins"))
    return folder, *pin_study.tables(folder)


@pytest.fixture(scope="session")
def figures(pins):
    """All its figures, by name; their tables lie in its folder."""
    return pin_study.drawn(pins[0])
