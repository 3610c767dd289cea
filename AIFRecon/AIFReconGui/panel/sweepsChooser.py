"""The further sweeps that are reconstructed with the first: a list with check marks."""

import slicer
from AIFReconScene.sweep.severalSweeps import furtherSweeps

from .checkableList import CheckableList


class SweepsChooser:
    """Shows the other sweeps of the scene that have frames which can be placed; those that are checked enter the volume too.

    Parameters
    ----------
    comboBox : ctkCheckableComboBox
    label : QLabel
        Hidden with the list where there is no other sweep.
    offered : callable
        From the parameters to the sequence browsers that can be chosen.
    """

    def __init__(self, comboBox, label, offered):
        self._offered = offered
        self._list = CheckableList(comboBox, label, self._onChecked)
        self._parameterNode = None
        self._shown = None

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        self._parameterNode = parameterNode
        self._shown = None

    def update(self) -> None:
        """Show the sweeps that there are."""
        chosen = [browser.GetID() for browser in furtherSweeps(self._parameterNode)]
        shown = [(browser.GetID(), browser.GetName()) for browser in self._offered(self._parameterNode)], chosen
        if shown != self._shown:
            self._shown = shown
            self._list.show(*shown)

    def _onChecked(self, ids) -> None:
        if self._parameterNode is not None:
            self._shown = (self._shown[0], ids)
            self._parameterNode.otherSweeps = [slicer.mrmlScene.GetNodeByID(each) for each in ids]
