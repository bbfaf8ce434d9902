"""Files of studies: which there are, and a study from its own and those of the studies that it extends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bulkwear.workflows.config.coefficients import alternatives_of
from bulkwear.workflows.config.layers import ConfigError, KeyPath, Layer, extended, read_yaml
from bulkwear.workflows.config.schema import case_schema, load_schema, without_required
from bulkwear.workflows.config.validation import check_layer, unknown_name
from bulkwear.workflows.engine.case import DEFAULT_CASE, Case
from bulkwear.workflows.engine.cases import case_folders, case_names
from bulkwear.workflows.engine.project import Project, current_project

STUDIES = "config/studies"
CASE, EXTENDS, FIDELITIES = "case", "extends", "fidelities"  # keys of a study
DESIGN = "design"  # of a study, and of its fidelity blocks
ITS_OWN = ("title", "question")  # keys that a study which extends another needs


def list_studies(project: Project | None = None) -> list[str]:
    """Return the names of the studies of a project, by default the current one, and of the package."""
    return [name.removesuffix(".yaml") for name in (project or current_project()).names(STUDIES, ".yaml")]


def own_studies(project: Project) -> list[str]:
    """Return the names of the studies that are the project's own."""
    return sorted(path.stem for path in (project.folder / STUDIES).glob("*.yaml"))


def read_study(name: str, project: Project) -> list[Layer]:
    """Return the files of a study, that of one that it extends before its own.

    Raises ConfigError for a name that project and package both have, and for studies that extend one another.
    """
    files, names = [_study_file(name, project)], [name]
    while EXTENDS in files[0].values:
        check_layer(files[0].part({EXTENDS}), without_required(load_schema("study")))
        where, named = files[0].where((EXTENDS,)), files[0].values[EXTENDS]
        if named in names:
            raise ConfigError(f"{where}: {EXTENDS} is {named}, which leads back to it, allowed is another study.")
        if named not in list_studies(project):
            raise ConfigError(unknown_name(where, EXTENDS, named, list_studies(project)))
        if missing := [key for key in ITS_OWN if key not in files[0].values]:
            raise ConfigError(
                f"{files[0].source}: {missing[0]} is missing, allowed is one of its own: not that of {named}, which it"
                " extends."
            )
        files, names = [_study_file(named, project), *files], [named, *names]
    return files


def _study_file(name: str, project: Project) -> Layer:
    """Return the file of a study alone. Raises ConfigError for a name that project and package both have."""
    files = project.every(f"{STUDIES}/{name}.yaml")
    if not files:
        raise ConfigError(
            f"{STUDIES}/{name}.yaml: found no such file, a folder perhaps; allowed is the file of a study."
        )
    if len(files) > 1:
        raise ConfigError(
            f"{STUDIES}/{name}.yaml: a study {name} is in the package too, {files[1]}, allowed is a name of its own: "
            f"none of {', '.join(path.stem for path in sorted(files[1].parent.glob('*.yaml')))}."
        )
    return read_yaml(files[0], project.folder)


def check_case(files: Sequence[Layer], case: Case) -> None:
    """Raise ConfigError where a study is of another case than the one that it extends, and not of one made of that."""
    first = files[0].values.get(CASE, DEFAULT_CASE)
    if first not in [folder.name for folder in case_folders(case)]:
        where = next(file.where((CASE,)) for file in reversed(files) if CASE in file.values)
        raise ConfigError(
            f"{where}: case is {case.name}, allowed is {first}, that of {files[0].source}, or a case that extends it."
        )


def joined_study(files: Sequence[Layer], case: Case, settings: Mapping[str, Any], columns: Sequence[str]) -> Layer:
    """Return the layer of a study from its files, each checked before it is joined: the one that extends others last.

    settings: their schema, in which none is required; columns: of the design that stand for no setting
    Raises ConfigError.
    """
    is_case_named = any(CASE in file.values for file in files)
    of_study = case_schema(case.name, "study")
    whole = {**of_study, "properties": of_study["properties"] | settings["properties"]}
    offered = {k: v for k, v in settings["properties"].items() if k != "fidelity"}
    within_block = {**settings, "properties": offered | {DESIGN: of_study["properties"][DESIGN]}}
    study = None
    for file in files:
        if not is_case_named:
            _check_case_meant(file, case.name, whole["properties"])
        check_layer(file, without_required(whole), columns)
        for fidelity in file.values.get(FIDELITIES, {}):
            check_layer(block_of(file, fidelity), within_block, columns)
        study = file if study is None else extended(study, file, _replaced(case, study, file))
        check_layer(study, whole, columns)
    return study


def block_of(study: Layer, fidelity: str) -> Layer:
    """Return the block of a fidelity as a layer of its own, empty where there is none."""
    return study.inner((FIDELITIES, fidelity), f"fidelity {fidelity}")


def _replaced(case: Case, lower: Layer, upper: Layer) -> Iterator[KeyPath]:
    """Yield the paths of keys of a study for which keys stand of one that extends it: the alternatives of these, and in
    its fidelities what the other one gives for all fidelities.
    """
    blocks = {(FIDELITIES, name): block or {} for name, block in upper.values.get(FIDELITIES, {}).items()}
    own = {key: value for key, value in upper.values.items() if key != FIDELITIES}
    for place, values in {(): own, **blocks}.items():
        given = Layer(upper.source, values)
        groups = [group for group in alternatives_of(case, values) if any(given.holds(path) for path in group)]
        others = [path for group in groups for path in group]
        yield from ((*place, *path) for path in others)
        if not place:
            within = lower.values.get(FIDELITIES, {})
            yield from ((FIDELITIES, name, *path) for name in within for path in (*others, *_leaves(values)))


def _leaves(values: Mapping[str, Any]) -> Iterator[KeyPath]:
    for key, value in values.items():
        yield from ((key, *rest) for rest in _leaves(value)) if isinstance(value, dict) else [(key,)]


def _check_case_meant(study: Layer, case: str, allowed: Mapping[str, Any]) -> None:
    """Raise ConfigError for a study without a case, with a key that its case, the default, has not, but others have."""
    for key in (key for key in study.values if key not in allowed):
        others = [other for other in case_names() if key in load_schema(f"cases/{other}/settings")["properties"]]
        if others:
            raise ConfigError(
                f"{study.where((key,))}: {key} is a key of {', '.join(others)}, and the study names no case, which is"
                f" {case} then; allowed is case: {others[0]}, or none of its keys."
            )
