"""Targets for what a network sends: a stream of OpenIGTLink bytes, and single messages whose checksum is right."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from AIFReconLib.errors import LiveMessageError
from AIFReconLib.live.wire.decoding import USED_TYPES, decode
from AIFReconLib.live.wire.framing import Framer
from AIFReconLib.live.wire.messages import ImageMessage, TransformMessage

from . import seeds
from .target import Target

KINDS = tuple(kind.encode() for kind in (*sorted(USED_TYPES), "POLYDATA", "POINT", "GET_STATUS", "CAPABILITY"))


def _decode_all(messages) -> None:
    for raw in messages:
        for message in decode(raw):
            _check_message(message)


def _check_message(message) -> None:
    assert isinstance(message, ImageMessage | TransformMessage)
    assert isinstance(message.device, str)
    assert np.isfinite(message.timestamp)
    if isinstance(message, ImageMessage):
        assert message.image.ndim == 2
        assert message.image.size > 0
        assert message.image.dtype.isnative
        assert message.image_to_sender.shape == (4, 4)
    if isinstance(message, TransformMessage):
        assert message.matrix.shape == (4, 4)
        assert message.matrix.dtype == np.float64


def _read_stream(path: Path) -> None:
    """The bytes in pieces of every size, as a network gives them; the same messages must come out whatever the pieces."""
    data = path.read_bytes()
    framer, whole = Framer(2**20), Framer(2**20)
    step = 1 + len(data) // 7
    parts = [part for start in range(0, len(data), step) for part in framer.feed(data[start : start + step])]
    together = whole.feed(data)
    assert [part.body for part in parts] == [part.body for part in together]
    framer.describe_pending()
    for raw in parts:
        try:
            _decode_all([raw])
        except LiveMessageError:
            continue  # a message that is refused costs no other


def _read_message(path: Path) -> None:
    _decode_all(Framer(2**20).feed(path.read_bytes()))


def _streams() -> list[bytes]:
    """Several messages in a row, and one in the middle of another."""
    messages = seeds.stream_bodies()
    return [b"".join(messages), messages[0] + messages[3], messages[0][:70] + messages[0] + messages[1]]


LIVE = (
    Target("live-stream", "stream.igtl", _read_stream, _streams, words=KINDS),
    Target("live-message", "message.igtl", _read_message, seeds.stream_bodies, seeds.with_checksum, words=KINDS),
)
