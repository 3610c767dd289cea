"""How segments are displayed, which is the user's: what the module changes of it for a while and gives back, such as fill for outlines."""

import slicer

from . import sliceDisplay


def displayOf(bone):
    """How the segments of a node are displayed; None for any other node, and for none."""
    return bone.GetDisplayNode() if bone is not None and bone.IsA("vtkMRMLSegmentationNode") else None


class Borrowed:
    """One property of the display of segments, changed on one display at a time.

    Parameters
    ----------
    name : str
        As in the display's ``Get`` and ``Set`` methods, e.g. ``"Opacity3D"``.
    value : bool or float
        What it is while it is borrowed.
    attribute : str
        Of the display node: what it was before, as a number.

    Notes
    -----
    What it was is kept in the scene and nowhere else, so that a scene which is saved meanwhile gives it back when it is open again. It is
    changed once: what the user sets after that stays, also when it is given back.
    """

    def __init__(self, name: str, value, attribute: str):
        self._name, self._value, self._attribute = name, value, attribute

    def follow(self, display) -> None:
        """Change this display, or none, and give back what was changed of any other one in the scene."""
        for other in slicer.util.getNodesByClass("vtkMRMLSegmentationDisplayNode"):
            if other is not display and other.GetAttribute(self._attribute) is not None:
                self._giveBack(other)
        if display is not None and display.GetAttribute(self._attribute) is None:
            # All views draw segments anew with every change of their display
            with slicer.util.NodeModify(display):
                display.SetAttribute(self._attribute, str(float(self._of(display))))
                self._set(display, self._value)

    def _giveBack(self, display) -> None:
        with slicer.util.NodeModify(display):
            if self._of(display) == self._value:
                self._set(display, type(self._value)(float(display.GetAttribute(self._attribute))))
            display.RemoveAttribute(self._attribute)

    def _of(self, display):
        return getattr(display, f"Get{self._name}")()

    def _set(self, display, value) -> None:
        getattr(display, f"Set{self._name}")(value)


UNFILLED = Borrowed("Visibility2DFill", False, "AIFRecon.FilledBefore")
OUTLINED = Borrowed("Visibility2DOutline", True, "AIFRecon.OutlinedBefore")
THIN = Borrowed("SliceIntersectionThickness", 1, "AIFRecon.ThicknessBefore")
HIDDEN = Borrowed("Visibility2D", False, "AIFRecon.HiddenIn2D")


class BoneOutlines:
    """Outlines the bone that the parameters name while a reconstruction is on display: filled, it would hide the very surface of that.

    Notes
    -----
    Its fill is given back at the end. A segmentation is changed when a reconstruction comes on display: one that the user fills again
    after that stays filled.
    """

    def __init__(self):
        self._parameterNode = None

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none: then the user leaves."""
        self._parameterNode = parameterNode
        if parameterNode is None:
            self._follow(None)

    def update(self) -> None:
        """Outline the bone, or hide it if that is chosen, while a reconstruction is on display."""
        display = displayOf(self._parameterNode.bone) if sliceDisplay.showsReconstruction() else None
        self._follow(display, None if self._parameterNode.showBoneOutlines else display)

    def _follow(self, display, hidden=None) -> None:
        for each in (UNFILLED, OUTLINED, THIN):
            each.follow(display)
        HIDDEN.follow(hidden)
