"""A bed in a window that travels with the sample: exchanges of bed behind it for fresh bed in front of it."""

import itertools
import re
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from bulkwear.postproc.mesh import read_surface
from bulkwear.postproc.readers.cycle_folders import PACKING
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.readers.solver_log import exchanges, thermo_table
from bulkwear.workflows.cases.sliding_sample.case import SlidingSample, exchanged_particles, front_lag
from bulkwear.workflows.cases.sliding_sample.decks import exchange_steps, lowered_bed, sliding_sample
from bulkwear.workflows.cases.sliding_sample.work import run_stages
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.chain import write_cycle
from bulkwear.workflows.engine.derived import SKIN_OVER_RADIUS, window_lengths
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.ledgers import summed_by_solver
from bulkwear.workflows.engine.schedule import first_span, known_spans
from bulkwear.workflows.engine.solver import run_deck
from bulkwear.workflows.engine.template_files import templates_read
from bulkwear.workflows.engine.templates import render
from bulkwear.workflows.engine.work import builds_per_step
from tests.support.tiny import tiny_chain, tiny_study

WINDOW = {
    "particle_scale": 6,
    "bed": {"ends": "window", "exchange_mm": 40, "ahead_mm": 200, "behind_mm": 60, "allow_thin_bed": True},
    "sliding": {"run_in_mm": 60, "travel_mm": 120, "cycles": 2},
    "solver": {"picture_interval_mm": 5},
}
EXCHANGE = 0.04  # m
PICTURE_STEPS = 50  # between two snapshots of a cycle by hand
ROUNDING = 1e-12  # m, of places that awk prints with 15 digits
FRONT_LAG = 0.1  # -, 160 mm ahead of a small sample in a bed of two layers; seen 0.02
PRINTED = 2e-6  # m, of places that the solver prints with six digits
UNDISTURBED = 0.02  # m/s, of nine tenths of fresh bed against its floor; seen 0.005
LOOSE = 0.5  # m/s, of the rest, a grain on top that tumbles down; seen 0.1, and 6 where the bed enters 1 mm too low
# Relative, work of two ranks against one, that sums in another order: in a bed the difference grows some 300 times per
# fifth of the cycle, from 6e-16 to 4e-11 at the look taken here; at its end one contact more or less is 2e-5.
RANKS_PART = 1e-8
UNDISTURBED_STEPS = 500  # since an exchange, in which the sample has not come near


def mesh_of(chain):
    """The surface of a run as the solver gets it."""
    return chain.case.pieces(chain.parameters, None, read_surface(chain.surface))[0]


def window_study(**changes):
    return tiny_study(**{**WINDOW, **changes})


def decks(study):
    """Parameters of the decks of a run, cycle 0 first, and its bed."""
    parameters, bed = study.run("R9_convex").parameters, study.beds[study.bed_of("R9_convex")]
    later = [sliding_sample(parameters, bed, span, "run.restart") for span in known_spans(parameters)]
    return [lowered_bed(parameters, bed, "bed.restart"), *later], bed


# ---------------------------------------------------------------- when bed is exchanged


@given(
    st.lists(st.integers(1, 500), min_size=1, max_size=6),
    st.integers(2, 200),
    st.just(0) | st.integers(2, 60),
    st.integers(1, 50),
)
def test_each_exchange_is_done_once_in_whatever_cycles_the_travel_is_cut(cycles, every, look, lowering):
    """From the instant at which the bed is set in motion on, every so many steps, in exactly one deck; only what falls
    on a look at the wear is one step late."""
    found, before = exchange_steps(-lowering, lowering + cycles[0], every), cycles[0]
    done = [step - lowering for step in found]
    for steps in cycles[1:]:
        here = exchange_steps(before, steps, every, look)
        assert all(0 < step <= steps for step in here)
        assert not any(look and step < steps and step % look == 0 for step in here)
        late = [step for step in here if (before + step) % every]
        assert all(look and (step - 1) % look == 0 for step in late)
        done += [before + step - (step in late) for step in here]
        before += steps
    assert done == list(range(0, before + 1, every))


def test_decks_continue_each_others_travel():
    """What a deck counts as travelled when it begins is what those before it counted when they ended."""
    (first, *later), bed = decks(window_study())
    steps = first["steps_before"] + first["end_step"]
    for parameters in later:
        assert parameters["steps_before"] == steps
        steps += parameters["end_step"]
    assert steps * later[0]["travel_per_step_m"] == pytest.approx(0.18, rel=1e-3)
    assert later[0]["period_m"] == bed["length_m"]


def test_the_window_is_as_long_whatever_the_travel():
    """Behind 60, sample 40, ahead 200, exchange 40 mm, a held strip of two of the largest particles and room of one
    and the neighbour skin off the wake; runs of all travels and velocities share the bed."""
    largest, smallest = 6 * 1.2 * 2.65e-3, 6 * 0.8 * 2.65e-3
    expected = 0.06 + 0.04 + 0.2 + 0.04 + 3.0 * largest + 0.5 * SKIN_OVER_RADIUS * smallest
    studies = [window_study(sliding={"run_in_mm": 60, "travel_mm": travel, "cycles": 2}) for travel in (120, 12000)]
    for study in studies:
        derived = study.run("R9_convex").parameters["derived"]
        assert derived["bed_length_m"] == pytest.approx(expected, rel=1e-9)
        assert derived["bed_start_m"] + derived["bed_length_m"] == pytest.approx(0.02 + 0.06)
        assert derived["bed_travel_m"] == 0.0
    assert studies[0].beds == studies[1].beds
    face = decks(studies[0])[0][0]["face_m"]
    strip, clearance = window_lengths(studies[0].run("R9_convex").parameters["particle"])
    assert -0.02 - face - strip - EXCHANGE == pytest.approx(0.2)
    assert face - studies[0].beds["bed_R5"]["start_m"] == pytest.approx(clearance)


def test_the_forecast_of_a_window_grows_with_the_travel_only():
    """Ten times the travel: the same particles in ten times the steps. Each exchange makes a neighbour list anew."""
    stages = []
    for travel in (120, 1200):
        study = window_study(sliding={"run_in_mm": 60, "travel_mm": travel, "cycles": 2})
        parameters, bed = study.run("R9_convex").parameters, study.beds[study.bed_of("R9_convex")]
        stages.append(run_stages(parameters, bed)[-1])
        often = stages[-1].builds - builds_per_step(parameters) * stages[-1].steps
        assert often == pytest.approx(travel / 1000.0 / EXCHANGE)
    assert stages[0].particles == stages[1].particles
    assert stages[1].steps == pytest.approx(10 * stages[0].steps, rel=1e-3)


def test_decks_of_a_window_keep_ids_and_the_strip():
    """Contacts are found by ids, which deleting must not renumber; the strip is held after gravity acts."""
    for name, parameters in zip(("lowered_bed", "sliding_sample"), decks(window_study())[0], strict=False):
        text = render(name, parameters)
        assert "delete_atoms    group wake compress no" in text
        assert text.index("fix  gravity") < text.index("fix  strip_held")
        assert "boundary        p p fm" in text and "upstream_end" not in text


def test_other_beds_do_not_know_of_exchanges():
    """Without a window the travel between exchanges is no parameter, and no deck exchanges anything."""
    one, other = (tiny_study(bed={"exchange_mm": travel}).run("R9_convex").parameters for travel in (30, 50))
    assert one == other and "exchange_m" not in one["bed"]
    for text in (render("lowered_bed", decks(tiny_study())[0][0]),):
        assert not re.search(r"strip|exchange|packing", text)


# ---------------------------------------------------------------- what enters


class Window:
    """The deck's own selection of fresh bed, outside the solver."""

    def __init__(self, folder, packing, period):
        self.folder, self.face, self.period = folder, -0.13, period
        lines = [f"{k + 1} 1 0.01 2460 {x:.17g} {y:.17g} {z:.17g}" for k, (x, y, z) in enumerate(packing)]
        (folder / "packing.dump").write_text("\n".join([*["ITEM"] * 9, *lines]) + "\n")
        names = ("face_m", "strip_length_m", "clearance_m", "travel_per_step_m", "steps_before")
        words = {name: 0.0 for name in names} | {
            "ends": "window",
            "cycle": 1,
            "exchange_steps": [1],
            "period_m": period,
            "packing_file": "packing.dump",
        }
        text = templates_read()[0].get_template("_shared/fresh_bed.in.j2").render(words)
        command = re.search(r"^shell +(awk .*?fresh_bed\.data\")$", text.replace("&\n", ""), re.MULTILINE)[1]
        self.command = command.replace("\"'", "'").replace("'\"", "'").replace('"> ', "> ").removesuffix('"')

    def fresh(self, travel, strip_start, newest):
        """Ids and places of the particles that enter."""
        values = {
            "v_face": self.face,
            "v_strip_start-v_face-v_nanometre": strip_start - self.face - 1e-9,
            "v_travel": travel,
            "v_newest": newest,
        }
        command = self.command
        for name, value in values.items():
            command = command.replace(f"$({name})", f"{value:.20g}")
        subprocess.run(command, shell=True, check=True, cwd=self.folder)
        lines = (self.folder / "fresh_bed.data").read_text().splitlines()
        assert lines[2] == f"{len(lines) - 6} atoms" and lines[4] == "Atoms"
        table = np.array([line.split() for line in lines[6:]], float).reshape(-1, 7)
        assert (table[:, 1:4] == [1, 0.01, 2460]).all()
        return table[:, 0].astype(int), table[:, 4:]


@pytest.mark.parametrize("seed", range(3))
def test_fresh_bed_continues_the_packing_over_periods_of_travel(tmp_path, seed):
    """Exchanges at irregular travels, over two and a half periods: together they bring each particle of the packing as
    often as it passes the face, at packing + travel less whole periods, with new ids; nothing overlaps
    that does not in the packing."""
    random = np.random.default_rng(seed)
    period, spacing = 0.3, 0.01
    cells = np.stack(np.meshgrid(np.arange(3), np.arange(30), np.arange(2), indexing="ij"), axis=-1).reshape(-1, 3)
    packing = spacing * (cells + 0.5 + random.uniform(-0.2, 0.2, cells.shape)) + (0.0, -0.15, 0.0)
    window = Window(tmp_path, packing, period)
    bed, strip_start, travel, newest = np.empty((0, 3)), window.face + 0.02, 0.0, 1000
    while travel < 2.5 * period:
        ids, fresh = window.fresh(travel, strip_start, newest)
        assert list(ids) == list(range(newest + 1, newest + 1 + len(ids)))
        bed, newest = np.concatenate((bed, fresh)), newest + len(ids)
        moved = random.uniform(0.0, 0.08)
        bed, travel, strip_start = bed + np.array([0.0, moved, 0.0]), travel + moved, bed[:, 1].min() + moved
    unwrapped = bed[:, 1] - travel  # where each was in an endless packing
    covered = np.arange(-4, 3)[:, None] * period + packing[:, 1]
    expected = np.sort(covered[(covered > unwrapped.min() - ROUNDING) & (covered < unwrapped.max() + ROUNDING)])
    np.testing.assert_allclose(np.sort(unwrapped), expected, rtol=0.0, atol=ROUNDING * 1e2)
    assert unwrapped.max() - unwrapped.min() > 2.4 * period
    images = np.concatenate([packing + np.array([0.0, k * period, 0.0]) for k in (-1, 0, 1)])
    closest = cKDTree(images).query(images, k=2)[0][:, 1].min()
    assert cKDTree(bed).query(bed, k=2)[0][:, 1].min() == pytest.approx(closest, abs=ROUNDING * 1e2)


# ---------------------------------------------------------------- particles are counted


def _log(folder, counts, told):
    rows = "\n".join(f"{step} {count}" for step, count in enumerate(counts))
    (folder / "log.liggghts").write_text(f"Step Atoms\n{rows}\nLoop time of 1\n{told}")


def test_the_count_of_particles_adds_up(tmp_path):
    """What left and entered explains every count; one more that is gone stops the cycle with a sentence."""
    told = "Exchange at step 5: 20 particles left, 25 entered, 105 are here.\n"
    case = SlidingSample()
    _log(tmp_path, [100, 100, 105, 105], told)
    own = exchanged_particles(tmp_path)
    assert own == {"left_particles": 20, "entered_particles": 25, "missing_particles": 0}
    assert case.cycle_fault({}, own) is None
    for counts, said in (([100, 100, 104], told), ([100, 100], told.replace("105", "104"))):
        _log(tmp_path, counts, said)
        assert exchanged_particles(tmp_path)["missing_particles"] == 1
        assert case.cycle_fault({}, exchanged_particles(tmp_path)).startswith("1 particles are missing")


# ---------------------------------------------------------------- the solver


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The folder of a run whose bed is in motion, and of its first wear cycle run by hand with many snapshots."""
    chain = tiny_chain(window_study(), tmp_path_factory.mktemp("window"))
    cycles.run_cycle(chain, None, inputs_digest(chain), Progress("window", 1))
    span, folder = first_span(chain.parameters), chain.folder / "by_hand"
    folder.mkdir()
    triangles = write_cycle(chain, span, folder, read_surface(chain.surface))
    text = (folder / "deck.in").read_text()
    picture = re.search(r"picture_steps +equal (\d+)", text)[0]
    (folder / "deck.in").write_text(text.replace(picture, f"picture_steps equal {PICTURE_STEPS}"))
    cycles.simulate(chain, span, folder, triangles, Progress("window", 1))
    return chain, folder


def snapshots(run):
    """(step, steps since the last exchange, places, velocities and spins, y of the strip's end) of a cycle's snapshots.

    From its first exchange on; places in m, six digits as the solver prints them.
    """
    folder, first = run[1], decks(window_study())[0][0]
    told = exchanges(folder / "log.liggghts")["step"]
    for path in sorted(folder.glob("bed_*.dump"), key=lambda path: int(path.stem[4:])):
        step = int(path.stem[4:])
        if step > told[0]:
            since = step - told[told < step][-1]
            table = np.loadtxt(path, skiprows=9)
            start = first["face_m"] + since * first["travel_per_step_m"]
            yield step, since, table[:, 1:4], table[:, 4:10], start


@pytest.mark.solver
def test_particles_are_conserved_but_for_the_exchanged_ones(run):
    """Between exchanges no count changes; the ledger of all steps is complete, whatever number of runs they took."""
    chain, folder = run
    own = exchanged_particles(folder)
    assert own["missing_particles"] == 0 and own["left_particles"] > 0 and own["entered_particles"] > 0
    counts = thermo_table(folder / "log.liggghts")["Atoms"]
    assert len(np.unique(counts)) == len(exchanges(folder / "log.liggghts")["step"]) + 1
    ledger = summed_by_solver(chain, first_span(chain.parameters), folder, mesh_of(chain))
    assert ledger["sliding_work_J"].sum() > 0.0


@pytest.mark.solver
def test_the_held_strip_is_packing_that_travels_with_the_floor(run):
    """Its particles move at the bed's velocity without spin, each where the packing has it, travelled on."""
    first, second = decks(window_study())[0][:2]
    packing = np.loadtxt(run[0].folder / "cycle_000" / PACKING, skiprows=9)[:, 4:]
    seen = 0
    for step, _, places, motion, start in snapshots(run):
        held = (places[:, 1] > start - PRINTED) & (places[:, 1] < start + first["strip_length_m"] - PRINTED)
        np.testing.assert_array_equal(motion[held], np.tile([0.0, 1.0, 0.0, 0.0, 0.0, 0.0], (held.sum(), 1)))
        travel = (second["steps_before"] + step) * first["travel_per_step_m"]
        expected = packing.copy()
        expected[:, 1] = first["face_m"] + np.mod(expected[:, 1] + travel - first["face_m"], first["period_m"])
        assert cKDTree(expected).query(places[held])[0].max() < PRINTED
        seen += held.sum()
    assert seen > 100


@pytest.mark.solver
def test_undisturbed_fresh_bed_rests_on_the_floor(run):
    """What was let go at the last exchange, far ahead of the sample, hardly moves against the floor: nothing that
    entered overlapped, nothing had to settle."""
    strip = decks(window_study())[0][0]["strip_length_m"]
    fastest = []
    for _, since, places, motion, start in snapshots(run):
        free = (places[:, 1] > start + strip) & (places[:, 1] < start + strip + EXCHANGE)
        if since < UNDISTURBED_STEPS:
            speeds = np.linalg.norm(motion[free, :3] - (0.0, 1.0, 0.0), axis=1)
            fastest.append((np.quantile(speeds, 0.9), speeds.max()))
    assert len(fastest) >= 5
    assert (np.array(fastest) < (UNDISTURBED, LOOSE)).all()
    assert abs(front_lag(run[0].parameters, run[1])) < FRONT_LAG


@pytest.mark.solver
def test_a_run_in_pieces_exchanges_as_often(run, tmp_path):
    """Ended and begun again in the middle and at an exchange, a cycle has each exchange once and loses no particle."""
    chain, whole = run
    span = first_span(chain.parameters)
    folder = chain.folder / "in_pieces"
    folder.mkdir()
    triangles = write_cycle(chain, span, folder, read_surface(chain.surface))
    told = exchanges(whole / "log.liggghts")["step"]
    log = ""
    for begin, end in itertools.pairwise([0, int(told[0]), int(told[1]) - 100, span.steps]):
        given = {"begin": "begin.restart", "begin_step": str(begin)} if begin else {}
        run_deck(
            folder,
            triangles=triangles,
            executable=cycles.cycle_executable(chain),
            variables={**given, "stop": str(end)},
        )
        log += (folder / "log.liggghts").read_text()
        if end < span.steps:
            (folder / "checkpoint.restart").rename(folder / "begin.restart")
    (folder / "log.liggghts").write_text(log)
    np.testing.assert_array_equal(exchanges(folder / "log.liggghts")["step"], told)
    assert exchanged_particles(folder)["missing_particles"] == 0
    assert summed_by_solver(chain, span, folder, mesh_of(chain))["contact_time_s"].sum() > 0.0


@pytest.mark.solver
@pytest.mark.parametrize(
    ("asked", "grid"), [("2 1 1", (2, 1)), pytest.param("* * 1", (1, 2), marks=pytest.mark.verify)]
)
def test_two_ranks_exchange_as_one_does(run, asked, grid):
    """Split across, and as the solver chooses for the deck, which is along the travel: the same exchanges of as many
    particles at the same steps, none lost, and up to a late look the same work but for the rounding of sums.
    """
    chain, whole = run
    span = first_span(chain.parameters)
    folder = chain.folder / f"grid_{grid[0]}_{grid[1]}"
    folder.mkdir()
    triangles = write_cycle(chain, span, folder, read_surface(chain.surface))
    text = (folder / "deck.in").read_text()
    assert len(re.findall(r"^processors +\* \* 1 ", text, re.MULTILINE)) == 1
    (folder / "deck.in").write_text(re.sub(r"^processors .*", f"processors {asked}", text, flags=re.MULTILINE))
    cycles.simulate(replace(chain, ranks=2), span, folder, triangles, Progress("window", 1))
    assert f"{grid[0]} by {grid[1]} by 1 MPI processor grid" in (folder / "log.liggghts").read_text()
    alone, shared = (exchanges(place / "log.liggghts") for place in (whole, folder))
    for column, values in alone.items():
        np.testing.assert_array_equal(shared[column], values, column)
    assert exchanged_particles(folder)["missing_particles"] == 0
    look = sorted(int(path.suffix[1:]) for path in whole.glob("load_ledger.bin.*"))[-2]
    assert look > alone["step"][0]  # after fresh bed has come
    work = [
        read_load_ledger(place / f"load_ledger.bin.{look}").columns["sliding_work_J"].sum() for place in (whole, folder)
    ]
    assert work[1] == pytest.approx(work[0], rel=RANKS_PART)
