"""Room in the solver's lists of neighbours: as much as spheres and triangles round a particle need, at least."""

import math

import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.workflows.cases.pin_on_disc.decks import SKIN_OVER_RADIUS
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.neighbour_lists import LEAST_LIST, LEAST_PAGE, finest_element, list_sizes
from tests.verification.ledger_cases import FRAME, PIN_MOTION, RADIUS, pin, run, write_case

SKIN = 1e-3  # m, of the frame deck
LEAST = {"most_neighbours": LEAST_LIST, "neighbours_of_page": LEAST_PAGE}
FINE = 4e-5  # m, a hundredth of pin and skin together


def of_diameters(*diameters):
    return {"diameters_m": list(diameters)}


@pytest.mark.parametrize("study", ["screening", "circular_tester", "chute", "pin_on_disc"])
def test_studies_have_the_least(study):
    """At their finest, too, what their decks had before sizes counted: nothing is simulated again."""
    parameters = load_study(study, overrides={"fidelity": "paper"}).runs[0].parameters
    skin = SKIN_OVER_RADIUS * 0.5 * max(parameters["particle"]["diameters_m"])  # the pin's; the others are small
    assert list_sizes(parameters, parameters["particle"], skin) == LEAST


def test_dust_round_a_boulder_has_room():
    """Spheres of a fiftieth, packed as densely as equal ones can be round the largest, fit, and a page holds ten."""
    found = list_sizes({}, of_diameters(1.0, 0.02), 0.0)
    round_it = math.pi / math.sqrt(18.0) * (0.52**3 - 0.5**3) / 0.01**3
    assert found["most_neighbours"] > round_it
    assert list_sizes({}, of_diameters(1.0, 0.002), 0.0)["most_neighbours"] > 50 * LEAST_LIST
    assert found["neighbours_of_page"] >= 10 * found["most_neighbours"]


def test_the_finest_mesh_counts():
    """Of a sample, a disc or parts; a bulk test has none."""
    assert finest_element({"sample": {"element_size_m": 2e-3}, "parts": [{"edge_m": 1e-3}, {"edge_m": 5e-3}]}) == 1e-3
    assert finest_element({"disc": {"element_size_m": 1e-4}, "sample": None}) == 1e-4
    assert finest_element({}) == math.inf and list_sizes({}, of_diameters(0.01), 0.0) == LEAST


@pytest.mark.solver
@pytest.mark.parametrize("fits", [False, True])
def test_the_solver_has_room_for_fine_triangles(tmp_path, fits):
    """A pin on elements so fine that it ends with the least room, which it says, goes on with what is computed."""
    mesh = flat_plate(0.005, 0.005, FINE)  # all of it within reach of the pin
    assert len(mesh.triangles) > LEAST_LIST
    write_case(tmp_path, mesh, pin(1.3e-4, 0.7e-4), PIN_MOTION, steps=2)
    found = list_sizes({"sample": {"element_size_m": FINE}}, of_diameters(2.0 * RADIUS), SKIN) if fits else LEAST
    told = f"one {found['most_neighbours']} page {found['neighbours_of_page']}"
    text = FRAME.read_text()
    assert text.count("one 20000 page 1000000") == 1
    (tmp_path / FRAME.name).write_text(text.replace("one 20000 page 1000000", told))
    if fits:
        assert "Loop time" in run(tmp_path)
    else:
        with pytest.raises(RuntimeError, match="overflow"):
            run(tmp_path)
