"""What a live stream hands on: images, transforms and readings as plain values, and events of the connection itself.

Nothing here knows the wire. `decoding` makes messages from bytes, the client hands them out in order of arrival, and whoever takes them
needs no codec.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from ...arrays import Matrix, Numbers
from ...geometry.transform_graph import TransformStatus

EventKind = Literal["connected", "disconnected", "stalled", "dropped", "refused"]


@dataclass(frozen=True, eq=False)
class ImageMessage:
    """One image and the matrix sent with it.

    Parameters
    ----------
    device : str
        Name of the image device, e.g. ``Image_Reference``.
    timestamp : float, s since 1970 (UTC)
        Of the message header. What belongs together carries the same time to the last bit.
    image : (rows, columns) array, read-only
        Pixels as sent, not turned; colors reduced to luminance. In the byte order of the machine.
    image_to_sender : (4, 4) float64 array, pixels to mm
        Pixel (column, row, 0, 1), centers at integers, to the frame that the sender's matrix means (Reference for ``Image_Reference``).
        RAS. May hold NaN or infinities if they were sent.
    metadata : dict of str to str
        Empty for a message of header version 1.
    received : float, s of `time.monotonic`
        When its last byte had arrived.
    """

    device: str
    timestamp: float
    image: Numbers
    image_to_sender: Matrix
    metadata: dict[str, str] = field(default_factory=dict)
    received: float = 0.0
    header_version: int = 1


@dataclass(frozen=True, eq=False)
class TransformMessage:
    """One transform: a pose of a tracker, or of a chain that the server follows.

    Parameters
    ----------
    device : str
        Name of the transform, e.g. ``ProbeToTracker``; cut to 20 bytes by the header, in full for TDATA of Plus.
    timestamp : float, s since 1970 (UTC)
    matrix : (4, 4) float64 array, mm
        As sent; may hold NaN (its status is then INVALID), or the identity that servers send for an invalid tool.
    status : TransformStatus
        From the metadata; OK where there is none, which in header version 1 says nothing about validity.
    metadata : dict of str to str
    received : float, s of `time.monotonic`
    from_quaternion : bool
        It came as a position and a quaternion, which hold no scale.
    """

    device: str
    timestamp: float
    matrix: Matrix
    status: TransformStatus = TransformStatus.OK
    metadata: dict[str, str] = field(default_factory=dict)
    received: float = 0.0
    header_version: int = 1
    from_quaternion: bool = False


@dataclass(frozen=True, eq=False)
class StreamEvent:
    """Something that happened to the stream itself.

    Parameters
    ----------
    kind : str
        ``connected``, ``disconnected`` (also: an attempt to connect failed), ``stalled`` (connected, but nothing arrives),
        ``dropped`` (the reader of the queue was too slow), ``refused`` (a message cannot be used).
    detail : str
        One sentence for the user: what was seen and what is done about it.
    received : float, s of `time.monotonic`
    """

    kind: EventKind
    detail: str
    received: float = 0.0


StreamMessage = ImageMessage | TransformMessage | StreamEvent
