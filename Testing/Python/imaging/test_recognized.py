"""The probe is looked for once in a recording, and anew in an array that may have changed."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.commands.parser import main
from AIFReconLib.errors import BeamGeometryError
from AIFReconLib.imaging import recognized as module
from AIFReconLib.imaging.recognized import recognized


@pytest.fixture
def looks(monkeypatch):
    """How often the images were looked at."""
    counted = []
    look = module.detect_imaging

    def counting(images, spacing):
        counted.append(spacing)
        return look(images, spacing)

    monkeypatch.setattr(module, "detect_imaging", counting)
    return counted


def strip(left: int) -> np.ndarray:
    images = np.zeros((3, 120, 200), np.uint8)
    images[:, 10:110, left : left + 120] = np.random.default_rng(0).integers(60, 200, (3, 100, 120))
    return images


def test_a_run_with_labels_looks_at_its_recording_once(patient, results, looks):
    assert main([*patient.reconstruct, *patient.bone, "--method", "weighted", "--output", str(results / "v.nrrd")]) == 0
    assert len(looks) == 1


def test_an_array_that_can_be_written_to_is_looked_at_every_time_and_one_that_tells_nothing_once(looks):
    images = strip(30)
    first = recognized(images).region.clip
    images[:] = strip(50)
    assert recognized(images).region.clip != first
    images.flags.writeable = False
    assert recognized(images) is recognized(images)
    assert recognized(images, (0.5, 0.5)) is not recognized(images)
    assert len(looks) == 5
    black = np.zeros((3, 60, 80), np.uint8)
    black.flags.writeable = False
    for _ in range(2):
        with pytest.raises(BeamGeometryError, match="all images are black"):
            recognized(black)
    assert len(looks) == 6
