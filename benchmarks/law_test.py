"""A laboratory test that tells wear laws apart: a definitive screening design of angle, speed and friction.

    python -m benchmarks.law_test --output docs        # in the root of the repository; a second

Plates are blasted at each run of the design and weighed. Writes law_test.csv, the design with the wear of a run by each
law over the law's mean, and what is between the marks of wear.md. Closed forms of single spheres without spin.
"""

from __future__ import annotations

import argparse
import itertools
import math

import numpy as np
import pandas as pd

from benchmarks.command_line import command, output_folder
from benchmarks.law_examples import THRESHOLD
from benchmarks.stream_laws import PAGE, with_table
from bulkwear.postproc.reference.impact_angle import finnie, impact_energy, oka, sliding_work
from bulkwear.postproc.statistics.factors import Factor
from bulkwear.postproc.statistics.regression import fit
from bulkwear.postproc.statistics.screening_design import FAKE, coded_design
from bulkwear.workflows.config.design import load_study

BEGIN = "<!-- by benchmarks.law_test -->"
FACTORS = (  # what a laboratory sets; friction of ore on the plate as by wetting it
    Factor("angle_deg", 15.0, 75.0),
    Factor("speed_m_per_s", 4.0, 16.0, "log"),
    Factor("friction", 0.2, 0.6, "log"),
)
SURE = 1.959964  # standard deviations: the right one of two laws is chosen in 97.5 % of tests
DIGITS = 4
HEADS = ("power of speed", "power of friction", "nearest law", "error up to")


def design() -> pd.DataFrame:
    """Return the runs of the design, a column per factor in its unit, with fake factors for an error of its own."""
    coded = coded_design(len(FACTORS), FAKE)
    return pd.DataFrame({factor.name: factor.real(coded[:, k]) for k, factor in enumerate(FACTORS)})


def volumes(runs: pd.DataFrame) -> pd.DataFrame:
    """Return the volume of each run per kilogram of ore and coefficient (m2/s2) by each law, a column per law.

    Restitution and the constants of Oka are those of the study which_law.
    """
    study = load_study("which_law")
    restitution = study.materials["walls"][study.settings["parts"]["plate"]["material"]]["contact"]["restitution"]
    given = study.settings["wear"]["parameters"]
    angle, speed = np.radians(runs["angle_deg"].to_numpy()), runs["speed_m_per_s"].to_numpy()
    sliding = speed**2 * sliding_work(angle, runs["friction"].to_numpy(), restitution)
    of_angle = oka(angle, *(given[name] for name in ("angle_exponent", "hardness_exponent", "hardness_pa")))
    reference = given["reference_velocity_m_per_s"]
    return pd.DataFrame(
        {
            "Archard": sliding,
            "Shear work": runs["friction"] * sliding,
            "Finnie": speed**2 * finnie(angle),
            "Oka": reference**2 * (speed / reference) ** given["velocity_exponent"] * of_angle,
            "Impact energy": speed**2 * impact_energy(angle),
            f"Impact energy above {THRESHOLD:g} m/s": speed**2 * impact_energy(angle, THRESHOLD / speed),
        }
    )


def effects(runs: pd.DataFrame, found: pd.DataFrame) -> pd.DataFrame:
    """Return the main effects by each law, a line each: wear at the high over that at the low angle (-), and exponents
    (-) of speed and friction. In this design no square and no interaction biases them.
    """
    coded = np.column_stack([factor.coded(runs[factor.name]) for factor in FACTORS])
    terms = [(k,) for k in range(len(FACTORS))]
    lines = {law: fit(terms, coded, np.log(volume)).coefficients[1:] for law, volume in found.items()}
    table = pd.DataFrame(lines, index=[factor.name for factor in FACTORS]).T
    steps = {factor.name: 0.5 * math.log(factor.high / factor.low) for factor in FACTORS if factor.spacing == "log"}
    powers = {name: table[name] / by for name, by in steps.items()}
    return table.assign(angle_deg=np.exp(2.0 * table["angle_deg"]), **powers)


def largest_error(one: np.ndarray, other: np.ndarray) -> float:
    """Return the error of a weighing (-, of its logarithm) up to which the design tells two laws apart.

    one, other: (n,) volumes of the runs; their coefficients are not known. The law whose logarithms lie nearer to the
    weighings is the right one with the probability Phi(d / 2 s), d the distance between both, s the error.
    """
    apart = np.log(one) - np.log(other)
    return float(np.linalg.norm(apart - apart.mean()) / (2.0 * SURE))


def nearest(found: pd.DataFrame) -> pd.DataFrame:
    """Return of each law the one that is hardest to tell from it, and the `largest_error` of both."""
    pairs = itertools.permutations(found, 2)
    errors = pd.DataFrame([(*pair, largest_error(*(found[law].to_numpy() for law in pair))) for pair in pairs])
    errors.columns = ["law", "nearest", "error"]
    return errors.loc[errors.groupby("law", sort=False)["error"].idxmin()].set_index("law")


def table(told: pd.DataFrame, near: pd.DataFrame) -> str:
    """Return the table in Markdown; told: as from `effects`, near: as from `nearest`."""
    angle = FACTORS[0]
    heads = ["law", f"{angle.high:g} over {angle.low:g}°", *HEADS]
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for law, row in told.iterrows():
        numbers = f"{row['angle_deg']:.2g} | {row['speed_m_per_s']:.2f} | {row['friction'] + 0.0:.2f}"
        lines.append(f"| {law} | {numbers} | {near.loc[law, 'nearest']} | {100.0 * near.loc[law, 'error']:.2g} % |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write design and table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--output", type=output_folder, default="benchmark")
    folder = parser.parse_args().output
    runs = design()
    found = volumes(runs)
    over_mean = found / np.exp(np.log(found).mean())
    pd.concat([runs, over_mean], axis=1).round(DIGITS).to_csv(folder / "law_test.csv", index=False)
    page = folder / PAGE.name
    if page.is_file():
        new = table(effects(runs, found), nearest(found))
        page.write_text(with_table(page.read_text(encoding="utf-8"), new, BEGIN), encoding="utf-8")


if __name__ == "__main__":
    command(main)
