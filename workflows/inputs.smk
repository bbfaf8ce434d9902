"""Input functions and params of runs and beds: what each is made from, and made again when that changes; where packings
or rows are found in rounds, what each round looks at, and what the last one decided."""

import itertools
from functools import cache, partial
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.io import IOFile
from snakemake.settings.types import RerunTrigger

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.packings import possible_packings
from bulkwear.workflows.config.rounds import read_round
from bulkwear.workflows.config.targets import triggers_sentence
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
