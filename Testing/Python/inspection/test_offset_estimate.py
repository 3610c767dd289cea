"""How far images and poses are out of step: told from simulated sweeps of known offset, and not told where it cannot be."""

from __future__ import annotations

from dataclasses import replace
from unittest import mock

import numpy as np
import pytest
from late_sweeps import COLUMNS, RATE, ROWS, SPACING, one_way, to_and_fro
from late_sweeps import late_sweep as sweep
from sweeps import rigid

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.inspection.offset_estimate import estimate_time_offset
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses


def estimate(sequence, **options):
    return estimate_time_offset(sequence, sweep_poses(sequence), **options)


@pytest.mark.parametrize("late", [-0.21, 0.0])
def test_poses_that_are_late_are_told_with_their_sign(late):
    found = estimate(sweep(late=late))
    assert found.time_offset == pytest.approx(late, abs=0.01)
    assert found.time_offset == pytest.approx(late, abs=found.uncertainty + 0.005)


def test_motion_within_the_image_plane_tells_it_too():
    assert estimate(sweep(late=0.12, sideways=True)).time_offset == pytest.approx(0.12, abs=0.01)


def test_an_offset_beyond_doubt_comes_with_the_option_that_mends_it():
    found = estimate(sweep(late=0.2))
    assert found.out_of_step
    assert f"A time offset of {found.time_offset:.3f} would" in found.to_text()


def looped(seconds, path=to_and_fro):
    """A recording that was replayed in a loop: the probe is back at the start at once."""
    return lambda t: path(t % seconds)


def test_a_recording_that_was_looped_is_told_by_what_goes_to_and_fro_in_it():
    found = estimate(sweep(looped(5.3), late=0.0, seconds=16.0))
    assert found.time_offset == pytest.approx(0.0, abs=0.02)


def test_parts_that_contradict_each_other_are_no_estimate():
    early, late = sweep(late=0.2), sweep(late=-0.2)
    records = [replace(record, timestamp=record.timestamp + 12.05) for record in late.records]
    found = estimate(TrackedSequence(np.concatenate([early.images, late.images]), [*early.records, *records]))
    assert found.time_offset is None


def without_times(sequence):
    return replace(sequence, records=[replace(record, timestamp=None) for record in sequence.records])


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda: sweep(one_way, late=0.2), "does not go back over the same place"),
        (lambda: sweep(lambda t: 4.0 * (t % 6.0), late=0.2), "does not go back over the same place"),
        (lambda: sweep(lambda t: 0.0), "does not go back over the same place"),
        (lambda: sweep(looped(3.0, one_way), late=0.0), "does not go back over the same place"),
        (lambda: sweep(looped(3.0, one_way), late=0.15), "does not go back over the same place"),
        (lambda: sweep(seconds=0.9), "only 18 frames"),
        (lambda: without_times(sweep(seconds=3)), "time stamp"),
    ],
    ids=["one way", "one way twice", "still", "looped", "looped and late", "short", "no times"],
)
def test_a_sweep_that_says_nothing_is_said_to(make, reason):
    found = estimate(make())
    assert found.time_offset is None
    assert reason in found.to_text()
    assert "cannot be told" in found.to_text()


def test_images_are_not_read_where_the_poses_already_say_that_it_is_no_use():
    unread = mock.MagicMock(shape=(200, ROWS, COLUMNS), dtype=np.dtype(np.uint8))
    unread.__len__.return_value = 200
    assert estimate(replace(sweep(one_way, seconds=10), images=unread)).time_offset is None
    unread.__getitem__.assert_not_called()


def test_it_can_be_canceled():
    with pytest.raises(OperationCanceled):
        estimate(sweep(), progress=lambda fraction, _: fraction < 0.5)


@pytest.mark.parametrize("late", [-0.06, 0.1])
def test_the_bottom_of_a_water_tank_tells_the_offset(late):
    rng = np.random.default_rng(0)
    rows = np.arange(ROWS)[:, None]
    images, records = [], []
    for n in range(240):
        depth = 20.0 + to_and_fro(n / RATE) * 0.8
        image = 200 * np.exp(-(((rows - depth) / 1.5) ** 2)) + rng.rayleigh(4.0, (ROWS, COLUMNS))
        images.append(np.clip(image, 0, 255).astype(np.uint8))
        # Up by as much as the bottom comes deeper
        claimed = to_and_fro(n / RATE - late) * 0.8
        pose = rigid((20.0, 5.0, -30.0), (7.0, 8.0, 9.0)) @ rigid((0, 0, 0), (0, -claimed, 0)) @ np.diag([SPACING, SPACING, 1.0, 1.0])
        records.append(FrameRecord(timestamp=n / RATE, transforms={TransformName("Image", "Reference"): TransformSample(pose)}))
    found = estimate(TrackedSequence(np.array(images), records))
    assert found.time_offset == pytest.approx(late, abs=max(found.uncertainty, 0.01))
