"""AIFRecon: 3D ultrasound of the spine from tracked 2D frames, every beam weighted by its angle of incidence to bone.

Every source (a Plus sequence file, Slicer's nodes, a live stream) becomes `TrackedFrame`s: an image and the matrix that places it in
Reference. A `Reconstructor` turns them into voxels of a `VoxelGrid`, reading a `BoneMap` where the method weights by incidence.
`reconstruct` does all of it for a recorded sequence in one call. Matrices are `a_to_b` on column vectors in mm; arrays are [k, j, i];
Reference is taken as RAS, and only files hold LPS.
"""

from __future__ import annotations

import logging
import warnings
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    # The names below, for editors and type checkers; a test compares
    from .bone.ct.from_ct import labels_from_ct as labels_from_ct
    from .bone.echoes.surface import bone_from_sweep as bone_from_sweep
    from .bone.map import BoneMap as BoneMap
    from .bone.predicted_bone import bone_from_masks as bone_from_masks
    from .calibration.calibration import Calibration as Calibration
    from .calibration.calibration import calibrate as calibrate
    from .calibration.check import check_calibration as check_calibration
    from .calibration.crossing import calibrate_by_crossing as calibrate_by_crossing
    from .compounding.methods.table import MethodName as MethodName
    from .compounding.own.method import Method as Method
    from .compounding.own.method import register_method as register_method
    from .compounding.reconstructor import Reconstructor as Reconstructor
    from .compounding.state import Reconstruction as Reconstruction
    from .errors import AIFReconError as AIFReconError
    from .errors import DisagreementWarning as DisagreementWarning
    from .evaluation.figures import ComparisonFigure as ComparisonFigure
    from .evaluation.metrics import evaluate as evaluate
    from .geometry.labels import Labels as Labels
    from .geometry.volume import Volume as Volume
    from .geometry.volume import VoxelGrid as VoxelGrid
    from .guidance.coverage import coverage as coverage
    from .guidance.plan import plan as plan
    from .imaging.beams import ProbeGeometry as ProbeGeometry
    from .imaging.region import ClipRectangle as ClipRectangle
    from .imaging.region import Fan as Fan
    from .imaging.region import ImageRegion as ImageRegion
    from .inspection.offset_estimate import estimate_time_offset as estimate_time_offset
    from .io.plus.configuration import read_plus_configuration as read_plus_configuration
    from .io.sequence.files import read_sequence as read_sequence
    from .io.sequence.writer import write_sequence as write_sequence
    from .io.transform.files import read_transform as read_transform
    from .io.volume.dicom_series import read_ct as read_ct
    from .io.volume.files import read_volume as read_volume
    from .io.volume.files import write_volume as write_volume
    from .io.volume.label_files import read_labels as read_labels
    from .live.pairing.synchronizer import SynchronizerSettings as SynchronizerSettings
    from .live.replay.server import ReplayServer as ReplayServer
    from .live.session.session import LiveSession as LiveSession
    from .live.wire.client import OpenIGTLinkClient as OpenIGTLinkClient
    from .paths.free_paths import free_paths as free_paths
    from .recipe.recipe import Recipe as Recipe
    from .reconstruction import reconstruct as reconstruct
    from .registration.labeled_bone import LabeledBone as LabeledBone
    from .registration.registration import register as register
    from .sweep.frames import TrackedFrame as TrackedFrame
    from .sweep.frames import TrackedSequence as TrackedSequence
    from .sweep.time_offset import with_time_offset as with_time_offset
    from .workflows.reconstruct import mended as mended

__version__ = "0.1.0"

_PUBLIC = {
    "AIFReconError": "errors",
    "BoneMap": "bone.map",
    "Calibration": "calibration.calibration",
    "DisagreementWarning": "errors",
    "Fan": "imaging.region",
    "ClipRectangle": "imaging.region",
    "ComparisonFigure": "evaluation.figures",
    "ImageRegion": "imaging.region",
    "Labels": "geometry.labels",
    "LabeledBone": "registration.labeled_bone",
    "LiveSession": "live.session.session",
    "Method": "compounding.own.method",
    "MethodName": "compounding.methods.table",
    "OpenIGTLinkClient": "live.wire.client",
    "ProbeGeometry": "imaging.beams",
    "Recipe": "recipe.recipe",
    "Reconstruction": "compounding.state",
    "Reconstructor": "compounding.reconstructor",
    "ReplayServer": "live.replay.server",
    "SynchronizerSettings": "live.pairing.synchronizer",
    "TrackedFrame": "sweep.frames",
    "TrackedSequence": "sweep.frames",
    "Volume": "geometry.volume",
    "VoxelGrid": "geometry.volume",
    "bone_from_masks": "bone.predicted_bone",
    "bone_from_sweep": "bone.echoes.surface",
    "calibrate": "calibration.calibration",
    "calibrate_by_crossing": "calibration.crossing",
    "check_calibration": "calibration.check",
    "coverage": "guidance.coverage",
    "estimate_time_offset": "inspection.offset_estimate",
    "evaluate": "evaluation.metrics",
    "free_paths": "paths.free_paths",
    "labels_from_ct": "bone.ct.from_ct",
    "mended": "workflows.reconstruct",
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
