"""Studies, checked before anything runs, and the input functions of all stages."""

import itertools
import sys
from dataclasses import asdict  # of params: Snakemake does not see that an object of a class of ours has changed
from functools import cache, partial
from pathlib import Path

from snakemake.cli import get_argument_parser
from snakemake.exceptions import WorkflowError
from snakemake.io import IOFile
from snakemake.settings.types import RerunTrigger
from snakemake.utils import min_version

from bulkwear.workflows.config.deck_checks import template_faults_told
from bulkwear.workflows.config.deck_commands import left_out
from bulkwear.workflows.config.design import ConfigError, list_studies, load_study
from bulkwear.workflows.config.packings import possible_packings
from bulkwear.workflows.config.published_tables import check_published
from bulkwear.workflows.config.rounds import read_round
from bulkwear.workflows.config.run_checks import check_files
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.targets import (
    default_studies,
    naming,
    nearly_studies,
    placed,
    requested_studies,
    triggers_sentence,
    unheard_sentence,
)
from bulkwear.workflows.engine.cases import case_folders
from bulkwear.workflows.engine.chain import sample_decks
from bulkwear.workflows.engine.inputs import (
    SimulatedFrom,
    bed_digest,
    digest_of,
    job_digest,
    other_bed,
    other_inputs,
    other_length,
    simulated_from,
    surface_from,
    why_again,
)
from bulkwear.workflows.engine.job import let_jobs_import
from bulkwear.workflows.engine.project import ProjectError, enter_project
from bulkwear.workflows.engine.solver import LAUNCHER, cycle_fault, executable_of
from bulkwear.workflows.engine.study_folder import StudyFolderError, date_back, take
from bulkwear.workflows.engine.template_files import DeckError
from bulkwear.workflows.engine.templates import templates_digest
from bulkwear.workflows.engine.terminal import Terminal, listen
from bulkwear.workflows.forecast.rates import damage_of, rates_file
from bulkwear.workflows.report import figure_process
from bulkwear.workflows.report.products import code_of, looked_up, paths_of, told_to

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
            check_published(PROJECT)
            for study in studies.values():
                if len(study.runs) > MANY_RUNS:
                    logger.info(f"Study {study.name} has {len(study.runs):,} runs: to plan them takes minutes.")
                check_files(study.name, study.case, study.runs)
                check_decks(study)
        return studies
    except (ConfigError, DeckError, ProjectError) as fault:
        raise WorkflowError(placed(str(fault), NAMING, GIVEN.config or ())) from None


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


HELD = []  # locks of studies' folders, until Snakemake ends
if GIVEN.target_jobs:  # on a node of a cluster, where nothing is called at the start
    figure_process.start()


onstart:
    needed = jobs_by_study(workflow.dag.needrun_jobs())
    if needed and (fault := damage_of(rates_file())):  # jobs ask for time and memory by them
        raise WorkflowError(fault)
    # before the first job: a bed takes minutes to fill, and without its solver no run can follow
    for job in workflow.dag.needrun_jobs():
        if NAMING.ours(job.rule.name) == "worn_run":
            case, parameters = study_of(job.wildcards).case, run_parameters(job.wildcards)
            if fault := cycle_fault(executable_of(parameters, wears=True), case, parameters):
                raise WorkflowError(fault)
    if workflow.local_exec:  # a cluster's nodes are others
        for study in STUDIES:
            if fault := beyond_machine(study, needed.get(study, ()), workflow.dag.needrun_jobs()):
                raise WorkflowError(fault)
    for study in needed:
        if fault := beyond_budget(study):
            raise WorkflowError(fault)
    if workflow.local_exec:
        figure_process.start()
    for study in sorted({job.wildcards.get("study", "") for job in workflow.dag.needrun_jobs()} & set(STUDIES)):
        HELD.append(prepared(Path("results") / study))
    for study, jobs in needed.items():
        announce_cost(study, jobs)
        if in_rounds(STUDIES[study]):
            logger.info((STUDIES[study].until or STUDIES[study].optimise).said(study))
    tell_time_left(needed, workflow.dag.needrun_jobs())


onsuccess:
    from bulkwear.workflows.report.verdict import leading  # slow to import, and every start reads this file

    for job in workflow.dag.jobs:
        if NAMING.ours(job.rule.name) == "report":
            study, page = STUDIES[job.wildcards.study], Path(job.output[0])
            said = leading(answers_of(study.case.name, page.parent))
            for sentence in said.items:
                logger.info(f"{study.name}: {sentence}")
            more = f", with {len(said.folded)} more answers" if said.folded else ""
            logger.info(f"{study.name}: its page is {page}{more}")


def prepared(folder):
    """The lock of a study's folder, of which no file is of the future any more."""
    try:
        lock = take(folder)
    except StudyFolderError as fault:
        raise WorkflowError(str(fault)) from None
    if ahead := date_back(folder):
        logger.info(f"{folder}: {ahead} files were dated after now, the clock was set back; they are dated now.")
    return lock


def answers_of(case, folder):
    """What a finished study of a case answers, in sentences."""
    from bulkwear.workflows.report.page_parameters import answers_of_study  # slow to import, and jobs need none

    return answers_of_study(case, folder)


def jobs_by_study(jobs):
    """The jobs that call the solver, by study: the names they have in forecasts."""
    found = {}
    for study, name in solver_jobs(jobs).values():
        found.setdefault(study, set()).add(name)
    return found


def solver_jobs(jobs):
    """Of the jobs that call the solver: {id: (study, the name in forecasts)}."""
    found = {}
    for job in jobs:
        if (kind := NAMING.ours(job.rule.name)) in SOLVER_RULES:
            words = dict(job.wildcards.items())
            found[job.jobid] = words.pop("study"), "_".join([kind, *words.values()])
    return found


def beyond_machine(study, jobs, all_jobs):
    """Why this machine cannot do those jobs of a study, and make the meshes among all jobs; None where it can."""
    meshed = [
        job.wildcards.run
        for job in all_jobs
        if NAMING.ours(job.rule.name) == "surface_mesh" and job.wildcards.study == study
    ]
    if not (jobs or meshed):
        return None
    from bulkwear.workflows.forecast.limits import fault_here  # slow to import, and jobs need none

    return fault_here(STUDIES[study], jobs, meshed)


def beyond_budget(study):
    """Why the budget of a study's search does not hold a round; None where it does."""
    if STUDIES[study].optimise is None:
        return None
    from bulkwear.workflows.forecast.limits import fault_of_budget  # slow to import, and jobs need none

    return fault_of_budget(STUDIES[study])


def announce_cost(study, jobs):
    """Say in one line what those jobs of a study will cost."""
    from bulkwear.workflows.forecast.forecast import announcement  # slow to import, and jobs need none

    logger.info(announcement(STUDIES[study], jobs, CORES))


def tell_time_left(needed, jobs):
    """From now on say the time left of a study whenever one of those jobs has ended."""
    from bulkwear.workflows.forecast.time_left import times_left  # slow to import, and jobs need none

    left, names = times_left([(STUDIES[study], found) for study, found in needed.items()], CORES), solver_jobs(jobs)

    def said(job):
        study, name = names.get(job, ("", ""))
        if study in left:
            logger.info(left[study].finished(name))

    TERMINAL.on_finished = said


def rules_of_cases():
    """The files of rules that the cases of these studies have of their own."""
    folders = dict.fromkeys(folder for case in CASES.values() for folder in case_folders(case))
    return [path for folder in folders for path in sorted(folder.rglob("rules.smk"))]


def study_of(wildcards):
    return STUDIES[wildcards.study]


def study_so_far(wildcards):
    """The study with the packings, and rows, that were found to be needed; which are, is not known before its runs are
    done.
    """
    decided = last_round(wildcards)
    return study_of(wildcards).with_packings(read_round(decided[0])["packings"]) if decided else study_of(wildcards)


def last_round(wildcards):
    """What says which packings and rows are enough, which tables depend on; nothing where their number is given."""
    if not in_rounds(study_of(wildcards)):
        return []
    for number in itertools.count(1):
        decided = round_of(wildcards.study, number)
        if read_round(decided)["enough"]:
            return [decided]


def in_rounds(study):
    """Whether rounds say which packings or rows a study has."""
    return bool(study.until or study.optimise)


def round_of(study, number):
    """What a round decided; the rows of the study are those of that round from now on."""
    rounds = checkpoints.proposed_rows if STUDIES[study].optimise else checkpoints.further_packings
    decided = rounds.get(study=study, round=number).output.decided
    if STUDIES[study].optimise and not known_rows(study, decided):
        STUDIES[study] = load_study(study, overrides=SETTINGS)
        if not known_rows(study, decided):
            raise WorkflowError(
                f"{decided}: found a round of other settings, allowed are those of the study; move the folder away to"
                " search anew"
            )
    return decided


def known_rows(study, decided):
    """Whether the study has the rows that a round found, as it found them."""
    rows = {row["row"]: row for row in STUDIES[study].design_rows}
    return all(rows[name] == rows[name] | values for name, values in read_round(decided)["rows"].items())


def rows_by_setting(study):
    """How many packings each setting of a study may have."""
    return possible_packings(study.design_rows, study.setting_of, study.packing_of)


def study_of_round(wildcards):
    """The study with the packings that a round looks at."""
    study, number = study_of(wildcards), int(wildcards.round)
    if number == 1:
        return study.with_packings(study.first_packings)
    packings = read_round(round_of(study.name, number - 1))["packings"]
    return study_of(wildcards).with_packings(packings)


def of_round(pattern):
    """An input function: a path pattern with {study} and {run}, expanded over the runs that a round looks at."""

    def paths(wildcards):
        return [pattern.format(study=wildcards.study, run=run.name) for run in study_of_round(wildcards).runs]

    return paths


def costs_of_round(wildcards):
    """The tables of what the runs and beds of a round cost."""
    beds = [f"results/{wildcards.study}/beds/{bed}/cost.csv" for bed in study_of_round(wildcards).beds]
    return [*of_round("results/{study}/{run}/cost.csv")(wildcards), *beds]


def round_before(wildcards):
    """What the round before decided; nothing before the first."""
    number = int(wildcards.round) - 1
    return [f"results/{wildcards.study}/rounds/round_{number}.json"] if number else []


def run_of(wildcards):
    return study_of(wildcards).run(wildcards.run)


def run_parameters(wildcards):
    return run_of(wildcards).parameters


def case_of(wildcards):
    return study_of(wildcards).case.name


def run_geometry(wildcards):
    """The sections of a run's parameters that its surface depends on; of a project's case its code as well."""
    return surface_from(study_of(wildcards).case, run_parameters(wildcards))


@cache
def tell_triggers():
    """Say once what Snakemake makes again where it is called without the package's profile, as by another Snakefile."""
    if not GIVEN.target_jobs and (said := triggers_sentence(map(str, workflow.rerun_triggers))):
        logger.warning(said)


@cache
def made_from(study, run):
    """The case, the parameters and the bed of a run, and what it is simulated from."""
    case, parameters = STUDIES[study].case, STUDIES[study].run(run).parameters
    bed = STUDIES[study].beds.get(STUDIES[study].bed_of(run))
    return case, parameters, bed, simulated_from(case, parameters, bed)


@cache
def simulated_run(study, run):
    """The parameters of a run, and of its bed, which run again when what is simulated from them changes."""
    tell_triggers()  # here, as Snakemake knows them only when this file has been read
    case, parameters, bed, found = made_from(study, run)
    digest = digest_of(found)
    if not GIVEN.target_jobs and (why := why_again(Path(f"results/{study}/{run}"), found)):
        logger.info(f"{run} of {study} differs from what was simulated: {why}.")
    asked = job_digest(case, parameters, digest)
    return SimulatedFrom(parameters, asked), bed and SimulatedFrom(bed, digest)


@cache
def simulated_bed(study, bed):
    """The parameters of a bed, which is filled again when its deck or what that reads changes."""
    return SimulatedFrom(STUDIES[study].beds[bed], bed_digest(STUDIES[study].case, STUDIES[study].beds[bed]))


def bed_restart_of_run(folder):
    """An input function: the restart file below results/<study>/<folder> that a run starts from, or nothing."""

    def paths(wildcards):
        bed = study_of(wildcards).bed_of(wildcards.run)
        return [f"results/{wildcards.study}/{folder}/{bed}/bed.restart"] if bed else []

    return paths


def surface_of_run(wildcards):
    """The surface of a run. Of results that were copied without .snakemake Snakemake compares but times of files: a run,
    or its bed, that was made from something else is made again.
    """
    study, run = wildcards.study, wildcards.run
    folder, bed = Path("results") / study, STUDIES[study].bed_of(run)
    again_if_unrecorded(folder / run / "wear.csv", partial(other_run, study, run))
    if bed:
        filled = partial(other_bed, folder / "beds" / bed, STUDIES[study].case, STUDIES[study].beds[bed])
        again_if_unrecorded(folder / "beds" / bed / "cost.csv", filled)
    return str(folder / run / "surface.vtu")


def other_run(study, run):
    """From what else a run was simulated."""
    case, parameters, _, found = made_from(study, run)
    folder = Path("results") / study / run
    return other_inputs(folder, found) or other_length(folder, case, parameters)


def again_if_unrecorded(made, other):
    """Have a file made again that exists, of which Snakemake has no record, and that was made otherwise; say why.

    other: a function that tells from what else, in a phrase
    """
    if GIVEN.target_jobs or GIVEN.touch or RerunTrigger.PARAMS not in workflow.rerun_triggers or not made.exists():
        return
    if workflow.persistence.metadata(IOFile(str(made))) is not None or str(made) in workflow.dag.forcefiles:
        return
    if why := other():
        workflow.dag.forcefiles.add(str(made))  # as Snakemake does with what an interrupted job has left
        logger.info(f"{made.parent} is made again: {why}, and .snakemake has no record of it.")


def batch_of(wildcards):
    """How many simulations a calibration does at a time."""
    from bulkwear.workflows.cases.calibration.case import calibration_box  # slow to import

    return calibration_box(study_of(wildcards))["calibration"]["batch"]


def measured_of(wildcards):
    """The table of measured responses; see `again_if_unrecorded`."""
    from bulkwear.workflows.cases.calibration.case import calibration_box, measured_file
    from bulkwear.workflows.cases.calibration.kept import other_calibration  # slow to import

    study, made = study_of(wildcards), Path(f"results/{wildcards.study}/simulations.csv")
    measured = measured_file(study)
    again_if_unrecorded(made, lambda: other_calibration(calibration_box(study), Path(measured), made))
    return measured


def pairs_of_sizes(wildcards):
    """The table of pairs that others simulated; see `again_if_unrecorded`."""
    from bulkwear.workflows.cases.calibration.case import pairs_file
    from bulkwear.workflows.cases.calibration.kept import other_box_sizes  # slow to import

    study, made = study_of(wildcards), Path(f"results/{wildcards.study}/box_sizes.csv")
    runs, pairs = {run.name: run.parameters for run in study.runs}, pairs_file(study)
    again_if_unrecorded(made, lambda: other_box_sizes(runs, Path(pairs), made))
    return pairs


def nothing_before_packings(wildcards):
    """No input; see `again_if_unrecorded`."""
    from bulkwear.workflows.cases.sliding_sample.particle_size.kept import other_containers  # slow to import
    from bulkwear.workflows.cases.sliding_sample.particle_size.study import packed_runs
    from bulkwear.workflows.config.units import to_si

    study, made = study_of(wildcards), Path(f"results/{wildcards.study}/packings/profiles.csv")
    packing = to_si(study.settings)["packing"]
    again_if_unrecorded(made, lambda: other_containers(packed_runs(study), packing, made))
    return []


def same_run(wildcards):
    """The table of the run that simulates this one as well; nothing where the run is simulated itself."""
    same = study_of(wildcards).same_as(wildcards.run)
    return [f"results/{wildcards.study}/{same}/wear.csv"] if same else []


def of_every_run(pattern):
    """An input function: a path pattern with {study} and {run}, expanded over the runs of the study."""

    def paths(wildcards):
        return [pattern.format(study=wildcards.study, run=run.name) for run in study_so_far(wildcards).runs]

    return paths


def costs_of_runs(wildcards):
    """The tables of what the wear cycles of each run took, where a study has wear cycles."""
    return of_every_run("results/{study}/{run}/cost.csv")(wildcards) if study_of(wildcards).case.wears else []


def study_decks(study):
    """The decks of a study, rendered without the solver; of the packings that are simulated first."""
    first = STUDIES[study].with_packings(STUDIES[study].first_packings)
    files = first.case.deck_files([run.name for run in first.runs], list(first.beds))
    return [f"results/{study}/decks/{name}" for name in files]


def input_of(source):
    """An input of a rule: a path, or an input function."""
    return looked_up(source) if isinstance(source, str) else lambda wildcards: paths_of(source, study_so_far(wildcards))


def in_report(product, paths):
    """The outputs of a product, marked for Snakemake's own report; the captions lie beside the rule."""
    if not product.is_figure:
        return {key: table_in_report(path) for key, path in paths.items()}
    titles = {"figure": product.title}
    if product.suffix == "gif":  # that report shows no film, it saves one
        titles["still"] = f"{product.title}: its last picture"
    flagged = {
        key: report(paths[key], caption="caption.rst", category=product.category, labels={"figure": title})
        for key, title in titles.items()
        if key in paths
    }
    return {**paths, **flagged}


def table_in_report(path, captions=""):
    """A path, marked for Snakemake's own report where it is that of a table beside the page: others may be large."""
    folder, _, name = path.rpartition("/")
    if folder != "results/{study}" or not name.endswith(".csv"):
        return path
    shown = name.removesuffix(".csv").replace("_", " ")
    return report(path, caption=f"{captions}table.rst", category="Tables", labels={"table": shown})


def told_of(product):
    """A param: what a product is told of a study."""
    return lambda wildcards: told_to(product, study_so_far(wildcards))


def code_of_pages(*modules):
    """A param: the hash of what tables, figures or a page that modules make depend on beside results and configuration.

    Without modules, of what the case makes.
    """
    return lambda wildcards: code_by_name(wildcards.study, modules or (type(study_of(wildcards).case).__module__,))


@cache  # many figures are of one module
def code_by_name(study, modules):
    return code_of(STUDIES[study], *modules)


def used_rates(wildcards=None):
    """The rates that were measured on this machine, or the default ones."""
    return str(rates_file())


def solver_work(study):
    """A function of wildcards: the jobs of a study that call the solver, with their sizes."""

    def work(wildcards):
        from bulkwear.workflows.forecast.forecast import work_of  # slow to import, and most jobs ask for no forecast

        return work_of(STUDIES[study].foreseen)

    return work


def ranks_of(wildcards):
    return study_of(wildcards).settings["solver"]["ranks"]


def submitted(wildcards):
    """A resource: 1 where a cluster's job runs this Snakemake, 0 where it was called, though in an allocation."""
    return int(workflow.remote_exec)


def launcher_of(wildcards):
    """The program that starts the ranks of a solver; none for one rank."""
    return LAUNCHER if ranks_of(wildcards) > 1 else None


@cache
def demands_of(study):
    from bulkwear.workflows.forecast.forecast import demands  # slow to import, and few jobs ask for it

    return demands(STUDIES[study])


def asked(rule, measure):
    """A resource function: a demand of jobs of a rule, more at every attempt; measure 0 is min, 1 is MB, 2 is core min."""

    def amount(wildcards, attempt):
        words = dict(wildcards.items())
        return attempt * demands_of(words.pop("study"))["_".join([rule, *words.values()])][measure]

    return amount
