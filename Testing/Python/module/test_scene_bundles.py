"""Scene bundles as Slicer's own MRML writes them, read without Slicer: every pose as the scene itself has it."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from sweeps import rigid

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
import tinyScene  # noqa: E402
from test_scene_foreign_sweep import (  # noqa: E402
    CALIBRATION,
    browser_of,
    image_nodes,
    images,
    live,
    pose_nodes,
    probe_pose,
    sequence_of,
    under_poses,
)

from AIFReconLib import read_sequence  # noqa: E402
from AIFReconLib.errors import SequenceFormatError  # noqa: E402
from AIFReconLib.sweep.poses import sweep_poses  # noqa: E402

TO_RAS = rigid((0.0, 0.0, 90.0), (10.0, 20.0, 30.0))


def saved(scene, tmp_path):
    assert scene.WriteToMRB(str(tmp_path / "scene.mrb"))
    return tmp_path / "scene.mrb"


def live_under_ras(scene, **options):
    browser = live(scene, **options)
    probe = browser.GetProxyNode(scene.GetFirstNodeByName("ProbeToReference"))
    tinyScene.addTransform("ReferenceToRAS", TO_RAS, probe)
    return browser


def test_the_transforms_above_the_images_place_them(scene, tmp_path):
    live_under_ras(scene)
    sequence = read_sequence(saved(scene, tmp_path))
    np.testing.assert_array_equal(np.asarray(sequence.images), images())
    np.testing.assert_allclose(sequence.timestamps, [0.0, 0.1, 0.2, 0.3])
    expected = [TO_RAS @ probe_pose(number) @ CALIBRATION for number in range(4)]
    # Slicer writes six digits
    np.testing.assert_allclose(sweep_poses(sequence).image_to_reference, expected, atol=1e-3)


def test_what_the_tracker_said_is_lost_in_a_bundle_and_that_is_said(scene, tmp_path):
    """Slicer writes OK for all."""
    live_under_ras(scene, statuses=["OK", "OUT_OF_VIEW", "OK", "MISSING"])
    sequence = read_sequence(saved(scene, tmp_path))
    assert sweep_poses(sequence).usable.tolist() == [0, 1, 2, 3]
    assert sequence.notes[-1].startswith("Slicer's bundles say of every pose that it is valid")


@pytest.mark.parametrize(
    ("suffix", "kept", "words"),
    [
        (".seq.mha", None, r"the file of ProbeToReference \(Data/ProbeToReference\.seq\.mha\) is not in it"),
        (".seq.nrrd", 200, r"scene\.mrb: .*scene/Data/Image_Image\.seq\.nrrd"),
    ],
)
def test_a_file_that_the_bundle_lacks_or_that_is_damaged_is_named(scene, tmp_path, suffix, kept, words):
    live_under_ras(scene)
    path = saved(scene, tmp_path)
    with zipfile.ZipFile(path) as archive:
        members = {info.filename: archive.read(info) for info in archive.infolist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in members.items():
            if not name.endswith(suffix):
                archive.writestr(name, data)
            elif kept:
                archive.writestr(name, data[:kept])
    with pytest.raises(SequenceFormatError, match=words):
        read_sequence(path)


@pytest.mark.parametrize("make", [browser_of, under_poses])
def test_transforms_that_were_recorded_beside_the_images_are_taken_by_name_and_the_images_own_geometry_counts(scene, tmp_path, make):
    own = np.diag([-0.5, -0.3, 1.0, 1.0]) if make is under_poses else np.eye(4)
    recorded = sequence_of(scene, "ImageToReference", pose_nodes([probe_pose(n) @ CALIBRATION for n in range(3)], "ImageToReference"))
    make(scene, sequence_of(scene, "Image", image_nodes(images(3), lambda number: own)), recorded)
    poses = sweep_poses(read_sequence(saved(scene, tmp_path))).image_to_reference
    np.testing.assert_allclose(poses, [probe_pose(n) @ CALIBRATION @ own for n in range(3)], atol=1e-3)


def test_a_scene_without_a_recording_and_one_with_two_say_so(scene, tmp_path):
    with pytest.raises(SequenceFormatError, match="must hold one recording of images; got 0"):
        read_sequence(saved(scene, tmp_path))
    for name in ("First", "Second"):
        browser_of(scene, sequence_of(scene, name, image_nodes(images(2))), name=name)
    with pytest.raises(SequenceFormatError, match=r"got 2 \(First, Second\)"):
        read_sequence(saved(scene, tmp_path))
