"""Sequence files of every kind that Plus and Slicer write, written byte by byte from the manuals' words, each frame with one bright pixel.

Reader and writer of the library cannot share a mistake with them.
"""

from __future__ import annotations

import gzip

import numpy as np
from sequence_samples import metaimage, nrrd
from sweeps import rigid

from AIFReconLib.sweep.poses import sweep_poses

COLUMNS, ROWS, FRAMES = 7, 5, 3


LANDMARKS = ((2, 1), (5, 3), (4, 0))
"""Column and row of the bright pixel of each frame, in MF orientation."""


DEEP = f"{COLUMNS} {ROWS} 1 {FRAMES}"
IMAGE_TO_PROBE = rigid((3.0, -8.0, 15.0), (4.0, 5.0, 6.0)) @ np.diag([0.25, 0.5, 0.3, 1.0])


REFERENCE_TO_TRACKER = rigid((-20.0, 40.0, 10.0), (100.0, -50.0, 30.0))


PROBE_TO_TRACKER = [rigid((10.0 * n, -5.0, 3.0 * n), (20.0 + n, -3.0 * n, 7.0)) for n in range(FRAMES)]


EXPECTED = np.array(
    [(np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER[n] @ IMAGE_TO_PROBE @ (*LANDMARKS[n], 0.0, 1.0))[:3] for n in range(FRAMES)]
)


def numbers(matrix) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(matrix).ravel())


def pictures(dtype: str = "u1", flips: str = "MF", color: bool = False) -> np.ndarray:
    """Black frames with one bright pixel, as a file of this orientation stores them."""
    stack = np.zeros((FRAMES, ROWS, COLUMNS), dtype)
    for n, (column, row) in enumerate(LANDMARKS):
        stack[n, row if flips[1] == "F" else ROWS - 1 - row, column if flips[0] == "M" else COLUMNS - 1 - column] = 100
    return np.repeat(stack[..., None], 3, axis=3) if color else stack


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


def landmarks_mm(sequence) -> np.ndarray:
    """Where the brightest pixel of each frame lies in Reference, (frames, 3)."""
    placed = sweep_poses(sequence).image_to_reference
    found = [np.unravel_index(int(np.argmax(sequence.images[n])), (ROWS, COLUMNS)) for n in range(len(sequence))]
    return np.array([(placed[n] @ (column, row, 0.0, 1.0))[:3] for n, (row, column) in enumerate(found)])


def header_transforms() -> dict[str, str]:
    """Calibration and reference as transforms of the whole file."""
    fields = {key: value for key, value in poses(with_calibration=False).items() if "ReferenceToTracker" not in key}
    return {"ImageToProbeTransform": numbers(IMAGE_TO_PROBE), "ReferenceToTrackerTransform": numbers(REFERENCE_TO_TRACKER), **fields}


def recorded(path, pixels=None, fields=None, **changes):
    """A sequence file as Plus writes it, by its suffix; its `pixels` and `fields` are the usual ones unless they are given."""
    pixels, fields = pictures() if pixels is None else pixels, poses() if fields is None else fields
    if path.suffix == ".nrrd":
        return nrrd(path, pixels, fields, **changes)
    # Plus does not use that spacing, and neither may anyone else
    return metaimage(path, pixels, fields, **{"ElementSpacing": "0.1 7 1", "Offset": "5 5 5", "AnatomicalOrientation": "RAI", **changes})


IMAGE_TO_REFERENCE = [np.linalg.inv(REFERENCE_TO_TRACKER) @ pose @ IMAGE_TO_PROBE for pose in PROBE_TO_TRACKER]


def slicer_images(path, *, interleaved=False, color=False, compressed=True, times="10 10.1 10.2", unit="s", matrix=None, **attributes):
    """A volume sequence as Slicer's Sequences module writes it; interleaved as it did before 2022."""
    pixels = pictures(color=color)
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
