"""A drum turns about an axis near its middle; of what is no drum nothing is said."""

from __future__ import annotations

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.bodies import body
from bulkwear.workflows.cases.equipment.drum_checks import OFF_MIDDLE, check_drums
from bulkwear.workflows.config.layers import ConfigError
from tests.support.own_machine_project import machine_study
from tests.support.own_solids import write_ascii
from tests.workflows.cases.equipment.scenes import box, drum, merged

SHELL = drum(radius=0.5, width=0.2, lifters=8, height=0.1, edge=0.05, thickness=0.05)
MOST = OFF_MIDDLE * 0.55  # m, of the shell's outer radius
ALONG_X = SurfaceMesh(SHELL.points[:, [1, 2, 0]], SHELL.triangles)
TURN = {"kind": "rotation", "axis": [0.0, -2.0, 0.0], "speed_rad_per_s": 1.0}


def turning(*point, **changes):
    return {**TURN, "point_m": list(point), **changes}


def checked(*bodies):
    """Bodies (mesh, motion) as parts of a machine."""
    parts = [{"name": f"part_{k}", "file": f"part_{k}.stl", "motion": motion} for k, (_, motion) in enumerate(bodies)]
    return check_drums(parts, [mesh for mesh, _ in bodies])


def message_of(*bodies):
    with pytest.raises(ConfigError) as caught:
        checked(*bodies)
    return str(caught.value)


@pytest.mark.parametrize("direction_deg", [0, 33, 180, 250])
@pytest.mark.parametrize("kind", ["rotation", "turning_surface"])
def test_an_axis_off_the_middle_of_a_drum(kind, direction_deg):
    """By more than half of the way to its outside, in any direction; along the axis a point may lie anywhere."""
    way = np.array([np.cos(np.radians(direction_deg)), 0.0, np.sin(np.radians(direction_deg))])
    for away, along in ((0.98, 0.0), (0.98, 5.0), (0.0, -5.0)):
        assert checked((SHELL, turning(*(away * MOST * way + [0.0, along, 0.0]), kind=kind))) is None
    for away in (1.02, 3.0, 20.0):
        assert "parts.part_0.motion.point_mm is (" in message_of((SHELL, turning(*(away * MOST * way), kind=kind)))


def test_what_is_said_of_it():
    """Key, how far off, what is allowed and where the middle is."""
    placed = SurfaceMesh(SHELL.points + np.array([1.0, 0.0, 0.5]), SHELL.triangles)
    assert message_of((placed, turning(0.0, 0.0, 0.5))) == (
        "parts.part_0.motion.point_mm is (0, 0, 500) mm, 1000 mm off the middle of part_0.stl, allowed is an axis at"
        f" most {1e3 * MOST:.6g} mm off it, as through (1000, 0, 500) mm: a drum turns about its middle."
    )
    assert checked((placed, turning(1.0, 0.0, 0.5))) is None


def test_parts_of_one_motion_are_one_drum():
    """Two halves of a shell: each alone may be a segment that turns about a mill's axis, both together are the mill."""
    side = SHELL.points[SHELL.triangles][:, :, 0].mean(axis=1) > 0.0
    halves = [body(SHELL, side), body(SHELL, ~side)]
    far = turning(2.0, 0.0, 0.0)
    for half in halves:
        assert checked((half, far)) is None
    assert message_of(*((half, far) for half in halves)).startswith("parts.part_0.motion.point_mm is (2000, 0, 0) mm")
    assert checked(*((half, turning(0.0, 0.0, 0.0)) for half in halves)) is None
    assert checked((halves[0], far), (halves[1], None)) is None


@pytest.mark.parametrize(
    ("mesh", "motion"),
    [
        (box((0.1, 0.2, 0.3), 0.05), turning(2.0, 0.0, 0.0)),  # a hammer
        (box((0.9, 0.2, 0.9), 0.1), turning(0.4, 0.0, 0.0)),  # a roll off its middle, as some crush
        (ALONG_X, turning(0.0, 2.0, 0.0, axis=[0.0, 0.3, 1.0])),  # the pot of a centrifuge
        (SHELL, turning(2.0, 0.0, 0.0, stop_s=3.0)),  # what tips
        (SHELL, turning(2.0, 0.0, 0.0, kind="angular_oscillation")),
        (SHELL, None),
    ],
)
def test_what_is_no_drum_turns_about_any_axis(mesh, motion):
    """Solid bodies, what goes round an upright axis, and what turns for a while, or to and fro."""
    assert checked((mesh, motion)) is None


def test_bars_round_a_room_are_no_drum():
    """They leave gaps between them, as the beaters of a rotor do."""
    angles = np.radians(np.arange(0, 360, 30))
    bars = [box((0.05, 0.2, 0.05), 0.05, (0.5 * np.cos(a), 0.0, 0.5 * np.sin(a))) for a in angles]
    points = np.concatenate([bar.points for bar in bars])
    triangles = np.concatenate([bar.triangles + k * len(bars[0].points) for k, bar in enumerate(bars)])
    assert checked((merged(points, triangles), turning(2.0, 0.0, 0.0))) is None


def test_a_machine_with_such_a_drum_is_refused(tmp_path):
    """In the study's own words, with its drawing."""
    motion = {"kind": "rotation", "axis": [0, 1, 0], "speed_rpm": 60, "point_mm": [600, 0, 0]}
    filled = {"fraction": 0.2, "axis": "y", "centre_mm": [0, 0, 0], "radius_mm": 200, "length_mm": 150}
    shell = {"file": "shell.stl", "unit": "mm", "material": "steel", "role": "wears", "edge_mm": 60, "motion": motion}
    others = dict.fromkeys(("liner", "plate", "paddle", "hood"))
    changes = {"inlet": None, "outlets": None, "filling": filled, "sampling": {"patch_mm": 100}}
    (tmp_path / "meshes").mkdir()
    write_ascii(tmp_path / "meshes/shell.stl", {"shell": (1e3 * SHELL.points, SHELL.triangles)})
    with machine_study(tmp_path, parts={**others, "shell": shell}, **changes) as study:
        parameters = study.runs[0].parameters
        with pytest.raises(ConfigError, match=r"^parts\.shell\.motion\.point_mm is \(600, 0, 0\) mm, 600 mm off"):
            study.case.surface_mesh(study.case.surface_sections(parameters))
