"""What a Plus server sends for every frame of a recording: the image with its pose, each transform, and their statuses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...arrays import Floats, Integers, Matrix
from ...errors import GeometryError, SettingsError, TransformError
from ...geometry.transform_graph import MISSING, TransformName, TransformSample, TransformStatus, find_ways
from ...geometry.transforms import invert, why_not_affine
from ...sweep.frames import CROPPED, FrameRecord, TrackedSequence
from ...sweep.poses import chain_ends, sweep_poses, time_order
from ..wire.encoding import encode_image, encode_transform, why_not_sendable

SHORTEST_INTERVAL = 1e-3
"""Time between frames whose recorded times are equal, s: messages of one time belong to one frame."""

_FRAME_NUMBER = "FrameNumber"


class ReplayFrames:
    """The frames of a recording as messages, in order of their time.

    Parameters
    ----------
    sequence : TrackedSequence
        Its images are read when their turn comes.
    rate : float or None, frames/s
        By default the recorded times.
    image_to_reference, reference : str or None
        See `sweep_poses`: which chain is embedded in the image message.
    transforms : sequence of str, or None
        Names of the transforms to send, recorded or derived from what is recorded and configured (``ProbeToReference``). By default
        every recorded one, and that of the image.
    valid_only : bool
        Leave out transforms that are not valid, as Plus does by default; otherwise they are sent as identity.

    Attributes
    ----------
    image_device : str
        ``Image_Reference``, or ``Image`` where no chain leads from it to Reference: such an image brings no pose.
    transforms : tuple of TransformName
    offsets : (frames,) float64 array, s
        Time of every frame after the first one, strictly increasing.
    period : float, s
        From the first frame to the first frame of the next round.

    Raises
    ------
    SettingsError
        Without frames, with images that the protocol cannot carry, or when neither a rate nor usable recorded times are there.
    TransformError
        When a transform that was asked for cannot be derived.
    """

    def __init__(
        self,
        sequence: TrackedSequence,
        *,
        rate: float | None = None,
        image_to_reference: str | None = None,
        reference: str | None = None,
        transforms: Sequence[str] | None = None,
        valid_only: bool = True,
    ):
        if len(sequence) == 0:
            raise SettingsError(f"{sequence.name} has no frames to replay. Choose another recording.")
        problem = why_not_sendable(sequence.images.dtype, sequence.frame_size)
        if problem:
            raise SettingsError(f"{sequence.name} cannot be sent over OpenIGTLink: {problem}. Convert the recording.")
        self._sequence = sequence
        self._valid_only = valid_only
        self._order = time_order(sequence)
        self.offsets, self.period = _times(sequence, self._order, rate)
        recorded = sequence.transform_names()
        configured = sequence.configured()
        self._static = {**configured, **sequence.transforms}
        self._known = {*recorded, *configured}
        named = image_to_reference is not None or reference is not None
        image, self._image_path = self._image_chain(image_to_reference, reference, named)
        self.image_device = f"{image.source}_{image.target}" if self._image_path else image.source
        if transforms is None:
            of_image = [image] if self._image_path and image not in recorded and image.inverse not in recorded else []
            self.transforms = (*recorded, *of_image)
        else:
            self.transforms = tuple(TransformName.parse(name) for name in transforms)
        self._paths = {image: self._image_path} if self._image_path else {}
        self._paths.update({name: self._path(name) for name in self.transforms if name not in self._paths})

    def __len__(self) -> int:
        return len(self._order)

    def messages(self, index: int, timestamp: float, version: int) -> bytes:
        """The messages of the frame at an index in time order, all of one timestamp (s since 1970), image first."""
        number = int(self._order[index])
        record = self._sequence.records[number]
        samples = {**self._static, **record.transforms}
        parts = []
        if record.image_status is TransformStatus.OK:
            matrix = self._follow(self._image_path, samples)[0] if self._image_path else np.eye(4)
            metadata = self._metadata(record, timestamp) if version > 1 else None
            image = np.asarray(self._sequence.images[number])
            parts.append(encode_image(self.image_device, timestamp, image, matrix, version=version, metadata=metadata))
        for name in self.transforms:
            matrix, status = self._follow(self._paths[name], samples)
            valid = status is TransformStatus.OK
            if valid or not self._valid_only:
                metadata = {"TransformStatus": status.value, "TransformValid": str(int(valid))} if version > 1 else None
                parts.append(encode_transform(str(name), timestamp, matrix if valid else np.eye(4), version=version, metadata=metadata))
        return b"".join(parts)

    def _image_chain(
        self, image_to_reference: str | None, reference: str | None, named: bool
    ) -> tuple[TransformName, tuple[TransformName, ...]]:
        """The transform that places the image, and the chain that it is made of; no chain where nothing leads there and none was named."""
        image, _ = chain_ends(self._sequence.configuration, image_to_reference, reference)
        try:
            path = sweep_poses(self._sequence, image_to_reference, reference).path
            # As Plus does, for the receiver: what was cropped is told by a transform of its own
            return image, path[1:] if path[0] == CROPPED.inverse else path
        except TransformError:
            if named:
                raise
            return image, ()

    def _path(self, name: TransformName) -> tuple[TransformName, ...]:
        if name in self._known or name.inverse in self._known:
            return (name,)
        return tuple(link.name for link in find_ways(sorted(self._known, key=str), name.source, name.target).path)

    def _follow(self, path: tuple[TransformName, ...], samples: Mapping[TransformName, TransformSample]) -> tuple[Matrix, TransformStatus]:
        """The product along a chain and its status. As in Plus, a status that is not OK does not change the product."""
        matrix, status = np.eye(4), TransformStatus.OK
        for name in path:
            stored = name if name in self._known else name.inverse
            sample = samples.get(stored, MISSING)
            link = TransformStatus.INVALID if sample.status is TransformStatus.OK and why_not_affine(sample.matrix) else sample.status
            status = link if status is TransformStatus.OK else status
            if why_not_affine(sample.matrix):
                return np.eye(4), status
            try:
                matrix = (sample.matrix if stored == name else invert(sample.matrix)) @ matrix
            except GeometryError:
                return np.eye(4), TransformStatus.INVALID if status is TransformStatus.OK else status
        return matrix, status

    def _metadata(self, record: FrameRecord, timestamp: float) -> dict[str, str]:
        """What rides on an image: every recorded transform with its status, the fields of the frame, and the time."""
        metadata = {key: str(value) for key, value in record.fields.items() if key != _FRAME_NUMBER}
        for name, sample in record.transforms.items():
            # Plus writes 6 digits; with all of them a live reconstruction can be compared with one of the recording
            metadata[f"{name}Transform"] = " ".join(map(repr, np.asarray(sample.matrix, dtype=np.float64).ravel().tolist()))
            metadata[f"{name}TransformStatus"] = sample.status.value
        metadata["Timestamp"] = f"{timestamp:.6f}"
        return metadata


def _times(sequence: TrackedSequence, order: Integers, rate: float | None) -> tuple[Floats, float]:
    """Offsets of the frames in order, and the duration of a round, s."""
    count = len(order)
    if rate is not None:
        if not 0.0 < rate <= 1.0 / SHORTEST_INTERVAL:
            raise SettingsError(f"Input rate must be above 0 and at most {1 / SHORTEST_INTERVAL:g} frames/s; got {rate!r}.")
        return np.arange(count) / rate, count / rate
    recorded = [record.timestamp for record in sequence.records if record.timestamp is not None]
    if len(recorded) < len(sequence) or not np.isfinite(recorded).all() or (count > 1 and max(recorded) == min(recorded)):
        raise SettingsError(f"{sequence.name} has no recorded times to follow.", "Give the rate to replay it at ({rate}).")
    times = np.array(recorded)[order]
    intervals = np.maximum(np.diff(times), SHORTEST_INTERVAL)
    offsets = np.concatenate(([0.0], np.cumsum(intervals)))
    usual = float(np.median(intervals)) if count > 1 else 0.1
    return offsets, float(offsets[-1]) + usual
