"""Bone from a CT alone, on a simulated patient with what CTs hold beside bone; CTs that cannot be used."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk

from AIFReconLib.bone.ct.from_ct import labels_from_ct
from AIFReconLib.errors import GeometryError, SettingsError, VolumeFormatError
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.dicom_series import read_ct
from AIFReconLib.simulation.anatomy import LumbarPhantom

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from study.ct_bone import MOST_MEDIAN, MOST_OFF, phantom_of, surface_off
from study.ct_disturbances import disturbed_ct

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


def test_the_threshold_is_said():
    assert found().notes[0].startswith("Bone is what is above ")
    assert found().notes[0].endswith(" HU, found in the CT.")


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


def dicom_series(folder: Path, volume: Volume, modality: str = "CT", without: int | None = None) -> Path:
    """A series as an archive gives it: files whose names are in another order than their places."""
    folder.mkdir()
    image = volume.to_sitk()
    writer = sitk.ImageFileWriter()
    writer.KeepOriginalImageUIDOn()
    direction = image.GetDirection()
    for k in range(image.GetSize()[2]):
        if k == without:
            continue
        plane = image[:, :, k]
        tags = {
            "0008|0060": modality,
            "0020|000e": "1.2.3.4",
            "0020|0013": str(k),
            "0020|0032": "\\".join(map(str, image.TransformIndexToPhysicalPoint((0, 0, k)))),
            "0020|0037": "\\".join(map(str, (direction[0], direction[3], direction[6], direction[1], direction[4], direction[7]))),
            "0008|0018": f"1.2.3.4.{k + 1}",
        }
        for key, text in tags.items():
            plane.SetMetaData(key, text)
        writer.SetFileName(str(folder / f"slice-{(7 * k) % 100:03d}.dcm"))
        writer.Execute(plane)
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
