"""The simulated patient in Slicer's Sample Data module."""

import functools
import pathlib

import slicer
from slicer.i18n import tr as _

SAMPLE_NAME, THIN_SAMPLE_NAME = "AIFRecon lumbar phantom", "AIFRecon lumbar phantom, a thin scan"
THUMBNAIL = pathlib.Path(__file__).resolve().parent.parent / "Resources" / "Icons" / "AIFReconLumbarPhantom.png"


def registerSampleData():
    """Offer the simulated patient in the Sample Data module; it is built on the spot when asked for."""
    import SampleData

    for name, isThin in ((SAMPLE_NAME, False), (THIN_SAMPLE_NAME, True)):
        SampleData.SampleDataLogic.registerCustomSampleDataSource(
            category="AIFRecon",
            sampleName=name,
            uris="",  # nothing is downloaded
            thumbnailFileName=str(THUMBNAIL),
            customDownloader=functools.partial(loadPhantomSample, isThin=isThin),
        )
    panel = getattr(slicer.modules, "SampleDataWidget", None)
    if panel is not None:
        # Built before this module was loaded, with what was on offer then
        panel.setCategoriesFromSampleDataSources(panel.categoryLayout, slicer.modules.sampleDataSources, panel.logic)


def loadPhantomSample(source=None, isThin=False):
    """Simulate the patient and add CT, segmentation and sweep to the scene; cancel leaves the scene as it was."""
    from .longWork import ProgressDialog, errorsShown

    with errorsShown(_("The sample patient could not be made.")), ProgressDialog(_("Lumbar phantom")) as progress:
        return addPhantom(progress, isThin).nodes
    return []


def addPhantom(progress=None, isThin=False, begun=None):
    """The nodes of the simulated patient, of what was `begun` if anything, in the scene and the views, with the surface of its bone."""
    from AIFReconScene.display.firstLook import showInputs
    from AIFReconScene.display.threeDViews import makeSurface
    from AIFReconScene.sceneNodes import addedTogether
    from AIFReconScene.volumes.phantomSample import FEW_FRAMES, loadPhantom

    from AIFReconLib.progress import part

    with addedTogether():
        chosen = {"frames": FEW_FRAMES, "above": 0.0} if isThin else {}
        phantom = loadPhantom(part(progress, 0.0, 0.9), begun, **chosen)
        makeSurface(phantom.segmentation, part(progress, 0.9, 0.95))
        showInputs(phantom.browser, phantom.ct)
    return phantom
