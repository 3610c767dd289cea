"""Sequences of a transform alone, as Slicer saves them (.seq.mha), paired with the images by the user.

Slicer writes ``DimSize = 0 0 N``, per frame NAMETransform and NAMETransformStatus, and the index value as Timestamp. NAME is what the
transform was called when it was recorded, so it may be any word. A recording with images serves as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ...errors import SequenceFormatError, SettingsError, TransformError
from ...geometry.transform_graph import MISSING, TransformName, TransformSample, TransformStatus
from ...message import message_of
from ...recipe.recipe import LONGEST_GAP
from ...remedies import TRANSFORM_SEQUENCES
from ...sweep.frames import FrameRecord
from ...sweep.pose_tracks import SLICERS_TIME, PoseTrack
from ..metafile.opening import METAIMAGE_SUFFIXES, NRRD_SUFFIXES, format_of, opened_header
from .fields import MATRIX_SUFFIX, STATUS_SUFFIX, by_frame, parsed_time, samples_in
from .file_images import MAXIMUM_FRAMES

_TOGETHER = "Give the transform sequence that was recorded together with the images."


def read_transform_sequence(path: str | Path, name: str) -> list[tuple[float | None, TransformSample]]:
    """The samples of one transform, each with its time in s, in the order of the file.

    Raises SequenceFormatError when the file cannot be understood or does not hold the transform.

    Parameters
    ----------
    path : str or Path
        .seq.mha or .seq.mhd of Slicer, or any sequence file that holds the transform.
    name : str
        ``ImageToReference``. Where the file holds one transform alone, under whatever name, that one is meant.
    """
    path = Path(path)
    if path.suffix.lower() not in METAIMAGE_SUFFIXES + NRRD_SUFFIXES:
        raise SequenceFormatError(f"{path}: its suffix must be .mha, .mhd or .nrrd. Save the transform sequence from Slicer as .seq.mha.")
    with opened_header(path, SequenceFormatError) as lines:
        _, header = format_of(path).read(lines)
    per_frame, _ = by_frame(lines, header.items(), MAXIMUM_FRAMES)
    if not per_frame:
        raise lines.failure("it holds no transforms per frame (no Seq_Frame fields). Give a sequence of transforms.")
    recorded = {number: samples_in(lines, f"frame {number}, ", fields, _stem)[0] for number, fields in per_frame.items()}
    present = dict.fromkeys(stem for samples in recorded.values() for stem in samples)
    wanted = next((word for word in present if word.removesuffix(MATRIX_SUFFIX).lower() == name.lower()), None)
    if wanted is None and len(present) != 1:
        there = ", ".join(present) or "none"
        raise SequenceFormatError(f"{path}: it must hold the transform {name}; got {there}. Name one of these, or give another file.")
    stem = wanted or next(iter(present))
    # A file may leave out a million frames
    samples: list[tuple[float | None, TransformSample]] = [(None, MISSING)] * (max(per_frame) + 1)
    for number, fields in per_frame.items():
        samples[number] = parsed_time(lines, number, "Timestamp", fields.get("Timestamp")), recorded[number].get(stem, MISSING)
    return samples


def pair_transforms(
    records: Sequence[FrameRecord], files: Mapping[str, str | Path], longest_gap: float = LONGEST_GAP
) -> tuple[Sequence[FrameRecord], tuple[str, ...]]:
    """Records with the transforms of these files, each taken at the time of the image, and what a user should know.

    Raises SequenceFormatError when a file cannot be used; SettingsError when times are missing and the numbers of samples differ, or a name
    is none.

    Parameters
    ----------
    records : list of FrameRecord
    files : mapping of transform name to path
        As in ``{"ImageToReference": "Transform.seq.mha"}``.
    longest_gap : float, s
        See `PoseTrack.at`.
    """
    notes = []
    for text, path in files.items():
        try:
            name = TransformName.parse(text)
        except TransformError as error:
            raise SettingsError(message_of(error), TRANSFORM_SEQUENCES) from None
        records, note = _pair(records, name, read_transform_sequence(path, str(name)), Path(path), longest_gap)
        notes.append(note)
    return records, tuple(notes)


def _pair(
    records: Sequence[FrameRecord],
    name: TransformName,
    samples: list[tuple[float | None, TransformSample]],
    path: Path,
    longest_gap: float,
) -> tuple[list[FrameRecord], str]:
    image_times = [record.timestamp for record in records if record.timestamp is not None]
    timed = [(time, sample) for time, sample in samples if time is not None]
    if len(image_times) == len(records) and len(timed) == len(samples):
        track = PoseTrack(timed)
        paired = track.samples(image_times, longest_gap, SLICERS_TIME)
        if all(sample is MISSING for sample in paired):
            span = f"{track.times[0]:.3f} to {track.times[-1]:.3f} s" if len(track) else "none"
            images = f"{min(image_times):.3f} to {max(image_times):.3f} s"
            raise SequenceFormatError(f"{path}: no pose of {name} (times {span}) fits the images ({images}). {_TOGETHER}")
        how = "by time"
    elif len(samples) == len(records):
        paired = [sample for _, sample in samples]
        how = "frame by frame, for lack of times"
    else:
        must = f"there must be as many samples of {name} as images, or times on both"
        raise SettingsError(f"{path}: {must}; got {len(samples)} for {len(records)} images. {_TOGETHER}")
    good = sum(sample.status is TransformStatus.OK for sample in paired)
    changed = [replace(record, transforms={**record.transforms, name: sample}) for record, sample in zip(records, paired)]
    note = f"{name} was paired from {path.name} {how}: {good} of {len(records)} frames."
    return changed, note


def _stem(key: str) -> str | None:
    """The name before ``Transform`` or ``TransformStatus``."""
    return next((key.removesuffix(suffix) for suffix in (STATUS_SUFFIX, MATRIX_SUFFIX) if key.endswith(suffix)), None)
