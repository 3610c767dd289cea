"""What files are that somebody opens together: a recording, the configuration with its calibration, a CT, its segmentation, its place."""

from pathlib import Path

from AIFReconLib.io.sequence.files import recording_suffixes
from AIFReconLib.worker.recordings import frame_fields

from ..work import inWorker
from .sequenceNodes import COVERS_ATTRIBUTE

RECORDING, CONFIGURATION, VOLUME, SEGMENTATION, TRANSFORM = "recording", "configuration", "volume", "segmentation", "transform"
PREDICTIONS = "predictions"
"""What a network has said of a recording, as a scan records it."""

SUFFIXES = {
    ".xml": CONFIGURATION,
    ".seg.nrrd": SEGMENTATION,
    ".seg.nhdr": SEGMENTATION,
    ".nii": VOLUME,
    ".nii.gz": VOLUME,
    ".tfm": TRANSFORM,
    ".h5": TRANSFORM,
}
"""What names tell; others are looked into."""


def opened() -> tuple[str, ...]:
    """Suffixes of all files that are opened."""
    return (*SUFFIXES, *recording_suffixes())


def kindOf(path: Path) -> str:
    """What a file is, by its name, else by its header; a FileFormatError when it is none that is known, or cannot be read."""
    told = next((kind for suffix, kind in SUFFIXES.items() if path.name.lower().endswith(suffix)), None)
    if told is not None:
        return told
    ofFrames = inWorker(frame_fields, path)
    if ofFrames is None:
        return VOLUME
    return PREDICTIONS if COVERS_ATTRIBUTE in ofFrames else RECORDING
