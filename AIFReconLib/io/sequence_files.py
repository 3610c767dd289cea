"""Tracked ultrasound sequences in files, as the Plus toolkit and Slicer write them: .mha, .mhd with a data file, .nrrd."""

from __future__ import annotations

from pathlib import Path

from ..errors import SequenceFormatError
from ..frames import TrackedSequence
from .file_images import FileImages
from .metafile import read_metafile
from .orientation import is_image_key, required_flips
from .plus_config import PlusConfiguration, read_plus_configuration
from .sequence_fields import split_fields
from .sequence_writer import write_sequence

__all__ = ["read_sequence", "write_sequence"]


def read_sequence(path: str | Path, config: str | Path | PlusConfiguration | None = None) -> TrackedSequence:
    """The sequence in a file.

    Parameters
    ----------
    path : str or Path
        .mha, .mhd, .nrrd or .nhdr, compressed or not.
    config : str, Path, PlusConfiguration or None
        The Plus configuration it was recorded with, which holds the calibration.

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
    """
    metafile = read_metafile(path, SequenceFormatError)
    flip_columns, flip_rows = required_flips(metafile)
    images = FileImages(metafile, flip_columns=flip_columns, flip_rows=flip_rows)
    records, fields, transforms = split_fields(metafile, len(images))
    configuration = read_plus_configuration(config) if isinstance(config, str | Path) else config
    return TrackedSequence(
        images=images,
        records=records,
        fields={key: value for key, value in fields.items() if not is_image_key(key)},
        transforms=transforms,
        configuration=configuration,
        path=Path(path),
    )
