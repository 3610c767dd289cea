"""A scan in the worker: the voxels of offline, and nothing lost when the worker dies."""

from __future__ import annotations

import os
import signal
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from files import LABELS_TO_REFERENCE, tracked_sequence, write_patient
from live_messages import streamed
from waiting import until

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.errors import OutputError, WorkerDiedError
from AIFReconLib.geometry.transform_graph import TransformStatus
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.gray_levels import STANDARD
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.live.session.recording import growing_files
from AIFReconLib.live.wire.messages import ImageMessage
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.worker.reconstructing import begin_scan
from AIFReconLib.worker.scan import Scan
from AIFReconLib.workflows.job import BoneSource, ScanJob

GRID = VoxelGrid.from_spacing((-9.0, -8.0, -6.0), (19, 17, 13), 1.0)
SEQUENCE = tracked_sequence(24, statuses={5: TransformStatus.OUT_OF_VIEW})
# Gray levels that are told: frames enter as they come
RECIPE = Recipe(method="weighted", output_type="float32", bone_sigma_voxels=1.0, gray_levels=STANDARD)


@pytest.fixture
def request_of(tmp_path):
    """Makes requests for scans of images that are given, in a box, by bone, recorded."""
    folder = tmp_path / "patient"
    folder.mkdir()
    patient = write_patient(folder)
    configuration, labels = read_plus_configuration(patient.config), read_volume(patient.labels)
    bone = BoneSource(labels, to_reference=LABELS_TO_REFERENCE)
    made = ScanJob(RECIPE, None, configuration, GRID, bone, record=tmp_path / "scans" / "scan.mhd")
    made.record.parent.mkdir()
    return lambda **changed: replace(made, **changed)


def messages(first, stop):
    """What a server sends of these frames of the sweep, the transforms first: then no image waits for them, however slow the machine is."""
    sent = (message for message in streamed(SEQUENCE) if first <= round((message.timestamp - 10.0) / 0.05) < stop)
    return sorted(sent, key=lambda message: (message.timestamp, isinstance(message, ImageMessage)))


def give(worker, scan, first, stop) -> None:
    """Send these frames, no faster than they are inserted: else some would be left out to keep up."""
    for number in range(first, stop):
        for message in messages(number, number + 1):
            worker.begin("put", scan, message).result()
        assert until(partial(is_taken, worker, scan, number))


def is_taken(worker, scan, number) -> bool:
    """Whether a frame was recorded, and none waits to be inserted."""
    statistics = worker.call("look", scan).statistics
    return statistics.recorded > number and statistics.waiting == 0


def offline(request, frames):
    """The volume of these frames, with the bone of the request."""
    chosen = replace(SEQUENCE, images=SEQUENCE.images[frames], records=[SEQUENCE.records[n] for n in frames])
    bone = BoneMap.from_labels(request.bone.labels, 1.0, None, request.bone.to_reference)
    return reconstruct(replace(chosen, configuration=request.configuration), RECIPE, bone, GRID).intensity.array


def killed(worker, scan) -> None:
    """Kill it, and hear of that."""
    os.kill(worker.pid, signal.SIGKILL)
    with pytest.raises(WorkerDiedError):
        until(lambda: worker.call("look", scan) is None)


def test_a_look_tells_what_is_new_and_no_more(request_of):
    scan = Scan(request_of(record=None))
    try:
        for message in messages(0, 24):
            scan.put(message)
        assert until(lambda: scan.look(-1).statistics.inserted == 23)
        seen = scan.look(-1)
        assert seen.frame.number == 23
        np.testing.assert_array_equal(seen.frame.image, SEQUENCE.images[23])
        assert scan.look(23).frame is None
        assert until(lambda: scan.look(23).result is None)
    finally:
        scan.close()


TAKEN_UP = {
    "24": range(24),
    "8 kill 24": range(24),
    "8 pause 12 resume kill 24": [*range(8), *range(12, 24)],
    "8 pause kill 12 resume 24": [*range(8), *range(12, 24)],
    "8 reset kill 24": range(8, 24),
    "24 kill kill": range(24),
}
"""What happens, a number being that of the frame until which frames come, and the frames that are in the volume then."""


@pytest.mark.parametrize(("script", "counted"), TAKEN_UP.items(), ids=TAKEN_UP)
def test_a_scan_gives_the_voxels_of_offline_and_loses_nothing_when_its_worker_is_killed(script, counted, worker, request_of):
    request, given = request_of(), 0
    scan, seen = worker.keep(begin_scan, request), None
    for word in script.split():
        if word.isdecimal():
            give(worker, scan, given, int(word))
            given = int(word)
            # An image is decided by what comes after it
            assert until(partial(is_taken, worker, scan, given - 1))
        elif word == "kill":
            seen = worker.call("look", scan)
            killed(worker, scan)
            assert [path.exists() for path in growing_files(request.record)] == [True, True]
            scan = worker.keep(begin_scan, replace(request, takes_up=True, spans=seen.spans, grid=seen.grid))
        else:
            worker.call(*(("reset", scan) if word == "reset" else ("pause", scan, word == "pause")))
    ended = worker.call("finish", scan)
    np.testing.assert_array_equal(ended.result.intensity.array, offline(request, np.array(counted)))
    np.testing.assert_array_equal(np.array(read_sequence(ended.recorded).images), SEQUENCE.images)
    assert sorted(path.name for path in request.record.parent.iterdir()) == ["scan.mhd", "scan.raw"]
    assert ended.statistics.frames_received == 24
    assert "bone_sigma_voxels" in ended.result.intensity.fields["AIFRecon_settings"]
    assert ended.statistics.skipped.get("paused", 0) == 24 - len(counted)


def test_a_scan_that_cannot_begin_leaves_nothing_running(worker, request_of):
    request = request_of(record=request_of().record.parent / "nowhere" / "scan.mhd")
    with pytest.raises(OutputError):
        worker.keep(begin_scan, request)
    assert list(request_of().record.parent.iterdir()) == []
