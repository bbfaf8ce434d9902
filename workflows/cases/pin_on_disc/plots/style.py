"""What the figures of the pin-on-disc study share: colours and names of schemes, published values, tables."""

from __future__ import annotations

SCHEME_COLOURS = {"conserving": "#0072B2", "per_triangle": "#D55E00"}
SCHEME_NAMES = {"conserving": "conserving", "per_triangle": "per triangle (Yan 2022, Eq 5.7)"}
SCHEME_MARKERS = {"conserving": "o", "per_triangle": "s"}
LAW_COLOUR = "#009E73"
LABORATORY_COLOUR = "#CC79A7"


def coefficient_name(coefficient: float) -> str:
    """A wear coefficient (1/Pa) as people read it."""
    exponent = f"{coefficient:.1e}".partition("e")[2]
    digits = coefficient / 10.0 ** int(exponent)
    return rf"$\alpha$ = {digits:.3g}·10$^{{{int(exponent)}}}$ Pa$^{{-1}}$"
