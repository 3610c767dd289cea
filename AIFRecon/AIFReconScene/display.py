"""What the views show of the panel's choices: output over the CT, comparison, volume rendering, probe and outlines."""

import slicer

from AIFReconLib.errors import AIFReconError

from . import sliceDisplay
from .probeOverlay import ProbeOverlay


class SceneDisplay:
    """Keeps the views in step with the parameters, changing only what has changed.

    Notes
    -----
    The nodes that the views show belong to the scene. What is drawn for orientation (probe and outlines) is this object's, and `clear`
    removes it.
    """

    def __init__(self):
        self._overlay = None
        self._drawn = {}

    def showOutput(self, parameters) -> None:
        """Show the output over the CT in the usual slice views."""
        sliceDisplay.restoreLayout()
        sliceDisplay.showOverCT(parameters.output, parameters.ctVolume, parameters.opacity)
        self.update(parameters)

    def showComparison(self, comparison, parameters) -> None:
        """Show the compared volumes side by side, over the CT, in linked views."""
        sliceDisplay.showSideBySide([(node, method) for method, node in comparison.volumes.items()], parameters.ctVolume)

    def update(self, parameters) -> None:
        """Follow opacity, volume rendering, probe and outlines."""
        output = parameters.output
        if output is not None and output.GetImageData() is not None:
            if self._changed("opacity", (output.GetID(), parameters.opacity)):
                sliceDisplay.setOpacity(output, parameters.opacity)
            if self._changed("rendering", (output.GetID(), parameters.volumeRendering)):
                sliceDisplay.showVolumeRendering(output, parameters.volumeRendering)
        self._updateProbe(parameters)
        self._updateOutlines(parameters)

    def clear(self) -> None:
        """Remove what is drawn for orientation."""
        if self._overlay is not None:
            self._overlay.hide()
        self._overlay = None
        self._drawn = {}

    def _changed(self, what: str, state) -> bool:
        changed = self._drawn.get(what) != state
        self._drawn[what] = state
        return changed

    def _updateProbe(self, parameters) -> None:
        shown = parameters.showProbe and parameters.sweep is not None
        state = shown and (*_sweepOf(parameters), parameters.probe, parameters.apexColumn, parameters.apexRow)
        if not self._changed("probe", state):
            return
        if not shown:
            self._hide("Probe")
            return
        try:
            imaging = _imagingOf(parameters)
            self._theOverlay().showProbe(parameters.sweep, parameters.imageSequence, imaging.probe, imaging.region)
        except AIFReconError as error:
            self._hide("Probe")
            slicer.util.showStatusMessage(str(error), 5000)

    def _updateOutlines(self, parameters) -> None:
        from .sequenceReader import sequenceFromBrowser

        shown = parameters.showOutlines and parameters.sweep is not None
        if not self._changed("outlines", shown and _sweepOf(parameters)):
            return
        if not shown:
            self._hide("Outlines")
            return
        try:
            sequence = sequenceFromBrowser(parameters.sweep, parameters.imageSequence)
            self._theOverlay().showOutlines(parameters.sweep, sequence, _imagingOf(parameters, needProbe=False).region)
        except AIFReconError as error:
            self._hide("Outlines")
            slicer.util.showStatusMessage(str(error), 5000)

    def _theOverlay(self):
        if self._overlay is None:
            self._overlay = ProbeOverlay()
        return self._overlay

    def _hide(self, what: str) -> None:
        if self._overlay is not None:
            getattr(self._overlay, f"hide{what}")()


def _sweepOf(parameters) -> tuple:
    images = parameters.imageSequence
    return parameters.sweep.GetID(), images.GetID() if images is not None else None


def _imagingOf(parameters, needProbe: bool = True):
    """Probe and region as a reconstruction would use them."""
    from AIFReconLib.poses import sweep_poses
    from AIFReconLib.reconstruction import resolve_imaging

    from .inputs import probeFrom
    from .sequenceReader import sequenceFromBrowser

    sequence = sequenceFromBrowser(parameters.sweep, parameters.imageSequence)
    poses = sweep_poses(sequence)
    poses.require_usable(sequence.name)
    return resolve_imaging(sequence, poses, needProbe, probe=probeFrom(parameters))
