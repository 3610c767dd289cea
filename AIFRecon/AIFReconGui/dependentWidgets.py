"""What can be entered and read in the panel, as it follows from the parameters."""

from AIFReconScene import readiness
from AIFReconScene.parameters import ProbeShape, Region


def updateDependentWidgets(ui, parameters, sweepText: str) -> None:
    """Show `sweepText` and what the bone is taken for, and enable the fields that count with these parameters."""
    ui.sweepStatusLabel.text = sweepText
    ui.boneStatusLabel.text = readiness.describeBone(parameters)
    for label in (ui.sweepStatusLabel, ui.boneStatusLabel):
        label.visible = bool(label.text)
    ui.roiSelector.enabled = parameters.region == Region.BOX
    ui.regionVolumeSelector.enabled = parameters.region == Region.LIKE_VOLUME
    ui.spacingSpinBox.enabled = parameters.region != Region.LIKE_VOLUME
    ui.apexColumnSpinBox.enabled = ui.apexRowSpinBox.enabled = parameters.probe == ProbeShape.SECTOR
    ui.singleViewButton.enabled = parameters.output is not None
