"""Tracking, registration and coverage of the sweep that was reconstructed last: three verdicts, for as long as they hold."""

import numpy as np

from AIFReconLib.errors import AIFReconError, OperationCanceled
from AIFReconLib.inspection.verdicts import Verdict, coverage_verdict, registration_verdict, tracking_verdict, unknown
from AIFReconLib.message import said

from ..inputs.boneNodes import boneNames, inNames, isLabeled, nameOf
from ..sweep.severalSweeps import furtherSweeps
from ..sweep.sweepStatus import sweepKey
from ..transforms import matrixToWorld

TRACKING, REGISTRATION, COVERAGE = NAMES = ("tracking", "registration", "coverage")


class SweepVerdicts:
    """Remembers what is to be thought of the chosen sweep and CT, and forgets it when one of them is changed or moved."""

    def __init__(self):
        self._known: dict[str, tuple] = {}
        self._prepared = None

    def forget(self) -> None:
        """Nothing is known of any sweep."""
        self._known, self._prepared = {}, None

    def of(self, parameters) -> dict[str, Verdict]:
        """The three verdicts by name; where one is not known, what to do to be told."""
        return {name: self._known_or(name, parameters) for name in NAMES}

    def judge(self, parameters, prepared, report, progress=None) -> None:
        """Judge what was reconstructed.

        Parameters
        ----------
        parameters : AIFReconParameterNode
        prepared : PreparedInputs
            Kept until the coverage is told.
        report : TrackingReport
        progress : callable or None
            A cancel leaves the registration open: the volume is there by now.
        """
        self._known = {}
        self._tell(TRACKING, parameters, tracking_verdict(report))
        if prepared.labeledBone is None:
            return
        try:
            comparison = prepared.comparison(progress)
        except OperationCanceled:
            return
        self._prepared = prepared
        if comparison.agreement is None:
            self._tell(REGISTRATION, parameters, unknown(comparison.lines[0]))
        else:
            self.takeAgreement(parameters, comparison.agreement)

    def takeAgreement(self, parameters, agreement) -> None:
        """The `Agreement` of CT and sweep where the CT is now, whoever has asked for it."""
        names = boneNames(parameters.bone, list(parameters.boneSegments))
        self._tell(REGISTRATION, parameters, registration_verdict(agreement, names))

    def coverageWork(self, parameters):
        """What tells the coverage, to be called with a progress function on any thread; None where it cannot be told, or is told."""
        prepared, self._prepared = self._prepared, None
        if prepared is None or parameters.bone is None or _key(COVERAGE, parameters)[1:] != _key(REGISTRATION, parameters)[1:]:
            return None
        names, key = boneNames(parameters.bone, list(parameters.boneSegments)), _key(COVERAGE, parameters)

        def work(progress):
            return key, _coverageOf(prepared, names, progress)

        return work

    def takeCoverage(self, told: tuple) -> None:
        """What `coverageWork` has returned."""
        key, verdict = told
        self._known[COVERAGE] = key, verdict

    def takeGuidance(self, parameters, guidance) -> None:
        """What `guidanceOfSweep` knows of the chosen sweep and CT: the coverage, and where to move the probe next."""
        if guidance.coverage is not None:
            names = boneNames(parameters.bone, list(parameters.boneSegments))
            advice = guidance.advice
            move = "" if advice is None or advice.move is None else _inWords(advice, names)
            self._tell(COVERAGE, parameters, _verdictOn(guidance.coverage, names, move))

    def _tell(self, name: str, parameters, verdict: Verdict) -> None:
        self._known[name] = _key(name, parameters), verdict

    def _known_or(self, name: str, parameters) -> Verdict:
        if parameters.sweep is None:
            return unknown("no sweep yet")
        if name != TRACKING and parameters.bone is None:
            return unknown("not known: select the bone of the CT under “Bone of CT”")
        if name != TRACKING and not isLabeled(parameters.bone):
            return unknown("not known: select a segmentation of the CT under “Bone of CT”")
        key, verdict = self._known.get(name, (None, None))
        if verdict is not None and key == _key(name, parameters):
            return verdict
        return unknown("something has changed: press “Reconstruct” again" if verdict is not None else "known after “Reconstruct”")


def _key(name: str, parameters) -> tuple:
    """What a verdict is about: it does not hold when that changes."""
    sweeps = (sweepKey(parameters.sweep, parameters.imageSequence), *map(sweepKey, furtherSweeps(parameters)))
    if name == TRACKING:
        return (name, *sweeps)
    bone = parameters.bone
    try:
        place = tuple(np.round(matrixToWorld(bone), 6).ravel())
    except AIFReconError:
        place = ()
    return (name, *sweeps, bone.GetID(), tuple(parameters.boneSegments), place)


def _coverageOf(prepared, names: dict, progress) -> Verdict:
    from AIFReconLib.guidance.coverage import coverage

    bone = prepared.labeledBone
    try:
        return _verdictOn(
            coverage(prepared.sequence, bone.labels, bone.labels_to_reference, recipe=prepared.recipe, progress=progress), names
        )
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return unknown(said(error))


def _verdictOn(found, names: dict, move: str = "") -> Verdict:
    from AIFReconLib.guidance.coverage import back_of_labels

    shares = {nameOf(int(label), names): share for label, share in back_of_labels(found.met).items()}
    shown = {name: share.expected_visibility for name, share in shares.items()}
    return coverage_verdict(shown, {name: share.met for name, share in shares.items()}, move)


def _inWords(advice, names: dict) -> str:
    """Where to move the probe next, in a few words."""
    over = inNames(advice.over, names)
    return f"Next: {advice.directions[0].words} over {over}."
