"""Compared surfaces as one small block of numbers for a page.

Places are kept to 1/65535 of the box round all surfaces, values to 1/65534 of their largest.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from bulkwear.postproc.mesh import SurfaceMesh, node_areas
from bulkwear.postproc.tables.compared_surfaces import DEPTH, Shown, Values, quantities
from bulkwear.postproc.tables.depths import area_quantile
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES

TOP_SHARE = 0.99  # -, of the area of the surface with the largest values: the colours end there
LEVELS = 65535  # of a 16-bit number
UNKNOWN = LEVELS  # a node without a value
ALIGNED, HARDEST = 4, 9  # bytes of the longest number; level of the compression


def top_of(shown: Shown, values: Values) -> float:
    """Return the value that TOP_SHARE of a surface's area does not exceed."""
    area = node_areas(shown.mesh)
    known = np.isfinite(values) & (area > 0.0)
    return area_quantile(values[known], area[known], TOP_SHARE) if known.any() else 0.0


def packed(surfaces: Sequence[Shown], deformed: bool) -> tuple[dict[str, Any], bytes]:
    """Return what a page is told of surfaces, JSON-able, and the compressed (zlib) block of numbers that it points to.

    Told: `box` (low and high corner, mm), `quantities` (key, title, unit, top of the colours, largest value, scale of
    the unit, keys of which it is the difference), and `surfaces` (run, cycle, said, numbers of nodes and faces, and
    where its points (3, n), triangles (m, 3), label of the part at each node (n,) int16 and values (n,) by key begin in
    the block, in bytes). Points and values are 16-bit levels, triangles 32-bit `_differences`, all lowest bytes before
    all higher ones; where `over` says so, to points those that begin there are added, modulo 65536. Nodes and triangles
    are in the order of `neighbours_together`. Arrays that are alike are kept once. What no surface has is left out.
    """
    block = _Block()
    corners = np.array([[each.mesh.points.min(axis=0), each.mesh.points.max(axis=0)] for each in surfaces])
    low, high = corners[:, 0].min(axis=0) * MILLIMETRES, corners[:, 1].max(axis=0) * MILLIMETRES
    size = float(max((high - low).max(), np.finfo(float).tiny))
    first: dict[str, tuple[np.ndarray, int]] = {}
    told = []
    orders = []
    for each in surfaces:
        order, triangles = neighbours_together(each.mesh.triangles, len(each.mesh.points))
        orders.append(order)
        places = _places(each.mesh.points[order], low, size)
        base, at = first.get(each.run, (None, None))
        same = base is not None and base.shape == places.shape
        told.append(
            {
                "run": each.run,
                "cycle": each.cycle,
                "said": each.said,
                "nodes": len(each.mesh.points),
                "faces": len(each.mesh.triangles),
                "points": block.add(_planes(places - base if same else places)),  # modulo 65536, as such numbers are
                "over": at if same else None,
                "triangles": block.add(_planes(_differences(triangles))),
                "parts": block.add(node_parts(each.mesh)[order].astype("<i2")),
                "values": {},
            }
        )
        first.setdefault(each.run, (places, told[-1]["points"]))
    shown = {}
    for key, quantity in quantities(deformed).items():
        values = [quantity.values(each) if each.whole or key == DEPTH else None for each in surfaces]
        known = [(each, found) for each, found in zip(surfaces, values, strict=True) if found is not None]
        if not known or not np.isfinite(np.concatenate([found for _, found in known])).any():
            continue
        largest = max(float(np.nanmax(found)) for _, found in known if np.isfinite(found).any())
        top = max(top_of(*pair) for pair in known)
        if not largest > 0.0:
            continue
        scale, unit = _readable(largest, quantity.unit)
        ends = {"top": scale * (top if top > 0.0 else largest), "largest": scale * largest, "scale": scale}
        shown[key] = {"title": quantity.title, "unit": unit, **ends, "less": quantity.less}
        if quantity.less:
            continue
        for entry, found, order in zip(told, values, orders, strict=True):
            if found is not None:
                entry["values"][key] = block.add(_planes(_levels(found[order], largest)))
    return {"box": [low.tolist(), (low + size).tolist()], "quantities": shown, "surfaces": told}, block.compressed()


def _readable(largest: float, unit: str) -> tuple[float, str]:
    """Return by what values are multiplied, and their unit then: micrometres by the thousand are millimetres."""
    return (MILLIMETRES / MICROMETRES, "mm") if unit == "µm" and largest > MICROMETRES / MILLIMETRES else (1.0, unit)


def node_parts(mesh: SurfaceMesh) -> np.ndarray:
    """Return the label (n,) of the part at each node: the highest of its triangles'."""
    labels = mesh.cell_data.get("part", np.zeros(len(mesh.triangles), dtype=int))
    found = np.full(len(mesh.points), labels.min(initial=0))
    np.maximum.at(found, mesh.triangles.ravel(), np.repeat(labels, 3))
    return found


def _levels(values: Values, largest: float) -> np.ndarray:
    share = np.clip(np.where(np.isfinite(values), values, 0.0) / largest, 0.0, 1.0)
    return np.where(np.isfinite(values), np.round(share * (LEVELS - 1)), UNKNOWN).astype("<u2")


def neighbours_together(triangles: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return an order (n,) of nodes in which neighbours are near one another, and triangles (m, 3) by that order.

    Triangles keep their normals; they begin with their first node, and are sorted. Numbers of nodes then hardly differ
    from triangle to triangle. The order is that of Cuthill and McKee (1969), reversed.
    """
    ends = np.roll(triangles, 1, axis=1).ravel()
    links = coo_matrix((np.ones(triangles.size, dtype=np.int8), (triangles.ravel(), ends)), shape=(nodes, nodes))
    order = reverse_cuthill_mckee((links + links.T).tocsr(), symmetric_mode=True).astype(np.int64)
    place = np.empty(nodes, dtype=np.int64)
    place[order] = np.arange(nodes)
    found = place[triangles]
    turned = (found.argmin(axis=1)[:, None] + np.arange(3)) % 3
    found = np.take_along_axis(found, turned, axis=1)
    return order, found[np.lexsort(found.T[::-1])]


def _differences(triangles: np.ndarray) -> np.ndarray:
    """Return triangles (m, 3) as differences: the first node from that of the one before, the others from the first."""
    found = triangles - triangles[:, :1]
    found[:, 0] = np.diff(triangles[:, 0], prepend=0)
    return found.astype("<u4")


def _places(points: np.ndarray, low: np.ndarray, size: float) -> np.ndarray:
    """Return points (n, 3) m as levels (3, n) of a box; low: its corner (mm), size: its side (mm)."""
    return np.round((points * MILLIMETRES - low).T / size * LEVELS).astype("<u2")


def _planes(numbers: np.ndarray) -> np.ndarray:
    """Return numbers with all lowest bytes first, then the next: the high ones of neighbours are alike."""
    return np.ascontiguousarray(numbers).ravel().view(np.uint8).reshape(-1, numbers.itemsize).T


class _Block:
    """Arrays one after another, each beginning at a multiple of four bytes, alike ones once."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.length = 0
        self.places: dict[bytes, int] = {}

    def add(self, array: np.ndarray) -> int:
        """Return where (bytes) an array begins."""
        content = np.ascontiguousarray(array).tobytes()
        if content not in self.places:
            self.places[content] = self.length
            padded = content + bytes(-len(content) % ALIGNED)
            self.parts.append(padded)
            self.length += len(padded)
        return self.places[content]

    def compressed(self) -> bytes:
        """Return all arrays, compressed."""
        return zlib.compress(b"".join(self.parts), HARDEST)
