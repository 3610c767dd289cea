"""Where one image of a stream lies, from what the stream says of its transforms, and whether that can be believed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ...arrays import Matrix, Numbers
from ...errors import TransformError
from ...geometry.transform_graph import TransformName, TransformSample, TransformStatus, Ways, capital
from ...message import said
from ...sweep.configuration import PlusConfiguration
from ...sweep.frames import FrameRecord, TrackedSequence
from ...sweep.poses import chain_ends, image_ways, missing_link, sweep_poses
from ..wire.messages import ImageMessage

PROBE = "Probe"
"""Plus's name of the tool that carries the transducer, by which a chain is recognized that no configuration tells."""

STATUS_SUFFIX = "TransformStatus"

LONGEST_NAME = 200
"""Characters in the name of a transform; metadata may hold millions."""

UNCONFIRMED = "pose not confirmed (no transform or status of its tool is sent)"


@dataclass(frozen=True, eq=False)
class Placed:
    """The pose of an image (None without), its status, and all of its transforms."""

    image_to_reference: Matrix | None
    status: str
    transforms: dict[TransformName, TransformSample]


def stream_name(text: str) -> TransformName | None:
    """The transform that a device name means; None for a name that is no ``FromToTo``."""
    try:
        name = TransformName.parse(text)
    except TransformError:
        return None
    # A name that would not come back from a sequence file as itself cannot be recorded
    writable = len(text) <= LONGEST_NAME and text.isprintable() and text == text.strip() and not set("=:#\\") & set(text)
    return name if writable and str(name) == capital(text) else None


class Placement:
    """Places images.

    Parameters
    ----------
    configuration : PlusConfiguration
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
        self._configuration = configuration
        self._configured = configuration.transforms
        self._named = image_to_reference
        self.wanted, _ = chain_ends(configuration, image_to_reference, reference)
        self._ways: dict[tuple[str, str, frozenset[TransformName], str | None], Ways | None] = {}
        self._first: dict[TransformName, Matrix] = {}
        self._moving: set[TransformName] = set()

    def embedded_frame(self, message: ImageMessage) -> str | None:
        """The frame to which the image's own matrix leads; None where it is not used."""
        prefix, _, frame = message.device.rpartition("_")
        if not self._uses_image_matrix or not prefix or not frame[:1].isupper() or frame == self.wanted.source:
            return None
        return frame if stream_name(str(TransformName(self.wanted.source, frame))) else None

    def _used_frame(self, message: ImageMessage, names: frozenset[TransformName]) -> str | None:
        """`embedded_frame`, where a way leads on from there."""
        frame = self.embedded_frame(message)
        leads_on = frame == self.wanted.target or (frame is not None and self._chain(frame, self.wanted.target, names) is not None)
        return frame if leads_on else None

    def needed(
        self, message: ImageMessage, sent: Iterable[TransformName], told: Iterable[TransformName]
    ) -> frozenset[TransformName] | None:
        """The transforms that decide on the image, of those that are sent and told of; None while they are not known.

        Parameters
        ----------
        message : ImageMessage
        sent : TransformNames that have come as messages of their own
        told : TransformNames in the image's metadata
        """
        sent, told = frozenset(sent), frozenset(told)
        names = sent | told
        frame = self._used_frame(message, names)
        if frame is None:
            chain = self._chain(self.wanted.source, self.wanted.target, self._fewest(sent, names), self._named)
            return None if chain is None else names & set(chain.names)
        deciding = self._deciding(message, frame, names, told)
        if deciding is None:
            return frozenset() if self._trusting and frame == self.wanted.target else None
        if frame == self.wanted.target:
            return names & set(deciding)
        chain = self._chain(frame, self.wanted.target, names)
        return None if chain is None else names & {*deciding, *chain.names}

    def place(
        self,
        message: ImageMessage,
        sent: Mapping[TransformName, TransformSample],
        told: Mapping[TransformName, TransformSample],
        problems: Mapping[TransformName, str],
    ) -> Placed:
        """The image's pose and status.

        Parameters
        ----------
        message : ImageMessage
        sent : dict of TransformName to TransformSample
            Every transform that has come as messages of its own, at the time of the image; MISSING where none belongs to it.
        told : dict of TransformName to TransformSample
            Those in the image's metadata.
        problems : dict of TransformName to str
            What is wrong with one of them where its status does not tell.
        """
        # Where a message did not come, the image's metadata tell why, or bring the pose
        transforms = {name: told.get(name, s) if s.status is TransformStatus.MISSING else s for name, s in sent.items()}
        transforms = {**told, **transforms}
        frame = self._used_frame(message, frozenset(transforms))
        if frame is None:
            fewest = self._fewest(frozenset(sent), frozenset(transforms))
            transforms = {name: sample for name, sample in transforms.items() if name in fewest}
            return self._follow(message.image, transforms, problems, self._named)
        own = TransformName(self.wanted.source, frame)
        status, doubt = self._confirm(message, frame, transforms, frozenset(told), problems)
        transforms.pop(own.inverse, None)
        transforms[own] = TransformSample(message.image_to_sender, status)
        if doubt is not None:
            return Placed(None, doubt, transforms)
        # The server has followed the other ways
        named = str(self.wanted) if frame == self.wanted.target else self._named
        return self._follow(message.image, transforms, problems, named)

    def _fewest(self, sent: frozenset[TransformName], names: frozenset[TransformName]) -> frozenset[TransformName]:
        """The transforms that were sent where they suffice: metadata repeat them in other words."""
        return sent if self._chain(self.wanted.source, self.wanted.target, sent, self._named) is not None else names

    def _confirm(
        self,
        message: ImageMessage,
        frame: str,
        transforms: Mapping[TransformName, TransformSample],
        told: frozenset[TransformName],
        problems: Mapping[TransformName, str],
    ) -> tuple[TransformStatus, str | None]:
        """Status of the image's own matrix, and what makes it unusable."""
        names = frozenset(transforms)
        deciding = self._deciding(message, frame, names, told)
        if deciding is None:
            return (TransformStatus.OK, None) if self._trusting else (TransformStatus.UNKNOWN, UNCONFIRMED)
        broken = self._unseen(self._tools(frame, names, told), transforms)
        of_metadata = self._tools(frame, told, told)
        # A message that was lost says nothing against a pose whose tools the metadata confirm
        confirmed = bool(of_metadata and of_metadata[0]) and not self._unseen(of_metadata, transforms)
        direct = self._direct(message, frame, names)
        enough = {TransformStatus.OK, TransformStatus.MISSING} if confirmed else {TransformStatus.OK}
        bad = [name for name in direct if transforms[name].status not in enough]
        # The tool that was not seen says more than the chain that broke
        culprit = next(iter((*broken, *bad)), None)
        if culprit is None or (direct and not bad):
            return TransformStatus.OK, None
        status = transforms[culprit].status
        return status, f"{culprit} {problems.get(culprit, status.value)}"

    def _deciding(
        self, message: ImageMessage, frame: str, names: frozenset[TransformName], told: frozenset[TransformName]
    ) -> tuple[TransformName, ...] | None:
        """The transforms that tell whether the image's own matrix is valid; None where there are none."""
        tools = self._tools(frame, names, told)
        return self._direct(message, frame, names) or (None if tools is None else tools[0])

    def _direct(self, message: ImageMessage, frame: str, names: frozenset[TransformName]) -> tuple[TransformName, ...]:
        """The transforms of the image itself."""
        own = {TransformName(self.wanted.source, frame), TransformName(message.device.rpartition("_")[0], frame)}
        return tuple(name for name in names if own & {name, name.inverse})

    def _tools(
        self, frame: str, names: frozenset[TransformName], told: frozenset[TransformName]
    ) -> tuple[tuple[TransformName, ...], Ways | None] | None:
        """The tools that the image's own matrix is made of, and the ways that they are on, where those are known."""
        moving = frozenset(name for name in names if self.wanted.source not in (name.source, name.target))
        if frame == PROBE:
            return (), None
        for start in (self.wanted.source, PROBE):
            ways = self._chain(start, frame, moving)
            if ways is not None:
                return tuple(name for name in ways.names if name in moving), ways
        tools = tuple(sorted(told & moving, key=str))
        return (tools, None) if tools else None

    @staticmethod
    def _unseen(
        tools: tuple[tuple[TransformName, ...], Ways | None] | None, transforms: Mapping[TransformName, TransformSample]
    ) -> tuple[TransformName, ...]:
        """Those of the tools without which the matrix is not valid."""
        names, ways = tools or ((), None)
        broken = tuple(name for name in names if transforms[name].status is not TransformStatus.OK)
        return () if ways is not None and ways.without(broken) is not None else broken

    def _chain(self, source: str, target: str, names: frozenset[TransformName], named: str | None = None) -> Ways | None:
        """The ways from one frame to another, by the transforms of the stream and of the configuration; None where there is none."""
        key = (source, target, names, named)
        if key not in self._ways:
            if len(self._ways) > 100:
                self._ways.clear()
            try:
                self._ways[key] = image_ways(TransformName(source, target), named, sorted(names, key=str), self._configured)
            except TransformError:
                self._ways[key] = None
        return self._ways[key]

    def _follow(
        self,
        image: Numbers,
        transforms: dict[TransformName, TransformSample],
        problems: Mapping[TransformName, str],
        named: str | None,
    ) -> Placed:
        """Follow the ways exactly as for one frame of a recording, so that live and offline agree to the bit."""
        ends = {"source": self.wanted.source, "target": self.wanted.target}
        chain = self._chain(self.wanted.source, self.wanted.target, frozenset(transforms), named)
        if chain is None:
            try:
                image_ways(self.wanted, named, transforms, self._configured)
            except TransformError as error:
                self.problem = f"{error} {self._advice(transforms)}"
            return Placed(None, "no transform leads from {source} to {target}".format(**ends), transforms)
        if not transforms.keys() & set(chain.names):
            self.problem = (
                "By the configuration alone {source} is fixed to {target}, so all images would lie in one plane. {advice}".format(
                    advice=self._advice(transforms), **ends
                )
            )
            return Placed(None, "{source} is fixed to {target}".format(**ends), transforms)
        record = FrameRecord(transforms=transforms)
        sequence = TrackedSequence(np.broadcast_to(image, (1, *image.shape)), [record], configuration=self._configuration)
        try:
            poses = sweep_poses(sequence, named, self.wanted.target)
        except TransformError as error:
            self.problem = said(error).removeprefix(f"{sequence.name}: ")
            return Placed(None, "two ways lead from {source} to {target}, and disagree".format(**ends), transforms)
        self.problem = None
        status = poses.problems[0]
        if status is None:
            return Placed(poses.image_to_reference[0], "OK", transforms)
        culprit = next((name for name in problems if status.startswith(f"{name} ")), None)
        what = f"{culprit} {problems[culprit]}" if culprit else status
        return Placed(None, what, transforms)

    def _advice(self, transforms: Mapping[TransformName, TransformSample]) -> str:
        for name, sample in transforms.items():
            if sample.status is TransformStatus.OK and not np.array_equal(self._first.setdefault(name, sample.matrix), sample.matrix):
                self._moving.add(name)
        if not transforms:
            return (
                "No transforms are sent. Let the server send those of its tools (ProbeToTracker, ReferenceToTracker); an image that "
                f"brings its pose in its own matrix must be called {self.wanted.source}_{self.wanted.target}."
            )
        return missing_link(self.wanted, list(dict.fromkeys([*self._configured, *transforms])), list(self._moving))


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
