"""Tracked ultrasound sequences in files of every kind that is known."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ...errors import SequenceFormatError
from ...recipe.recipe import LONGEST_GAP
from ...remedies import IMPORT_IT
from ...sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ...sweep.frames import TrackedSequence
from ..plus.configuration import read_plus_configuration
from .kinds import RecordingKind
from .metafiles import METAFILES
from .orientation import parse_orientation
from .others.custusx import CUSTUSX, refuse_one_frame
from .others.numpy_archives import NUMPY_ARCHIVES
from .others.ros import BAGS
from .others.slicer_bundles import BUNDLES
from .others.unread import refuse_unread
from .slicer import place_frames
from .transforms import pair_transforms
from .writer import write_sequence

__all__ = ["read_sequence", "write_sequence"]

KINDS = (METAFILES, BUNDLES, NUMPY_ARCHIVES, CUSTUSX, BAGS)
"""Every kind of recording that is read: what chooses files, and what reads or damages them in tests, goes by this table."""

IMAGE_FRAME = "Image"


def recording_suffixes() -> tuple[str, ...]:
    """Of all files that are opened as recordings."""
    return tuple(suffix for kind in KINDS for suffix in kind.suffixes)


def recording_kind(path: Path) -> RecordingKind | None:
    """The kind that opens a file of this name, or this folder; None where none does."""
    if path.is_dir():
        return next((kind for kind in KINDS if kind.is_folder(path)), None)
    return next((kind for kind in KINDS if path.suffix.lower() in kind.suffixes), None)


def require_recording_kind(path: Path) -> RecordingKind:
    """The kind that opens it.

    Raises SequenceFormatError when none opens it.
    """
    kind = recording_kind(path)
    if kind is None and path.is_dir():
        raise SequenceFormatError(f"{path}: this is a folder, and no recording that is known.", IMPORT_IT)
    if kind is None:
        refuse_unread(path)
        raise SequenceFormatError(f"{path}: its suffix must be one of {', '.join(recording_suffixes())}.", IMPORT_IT)
    return kind


def read_sequence(
    path: str | Path,
    config: str | Path | PlusConfiguration | None = None,
    *,
    orientation: str | None = None,
    transform_sequences: Mapping[str, str | Path] | None = None,
    longest_gap: float = LONGEST_GAP,
    image_frame: str | None = None,
) -> TrackedSequence:
    """The sequence in a file.

    Parameters
    ----------
    path : str or Path
        .mha, .mhd, .nrrd or .nhdr of Plus or of Slicer, compressed or not; or a file or folder of another kind in `KINDS`.
    config : str, Path, PlusConfiguration or None
        The Plus configuration it was recorded with, which holds the calibration.
    orientation : str or None
        What the stored pixels are (MF, MN, UF, UN), where the file says it wrongly or not at all.
    transform_sequences : mapping of transform name to path, or None
        Slicer's sequences of transforms (.seq.mha) that belong to the images, as in ``{"ImageToReference": "Transform.seq.mha"}``;
        each is taken at the time of every image.
    longest_gap : float, s
        Poses of a transform sequence that are farther apart in time than this are not interpolated between.
    image_frame : str or None
        What transforms call the image's frame, where volume nodes of Slicer have a geometry of their own; by default as the configuration
        says, else Image.

    Returns
    -------
    TrackedSequence
        Its images are read when asked for, in MF orientation, colors reduced to luminance. The file must stay until then.

    Raises
    ------
    SequenceFormatError
        When the file is damaged or of a kind that is not supported. Damage inside compressed pixel data shows when the frame
        is read.
    ConfigurationError
        When the configuration cannot be used.
    SettingsError
        When `orientation` is none, or a transform sequence does not fit the images.

    Notes
    -----
    A transform of the image in a Slicer sequence takes what the volume node's IJKToRAS makes of a pixel. Where that is not the identity,
    it is multiplied into those transforms, so that they take pixels here as everywhere. Those of a configuration take pixels as they are.
    """
    path = Path(path)
    refuse_one_frame(path)
    recorded = require_recording_kind(path).read(path, parse_orientation(orientation) if orientation else None)
    records, notes = recorded.records, recorded.notes
    if transform_sequences:
        records, paired = pair_transforms(records, transform_sequences, longest_gap)
        notes += paired
    configuration = read_plus_configuration(config) if isinstance(config, str | Path) else config
    if recorded.pixel_to_node is not None:
        frame = image_frame or (configuration.image_frame if configuration is not None else None) or IMAGE_FRAME
        is_moved = any(frame in (name.source, name.target) for record in records for name in record.transforms)
        included = (
            f"the transforms of {frame} now include" if is_moved else f"nothing includes: none of the recorded transforms is of {frame}"
        )
        notes += (f"The volume nodes of this Slicer sequence have a geometry of their own, which {included}.",)
        records = place_frames(records, frame, recorded.pixel_to_node)
    oriented = {} if orientation is None else {"orientation": orientation}
    return TrackedSequence(
        images=recorded.images,
        records=records,
        fields=recorded.fields,
        transforms=recorded.transforms,
        configuration=NO_CONFIGURATION if configuration is None else configuration,
        path=path,
        notes=notes,
        reading={**oriented, "longest_gap": longest_gap},
    )
