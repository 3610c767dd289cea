"""The scan that the soak test streams: images that tell their number, so that each one can be followed to where it went."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from benchmark.live import sweep

from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.live.wire.encoding import encode_image, encode_transform
from AIFReconLib.sweep.frames import TrackedSequence

COLUMNS, ROWS = 128, 96
RATE = 20.0
"""frames/s of simulated time."""

DEVICE, OTHER_DEVICE = "Image_Reference", "Second_Reference"
POSE = "ImageToReference"
TOOLS = ("ProbeToTracker", "ReferenceToTracker")

_MARK = 0xA5A5A5A5


@lru_cache(maxsize=1)
def scan() -> TrackedSequence:
    """The fan of speckle that the live benchmark streams, at a size that lets an hour pass in minutes."""
    return sweep(COLUMNS, ROWS)


def image_to_reference(number: int) -> np.ndarray:
    """Where image `number` lies."""
    records = scan().records
    return records[number % len(records)].transforms[TransformName.parse(POSE)].matrix


def pixels(number: int) -> np.ndarray:
    """Image `number`, (ROWS, COLUMNS) uint8; its first eight pixels hold its number, twice."""
    image = scan().images[number % len(scan().images)].copy()
    image[0, :8].view(np.uint32)[:] = number, number ^ _MARK
    return image


def number_of(image: np.ndarray) -> int | None:
    """The number that an image tells; None if it is not one of the scan, in every pixel."""
    if image.shape != (ROWS, COLUMNS) or image.dtype != np.uint8:
        return None
    number = int(image[0, :4].copy().view(np.uint32)[0])
    return number if np.array_equal(image, pixels(number)) else None


def image_message(number: int, time: float, version: int, device: str = DEVICE, image: np.ndarray | None = None) -> bytes:
    """IMAGE `number`, or another image in its place."""
    return encode_image(device, time, pixels(number) if image is None else image, image_to_reference(number), version=version)


def transform_messages(number: int, time: float, version: int, status: str = "OK") -> list[bytes]:
    """Poses of the tools and of image `number`, as a server sends them that is told to send invalid ones too."""
    metadata = {"TransformStatus": status, "TransformValid": str(int(status == "OK"))}
    # Without metadata, the identity is how a server says that a tool is not seen
    seen = status == "OK"
    pose = image_to_reference(number) if seen else np.eye(4)
    tool = np.diag([1.0, -1.0, -1.0, 1.0]) if seen else np.eye(4)
    named = [*((name, tool) for name in TOOLS), (POSE, pose)]
    return [encode_transform(name, time, matrix, version=version, metadata=metadata) for name, matrix in named]
