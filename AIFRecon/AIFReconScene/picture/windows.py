"""Window presets: what of the gray levels of the ultrasound and of the CT is shown, for bone, for soft tissue, or for all."""

from slicer.i18n import tr as _

from ..sceneNodes import setWindow
from ..volumes.volumeNodes import measuredOf, ultrasoundWindowOf


def presets() -> tuple:
    """Name in the user's language, shares of the usual window that ultrasound is shown in (1: its brightest), and HU of the CT."""
    return (
        (_("Bone"), (0.2, 1.0), (-200.0, 900.0)),
        (_("Soft tissue"), (0.0, 0.5), (-160.0, 240.0)),
        (_("Everything"), (0.0, 1.0), (-1000.0, 1500.0)),
    )


def showIn(preset: tuple, output, ct) -> None:
    """Show a reconstruction, its plain echo and a CT in the gray levels of a preset; None is passed over."""
    _name, ofUltrasound, ofCT = preset
    for node in (output, measuredOf(output)):
        if node is not None and node.GetImageData() is not None and node.GetDisplayNode() is not None:
            brightest = ultrasoundWindowOf(output)[1]
            setWindow(node.GetDisplayNode(), *(share * brightest for share in ofUltrasound))
    if ct is not None and ct.GetDisplayNode() is not None:
        setWindow(ct.GetDisplayNode(), *ofCT)
