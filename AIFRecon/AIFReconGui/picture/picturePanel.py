"""The picture in the panel: how the reconstruction is looked at."""

import pathlib

import slicer
from AIFReconScene.picture.echoView import EchoView
from AIFReconScene.volumes.volumeNodes import measuredOf
from slicer.i18n import tr as _

UI = pathlib.Path(__file__).resolve().parents[2] / "Resources" / "UI" / "Picture.ui"


class PicturePanel:
    """A widget of its own below the others of *Display*, and what its boxes do.

    Parameters
    ----------
    layout : QFormLayout
        Takes the widget as its last row.
    """

    def __init__(self, layout):
        widget = slicer.util.loadUI(str(UI))
        layout.addRow(widget)
        self._ui = slicer.util.childWidgetVariables(widget)
        self._parameterNode = self._bound = None
        self._echo = EchoView()

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        if self._parameterNode is not None:
            self._parameterNode.disconnectGui(self._bound)
            if parameterNode is None:
                self._echo.clear()
        self._parameterNode = parameterNode
        self._bound = parameterNode.connectGui(self._ui) if parameterNode is not None else None

    def update(self) -> None:
        """Show what is chosen, and enable what can be."""
        plain = measuredOf(self._parameterNode.output)
        why = "" if plain is not None else _("Press “Apply” with a method that weights by bone: its plain echo is kept beside it.")
        for box, does in (
            (
                self._ui.showMeasuredCheckBox,
                _("Show the plain mean of the echoes in the place of the enhanced volume, in the same gray levels"),
            ),
            (self._ui.showRaisedCheckBox, _("Violet where the method has made the picture brighter than the echoes are on the mean")),
        ):
            box.enabled = plain is not None
            box.toolTip = why or does
        self._echo.update(self._parameterNode)
