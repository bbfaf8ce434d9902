"""A checked study: its settings, its runs, and how rows, packings and beds belong together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from bulkwear.workflows.config.coefficients import coefficient_columns
from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.optimise import Optimise, optimise_of
from bulkwear.workflows.config.packings import named_by_rows
from bulkwear.workflows.config.until import Until, until_of
from bulkwear.workflows.config.validation import unknown_name
from bulkwear.workflows.engine.case import Case, Run
from bulkwear.workflows.engine.template_files import templates_read_once


@dataclass(frozen=True)
class Study:
    """A checked study. `settings` are merged, in the units that their keys spell; so are `design_rows`.

    runs: those of its rows; all_runs: those of the whole design, where `rows` chooses some of it, added packings last
    setting_of, packing_of: {row: its setting} and {row: number among its packings} of the whole design, see packings.py
    factors: {short name: column of the design} of the regression of its results; empty without one
    head: the keys of its file that are the study's own, no settings
    confirms: the study whose best designs this one simulates, "" for all others
    first_packings: {chosen setting: packings that are simulated first}; with `until` and `optimise` runs are all that
        there may be
    search_digest: of what proposals of its search depend on besides results
    runs_of: the checked runs of any further row of its design
    until: how narrow intervals shall be, None where packings are a fixed number
    """

    name: str
    case: Case
    title: str
    question: str
    fidelity: str
    settings: dict[str, Any]
    runs: tuple[Run, ...]
    all_runs: tuple[Run, ...]
    design_rows: tuple[dict[str, Any], ...]
    setting_of: dict[str, str]
    packing_of: dict[str, int]
    factors: dict[str, str]
    paper_settings: dict[str, Any]
    materials: dict[str, Any]
    head: dict[str, Any]
    first_packings: dict[str, int]
    confirms: str = ""
    search_digest: str = ""
    runs_of: Callable[[Layer], list[Run]] | None = field(default=None, compare=False, repr=False)

    @property
    def optimise(self) -> Optimise | None:
        """Return what the study asks of a search for the best pattern; None where nothing is looked for."""
        return optimise_of(self.settings)

    @property
    def until(self) -> Until | None:
        """Return what the study asks of its intervals; None where packings are a fixed number."""
        return until_of(self.settings)

    def with_packings(self, packings: Mapping[str, int]) -> Study:
        """Return the study with so many packings of each setting, of those that it may have."""

        def there(row: str) -> bool:
            return self.packing_of[row] <= packings[self.setting_of[row]]

        return replace(
            self,
            runs=tuple(run for run in self.runs if there(run.row)),
            design_rows=tuple(row for row in self.design_rows if there(str(row["row"]))),
        )

    @property
    def foreseen(self) -> Study:
        """Return the study by which its cost is forecast: with as many rows and packings as it may need."""
        if (search := self.optimise) is None:
            return self
        return self.with_packings(search.foreseen([name for name in self.first_packings if name not in search.rows]))

    @property
    def chosen_settings(self) -> list[str]:
        """Return the names of the settings that the rows of the study are packings of."""
        return list(dict.fromkeys(self.setting_of[str(row["row"])] for row in self.design_rows))

    @property
    def settings_left_out(self) -> list[str]:
        """Return the names of the settings of the design of which no row is run."""
        chosen = self.chosen_settings
        return [name for name in dict.fromkeys(self.setting_of.values()) if name not in chosen]

    def run(self, name: str) -> Run:
        """Return the run of that name. Raises ConfigError naming the runs there are."""
        found = next((run for run in self.runs if run.name == name), None)
        if found is None:
            raise ConfigError(unknown_name(f"study {self.name}", "run", name, [run.name for run in self.runs]))
        return found

    def same_as(self, run_name: str) -> str | None:
        """Return the first run with the parameters of this one, which simulates both; None for that run itself.

        So do plain samples of rows that differ in their pattern only. Raises ConfigError for an unknown run.
        """
        wanted = self.run(run_name).parameters
        first = next(run.name for run in self.runs if run.parameters == wanted)
        return first if first != run_name else None

    def design_table(self) -> list[dict[str, Any]]:
        """Return one row per run: run, row, its setting and packing, surface where there are any, the factors with
        their units, and what follows from them in this case.
        """
        factors = {str(row["row"]): {k: v for k, v in row.items() if k != "row"} for row in self.design_rows}
        columns = dict.fromkeys(name for row in factors.values() for name in row)
        told = {run.name: coefficient_columns(run.parameters) for run in self.runs}
        coefficients = dict.fromkeys((name for row in told.values() for name in row), "")
        return [
            {"run": run.name, "row": run.row, "setting": self.setting_of[run.row], "packing": self.packing_of[run.row]}
            | ({"surface": run.surface} if run.surface else {})
            | {name: factors[run.row].get(name, "") for name in columns}
            | self.case.table_columns(run.parameters)
            | (coefficients | told[run.name])
            for run in self.runs
        ]

    @cached_property
    def _beds(self) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
        with templates_read_once():
            return named_by_rows(self.all_runs, *self.case.beds(self.all_runs))

    @property
    def beds(self) -> dict[str, dict[str, Any]]:
        """Return {bed id: parameters}; runs with equal parameters share a bed, and some cases have none.

        A bed is that of the whole design, so that a run is the same whichever rows are chosen beside it, and however
        many packings there are. Its id is that of its first row.
        """
        beds, bed_of = self._beds
        used = {bed_of[run.name] for run in self.runs if run.name in bed_of}
        return {name: parameters for name, parameters in beds.items() if name in used}

    def bed_of(self, run_name: str) -> str | None:
        """Return the id of the bed that a run starts from, None without. Raises ConfigError for an unknown run."""
        return self._beds[1].get(self.run(run_name).name)
