"""Frames from DICOM files: one file per frame, or all frames in one, with what they say of pixel size and time."""

from __future__ import annotations

from os import SEEK_CUR
from pathlib import Path
from types import ModuleType
from typing import IO, TYPE_CHECKING

import numpy as np

from ...arrays import Floats, Numbers
from ...errors import FileFormatError
from ...message import Message
from ..sequence.file_images import MAXIMUM_FRAMES
from .bounds import check_pixels, check_scans
from .images import DecodedImages, ImportedImages, decoding, describe_stack, library

if TYPE_CHECKING:
    from pydicom import Dataset

_JPEG = ("1.2.840.10008.1.2.4.5", "1.2.840.10008.1.2.4.6", "1.2.840.10008.1.2.4.70")
"""How the transfer syntaxes of JPEG begin."""

_BEFORE_FRAGMENTS = 12
"""Bytes of tag, kind and length."""

_CENTIMETERS = 3
"""PhysicalUnitsXDirection of an ultrasound region in cm."""


def open_dicom(files: list[Path]) -> ImportedImages:
    """The frames of these files; files of one frame in order of their InstanceNumber where all have one.

    Raises
    ------
    FileFormatError
        When a file is no DICOM image, or is compressed in a way that needs another package.
    """
    pydicom = library("pydicom", Message("DICOM files"))
    pixels = library("pydicom.pixels", Message("DICOM files"))
    headers = [(path, _header(pydicom, path)) for path in files]
    numbers = [getattr(header, "InstanceNumber", None) for _, header in headers]
    if len(headers) > 1 and None not in numbers and len(set(numbers)) == len(numbers):
        headers = [headers[n] for n in np.argsort(np.array(numbers, dtype=np.int64), kind="stable")]
    frames = [(path, frame) for path, header in headers for frame in range(_frame_count(header))]
    single = len(frames) == len(headers)
    header_of = dict(headers)

    def decode(number: int) -> Numbers:
        path, frame = frames[number]
        what = Message("{path}, frame {number}: its pixels cannot be decoded", path=path, number=frame)
        with decoding(what, Message("Export it uncompressed, or install pylibjpeg[all].")):
            return _as_shown(pixels, header_of[path], pixels.pixel_array(path, index=frame))

    stack = DecodedImages(len(frames), decode, lambda n: Message("{path}, frame {number}", path=frames[n][0], number=frames[n][1]))
    first = headers[0][1]
    return ImportedImages(
        stack,
        describe_stack(len(frames), "DICOM frames", stack.shape[1:], stack.dtype),
        tuple(path.name for path, _ in frames) if single else None,
        None if single and len(frames) > 1 else _times(first, len(frames)),
        _spacing(first),
    )


def _as_shown(pixels: ModuleType, header: Dataset, image: Numbers) -> Numbers:
    """Stored values of a frame as the gray levels or colors that they stand for (DICOM PS3.3 C.7.6.3.1.2)."""
    kind = getattr(header, "PhotometricInterpretation", "")
    if kind == "MONOCHROME1":
        # White is the least value that can be stored, black the largest
        least_and_largest = -1 if int(header.PixelRepresentation) else 2 ** int(header.BitsStored) - 1
        return (least_and_largest - image.astype(np.int64)).astype(image.dtype)
    if kind != "PALETTE COLOR":
        return image
    colors: Numbers = pixels.apply_color_lut(image, header)
    return colors if colors.dtype == np.uint8 else (colors.astype(np.uint32) // 256).astype(np.uint8)


def _header(pydicom: ModuleType, path: Path) -> Dataset:
    header: Dataset
    with decoding(Message("{path}: it cannot be read as DICOM", path=path), Message("Export it again.")):
        # pydicom would inflate all of it, whatever that becomes, and then not find its pixels
        if pydicom.filereader.read_file_meta_info(path).get("TransferSyntaxUID") == pydicom.uid.DeflatedExplicitVRLittleEndian:
            raise FileFormatError("{path}: DICOM files that are deflated as a whole are not read. Export it uncompressed.", path=path)
        with open(path, "rb") as file:
            header = pydicom.dcmread(file, stop_before_pixels=True)
            _check_pixels(path, header, file)
        # Values are decoded when first asked for, so what is wrong with one shows here
        count = _frame_count(header)
        _ = _times(header, min(count, MAXIMUM_FRAMES)), _spacing(header), getattr(header, "InstanceNumber", None)
    if count > MAXIMUM_FRAMES:
        raise FileFormatError(
            "{path}: NumberOfFrames must be at most {maximum}; got {count}. Export it again.",
            path=path,
            maximum=MAXIMUM_FRAMES,
            count=count,
        )
    if "Rows" not in header or "Columns" not in header:
        raise FileFormatError("{path}: this DICOM file holds no image. Give the images of the sweep.", path=path)
    return header


def _check_pixels(path: Path, header: Dataset, file: IO[bytes]) -> None:
    """Return if a frame is no larger than one may be, and JPEG has no more scans; the file is at its pixels."""
    rows, columns = (int(getattr(header, name, 0) or 0) for name in ("Rows", "Columns"))
    bits = int(getattr(header, "BitsAllocated", 8) or 8) * int(getattr(header, "SamplesPerPixel", 1) or 1)
    check_pixels(path, columns, rows, -(-bits // 8))
    if getattr(header.file_meta, "TransferSyntaxUID", "").startswith(_JPEG):
        fragments = library("pydicom.encaps", Message("DICOM files"))
        file.seek(_BEFORE_FRAGMENTS, SEEK_CUR)
        count, _ = fragments.parse_fragments(file)
        check_scans(fragments.generate_fragments(file), path, rows * columns, min(_frame_count(header), max(count - 1, 1)))


def _frame_count(header: Dataset) -> int:
    return max(int(getattr(header, "NumberOfFrames", 1) or 1), 1)


def _times(header: Dataset, count: int) -> Floats | None:
    """Times of the frames of one file, in s from its first: FrameTimeVector holds increments in ms, FrameTime one for all."""
    vector = getattr(header, "FrameTimeVector", None)
    if vector is not None and count > 1 and len(vector) == count:
        return np.cumsum(np.array([float(value) for value in vector])) / 1000.0
    step = getattr(header, "FrameTime", None)
    return np.arange(count, dtype=np.float64) * float(step) / 1000.0 if step and count > 1 else None


def _spacing(header: Dataset) -> tuple[float, float] | None:
    """Size of a pixel in mm: of the first ultrasound region, else PixelSpacing (which lists rows first); None where neither is positive."""
    found = _stated_spacing(header)
    return found if found is not None and np.isfinite(found).all() and min(found) > 0 else None


def _stated_spacing(header: Dataset) -> tuple[float, float] | None:
    for region in getattr(header, "SequenceOfUltrasoundRegions", None) or ():
        units = (getattr(region, "PhysicalUnitsXDirection", 0), getattr(region, "PhysicalUnitsYDirection", 0))
        if units == (_CENTIMETERS, _CENTIMETERS):
            return abs(10.0 * float(region.PhysicalDeltaX)), abs(10.0 * float(region.PhysicalDeltaY))
    spacing = getattr(header, "PixelSpacing", None)
    return (float(spacing[1]), float(spacing[0])) if spacing else None
