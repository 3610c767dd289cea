"""TIFF of every depth and layout, pictures that are turned, MetaImage frames, and volumes that are no frames."""

from __future__ import annotations

import struct

import numpy as np
import PIL.Image as pil
import pydicom as dicom
import pytest
import tifffile
from dicom_samples import write_dicom
from sequence_samples import metaimage, single_frame
from test_foreign_images import FRAMES

from AIFReconLib.errors import FileFormatError
from AIFReconLib.io.foreign.openers import open_images

ORIENTATION = 274


def opened(path):
    return np.asarray(open_images([path]).stack)


def levels(dtype, shape=(3, 12, 17)):
    """Levels over the whole range of a type, its ends too."""
    if np.dtype(dtype).kind == "f":
        return np.random.default_rng(0).normal(size=shape).astype(dtype)
    limits = np.iinfo(dtype)
    values = np.random.default_rng(0).integers(limits.min, limits.max, shape, dtype, endpoint=True)
    values[0, 0, :2] = limits.min, limits.max
    return values


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.uint32, np.int16, np.int32, np.float32, np.float64])
@pytest.mark.parametrize("options", [{}, {"bigtiff": True, "byteorder": ">"}, {"compression": "lzw", "tile": (16, 16)}])
def test_a_tiff_of_any_depth_keeps_every_level(tmp_path, dtype, options):
    tifffile.imwrite(tmp_path / "a.tif", levels(dtype), photometric="minisblack", **options)
    found = opened(tmp_path / "a.tif")
    assert found.dtype == dtype
    np.testing.assert_array_equal(found, levels(dtype))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.uint32, np.int16, np.float32])
def test_white_as_zero_is_turned_round_at_any_depth_and_said(tmp_path, dtype):
    tifffile.imwrite(tmp_path / "a.tif", levels(dtype), photometric="miniswhite")
    if dtype == np.float32:
        with pytest.raises(FileFormatError, match="white is zero, which float32 does not tell"):
            opened(tmp_path / "a.tif")
        return
    limits = np.iinfo(dtype)
    expected = (limits.max - levels(dtype).astype(np.int64) + limits.min).astype(dtype)
    np.testing.assert_array_equal(opened(tmp_path / "a.tif"), expected)
    assert open_images([tmp_path / "a.tif"]).description.endswith(", white was zero")


@pytest.mark.parametrize("planar", ["contig", "separate"])
def test_colors_of_a_tiff_become_gray_as_those_of_other_pictures(tmp_path, planar):
    colors = levels(np.uint8, (12, 17, 3))
    pil.fromarray(colors).save(tmp_path / "a.png")
    stored = colors if planar == "contig" else np.moveaxis(colors, -1, 0)
    tifffile.imwrite(tmp_path / "a.tif", stored, photometric="rgb", planarconfig=planar)
    np.testing.assert_array_equal(opened(tmp_path / "a.tif"), opened(tmp_path / "a.png"))


def imagej_stack(path, frames, said):
    """A stack as ImageJ writes it beyond 4 GB: one directory, all frames behind it."""
    _, rows, columns = frames.shape
    text = "".join(f"{key}={value}\n" for key, value in {"ImageJ": "1.53t", **said}.items()).encode() + b"\0"
    place = 8 + 2 + 12 * 10 + 4
    entries = [
        *((256, 4, 1, columns), (257, 4, 1, rows), (258, 3, 1, 8 * frames.itemsize), (259, 3, 1, 1), (262, 3, 1, 1)),
        *((270, 2, len(text), place), (273, 4, 1, place + len(text)), (278, 4, 1, rows), (279, 4, 1, frames[0].nbytes)),
        (339, 3, 1, 3 if frames.dtype.kind == "f" else 1),
    ]
    directory = b"".join(struct.pack("<HHII", *entry) for entry in entries)
    path.write_bytes(b"II" + struct.pack("<HIH", 42, 8, len(entries)) + directory + bytes(4) + text + frames.tobytes())


@pytest.mark.parametrize("dtype", ["uint8", "<u2", "<f4"])
def test_a_stack_of_imagej_with_one_directory_gives_all_its_frames(tmp_path, dtype):
    frames = FRAMES.astype(dtype)
    imagej_stack(tmp_path / "a.tif", frames, {"images": 11, "slices": 11})
    np.testing.assert_array_equal(opened(tmp_path / "a.tif"), frames)


@pytest.mark.parametrize(
    ("said", "columns", "message"),
    [
        ({"images": 12}, 17, "holds 12 frames, but it ends after 11"),
        ({"images": 10**9}, 17, "holds 1000000000 frames, but it ends after 11"),
        ({"images": "."}, 17, "it cannot be read as a picture"),
        ({"images": 11, "channels": 2, "frames": 5}, 17, "its frames have 2 channels each"),
        ({}, 2**31 - 1, "it cannot be read as a picture"),
    ],
)
def test_what_imagej_says_and_the_file_does_not_hold_is_refused(tmp_path, said, columns, message):
    imagej_stack(tmp_path / "a.tif", FRAMES, said)
    data = bytearray((tmp_path / "a.tif").read_bytes())
    struct.pack_into("<I", data, 10 + 8, columns)
    (tmp_path / "a.tif").write_bytes(data)
    with pytest.raises(FileFormatError, match=message):
        opened(tmp_path / "a.tif")


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", [".png", ".jpg", ".tif"])
def test_a_picture_is_turned_as_viewers_turn_it_and_that_is_said(tmp_path, orientation, suffix):
    stored = np.kron(np.arange(12, dtype=np.uint8).reshape(3, 4) * 20, np.ones((8, 8), np.uint8))
    tag = pil.Exif()
    tag[ORIENTATION] = orientation
    extra = {"tiffinfo": {ORIENTATION: orientation}} if suffix == ".tif" else {"exif": tag, "quality": 100}
    pil.fromarray(stored).save(tmp_path / f"a{suffix}", **extra)
    # Where first row and column of what is stored are shown (EXIF 2.3, tag 0x0112)
    quarter_turns = {1: 0, 2: 0, 3: 2, 4: 2, 5: 3, 6: 3, 7: 1, 8: 1}
    mirrored = stored[:, ::-1] if orientation in (2, 4, 5, 7) else stored
    expected = np.rot90(mirrored, {5: 1, 7: 3}.get(orientation, quarter_turns[orientation]))
    found = open_images([tmp_path / f"a{suffix}"])
    np.testing.assert_allclose(found.stack[0].astype(int), expected, atol=2)
    assert found.description.endswith(", turned as they say") == (orientation > 1)


def test_frames_of_metaimages_come_one_a_file_with_their_pixel_size(tmp_path):
    for number, frame in enumerate(FRAMES[:3]):
        single_frame(tmp_path / f"f_{number}.mhd", frame)
    found = open_images([tmp_path])
    np.testing.assert_array_equal(np.asarray(found.stack), FRAMES[:3])
    assert found.names == ("f_0.mhd", "f_1.mhd", "f_2.mhd")
    assert found.spacing == (0.2, 0.3)


def test_a_volume_as_metaimage_is_refused_as_one(tmp_path):
    metaimage(tmp_path / "a.mha", FRAMES, {}, Kinds=None, UltrasoundImageOrientation=None)
    with pytest.raises(FileFormatError, match="a 3D volume of 11 slices; frames must be 2D"):
        open_images([tmp_path / "a.mha"])


def groups(*, shared=(), frames=()):
    """Functional groups with these attributes of one sequence each."""

    def group(name, **attributes):
        inner, outer = dicom.dataset.Dataset(), dicom.dataset.Dataset()
        for key, value in attributes.items():
            setattr(inner, key, value)
        setattr(outer, name, dicom.sequence.Sequence([inner]))
        return outer

    made = {"Shared": [group(name, **values) for name, values in shared], "PerFrame": [group(name, **values) for name, values in frames]}
    return {f"{key}FunctionalGroupsSequence": dicom.sequence.Sequence(items) for key, items in made.items() if items}


def test_the_pixel_size_in_the_functional_groups_of_dicom_is_found(tmp_path):
    shared = groups(shared=[("PixelMeasuresSequence", {"PixelSpacing": [0.3, 0.2]})])
    assert open_images([write_dicom(tmp_path / "a.dcm", FRAMES, **shared)]).spacing == (0.2, 0.3)
    each = groups(frames=[("PixelMeasuresSequence", {"PixelSpacing": [size, 0.2]}) for size in (0.3, 0.4)])
    found = open_images([write_dicom(tmp_path / "b.dcm", FRAMES[:2], **each)])
    assert found.spacing is None
    assert "frames of different pixel sizes (0.2 x 0.3 mm and 0.2 x 0.4 mm)" in found.unknown_spacing


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({"SOPClassUID": "1.2.840.10008.5.1.4.1.1.6.2"}, "11 slices .Enhanced US Volume."),
        ({"Modality": "CT"}, "slices .CT."),
        ({"SpacingBetweenSlices": 0.5}, "11 slices .0.5 mm apart."),
        (None, "11 slices"),
    ],
)
def test_a_volume_in_dicom_is_refused_as_one(tmp_path, attributes, message):
    places = [("PlanePositionVolumeSequence", {"ImagePositionVolume": [0, 0, 0.5 * n]}) for n in range(11)]
    told = groups(frames=places) if attributes is None else attributes
    with pytest.raises(FileFormatError, match=f"a 3D volume of {message}.*; frames must be 2D"):
        open_images([write_dicom(tmp_path / "a.dcm", FRAMES, **told)])
