"""A CT is laid on a sweep, in the space in which its models fit, and what is to be said of the place and of the calibration."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..arrays import Matrix
from ..bone.echoes.found import SweepEchoes
from ..calibration.check import CalibrationCheck, checked
from ..errors import AIFReconError, RegistrationRefused
from ..geometry.labels import Labels
from ..geometry.volume import Volume
from ..message import Sentence, message_of
from ..motion.motion import PatientMotion, taken_out
from ..progress import Progress
from ..recipe.recipe import Recipe
from ..registration.labeled_bone import LabeledBone
from ..registration.registration import Registration, register
from ..registration.segments import placed_labels
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined


@dataclass(frozen=True, eq=False)
class RegistrationJob:
    """What is to be laid on what; fields as the arguments of `register`.

    Parameters
    ----------
    level : int or None
        A place that the user has chosen.
    accept : bool
        Whether the best place is taken even if it is not sure.
    """

    sequences: list[TrackedSequence]
    labels: Labels
    start: Matrix | None = None
    recipe: Recipe = field(default_factory=Recipe)
    per_segment: bool = False
    level: int | None = None
    accept: bool = False


@dataclass(frozen=True, eq=False)
class RegistrationOutput:
    """What became of a job."""

    found: Registration
    labels: Labels  #: In the space in which they fit
    is_taken: bool  #: The answer is sure, or the user has chosen it

    def require_taken(self, more: str = "") -> None:
        """Return if the answer may be used; RegistrationRefused says why not, and `more`."""
        if not self.is_taken:
            raise RegistrationRefused(f"No transform is written. {self.found.reason}{more}", message_of(self.found.reason))

    @property
    def placed(self) -> Volume:
        """The labels in Reference, where they came to lie."""
        found = self.found
        return placed_labels(self.labels, found.segments.transforms) if found.segments else self.labels.placed_by(found.transform)

    @property
    def lines(self) -> list[str]:
        """What a user should know, one line each."""
        found, all_echoes = self.found, len(self.found.echoes)
        lines = [found.agreement.sentence(), *(() if found.motion is None else found.motion.lines), *self.labels.notes]
        if found.moved is not None:
            lines.append(f"moved by {found.moved:.1f} mm from the start")
        lines += [
            f"{self.labels.called(label)}: {own.agreement:.0%} of its echoes agree; it has {own.echoes / all_echoes:.0%} of all"
            for label, own in sorted(found.agreement.per_label.items())
        ]
        if found.uncertain:
            lines.append("not determined by this sweep: " + "; ".join(found.uncertain))
        if found.agreement.elsewhere:
            far = found.agreement.elsewhere / all_echoes
            lines.append(f"{far:.1%} of all echoes lie far from labeled bone: of bone that the labels lack, or of none")
        if found.alternatives:
            best = found.alternatives[0]
            levels = "" if not best.levels else f" ({best.levels:+d} level{'s' if abs(best.levels) > 1 else ''})"
            shares = f"{best.agreement.explained:.0%} of all echoes agree, here {found.agreement.explained:.0%}"
            lines.append(f"next best place{levels}: {shares}")
        return lines


def register_job(job: RegistrationJob, progress: Progress | None = None) -> RegistrationOutput:
    """Carry out a job. Models that do not say their space are taken in that in which the sweep fits better.

    Raises AIFReconError for input that cannot be registered; an answer that is not sure is none: see `require_taken`.
    """
    given = labels = job.labels
    if given.space_is_guessed:
        labels = LabeledBone(given, job.start, job.sequences, job.recipe).labels
    found = _laid(job, labels, progress)
    if given.space_is_guessed and not found.accepted:
        is_lps = np.array_equal(labels.ijk_to_reference, given.ijk_to_reference)
        turned = given.taken_as("RAS" if is_lps else "LPS", "where the sweep fits better")
        other = _laid(job, turned)
        if other.agreement.tightness > found.agreement.tightness:
            found, labels = other, turned
    return RegistrationOutput(found, labels, found.accepted or job.accept or job.level is not None)


def _laid(job: RegistrationJob, labels: Labels, progress: Progress | None = None) -> Registration:
    return register(
        job.sequences,
        labels,
        job.start,
        per_segment=job.per_segment,
        level=job.level or 0,
        recipe=job.recipe,
        progress=progress,
    )


def calibration_by(
    sequences: list[TrackedSequence],
    labels: Volume,
    placed: Matrix | None,
    recipe: Recipe,
    progress: Progress | None = None,
    known: SweepEchoes | None = None,
    motion: PatientMotion | None = None,
) -> CalibrationCheck:
    """What the bone of a CT that lies on sweeps says of their calibration; that it cannot be told is no error.

    `known` are echoes of the sweeps that were found already. Where the sweeps as they were recorded cannot tell, what of a `motion` is the
    patient's is taken out. Not before: it may stand for a part of what is wrong with the calibration.
    """
    try:
        found = checked(sequences, labels, np.eye(4) if placed is None else placed, recipe=recipe, progress=progress, known=known)
    except AIFReconError as error:
        found = CalibrationCheck(None, Sentence(f"cannot be told. {message_of(error)}", error))
    if found.agrees is not None or motion is None or not motion.applied:
        return found
    still = taken_out(joined(sequences, recipe), motion.alone, recipe)
    return calibration_by([still], labels, placed, recipe, progress)
