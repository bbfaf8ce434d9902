"""Turn a study's configuration into runs: merge, check, convert to SI, derive.

    default.yaml <- case <- study <- fidelity block <- command line   settings, in the units that their keys spell;
                                                                      the project's default and case over the package's
    settings x design row x surface -> Run.parameters                 SI, JSON-able

Configuration faults raise ConfigError, one sentence each.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial, reduce
from pathlib import Path
from typing import Any

from bulkwear.workflows.config.chosen import ROWS, chosen_rows, is_wanted, runs_of_rows
from bulkwear.workflows.config.coefficients import (
    alternatives_of,
    check_hardness,
    with_coefficients,
)
from bulkwear.workflows.config.columns import as_settings, check_heard, opened, row_overrides, setting_columns, with_row
from bulkwear.workflows.config.contact_checks import CONTACT_CHECKS
from bulkwear.workflows.config.deck_checks import check_own_words, template_faults_told
from bulkwear.workflows.config.factors import FACTORS, can_tell, factors_of
from bulkwear.workflows.config.law_settings import check_law, check_volume
from bulkwear.workflows.config.laws_beside import check_beside
from bulkwear.workflows.config.layers import ConfigError, Layer, display_name
from bulkwear.workflows.config.materials import check_calibrated_for, check_material_names, check_materials
from bulkwear.workflows.config.optimise import search_digest, with_search
from bulkwear.workflows.config.packings import PACKINGS, Packings, with_packings, without_packings
from bulkwear.workflows.config.pin_checks import PIN_RANGE_CHECKS
from bulkwear.workflows.config.run_checks import (
    COMMON_CHECKS,
    LAST_CHECKS,
    CheckedRun,
    check_needed,
    check_run,
)
from bulkwear.workflows.config.schema import case_schema, load_schema
from bulkwear.workflows.config.sources import (
    Sources,
    fidelity_of,
    read_materials,
    read_sources,
)
from bulkwear.workflows.config.study import Study
from bulkwear.workflows.config.study_files import DESIGN, STUDIES, list_studies
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.config.until import GOALS, UNTIL
from bulkwear.workflows.config.validation import (
    as_told,
    check_given,
    locate,
    read_design,
    show,
    unknown_name,
    with_place,
)
from bulkwear.workflows.engine.case import Run
from bulkwear.workflows.engine.chain import sample_decks
from bulkwear.workflows.engine.derived import laws_beside
from bulkwear.workflows.engine.project import Project, current_project
from bulkwear.workflows.engine.template_files import templates_read_once

__all__ = ["ConfigError", "Run", "Study", "confirmation_design", "list_studies", "load_study"]

TARGETS = ("_decks", "_forecast")  # endings of targets that each study has besides its own name
CONFIRMATION = "_confirmation"  # ends the name of the study that simulates what a study's regression found best
STUDY_NAME = re.compile(r"(?!figure_|tables_)[a-z][a-z0-9_]*")  # rules of figures and tables begin so
RULE_NAMES = frozenset(
    found[1]
    for path in (*Path(__file__).parents[1].rglob("*.smk"), Path(__file__).parents[2] / "Snakefile")
    for found in re.finditer(r"^(?:rule|checkpoint) (\w+):", path.read_text(encoding="utf-8"), re.MULTILINE)
)
RULES_SAID, DESIGNS = ", ".join(sorted(RULE_NAMES)), "config/designs"


@templates_read_once()
@template_faults_told()
def load_study(name: str, project: Project | None = None, overrides: dict[str, Any] | None = None) -> Study:
    """Return a checked study of a project, by default the current one, or of the package, with all its runs.

    `overrides` are nested settings, as from the command line: {"fidelity": "standard", "particle_scale": 2}.
    <name>_confirmation is the study with everything of <name> but its design, which is that of its best designs.
    Raises ConfigError: one sentence with file, line, key or row, the value found and what is allowed.
    """
    project = project or current_project()
    if not STUDY_NAME.fullmatch(name) or name in RULE_NAMES or name.endswith(TARGETS):
        raise ConfigError(
            f"config/studies/{name}.yaml: a study cannot be called {name}, allowed are small letters, digits and"
            f" underscores, not figure_ or tables_ first or {' or '.join(TARGETS)} last, and none of {RULES_SAID}."
        )
    studies = list_studies(project)
    confirms = name.removesuffix(CONFIRMATION) if name not in studies and name.endswith(CONFIRMATION) else ""
    if (confirms or name) not in studies:
        raise ConfigError(unknown_name(STUDIES, "study", confirms or name, studies))
    sources = read_sources(confirms or name, project, overrides)
    fidelity = fidelity_of(sources)
    layers = sources.stack(fidelity)
    check_law(layers)
    check_beside(layers)
    settings = sources.merged(layers)
    materials = check_materials(read_materials(settings, project))
    head = sources.head
    wanted = [] if confirms else settings.get(ROWS, [])
    written = (
        _rows_to_confirm(sources, confirms, project) if confirms else _design_rows(sources, fidelity, project, wanted)
    )
    checked_runs = partial(_checked_runs, sources, layers, settings, materials)
    digest = search_digest(settings, written)
    written = _placed(layers, with_search, written, settings, head, checked_runs, project.folder / "results" / name)
    designed = _packings(sources, layers, settings, written)
    rows = list(designed.rows) if confirms else chosen_rows(layers, settings, designed)
    runs_of = runs_of_rows(designed.added_last(), rows, checked_runs)
    factors = {} if confirms else factors_of(sources, designed, wanted)
    paper = sources.stack("paper")[:-1]
    study = Study(
        name=name,
        case=sources.case,
        title=f"{head['title']}: the best designs simulated" if confirms else head["title"],
        question="Do runs of each best design wear what was predicted?" if confirms else head["question"],
        fidelity=fidelity,
        settings=_told(sources, layers, settings, materials),
        runs=tuple(run for row in rows for run in runs_of[row.values["row"]]),
        all_runs=tuple(run for runs in runs_of.values() for run in runs),
        design_rows=tuple(as_told(row.values) for row in rows),
        setting_of=designed.setting_of,
        packing_of=designed.packing_of,
        factors=factors if can_tell(factors, designed, rows) else {},
        paper_settings=_told(sources, paper, sources.merged(paper), materials),
        materials=materials,
        head=head,
        first_packings=designed.first(settings, rows),
        confirms=confirms,
        search_digest=digest,
        runs_of=checked_runs,
    )
    _check_own_code(study, layers)
    return study


def _told(
    sources: Sources, layers: tuple[Layer, ...], settings: dict[str, Any], materials: dict[str, Any]
) -> dict[str, Any]:
    """Return settings as pages tell them, with the wear coefficients that follow from materials."""
    return with_coefficients(sources.case, settings, materials, sources.of_coefficient(layers))


def _check_own_code(study: Study, layers: tuple[Layer, ...]) -> None:
    """Check a project's own laws, and its words of templates on the first run. Raises ConfigError."""
    first, project = study.runs[0], current_project()
    case, runs = study.case, [run.parameters for run in study.runs] if project.own_laws else []
    given = {law: values for run in runs for law, values in (*case.laws(run), *laws_beside(run))}
    for law, values in given.items():
        if file := project.law_file(law):
            check_volume(law, values, file)
    decks = partial(sample_decks, study.case, first.parameters, study.beds.get(study.bed_of(first.name)))
    check_own_words(layers, study.case, study.settings.get("deck", {}), decks)


def confirmation_design(study: str) -> str:
    """Return the path, from the repository, of the design table of a study's best designs."""
    return f"results/{study}/confirmation/design.csv"


def _rows_to_confirm(sources: Sources, study: str, project: Project) -> list[Layer]:
    """Return the checked rows of a study's best designs. Raises ConfigError where there are none (yet)."""
    if not sources.study.values.get(FACTORS):
        raise ConfigError(
            f"{sources.study.source}: {study} has nothing to confirm, allowed is a study with factors, whose regression"
            " finds a best design."
        )
    path = project.folder / confirmation_design(study)
    if not path.is_file():
        shown = display_name(path, project.folder)
        raise ConfigError(f"{shown}: there is no such file yet, `snakemake {study}` writes it.")
    return read_design(path, project.folder, sources.design_schema)


def _design_rows(sources: Sources, fidelity: str, project: Project, chosen: list[str]) -> list[Layer]:
    """Return the checked rows of the study's design table, or of the fidelity's own. Raises ConfigError.

    chosen: names of the rows that are simulated, none where all are
    """
    block = sources.block(fidelity)
    source = block if DESIGN in block.values else sources.study
    name, there = source.values[DESIGN], project.names(DESIGNS, ".csv")
    if name not in there:
        raise ConfigError(unknown_name(source.where((DESIGN,)), DESIGN, name, there))
    path = project.file(f"{DESIGNS}/{name}")
    schema = opened(sources.design_schema, path, project, sources.case.name)
    rows = read_design(path, project.folder, schema, partial(is_wanted, chosen=chosen))
    if not chosen and (fault := sources.case.design_fault([row.values for row in rows])):
        raise ConfigError(f"{display_name(path, project.folder)}: {fault}.")
    check_heard(sources.command, rows, schema)
    return rows


def _packings(sources: Sources, layers: tuple[Layer, ...], settings: dict[str, Any], rows: list[Layer]) -> Packings:
    """Return the rows of a design with all their packings. Raises ConfigError, as for several where there is no bed."""
    case = sources.case
    if missing := [key for key in GOALS if key not in settings.get(UNTIL, dict.fromkeys(GOALS))]:
        raise ConfigError(
            f"{locate(layers, (UNTIL,))}: {UNTIL}.{missing[0]} is missing, allowed are {', '.join(GOALS)} together."
        )
    if case.seed_setting:
        column = setting_columns(load_schema(f"cases/{case.name}/design"))[case.seed_setting]
        return with_packings(rows, settings, column, reduce(dict.__getitem__, case.seed_setting.split("."), settings))
    if settings[PACKINGS] > 1 or UNTIL in settings:
        key, allowed = (PACKINGS, "1") if settings[PACKINGS] > 1 else (UNTIL, "no such block")
        raise ConfigError(
            f"{locate(layers, (key,))}: {key} is {show(settings[key])}, allowed is {allowed} in studies of case"
            f" {case.name}: {case.one_packing}."
        )
    return without_packings(rows)


def _checked_runs(
    sources: Sources,
    layers: tuple[Layer, ...],
    settings: dict[str, Any],
    materials: dict[str, Any],
    row: Layer,
) -> list[Run]:
    """Return the runs of a row, one per surface, after all checks that need no solver. Raises ConfigError."""
    return [
        _checked_run(sources, layers, settings, materials, row, surface)
        for surface in sources.case.surfaces(sources.head)
    ]


def _checked_run(
    sources: Sources,
    layers: tuple[Layer, ...],
    settings: dict[str, Any],
    materials: dict[str, Any],
    row: Layer,
    surface: str,
) -> Run:
    """Return one run after all checks that need no solver. Raises ConfigError."""
    case = sources.case
    columns = row_overrides(row, load_schema(f"cases/{sources.case.name}/design"))
    own = as_settings(row, columns)
    of_row = with_row(settings, own, alternatives_of(case, own.values))
    schema, stack = case_schema(sources.case.name, "settings"), (*layers, own)
    check_given((own, *layers), of_row, schema)
    named = case.named_materials(of_row)
    check_material_names(stack, of_row, materials, named)
    check_calibrated_for(stack, of_row, materials, named, case.looks_for(of_row))
    of_row = with_coefficients(case, of_row, materials, sources.of_coefficient(stack))
    check_hardness(stack, case, of_row)
    check_needed(layers, of_row, schema, "pattern", case.needed_pattern_keys(of_row, surface))
    given = (to_si(of_row), to_si(materials), to_si(row.values), surface)
    parameters = _placed(stack, case.run_parameters, *given)
    check_run(
        CheckedRun(layers, of_row, row, parameters, columns),
        (*COMMON_CHECKS, *CONTACT_CHECKS, *PIN_RANGE_CHECKS, *case.checks, *LAST_CHECKS),
    )
    name = row.values["row"]
    return Run(name=f"{name}_{surface}" if surface else name, row=name, surface=surface, parameters=parameters)


def _placed(layers: tuple[Layer, ...], function: Callable[..., Any], *given: Any) -> Any:
    """Return what a function makes of what it is given; its ConfigError of a setting gets that one's place."""
    try:
        return function(*given)
    except ConfigError as fault:
        raise ConfigError(with_place(layers, str(fault))) from None
