"""Beds of clumps: what decks say, what is refused, and a chain on the real solver."""

import re
import subprocess

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.bed import last_snapshot, read_snapshot
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.workflows.cases.sliding_sample.decks import bed_mass, settled_bed
from bulkwear.workflows.cases.sliding_sample.work import single_spheres
from bulkwear.workflows.config.clumps import MOST_SPHERES, find_clump, read_clump
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.layers import read_csv_rows
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.grains import smallest_radius
from bulkwear.workflows.engine.project import enter_project, leave_project
from bulkwear.workflows.engine.solver import OWN_ROLLING_MODELS
from bulkwear.workflows.engine.templates import render
from tests import REPOSITORY
from tests.support.tiny import OF_ANY_MODEL, TINY, tiny_chain, tiny_study

SHIPPED = sorted(path.stem for path in (REPOSITORY / "config" / "clumps").glob("*.csv"))
NO_ROLLING = {"rolling_friction_factor": 0.0}
NO_MODEL = "# No model of rolling friction: clumps have their shape alone.\n"  # in decks
ROUNDING = 1e-9  # relative
TRIES = 0.01  # relative; the solver's own volume and inertia come from 100,000 random points
DUMPED = 4e-7  # m; dumps have six digits of places up to 0.1 m
LOG_NUMBER = r"([-+.\de]+)"


def clumps(shape="pair", **changes):
    """The tiny study with a bed of clumps, and a rolling model that bodies may have."""
    bed = {**TINY["bed"], **NO_ROLLING, "shape": shape, **changes.pop("bed", {})}
    solver = {"rolling_friction": "cdt", **changes.pop("solver", {})}
    return tiny_study(bed=bed, solver=solver, **changes)


def decks_of(study):
    """Text of the decks of bed, lowering and first wear cycle of the first run."""
    run = study.runs[0]
    bed = study.beds[study.bed_of(run.name)]
    return [render("settled_bed", settled_bed(bed)), *study.case.sample_decks(run.parameters, bed)]


# ---------------------------------------------------------------- decks


@pytest.mark.parametrize("shape", SHIPPED)
@pytest.mark.parametrize("ends", ["walls", "periodic"])
def test_decks_move_clumps_as_bodies(shape, ends):
    """A template per size with all its spheres; bodies are integrated as such, and set in motion by an acceleration."""
    study = clumps(shape, bed={"ends": ends, "ahead_mm": 80})
    settled, lowered, wear = decks_of(study)
    header, rows = read_csv_rows(REPOSITORY / "config" / "clumps" / f"{shape}.csv", REPOSITORY)
    assert header == ["x", "y", "z", "radius"]
    templates = re.findall(r"^fix +size_\d all particletemplate/multisphere .*\n(?: .*\n)+", settled, re.MULTILINE)
    assert len(templates) == len(study.runs[0].parameters["particle"]["diameters_m"])
    for number, template in enumerate(templates, start=1):
        assert f"nspheres {len(rows)} " in template and f" type {number} mass " in template
        assert len(re.findall(r"^ +(?:[-.\de]+ ){3}[-.\de]+ &$", template, re.MULTILINE)) == len(rows)
    for text in (settled, lowered, wear):
        assert "nve/sphere" not in text and "erotate/sphere" not in text
        assert len(re.findall(r"^fix +motion +all multisphere", text, re.MULTILINE)) == 1
        assert not re.search(r"\{\{|\}\}|\{%|%\}|\t|\bNone\b|\bnan\b", text)
    assert "velocity all set" not in lowered
    assert '"fix gravity all gravity $(v_velocity/v_time_step) vector 0. 1. 0." "run 1"' in lowered


def test_spheres_decks_know_nothing_of_clumps():
    """A bed of spheres has the decks that it always had."""
    for text in decks_of(tiny_study()):
        assert "multisphere" not in text and "lump" not in text


@pytest.mark.parametrize("shape", SHIPPED)
def test_clumps_weigh_what_spheres_of_their_size_do(shape):
    """Mass of each template: density times the volume of the sphere; the bed's is that of a bed of spheres."""
    settled, sphere = decks_of(clumps(shape))[0], decks_of(tiny_study())[0]
    particle = clumps(shape).runs[0].parameters["particle"]
    masses = [float(found) for found in re.findall(r"type \d mass (\S+)", settled)]
    expected = particle["density_kg_per_m3"] * np.pi / 6.0 * np.array(particle["diameters_m"]) ** 3
    assert masses == pytest.approx(expected, rel=1e-8)
    poured = [re.search(r"poured_mass +equal (\S+)", text).group(1) for text in (settled, sphere)]
    assert poured[0] == poured[1]


@pytest.mark.parametrize("shape", SHIPPED)
def test_time_step_and_cost_are_those_of_the_spheres_of_a_clump(shape):
    """The Rayleigh time grows with the radius; the solver has as many particles as all clumps have spheres."""
    round_, angular = tiny_study().runs[0].parameters, clumps(shape).runs[0].parameters
    ratio = smallest_radius(angular["particle"]) / smallest_radius(round_["particle"])
    assert ratio < 1.0
    steps = [each["derived"]["rayleigh_time_s"] for each in (angular, round_)]
    assert steps[0] / steps[1] == pytest.approx(ratio, rel=ROUNDING)
    count = len(find_clump(shape).radii)
    assert angular["derived"]["bed_particles"] == count * round_["derived"]["bed_particles"]
    assert single_spheres(round_) == round_["derived"]["bed_particles"]
    assert single_spheres(angular) == pytest.approx((count + 1) * round_["derived"]["bed_particles"], rel=ROUNDING)


def test_rolling_friction_factor_scales_every_coefficient_of_the_particles():
    """Between particles, and at sample and floor; 1 changes nothing."""
    plain, half = (tiny_study(bed={"rolling_friction_factor": factor}).runs[0].parameters for factor in (1.0, 0.5))
    for name in ("particle", "sample_material", "floor_material"):
        for values in (plain, half):
            assert values[name]["contact"]["rolling_friction"] > 0.0
        ratio = half[name]["contact"]["rolling_friction"] / plain[name]["contact"]["rolling_friction"]
        assert ratio == pytest.approx(0.5, rel=ROUNDING)
    assert plain == tiny_study().runs[0].parameters


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_without_rolling_friction_clumps_leave_out_a_model_of_spheres(model):
    """Their decks, that of the bed too, have no such model and say so; those of spheres beside them keep it."""
    for text in decks_of(clumps(solver={"rolling_friction": model})):
        assert NO_MODEL in text and f"rolling_friction {model}" not in text
    for text in decks_of(tiny_study(bed={**TINY["bed"], **NO_ROLLING}, solver={"rolling_friction": model})):
        assert f"rolling_friction {model}" in text and NO_MODEL not in text
    assert all(NO_MODEL not in text for text in decks_of(clumps()))


# ---------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bed": {"ends": "window", "ahead_mm": 60, "exchange_mm": 60}}, r"bed.ends is 'window'.*walls or periodic"),
        (
            {"solver": {"rolling_friction": "rvd"}, "bed": {"rolling_friction_factor": 0.5}},
            r"solver.rolling_friction is 'rvd'.*rolling_friction_factor 0, with clumps, because own_spin and rvd act",
        ),
        ({"ledger": "dumps"}, r"ledger is 'dumps'.*solver with clumps"),
        ({"bed": {"shape": "cube"}}, r"bed.shape is 'cube', allowed is one of sphere, pair, tetrahedron\."),
    ],
)
def test_what_clumps_cannot_do_is_refused_in_a_sentence(changes, message):
    """The message says which setting, what it is, and what is allowed with clumps."""
    with pytest.raises(ConfigError, match=message):
        clumps(**changes)


def test_a_study_of_particle_size_has_spheres():
    """Its packings count contacts by spheres."""
    with pytest.raises(ConfigError, match=r"bed.shape is 'pair'.*sphere in a study of particle size"):
        load_study(
            "particle_size",
            overrides={
                "bed": {"material": OF_ANY_MODEL, "shape": "pair", "ends": "walls"},
                "solver": {"rolling_friction": "cdt"},
            },
        )


@pytest.mark.parametrize("study", ["circular_tester", "chute"])
def test_other_cases_know_no_shape(study):
    """A shape where only spheres are simulated is a key that is not known, never one without effect."""
    block = "bulk" if study != "circular_tester" else "bed"
    with pytest.raises(ConfigError, match=rf"{block}.shape .*no known key"):
        load_study(study, overrides={block: {"shape": "pair"}})


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("x,y,z\n0,0,0\n", "column radius is missing"),
        ("x,y,z,radius\n0,0,0,1\n", "found one sphere, allowed are two or more"),
        (
            "x,y,z,radius\n" + "".join(f"{k},0,0,1\n" for k in range(MOST_SPHERES + 1)),
            "found 51 spheres, allowed are 50",
        ),
        ("x,y,z,radius\n0,0,0,1\n2.1,0,0,1\n", "found spheres apart from the others"),
        ("x,y,z,radius\n0,0,0,1\n1,0,0,1\n0,0,0,1\n", "found a sphere twice"),
        ("x,y,z,radius\n0,0,0,1\n0.5,0,0,0.4\n", "line 3: found a sphere within another"),
        ("x,y,z,radius\n0,0,0,1\n1,0,0,0\n", "line 3: radius is 0"),
        ("x,y,z,radius\n0,0,0,1\n1,wide,0,1\n", "line 3: y is 'wide'"),
    ],
)
def test_a_table_that_is_no_clump_is_refused(tmp_path, rows, message):
    """File, line and column of the fault."""
    path = tmp_path / "mine.csv"
    path.write_text(rows)
    with pytest.raises(ConfigError, match=rf"mine\.csv.*{message}"):
        read_clump(path, tmp_path)


def test_a_table_of_the_name_of_round_grains_is_refused(tmp_path):
    """It would never be read."""
    (tmp_path / "config" / "clumps").mkdir(parents=True)
    (tmp_path / "config" / "clumps" / "sphere.csv").write_text("x,y,z,radius\n0,0,0,1\n1,0,0,1\n")
    enter_project(tmp_path)
    try:
        with pytest.raises(ConfigError, match=r"^config/clumps/sphere\.csv: found a clump of that name, allowed is"):
            find_clump("sphere")
    finally:
        leave_project()


# ---------------------------------------------------------------- the real solver


@pytest.mark.solver
@pytest.mark.parametrize("shape", SHIPPED)
def test_solver_finds_the_same_mass_and_inertia_by_random_points(tmp_path, shape):
    """Without the mass and inertia of the deck LIGGGHTS estimates them from ntry points in the spheres."""
    text = decks_of(clumps(shape))[0]
    given = re.findall(r"mass (\S+) inertia_tensor (.*) use_density", text)
    text = re.sub(r" mass \S+ inertia_tensor .* use_density", "", text)
    text = text[: text.index("region  fill")] + "fix motion all multisphere\nrun 0\n"
    (tmp_path / "deck.in").write_text(text)
    subprocess.run(["liggghts", "-in", "deck.in"], cwd=tmp_path, check=True, capture_output=True)
    log = (tmp_path / "log.liggghts").read_text()
    masses = re.findall(rf"^ +mass = {LOG_NUMBER}", log, re.MULTILINE)
    moments = re.findall(rf"Principal moments of inertia_: {LOG_NUMBER}, {LOG_NUMBER}, {LOG_NUMBER}", log)
    assert len(masses) == len(moments) == len(given)
    for mass, found, (ours, tensor) in zip(masses, moments, given, strict=True):
        xx, xy, xz, yy, yz, zz = map(float, tensor.split())
        expected = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        assert float(mass) == pytest.approx(float(ours), rel=TRIES)
        assert sorted(map(float, found)) == pytest.approx(expected, rel=2 * TRIES)


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    """A run of two cycles, plain, in a bed of pairs."""
    study = clumps("pair", wear={"deform": False}, solver={"checkpoint_interval_steps": 900})
    chain = tiny_chain(study, tmp_path_factory.mktemp("clumps"), "R9_plain")
    cycles.run_chain(chain)
    return chain


@pytest.mark.solver
def test_bed_has_its_mass_and_keeps_its_clumps(chain):
    """Mass as asked; no sphere is lost in any deck, pieces included; both spheres of every pair stay as far apart."""
    bed = chain.bed
    log = thermo_table(chain.bed_restart.parent / "log.liggghts")
    largest = bed["particle"]["density_kg_per_m3"] * np.pi / 6.0 * max(bed["particle"]["diameters_m"]) ** 3
    assert log["bed_mass"][-1] == pytest.approx(bed_mass(bed), abs=2.0 * largest)
    logs = [thermo_table(folder / "log.liggghts") for folder in sorted(chain.folder.glob("cycle_*"))]
    assert len(logs) == 3 and len({count for each in logs for count in each["Atoms"]}) == 1
    spheres = read_snapshot(last_snapshot(chain.folder)).sort_values("id")
    places = spheres[["x_m", "y_m", "z_m"]].to_numpy()
    apart = places[1::2] - places[::2]
    width = bed["width_m"]
    apart[:, 0] -= width * np.round(apart[:, 0] / width)  # periodic across
    (first, _), (second, _) = ((np.array(each[:3]), each[3]) for each in bed["particle"]["clump"]["spheres"])
    share = np.linalg.norm(second - first) / bed["particle"]["clump"]["spheres"][0][3]
    assert np.linalg.norm(apart, axis=1) == pytest.approx(share * spheres["radius_m"].to_numpy()[::2], abs=DUMPED)


@pytest.mark.solver
def test_clumps_wear_the_sample(chain):
    """Archard: worn volume is the coefficient times the sliding work, which is below force times travel."""
    wear = pd.read_csv(chain.folder / "wear.csv")
    work = wear["sliding_work_J"].sum()
    coefficient = chain.parameters["wear"]["accelerated_wear_coefficient_per_pa"]
    assert wear["worn_volume_m3"].sum() == pytest.approx(coefficient * work, rel=ROUNDING)
    force, travel = wear["mean_normal_force_N"].mean(), wear["travel_m"].iloc[-1]
    assert 0.1 * force * travel < work < force * travel


DRIFTING = """\
units si
atom_style granular
atom_modify map array
boundary p f f
newton off
communicate single vel yes
region room block -0.05 0.05 -0.05 0.05 -0.05 0.05 units box
create_box 2 room
neighbor 0.002 bin
pair_style gran model hertz
fix youngs_modulus all property/global youngsModulus peratomtype 1e7 1e7
fix poissons_ratio all property/global poissonsRatio peratomtype 0.3 0.3
fix restitution all property/global coefficientRestitution peratomtypepair 2 0.5 0.5 0.5 0.5
pair_coeff * *
timestep 1e-5
"""
INSERTED = """\
fix pair all particletemplate/multisphere 15485863 atom_type 1 density constant 2500 nspheres 2 ntry 1000 spheres &
    0 -0.004 0 0.003 0 0.004 0 0.003 type 1 mass 5.65e-4 inertia_tensor 1.1e-8 0 0 2.0e-9 0 1.1e-8 use_density
fix pairs all particledistribution/discrete 32452843 1 pair 1.0
region source block 0.04699 0.046991 0 1e-6 0 1e-6 units box volume_limit 1e-30
fix motion all multisphere allow_group_and_set yes
fix fill all insert/pack seed 49979687 distributiontemplate pairs vel constant 1.0 0 0 orientation constant 1 0 0 0 &
    insert_every once overlapcheck no all_in no particles_in_region 1 region source
run 1
unfix fill
run 290
neigh_modify delay 1000 every 1000 check no
run 20
"""


@pytest.mark.solver
@pytest.mark.parametrize(("inside", "spheres"), [(True, 2), (False, 0)])
def test_a_clump_that_crosses_the_periodic_face_is_in_the_restart_file(tmp_path, inside, spheres):
    """A pair drifts 0.1 mm through the face since the last lists were made: what decks say before a restart file is
    written keeps it, without that it is lost.
    """
    before = render("_shared/clumps_inside", {"grains": "clump"}) if inside else ""
    (tmp_path / "deck.in").write_text(f"{DRIFTING}{INSERTED}{before}write_restart pair.restart\n")
    again = DRIFTING.replace("region room block -0.05 0.05 -0.05 0.05 -0.05 0.05 units box\ncreate_box 2 room\n", "")
    read = again.replace("neighbor", "read_restart pair.restart\nneighbor", 1)
    told = 'variable spheres equal count(all)\nrun 300\nprint "spheres ${spheres}" file found.txt\n'
    (tmp_path / "again.in").write_text(f"{read}fix motion all multisphere allow_group_and_set yes\n{told}")
    for deck in ("deck.in", "again.in"):
        done = subprocess.run(["liggghts", "-in", deck], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-500:]
    assert (tmp_path / "found.txt").read_text().split() == ["spheres", str(spheres)]
