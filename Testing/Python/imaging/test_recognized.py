"""The probe is looked for anew in an array that may have changed."""

from __future__ import annotations

import numpy as np

from AIFReconLib.imaging.recognized import recognized


def strip(left: int) -> np.ndarray:
    images = np.zeros((3, 120, 200), np.uint8)
    images[:, 10:110, left : left + 120] = np.random.default_rng(0).integers(60, 200, (3, 100, 120))
    return images


def test_images_that_were_written_to_show_what_they_hold_now():
    images = strip(30)
    first = recognized(images).region.clip
    images[:] = strip(50)
    assert recognized(images).region.clip == recognized(strip(50)).region.clip != first
