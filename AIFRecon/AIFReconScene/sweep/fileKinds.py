"""What files are that somebody opens together: a recording, the configuration with its calibration, a CT, its segmentation, its place."""

from pathlib import Path

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

OPENED = (*SUFFIXES, ".mha", ".mhd", ".nrrd", ".nhdr")


def kindOf(path: Path) -> str:
    """What a file is, by its name, else by its header.

    Raises
    ------
    FileFormatError
        When it is none that is known, or cannot be read.
    """
    from AIFReconLib.bone.recorded_predictions import COVERS
    from AIFReconLib.errors import FileFormatError
    from AIFReconLib.io.metafile.opening import read_metafile
    from AIFReconLib.io.sequence.slicer import is_slicer_sequence

    told = next((kind for suffix, kind in SUFFIXES.items() if path.name.lower().endswith(suffix)), None)
    if told is not None:
        return told
    header = read_metafile(path, FileFormatError)
    ofFrames = [name for name in header.fields if name.startswith("Seq_Frame")]
    if any(name.endswith(f"_{COVERS}") for name in ofFrames):
        return PREDICTIONS
    tracked = is_slicer_sequence(header) or bool(ofFrames)
    return RECORDING if tracked else VOLUME
