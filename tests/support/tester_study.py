"""Tables of a circular wear tester that wears exactly as a chosen law, for analysis and figures."""

import numpy as np
import pandas as pd

from tests import REPOSITORY

PUBLISHED = pd.read_csv(REPOSITORY / "config/published/circular_tester.csv")
PUBLISHED_FITS = pd.read_csv(REPOSITORY / "config/published/circular_tester_volume.csv")
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
        table |= {"bottom_angular_speed_rad_per_s": 1.5, "bottom_velocity_m_per_s": velocity, "normal_force_N": 16.0}
        columns = {name: value * wave * start for name, value in table.items()}
        parts.append(pd.DataFrame({"run": surface, "surface": surface, "revolution": x, **columns}))
    return pd.concat(parts, ignore_index=True)
