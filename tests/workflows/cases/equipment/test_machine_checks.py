"""Wrong machines that are seen with their drawings, before any solver starts: one sentence each, with part and key."""

from __future__ import annotations

import numpy as np
import pytest

from bulkwear.meshes.drawing import write_step
from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.postproc.mesh import SurfaceMesh, enclosed_volume
from bulkwear.postproc.wear.bodies import body, together
from bulkwear.workflows.cases.equipment.change_out import BY_MASS, REMAINING
from bulkwear.workflows.cases.equipment.machine_checks import (
    check_machine,
    check_units,
    thickness_of,
)
from bulkwear.workflows.cases.equipment.surfaces import label_of, part_surface
from bulkwear.workflows.config.layers import ConfigError
from tests.support.own_machine_project import machine_study
from tests.support.own_solids import box as corners_of_box
from tests.support.own_solids import write_ascii
from tests.workflows.cases.equipment.scenes import box, drum, without_lid

MEASURED = 1e-3  # -, relative; of thickness along normals of facets
DOMAIN = {"low_m": [-0.6, -0.3, -0.5], "high_m": [0.6, 0.3, 0.4]}
SLICE = {"axis": "y", "low_m": -0.05, "high_m": 0.05}
SWING = {"kind": "oscillation", "amplitude_m": [0.0, 0.0, 0.2], "period_s": 1.0}
TURN = {"kind": "rotation", "point_m": [0.0, 0.0, -0.3], "axis": [0.0, 1.0, 0.0], "speed_rad_per_s": 6.0}
TURN_ACROSS = {**TURN, "axis": [1.0, 0.0, 0.0]}
FILLING = {"fraction": 0.2, "axis": "y", "centre_m": [0.0, 0.0, 0.0], "radius_m": 0.3, "length_m": 0.2}
PLATE = box((0.4, 0.1, 0.03), 0.025, (0.0, 0.0, -0.3))


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Parameters of a machine with an inlet of 80 x 80 mm at (-60, 0, 160) mm; particles have 9.6 and 14.4 mm."""
    with machine_study(tmp_path_factory.mktemp("machine")) as study:
        return study.case.surface_sections(study.runs[0].parameters)


def machine(run, *bodies, **sections):
    """Parameters and surface of a machine of some parts, (name, mesh, what is said of it), with other sections."""
    like, parts, meshes = run["parts"][1], [], []
    for number, (name, mesh, given) in enumerate(bodies):
        part = {**like, "name": name, "file": f"{name}.stl", "motion": None, "wears": True, "edge_m": 0.025, **given}
        parts.append({key: value for key, value in part.items() if value is not None or key == "motion"})
        labels = np.full(len(mesh.triangles), label_of(number, parts[-1]))
        meshes.append(SurfaceMesh(mesh.points, mesh.triangles, {"part": labels}))
    return {**run, "parts": parts, **sections}, together(meshes)


def message_of(run, *bodies, **sections) -> str:
    with pytest.raises(ConfigError) as caught:
        check_machine(*machine(run, *bodies, **sections))
    message = str(caught.value)
    assert message.endswith(".") and "\n" not in message and ". " not in message, message
    return message


def turned_round(mesh):
    return SurfaceMesh(mesh.points, mesh.triangles[:, ::-1])


# ---------------------------------------------------------------- units and sizes


@pytest.mark.parametrize(
    ("unit", "scale", "size", "hint"),
    [
        ("m", 1.0, "261.7 m", "in mm it is 261.7 mm"),
        ("m", 12.0, "3141 m", "in mm it is 3.141 m"),
        ("ft", 12.0, "957.3 m", "in mm it is 3.141 m"),
        ("um", 1.0, "0.2617 mm", "in mm it is 261.7 mm"),
        ("mm", 0.01, "2.617 mm", "in m it is 2.617 m"),
    ],
)
def test_a_wrong_unit_is_named_with_the_one_that_makes_sense(tmp_path, unit, scale, size, hint):
    """A chute of 3,000 m, or of 3 mm: its file is read again, whatever its elements would be."""
    with machine_study(tmp_path, parts={"liner": {"unit": unit}}) as study:
        points, triangles = corners_of_box((240.0, 100.0, 30.0))
        write_ascii(tmp_path / "meshes/liner.stl", {"liner": (points * scale, triangles)})
        parameters = study.runs[0].parameters
        with pytest.raises(ConfigError) as caught:
            study.case.surface_mesh(study.case.surface_sections(parameters))
    assert str(caught.value) == (
        f"parts.liner.unit is {unit}, in which liner.stl is {size} large, allowed are 12 mm, a median particle as"
        f" coarse-grained, to 200 m: {hint}."
    )


@pytest.mark.verify
def test_a_chute_of_three_kilometres_as_step(tmp_path):
    """A CAD file says its unit itself; drawn in thousandths of it, it is too large before anything is meshed."""
    (tmp_path / "meshes").mkdir()
    with gmsh_model() as gmsh:
        body = gmsh.model.occ.addBox(0, 0, 0, 3e6, 1e5, 3e4)
        write_step(gmsh, tmp_path / "meshes/liner.step", {body: "liner"})
    with machine_study(tmp_path, parts={"liner": {"file": "liner.step"}}) as study:
        run = study.runs[0].parameters
        for look in (study.case.check_files, lambda runs: study.case.surface_mesh(study.case.surface_sections(run))):
            with pytest.raises(ConfigError, match=r"^parts\.liner\.unit is mm, in which liner\.step is 3002 m large"):
                look(study.runs)


def test_a_part_that_no_unit_makes_sense_of(run):
    """A dot: the sentence says so."""
    dot = box((1e-7, 1e-7, 1e-7), 1e-7)
    assert message_of(run, ("dot", dot, {})).endswith("to 200 m: no unit makes sense of it.")


def test_other_faults_of_a_drawing_are_told_as_they_are(tmp_path, run):
    """A file that cannot be read, or is not there, is no matter of units; nor is a machine of the right ones."""
    with machine_study(tmp_path) as study:
        parameters = study.runs[0].parameters
        check_units(parameters)
        (tmp_path / "meshes/liner.stl").write_text("solid nothing\nendsolid\n")
        (tmp_path / "meshes/plate.stl").unlink()
        check_units(parameters)
        (tmp_path / "meshes/hood.stl").rename(tmp_path / "meshes/hood.sldprt")
        renamed = [{**part, "file": "hood.sldprt"} if part["name"] == "hood" else part for part in parameters["parts"]]
        check_units({**parameters, "parts": renamed})
        with pytest.raises(ConfigError, match=r"^parts\.liner: .*liner\.stl") as caught:
            study.case.surface_mesh(study.case.surface_sections(parameters))
    assert ".unit is" not in str(caught.value)


def test_a_machine_of_the_right_size_passes(tmp_path):
    """The tiny machine of these tests, with its drawings."""
    with machine_study(tmp_path) as study:
        parameters = study.runs[0].parameters
        surface = study.case.surface_mesh(study.case.surface_sections(parameters))
    assert len(np.unique(surface.cell_data["part"])) == 4


def test_a_body_that_two_parts_have_is_refused(run):
    """By whatever file, alone or among others; not one that moves another way, and no liner on its wall, which may
    be a sheet of the liner's outline.
    """
    finer, wall = box((0.4, 0.1, 0.03), 0.02, (0.0, 0.0, -0.3)), box((0.4, 0.1, 0.03), 0.025, (0.0, 0.0, -0.33))
    for other in (finer, together([finer, box((0.1, 0.1, 0.03), 0.025, (0.45, 0.0, -0.3))])):
        said = message_of(run, ("liner", PLATE, {}), ("assembly", other, {}))
        assert said.startswith(
            "parts.assembly.file is assembly.stl, of which a body lies where parts.liner (liner.stl)"
        )
    check_machine(*machine(run, ("liner", PLATE, {}), ("wall", wall, {})))
    back = body(PLATE, (PLATE.points[PLATE.triangles][:, :, 2] < -0.315 + 1e-9).all(axis=1))
    for sheet in (back, turned_round(back)):
        check_machine(*machine(run, ("liner", PLATE, {}), ("wall", sheet, {"wears": False})))
        check_machine(*machine(run, ("wall", sheet, {"wears": False}), ("liner", PLATE, {})))
    message_of(run, ("wall", back, {"wears": False}), ("sheet", turned_round(back), {"wears": False}))
    check_machine(*machine(run, ("liner", PLATE, {}), ("assembly", finer, {"motion": TURN})))


def test_room_that_takes_too_many_cells(run):
    """A part 150 m away, as one in cm among others in mm may be: the largest part is named, or the domain."""
    far = ("far", box((120.0, 50.0, 120.0), 40.0), {"edge_m": 40.0})
    message = message_of(run, ("plate", PLATE, {}), far)
    assert message.startswith("parts: what is simulated is 121 x 50.7 x 121 m") and "allowed are 2.1e+09" in message
    assert "(parts.far needs the most room, 176.9 m), an outlet or domain is too large, or particle_scale" in message
    wide = {"low_m": [-50.0, -50.0, -50.0], "high_m": [50.0, 50.0, 50.0]}
    assert message_of(run, ("plate", PLATE, {}), domain=wide).startswith(
        "domain: what is simulated is 100 x 100 x 100 m"
    )


# ---------------------------------------------------------------- domain and slice


def test_a_part_outside_the_domain(run):
    """How far it stands out, along which axis, and where the domain ends."""
    beside = box((0.4, 0.1, 0.03), 0.025, (0.5, 0.0, -0.3))
    assert message_of(run, ("plate", beside, {}), domain=DOMAIN) == (
        "parts.plate.file: plate.stl stands out by 100 mm along x, from 300 mm to 700 mm, allowed is -600 mm to 600 mm,"
        " domain.low_mm and domain.high_mm: make room for it."
    )
    check_machine(*machine(run, ("plate", PLATE, {}), domain=DOMAIN))


def test_a_part_that_leaves_the_domain_on_its_way(run):
    """Where it is at any time counts, not where it was drawn."""
    far = {"motion": {"kind": "translation", "velocity_m_per_s": [1.0, 0.0, 0.0]}}
    message = message_of(run, ("plate", PLATE, far), domain=DOMAIN)
    assert "plate.stl stands out by" in message and "along x on its way, from -200 mm to" in message


def test_a_part_that_leaves_the_machine(run):
    """By a motion that goes on: how far it is then from all else; one that stops, or swings, may stay."""
    floor = box((1.0, 0.2, 0.03), 0.05, (0.0, 0.0, -0.4))
    on = {"kind": "translation", "velocity_m_per_s": [2.0, 0.0, 0.0]}
    message = message_of(run, ("flight", PLATE, {"motion": on}), ("floor", floor, {}))
    assert message.startswith("parts.flight.motion.velocity_m_per_s takes flight.stl out of the machine, ")
    assert "away from all else after" in message and "or the run be shorter" in message
    check_machine(*machine(run, ("flight", PLATE, {"motion": {**on, "stop_s": 0.1}}), ("floor", floor, {})))
    check_machine(*machine(run, ("flight", PLATE, {"motion": SWING}), ("floor", floor, {})))


def test_a_part_that_goes_through_particles(run):
    """In a time step of 0.12 ms a part goes no farther than half of the smallest radius of 4.8 mm, 19.5 m/s."""
    step = run["derived"]["time_step_s"]
    slow, fast = (
        {"kind": "translation", "velocity_m_per_s": [0.0, 0.0, -factor * 0.0024 / step], "stop_s": 0.001}
        for factor in (0.99, 1.01)
    )
    check_machine(*machine(run, ("plate", PLATE, {"motion": slow})))
    message = message_of(run, ("plate", PLATE, {"motion": fast}))
    assert message.startswith("parts.plate.motion takes plate.stl 2.424 mm far in a time step, at 19.")
    assert "allowed are 2.4 mm, 0.5 of the smallest radius" in message


def test_a_part_that_stands_out_of_the_slice(run):
    """Its ends may lie on those of the slice; beyond them the drawing has to be cut, or the part turns out of it."""
    periodic, wide = {"periodic": SLICE, "inlet": None}, box((0.4, 0.12, 0.03), 0.025, (0.0, 0.0, -0.3))
    filling = {"filling": {**FILLING, "radius_m": 0.1, "length_m": 0.1}}
    check_machine(*machine(run, ("plate", PLATE, {}), **periodic, **filling))
    assert message_of(run, ("plate", wide, {}), **periodic, **filling) == (
        "parts.plate.file: plate.stl stands out by 10 mm along y, from -60 mm to 60 mm, allowed is -50 mm to 50 mm,"
        " periodic.low_mm and periodic.high_mm: cut the drawing there."
    )
    check_machine(*machine(run, ("plate", PLATE, {"motion": TURN}), **periodic, **filling))
    message = message_of(run, ("plate", PLATE, {"motion": TURN_ACROSS}), **periodic, **filling)
    assert "along y on its way" in message and message.endswith("periodic.high_mm: make room for it.")


# ---------------------------------------------------------------- inlet


def test_a_feed_that_goes_through_particles_in_a_time_step(run):
    """Half of the smallest radius is the most that it goes."""
    most = 0.5 * 0.5 * min(run["particle"]["diameters_m"]) / run["derived"]["time_step_s"]
    inlet = {**run["inlet"], "velocity_m_per_s": [0.0, 0.0, -1.001 * most]}
    message = message_of(run, ("plate", PLATE, {}), inlet=inlet)
    assert message.startswith(f"inlet.velocity_m_per_s is {1.001 * most:.4g} m/s fast, ")
    assert f"allowed are {most:.4g} m/s" in message


def test_a_part_in_the_room_behind_the_inlet(run):
    """Where it reaches into it; walls that touch the inlet's rim, and a part before it, are no fault."""
    lid = box((0.2, 0.2, 0.03), 0.025, (-0.06, 0.0, 0.2))
    message = message_of(run, ("plate", PLATE, {}), ("lid", lid, {}))
    assert message.startswith(
        "inlet.centre_mm is (-60, 0, 160) mm, allowed is a place where the room of 80 x 80 x 43.2 mm behind the inlet,"
        " in which particles are placed, is free: parts.lid reaches into it at ("
    )
    walls = [
        (f"wall_{k}", box((0.03, 0.08, 0.3), 0.025, (-0.06 + side, 0.0, 0.16)), {})
        for k, side in enumerate((-0.055, 0.055))
    ]
    under = ("under", box((0.2, 0.2, 0.03), 0.025, (-0.06, 0.0, 0.14)), {})
    over = ("over", box((0.2, 0.2, 0.03), 0.025, (-0.06, 0.0, 0.22)), {})
    check_machine(*machine(run, *walls, under, over))


def test_a_part_that_comes_into_the_room_behind_the_inlet(run):
    """At a later time, which is told."""
    below = box((0.1, 0.1, 0.03), 0.025, (-0.06, 0.0, 0.0))
    message = message_of(run, ("plate", below, {"motion": SWING}))
    assert "parts.plate reaches into it at (" in message and message.endswith(" s.")
    check_machine(*machine(run, ("plate", below, {})))


def test_an_inlet_within_a_body_is_refused_however_its_facets_look(run):
    """A body drawn as the room for the material, or an inlet in solid steel; an open tray or a hollow body is none."""
    size, centre = (0.5, 0.5, 0.5), (-0.06, 0.0, 0.16)
    block = box(size, 0.1, centre)
    for each in (block, turned_round(block)):
        assert message_of(run, ("block", each, {"edge_m": 0.1})) == (
            "inlet.centre_mm is (-60, 0, 160) mm, within the closed body parts.block, allowed is an inlet in the room"
            " where material flows: if block.stl is that room, draw the walls round it in its place."
        )
    check_machine(*machine(run, ("tray", without_lid(size, 0.1, centre), {"edge_m": 0.1, "thickness_m": 0.1})))
    inner = turned_round(box((0.3, 0.3, 0.3), 0.1, centre))
    hollow = together([block, inner])
    check_machine(*machine(run, ("hollow", hollow, {"edge_m": 0.1, "wears": False})))


def test_facets_of_a_closed_body_that_look_inward_are_turned_when_it_is_read(tmp_path, capsys):
    """An inside-out file gives the surface of the right one, and its owner is told."""
    with machine_study(tmp_path) as study:
        part = study.runs[0].parameters["parts"][0]
        points, triangles = corners_of_box((240.0, 100.0, 30.0))
        volumes, said = [], []
        for each in (triangles, triangles[:, ::-1]):
            write_ascii(tmp_path / "meshes/liner.stl", {"liner": (points, each)})
            found = part_surface(0, part, tmp_path, own_mesh)
            volumes.append(enclosed_volume(found.points, found.triangles))
            said.append(capsys.readouterr().err)
    assert said[0] == "" and said[1].startswith(
        "parts.liner: liner.stl, liner: facets turned round, 12 times, the first"
    )
    assert volumes == pytest.approx([0.24 * 0.1 * 0.03] * 2)


# ---------------------------------------------------------------- filling


def test_a_filling_in_a_drum(run):
    """Free within the drum's lifters; in a larger cylinder they are told with their distance from the axis."""
    shell = drum(radius=0.5, width=0.2, lifters=8, height=0.1, edge=0.025, thickness=0.05)
    fed = {"inlet": None, "outlets": None}
    bodies = (("shell", shell, {"wears": False}),)
    check_machine(*machine(run, *bodies, **fed, filling={**FILLING, "radius_m": 0.4}))
    message = message_of(run, *bodies, **fed, filling={**FILLING, "radius_m": 0.45})
    assert message.startswith("filling.radius_mm is 450, allowed is a cylinder that is free at the start: parts.shell")
    away = float(message.split(" mm from its axis")[0].split(" ")[-1])
    assert 399.0 < away < 450.0  # crests at 400 mm, their chords a little less


def test_a_filling_within_a_body(run):
    """A drum that is drawn as the room in it."""
    room = box((0.9, 0.4, 0.9), 0.1)
    message = message_of(run, ("drum", room, {"edge_m": 0.1}), inlet=None, outlets=None, filling=FILLING)
    assert message.startswith(
        "filling.centre_mm is (0, 0, 0) mm, within the closed body parts.drum, allowed is a filling"
    )


def test_a_filling_out_of_what_is_simulated(run):
    """The solver would stop: the room round the parts ends before the cylinder does."""
    message = message_of(run, ("plate", PLATE, {}), inlet=None, outlets=None, filling={**FILLING, "length_m": 1.2})
    assert "from where the cylinder stands out of what is simulated by" in message and "along y" in message


# ---------------------------------------------------------------- liners


def test_a_drawn_liner_that_is_thinner_than_its_elements(run):
    """Measured along its normals; not of parts that keep their shape, nor where the thickness is given."""
    thin = box((0.4, 0.2, 0.01), 0.025, (0.0, 0.0, -0.3))
    assert message_of(run, ("liner", thin, {})) == (
        "parts.liner.edge_mm is 25, allowed is at most 10 mm, the thickness in liner.stl: a liner that is thinner than"
        " an element would be worn through in a few updates."
    )
    check_machine(*machine(run, ("liner", thin, {"wears": False})))
    check_machine(*machine(run, ("liner", thin, {"thickness_m": 0.03})))
    check_machine(*machine(run, ("liner", thin, {"edge_m": 0.01})))
    check_machine(*machine(run, ("liner", thin, {"edge_m": 0.0105})))  # a leaning one is measured thinner than drawn


def test_a_drawn_liner_of_which_more_shall_remain_than_there_is(run):
    """As much as there is, too; not of parts that keep their shape, nor where the thickness is given."""
    thick = box((0.4, 0.2, 0.04), 0.025, (0.0, 0.0, -0.3))
    for remaining in (0.0397, 0.04, 0.05):
        told = message_of(run, ("liner", thick, {}), change_out_remaining_m=remaining)
        assert told == (
            f"operation.change_out_remaining_mm is {1e3 * remaining:g}, allowed is at most 39.6 mm: of 40 mm, the"
            " thickness in liner.stl, of parts.liner, a hundredth at least is there to wear."
        )
    own = message_of(run, ("liner", thick, {REMAINING: 0.05}), change_out_remaining_m=0.01)
    assert own.startswith("parts.liner.change_out_remaining_mm is 50, allowed is at most 39.6 mm")
    check_machine(*machine(run, ("liner", thick, {REMAINING: 0.01}), change_out_remaining_m=0.05))
    check_machine(*machine(run, ("liner", thick, {}), change_out_remaining_m=0.039))
    check_machine(*machine(run, ("liner", thick, {"wears": False}), change_out_remaining_m=0.05))
    check_machine(*machine(run, ("liner", thick, {"thickness_m": 0.06}), change_out_remaining_m=0.05))


def test_a_liner_without_a_mass_is_not_changed_by_it(run):
    """An open body has none; one that is open at the ends of a slice has that of the slice."""
    open_box = without_lid((0.4, 0.1, 0.03), 0.025, (0.0, 0.0, -0.3))
    message = message_of(run, ("tray", open_box, {}), **{BY_MASS: True})
    assert message.startswith("operation.change_out_worn_mass_fraction is given, and parts.tray has no mass")
    own = message_of(run, ("tray", open_box, {BY_MASS: True}))
    assert own.startswith("parts.tray.change_out_worn_mass_fraction is given, and parts.tray has no mass")
    by_thickness = {"thickness_m": 0.03, REMAINING: 0.0}
    check_machine(*machine(run, ("tray", open_box, by_thickness), **{BY_MASS: True}))
    check_machine(*machine(run, ("tray", open_box, {"thickness_m": 0.03})))
    ends = np.abs(PLATE.points[PLATE.triangles][:, :, 1]).min(axis=1) > SLICE["high_m"] - 1e-9
    sliced = SurfaceMesh(PLATE.points, PLATE.triangles[~ends])
    check_machine(*machine(run, ("tray", sliced, {}), periodic=SLICE, **{BY_MASS: True}))


def test_a_thickness_that_no_part_of_that_size_has(run):
    """A plate with a diagonal of 413 mm is not 414 mm thick, nor a closed one of 30 mm ten times as thick."""
    tray = without_lid((0.4, 0.1, 0.03), 0.025, (0.0, 0.0, -0.3))
    message = message_of(run, ("plate", tray, {"thickness_m": 0.414}))
    assert message.startswith("parts.plate.thickness_mm is 414, allowed is at most 413.")
    check_machine(*machine(run, ("plate", tray, {"thickness_m": 0.413})))
    message = message_of(run, ("plate", PLATE, {"thickness_m": 0.3}))
    assert message.startswith("parts.plate.thickness_mm is 300, allowed is at most 120 mm, 4 of the thickness")
    check_machine(*machine(run, ("plate", PLATE, {"thickness_m": 0.12})))


def test_an_open_surface_without_a_thickness(run):
    """It has no back: what a tray has across is not its thickness. One that keeps its shape needs none, nor one that is
    open at the ends of a slice.
    """
    tray = without_lid((0.4, 0.1, 0.03), 0.025, (0.0, 0.0, -0.3))
    message = message_of(run, ("tray", tray, {}))
    assert message.startswith("parts.tray.thickness_mm is missing, allowed is the thickness of the liner: the surface")
    assert "of tray.stl is open, first at (" in message
    for changes in ({"wears": False}, {"thickness_m": 0.03}):
        check_machine(*machine(run, ("tray", tray, changes)))


def test_thickness_is_that_of_half_the_area():
    """Of a plate through its thin side, of a bulky body across; a sheet has no back."""
    assert thickness_of(box((0.4, 0.3, 0.03), 0.03)) == pytest.approx(0.03, rel=MEASURED)
    assert thickness_of(box((0.2, 0.3, 0.4), 0.05)) == pytest.approx(0.3, rel=MEASURED)
    sheet = SurfaceMesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    assert thickness_of(sheet) == np.inf
