"""Tables of a circular wear tester that wears exactly as a chosen law, and what its figures must say."""

import numpy as np
import pandas as pd

from bulkwear.postproc.plots.style import remarks_of, save
from tests import PUBLISHED as TABLES

PUBLISHED = pd.read_csv(TABLES / "circular_tester.csv")
PUBLISHED_FITS = pd.read_csv(TABLES / "circular_tester_volume.csv")
PUBLISHED_FINDINGS = pd.read_csv(TABLES / "circular_tester_findings.csv")
REMARKS = ["reduced scale, for tests"]
SMALLEST_PICTURE = 20_000  # bytes
REVOLUTIONS = 17
LAWS = {("plain", 3): (75.0, 0.0), ("convex", 3): (45.0, 0.75), ("convex", 1): (30.0, 0.0)}  # mm3 per revolution, 2
ELEMENTS = {"plain": 30_000, "convex": 40_000}


def volumes(noise=0.0):
    """Volumes of three runs after each revolution, by LAWS; noise: mm3."""
    generator = np.random.default_rng(1)
    x = np.arange(REVOLUTIONS + 1.0)
    parts = [
        pd.DataFrame(
            {
                "run": f"{surface}_{scale}",
                "surface": surface,
                "particle_scale": float(scale),
                "revolution": x,
                "volume_m3": 1e-9 * (a * x + b * x**2 + noise * generator.normal(size=len(x)) * (x > 0)),
                "elements": ELEMENTS[surface],
            }
        )
        for (surface, scale), (a, b) in LAWS.items()
    ]
    return pd.concat(parts, ignore_index=True)


def series(revolutions=10, instants=40, settled_after=3.0, variation=0.05):
    """Flow of two runs: twice too fast at first, settling; then of known coefficient of variation and mean."""
    x = (np.arange(revolutions * instants) + 0.5) / instants
    wave = 1.0 + variation * np.sqrt(2.0) * np.sin(2.0 * np.pi * 8.0 * x)
    start = 1.0 + np.exp(-6.0 * x / settled_after)
    parts = []
    for surface, velocity in (("plain", 0.52), ("convex", 0.24)):
        table = {"velocity_m_per_s": velocity, "bed_height_m": 0.12, "wear_rate_m3_per_s": 2e-8}
        table |= {"bottom_averaged_angular_velocity_rad_per_s": 1.5, "bottom_mean_angular_speed_rad_per_s": 2.0}
        table |= {"bottom_velocity_m_per_s": velocity, "normal_force_N": 16.0}
        columns = {name: value * wave * start for name, value in table.items()}
        parts.append(pd.DataFrame({"run": surface, "surface": surface, "revolution": x, **columns}))
    return pd.concat(parts, ignore_index=True)


def missing_words(figure, path, words=()):
    """Return which words a figure does not say anywhere; it is drawn and has its remarks."""
    save(figure, path)
    assert path.stat().st_size > SMALLEST_PICTURE
    assert remarks_of(figure) == REMARKS[0]
    said = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    said += [axes.get_title(loc="left") for axes in figure.axes]
    said += [
        cell.get_text().get_text()
        for axes in figure.axes
        for table in axes.tables
        for cell in table.get_celld().values()
    ]
    return [word for word in words if not any(word in each for each in said)]
