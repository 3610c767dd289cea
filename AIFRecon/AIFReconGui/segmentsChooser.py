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
        comboBox.connect("checkedIndexesChanged()", self._onChecked)
        self._show([])

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        self._parameterNode = parameterNode
        self._shown = None

    def update(self) -> None:
        """Show the segments that there are and which of them are chosen."""
        bone = self._parameterNode.bone
        segments = []
        if bone is not None and bone.IsA("vtkMRMLSegmentationNode"):
            segmentation = bone.GetSegmentation()
            ids = [segmentation.GetNthSegmentID(number) for number in range(segmentation.GetNumberOfSegments())]
            segments = [(segmentID, segmentation.GetSegment(segmentID).GetName()) for segmentID in ids]
        chosen = list(self._parameterNode.boneSegments)
        if self._shown == (segments, chosen):
            return
        self._shown = (segments, chosen)
        self._show(segments, chosen)

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
