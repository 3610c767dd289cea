"""What the 3D views show: the surface of bone, and all that appears in their middle."""

import contextlib
import textwrap

import numpy as np
import slicer
import vtk

from ..sceneNodes import boundsOf

UPPER_LEFT = 2
"""VTK's number of that corner."""

LETTERS = 30
"""Points: to be read from two meters."""

COLUMNS = 24
"""Letters in a line at most: more are cut off at the edge of a view in a window of 1400 pixels."""

LINE, GROWTH = 0.15, 10.0
"""Part of a view's height that a line may take, and how letters grow with the view: by Slicer's own 0.07 and VTK's 5 they stay small."""


def center() -> None:
    """Have every 3D view look at the middle of what appears in it, from the side that the user has chosen; they never do by themselves."""
    for view in _views():
        with _withoutBox(view):
            renderer = view.renderWindow().GetRenderers().GetFirstRenderer()
            isEmpty = not vtk.vtkMath.AreBoundsInitialized(renderer.ComputeVisiblePropBounds())
            if not isEmpty:
                _lookAtMiddle(view)
        if isEmpty:
            # The box is all that there is to look at
            _lookAtMiddle(view)
        view.cameraNode().ResetClippingRange()


def _lookAtMiddle(view) -> None:
    view.resetFocalPoint()
    # How far away it is, not how it is turned
    view.resetCamera(False, False, True)


@contextlib.contextmanager
def _withoutBox(view):
    """A view's box is drawn around all nodes, those too that no 3D view shows: a CT would make the bone in it small and push it aside."""
    node = view.mrmlViewNode()
    shown = node.GetBoxVisible(), node.GetAxisLabelsVisible()
    node.SetBoxVisible(False)
    node.SetAxisLabelsVisible(False)
    try:
        yield
    finally:
        node.SetBoxVisible(shown[0])
        node.SetAxisLabelsVisible(shown[1])


def showLetters(isOfPatient: bool) -> None:
    """Have the box in 3D say where the patient's right and head are, or not: where there is no CT its axes are a tracker's."""
    for view in _views():
        view.mrmlViewNode().SetAxisLabelsVisible(isOfPatient)


def lookAlong(direction, up, model) -> None:
    """Have every 3D view look in this direction (RAS) at a model, which fills it, with `up` upward."""
    bounds = boundsOf(model)
    middle, radius = bounds.mean(axis=1), np.linalg.norm(np.diff(bounds)) / 2.0
    for view in _views():
        camera = view.cameraNode()
        away = max(radius, 1.0) / np.sin(np.radians(camera.GetViewAngle()) / 2.0)
        with slicer.util.NodeModify(camera):
            camera.SetFocalPoint(middle)
            camera.SetPosition(middle - away * np.asarray(direction) / np.linalg.norm(direction))
            camera.SetViewUp(up)
        camera.ResetClippingRange()


def say(text: str) -> None:
    """Show a text in the upper left corner of every 3D view, in large letters; an empty one takes it away."""
    lines = textwrap.fill(text, COLUMNS)
    for view in _views():
        annotation = view.cornerAnnotation()
        if annotation.GetText(UPPER_LEFT) != (lines or None):
            annotation.SetText(UPPER_LEFT, lines)
            annotation.SetMaximumFontSize(LETTERS)
            annotation.SetMaximumLineHeight(LINE)
            annotation.SetLinearFontScaleFactor(GROWTH)
            letters = annotation.GetTextProperty()
            letters.SetShadow(True)
            # VTK's own have no Chinese, for instance; a font that has is among Slicer's settings
            slicer.app.applicationLogic().UseCustomFontFile(letters)
            view.scheduleRender()


def _views() -> list:
    layoutManager = slicer.app.layoutManager()
    return [layoutManager.threeDWidget(n).threeDView() for n in range(layoutManager.threeDViewCount if layoutManager is not None else 0)]


def makeSurface(segmentationNode, progress=None) -> None:
    """Give every segment the closed surface that 3D views draw; nothing happens where there is one.

    Parameters
    ----------
    segmentationNode : vtkMRMLSegmentationNode
    progress : callable or None
        Hears of every segment, and again before Slicer gets its surface; it cannot cancel.
    """
    surface = slicer.vtkSegmentationConverter.GetClosedSurfaceRepresentationName()
    segmentation = segmentationNode.GetSegmentation()
    if segmentation is None or segmentation.ContainsRepresentation(surface):
        return
    ids = [segmentation.GetNthSegmentID(number) for number in range(segmentation.GetNumberOfSegments())]

    def tell(made: float) -> None:
        if progress is not None:
            progress(made / len(ids), "Making the surface of bone")

    # All but the last one at a time, so that the application stays alive between them
    for number, segmentID in enumerate(ids[:-1]):
        tell(number)
        single = slicer.vtkSegmentation()
        single.SetSourceRepresentationName(segmentation.GetSourceRepresentationName())
        single.CopyConversionParameters(segmentation)
        single.CopySegmentFromSegmentation(segmentation, segmentID)
        isMade = single.CreateRepresentation(surface)
        tell(number + 0.5)
        segment = segmentation.GetSegment(segmentID)
        # It may have gone meanwhile
        if isMade and segment is not None:
            segment.AddRepresentation(surface, single.GetNthSegment(0).GetRepresentation(surface))
    tell(len(ids) - 1)
    segmentationNode.CreateClosedSurfaceRepresentation()
    tell(len(ids))
