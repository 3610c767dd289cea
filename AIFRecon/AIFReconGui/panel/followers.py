"""What follows the parameters beside the widgets that parameterNodeWrapper connects."""

from AIFReconScene.display.boneOutlines import BoneOutlines

from ..methodChooser import MethodChooser
from ..picture.picturePanel import PicturePanel
from .boxChooser import BoxChooser
from .pathField import PATHS, PathField
from .reportPanel import ReportPanel
from .segmentsChooser import SegmentsChooser
from .sweepsChooser import SweepsChooser


def followersOf(ui, logic, work) -> tuple:
    """Those of the panel; each has `setParameterNode`, and `update` for when a parameter has changed.

    Parameters
    ----------
    ui : the panel's widgets by name
    logic : AIFReconLogic
    work : LongWork
    """
    return (
        SweepsChooser(ui.otherSweepsComboBox, ui.otherSweepsLabel, logic.offeredSweeps),
        SegmentsChooser(ui.segmentsComboBox, ui.segmentsLabel),
        *(PathField(getattr(ui, f"{name}LineEdit"), name) for name in PATHS),
        MethodChooser(ui.methodComboBox),
        BoxChooser(),
        BoneOutlines(),
        ReportPanel(ui, logic.trackingReport),
        PicturePanel(ui.opacitySliderWidget.parentWidget().layout(), work, logic.trackingReport),
    )
