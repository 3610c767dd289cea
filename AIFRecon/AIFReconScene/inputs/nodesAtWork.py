"""The nodes that long work needs, and what happens to them meanwhile: the views stay alive, so the user can delete any of them."""

import slicer
import vtk
from slicer.i18n import tr as _

from ..sceneNodes import proxiesOf, sequencesOf
from ..transforms import parentTransforms


class NodesAtWork:
    """Hears when one of the nodes goes that parameters name, or the whole scene; use it as a context manager.

    They are those of the moment when work begins, what a sweep is made of, and the transforms above all of them. `onLost` is called when
    the first is about to go; `lost` says in a sentence which, and is empty while all are there.
    """

    def __init__(self, parameters, onLost):
        self._parameterNode = parameters.parameterNode
        self._onLost = onLost
        self._nodes = []
        self._tags = []
        self.lost = ""

    def __enter__(self):
        scene, events = slicer.mrmlScene, slicer.vtkMRMLScene
        self._nodes = _needed(self._parameterNode)
        self._tags = [
            scene.AddObserver(events.NodeAboutToBeRemovedEvent, self._onNodeGoes),
            scene.AddObserver(events.StartCloseEvent, self._onSceneCloses),
        ]
        return self

    def __exit__(self, *exception):
        for tag in self._tags:
            slicer.mrmlScene.RemoveObserver(tag)
        self._nodes, self._tags = [], []

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onNodeGoes(self, caller, event, node) -> None:
        if any(node is each for each in self._nodes):
            self._lose(_("{name} was deleted meanwhile. Nothing was changed.").format(name=node.GetName()))

    def _onSceneCloses(self, caller, event) -> None:
        self._lose(_("The scene was closed meanwhile."))

    def _lose(self, sentence: str) -> None:
        if not self.lost:
            self.lost = sentence
            self._onLost()


def _needed(parameterNode) -> list:
    """The nodes that a parameter node refers to, with all that they are made of and placed by."""
    nodes = [parameterNode]
    for number in range(parameterNode.GetNumberOfNodeReferenceRoles()):
        role = parameterNode.GetNthNodeReferenceRole(number)
        nodes += [parameterNode.GetNthNodeReference(role, which) for which in range(parameterNode.GetNumberOfNodeReferences(role))]
    nodes = [node for node in nodes if node is not None]
    for browser in [node for node in nodes if node.IsA("vtkMRMLSequenceBrowserNode")]:
        nodes += [*proxiesOf(browser), *sequencesOf(browser)]
    placed = [node for node in nodes if node.IsA("vtkMRMLTransformableNode")]
    return nodes + [parent for node in placed for parent in parentTransforms(node)]
