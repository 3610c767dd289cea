"""AIFRecon: 3D ultrasound of the spine from tracked 2D frames, every beam weighted by its angle of incidence to bone.

Every source (a Plus sequence file, Slicer's nodes, a live stream) becomes `TrackedFrame`s: an image and the matrix that places it in
Reference. A `Reconstructor` turns them into voxels of a `VoxelGrid`, reading a `BoneMap` where the method weights by incidence.
`reconstruct` does all of it for a recorded sequence in one call. Matrices are `a_to_b` on column vectors in mm; arrays are [k, j, i];
Reference is taken as RAS, and only files hold LPS.
"""

from __future__ import annotations

import logging
import re
import warnings
from importlib import import_module
from pathlib import Path
from typing import Any

__version__ = "0.1.0"

_PUBLIC = {name: file for file, name in re.findall(r"from \.(\S+) import (\w+)", Path(__file__).with_suffix(".pyi").read_text("utf-8"))}
"""The public names and the files that they lie in, as `__init__.pyi` tells them to editors and type checkers."""

__all__ = sorted(_PUBLIC)

# What is worth knowing afterwards is logged under this name; nothing is shown unless a program wants it
logging.getLogger(__name__).addHandler(logging.NullHandler())


def __getattr__(name: str) -> Any:
    if name == "ReconstructionSettings":
        warnings.warn("ReconstructionSettings is now called Recipe.", DeprecationWarning, stacklevel=2)
        name = "Recipe"
    # Names are loaded when first used: Slicer imports this package at start-up, and SimpleITK alone takes longer than all else
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_PUBLIC[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
