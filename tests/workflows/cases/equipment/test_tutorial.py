"""The tutorial of a chute in docs, done as it is written there, with the package as a wheel installs it.

Its files and commands are taken from the page; less is simulated than on the page, and yet it takes the processor a
minute and a half, so that `make test` loads its study alone.
"""

import html
import math
import os
import re
import subprocess
import sys
import zipfile

import pandas as pd
import pytest
import yaml

from bulkwear.meshes.transfer import draw
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.readme import readme
from bulkwear.workflows.engine.project import enter_project, leave_project
from tests import REPOSITORY
from tests.support.compiled import share_compiled

TUTORIAL = (REPOSITORY / "docs/tutorial_chute.md").read_text(encoding="utf-8")
REFERENCE = (REPOSITORY / "docs/equipment.md").read_text(encoding="utf-8")
FILES = re.findall(r"`(config/[\w/.]+)`[^`\n]*\n\n```(?:yaml|csv)\n(.*?)```", TUTORIAL, re.DOTALL)
COMMANDS = "".join(re.findall(r"```sh\n(.*?)```", TUTORIAL, re.DOTALL))
SENTENCES = re.findall(r"^> (\S.*)$", TUTORIAL, re.MULTILINE)  # of the page, numbers left out
STUDY = "transfer"
TINY = {  # less to simulate than the page asks for
    "start_up": {"most_s": 0.6},
    "sampling": {"block_s": 0.2, "fewest_blocks": 3, "most_blocks": 3, "pictures_per_block": 2},
    "updates": {"most": 2, "worn_blocks": 1},
    "solver": {"rayleigh_fraction": 0.4},
}
# Commands run as they stand, but for snakemake: starting it takes seconds, so its targets are made together.
BEFORE = 'set -e; python() { "$PYTHON" "$@"; }; targets=""; snakemake() { targets="$targets $*"; }\n'
AFTER = '\n"$PYTHON" -m snakemake $targets --configfile "$HOME/tiny.yaml"\n'
SOLVER = REPOSITORY / "solver" / "build"
TIMEOUT = 1800.0  # s, for what takes a minute or two on two idle cores
NEEDED = ("parts", "bulk", "inlet", "outlets", "operation")


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """The home of someone with the installed package."""
    folder = tmp_path_factory.mktemp("home")
    build = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(folder)]
    subprocess.run(build, cwd=REPOSITORY, check=True, capture_output=True)
    (wheel,) = folder.glob("bulkwear-*.whl")
    with zipfile.ZipFile(wheel) as opened:
        opened.extractall(folder / "site")
    for name in ("bulkwear", "postproc", "meshes", "workflows"):
        share_compiled(folder / "site/bulkwear" / name.removeprefix("bulkwear"), REPOSITORY / name)
    (folder / "tiny.yaml").write_text(yaml.safe_dump(TINY))
    return folder


@pytest.fixture(scope="module")
def finished(home):
    """The project after the tutorial, and what was said on the way."""
    (study, text), (design, rows) = FILES[:2]
    writing = "".join(f"cat >{name} <<'END'\n{each}END\n" for name, each in ((study, text), (design, rows)))
    first, rest = COMMANDS.split("snakemake", 1)
    environment = {
        **{key: value for key, value in os.environ.items() if key != "PYTHONPATH"},
        **{"HOME": str(home), "PYTHON": sys.executable, "PYTHONPATH": str(home / "site")},
        "PATH": f"{SOLVER}{os.pathsep}{os.environ['PATH']}",
    }
    done = subprocess.run(
        ["bash", "-c", f"{BEFORE}{first}{writing}snakemake{rest}{AFTER}"],
        cwd=home,
        env=environment,
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    return home / "chutes", done.stdout + done.stderr


def test_the_page_gives_what_a_machine_needs():
    """One YAML, its design, the same design with a second row, and a machine without a feed; every command once."""
    assert [name for name, _ in FILES] == [
        "config/studies/transfer.yaml",
        *["config/designs/transfer.csv"] * 2,
        "config/studies/drum.yaml",
    ]
    assert len(SENTENCES) > 1
    assert set(NEEDED) <= set(yaml.safe_load(FILES[0][1]))
    assert re.findall(r"^snakemake (\S+)$", COMMANDS, re.MULTILINE) == [
        f"{STUDY}{end}" for end in ("_forecast", "_decks", "")
    ]


@pytest.mark.solver
@pytest.mark.verify
def test_every_step_leaves_what_the_page_says(finished):
    """The table of bodies, the forecast, decks, tables and page; all of it by the installed package."""
    project, said = finished
    assert str(project.parent / "site/bulkwear") in (project / "Snakefile").read_text()
    for word in ("impact_plate", "right_wall", "nothing had to be repaired", "Forecast of transfer"):
        assert word in said
    results = project / "results" / STUDY
    assert (results / "decks/A/cycle_001/deck.in").is_file() and (results / "A/worn_surface.vtu").is_file()
    page = html.unescape((results / "report.html").read_text(encoding="utf-8"))
    for sentence in SENTENCES:
        form = ".+?".join(map(re.escape, sentence.split("…")))
        assert re.search(form, page) and re.search(form, said), sentence
    life = pd.read_csv(results / "equipment/life.csv")
    assert list(life["part"]) == ["impact_plate", "liner"] and (life["life_h"] > 0.0).all()


@pytest.mark.solver
@pytest.mark.verify
def test_the_run_goes_through_all_phases(finished):
    """Start-up, shape as built, updates, worn shape; both parts wear, and no particle is missing."""
    run = finished[0] / "results" / STUDY / "A"
    wear = pd.read_csv(run / "wear.csv")
    assert list(wear["phase"].drop_duplicates()) == ["start_up", "pristine", "wearing", "worn"]
    assert (wear["lost_particles"] == 0).all()
    parts = pd.concat([pd.read_csv(path) for path in run.glob("cycle_*/parts.csv")])
    assert (parts.groupby("part")["worn_volume_m3_per_h"].sum() > 0.0).to_dict() == {
        **{"impact_plate": True, "liner": True},
        **{"left_wall": False, "right_wall": False},
    }


def loaded(folder, name):
    """A study of the tutorial, checked; of two designs with one name the second takes the place of the first."""
    for place, text in (*FILES, ("config/designs/drum.csv", FILES[1][1])):
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (folder / place).write_text(text)
    enter_project(folder)
    try:
        return load_study(name)
    finally:
        leave_project()


def test_a_machine_that_is_filled_once(tmp_path):
    """It passes the checks; a block is one turn of it, and nothing is fed."""
    run = loaded(tmp_path, "drum").runs[0].parameters
    (liner,) = run["parts"]
    turn = 2.0 * math.pi / liner["motion"]["speed_rad_per_s"]
    assert run["sampling"]["block_s"] == pytest.approx(turn, rel=1e-3)  # three digits of a second
    assert run["inlet"] is None and run["filling"]["fraction"] == 0.3


def test_a_second_design_is_a_row(tmp_path):
    """The step with two designs: B has another drawing, all else is A's."""
    draw.main(tmp_path / "meshes")
    study = loaded(tmp_path, STUDY)
    files = {run.name: {part["name"]: part["file"] for part in run.parameters["parts"]} for run in study.runs}
    assert list(files) == ["A", "B"]
    assert files["B"] == files["A"] | {"liner": "transfer_steep.step"}


def test_named_keys_are_there():
    """Every key with a point that tutorial and reference name is one of the configuration."""
    known = set(re.findall(r"^\| `([\w.<>]+)` \|", readme(), re.MULTILINE))
    known |= {re.sub(r"<name>", "shell", key) for key in known} | {re.sub(r"<name>", "liner", key) for key in known}
    named = {
        key
        for key in re.findall(
            r"`((?:parts|bulk|start_up|sampling|updates|operation|wear|inlet|solver)\.[\w.]+)`", TUTORIAL + REFERENCE
        )
        if not key.endswith((".csv", ".vtu"))
    }
    assert len(named) > 10 and named <= known | {"wear.parameters"}
