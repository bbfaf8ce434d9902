"""What is checked and said when Snakemake starts its jobs and when all have ended."""

from pathlib import Path

from snakemake.exceptions import WorkflowError

from bulkwear.workflows.engine.solver import cycle_fault, executable_of
from bulkwear.workflows.engine.study_folder import StudyFolderError, date_back, take
from bulkwear.workflows.forecast.rates import damage_of, rates_file
from bulkwear.workflows.report import figure_process

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
