"""The list of segments that are bone, kept alike with the parameters."""

from .checkableList import CheckableList


class SegmentsChooser:
    """Shows the segments of the chosen segmentation with check marks; none checked means all.

    Parameters
    ----------
    comboBox : ctkCheckableComboBox
    label : QLabel
        Hidden with the list where the bone is no segmentation.
    """

    def __init__(self, comboBox, label):
        self._list = CheckableList(comboBox, label, self._onChecked)
        self._parameterNode = None
        self._shown = None
        self._boneID = None

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        self._parameterNode = parameterNode
        self._shown = self._boneID = None

    def update(self) -> None:
        """Show the segments that there are and which of them are chosen."""
        bone = self._parameterNode.bone
        segments = []
        if bone is not None and bone.IsA("vtkMRMLSegmentationNode"):
            segmentation = bone.GetSegmentation()
            ids = [segmentation.GetNthSegmentID(number) for number in range(segmentation.GetNumberOfSegments())]
            segments = [(segmentID, segmentation.GetSegment(segmentID).GetName()) for segmentID in ids]
        chosen = self._stillThere(bone, [segmentID for segmentID, _name in segments])
        if self._shown == (segments, chosen):
            return
        self._shown = (segments, chosen)
        self._list.show(segments, chosen or [segmentID for segmentID, _name in segments])

    def _stillThere(self, bone, present) -> list:
        """The chosen segments. Those of another segmentation, which may have the same IDs, and removed ones are chosen no more."""
        chosen = list(self._parameterNode.boneSegments)
        kept = [segmentID for segmentID in chosen if segmentID in present]
        boneID = bone.GetID() if bone is not None else None
        if self._boneID is not None and boneID != self._boneID:
            kept = []
        self._boneID = boneID if boneID is not None else self._boneID
        # A segmentation without segments may be one whose file is still to be read
        if not present or kept == chosen:
            return chosen
        self._parameterNode.boneSegments = kept
        return kept

    def _onChecked(self, checked) -> None:
        if self._parameterNode is None:
            return
        chosen = [] if len(checked) == len(self._shown[0]) else checked
        # Nothing checked means all, so all are checked again
        self._shown = (self._shown[0], chosen) if checked else None
        self._parameterNode.boneSegments = chosen
