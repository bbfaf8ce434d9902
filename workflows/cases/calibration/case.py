"""Contact parameters from bulk tests: shear box and draw-down test (Yan 2022, section 3.3), wall shear test."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.workflows.cases.calibration import boxes
from bulkwear.workflows.cases.calibration.box_checks import BOX_CHECKS
from bulkwear.workflows.cases.calibration.range_checks import RANGE_CHECKS, allowed_value, may_be
from bulkwear.workflows.config.clumps import shaped
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.published_tables import check_table
from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault
from bulkwear.workflows.engine.bulk_simulations import simulation_bytes
from bulkwear.workflows.engine.bulk_tests import deck_text
from bulkwear.workflows.engine.case import Case, Parameters, Run, register
from bulkwear.workflows.engine.derived import particle_section, template_sections, wall_section
from bulkwear.workflows.engine.grains import SPHERE, grain_kind
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.engine.solver import OWN_ROLLING_MODELS
from bulkwear.workflows.engine.work import Work

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

PUBLISHED = "config/published"
DISCREPANCY = "model_discrepancy"  # column of a table of measured responses, where it is known
LEAST_ANGLE, MOST_ANGLE, LONGEST = 2.0, 90.0, 3600.0  # degrees, degrees, s, of a measured response; radians are less


def published(name: str) -> pd.DataFrame:
    """Return a table of config/published. Raises ConfigError when there is none of that name."""
    project = current_project()
    if name not in (there := project.names(PUBLISHED, ".csv")):
        found = ", ".join(there) or "nothing"
        raise ConfigError(f"{PUBLISHED}/{name}: there is no such file, found in its folder: {found}.")
    path = project.file(f"{PUBLISHED}/{name}")
    check_table(path, project.folder)
    return pd.read_csv(path)


def calibration_box(study: Study) -> dict[str, Any]:
    """Return the parameters of the first run, whose box is that of the calibration."""
    return study.all_runs[0].parameters


def measured_file(study: Study) -> str:
    """Return the path of the table of measured responses."""
    return current_project().path(f"{PUBLISHED}/{calibration_box(study)['calibration']['measured']}")


def pairs_file(study: Study) -> str:
    """Return the path of the table of pairs that others simulated."""
    return current_project().path(f"{PUBLISHED}/{calibration_box(study)['calibration']['simulated_before']}")


# ---------------------------------------------------------------- checks


def rolling_model_of_bodies(run: CheckedRun) -> Fault | None:
    """Clumps have a model of rolling friction that knows of bodies, or none."""
    model = run.parameters["solver"]["rolling_friction"]
    if grain_kind(run.parameters["particle"]) == SPHERE or model not in OWN_ROLLING_MODELS:
        return None
    own = " and ".join(OWN_ROLLING_MODELS)
    return "solver.rolling_friction", f"none, or a model of LIGGGHTS, with clumps, because {own} act on spheres alone"


def one_wall_is_looked_for(run: CheckedRun) -> Fault | None:
    """Where friction of a wall is looked for, all tests have that wall."""
    calibration = run.settings["calibration"]
    if not any(each["name"].startswith("wall_material.") for each in calibration["parameters"]):
        return None
    walls = {test: run.settings[test]["wall_material"] for test in calibration["tests"]}
    last = calibration["tests"][-1]
    for test, wall in walls.items():
        if wall != walls[last]:
            return f"{test}.wall_material", f"{walls[last]}, as of {last}: the friction of one wall is looked for"
    return None


def measured_are_numbers(run: CheckedRun) -> Fault | None:
    """The table of measured responses has values, deviations above 0, and discrepancies of the model of at least 0."""
    table = published(run.settings["calibration"]["measured"])
    allowed = "a table with the columns response, value and deviation"
    if missing := [name for name in ("response", "value", "deviation") if name not in table]:
        return "calibration.measured", f"{allowed}; it has no {missing[0]}"
    faults = {"value": lambda v: v.isna(), "deviation": lambda v: ~(v > 0.0), DISCREPANCY: lambda v: v < 0.0}
    for name in filter(table.__contains__, faults):
        numbers = pd.to_numeric(table[name], errors="coerce")
        wrong = faults[name](numbers) | (numbers.isna() & table[name].notna())
        if wrong.any():
            place = f"its line {int(wrong.idxmax()) + 2} has {name} {table[name][wrong].iloc[0]}"
            return "calibration.measured", f"{allowed}, deviations above 0, {DISCREPANCY} of 0 or more; {place}"
    return None


def measured_are_responses(run: CheckedRun) -> Fault | None:
    """Every row of the table of measured responses is a response that a test has, named once: an angle in degrees, or a
    time in s.
    """
    table = published(run.settings["calibration"]["measured"])
    known = [name for names in RESPONSES.values() for name in names]
    for number, row in enumerate(table.itertuples(), 2):
        if row.response not in known:
            fault, allowed = f"response {row.response}", f"one of {', '.join(known)}"
        elif (table["response"] == row.response).sum() > 1:
            fault, allowed = f"response {row.response}, as another line", "each response once"
        elif row.response.endswith("_deg") and not LEAST_ANGLE <= float(row.value) < MOST_ANGLE:
            fault, allowed = f"{row.response} {row.value}", f"{LEAST_ANGLE:g} to below {MOST_ANGLE:g} degrees"
        elif row.response.endswith("_s") and not 0.0 < float(row.value) <= LONGEST:
            fault, allowed = f"{row.response} {row.value}", f"above 0 to {LONGEST:g} s"
        else:
            continue
        return "calibration.measured", f"in it {allowed}; its line {number} has {fault}"
    return None


def tests_tell_something(run: CheckedRun) -> Fault | None:
    """Of every test at least one response was measured: nothing else of it says anything about the parameters."""
    calibration = run.settings["calibration"]
    known = set(published(calibration["measured"])["response"])
    for test in calibration["tests"]:
        if not known & set(RESPONSES[test]):
            names = " or ".join(RESPONSES[test])
            return "calibration.tests", f"with {test} a table {calibration['measured']} that has {names}"
    return None


def pairs_are_values(run: CheckedRun) -> Fault | None:
    """Rows of the table of pairs simulated before have names, each its own, and the two that are simulated here have
    values that a contact may have, or empty cells.
    """
    calibration = run.settings["calibration"]
    key, table = "calibration.simulated_before", published(calibration["simulated_before"])
    if "row" not in table:
        return key, "a table with the column row"
    taken = {calibration["compared_pair"], calibration["sizes_pair"]}
    names = [each["name"] for each in calibration["parameters"] if each["name"] in table]
    seen: set[str] = set()
    for line, row in enumerate(table.to_dict("records"), 2):
        name = row["row"]
        if not isinstance(name, str) or name in seen:
            found = f"row {name}, {'as another line' if name in seen else 'a number or nothing'}"
            return key, f"a table whose rows have names of letters, each its own; its line {line} has {found}"
        seen.add(name)
        for each in names if name in taken else ():
            value = pd.to_numeric(row[each], errors="coerce")
            if pd.notna(row[each]) and not may_be(float(value), each):
                return key, f"in it {each} {allowed_value(each)}; its line {line} has {row[each]}"
    return None


def pairs_are_known(run: CheckedRun) -> Fault | None:
    """The compared pair and that of the sizes are rows of the table of pairs simulated before."""
    calibration = run.settings["calibration"]
    rows = list(published(calibration["simulated_before"])["row"])
    for key in ("compared_pair", "sizes_pair"):
        if calibration[key] not in rows:
            return f"calibration.{key}", f"one of {', '.join(rows)}, the rows of {calibration['simulated_before']}"
    return None


def initial_below_most(run: CheckedRun) -> Fault | None:
    """A test has at least as many simulations in all as before the acquisition rule."""
    calibration = run.settings["calibration"]
    for test in calibration["tests"]:
        if calibration["initial"][test] > calibration["most"][test]:
            return "calibration.most", f"for {test} at least calibration.initial.{test}, {calibration['initial'][test]}"
    return None


def packings_are_others(run: CheckedRun) -> Fault | None:
    """All tests together have no more simulations than there are packings before those that are repeated."""
    calibration = run.settings["calibration"]
    found = sum(calibration["most"][test] for test in calibration["tests"])
    if found <= boxes.FIRST_REPEAT:
        return None
    words = f"at most {boxes.FIRST_REPEAT} for all tests together, which have {found}"
    return "calibration.most", f"{words}: more have the seeds of packings that are repeated"


class Calibration(Case):
    """Contact parameters from bulk tests: a driver simulates where a rule says; design rows are boxes of other sizes.

    The calibration itself uses the box of the first row.
    """

    name = "calibration"
    one_packing = "calibration.repeats says with how many packings it is done"
    material_keys = (
        ("bulk", "material", "particles"),
        ("shear_box", "wall_material", "walls"),
        ("shear_box", "floor_material", "walls"),
        ("draw_down", "wall_material", "walls"),
        ("draw_down", "front_material", "walls"),
        ("wall_shear", "wall_material", "walls"),
        ("wall_shear", "side_material", "walls"),
    )
    checks: tuple[Check, ...] = (
        *BOX_CHECKS,
        rolling_model_of_bodies,
        one_wall_is_looked_for,
        *RANGE_CHECKS,
        measured_are_numbers,
        measured_are_responses,
        tests_tell_something,
        pairs_are_values,
        pairs_are_known,
        initial_below_most,
        packings_are_others,
    )
    run_templates = tuple(boxes.KINDS)
    run_rules = ()
    solver_rules = ("calibrated_parameters", "box_sizes")
    wears = False

    def run_parameters(
        self, settings: Mapping[str, Any], materials: Mapping[str, Any], factors: Mapping[str, Any], surface: str
    ) -> dict[str, Any]:
        """Return the settings of a box size with its materials: all that its simulations depend on besides the pair."""
        sections = (*boxes.KINDS, "rest", "calibration")
        return {
            **{name: settings[name] for name in sections},
            **template_sections(settings),
            "particle": shaped(
                particle_section(settings["bulk"]["material"], materials, settings["particle_scale"]),
                settings["bulk"]["shape"],
                "bulk.shape",
            ),
            "walls": {name: wall_section(name, materials) for name in materials["walls"]},
            "varied": factors["varied"],
        }

    def looks_for(self, settings: Mapping[str, Any]) -> list[str]:
        """Return the parameters that are calibrated."""
        return [each["name"] for each in settings["calibration"]["parameters"]]

    def sample_decks(self, parameters: Parameters, bed: Parameters | None) -> list[str]:
        """Return the decks of the tests."""
        seed = parameters["calibration"]["seed"]
        return [deck_text(boxes.test_of(parameters, kind, {}, seed)) for kind in self.run_templates]

    def table_columns(self, parameters: Parameters) -> dict[str, Any]:
        """Return particle scale, and the box's width as simulated."""
        return {
            "particle_scale": parameters["particle"]["scale"],
            "simulated_width_m": boxes.simulated_width(parameters["shear_box"], parameters["particle"]),
        }

    def deck_files(self, runs: Sequence[str], beds: Sequence[str]) -> list[str]:
        """Return the decks of all tests."""
        return [f"{test}/deck.in" for test in self.run_templates]

    def simulation_folders(self, folder: Path, runs: Sequence[str]) -> list[Path]:
        """Return the folders of the bulk tests that its tables are made of, each with a single cycle."""
        from bulkwear.workflows.cases.calibration.simulations import used_folders  # slow to import

        return used_folders(folder)

    def work(
        self, runs: Sequence[Run], beds: Mapping[str, Parameters], bed_of: Mapping[str, str], ranks: int
    ) -> tuple[Work, ...]:
        """Return the calibration with the first row's box and the boxes of all sizes: a job with many simulations each.

        The calibration is that of `calibration.most` simulations; it may stop before.
        """
        parallel = runs[0].parameters["calibration"]["batch"]
        jobs = {
            "calibrated_parameters": boxes.calibration_stages(runs[0].parameters),
            "box_sizes": boxes.sizes_stages([run.parameters for run in runs]),
        }
        return tuple(
            Work(rule, (), stages, parallel=parallel, disk_bytes=simulation_bytes(stages))
            for rule, stages in jobs.items()
        )


register(Calibration())
