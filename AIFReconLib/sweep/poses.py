"""Where every frame of a sequence lies, and why a frame cannot be used.

The ways from Image to Reference are looked up once for the whole sequence and then followed frame by frame, so that a tool that was
out of view in some frames costs those frames and no others. Several ways are one where they agree in every frame.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Integers, Matrix
from ..errors import GeometryError, NoUsableFramesError, TransformError
from ..geometry.transform_graph import (
    TransformName,
    TransformStatus,
    Ways,
    connected,
    find_ways,
)
from ..message import Sentence, listed, message_of
from ..remedies import MISSING_LINK, TRANSFORM_SEQUENCES
from .configuration import PlusConfiguration
from .frame_pose import frame_pose, require_agreement
from .frames import CROPPED, TrackedFrame, TrackedSequence
from .multi_sweep import JoinedSequence, names_of
from .pixel_size import about_pixel_size, implausible_extent, implausible_places, implausible_size
from .still_images import STILL, StillImages, are_equal

FARTHEST_APART = 1000.0
"""mm between two sweeps that no patient's spine spans."""

FRAMES_COMPARED = 8
"""By which a recording is known whose images are all equal."""

MOST_RUNS = 4
"""Of frames in a row that are told by their numbers."""


@dataclass(frozen=True, eq=False)
class SweepPoses:
    """The poses of a sequence."""

    image_to_reference: Matrix  #: (frames, 4, 4), pixels to mm. NaN where the frame cannot be used.
    problems: tuple[str | None, ...]
    """One per frame; why it cannot be used: ``"ProbeToTracker OUT_OF_VIEW"``, ``"no image (MISSING)"``."""
    path: tuple[TransformName, ...]  #: The chain that was followed; of several that agree, the shortest
    notes: tuple[str, ...] = ()  #: What a user should know about the choice

    @property
    def usable(self) -> Integers:
        """The numbers of the frames that have an image and a valid pose, in file order."""
        return np.array([i for i, problem in enumerate(self.problems) if problem is None], dtype=np.int64)

    def skipped(self) -> dict[str, list[int]]:
        """Numbers of the frames that cannot be used, by reason."""
        reasons: dict[str, list[int]] = {}
        for number, problem in enumerate(self.problems):
            if problem is not None:
                reasons.setdefault(problem, []).append(number)
        return reasons

    def require_usable(self, name: str) -> Integers:
        """`usable`, or an error that says why there is none."""
        usable = self.usable
        if not usable.size:
            reasons = describe_skipped(self.skipped()) or "it has no frames"
            raise NoUsableFramesError(f"{name}: no frame has a position ({reasons}). Check the tracking of this recording.")
        return usable


def chain_ends(configuration: PlusConfiguration, image_to_reference: str | None, reference: str | None) -> tuple[TransformName, bool]:
    """The transform to look up, and whether the caller named it: options first, then the configuration, then Plus's usual names."""
    if image_to_reference is not None:
        ends = ends_of(image_to_reference)
        return TransformName(ends.source, reference or ends.target), True
    source = configuration.image_frame or "Image"
    target = reference or configuration.reference_frame or "Reference"
    return TransformName(source, target), False


def ends_of(image_to_reference: str) -> TransformName:
    """What is named: ImageToReference, or from where to where the chain leads that is spelled out as ImageToProbe,ProbeToReference."""
    chain = _spelled(image_to_reference)
    here = chain[0].source
    for name in chain:
        here = name.source if here == name.target else name.target
    return TransformName(chain[0].source, here)


def _spelled(image_to_reference: str) -> tuple[TransformName, ...]:
    if not isinstance(image_to_reference, str):
        return (TransformName.parse(image_to_reference),)
    return tuple(TransformName.parse(name.strip()) for name in image_to_reference.split(","))


def image_ways(
    wanted: TransformName, image_to_reference: str | None, told: Iterable[TransformName], configured: Iterable[TransformName]
) -> Ways:
    """The ways that place an image, over what a recording or stream tells and the configuration holds; see `chain_ends`, `sweep_poses`.

    Where it was cropped, they begin with its own pixels.
    """
    told = tuple(told)
    names = tuple(dict.fromkeys([*configured, *told]))
    if image_to_reference is not None:
        chain = _spelled(image_to_reference)
        # What is named is used alone, whatever other ways there are
        if len(chain) > 1 or {wanted, wanted.inverse} & {*told}:
            chain = chain if len(chain) > 1 else (wanted,)
            names = tuple(name for name in names if name in chain or (name.inverse in chain and name.inverse not in names))
    cropped = tuple(name for name in (CROPPED, CROPPED.inverse) if name in told)
    if cropped and wanted.source == CROPPED.source:
        return find_ways(dict.fromkeys([*names, *cropped]), CROPPED.target, wanted.target)
    return find_ways(names, wanted.source, wanted.target)


def sweep_poses(sequence: TrackedSequence, image_to_reference: str | None = None, reference: str | None = None) -> SweepPoses:
    """Find the image's place in every frame.

    Raises TransformError when no chain leads from image to reference, or two that disagree in some frame; GeometryError,
    NoUsableFramesError when sweeps that were joined are plainly not in one frame, or one of them has no frame that can be placed.

    Parameters
    ----------
    sequence : TrackedSequence
        Its configuration, if any, contributes calibration and other static transforms.
    image_to_reference : str or None
        The transform that places the image. When the recording holds one of that very name it is used alone, whatever other paths
        there are; else it is looked up as a chain, or spelled out as one: ``ImageToProbe,ProbeToReference``. Default: from the
        configuration's image frame to its reference frame.
    reference : str or None
        Frame to reconstruct in, e.g. "Tracker" when there is no reference marker.
    """
    if isinstance(sequence, JoinedSequence):
        return _joined_poses(sequence, image_to_reference, reference)
    wanted, _ = chain_ends(sequence.configuration, image_to_reference, reference)
    recorded = sequence.transform_names()
    configured = sequence.configured()
    notes = list(sequence.notes)
    both = [name for name in sequence.configuration.transforms if name not in configured]
    notes += [f"{name} is in the recording and in the configuration; the recording's is used." for name in both]
    ways = _find_ways(sequence, wanted, image_to_reference, recorded, configured)
    if ways.path[0].name == CROPPED.inverse:
        notes.append(
            f"The recording says that its images were cropped ({CROPPED}), and is placed so. A configuration's clip rectangle, fan "
            "and transducer center are taken as those of the images as they are."
        )
    static = {**configured, **sequence.transforms}
    count = len(sequence)
    matrices = np.full((count, 4, 4), np.nan)
    problems: list[str | None] = []
    stated = np.full((count, 2), np.nan)
    pairs: dict[Ways, dict[int, Sequence[Matrix]]] = {}
    for number, record in enumerate(sequence.records):
        if record.stated_spacing is not None:
            stated[number] = record.stated_spacing
        if record.image_status is not TransformStatus.OK:
            problems.append(f"no image ({record.image_status.value})")
            continue
        pose = frame_pose(ways, record.transforms, static, wanted.source)
        problems.append(pose.problem)
        if pose.matrix is not None:
            matrices[number] = pose.matrix
        if pose.loops:
            pairs.setdefault(pose.ways, {})[number] = pose.loops
    for seen, frames in pairs.items():
        require_agreement(f"{sequence.name}: ", sequence.frame_size, seen, frames)
    path = tuple(link.name for link in ways.path)
    numbers = np.flatnonzero([problem is None for problem in problems])
    placed, (columns, rows) = matrices[numbers], sequence.frame_size
    asked = [about(placed, sequence.frame_size) for about in (implausible_size, implausible_extent)] if len(placed) else []
    asked.append(implausible_places(placed[:, :3] @ (columns / 2, rows / 2, 0.0, 1.0), numbers))
    doubts = [f"WARNING: {doubt}" for doubt in asked if doubt is not None][:1]
    return SweepPoses(matrices, tuple(problems), path, (*notes, *doubts, *about_pixel_size(stated, wanted, matrices)))


def poses_of_each(sequences: Sequence[TrackedSequence], image_to_reference: str | None, reference: str | None) -> list[SweepPoses]:
    """The poses of each of several sweeps in one frame; the arguments are those of `sweep_poses`.

    Raises GeometryError, NoUsableFramesError when they are plainly not in one frame, or one of them has no frame that can be placed.
    """
    found: list[SweepPoses] = []
    boxes: list[tuple[Matrix, Matrix]] = []
    names = names_of(sequences)
    targets = [chain_ends(sequence.configuration, image_to_reference, reference)[0].target for sequence in sequences]
    for sequence, name, target in zip(sequences, names, targets, strict=True):
        if target != targets[0]:
            raise GeometryError(
                f"{names[0]} would be placed in {targets[0]}, and {name} in {target}. Choose another reference frame, one that both know."
            )
        poses = sweep_poses(sequence, image_to_reference, reference)
        columns, rows = sequence.frame_size
        middles = poses.image_to_reference[poses.require_usable(name), :3] @ (columns / 2, rows / 2, 0.0, 1.0)
        low, high = middles.min(axis=0), middles.max(axis=0)
        gaps = [float(np.linalg.norm(np.maximum(0, np.maximum(below - high, low - above)))) for below, above in boxes]
        if gaps and min(gaps) > FARTHEST_APART:
            raise GeometryError(
                f"{names[int(np.argmin(gaps))]} and {name} lie {min(gaps):.0f} mm apart, so they are not in one {target}: was its "
                "marker moved, or is it another patient? Take them one by one."
            )
        found.append(poses)
        boxes.append((low, high))
    return found


def _joined_poses(sequence: JoinedSequence, image_to_reference: str | None, reference: str | None) -> SweepPoses:
    """Those of every sweep by its own transforms, one after the other."""
    of_each = poses_of_each(sequence.sweeps, image_to_reference, reference)
    return SweepPoses(
        np.concatenate([poses.image_to_reference for poses in of_each]),
        tuple(problem for poses in of_each for problem in poses.problems),
        of_each[0].path,
        tuple(dict.fromkeys([*sequence.notes, *(note for poses in of_each for note in poses.notes)])),
    )


def tracked_frames(
    sequence: TrackedSequence, poses: SweepPoses, numbers: Iterable[int], still: StillImages | None = None
) -> Iterator[TrackedFrame]:
    """The frames with these numbers, one after the other, images read when asked for.

    `still` tells images that stand still while the probe moves, where it is given and the numbers are in the order of time.
    """
    timestamps = sequence.timestamps
    for number in numbers:
        problem = poses.problems[number]
        frame = TrackedFrame(
            image=sequence.images[number] if problem is None else None,
            image_to_reference=poses.image_to_reference[number] if problem is None else None,
            timestamp=float(number if np.isnan(timestamps[number]) else timestamps[number]),
            status=problem or "OK",
            number=number,
        )
        yield frame if still is None else still.judged(frame)


def still_images_of(sequence: TrackedSequence, poses: SweepPoses, numbers: Iterable[int]) -> StillImages:
    """What finds images that stand still among these frames; where all are equal, as a few of them tell, it finds none."""

    def all_equal() -> bool:
        placed = [number for number in numbers if poses.problems[number] is None]
        few = (placed[n] for n in np.unique(np.linspace(0, len(placed) - 1, FRAMES_COMPARED).astype(int)))
        first = sequence.images[next(few)]
        return all(are_equal(first, sequence.images[number]) for number in few)

    return StillImages(all_equal)


def without_still_images(sequence: TrackedSequence, poses: SweepPoses) -> SweepPoses:
    """The poses with the problem `STILL` where an image stands still while the probe moves; every image is read.

    Raises SequenceFormatError where one cannot be read.
    """
    order = time_order(sequence)
    found = still_images_of(sequence, poses, order)
    still = {frame.number for frame in tracked_frames(sequence, poses, order, found) if frame.status == STILL}
    problems = tuple(STILL if number in still else problem for number, problem in enumerate(poses.problems))
    return replace(poses, problems=problems, notes=(*poses.notes, *found.notes))


def time_order(sequence: TrackedSequence) -> Integers:
    """Frame numbers in order of their timestamps; in file order where a timestamp is missing, and among equal ones.

    Sweeps that were joined follow each other as they were given, whatever their clocks say.
    """
    if len(sequence.sweeps) > 1:
        starts = np.cumsum([0, *map(len, sequence.sweeps[:-1])])
        return np.concatenate([start + time_order(part) for start, part in zip(starts, sequence.sweeps, strict=True)])
    timestamps = sequence.timestamps
    return np.argsort(timestamps, kind="stable") if np.isfinite(timestamps).all() else np.arange(len(sequence))


def describe_frames(numbers: Sequence[int]) -> str:
    """Frame numbers in words: ``12 frames (0-8, 11, 13-14)``."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    spelled = [str(a) if a == b else f"{a}-{b}" for a, b in runs[:MOST_RUNS]]
    which = ", ".join([*spelled, "..."] if len(runs) > MOST_RUNS else spelled)
    return f"{len(numbers)} {'frame' if len(numbers) == 1 else 'frames'} ({which})"


def describe_skipped(skipped: Mapping[str, Sequence[int]]) -> str:
    """Frames by reason, in words: ``no image: 1 frame (3); ProbeToTracker OUT_OF_VIEW: 2 frames (5-6)``."""
    words = (f"{reason}: {describe_frames(numbers)}" for reason, numbers in skipped.items())
    return listed(words, "; ")


def status_of_problem(problem: str | None) -> TransformStatus:
    """The status that a reason of `sweep_poses` ends with (``ProbeToTracker OUT_OF_VIEW``); INVALID for a reason without one."""
    if problem is None:
        return TransformStatus.OK
    status = TransformStatus.parse(problem.replace("(", " ").replace(")", " ").split()[-1])
    return TransformStatus.INVALID if status in (TransformStatus.UNKNOWN, TransformStatus.OK) else status


def _find_ways(
    sequence: TrackedSequence,
    wanted: TransformName,
    image_to_reference: str | None,
    recorded: Iterable[TransformName],
    configured: Iterable[TransformName],
) -> Ways:
    """The ways from image to reference over everything that any frame or the configuration holds."""
    if wanted.source == wanted.target:
        raise TransformError(f"{sequence.name}: Image and reference must be two frames; got {wanted.source} for both.")
    try:
        return image_ways(wanted, image_to_reference, recorded, configured)
    except TransformError as error:
        names = list(dict.fromkeys([*configured, *recorded]))
        none = Sentence(NO_TRANSFORMS) if sequence.notes else NO_TRANSFORMS  # what its notes tell comes first
        advice = none if not names else missing_link(wanted, names, [name for name in recorded if _moves(sequence, name)])
        if advice.advice == CHOOSE_FRAME and wanted.target == "Reference":
            advice = Sentence("", CHOOSE_OR_IMPORT, **advice.details)
        raise TransformError(f"{sequence.name}: {message_of(error)} {advice}", advice) from None


NO_TRANSFORMS = Sentence("The recording has no transforms at all: was a tracker connected?", TRANSFORM_SEQUENCES)


CHOOSE_FRAME = "Choose another frame to reconstruct in with {reference}, one of: {frames}."
CHOOSE_OR_IMPORT = f"{CHOOSE_FRAME} There the patient must not move; a marker on the patient is imported with {{reference_tool}}."


def missing_link(wanted: TransformName, names: Sequence[TransformName], moving: Sequence[TransformName]) -> Sentence:
    """What is missing of a chain, and what to do; of all known `names`, those `moving` are not the same in every frame."""
    frames = {frame for name in names for frame in (name.source, name.target)}
    if wanted.source not in frames:
        return Sentence(
            "", "Give the calibration (for example {example}) with {config:PlusDeviceSet.xml}.", example=f"{wanted.source}ToProbe"
        )
    near = connected(names, wanted.source)
    if wanted.target in frames - near:
        return Sentence("", MISSING_LINK)
    # In a frame that the image is fixed to, all images would lie in one plane
    fixed = connected([name for name in names if name not in moving], wanted.source)
    others = ", ".join(sorted(near - fixed))
    if not others:
        return Sentence("No pose of a tool leads on from there: check which tools the tracker follows, and their names.")
    return Sentence("", CHOOSE_FRAME, frames=others)


def _moves(sequence: TrackedSequence, name: TransformName) -> bool:
    """Whether a transform is not the same in every frame that has it, as far as that can be seen."""
    matrices = [record.transforms[name].matrix for record in sequence.records if name in record.transforms]
    return len(matrices) == 1 or any(not np.array_equal(matrix, matrices[0], equal_nan=True) for matrix in matrices)
