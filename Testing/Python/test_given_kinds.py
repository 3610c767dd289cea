"""What is of another kind than what is taken is refused in a sentence that says what to do: paths, arrays, poses, names."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from sweeps import oblique_sequence, sphere_bone, turned_grid

import AIFReconLib
from AIFReconLib.bone.predicted_bone import bone_from_frames
from AIFReconLib.compounding.methods.table import METHODS, MethodName, method_named
from AIFReconLib.errors import InputTypeError

library: Any = AIFReconLib
"""For a checker of types these calls are wrong too."""

SEQUENCE = oblique_sequence(count=3)
IMAGES, POSES = np.asarray(SEQUENCE.images), np.stack([next(iter(record.transforms.values())).matrix for record in SEQUENCE.records])
LINEAR = library.Recipe(probe="linear")
LABELS = library.Volume(np.pad(np.ones((1, 1, 1), np.uint8), 1), np.eye(4))


PATH = r"must be {}; got '{}'. Read it first"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: library.reconstruct("sweep.mha"), "^Input sequence " + PATH.format("TrackedSequence", "sweep.mha")),
        (lambda: library.reconstruct(Path("sweep.mha")), PATH.format("TrackedSequence", "sweep.mha")),
        (lambda: library.reconstruct([SEQUENCE, "second.mha"]), PATH.format("TrackedSequence", "second.mha")),
        (lambda: library.reconstruct(IMAGES), r"got ndarray of shape \(3, 26, 34\).*TrackedSequence.from_arrays"),
        (lambda: library.reconstruct(None), r"must be TrackedSequence; got NoneType"),
        (lambda: library.bone_from_sweep("sweep.mha"), PATH.format("TrackedSequence", "sweep.mha")),
        (lambda: library.register("sweep.mha", LABELS), PATH.format("TrackedSequence", "sweep.mha")),
        (lambda: library.register(SEQUENCE, "ct.nrrd"), "Input labels " + PATH.format("Volume", "ct.nrrd") + ": read_labels"),
        (lambda: library.LabeledBone("ct.nrrd", np.eye(4)), "Input labels " + PATH.format("Volume", "ct.nrrd")),
        (lambda: library.LabeledBone(LABELS.array), r"got ndarray of shape .* of an array make one: Volume\(array, ijk"),
        (lambda: library.reconstruct(SEQUENCE, "weighted"), r"Input recipe must be Recipe; got 'weighted'. Write"),
        (lambda: library.reconstruct(SEQUENCE, bone="ct.nrrd"), "bone must be BoneMap; got 'ct.nrrd'. Make one: LabeledBone"),
        (lambda: library.reconstruct(SEQUENCE, grid=LABELS), "grid must be VoxelGrid; got Volume of shape .*volume.grid"),
        (lambda: library.Reconstructor(turned_grid(), probe="linear"), "probe must be ProbeGeometry; got 'linear'"),
        (lambda: library.Reconstructor(turned_grid(), region=(0, 0, 3, 3)), "region must be ImageRegion; got tuple"),
        (lambda: library.Reconstructor(turned_grid(), bone=sphere_bone().probability), "bone must be BoneMap; got Volume"),
        (lambda: library.Reconstructor(turned_grid()).insert(IMAGES), r"frames must be TrackedFrame; got ndarray of shape \(26,"),
        (lambda: library.BoneMap.from_labels([1, 2]), "labels must be Volume; got list"),
        (lambda: library.BoneMap.from_labels(LABELS.array), "labels must be Volume; got ndarray .* Give ijk_to_reference"),
        (lambda: library.BoneMap.from_probability(IMAGES), "probability must be Volume; .* Give ijk_to_reference"),
        (lambda: library.BoneMap.from_probability(LABELS, ijk_to_reference=np.eye(4)), "out, or give probability_to_reference"),
        (lambda: library.evaluate("volume.nrrd", LABELS), "Input volume must be Volume; got 'volume.nrrd'"),
        (lambda: library.evaluate(LABELS, "ct.nrrd"), "Input bone must be Volume or BoneTruth; got 'ct.nrrd'"),
        (lambda: library.evaluate(LABELS, LABELS, "mask.nrrd"), "Input mask must be Volume; got 'mask.nrrd'"),
        (lambda: library.evaluate(LABELS, LABELS, sweep="sweep.mha"), "Input sequence must be TrackedSequence; got 'sweep.mha'"),
        (lambda: bone_from_frames(SEQUENCE, Answering("bone"), recipe=LINEAR), "estimate must be .*; got 'bone'. An estimator ans"),
    ],
)
def test_another_kind_of_thing_is_refused_with_what_to_do(call, words):
    with pytest.raises(InputTypeError, match=words):
        call()


EVERYWHERE, NOWHERE = np.ones(IMAGES.shape, bool), np.zeros(IMAGES.shape, bool)
WIDER = np.diag([2.0, 2.0, 2.0, 1.0])


class Answering:
    """An estimator with one answer for all frames."""

    def __init__(self, answer):
        self.answer = answer

    def estimate(self, frame):
        return self.answer

    def notes(self):
        return ()


def masked(masks):
    return library.bone_from_masks(SEQUENCE, masks, LINEAR)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: library.TrackedSequence.from_arrays(IMAGES > 100, POSES), "of bool. Masks become images by"),
        (lambda: library.TrackedSequence.from_arrays(IMAGES, POSES.transpose(0, 2, 1)), "those of frame 0 and 2 more are transposed"),
        (lambda: library.TrackedFrame(IMAGES[0], np.eye(4)[:2]), r"image_to_reference must have shape \(4, 4\); got \(2, 4\)"),
        (lambda: library.LabeledBone(LABELS, WIDER), "a rotation and a translation, in mm; it is not rigid"),
        (lambda: library.LabeledBone(LABELS, np.eye(3)), r"Input labels_to_reference must have 16 numbers .* got shape \(3, 3\)"),
        (lambda: library.ComparisonFigure({"mine": LABELS.array}, (0, 0, 0)), "Input mine must be Volume; got ndarray of shape"),
        (lambda: masked(EVERYWHERE), "set where bone is; 100% of all pixels are"),
        (lambda: masked(EVERYWHERE[:2]), r"each of 3 frames, .*; got \(2, 26, 34\)"),
        (lambda: masked(IMAGES.transpose(0, 2, 1)), r"Give masks.transpose\(0, 2, 1\)"),
        (lambda: masked(POSES[:, 0]), r"mask 0: bone must be \(rows, columns\) .* got \(4,\)"),
        (lambda: masked(3.0 * (IMAGES.max() == IMAGES)), "must be 0 to 1; got 0 to 3"),
        # One channel, as networks give it, is none too many
        *((lambda masks=masks: masked(masks), "^(?!.*rows, columns).*bone") for masks in (NOWHERE, NOWHERE[:, None])),
        (lambda: bone_from_frames(SEQUENCE, Answering(IMAGES[0]), recipe=LINEAR), r"frame 0: .* must be 0 to 1; got 0 to \d+"),
        (lambda: library.Recipe(method=lambda intensity: (1.0, intensity)), "Write @register_method above it"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_with_their_shapes(call, words):
    with pytest.raises(AIFReconLib.AIFReconError, match=words):
        call()


def test_poses_may_be_3_x_4_and_lists():
    given = library.TrackedSequence.from_arrays(IMAGES.tolist(), [pose[:3].tolist() for pose in POSES])
    for record, pose in zip(given.records, POSES, strict=True):
        (sample,) = record.transforms.values()
        np.testing.assert_array_equal(sample.matrix, pose)
    frame = library.TrackedFrame(IMAGES[0].tolist(), POSES[0].tolist())
    np.testing.assert_array_equal(frame.placed()[0], IMAGES[0])
    np.testing.assert_array_equal(frame.placed()[1], POSES[0])


def test_a_method_is_given_by_its_name_or_as_it_is_and_the_old_name_of_the_recipe_is_told_to_be_old():
    @library.register_method
    def plain(intensity):
        return 1.0, intensity

    assert library.Recipe(method=plain).method == plain.name
    assert library.Recipe(method=method_named("average")).method == "average"
    assert get_args(MethodName) == METHODS
    with pytest.warns(DeprecationWarning, match="is now called Recipe"):
        assert library.ReconstructionSettings is library.Recipe
