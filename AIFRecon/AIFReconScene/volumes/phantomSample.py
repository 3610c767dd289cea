"""A simulated patient as nodes: the CT of a lumbar spine, its segmentation and registration, and a tracked sweep. Made on the spot."""

from dataclasses import dataclass

import slicer

from AIFReconLib.progress import Progress, part, report
from AIFReconLib.worker.evaluating import simulated_patient

from ..sceneNodes import addedTogether, setWindow
from ..sweep.sequenceNodes import browserFromSequence
from ..work import worker
from .segments import segmentationNode
from .volumeNodes import updateVolumeNode

FRAMES, FEW_FRAMES = 360, 180
"""Forty at each of the nine pairs of tilts, which is as slow and dense as a scan should be; and half of them, a scan that was too fast."""

WHOLE_BODY = 12.0
"""mm by which the scan begins earlier, so that it sees the first vertebra to its upper end."""

CT_SPACING = 1.25
"""mm, as CT scans of the spine have between slices."""

LEVELS = ("L2", "L3", "L4")

BONE_WINDOW = (-200.0, 900.0)
"""HU."""


@dataclass(frozen=True)
class PhantomNodes:
    """The nodes of a simulated patient; CT and segmentation, a segment per vertebra, lie under their registration."""

    ct: object
    segmentation: object
    ctToReference: object
    browser: object

    @property
    def nodes(self) -> list:
        """All of them, the CT first."""
        return [self.ct, self.segmentation, self.ctToReference, self.browser]


def beginPhantom(*, seed: int = 0, frames: int = FRAMES, spacing: float = CT_SPACING, above: float = WHOLE_BODY):
    """A `Task` that simulates a patient beside the windows; arguments as for `simulated_patient`."""
    return worker.begin(simulated_patient, seed, len(LEVELS), frames, spacing, above)


def loadPhantom(progress: Progress | None = None, begun=None, **choices) -> PhantomNodes:
    """Simulate a patient, or take what was `begun`, and add it to the scene, which is as it was after a cancel."""
    patient = (begun or beginPhantom(**choices)).result(part(progress, 0.0, 0.95))
    return addPatient(patient, part(progress, 0.95, 1.0))


def addPatient(patient, progress: Progress | None = None) -> PhantomNodes:
    """Add a simulated patient to the scene; arguments as for `loadPhantom`."""
    scene = slicer.mrmlScene
    with addedTogether():
        browser = browserFromSequence(patient.sweep, "Lumbar sweep", part(progress, 0.0, 0.4))
        report(progress, 0.4, "Adding the CT")
        transform = scene.AddNewNodeByClass("vtkMRMLLinearTransformNode", scene.GenerateUniqueName("CTToReference"))
        transform.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(patient.ct_to_reference))
        ct = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", scene.GenerateUniqueName("Lumbar CT"))
        updateVolumeNode(ct, patient.ct)
        ct.CreateDefaultDisplayNodes()
        setWindow(ct.GetScalarVolumeDisplayNode(), *BONE_WINDOW)
        ct.SetAndObserveTransformNodeID(transform.GetID())
        names = dict(enumerate(LEVELS, start=1))
        segmentation = segmentationNode("Lumbar vertebrae", patient.labels, names, ct, part(progress, 0.6, 1.0))
    return PhantomNodes(ct, segmentation, transform, browser)
