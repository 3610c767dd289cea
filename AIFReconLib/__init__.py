"""AIFRecon: 3D ultrasound of the spine from tracked 2D frames, every beam weighted by its angle of incidence to bone.

Every source (a Plus sequence file, Slicer's nodes, a live stream) becomes `TrackedFrame`s: an image and the matrix that places it in
Reference. A `Reconstructor` turns them into voxels of a `VoxelGrid`, reading a `BoneMap` where the method weights by incidence.
`reconstruct` does all of it for a recorded sequence in one call. Matrices are `a_to_b` on column vectors in mm; arrays are [k, j, i];
Reference is taken as RAS, and only files hold LPS.
"""

from __future__ import annotations

from importlib import import_module

from .machine.moved import find_moved_modules

__version__ = "0.1.0"

_PUBLIC = {
    "AIFReconError": "errors",
    "BoneMap": "bone.map",
    "Fan": "imaging.region",
    "ClipRectangle": "imaging.region",
    "ImageRegion": "imaging.region",
    "LiveSession": "live.session.session",
    "OpenIGTLinkClient": "live.wire.client",
    "ProbeGeometry": "imaging.beams",
    "Reconstruction": "compounding.reconstructor",
    "ReconstructionSettings": "settings",
    "Reconstructor": "compounding.reconstructor",
    "ReplayServer": "live.replay.server",
    "SynchronizerSettings": "live.pairing.synchronizer",
    "TrackedFrame": "sweep.frames",
    "TrackedSequence": "sweep.frames",
    "TransformGraph": "geometry.transform_graph",
    "Volume": "geometry.volume",
    "VoxelGrid": "geometry.volume",
    "bone_from_sweep": "bone.from_sweep",
    "estimate_time_offset": "inspection.offset_estimate",
    "evaluate": "evaluation.metrics",
    "read_labels": "io.volume.files",
    "read_plus_configuration": "io.plus.configuration",
    "read_sequence": "io.sequence.files",
    "read_transform": "io.volume.files",
    "read_volume": "io.volume.files",
    "reconstruct": "reconstruction",
    "register": "registration.registration",
    "with_time_offset": "sweep.time_offset",
    "write_sequence": "io.sequence.writer",
    "write_volume": "io.volume.files",
}

__all__ = sorted(_PUBLIC)

find_moved_modules()


def __getattr__(name: str):
    # Names are loaded when first used: Slicer imports this package at start-up, and SimpleITK alone takes longer than all else
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_PUBLIC[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
