"""What is probably wrong with the geometry of a sweep: repairs are tried, and told where one explains the sweep clearly better."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy

from ..arrays import Floats, Matrix
from ..bone.echoes.found import SweepEchoes
from ..bone.field import BoneField
from ..errors import AIFReconError, require_kind
from ..geometry.transforms import affine, as_matrix, invert, with_unit_depth
from ..geometry.volume import Volume
from ..message import Sentence, listed, message_of
from ..progress import Progress, part, report
from ..recipe.recipe import SCANNER_SPEED, Recipe
from ..registration.registration import LEAST_CLOSENESS
from ..remedies import ADD_TIME_OFFSET, CALIBRATE, CALIBRATE_NOW, CHECK_IN_PLACE
from ..sweep.edits import inverted, with_configured_transforms
from ..sweep.frames import CROPPED, TrackedSequence
from ..sweep.multi_sweep import sweeps_of
from ..sweep.poses import chain_ends, sweep_poses
from .calibration import Calibration, calibrate_echoes
from .crossing import GAIN, calibrate_crossing_echoes, contradiction, crossing, off_the_surface
from .echoes import Correction, ImagedEchoes, imaged_echoes, replaced
from .mending import FARTHEST
from .solve import EXPECTED, PARAMETERS, UNITS, as_vector, in_words

SURE = 3.0
"""Standard deviations from which a number of the calibration is told to be wrong."""

_SIZES = [PARAMETERS.index("size across"), PARAMETERS.index("size along")]

CLEARLY, TRIED = 0.8, 2
"""The part of the angles' distance as given below which a repair is clearly better, and how many of the best are laid on the CT's bone."""

AGREE = 0.65
"""mm that echoes of different angles may lie off each other's surface: 0.2 to 0.3 on simulated patients, 0.45 to 0.55 on the fibula, in all
looks of a scanner. Images 0.1 s late are at 0.7, passes of a patient who moved by 1.5 mm at 0.9 and more."""

DENSE = 6
"""Frames of an angle, on the mean, from which on that is so: with 4 it is 0.7 to 0.8 of right recordings."""


@dataclass(frozen=True)
class CalibrationCheck:
    """What a check of the calibration has found."""

    agrees: bool | None  #: None where the sweep cannot tell, or does not lie on the CT's bone anyhow
    finding: str  #: As in "Calibration: ..."
    more: tuple[str, ...] = ()  #: Further sentences

    @property
    def lines(self) -> list[str]:
        """All of it, in sentences."""
        return [Sentence(f"Calibration: {self.finding}", message_of(self.finding)), *self.more]


def check_calibration(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume | None = None,
    start: Floats | None = None,
    *,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> list[str]:
    """What is probably wrong with calibration, orientation and delay of a sweep, in sentences; the arguments are those of `calibrate`.

    Images mirrored, a transform recorded as its inverse, a marker mounted in another way: each is mended in turn, and told where echoes of
    different angles then lie nearer to each other than as given and than with all else (`crossing`). With a CT's `labels` it is told only
    where a calibration near the mended one lays the echoes on the bone, too. Where nothing of that kind is wrong, numbers are told.
    """
    return checked(sequences, labels, start, recipe=recipe, progress=progress).lines


def checked(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume | None = None,
    start: Floats | None = None,
    *,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
    known: SweepEchoes | None = None,
) -> CalibrationCheck:
    """What `check_calibration` tells, and whether the calibration agrees; `known` are echoes of the sweeps that were found already."""
    if labels is not None:
        require_kind("labels", labels, Volume, "Read it first: read_labels(path).")
    start = None if start is None else as_matrix(start, "start")
    recipe = recipe or Recipe()
    sweeps = sweeps_of(sequences, recipe)
    bone = None if labels is None else BoneField.from_labels(labels)
    echoes = imaged_echoes(sweeps, recipe, part(progress, 0.0, 0.2), known)
    if len(np.unique(echoes.angles)) < 2:
        return CalibrationCheck(None, "cannot be told from this sweep, which shows bone from one angle.")
    report(progress, 0.2, "Trying repairs")
    given = crossing(echoes)
    tried = [(crossing(mended), repair, mended) for repair, mended in repairs(echoes, sweeps, recipe)]
    better = sorted((one for one in tried if one[0] < CLEARLY * given), key=lambda one: one[0])
    if bone is None:
        # Fewer echoes may lie near each other for chance: the surface that they show must be the better one, too
        none = Correction.none(echoes.center)
        better = [one for one in better if off_the_surface(one[2], none) < CLEARLY * off_the_surface(echoes, none)]
        if better:
            return _told(better[0][1], f"echoes of different angles lie {given:.1f} mm apart, {better[0][0]:.1f} mm with that mended")
        return _by_crossing(echoes, part(progress, 0.3, 1.0))
    found = calibrate_echoes(echoes, bone, start, part(progress, 0.3, 0.5))
    if found.accepted:
        return _near(found)
    if found.before.enough and found.before.closeness <= LEAST_CLOSENESS:
        # It lies on the bone as it is: what else would lie there tells nothing
        return CalibrationCheck(None, f"cannot be told from this sweep. {found.reason}")
    for number, (_, repair, mended) in enumerate(better[:TRIED]):
        again = calibrate_echoes(mended, bone, None, part(progress, 0.5 + 0.2 * number, 0.7 + 0.2 * number))
        if again.accepted:
            agreeing = f"{found.before.share:.0%} of the echoes agree with the CT's bone, {again.before.share:.0%} with that mended"
            return _told(repair, agreeing)
    if (np.abs(as_vector(found.correction)) > FARTHEST * EXPECTED)[_SIZES].any():
        # What is known of calibrations draws sizes to those given: from the ones found the true ones are near
        again = calibrate_echoes(echoes.mended(found.correction), bone, found.labels_to_reference, part(progress, 0.9, 1.0))
        if again.accepted:
            return _size(echoes, again)
    report(progress, 1.0, "Tried repairs")
    return CalibrationCheck(
        None,
        "neither near the one given nor with anything usual mended does the sweep lie on the CT's bone. "
        f"{found.before.sentence()} Check that both are of one bone.",
    )


def known_without_ct(
    sequences: TrackedSequence | Iterable[TrackedSequence], recipe: Recipe | None = None, known: SweepEchoes | None = None
) -> tuple[str, ...]:
    """What the echoes of a sweep tell of its calibration in passing, where there is no CT: a sentence, or nothing.

    `known` are echoes of it that were found already.
    """
    try:
        echoes = imaged_echoes(sequences, recipe, known=known)
    except AIFReconError:
        return ()
    if (contradicted := contradiction(echoes)) is not None:
        return (contradicted,)
    apart = off_the_surface(echoes, Correction.none(echoes.center))
    if apart > AGREE and len(np.unique(echoes.frames)) >= DENSE * len(np.unique(echoes.angles)):
        return (
            Sentence(
                f"WARNING: Echoes of different angles lie {apart:.1f} mm off each other's surface, where {AGREE:g} mm are the most of a "
                "right recording. Images and poses may be out of step, the tool or the calibration may be a wrong one, or the patient "
                "moved.",
                CHECK_IN_PLACE,
            ),
        )
    return (f"Calibration: not checked, as there is no CT; {_off_each_other(echoes)}.",)


def _off_each_other(echoes: ImagedEchoes) -> str:
    apart = off_the_surface(echoes, Correction.none(echoes.center))
    return f"echoes of different angles lie {apart:.1f} mm off each other's surface" if apart == apart else "bone is shown from one angle"


def _by_crossing(echoes: ImagedEchoes, progress: Progress | None) -> CalibrationCheck:
    """What is said without a CT: the yardstick is how near to each other another calibration lays the echoes."""
    contradicted = contradiction(echoes)
    if contradicted is not None:
        return CalibrationCheck(False, "cannot be told of frames that contradict each other.", (contradicted,))
    found = calibrate_crossing_echoes(echoes, progress)
    lie = _off_each_other(echoes)
    if found.halves.after <= GAIN * found.halves.before:
        return CalibrationCheck(False, Sentence(f"{lie}, and {found.after:.1f} mm with another calibration.", CALIBRATE_NOW))
    return CalibrationCheck(
        None,
        f"{lie}, and another calibration lays them no nearer. Whether that is near enough cannot be told without a CT or a phantom, nor "
        "whether pixels have their true size.",
    )


def _size(echoes: ImagedEchoes, found: Calibration) -> CalibrationCheck:
    """What is said where pixels of quite another size explain the sweep."""
    times = found.correction.scale * np.array(found.echoes.spacing) / np.array(echoes.spacing)
    words = f"pixels look {1 / times[0]:.0%} as wide and {1 / times[1]:.0%} as high as they are."
    return CalibrationCheck(
        False,
        Sentence(words, "Mend recordings with {convert} {scale:{across} {along}}.", across=f"{times[0]:.3f}", along=f"{times[1]:.3f}"),
    )


def _told(repair: Sentence, why: str) -> CalibrationCheck:
    return CalibrationCheck(False, Sentence(f"{repair} ({why}).", repair))


def _near(found: Calibration) -> CalibrationCheck:
    """What is said of a sweep of which a calibration is found near the one that was given."""
    if found.changed <= found.uncertainty:
        return CalibrationCheck(True, f"agrees with this sweep within {found.uncertainty:.1f} mm.")
    values, deviations = in_words(found.values), in_words(found.deviation)
    sure = found.held & (np.abs(values) > SURE * deviations)
    wrong = [f"{name} {value:+.1f} {unit}" for name, value, unit, one in zip(PARAMETERS, values, UNITS, sure, strict=True) if one]
    off = f"image points lie {found.changed:.1f} mm off ({listed(wrong) or 'by several numbers together'})."
    more = []
    if sure[_SIZES[1]]:
        speed = SCANNER_SPEED * found.correction.scale[1]
        more.append(
            Sentence(f"The size along would fit a speed of sound of {speed:.0f} m/s where the scanner took {SCANNER_SPEED:.0f} m/s.")
        )
    if sure[-1]:
        more.append(
            Sentence(f"Images and poses are {abs(values[-1]):.0f} ms out of step.", ADD_TIME_OFFSET, offset=f"{found.values[-1]:.3f}")
        )
    return CalibrationCheck(False, Sentence(off, CALIBRATE_NOW), tuple(more))


def repairs(echoes: ImagedEchoes, sweeps: list[TrackedSequence], recipe: Recipe) -> Iterator[tuple[Sentence, ImagedEchoes]]:
    """All that may be wrong, in words as in "the images look ..." with what to do, and the echoes as they would lie were it mended."""
    yield Sentence("the images look mirrored", "Mend recordings with {convert} {mirror}."), mirrored(echoes)
    whole = [with_configured_transforms(sweep) for sweep in sweeps]
    recorded = whole[0].transform_names()
    for step in sweep_poses(sweeps[0], recipe.image_to_reference, recipe.reference).path:
        name = step if step in recorded else step.inverse
        if name in recorded and name not in (CROPPED, CROPPED.inverse):
            words = Sentence(f"{name} looks recorded as its inverse", "Mend recordings with {convert} {invert:{name}}.", name=str(name))
            with contextlib.suppress(AIFReconError):  # where it places nothing
                yield words, replaced(echoes, [inverted(sweep, name) for sweep in whole], recipe)
    calibration = _calibration(whole[0], recipe)
    if calibration is not None:
        for way, turn in quarter_turns():
            words = Sentence(f"the probe's marker looks turned {way} since it was calibrated", CALIBRATE)
            yield words, _turned(echoes, calibration, turn)


def mirrored(echoes: ImagedEchoes) -> ImagedEchoes:
    """The echoes of the same images turned left to right."""
    points, beams = echoes.points.copy(), echoes.beams * [-1.0, 1.0, 1.0]
    points[:, 0] = (echoes.frame_size[0] - 1) * echoes.spacing[0] - points[:, 0]
    return replace(echoes, points=points, beams=beams)


def _calibration(sweep: TrackedSequence, recipe: Recipe) -> Matrix | None:
    """(4, 4), pixels to mm: where the image lies in the frame of the probe's marker; None where that is not told."""
    wanted, _ = chain_ends(sweep.configuration, recipe.image_to_reference, recipe.reference)
    names = [name for name in sweep.transforms if name.source == wanted.source and name not in (CROPPED, CROPPED.inverse)]
    return sweep.transforms[names[0]].matrix if len(names) == 1 else None


def _turned(echoes: ImagedEchoes, image_to_probe: Matrix, turn: Matrix) -> ImagedEchoes:
    """The echoes with the marker turned against the image: poses @ turn @ calibration."""
    plane_to_probe = with_unit_depth(image_to_probe @ invert(np.diag([*echoes.spacing, 1.0, 1.0])))
    return echoes.moved(invert(plane_to_probe) @ turn @ plane_to_probe)


def quarter_turns() -> Iterator[tuple[str, Matrix]]:
    """The 23 ways, (4, 4), to mount a marker with its axes along those that it should have, and how each is called."""
    for turn in scipy.spatial.transform.Rotation.create_group("O"):
        angle = round(float(np.degrees(turn.magnitude())))
        if angle == 0:
            continue
        axis = turn.as_rotvec() / turn.magnitude()
        matrix = affine(np.rint(turn.as_matrix()))
        along = np.rint(axis / np.abs(axis).max()).astype(int)
        name = "xyz"[int(np.abs(along).argmax())] if np.abs(along).sum() == 1 else f"({', '.join(map(str, along))})"
        yield f"by {int(np.sign(along.sum()) or 1) * angle if np.abs(along).sum() == 1 else angle} degrees about its {name} axis", matrix
