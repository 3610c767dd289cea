"""Cuts that are drawn without matplotlib: a PNG that others can read, in the colors of what is there."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from AIFReconLib.evaluation.cuts import CT_DIMMED, Scene, cut_pictures
from AIFReconLib.geometry.volume import Volume


def pixels_of(data):
    """(rows, columns, 3) of a PNG file, as a program for pictures reads it."""
    with Image.open(io.BytesIO(data)) as picture:
        return np.asarray(picture)


MATRIX = np.diag([1.0, 1.0, 1.0, 1.0])
SIZE = (21, 21, 21)


def volume(array):
    """Voxels of 1 mm."""
    return Volume(np.asarray(array), MATRIX)


def axial(**scene):
    """The pixels of the axial cut through the middle."""
    return pixels_of(cut_pictures(Scene(**scene), np.array([10.0, 10.0, 10.0]))[0][1])


def test_three_planes_are_cut_and_say_which_way_they_lie():
    shown = volume(np.ones(SIZE, np.uint8))
    captions = [caption for caption, _data in cut_pictures(Scene(shown, (0, 255), ct=shown))]
    assert captions == ["Axial: R is left, A is up", "Sagittal: A is left, S is up", "Coronal: R is left, S is up"]
    without_ct = [caption for caption, _data in cut_pictures(Scene(shown, (0, 255)))]
    assert without_ct == ["Across z: +x is left, +y is up", "Across x: +y is left, +z is up", "Across y: +x is left, +z is up"]


def test_the_patient_s_right_is_on_the_left_and_the_front_is_up():
    array = np.full(SIZE, 50, np.uint8)
    # RAS: i runs to the patient's right, j to the front
    array[:, 15:, 15:] = 250
    rows, columns = np.nonzero(axial(shown=volume(array), window=(0, 255))[..., 0] == 250)
    assert rows.max() < 210
    assert columns.max() < 210


def test_where_nothing_was_scanned_the_ct_is_seen_dimmed():
    shown = np.full(SIZE, 128, np.uint8)
    shown[:, :, :10] = 0
    picture = axial(shown=volume(shown), window=(0, 255), ct=volume(np.full(SIZE, 3000.0)))
    assert picture[200, 100].tolist() == [128] * 3
    assert picture[200, 400] == pytest.approx([CT_DIMMED * 255] * 3, abs=1)


def test_what_was_raised_is_violet_and_the_rest_stays_gray():
    bands = np.zeros(SIZE, np.uint8)
    bands[:, :, :8] = 4
    picture = axial(shown=volume(np.full(SIZE, 128, np.uint8)), window=(0, 255), bands=volume(bands)).astype(int)
    assert picture[200, 100].tolist() == [128] * 3
    red, green, blue = picture[200, 400]
    assert blue > red > green


def test_the_bone_of_the_ct_is_outlined_and_its_inside_is_left():
    labels = np.zeros(SIZE, np.uint8)
    labels[6:15, 6:15, 6:15] = 1
    picture = axial(shown=volume(np.full(SIZE, 128, np.uint8)), window=(0, 255), labels=volume(labels))
    orange = (picture == (0xFF, 0xB0, 0)).all(axis=2)
    assert orange.any()
    assert picture[210, 210].tolist() == [128] * 3
