"""What stands under every reconstruction with labels: whether the bone of the sweep lies where the labels are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..arrays import Floats
from ..errors import AIFReconError, OperationCanceled
from ..geometry.volume import Volume
from ..message import Sentence, said
from ..progress import Progress, report
from ..recipe.recipe import Recipe
from ..remedies import Remedy
from ..sweep.frames import TrackedSequence
from .agreement import Agreement, check
from .bone_field import BoneField
from .echoes import sweep_echoes

COMPARED_FRAMES = 90
"""Frames of the sweep in which bone is looked for: enough to judge by, in less than a second."""


@dataclass(frozen=True)
class Comparison:
    """How a sweep and placed labels agree, or why that cannot be told."""

    agreement: Agreement | None
    lines: tuple[str, ...]  #: The same in words, and what to do where they do not agree


def compared(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume,
    labels_to_reference: Floats,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """How well a sweep and placed labels agree, and what to do where they do not.

    It goes with a reconstruction and cannot spoil it: a sweep that cannot be compared is said to be so.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference
    labels : Volume of integers
    labels_to_reference : (4, 4) array, mm
    recipe : Recipe or None
        As in `reconstruct`.
    """
    try:
        echoes = sweep_echoes(sequences, recipe, most_frames=COMPARED_FRAMES, progress=progress)
        bone = BoneField.from_labels(labels)
        report(progress, 1.0, "Looking for bone in the sweep")
        agreement = check(echoes, bone, labels_to_reference)
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return Comparison(None, (Sentence(f"CT and sweep were not compared. {said(error)}", error),))
    warning, sentence = agreement.warning(), agreement.sentence()
    if warning is None:
        return Comparison(agreement, (sentence,))
    return Comparison(agreement, (sentence, Sentence(f"WARNING: {warning}", Remedy.REGISTER)))
