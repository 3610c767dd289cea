"""Lists of the panel that parameterNodeWrapper has no connector for: sweeps, segments, methods, presets; and the box that lays itself."""

import contextlib
from typing import Any

import qt
import slicer
from AIFReconScene.inputs import boxes, presets
from AIFReconScene.inputs.boneSource import BoneSource
from AIFReconScene.inputs.parameters import Method, Region
from AIFReconScene.picture.freePaths import A_POINT, levelsOf
from AIFReconScene.sweep.sweepStatus import furtherSweeps
from slicer.i18n import tr as _

from AIFReconLib.compounding.methods.table import method_named, registered_methods


class Follower:
    """What follows the parameters beside the widgets that parameterNodeWrapper connects."""

    _parameterNode: Any = None

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        self._parameterNode = parameterNode


class CheckableList(Follower):
    """Items of a ctkCheckableComboBox, kept alike with what the parameters say; hidden with its label where there are none."""

    def __init__(self, comboBox, label):
        self._comboBox, self._label = comboBox, label
        self._shown: Any = None
        comboBox.connect("checkedIndexesChanged()", self._onIndexes)
        self._show([], [])

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        super().setParameterNode(parameterNode)
        self._shown = None

    def _check(self, checked: list) -> None:
        """The user has checked the items of these keys."""
        raise NotImplementedError

    def _show(self, items, checked) -> None:
        """Show items, as (key, name), and check those of these keys."""
        self._updating = True
        self._comboBox.clear()
        for key, name in items:
            self._comboBox.addItem(name, key)
        for row, (key, _name) in enumerate(items):
            self._comboBox.setCheckState(self._index(row), qt.Qt.Checked if key in checked else qt.Qt.Unchecked)
        self._comboBox.visible = self._label.visible = bool(items)
        self._updating = False

    def _index(self, row: int):
        return self._comboBox.model().index(row, self._comboBox.modelColumn)

    def _onIndexes(self) -> None:
        if not self._updating and self._parameterNode is not None:
            rows = [row for row in range(self._comboBox.count) if self._comboBox.checkState(self._index(row)) == qt.Qt.Checked]
            self._check([self._comboBox.itemData(row) for row in rows])


class SweepsChooser(CheckableList):
    """Shows the other sweeps of the scene that have frames which can be placed; those that are checked enter the volume too.

    `offered` leads from the parameters to the sequence browsers that can be chosen.
    """

    def __init__(self, comboBox, label, offered):
        super().__init__(comboBox, label)
        self._offered = offered

    def update(self) -> None:
        """Show the sweeps that there are."""
        chosen = [browser.GetID() for browser in furtherSweeps(self._parameterNode)]
        shown = [(browser.GetID(), browser.GetName()) for browser in self._offered(self._parameterNode)], chosen
        if shown != self._shown:
            self._shown = shown
            self._show(*shown)

    def _check(self, checked: list) -> None:
        self._shown = (self._shown[0], checked)
        self._parameterNode.otherSweeps = [slicer.mrmlScene.GetNodeByID(each) for each in checked]


class SegmentsChooser(CheckableList):
    """Shows the segments of the chosen segmentation with check marks; none checked means all."""

    _boneID = None

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        super().setParameterNode(parameterNode)
        self._boneID = None

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
        self._show(segments, chosen or [segmentID for segmentID, _name in segments])

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

    def _check(self, checked: list) -> None:
        chosen = [] if len(checked) == len(self._shown[0]) else checked
        # Nothing checked means all, so all are checked again
        self._shown = (self._shown[0], chosen) if checked else None
        self._parameterNode.boneSegments = chosen


class RowChooser(Follower):
    """A list of which one row is chosen, kept alike with what the parameters say."""

    def __init__(self, comboBox):
        self._comboBox, self._updating = comboBox, False
        comboBox.connect("currentIndexChanged(int)", self._onChosen)

    @contextlib.contextmanager
    def _untold(self):
        """What changes within was not chosen by the user."""
        self._updating = True
        yield
        self._updating = False

    def _choose(self, row: int) -> None:
        """The user has chosen this row."""
        raise NotImplementedError

    def _onChosen(self, row: int) -> None:
        if not self._updating and self._parameterNode is not None and row >= 0:
            self._choose(row)


class MethodChooser(RowChooser):
    """Keeps the list and two parameters alike: `method`, and `ownMethod`, which comes before it where it is not empty."""

    _own: Any = None

    def update(self) -> None:
        """Show the methods that there are, and which is chosen; one that a scene was saved with is shown even where it is not known."""
        chosen, known = self._parameterNode.ownMethod, registered_methods()
        own = (*known, *((chosen,) if chosen and chosen not in known else ()))
        with self._untold():
            if own != self._own:
                self._own = own
                self._comboBox.clear()
                for label in (*(method.label() for method in Method), *own):
                    self._comboBox.addItem(label)
                for row, method in enumerate(Method):
                    words = method_named(method.value).words if method.value else ""
                    self._comboBox.setItemData(row, words, qt.Qt.ToolTipRole)
            self._comboBox.currentIndex = len(Method) + own.index(chosen) if chosen else list(Method).index(self._parameterNode.method)

    def _choose(self, row: int) -> None:
        if row < len(Method):
            self._parameterNode.method = list(Method)[row]
        self._parameterNode.ownMethod = "" if row < len(Method) else self._own[row - len(Method)]


class PresetChooser(RowChooser):
    """Sets many parameters at once, and says which preset they are now; "own settings" where they are none."""

    def __init__(self, comboBox):
        super().__init__(comboBox)
        for label in (*(preset.label() for preset in presets.Preset), _("Own settings")):
            comboBox.addItem(label)

    def update(self) -> None:
        """Show which preset the parameters are."""
        known = presets.presetOf(self._parameterNode)
        with self._untold():
            self._comboBox.currentIndex = len(presets.Preset) if known is None else list(presets.Preset).index(known)

    def _choose(self, row: int) -> None:
        if row < len(presets.Preset):
            presets.choose(self._parameterNode, list(presets.Preset)[row])
        self.update()


class TargetChooser(RowChooser):
    """Where paths lead: between two neighboring bones, or to a point, which the last row stands for; kept alike with `pathTarget`."""

    _levels: Any = None

    def update(self) -> None:
        """Show the levels that there are, and which is chosen."""
        levels = levelsOf(self._parameterNode)
        with self._untold():
            if levels != self._levels:
                self._levels = levels
                self._comboBox.clear()
                for level in (*levels, _("a point")):
                    self._comboBox.addItem(level)
            chosen = self._parameterNode.pathTarget
            rows = [*levels, A_POINT]
            self._comboBox.currentIndex = rows.index(chosen) if chosen in rows else 0

    @property
    def level(self) -> str | None:
        """What the library calls it; None: a point."""
        return dict(enumerate((self._levels or {}).values())).get(self._comboBox.currentIndex)

    def _choose(self, row: int) -> None:
        self._parameterNode.pathTarget = [*self._levels, A_POINT][row]


class BoneSourceChooser(RowChooser):
    """Keeps a list and the parameter `boneSource` alike, and shows the widgets `fieldsOf` each source with that alone."""

    def __init__(self, comboBox, fieldsOf, live=False):
        super().__init__(comboBox)
        self._fieldsOf = fieldsOf
        for source in BoneSource:
            comboBox.addItem(source.label(live))
        self._show(BoneSource.CT)

    def update(self) -> None:
        """Show which source is chosen."""
        with self._untold():
            self._comboBox.currentIndex = list(BoneSource).index(self._parameterNode.boneSource)
        self._show(self._parameterNode.boneSource)

    def _show(self, chosen) -> None:
        for source, fields in self._fieldsOf.items():
            for widget in fields:
                widget.visible = source == chosen

    def _choose(self, row: int) -> None:
        self._parameterNode.boneSource = list(BoneSource)[row]


def boneSourceOfRecorded(ui) -> BoneSourceChooser:
    """The choice in the tab Recorded."""
    fieldsOf = {
        BoneSource.PREDICTIONS: (ui.bonePredictionsLabel, ui.bonePredictionsSelector),
        BoneSource.MODEL: (ui.boneModelPathLabel, ui.boneModelPathLineEdit),
    }
    return BoneSourceChooser(ui.boneSourceComboBox, fieldsOf)


def boneSourceOfScan(ui) -> BoneSourceChooser:
    """The choice in the tab Live."""
    fieldsOf = {
        BoneSource.PREDICTIONS: (ui.liveBoneDeviceLabel, ui.liveBoneDeviceLineEdit),
        BoneSource.MODEL: (ui.liveBoneModelLabel, ui.liveBoneModelPathLineEdit),
    }
    return BoneSourceChooser(ui.liveBoneSourceComboBox, fieldsOf, live=True)


class BoxChooser(Follower):
    """A new box is laid around the sweep or the CT as soon as it is chosen; one that has a place already stays as it is."""

    def update(self) -> None:
        """Lay the chosen box around what there is, if it is empty."""
        parameters = self._parameterNode
        if parameters.region == Region.BOX and parameters.roi is not None and boxes.isEmpty(parameters.roi):
            boxes.layAround(parameters.roi, parameters)
