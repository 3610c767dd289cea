"""What is shown of a sweep that has just come: nodes that are made by code would stay unseen."""

import slicer

from AIFReconLib.progress import part, report

from ..inputs.readiness import chooseDefaults
from ..volumes.opening import openedTogether, openFiles, replaceSweep
from . import sliceDisplay, threeDViews


def showInputs(browserNode=None, ctNode=None) -> None:
    """Show a sweep in the tool bar that replays it, its CT in slice views that do not show it (else its frame), and 3D."""
    if browserNode is not None:
        slicer.modules.sequences.showSequenceBrowser(browserNode)
    with slicer.util.RenderBlocker():
        if ctNode is not None:
            sliceDisplay.showBackground(ctNode)
        elif browserNode is not None:
            sliceDisplay.showFrame(browserNode.GetProxyNode(browserNode.GetMasterSequenceNode()))
        threeDViews.center()


def openAndShow(parameters, paths, loadRecording, progress=None) -> str:
    """Read files and choose what they hold, as `openFiles`, and show it, with the surface of bone that 3D views draw."""
    with openedTogether(parameters):
        done, before = openFiles(parameters, paths, loadRecording, part(progress, 0.0, 0.9))
        chooseDefaults(parameters)
        if parameters.bone is not None and parameters.bone.IsA("vtkMRMLSegmentationNode"):
            threeDViews.makeSurface(parameters.bone, part(progress, 0.9, 1.0))
        report(progress, 1.0, done)
    if before is not None:
        replaceSweep(before, parameters.sweep)
    showInputs(parameters.sweep, parameters.ctVolume)
    return done
