"""What can be entered, pressed and read in the panel, as it follows from the parameters."""

from AIFReconScene.inputs import readiness
from AIFReconScene.inputs.boneSource import describeBone, lacksBoneOfCT
from AIFReconScene.inputs.parameters import ProbeShape, Region, SigmaUnit
from slicer.i18n import tr as _

from .layout import say


def updateDependentWidgets(ui, parameters, sweepText: str) -> None:
    """Show `sweepText` and what the bone is taken for, and the fields that count with these parameters."""
    say(ui.sweepStatusLabel, sweepText)
    say(ui.boneStatusLabel, describeBone(parameters))
    for label in (ui.sweepStatusLabel, ui.boneStatusLabel):
        label.visible = bool(label.text)
    ui.boneFromCTButton.visible = lacksBoneOfCT(parameters)
    ui.roiLabel.visible = ui.roiSelector.visible = parameters.region == Region.BOX
    ui.regionVolumeLabel.visible = ui.regionVolumeSelector.visible = parameters.region == Region.LIKE_VOLUME
    ui.spacingSpinBox.enabled = parameters.region != Region.LIKE_VOLUME
    ui.apexColumnSpinBox.enabled = ui.apexRowSpinBox.enabled = parameters.probe == ProbeShape.SECTOR
    ui.boneSigmaSpinBox.enabled = parameters.boneSigmaUnit != SigmaUnit.AUTOMATIC
    for spinBox in (ui.fanFirstRadiusSpinBox, ui.fanFirstAngleSpinBox, ui.fanLastAngleSpinBox):
        spinBox.enabled = parameters.fanLastRadius > 0
    ui.scannerSpeedOfSoundSpinBox.enabled = parameters.speedOfSound > 0
    ui.longestGapSpinBox.enabled = parameters.timeOffset != 0
    ui.singleViewButton.enabled = parameters.output is not None


def updateButtons(ui, logic, parameters, waits: str, report: str) -> None:
    """Enable what can be done, and say what is missing for the rest.

    `waits` says why everything has to wait, `report` what was done last, which stays to be read where something is missing for the next.
    """
    sweep = logic.sweepSummary(parameters)
    cannot = readiness.whyNotReconstruct(parameters, sweep)
    for button, missing, does in (
        (ui.loadButton, readiness.whyNotLoad(parameters), _("Read the recording into a sweep that can be replayed")),
        (ui.applyButton, cannot, _("Reconstruct the volume, and judge tracking, registration and coverage")),
        (ui.recognizeButton, readiness.whyNoImages(parameters, sweep), _("Set the rectangle of ultrasound that is recognized")),
        (ui.compareButton, readiness.whyNotCompare(parameters, sweep), _("Reconstruct with each method and show them side by side")),
    ):
        missing = waits or missing
        button.enabled = not missing
        button.toolTip = missing or does
    missing = readiness.withoutRepeating(cannot, ui.sweepStatusLabel.text)
    text = "\n".join(line for line in (report, missing) if line)
    ui.statusLabel.visible = bool(text)
    say(ui.statusLabel, text)
