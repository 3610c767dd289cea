"""Sequence files written by hand, so that the tests do not depend on the writer under test."""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path

import numpy as np

from AIFReconLib.sweep.frames import FrameRecord

TYPES = {
    "u1": ("MET_UCHAR", "uint8"),
    "i1": ("MET_CHAR", "int8"),
    "u2": ("MET_USHORT", "uint16"),
    "i2": ("MET_SHORT", "int16"),
    "i4": ("MET_INT", "int32"),
    "f4": ("MET_FLOAT", "float"),
    "f8": ("MET_DOUBLE", "double"),
}
"""In a MetaImage, and in an NRRD file."""

IDENTITY = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
FIELDS = {
    "Seq_Frame0000_ProbeToTrackerTransform": "1 0 0 10.5 0 1 0 -2.25 0 0 1 3e-05 0 0 0 1",
    "Seq_Frame0000_ProbeToTrackerTransformStatus": "OK",
    "Seq_Frame0000_Timestamp": "215.102186",
    "Seq_Frame0000_ImageStatus": "OK",
    "Seq_Frame0001_ProbeToTrackerTransform": IDENTITY,
    "Seq_Frame0001_ProbeToTrackerTransformStatus": "OUT_OF_VIEW",
    "Seq_Frame0001_Timestamp": "215.190114",
    "Seq_Frame0001_ImageStatus": "INVALID",
}


def ramp(dtype: str = "u1", frames: int = 2, rows: int = 3, columns: int = 4, channels: int = 1) -> np.ndarray:
    """Pixels that are all different, (frames, rows, columns[, channels])."""
    shape = (frames, rows, columns, channels) if channels > 1 else (frames, rows, columns)
    return np.arange(np.prod(shape)).astype(dtype).reshape(shape)


def metaimage(
    path: Path,
    pixels: np.ndarray,
    fields: dict[str, str] = FIELDS,
    *,
    compressed: bool = False,
    data: bytes | None = None,
    **changes: str | None,
) -> Path:
    """A .mha file. `changes` replaces header entries; None removes one. `data` replaces the payload as stored."""
    frames, rows, columns = pixels.shape[:3]
    payload = zlib.compress(pixels.tobytes()) if compressed else pixels.tobytes()
    payload = payload if data is None else data
    header = {
        "ObjectType": "Image",
        "NDims": "3",
        "BinaryData": "True",
        "BinaryDataByteOrderMSB": str(pixels.dtype.str[0] == ">"),
        "CompressedData": str(compressed),
        "CompressedDataSize": str(len(payload)) if compressed else None,
        "DimSize": f"{columns} {rows} {frames}",
        "Kinds": "domain domain list",
        "ElementNumberOfChannels": str(pixels.shape[3]) if pixels.ndim == 4 else None,
        "ElementSpacing": "1 1 1",
        "ElementType": TYPES[pixels.dtype.str[1:]][0],
        "UltrasoundImageOrientation": "MFA",
        **fields,
        **changes,
    }
    header["ElementDataFile"] = header.pop("ElementDataFile", "LOCAL")
    lines = [f"{key} = {value}\n" for key, value in header.items() if value is not None]
    path.write_bytes("".join(lines).encode() + payload)
    return path


def single_frame(path: Path, image: np.ndarray, spacing: str = "0.2 0.3 1") -> None:
    """A frame as CustusX and ITK write it: the pixels of a .mhd stand in a file beside it."""
    raw = path.with_suffix(".raw") if path.suffix == ".mhd" else None
    if raw is not None:
        raw.write_bytes(image.tobytes())
    told = {"ElementSpacing": spacing, "ElementDataFile": "LOCAL" if raw is None else raw.name}
    metaimage(path, image[None], told, data=b"" if raw else None, Kinds=None, UltrasoundImageOrientation=None)


def nrrd(
    path: Path,
    pixels: np.ndarray,
    fields: dict[str, str] = FIELDS,
    *,
    compressed: bool = False,
    data: bytes | None = None,
    **changes: str | None,
) -> Path:
    """A .nrrd file, as `metaimage`; underscores in `changes` stand for spaces."""
    frames, rows, columns = pixels.shape[:3]
    payload = gzip.compress(pixels.tobytes()) if compressed else pixels.tobytes()
    payload = payload if data is None else data
    color = pixels.ndim == 4
    header = {
        "dimension": "4" if color else "3",
        "encoding": "gz" if compressed else "raw",
        "endian": "big" if pixels.dtype.str[0] == ">" else "little",
        "kinds": "vector domain domain list" if color else "domain domain list",
        "sizes": f"{f'{pixels.shape[3]} ' if color else ''}{columns} {rows} {frames}",
        "type": TYPES[pixels.dtype.str[1:]][1],
        **{key.replace("_", " "): value for key, value in changes.items()},
    }
    lines = [f"{key}: {value}\n" for key, value in header.items() if value is not None]
    pairs = [f"{key}:={value}\n" for key, value in {"ultrasound image orientation": "MFA", **fields}.items()]
    path.write_bytes(b"NRRD0004\n# made by hand\n" + "".join(lines + pairs).encode() + b"\n" + payload)
    return path


def assert_same_records(actual: list[FrameRecord], expected: list[FrameRecord]) -> None:
    """To the last bit."""
    for a, b in zip(actual, expected, strict=True):
        assert {**vars(a), "transforms": {}} == {**vars(b), "transforms": {}}
        assert list(a.transforms) == list(b.transforms)
        for name, sample in b.transforms.items():
            assert a.transforms[name].status is sample.status
            np.testing.assert_array_equal(a.transforms[name].matrix, sample.matrix)
