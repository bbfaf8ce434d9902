"""Templates and their parameters: complete, documented, and one golden deck."""

import re
import shutil

import pytest

from tests import DATA
from tests.support.law_cases import long_slip_registered, wear_settings
from tests.support.tiny import tiny_study
from workflows.cases.sliding_sample.decks import lowered_bed, settled_bed, sliding_sample
from workflows.config.design import ConfigError, list_studies, load_study
from workflows.engine import decks as deck
from workflows.engine import templates
from workflows.engine.chain import bed_deck_text
from workflows.engine.schedule import known_spans
from workflows.engine.templates import TEMPLATES, DeckError, render, template_sources, template_variables

NAMES = sorted(path.name.removesuffix(".in.j2") for path in TEMPLATES.glob("[!_]*/*.in.j2"))
README = (TEMPLATES / "README.md").read_text()
RESET = 'if "${begin_step} == 0" then "reset_timestep 0"'  # a later piece goes on counting
GOLDEN = DATA / "golden_sliding_sample.in"


SLIDING = [name for name in list_studies() if load_study(name).case.name == "sliding_sample"]


def run_and_bed(study, name="R9_convex"):
    return study.run(name).parameters, study.beds[study.bed_of(name)]


def test_every_variable_of_the_templates_is_in_their_readme():
    """The table has each variable of the templates once, and no other."""
    used = set().union(*(template_variables(name) for name in NAMES))
    listed = re.findall(r"^\| `(\w+)` \|", README.split("## Variables")[1], re.MULTILINE)
    assert sorted(listed) == sorted(used)


@pytest.mark.parametrize("name", SLIDING)
@pytest.mark.parametrize("rolling_friction", ["cdt", "epsd2"])
@pytest.mark.parametrize(
    ("ledger", "ends"),
    [("solver", "walls"), ("dumps", "walls"), ("solver", "periodic"), ("solver", "window"), ("dumps", "window")],
)
def test_every_deck_of_every_sliding_study_renders(name, rolling_friction, ledger, ends):
    """No deck has an open word, a missing or an unused parameter, or a tab."""
    changes = {"solver": {"rolling_friction": rolling_friction}, "ledger": ledger, "bed": {"ends": ends}}
    study = load_study(name, overrides=changes)
    texts = [render("settled_bed", settled_bed(bed)) for bed in study.beds.values()]
    for run in study.runs:
        parameters, bed = run_and_bed(study, run.name)
        texts.append(render("lowered_bed", lowered_bed(parameters, bed, "bed.restart")))
        texts.append(render("sliding_sample", sliding_sample(parameters, bed, cycle(parameters, 1), "run.restart")))
    for text in texts:
        assert f"rolling_friction {rolling_friction}" in text
        assert not re.search(r"\{\{|\}\}|\{%|%\}|\t|\bNone\b|\bnan\b", text)


def test_golden_deck():
    """The deck of the tiny chain's second cycle, word for word; a change of it is a decision."""
    parameters, bed = run_and_bed(tiny_study())
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
    study = tiny_study(bed={"ends": ends, "ahead_mm": 60, "exchange_mm": 60})
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
    text = cycle_deck(ledger="dumps")
    order = (RESET, "compute wall_contact", "dump spins", "dump contacts", "run ", "write_restart")
    places = [position(text, start) for start in order]
    assert places == sorted(places)
    assert "# Runs by hand: liggghts -in deck.in" in text.split("\n\n")[0]
    assert "ledger" not in text


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


@pytest.mark.parametrize(
    ("words", "used"),
    [
        ({}, {"kind", "often", "a", "b", "c"}),
        ({"kind": "one"}, {"kind", "often", "a", "c"}),
        ({"kind": "two"}, {"kind", "often", "b", "c"}),
        ({"kind": "one", "often": 3}, {"kind", "often", "a", "c"}),
        ({"solver": {"model": "two"}}, {"kind", "often", "a", "b", "c"}),
        ({"solver": {"model": "one"}}, {"kind", "often", "a", "b", "c", "d"}),
    ],
)
def test_a_branch_not_taken_asks_for_nothing(tmp_path, words, used):
    """Only what the branch taken uses is wanted, its partials included; other conditions count as taken."""
    (tmp_path / "case.in.j2").write_text(
        '{% if kind == "one" %}{% include "part.in.j2" %}{% else %}{{ b }}{% endif %}\n'
        "{% if often > 2 %}{{ c }}{% endif %}"
        '{% if solver.model in ("one", "three") %}{{ d }}{% endif %}'
    )
    (tmp_path / "part.in.j2").write_text("{{ a }}")
    words = {"solver": {"model": "two"}} | words
    assert template_variables("case", tmp_path, words) == used | {"solver"}


def test_missing_and_unused_parameters_are_errors():
    """The message names template and parameter."""
    given = settled_bed(run_and_bed(tiny_study())[1])
    with pytest.raises(DeckError, match=r"templates/settled_bed\.in\.j2: parameter skin_m is not given"):
        render("settled_bed", {key: value for key, value in given.items() if key != "skin_m"})
    with pytest.raises(DeckError, match=r"templates/settled_bed\.in\.j2: parameter colour is never used"):
        render("settled_bed", {**given, "colour": "red"})


def test_decks_begin_with_their_case_and_keep_the_order_of_blocks():
    """Header with source, axes and files; then the blocks in one order in every deck."""
    order = ["domain", "materials", "contact model", "geometry", "particles", "integration", "output", "run"]
    for name in NAMES:
        text = "".join(template_sources(name)[part] for part in [f"{name}.in.j2"])
        for word in ("Runs by hand:", "Axes:", "Source of the case:", "Writes:"):
            assert word in text.split("\n\n")[0]
        blocks = {found: index for index, found in enumerate(order)}
        whole = re.sub(r'\{% include "(.*?)" %\}', lambda found, name=name: template_sources(name)[found[1]], text)
        titles = [title for title in re.findall(r"^# --- ([a-z ]+?)(?::.*)? -", whole, re.MULTILINE) if title in blocks]
        assert [blocks[title] for title in titles] == sorted(blocks[title] for title in titles)
        assert {"domain", "materials", "contact model", "geometry", "integration", "output", "run"} <= set(titles)


def test_random_seeds_are_primes_above_ten_thousand():
    """LIGGGHTS refuses other seeds; the first five primes above 10,000 are known."""
    assert deck.primes(1, 5) == [10007, 10009, 10037, 10039, 10061]


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


# ---------------------------------------------------------------- words of the user's own


@pytest.fixture
def edited(tmp_path, monkeypatch):
    """A function that adds a line to a template of a copy, from which decks are made during a test."""
    shutil.copytree(TEMPLATES, tmp_path / "templates")
    original = templates._environment
    monkeypatch.setattr(templates, "_environment", lambda folder: original(tmp_path / "templates"))

    def add(name, line):
        (path,) = (tmp_path / "templates").glob(f"*/{name}.in.j2")
        with open(path, "a") as stream:
            stream.write(line + "\n")

    return add


def test_a_word_of_the_users_own_reaches_its_template_as_it_is_written(edited):
    """Also one whose name ends in a unit. Templates without it take no notice; beds that do not use it are shared."""
    edited("sliding_sample", 'print "{{ gap_mm }} {{ kind }}"')
    study = tiny_study(deck={"gap_mm": 5, "kind": "vermilion"})
    parameters, bed = run_and_bed(study)
    text = render("sliding_sample", sliding_sample(parameters, bed, cycle(parameters, 1), "run.restart"))
    assert text.splitlines()[-1] == 'print "5 vermilion"'
    assert bed == run_and_bed(tiny_study(deck={"gap_mm": 6, "kind": "vermilion"}))[1]
    assert "vermilion" not in render("lowered_bed", lowered_bed(parameters, bed, "bed.restart"))


def test_a_word_in_the_template_of_beds_is_part_of_a_bed(edited):
    """Two values make two beds, and the word stands in the bed's deck."""
    edited("settled_bed", "# {{ my_word }}")
    studies = [tiny_study(deck={"my_word": value}) for value in (1, 2)]
    beds = [study.beds["bed_1"] for study in studies]
    assert beds[0] != beds[1]
    assert bed_deck_text(studies[1].case, beds[1]).endswith("# 2\n")


def test_a_word_that_no_template_uses_is_refused(config):
    """One sentence names file, line and word, before the solver; so for a word of a fidelity's block."""
    config.edit("studies/small.yaml", "    particle_scale: 2.0\n", "    particle_scale: 2.0\n    deck: {my_word: 3}\n")
    with pytest.raises(ConfigError) as caught:
        load_study("small", config.root)
    assert str(caught.value) == (
        "config/studies/small.yaml, line 9, fidelity quick: deck.my_word stands in no template, allowed is a word that"
        " one of lowered_bed, sliding_sample, settled_bed, packed_container, bed_contacts, collision uses."
    )


@pytest.mark.parametrize(
    ("name", "word", "template"),
    [
        ("demo", "velocity_m_per_s", "lowered_bed"),
        ("demo", "level_m", "settled_bed"),
        ("demo", "solver", "lowered_bed"),
        ("pin_on_disc", "pin_radius_m", "pin_set_down"),
        ("circular_tester", "steady_steps", "tester_bed"),
        ("calibration", "rest_energy_j", "shear_box"),
    ],
)
def test_a_word_of_ours_is_refused(name, word, template):
    """No word of the user's own changes a parameter, in no case."""
    with pytest.raises(ConfigError) as caught:
        load_study(name, overrides={"deck": {word: 3}})
    fault = f"parameter {word} is one of ours, no word of deck may be called so."
    assert str(caught.value) == f"command line: templates/{template}.in.j2: {fault}"


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        ({"bad-name": 1}, "deck is 'bad-name', allowed is a name of letters, digits and underscores"),
        ({"several": [1, 2]}, "deck.several is [1, 2], allowed is a number, text, true or false"),
    ],
)
def test_words_are_names_and_values(words, fault):
    """Names that Jinja could not read and values that are no word are refused."""
    with pytest.raises(ConfigError) as caught:
        load_study("demo", overrides={"deck": words})
    assert str(caught.value) == f"command line: {fault}."


def test_a_setting_that_is_not_given_is_named():
    """A template that asks for a setting of the solver that there is not says which."""
    given = settled_bed(run_and_bed(tiny_study())[1])
    solver = {key: value for key, value in given["solver"].items() if key != "rolling_radius"}
    with pytest.raises(DeckError, match=r"settled_bed\.in\.j2: parameter solver\.rolling_radius is not given"):
        render("settled_bed", {**given, "solver": solver})
