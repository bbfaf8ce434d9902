"""Projects that are planned: from within, from outside, on a cluster, as a module of a pipeline."""

import shutil

import pytest

from bulkwear.__main__ import main
from bulkwear.workflows.engine.project import PACKAGE
from tests.support.asked_project import PROFILE, outside_of, said_of
from tests.support.own_project import STUDY, own_project
from tests.workflows.test_snakemake import planned_jobs


def test_a_project_is_planned_on_a_cluster(tmp_path):
    """The profile for Slurm of the package, on the project's study; the same jobs as on one machine."""
    mine = own_project(tmp_path / "my project")
    outside = (*outside_of(mine), "--dry-run", STUDY)
    profiles = (str(PACKAGE / "workflows/profiles" / name) for name in ("default", "slurm"))
    planned = [planned_jobs(said_of(tmp_path, *outside, "--workflow-profile", each)) for each in profiles]
    assert planned[0] == planned[1] and planned[0]["worn_run"] == 1


def test_one_command_makes_a_project(tmp_path, capsys):
    """Its Snakefile takes the package as a module; both ways in plan the same, and its study is made by default."""
    folder = tmp_path / "a new one"
    assert main(["project", str(folder)]) == 0
    assert f"cd '{folder}' && snakemake" in capsys.readouterr().out
    from_outside = said_of(tmp_path, *outside_of(folder), "--dry-run")
    planned = [planned_jobs(said) for said in (said_of(folder, "--dry-run"), from_outside)]
    assert planned[0] == planned[1] and planned[0]["worn_run"] == 2 * 3 and planned[0]["report"] == 1
    assert {"demo", "screening", "first"} <= set(said_of(folder, "--list-target-rules").split())
    assert main(["project", str(folder)]) == 1
    assert "there is something in it, allowed is a new or an empty folder" in capsys.readouterr().err
    assert main(["project", str(tmp_path / "q{8}")]) == 1
    assert "found a brace in the name of the folder" in capsys.readouterr().err
    assert main(["project", "~no_such_user/new"]) == 1
    assert "~no_such_user is the home of nobody, allowed is another folder" in capsys.readouterr().err


def test_what_an_own_template_leaves_out_is_told(tmp_path):
    """It is no fault: the line stands beside that on which template won."""
    folder = own_project(tmp_path / "my project")
    partial = "templates/_shared/integration.in.j2"
    (folder / partial).parent.mkdir(exist_ok=True)
    (folder / partial).write_text("fix step_check all check/timestep/gran 1000 0.5 0.5\n")
    said = said_of(folder, *PROFILE, f"bw_{STUDY}_forecast", "--dry-run")
    assert said.count(f"{partial}: without fix gravity, fix motion of the package's deck") == 1


@pytest.mark.verify
def test_studies_of_the_package_are_planned_in_a_project(tmp_path):
    """With the published tables that they are compared with, and those of the project where it has some."""
    folder = own_project(tmp_path / "my project")
    shutil.rmtree(folder / "templates")
    outside = (*outside_of(folder), "--dry-run")
    planned = planned_jobs(said_of(tmp_path, *outside, "calibration", "particle_size"))
    assert planned["calibrated_parameters"] == 1 and planned["report"] == 2


def test_a_module_loads_the_studies_that_it_names(tmp_path):
    """Two modules side by side, each with its own; what is not a list of names is refused."""
    folder = own_project(tmp_path / "my project")
    module = """
module {name}:
    snakefile: "{package}/Snakefile"
    config: {{"studies": {studies}}}

use rule * from {name} as {name}_*
"""
    texts = [
        module.format(name=name, package=PACKAGE, studies=studies)
        for name, studies in (("a", ["mine"]), ("b", ["second"]))
    ]
    (folder / "Snakefile").write_text("".join(texts))
    planned = planned_jobs(said_of(folder, *PROFILE, "a_mine", "b_second_decks", "--dry-run"))
    assert planned["a_worn_run"] == 1 and planned["b_run_decks"] == 2
    (folder / "Snakefile").write_text(texts[0].replace("['mine']", "'mine'"))
    output = said_of(folder, *PROFILE, "--dry-run", code=1)
    assert "config of the module: studies is 'mine', allowed is a list of names of studies." in output


@pytest.mark.parametrize(
    ("triggers", "said"),
    [
        ((), "are code, input, mtime, params, software-env: newer code fills beds and simulates runs again"),
        (("--rerun-triggers", "mtime"), "are mtime: without params and input results may stay"),
        (PROFILE, ""),
    ],
)
def test_a_pipeline_without_our_profile_is_told(tmp_path, triggers, said):
    """What Snakemake makes again there, and what it does not; nothing with the package's profile."""
    folder = own_project(tmp_path / "my project")
    output = said_of(folder, *triggers, "--cores", "1", "bw_mine_decks", "--dry-run")
    assert output.count("rerun-triggers of Snakemake") == bool(said) and said in output


def test_settings_of_a_pipeline_are_those_of_its_block(tmp_path):
    """What the command line sets beside the block does not reach the studies, which is said; a fault within the block
    names the module. What moves the results is refused.
    """
    folder = own_project(tmp_path / "my project")
    snakefile = folder / "Snakefile"
    own = snakefile.read_text()
    snakefile.write_text(own.replace("        config\n", '        config.get("bulkwear", {})\n'))
    lost = ("--config", "fidelity=paper", "sample={width_mm: 50}", "colour=red")
    output = said_of(folder, *PROFILE, "bw_mine", "--dry-run", *lost)
    assert "command line: fidelity, sample of --config does not reach the studies" in output
    given = said_of(folder, *PROFILE, "bw_mine", "--dry-run", "--config", "bulkwear={particle_scale: 5}")
    assert "does not reach" not in given
    snakefile.write_text('config["bulkwear"] = {"fidelity": "paper"}\n' + snakefile.read_text())
    output = said_of(folder, *PROFILE, "bw_mine", "--dry-run", code=1)
    assert "config of the module: fidelity is 'paper', allowed is one of quick" in output
    snakefile.write_text(own.replace("    config:\n", '    prefix:\n        "sub"\n    config:\n'))
    output = said_of(folder, *PROFILE, "bw_mine", "--dry-run", code=1)
    assert "module: its prefix makes sub/results/first/summary.csv of results/first/summary.csv, allowed is" in output
