"""What is of another kind than what is taken is refused in a sentence that says what to do: paths, arrays, poses, names."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from sweeps import oblique_frames, sphere_bone, turned_grid

import AIFReconLib
from AIFReconLib.bone.predicted_bone import bone_from_frames
from AIFReconLib.compounding.methods.table import METHODS, MethodName, method_named
from AIFReconLib.errors import InputTypeError

library: Any = AIFReconLib
"""For a checker of types these calls are wrong too."""

FRAMES = oblique_frames(count=3)
IMAGES, POSES = np.stack([f.placed()[0] for f in FRAMES]), np.stack([f.placed()[1] for f in FRAMES])
SEQUENCE = library.TrackedSequence.from_arrays(IMAGES, POSES)
LINEAR = library.Recipe(probe="linear")
LABELS = library.Volume(np.pad(np.ones((1, 1, 1), np.uint8), 1), np.eye(4))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: library.reconstruct("sweep.igs.mha"),
            r"^Input sequence must be TrackedSequence; got 'sweep.igs.mha'. Read it first",
        ),
        (lambda: library.reconstruct(Path("sweep.igs.mha")), r"got 'sweep.igs.mha'. Read it first"),
        (lambda: library.reconstruct([SEQUENCE, "second.mha"]), r"got 'second.mha'. Read it first"),
        (lambda: library.reconstruct(IMAGES), r"got ndarray of shape \(3, 26, 34\).*TrackedSequence.from_arrays"),
        (lambda: library.reconstruct(None), r"must be TrackedSequence; got NoneType"),
        (lambda: library.bone_from_sweep("sweep.igs.mha"), r"Input sequence must be TrackedSequence; got 'sweep.igs.mha'"),
        (lambda: library.register("sweep.igs.mha", LABELS), r"Input sequence must be TrackedSequence; got 'sweep.igs.mha'"),
        (lambda: library.register(SEQUENCE, "lumbar.nrrd"), r"Input labels must be Volume; got 'lumbar.nrrd'. Read it first: read_labels"),
        (
            lambda: library.LabeledBone("lumbar.nrrd", np.eye(4)),
            r"Input labels must be Volume; got 'lumbar.nrrd'. Read it first: read_labels",
        ),
        (lambda: library.LabeledBone(LABELS.array), r"got ndarray of shape .* of an array make one: Volume\(array, ijk_to_reference\)"),
        (lambda: library.reconstruct(SEQUENCE, "weighted"), r"Input recipe must be Recipe; got 'weighted'. Write"),
        (
            lambda: library.reconstruct(SEQUENCE, bone="lumbar.nrrd"),
            r"Input bone must be BoneMap; got 'lumbar.nrrd'. Make one: LabeledBone",
        ),
        (lambda: library.reconstruct(SEQUENCE, grid=LABELS), r"Input grid must be VoxelGrid; got Volume of shape .*volume.grid"),
        (lambda: library.Reconstructor(turned_grid(), probe="linear"), r"Input probe must be ProbeGeometry; got 'linear'"),
        (lambda: library.Reconstructor(turned_grid(), region=(0, 0, 3, 3)), r"Input region must be ImageRegion; got tuple"),
        (lambda: library.Reconstructor(turned_grid(), bone=sphere_bone().probability), r"Input bone must be BoneMap; got Volume"),
        (
            lambda: library.Reconstructor(turned_grid()).insert(IMAGES),
            r"Input frames must be TrackedFrame; got ndarray of shape \(26, 34\)",
        ),
        (lambda: library.BoneMap.from_labels([1, 2]), r"Input labels must be Volume; got list"),
        (
            lambda: library.BoneMap.from_labels(LABELS.array),
            r"Input labels must be Volume; got ndarray of shape .* Give ijk_to_reference",
        ),
        (lambda: library.BoneMap.from_probability(np.ones((2, 2, 2))), r"Input probability must be Volume; .* Give ijk_to_reference"),
        (lambda: library.BoneMap.from_probability(LABELS, ijk_to_reference=np.eye(4)), r"Leave it out, or give probability_to_reference"),
        (lambda: library.evaluate("volume.nrrd", LABELS), r"Input volume must be Volume; got 'volume.nrrd'"),
        (lambda: library.evaluate(LABELS, "lumbar.nrrd"), r"Input bone must be Volume or BoneTruth; got 'lumbar.nrrd'"),
        (lambda: library.evaluate(LABELS, LABELS, "mask.nrrd"), r"Input mask must be Volume; got 'mask.nrrd'"),
        (lambda: library.evaluate(LABELS, LABELS, sweep="sweep.igs.mha"), r"Input sequence must be TrackedSequence; got 'sweep.igs.mha'"),
    ],
)
def test_another_kind_of_thing_is_refused_with_what_to_do(call, words):
    with pytest.raises(InputTypeError, match=words):
        call()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: library.TrackedSequence.from_arrays(IMAGES > 100, POSES),
            r"of bool. Masks become images by",
        ),
        (lambda: library.TrackedFrame(IMAGES[0], np.eye(4)[:2]), r"image_to_reference must have shape \(4, 4\); got \(2, 4\)"),
        (lambda: library.TrackedSequence.from_arrays(IMAGES, POSES.transpose(0, 2, 1)), r"those of frame 0 and 2 more are transposed"),
        (lambda: library.bone_from_masks(SEQUENCE, np.ones(IMAGES.shape, bool), LINEAR), r"set where bone is; 100% of all pixels are"),
        (lambda: library.LabeledBone(LABELS, np.diag([2.0, 2.0, 2.0, 1.0])), r"a rotation and a translation, in mm; it is not rigid"),
        (lambda: library.ComparisonFigure({"mine": LABELS.array}, (0, 0, 0)), r"Input mine must be Volume; got ndarray of shape"),
        (lambda: library.LabeledBone(LABELS, np.eye(3)), r"Input labels_to_reference must have 16 numbers .* got shape \(3, 3\)"),
        (
            lambda: library.bone_from_masks(SEQUENCE, IMAGES[:2] > 100),
            r"each of 3 frames, .*; got \(2, 26, 34\)",
        ),
        (lambda: library.bone_from_masks(SEQUENCE, np.zeros_like(IMAGES.transpose(0, 2, 1)), LINEAR), r"Give masks.transpose\(0, 2, 1\)"),
        (lambda: library.bone_from_masks(SEQUENCE, POSES[:, 0], LINEAR), r"mask 0: bone must be \(rows, columns\) .* got \(4,\)"),
        (lambda: library.bone_from_masks(SEQUENCE, 3.0 * (IMAGES.max() == IMAGES), LINEAR), r"must be 0 to 1; got 0 to 3"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_with_their_shapes(call, words):
    with pytest.raises(AIFReconLib.AIFReconError, match=words):
        call()


@pytest.mark.parametrize("channel", [False, True])
def test_masks_may_have_the_one_channel_of_a_network(channel):
    """What is refused of them is the same."""
    masks = np.zeros(IMAGES.shape, bool)
    with pytest.raises(AIFReconLib.AIFReconError, match="bone") as none:
        library.bone_from_masks(SEQUENCE, masks[:, None] if channel else masks, LINEAR)
    assert "must be (rows, columns)" not in str(none.value)


def test_a_function_that_is_no_method_yet_is_refused_with_what_makes_it_one():
    with pytest.raises(AIFReconLib.AIFReconError, match="Write @register_method above it"):
        library.Recipe(method=lambda intensity: (1.0, intensity))


def test_poses_may_be_3_x_4_and_lists():
    given = library.TrackedSequence.from_arrays(IMAGES.tolist(), [pose[:3].tolist() for pose in POSES])
    for record, pose in zip(given.records, POSES, strict=True):
        (sample,) = record.transforms.values()
        np.testing.assert_array_equal(sample.matrix, pose)


def test_a_frame_may_be_made_of_lists():
    frame = library.TrackedFrame(IMAGES[0].tolist(), POSES[0].tolist())
    np.testing.assert_array_equal(frame.placed()[0], IMAGES[0])
    np.testing.assert_array_equal(frame.placed()[1], POSES[0])


def test_a_method_is_given_by_its_name_or_as_it_is():
    @library.register_method
    def plain(intensity):
        return 1.0, intensity

    assert library.Recipe(method=plain).method == plain.name
    assert library.Recipe(method=method_named("average")).method == "average"
    assert get_args(MethodName) == METHODS


def test_an_estimator_may_answer_with_an_array():
    class Everywhere:
        def estimate(self, frame):
            return frame.image  # gray levels, no probabilities

        def notes(self):
            return ()

    with pytest.raises(AIFReconLib.AIFReconError, match=r"frame 0: a probability of bone must be 0 to 1; got 0 to \d+"):
        bone_from_frames(SEQUENCE, Everywhere(), recipe=LINEAR)


def test_an_estimator_that_answers_something_else_is_told_what_to_answer():
    class Words:
        def estimate(self, frame):
            return "bone"

        def notes(self):
            return ()

    with pytest.raises(InputTypeError, match=r"Input estimate must be .*; got 'bone'. An estimator answers with an array"):
        bone_from_frames(SEQUENCE, Words(), recipe=LINEAR)


def test_the_old_name_of_the_recipe_is_told_to_be_old():
    with pytest.warns(DeprecationWarning, match="is now called Recipe"):
        assert library.ReconstructionSettings is library.Recipe
