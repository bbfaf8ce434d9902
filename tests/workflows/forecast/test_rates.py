"""Rates of a machine: found from measurements, kept in a file, marked when they are another machine's."""

import json
import math
import os
import shutil
from dataclasses import replace
from functools import partial

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.project import Project
from bulkwear.workflows.engine.work import Stage
from bulkwear.workflows.forecast import rate_benchmark
from bulkwear.workflows.forecast.rate_benchmark import (
    BED_STUDY,
    DISCS,
    GROUPS,
    PIN_RUN,
    PIN_STUDY,
    SAMPLES,
    SHRUNK,
    Measurement,
    measured_rates,
    rates_from,
    typical,
)
from bulkwear.workflows.forecast.rates import (
    DEFAULT,
    MEASURED,
    TERMS,
    MachineRates,
    RatesError,
    damage_of,
    machine_facts,
    rates_file,
    read_rates,
    write_rates,
)

MET = 0.5  # relative; of single `run` commands on a machine that does other things too. Seen: 0.24
FIT = 1e-6  # relative; of a least-squares solution whose columns differ by orders of magnitude
KNOWN = {
    **{"decks": 0.2, "triangles_read": 5e-5, "steps": 1e-5, "particle_steps": 2e-7, "moving_particle_steps": 1e-7},
    **{"particle_builds": 9e-7, "triangle_steps": 5e-8, "loaded_triangle_steps": 6e-8, "jobs": 2.0},
    **{"meshed_triangles": 1e-5, "cycles": 0.2, "worn_triangles": 3e-5},
}
STAGES = (
    Stage(0, 9000, 3600.0),
    Stage(0, 7000, 3100.0, 1400.0),
    Stage(0, 2000, 3100.0, 1400.0, 40.0, True),
    Stage(0, 7000, 3100.0, 12000.0),
    Stage(0, 2000, 3100.0, 12000.0, 40.0, True),
    Stage(0, 11000, 1.0, 900.0),
    Stage(0, 11000, 1.0, 5000.0),
)


def taken(kind, terms):
    """A measurement of work that takes what the known rates say."""
    return Measurement(kind, str(terms), terms, sum(KNOWN[term] * amount for term, amount in terms.items()))


def measurements():
    """What a benchmark with sizes like the real one would measure on a machine of those rates."""
    steps = [taken("steps", {term: stage.terms()[term] for term in GROUPS["steps"]}) for stage in STAGES]
    return [
        *steps,
        taken("neighbour lists", {"particle_builds": 40.0 * 3100.0}),
        *(taken("start", {"decks": 1, "triangles_read": read}) for read in (1400, 12000)),
        *(taken("wear update", {"cycles": 1, "worn_triangles": worn}) for worn in (1400, 75000)),
        taken("mesh", {"meshed_triangles": 12000}),
        taken("job", {"jobs": 1}),
    ]


def test_known_rates_are_found_from_their_times():
    """Each group of measurements tells its rates, all of the model's together, and the model then meets every one."""
    found = rates_from(measurements())
    assert set(found.rates) == set(TERMS)
    assert found.rates == pytest.approx(KNOWN, rel=FIT)
    assert list(found.fit.values()) == pytest.approx([1.0] * len(found.fit), rel=FIT)


def test_copies_that_share_the_machine_are_told_by_their_median():
    """Three copies, one undisturbed and one disturbed: each measurement takes what the middle one took; one that only
    some copies told, because it was too short in others, is kept. Rates grow by as much as that copy was slower.
    """
    slower = {1.0: "alone", 1.3: "beside others", 3.0: "disturbed"}
    copies = [[replace(each, seconds=factor * each.seconds) for each in measurements()] for factor in slower]
    told = typical([copies[0][1:], copies[1], copies[2]])
    by_what = {(each.kind, each.what): each.seconds for each in told}
    for place, each in enumerate(measurements()):
        factor = 1.3 if place else 0.5 * (1.3 + 3.0)
        assert by_what[each.kind, each.what] == pytest.approx(factor * each.seconds)
    found = rates_from(typical(copies), len(copies))
    assert found.side_by_side == 3
    assert found.rates == pytest.approx({term: 1.3 * rate for term, rate in KNOWN.items()}, rel=FIT)


def test_every_copy_does_every_part(tmp_path, monkeypatch):
    """Copies side by side work in folders and processes of their own, parts in their order; no more than allowed."""
    monkeypatch.setattr(rate_benchmark, "_sliding", in_a_folder)
    monkeypatch.setattr(rate_benchmark, "_pin", in_a_folder)
    monkeypatch.setattr(rate_benchmark, "_job", partial(in_a_folder, "job", {}))
    monkeypatch.setattr(rate_benchmark, "rates_from", lambda measured, copies: (measured, copies))
    monkeypatch.setattr(rate_benchmark, "MOST_COPIES", 2)
    said = []
    measured, copies = measured_rates(tmp_path, said.append, cores=3)
    assert [each.what for each in measured] == [*SAMPLES, *DISCS, "job"]
    assert copies == 2 and sorted(path.name for path in tmp_path.iterdir()) == ["copy_0", "copy_1"]
    assert all(len(list(path.iterdir())) == len(SAMPLES) + len(DISCS) + 1 for path in tmp_path.iterdir())
    assert len(said) == len(SAMPLES) + len(DISCS) and all("2 side by side" in line for line in said)


def in_a_folder(title, settings, folder):
    """Stands for a part of the benchmark."""
    folder.mkdir(exist_ok=True)
    (folder / title).touch()
    return [Measurement("job", title, {"jobs": 1}, 1.0)] if title != "job" else Measurement("job", title, {}, 1.0)


def test_the_benchmark_fills_one_bed_for_both_samples(repository):
    """Both samples start from the same bed, and the discs differ in their elements alone."""
    beds = [load_study(BED_STUDY, overrides=SHRUNK | settings).beds for settings in SAMPLES.values()]
    assert beds[0] == beds[1] and len(beds[0]) == 1
    discs = [load_study(PIN_STUDY, overrides=settings).run(PIN_RUN).parameters["disc"] for settings in DISCS.values()]
    assert {key for key in discs[0] if discs[0][key] != discs[1][key]} == {"element_size_m"}


def rates(**changes):
    return replace(MachineRates(KNOWN, machine_facts(), "2026-11-20", {}), **changes)


def test_rates_round_trip(tmp_path):
    """What is written is read again, and nothing else is left in the folder."""
    write_rates(tmp_path / "cost_rates.json", rates())
    assert read_rates(tmp_path / "cost_rates.json") == rates()
    assert damage_of(tmp_path / "cost_rates.json") is None
    assert [path.name for path in tmp_path.iterdir()] == ["cost_rates.json"]


def test_whose_rates_they_are(repository):
    """Measured here, measured elsewhere and the default ones cannot be mixed up."""
    assert rates().said().startswith("rates of this machine (")
    assert rates(machine={**machine_facts(), "cores": 1000}).said().startswith("RATES OF ANOTHER MACHINE (")
    assert read_rates(repository / DEFAULT).said().startswith("DEFAULT RATES OF ANOTHER MACHINE (")


def test_measured_rates_go_before_default_ones(repository, tmp_path, monkeypatch):
    """Those of the project, then those of the package; the project's own are a file of the working directory."""
    monkeypatch.chdir(tmp_path)
    mine, package = tmp_path / "mine", tmp_path / "package"
    for folder in (mine, package):
        (folder / "results").mkdir(parents=True)
    (package / "config").mkdir()
    shutil.copy(repository / DEFAULT, package / "config")
    project = Project(mine, package)
    assert rates_file(project) == package / DEFAULT
    write_rates(package / MEASURED, rates())
    assert rates_file(project) == package / MEASURED
    write_rates(mine / MEASURED, rates())
    assert rates_file(project) == mine / MEASURED
    monkeypatch.chdir(mine)
    assert rates_file(project) == MEASURED


def test_a_file_that_does_not_tell_was_measured_alone(tmp_path):
    """Files of earlier versions: one process. What is told stands in the phrase of every forecast."""
    file = tmp_path / "cost_rates.json"
    write_rates(file, rates(side_by_side=2))
    assert "measured 2026-11-20 by 2 processes side by side" in read_rates(file).said()
    told = json.loads(file.read_text())
    assert told.pop("side_by_side") == 2
    file.write_text(json.dumps(told))
    assert "measured 2026-11-20 by a single process" in read_rates(file).said()


@pytest.mark.parametrize("copies", [0, "two", 1.5])
def test_copies_are_a_whole_number(tmp_path, copies):
    """Named, with what is allowed."""
    write_rates(tmp_path / "cost_rates.json", rates(side_by_side=copies))
    with pytest.raises(RatesError, match=r"side_by_side is .*, allowed are whole numbers from 1 on"):
        read_rates(tmp_path / "cost_rates.json")


NO_MACHINE = {"rates": KNOWN, "date": "", "fit": {}}


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "[]",
        "null",
        "{}",
        '{"rates": {}, "machine": {}, "date": "", "fit": {}}',
        json.dumps(NO_MACHINE | {"machine": {}}),
        json.dumps(NO_MACHINE | {"machine": "a name"}),
    ],
)
def test_a_damaged_file_is_one_sentence(tmp_path, text):
    """Named, with what to do."""
    file = tmp_path / "cost_rates.json"
    file.write_text(text)
    with pytest.raises(RatesError, match=r"cost_rates\.json: no file of rates \(.*\); remove it and `make rates`"):
        read_rates(file)
    assert damage_of(file).startswith(f"{file}: no file of rates")


@pytest.mark.parametrize("rate, said", [(-1.0, "-1"), (math.inf, "inf"), (math.nan, "nan")])
def test_a_rate_that_is_none_is_refused(tmp_path, rate, said):
    """No work gives time back, and none takes for ever."""
    write_rates(tmp_path / "cost_rates.json", rates(rates=KNOWN | {"steps": rate}))
    with pytest.raises(RatesError, match=f"a rate is {said} s, allowed is 0 or more"):
        read_rates(tmp_path / "cost_rates.json")


def test_the_default_rates_say_how_well_they_fit(repository):
    """The file holds machine, date and what the model makes of each measurement."""
    found = json.loads((repository / DEFAULT).read_text())
    assert set(found) - {"side_by_side"} == {"rates", "machine", "date", "fit"} and found["fit"]


@pytest.mark.verify
@pytest.mark.solver
def test_rates_of_this_machine(tmp_path):
    """The benchmark runs on all cores, what is large in a study costs something, and the model meets its steps."""
    said = []
    found = measured_rates(tmp_path, said.append, os.cpu_count())
    assert found.side_by_side == min(os.cpu_count(), rate_benchmark.MOST_COPIES)
    assert all(found.rates[term] > 0.0 for term in ("particle_steps", "particle_builds", "triangle_steps", "cycles"))
    steps = {what: ratio for what, ratio in found.fit.items() if what.startswith("steps, ")}
    assert steps == pytest.approx(dict.fromkeys(steps, 1.0), rel=MET)
    assert len(said) == len(SAMPLES) + len(DISCS)
