"""Bulkwear: how bulk solids wear equipment, and how the worn shape changes the flow.

The names for a notebook; all else is imported from where it stands, e.g. `bulkwear.postproc.wear.patch`. They are
imported when they are first used, so that `import bulkwear` costs nothing.
"""

from importlib import import_module
from pathlib import Path

from bulkwear.compiled import choose_cache, forget_older

PUBLIC = {  # name: module that has it
    "SurfaceMesh": "bulkwear.postproc.mesh",  # points (m), triangles, labels and fields of a surface
    "read_surface": "bulkwear.postproc.mesh",  # from a .vtu of a run
    "write_surface": "bulkwear.postproc.mesh",
    "own_mesh": "bulkwear.meshes.own.mesh",  # a surface of a plant's own CAD and mesh files
    "read_ledger": "bulkwear.postproc.readers.load_ledger",  # loads per triangle of a wear cycle
    "LAWS": "bulkwear.postproc.wear.laws",  # wear laws by name
    "worn_volume": "bulkwear.postproc.wear.laws",  # m3 per triangle, by a law, from a ledger
    "wear_update": "bulkwear.postproc.wear.update",  # a surface with that volume removed
    "with_depths": "bulkwear.postproc.wear.update",  # a worn surface with its depth fields
    "draw_surface": "bulkwear.postproc.plots.pictures",  # a figure of a worn surface
    "read_summary": "bulkwear.postproc.tables.summary",  # the table of a study, a row per run
}
__all__ = list(PUBLIC)

_HERE = Path(__file__).resolve().parent
if not (_HERE / "postproc").is_dir():  # a clone: the package's folders stand beside this one, installed they are in it
    __path__.append(str(_HERE.parent))
_POSTPROC = next(Path(folder) / "postproc" for folder in __path__ if (Path(folder) / "postproc").is_dir())
choose_cache(_POSTPROC)
forget_older(_POSTPROC)


def __getattr__(name: str):
    """Return a public name, imported when it is first asked for."""
    if name not in PUBLIC:
        raise AttributeError(f"bulkwear has no {name!r}, its public names are {', '.join(PUBLIC)}")
    return getattr(import_module(PUBLIC[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *PUBLIC})
