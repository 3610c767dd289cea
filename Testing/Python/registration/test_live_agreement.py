"""Whether CT and patient agree while a scan goes on: over the last seconds, after the patient has moved, and beside the session."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
import pytest
from idle_session import IdleSession
from sweeps import rigid
from waiting import until

from AIFReconLib.bone.field import BoneField
from AIFReconLib.effective_settings import resolve_imaging
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.live.pairing.synchronizer import LiveFrame
from AIFReconLib.live.session.agreement_watch import AgreementWatch
from AIFReconLib.registration.live import LiveAgreement
from AIFReconLib.registration.registration import register_echoes
from AIFReconLib.simulation.anatomy import LumbarAnatomy, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep, plus_configuration_xml, simulate_sweep
from AIFReconLib.sweep.poses import sweep_poses, tracked_frames

FRAMES, RATE = 27, 10.0
"""Of the simulated sweep, and how many come in a second: all of them lie within the seconds that are looked back upon."""

MOVED = rigid((0.0, 0.0, 0.0), (9.0, 4.0, 6.0))
"""Of a patient who shifts."""


@dataclass(frozen=True)
class Scan:
    """A patient: the bone of the CT, its true place, the frames in time order, and how their images are to be read."""

    bone: BoneField
    place: np.ndarray
    frames: list
    imaging: object

    def at(self, start: float, motion=None) -> list:
        """The frames as they come from `start` s on, of a patient who has moved."""
        placed = np.eye(4) if motion is None else motion
        return [
            LiveFrame(frame.image, placed @ frame.image_to_reference, timestamp=start + number / RATE, number=number)
            for number, frame in enumerate(self.frames)
        ]


@pytest.fixture(scope="module")
def scan(tmp_path_factory) -> Scan:
    phantom, probe = make_lumbar_phantom(LumbarAnatomy.from_seed(0, vertebrae=2), spacing=1.5), PhasedArray()
    path = tmp_path_factory.mktemp("scan") / "PlusDeviceSet.xml"
    path.write_text(plus_configuration_xml(probe), encoding="utf-8")
    sequence = simulate_sweep(phantom, probe, multi_angle_sweep(phantom, FRAMES), seed=0)
    sequence = replace(sequence, configuration=read_plus_configuration(path))
    poses = sweep_poses(sequence)
    frames = list(tracked_frames(sequence, poses, range(len(sequence))))
    bone = BoneField.from_labels(phantom.labels)
    return Scan(bone, phantom.ct_to_reference, frames, resolve_imaging(sequence, poses, True))


@pytest.fixture
def live(scan) -> LiveAgreement:
    return LiveAgreement(scan.bone, scan.place, scan.imaging)


def feed(live: LiveAgreement, frames) -> None:
    for frame in frames:
        live.add(frame)


# The last seconds


@pytest.mark.parametrize("motion", [MOVED, rigid(translation=(0.0, 0.0, 5.0))], ids=["shifted", "by five millimeters"])
def test_a_patient_who_moves_is_noticed(motion, live, scan):
    assert live.agreement() is None
    feed(live, scan.at(0.0))
    assert live.agreement().enough
    assert not live.has_fallen()
    feed(live, scan.at(10.0, motion))
    assert live.has_fallen()


def test_a_patient_who_moved_is_not_forgotten_while_no_bone_is_seen(live, scan):
    feed(live, scan.at(0.0))
    live.agreement()
    feed(live, scan.at(10.0, MOVED))
    assert live.has_fallen()
    dark = replace(scan.at(60.0)[0], image=np.zeros_like(scan.frames[0].image))
    feed(live, [dark])
    assert live.agreement() is None
    assert live.has_fallen()


def test_what_is_older_than_the_last_seconds_is_forgotten(live, scan):
    feed(live, scan.at(0.0, MOVED))
    feed(live, scan.at(10.0))
    fresh = LiveAgreement(scan.bone, scan.place, scan.imaging)
    feed(fresh, scan.at(10.0))
    assert live.agreement() == fresh.agreement()
    assert len(live.echoes()) == len(fresh.echoes())


def test_a_recording_that_begins_anew_forgets_what_came_before(live, scan):
    feed(live, scan.at(100.0, MOVED))
    feed(live, scan.at(0.0))
    assert live.agreement().enough


def test_images_of_another_size_do_not_end_it(live, scan):
    feed(live, scan.at(0.0))
    cut = [replace(frame, image=frame.image[: frame.image.shape[0] // 2]) for frame in scan.at(3.0)]
    feed(live, cut[:3])
    assert live.agreement() is not None


# Beside a session


@pytest.fixture
def watching(scan, monkeypatch):
    """A session and its watch, which looks without a rest."""
    monkeypatch.setattr("AIFReconLib.live.session.agreement_watch.PERIOD", 0.001)
    session = IdleSession()
    session.imaging = lambda: scan.imaging
    watch = AgreementWatch(session, scan.bone, scan.place)
    yield session, watch
    watch.stop()


def show(session, watch, frames) -> None:
    """Let a watch see every frame."""
    for frame in frames:
        session.latest = frame
        while watch._last is not frame:
            time.sleep(0.001)
    assert until(lambda: watch.agreement is not None)


def test_frames_that_come_while_one_is_looked_at_are_passed_over(watching, scan):
    session, watch = watching
    for frame in scan.at(0.0):
        session.latest = frame
    assert until(lambda: watch._last is session.latest)
    assert watch.agreement is None


def test_a_ct_is_placed_by_the_whole_scan_while_all_is_well(watching, scan):
    session, watch = watching
    show(session, watch, [*scan.at(0.0), *scan.at(20.0)])
    assert until(lambda: len(watch.echoes()) > 1.8 * len(watch._echoes[1]))


def test_a_ct_is_placed_by_the_last_seconds_after_the_patient_has_moved(watching, scan):
    session, watch = watching
    show(session, watch, [*scan.at(0.0), *scan.at(20.0, MOVED)])
    assert until(lambda: watch.has_fallen)
    found = register_echoes(watch.echoes(), scan.bone, scan.place)
    assert found.accepted
    watch.place(found.transform)
    assert until(lambda: not watch.has_fallen)
    assert watch.agreement.enough


def test_a_ct_is_placed_by_all_frames_since_the_patient_moved_however_slowly_they_come(watching, scan):
    session, watch = watching
    slow = [replace(frame, timestamp=100.0 + 2.0 * number) for number, frame in enumerate(scan.at(0.0, MOVED))]
    show(session, watch, [*scan.at(0.0), *slow, *(replace(frame, timestamp=frame.timestamp + 60.0) for frame in slow)])
    assert until(lambda: watch.has_fallen)
    assert len(watch.echoes()) > 5 * len(watch._echoes[1])
    found = register_echoes(watch.echoes(), scan.bone, scan.place)
    assert found.accepted
    points = scan.bone.middle + np.eye(3) * 20.0
    away = transform_points(found.transform, points) - transform_points(MOVED @ scan.place, points)
    assert np.linalg.norm(away, axis=1).max() < 1.5


def test_echoes_of_a_long_scan_do_not_pile_up(watching, scan, monkeypatch):
    monkeypatch.setattr("AIFReconLib.live.session.agreement_watch.MOST_SEEN", 400)
    session, watch = watching
    for start in (0.0, 20.0, 40.0):
        show(session, watch, scan.at(start))
    assert len(watch.echoes()) <= 3 * 400


def test_what_goes_wrong_is_told_nothing_is_forgotten_and_the_watch_goes_on(watching, scan):
    session, watch = watching
    show(session, watch, [*scan.at(0.0), *scan.at(20.0, MOVED)])
    assert until(lambda: watch.has_fallen)
    session.latest = replace(scan.at(30.0)[0], image=np.zeros((0, 0), np.uint8))
    assert until(lambda: watch.problem is not None)
    assert watch.has_fallen
    show(session, watch, scan.at(40.0, MOVED))
    assert watch.problem is None
