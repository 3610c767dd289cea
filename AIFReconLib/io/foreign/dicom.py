"""Frames from DICOM files: one file per frame, or all frames in one, with what they say of pixel size and time."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Floats, Numbers
from ...errors import FileFormatError
from ..sequence.decoded_images import DecodedImages, decoding, library
from ..sequence.file_images import MAXIMUM_FRAMES
from .images import ImportedImages

if TYPE_CHECKING:
    from pydicom import Dataset

_ENHANCED_US_VOLUME = "1.2.840.10008.5.1.4.1.1.6.2"
_OF_SLICES = ("CT", "MR", "PT", "NM")
"""Kinds of examination whose images are slices of a volume."""

_CENTIMETERS = 3
"""PhysicalUnitsXDirection of an ultrasound region in cm."""

_Size = tuple[tuple[float, float] | None, str | None]
"""Of a pixel, mm; and why it is not known, where the files speak of it."""


def open_dicom(files: list[Path]) -> ImportedImages:
    """The frames of these files, in order of their InstanceNumber where that tells it.

    Raises FileFormatError when a file is no DICOM image, or is compressed in a way that needs another package.
    """
    pydicom = library("pydicom", "DICOM files")
    pixels = library("pydicom.pixels", "DICOM files")
    headers = {path: _header(pydicom, path) for path in files}
    unknown_order = _why_not_in_order(list(headers.values()))
    ordered = list(headers) if unknown_order else sorted(headers, key=lambda path: _number(headers[path]) or 0)
    frames = [(path, frame) for path in ordered for frame in range(_frame_count(headers[path]))]
    single = len(frames) == len(headers)

    def decode(number: int) -> Numbers:
        path, frame = frames[number]
        what = f"{path}, frame {frame}: its pixels cannot be decoded"
        with decoding(what, "Export it uncompressed, or install pylibjpeg[all]."):
            return _as_shown(pixels, headers[path], pixels.pixel_array(path, index=frame))

    stack = DecodedImages(len(frames), decode, lambda n: f"{frames[n][0]}, frame {frames[n][1]}")
    spacing, unknown_spacing = _common_spacing({path: headers[path] for path in ordered})
    names = tuple(path.name for path, _ in frames) if single else None
    # What lies between two files is not known
    times = _times(headers[ordered[0]], len(frames)) if len(headers) == 1 else None
    return ImportedImages(stack, "DICOM frames", names, times, spacing, unknown_spacing, unknown_order)


def _why_not_in_order(headers: list[Dataset]) -> str | None:
    """What keeps InstanceNumber from telling the order of several files; None where it does."""
    numbers, series = set(map(_number, headers)), {header.get("SeriesInstanceUID") for header in headers}
    if len(series) > 1:
        return f"the files are of {len(series)} series, each with an order of its own"
    is_missing = None in numbers and len(headers) > 1
    return "InstanceNumber is missing, or occurs more than once" if is_missing or len(numbers) < len(headers) else None


def _common_spacing(headers: dict[Path, Dataset]) -> _Size:
    """Size of a pixel that all files state, and why there is none, where they state several."""
    found = {path: _spacing(header) for path, header in headers.items()}
    first, (size, _) = next(iter(found.items()))
    for path, (other, problem) in found.items():
        if problem is not None or not _same(size, other):
            return None, f"{path}: {problem}" if problem else f"{first.name} says {_words(size)}, {path.name} says {_words(other)}"
    return size, None


def _same(size: tuple[float, float] | None, other: tuple[float, float] | None) -> bool:
    return np.allclose(size, other, rtol=1e-3, atol=0.0) if size and other else size == other


def _words(spacing: tuple[float, float] | None) -> str:
    return "nothing" if spacing is None else f"{spacing[0]:g} x {spacing[1]:g} mm"


def _as_shown(pixels: ModuleType, header: Dataset, image: Numbers) -> Numbers:
    """Stored values of a frame as the gray levels or colors that they stand for (DICOM PS3.3 C.7.6.3.1.2)."""
    kind = header.get("PhotometricInterpretation")
    if kind == "MONOCHROME1":
        # White is the least value that can be stored, black the largest
        least_and_largest = -1 if int(header.PixelRepresentation) else 2 ** int(header.BitsStored) - 1
        return (least_and_largest - image.astype(np.int64)).astype(image.dtype)
    if kind != "PALETTE COLOR":
        return image
    colors: Numbers = pixels.apply_color_lut(image, header)
    return colors if colors.dtype == np.uint8 else (colors // 256).astype(np.uint8)


def _header(pydicom: ModuleType, path: Path) -> Dataset:
    header: Dataset
    with decoding(f"{path}: it cannot be read as DICOM", "Export it again."):
        header = pydicom.dcmread(path, stop_before_pixels=True)
        # Values are decoded when first asked for, so what is wrong with one shows here
        count, volume = _frame_count(header), _volume(header)
        _ = _times(header, min(count, MAXIMUM_FRAMES)), _spacing(header), _number(header)
    if volume or "Rows" not in header or "Columns" not in header:
        what = f"is a 3D volume of {volume}; frames must be 2D" if volume else "DICOM file holds no image"
        raise FileFormatError(f"{path}: this {what}. Give the images of the sweep.")
    if count > MAXIMUM_FRAMES:
        raise FileFormatError(f"{path}: NumberOfFrames must be at most {MAXIMUM_FRAMES}; got {count}. Export it again.")
    return header


def _volume(header: Dataset) -> str | None:
    """What the slices are, in words, where the file holds those of a volume; None of frames of a sweep."""
    count, modality, apart = _frame_count(header), str(header.get("Modality", "")), header.get("SpacingBetweenSlices")
    if header.get("SOPClassUID") == _ENHANCED_US_VOLUME or any("PlanePositionVolumeSequence" in group for group in _groups(header)):
        return f"{count} slices (Enhanced US Volume)"
    if modality in _OF_SLICES:
        return f"slices ({modality})"
    return f"{count} slices ({float(apart):g} mm apart)" if count > 1 and apart else None


def _groups(header: Dataset) -> list[Dataset]:
    """Functional groups, of all frames and of each."""
    return [group for name in ("Shared", "PerFrame") for group in header.get(f"{name}FunctionalGroupsSequence") or ()]


def _number(header: Dataset) -> int | None:
    value = header.get("InstanceNumber")
    return None if value in (None, "") else int(value)


def _frame_count(header: Dataset) -> int:
    return max(int(header.get("NumberOfFrames") or 1), 1)


def _times(header: Dataset, count: int) -> Floats | None:
    """Times of the frames of one file, in s from its first: FrameTimeVector holds increments in ms, FrameTime one for all."""
    vector, step = header.get("FrameTimeVector"), header.get("FrameTime")
    if vector is not None and count > 1 and len(vector) == count:
        return np.cumsum(np.array(vector, np.float64)) / 1000.0
    return np.arange(count, dtype=np.float64) * float(step) / 1000.0 if step and count > 1 else None


def _spacing(header: Dataset) -> _Size:
    """Size of a pixel in mm: of the ultrasound regions, else PixelSpacing (which lists rows first), also that of the functional groups of
    multi-frame files (PS3.3 C.7.6.16.2.1); None where none is positive.

    Beside it, why what regions say is not that of the whole image, where it is not.
    """
    regions = [
        region
        for region in header.get("SequenceOfUltrasoundRegions") or ()
        if {region.get(f"PhysicalUnits{axis}Direction") for axis in "XY"} == {_CENTIMETERS}
    ]
    measures = [item for group in _groups(header) for item in group.get("PixelMeasuresSequence") or ()]
    spacings = [item.PixelSpacing for item in ([header] if header.get("PixelSpacing") else measures) if item.get("PixelSpacing")]
    sizes = [(abs(10.0 * float(region.PhysicalDeltaX)), abs(10.0 * float(region.PhysicalDeltaY))) for region in regions]
    sizes = sizes or [(float(columns), float(rows)) for rows, columns in spacings]
    sizes = [size for size in sizes if np.isfinite(size).all() and min(size) > 0]
    if not sizes:
        return None, None
    other = next((size for size in sizes if not _same(size, sizes[0])), None)
    if other is not None:
        parts = "image has regions" if regions else "file has frames"
        return None, f"the {parts} of different pixel sizes ({_words(sizes[0])} and {_words(other)})"
    edges = [[region.get(f"RegionLocation{edge}") for edge in ("MinX0", "MinY0", "MaxX1", "MaxY1")] for region in regions]
    boxes = np.array([box for box in edges if None not in box], np.int64).reshape(-1, 4)
    columns, rows = int(header.get("Columns", 0)), int(header.get("Rows", 0))
    around = [*boxes[:, :2].min(axis=0, initial=columns), *boxes[:, 2:].max(axis=0, initial=0)]
    # Some count the last pixel in, some do not
    if len(boxes) and np.abs(np.subtract(around, (0, 0, columns - 1, rows - 1))).max() > 1:
        inside = "columns {} to {} and rows {} to {}".format(*(around[n] for n in (0, 2, 1, 3)))
        return None, f"{_words(sizes[0])} is the size of pixels in {inside}, not of the whole image, of {columns} x {rows} pixels"
    return sizes[0], None
