"""Which studies the targets of Snakemake name, and whose fault a wrong setting is."""

from pathlib import Path

import pytest

from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.targets import Naming, naming, nearly_studies, placed, requested_studies, unknown_run
from bulkwear.workflows.engine.project import PACKAGE, Project


@pytest.mark.parametrize(
    ("targets", "studies"),
    [
        ([], ["demo"]),
        (["screening", "calibration_decks"], ["screening", "calibration"]),
        (["results/pin_on_disc/report.html", "./results/demo/R9_plain/wear.csv"], ["pin_on_disc", "demo"]),
        (["screening_confirmation_forecast", "screening"], ["screening", "screening_confirmation"]),
        (["cost_rates"], []),
        (["results/cost_rates.json", "report.html"], []),
    ],
)
def test_targets_name_their_studies(targets, studies):
    """By name, with an ending, or by a file of its results; the best designs come with the study that found them."""
    assert requested_studies(targets) == studies


def test_jobs_of_a_cluster_name_their_studies():
    """A job by itself needs the study of its wildcards, whatever its rule, or that of its target; else none."""
    drawn = [
        ("figure_forces", {"study": "demo"}),
        ("rule_of_a_case", {"study": "screening", "run": "R1"}),
        ("other", {}),
    ]
    assert requested_studies([], drawn) == ["demo", "screening"]
    jobs = [("worn_run", {"study": "demo", "run": "R9_plain"}), ("screening_forecast", {}), ("cost_rates", {})]
    assert requested_studies([], jobs) == ["demo", "screening"]
    assert requested_studies([], jobs[2:]) == []


@pytest.mark.parametrize("target", ["screning", "results/screning/report.html", "demo_confirmed", "confirmation"])
def test_targets_of_no_study_are_refused(target):
    """Neither a study nor a rule nor a file: the sentence names the target and the studies."""
    with pytest.raises(ConfigError, match=f"target is '{target}', allowed is one of calibration, .*, worn_bump"):
        requested_studies([target])


def test_names_with_words_round_them_are_ours():
    """A module's targets are recognised by what was put round them; what is not ours is the Snakefile's own."""
    project = Project(PACKAGE)
    named = naming(lambda name: f"bw_{name}_x", True)
    assert named == Naming("bw_", "_x", True)
    assert requested_studies(["bw_screening_x", "bw_calibration_decks_x"], project=project, names=named) == [
        *("screening", "calibration")
    ]
    jobs = [("bw_worn_run_x", {"study": "screening"}), ("own_rule", {"study": "no study"})]
    assert requested_studies([], jobs, project, named) == ["screening", "demo"]
    assert requested_studies(["all", "figures/a.png"], project=project, names=named) == ["demo"]
    assert requested_studies(["bw_cost_rates_x"], project=project, names=named) == []
    near = nearly_studies(["bw_screning_x", "bw_screening_x", "all", "screning", "results/screning/"], project, named)
    assert near == ["bw_screning_x is no study, the nearest is screening; it is taken for a rule of this Snakefile."]
    assert nearly_studies(["screning"], project) == []


def test_a_fault_of_settings_is_of_the_place_that_gives_them():
    """The command line where it has that key, else the files of --configfile; without either the module's config."""
    said, mine = "command line: packings is 200, allowed is 1.", Naming(is_module=True)
    for given, files, place in (
        (["packings=200"], [Path("my.yaml")], "command line"),
        (["rows=[R5]"], [Path("my.yaml")], "my.yaml"),
        ([], [Path("my.yaml"), Path("ours.yaml")], "my.yaml, ours.yaml"),
        (["rows=[R5]"], [], "command line"),
        ([], [], "config of the module"),
    ):
        assert placed(said, mine, given, files) == f"{place}: packings is 200, allowed is 1."
    assert placed(said, Naming(), []) == said
    assert placed("default.yaml: packings is 200.", mine, [], [Path("my.yaml")]) == "default.yaml: packings is 200."


def test_a_file_of_a_run_that_a_study_does_not_have():
    """It is named, with those that there are; files of beds and studies, and studies that add runs, are let be."""
    runs = {"demo": ["R5_convex", "R5_plain"]}
    said = unknown_run(["demo", "results/demo/R9_convex/wear.csv"], runs)
    assert said.startswith("target results/demo/R9_convex/wear.csv: its run is 'R9_convex', allowed is one of R5_")
    fine = ["demo", "results/demo/R5_plain/wear.csv", "results/demo/beds/wear.csv/x", "results/screening/R0/wear.csv"]
    assert unknown_run(fine, runs) is None


def test_a_study_called_as_a_rule_is_refused_by_its_name(tmp_path):
    """Not taken for the rule, which needs wildcards."""
    (tmp_path / "config/studies").mkdir(parents=True)
    (tmp_path / "config/studies/report.yaml").write_text("title: x\n")
    assert requested_studies(["report"], project=Project(tmp_path)) == ["report"]
    with pytest.raises(ConfigError, match="a study cannot be called report"):
        load_study("report", Project(tmp_path))
