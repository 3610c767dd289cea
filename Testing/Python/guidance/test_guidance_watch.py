"""Guidance beside a session: it tells what the frames met, follows a CT that is placed anew, and says why it cannot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from idle_session import IMAGES, LIT, show
from sweeps import rigid, two_vertebrae
from waiting import until

from AIFReconLib.errors import BeamGeometryError
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.guidance.bone_coverage import CoverageAccumulator, FrameGeometry
from AIFReconLib.guidance.guidance import NOT_IN_BOX
from AIFReconLib.guidance.probe import ProbePlacement
from AIFReconLib.live.pairing.synchronizer import LiveFrame

MOVED = rigid(translation=(0.0, 3.0, 12.0))


@pytest.fixture(scope="module")
def frames(probe):
    poses = [probe.pose(ProbePlacement(x, 0.0, 90.0, tilt)) for tilt in (-30.0, 30.0) for x in (-6.0, 0.0, 6.0)]
    return [LiveFrame(LIT, pose, timestamp=0.1 * n, number=n) for n, pose in enumerate(poses)]


def of(frames, place=None):
    met = CoverageAccumulator(FrameGeometry(guided_bone(two_vertebrae(), place), IMAGES.frame_size, IMAGES.geometry, IMAGES.region))
    for frame in frames:
        met.insert(frame.image_to_reference)
    return met


def test_a_watch_tells_what_the_frames_met(watching, frames):
    session, watch = watching()
    show(session, watch, frames)
    expected = of(frames).best_cosine
    assert until(lambda: watch.state.best_cosine is not None and np.array_equal(watch.state.best_cosine, expected, equal_nan=True))
    assert watch.state.coverage.interspinous.met > 0.1


def test_a_ct_that_is_placed_anew_is_told_from_the_poses_so_far(watching, frames):
    session, watch = watching()
    show(session, watch, frames[:-1])
    watch.place(MOVED)
    assert until(lambda: not watch._mets)
    session.latest = frames[-1]
    expected = of(frames, MOVED).best_cosine

    def same() -> bool:
        best = watch.state.best_cosine
        # Rounding may put a point on the other side of an edge
        return best is not None and (np.isclose(best, expected, equal_nan=True).mean() > 0.995)

    assert until(same)


def test_a_next_move_leads_to_places_that_were_not_seen(watching, frames):
    """And bone is told as before."""
    session, watch = watching(unseen=np.array([(6.0, -5.0, 0.0), (6.0, -2.0, 0.0), (9.0, -5.0, 0.0)]))
    show(session, watch, frames)
    assert until(lambda: watch._advisor is not None)
    session.latest = replace(frames[0], number=9)
    assert until(lambda: watch.state.advice is not None and watch.state.advice.move is not None)
    assert watch.state.seen().move.adds_cm2 is None
    expected = of([*frames, frames[0]]).best_cosine
    assert until(lambda: np.array_equal(watch.state.best_cosine, expected, equal_nan=True))
    watch.place(MOVED)
    assert until(lambda: not watch._mets)
    session.latest = replace(frames[0], number=10)
    assert until(lambda: len(watch._mets) == 2 and watch._mets[1].frames.any() and not watch._again)


def test_labels_that_lose_their_bone_in_mid_scan_are_a_sentence_and_come_back(watching, frames):
    session, watch = watching()
    show(session, watch, frames[:3])
    labels = two_vertebrae()
    watch.place(np.eye(4), Volume(np.zeros_like(labels.array), labels.ijk_to_reference))
    assert until(lambda: watch.state.problem is not None)
    assert "voxels above 0" in str(watch.state.problem)
    watch.place(np.eye(4), labels)
    assert until(lambda: watch._bone is not None)
    session.latest = frames[3]
    assert until(lambda: watch.state.problem is None and watch.state.coverage is not None)


def test_an_unknown_probe_is_a_sentence(watching, frames):
    def unknown():
        raise BeamGeometryError("The probe cannot be told.")

    session, watch = watching()
    session.imaging = unknown
    show(session, watch, frames[:1])
    assert until(lambda: watch.state.problem == "The probe cannot be told.")


def test_a_box_without_bone_is_a_sentence_and_another_one_brings_the_colors(watching, frames):
    session, watch = watching()
    session.grid = VoxelGrid.from_spacing((200.0, 0.0, 0.0), (10, 10, 10), 1.0)
    show(session, watch, frames[:2])
    assert until(lambda: watch.state.problem == NOT_IN_BOX)
    session.grid = VoxelGrid.from_spacing((-40.0, -40.0, -40.0), (80, 80, 80), 1.0)
    show(session, watch, frames[2:])
    assert until(lambda: watch.state.problem is None and watch.state.coverage is not None)


def test_bone_that_lies_awry_is_told_from_where_the_first_frame_looks(watching, frames):
    session, watch = watching()
    turned = rigid((180.0, 0.0, 0.0))
    show(session, watch, [])
    watch.place(turned)
    show(session, watch, frames)
    assert until(lambda: watch.state.coverage is not None)
    front = watch._bone.patient_to_reference[:3, 1]
    assert front @ frames[0].image_to_reference[:3, 1] > 0
