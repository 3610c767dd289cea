"""Linear transforms that place nodes of the scene are set, or made where there is none, and all can be undone."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import slicer

from AIFReconLib.errors import TransformError
from AIFReconLib.geometry.transforms import invert

from ..sceneNodes import freeName, proxiesOf
from ..transforms import matrixToParent, matrixToWorld, parentTransforms

NAME = "CTToReference"
"""Of a transform that is made for a CT."""


@dataclass(frozen=True)
class Move:
    """What a transform becomes."""

    mover: Any  #: The transform; None: one is made between the nodes and what is above the first of them
    nodes: tuple  #: That lie below the one that is made
    name: str  #: Of the one that is made
    toParent: np.ndarray  #: (4, 4), mm


class Moves:
    """Does moves, some at a time, and takes them back.

    Notes
    -----
    Nothing is resampled and nothing hardened. Slicer's own Undo knows of every move, where the application has it switched on; `undo`
    works in any case.
    """

    def __init__(self):
        self._done = []

    @property
    def canUndo(self) -> bool:
        """Whether moves can be taken back."""
        return any(slicer.mrmlScene.GetNodeByID(moverID) is not None for done in self._done for moverID, _before in done)

    def do(self, *moves: Move) -> None:
        """Do these together."""
        slicer.mrmlScene.SaveStateForUndo()
        self._done.append([_done(move) for move in moves])

    def undo(self) -> bool:
        """Take back what was done last; False where nothing was, or its nodes are gone."""
        scene = slicer.mrmlScene
        while self._done:
            last = [(scene.GetNodeByID(moverID), before) for moverID, before in self._done.pop()]
            if any(mover is not None for mover, _before in last):
                scene.SaveStateForUndo()
                for mover, before in last:
                    _takeBack(mover, before)
                return True
        return False


def _done(move: Move) -> tuple:
    """The transform's ID, and its matrix before; None where it was made."""
    mover, before = move.mover, None if move.mover is None else matrixToParent(move.mover).copy()
    if mover is None:
        mover = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLLinearTransformNode", freeName(move.name))
        mover.SetAndObserveTransformNodeID(move.nodes[0].GetTransformNodeID())
    mover.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(move.toParent))
    for node in move.nodes if before is None else ():
        node.SetAndObserveTransformNodeID(mover.GetID())
    return mover.GetID(), before


def _takeBack(mover, before) -> None:
    """A transform as it was; one that was made goes, and what is below it lies under what is above it."""
    if mover is None:
        return
    if before is not None:
        mover.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(before))
        return
    for node in slicer.util.getNodesByClass("vtkMRMLTransformableNode"):
        if node.GetTransformNodeID() == mover.GetID():
            node.SetAndObserveTransformNodeID(mover.GetTransformNodeID())
    slicer.mrmlScene.RemoveNode(mover)


def placing(bone, ct, browser, labelsToWorld: np.ndarray) -> Move:
    """Of bone, and the CT with it, so that `labelsToWorld` (4, 4), mm, leads from the bone's own coordinates to RAS world.

    The sweep, a sequence browser or None, stays where it is. Errors are those of `transformAbove`.
    """
    mover = transformAbove(bone, ct, browser)
    nodes = tuple(node for node in (bone, ct) if node is not None)
    return Move(mover, nodes, NAME, invert(matrixToWorld(bone if mover is None else mover)) @ labelsToWorld)


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
