"""Sweeps that somebody else put into the scene: recorded live through OpenIGTLink, imported, or arranged by hand."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import rigid

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
import tinyScene  # noqa: E402

from AIFReconLib import read_sequence  # noqa: E402
from AIFReconLib.sweep.poses import sweep_poses  # noqa: E402

CALIBRATION = rigid((5.0, 60.0, -4.0), (1.0, -2.0, 3.0)) @ np.diag([0.3, 0.5, 0.4, 1.0])


def probe_pose(number: int) -> np.ndarray:
    return rigid((10.0 * number, 5.0, -20.0), (3.0 * number, 40.0, -7.0))


def images(count=4, shape=(5, 7)) -> list[np.ndarray]:
    return [np.random.default_rng(number).integers(0, 255, shape).astype(np.uint8) for number in range(count)]


def sequence_of(scene, name, nodes, values=None):
    """A sequence node of these data nodes, numbered by 0.1 s."""
    sequence = scene.AddNewNodeByClass("vtkMRMLSequenceNode", name)
    sequence.SetIndexName("time")
    sequence.SetIndexUnit("s")
    for number, node in enumerate(nodes):
        sequence.SetDataNodeAtValue(node, f"{0.1 * number:.3f}" if values is None else values[number])
    return sequence


def image_nodes(arrays, matrix=None):
    for number, array in enumerate(arrays):
        node = slicer.vtkMRMLScalarVolumeNode()
        node.SetName("Image_Image")
        if array is not None:
            slicer.util.updateVolumeFromArray(node, array[None])
        node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(matrix(number) if matrix else np.eye(4)))
        yield node


def pose_nodes(matrices, name="ProbeToReference", statuses=None, attribute="TransformStatus"):
    for number, matrix in enumerate(matrices):
        node = slicer.vtkMRMLLinearTransformNode()
        node.SetName(name)
        node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(matrix))
        if statuses:
            node.SetAttribute(attribute, statuses[number])
        yield node


def browser_of(scene, master, *others, name="Live"):
    browser = scene.AddNewNodeByClass("vtkMRMLSequenceBrowserNode", name)
    browser.SetAndObserveMasterSequenceNodeID(master.GetID())
    for sequence in others:
        browser.AddSynchronizedSequenceNode(sequence)
    for sequence in (master, *others):
        if browser.GetProxyNode(sequence) is None:
            browser.AddProxyNode(sequence.GetNthDataNode(0), sequence, True)
    return browser


def live(scene, **options):
    """What SlicerIGT users have: image under the static ImageToProbe under the recorded ProbeToReference."""
    recorded = sequence_of(scene, "ProbeToReference", pose_nodes([probe_pose(n) for n in range(4)], **options))
    pictures = sequence_of(scene, "Image_Image", image_nodes(images()))
    browser = browser_of(scene, pictures, recorded)
    calibration = tinyScene.addTransform("ImageToProbe", CALIBRATION, browser.GetProxyNode(pictures))
    calibration.SetAndObserveTransformNodeID(browser.GetProxyNode(recorded).GetID())
    return browser


def read(browser):
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    return sequenceFromBrowser(browser)


def poses_of(browser) -> np.ndarray:
    return sweep_poses(read(browser)).image_to_reference


# ---- parent transforms


def under_poses(scene, pictures, recorded, poses_lead=False):
    """A browser that replays images under the transform of their poses."""
    browser = browser_of(scene, *((recorded, pictures) if poses_lead else (pictures, recorded)))
    browser.GetProxyNode(pictures).SetAndObserveTransformNodeID(browser.GetProxyNode(recorded).GetID())
    return browser


def test_reference_to_ras_above_a_live_recording_and_the_image_s_own_matrix_below_count(scene):
    own, reference_to_ras = np.diag([-1.0, -1.0, 1.0, 1.0]), rigid((0.0, 0.0, 90.0), (10.0, 20.0, 30.0))
    recorded = sequence_of(scene, "ImageToReference", pose_nodes([probe_pose(n) for n in range(3)], "ImageToReference"))
    browser = under_poses(scene, sequence_of(scene, "Image", image_nodes(images(3), lambda number: own)), recorded)
    tinyScene.addTransform("ReferenceToRAS", reference_to_ras, browser.GetProxyNode(recorded))
    assert np.allclose(poses_of(browser)[1], reference_to_ras @ probe_pose(1) @ own, atol=1e-12)


@pytest.mark.parametrize(
    ("attribute", "statuses"),
    [
        ("TransformStatus", ["OK", "OUT_OF_VIEW", "OK", "MISSING"]),
        ("OpenIGTLink.TransformStatus", ["OK", "OUT_OF_VIEW", "OK", "MISSING"]),
        ("OpenIGTLink.TransformValid", ["true", "false", "True", "0"]),
    ],
)
def test_a_status_from_the_live_stream_keeps_frames_out(scene, attribute, statuses):
    browser = live(scene, statuses=statuses, attribute=attribute)
    assert sweep_poses(read(browser)).usable.tolist() == [0, 2]


POSES_AND_LEADERS = {
    "poses lead": ([0.0, 0.2, 0.4, 0.6], [0.05 * n for n in range(14)], True),
    "poses between images": ([0.0, 0.2, 0.4, 0.6], [0.0, *(0.05 * n + 0.03 for n in range(1, 14))], False),
    "poses that stop": ([0.5 * n for n in range(9)], [0.0, 0.5, 1.0, 4.0], False),
    "poses that begin late": ([0.1 * n for n in range(5)], [0.25, 0.35, 0.45], False),
    "times off by less than a millisecond": ([0.1, 0.2, 0.3], [0.1009, 0.2009, 0.2991], True),
}


@pytest.mark.parametrize(("image_times", "pose_times", "poses_lead"), POSES_AND_LEADERS.values(), ids=POSES_AND_LEADERS)
def test_a_browser_places_the_frames_that_its_files_place(scene, tmp_path, image_times, pose_times, poses_lead):
    pictures, recorded = at_times(scene, image_times, pose_times)
    browser = under_poses(scene, pictures, recorded, poses_lead)
    found, expected = read(browser), read_files(tmp_path, pictures, recorded)
    assert [frame[0, 0] for frame in found.images] == [frame[0, 0] for frame in expected.images]
    places = [sweep_poses(sequence).image_to_reference for sequence in (found, expected)]
    # Slicer writes matrices with six digits
    assert np.allclose(*places, rtol=1e-5, atol=1e-6, equal_nan=True)


def at_times(scene, image_times, pose_times):
    """Images of different grays, and poses that move by 10 mm/s."""
    grays = [np.full((5, 7), 20 + number, np.uint8) for number in range(len(image_times))]
    poses = [rigid((0.0, 0.0, 20.0 * time), (0.0, 0.0, 10.0 * time)) @ np.diag([0.3, 0.5, 0.4, 1.0]) for time in pose_times]
    pictures = sequence_of(scene, "Image", image_nodes(grays), [f"{time:.4f}" for time in image_times])
    return pictures, sequence_of(scene, "ImageToReference", pose_nodes(poses, "ImageToReference"), [f"{time:.4f}" for time in pose_times])


def read_files(folder, pictures, recorded):
    """The two sequences as Slicer writes them and as the command line reads them."""
    paths = folder / "Image.seq.nrrd", folder / "ImageToReference.seq.mha"
    storages = slicer.vtkMRMLVolumeSequenceStorageNode(), slicer.vtkMRMLLinearTransformSequenceStorageNode()
    for path, storage, node in zip(paths, storages, (pictures, recorded), strict=True):
        storage.SetFileName(str(path))
        assert storage.WriteData(node)
    return read_sequence(paths[0], transform_sequences={"ImageToReference": paths[1]})


@pytest.mark.parametrize(("type_name", "values"), [("TextIndex", ["late", "early", "between"]), ("NumericIndex", ["0", "7", "8"])])
def test_items_that_are_not_numbered_by_time_belong_to_their_like(scene, type_name, values):
    pictures, recorded = sequence_of(scene, "Image", []), sequence_of(scene, "ImageToReference", [])
    for sequence, nodes, of in (
        (pictures, image_nodes(images(3)), values),
        (recorded, pose_nodes([probe_pose(1), probe_pose(2)], "ImageToReference"), values[:0:-1]),
    ):
        sequence.SetIndexType(getattr(slicer.vtkMRMLSequenceNode, type_name))
        sequence.SetIndexName("place")
        sequence.SetIndexUnit("")
        for node, value in zip(nodes, of, strict=True):
            sequence.SetDataNodeAtValue(node, value)
    browser = browser_of(scene, pictures, recorded, name="Places")
    assert np.allclose(poses_of(browser), [np.full((4, 4), np.nan), probe_pose(2), probe_pose(1)], atol=1e-12, equal_nan=True)


def test_a_transform_whose_replay_is_off_stays_where_it_is(scene):
    browser = live(scene)
    sequence = scene.GetFirstNodeByName("ProbeToReference")
    browser.SetPlayback(sequence, False)
    browser.GetProxyNode(sequence).SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(probe_pose(7)))
    assert np.allclose(poses_of(browser), [probe_pose(7) @ CALIBRATION] * 4, atol=1e-12)


# ---- transforms found by their names


def test_images_without_a_parent_are_placed_by_the_names_of_transforms(scene):
    calibration = sequence_of(scene, "ImageToProbe", pose_nodes([CALIBRATION] * 3, "ImageToProbe"))
    recorded = sequence_of(scene, "ProbeToReference", pose_nodes([probe_pose(n) for n in range(3)]))
    browser = browser_of(scene, sequence_of(scene, "Image", image_nodes(images(3))), calibration, recorded)
    assert np.allclose(poses_of(browser), [probe_pose(n) @ CALIBRATION for n in range(3)], atol=1e-12)


@pytest.mark.parametrize("telling", ["sequence", "proxy", "items"])
def test_a_transform_is_known_by_whichever_of_its_names_says_where_it_leads(scene, telling):
    recorded = sequence_of(scene, "S", pose_nodes([CALIBRATION] * 3, "ImageToReference" if telling == "items" else "T"))
    browser = browser_of(scene, sequence_of(scene, "Image", image_nodes(images(3))), recorded)
    proxy = browser.GetProxyNode(recorded)
    for node in (proxy, *(recorded.GetNthDataNode(number) for number in range(3))):
        node.SetAttribute("Sequences.BaseName", None)
    recorded.SetName("ImageToReference" if telling == "sequence" else "renamed")
    proxy.SetName("ImageToReference" if telling == "proxy" else "renamed too")
    assert np.allclose(poses_of(browser)[1], CALIBRATION, atol=1e-12)


def test_what_is_known_of_a_sweep_is_looked_up_again_when_a_node_that_is_replayed_into_is_renamed(scene):
    from AIFReconScene.sweep.sweepStatus import SweepStatus

    recorded = sequence_of(scene, "S", pose_nodes([CALIBRATION] * 3, "T"))
    browser = browser_of(scene, sequence_of(scene, "Image", image_nodes(images(3))), recorded)
    status = SweepStatus()
    assert status.of(browser).problem
    browser.GetProxyNode(recorded).SetName("ImageToReference")
    assert status.of(browser).lines == ["3 of 3 frames have a position."]


# ---- poses within the images


def test_the_status_of_the_image_s_own_transform_counts_and_that_of_a_stylus_does_not(scene):
    pictures = sequence_of(scene, "Image_Reference", image_nodes(images(3), lambda n: probe_pose(n) @ CALIBRATION))
    pictures.GetNthDataNode(0).SetAttribute("OpenIGTLink.StylusToTrackerTransformStatus", "OUT_OF_VIEW")
    pictures.GetNthDataNode(1).SetAttribute("OpenIGTLink.ProbeToTrackerTransformStatus", "OUT_OF_VIEW")
    assert sweep_poses(read(browser_of(scene, pictures))).skipped() == {"ImageToReference OUT_OF_VIEW": [1]}


# ---- images


@pytest.mark.parametrize(("code", "rows", "columns"), [("UFD", 1, -1), ("MND", -1, 1), ("UN", -1, -1), ("MFA", 1, 1), ("??", 1, 1)])
def test_images_of_another_orientation_are_turned(scene, code, rows, columns):
    browser = live(scene)
    browser.GetMasterSequenceNode().SetAttribute("Sequences.UltrasoundImageOrientation", code)
    assert np.array_equal(read(browser).images[2], images()[2][::rows, ::columns])


def test_an_item_without_an_image_is_a_frame_without_one(scene):
    frames = images(3)
    frames[1] = None
    browser = browser_of(scene, sequence_of(scene, "I", image_nodes(frames, lambda n: probe_pose(n) @ CALIBRATION)))
    assert sweep_poses(read(browser)).skipped() == {"no image (MISSING)": [1]}


def test_a_summary_counts_frames_by_reason(scene):
    from AIFReconScene.sweep.sequenceReader import sweepSummary

    assert sweepSummary(live(scene, statuses=["OK", "OUT_OF_VIEW", "OK", "MISSING"])).lines == [
        "2 of 4 frames have a position.",
        "Will be skipped: 1 frame (1): ProbeToReference OUT_OF_VIEW.",
        "Will be skipped: 1 frame (3): ProbeToReference MISSING.",
    ]
