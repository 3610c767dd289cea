"""What happens to the chosen nodes while the panel is open: a frame is shown, a transform moves, a segment is drawn, a node goes."""

import slicer
import vtk

from ..sweep.sweepStatus import sweepKey
from .boxes import isEmpty

CHOSEN = ("sweep", "imageSequence", "ctVolume", "bone", "roi", "regionVolume", "output", "liveImage")
"""The parameters that name a node."""


class InputWatch:
    """Observes the sweep, its image, the bone and the box that the parameters name.

    Parameters
    ----------
    onChanged : callable
        Called without arguments when what is known of them no longer holds.
    onMoved : callable
        Called without arguments when the sweep merely shows another frame.

    Notes
    -----
    A node that is about to be deleted is chosen no more, before the panel's lists choose its neighbor instead: a CT that takes the place
    of a deleted bone would be taken for the probability of bone.
    """

    def __init__(self, onChanged, onMoved):
        self._onChanged = onChanged
        self._onMoved = onMoved
        self._followed = None
        self._observations = []
        self._key = None
        self._boxIsEmpty = False

    def follow(self, parameters) -> None:
        """Observe what these parameters name."""
        sweep, images, bone = parameters.sweep, parameters.imageSequence, parameters.bone
        image = sweep.GetProxyNode(images or sweep.GetMasterSequenceNode()) if sweep is not None and sweep.GetMasterSequenceNode() else None
        self._key = sweepKey(sweep, images) if sweep is not None else None
        self._boxIsEmpty = parameters.roi is not None and isEmpty(parameters.roi)
        followed = (parameters, sweep, images, bone, image, parameters.roi)
        if self._followed is not None and all(one is other for one, other in zip(followed, self._followed)):
            return
        self.stop()
        self._followed = followed
        self._observe(slicer.mrmlScene, slicer.vtkMRMLScene.NodeAboutToBeRemovedEvent, self._onNodeGoes)
        if sweep is not None:
            self._observe(sweep, vtk.vtkCommand.ModifiedEvent, self._onSweep)
        if image is not None:
            self._observe(image, slicer.vtkMRMLTransformableNode.TransformModifiedEvent, self._onSweep)
        if parameters.roi is not None:
            self._observe(parameters.roi, vtk.vtkCommand.ModifiedEvent, self._onBox)
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

    def _onSweep(self, caller, event) -> None:
        _parameters, sweep, images, *_others = self._followed
        if sweep.GetScene() is None or sweep.GetScene().IsBatchProcessing():
            return
        key = sweepKey(sweep, images)
        if key == self._key:
            self._onMoved()
        else:
            self._key = key
            self._onChanged()

    def _onBone(self, caller, event) -> None:
        if caller.GetScene() is not None and not caller.GetScene().IsBatchProcessing():
            self._onChanged()

    def _onBox(self, caller, event) -> None:
        if isEmpty(caller) != self._boxIsEmpty:
            self._onChanged()
