"""What happens to the chosen nodes while the panel is open: a frame is shown, a transform moves, a segment is drawn, a node goes."""

from functools import partial

import slicer
import vtk

from ..sceneNodes import sequencesOf
from ..sweep.sweepStatus import furtherSweeps, sweepKey
from .boxes import isEmpty

CHOSEN = ("sweep", "imageSequence", "ctVolume", "bone", "bonePredictions", "roi", "regionVolume", "output", "liveImage", "pathPoint")
"""The parameters that name a node."""


class InputWatch:
    """Observes the sweep, its image, the bone, the box and the point that the parameters name, and the other sweeps of the scene.

    `onChanged` is called when what is known of them no longer holds, `onMoved` when the sweep merely shows another frame, and
    ``onGone(node)`` when any node has gone. A node that is about to be deleted is chosen no more, before the panel's lists choose
    its neighbor instead: a CT that takes the place of a deleted bone would be taken for the probability of bone.
    """

    def __init__(self, onChanged, onMoved, onGone):
        self._onChanged, self._onMoved, self._onGone = onChanged, onMoved, onGone
        self._followed = None
        self._observations = []
        self._keys = {}
        self._boxIsEmpty = False

    def follow(self, parameters) -> None:
        """Observe what these parameters name."""
        sweep, images, bone = parameters.sweep, parameters.imageSequence, parameters.bone
        replayed = {browser: _imageOf(browser, images if browser is sweep else None) for browser in (sweep, *furtherSweeps(parameters))}
        browsers = slicer.util.getNodesByClass("vtkMRMLSequenceBrowserNode")
        self._keys = {browser.GetID(): sweepKey(browser, images if browser is sweep else None) for browser in browsers}
        self._boxIsEmpty = parameters.roi is not None and isEmpty(parameters.roi)
        sequences = {each: browser for browser in replayed for each in sequencesOf(browser)}
        followed = (parameters, sweep, images, bone, parameters.roi, parameters.pathPoint, *browsers, None, *replayed.values(), *sequences)
        before = self._followed or ()
        if len(followed) == len(before) and all(one is other for one, other in zip(followed, before)):
            return
        self.stop()
        self._followed = followed
        self._observe(slicer.mrmlScene, slicer.vtkMRMLScene.NodeAboutToBeRemovedEvent, self._onNodeGoes)
        self._observe(slicer.mrmlScene, slicer.vtkMRMLScene.NodeAddedEvent, self._onNodes)
        self._observe(slicer.mrmlScene, slicer.vtkMRMLScene.NodeRemovedEvent, self._onNodeGone)
        for browser in browsers:
            self._observe(browser, vtk.vtkCommand.ModifiedEvent, partial(self._onBrowser, browser))
        for sequence, browser in sequences.items():  # renamed, for instance
            self._observe(sequence, vtk.vtkCommand.ModifiedEvent, partial(self._onBrowser, browser))
        for browser, image in replayed.items():
            if image is not None:
                self._observe(image, slicer.vtkMRMLTransformableNode.TransformModifiedEvent, partial(self._onBrowser, browser))
        if parameters.roi is not None:
            self._observe(parameters.roi, vtk.vtkCommand.ModifiedEvent, self._onBox)
        if parameters.pathPoint is not None:
            self._observe(parameters.pathPoint, slicer.vtkMRMLMarkupsNode.PointPositionDefinedEvent, lambda *placed: self._onChanged())
        if bone is not None and bone.IsA("vtkMRMLSegmentationNode"):
            events = slicer.vtkSegmentation
            for event in (events.SegmentAdded, events.SegmentRemoved, events.SegmentModified):
                self._observe(bone, event, self._onBone)

    def stop(self) -> None:
        """Observe nothing any more."""
        for node, tag in self._observations:
            node.RemoveObserver(tag)
        self._observations, self._followed = [], None

    def _observe(self, node, event, slot) -> None:
        self._observations.append((node, node.AddObserver(event, slot)))

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onNodeGoes(self, caller, event, node) -> None:
        if caller.IsBatchProcessing():
            return
        parameters = self._followed[0]
        for name in CHOSEN:
            if getattr(parameters, name) is node:
                setattr(parameters, name, None)
        others = furtherSweeps(parameters)
        if node in others:
            parameters.otherSweeps = [other for other in others if other is not node]

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onNodes(self, caller, event, node) -> None:
        if node.IsA("vtkMRMLSequenceBrowserNode") and not caller.IsBatchProcessing():
            self._onChanged()

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onNodeGone(self, caller, event, node) -> None:
        if not caller.IsBatchProcessing():
            self._onGone(node)
            self._onNodes(caller, event, node)

    def _onBrowser(self, browser, caller, event) -> None:
        _parameters, sweep, images, *_others = self._followed
        if browser.GetScene() is None or browser.GetScene().IsBatchProcessing():
            return
        key = sweepKey(browser, images if browser is sweep else None)
        if key != self._keys.get(browser.GetID()):
            self._keys[browser.GetID()] = key
            self._onChanged()
        elif browser is sweep:
            self._onMoved()

    def _onBone(self, caller, event) -> None:
        if caller.GetScene() is not None and not caller.GetScene().IsBatchProcessing():
            self._onChanged()

    def _onBox(self, caller, event) -> None:
        if isEmpty(caller) != self._boxIsEmpty:
            self._onChanged()


def _imageOf(browser, imageSequence=None):
    """The node that a sweep's images are replayed into; None where it has none."""
    sequence = browser and (imageSequence or browser.GetMasterSequenceNode())
    return browser.GetProxyNode(sequence) if sequence else None
