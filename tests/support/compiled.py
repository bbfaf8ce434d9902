"""What Python and numba have compiled of the repository, taken along into a copy of it.

Without it a copy compiles all of it anew: seconds of every first start, and half a minute of a first wear step.
"""

import shutil
from pathlib import Path

SUFFIXES = (".pyc", ".nbi", ".nbc")  # of Python, index and code of numba; what is being written ends otherwise


def take_compiled(copy: Path, source: Path) -> None:
    """Lay what is compiled of a folder's modules beside those of a copy that are the same to the byte.

    Both look at a module's time: that of the copy becomes that of the source.
    """
    for folder in {path.parent for path in source.rglob("__pycache__/*.pyc")}:
        beside = copy / folder.parent.relative_to(source)
        for compiled in folder.iterdir():
            name = f"{compiled.name.partition('.')[0]}.py"
            module, original = beside / name, folder.parent / name
            if compiled.suffix in SUFFIXES and module.is_file() and module.read_bytes() == original.read_bytes():
                (beside / folder.name).mkdir(exist_ok=True)
                shutil.copystat(original, module)
                shutil.copy2(compiled, beside / folder.name)
