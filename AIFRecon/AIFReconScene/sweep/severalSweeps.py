"""Several sweeps of one patient that are reconstructed as one: which are chosen beside the first, and which can be."""

import slicer

from ..sceneNodes import nodesOfClass


def furtherSweeps(parameters) -> tuple:
    """The sequence browsers that are chosen beside the first sweep, in their order; those that are gone are chosen no more."""
    first = parameters.sweep
    chosen = dict.fromkeys(node for node in parameters.otherSweeps if node is not None and node is not first)
    return tuple(node for node in chosen if node.GetScene() is not None) if first is not None else ()


def offered(parameters, status) -> list:
    """The sweeps of the scene that could be chosen beside the first, and those that are.

    Parameters
    ----------
    parameters : AIFReconParameterNode
    status : SweepStatus
        Knows which have frames that can be placed.
    """
    if parameters.sweep is None:
        return []
    chosen = furtherSweeps(parameters)
    others = [node for node in nodesOfClass("vtkMRMLSequenceBrowserNode", slicer.mrmlScene) if node is not parameters.sweep]
    return [node for node in others if node in chosen or not status.of(node).problem]
