"""Messages of a stream become tracked frames: every image with the transforms of its own time, or with the reason why it has no pose.

No thread and no clock: the same messages give the same frames.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field

import numpy as np

from ...errors import SettingsError
from ...geometry.transform_graph import MISSING, TransformName, TransformSample, TransformStatus, capital
from ...message import listed
from ...sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ...sweep.frames import FrameRecord, TrackedFrame
from ..wire.messages import ImageMessage, StreamEvent, StreamMessage, TransformMessage
from .placement import ImagePlacement, metadata_transforms, stream_name
from .pose_history import Answer, PoseHistory

MOST_WAITING = 128
"""Images that wait for their transforms at the same time; then the oldest is decided as it stands."""

MOST_TRANSFORMS = 200
"""Transforms that are followed; a server that makes up ever new names must not fill the memory."""

WHOLE_SECONDS = 5
"""Messages of one time, a whole second, after which a clock that never told anything else counts in seconds."""

REMEMBERED_TIMES = 512
"""Times of placed images, by which those are recognized that a server sends again after a reconnection."""


@dataclass(frozen=True)
class SynchronizerSettings:
    """How messages become frames.

    Parameters
    ----------
    image_device : str or None
        Name of the IMAGE device; the first that sends an image by default.
    image_to_reference, reference : str or None
        The transform that places the image and the frame to reconstruct in, as for `sweep_poses`.
    time_offset : float, s
        Added to the times of images, as Plus's LocalTimeOffsetSec of the image device and `with_time_offset`: an image of time t gets the
        pose of t + time_offset. Other than 0, poses are always interpolated and the matrix that comes with an image is not used.
    longest_gap : float, s
        Two samples of a tracker may be this far apart for a pose between them.
    patience : float, s
        How long after its arrival an image waits for its transforms.
    trust_image_pose : bool
        Use the matrix that comes with an image although nothing in the stream tells whether its tool was seen.
    tracker_frame : str
        Where the poses of tools lead that say no more than the tool's name: ``Probe`` is ProbeToTracker, as in Plus.
    """

    image_device: str | None = None
    image_to_reference: str | None = None
    reference: str | None = None
    time_offset: float = 0.0
    longest_gap: float = 0.1
    patience: float = 0.25
    trust_image_pose: bool = False
    tracker_frame: str = "Tracker"

    def __post_init__(self) -> None:
        for name, least in (("time_offset", -60.0), ("longest_gap", 0.0), ("patience", 0.0)):
            value = getattr(self, name)
            if not least <= value <= 60.0:
                raise SettingsError(f"Input {name} must be from {least:g} to 60 s; got {value!r}.")


@dataclass(frozen=True, eq=False)
class LiveFrame(TrackedFrame):
    """A `TrackedFrame` of a stream. It has its image and record whatever its status, so that all can be recorded.

    Parameters
    ----------
    record : FrameRecord
        Its transforms with their statuses, as a sequence file holds them: `sweep_poses` gives the same pose and status for it.
    received : float, s of `time.monotonic`
        When its image arrived.
    """

    record: FrameRecord = field(default_factory=FrameRecord)
    received: float = 0.0


@dataclass(eq=False)
class _Waiting:
    message: ImageMessage
    time: float
    metadata: dict[TransformName, TransformSample]


class Synchronizer:
    """Pairs images with transforms.

    Parameters
    ----------
    configuration : PlusConfiguration or None
        Gives calibration and other fixed transforms, and the names of the frames.

    Notes
    -----
    An image is decided as soon as what it needs has come: samples of its own time (bit-identical), or, for a tracker whose times are never
    those of an image, a sample behind its time. It is decided without them when each of them has gone on to a later time, or after
    `patience`. Frames come out in the order of their images. A transform that has once come with the time of an image is never
    interpolated afterwards: its absence is how a server says that the tool was not seen. Servers of header version 1 may send the identity
    for a tool that was not seen, so there an exact identity counts as INVALID.
    """

    def __init__(self, settings: SynchronizerSettings | None = None, configuration: PlusConfiguration | None = None):
        self.settings = settings or SynchronizerSettings()
        self.device = self.settings.image_device
        self.frames = self.repeated = self.other_images = 0
        given = self.settings
        # Who spells out a chain wants that one
        by_image = given.time_offset == 0.0 and "," not in (given.image_to_reference or "")
        configuration = configuration or NO_CONFIGURATION
        self._placement = ImagePlacement(configuration, given.image_to_reference, given.reference, by_image, given.trust_image_pose)
        self._waiting: deque[_Waiting] = deque()
        self._arrival = self._image_arrival = 0
        self._whole: dict[str | TransformName, float] = {}
        self._known_times: deque[float] = deque(maxlen=REMEMBERED_TIMES)
        self._begin()

    def _begin(self) -> None:
        """Nothing is known of the server."""
        self._histories: dict[TransformName, PoseHistory] = {}
        self._expected: frozenset[TransformName] = frozenset()
        self._image_time: float | None = None
        self._decided_time: float | None = None
        self._lesser: set[TransformName] = set()
        self._stamps: dict[str | TransformName, float] = {}
        self._times_before = frozenset(self._known_times)

    @property
    def reference(self) -> str:
        """The frame that images are placed in."""
        return self._placement.wanted.target

    @property
    def problem(self) -> str | None:
        """Why images cannot be placed at all, in full; None when they can."""
        return self._placement.problem

    @property
    def note(self) -> str | None:
        """What makes places doubtful although all is well otherwise."""
        coarse = [str(who) for who, count in self._whole.items() if count >= WHOLE_SECONDS]
        if not coarse:
            return None
        return (
            f"The time stamps of {listed(coarse)} are whole seconds, so images may be placed by the pose of a neighbor. Let the sender "
            "stamp with fractions of a second."
        )

    @property
    def deadline(self) -> float | None:
        """When the oldest waiting image has waited long enough, s of `time.monotonic`; None when none waits."""
        return self._waiting[0].message.received + self.settings.patience if self._waiting else None

    def feed(self, message: StreamMessage) -> list[LiveFrame]:
        """Take one message; the answer is the frames that it decides, often none."""
        self._arrival += 1
        frames = []
        if isinstance(message, StreamEvent):
            if message.kind == "connected":
                frames = self._start_over()
        elif isinstance(message, ImageMessage):
            frames = self._take_image(message)
        elif isinstance(message, TransformMessage):
            self._take_transform(message)
        return frames + self.expire(message.received)

    def expire(self, now: float) -> list[LiveFrame]:
        """Frames that are decided at the time `now` (s of `time.monotonic`), those that have waited long enough among them."""
        frames = []
        while self._waiting:
            impatient = now - self._waiting[0].message.received >= self.settings.patience or len(self._waiting) > MOST_WAITING
            frame = self._decide(self._waiting[0], impatient)
            if frame is None:
                break
            self._waiting.popleft()
            frames.append(frame)
        return frames

    def flush(self) -> list[LiveFrame]:
        """Decide every waiting image as it stands: the stream is over."""
        return self.expire(math.inf)

    def _start_over(self) -> list[LiveFrame]:
        """A new connection: what was learned of the server no longer holds."""
        frames = self.flush()
        self._begin()
        return frames

    def _take_image(self, message: ImageMessage) -> list[LiveFrame]:
        if self.device is None:
            self.device = message.device
        if message.device != self.device:
            self.other_images += 1
            return []
        time, frames = self._time_of(message, "images"), []
        if time in self._times_before and message.timestamp != 0.0:
            self.repeated += 1
            return []
        if self._image_time is not None and time < self._image_time:
            # A recording that starts over with its old times: samples of the first round are none of the second
            frames = self.flush()
            for history in self._histories.values():
                history.forget(self._image_arrival)
        self._image_time, self._image_arrival = time, self._arrival
        self._waiting.append(_Waiting(message, time, metadata_transforms(message)))
        return frames

    def _take_transform(self, message: TransformMessage) -> None:
        name = self._name_of(message)
        if name is None or (name not in self._histories and len(self._histories) >= MOST_TRANSFORMS):
            return
        status = message.status
        if status is TransformStatus.OK and message.header_version == 1 and np.array_equal(message.matrix, np.eye(4)):
            status = TransformStatus.INVALID
        history = self._histories.setdefault(name, PoseHistory(self.settings.longest_gap))
        time = self._time_of(message, name)
        history.add(time, TransformSample(message.matrix, status), self._arrival)
        if time == self._image_time and not self._waiting:
            # It came too late for its image; the next one waits for it
            self._expected |= {name}

    def _name_of(self, message: TransformMessage) -> TransformName | None:
        """The transform that a message is about; None where that is not told, or others tell it better.

        A whole matrix under a whole name goes before a tool's name alone, and before a quaternion, which holds no scale.
        """
        name = stream_name(message.device)
        if name is not None and not message.from_quaternion:
            if name in self._lesser:
                self._lesser.remove(name)
                self._histories.pop(name, None)
            return name
        name = name or stream_name(f"{message.device}To{capital(self.settings.tracker_frame)}")
        # None of these holds the size of a pixel, without which no image is placed
        if name is None or self._placement.wanted.source in (name.source, name.target):
            return None
        if name in self._histories and name not in self._lesser:
            return None
        if len(self._histories) < MOST_TRANSFORMS:
            self._lesser.add(name)
        return name

    def _time_of(self, message: ImageMessage | TransformMessage, who: str | TransformName) -> float:
        """The message's time. Servers that do not stamp send 0 again and again: then the time of arrival serves."""
        last, self._stamps[who] = self._stamps.get(who), message.timestamp
        if message.timestamp % 1.0:
            self._whole[who] = -math.inf
        elif message.timestamp == last != 0.0:
            self._whole[who] = self._whole.get(who, 0) + 1
        return message.received if message.timestamp == 0.0 and last == 0.0 else message.timestamp

    def _answer(self, name: TransformName, time: float, with_images: bool, impatient: bool) -> Answer | None:
        """What a transform was at the time of an image; None while it may still come."""
        history = self._histories[name]
        if self.settings.time_offset == 0.0:
            exact = history.exactly_at(time)
            if exact is not None:
                return exact
            if with_images or history.paired:
                return Answer(MISSING) if impatient or history.has_passed(time) else None
        answer = history.between(time + self.settings.time_offset)
        return history.given_up() if answer is None and impatient else answer

    def _decide(self, waiting: _Waiting, impatient: bool) -> LiveFrame | None:
        """The frame of a waiting image; None while something that it needs may still come."""
        message, time = waiting.message, waiting.time
        # Who puts the pose into the image also gives its transforms the image's time
        with_images = self._placement.embedded_frame(message) == self._placement.wanted.target
        answers = {name: self._answer(name, time, with_images, impatient) for name in self._histories}
        if not impatient:
            if self._decided_time is None and len(self._waiting) < 2:
                # What the first image of a connection comes with is known when the next one is there
                return None
            needed = self._placement.needed(message, answers, waiting.metadata)
            # What it could do without is waited for until the next image is there
            wanted = needed if needed is None or len(self._waiting) > 1 else needed | self._expected
            if wanted is None or any(name in answers and answers[name] is None for name in wanted):
                return None
        for history in self._histories.values():
            history.compare(self._decided_time, time)
        self._decided_time = time
        self._expected = frozenset(name for name, answer in answers.items() if answer is not None and answer.exact)
        pose, status, transforms = self._placement.place(
            message,
            {name: MISSING if answer is None else answer.sample for name, answer in answers.items()},
            waiting.metadata,
            {name: answer.problem for name, answer in answers.items() if answer is not None and answer.problem},
        )
        if status == "OK":
            self._known_times.append(time)
        number, self.frames = self.frames, self.frames + 1
        return LiveFrame(
            image=message.image,
            image_to_reference=pose,
            timestamp=time,
            status=status,
            number=number,
            record=FrameRecord(timestamp=time, transforms=transforms, fields={"FrameNumber": str(number)}),
            received=message.received,
        )
