"""The project and its studies, checked before anything runs."""

import sys
from pathlib import Path

from snakemake.cli import get_argument_parser
from snakemake.exceptions import WorkflowError
from snakemake.utils import min_version

from bulkwear.workflows.config.contact_checks import unused_properties
from bulkwear.workflows.config.deck_checks import template_faults_told
from bulkwear.workflows.config.deck_commands import left_out
from bulkwear.workflows.config.design import ConfigError, list_studies, load_study
from bulkwear.workflows.config.optimise import OPTIMISE
from bulkwear.workflows.config.published_tables import check_published
from bulkwear.workflows.config.run_checks import check_files
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.targets import (
    naming,
    nearly_studies,
    placed,
    requested_studies,
    unheard_sentence,
    unknown_run,
)
from bulkwear.workflows.config.until import UNTIL
from bulkwear.workflows.engine.cases import case_folders
from bulkwear.workflows.engine.chain import sample_decks
from bulkwear.workflows.engine.job import let_jobs_import
from bulkwear.workflows.engine.project import ProjectError, enter_project
from bulkwear.workflows.engine.template_files import DeckError
from bulkwear.workflows.engine.terminal import Terminal, listen

min_version("9.0")

CORES = workflow.cores or 1  # on a cluster those of a submission of small jobs
MANY_RUNS = 500  # of a study, for which Snakemake plans about a tenth of a second each
# Another Snakefile may take this workflow as a module, and put words round the names of its rules.
NAMING = naming(workflow.modifier.modify_rulename, workflow.modifier.base_snakefile is not None)
MADE_BY_DEFAULT = not workflow.default_target  # unless that Snakefile has said before what is
# The command line is read as Snakemake does it: the workflow has its targets only when this file has been read.
GIVEN, _ = get_argument_parser().parse_known_args(sys.argv[1:])
let_jobs_import()
TERMINAL = Terminal() if GIVEN.target_jobs else listen(logger)  # not in the jobs that Snakemake starts by themselves


def entered_project():
    """The project, which is the working directory; says which of its files stand before the package's."""
    try:
        project = enter_project(Path.cwd())
    except ProjectError as fault:
        raise WorkflowError(str(fault)) from None
    if Path("results").exists() and not Path("results").is_dir():
        raise WorkflowError("results: found a file, allowed is a folder, or none: what is simulated goes into it.")
    if not GIVEN.target_jobs:
        for sentence in (*project.substitutes(), *project.astray(), *left_out(project)):
            logger.info(sentence)
    return project


def checked_studies(settings, named):
    """The studies that are asked for by name. A fault ends here, in one sentence, before a job starts.

    Where nothing is made, as with --list and --lint, all that have no fault. A Snakefile that takes this workflow as a
    module may name them: config of the module, `studies`.
    """
    if not (isinstance(named, list) and all(isinstance(name, str) for name in named)):
        raise WorkflowError(f"config of the module: studies is {named!r}, allowed is a list of names of studies.")
    if GIVEN.lint or GIVEN.list_rules or GIVEN.list_target_rules:
        return dict(filter(None, (sound_study(name, settings) for name in list_studies())))
    try:
        names = named or requested_studies(GIVEN.targets, GIVEN.target_jobs, names=NAMING)
        for sentence in () if GIVEN.target_jobs else nearly_studies(GIVEN.targets, names=NAMING):
            logger.info(sentence)
        studies = {name: load_study(name, overrides=settings) for name in names}
        if not GIVEN.target_jobs:
            if said := unknown_run(GIVEN.targets, known_runs(studies.values())):
                raise ConfigError(said)
            check_published(PROJECT)
            for study in studies.values():
                for sentence in unused_properties(study.settings, (run.parameters["solver"] for run in study.runs)):
                    logger.info(f"Study {study.name}: {sentence}")
                if len(study.runs) > MANY_RUNS:
                    logger.info(f"Study {study.name} has {len(study.runs):,} runs: to plan them takes minutes.")
                check_files(study.name, study.case, study.runs)
                check_decks(study)
        return studies
    except (ConfigError, DeckError, ProjectError) as fault:
        raise WorkflowError(placed(str(fault), NAMING, GIVEN.config or (), GIVEN.configfile or ())) from None


def known_runs(studies):
    """The names of the runs of each study; without those to which rounds add runs."""
    fixed = (study for study in studies if not {UNTIL, OPTIMISE} & set(study.settings))
    return {study.name: [run.name for run in study.runs] for study in fixed}


def check_decks(study):
    """Render a deck of each kind of a study's first run, as its jobs will: a template may have been edited."""
    first = study.runs[0]
    with template_faults_told():
        sample_decks(study.case, first.parameters, study.beds.get(study.bed_of(first.name)))


def sound_study(name, settings):
    """A study's name and the study; None where it has a fault."""
    try:
        return name, load_study(name, overrides=settings)
    except (ConfigError, DeckError, ProjectError) as fault:
        logger.warning(f"Study {name} is left out: {fault}")


def tell_unheard():
    """Say which settings of the command line do not reach the studies, as they are not in the config of the module."""
    if NAMING.is_module and not GIVEN.target_jobs:
        known = {*load_schema("settings")["properties"], *(key for study in STUDIES.values() for key in study.settings)}
        if said := unheard_sentence(GIVEN.config or (), config, known):
            logger.warning(said)


PROJECT = entered_project()
if not isinstance(config, dict):
    raise WorkflowError(f"config of the module is {config!r}, allowed is a block of keys to values.")
SETTINGS = {key: value for key, value in config.items() if key != "studies"}  # of the command line
PLACE = "results/first/summary.csv"  # any, to see whether a module moves it
if (MOVED := workflow.modifier.path_modifier.replace_prefix(PLACE)) != PLACE:
    raise WorkflowError(f"module: its prefix makes {MOVED} of {PLACE}, allowed is a module without one.")
STUDIES = checked_studies(SETTINGS, config.get("studies", []))
tell_unheard()


wildcard_constraints:
    study="|".join(STUDIES) or "no_study",
    run=r"[A-Za-z0-9][A-Za-z0-9_-]*",
    bed=r"bed_[A-Za-z0-9][A-Za-z0-9_-]*",


CASES = {study.case.name: study.case for study in STUDIES.values()}
SOLVER_RULES = {rule for case in CASES.values() for rule in case.solver_rules}
# What comes before the tables of a study: on a cluster all that is not named here is one submission.
BEFORE_TABLES = {"surface_mesh", "cost_rates", "forecast_table", "further_packings", "proposed_rows", *SOLVER_RULES}


def rules_of_cases():
    """The files of rules that the cases of these studies have of their own."""
    folders = dict.fromkeys(folder for case in CASES.values() for folder in case_folders(case))
    return [path for folder in folders for path in sorted(folder.rglob("rules.smk"))]


def study_of(wildcards):
    return STUDIES[wildcards.study]
