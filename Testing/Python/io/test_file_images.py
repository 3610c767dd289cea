"""Images that stay in their file until they are asked for."""

from __future__ import annotations

import numpy as np
import pytest
from sequence_samples import metaimage, ramp

from AIFReconLib.io.sequence.files import read_sequence


@pytest.mark.parametrize("compressed", [False, True])
def test_frames_can_be_read_in_any_order(tmp_path, compressed):
    pixels = ramp("<u2", frames=9, rows=40, columns=50)
    images = read_sequence(metaimage(tmp_path / "sweep.mha", pixels, compressed=compressed)).images
    for index in (3, 3, 8, 0, 5, 4, -1):
        np.testing.assert_array_equal(images[index], pixels[index])


def test_frames_larger_than_the_decoding_buffer_are_whole(tmp_path):
    pixels = np.random.default_rng(1).integers(0, 255, (3, 700, 801), dtype=np.uint8)
    images = read_sequence(metaimage(tmp_path / "sweep.mha", pixels, compressed=True)).images
    np.testing.assert_array_equal(np.asarray(images), pixels)


def test_changing_an_image_does_not_change_the_next_reading(tmp_path):
    images = read_sequence(metaimage(tmp_path / "sweep.mha", ramp(), compressed=True)).images
    images[1][:] = 0
    np.testing.assert_array_equal(images[1], ramp()[1])


def test_a_frame_beyond_the_end_is_an_index_error(tmp_path):
    images = read_sequence(metaimage(tmp_path / "sweep.mha", ramp())).images
    with pytest.raises(IndexError):
        images[2]


def test_images_in_a_file_cannot_be_an_array_without_a_copy(tmp_path):
    images = read_sequence(metaimage(tmp_path / "sweep.mha", ramp())).images
    with pytest.raises(ValueError, match="without a copy"):
        images.__array__(copy=False)


def test_images_become_an_array_of_another_type(tmp_path):
    images = read_sequence(metaimage(tmp_path / "sweep.mha", ramp())).images
    assert np.asarray(images, dtype=np.float32).dtype == np.float32
