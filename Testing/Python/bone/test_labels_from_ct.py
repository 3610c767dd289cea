"""Bone from a CT alone, on a simulated patient with what CTs hold beside bone; CTs that cannot be used."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pydicom
import pytest
from dicom_samples import write_dicom
from study.ct_bone import MOST_MEDIAN, MOST_OFF, phantom_of, surface_off
from study.ct_disturbances import disturbed_ct

from AIFReconLib.bone.ct.from_ct import labels_from_ct
from AIFReconLib.errors import GeometryError, SettingsError, VolumeFormatError
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.transforms import LPS_FROM_RAS, transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.dicom_series import read_ct
from AIFReconLib.io.volume.files import write_volume
from AIFReconLib.simulation.anatomy import LumbarPhantom

PATIENT = 2
"""The one with the largest voxels: the least work, and the hardest."""


@cache
def patient() -> tuple[LumbarPhantom, Volume]:
    phantom = phantom_of(PATIENT)
    return phantom, disturbed_ct(phantom, PATIENT)


@cache
def found() -> Labels:
    return labels_from_ct(patient()[1])


def test_the_surface_that_a_probe_can_meet_is_that_of_the_true_bone():
    true = patient()[0].labels
    for of, to in ((true, found()), (found(), true)):
        median, off = surface_off(of, to)
        assert median <= MOST_MEDIAN
        assert off <= MOST_OFF


def test_each_vertebra_has_its_label_from_the_uppermost_down():
    true = patient()[0].labels.array
    assert found().names == {1: "vertebra 1", 2: "vertebra 2", 3: "vertebra 3"}
    for n in (1, 2, 3):
        own, theirs = found().array == n, true == n
        assert 2 * (own & theirs).sum() / (own.sum() + theirs.sum()) > 0.9


def test_the_threshold_can_be_given():
    dense = labels_from_ct(patient()[1], above=600)
    assert dense.notes[0] == "Bone is what is above 600 HU."
    assert (dense.array > 0).sum() < (found().array > 0).sum()
    with pytest.raises(SettingsError, match="Input above must be 50 to 2500 HU; got 5000"):
        labels_from_ct(patient()[1], above=5000)


def test_metal_is_left_out_and_said():
    ct = patient()[1]
    array = ct.array.copy()
    k, j, i = np.argwhere(found().array == 2).mean(axis=0).astype(int)
    array[k - 2 : k + 3, j - 20 : j + 20, i + 8 : i + 12] = 3071
    screwed = labels_from_ct(Volume(array, ct.ijk_to_reference))
    assert any(note.startswith("Metal was left out") for note in screwed.notes)


def water(noise: float = 20.0) -> np.ndarray:
    """A cylinder of water in a wall of plastic, in air."""
    rng = np.random.default_rng(0)
    k, j, i = np.ogrid[:40, :80, :80]
    radius = np.hypot(j - 40, i - 40) + 0 * k
    return np.where(radius < 30, 0.0, np.where(radius < 32, 120.0, -1000.0)) + rng.normal(0, noise, radius.shape)


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (water(), "There is no bone in the CT: nothing above 1.. HU is larger than 0.2 cm3"),
        (water() + 1024, "not in Hounsfield units: its values run from .* with 1000 or 1024 added"),
        (np.clip((water() + 1000) / 8, 0, 255).astype(np.uint8), "not in Hounsfield units"),
        (np.random.default_rng(1).gamma(2.0, 200.0, (20, 30, 30)), "not in Hounsfield units"),
        (np.full((20, 20, 20), -1000), "not in Hounsfield units"),
        (np.where(water() > 100, np.nan, water()), "no numbers"),
    ],
    ids=["water", "shifted", "8 bit", "MR", "air", "NaN"],
)
def test_a_ct_that_cannot_be_used_is_refused_in_a_sentence(array, words):
    with pytest.raises(GeometryError, match=words):
        labels_from_ct(array, ijk_to_reference=np.diag([1.5, 1.5, 1.5, 1.0]))


# ---- files


def dicom_series(
    folder: Path,
    volume: Volume,
    modality: str = "CT",
    without: int | None = None,
    *,
    series: str = "1.2.3.4",
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0),
    said: dict[str, str | None] | None = None,
    from_slice: int = 0,
) -> Path:
    """A series as an archive gives it: files whose names are in another order than their places.

    `shift` is added to the place for each slice (LPS, mm); `said` are headers of the slices from `from_slice` on, None where they lack one.
    """
    folder.mkdir(exist_ok=True)
    to_lps = LPS_FROM_RAS @ volume.ijk_to_reference
    for k, plane in enumerate(volume.array):
        place = (to_lps @ (0, 0, k, 1))[:3] + np.multiply(shift, k)
        headers = {
            "Modality": modality,
            "SeriesInstanceUID": series,
            "SeriesNumber": series.rpartition(".")[2],
            "SOPInstanceUID": f"{series}.{k + 1}",
            "PixelRepresentation": 1,
            "PixelSpacing": [*map(str, volume.spacing[1::-1])],
            "ImagePositionPatient": [f"{value:.8g}" for value in place],
            "ImageOrientationPatient": [f"{value:.8g}" for value in (to_lps[:3, :2] / volume.spacing[:2]).T.ravel()],
        }
        for name, value in (said or {}).items() if k >= from_slice else ():
            headers[name] = value and value.split("\\")
        if k != without:
            path = folder / f"{'' if series == '1.2.3.4' else series + '-'}slice-{(7 * k) % 100:03d}.dcm"
            write_dicom(path, plane, **{name: value for name, value in headers.items() if value is not None})
    return folder


SMALL = Volume(
    np.arange(5 * 7 * 6, dtype=np.int16).reshape(5, 7, 6) - 100,
    np.array([[0.8, 0, 0, -12], [0, 0.8, 0, 5], [0, 0, 2.5, 30], [0, 0, 0, 1.0]]),
)


@pytest.mark.parametrize("name", ["", "slice-007.dcm"])
def test_a_folder_or_a_file_of_dicom_is_the_whole_series_in_hu(name, tmp_path):
    folder = dicom_series(tmp_path / "ct", SMALL)
    read = read_ct(folder / name if name else folder)
    np.testing.assert_array_equal(read.array, SMALL.array)
    np.testing.assert_allclose(read.ijk_to_reference, SMALL.ijk_to_reference, atol=1e-5)


def test_a_series_that_lacks_a_slice_is_refused(tmp_path):
    with pytest.raises(VolumeFormatError, match=r"not evenly spaced \(2.5 mm, once 5 mm\)"):
        read_ct(dicom_series(tmp_path / "ct", SMALL, without=2))


def test_slices_of_a_tilted_gantry_are_moved_to_where_they_lie(tmp_path, caplog):
    k, j, i = np.mgrid[:20, :40, :30]
    tilt = 0.4  # mm of the table's motion, along the columns, for each slice
    ball = np.where(np.linalg.norm([2.5 * (k - 10), 0.8 * (j - 16) + tilt * k - 4, 0.8 * (i - 14)], axis=0) < 9, 700, -1000)
    folder = dicom_series(tmp_path / "ct", Volume(ball.astype(np.int16), SMALL.ijk_to_reference), shift=(0.0, tilt, 0.0))
    read = read_ct(folder)
    inside = transform_points(read.ijk_to_reference, np.argwhere(read.array > -150)[:, ::-1].astype(float))
    # Where the headers place the middle: LPS columns run along -y in RAS
    first = transform_points(SMALL.ijk_to_reference, (14.0, 16.0, 10.0))
    np.testing.assert_allclose(inside.mean(axis=0), first - (0.0, 4.0, 0.0), atol=0.15)
    np.testing.assert_allclose(np.ptp(inside, axis=0), (17.6, 17.6, 15.0), atol=0.81)
    assert "sheared by 9.09 degrees" in caplog.text


def test_of_several_series_the_longest_ct_is_taken_and_the_others_are_named(tmp_path, caplog):
    folder = dicom_series(tmp_path / "ct", SMALL, series="1.2.3.12")
    dicom_series(folder, SMALL, series="1.2.3.1", without=2, said={"SeriesNumber": "1"})
    dicom_series(folder, Volume(np.zeros((9, 7, 6), np.int16), SMALL.ijk_to_reference), "PT", series="1.2.3.7")
    assert read_ct(folder).shape == SMALL.shape
    assert "series 12 (5 slices" in caplog.text
    assert "Also there: 1 (4 slices" in caplog.text
    with pytest.raises(VolumeFormatError, match="not evenly spaced"):
        read_ct(folder / "1.2.3.1-slice-007.dcm")


@pytest.mark.parametrize(
    ("said", "from_slice", "words"),
    [
        ({"ImagePositionPatient": None}, 0, "do not all say where slices lie"),
        ({"PixelSpacing": None, "ImagerPixelSpacing": "0.8\\0.8"}, 0, "how large pixels are"),
        ({"ImageOrientationPatient": None}, 3, "do not all say .*which way slices lie"),
        ({"PixelSpacing": "0.9\\0.8"}, 3, "the size of the pixels changes"),
        ({"ImageOrientationPatient": "1\\0\\0\\0\\0.8\\0.6"}, 3, "the direction of the slices changes"),
        ({"ImagePositionPatient": "0\\0\\0"}, 3, "slices lie at the same place"),
    ],
)
def test_nothing_is_made_up_that_headers_leave_out(said, from_slice, words, tmp_path):
    with pytest.raises(VolumeFormatError, match=words):
        read_ct(dicom_series(tmp_path / "ct", SMALL, said=said, from_slice=from_slice))


@pytest.mark.parametrize("order", [1, -1, None])
def test_a_file_of_many_frames_lies_where_its_frames_say(order, tmp_path):
    whole = Volume((SMALL.array + 100).astype(np.uint16), SMALL.ijk_to_reference)
    write_volume(whole, tmp_path / "frames.dcm")
    data = pydicom.dcmread(tmp_path / "frames.dcm")
    data.Modality, places = "CT", list(data.PerFrameFunctionalGroupsSequence)
    data.PerFrameFunctionalGroupsSequence = places[::order] if order else []
    data.save_as(tmp_path / "frames.dcm")
    if order is None:
        with pytest.raises(VolumeFormatError, match="do not all say where slices lie"):
            read_ct(tmp_path / "frames.dcm")
        return
    read = read_ct(tmp_path / "frames.dcm")
    at = transform_points(read.grid.reference_to_ijk @ whole.ijk_to_reference, np.argwhere(whole.array >= 0)[:, ::-1].astype(float))
    i, j, k = np.rint(at).astype(int).T
    np.testing.assert_allclose(at, np.stack([i, j, k], axis=1), atol=1e-4)
    np.testing.assert_array_equal(read.array[k, j, i].reshape(whole.shape), whole.array[::order])


def test_another_modality_is_refused(tmp_path):
    with pytest.raises(VolumeFormatError, match="of the kind MR, not CT"):
        read_ct(dicom_series(tmp_path / "mr", SMALL, modality="MR"))


def test_what_is_no_ct_is_refused(tmp_path):
    (tmp_path / "notes.txt").write_text("no CT")
    with pytest.raises(VolumeFormatError, match="neither a volume"):
        read_ct(tmp_path / "notes.txt")
    (tmp_path / "empty").mkdir()
    with pytest.raises(VolumeFormatError, match="holds no DICOM"):
        read_ct(tmp_path / "empty")
