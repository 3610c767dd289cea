"""What stands under every reconstruction with labels: whether the bone of the sweep lies where the labels are."""

from __future__ import annotations

from collections.abc import Iterable

from ..arrays import Floats
from ..errors import AIFReconError, OperationCanceled
from ..geometry.volume import Volume
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion
from ..message import Message
from ..progress import Progress
from ..sweep.frames import TrackedSequence
from .agreement import Agreement, check
from .bone_field import BoneField
from .echoes import sweep_echoes

COMPARED_FRAMES = 90
"""Frames of the sweep in which bone is looked for: enough to judge by, in less than a second."""


def compared(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume,
    labels_to_reference: Floats,
    *,
    region: ImageRegion | None = None,
    probe: ProbeGeometry | None = None,
    image_to_reference: str | None = None,
    reference: str | None = None,
    progress: Progress | None = None,
) -> Agreement:
    """How well a sweep and placed labels agree, by some of its frames.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference
    labels : Volume of integers
    labels_to_reference : (4, 4) array, mm
    region, probe, image_to_reference, reference
        As in `reconstruct`.
    progress : Progress or None

    Raises
    ------
    AIFReconError
        When the sweep cannot be compared.
    """
    echoes = sweep_echoes(
        sequences,
        region=region,
        probe=probe,
        image_to_reference=image_to_reference,
        reference=reference,
        most_frames=COMPARED_FRAMES,
        progress=progress,
    )
    return check(echoes, BoneField.from_labels(labels), labels_to_reference)


def compared_lines(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume,
    labels_to_reference: Floats,
    *,
    region: ImageRegion | None = None,
    probe: ProbeGeometry | None = None,
    image_to_reference: str | None = None,
    reference: str | None = None,
    progress: Progress | None = None,
) -> list[Message]:
    """How well a sweep and placed labels agree, and what to do where they do not: a line each.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference
    labels : Volume of integers
    labels_to_reference : (4, 4) array, mm
    region, probe, image_to_reference, reference
        As in `reconstruct`.
    progress : Progress or None

    Raises
    ------
    OperationCanceled

    Notes
    -----
    It follows a reconstruction and cannot spoil it: a sweep that cannot be compared is said to be so.
    """
    try:
        agreement = compared(
            sequences,
            labels,
            labels_to_reference,
            region=region,
            probe=probe,
            image_to_reference=image_to_reference,
            reference=reference,
            progress=progress,
        )
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return [Message("CT and sweep were not compared. {error}", error=error)]
    warning = agreement.warning()
    lines = [agreement.sentence()]
    return lines if warning is None else [*lines, Message("WARNING: {warning} See aifrecon register.", warning=warning)]
