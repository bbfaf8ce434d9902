"""A pin dragged straight over a flat mesh by LIGGGHTS: dumps, ledger, Archard, displaced mesh, against alpha F L."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import volume_above_plane, write_stl
from bulkwear.postproc.readers.contacts import read_contact_batches
from bulkwear.postproc.wear.laws import worn_volume
from bulkwear.postproc.wear.ledger import LedgerBuilder
from bulkwear.postproc.wear.update import wear_update
from tests import DATA

pytestmark = pytest.mark.solver

DECK = DATA / "sphere_on_plate.in"
LOAD, SPEED, TIME_STEP, STEPS, STRIDE = 5.0, 0.5, 2e-6, 4000, 10  # N, m/s, s, -, -
SETTLED = 4000  # steps before the sampled ones
WEAR_COEFFICIENT = 1e-11  # 1/Pa
EFFECTIVE_MODULUS = 1.0 / ((1 - 0.24**2) / 2.48e8 + (1 - 0.3**2) / 2.028e11)  # Pa, of the deck's materials
DENSITY = 4850.0  # kg/m3, of the deck
ARCHARD_TOLERANCE = 1e-3  # relative; the load oscillates by less once it has settled
SWEPT_TOLERANCE = 1e-9  # relative; the displacement conserves volume to rounding
PLATE = (0.02, 0.04)  # m, width and length; the track of 8 mm lies well inside


def dragged_pin(folder: Path, element_size: float):
    """Run the deck on a plate of that element size; return mesh and ledger."""
    mesh = flat_plate(*PLATE, element_size)
    shutil.copy(DECK, folder)
    write_stl(folder / "plate.stl", mesh.points, mesh.triangles)
    command = ["liggghts", "-in", DECK.name, "-var", "stride", str(STRIDE), "-var", "steps", str(STEPS)]
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    ledger = LedgerBuilder(len(mesh.triangles), 0, EFFECTIVE_MODULUS, DENSITY)
    for batch in read_contact_batches(folder / "contacts.dump", folder / "spins.dump", after_step=SETTLED):
        ledger.add_batch(batch, STRIDE * TIME_STEP)
    return mesh, ledger.table()


@pytest.mark.parametrize("element_size", [2e-3, 1e-3, 0.5e-3])
def test_worn_volume_is_alpha_times_load_times_distance(tmp_path, element_size):
    """Archard (Yan 2022, Eq 3.6): V = alpha F L, whatever the mesh; the displaced mesh has lost exactly that volume."""
    mesh, ledger = dragged_pin(tmp_path, element_size)
    volume = worn_volume("archard", ledger, {"wear_coefficient_per_pa": WEAR_COEFFICIENT})
    distance = SPEED * STEPS * TIME_STEP
    assert volume.sum() == pytest.approx(WEAR_COEFFICIENT * LOAD * distance, rel=ARCHARD_TOLERANCE)

    worn, record = wear_update(mesh, volume, wall=(0.0, 0.0, -1.0))
    lost = -volume_above_plane(worn.points, worn.triangles)  # the plate was flat at z = 0
    assert lost == pytest.approx(volume.sum(), rel=SWEPT_TOLERANCE)
    assert record["applied_volume_m3"] == pytest.approx(volume.sum(), rel=SWEPT_TOLERANCE)


def test_wear_lies_on_the_track(tmp_path):
    """All wear is on triangles under the pin's path, and its mean position moves along the path."""
    _, ledger = dragged_pin(tmp_path, 1e-3)
    loaded = ledger["sliding_work_J"] > 0
    start, end = (SPEED * TIME_STEP * steps for steps in (SETTLED, SETTLED + STEPS))
    assert np.abs(ledger["contact_position_x_m"][loaded]).max() < 1e-6
    along = ledger["contact_position_y_m"][loaded]
    assert start < along.min() and along.max() < end
