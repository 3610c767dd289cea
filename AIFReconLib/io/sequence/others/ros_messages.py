"""Messages of ROS as images and matrices (sensor_msgs and geometry_msgs, the same in ROS 1 and 2)."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from ....arrays import Matrix, Numbers
from ....errors import SequenceFormatError
from ..decoded_images import library

MILLIMETERS = 1000.0
QUATERNION_TOLERANCE = 0.02
_ENCODINGS = {
    **dict.fromkeys(("mono8", "8UC1"), ("u1", 1, ())),
    **dict.fromkeys(("mono16", "16UC1"), ("u2", 1, ())),
    "16SC1": ("i2", 1, ()),
    "32SC1": ("i4", 1, ()),
    "32FC1": ("f4", 1, ()),
    "64FC1": ("f8", 1, ()),
    "rgb8": ("u1", 3, (0, 1, 2)),
    "8UC3": ("u1", 3, (2, 1, 0)),
    "bgr8": ("u1", 3, (2, 1, 0)),
    "rgba8": ("u1", 4, (0, 1, 2)),
    "bgra8": ("u1", 4, (2, 1, 0)),
    "8UC4": ("u1", 4, (2, 1, 0)),
}
"""Type and number of a pixel's channels, and which are red, green and blue. 8UC3 is OpenCV's, which is blue first."""


def image_of(message: Any, most_bytes: int) -> Numbers:
    """Pixels of a sensor_msgs/Image: (rows, columns), or with three colors."""
    known = _ENCODINGS.get(message.encoding)
    if known is None:
        raise SequenceFormatError(f"images of the encoding {message.encoding!r} are not read. Record them as mono8, mono16 or rgb8.")
    kind, channels, colors = known
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    rows, columns, step = int(message.height), int(message.width), int(message.step)
    row_bytes = columns * channels * dtype.itemsize
    if not 0 < row_bytes <= step or not rows or rows * step > min(most_bytes, len(message.data)):
        raise SequenceFormatError(f"{columns} x {rows} pixels in rows of {step} bytes are not what its {len(message.data)} bytes hold.")
    data = np.frombuffer(message.data, np.uint8, rows * step).reshape(rows, step)[:, :row_bytes]
    pixels = np.ascontiguousarray(data).view(dtype)
    return pixels.reshape(rows, columns, channels)[..., list(colors)] if colors else pixels


def compressed_image(message: Any, most_bytes: int) -> Numbers:
    """Pixels of a sensor_msgs/CompressedImage in PNG or JPEG."""
    data = bytes(message.data)
    with library("PIL.Image", "Compressed images of ROS").open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
        pixels = picture.width * picture.height
        if 4 * pixels > most_bytes:
            raise SequenceFormatError(f"{picture.width} x {picture.height} pixels would take too much memory to read.")
        return np.asarray(picture if picture.mode in ("L", "I;16", "I", "RGB") else picture.convert("RGB"))


def matrix_of(translation: Any, rotation: Any) -> Matrix | None:
    """Translation (m) and quaternion as (4, 4) in mm; None where they are no pose."""
    quaternion = np.array([rotation.x, rotation.y, rotation.z, rotation.w], dtype=np.float64)
    moved = np.array([translation.x, translation.y, translation.z], dtype=np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        length = float(np.linalg.norm(quaternion))
    if not np.isfinite([*quaternion, *moved]).all() or not abs(length - 1.0) <= QUATERNION_TOLERANCE:
        return None
    # By hand: what Slicer's own process imports loads no SciPy
    (*vector, w), matrix = quaternion / length, np.eye(4)
    x, y, z = vector
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix[:3, :3] += 2 * (w * across + across @ across)
    matrix[:3, 3] = MILLIMETERS * moved
    return matrix
