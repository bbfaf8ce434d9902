"""How particles are packed, layer by layer: contacts per particle and porosity (Yan 2022, section 4.3.1).

Layers are horizontal slabs over a whole area. Porosity by two rules: the source's, which gives a particle's whole
volume to the layer of its centre, and the exact one, which cuts it.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

LAYER_DIAMETERS = 4.0  # -, height of a layer over the median diameter (Yan 2022, section 4.3.1)
FULL = 0.99  # -, of the particles lie wholly below the surface
FEWEST_LAYERS = 3  # with a bottom and a top one, which walls and surface disturb, one to look at
MEASURES = ("coordination_number", "porosity", "porosity_whole_particles")


def volume_below(height: np.ndarray, radius: np.ndarray, plane: float) -> np.ndarray:
    """Return the volume (k,) m3 of spheres (centres at height (k,) m) below a horizontal plane (m).

    A segment of height t 2R has 4/3 pi R^3 t^2 (3 - 2 t).
    """
    share = np.clip((plane - height + radius) / (2.0 * radius), 0.0, 1.0)
    return 4.0 / 3.0 * math.pi * radius**3 * share**2 * (3.0 - 2.0 * share)


def porosity(height: np.ndarray, radius: np.ndarray, edges: np.ndarray, area: float) -> np.ndarray:
    """Return the porosity (k,) of layers between edges (k + 1,) m over an area (m2); spheres are cut by the edges."""
    below = np.array([volume_below(height, radius, edge).sum() for edge in edges])
    return 1.0 - np.diff(below) / (area * np.diff(edges))


def porosity_of_whole_particles(height: np.ndarray, radius: np.ndarray, edges: np.ndarray, area: float) -> np.ndarray:
    """Return the porosity (k,) where a particle counts whole in the layer of its centre (Yan 2022, section 4.3.1)."""
    solid, _ = np.histogram(height, edges, weights=4.0 / 3.0 * math.pi * radius**3)
    return 1.0 - solid / (area * np.diff(edges))


def layer_edges(height: np.ndarray, radius: np.ndarray, median_diameter: float, floor: float = 0.0) -> np.ndarray:
    """Return the edges (m) of all layers of four median diameters between the floor and the surface.

    Raises ValueError when there are fewer than three.
    """
    surface, step = np.quantile(height + radius, FULL), LAYER_DIAMETERS * median_diameter
    count = int((surface - floor) / step)
    if count < FEWEST_LAYERS:
        raise ValueError(
            f"a bed of {1e3 * (surface - floor):.3g} mm holds {count} layers of {1e3 * step:.3g} mm (four median"
            f" diameters), allowed are at least {FEWEST_LAYERS}."
        )
    return floor + step * np.arange(count + 1)


def packing_profile(particles: pd.DataFrame, edges: np.ndarray, area: float) -> pd.DataFrame:
    """Return how particles are packed layer by layer.

    particles: z_m, radius_m and contacts of each, as from `flow.bed.read_snapshot`, all over one area (m2)
    edges: (k + 1,) m, of the layers

    Columns layer (from 1, the lowest), height_m (its middle above the lowest edge), particles, coordination_number
    (contacts of a particle with others, mean over those with their centre in the layer), porosity and
    porosity_whole_particles (-).
    """
    height, radius = particles["z_m"].to_numpy(), particles["radius_m"].to_numpy()
    number, _ = np.histogram(height, edges)
    contacts, _ = np.histogram(height, edges, weights=particles["contacts"].to_numpy(dtype=float))
    return pd.DataFrame(
        {
            "layer": np.arange(1, len(edges)),
            "height_m": 0.5 * (edges[1:] + edges[:-1]) - edges[0],
            "particles": number,
            "coordination_number": np.where(number > 0, contacts, np.nan) / np.maximum(number, 1),
            "porosity": porosity(height, radius, edges, area),
            "porosity_whole_particles": porosity_of_whole_particles(height, radius, edges, area),
        }
    )


def inner_means(profile: pd.DataFrame) -> dict[str, float]:
    """Return the means of all measures without the lowest and the highest layer (Yan 2022, section 4.3.1).

    Porosities are means over equal layers, coordination numbers over their particles.
    """
    inner = profile.iloc[1:-1]
    coordination = np.average(inner["coordination_number"], weights=inner["particles"])
    return {"coordination_number": float(coordination)} | {name: float(inner[name].mean()) for name in MEASURES[1:]}


def loose_and_dense(loose: pd.DataFrame, dense: pd.DataFrame, median_diameter: float, area: float) -> pd.DataFrame:
    """Return the profiles of a container before (loose) and after shaking (dense), and their differences.

    loose, dense: particles, as for `packing_profile`, on a floor at z = 0. Layers of both are those of the dense
    packing, which is the lower one. Column state: loose, dense or difference (dense minus loose).
    """
    edges = layer_edges(dense["z_m"].to_numpy(), dense["radius_m"].to_numpy(), median_diameter)
    profiles = {state: packing_profile(each, edges, area) for state, each in (("loose", loose), ("dense", dense))}
    difference = profiles["dense"].copy()
    difference[list(MEASURES)] -= profiles["loose"][list(MEASURES)]
    tables = {**profiles, "difference": difference}
    return pd.concat([table.assign(state=state) for state, table in tables.items()], ignore_index=True)


def slabs_remark(table: pd.DataFrame) -> str:
    """Return what a figure must say of how many slabs a container has at every scale; table: layer, particle_scale."""
    counts = table.groupby("particle_scale")["layer"].max()
    told = ", ".join(f"{count} at scale {scale:g}" for scale, count in counts.items())
    return f"slabs of {LAYER_DIAMETERS:g} median diameters: {told}"


def within(particles: pd.DataFrame, start: float, end: float) -> pd.DataFrame:
    """Return the particles of a piece of bed, those with their centre between two y (m)."""
    return particles[particles["y_m"].between(start, end, inclusive="left")]
