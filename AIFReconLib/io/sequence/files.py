"""Tracked ultrasound sequences in files, as the Plus toolkit and Slicer write them: .mha, .mhd with a data file, .nrrd."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from ...arrays import Matrix
from ...errors import SequenceFormatError
from ...imaging.images import ImageStack
from ...recipe.recipe import LONGEST_GAP
from ...sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ...sweep.frames import FrameRecord, TrackedSequence
from ..metafile.metafile import Metafile
from ..metafile.opening import read_metafile
from ..metafile.text_values import parse_numbers
from ..plus.configuration import read_plus_configuration
from .fields import split_fields, stated_spacing
from .file_images import FileImages
from .interleaved_images import InterleavedImages
from .orientation import is_image_key, parse_orientation, required_flips
from .slicer import is_interleaved, is_slicer_sequence, node_geometry, place_frames, slicer_records
from .transforms import pair_transforms
from .writer import write_sequence

__all__ = ["read_sequence", "write_sequence"]

IMAGE_FRAME = "Image"


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
        .mha, .mhd, .nrrd or .nhdr, compressed or not, of Plus or of Slicer.
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
    metafile = read_metafile(path, SequenceFormatError)
    flip_columns, flip_rows = required_flips(metafile, parse_orientation(orientation) if orientation else None)
    kind = InterleavedImages if is_interleaved(metafile) else FileImages
    images: ImageStack = kind(metafile, flip_columns=flip_columns, flip_rows=flip_rows)
    from_slicer = is_slicer_sequence(metafile)
    records, fields, transforms = split_fields(metafile, len(images), None if from_slicer else _header_spacing(metafile))
    notes: tuple[str, ...] = ()
    if from_slicer:
        records, fields, notes = slicer_records(metafile, records, fields)
    if transform_sequences:
        records, paired = pair_transforms(records, transform_sequences, longest_gap)
        notes += paired
    configuration = read_plus_configuration(config) if isinstance(config, str | Path) else config
    geometry = node_geometry(metafile) if from_slicer else None
    if geometry is not None:
        frame = image_frame or (configuration.image_frame if configuration is not None else None) or IMAGE_FRAME
        records, said = _placed(records, frame, geometry)
        notes += (said,)
    return TrackedSequence(
        images=images,
        records=records,
        fields={key: value for key, value in fields.items() if not is_image_key(key)},
        transforms=transforms,
        configuration=NO_CONFIGURATION if configuration is None else configuration,
        path=Path(path),
        notes=notes,
    )


def _header_spacing(metafile: Metafile) -> tuple[float, float] | None:
    """Size of a pixel by the header, mm. (Slicer's is part of the place of its volume nodes.)"""
    entries = metafile.entries
    words = next((text.split() for key in ("ElementSpacing", "ElementSize", "spacings") if (text := entries.get(key))), [])
    if not words:
        vectors = re.findall(r"\(([^)]*)\)", entries.get("space directions", ""))
        with contextlib.suppress(ValueError):
            words = [str(math.hypot(*parse_numbers(vector.replace(",", " ")))) for vector in vectors]
    elif metafile.channels > 1 and len(words) > len(metafile.size):
        words = words[1:]
    return stated_spacing(" ".join(words))


def _placed(records: Sequence[FrameRecord], image_frame: str, geometry: Matrix) -> tuple[Sequence[FrameRecord], str]:
    """Records whose transforms of the image include its node's geometry, and a note on what was done."""
    if any(image_frame in (name.source, name.target) for record in records for name in record.transforms):
        note = f"The volume nodes of this Slicer sequence have a geometry of their own, which the transforms of {image_frame} now include."
        return place_frames(records, image_frame, geometry), note
    return records, (
        "The volume nodes of this Slicer sequence have a geometry of their own, which nothing includes: none of the recorded "
        f"transforms is of {image_frame}."
    )
