"""Where one image of a stream lies, from what the stream says of its transforms, and whether that can be believed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...arrays import Matrix
from ...errors import TransformError
from ...geometry.transform_graph import TransformName, TransformSample, TransformStatus, Ways, capital
from ...message import Sentence, message_of
from ...sweep.configuration import PlusConfiguration
from ...sweep.frame_pose import frame_pose, require_agreement
from ...sweep.poses import chain_ends, image_ways, missing_link
from ..wire.messages import ImageMessage

PROBE = "Probe"
"""Plus's name of the tool that carries the transducer, by which a chain is recognized that no configuration tells."""

STATUS_SUFFIX = "TransformStatus"

LONGEST_NAME = 200
"""Characters in the name of a transform; metadata may hold millions."""

UNCONFIRMED = "pose not confirmed (no transform or status of its tool is sent)"


Placed = tuple[Matrix | None, str, dict[TransformName, TransformSample]]
"""The pose of an image (None without), its status, and all of its transforms."""


def stream_name(text: str) -> TransformName | None:
    """The transform that a device name means; None for a name that is no ``FromToTo``."""
    try:
        name = TransformName.parse(text)
    except TransformError:
        return None
    # A name that would not come back from a sequence file as itself cannot be recorded
    writable = len(text) <= LONGEST_NAME and text.isprintable() and text == text.strip() and not set("=:#\\") & set(text)
    return name if writable and str(name) == capital(text) else None


@dataclass(frozen=True)
class _Tools:
    """The tools that an image's own matrix is made of, and the ways that they are on, where those are known."""

    names: tuple[TransformName, ...] = ()
    ways: Ways | None = None

    def unseen(self, transforms: Mapping[TransformName, TransformSample]) -> tuple[TransformName, ...]:
        """Those without which the matrix is not valid."""
        broken = tuple(name for name in self.names if transforms[name].status is not TransformStatus.OK)
        return () if self.ways is not None and self.ways.without(broken) is not None else broken


class ImagePlacement:
    """Places images.

    Parameters
    ----------
    image_to_reference, reference : str or None
        As in `SynchronizerSettings`.
    uses_image_matrix, trusting : bool
        Whether the matrix that comes with an image may place it, and that without a confirmation.

    Notes
    -----
    An image device named ``<Image>_<Frame>`` brings its own matrix to that frame, which the server computes whether or not it sees
    the tool. So the matrix counts only when the stream says that the tool is seen: by the transform of the image itself
    (ImageToReference), else by every tool on the way from the image, or from the frame called Probe, to that frame; where neither is
    known, by every tool in the image's metadata. Without any of these the pose is not confirmed. Other images are placed by the chain
    of transforms from Image to Reference.
    """

    def __init__(
        self,
        configuration: PlusConfiguration,
        image_to_reference: str | None,
        reference: str | None,
        uses_image_matrix: bool,
        trusting: bool,
    ):
        self.problem: str | None = None
        self._trusting, self._uses_image_matrix = trusting, uses_image_matrix
        self._configured = configuration.transforms
        self._named = image_to_reference
        self.wanted, _ = chain_ends(configuration, image_to_reference, reference)
        self._look_up = lru_cache(100)(self._looked_up)
        self._first: dict[TransformName, Matrix] = {}
        self._moving: set[TransformName] = set()

    def embedded_frame(self, message: ImageMessage) -> str | None:
        """The frame to which the image's own matrix leads; None where it is not used."""
        prefix, _, frame = message.device.rpartition("_")
        if not self._uses_image_matrix or not prefix or not frame[:1].isupper() or frame == self.wanted.source:
            return None
        return frame if stream_name(str(TransformName(self.wanted.source, frame))) else None

    def needed(
        self, message: ImageMessage, sent: Iterable[TransformName], metadata: Iterable[TransformName]
    ) -> frozenset[TransformName] | None:
        """The transforms that decide on the image, of those that are sent and of those in its metadata; None while they are not known."""
        sent, metadata = frozenset(sent), frozenset(metadata)
        names, target = sent | metadata, self.wanted.target
        frame = self._used_frame(message, names)
        if frame is None:
            ways = self._find(self.wanted.source, target, self._fewest(sent, names), self._named)
            return None if ways is None else names & set(ways.names)
        deciding = self._deciding(message, frame, names, metadata)
        if deciding is None:
            return frozenset() if self._trusting and frame == target else None
        onward = None if frame == target else self._find(frame, target, names)
        return names & {*deciding, *(onward.names if onward else ())}

    def place(
        self,
        message: ImageMessage,
        sent: Mapping[TransformName, TransformSample],
        metadata: Mapping[TransformName, TransformSample],
        problems: Mapping[TransformName, str],
    ) -> Placed:
        """The image's pose and status.

        Parameters
        ----------
        sent : dict of TransformName to TransformSample
            Every transform that has come as messages of its own, at the time of the image; MISSING where none belongs to it.
        metadata : dict of TransformName to TransformSample
            Those in the image's metadata.
        problems : dict of TransformName to str
            What is wrong with one of them where its status does not tell.
        """
        # Where a message did not come, the image's metadata tell why, or bring the pose
        transforms = {name: metadata.get(name, s) if s.status is TransformStatus.MISSING else s for name, s in sent.items()}
        transforms = {**metadata, **transforms}
        frame = self._used_frame(message, frozenset(transforms))
        if frame is None:
            fewest = self._fewest(frozenset(sent), frozenset(transforms))
            transforms = {name: sample for name, sample in transforms.items() if name in fewest}
            return self._follow(message, transforms, problems, self._named)
        of_image = TransformName(self.wanted.source, frame)
        status, doubt = self._confirm(message, frame, transforms, frozenset(metadata), problems)
        transforms.pop(of_image.inverse, None)
        transforms[of_image] = TransformSample(message.image_to_sender, status)
        if doubt is not None:
            return None, doubt, transforms
        # The server has followed the other ways
        return self._follow(message, transforms, problems, str(self.wanted) if frame == self.wanted.target else self._named)

    def _used_frame(self, message: ImageMessage, names: frozenset[TransformName]) -> str | None:
        """`embedded_frame`, where a way leads on from there."""
        frame = self.embedded_frame(message)
        leads_on = frame == self.wanted.target or (frame is not None and self._find(frame, self.wanted.target, names) is not None)
        return frame if leads_on else None

    def _fewest(self, sent: frozenset[TransformName], names: frozenset[TransformName]) -> frozenset[TransformName]:
        """The transforms that were sent where they suffice: metadata repeat them in other words."""
        return sent if self._find(self.wanted.source, self.wanted.target, sent, self._named) is not None else names

    def _confirm(
        self,
        message: ImageMessage,
        frame: str,
        transforms: Mapping[TransformName, TransformSample],
        metadata: frozenset[TransformName],
        problems: Mapping[TransformName, str],
    ) -> tuple[TransformStatus, str | None]:
        """Status of the image's own matrix, and what makes it unusable."""
        names = frozenset(transforms)
        if self._deciding(message, frame, names, metadata) is None:
            return (TransformStatus.OK, None) if self._trusting else (TransformStatus.UNKNOWN, UNCONFIRMED)
        tools, of_metadata = self._tools(frame, names, metadata), self._tools(frame, metadata, metadata)
        # A message that was lost says nothing against a pose whose tools the metadata confirm
        confirmed = of_metadata is not None and bool(of_metadata.names) and not of_metadata.unseen(transforms)
        direct = self._direct(message, frame, names)
        enough = {TransformStatus.OK, TransformStatus.MISSING} if confirmed else {TransformStatus.OK}
        bad = [name for name in direct if transforms[name].status not in enough]
        # The tool that was not seen says more than the chain that broke
        culprit = next(iter((*(tools.unseen(transforms) if tools else ()), *bad)), None)
        if culprit is None or (direct and not bad):
            return TransformStatus.OK, None
        status = transforms[culprit].status
        return status, f"{culprit} {problems.get(culprit, status.value)}"

    def _deciding(
        self, message: ImageMessage, frame: str, names: frozenset[TransformName], metadata: frozenset[TransformName]
    ) -> tuple[TransformName, ...] | None:
        """The transforms that tell whether the image's own matrix is valid; None where there are none."""
        tools = self._tools(frame, names, metadata)
        return self._direct(message, frame, names) or (None if tools is None else tools.names)

    def _direct(self, message: ImageMessage, frame: str, names: frozenset[TransformName]) -> tuple[TransformName, ...]:
        """The transforms of the image itself."""
        of_image = {TransformName(self.wanted.source, frame), TransformName(message.device.rpartition("_")[0], frame)}
        return tuple(name for name in names if of_image & {name, name.inverse})

    def _tools(self, frame: str, names: frozenset[TransformName], metadata: frozenset[TransformName]) -> _Tools | None:
        moving = frozenset(name for name in names if self.wanted.source not in (name.source, name.target))
        if frame == PROBE:
            return _Tools()
        for start in (self.wanted.source, PROBE):
            ways = self._find(start, frame, moving)
            if ways is not None:
                return _Tools(tuple(name for name in ways.names if name in moving), ways)
        tools = tuple(sorted(metadata & moving, key=str))
        return _Tools(tools) if tools else None

    def _find(self, source: str, target: str, names: frozenset[TransformName], named: str | None = None) -> Ways | None:
        """The ways from one frame to another, by the transforms of the stream and of the configuration; None where there is none."""
        found = self._look_up(source, target, names, named)
        return found if isinstance(found, Ways) else None

    def _looked_up(self, source: str, target: str, names: frozenset[TransformName], named: str | None) -> Ways | TransformError:
        try:
            return image_ways(TransformName(source, target), named, sorted(names, key=str), self._static(names))
        except TransformError as error:
            return error

    def _static(self, names: Iterable[TransformName]) -> dict[TransformName, TransformSample]:
        """The configuration's transforms but for those that are sent, whichever way round."""
        sent = set(names)
        return {name: sample for name, sample in self._configured.items() if not sent & {name, name.inverse}}

    def _follow(
        self,
        message: ImageMessage,
        transforms: dict[TransformName, TransformSample],
        problems: Mapping[TransformName, str],
        named: str | None,
    ) -> Placed:
        """Follow the ways exactly as for a frame of a recording, so that live and offline agree to the bit."""
        source, target = self.wanted.source, self.wanted.target
        ways = self._look_up(source, target, frozenset(transforms), named)
        if isinstance(ways, TransformError):
            self._tell(message_of(ways), transforms)
            return None, f"nothing says where {source} lies in {target}", transforms
        if not transforms.keys() & set(ways.names):
            self._tell(f"By the configuration alone {source} is fixed to {target}, so all images would lie in one plane.", transforms)
            return None, f"{source} is fixed to {target}", transforms
        pose = frame_pose(ways, transforms, self._static(transforms), source)
        try:
            if pose.loops:
                require_agreement("", message.image.shape[::-1], pose.ways, {0: pose.loops})
        except TransformError as error:
            self.problem = message_of(error)
            return None, f"two ways lead from {source} to {target}, and disagree", transforms
        self.problem = None
        if pose.problem is None:
            return pose.matrix, "OK", transforms
        culprit = next((name for name in problems if pose.problem.startswith(f"{name} ")), None)
        return None, f"{culprit} {problems[culprit]}" if culprit else pose.problem, transforms

    def _tell(self, what: str, transforms: Mapping[TransformName, TransformSample]) -> None:
        """Say what is wrong, and what is missing."""
        for name, sample in transforms.items():
            if sample.status is TransformStatus.OK and not np.array_equal(self._first.setdefault(name, sample.matrix), sample.matrix):
                self._moving.add(name)
        advice: str = missing_link(self.wanted, list(dict.fromkeys([*self._configured, *transforms])), list(self._moving))
        if not transforms:
            advice = (
                "No transforms are sent. Let the server send those of its tools (ProbeToTracker, ReferenceToTracker); an image that "
                f"brings its pose in its own matrix must be called {self.wanted.source}_{self.wanted.target}."
            )
        self.problem = Sentence(f"{what} {advice}", advice)


def metadata_transforms(message: ImageMessage) -> dict[TransformName, TransformSample]:
    """The transforms that an image of header version 2 brings as metadata: ``ProbeToTrackerTransform`` with its ``...Status``."""
    found = {}
    for key, word in message.metadata.items():
        name = stream_name(key.removesuffix(STATUS_SUFFIX)) if key.endswith(STATUS_SUFFIX) else None
        if name is None:
            continue
        try:
            matrix = np.array(message.metadata.get(f"{name}Transform", "").split(), dtype=np.float64).reshape(4, 4)
        except ValueError:
            matrix = np.full((4, 4), np.nan)
        found[name] = TransformSample(matrix, TransformStatus.parse(word))
    return found
