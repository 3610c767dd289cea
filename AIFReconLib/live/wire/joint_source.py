"""A source that says what the axes of a mechanism read, in messages or with its images: from it follow the poses."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...geometry.mechanism import Mechanism
from ...geometry.transform_graph import TransformName, TransformStatus
from ...io.metafile.text_values import NotANumberError, parse_number
from .messages import ImageMessage, ReadingsMessage, StreamMessage, TransformMessage
from .sources import MessageSource, StreamStatistics

_DEVICE_NAME = 20
"""Bytes of a device's name in a header."""


class JointSource:
    """Another source's messages, with a transform before each image, or in place of the readings of each moment.

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

    def __init__(self, source: MessageSource, mechanism: Mechanism, name: TransformName):
        self._source, self._mechanism, self._name = source, mechanism, name
        self._image: ImageMessage | None = None
        self._by_messages = False
        self._moment: float | None = None
        self._readings: dict[str, float] = {}

    @property
    def state(self) -> str:
        """That of the other source."""
        return self._source.state

    @property
    def statistics(self) -> StreamStatistics:
        """Those of the other source."""
        return self._source.statistics

    def start(self) -> None:
        """Begin to receive."""
        self._source.start()

    def stop(self) -> None:
        """Receive no more."""
        self._source.stop()

    def get(self, timeout: float | None = None) -> StreamMessage | None:
        """The next message; see `MessageSource`."""
        if self._image is not None:
            image, self._image = self._image, None
            return image
        message = self._source.get(timeout)
        while isinstance(message, ReadingsMessage):
            pose = self._pose_of(message)
            if pose is not None:
                return pose
            message = self._source.get(timeout)
        if not isinstance(message, ImageMessage) or self._by_messages:
            return message
        self._image = message
        fields = {name.lower(): _number(text) for name, text in message.metadata.items()}
        return self._pose(fields, message.timestamp, message.received)

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Those of the other source, and the poses."""
        return {**self._source.devices(), str(self._name): ("TRANSFORM",)}

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
