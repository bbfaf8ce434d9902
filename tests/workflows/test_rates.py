"""Rates of a machine: found from measurements, kept in a file, marked when they are another machine's."""

import json
from dataclasses import replace

import pytest

from postproc.analysis.cost_model import TERMS
from workflows.design import load_study
from workflows.rate_benchmark import (
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
)
from workflows.rates import DEFAULT, MachineRates, RatesError, machine_facts, rates_file, read_rates, write_rates
from workflows.work import Stage

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


def test_the_benchmark_fills_one_bed_for_both_samples(repository):
    """Both samples start from the same bed, and the discs differ in their elements alone."""
    beds = [load_study(BED_STUDY, repository, SHRUNK | settings).beds for settings in SAMPLES.values()]
    assert beds[0] == beds[1] and len(beds[0]) == 1
    discs = [load_study(PIN_STUDY, repository, settings).run(PIN_RUN).parameters["disc"] for settings in DISCS.values()]
    assert {key for key in discs[0] if discs[0][key] != discs[1][key]} == {"element_size_m"}


def rates(**changes):
    return replace(MachineRates(KNOWN, machine_facts(), "2026-11-20", {}), **changes)


def test_rates_round_trip(tmp_path):
    """What is written is read again, and nothing else is left in the folder."""
    write_rates(tmp_path / "cost_rates.json", rates())
    assert read_rates(tmp_path / "cost_rates.json") == rates()
    assert [path.name for path in tmp_path.iterdir()] == ["cost_rates.json"]


def test_whose_rates_they_are(repository):
    """Measured here, measured elsewhere and the default ones cannot be mixed up."""
    assert rates().said().startswith("rates of this machine (")
    assert rates(machine={**machine_facts(), "cores": 1000}).said().startswith("RATES OF ANOTHER MACHINE (")
    assert read_rates(repository / DEFAULT).said().startswith("DEFAULT RATES OF ANOTHER MACHINE (")


def test_measured_rates_go_before_default_ones(repository, tmp_path, monkeypatch):
    """In a folder with results/cost_rates.json that is used."""
    monkeypatch.chdir(tmp_path)
    assert rates_file(repository) == repository / DEFAULT
    (tmp_path / "results").mkdir()
    write_rates(tmp_path / "results/cost_rates.json", rates())
    assert not rates_file(repository).is_absolute()


@pytest.mark.parametrize("text", ["{", "[]", "{}", '{"rates": {}, "machine": {}, "date": "", "fit": {}}'])
def test_a_damaged_file_is_one_sentence(tmp_path, text):
    """Named, with what to do."""
    (tmp_path / "cost_rates.json").write_text(text)
    with pytest.raises(RatesError, match=r"cost_rates\.json: no file of rates \(.*\); remove it and `make rates`"):
        read_rates(tmp_path / "cost_rates.json")


def test_a_negative_rate_is_refused(tmp_path):
    """No work gives time back."""
    write_rates(tmp_path / "cost_rates.json", rates(rates=KNOWN | {"steps": -1.0}))
    with pytest.raises(RatesError, match="a rate is -1 s, allowed is 0 or more"):
        read_rates(tmp_path / "cost_rates.json")


def test_the_default_rates_say_how_well_they_fit(repository):
    """The file holds machine, date and what the model makes of each measurement."""
    found = json.loads((repository / DEFAULT).read_text())
    assert set(found) == {"rates", "machine", "date", "fit"} and found["fit"]


@pytest.mark.verify
@pytest.mark.solver
def test_rates_of_this_machine(tmp_path):
    """The benchmark runs, what is large in a study costs something, and the model meets the steps it is made of."""
    said = []
    found = measured_rates(tmp_path, said.append)
    assert all(found.rates[term] > 0.0 for term in ("particle_steps", "particle_builds", "triangle_steps", "cycles"))
    steps = {what: ratio for what, ratio in found.fit.items() if what.startswith("steps, ")}
    assert steps == pytest.approx(dict.fromkeys(steps, 1.0), rel=MET)
    assert len(said) == len(SAMPLES) + len(DISCS)
