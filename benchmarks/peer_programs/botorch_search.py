"""What BoTorch proposes next in searches so far, and which tried design it holds for the best; run by its Python.

python botorch_search.py asked.json answers.json

Gaussian processes of BoTorch's own kernel and priors, with the known noise, one for the response that shall be least
and one for the limited one; logarithmic noisy expected improvement under the limit (qLogNoisyExpectedImprovement),
among the candidates that it is given, one design after the other with those before pending.
"""

import json
import sys
import warnings
from pathlib import Path

import botorch
import torch
from botorch.acquisition.logei import qLogNoisyExpectedImprovement
from botorch.acquisition.objective import GenericMCObjective
from botorch.fit import fit_gpytorch_mll
from botorch.models import ModelListGP, SingleTaskGP
from botorch.models.transforms import Standardize
from botorch.optim import optimize_acqf_discrete
from botorch.sampling import SobolQMCNormalSampler
from gpytorch.mlls import SumMarginalLogLikelihood

DRAWS = 256  # as many as ours
CHANCE = 0.9  # of keeping to the limit, asked of the best; ours too


def model_of(asked):
    """Return the processes of both responses, the first negative: BoTorch maximises."""
    points = torch.tensor(asked["points"], dtype=torch.double)

    def process(values, variances):
        column, noise = (torch.tensor(each, dtype=torch.double)[:, None] for each in (values, variances))
        return SingleTaskGP(points, column, noise, outcome_transform=Standardize(1))

    model = ModelListGP(
        process([-value for value in asked["values"]], asked["variances"]),
        process(asked["limited"], asked["limited_variances"]),
    )
    fit_gpytorch_mll(SumMarginalLogLikelihood(model.likelihood, model))
    return model, points


def answer(asked):
    """Return the positions of the candidates to simulate next, and of the tried design that is held for the best, with
    mean and standard deviation of its response.
    """
    torch.manual_seed(asked["seed"])
    model, points = model_of(asked)
    with torch.no_grad():
        both = model.posterior(points)
    mean, deviation = both.mean[:, 0], both.variance[:, 0].sqrt()
    sure = torch.distributions.Normal(0.0, 1.0).cdf((asked["limit"] - both.mean[:, 1]) / both.variance[:, 1].sqrt())
    kept = torch.where(sure >= CHANCE, mean, -torch.inf)
    best = int(kept.argmax()) if (sure >= CHANCE).any() else int(sure.argmax())
    found = {"best": best, "mean": -float(mean[best]), "deviation": float(deviation[best])}
    found |= {"next": [], "version": botorch.__version__}
    if asked["count"]:
        improvement = qLogNoisyExpectedImprovement(
            model,
            points,
            sampler=SobolQMCNormalSampler(torch.Size([DRAWS]), seed=asked["seed"]),
            objective=GenericMCObjective(lambda drawn, X=None: drawn[..., 0]),  # noqa: N803
            constraints=[lambda drawn: drawn[..., 1] - asked["limit"]],
            prune_baseline=True,
        )
        candidates = torch.tensor(asked["candidates"], dtype=torch.double)
        chosen, _ = optimize_acqf_discrete(improvement, asked["count"], candidates, unique=True)
        found["next"] = [int((candidates == row).all(dim=1).nonzero()[0, 0]) for row in chosen]
    return found


def main():
    """Answer every search in the file."""
    warnings.filterwarnings("ignore")
    torch.set_num_threads(1)
    asked = json.loads(Path(sys.argv[1]).read_text())
    Path(sys.argv[2]).write_text(json.dumps([answer(each) for each in asked]))


if __name__ == "__main__":
    main()
