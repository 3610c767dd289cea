"""What a recorded sweep holds, and in plain words what keeps it from being reconstructed."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats
from ..effective_settings import scanned_alike
from ..errors import AIFReconError, BeamGeometryError, SequenceFormatError
from ..geometry.transform_graph import TransformName, TransformStatus
from ..geometry.transforms import pixel_spacing
from ..imaging.recognized import recognized
from ..message import Sentence, columns, message_of
from ..progress import Progress
from ..remedies import NAME_THE_PROBE
from ..sweep.frames import TrackedSequence
from ..sweep.poses import SweepPoses, sweep_poses, without_still_images
from .offset_estimate import OffsetEstimate, estimate_time_offset
from .tracking_report import TrackingReport, tracking_report

UNKNOWN = "the directions of the beams are not known."


@dataclass(frozen=True)
class SequenceReport:
    """The facts of a sequence, and findings about them."""

    facts: tuple[tuple[str, str], ...]  #: (name, value)
    transforms: tuple[tuple[str, str], ...]  #: (name, statuses in words)
    findings: tuple[str, ...]  #: Sentences a user should read; the first says whether the sequence can be reconstructed
    ready: bool  #: Whether at least one frame can be placed
    tracking: TrackingReport | None = None  #: None when no chain leads from image to reference
    time_offset: OffsetEstimate | None = None  #: Whether images and poses are in step; None when no frame can be placed
    poses: SweepPoses | None = None  #: None when no chain leads from image to reference

    def to_text(self) -> str:
        """The report for a terminal."""
        transforms: list[tuple[str, ...]] = [("transforms" if n == 0 else "", *row) for n, row in enumerate(self.transforms)]
        transforms = transforms or [("transforms", "none")]
        name, *facts = self.facts
        tracking = self.tracking.rows() if self.tracking else []
        return "\n".join([name[1], columns([*facts, *tracking, *transforms]), "", *self.findings])

    def to_dict(self) -> dict[str, object]:
        """The report for JSON."""
        offset = self.time_offset
        return {
            **dict(self.facts),
            "transforms": dict(self.transforms),
            "ready": self.ready,
            "findings": list(self.findings),
            "tracking": self.tracking and self.tracking.to_dict(),
            "time_offset": offset
            and {
                "estimate_s": offset.time_offset,
                "uncertainty_s": offset.uncertainty,
                "out_of_step": offset.out_of_step,
                "words": offset.to_text(),
            },
        }


def diagnose(
    sequence: TrackedSequence,
    image_to_reference: str | None = None,
    reference: str | None = None,
    progress: Progress | None = None,
    probe: str | None = None,
    has_bone: bool = False,
) -> SequenceReport:
    """Look at a sequence as `reconstruct` would, without reconstructing.

    Names are those of `sweep_poses`; `probe` is what the caller says of it, where it does. With `has_bone` bone will be asked for, and the
    probe must be known. Comparing images with poses takes a while, where the sweep goes to and fro.
    """
    columns_, rows = sequence.frame_size
    facts = [
        ("file", sequence.name),
        ("frames", f"{len(sequence)} of {columns_} x {rows} pixels, {np.dtype(sequence.images.dtype).name}"),
        ("orientation", _orientation(sequence)),
        ("time", _describe_time(sequence)),
    ]
    findings, ready, tracking, offset, poses = [], False, None, None, None
    try:
        poses = sweep_poses(sequence, image_to_reference, reference)
        with contextlib.suppress(SequenceFormatError):  # said below
            poses = without_still_images(sequence, poses)
        tracking = tracking_report(sequence, poses)
        poses.require_usable(sequence.name)
    except AIFReconError as error:
        findings += [Sentence(f"Cannot be reconstructed yet. {message_of(error)}", error), *sequence.notes]
        shown = probe or _describe_probe(sequence, None)
    else:
        usable = poses.usable
        facts.append(("pixel spacing", _describe_spacing(poses)))
        facts.append(("image", _describe_extent(poses, sequence.frame_size)))
        chain = ", ".join(str(name) for name in poses.path)
        shown = probe or _describe_probe(sequence, pixel_spacing(poses.image_to_reference[usable[0]]))
        ready = shown is not None or not has_bone
        placed = f"{len(usable)} of {len(sequence)} frames can be placed by {chain}."
        findings.append(f"Ready: {placed}" if ready else Sentence(f"Not ready for bone: {placed} But {UNKNOWN}", NAME_THE_PROBE))
        if shown is None and not has_bone:
            findings.append(Sentence(f"Frames can be averaged. For a CT's bone, more is needed: {UNKNOWN}", NAME_THE_PROBE))
        findings += [*tracking.findings(), *poses.notes]
        try:
            offset = estimate_time_offset(sequence, poses, progress)
            findings.append(offset.to_text())
        except SequenceFormatError as error:
            findings.append(Sentence(f"Images cannot be compared with poses: {message_of(error)}", error))
    facts.append(("probe", shown or "not recognized in the images"))
    findings += _about_time(sequence) + _about_tools(sequence)
    findings += sequence.configuration.warnings
    names = sequence.transform_names()
    statuses = tuple((str(name), _describe_statuses(sequence, name)) for name in names)
    return SequenceReport(tuple(facts), statuses, tuple(findings), ready, tracking, offset, poses)


def _orientation(sequence: TrackedSequence) -> str:
    stored = getattr(sequence.images, "orientation", None)
    return "MF" if stored in (None, "MF") else f"{stored} in the file, turned to MF"


def _describe_time(sequence: TrackedSequence) -> str:
    times = _timestamps(sequence)
    if times is None:
        return "no timestamps"
    span = float(times.max() - times.min())
    return f"{span:.2f} s, {(len(times) - 1) / span:.1f} frames/s" if span > 0 else "all timestamps are equal"


def _describe_spacing(poses: SweepPoses) -> str:
    spacings = np.array([pixel_spacing(poses.image_to_reference[number]) for number in poses.usable])
    x, y = np.median(spacings, axis=0)
    varies = "" if np.ptp(spacings, axis=0).max() < 1e-3 * max(x, y) else ", varies between frames"
    return f"{x:.4g} x {y:.4g} mm{varies}"


def _describe_extent(poses: SweepPoses, frame_size: tuple[int, int]) -> str:
    """How large an image is, and how far the sweep goes."""
    placed = poses.image_to_reference[poses.usable]
    columns, rows = frame_size
    wide, high = np.median(np.linalg.norm(placed[:, :3, :2], axis=1), axis=0) * (columns, rows)
    middle = (placed @ (columns / 2, rows / 2, 0.0, 1.0))[:, :3]
    return f"{wide:.4g} x {high:.4g} mm, its middle moves within {' x '.join(f'{side:.4g}' for side in np.ptp(middle, axis=0))} mm"


def _describe_probe(sequence: TrackedSequence, spacing: tuple[float, float] | None) -> str | None:
    """The probe in words; None where it is not known."""
    configuration = sequence.configuration
    probe = (scanned_alike(configuration, spacing)[0] if spacing else configuration).probe
    if probe is not None:
        apex = f", apex at column {probe.apex_px[0]:.1f}, row {probe.apex_px[1]:.1f}" if probe.apex_px else ""
        return f"{probe.kind}{apex} (configuration)"
    try:
        return f"{recognized(sequence.images, spacing or (1.0, 1.0)).description} (recognized in the images)"
    except BeamGeometryError:
        return None
    except SequenceFormatError as error:
        return f"cannot be looked at: {message_of(error)}"


def _describe_statuses(sequence: TrackedSequence, name: TransformName) -> str:
    counts = sequence.status_counts(name)
    return ", ".join(f"{counts[status]} {status.value}" for status in TransformStatus if counts[status])


def _timestamps(sequence: TrackedSequence) -> Floats | None:
    times = sequence.timestamps
    return times if np.isfinite(times).all() else None


def _about_time(sequence: TrackedSequence) -> list[str]:
    if len(sequence) < 2:
        return []
    times = _timestamps(sequence)
    if times is None:
        return ["Some frames have no timestamp; frames are taken in the order of the file."]
    if times.max() == times.min():
        return ["All timestamps are equal, so the frame rate is unknown; frames are taken in the order of the file."]
    findings = []
    if (np.diff(times) < 0).any():
        findings.append("Timestamps go back in places; frames are taken in the order of their timestamps.")
    equal = int((np.diff(times) == 0).sum())
    if equal:
        findings.append(f"{equal} frames have the timestamp of the frame before them: were images and poses repeated while recording?")
    return findings


def _about_tools(sequence: TrackedSequence) -> list[str]:
    """A sentence for each tool that was never seen: its marker may have been covered, or it was never connected."""
    never_seen = [name for name in sequence.transform_names() if not sequence.status_counts(name)[TransformStatus.OK]]
    return [f"{name} is not valid in any frame: {name.source} was not tracked while recording." for name in never_seen]
