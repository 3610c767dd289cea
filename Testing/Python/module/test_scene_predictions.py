"""A network's predictions in a sequence of the scene give the bone map that they give as a file."""

from __future__ import annotations

import numpy as np
import pytest
from seen_planes import IMAGING, PlaneSweep, as_sequence

from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.recipe.recipe import Recipe

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")

from AIFReconLib.bone.predicted_bone import bone_from_frames  # noqa: E402
from AIFReconLib.bone.recorded_predictions import RecordedPredictions  # noqa: E402
from AIFReconLib.errors import GeometryError  # noqa: E402
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample  # noqa: E402
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence  # noqa: E402
from AIFReconLib.workflows.job import BoneSource, ReconstructionJob  # noqa: E402
from AIFReconLib.workflows.reconstruct import found_bone  # noqa: E402

SWEEP = PlaneSweep(count=5)
SAID = (255 * SWEEP.predictions()).astype(np.uint8)


@pytest.fixture
def browsers(scene):
    """The sweep and its predictions as the scene has them, in RAS."""
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    def browser(images, name):
        transform = TransformName("Image", "Reference")
        records = [FrameRecord(5.0 + 0.1 * n, transforms={transform: TransformSample(pose)}) for n, pose in enumerate(SWEEP.poses)]
        return browserFromSequence(TrackedSequence(images, records[: len(images)]), name)

    return browser(SWEEP.images, "Sweep"), browser(SAID[:4], "Predictions")


def bone_told_by(browser, predictions, recipe):
    """The bone that the worker is asked for."""
    from AIFReconScene.sweep.sequenceReader import predictionsFromNode, sequenceFromBrowser

    bone = BoneSource(predictions=predictionsFromNode(predictions))
    return found_bone(ReconstructionJob(sequenceFromBrowser(browser), recipe, bone))


def test_predictions_in_the_scene_are_those_of_a_file(browsers):
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    sweep, predictions = browsers
    found = bone_told_by(sweep, predictions.GetMasterSequenceNode(), Recipe(**imaging_fields(IMAGING.region, IMAGING.probe)))
    sequence = sequenceFromBrowser(sweep)
    times = [record.timestamp for record in sequence.records][:4]
    expected = bone_from_frames(sequence, RecordedPredictions(sequence, as_sequence(SAID[:4], times)), imaging=IMAGING)
    np.testing.assert_allclose(found.probability.array, expected.probability.array, atol=1e-6)
    assert "4 of 5 frames, matched by time" in found.notes[0]


def test_predictions_that_do_not_fit_are_refused(browsers):
    from AIFReconScene.sweep.sequenceNodes import browserFromSequence

    small = browserFromSequence(as_sequence(SAID[:3, ::2]), "Small").GetMasterSequenceNode()
    with pytest.raises(GeometryError, match="do not fit frames"):
        bone_told_by(browsers[0], small, Recipe(**imaging_fields(probe=IMAGING.probe)))
