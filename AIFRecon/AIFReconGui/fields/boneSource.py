"""Who says where bone is: one choice that both tabs show, each with the fields that count with it there."""

from AIFReconScene.inputs.boneSource import BoneSource

from .choosers import Follower


class BoneSourceChooser(Follower):
    """Keeps a list and the parameter `boneSource` alike, and shows those of `fieldsOf` that belong to the source that is chosen."""

    def __init__(self, comboBox, fieldsOf, live=False):
        self._comboBox, self._fieldsOf = comboBox, fieldsOf
        self._updating = False
        for source in BoneSource:
            comboBox.addItem(source.label(live))
        comboBox.connect("currentIndexChanged(int)", self._onChosen)
        self._show(BoneSource.CT)

    def update(self) -> None:
        """Show which source is chosen."""
        self._updating = True
        self._comboBox.currentIndex = list(BoneSource).index(self._parameterNode.boneSource)
        self._updating = False
        self._show(self._parameterNode.boneSource)

    def _show(self, chosen) -> None:
        for source, fields in self._fieldsOf.items():
            for widget in fields:
                widget.visible = source == chosen

    def _onChosen(self, row: int) -> None:
        if not self._updating and self._parameterNode is not None and row >= 0:
            self._parameterNode.boneSource = list(BoneSource)[row]


def ofRecorded(ui) -> BoneSourceChooser:
    """The choice in the tab Recorded."""
    fieldsOf = {
        BoneSource.PREDICTIONS: (ui.bonePredictionsLabel, ui.bonePredictionsSelector),
        BoneSource.MODEL: (ui.boneModelPathLabel, ui.boneModelPathLineEdit),
    }
    return BoneSourceChooser(ui.boneSourceComboBox, fieldsOf)


def ofScan(ui) -> BoneSourceChooser:
    """The choice in the tab Live."""
    fieldsOf = {
        BoneSource.PREDICTIONS: (ui.liveBoneDeviceLabel, ui.liveBoneDeviceLineEdit),
        BoneSource.MODEL: (ui.liveBoneModelLabel, ui.liveBoneModelPathLineEdit),
    }
    return BoneSourceChooser(ui.liveBoneSourceComboBox, fieldsOf, live=True)
