"""Loading what the library computes with, beside the windows: the first run of an application waits for it."""

import contextlib
import importlib
import importlib.util
import sys
from pathlib import Path

from AIFReconLib.progress import report
from AIFReconScene.background import inBackground

HEAVY = (
    *("AIFReconLib.reconstruction", "AIFReconLib.evaluation.metrics"),
    *("scipy.fft", "scipy.interpolate", "scipy.ndimage", "scipy.optimize", "scipy.sparse", "scipy.spatial", "scipy.special"),
)
"""All that the library computes with. It would load the parts of SciPy where it first names them, be that while windows stand still."""

LARGE = ("SimpleITK", "llvmlite", "onnxruntime")
"""Packages whose compiled libraries have 70 to 270 MB. llvmlite is that of numba."""

COMPILED = {".so", ".pyd", ".dll", ".dylib"}
"""A version may follow: libonnxruntime.so.1.32.0."""

AT_ONCE = 1 << 20
"""Bytes of a read."""

_read: set[str] = set()


def importLibrary(progress=None) -> None:
    """Load what the library computes with, which takes a while the first time; a cancel is heard while files are read."""

    def load(progress) -> None:
        for package in LARGE:
            readCompiled(package, progress)
        for name in HEAVY:
            importlib.import_module(name)

    inBackground(load, progress)


def readCompiled(package: str, progress=None) -> None:
    """Read the compiled libraries of a package from the disk, once, for a later import to find them in memory.

    An import holds the interpreter's lock while a library is loaded, and what is not in memory yet comes from the disk page by page:
    windows stood still for 0.3 s at the first of them after the computer's start. A read leaves the lock to other threads.

    Nothing is done where the package is loaded already or is not there; what cannot be read is left to the import.

    Raises
    ------
    OperationCanceled
        When `progress` returns False.
    """
    if package in _read or package in sys.modules:
        return
    spec, buffer = importlib.util.find_spec(package), bytearray(AT_ONCE)
    for folder in (spec and spec.submodule_search_locations) or ():
        for path in Path(folder).rglob("*"):
            if COMPILED.intersection(path.suffixes):
                with contextlib.suppress(OSError), path.open("rb", buffering=0) as file:
                    while file.readinto(buffer):
                        report(progress, 0.0, "")
    _read.add(package)
