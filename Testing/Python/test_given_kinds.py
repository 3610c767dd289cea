"""What is of another kind than what is taken is refused in a sentence that says what to do: paths, arrays, poses, names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sweeps import oblique_frames, sphere_bone, turned_grid

import AIFReconLib
from AIFReconLib.errors import InputTypeError

library: Any = AIFReconLib
"""For a checker of types these calls are wrong too."""

FRAMES = oblique_frames(count=3)
IMAGES, POSES = np.stack([f.placed()[0] for f in FRAMES]), np.stack([f.placed()[1] for f in FRAMES])
SEQUENCE = library.TrackedSequence.from_arrays(IMAGES, POSES)
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
        (lambda: library.reconstruct(SEQUENCE, "weighted"), r"Input recipe must be Recipe; got 'weighted'. Write"),
        (
            lambda: library.reconstruct(SEQUENCE, bone="lumbar.nrrd"),
            r"Input bone must be BoneMap; got 'lumbar.nrrd'. Make one: BoneMap.from",
        ),
        (lambda: library.reconstruct(SEQUENCE, grid=LABELS), r"Input grid must be VoxelGrid; got Volume of shape .*volume.grid"),
        (lambda: library.Reconstructor(turned_grid(), probe="linear"), r"Input probe must be ProbeGeometry; got 'linear'"),
        (lambda: library.Reconstructor(turned_grid(), region=(0, 0, 3, 3)), r"Input region must be ImageRegion; got tuple"),
        (lambda: library.Reconstructor(turned_grid(), bone=sphere_bone().probability), r"Input bone must be BoneMap; got Volume"),
        (
            lambda: library.Reconstructor(turned_grid()).insert(IMAGES),
            r"Input frames must be TrackedFrame; got ndarray of shape \(26, 34\)",
        ),
        (lambda: library.TransformGraph(POSES), r"Input transforms must be dict; got ndarray of shape \(3, 4, 4\)"),
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
