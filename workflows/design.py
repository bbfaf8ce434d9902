"""Turn a study's configuration into runs: merge, check, convert to SI, derive.

    default.yaml <- study <- fidelity block <- command line   settings, in the units that their keys spell
    settings x design row x surface -> Run.parameters         SI, JSON-able

This is the only module that converts units. Configuration faults raise ConfigError, one sentence each.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from workflows.config_files import ConfigError, Layer, command_line_layer, merge, read_yaml
from workflows.derived import ADAPTIVE, derived_parameters, rolling_coefficient_for_solver
from workflows.run_checks import Case, check_run
from workflows.validation import (
    TRAVELS,
    check_layer,
    check_material_names,
    check_materials,
    check_travel,
    coerce_numbers,
    load_schema,
    read_design,
    unknown_name,
    without_required,
)

__all__ = [
    "ConfigError",
    "Run",
    "Study",
    "bed_parameters",
    "list_studies",
    "load_study",
    "rolling_coefficient_for_solver",
]

SECONDS_PER_HOUR = 3600.0
STUDY_NAME = re.compile(r"[a-z][a-z0-9_]*")
RULE_NAMES = frozenset(
    found[1]
    for path in Path(__file__).parent.glob("*.smk")
    for found in re.finditer(r"^rule (\w+):", path.read_text(encoding="utf-8"), re.MULTILINE)
)
REPOSITORY = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Run:
    """One simulation: a row of the design with one surface.

    `parameters` holds ledger (solver or dumps) and the sections sample, pattern (None for a plain plate), bed,
    sliding, wear, solver, particle, sample_material, floor_material and derived; SI, the unit is the suffix of the key.
    """

    name: str
    row: str
    surface: str
    parameters: dict[str, Any]


@dataclass(frozen=True)
class Study:
    """A checked study. `settings` are merged, in the units that their keys spell; so are `design_rows`."""

    name: str
    title: str
    question: str
    fidelity: str
    settings: dict[str, Any]
    runs: tuple[Run, ...]
    design_rows: tuple[dict[str, Any], ...]
    paper_settings: dict[str, Any]

    def run(self, name: str) -> Run:
        """Return the run of that name. Raises ConfigError naming the runs there are."""
        found = next((run for run in self.runs if run.name == name), None)
        if found is None:
            raise ConfigError(unknown_name(f"study {self.name}", "run", name, [run.name for run in self.runs]))
        return found

    def design_table(self) -> list[dict[str, Any]]:
        """Return one row per run: run, row, surface, the factors with their units, and what follows from them.

        The equivalent size ratio is the particle's over the bump's, alpha_ER of Yan 2022, Eq 4.18.
        """
        factors = {str(row["row"]): {k: v for k, v in row.items() if k != "row"} for row in self.design_rows}
        return [
            {
                "run": run.name,
                "row": run.row,
                "surface": run.surface,
                **factors[run.row],
                "particle_scale": run.parameters["particle"]["scale"],
                "layers": run.parameters["derived"]["layers"],
                "equivalent_size_ratio": run.parameters["derived"]["equivalent_size_ratio"],
            }
            for run in self.runs
        ]

    @cached_property
    def _beds(self) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
        beds: dict[str, dict[str, Any]] = {}
        bed_of = {}
        clearance = max(run.parameters["derived"]["highest_point_m"] for run in self.runs)
        for run in self.runs:
            wanted = {**bed_parameters(run), "temporary_floor_m": clearance}
            name = next((name for name, bed in beds.items() if bed == wanted), f"bed_{len(beds) + 1}")
            beds[name], bed_of[run.name] = wanted, name
        return beds, bed_of

    @property
    def beds(self) -> dict[str, dict[str, Any]]:
        """Return {bed id: parameters}; runs with equal parameters share a bed.

        Beds settle on a temporary floor (`temporary_floor_m`) above the highest bump of the whole study.
        """
        return self._beds[0]

    def bed_of(self, run_name: str) -> str:
        """Return the id of the bed that a run starts from. Raises ConfigError for an unknown run."""
        return self._beds[1][self.run(run_name).name]


def list_studies(root: Path = REPOSITORY) -> list[str]:
    """Return the names of the studies in config/studies."""
    return sorted(path.stem for path in (Path(root) / "config" / "studies").glob("*.yaml"))


def load_study(name: str, root: Path = REPOSITORY, overrides: dict[str, Any] | None = None) -> Study:
    """Return a checked study with all its runs.

    `overrides` are nested settings, as from the command line: {"fidelity": "standard", "particle_scale": 2}.
    Raises ConfigError: one sentence with file, line, key or row, the value found and what is allowed.
    """
    root = Path(root)
    if not STUDY_NAME.fullmatch(name) or name in RULE_NAMES or name.endswith("_decks"):
        raise ConfigError(
            f"config/studies/{name}.yaml: a study cannot be called {name}, allowed are small letters, digits and"
            f" underscores, not ending in _decks, and none of {', '.join(sorted(RULE_NAMES))}."
        )
    if name not in list_studies(root):
        raise ConfigError(unknown_name("config/studies", "study", name, list_studies(root)))
    sources = _read_sources(name, root, overrides)
    fidelity = _fidelity(sources)
    layers = sources.stack(fidelity)
    settings = _merged(layers)
    materials = check_materials(read_yaml(root / "config" / "materials.yaml", root))
    check_material_names(layers, settings, materials)
    head = sources.study.values
    rows = _design_rows(sources.study, root)
    runs = tuple(
        _checked_run(layers, settings, materials, row_layer, surface)
        for row_layer in rows
        for surface in head["surfaces"]
    )
    return Study(
        name=name,
        title=head["title"],
        question=head["question"],
        fidelity=fidelity,
        settings=settings,
        runs=runs,
        design_rows=tuple(row_layer.values for row_layer in rows),
        paper_settings=_merged(sources.stack("paper")[:-1]),
    )


@dataclass(frozen=True)
class _Sources:
    """Where settings come from; `study` also holds the keys that are the study's own."""

    default: Layer
    study: Layer
    command: Layer

    @property
    def study_settings(self) -> Layer:
        return self.study.part(set(self.study.values) - set(load_schema("study")["properties"]))

    def block(self, fidelity: str) -> Layer:
        return self.study.inner(("fidelities", fidelity), f"fidelity {fidelity}")

    @property
    def partial_layers(self) -> list[Layer]:
        """All layers that override some keys: the study's, those of its fidelities and the command line."""
        blocks = [self.block(fidelity) for fidelity in self.study.values.get("fidelities", {})]
        return [self.study_settings, *blocks, self.command]

    def stack(self, fidelity: str) -> tuple[Layer, ...]:
        """Return the layers from the weakest to the strongest."""
        return self.default, self.study_settings, self.block(fidelity), self.command


def _read_sources(name: str, root: Path, overrides: dict[str, Any] | None) -> _Sources:
    """Return the sources of a study, each checked by itself so that a fault is reported where it stands."""
    sources = _Sources(
        default=read_yaml(root / "config" / "default.yaml", root),
        study=read_yaml(root / "config" / "studies" / f"{name}.yaml", root),
        command=command_line_layer(overrides),
    )
    study_schema, complete = load_schema("study"), load_schema("settings")
    partial = without_required(complete)
    check_layer(sources.default, complete)
    check_travel(sources.default, required=True)
    in_study = {**study_schema, "properties": study_schema["properties"] | partial["properties"]}
    check_layer(sources.study, in_study)
    within_block = {
        **partial,
        "properties": {k: v for k, v in partial["properties"].items() if k != "fidelity"},
    }
    for fidelity in sources.study.values.get("fidelities", {}):
        check_layer(sources.block(fidelity), within_block)
    check_layer(sources.command, partial)
    for layer in sources.partial_layers:
        check_travel(layer, required=False)
    return sources


def _design_rows(study: Layer, root: Path) -> list[Layer]:
    """Return the checked rows of the study's design table. Raises ConfigError."""
    folder, name = root / "config" / "designs", study.values["design"]
    there = sorted(path.name for path in folder.glob("*.csv"))
    if name not in there:
        raise ConfigError(unknown_name(study.where(("design",)), "design", name, there))
    return read_design(folder / name, root)


def _fidelity(sources: _Sources) -> str:
    """Return the fidelity asked for: command line, else study, else default; the study must offer it."""
    layers = (sources.default, sources.study_settings, sources.command)
    source = next(layer for layer in reversed(layers) if "fidelity" in layer.values)
    fidelity = source.values["fidelity"]
    offered = sources.study.values.get("fidelities")
    if offered is not None and fidelity not in offered:
        raise ConfigError(
            f"{source.where(('fidelity',))}: fidelity is '{fidelity}',"
            f" allowed is one of {', '.join(offered)}, the fidelities of {sources.study.source}."
        )
    return fidelity


def _merged(layers: tuple[Layer, ...]) -> dict[str, Any]:
    settings: dict[str, Any] = {}
    for layer in layers:
        if any(layer.holds(path) for path in TRAVELS):  # the travel and a test duration replace one another
            for section, key in TRAVELS:
                settings.get(section, {}).pop(key, None)
        settings = merge(settings, layer.values)
    return coerce_numbers(settings, load_schema("settings"))


def _checked_run(
    layers: tuple[Layer, ...], settings: dict[str, Any], materials: dict[str, Any], row: Layer, surface: str
) -> Run:
    """Return one run after all checks that need no solver. Raises ConfigError."""
    parameters = run_parameters(settings, materials, row.values, surface)
    check_run(Case(layers=layers, settings=settings, row=row, parameters=parameters))
    name = row.values["row"]
    return Run(name=f"{name}_{surface}", row=name, surface=surface, parameters=parameters)


# ---------------------------------------------------------------- units


def to_si(values: Any) -> Any:
    """Return values in SI, with keys that say so: width_mm -> width_m, skirt_slope_deg -> skirt_slope_rad.

    Every other unit of the schemas (Pa, 1/Pa, kg/m3, m/s, steps) is SI already.
    """
    if not isinstance(values, dict):
        return values
    converted = {}
    for key, value in values.items():
        if key.endswith("_mm"):
            converted[f"{key.removesuffix('_mm')}_m"] = value / 1000.0
        elif key.endswith("_deg"):
            converted[f"{key.removesuffix('_deg')}_rad"] = math.radians(value)
        else:
            converted[key] = to_si(value)
    return converted


# ---------------------------------------------------------------- one run


def run_parameters(
    settings: dict[str, Any], materials: dict[str, Any], row: dict[str, Any], surface: str
) -> dict[str, Any]:
    """Return the parameters of a run in SI (see Run), derived ones included."""
    si, factors = to_si(settings), to_si(row)
    scale = row_particle_scale(settings, materials, factors["bed_thickness_m"])
    parameters = {
        "ledger": si["ledger"],
        "sample": si["sample"],
        "pattern": _pattern(si["pattern"], factors) if surface == "convex" else None,
        "bed": {**si["bed"], "thickness_m": factors["bed_thickness_m"]},
        "sliding": _sliding(si["sliding"], factors["velocity_m_per_s"], si["wear"]["acceleration"]),
        "wear": _wear(si["wear"], materials["particles"][settings["bed"]["material"]]),
        "remeshing": si["remeshing"],
        "solver": {k: v for k, v in si["solver"].items() if si["ledger"] == "dumps" or k != "sampling_interval_steps"},
        "particle": _particle(settings["bed"]["material"], materials, scale),
        "sample_material": _wall(settings["sample"]["material"], materials),
        "floor_material": _wall(settings["bed"]["floor_material"], materials),
    }
    return {**parameters, "derived": derived_parameters(parameters)}


def row_particle_scale(settings: dict[str, Any], materials: dict[str, Any], thickness: float) -> float:
    """Return the particle scale (-) of a bed of that thickness (m): the study's, lowered to keep bed.least_layers."""
    scale, layers = settings["particle_scale"], settings["bed"]["least_layers"]
    diameter = to_si(materials["particles"][settings["bed"]["material"]])["median_diameter_m"]
    return min(scale, max(thickness / (layers * diameter), 1.0)) if layers else scale


def _sliding(sliding: dict[str, Any], velocity: float, acceleration: float) -> dict[str, Any]:
    """Return the section with velocity (m/s) and travel, which a test duration makes with the acceleration (-).

    Without the length of the first cycle where all are equal: it then changes nothing.
    """
    kept = {k: v for k, v in sliding.items() if sliding["cycles"] == ADAPTIVE or k != "first_cycle_m"}
    hours = kept.pop("test_duration_h", None)
    if hours is not None:
        kept["travel_m"] = velocity * hours * SECONDS_PER_HOUR / acceleration
    return {**kept, "velocity_m_per_s": velocity}


def _wear(wear: dict[str, Any], particle: dict[str, Any]) -> dict[str, Any]:
    """Return the section with the accelerated coefficient, and of the patch only what its choice needs."""
    kept = {k: v for k, v in wear.items() if k != "patch_radius_m" or wear["patch"] == "radius"}
    if wear["patch"] == "physical":
        kept["physical_shear_modulus_pa"] = particle.get("physical_shear_modulus_pa")
    return {**kept, "accelerated_wear_coefficient_per_pa": wear["wear_coefficient_per_pa"] * wear["acceleration"]}


def _pattern(pattern: dict[str, Any], factors: dict[str, Any]) -> dict[str, Any]:
    names = ("major_radius_m", "minor_radius_m", "height_m", "column_spacing_m")
    return {**pattern, **{name: factors[name] for name in names}}


def _particle(name: str, materials: dict[str, Any], scale: float) -> dict[str, Any]:
    """Return the particle's material; its lengths are coarse-grained, `scale` times the real ones."""
    particle = to_si(materials["particles"][name])
    particle.pop("physical_shear_modulus_pa", None)  # concerns wear alone, and no bed is filled again for it
    distribution = particle.pop("size_distribution")
    median_diameter = scale * particle.pop("median_diameter_m")
    return {
        "name": name,
        **particle,
        "scale": scale,
        "median_diameter_m": median_diameter,
        "diameters_m": [median_diameter * relative for relative in distribution["relative_diameter"]],
        "mass_fractions": list(distribution["mass_fraction"]),
    }


def _wall(name: str, materials: dict[str, Any]) -> dict[str, Any]:
    return {"name": name, **to_si(materials["walls"][name])}


# ---------------------------------------------------------------- beds


def bed_parameters(run: Run) -> dict[str, Any]:
    """Return exactly what determines the settled bed of a run (SI); runs with equal ones share a bed.

    `start_m` is the y of the upstream end before the travel: the sample is at y = 0, the bed moves in +y over
    `travel_m`, or goes round (`ends` periodic, travel_m 0). It settles with the largest time step, which does not
    depend on the run's velocity.
    """
    parameters, derived = run.parameters, run.parameters["derived"]
    return {
        "particle": parameters["particle"],
        "floor_material": parameters["floor_material"],
        "width_m": parameters["bed"]["width_m"],
        "length_m": derived["bed_length_m"],
        "start_m": derived["bed_start_m"],
        "travel_m": derived["bed_travel_m"],
        "ends": parameters["bed"]["ends"],
        "thickness_m": parameters["bed"]["thickness_m"],
        "seed": parameters["bed"]["seed"],
        "rolling_friction": parameters["solver"]["rolling_friction"],
        "rolling_radius": parameters["solver"]["rolling_radius"],
        "rayleigh_fraction": parameters["solver"]["rayleigh_fraction"],
        "rolling_friction_for_solver": {
            name: derived["rolling_friction_for_solver"][name] for name in ("particle", "floor_material")
        },
        "youngs_modulus_pa": {name: derived["youngs_modulus_pa"][name] for name in ("particle", "floor_material")},
        "time_step_s": derived["largest_time_step_s"],
    }
