"""How well a placed CT explains the bone echoes of a sweep: echo by echo, and in all."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Mask
from ..bone.echoes.found import SweepEchoes
from ..bone.echoes.search import sweep_echoes
from ..bone.field import BoneField
from ..errors import AIFReconError, DisagreementWarning, OperationCanceled
from ..geometry.labels import Labels
from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume
from ..machine.read_ahead import read_ahead
from ..message import Sentence, advised, message_of
from ..progress import Progress, report
from ..recipe.recipe import Recipe
from ..remedies import PLACE_THE_CT
from ..sweep.frames import TrackedSequence
from .agreement import CLOSE, NEAR, TIGHT, Agreement, Comparison, LabelAgreement

ENTERING = 0.1
"""Cosine between beam and surface below which sound would come out of bone, or graze it, and no echo comes back."""

COVER_FROM, COVER_TO, COVER_STEP, COVER_DEPTH = 3.0, 45.0, 1.5, 1.0
"""mm before an echo where bone is looked for, how finely, and how deep in bone counts: bone there would have stopped the beam."""

COMPARED_FRAMES = 90
"""Frames of the sweep in which bone is looked for: enough to judge by, in less than a second."""


@dataclass(frozen=True, eq=False)
class EchoFit:
    """Echo by echo, how a placed CT explains them."""

    distances: Floats  #: (n,), mm. Signed distance to bone, positive before the surface or beside it.
    reachable: Mask  #: (n,). Whether the sound enters bone there and no bone lies before it.

    @property
    def near(self) -> Mask:
        """Echoes that say something about the registration, (n,) bool."""
        return self.distances <= NEAR

    @property
    def agreeing(self) -> Mask:
        """Echoes within `CLOSE` of bone that their beams could reach, (n,) bool."""
        agreeing: Mask = (np.abs(self.distances) <= CLOSE) & self.reachable
        return agreeing


def fit_echoes(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> EchoFit:
    """How each echo lies to bone that stands where `labels_to_reference` puts it."""
    to_labels = invert(labels_to_reference)
    points, beams = transform_points(to_labels, echoes.points), echoes.beams @ to_labels[:3, :3].T
    distances, slopes = bone.sample(points)
    slopes /= np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-6)
    reachable = -(slopes * beams).sum(axis=1) >= ENTERING
    # Only what would agree otherwise needs to be followed back
    followed = np.flatnonzero(reachable & (np.abs(distances) <= CLOSE))
    before = points[followed, None] - np.arange(COVER_FROM, COVER_TO, COVER_STEP)[None, :, None] * beams[followed, None]
    reachable[followed] = (bone.distances(before) > -COVER_DEPTH).all(axis=1)
    return EchoFit(distances, reachable)


def check(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> Agreement:
    """How well bone that stands where `labels_to_reference` puts it agrees with the echoes.

    All `echoes` are wanted: counts are part of the answer. `labels_to_reference` is rigid, (4, 4) in mm.
    """
    return agreement_of(*judged(echoes, bone, labels_to_reference))


def judged(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> tuple[EchoFit, Integers]:
    """How each echo lies to bone that stands there, and the label that it belongs to, (n,); 0: to none."""
    fit = fit_echoes(echoes, bone, labels_to_reference)
    owners = np.zeros(len(echoes), dtype=np.int64)
    owners[fit.near] = bone.label_at(transform_points(invert(labels_to_reference), echoes.points[fit.near]))
    return fit, owners


def agreement_of(fit: EchoFit, owners: Integers) -> Agreement:
    """The agreement of echoes that are fitted and belong to the labels `owners` (n,); 0: to none in particular."""
    near = fit.near
    distances, agreeing, owners = np.abs(fit.distances[near]), fit.agreeing[near], owners[near]
    per_label = {
        int(label): LabelAgreement(*_share_and_median(agreeing[owners == label], distances[owners == label]), int((owners == label).sum()))
        for label in np.unique(owners[owners > 0])
    }
    tightness = float((np.exp(-0.5 * (np.minimum(np.abs(fit.distances), NEAR) / TIGHT) ** 2) * fit.reachable).mean()) if len(near) else 0.0
    entered = distances[fit.reachable[near]]
    quartile, tenth = np.percentile(entered, (75, 90)).tolist() if len(entered) else (float("nan"), float("nan"))
    closeness = float(np.median(distances[agreeing])) if agreeing.any() else float("nan")
    share, median = _share_and_median(agreeing, distances)
    return Agreement(share, median, len(distances), len(near) - len(distances), per_label, tightness, closeness, quartile, tenth)


def _share_and_median(agreeing: Mask, distances: Floats) -> tuple[float, float]:
    """Share of True, and median in mm; 0 and NaN of none."""
    return (float(agreeing.mean()), float(np.median(distances))) if len(distances) else (0.0, float("nan"))


def compared(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume,
    labels_to_reference: Floats,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
    field: Callable[[], BoneField] | None = None,
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
    field : callable or None
        Gives the field of the labels, where it is made once for other work, too. Called beside the search for echoes.
    """
    try:
        with read_ahead(field() if field is not None else BoneField.from_labels(labels) for _ in range(1)) as measured:
            echoes = sweep_echoes(sequences, recipe, most_frames=COMPARED_FRAMES, progress=progress)
            bone = next(measured)
        report(progress, 1.0, "Looking for bone in the sweep")
        agreement = check(echoes, bone, labels_to_reference)
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return Comparison(None, (Sentence(f"CT and sweep were not compared. {message_of(error)}", error),))
    warning, sentence = agreement.warning(labels.names if isinstance(labels, Labels) else None), agreement.sentence()
    if warning is None:
        return Comparison(agreement, (sentence,), echoes)
    return Comparison(agreement, (sentence, Sentence(f"WARNING: {warning}", PLACE_THE_CT)), echoes)


def warn_of_disagreement(comparison: Comparison | None) -> None:
    """Warn who calls from Python where CT and sweep do not agree."""
    if comparison is not None and comparison.agreement is not None and not comparison.agreement.enough:
        warnings.warn(" ".join(advised(line).removeprefix("WARNING: ") for line in comparison.lines), DisagreementWarning, stacklevel=3)
