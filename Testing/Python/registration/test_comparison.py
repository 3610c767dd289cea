"""What stands under a reconstruction with labels when CT and sweep cannot be compared; that they can is tested with the commands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from files import tracked_sequence, write_patient

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.registration.comparison import compared_lines


@pytest.fixture
def sequence(tmp_path):
    """A sweep without bone."""
    return replace(tracked_sequence(), configuration=read_plus_configuration(write_patient(tmp_path).config))


@pytest.fixture
def labels():
    array = np.zeros((9, 9, 9), np.uint8)
    array[3:6, 3:6, 3:6] = 1
    return Volume(array, np.eye(4))


def test_a_sweep_without_bone_is_said_to_be_not_compared(sequence, labels):
    (line,) = compared_lines(sequence, labels, np.eye(4), probe=ProbeGeometry(LINEAR))
    assert line.startswith("CT and sweep were not compared. ")
    assert "too few" in line


def test_a_cancel_is_no_finding(sequence, labels):
    with pytest.raises(OperationCanceled):
        compared_lines(sequence, labels, np.eye(4), probe=ProbeGeometry(LINEAR), progress=lambda fraction, step: False)
