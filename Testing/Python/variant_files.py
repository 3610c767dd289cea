"""Sequence files of every kind that Plus and Slicer write, written byte by byte from the manuals' words, each frame with one bright pixel.

Reader and writer of the library cannot share a mistake with them.
"""

from __future__ import annotations

import gzip
import zlib
from dataclasses import dataclass, field

import numpy as np
from sweeps import rigid

from AIFReconLib.sweep.poses import sweep_poses

COLUMNS, ROWS, FRAMES = 7, 5, 3


LANDMARKS = ((2, 1), (5, 3), (4, 0))
"""Column and row of the bright pixel of each frame, in MF orientation."""


FLAT = f"{COLUMNS} {ROWS} {FRAMES}"
DEEP = f"{COLUMNS} {ROWS} 1 {FRAMES}"
IMAGE_TO_PROBE = rigid((3.0, -8.0, 15.0), (4.0, 5.0, 6.0)) @ np.diag([0.25, 0.5, 0.3, 1.0])


REFERENCE_TO_TRACKER = rigid((-20.0, 40.0, 10.0), (100.0, -50.0, 30.0))


PROBE_TO_TRACKER = [rigid((10.0 * n, -5.0, 3.0 * n), (20.0 + n, -3.0 * n, 7.0)) for n in range(FRAMES)]


EXPECTED = np.array(
    [(np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER[n] @ IMAGE_TO_PROBE @ (*LANDMARKS[n], 0.0, 1.0))[:3] for n in range(FRAMES)]
)


TYPES = {"u1": "MET_UCHAR", "i2": "MET_SHORT", "u2": "MET_USHORT", "f4": "MET_FLOAT", "f8": "MET_DOUBLE"}


NRRD_TYPES = {"u1": "unsigned char", "i2": "short", "u2": "ushort", "f4": "float", "f8": "double"}


def numbers(matrix) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(matrix).ravel())


def pictures(dtype: str = "u1", flips: str = "MF") -> np.ndarray:
    """Black frames with one bright pixel, as a file of this orientation stores them."""
    stack = np.zeros((FRAMES, ROWS, COLUMNS), dtype)
    for n, (column, row) in enumerate(LANDMARKS):
        stack[n, row if flips[1] == "F" else ROWS - 1 - row, column if flips[0] == "M" else COLUMNS - 1 - column] = 100
    return stack


def poses(prefix="Seq_Frame{n:04d}_", probe="ProbeToTracker", with_calibration=True, times=True) -> dict[str, str]:
    """The usual fields of all frames."""
    fields = {}
    for n in range(FRAMES):
        start = prefix.format(n=n)
        if times:
            fields[f"{start}Timestamp"] = repr(10.0 + 0.1 * n)
        fields[f"{start}{probe}Transform"] = numbers(PROBE_TO_TRACKER[n])
        fields[f"{start}{probe}TransformStatus"] = "OK"
        fields[f"{start}ReferenceToTrackerTransform"] = numbers(REFERENCE_TO_TRACKER)
        fields[f"{start}ReferenceToTrackerTransformStatus"] = "OK"
        if with_calibration:
            fields[f"{start}ImageToProbeTransform"] = numbers(IMAGE_TO_PROBE)
            fields[f"{start}ImageToProbeTransformStatus"] = "OK"
    return fields


@dataclass
class Variant:
    """One file: its header lines in order, its pixels, and how they are stored."""

    pixels: np.ndarray = field(default_factory=pictures)
    fields: dict[str, str] = field(default_factory=poses)
    compressed: bool = False
    changes: dict[str, str | None] = field(default_factory=dict)

    def write_mha(self, path):
        payload = zlib.compress(self.pixels.tobytes()) if self.compressed else self.pixels.tobytes()
        header = {
            "ObjectType": "Image",
            "NDims": "3",
            "AnatomicalOrientation": "RAI",
            "BinaryData": "True",
            "BinaryDataByteOrderMSB": "True" if self.pixels.dtype.str[0] == ">" else "False",
            "CompressedData": "True" if self.compressed else "False",
            "CompressedDataSize": str(len(payload)) + "      " if self.compressed else None,
            "DimSize": f"{COLUMNS} {ROWS} {FRAMES}",
            "ElementSpacing": "0.1 7 1",  # Plus does not use it, and neither may anyone else
            "Offset": "5 5 5",
            "Kinds": "domain domain list",
            "ElementType": TYPES[self.pixels.dtype.str[1:]],
            "UltrasoundImageOrientation": "MFA",
            "UltrasoundImageType": "BRIGHTNESS",
            **self.changes,
            **self.fields,
        }
        lines = [f"{key} = {value}\n" for key, value in header.items() if value is not None] + ["ElementDataFile = LOCAL\n"]
        path.write_bytes("".join(lines).encode() + payload)
        return path

    def write_nrrd(self, path):
        payload = gzip.compress(self.pixels.tobytes()) if self.compressed else self.pixels.tobytes()
        header = {
            "type": NRRD_TYPES[self.pixels.dtype.str[1:]],
            "dimension": "3",
            "sizes": f"{COLUMNS} {ROWS} {FRAMES}",
            "kinds": "domain domain list",
            "encoding": "gzip" if self.compressed else "raw",
            "endian": "big" if self.pixels.dtype.str[0] == ">" else "little",
            **self.changes,
        }
        lines = [f"{key}: {value}\n" for key, value in header.items() if value is not None]
        pairs = [f"{key}:={value}\n" for key, value in self.fields.items()]
        path.write_bytes(("NRRD0004\n# from a test\n" + "".join(lines + pairs) + "\n").encode() + payload)
        return path


def landmarks_mm(sequence) -> np.ndarray:
    """Where the brightest pixel of each frame lies in Reference, (frames, 3)."""
    placed = sweep_poses(sequence).image_to_reference
    found = [np.unravel_index(int(np.argmax(sequence.images[n])), (ROWS, COLUMNS)) for n in range(len(sequence))]
    return np.array([(placed[n] @ (column, row, 0.0, 1.0))[:3] for n, (row, column) in enumerate(found)])


def header_transforms() -> dict[str, str]:
    """Calibration and reference as transforms of the whole file."""
    fields = {key: value for key, value in poses(with_calibration=False).items() if "ReferenceToTracker" not in key}
    return {"ImageToProbeTransform": numbers(IMAGE_TO_PROBE), "ReferenceToTrackerTransform": numbers(REFERENCE_TO_TRACKER), **fields}


def rgb() -> np.ndarray:
    return np.repeat(pictures()[..., None], 3, axis=3)


def time_last(kinds: str | None, size: str, dimensions: str) -> dict[str, str | None]:
    return {"Kinds": kinds, "DimSize": size, "NDims": dimensions}


IMAGE_TO_REFERENCE = [np.linalg.inv(REFERENCE_TO_TRACKER) @ pose @ IMAGE_TO_PROBE for pose in PROBE_TO_TRACKER]


def slicer_images(path, *, interleaved=False, color=False, compressed=True, times="10 10.1 10.2", unit="s", matrix=None, **attributes):
    """A volume sequence as Slicer's Sequences module writes it; interleaved as it did before 2022."""
    pixels = rgb() if color else pictures()
    if interleaved:
        pixels = np.moveaxis(pixels, 0, 2)  # (rows, columns, frames[, channels])
    ijk_to_ras = np.eye(4) if matrix is None else matrix
    ijk_to_lps = np.diag([-1.0, -1.0, 1.0, 1.0]) @ ijk_to_ras
    vectors = " ".join(f"({','.join(map(repr, ijk_to_lps[:3, axis].tolist()))})" for axis in range(3))
    axis, channel = (0, "RGB-color ") if interleaved else (3, "RGB-color ")
    blanks = '"" "" ""'
    sizes = f"{FRAMES} {COLUMNS} {ROWS} 1" if interleaved else DEEP
    header = {
        "type": "unsigned char",
        "dimension": "5" if color else "4",
        "space": "left-posterior-superior",
        "sizes": ("3 " if color else "") + sizes,
        "space directions": ("none " if color else "") + (f"none {vectors}" if interleaved else f"{vectors} none"),
        "kinds": (channel if color else "") + ("list domain domain domain" if interleaved else "domain domain domain list"),
        "labels": ('"" ' if color else "") + (f'"time" {blanks}' if interleaved else f'{blanks} "time"'),
        "units": ('"" ' if color else "") + (f'"{unit}" {blanks}' if interleaved else f'{blanks} "{unit}"'),
        "encoding": "gzip" if compressed else "raw",
        "space origin": f"({','.join(map(repr, ijk_to_lps[:3, 3].tolist()))})",
    }
    pairs = {
        "DataNodeClassName": "vtkMRMLVectorVolumeNode" if color else "vtkMRMLScalarVolumeNode",
        f"axis {axis} index type": "numeric",
        f"axis {axis} index values": times,
        **attributes,
    }
    text = "NRRD0005\n# Complete NRRD file format specification at:\n"
    text += "".join(f"{key}: {value}\n" for key, value in header.items())
    text += "".join(f"{key}:={value}\n" for key, value in pairs.items())
    data = pixels.tobytes()
    path.write_bytes((text + "\n").encode() + (gzip.compress(data) if compressed else data))
    return path


def slicer_transforms(path, name="ImageToReference", matrices=IMAGE_TO_REFERENCE, times=(10.0, 10.1, 10.2), statuses=("OK",) * 3):
    """A transform sequence as Slicer's Sequences module writes it: no images, the last line without an end."""
    lines = ["ObjectType = Image", "NDims = 3", "AnatomicalOrientation = RAI", "BinaryData = True", "CompressedData = False"]
    lines += [f"DimSize = 0 0 {len(matrices)}", "ElementSpacing = 1 1 1", "Offset = 0 0 0", "TransformMatrix = 1 0 0 0 1 0 0 0 1"]
    lines += ["ElementType = MET_UCHAR", "Kinds = domain domain list"]
    for n, matrix in enumerate(matrices):
        lines += [f"Seq_Frame{n:04d}_{name}Transform ={numbers(matrix)}", f"Seq_Frame{n:04d}_{name}TransformStatus = {statuses[n]}"]
        if times is not None:
            lines.append(f"Seq_Frame{n:04d}_Timestamp = {times[n]}")
    path.write_text("\n".join([*lines, "ElementDataFile = LOCAL"]))
    return path
