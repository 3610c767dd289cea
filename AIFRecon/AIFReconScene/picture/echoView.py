"""Measured or enhanced: the plain mean of the echoes in the place of the reconstruction, and a tint where the method has raised it."""

import slicer
from slicer.i18n import tr as _

from AIFReconLib.geometry.volume import Volume
from AIFReconLib.inspection.enhancement_map import BANDS, raised_bands

from ..display import sliceDisplay
from ..display.ownNodes import OwnNodes
from ..sceneNodes import setWindow
from ..transforms import ijkToRAS
from ..volumes.volumeNodes import measuredOf, updateVolumeNode

TINT = (0.66, 0.22, 0.95)
"""Violet: no other thing in the views has it, and gray stays readable under it."""

OPACITIES = (0.0, 0.16, 0.30, 0.42, 0.52)
"""Of the tint, for nothing and for each band of `AIFReconLib.inspection.enhancement_map`: never so much that the echo is hidden."""


class EchoView:
    """Keeps the slice views in step with two choices: the plain echo in the reconstruction's place, and the tint over the reconstruction.

    Notes
    -----
    The plain echo is a volume of the scene that was kept when the reconstruction was made. The tint is told from the two, for display only,
    and lies in the label layer of views that have that free.
    """

    def __init__(self):
        self._own = OwnNodes()
        self._tintOf: tuple | None = None
        self._opacity: tuple | None = None

    @property
    def tintNode(self):
        """The labelmap node of the tint, or None where nothing is marked."""
        return self._own.get("tint")

    def update(self, parameters) -> None:
        """Show what is chosen, in every slice view that shows the reconstruction or its plain echo."""
        output = parameters.output if parameters.output is not None and parameters.output.GetImageData() is not None else None
        plain = measuredOf(output)
        if plain is not None and output is not None:
            shown, hidden = (plain, output) if parameters.showMeasured else (output, plain)
            if sliceDisplay.exchange(hidden, shown):
                _sameWindow(hidden, shown)
            if self._opacity != (shown.GetID(), parameters.opacity):
                self._opacity = shown.GetID(), parameters.opacity
                sliceDisplay.setOpacity(shown, parameters.opacity)
        if plain is None or parameters.showMeasured or not parameters.showRaised:
            self._untint()
        else:
            self._tint(output, plain)

    def clear(self) -> None:
        """Take the tint out of the views and of the scene."""
        self._untint()
        self._own.remove()
        self._tintOf = self._opacity = None

    def _untint(self) -> None:
        if self.tintNode is not None:
            sliceDisplay.showLabels(self.tintNode, None)

    def _tint(self, output, plain) -> None:
        node = self.tintNode or self._made()
        key = (output.GetID(), output.GetImageData().GetMTime(), plain.GetImageData().GetMTime())
        if self._tintOf != key:
            self._tintOf = key
            volumes = (Volume(slicer.util.arrayFromVolume(each), ijkToRAS(each)) for each in (output, plain))
            updateVolumeNode(node, Volume(raised_bands(*volumes), ijkToRAS(output)))
        sliceDisplay.showLabels(node, output)

    def _made(self):
        colors = self._own.colors("colors", "Raised brightness", [(name, (*TINT, each)) for name, each in zip(bandNames(), OPACITIES)])
        node = self._own.add("tint", slicer.mrmlScene.AddNewNodeByClass("vtkMRMLLabelMapVolumeNode", "Raised brightness"))
        node.CreateDefaultDisplayNodes()
        node.GetDisplayNode().SetAndObserveColorNodeID(colors.GetID())
        node.GetDisplayNode().SetSaveWithScene(False)
        for each in (node, node.GetDisplayNode()):
            each.SetHideFromEditors(True)
        node.SetSelectable(False)
        self._tintOf = None
        return node


def bandNames() -> list:
    """What the strengths of the tint stand for, in the user's language."""
    names = [_("as bright as its echoes")]
    return names + [_("at least {share:.0%} of the brightness was added").format(share=band) for band in BANDS]


def _sameWindow(one, other) -> None:
    """Let two volumes be told apart by their gray levels alone."""
    before, after = one.GetDisplayNode(), other.GetDisplayNode()
    if before is not None and after is not None:
        setWindow(after, before.GetWindowLevelMin(), before.GetWindowLevelMax())
