"""A worked example of every wear law: a case by hand, the lines of a study, and where the law ends.

    python -m benchmarks.law_examples --output docs        # in the root of the repository; a second

Writes wear_laws.md. Each volume is worked out here by the law's published formula, without the code of the laws, which
tests/benchmarks/test_law_examples.py sets beside it.
"""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import yaml

from benchmarks.command_line import command, output_folder
from bulkwear.postproc.reference import impact_angle
from bulkwear.postproc.wear.coefficient import coefficient_per_pa, dimensionless_coefficient
from bulkwear.postproc.wear.kernels import kernel_column, kernel_value
from bulkwear.workflows.config.design import load_study

MM3 = 1e9  # per m3
LINE = 120  # characters
TIMES, ALPHA = "\u00d7", "\u03b1"
LOAD_N, PATH_M, FRICTION = 5.0, 180.0, 0.5  # of a pin that is dragged over a plate
STEEL = "mild_steel"  # of the file of materials, with its hardness
TREMBLE_M, TREMBLE_HZ, HOUR_S = 1e-6, 100.0, 3600.0  # to each side, of a contact that sticks
ROLLING_M, ROLLING_RATIO = 500.0, 0.05  # the ratio is assumed
SPEED, MASS_KG, OBLIQUE_DEG, SHALLOW_DEG = 8.0, 1000.0, 30.0, 15.0  # m/s; of ore that hits a plate
THRESHOLD, PER_VOLUME = 0.5, 2.0e10  # m/s and J per m3, assumed
E90_MM3_PER_KG, WRONG = 20.0, 0.1  # assumed; error of an exponent
CONTACT_S = 1.0  # of a shallow contact
ON_N, ON_M = 8500.0, 20.0  # of ore that slides on: the weight of MASS_KG on a slope of OBLIQUE_DEG
HARD_HITS, BY_SPEED = "impact_above_threshold", {"threshold_velocity_m_per_s": THRESHOLD}
IMPACT = kernel_column(HARD_HITS)
IMPACT = kernel_column("impact_above_threshold")


@dataclass(frozen=True)
class Example:
    """An example of a law.

    case, by_hand, limit: sentences; volume: m3, by hand; settings: of a study
    columns: ledger sums by name, J; parameters: of the law besides the coefficient, SI
    """

    title: str
    law: str
    case: str
    by_hand: str
    limit: str
    volume: float
    coefficient: float
    columns: dict[str, float]
    settings: dict[str, Any]
    parameters: dict[str, float] = field(default_factory=dict)


def examples() -> list[Example]:
    """Return the examples in the order of the page."""
    return [archard(), hardness(), shear_work(), rolling(), impact(), threshold(), finnie(), oka()]


def default_coefficient() -> float:
    """Return the coefficient (1/Pa) of a study that says nothing else."""
    return load_study("demo").settings["wear"]["wear_coefficient_per_pa"]


def archard() -> Example:
    """A dragged pin."""
    alpha, work = default_coefficient(), LOAD_N * PATH_M
    return Example(
        "Archard",
        "archard",
        f"A pin slides {PATH_M:g} m under {LOAD_N:g} N.",
        f"V = alpha F L = {short(alpha)} 1/Pa x {LOAD_N:g} N x {PATH_M:g} m",
        "Friction has no part in it: of two plates under one load and path the rougher wears no more.",
        alpha * work,
        alpha,
        {"sliding_work_J": work},
        {"wear": {"law": "archard", "wear_coefficient_per_pa": alpha}},
    )


def hardness() -> Example:
    """The same pin on a plate of known hardness."""
    hardness, work = load_study("pin_on_disc").materials["walls"][STEEL]["hardness_pa"], LOAD_N * PATH_M
    k = float(short(dimensionless_coefficient(default_coefficient(), hardness)))
    alpha = coefficient_per_pa(k, hardness)
    return Example(
        "Archard, scaled by hardness",
        "archard",
        f"The same pin on a plate of k = {short(k)} and H = {short(hardness, 4)} Pa, as the [file of"
        " materials](wear.md#which-coefficient) has them; a plate twice as hard wears half as much.",
        f"V = k F L / H = {short(k)} x {LOAD_N:g} N x {PATH_M:g} m / {short(hardness, 4)} Pa",
        "Steel of one kind, softer than the abrasive.",
        k / hardness * work,
        alpha,
        {"sliding_work_J": work},
        {"walls": {"steel": {"hardness_pa": hardness, "wear": {"iron_ore_10mm": {"wear_coefficient_k": k}}}}},
    )


def shear_work() -> Example:
    """The same pin, then one that sticks and trembles."""
    alpha, work = default_coefficient(), FRICTION * LOAD_N * PATH_M
    trembled = 4.0 * TREMBLE_M * TREMBLE_HZ * HOUR_S
    stuck = MM3 * alpha * LOAD_N * trembled
    coefficient = alpha / FRICTION
    return Example(
        "Shear work",
        "tangential_work",
        f"The same pin with a friction of {FRICTION:g}, which slides all the way: as by Archard.",
        f"V = (alpha / μ) μ F L = {short(coefficient)} 1/Pa x {FRICTION:g} x {LOAD_N:g} N x {PATH_M:g} m",
        f"A pin that sticks and trembles by {1e6 * TREMBLE_M:g} µm to both sides, {TREMBLE_HZ:g} times a second, wears"
        f" nothing by this law and {stuck:.3g} mm³ an hour by Archard's, which takes it for {trembled:.3g} m of path.",
        coefficient * work,
        coefficient,
        {"tangential_work_J": work},
        {"wear": {"law": "tangential_work", "wear_coefficient_per_pa": coefficient}},
    )


def rolling() -> Example:
    """Spheres that slide and roll."""
    alpha = default_coefficient()
    work = {"sliding_work_J": LOAD_N * PATH_M, "rolling_work_J": LOAD_N * ROLLING_M, IMPACT: 0.0}
    return Example(
        "Combined: sliding and rolling",
        "combined",
        f"Grains under {LOAD_N:g} N slide {PATH_M:g} m and roll {ROLLING_M:g} m without slip; rolling wears"
        f" {ROLLING_RATIO:g} times as much per path.",
        f"V = alpha F (L + r L_rolling) = {short(alpha)} 1/Pa x {LOAD_N:g} N x ({PATH_M:g} + {ROLLING_RATIO:g} x"
        f" {ROLLING_M:g}) m",
        "The ratio is one of grains and wall, to be measured: round grains that roll scratch less than shards.",
        alpha * LOAD_N * (PATH_M + ROLLING_RATIO * ROLLING_M),
        alpha,
        work,
        {"wear": {"law": "combined", "parameters": {"rolling_ratio": ROLLING_RATIO}}},
        {"rolling_ratio": ROLLING_RATIO, "impact_ratio": 0.0, "threshold_velocity_m_per_s": 0.0},
    )


def impact() -> Example:
    """Ore that falls on a plate and slides on, with the coefficient of sliding for both."""
    alpha, angle = default_coefficient(), np.radians(OBLIQUE_DEG)
    ratio = float(f"{1.0 / (PER_VOLUME * alpha):.3g}")
    energy, sliding = MASS_KG * SPEED**2 * float(impact_angle.impact_energy(angle, THRESHOLD / SPEED)), ON_N * ON_M
    volume = alpha * (sliding + ratio * energy)
    given = {"impact_ratio": ratio, "threshold_velocity_m_per_s": THRESHOLD}
    return Example(
        "Combined: sliding and impact",
        "combined",
        f"{MASS_KG:g} kg of ore hit a plate at {SPEED:g} m/s and {OBLIQUE_DEG:g}° and slide on for {ON_M:g} m under"
        f" {ON_N:g} N; above K = {THRESHOLD:g} m/s an impact spends {short(PER_VOLUME)} J per m³ worn (assumed), q = 1"
        f" / ({short(PER_VOLUME)} alpha).",
        f"V = alpha (F L + q m (v sin a - K)² / 2) = {short(alpha)} 1/Pa x ({ON_N:g} N x {ON_M:g} m + {ratio:g} x"
        f" {MASS_KG:g} kg x (({SPEED:g} x {np.sin(angle):.3g} - {THRESHOLD:g}) m/s)² / 2)",
        f"Here sliding has {100.0 * alpha * sliding / volume:.0f} % of it, by a ratio that only a test of one's own"
        " tells.",
        volume,
        alpha,
        {
            "sliding_work_J": sliding,
            "rolling_work_J": 0.0,
            IMPACT: hit(OBLIQUE_DEG, HARD_HITS, BY_SPEED),
        },
        {"wear": {"law": "combined", "parameters": given}},
        {"rolling_ratio": 0.0, **given},
    )


def threshold() -> Example:
    """The same ore at an angle, above a threshold."""
    angle, coefficient = np.radians(OBLIQUE_DEG), 1.0 / PER_VOLUME
    return Example(
        "Impact energy above a threshold",
        "impact_threshold",
        f"The same ore, of which impacts below K = {THRESHOLD:g} m/s wear nothing.",
        f"V = k m (v sin a - K)² / 2 = {short(coefficient)} 1/Pa x {MASS_KG:g} kg x (({SPEED:g} x {np.sin(angle):.3g} -"
        f" {THRESHOLD:g}) m/s)² / 2",
        "A bed that lies on the plate wears nothing by this law, however far it slides.",
        coefficient * MASS_KG * SPEED**2 * float(impact_angle.impact_energy(angle, THRESHOLD / SPEED)),
        coefficient,
        {IMPACT: hit(OBLIQUE_DEG, HARD_HITS, BY_SPEED)},
        {"wear": {"law": "impact_threshold", "wear_coefficient_per_pa": coefficient, "parameters": BY_SPEED}},
        BY_SPEED,
    )


def finnie() -> Example:
    """A contact at a shallow angle."""
    alpha, angle = default_coefficient(), np.radians(SHALLOW_DEG)
    share = float(impact_angle.finnie(angle))
    return Example(
        "Finnie",
        "finnie",
        f"Grains at {SPEED:g} m/s and {SHALLOW_DEG:g}° to the plate press on it with {LOAD_N:g} N for {CONTACT_S:g} s.",
        f"V = 2 k (sin 2a - 3 sin² a) v F t = 2 x {short(alpha)} 1/Pa x {share:.3g} x {SPEED:g} m/s x {LOAD_N:g} N x"
        f" {CONTACT_S:g} s",
        "At 0 and at 90° it gives nothing, though grains that slide wear a plate, and so do square impacts.",
        alpha * 2.0 * share * SPEED * LOAD_N * CONTACT_S,
        alpha,
        {kernel_column("finnie_work"): CONTACT_S * hit(SHALLOW_DEG, "finnie_work", {})},
        {"wear": {"law": "finnie", "wear_coefficient_per_pa": alpha}},
    )


def oka() -> Example:
    """The same ore by Oka's law, with the constants of the study which_law."""
    given = dict(load_study("which_law").settings["wear"]["parameters"])
    reference, angle = given["reference_velocity_m_per_s"], np.radians(OBLIQUE_DEG)
    coefficient = float(f"{E90_MM3_PER_KG / MM3 / (0.5 * reference**2):.3g}")
    e90 = coefficient * 0.5 * reference**2
    of_angle = float(
        impact_angle.oka(angle, *(given[name] for name in ("angle_exponent", "hardness_exponent", "hardness_pa")))
    )
    slower = (SPEED / reference) ** given["velocity_exponent"]
    return Example(
        "Oka",
        "oka",
        f"The same ore at {OBLIQUE_DEG:g}°; at {reference:g} m/s and 90° a kilogram wears {E90_MM3_PER_KG:g} mm³"
        " (assumed), which over V² / 2 is the coefficient.",
        f"V = m E90 (v / {reference:g})^{given['velocity_exponent']:g} g(a) = {MASS_KG:g} kg x {MM3 * e90:.3g}"
        f" mm³/kg x {slower:.3g} x {of_angle:.3g}",
        f"{SPEED:g} m/s are {reference / SPEED:.2g} times slower than the test: an exponent that is wrong by"
        f" {WRONG:g} changes this volume by {100.0 * ((reference / SPEED) ** WRONG - 1.0):.2g} %.",
        MASS_KG * e90 * slower * of_angle,
        coefficient,
        {kernel_column("oka_energy"): hit(OBLIQUE_DEG, "oka_energy", given)},
        {"wear": {"law": "oka", "wear_coefficient_per_pa": coefficient, "parameters": given}},
        given,
    )


def hit(degrees: float, kernel: str, given: dict[str, float]) -> float:
    """Return what a kernel takes of MASS_KG that come at SPEED and an angle, or of LOAD_N there for a second."""
    angle = np.radians(degrees)
    velocity = SPEED * np.array([[np.cos(angle), 0.0, -np.sin(angle)]])
    up, approach = np.array([[0.0, 0.0, 1.0]]), np.array([SPEED * np.sin(angle)])
    motion = SimpleNamespace(relative_velocity=velocity, normal=up, mass=np.array([MASS_KG]), approach_speed=approach)
    contacts = SimpleNamespace(contact_point=np.zeros((1, 3)), centre=up, force=LOAD_N * up)
    value: Callable[..., np.ndarray] = kernel_value(kernel, given)
    return float(value(contacts, motion, up)[0])


def short(value: float, digits: int = 3) -> str:
    """Return significant digits of a number, without the zeros and the plus of an exponent."""
    return f"{float(f'{value:.{digits}g}'):g}".replace("e+", "e").replace("e0", "e").replace("e-0", "e-")


class Numbers(yaml.SafeDumper):
    """YAML with numbers as people write them."""


Numbers.add_representer(
    float, lambda dumper, value: dumper.represent_scalar("tag:yaml.org,2002:float", plain_number(value))
)


def plain_number(value: float) -> str:
    """Return a number that YAML reads as one: with a point, and with a sign before its exponent."""
    mantissa, mark, exponent = f"{value:.6g}".partition("e")
    return f"{mantissa if '.' in mantissa else f'{mantissa}.0'}{mark}{exponent}"


def page() -> str:
    """Return docs/wear_laws.md."""
    begin = folded(
        "Written by `python -m benchmarks.law_examples --output docs`, by published formulas; a"
        " [test](../tests/benchmarks/test_law_examples.py) sets the code of each law beside it. Which law to take, and"
        " where each does not hold: [wear.md](wear.md#which-law); formulas, units and ranges:"
        " [keys](../config/README.md#wear-laws)."
    )
    end = folded(
        "It is a file of a [project](project.md#a-wear-law): `hardened` there, with `wear: {law: hardened, parameters:"
        " {hardening: 3}}`, makes a third of Archard's volume."
    )
    return "\n".join(
        [f"# Wear laws by example\n\n{begin}\n", *map(section, examples()), "## A law of one's own\n", f"{end}\n"]
    )


def section(example: Example) -> str:
    """Return the section of an example."""
    lines = yaml.dump(example.settings, Dumper=Numbers, sort_keys=False)
    told = [example.case, f"**{example.by_hand} = {short(MM3 * example.volume)} mm³.** Limit: {example.limit}"]
    words = "\n\n".join(folded(each.replace(" x ", f" {TIMES} ").replace("alpha", ALPHA)) for each in told)
    return f"## {example.title}\n\n{words}\n\n```yaml\n{lines}```\n"


def folded(text: str) -> str:
    """Return a paragraph in lines of the page's length."""
    return textwrap.fill(text, LINE, break_long_words=False, break_on_hyphens=False)


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--output", type=output_folder, default="benchmark")
    folder = parser.parse_args().output
    (folder / "wear_laws.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    command(main)
