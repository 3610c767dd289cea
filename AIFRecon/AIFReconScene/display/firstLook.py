"""What is shown of a sweep that has just come: nodes that are made by code would stay unseen."""

import slicer

from . import sliceDisplay, threeDViews


def showInputs(browserNode, ctNode=None) -> None:
    """Show a sweep in the tool bar that replays it, its CT in the slice views, and the middle of what appears in 3D.

    Parameters
    ----------
    browserNode : vtkMRMLSequenceBrowserNode
    ctNode : vtkMRMLScalarVolumeNode or None
        Slice views that show it already stay where they are.
    """
    slicer.modules.sequences.showSequenceBrowser(browserNode)
    with slicer.util.RenderBlocker():
        if ctNode is not None:
            sliceDisplay.showBackground(ctNode)
        threeDViews.center()
