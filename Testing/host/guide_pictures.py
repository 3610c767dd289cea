"""Pictures of the steps in the user guide: Resources/Screenshots/step-*.png, made by `screenshots.py`.

Each function takes the `Module` of that program at the step that its name tells, and the folder to write into.
"""

from __future__ import annotations

from pathlib import Path

from . import view_frames

PANEL_WIDTH = 400
PROGRESS_AT = 0.45
"""Share of the work at which the dialog is pictured."""

SIZE = (400, 300)
"""Of a view in a picture of four, pixels."""

BESIDE = (340, 300)
"""Of one of two views beside the panel."""


def empty(module, folder: Path) -> None:
    """step-1-empty.png: the panel in an empty scene, with the reason why nothing can be reconstructed."""
    view_frames.write_png(_panel(module), folder / "step-1-empty.png")


def imported(module, folder: Path) -> None:
    """step-import.png: the sample's sweep as an array and a table of two tools, after what they leave open was answered."""
    import tempfile

    import numpy as np
    import tinyScene
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    importer = module.widget._recorded.importer
    with tempfile.TemporaryDirectory() as name:
        poses = tinyScene.writeForeign(Path(name), sequenceFromBrowser(module.parameters.sweep))
        spacing = np.linalg.norm(poses[0][:3, :2], axis=0)
        module.press(module.widget.ui.importButton)
        ui = importer._ui
        ui.imagesLineEdit.currentPath, ui.posesLineEdit.currentPath = str(Path(name) / "images.npy"), str(Path(name) / "poses.csv")
        ui.transformComboBox.currentIndex = 1
        module.press(ui.importCheckButton)
        for question, answer in (("tool", "Probe"), ("time_unit", "ms"), ("spacing", f"{spacing[0]:.4g} {spacing[1]:.4g}")):
            importer._answers[question].currentText = answer
            module.press(ui.importCheckButton)
        ui.imagesLineEdit.comboBox().blockSignals(True)
        ui.posesLineEdit.comboBox().blockSignals(True)
        ui.imagesLineEdit.currentPath, ui.posesLineEdit.currentPath = "sweep.npy", "tracker.csv"
        module.host.process_events()
        window = importer._window._object
        window.adjustSize()
        view_frames.write_png(view_frames.titled(window.grab().toImage(), window.windowTitle()), folder / "step-import.png")
        importer._window.close()


def registration(module, folder: Path) -> None:
    """step-registration.png: a CT that lies 9 mm off is checked, then placed: the section, and the echoes in a slice and in 3D."""
    import numpy as np
    import slicer

    ui, parameters = module.widget.ui, module.parameters
    transform = parameters.bone.GetParentTransformNode()
    true = slicer.util.arrayFromTransformMatrix(transform)
    away = np.eye(4)
    away[:3, 3] = 4.0, -3.0, 7.0
    ui.registrationMoreButton.checked = True
    rows = []
    for button, matrix in ((ui.checkButton, away @ true), (ui.placeButton, None)):
        if matrix is not None:
            transform.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(matrix))
        module.press(button)
        section = _section(module, ui.registrationSignalLabel, ui.coverageSignalLabel)
        rows.append([section, module.slice_view("Yellow", BESIDE, field_of_view=100.0), _echoes_in_3d(module)])
    view_frames.write_png(view_frames.tiled(rows, background=_background(module)), folder / "step-registration.png")
    module.widget._registration.forget()
    transform.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(true))
    ui.registrationMoreButton.checked = False


def _section(module, first, beyond):
    """The panel from one widget to before another; their places are known once it has its size."""
    panel = _panel(module)
    top, end = _top(module, first) - 8, _top(module, beyond) - 8
    return panel.copy(0, top, PANEL_WIDTH, end - top)


def _echoes_in_3d(module):
    from AIFReconScene.display import threeDViews

    threeDViews.makeSurface(module.parameters.bone)
    echoes = module.widget._registration._echoes.node
    return module.view_3d("1   Bone of the CT, echoes of the sweep", BESIDE, echoes, (-120.0, -300.0, 120.0), 300.0)


def guidance(module, folder: Path) -> None:
    """step-guidance.png: the bone in the colors of how the sweep met it, with the ghost of the probe, and what the panel says of it."""
    ui = module.widget.ui
    ui.coverageMoreButton.checked = True
    ui.guidanceCheckBox.click()
    module.check()
    bone = module.widget._guidance._colors.node
    title = "1   Bone hit by the sweep, and the next move"
    shown = module.view_3d(title, (560, 480), bone, (-130.0, -300.0, 110.0), 430.0, beside=(0.0, -25.0, 0.0))
    section = _section(module, ui.coverageSignalLabel, ui.calibrationSignalLabel)
    picture = view_frames.tiled([[section, shown]], background=_background(module))
    view_frames.write_png(picture, folder / "step-guidance.png")
    ui.guidanceCheckBox.click()
    ui.coverageMoreButton.checked = False


def settings(module, folder: Path) -> None:
    """step-3-settings.png: the settings, all opened, in two columns."""
    ui = module.widget.ui
    groups = [ui.displayGroupBox, ui.volumeGroupBox, ui.volumeAdvancedGroupBox, ui.advancedGroupBox, ui.boneAdvancedGroupBox]
    groups += [ui.imageAdvancedGroupBox, ui.loadGroupBox, ui.compareGroupBox, ui.settingsCollapsibleButton]
    for group in groups:
        group.collapsed = False
    module.host.process_events()
    whole = _panel(module)
    margin, middle, end = _top(module, ui.settingsCollapsibleButton), _top(module, ui.boneAdvancedGroupBox) - 4, whole.height()
    columns = [whole.copy(0, top, PANEL_WIDTH, bottom - top) for top, bottom in ((margin, middle), (middle, end))]
    view_frames.write_png(view_frames.tiled([columns], background=_background(module)), folder / "step-3-settings.png")
    for group in groups:
        group.collapsed = True


def progress(module, folder: Path) -> None:
    """step-4-progress.png: the dialog during the reconstruction, which this starts."""
    from PySide6 import QtWidgets

    pictures: list = []

    def look(value):
        for dialog in QtWidgets.QApplication.topLevelWidgets():
            if isinstance(dialog, QtWidgets.QProgressDialog) and value >= PROGRESS_AT * dialog.maximum() and not pictures:
                pictures.append(view_frames.titled(dialog.grab().toImage(), dialog.windowTitle().strip()))

    module.host.dialogs.on_progress = look
    module.press(module.widget.ui.applyButton)
    module.host.dialogs.on_progress = None
    view_frames.write_png(pictures[0], folder / "step-4-progress.png")


def result(module, folder: Path) -> None:
    """step-5-result.png: the volume over the CT in three planes, and rendered in 3D with the bone of the CT."""
    parameters = module.parameters
    views = {name: module.slice_view(name, SIZE) for name in ("Red", "Yellow", "Green")}
    parameters.volumeRendering = True
    module.check()
    parameters.bone.GetDisplayNode().SetOpacity3D(0.25)
    shown = module.view_3d("1   Volume rendering, bone of the CT", SIZE, parameters.output, (-120.0, -330.0, 160.0), 330.0, marked=True)
    parameters.volumeRendering = False
    parameters.bone.GetDisplayNode().SetOpacity3D(1.0)
    view_frames.write_png(view_frames.tiled([[views["Red"], shown], [views["Yellow"], views["Green"]]]), folder / "step-5-result.png")


def live(module, views: list, folder: Path) -> None:
    """step-8-live.png: the tab Live and the views during a scan."""
    top = _top(module, module.widget.ui.tabWidget)
    whole = _panel(module)
    section = whole.copy(0, top, PANEL_WIDTH, min(whole.height() - top, views[0].height()))
    view_frames.write_png(view_frames.tiled([[section, *views]], background=_background(module)), folder / "step-8-live.png")


def _panel(module):
    return module.host.picture(module.widget.parent, PANEL_WIDTH)


def _top(module, widget) -> int:
    """Where a widget begins in the panel, pixels from above."""
    from PySide6 import QtCore

    from host.pythonqt import unwrap

    return unwrap(widget).mapTo(unwrap(module.widget.parent), QtCore.QPoint(0, 0)).y()


def _background(module) -> int:
    from PySide6 import QtWidgets

    return QtWidgets.QApplication.palette().window().color().red()
