"""A source whose images say what the axes of a mechanism read: before each goes the pose that follows from it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import Floats
from ...geometry.mechanism import Mechanism
from ...geometry.transform_graph import TransformName, TransformStatus
from ...io.metafile.text_values import NotANumberError, parse_number
from .messages import ImageMessage, StreamMessage, TransformMessage
from .sources import MessageSource, StreamStatistics


class JointSource:
    """Another source's messages, with a transform before each image.

    Parameters
    ----------
    source : MessageSource
    mechanism : Mechanism
        Its axes are called as the fields in the images' metadata, and read mm and degrees.
    name : TransformName
        What the poses are, as in ``ProbeToBase``.

    Notes
    -----
    A pose has the time of its image to the last bit, so it is taken as it is. Where a field is missing or no number, its status is MISSING.
    """

    def __init__(self, source: MessageSource, mechanism: Mechanism, name: TransformName):
        self._source, self._mechanism, self._name = source, mechanism, name
        self._image: ImageMessage | None = None

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
        if not isinstance(message, ImageMessage):
            return message
        self._image = message
        amounts = self._amounts({name.lower(): text for name, text in message.metadata.items()})
        matrix = self._mechanism.poses(amounts[None])[0]
        status = TransformStatus.OK if np.isfinite(matrix).all() else TransformStatus.MISSING
        return TransformMessage(str(self._name), message.timestamp, matrix, status, received=message.received, header_version=2)

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Those of the other source, and the poses."""
        return {**self._source.devices(), str(self._name): ("TRANSFORM",)}

    def _amounts(self, fields: Mapping[str, str]) -> Floats:
        """How far each axis has moved, mm or radians; NaN where the image does not say."""
        amounts = np.full(len(self._mechanism.moving), np.nan)
        for place, axis in enumerate(self._mechanism.moving):
            try:
                amounts[place] = axis.amount(parse_number(fields.get(axis.name.lower(), "nan")))
            except NotANumberError:
                continue
        return amounts
