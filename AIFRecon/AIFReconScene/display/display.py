"""What the views show of the panel's choices: output over the CT, comparison, volume rendering, probe and outlines."""

import slicer

from AIFReconLib.errors import AIFReconError
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.worker.reconstructing import imaging_of

from ..inputs.parameters import ProbeShape, regionFrom, settingsFrom
from ..panelWords import inPanelWords
from ..sceneNodes import boundsOf
from ..sweep.sequenceReader import sequenceFromBrowser
from ..sweep.sweepStatus import sweepKey
from ..work import inWorker
from . import sliceDisplay, threeDViews
from .probeOverlay import ProbeOverlay


class SceneDisplay:
    """Keeps the views in step with the parameters, changing only what has changed.

    Notes
    -----
    The nodes that the views show belong to the scene. What is drawn for orientation (probe and outlines) is this object's, and `clear`
    removes it.
    """

    def __init__(self):
        self._overlay = ProbeOverlay()
        self._drawn = {}
        self._imaging = (None, None, None)

    def showOutput(self, parameters, progress=None) -> None:
        """Show the output over the CT in the usual slice views, and bone in 3D. Views that show its place already stay where they are."""
        if parameters.bone is not None and parameters.bone.IsA("vtkMRMLSegmentationNode"):
            threeDViews.makeSurface(parameters.bone, progress)
        if parameters.output is None:
            return  # deleted while the surface was made
        fit = self._changed("place", (parameters.output.GetID(), boundsOf(parameters.output).tolist()))
        with slicer.util.RenderBlocker():
            sliceDisplay.restoreLayout()
            sliceDisplay.showOverCT(parameters.output, parameters.ctVolume, parameters.opacity, fit=fit)
            self.update(parameters)

    def showUnseen(self, parameters) -> None:
        """Show the output where no view does, as after a scene was loaded into one that shows its own: bone of the same name steps back."""
        output, bone = parameters.output, parameters.bone
        if output is None or output.GetImageData() is None or sliceDisplay.isShown(output):
            return
        for each in slicer.util.getNodesByClass("vtkMRMLSegmentationNode"):
            if bone is not None and each is not bone and each.GetName() == bone.GetName():
                each.SetDisplayVisibility(False)
        self.showOutput(parameters)

    def showComparison(self, comparison, parameters, progress=None) -> None:
        """Show the compared volumes side by side, over the CT, in linked views. Views that show their place already stay there."""
        volumes = [(node, method) for method, node in comparison.volumes.items()]
        fit = self._changed("compared", [(node.GetID(), boundsOf(node).tolist()) for node, _method in volumes])
        sliceDisplay.showSideBySide(volumes, parameters.ctVolume, tableNode=comparison.table, fit=fit, progress=progress)

    def update(self, parameters) -> None:
        """Follow opacity, volume rendering, probe and outlines."""
        output = parameters.output
        if output is not None and output.GetImageData() is not None:
            if self._changed("opacity", (output.GetID(), parameters.opacity)):
                sliceDisplay.setOpacity(output, parameters.opacity)
            if self._changed("rendering", (output.GetID(), parameters.volumeRendering)):
                sliceDisplay.showVolumeRendering(output, parameters.volumeRendering)
        isEmpty = parameters.sweep is None and output is None
        isOfPatient = isEmpty or parameters.ctVolume is not None or parameters.bone is not None
        # Where nothing has to be hidden they are as the user wants them
        if self._drawn.setdefault("letters", True) != isOfPatient:
            self._drawn["letters"] = isOfPatient
            threeDViews.showLetters(isOfPatient)
        self._updateProbe(parameters)
        self._updateOutlines(parameters)
        if self._changed("in 3D", self._placeIn3D(parameters)) and self._drawn["in 3D"] is not None:
            threeDViews.center()

    def followFrame(self, parameters) -> None:
        """Draw the probe on the frame that is shown now, and let the view that shows it lie in it; an image under a transform takes the
        probe along by itself."""
        sliceDisplay.followFrame()
        if self._drawn.get("probe") and parameters.sweep is not None and isPlacedByItself(parameters.sweep, parameters.imageSequence):
            self._draw("probe", self._drawProbe, parameters)

    def clear(self) -> None:
        """Remove what is drawn for orientation."""
        self._overlay.hide()
        if not self._drawn.get("letters", True):
            threeDViews.showLetters(True)
        self._drawn = {}
        self._imaging = (None, None, None)

    def _changed(self, what: str, state) -> bool:
        changed = self._drawn.get(what) != state
        self._drawn[what] = state
        return changed

    def _placeIn3D(self, parameters):
        """Where something appears in 3D on account of the panel; None where nothing does."""
        bone = parameters.bone
        hasSurface = bone is not None and bone.IsA("vtkMRMLSegmentationNode") and self._drawn.get("place") is not None
        appears = hasSurface or self._drawn.get("rendering", (None, False))[1] or bool(self._drawn.get("outlines"))
        return (self._drawn.get("place"),) if appears else None

    def _updateProbe(self, parameters) -> None:
        shown = parameters.showProbe and parameters.sweep is not None
        state = shown and (_sweepOf(parameters), settingsFrom(parameters).apex_px, parameters.probe, regionFrom(parameters))
        if self._changed("probe", state):
            self._draw("probe", self._drawProbe if shown else None, parameters)

    def _updateOutlines(self, parameters) -> None:
        shown = parameters.showOutlines and parameters.sweep is not None
        if self._changed("outlines", shown and (_sweepOf(parameters), regionFrom(parameters))):
            self._draw("outlines", self._drawOutlines if shown else None, parameters)

    def _draw(self, what: str, draw, parameters) -> None:
        """Draw it; where that is not wanted, or does not work, it goes."""
        try:
            if draw is not None:
                draw(parameters)
                return
        except AIFReconError as error:
            slicer.util.showStatusMessage(inPanelWords(error), 5000)
        self._overlay.hide(what)

    def _drawProbe(self, parameters) -> None:
        self._overlay.showProbe(parameters.sweep, parameters.imageSequence, *self._imagingOf(parameters))

    def _drawOutlines(self, parameters) -> None:
        sequence = sequenceFromBrowser(parameters.sweep, parameters.imageSequence)
        self._overlay.showOutlines(parameters.sweep, sequence, self._imagingOf(parameters, needProbe=False)[1])

    def _imagingOf(self, parameters, needProbe: bool = True):
        """Probe and region as a reconstruction would use them; looked for in the images once for a sweep."""
        recipe, key = settingsFrom(parameters), (_sweepOf(parameters), regionFrom(parameters))
        byHand = None if parameters.probe == ProbeShape.AUTOMATIC else ProbeGeometry(parameters.probe.value, recipe.apex_px)
        probe, region = self._imaging[1:] if self._imaging[0] == key else (None, None)
        if region is None or (needProbe and byHand is None and probe is None):
            sequence = sequenceFromBrowser(parameters.sweep, parameters.imageSequence)
            probe, region = inWorker(imaging_of, sequence, needProbe and byHand is None, recipe)
            self._imaging = key, probe, region
        return byHand or probe, region


def _sweepOf(parameters) -> tuple:
    return sweepKey(parameters.sweep, parameters.imageSequence)


def isPlacedByItself(browser, imageSequence=None) -> bool:
    """Whether the images of a sweep lie where their own matrices put them, with no transform above."""
    proxy = browser.GetProxyNode(imageSequence or browser.GetMasterSequenceNode())
    return proxy is not None and proxy.GetParentTransformNode() is None
