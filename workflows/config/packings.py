"""Packings: every setting of a design is simulated in several random beds, which differ in their seed alone.

A setting is what rows share that differ in nothing but their seed. A row R9 with three packings becomes the rows R9,
R9-2 and R9-3; the first one is as it was written. Rows that a design repeats with seeds of its own count as packings.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.optimise import optimise_of
from bulkwear.workflows.config.until import first_packings, until_of
from bulkwear.workflows.config.validation import as_told
from bulkwear.workflows.engine.case import Run
from bulkwear.workflows.engine.decks import SMALLEST_SEED, primes

PACKINGS = "packings"  # key of the settings, and column of designs whose rows have numbers of their own
SEED_SPACING = 1000  # the solver takes a few primes above a seed; gaps between primes up to 2e9 are below 300
NUMBERED = re.compile(r"-\d+$")  # ends the names of rows that repeat a setting


@dataclass(frozen=True)
class Packings:
    """The rows of a design with all their packings, in its order.

    setting_of: {row: name of its setting}; packing_of: {row: its number among the packings of its setting, from 1 on}
    added: rows that do not stand in the table
    """

    rows: tuple[Layer, ...]
    setting_of: dict[str, str]
    packing_of: dict[str, int]
    added: frozenset[str] = frozenset()

    def first(self, settings: Mapping[str, Any], chosen: Sequence[Layer]) -> dict[str, int]:
        """Return how many packings of each setting are simulated first; `until` and `optimise` add the others.

        chosen: rows that are run; settings of which none is have no number
        """
        found: dict[str, list[Layer]] = {self.setting_of[_name(row)]: [] for row in chosen}
        for row in (row for row in self.rows if self.setting_of[_name(row)] in found):
            found[self.setting_of[_name(row)]].append(row)
        written = {name: sum(_name(row) not in self.added for row in rows) for name, rows in found.items()}
        own = {name: any(PACKINGS in row.values for row in rows) for name, rows in found.items()}
        given = {
            name: len(rows) if own[name] else max(written[name], settings[PACKINGS]) for name, rows in found.items()
        }
        if (search := optimise_of(settings)) is not None:
            return search.first_packings([name for name in given if name not in search.rows])
        return first_packings(until_of(settings), given, own)

    def added_last(self) -> list[Layer]:
        """Return the rows of the table, then second packings that were added, then third ones."""
        return sorted(self.rows, key=lambda row: self.packing_of[_name(row)] * (_name(row) in self.added))


def wanted_packings(rows: Sequence[Layer], settings: Mapping[str, Any]) -> int:
    """Return how many packings a setting may have; rows: those of the design that are of it."""
    until, search = until_of(settings), optimise_of(settings)
    further = [until.most_packings] if until else [search.confirming_packings] if search else []
    most = max(settings[PACKINGS], *further) if further else settings[PACKINGS]
    return max(row.values.get(PACKINGS, most) for row in rows)


def possible_packings(
    design_rows: Iterable[Mapping[str, Any]], setting_of: Mapping[str, str], packing_of: Mapping[str, int]
) -> dict[str, int]:
    """Return {setting: packings} that a study has rows for, by the largest of their numbers.

    design_rows, setting_of, packing_of: of the study
    """
    numbers: dict[str, int] = {}
    for name in (str(row["row"]) for row in design_rows):
        setting = setting_of[name]
        numbers[setting] = max(numbers.get(setting, 0), packing_of[name])
    return numbers


def without_packings(rows: Sequence[Layer]) -> Packings:
    """Return the rows of a design whose runs start from no bed: each is a setting of its own."""
    names = [_name(row) for row in rows]
    return Packings(tuple(rows), dict(zip(names, names, strict=True)), dict.fromkeys(names, 1))


def with_packings(rows: Sequence[Layer], settings: Mapping[str, Any], seed_column: str, default_seed: int) -> Packings:
    """Return the rows of a design with those that packings add: a setting's first row with another name and seed.

    default_seed: of rows without one. Where rows are added, those of the table tell their seeds too.
    Raises ConfigError for rows of one setting with equal seeds, and for a row that is called as an added one.
    """
    groups = _groups(rows, seed_column)
    of_setting: dict[str, list[Layer]] = {}
    added: dict[str, Layer] = {}
    for setting, group in zip(_setting_names(groups), groups, strict=True):
        seeded = [replace(row, values={seed_column: default_seed} | row.values) for row in group]
        _check_seeds(seeded, seed_column)
        count = max(wanted_packings(group, settings) - len(group), 0)
        more = list(itertools.islice(_further(setting, seeded, seed_column), count))
        of_setting[setting] = [*(seeded if more else group), *more]
        added |= {_name(row): row for row in more}
    _check_names(rows, added, of_setting)
    members = {setting: [_name(row) for row in found] for setting, found in of_setting.items()}
    return Packings(
        tuple(_in_order(rows, of_setting.values())),
        {name: setting for setting, names in members.items() for name in names},
        {name: number for names in members.values() for number, name in enumerate(names, 1)},
        frozenset(added),
    )


def _name(row: Layer) -> str:
    return str(row.values["row"])


def _groups(rows: Sequence[Layer], seed_column: str) -> list[list[Layer]]:
    """Return the rows of each setting, in the order of the first ones."""
    groups: dict[frozenset, list[Layer]] = {}
    for row in rows:
        told = as_told(row.values)
        key = frozenset(item for item in told.items() if item[0] not in ("row", seed_column, PACKINGS))
        groups.setdefault(key, []).append(row)
    return list(groups.values())


def _setting_names(groups: Sequence[Sequence[Layer]]) -> list[str]:
    """Return R5 for the rows R5-1 and R5-2, or the name of the first row where they are named otherwise."""
    stems = [{NUMBERED.sub("", _name(row)) for row in group} for group in groups]
    return [
        min(stem) if len(group) > 1 and len(stem) == 1 and stems.count(stem) == 1 else _name(group[0])
        for stem, group in zip(stems, groups, strict=True)
    ]


def _further(setting: str, group: Sequence[Layer], seed_column: str) -> Iterator[Layer]:
    """Yield further packings of a setting: its first row, with names and seeds that its rows do not have."""
    names, seeds = {_name(row) for row in group}, [row.values[seed_column] for row in group]
    numbers = (number for number in itertools.count(len(group) + 1) if f"{setting}-{number}" not in names)
    first = max(seeds[0], SMALLEST_SEED)  # below it all seeds are one
    free = (
        seed
        for seed in itertools.count(first + SEED_SPACING, SEED_SPACING)
        if all(abs(seed - other) >= SEED_SPACING for other in seeds)
    )
    for number, seed in zip(numbers, free, strict=False):
        name = f"{setting}-{number}"
        yield replace(group[0], values={**group[0].values, "row": name, seed_column: seed}, block=f"row {name}")


def _in_order(rows: Sequence[Layer], settings: Iterable[Sequence[Layer]]) -> list[Layer]:
    """Return all rows where they stand in the table, added ones after the last row of their setting."""
    places = {_name(row): (index, 0) for index, row in enumerate(rows)}
    for members in settings:
        last = max(places[_name(row)] for row in members if _name(row) in places)
        places |= {_name(row): (last[0], n) for n, row in enumerate(members, 1) if _name(row) not in places}
    return sorted(itertools.chain(*settings), key=lambda row: places[_name(row)])


def _check_seeds(group: Sequence[Layer], seed_column: str) -> None:
    """Raise ConfigError for rows of one setting that would be one simulation."""
    seen: dict[int, str] = {}
    for row in group if len(group) > 1 else ():
        first_prime = primes(row.values[seed_column], 1)[0]
        if first_prime in seen:
            low = row.values[seed_column] < SMALLEST_SEED
            apart = f" of {SMALLEST_SEED} or more, below which all are one," if low else ""
            raise ConfigError(
                f"{row.where()}: {seed_column} is {row.values[seed_column]}, which makes row {seen[first_prime]} again,"
                f" whose other values are the same, allowed are seeds{apart} that are {SEED_SPACING} apart, or one row."
            )
        seen[first_prime] = _name(row)


def _check_names(rows: Sequence[Layer], added: Mapping[str, Layer], settings: Mapping[str, Sequence[Layer]]) -> None:
    """Raise ConfigError for a row of the table that is called as a packing of another one."""
    for row in rows:
        if (name := _name(row)) in added:
            setting = next(key for key, members in settings.items() if added[name] in members)
            raise ConfigError(
                f"{row.where()}: row is '{name}', which is what a packing of row {setting} is called, allowed is"
                f" another name, or {PACKINGS}: 1."
            )


def named_by_rows(
    runs: Sequence[Run], beds: Mapping[str, Mapping[str, Any]], bed_of: Mapping[str, str]
) -> tuple[dict[str, Any], dict[str, str]]:
    """Return beds and {run: bed} under the names of the first rows that start from them, as bed_R9-2.

    A bed so keeps its folder when a design gets further rows or packings. Where the surfaces of a row start from beds
    of their own, those are named by runs. runs: of the whole design; beds, bed_of: as from `Case.beds`
    """
    names: dict[str, str] = {}
    for run in runs:
        bed = bed_of.get(run.name)
        if bed is not None and bed not in names:
            of_row = f"bed_{run.row}"
            names[bed] = f"bed_{run.name}" if of_row in names.values() else of_row
    return {names[bed]: beds[bed] for bed in names}, {run: names[bed] for run, bed in bed_of.items()}
