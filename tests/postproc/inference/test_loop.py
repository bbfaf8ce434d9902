"""A calibration finds what the responses were made with, in few simulations, and says how sure it is."""

import math

import numpy as np
import pytest

from bulkwear.postproc.inference.acquisition import (
    expected_information,
    log_likelihood_variance,
    next_points,
    surrogate_share,
)
from bulkwear.postproc.inference.loop import calibrate, initial_points, posterior
from bulkwear.postproc.inference.posterior import (
    denser_shares,
    densest,
    interval,
    log_normal,
    posterior_weights,
    recommended,
)
from bulkwear.postproc.inference.problem import Experiment, Measured, Parameter, Problem
from bulkwear.postproc.inference.surrogate import fit_surrogate

MOST_SIMULATIONS = 20  # what a closed loop may cost
STATED_SHARE = 0.95  # of the posterior, in the interval that must hold the hidden parameters
HIDDEN = {"sliding": 0.35, "rolling": 0.25}
DEVIATIONS = {"angle": 0.4, "repose": 0.9, "time": 0.1}  # degrees, degrees, s: as measured in Yan 2022, Table 3.1
SEED_SCATTER = {"angle": 0.7, "repose": 0.5, "time": 0.05}  # of a simulation, in the same units
FIT_ERROR = 0.3  # of each simulated response, in its deviation


def response(values):
    """A formula for a bulk test: angles grow with both frictions and level off, time grows with sliding friction."""
    sliding, rolling = values["sliding"], values["rolling"]
    return {
        "angle": 20.0 + 45.0 * (1.0 - math.exp(-3.0 * sliding)) * (1.0 - math.exp(-3.5 * rolling)) + 6.0 * sliding,
        "repose": 18.0 + 40.0 * (1.0 - math.exp(-2.0 * sliding)) * (1.0 - math.exp(-5.0 * rolling)),
        "time": 5.0 + 3.0 * sliding + 0.5 * rolling,
    }


RESPONSES = {"box": ("angle",), "draw_down": ("repose", "time")}
BOTH = tuple(Experiment(name, RESPONSES[name], *runs) for name, runs in (("box", (8, 12)), ("draw_down", (4, 8))))


def simulate(requests):
    """Answers of the formula with the scatter of each request's seed."""
    answers = []
    for request in requests:
        scatter = np.random.default_rng(request.seed)
        exact = response(request.values)
        answers.append({})
        for name in RESPONSES[request.test]:
            answers[-1][name] = exact[name] + SEED_SCATTER[name] * scatter.standard_normal()
            answers[-1][f"{name}_uncertainty"] = FIT_ERROR * SEED_SCATTER[name]
    return answers


def problem(seed, tests=BOTH, **changed):
    """A calibration on the responses of the hidden parameters."""
    measured = {name: Measured(value, DEVIATIONS[name]) for name, value in response(HIDDEN).items()}
    parameters = (Parameter("sliding", 0.1, 0.7), Parameter("rolling", 0.1, 0.7))
    return Problem(parameters, tests, measured, seed=seed, **changed)


def nearest(found, values):
    """Which point of a posterior is nearest to parameter values."""
    return int(np.argmin(np.linalg.norm(found - np.array(list(values.values())), axis=1)))


@pytest.mark.parametrize("seed", range(1, 4))
def test_hidden_parameters_are_found(seed):
    """Responses of hidden parameters lead back to them: they are in the stated region and in both stated intervals."""
    asked = problem(seed)
    result = calibrate(asked, simulate)
    weights, values = result.posterior.weights, asked.from_unit(result.posterior.points)
    assert len(result.simulations) <= MOST_SIMULATIONS
    assert densest(weights, STATED_SHARE)[nearest(values, HIDDEN)]
    for column, hidden in enumerate(HIDDEN.values()):
        low, high = interval(values[:, column], weights)
        assert low < hidden < high


def test_one_response_leaves_a_family():
    """One angle cannot tell two frictions apart: the hidden pair is in a family that spans most of the range."""
    asked = problem(1, tests=(Experiment("box", ("angle",), 8, 20),))
    result = calibrate(asked, simulate)
    weights, values = result.posterior.weights, asked.from_unit(result.posterior.points)
    family = densest(weights, STATED_SHARE)
    assert family[nearest(values, HIDDEN)]
    assert np.ptp(values[family], axis=0).min() > 0.4  # of the range of 0.6, in either friction
    assert family.mean() < 0.4  # and yet most pairs are ruled out


def test_a_calibration_repeats_itself():
    """The same seeds ask the same questions in the same order: an interrupted calibration is replayed exactly."""
    tests = (Experiment("box", ("angle",), 6, 10),)
    first, second = (calibrate(problem(5, tests=tests), simulate).simulations for _ in range(2))
    assert first.equals(second)


def test_as_many_initial_points_as_asked_for():
    """Also more than one power of two; fewer are the beginning of more."""
    many = initial_points(problem(0), Experiment("box", RESPONSES["box"], 100, 100), None)
    few = initial_points(problem(0), Experiment("box", RESPONSES["box"], 5, 100), None)
    assert len(many) == 100 and len(np.unique(many, axis=0)) == 100
    np.testing.assert_array_equal(few, many[:5])


def test_it_stops_when_the_measurement_is_what_blurs():
    """The stopping rule: with a coarse measurement the initial simulations are enough, with a fine one all are used."""
    tests = (Experiment("box", ("angle",), 8, 12),)
    coarse = problem(2, tests=tests)
    coarse = Problem(coarse.parameters, tests, {"angle": Measured(coarse.measured["angle"].value, 5.0, 0.0)}, seed=2)
    assert len(calibrate(coarse, simulate).simulations) == 8
    fine = Problem(coarse.parameters, tests, {"angle": Measured(coarse.measured["angle"].value, 0.01, 0.0)}, seed=2)
    assert len(calibrate(fine, simulate).simulations) == 12


def test_any_number_of_parameters():
    """Three parameters with two responses go the same way as two with one."""
    parameters = (*problem(1).parameters, Parameter("without_effect", 0.0, 1.0))
    asked = Problem(parameters, (Experiment("box", ("angle",), 8, 10),), problem(1).measured, seed=1)
    result = calibrate(asked, simulate)
    assert result.posterior.points.shape[1] == 3
    values = asked.from_unit(result.posterior.points)[:, 2]
    low, high = interval(values, result.posterior.weights)
    assert high - low > 0.8  # of a range of 1: what has no effect stays open


# ---------------------------------------------------------------- the parts


def test_surrogate_of_a_plane_is_the_plane():
    """Responses without scatter come back between the simulated points within 1 % of their range."""
    points = problem(1).spread_points(5)
    values = 3.0 + points @ [2.0, -1.0]
    surrogate = fit_surrogate(points, values, 1e-6 * np.eye(len(points)), seed=1)
    others = problem(2).spread_points(6)
    mean, variance = surrogate.predict(others)
    np.testing.assert_allclose(mean, 3.0 + others @ [2.0, -1.0], atol=0.03)
    assert (np.sqrt(variance) < 0.03).all()


def test_scatter_between_seeds_is_found():
    """The surrogate tells scatter between seeds from its own doubt: the first stays, the second falls with points."""
    random = np.random.default_rng(3)
    points = problem(1).spread_points(6)
    values = points @ [2.0, -1.0] + 0.2 * random.standard_normal(len(points))
    surrogate = fit_surrogate(points, values, 1e-12 * np.eye(len(points)), seed=1)
    assert surrogate.seed_deviation == pytest.approx(0.2, rel=0.3)  # 64 points tell a deviation to a tenth or so
    assert np.sqrt(surrogate.predict(points)[1]).max() < 0.15


def test_unit_of_a_response_does_not_matter():
    """Angles in degrees or in radians lead to the same posterior."""
    points = problem(1).spread_points(4)
    angles = 20.0 + 20.0 * points.sum(axis=1)
    weights = []
    for unit in (1.0, math.pi / 180.0):
        surrogate = fit_surrogate(points, unit * angles, (0.3 * unit) ** 2 * np.eye(len(points)), seed=1)
        predicted = {"angle": surrogate.predict(problem(2).spread_points(8))}
        weights.append(posterior_weights(predicted, {"angle": Measured(36.0 * unit, 0.4 * unit)}))
    np.testing.assert_allclose(weights[0], weights[1], atol=1e-6)  # the fit of the kernel stops at such a difference


def test_variance_of_the_likelihood_is_that_of_draws():
    """The closed form of the acquisition rule is the variance of the likelihood over drawn responses."""
    mean, variance, measured = np.array([34.0, 36.2]), np.array([1.5, 0.3]), Measured(36.0, 0.3, 0.2)
    draws = mean + np.sqrt(variance) * np.random.default_rng(1).standard_normal((400_000, 2))
    expected = np.exp(log_normal(measured.value, draws, 0.3**2 + 0.2**2)).var(axis=0)
    found = np.exp(log_likelihood_variance({"angle": (mean, variance)}, {"angle": measured}))
    np.testing.assert_allclose(found, expected, rtol=0.02)  # of so many draws


def test_next_points_are_where_doubt_is_and_differ():
    """Of several points at once the later ones know of the earlier: they are not the same place twice."""
    asked = problem(1, tests=(Experiment("box", ("angle",), 6, 10),))
    table = calibrate(asked, simulate).simulations
    state = posterior(asked, table)
    chosen = next_points(state.points, state.surrogates, asked.measured, 3)
    distances = np.linalg.norm(chosen[:, None] - chosen[None], axis=2)[np.triu_indices(3, 1)]
    assert distances.min() > 0.02  # of the range: beyond the spacing of the candidates


def test_share_of_the_surrogate():
    """A surrogate with the variance of measurement and model together has a share of one half, one without has none."""
    weights, measured = np.full(4, 0.25), {"angle": Measured(36.0, 0.3, 0.4)}
    half = {"angle": (np.full(4, 36.0), np.full(4, 0.25))}
    assert surrogate_share(weights, half, measured, ["angle"]) == pytest.approx(0.5)
    assert surrogate_share(weights, {"angle": (np.full(4, 36.0), np.zeros(4))}, measured, ["angle"]) == 0.0
    assert surrogate_share(weights, half, measured, ["another"]) == 0.0


def test_information_of_a_response_that_halves_the_family():
    """A response that is the same all over the family tells nothing; one that splits it in two tells one bit."""
    weights, none = np.full(200, 1.0 / 200.0), np.zeros(200)
    predicted = {"same": (np.full(200, 36.0), none), "split": (np.repeat([30.0, 40.0], 100), none)}
    bits = expected_information(weights, predicted, {name: Measured(36.0, 0.4, 0.0) for name in predicted}, seed=1)
    assert bits["same"] == pytest.approx(0.0, abs=1e-9)
    assert bits["split"] == pytest.approx(1.0, abs=0.05)  # of 1500 draws


def test_recommendation_lies_in_the_family():
    """Of a ring-shaped family the mean lies outside; what is recommended lies on the ring."""
    points = problem(1).spread_points(10)
    radius = np.linalg.norm(points - 0.5, axis=1)
    weights = np.exp(-0.5 * ((radius - 0.3) / 0.02) ** 2)
    weights /= weights.sum()
    assert radius[recommended(points, weights)] == pytest.approx(0.3, abs=0.03)


def test_share_that_is_denser_than_a_pair():
    """Of a normal distribution within one and two deviations; the pairs need not be points of the posterior."""
    mean = np.linspace(30.0, 40.0, 5001)
    predicted, measured = {"angle": (mean, np.zeros(5001))}, {"angle": Measured(35.0, 0.3, 0.4)}
    weights = posterior_weights(predicted, measured)
    pairs = {"angle": (np.array([35.5, 34.0]), np.zeros(2))}  # deviation and discrepancy: 0.5 together
    shares = denser_shares(weights, predicted, measured, pairs)
    assert shares == pytest.approx([0.683, 0.954], abs=0.01)  # on this grid
