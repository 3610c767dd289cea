"""Messages as a Plus server sends them, made by hand: what belongs together carries the same time to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from time import monotonic

import numpy as np
from sweeps import image_pose, rigid

from AIFReconLib.geometry.transform_graph import TransformStatus
from AIFReconLib.live.wire.messages import ImageMessage, StreamMessage, TransformMessage
from AIFReconLib.sweep.frames import TrackedSequence

REFERENCE_TO_TRACKER = rigid((0.0, 40.0, 10.0), (100.0, 50.0, -900.0))
SMALL = np.arange(12, dtype=np.uint8).reshape(3, 4)


def image(
    time: float, device: str = "Image_Reference", *, pose=None, pixels=SMALL, metadata=None, received=None, version=1
) -> ImageMessage:
    """An IMAGE; it arrives at its time unless told otherwise."""
    pose = image_pose(translation=(time, 2.0, 3.0)) if pose is None else pose
    return ImageMessage(device, time, pixels, pose, metadata or {}, time if received is None else received, version)


def transform(time: float, name: str, matrix=None, status=TransformStatus.OK, *, received=None, version=1) -> TransformMessage:
    """A TRANSFORM; by default a pose that tells its time."""
    matrix = rigid((10 * time, 5.0, 0.0), (time, 0.0, 0.0)) if matrix is None else matrix
    return TransformMessage(name, time, matrix, status, {}, time if received is None else received, version)


def tracked(time: float, *, probe=True, reference=True, version=1, **options) -> list[StreamMessage]:
    """One frame of a server that sends valid transforms only: image first, then its tools and its own transform."""
    picture = image(time, version=version, **options)
    messages: list[StreamMessage] = [picture]
    if probe:
        messages.append(transform(time, "ProbeToTracker", version=version))
    if reference:
        messages.append(transform(time, "ReferenceToTracker", REFERENCE_TO_TRACKER, version=version))
    if probe and reference:
        messages.append(transform(time, "ImageToReference", picture.image_to_sender, version=version))
    return messages


def metadata(**statuses: str) -> dict[str, str]:
    """What an image of header version 2 tells of the tools: ``ProbeToTracker="OK"``."""
    told = {}
    for name, status in statuses.items():
        told[f"{name}Transform"] = " ".join(str(x) for x in rigid(translation=(1, 2, 3)).ravel())
        told[f"{name}TransformStatus"] = status
    return told


def streamed(sequence: TrackedSequence, device: str = "Image") -> Iterator[StreamMessage]:
    """A recording as a server without an image pose sends it now: the image, then each of its transforms."""
    for number, record in enumerate(sequence.records):
        assert record.timestamp is not None
        received = monotonic()
        yield ImageMessage(device, record.timestamp, sequence.images[number], np.eye(4), {}, received, 2)
        for name, sample in record.transforms.items():
            yield TransformMessage(str(name), record.timestamp, sample.matrix, sample.status, {}, received, 2)
