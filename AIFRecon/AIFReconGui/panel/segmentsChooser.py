"""The list of segments that are bone, kept alike with the parameters: parameterNodeWrapper has no connector for checkable lists."""

import qt


class SegmentsChooser:
    """Shows the segments of the chosen segmentation with check marks; none checked means all.

    Parameters
    ----------
    comboBox : ctkCheckableComboBox
    label : QLabel
        Hidden with the list where the bone is no segmentation.
    """

    def __init__(self, comboBox, label):
        self._comboBox = comboBox
        self._label = label
        self._parameterNode = None
        self._updating = False
        self._shown = None
        self._boneID = None
        comboBox.connect("checkedIndexesChanged()", self._onChecked)
        self._show([])

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
        self._show(segments, chosen)

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

    def _show(self, segments, chosen=()) -> None:
        self._updating = True
        self._comboBox.clear()
        for segmentID, name in segments:
            self._comboBox.addItem(name, segmentID)
        for row, (segmentID, _name) in enumerate(segments):
            state = qt.Qt.Checked if not chosen or segmentID in chosen else qt.Qt.Unchecked
            self._comboBox.setCheckState(self._index(row), state)
        self._comboBox.visible = self._label.visible = bool(segments)
        self._updating = False

    def _index(self, row: int):
        return self._comboBox.model().index(row, self._comboBox.modelColumn)

    def _onChecked(self) -> None:
        if self._updating or self._parameterNode is None:
            return
        ids = [self._comboBox.itemData(row) for row in range(self._comboBox.count)]
        checked = [segmentID for row, segmentID in enumerate(ids) if self._comboBox.checkState(self._index(row)) == qt.Qt.Checked]
        chosen = [] if len(checked) == len(ids) else checked
        # Nothing checked means all, so all are checked again
        self._shown = (self._shown[0], chosen) if checked else None
        self._parameterNode.boneSegments = chosen
