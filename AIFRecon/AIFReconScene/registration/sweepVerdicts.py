"""Tracking, registration, coverage, calibration and motion of the sweep that was reconstructed last: verdicts, for as long as they hold."""

import json

import numpy as np

from AIFReconLib.errors import AIFReconError
from AIFReconLib.guidance.snapshot import GuidanceSnapshot
from AIFReconLib.inspection.verdicts import Level, Verdict, coverage_verdict, registration_verdict, tracking_verdict, unknown
from AIFReconLib.message import message_of
from AIFReconLib.progress import part
from AIFReconLib.worker.evaluating import calibration_of_sweep, guidance_in_sweep, met_of_sweep, motion_of_sweep

from ..inputs.boneNodes import boneNames, isLabeled, nameOf
from ..inputs.inputs import Inputs
from ..panelWords import inPanelWords
from ..sweep.browserItems import checkRecorded
from ..sweep.sweepStatus import furtherSweeps, sweepKey
from ..transforms import matrixToWorld
from ..work import inWorker, worker
from .ctRegistration import rigidPlace

TRACKING, REGISTRATION, COVERAGE, CALIBRATION, MOTION = NAMES = ("tracking", "registration", "coverage", "calibration", "motion")
WITHOUT_CT = (TRACKING, MOTION)

ATTRIBUTE, MADE, ROLE = "AIFRecon.Verdicts", "AIFRecon.MadeOf", "AIFRecon.Judged"
"""Of the volume that was reconstructed: its verdicts and what it was made of, for whoever opens the scene later, and references to the
nodes that they are about, which stay right where a scene is loaded into another and its nodes get other IDs."""


class SweepVerdicts:
    """Remembers what is to be thought of the chosen sweep and CT; it holds while they are as they were then, and again when they are."""

    def __init__(self):
        self._known: dict[str, dict[tuple, Verdict]] = {}
        self._done, self._sought = None, {}
        self.agreement = None
        """Of CT and sweep, by which *Registration* was judged last."""

    def forget(self) -> None:
        """Nothing is known of any sweep."""
        self._known, self._done, self.agreement = {}, None, None
        self.cancelBeside()

    def of(self, parameters) -> dict[str, Verdict]:
        """The verdicts by name; where one is not known, what to do to be told."""
        return {name: self._known_or(name, parameters) for name in NAMES}

    def judge(self, parameters, comparison, report, job=None, motion=None) -> None:
        """Judge what was reconstructed, by its `TrackingReport` and the `Comparison` of CT and sweep (None without labels).

        `job` is the `ReconstructionJob` that was carried out, and `motion` what was taken out of its sweep; they are kept until more is
        looked at.
        """
        self.forget()
        self._tell(TRACKING, parameters, tracking_verdict(report))
        self._done = None if job is None else (job, motion)
        if comparison is None:
            pass
        elif comparison.agreement is None:
            self._tell(REGISTRATION, parameters, unknown(comparison.lines[0]))
        else:
            self.takeAgreement(parameters, comparison.agreement)
        if parameters.output is not None:
            _refer(parameters.output, _key(REGISTRATION, parameters))
            parameters.output.SetAttribute(MADE, _madeOf(parameters))

    def takeAgreement(self, parameters, agreement, guessed: str = "") -> None:
        """The `Agreement` of CT and sweep where the CT is now, whoever has asked for it; and what of its place was a guess."""
        self.agreement, names = agreement, boneNames(parameters.bone, list(parameters.boneSegments))
        self._tell(REGISTRATION, parameters, registration_verdict(agreement, names, guessed))

    @property
    def sought(self) -> tuple:
        """Names of the verdicts that the worker is looking for."""
        return tuple(self._sought)

    def beginBeside(self, parameters) -> None:
        """Have the worker look at what takes it seconds, of what was reconstructed last, where that can be told and is not."""
        done, self._done = self._done, None
        if done is None:
            return
        if parameters.bone is not None and REGISTRATION in self._known:
            self._beginOnCT(parameters, *done)
        self._begin(MOTION, parameters, lambda verdict: verdict, motion_of_sweep, *done)

    def _beginOnCT(self, parameters, job, motion) -> None:
        names = boneNames(parameters.bone, list(parameters.boneSegments))
        looks: dict[str, tuple] = {COVERAGE: (met_of_sweep, lambda back: _verdictOn(back, names))}
        if self._known_or(REGISTRATION, parameters).level is Level.GOOD:
            looks[CALIBRATION] = calibration_of_sweep, lambda verdict: verdict
        else:
            advice = "If they do not wherever the CT is placed, the calibration may be wrong: press “More”."
            self._tell(CALIBRATION, parameters, Verdict(Level.UNKNOWN, "known where CT and sweep agree.", advice))
        for name, (look, verdictOf) in looks.items():
            self._begin(name, parameters, verdictOf, look, job.sequence, job.bone.labels, job.bone.to_reference, job.recipe, motion)

    def _begin(self, name: str, parameters, verdictOf, look, *given) -> None:
        self._sought[name] = worker.begin(look, *given), _key(name, parameters), verdictOf, parameters.output

    def takeBeside(self) -> bool:
        """Hear of it; whether something was told."""
        done = [name for name, (task, *_more) in self._sought.items() if task.is_done]
        for name in done:
            task, key, verdictOf, output = self._sought.pop(name)
            try:
                verdict = verdictOf(task.result())
            except AIFReconError as error:
                verdict = unknown(message_of(error))
            self._known.setdefault(name, {})[key] = verdict
            self._keep(output)
        return bool(done)

    def cancelBeside(self) -> None:
        """Look no further."""
        for task, *_more in self._sought.values():
            task.cancel()
        self._sought = {}

    def guide(self, parameters, progress=None, unseen=None) -> GuidanceSnapshot:
        """What the chosen sweeps have met, and the next move from where the last one ended; with that, the coverage is known.

        It leads to bone, or to `unseen` places, (n, 3) in RAS. An AIFReconError says what cannot be used and what to do.
        """
        inputs = Inputs.fromParameters(parameters)
        for sweep in inputs.sweeps:
            checkRecorded(sweep)
        bone = (None, None) if parameters.bone is None else (inputs.labels(part(progress, 0.0, 0.1)), rigidPlace(inputs.bone))
        asked = inputs.sequence(), *bone, inputs.recipe, inputs.grid(inputs.recipe), unseen
        seen = inWorker(guidance_in_sweep, *asked, progress=part(progress, 0.1, 1.0))
        if seen.by_label:
            self._tell(COVERAGE, parameters, _verdictOn(seen.by_label, boneNames(parameters.bone, list(parameters.boneSegments))))
        return seen

    def _tell(self, name: str, parameters, verdict: Verdict) -> None:
        self._known.setdefault(name, {})[_key(name, parameters)] = verdict
        self._keep(parameters.output)

    def _keep(self, output) -> None:
        if output is not None:
            for key in (each for known in self._known.values() for each in known):
                _refer(output, key)
            told = {
                name: [(_lasting(key, output), told.level.value, told.finding, inPanelWords(told.advice)) for key, told in known.items()]
                for name, known in self._known.items()
            }
            output.SetAttribute(ATTRIBUTE, json.dumps(told))

    def _known_or(self, name: str, parameters) -> Verdict:
        if parameters.sweep is None:
            return unknown("no sweep yet")
        if name not in WITHOUT_CT and parameters.bone is None:
            return unknown("not known: select the bone of the CT under “Bone of CT”")
        if name not in WITHOUT_CT and not isLabeled(parameters.bone):
            return unknown("not known: select a segmentation of the CT under “Bone of CT”")
        if name == COVERAGE and self._known_or(REGISTRATION, parameters).level is Level.POOR:
            return unknown("known where CT and sweep agree")
        asked, known = _key(name, parameters), self._known.get(name, {})
        told = known.get(asked) or _keptWith(parameters.output, name, asked)
        first = "known after “Place CT on sweep” or “Reconstruct”" if name == REGISTRATION else "known after “Reconstruct”"
        return told or unknown("something has changed: press “Reconstruct” again" if known else first)


def isOfNow(parameters) -> bool:
    """Whether the output was made of what is chosen now, where it lies now; also where nobody knows what it was made of."""
    made = None if parameters.output is None else parameters.output.GetAttribute(MADE)
    return not made or parameters.sweep is None or made == _madeOf(parameters)


def _madeOf(parameters) -> str:
    return json.dumps(_lasting(_key(REGISTRATION, parameters), parameters.output))


def _refer(output, key: tuple) -> None:
    for nodeID in _nodesOf(key):
        if nodeID not in _judged(output):
            output.AddNodeReferenceID(ROLE, nodeID)


def _key(name: str, parameters) -> tuple:
    """What a verdict is about: it does not hold when that changes."""
    sweeps = (sweepKey(parameters.sweep, parameters.imageSequence), *map(sweepKey, furtherSweeps(parameters)))
    bone = parameters.bone
    if name == TRACKING or bone is None:
        return sweeps, ()
    try:
        place = tuple(map(float, np.round(matrixToWorld(bone), 6).ravel()))
    except AIFReconError:
        place = ()
    return sweeps, (bone.GetID(), tuple(parameters.boneSegments), place)


def _nodesOf(key: tuple) -> list[str]:
    """IDs of the nodes that a key names: sweeps, and the bone where there is one."""
    sweeps, bone = key
    return [*(sweep[0] for sweep in sweeps), *bone[:1]]


def _judged(output) -> list[str]:
    """IDs of the nodes that a volume's verdicts are about."""
    return [output.GetNthNodeReferenceID(ROLE, n) for n in range(output.GetNumberOfNodeReferences(ROLE))]


def _lasting(key: tuple, output) -> list:
    """What of a key a scene's file keeps as it was, nodes by their place among the references: sequences get other names."""
    sweeps, bone = key
    judged = _judged(output)
    nodes = tuple(judged.index(each) if each in judged else each for each in _nodesOf(key))
    return _rounded((nodes, tuple(sweep[-1] for sweep in sweeps), bone[1:]))


def _rounded(value):
    """As JSON gives it back, with the digits that files keep."""
    return [*map(_rounded, value)] if isinstance(value, tuple) else round(value, 3) if isinstance(value, float) else value


def _keptWith(output, name: str, key: tuple) -> Verdict | None:
    """The verdict that is kept with a volume, if it is about this; None where nothing readable is."""
    try:
        told = {json.dumps(about): more for about, *more in json.loads(output.GetAttribute(ATTRIBUTE))[name]}
        level, finding, advice = told[json.dumps(_lasting(key, output))]
        return Verdict(Level(level), str(finding), str(advice))
    except (AttributeError, LookupError, TypeError, ValueError):
        return None


def _verdictOn(back: dict, names: dict) -> Verdict:
    shares = {nameOf(int(label), names): share for label, share in back.items()}
    shown = {name: share.expected_visibility for name, share in shares.items()}
    return coverage_verdict(shown, {name: share.met for name, share in shares.items()})
