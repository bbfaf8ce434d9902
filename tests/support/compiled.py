"""What Python and numba have compiled of the repository, had by a copy of it too.

Without it a copy compiles all of it anew: seconds of every first start, and half a minute of a first wear step.
Both look at a module's time: that of the copy becomes that of the source.
"""

import shutil
from pathlib import Path

SUFFIXES = (".pyc", ".nbi", ".nbc")  # of Python, index and code of numba; what is being written ends otherwise
CACHE = "__pycache__"


def share_compiled(copy: Path, source: Path) -> None:
    """Let the modules of a folder's copy have their compiled forms where those of the source are: what one of them
    compiles, the other need not. For copies whose modules stay as they are, to the byte.
    """
    for folder in {path.parent for path in source.rglob("*.py")}:
        beside = copy / folder.relative_to(source)
        for module in folder.glob("*.py"):
            assert (beside / module.name).read_bytes() == module.read_bytes(), module
            shutil.copystat(module, beside / module.name)
        (folder / CACHE).mkdir(exist_ok=True)
        shutil.rmtree(beside / CACHE, ignore_errors=True)
        (beside / CACHE).symlink_to(folder / CACHE)


def take_compiled(copy: Path, source: Path) -> None:
    """Lay what is compiled of a folder's modules beside those of a copy that are the same to the byte."""
    for folder in {path.parent for path in source.rglob(f"{CACHE}/*.pyc")}:
        beside = copy / folder.parent.relative_to(source)
        for compiled in folder.iterdir():
            name = f"{compiled.name.partition('.')[0]}.py"
            module, original = beside / name, folder.parent / name
            if compiled.suffix in SUFFIXES and module.is_file() and module.read_bytes() == original.read_bytes():
                (beside / folder.name).mkdir(exist_ok=True)
                shutil.copystat(original, module)
                shutil.copy2(compiled, beside / folder.name)
