"""Recordings in MetaImage and NRRD files, as the Plus toolkit and Slicer write them."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Set
from pathlib import Path

from ...errors import SequenceFormatError
from ..metafile.metafile import Metafile
from ..metafile.opening import METAIMAGE_SUFFIXES, NRRD_SUFFIXES, read_metafile
from ..metafile.text_values import parse_numbers
from .fields import FRAME_KEY, split_fields, stated_spacing
from .file_images import FileImages
from .kinds import Recorded, RecordingKind
from .orientation import is_image_key, required_flips
from .slicer import is_interleaved, is_slicer_sequence, node_geometry, slicer_records


def _read(path: Path, orientation: str | None) -> Recorded:
    metafile = read_metafile(path, SequenceFormatError)
    flip_columns, flip_rows = required_flips(metafile, orientation)
    images = FileImages(metafile, flip_columns=flip_columns, flip_rows=flip_rows, interleaved=is_interleaved(metafile))
    from_slicer = is_slicer_sequence(metafile)
    records, fields, transforms = split_fields(metafile, len(images), None if from_slicer else _header_spacing(metafile))
    notes: tuple[str, ...] = ()
    if from_slicer:
        records, fields, notes = slicer_records(metafile, records, fields)
    own = {key: value for key, value in fields.items() if not is_image_key(key)}
    return Recorded(images, records, own, transforms, notes, node_geometry(metafile) if from_slicer else None)


def _frame_fields(path: Path) -> Set[str] | None:
    metafile = read_metafile(path, SequenceFormatError)
    names = {found[2] for key in metafile.fields if (found := FRAME_KEY.fullmatch(key))}
    return names if names or is_slicer_sequence(metafile) else None


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


METAFILES = RecordingKind("MetaImage and NRRD of Plus and Slicer", (*METAIMAGE_SUFFIXES, *NRRD_SUFFIXES), _read, _frame_fields)
