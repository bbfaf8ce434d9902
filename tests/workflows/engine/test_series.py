"""A run's cycles as a series in time, as VTK reads it."""

import pytest
import pyvista

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import write_surface
from bulkwear.workflows.engine.series import SERIES, write_series


def test_cycles_are_times(tmp_path):
    """Each cycle that has a surface is a time; each time gives the surface of its cycle."""
    for cycle in (1, 3):
        folder = tmp_path / f"cycle_{cycle:03d}"
        folder.mkdir()
        write_surface(folder / "surface.vtu", flat_plate(0.01 * cycle, 0.01, 0.005))
    write_series(tmp_path, "surface.vtu", range(1, 4))
    reader = pyvista.PVDReader(tmp_path / SERIES)
    assert list(reader.time_values) == [1.0, 3.0]
    reader.set_active_time_value(3.0)
    bounds = reader.read()[0].bounds
    assert bounds[1] - bounds[0] == pytest.approx(0.03)
