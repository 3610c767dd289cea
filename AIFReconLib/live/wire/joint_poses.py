"""Poses of a mechanism, by what its axes read, in messages or with the images."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...geometry.mechanism import Mechanism
from ...geometry.transform_graph import TransformName, TransformStatus
from ...io.metafile.text_values import NotANumberError, parse_number
from .messages import ImageMessage, ReadingsMessage, StreamMessage, TransformMessage

_DEVICE_NAME = 20
"""Bytes of a device's name in a header."""


class JointPoses:
    """What comes in the place of a message: before an image its transform, and a transform for the readings of a moment.

    Parameters
    ----------
    mechanism : Mechanism
        Its axes are called as the fields in the images' metadata, or as the devices that read them, one each; or the probe's device reads
        all of them in their order. They read mm and degrees.
    name : TransformName
        What the poses are, as in ``ProbeToBase``.

    Notes
    -----
    A pose has the time of its image to the last bit, so it is taken as it is. Where a field is missing or no number, its status is MISSING.
    Readings of several devices make one pose where they have the same time to the last bit. Once messages come, images are not asked.
    """

    def __init__(self, mechanism: Mechanism, name: TransformName):
        self._mechanism, self._name = mechanism, name
        self._by_messages = False
        self._moment: float | None = None
        self._readings: dict[str, float] = {}

    def __call__(self, message: StreamMessage) -> list[StreamMessage]:
        """The message, or what comes in its place, often nothing."""
        if isinstance(message, ReadingsMessage):
            pose = self._pose_of(message)
            return [] if pose is None else [pose]
        if not isinstance(message, ImageMessage) or self._by_messages:
            return [message]
        fields = {name.lower(): _number(text) for name, text in message.metadata.items()}
        return [self._pose(fields, message.timestamp, message.received), message]

    def _pose_of(self, message: ReadingsMessage) -> TransformMessage | None:
        """The pose of a moment, once all axes have been read then."""
        names = [axis.name.lower() for axis in self._mechanism.moving]
        if message.timestamp != self._moment:
            self._moment, self._readings = message.timestamp, {}
        device, probe = message.device.lower(), (str(self._name).lower(), self._name.source.lower())
        if device in probe and len(message.values) == len(names):
            self._readings = dict(zip(names, message.values))
        elif len(message.values) == 1:
            self._readings |= {name: message.values[0] for name in names if name[:_DEVICE_NAME] == device}
        if self._readings.keys() != set(names):
            return None
        self._by_messages = True
        return self._pose(self._readings, message.timestamp, message.received)

    def _pose(self, readings: Mapping[str, float], timestamp: float, received: float) -> TransformMessage:
        amounts = np.array([axis.amount(readings.get(axis.name.lower(), np.nan)) for axis in self._mechanism.moving])
        matrix = self._mechanism.poses(amounts[None])[0]
        status = TransformStatus.OK if np.isfinite(matrix).all() else TransformStatus.MISSING
        return TransformMessage(str(self._name), timestamp, matrix, status, received=received, header_version=2)


def _number(text: str) -> float:
    try:
        return parse_number(text)
    except NotANumberError:
        return float("nan")
