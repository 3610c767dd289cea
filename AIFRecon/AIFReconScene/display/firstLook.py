"""What is shown of a sweep that has just come: nodes that are made by code would stay unseen."""

import slicer

from AIFReconLib.progress import report

from . import sliceDisplay, threeDViews
from .viewByView import drawnViewByView


def showInputs(browserNode, ctNode=None, progress=None) -> None:
    """Show a sweep in the tool bar that replays it, its CT in the slice views, and the middle of what appears in 3D.

    Parameters
    ----------
    browserNode : vtkMRMLSequenceBrowserNode
    ctNode : vtkMRMLScalarVolumeNode or None
        Slice views that show it already stay where they are.
    progress : callable or None
        Has windows go on between tool bar and views, and after them.
    """
    slicer.modules.sequences.showSequenceBrowser(browserNode)
    report(progress, 0.5, "Showing the sweep")
    with drawnViewByView(progress):
        if ctNode is not None:
            sliceDisplay.showBackground(ctNode)
        threeDViews.center()
    report(progress, 1.0, "Showing the sweep")
