"""Who says where bone is: one choice that both tabs show, each with the fields that count with it there."""

from AIFReconScene.inputs.boneSource import BoneSource

from .choosers import RowChooser


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
