"""Steps of `walkInSlicer.py`: bone from the echoes themselves, from a network in a file, and from what a network has said of the sweep.

Each takes the walk, with a sweep that is chosen in its panel.
"""

import pathlib
import unittest

import numpy as np
import slicer

MODEL = pathlib.Path(__file__).resolve().parents[1] / "models" / "bone.onnx"
"""A small network, trained on simulated frames."""


def reconstructBy(walk, source) -> None:
    """Choose who says where bone is, and reconstruct: other voxels than those there are."""
    from AIFReconScene.inputs.boneSource import BoneSource

    walk.ui.tabWidget.currentIndex = 0
    before = walk.parameters.output and slicer.util.arrayFromVolume(walk.parameters.output).copy()
    walk.ui.boneSourceComboBox.currentIndex = list(BoneSource).index(source)
    walk.settle()
    walk.heart.start()
    walk.press(walk.ui.applyButton)
    if walk.parameters.output is None:
        raise RuntimeError(f"nothing was reconstructed: {walk.ui.statusLabel.text}")
    voxels = slicer.util.arrayFromVolume(walk.parameters.output)
    if not voxels.any() or (before is not None and np.array_equal(voxels, before)):
        raise RuntimeError(f"the volume is empty, or the one before: {walk.ui.statusLabel.text}")


def requireNetwork() -> None:
    """Leave a step out where a network in a file cannot be run."""
    from AIFReconGui.packages import MODEL as PACKAGE
    from AIFReconGui.packages import isInstalled

    if not isInstalled(PACKAGE):
        raise unittest.SkipTest(f"{PACKAGE} is not installed, and nobody is here to agree to that")


def echoes(walk) -> None:
    """Bone is looked for in the sweep itself."""
    from AIFReconScene.inputs.boneSource import BoneSource

    reconstructBy(walk, BoneSource.ECHOES)


def network(walk) -> None:
    """A network in a file tells where bone is."""
    from AIFReconScene.inputs.boneSource import BoneSource

    requireNetwork()
    walk.ui.boneModelPathLineEdit.currentPath = str(MODEL)
    reconstructBy(walk, BoneSource.MODEL)
    if MODEL.name not in walk.ui.statusLabel.text:
        raise RuntimeError(f"the network is not named: {walk.ui.statusLabel.text}")


def recordedNetwork(walk) -> None:
    """What a network has said of the sweep is opened, and tells where bone is."""
    from AIFReconScene.inputs.boneSource import BoneSource
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    from AIFReconLib import write_sequence
    from AIFReconLib.bone.predicted_bone import EchoEstimator
    from AIFReconLib.bone.recorded_predictions import COVERS
    from AIFReconLib.resolve import resolve_imaging
    from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
    from AIFReconLib.sweep.poses import sweep_poses, tracked_frames

    # In the place of a network that runs elsewhere: the rule for echoes, at half the size
    sweep = sequenceFromBrowser(walk.parameters.sweep)
    poses = sweep_poses(sweep)
    estimator = EchoEstimator(resolve_imaging(sweep, poses, True))
    columns, rows = sweep.frame_size
    images, records = [], []
    for frame in tracked_frames(sweep, poses, poses.usable):
        said = estimator.estimate(frame)
        assert said is not None
        images.append(np.rint(255 * said.probability[::2, ::2]).astype(np.uint8))
        records.append(FrameRecord(timestamp=frame.timestamp, fields={COVERS: f"0 0 {columns} {rows}"}))
        slicer.app.processEvents()
    path = walk.folder / "sample-bone.mhd"
    write_sequence(TrackedSequence(np.stack(images), records), path)
    walk.heart.start()
    walk.widget.logic.openFiles(walk.parameters, [path])
    walk.settle()
    if walk.parameters.boneSource != BoneSource.PREDICTIONS or walk.ui.bonePredictionsSelector.currentNode() is None:
        raise RuntimeError("what the network has said is not chosen in the panel")
    reconstructBy(walk, BoneSource.PREDICTIONS)
