"""Where a study's settings come from: its own file, defaults of package and project, materials, the command line.

Each file is checked by itself, so that a fault is reported where it stands.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

from bulkwear.workflows.config.coefficients import COEFFICIENTS, WEAR, alternatives_of
from bulkwear.workflows.config.law_settings import PARAMETERS, law_settings
from bulkwear.workflows.config.laws_beside import beside_settings
from bulkwear.workflows.config.layers import (
    ConfigError,
    Layer,
    command_line_layer,
    display_name,
    extended,
    merge,
    overridden,
    read_yaml,
)
from bulkwear.workflows.config.schema import case_schema, coerce_numbers, joined, load_schema, without_required
from bulkwear.workflows.config.study_files import (
    CASE,
    DESIGN,
    FIDELITIES,
    block_of,
    check_case,
    joined_study,
    read_study,
)
from bulkwear.workflows.config.validation import check_alternatives, check_layer, own_columns, unknown_name
from bulkwear.workflows.engine.case import DEFAULT_CASE, Case
from bulkwear.workflows.engine.cases import case_folders, case_names, find_case
from bulkwear.workflows.engine.project import Project
from bulkwear.workflows.engine.worn_pair import BESIDE, COEFFICIENT_ERROR

MATERIALS = "materials.yaml"  # in config, where a study names no other


@dataclass(frozen=True)
class Sources:
    """Where settings come from; `study` also holds the keys that are the study's own.

    shared, of_case: defaults of all cases, and of this one, the package's before the project's
    """

    case: Case
    shared: tuple[Layer, ...]
    of_case: tuple[Layer, ...]
    study: Layer
    command: Layer

    @property
    def defaults(self) -> tuple[Layer, ...]:
        return (*self.shared, *self.of_case)

    @property
    def head(self) -> dict[str, Any]:
        own = case_schema(self.case.name, "study")["properties"]
        return {key: value for key, value in self.study.values.items() if key in own}

    @property
    def study_settings(self) -> Layer:
        return self.study.part(set(self.study.values) - set(self.head))

    @property
    def design_schema(self) -> dict[str, Any]:
        """The schema of a design row, with the columns that the study's surfaces need."""
        schema, case = load_schema(f"cases/{self.case.name}/design"), self.case
        needed = {column for surface in case.surfaces(self.study.values) for column in case.needed_columns(surface)}
        return {**schema, "required": [c for c in schema["properties"] if c in needed or c in schema["required"]]}

    def block(self, fidelity: str) -> Layer:
        return block_of(self.study, fidelity)

    @property
    def partial_layers(self) -> list[Layer]:
        """All layers that override some keys: the study's, those of its fidelities and the command line."""
        blocks = [self.block(fidelity) for fidelity in self.study.values.get(FIDELITIES, {})]
        return [self.study_settings, *blocks, self.command]

    def stack(self, fidelity: str) -> tuple[Layer, ...]:
        """Return the layers from the weakest to the strongest."""
        block = self.block(fidelity)
        return (
            *(*self.defaults, self.study_settings),
            *(block.part(set(block.values) - {DESIGN}), self.command),
        )

    def of_coefficient(self, layers: Sequence[Layer]) -> set[str]:
        """Return what the section `wear` of these layers gives of its coefficient before a pair of materials does: a
        coefficient above what all cases share, its error above all defaults.
        """
        places = [*((key, self.shared) for key in COEFFICIENTS), (COEFFICIENT_ERROR, self.defaults)]
        return {key for key, weaker in places for each in layers if each not in weaker and each.holds((WEAR, key))}

    def merged(self, layers: tuple[Layer, ...]) -> dict[str, Any]:
        """Return the settings of the layers, the last one strongest."""
        settings: dict[str, Any] = {}
        for layer in layers:
            settings = overridden(settings, layer, alternatives_of(self.case, layer.values))
        told = {PARAMETERS: law_settings(layers), BESIDE: beside_settings(layers)}
        rest = {key: value for key, value in settings[WEAR].items() if key not in told}
        settings[WEAR] = rest | {key: found for key, found in told.items() if found}
        return coerce_numbers(settings, case_schema(self.case.name, "settings"))


def read_sources(name: str, project: Project, overrides: dict[str, Any] | None) -> Sources:
    """Return the sources of a study, each checked by itself so that a fault is reported where it stands."""
    files = read_study(name, project)
    named = reduce(extended, (file.part({CASE}) for file in files))
    check_layer(named, without_required(load_schema("study")))
    case = find_case(named.values.get(CASE, DEFAULT_CASE))
    check_case(files, case)
    shared, own = load_schema("settings"), load_schema(f"cases/{case.name}/settings")
    for stray in set(project.names("config/cases", ".yaml")) - {f"{name}.yaml" for name in case_names()}:
        raise ConfigError(unknown_name(f"config/cases/{stray}", "case", stray.removesuffix(".yaml"), case_names()))
    default = _read_defaults(["config/default.yaml"], project, shared)
    folders = [f"config/cases/{folder.name}.yaml" for folder in reversed(case_folders(case))]
    of_case = _read_defaults(folders, project, joined(without_required(shared), own))
    partial = without_required(joined(shared, own))
    columns = own_columns(load_schema(f"cases/{case.name}/design"))
    study = joined_study(files, case, partial, columns)
    sources = Sources(case, default, of_case, study, command_line_layer(overrides))
    check_layer(sources.command, partial, columns)
    check_alternatives(of_case[0], case.alternatives, required=True)
    for layer in (*sources.defaults, *sources.partial_layers):
        for alternatives in alternatives_of(case, layer.values):
            check_alternatives(layer, alternatives, required=False)
    return sources


def _read_defaults(names: list[str], project: Project, schema: dict[str, Any]) -> tuple[Layer, ...]:
    """Return the files of defaults, the weaker first: of each name the package's, then the project's.

    Together they give every key that the schema requires.
    """
    files = [path for name in names for path in reversed(project.every(name))] or [project.file(names[-1])]
    layers = tuple(read_yaml(path, project.folder) for path in files)
    if len(layers) > 1:
        for layer in layers:
            check_layer(layer, without_required(schema))
    whole = reduce(merge, (layer.values for layer in layers), {})
    lines = layers[0].lines if len(layers) == 1 else {}
    check_layer(Layer(display_name(project.file(names[-1]), project.folder), whole, lines), schema)
    return layers


def fidelity_of(sources: Sources) -> str:
    """Return the fidelity asked for: command line, else study, else default; the study must offer it."""
    layers = (*sources.defaults, sources.study_settings, sources.command)
    source = next(layer for layer in reversed(layers) if "fidelity" in layer.values)
    fidelity = source.values["fidelity"]
    offered = sources.study.values.get(FIDELITIES)
    if offered is not None and fidelity not in offered:
        raise ConfigError(
            f"{source.where(('fidelity',))}: fidelity is '{fidelity}',"
            f" allowed is one of {', '.join(offered)}, the fidelities of {sources.study.source}."
        )
    return fidelity


def read_materials(settings: dict[str, Any], project: Project) -> list[Layer]:
    """Return the files of a study's materials, the weaker first: in config of package and project, whose materials are
    added to the package's or stand for those of their name; or any other file, as a calibration writes it.
    """
    name = settings.get("materials", MATERIALS)
    elsewhere = project.folder / name
    files = project.every(f"config/{name}") or [
        elsewhere if os.path.isfile(elsewhere) else project.file(f"config/{name}")
    ]
    return [read_yaml(path, project.folder) for path in reversed(files)]
