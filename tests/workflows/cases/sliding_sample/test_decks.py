"""Decks of beds and sliding samples: complete, in order, and one golden deck."""

import re

import pytest

from bulkwear.workflows.cases.sliding_sample.decks import bed_mass, lowered_bed, settled_bed, sliding_sample
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.sources import read_sources
from bulkwear.workflows.config.study_files import list_studies
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.beds import bed_fault, read_measures
from bulkwear.workflows.engine.cycles import fill_bed
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.engine.schedule import known_spans
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, LOG, run_deck
from bulkwear.workflows.engine.template_files import DeckError
from bulkwear.workflows.engine.templates import render
from tests import DATA
from tests.support.law_cases import long_slip_registered, wear_settings
from tests.support.tiny import OF_ANY_MODEL, tiny_study

RESET = 'if "${begin_step} == 0" then "reset_timestep 0"'  # a later piece goes on counting
GOLDEN = DATA / "golden_sliding_sample.in"
SHORT_STEPS = {"rayleigh_fraction": 0.2}  # half of those in studies
SHAPES = "grain_shape"  # its clumps are refused by windows and sampled contacts: test_clumps.py
SLIDING = [
    name
    for name in list_studies()
    if read_sources(name, current_project(), None).case.name == "sliding_sample" and name != SHAPES
]


def run_and_bed(study, name="R9_convex"):
    return study.run(name).parameters, study.beds[study.bed_of(name)]


BEDS = [("solver", "walls"), ("dumps", "walls"), ("solver", "periodic"), ("solver", "window"), ("dumps", "window")]


@pytest.mark.parametrize("name", SLIDING)
@pytest.mark.parametrize(
    ("rolling_friction", "ledger", "ends"),
    [
        *(("own_spin", *bed) for bed in BEDS),
        ("cdt", *BEDS[0]),
        *(pytest.param("cdt", *bed, marks=pytest.mark.verify) for bed in BEDS[1:]),
    ],
)
def test_every_deck_of_every_sliding_study_renders(name, rolling_friction, ledger, ends):
    """No deck has an open word, a missing or an unused parameter, or a tab.

    Every run's at the first kind of bed; at the others of one packing, a run of each bed and surface: others differ in
    numbers alone.
    """
    changes = {"solver": {"rolling_friction": rolling_friction}, "ledger": ledger}
    changes["bed"] = {"material": OF_ANY_MODEL, "ends": ends}
    first = (rolling_friction, ledger, ends) == ("own_spin", *BEDS[0])
    study = load_study(name, overrides=changes if first else changes | {"packings": 1})
    unlike = {(study.bed_of(run.name), run.surface): run for run in study.runs}
    texts = [render("settled_bed", settled_bed(bed)) for bed in study.beds.values()]
    for run in study.runs if first else unlike.values():
        parameters, bed = run_and_bed(study, run.name)
        texts.append(render("lowered_bed", lowered_bed(parameters, bed, "bed.restart")))
        texts.append(render("sliding_sample", sliding_sample(parameters, bed, cycle(parameters, 1), "run.restart")))
    for text in texts:
        assert f"rolling_friction {rolling_friction}" in text
        assert not re.search(r"\{\{|\}\}|\{%|%\}|\t|\bNone\b|\bnan\b", text)


def test_golden_deck():
    """The deck of the tiny chain's second cycle, word for word; a change of it is a decision."""
    parameters, bed = run_and_bed(tiny_study(solver=SHORT_STEPS))
    text = render(
        "sliding_sample",
        sliding_sample(parameters, bed, cycle(parameters, 2), "../cycle_001/run.restart"),
    )
    assert text == GOLDEN.read_text()


@pytest.mark.parametrize(("ends", "grid"), [("walls", "* 1 1"), ("periodic", "* * 1"), ("window", "* * 1")])
def test_ranks_share_a_bed_as_its_geometry_wants(ends, grid):
    """A bed that travels through its domain is split across; one that fills it is the solver's to split. All decks of a
    run say the same, and none knows how many ranks there will be.
    """
    study = tiny_study(bed={"ends": ends, "ahead_mm": 60, "behind_mm": 60, "exchange_mm": 60})
    parameters, bed = run_and_bed(study)
    texts = [
        render("settled_bed", settled_bed(bed)),
        render("lowered_bed", lowered_bed(parameters, bed, "bed.restart")),
        render("sliding_sample", sliding_sample(parameters, bed, cycle(parameters, 1), "run.restart")),
    ]
    for text in texts:
        assert re.findall(r"^processors +(\S+ \S+ \S+)", text, re.MULTILINE) == [grid]


def cycle(parameters, number):
    """Span of a wear cycle."""
    return known_spans(parameters)[number - 1]


def cycle_deck(**changes):
    parameters, bed = run_and_bed(tiny_study(**changes))
    return render("sliding_sample", sliding_sample(parameters, bed, cycle(parameters, 2), "run.restart"))


def position(text, start):
    """Place of the only line that begins so."""
    found = [place for place, line in enumerate(text.splitlines()) if re.sub(" +", " ", line).startswith(start)]
    assert len(found) == 1, f"{start}: lines {found}"
    return found[0]


def test_the_exact_ledger_stands_where_the_solver_wants_it():
    """After mesh and wall, before the steps are reset; gone before the last restart file; no dump of contacts."""
    text = cycle_deck()
    order = (
        *("fix sample_2 all mesh/surface/stress", "fix walls all wall/gran"),
        *("fix load_ledger all load/ledger mesh sample_2 file load_ledger.bin", RESET, "run "),
        *("unfix load_ledger", "write_restart run.restart"),
    )
    places = [position(text, start) for start in order]
    assert places == sorted(places)
    assert "solver/build/liggghts-ledger -in deck.in" in text.split("\n\n")[0]
    for word in ("contacts.dump", "spins.dump", "wall/gran/local", "sampling"):
        assert word not in text


def test_sampled_contacts_run_with_any_liggghts():
    """With ledger: dumps no trace of the fix is left, and spins stand before contacts, after the steps are reset."""
    text = cycle_deck(ledger="dumps", solver={"rolling_friction": "cdt"})
    order = (RESET, "compute wall_contact", "dump spins", "dump contacts", "run ", "write_restart")
    places = [position(text, start) for start in order]
    assert places == sorted(places)
    assert "# Runs by hand: liggghts -in deck.in" in text.split("\n\n")[0]
    assert "ledger" not in text


@pytest.mark.parametrize(("rolling", "program"), [("own_spin", "build/liggghts-ledger"), ("cdt", "hand: liggghts")])
def test_a_bed_says_which_program_runs_it(rolling, program):
    """LIGGGHTS itself lacks some rolling models."""
    _, bed = run_and_bed(tiny_study(solver={"rolling_friction": rolling}))
    (line,) = re.findall("# Runs by hand: .*", render("settled_bed", settled_bed(bed)))
    assert f"{program} -in deck.in" in line


def test_a_law_with_a_kernel_asks_the_solver_for_it():
    """The fix gets exactly the kernels that the law needs, each with its parameters in SI, all digits of them."""
    with long_slip_registered():
        chosen = {law: wear_settings(law) for law in ("archard", "finnie", "long_slip")}
        chosen["long_slip"]["parameters"] = {"exponent": 5 / 3}
        texts = {law: cycle_deck(wear=settings) for law, settings in chosen.items()}
    asked = {law: re.search(r" file load_ledger.bin history \d+(.*)", text)[1] for law, text in texts.items()}
    assert asked == {
        "archard": "",
        "finnie": " kernels finnie_work",
        "long_slip": " kernels long_slip exponent 1.6666666666666667 length_m 0.002",
    }


def test_the_producer_adds_its_own_parameters_only():
    """A parameter of the other producer is one that is never used."""
    parameters, bed = run_and_bed(tiny_study())
    given = sliding_sample(parameters, bed, cycle(parameters, 1), "run.restart")
    with pytest.raises(DeckError, match=r"parameter contact_format is never used"):
        render("sliding_sample", {**given, "contact_format": "%g"})
    with pytest.raises(DeckError, match=r"parameter ledger_kernels is not given"):
        render("sliding_sample", {key: value for key, value in given.items() if key != "ledger_kernels"})


def test_bed_has_travelled_run_in_and_all_earlier_cycles():
    """The end walls of cycle k start where cycle k-1 left them: the run-in and k-1 cycles on."""
    parameters, _ = run_and_bed(tiny_study())
    sliding = parameters["sliding"]
    cycle = sliding["travel_m"] / sliding["cycles"]
    assert deck.travelled(parameters, 0) == 0.0
    for span in known_spans(parameters):
        expected = sliding["run_in_m"] + (span.cycle - 1) * cycle
        steps = parameters["derived"]["run_in_steps"] + span.first_step
        assert deck.travelled(parameters, steps) == pytest.approx(expected, rel=1e-3)


def test_every_particle_pair_keeps_its_own_property():
    """Pair tables are symmetric and have the floor's value only where the floor takes part."""
    table = settled_bed(run_and_bed(tiny_study())[1])["sliding_friction"]
    assert table[0][0] == 0.21 and table[0][2] == 0.38
    assert all(table[i][j] == table[j][i] for i in range(3) for j in range(3))


def test_a_periodic_bed_has_no_ends():
    """No wall at an end in any deck; the domain is periodic along the travel and exactly as long as the bed."""
    parameters, bed = run_and_bed(tiny_study(bed={"ends": "periodic", "ahead_mm": 80}))
    settled = settled_bed(bed)
    texts = [
        render("settled_bed", settled),
        render("lowered_bed", lowered_bed(parameters, bed, "bed.restart")),
        render("sliding_sample", sliding_sample(parameters, bed, cycle(parameters, 1), "run.restart")),
    ]
    for text in texts:
        assert "boundary        p p fm" in text
        assert not re.search(r"upstream_end|downstream_end|end_wall|move/mesh", text)
    for text in texts[1:]:
        assert "shear y ${velocity}" in text and "v_bed_pace" in text
    assert settled["domain_end_m"] - settled["domain_start_m"] == pytest.approx(0.02 + 0.04 + 0.08, rel=1e-12)
    assert settled["fill_gap_m"] == 0.0


@pytest.mark.parametrize("scale", [2, 4, 6, 12])
@pytest.mark.parametrize("ends", ["walls", "periodic", "window"])
def test_the_poured_mass_is_that_of_a_level_bed(ends, scale):
    """Whatever ends and particles: bulk density times width, length and thickness, and the room in which it is placed,
    off floor and end walls, holds it at the fraction that can be placed; no grain sticks out of the domain.
    """
    wide = {
        "ends": ends,
        "ahead_mm": 500,
        "behind_mm": 500,
        "width_mm": 300,
        "allow_thin_bed": True,
        "exchange_mm": 200,
    }
    _, bed = run_and_bed(tiny_study(particle_scale=scale, bed=wide, sample={"length_mm": 40}, solver=SHORT_STEPS))
    settled, largest = settled_bed(bed), max(bed["particle"]["diameters_m"])
    mass = 0.59 * 2460.0 * 0.3 * bed["length_m"] * bed["thickness_m"]
    assert settled["poured_mass_kg"] == pytest.approx(mass, rel=1e-12)
    gap = 0.6 * largest
    length = bed["length_m"] - (2.0 * gap if ends == "walls" else largest)  # none is placed across periodic faces
    room = (0.3 - largest) * length * (settled["fill_top_m"] - bed["temporary_floor_m"] - gap)
    assert 0.34 * 2460.0 * room == pytest.approx(mass, rel=1e-12)
    assert settled["fill_bottom_m"] - bed["temporary_floor_m"] == pytest.approx(gap, rel=1e-12)
    assert settled["fill_top_m"] + 0.5 * largest < settled["domain_top_m"]
    assert "delete_atoms" not in render("settled_bed", settled)


@pytest.mark.solver
@pytest.mark.parametrize(("ends", "scale"), [("walls", 4), ("walls", 8), ("periodic", 4), ("window", 4), ("window", 8)])
def test_a_settled_bed_has_its_mass_and_level(tmp_path, ends, scale):
    """The solver's bed is within its tolerances; asked for half the thickness, it is refused with its numbers. That of
    a window is measured again where it has fallen a second time, which packs it denser.
    """
    room = {"ends": ends, "ahead_mm": 80, "behind_mm": 80, "allow_thin_bed": True, "exchange_mm": 60}
    study, log = tiny_study(particle_scale=scale, bed=room), tmp_path / LOG
    ((name, bed),) = study.beds.items()
    fill_bed(study.case, name, bed, tmp_path)
    measures = study.case.bed_measures(bed, log)
    names = [each.measure for each in measures]
    assert names == ["mass", "level", *(["mass in use", "level in use"] if ends == "window" else [])]
    assert bed_fault(measures) is None and [each.measure for each in read_measures(tmp_path)] == names
    levels = [each.found - each.asked for each in measures if each.unit == "m"]
    assert 0.5 * bed["particle"]["median_diameter_m"] > levels[0] >= levels[-1] > 0.0
    assert (len(levels) == 2) == (levels[0] > levels[-1])
    halved = study.case.bed_measures({**bed, "thickness_m": 0.5 * bed["thickness_m"]}, log)
    assert all(each.missed for each in halved)
    assert "mass" in bed_fault(halved) and "level" in bed_fault(halved)


@pytest.mark.solver
def test_a_large_bed_of_equal_spheres_is_poured_whole(tmp_path):
    """Of 28,000 all find room, though the last ones only after hundreds of places."""
    parameters, bed = run_and_bed(
        load_study("particle_size", overrides={"fidelity": "quick", "rows": ["S3"], "packings": 1}), "S3_plain"
    )
    particle = parameters["particle"]
    equal = {"diameters_m": [particle["median_diameter_m"]], "mass_fractions": [1.0]}
    text = render("settled_bed", settled_bed({**bed, "particle": {**bed["particle"], **equal}}))
    (tmp_path / "deck.in").write_text(text[: text.index("unfix           pour")])
    run_deck(tmp_path, executable=LEDGER_EXECUTABLE)
    (poured,) = re.findall(r"inserted (\d+) particle templates \(mass (\S+)\) at step 1", (tmp_path / LOG).read_text())
    assert int(poured[0]) > 20_000
    assert float(poured[1]) == pytest.approx(bed_mass(bed), rel=1e-3)
