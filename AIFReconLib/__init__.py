"""AIFRecon: 3D ultrasound of the spine from tracked 2D frames, every beam weighted by its angle of incidence to bone.

Every source (a Plus sequence file, Slicer's nodes, a live stream) becomes `TrackedFrame`s: an image and the matrix that places it in
Reference. A `Reconstructor` turns them into voxels of a `VoxelGrid`, reading a `BoneMap` where the method weights by incidence.
`reconstruct` does all of it for a recorded sequence in one call. Matrices are `a_to_b` on column vectors in mm; arrays are [k, j, i];
Reference is taken as RAS, and only files hold LPS.
"""

from __future__ import annotations

import logging
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    # The names below, for editors and type checkers; a test compares
    from .bone.ct.from_ct import labels_from_ct
    from .bone.echoes.surface import bone_from_sweep
    from .bone.map import BoneMap
    from .calibration.calibration import calibrate
    from .calibration.check import check_calibration
    from .compounding.own.method import Method, register_method
    from .compounding.reconstructor import Reconstructor
    from .compounding.state import Reconstruction
    from .errors import AIFReconError, DisagreementWarning
    from .evaluation.metrics import evaluate
    from .geometry.labels import Labels
    from .geometry.transform_graph import TransformGraph
    from .geometry.volume import Volume, VoxelGrid
    from .guidance.coverage import coverage
    from .guidance.plan import plan
    from .imaging.beams import ProbeGeometry
    from .imaging.region import ClipRectangle, Fan, ImageRegion
    from .inspection.offset_estimate import estimate_time_offset
    from .io.plus.configuration import read_plus_configuration
    from .io.sequence.files import read_sequence
    from .io.sequence.writer import write_sequence
    from .io.transform.files import read_transform
    from .io.volume.dicom_series import read_ct
    from .io.volume.files import read_volume, write_volume
    from .io.volume.label_files import read_labels
    from .live.pairing.synchronizer import SynchronizerSettings
    from .live.replay.server import ReplayServer
    from .live.session.session import LiveSession
    from .live.wire.client import OpenIGTLinkClient
    from .paths.free_paths import free_paths
    from .recipe.recipe import Recipe, ReconstructionSettings
    from .reconstruction import reconstruct
    from .registration.labeled_bone import LabeledBone
    from .registration.registration import register
    from .sweep.frames import TrackedFrame, TrackedSequence
    from .sweep.time_offset import with_time_offset

__version__ = "0.1.0"

_PUBLIC = {
    "AIFReconError": "errors",
    "BoneMap": "bone.map",
    "DisagreementWarning": "errors",
    "Fan": "imaging.region",
    "ClipRectangle": "imaging.region",
    "ImageRegion": "imaging.region",
    "Labels": "geometry.labels",
    "LabeledBone": "registration.labeled_bone",
    "LiveSession": "live.session.session",
    "Method": "compounding.own.method",
    "OpenIGTLinkClient": "live.wire.client",
    "ProbeGeometry": "imaging.beams",
    "Recipe": "recipe.recipe",
    "Reconstruction": "compounding.state",
    "ReconstructionSettings": "recipe.recipe",
    "Reconstructor": "compounding.reconstructor",
    "ReplayServer": "live.replay.server",
    "SynchronizerSettings": "live.pairing.synchronizer",
    "TrackedFrame": "sweep.frames",
    "TrackedSequence": "sweep.frames",
    "TransformGraph": "geometry.transform_graph",
    "Volume": "geometry.volume",
    "VoxelGrid": "geometry.volume",
    "bone_from_sweep": "bone.echoes.surface",
    "calibrate": "calibration.calibration",
    "check_calibration": "calibration.check",
    "coverage": "guidance.coverage",
    "estimate_time_offset": "inspection.offset_estimate",
    "evaluate": "evaluation.metrics",
    "free_paths": "paths.free_paths",
    "labels_from_ct": "bone.ct.from_ct",
    "plan": "guidance.plan",
    "read_ct": "io.volume.dicom_series",
    "read_labels": "io.volume.label_files",
    "read_plus_configuration": "io.plus.configuration",
    "read_sequence": "io.sequence.files",
    "read_transform": "io.transform.files",
    "read_volume": "io.volume.files",
    "reconstruct": "reconstruction",
    "register": "registration.registration",
    "register_method": "compounding.own.method",
    "with_time_offset": "sweep.time_offset",
    "write_sequence": "io.sequence.writer",
    "write_volume": "io.volume.files",
}

__all__ = [
    "AIFReconError",
    "BoneMap",
    "ClipRectangle",
    "DisagreementWarning",
    "Fan",
    "ImageRegion",
    "LabeledBone",
    "Labels",
    "LiveSession",
    "Method",
    "OpenIGTLinkClient",
    "ProbeGeometry",
    "Recipe",
    "Reconstruction",
    "ReconstructionSettings",
    "Reconstructor",
    "ReplayServer",
    "SynchronizerSettings",
    "TrackedFrame",
    "TrackedSequence",
    "TransformGraph",
    "Volume",
    "VoxelGrid",
    "bone_from_sweep",
    "calibrate",
    "check_calibration",
    "coverage",
    "estimate_time_offset",
    "evaluate",
    "free_paths",
    "labels_from_ct",
    "plan",
    "read_ct",
    "read_labels",
    "read_plus_configuration",
    "read_sequence",
    "read_transform",
    "read_volume",
    "reconstruct",
    "register",
    "register_method",
    "with_time_offset",
    "write_sequence",
    "write_volume",
]

# What is worth knowing afterwards is logged under this name; nothing is shown unless a program wants it
logging.getLogger(__name__).addHandler(logging.NullHandler())


def __getattr__(name: str) -> Any:
    # Names are loaded when first used: Slicer imports this package at start-up, and SimpleITK alone takes longer than all else
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_PUBLIC[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
