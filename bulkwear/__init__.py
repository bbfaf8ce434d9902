"""Bulkwear: how bulk solids wear equipment, and how the worn shape changes the flow."""

from pathlib import Path

_HERE = Path(__file__).resolve().parent
if not (
    _HERE / "postproc"
).is_dir():  # in a clone the package's folders stand beside this one, installed they are in it
    __path__.append(str(_HERE.parent))
