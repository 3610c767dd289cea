"""Frames from DICOM files: one file per frame, or all frames in one, with what they say of pixel size and time."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Floats, Numbers
from ...errors import FileFormatError
from ..sequence.decoded_images import DecodedImages, decoding, library
from ..sequence.file_images import MAXIMUM_FRAMES
from .images import ImportedImages, describe_stack

if TYPE_CHECKING:
    from pydicom import Dataset

_ENHANCED_US_VOLUME = "1.2.840.10008.5.1.4.1.1.6.2"
_OF_SLICES = ("CT", "MR", "PT", "NM")
"""Kinds of examination whose images are slices of a volume."""

_CENTIMETERS = 3
"""PhysicalUnitsXDirection of an ultrasound region in cm."""


def open_dicom(files: list[Path]) -> ImportedImages:
    """The frames of these files, in order of their InstanceNumber where that tells it.

    Raises FileFormatError when a file is no DICOM image, or is compressed in a way that needs another package.
    """
    pydicom = library("pydicom", "DICOM files")
    pixels = library("pydicom.pixels", "DICOM files")
    headers = [(path, _header(pydicom, path)) for path in files]
    unknown_order = _why_not_in_order([header for _, header in headers])
    if unknown_order is None:
        headers.sort(key=lambda pair: _number(pair[1]) or 0)
    frames = [(path, frame) for path, header in headers for frame in range(_frame_count(header))]
    single = len(frames) == len(headers)
    header_of = dict(headers)

    def decode(number: int) -> Numbers:
        path, frame = frames[number]
        what = f"{path}, frame {frame}: its pixels cannot be decoded"
        with decoding(what, "Export it uncompressed, or install pylibjpeg[all]."):
            return _as_shown(pixels, header_of[path], pixels.pixel_array(path, index=frame))

    stack = DecodedImages(len(frames), decode, lambda n: f"{frames[n][0]}, frame {frames[n][1]}")
    spacing, unknown_spacing = _common_spacing(headers)
    return ImportedImages(
        stack,
        describe_stack(len(frames), "DICOM frames", stack.shape[1:], stack.dtype),
        tuple(path.name for path, _ in frames) if single else None,
        # What lies between two files is not known
        _times(headers[0][1], len(frames)) if len(headers) == 1 else None,
        spacing,
        unknown_spacing,
        unknown_order,
    )


def _why_not_in_order(headers: list[Dataset]) -> str | None:
    """What keeps InstanceNumber from telling the order of several files; None where it does."""
    numbers = [_number(header) for header in headers]
    series = {getattr(header, "SeriesInstanceUID", None) for header in headers}
    if len(headers) == 1:
        return None
    if None in numbers:
        return f"InstanceNumber is missing in {numbers.count(None)} of {len(headers)} files"
    if len(series) > 1:
        return f"the files are of {len(series)} series, each with an order of its own"
    twice = next((number for number, count in Counter(numbers).items() if count > 1), None)
    return None if twice is None else f"InstanceNumber {twice} occurs more than once"


def _common_spacing(headers: list[tuple[Path, Dataset]]) -> tuple[tuple[float, float] | None, str | None]:
    """Size of a pixel that all files state, and why there is none, where they state several."""
    found = [_spacing(header) for _, header in headers]
    for (path, _), (spacing, problem) in zip(headers, found):
        if problem is not None:
            return None, f"{path}: {problem}"
        first = found[0][0]
        if (spacing is None) != (first is None) or (spacing and first and not np.allclose(spacing, first, rtol=1e-3, atol=0.0)):
            return None, f"{headers[0][0].name} says {_words(first)}, {path.name} says {_words(spacing)}"
    return found[0]


def _words(spacing: tuple[float, float] | None) -> str:
    return "nothing" if spacing is None else f"{spacing[0]:g} x {spacing[1]:g} mm"


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
    with decoding(f"{path}: it cannot be read as DICOM", "Export it again."):
        # pydicom would inflate all of it, whatever that becomes, and then not find its pixels
        if pydicom.filereader.read_file_meta_info(path).get("TransferSyntaxUID") == pydicom.uid.DeflatedExplicitVRLittleEndian:
            raise FileFormatError(f"{path}: DICOM files that are deflated as a whole are not read. Export it uncompressed.")
        header = pydicom.dcmread(path, stop_before_pixels=True)
        _check_frames(path, header)
        # Values are decoded when first asked for, so what is wrong with one shows here
        count = _frame_count(header)
        _ = _times(header, min(count, MAXIMUM_FRAMES)), _spacing(header), _number(header)
    if count > MAXIMUM_FRAMES:
        raise FileFormatError(f"{path}: NumberOfFrames must be at most {MAXIMUM_FRAMES}; got {count}. Export it again.")
    if "Rows" not in header or "Columns" not in header:
        raise FileFormatError(f"{path}: this DICOM file holds no image. Give the images of the sweep.")
    return header


def _check_frames(path: Path, header: Dataset) -> None:
    """Return if the file holds frames of a sweep, not slices of a volume."""
    groups = [*_groups(header, "SharedFunctionalGroupsSequence"), *_groups(header, "PerFrameFunctionalGroupsSequence")[:1]]
    modality = str(getattr(header, "Modality", ""))
    what = None
    if getattr(header, "SOPClassUID", "") == _ENHANCED_US_VOLUME or any("PlanePositionVolumeSequence" in group for group in groups):
        what = f"{_frame_count(header)} slices (Enhanced US Volume)"
    elif modality in _OF_SLICES:
        what = f"slices ({modality})"
    elif _frame_count(header) > 1 and getattr(header, "SpacingBetweenSlices", None):
        what = f"{_frame_count(header)} slices ({float(header.SpacingBetweenSlices):g} mm apart)"
    if what is not None:
        raise FileFormatError(f"{path}: this is a 3D volume of {what}; frames must be 2D. Give the images of the sweep.")


def _groups(header: Dataset, name: str) -> list[Dataset]:
    return list(getattr(header, name, None) or ())


def _number(header: Dataset) -> int | None:
    value = getattr(header, "InstanceNumber", None)
    return None if value in (None, "") else int(value)


def _frame_count(header: Dataset) -> int:
    return max(int(getattr(header, "NumberOfFrames", 1) or 1), 1)


def _times(header: Dataset, count: int) -> Floats | None:
    """Times of the frames of one file, in s from its first: FrameTimeVector holds increments in ms, FrameTime one for all."""
    vector = getattr(header, "FrameTimeVector", None)
    if vector is not None and count > 1 and len(vector) == count:
        return np.cumsum(np.array([float(value) for value in vector])) / 1000.0
    step = getattr(header, "FrameTime", None)
    return np.arange(count, dtype=np.float64) * float(step) / 1000.0 if step and count > 1 else None


def _spacing(header: Dataset) -> tuple[tuple[float, float] | None, str | None]:
    """Size of a pixel in mm: of the ultrasound regions, else PixelSpacing (which lists rows first), also that of the functional groups of
    multi-frame files (PS3.3 C.7.6.16.2.1); None where none is positive.

    Beside it, why what regions say is not that of the whole image, where it is not.
    """
    regions = [
        region
        for region in getattr(header, "SequenceOfUltrasoundRegions", None) or ()
        if {getattr(region, f"PhysicalUnits{axis}Direction", 0) for axis in "XY"} == {_CENTIMETERS}
    ]
    spacings = [spacing] if (spacing := getattr(header, "PixelSpacing", None)) else _measured(header)
    sizes = [(abs(10.0 * float(region.PhysicalDeltaX)), abs(10.0 * float(region.PhysicalDeltaY))) for region in regions]
    sizes = sizes or [(float(spacing[1]), float(spacing[0])) for spacing in spacings]
    sizes = [size for size in sizes if np.isfinite(size).all() and min(size) > 0]
    if not sizes:
        return None, None
    other = next((size for size in sizes if not np.allclose(size, sizes[0], rtol=1e-3, atol=0.0)), None)
    if other is not None:
        parts = "image has regions" if regions else "file has frames"
        return None, f"the {parts} of different pixel sizes ({_words(sizes[0])} and {_words(other)})"
    columns, rows = int(getattr(header, "Columns", 0)), int(getattr(header, "Rows", 0))
    boxes = [box for region in regions if (box := _box(region)) is not None]
    if not boxes:
        return sizes[0], None
    left, top, right, bottom = (edge(box[n] for box in boxes) for n, edge in enumerate((min, min, max, max)))
    # Some count the last pixel in, some do not
    if abs(left) > 1 or abs(top) > 1 or not columns - 2 <= right <= columns or not rows - 2 <= bottom <= rows:
        return None, (
            f"{_words(sizes[0])} is the size of pixels in columns {left} to {right} and rows {top} to {bottom}, which are not those of "
            f"the image, of {columns} x {rows} pixels"
        )
    return sizes[0], None


def _measured(header: Dataset) -> list[list[float]]:
    """PixelSpacing of all frames together, or of each."""
    groups = [*_groups(header, "SharedFunctionalGroupsSequence"), *_groups(header, "PerFrameFunctionalGroupsSequence")]
    measures = [item for group in groups for item in _groups(group, "PixelMeasuresSequence")]
    return [list(spacing) for item in measures if (spacing := getattr(item, "PixelSpacing", None))]


def _box(region: Dataset) -> tuple[int, ...] | None:
    """First column and row, last column and row of a region; None where it does not say."""
    values = [getattr(region, f"RegionLocation{edge}", None) for edge in ("MinX0", "MinY0", "MaxX1", "MaxY1")]
    return None if None in values else tuple(int(value) for value in values if value is not None)
