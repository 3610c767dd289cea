"""The window and the views of the stand-in do what the real application was seen to do."""

from __future__ import annotations

import pytest

pytest_plugins = ["host_fixture"]

WORDS = "A sentence that is much longer than any panel is wide, and goes on and on. " * 4


@pytest.fixture
def panel(host, qt):
    """A panel of one word-wrapped label in the main window: the label, and a function that tells how wide the window shows the panel."""
    from PySide6 import QtWidgets

    window = host._application.window
    widget = QtWidgets.QWidget()
    QtWidgets.QVBoxLayout(widget)
    label = QtWidgets.QLabel("short")
    label.setWordWrap(True)
    widget.layout().addWidget(label)
    window.panel.put(widget)

    def width() -> int:
        for _level in range(6):
            host.process_events()
        return window._dock.width()

    yield label, width
    window.panel.put(None)
    widget.deleteLater()


def test_a_label_with_a_long_text_widens_the_panel(panel):
    label, width = panel
    before = width()
    label.setText(WORDS)
    assert width() > before + 100


def test_a_label_whose_width_is_ignored_does_not(panel):
    from PySide6 import QtWidgets

    label, width = panel
    label.setSizePolicy(QtWidgets.QSizePolicy.Policy.Ignored, QtWidgets.QSizePolicy.Policy.Preferred)
    before = width()
    label.setText(WORDS)
    assert width() == before


def test_a_slice_view_fits_its_field_of_view_to_its_widget(host):
    import slicer

    node = slicer.app.layoutManager().sliceWidget("Red").mrmlSliceNode()
    node.SetFieldOfView(12.0, 12.0, 1.0)
    host.process_events()
    width, height, _depth = node.GetDimensions()
    assert node.GetFieldOfView()[:2] == pytest.approx((12.0 * width / height, 12.0))


def test_a_3d_view_looks_at_what_appears_only_when_it_is_told_to(host):
    import slicer
    import vtk

    view = slicer.app.layoutManager().threeDWidget(0).threeDView()
    sphere = vtk.vtkSphereSource()
    sphere.SetCenter(100.0, 20.0, -30.0)
    sphere.Update()
    before = view.cameraNode().GetFocalPoint()
    slicer.modules.models.logic().AddModel(sphere.GetOutput())
    host.process_events()
    alone = view.cameraNode().GetFocalPoint()
    slicer.util.resetThreeDViews()
    assert alone == before
    assert view.cameraNode().GetFocalPoint() == pytest.approx((100.0, 20.0, -30.0), abs=0.1)


def test_a_box_that_a_list_creates_has_no_points_and_no_size_and_is_not_being_placed(host):
    import slicer

    selector = slicer.qMRMLNodeComboBox()
    selector.nodeTypes = ["vtkMRMLMarkupsROINode"]
    selector.setMRMLScene(slicer.mrmlScene)
    node = selector.addNode()
    assert (node.GetNumberOfControlPoints(), node.GetSize()) == (0, (0.0, 0.0, 0.0))
    assert slicer.app.applicationLogic().GetInteractionNode().GetCurrentInteractionMode() != slicer.vtkMRMLInteractionNode.Place


def test_the_tool_bar_that_replays_does_not_appear_with_a_browser_that_code_makes(host):
    import slicer

    browser = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLSequenceBrowserNode")
    sequences = slicer.modules.sequences
    assert (sequences.isToolBarVisible(), sequences.toolBar().activeBrowserNode()) == (False, None)
    sequences.showSequenceBrowser(browser)
    assert (sequences.isToolBarVisible(), sequences.toolBar().activeBrowserNode()) == (True, browser)


def test_only_views_of_the_layout_are_mapped_in_it(host):
    import slicer

    manager = slicer.app.layoutManager()
    manager.setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutOneUpRedSliceView)
    alone = manager.sliceViewNames(), manager.threeDViewCount
    manager.setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
    assert alone == (("Red",), 0)
    assert (sorted(manager.sliceViewNames()), manager.threeDViewCount) == (["Green", "Red", "Yellow"], 1)
