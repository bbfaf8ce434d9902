"""What a project's own templates leave out of the package's decks is told, however they are cut into partials."""

import pytest

from bulkwear.workflows.config.deck_commands import commands, left_out, whole_text
from bulkwear.workflows.engine.project import PACKAGE, Project, template_files

DECK, PARTIAL = "sliding_sample.in.j2", "_shared/integration.in.j2"
THEIRS = {name: PACKAGE / path for name, path in template_files(PACKAGE).items()}


@pytest.fixture
def own(tmp_path):
    """A function that writes a template of a project, and the project."""

    def written(name, text):
        path = tmp_path / "templates" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return Project(tmp_path)

    return written


@pytest.mark.parametrize("name", sorted(THEIRS))
def test_a_copy_leaves_nothing_out(own, name):
    """Neither does one with all that it includes written out."""
    assert left_out(own(name, THEIRS[name].read_text())) == []
    assert left_out(own(name, whole_text(name, THEIRS))) == []


@pytest.mark.parametrize(
    ("removed", "missing"),
    [
        ('{% include "_shared/integration.in.j2" %}', ["fix gravity", "fix motion", "fix step_check"]),
        ('{% include "_shared/travel.in.j2" %}', ["delete_atoms", "read_data", "velocity"]),
        ("write_restart   run.restart", ["write_restart run.restart"]),
        ('if "${begin_step} == 0" then "reset_timestep 0" ', ["reset_timestep"]),
        ("dump            bed all custom ${picture_steps} ", ["dump bed"]),
    ],
)
def test_a_command_that_is_left_out_is_named(own, removed, missing):
    text = THEIRS[DECK].read_text()
    assert removed in text
    (said,) = left_out(own(DECK, text.replace(removed, "# ")))
    assert said == f"templates/{DECK}: without {', '.join(missing)} of the package's deck"


def test_a_partial_of_the_project_s_own_is_told_itself(own):
    """What it lacks is lacking in every deck that includes it, an own one too; that is said once. What a deck lacks
    may stand in a partial of the project's.
    """
    own(DECK, THEIRS[DECK].read_text())
    said = left_out(own(PARTIAL, "fix gravity all gravity 9.81 vector 0. 0. -1.\n"))
    assert said == [f"templates/{PARTIAL}: without fix motion, fix step_check of the package's deck"]
    own(DECK, THEIRS[DECK].read_text().replace("write_restart   run.restart", ""))
    assert left_out(own(PARTIAL, THEIRS[PARTIAL].read_text() + "write_restart run.restart\n")) == []


def test_columns_of_progress_count_one_by_one(own):
    """Tables are made of them: a deck without one ended after its first cycle."""
    name = "_shared/thermo.in.j2"
    text = THEIRS[name].read_text()
    assert " v_force_x" in text
    (said,) = left_out(own(name, text.replace(" v_force_x", "")))
    assert said == f"templates/{name}: without thermo_style v_force_x of the package's deck"


def test_many_commands_are_counted(own):
    (said,) = left_out(own(DECK, "run 1000\n"))
    others = len(commands(DECK, THEIRS)) - 1
    assert said.startswith(f"templates/{DECK}: without units, ")
    assert said.endswith(f" and {others - 6} more of the package's deck")


def test_the_package_itself_leaves_nothing_out():
    assert left_out(Project(PACKAGE)) == []
