"""A new box is laid around the sweep or the CT as soon as it is chosen."""

from AIFReconScene.inputs import boxes
from AIFReconScene.inputs.parameters import Region


class BoxChooser:
    """Follows the box that the parameters name; one that has a place already stays as it is."""

    def __init__(self):
        self._parameterNode = None

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        self._parameterNode = parameterNode

    def update(self) -> None:
        """Lay the chosen box around what there is, if it is empty."""
        parameters = self._parameterNode
        if parameters.region == Region.BOX and parameters.roi is not None and boxes.isEmpty(parameters.roi):
            boxes.layAround(parameters.roi, parameters)
