"""Where the CT belongs on the chosen sweep: nodes to the library's inputs, one call, and what it found in a form to be shown."""

from dataclasses import dataclass

import numpy as np

from AIFReconLib.errors import GeometryError
from AIFReconLib.progress import part

from ..background import inBackground
from ..inputs.inputs import Inputs
from ..inputs.parameters import RegistrationStart, regionFrom
from ..sweep.sweepStatus import sweepKey
from ..transforms import matrixToWorld

MOST_DRAWN = 3000
"""Echoes that are drawn, evenly in space: slices are cut anew whenever they move."""


@dataclass(frozen=True)
class Finding:
    """How a place of the CT and the bone echoes agree.

    Parameters
    ----------
    agreement : Agreement
    labelsToWorld : (4, 4) array, mm
        The place.
    points : (n, 3) array, mm, RAS world
        Echoes to be drawn, evenly in space.
    distances : (n,) array, mm
        From each of those to the CT's bone.
    echoes : SweepEchoes
        All of them.
    bone : BoneField
    registration : Registration or None
        None where the place was merely checked.
    """

    agreement: object
    labelsToWorld: np.ndarray
    points: np.ndarray
    distances: np.ndarray
    echoes: object
    bone: object
    registration: object = None

    def at(self, place: np.ndarray) -> "Finding":
        """The same echoes and bone in another place (4, 4): in some ten milliseconds."""
        return _finding(self.echoes, self.bone, place)


class CTRegistration:
    """Registers what the parameters name, and remembers the echoes of the sweep.

    Notes
    -----
    Nothing of the scene is changed. Echoes are looked for again when other sweeps are chosen, or one of them, its transforms or the region
    of its images have changed; the bone is read anew each time.
    """

    def __init__(self):
        self._key = self._echoes = None

    def check(self, parameters, progress=None, echoes=None) -> Finding:
        """How well the CT agrees where it is.

        Parameters
        ----------
        parameters : AIFReconParameterNode
        progress : Progress or None
        echoes : SweepEchoes or None
            Default: those of the chosen sweep.

        Raises
        ------
        AIFReconError
            With what cannot be used and what to do.
        """
        start = rigidPlace(parameters.bone)
        bone = self._boneOf(parameters, part(progress, 0.0, 0.2))
        echoes = self._echoesOf(parameters, part(progress, 0.2, 0.9)) if echoes is None else echoes
        return inBackground(lambda _progress: _finding(echoes, bone, start), part(progress, 0.9, 1.0))

    def register(self, parameters, progress=None, echoes=None) -> Finding:
        """Where the CT belongs, from where it is or from anywhere; arguments and errors as for `check`."""
        from AIFReconLib.registration.registration import register_echoes

        start = rigidPlace(parameters.bone)
        bone = self._boneOf(parameters, part(progress, 0.0, 0.1))
        echoes = self._echoesOf(parameters, part(progress, 0.1, 0.5)) if echoes is None else echoes
        anywhere = parameters.registrationStart == RegistrationStart.ANYWHERE

        def work(progress):
            found = register_echoes(echoes, bone, None if anywhere else start, progress=progress)
            return _finding(echoes, bone, found.transform, found)

        return inBackground(work, part(progress, 0.5, 1.0))

    def _boneOf(self, parameters, progress):
        from AIFReconLib.registration.bone_field import BoneField

        labels = Inputs.fromParameters(parameters).labels(part(progress, 0.0, 0.5))
        return inBackground(lambda _progress: BoneField.from_labels(labels), part(progress, 0.5, 1.0))

    def _echoesOf(self, parameters, progress):
        from AIFReconLib.registration.echoes import sweep_echoes

        from ..sweep.browserItems import checkRecorded

        inputs = Inputs.fromParameters(parameters)
        for sweep in inputs.sweeps:
            checkRecorded(sweep)
        asked = (parameters.probe, inputs.recipe.apex_px, *regionFrom(parameters).values())
        key = sweepKey(inputs.sweep, inputs.imageSequence), *map(sweepKey, inputs.otherSweeps), asked
        if self._key != key:
            sequence = inputs.sequence()
            self._echoes = inBackground(lambda progress: sweep_echoes(sequence, inputs.recipe, progress=progress), progress)
            self._key = key
        return self._echoes


def _finding(echoes, bone, place, registration=None) -> Finding:
    from AIFReconLib.registration.agreement import check, fit_echoes

    drawn = echoes.thinned(MOST_DRAWN)
    distances = np.abs(fit_echoes(drawn, bone, place).distances)
    return Finding(check(echoes, bone, place), np.asarray(place), drawn.points, distances, echoes, bone, registration)


def rigidPlace(bone) -> np.ndarray:
    """Where a node's own coordinates lie in RAS world, (4, 4) mm.

    Raises
    ------
    TransformError
        Names the transform that is not linear.
    GeometryError
        When the transforms scale, shear or mirror.
    """
    from AIFReconLib.geometry.transforms import why_not_rigid

    place = matrixToWorld(bone)
    problem = why_not_rigid(place)
    if problem:
        raise GeometryError(
            f"The transforms above {bone.GetName()} must be rigid, turns and shifts; together they are {problem}. Take the scaling out "
            "of them."
        )
    return place
