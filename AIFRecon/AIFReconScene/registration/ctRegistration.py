"""Where the CT belongs on the chosen sweep: nodes to arrays, and what the worker finds."""

import numpy as np

from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.transforms import why_not_rigid
from AIFReconLib.progress import part
from AIFReconLib.worker.placing import Found, PlacedCT, Placing, echoes_in

from ..inputs.inputs import Inputs
from ..inputs.parameters import RegistrationStart, regionFrom
from ..sweep.browserItems import checkRecorded
from ..sweep.sweepStatus import sweepKey
from ..transforms import matrixToWorld
from ..work import inWorker, worker


class CTRegistration:
    """Registers what the parameters name; the worker keeps the echoes of the sweep, and what was compared last.

    Notes
    -----
    Nothing of the scene is changed. Echoes are looked for again when other sweeps are chosen, or one of them, its transforms or the region
    of its images have changed; the bone is read anew each time.
    """

    def __init__(self):
        self._key = self._echoes = self._placing = None

    def check(self, parameters, progress=None, echoes=None) -> PlacedCT:
        """How well the CT agrees where it is; `echoes` are those of the chosen sweep by default. An AIFReconError says what cannot be."""
        start = rigidPlace(parameters.bone)
        self._begin(parameters, part(progress, 0.0, 0.9), echoes)
        return inWorker(Placing.at, self._placing, start, progress=part(progress, 0.9, 1.0))

    def register(self, parameters, progress=None, echoes=None) -> Found:
        """Where the CT belongs, from where it is or from anywhere; arguments and errors as for `check`."""
        place = rigidPlace(parameters.bone)
        self._begin(parameters, part(progress, 0.0, 0.5), echoes)
        begin = parameters.registrationStart
        start, apart = None if begin == RegistrationStart.ANYWHERE else place, begin == RegistrationStart.EACH_ON_ITS_OWN
        return inWorker(Placing.find, self._placing, start, apart, progress=part(progress, 0.5, 1.0))

    def at(self, place: np.ndarray) -> PlacedCT:
        """The echoes and the bone of the last call, in another place (4, 4)."""
        return inWorker(Placing.at, self._placing, place)

    def beginAt(self, place: np.ndarray):
        """A `Task` that does the same beside the windows."""
        return worker.begin(Placing.at, self._placing, place)

    def forget(self) -> None:
        """Have the worker forget all of it."""
        for kept in (self._echoes, self._placing):
            if kept is not None:
                worker.forget(kept)
        self._key = self._echoes = self._placing = None

    def _begin(self, parameters, progress, echoes) -> None:
        labels = Inputs.fromParameters(parameters).labels(part(progress, 0.0, 0.1))
        echoes = self._echoesOf(parameters, part(progress, 0.1, 0.9)) if echoes is None else echoes
        before, self._placing = self._placing, worker.keep(Placing, echoes, labels, progress=part(progress, 0.9, 1.0))
        if before is not None:
            worker.forget(before)

    def _echoesOf(self, parameters, progress):
        inputs = Inputs.fromParameters(parameters)
        for sweep in inputs.sweeps:
            checkRecorded(sweep)
        worker.listen()  # whether it has died
        asked = (parameters.probe, inputs.recipe.apex_px, *regionFrom(parameters).values())
        key = sweepKey(inputs.sweep, inputs.imageSequence), *map(sweepKey, inputs.otherSweeps), asked
        if self._key != (worker.pid, key):
            self.forget()
            self._echoes = worker.keep(echoes_in, inputs.sequence(), inputs.recipe, progress=progress)
            self._key = worker.pid, key
        return self._echoes


def rigidPlace(bone) -> np.ndarray:
    """Where a node's own coordinates lie in RAS world, (4, 4) mm.

    A TransformError names the transform that is not linear; a GeometryError says that the transforms scale, shear or mirror.
    """
    place = matrixToWorld(bone)
    problem = why_not_rigid(place)
    if problem:
        raise GeometryError(
            f"The transforms above {bone.GetName()} must be rigid, turns and shifts; together they are {problem}. Take the scaling out "
            "of them."
        )
    return place
