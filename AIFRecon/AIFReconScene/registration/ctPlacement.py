"""Moving a CT with its segmentation: the linear transform above both is set, one is made where there is none, and all can be undone."""

from dataclasses import dataclass

import numpy as np
import slicer

from AIFReconLib.errors import TransformError
from AIFReconLib.geometry.transforms import invert

from ..sceneNodes import freeName, proxiesOf
from ..transforms import matrixToParent, matrixToWorld, parentTransforms

NAME = "CTToReference"
"""Of a transform that is made."""


@dataclass(frozen=True)
class _Move:
    """What was there before a move: the transform's matrix, or, of one that was made, the parents of the nodes below it (IDs)."""

    moverID: str
    before: np.ndarray
    parents: tuple | None


class CTPlacement:
    """Moves bone and CT to where they belong, and back again.

    Notes
    -----
    Nothing is resampled and nothing hardened. Slicer's own Undo knows of every move, where the application has it switched on; `undo`
    works in any case, one move at a time.
    """

    def __init__(self):
        self._moves = []

    @property
    def canUndo(self) -> bool:
        """Whether a move can be taken back."""
        return any(slicer.mrmlScene.GetNodeByID(move.moverID) is not None for move in self._moves)

    def place(self, bone, ct, browser, labelsToWorld: np.ndarray) -> None:
        """Move bone, and the CT with it, so that `labelsToWorld` (4, 4), mm, leads from the bone's own coordinates to RAS world.

        The sweep, a sequence browser or None, stays where it is. Errors are those of `transformAbove`; nothing was moved then.
        """
        mover, scene = transformAbove(bone, ct, browser), slicer.mrmlScene
        below = [node for node in (bone, ct) if node is not None]
        above = matrixToWorld(bone if mover is None else mover)
        toParent = invert(above) @ labelsToWorld
        scene.SaveStateForUndo()
        if mover is not None:
            self._moves.append(_Move(mover.GetID(), matrixToParent(mover).copy(), None))
            mover.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(toParent))
            return
        mover = scene.AddNewNodeByClass("vtkMRMLLinearTransformNode", freeName(NAME))
        mover.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(toParent))
        mover.SetAndObserveTransformNodeID(bone.GetTransformNodeID())
        self._moves.append(_Move(mover.GetID(), np.eye(4), tuple((node.GetID(), node.GetTransformNodeID()) for node in below)))
        for node in below:
            node.SetAndObserveTransformNodeID(mover.GetID())

    def undo(self) -> bool:
        """Take the last move back; False where there is none, or its nodes are gone."""
        scene = slicer.mrmlScene
        while self._moves:
            move = self._moves.pop()
            mover = scene.GetNodeByID(move.moverID)
            if mover is None:
                continue
            scene.SaveStateForUndo()
            if move.parents is None:
                mover.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(move.before))
            else:
                _takeOut(mover, move.parents)
            return True
        return False


def transformAbove(bone, ct, browser):
    """The transform that places bone, the CT and nothing of the sweep; None where one is to be made below what is above them.

    A TransformError says that bone and CT do not move together, or that what is above them is not linear.
    """
    mover = bone.GetParentTransformNode()
    if ct is not None and ct.GetParentTransformNode() is not mover:
        names = [node.GetParentTransformNode().GetName() if node.GetParentTransformNode() else "-" for node in (ct, bone)]
        raise TransformError(
            f"{ct.GetName()} and {bone.GetName()} must be moved together, but lie under different transforms, {names[0]!r} and "
            f"{names[1]!r}. In Slicer's Data module, drag both onto the same transform."
        )
    matrixToWorld(bone)  # names a transform that is not linear
    ofSweep = {node.GetID() for proxy in proxiesOf(browser) for node in (proxy, *parentTransforms(proxy))}
    return None if mover is None or mover.GetID() in ofSweep else mover


def _takeOut(mover, parents) -> None:
    """Put the nodes back that a transform was made for, and remove it unless somebody has put more below it."""
    scene = slicer.mrmlScene
    for nodeID, parentID in parents:
        node = scene.GetNodeByID(nodeID)
        if node is not None and node.GetTransformNodeID() == mover.GetID():
            node.SetAndObserveTransformNodeID(parentID if parentID and scene.GetNodeByID(parentID) else None)
    if not any(node.GetTransformNodeID() == mover.GetID() for node in slicer.util.getNodesByClass("vtkMRMLTransformableNode")):
        scene.RemoveNode(mover)
    else:
        mover.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(np.eye(4)))
