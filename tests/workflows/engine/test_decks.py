"""Templates and their parameters: complete, documented; words of the user's own."""

import re
import shutil
import threading

import pytest

from bulkwear.workflows.cases.sliding_sample.decks import lowered_bed, settled_bed, sliding_sample
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine import template_files, templates
from bulkwear.workflows.engine.chain import bed_deck_text
from bulkwear.workflows.engine.project import Project
from bulkwear.workflows.engine.schedule import known_spans
from bulkwear.workflows.engine.template_files import DeckError, template_file
from bulkwear.workflows.engine.templates import render, template_sources, template_variables
from tests import REPOSITORY
from tests.support.tiny import tiny_study

TEMPLATES = REPOSITORY / "templates"
NAMES = sorted(path.name.removesuffix(".in.j2") for path in TEMPLATES.glob("[!_]*/*.in.j2"))
README = (TEMPLATES / "README.md").read_text()


def run_and_bed(study, name="R9_convex"):
    return study.run(name).parameters, study.beds[study.bed_of(name)]


def test_every_variable_of_the_templates_is_in_their_readme():
    """The table has each variable of the templates once, and no other."""
    used = set().union(*(template_variables(name) for name in NAMES))
    listed = re.findall(r"^\| `(\w+)` \|", README.split("## Variables")[1], re.MULTILINE)
    assert sorted(listed) == sorted(used)


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
def test_a_branch_not_taken_asks_for_nothing(tmp_path, monkeypatch, words, used):
    """Only what the branch taken uses is wanted, its partials included; other conditions count as taken."""
    monkeypatch.setattr(template_files, "current_project", lambda: Project(tmp_path, package=tmp_path))
    (tmp_path / "templates").mkdir()
    (tmp_path / "templates/case.in.j2").write_text(
        '{% if kind == "one" %}{% include "part.in.j2" %}{% else %}{{ b }}{% endif %}\n'
        "{% if often > 2 %}{{ c }}{% endif %}"
        '{% if solver.model in ("one", "three") %}{{ d }}{% endif %}'
    )
    (tmp_path / "templates/part.in.j2").write_text("{{ a }}")
    words = {"solver": {"model": "two"}} | words
    assert template_variables("case", words) == used | {"solver"}


def test_a_thread_waits_while_another_one_asks():
    """Trees of templates are kept and pruned for each question, so two at once would spoil one another's."""
    environment, stamp = template_files.templates_read()
    whole, answers = template_variables("settled_bed"), []
    asker = threading.Thread(target=lambda: answers.append(template_variables("settled_bed")))
    with templates._pruned_trees(environment, "settled_bed", {"shape": "sphere"}, stamp):
        templates._kept_uses.cache_clear()
        asker.start()
        asker.join(0.2)
        assert asker.is_alive()
    asker.join()
    assert answers == [whole]


def test_missing_and_unused_parameters_are_errors():
    """The message names template and parameter."""
    given = settled_bed(run_and_bed(tiny_study())[1])
    with pytest.raises(DeckError, match=r"templates/sliding_sample/settled_bed\.in\.j2: parameter skin_m is not given"):
        render("settled_bed", {key: value for key, value in given.items() if key != "skin_m"})
    with pytest.raises(DeckError, match="parameter colour is never used"):
        render("settled_bed", {**given, "colour": "red"})


def test_decks_begin_with_their_case_and_keep_the_order_of_blocks():
    """Header with source, axes and files; then the blocks in one order in every deck."""
    order = ["domain", "materials", "contact model", "geometry", "particles", "integration", "output", "run"]
    for name in NAMES:
        text = "".join(template_sources(name)[part] for part in [f"{name}.in.j2"])
        whole = re.sub(
            r'\{% include "(.*?)" %\}', lambda found, name=name: template_sources(name)[found[1]].rstrip(), text
        )
        for word in ("Runs by hand:", "Axes:", "Source of the case:", "Writes:"):
            assert word in whole.split("\n\n")[0]
        blocks = {found: index for index, found in enumerate(order)}
        titles = [title for title in re.findall(r"^# --- ([a-z ]+?)(?::.*)? -", whole, re.MULTILINE) if title in blocks]
        assert [blocks[title] for title in titles] == sorted(blocks[title] for title in titles)
        assert {"domain", "materials", "contact model", "geometry", "integration", "output", "run"} <= set(titles)


def test_random_seeds_are_primes_above_ten_thousand():
    """LIGGGHTS refuses other seeds; the first five primes above 10,000 are known."""
    assert deck.primes(1, 5) == [10007, 10009, 10037, 10039, 10061]


# ---------------------------------------------------------------- words of the user's own


@pytest.fixture
def edited(tmp_path, monkeypatch):
    """A function that adds a line to a template of a copy, from which decks are made during a test."""
    shutil.copytree(TEMPLATES, tmp_path / "templates")
    monkeypatch.setattr(template_files, "current_project", lambda: Project(tmp_path, package=tmp_path))

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
    text = render("sliding_sample", sliding_sample(parameters, bed, known_spans(parameters)[0], "run.restart"))
    assert text.splitlines()[-1] == 'print "5 vermilion"'
    assert bed == run_and_bed(tiny_study(deck={"gap_mm": 6, "kind": "vermilion"}))[1]
    assert "vermilion" not in render("lowered_bed", lowered_bed(parameters, bed, "bed.restart"))


def test_a_word_in_the_template_of_beds_is_part_of_a_bed(edited):
    """Two values make two beds, and the word stands in the bed's deck."""
    edited("settled_bed", "# {{ my_word }}")
    studies = [tiny_study(deck={"my_word": value}) for value in (1, 2)]
    beds = [study.beds["bed_R5"] for study in studies]
    assert beds[0] != beds[1]
    assert bed_deck_text(studies[1].case, beds[1]).endswith("# 2\n")


def test_a_word_that_no_template_uses_is_refused(config):
    """One sentence names file, line and word, before the solver; so for a word of a fidelity's block."""
    config.edit("studies/small.yaml", "    particle_scale: 2.0\n", "    particle_scale: 2.0\n    deck: {my_word: 3}\n")
    with pytest.raises(ConfigError) as caught:
        load_study("small", config.project)
    assert str(caught.value) == (
        "config/studies/small.yaml, line 9, fidelity quick: deck.my_word stands in no template, allowed is a word that"
        " one of lowered_bed, sliding_sample, settled_bed, packed_container, bed_contacts, collision uses."
    )


@pytest.mark.parametrize(
    ("name", "word", "template"),
    [
        ("demo", "velocity_m_per_s", "lowered_bed"),
        ("demo", "poured_mass_kg", "settled_bed"),
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
    shown = template_file(f"{template}.in.j2").relative_to(REPOSITORY)
    assert str(caught.value) == f"command line: {shown}: {fault}"


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


@pytest.mark.parametrize(
    ("text", "part", "said"),
    [
        ("units si\n{{ a / b }}\n", "", r"templates/case\.in\.j2, line 2: ZeroDivisionError: division by zero\."),
        (
            '{% include "part.in.j2" %}\n',
            "1\n2\n{{ a.b }}\n",
            r"templates/part\.in\.j2, line 3: UndefinedError: '[^.]*'\.",
        ),
        ("1\n{% if a %}\n", "", r"templates/case\.in\.j2, line 2: Unexpected end of template\. .*[^.]\."),
        ("1\n2\n{% for x in a %}{% endfor %}", "", r"templates/case\.in\.j2, line 3: TypeError: [^.]*\."),
    ],
)
def test_a_fault_while_a_template_is_filled_has_its_line(tmp_path, monkeypatch, text, part, said):
    """The file and the line are those of the partial where the fault is in one; the sentence has one full stop."""
    monkeypatch.setattr(template_files, "current_project", lambda: Project(tmp_path, package=tmp_path))
    (tmp_path / "templates").mkdir()
    (tmp_path / "templates/case.in.j2").write_text(text)
    (tmp_path / "templates/part.in.j2").write_text(part)
    with pytest.raises(DeckError) as fault:
        used = template_variables("case")
        render("case", {name: value for name, value in {"a": 3, "b": 0}.items() if name in used})
    assert re.fullmatch(said, str(fault.value))


def test_a_setting_that_is_not_given_is_named():
    """A template that asks for a setting of the solver that there is not says which."""
    given = settled_bed(run_and_bed(tiny_study())[1])
    solver = {key: value for key, value in given["solver"].items() if key != "rolling_radius"}
    with pytest.raises(DeckError, match=r"settled_bed\.in\.j2: parameter solver\.rolling_radius is not given"):
        render("settled_bed", {**given, "solver": solver})
