"""The chosen sweeps' calibration, from what they show of the CT's bone: the worker finds it, and a transform of the scene takes it."""

import numpy as np

from AIFReconLib.geometry.transforms import invert, with_unit_depth
from AIFReconLib.progress import part
from AIFReconLib.worker.evaluating import calibrated_by

from ..inputs.inputs import Inputs
from ..sweep.browserItems import BrowserItems, checkRecorded
from ..sweep.sequenceReader import IMAGE_TO_WORLD
from ..sweep.sweepPoses import calibrationOf
from ..transforms import ijkToRAS, matrixToParent
from ..work import inWorker
from .ctRegistration import rigidPlace
from .moves import Move


def calibrated(parameters, progress=None) -> tuple:
    """What the chosen sweeps say of their calibration, a `Calibrated`, and the `Move`s that change it, none where nothing is to be changed.

    An AIFReconError says what cannot be calibrated and what to do.
    """
    inputs = Inputs.fromParameters(parameters)
    changed = []
    for sweep in inputs.sweeps:
        checkRecorded(sweep)
        items = BrowserItems(sweep, inputs.imageSequence if sweep is inputs.sweep else None)
        changed.append((items, calibrationOf(items)))  # what cannot be is said before any work
    place, labels, sequence = rigidPlace(inputs.bone), inputs.labels(part(progress, 0.0, 0.1)), inputs.sequence()
    found = inWorker(calibrated_by, sequence, labels, place, inputs.recipe, progress=part(progress, 0.1, 1.0))
    moves: dict = {}
    for (items, mover), sweep in zip(changed, sequence.sweeps):
        if found.image_correction is not None:
            # Sweeps may lie under one and the same
            moves.setdefault(mover or items, _move(items, mover, sweep, found.image_correction))
    return found, list(moves.values())


def _move(items: BrowserItems, mover, sweep, correction: np.ndarray) -> Move:
    """The move by which each pose M (pixels to RAS) becomes `with_unit_depth` (M) @ correction."""
    image = items.browser.GetProxyNode(items.images)
    poses = (record.transforms[IMAGE_TO_WORLD].matrix for record in sweep.records)
    pose = next(matrix for matrix in poses if np.isfinite(matrix).all())
    own = np.eye(4) if image is None or image.GetParentTransformNode() is None else ijkToRAS(items.images.GetNthDataNode(0))
    change = own @ invert(pose) @ with_unit_depth(pose) @ correction @ invert(own)
    if mover is not None:
        return Move(mover, (), "", matrixToParent(mover) @ change)
    return Move(None, (image,), f"{image.GetName()} calibration", change)
