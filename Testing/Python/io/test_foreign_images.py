"""Frames from pictures, DICOM, video and numpy: in the right order, gray, of one size, and one at a time."""

from __future__ import annotations

import re
import struct
import subprocess
import zlib

import numpy as np
import PIL.Image as pil
import pydicom as dicom
import pytest
from dicom_samples import write_dicom
from made_pictures import write_pictures

from AIFReconLib.errors import FileFormatError
from AIFReconLib.io.foreign.openers import open_images

FRAMES = np.random.default_rng(0).integers(0, 256, (11, 12, 17), dtype=np.uint8)


@pytest.mark.parametrize("suffix", [".png", ".tif", ".bmp"])
def test_pictures_of_a_folder_come_in_natural_order_with_every_gray_level(tmp_path, suffix):
    found = open_images([write_pictures(tmp_path / "frames", FRAMES, suffix)])
    np.testing.assert_array_equal(np.array([found.stack[n] for n in range(11)]), FRAMES)
    assert found.names == tuple(f"{n}{suffix}" for n in range(11))


def test_a_picture_of_another_size_is_named(tmp_path):
    folder = write_pictures(tmp_path / "frames", [*FRAMES[:3], np.zeros((5, 5), np.uint8)])
    with pytest.raises(FileFormatError, match=r"3\.png: every frame must have 17 x 12 pixels, uint8 as the first; got 5 x 5"):
        open_images([folder]).stack[3]


@pytest.mark.parametrize("kept", [0, 8, 100, -30])
def test_a_damaged_picture_is_named(tmp_path, kept):
    pil.fromarray(FRAMES[0]).save(tmp_path / "a.png")
    (tmp_path / "a.png").write_bytes((tmp_path / "a.png").read_bytes()[:kept])
    with pytest.raises(FileFormatError, match=r"a\.png: it cannot be read as a picture"):
        open_images([tmp_path / "a.png"])
    for name in ("a.xyz", "noSuffix"):
        (tmp_path / name).write_bytes(b"not a picture")
        with pytest.raises(FileFormatError, match=r"\.png, .*\.dcm, .*\.mp4, .*\.npy"):
            open_images([tmp_path / name])


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((4, 5)), r"shape .frames, rows, columns. .*got .4, 5."),
        (np.zeros((4, 5, 6, 7)), "got .4, 5, 6, 7."),
        (np.zeros((0, 5, 6)), "got .0, 5, 6."),
        (np.zeros((2, 3, 4), complex), "whole numbers or floats; got complex128"),
        (np.zeros((2, 3, 4), np.float16), "got float16"),
    ],
)
def test_an_array_that_is_no_sweep_is_refused(tmp_path, array, message):
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(FileFormatError, match=message):
        open_images([tmp_path / "a.npy"])


TIMES = {"FrameTime": (40.0, [0.0, 0.04, 0.08]), "FrameTimeVector": ([0, 40, 60], [0.0, 0.04, 0.1])}


@pytest.mark.parametrize("name", TIMES)
def test_the_frames_of_one_dicom_file_have_their_times_and_pixel_size(tmp_path, name):
    said, times = TIMES[name]
    item = region(0.2)
    item.PhysicalDeltaY = 0.03
    found = open_images([write_dicom(tmp_path / "a.dcm", FRAMES[:3], **{name: said}, **regions(item))])
    np.testing.assert_array_equal(np.array([found.stack[n] for n in (2, 0)]), FRAMES[[2, 0]])
    np.testing.assert_allclose(found.times, times)
    assert found.spacing == pytest.approx((0.2, 0.3))


@pytest.mark.parametrize(
    ("second", "said"),
    [
        ({"PixelSpacing": [0.5, 0.25]}, None),
        ({"PixelSpacing": [0.4, 0.4]}, "c.dcm says 0.25 x 0.5 mm, a.dcm says 0.4 x 0.4 mm"),
        ({}, "c.dcm says 0.25 x 0.5 mm, a.dcm says nothing"),
    ],
)
def test_dicom_files_of_one_frame_come_in_order_of_their_instance_with_the_size_of_a_pixel(tmp_path, second, said):
    for n, (name, spacing) in enumerate((("c", {"PixelSpacing": [0.5, 0.25]}), ("a", second), ("b", second))):
        write_dicom(tmp_path / f"{name}.dcm", FRAMES[n], InstanceNumber=n + 1, **spacing)
    found = open_images([tmp_path])
    assert found.names == ("c.dcm", "a.dcm", "b.dcm")
    np.testing.assert_array_equal(found.stack[1], FRAMES[1])
    assert found.spacing == (None if said else (0.25, 0.5))
    assert said is None or found.unknown_spacing.startswith(said)


def region(mm: float, *box: int):
    """An ultrasound region in cm; its box is first column and row, last column and row."""
    item = dicom.dataset.Dataset()
    item.PhysicalUnitsXDirection = item.PhysicalUnitsYDirection = 3
    item.PhysicalDeltaX = item.PhysicalDeltaY = mm / 10
    if box:
        item.RegionLocationMinX0, item.RegionLocationMinY0, item.RegionLocationMaxX1, item.RegionLocationMaxY1 = box
    return item


def regions(*items) -> dict:
    return {"SequenceOfUltrasoundRegions": dicom.sequence.Sequence(items)}


@pytest.mark.parametrize(
    ("boxes", "expected"),
    [
        ([(0.2, (0, 0, 16, 11))], None),
        ([(0.2, (0, 0, 17, 12))], None),
        ([(0.2, (0, 0, 7, 11)), (0.2, (8, 0, 16, 11))], None),
        ([(0.2, (0, 0, 7, 11)), (0.4, (8, 0, 16, 11))], "regions of different pixel sizes .0.2 x 0.2 mm and 0.4 x 0.4 mm"),
        ([(0.2, ()), (0.4, ())], "regions of different pixel sizes"),
        ([(0.2, (0, 0, 639, 479))], "columns 0 to 639 and rows 0 to 479, not of the whole image, of 17 x 12 pixels"),
        ([(0.2, (0, 0, 7, 11))], "0.2 x 0.2 mm is the size of pixels in columns 0 to 7 and rows 0 to 11, not of the whole"),
    ],
)
def test_regions_tell_the_size_of_all_pixels_or_why_not(tmp_path, boxes, expected):
    found = regions(*(region(mm, *box) for mm, box in boxes))
    images = open_images([write_dicom(tmp_path / "a.dcm", FRAMES[0], **found)])
    assert images.spacing == (pytest.approx((0.2, 0.2)) if expected is None else None)
    assert expected is None or re.search(f"^{re.escape(str(tmp_path))}/a.dcm: .*{expected}", images.unknown_spacing)


UNORDERED = "InstanceNumber is missing, or occurs more than once"


@pytest.mark.parametrize(
    ("numbers", "series", "expected"),
    [
        ((None, 2), ("1.2", "1.2"), UNORDERED),
        ((2, 2), ("1.2", "1.2"), UNORDERED),
        ((1, 2), ("1.2", "1.3"), "the files are of 2 series, each with an order of its own"),
    ],
)
def test_an_order_that_the_files_do_not_tell_is_not_known(tmp_path, numbers, series, expected):
    for number, uid, name, frame in zip(numbers, series, "ab", FRAMES):
        write_dicom(tmp_path / f"{name}.dcm", frame, InstanceNumber=number, SeriesInstanceUID=uid)
    assert open_images([tmp_path]).unknown_order == expected


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"NumberOfFrames": 2_000_000_000}, "NumberOfFrames must be at most 1000000; got 2000000000"),
        ({"Rows": 60000, "Columns": 60000}, "pixels cannot be decoded"),
    ],
)
def test_a_dicom_file_that_promises_more_than_it_holds_is_refused(tmp_path, said, words):
    with pytest.raises(FileFormatError, match=words):
        open_images([write_dicom(tmp_path / "a.dcm", FRAMES[:2], **said)])


@pytest.mark.parametrize("bits", [8, 16, None])
def test_a_palette_of_a_dicom_file_is_looked_up_and_white_may_be_its_least_value(tmp_path, bits):
    """Of a palette that turns gray levels round, the picture counts and not the numbers that are stored."""
    levels = np.arange(256)[::-1]
    table = (levels * 257).astype("<u2").tobytes() if bits == 16 else levels.astype(np.uint8).tobytes()
    said = {"PhotometricInterpretation": "PALETTE COLOR" if bits else "MONOCHROME1"}
    for color in ("Red", "Green", "Blue") if bits else ():
        said[f"{color}PaletteColorLookupTableDescriptor"] = [256, 0, bits]
        said[f"{color}PaletteColorLookupTableData"] = table
    path = write_dicom(tmp_path / "a.dcm", 255 - FRAMES, **said)
    np.testing.assert_allclose(np.asarray(open_images([path]).stack), FRAMES, atol=1 if bits else 0)


def write_video(path, frames, rate=25):
    """A video made by the program that will read it."""
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed").get_ffmpeg_exe()
    size = f"{frames.shape[2]}x{frames.shape[1]}"
    source = ["-f", "rawvideo", "-pix_fmt", "gray", "-s", size, "-r", str(rate), "-i", "-"]
    subprocess.run([ffmpeg, "-v", "error", *source, "-pix_fmt", "yuv420p", "-y", str(path)], input=frames.tobytes(), check=True)
    return path


STEPS = np.stack([np.full((48, 64), 20 * n, np.uint8) for n in range(9)])


def test_the_frames_of_a_video_come_near_and_have_times(tmp_path):
    found = open_images([write_video(tmp_path / "a.mp4", STEPS)])
    assert found.stack.shape == (9, 48, 64)
    np.testing.assert_allclose(found.times, np.arange(9) / 25)
    assert [abs(int(np.median(found.stack[n])) - 20 * n) <= 4 for n in (8, 0, 3)] == [True] * 3


@pytest.mark.parametrize(
    ("name", "package", "distribution"),
    [("a.png", "PIL", "Pillow"), ("a.dcm", "pydicom", "pydicom"), ("a.mp4", "imageio_ffmpeg", "imageio-ffmpeg")],
)
def test_a_package_that_is_missing_is_named_with_the_way_to_get_it(tmp_path, monkeypatch, name, package, distribution):
    import sys

    monkeypatch.setitem(sys.modules, package, None)
    for module in [module for module in sys.modules if module.startswith(f"{package}.")]:
        monkeypatch.setitem(sys.modules, module, None)
    (tmp_path / name).write_bytes(b"x")
    with pytest.raises(FileFormatError, match=rf"without the Python package {distribution}\. .*pip install {distribution}\.$"):
        open_images([tmp_path / name])


# ---- small files that ask for hours and gigabytes


def test_a_picture_that_says_it_has_billions_of_pages_is_refused(tmp_path):
    path = tmp_path / "a.png"
    pil.fromarray(FRAMES[0]).save(path, save_all=True, append_images=[pil.fromarray(FRAMES[1])])
    data = path.read_bytes()
    control = data.index(b"acTL")
    said = b"acTL" + struct.pack(">II", 2**31 - 1, 0)
    path.write_bytes(data[:control] + said + struct.pack(">I", zlib.crc32(said)) + data[control + 16 :])
    with pytest.raises(FileFormatError, match=r"1000001 frames of .* are beyond the limits"):
        open_images([path])
