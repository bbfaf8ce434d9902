"""Tables of a circular wear tester that wears exactly as a chosen law, or scatters about it in a chosen way, and what
its figures must say.
"""

import numpy as np
import pandas as pd

from bulkwear.postproc.plots.style import remarks_of, save
from tests import PUBLISHED as TABLES

PUBLISHED = pd.read_csv(TABLES / "circular_tester.csv")
PUBLISHED_FITS = pd.read_csv(TABLES / "circular_tester_volume.csv")
REMARKS = ["reduced scale, for tests"]
SMALLEST_PICTURE = 20_000  # bytes
REVOLUTIONS = 17
LAWS = {("plain", 3): (75.0, 0.0), ("convex", 3): (45.0, 0.75), ("convex", 1): (30.0, 0.0)}  # mm3 per revolution, 2
ELEMENTS = {"plain": 30_000, "convex": 40_000}


def volumes(laws=None, packings=1, scatter=0.0, noise=0.0, revolutions=REVOLUTIONS, shape="channel", seed=1):
    """Volumes after each revolution, by {(surface, particle scale): (mm3 per revolution, per revolution2)}.

    scatter: relative, of a bed, which both samples in it share, and as much of each of them; noise: relative, of each
    increment
    """
    generator = np.random.default_rng(seed)
    x, parts = np.arange(revolutions + 1.0), []
    for packing in range(1, packings + 1):
        of_bed = 1.0 + scatter * generator.normal()
        for (surface, scale), (a, b) in (laws or LAWS).items():
            rate = of_bed * (1.0 + scatter * generator.normal()) * (1.0 + noise * generator.normal(size=revolutions))
            lost = np.append(0.0, np.cumsum((a + b * (2.0 * x[:-1] + 1.0)) * rate))
            same = {"surface": surface, "particle_scale": float(scale), "packing": packing, "series": "volume"}
            same |= {"run": f"{surface}_{scale:g}_{shape}_{packing}", "shape": shape, "element_size_mm": 1.0}
            table = pd.DataFrame({"revolution": x, "volume_m3": 1e-9 * lost, "law_volume_m3": 1e-9 * lost})
            parts.append(table.assign(**same, coefficient=5e-9, elements=ELEMENTS[surface]))
    return pd.concat(parts, ignore_index=True)


def series(revolutions=10, instants=40, settled_after=3.0, variation=0.05, packings=1):
    """Flow of pairs of runs: twice too fast at first, settling; then of known coefficient of variation and mean, a
    hundredth higher in each further packing.
    """
    x = (np.arange(revolutions * instants) + 0.5) / instants
    wave = 1.0 + variation * np.sqrt(2.0) * np.sin(2.0 * np.pi * 8.0 * x)
    start = 1.0 + np.exp(-6.0 * x / settled_after)
    parts = []
    for packing in range(1, packings + 1):
        for surface, velocity in (("plain", 0.52), ("convex", 0.24)):
            table = {"velocity_m_per_s": velocity, "bed_height_m": 0.12, "wear_rate_m3_per_s": 2e-8}
            table |= {
                "bottom_averaged_angular_velocity_rad_per_s": 1.5,
                "bottom_mean_angular_speed_rad_per_s": 2.0,
                "bottom_velocity_m_per_s": velocity,
                "normal_force_N": 16.0,
            }
            columns = {name: (1.0 + 0.01 * (packing - 1)) * value * wave * start for name, value in table.items()}
            run = surface if packing == 1 else f"{surface}-{packing}"
            same = {"run": run, "surface": surface, "packing": packing, "revolution": x}
            parts.append(pd.DataFrame(same | columns))
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
