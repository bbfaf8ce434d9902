"""The command that compares a scan: from a file to tables and figures, and what it refuses."""

import json

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, write_surface
from bulkwear.postproc.scans.start import IDENTITY, RigidMotion, largest_distance
from bulkwear.workflows.report.scans import main, named_surfaces
from tests.support import scanned_sample as sample

POSITION = 20e-6  # m
BOX = ["--box", "-2000", "2000", "-2000", "2000", "-2000", "2000"]  # mm, all of the scan


@pytest.fixture(scope="module", autouse=True)
def registered_again():
    """The same scan is registered with and without its leading edge."""
    with sample.rough_positions_once():
        yield


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Folder with pristine.vtu, worn.vtu and scan.xyz in mm; the motion of the scan is 4."""
    folder = tmp_path_factory.mktemp("scan")
    pristine = sample.pristine_sample()
    worn = sample.worn_sample(pristine)
    write_surface(folder / "pristine.vtu", pristine)
    write_surface(folder / "worn.vtu", worn)
    write_surface(folder / "bare.vtu", SurfaceMesh(pristine.points, pristine.triangles))
    scan = 1e3 * sample.scan_of(worn, sample.any_motion(4), 30_000)
    np.savetxt(folder / "scan.xyz", scan, fmt="%.5f")
    return folder


def test_from_file_to_figures(files, tmp_path, capsys):
    """The scan is found, every table and figure is there, and the report tells what it rests on."""
    edge = [f"{value:.1f}" for value in 1e3 * sample.leading_edge(sample.any_motion(4))]
    words = [
        files / "scan.xyz",
        files / "pristine.vtu",
        f"simulated={files / 'worn.vtu'}",
        "--output",
        tmp_path / "out",
    ]
    assert main([str(word) for word in words] + ["--bumps", "C11", "C22", "--leading-edge", *edge, *BOX]) == 0
    found = json.loads((tmp_path / "out" / "registration.json").read_text())
    motion = RigidMotion(np.array(found["rotation"]), np.array(found["translation_m"]))
    assert largest_distance(motion.after(sample.any_motion(4)), IDENTITY, sample.pristine_sample().points) < POSITION
    assert found["scanned_points"] > found["points_on_the_sample"] > 25_000
    volumes = pd.read_csv(tmp_path / "out" / "volumes.csv").set_index("of")
    simulated, measured = volumes.loc["sample", ["simulated_volume_mm3", "measured_volume_mm3"]]
    assert measured == pytest.approx(simulated, rel=0.05)
    assert volumes.loc["C11", "measured_largest_loss_um"] > 200.0
    for name in ("cells.csv", "sections.csv", "depth_maps.png", "bump_sections.png", "bump_losses.png"):
        assert (tmp_path / "out" / name).stat().st_size > 5000
    said = capsys.readouterr()
    assert "laying it on what did not wear" in said.err
    assert "C33" in said.out


@pytest.mark.parametrize(
    ("scan", "pristine", "more", "words"),
    [
        ("scan.xyz", "pristine.vtu", [], "the leading edge"),
        ("none.xyz", "pristine.vtu", [], "no such scan"),
        ("scan.xyz", "none.vtu", [], "no such surface"),
        ("scan.xyz", "bare.vtu", [], "has no label part"),
        ("scan.xyz", "pristine.vtu", ["worn.vtu", "worn.vtu"], "a name that is taken"),
        ("scan.xyz", "pristine.vtu", ["--unit", "m"], "check the unit"),
        ("scan.xyz", "pristine.vtu", ["--box", "0", "1", "0", "1", "1", "0"], "from < to"),
    ],
)
def test_faults_are_one_sentence(files, tmp_path, capsys, scan, pristine, more, words):
    more = [str(files / word) if word.endswith(".vtu") else word for word in more]
    assert main([str(files / scan), str(files / pristine), *more, "--output", str(tmp_path / "out")]) == 1
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert words in last
    assert last.endswith(".")
    assert not (tmp_path / "out").exists()


def test_numbers_that_make_no_sense_are_refused(capsys):
    with pytest.raises(SystemExit):
        main(["scan.ply", "pristine.vtu", "--accuracy", "-1"])
    assert "allowed are numbers above 0" in capsys.readouterr().err


def test_surfaces_have_names():
    assert {name: str(path) for name, path in named_surfaces(["a/worn.vtu", "R9=b/worn.vtu"]).items()} == {
        "worn": "a/worn.vtu",
        "R9": "b/worn.vtu",
    }
    with pytest.raises(ValueError, match="allowed are 4 or fewer"):
        named_surfaces([f"{name}=a.vtu" for name in "abcde"])
