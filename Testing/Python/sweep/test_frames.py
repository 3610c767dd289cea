"""Sequences in memory: their size, names and statuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.sweep.frames import FrameRecord, TrackedFrame, TrackedSequence

PROBE = TransformName("Probe", "Tracker")
STYLUS = TransformName("Stylus", "Tracker")


def sequence_of(*records: FrameRecord, **others) -> TrackedSequence:
    """A sequence of black 5 x 4 images with these records."""
    return TrackedSequence(np.zeros((len(records), 4, 5), np.uint8), list(records), **others)


def tracked(name: TransformName, status: TransformStatus = TransformStatus.OK) -> FrameRecord:
    """A record with one transform."""
    return FrameRecord(transforms={name: TransformSample(np.eye(4), status)})


def test_a_frame_size_is_columns_and_rows():
    assert sequence_of(FrameRecord()).frame_size == (5, 4)


def test_a_record_too_few_is_refused():
    with pytest.raises(ValueError, match="got 1 for 2 images"):
        TrackedSequence(np.zeros((2, 4, 5), np.uint8), [FrameRecord()])


def test_a_sequence_may_be_empty():
    assert len(sequence_of()) == 0


def test_a_sequence_is_named_after_its_file():
    assert sequence_of(path=Path("folder") / "sweep.igs.mha").name == "sweep.igs.mha"


def test_a_sequence_without_a_file_has_a_name():
    assert sequence_of().name == "sequence"


def test_transforms_are_named_in_order_of_appearance():
    sequence = sequence_of(tracked(STYLUS), tracked(PROBE), tracked(STYLUS))
    assert sequence.transform_names() == [STYLUS, PROBE]


def test_transforms_of_the_header_are_named_too():
    sequence = sequence_of(tracked(PROBE), transforms={STYLUS: TransformSample(np.eye(4))})
    assert sequence.transform_names() == [STYLUS, PROBE]


def test_statuses_are_counted():
    sequence = sequence_of(tracked(PROBE), tracked(PROBE, TransformStatus.OUT_OF_VIEW), tracked(PROBE))
    assert sequence.status_counts(PROBE) == {TransformStatus.OK: 2, TransformStatus.OUT_OF_VIEW: 1}


def test_a_frame_without_the_transform_counts_as_missing():
    assert sequence_of(tracked(PROBE), tracked(STYLUS)).status_counts(PROBE) == {TransformStatus.OK: 1, TransformStatus.MISSING: 1}


def test_the_transform_of_the_header_stands_in_where_a_frame_has_none():
    sequence = sequence_of(tracked(PROBE, TransformStatus.INVALID), tracked(STYLUS), transforms={PROBE: TransformSample(np.eye(4))})
    assert sequence.status_counts(PROBE) == {TransformStatus.INVALID: 1, TransformStatus.OK: 1}


def test_a_frame_is_ok_unless_it_says_otherwise():
    assert TrackedFrame(np.zeros((2, 2)), np.eye(4)).status == "OK"
