"""Bone that a scan shows by itself: predictions that are streamed with it, a network that looks at its frames, or their echoes."""

from AIFReconLib.bone.growing_bone import GrowingBone
from AIFReconLib.bone.predicted_bone import EchoEstimator
from AIFReconLib.live.session.bone_watch import BoneWatch, predictions_beside

from ..background import inBackground
from ..inputs.boneSource import BoneSource
from ..inputs.parameters import fileFrom


class LiveBone:
    """What looks for bone beside a session, and the map that grows by it.

    Parameters
    ----------
    parameters : AIFReconParameterNode
        Their source is another than the CT.
    record : Path or None
        Of the scan; what a network says is recorded beside it.
    progress : callable or None
        For a network, which is loaded and tried here.

    Raises
    ------
    ModelError
        When the file is no network that can be run.
    """

    def __init__(self, parameters, record=None, progress=None):
        self.bone = GrowingBone()
        chosen = parameters.boneSource
        self.device = parameters.liveBoneDevice.strip() if chosen == BoneSource.PREDICTIONS else None
        self._model = inBackground(lambda _progress: _modelIn(parameters), progress) if chosen == BoneSource.MODEL else None
        self._record = None if record is None or chosen == BoneSource.ECHOES else predictions_beside(record)
        self._watch = None

    def begin(self, session) -> None:
        """Look for bone in what this session receives from now on."""
        self._watch = BoneWatch(session, self.bone, None if self.device else self._estimator, self._record)

    def stop(self) -> None:
        """Look no more, and finish the recording."""
        if self._watch is not None:
            self._watch.stop()

    @property
    def recorded(self):
        """Where what the network said was recorded; None where it was not."""
        return None if self._watch is None else self._watch.recorded

    def lines(self, frames: int) -> list:
        """How it goes, after so many frames, in lines for the user."""
        if self._watch is None:
            return []
        state = self._watch.state
        lines = [f"Bone is known from {state.frames} of {frames} frames."]
        if state.unmatched:
            lines.append(f"{state.unmatched} predictions belong to no frame with a pose.")
        return lines if state.problem is None else [*lines, state.problem]

    def _estimator(self, imaging):
        return self._model or EchoEstimator(imaging)


def _modelIn(parameters):
    from AIFReconLib.bone.model import OnnxModel

    return OnnxModel(fileFrom(parameters.boneModelPath))
