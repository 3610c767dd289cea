"""Bad sequence files: each is an error of one line that names the file and what is wrong, never a traceback or a wrong image."""

from __future__ import annotations

import os
import re
import tracemalloc
import zlib

import numpy as np
import pytest
from sequence_samples import IDENTITY, metaimage, nrrd, ramp

from AIFReconLib.errors import SequenceFormatError
from AIFReconLib.io.sequence import file_images
from AIFReconLib.io.sequence.files import read_sequence


def refusal(path) -> str:
    """What is said about a file that cannot be opened: one line that begins with its path."""
    with pytest.raises(SequenceFormatError) as caught:
        read_sequence(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes are POSIX")
def test_a_pipe_is_refused_without_waiting_for_it(tmp_path):
    os.mkfifo(tmp_path / "sweep.mha")
    assert "regular file" in refusal(tmp_path / "sweep.mha")


@pytest.mark.parametrize("suffix", [".mha", ".nrrd"])
@pytest.mark.parametrize("content", [b"", b"\x00" * 100, b"\n" * 100, bytes(range(256)) * 10, b"hello\n", b"NRRD0004\nhello\n"])
def test_a_file_without_a_header_is_refused(tmp_path, suffix, content):
    (tmp_path / f"sweep{suffix}").write_bytes(content)
    refusal(tmp_path / f"sweep{suffix}")


def test_a_large_file_without_line_ends_is_not_read_whole(tmp_path):
    path = tmp_path / "sweep.mha"
    path.write_bytes(b"x" * 20_000_000)
    tracemalloc.start()
    try:
        refusal(path)
        assert tracemalloc.get_traced_memory()[1] < 5_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("make", [metaimage, nrrd])
def test_a_header_without_end_is_refused(tmp_path, make):
    path = make(tmp_path / ("sweep.mha" if make is metaimage else "sweep.nrrd"), ramp())
    path.write_bytes(path.read_bytes()[:300].rsplit(b"\n", 1)[0] + b"\n")
    assert "the header ends without" in refusal(path)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"NDims": "5"}, "NDims must be"),
        ({"NDims": "three"}, "NDims must be"),
        ({"DimSize": "4 3"}, "DimSize must be 3 whole numbers"),
        ({"DimSize": "4 3 -2"}, "DimSize must be 3 whole numbers"),
        ({"DimSize": "4 3 2.5"}, "DimSize must be 3 whole numbers"),
        ({"DimSize": "4 3 0"}, "holds no image"),
        ({"DimSize": "4 3 3"}, r"cut short: DimSize 4 3 3 needs 36 bytes, there are 24 \(2 of 3"),
        ({"DimSize": "4 3 1"}, "DimSize 4 3 1 needs 12 bytes, there are 12 bytes more"),
        ({"DimSize": "999999999999 999999999999 999999999999"}, "cut short"),
        ({"BinaryData": "False"}, "ASCII data are not supported"),
        ({"BinaryData": "perhaps"}, "BinaryData must be True or False"),
        ({"BinaryDataByteOrderMSB": "perhaps"}, "BinaryDataByteOrderMSB must be"),
        ({"ElementType": "MET_OTHER"}, "ElementType must be one of"),
        ({"ObjectType": "Tube"}, "ObjectType must be Image"),
        ({"HeaderSize": "-1"}, "HeaderSize must be"),
        ({"Kinds": "domain list"}, "Kinds must have 3 words"),
        ({"Kinds": "domain domain domain"}, "3D .4 x 3 x 2.: frames must be 2D"),
        ({"Kinds": "list domain domain"}, "axes must be columns, rows and time"),
        ({"NDims": "4", "DimSize": "4 1 3 2", "Kinds": None}, "3D .4 x 1 x 3.: frames must be 2D"),
        ({"ElementNumberOfChannels": "2", "DimSize": "4 3 1"}, "1 channel, or 3 or 4"),
        ({"ElementDataFile": "LIST"}, "Lists of files are not supported"),
        ({"ElementDataFile": "frame%03d.raw 1 2 1"}, "Lists of files are not supported"),
        ({"ElementDataFile": "missing.raw"}, "data file missing.raw is missing"),
        ({"ElementDataFile": "/etc/hostname"}, "must lie beside it"),
        ({"ElementDataFile": "../sweep.raw"}, "must lie beside it"),
        ({"ElementDataFile": "..\\sweep.raw"}, "must lie beside it"),
        ({"ElementDataFile": "C:sweep.raw"}, "must lie beside it"),
        ({"ElementDataFile": ""}, "must lie beside it"),
        ({"UltrasoundImageOrientation": "FM"}, "radio-frequency"),
        ({"UltrasoundImageOrientation": "NUD"}, "radio-frequency"),
        ({"UltrasoundImageType": "RF_IQ_LINE"}, "radio-frequency"),
        ({"UltrasoundImageType": "DOPPLER"}, "UltrasoundImageType must be"),
        ({"UltrasoundImageOrientation": "XX"}, "mirrors the anatomy"),
        ({"UltrasoundImageOrientation": "MFX"}, "mirrors the anatomy"),
    ],
)
def test_a_wrong_metaimage_header_is_explained(tmp_path, changes, expected):
    assert re.search(expected, refusal(metaimage(tmp_path / "sweep.mha", ramp(), **changes)))


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"dimension": "1"}, "dimension must be"),
        ({"sizes": "4 3"}, "sizes must be 3 whole numbers"),
        ({"sizes": "4 3 0"}, "holds no image"),
        ({"sizes": "4 3 3"}, "cut short: sizes 4 3 3 needs 36 bytes"),
        ({"type": "block"}, "type must be"),
        ({"encoding": "ascii"}, "encoding must be raw or gzip; got 'ascii'"),
        ({"encoding": "bzip2"}, "encoding must be raw or gzip"),
        ({"kinds": "domain domain"}, "kinds must have 3 words"),
        ({"endian": "middle"}, "endian must be little or big"),
        ({"byte_skip": "12"}, "byte skip must be"),
        ({"data_file": "LIST"}, "Lists of files are not supported"),
        ({"data_file": "frame%03d.raw 1 2 1"}, "Lists of files are not supported"),
        ({"data_file": "missing.raw"}, "data file missing.raw is missing"),
        ({"data_file": "../sweep.raw"}, "must lie beside it"),
    ],
)
def test_a_wrong_nrrd_header_is_explained(tmp_path, changes, expected):
    assert expected in refusal(nrrd(tmp_path / "sweep.nrrd", ramp(), **changes))


def test_two_values_under_one_key_are_refused(tmp_path):
    path = metaimage(tmp_path / "sweep.mha", ramp())
    path.write_bytes(path.read_bytes().replace(b"ElementSpacing", b"DimSize = 3 4 2\nElementSpacing"))
    assert "DimSize is given twice" in refusal(path)


def test_a_16_bit_nrrd_without_byte_order_is_refused(tmp_path):
    assert "endian must be" in refusal(nrrd(tmp_path / "sweep.nrrd", ramp("<u2"), endian=None))


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"Seq_Frame0001_ProbeToTrackerTransform": "1 0 0"}, "frame 1, ProbeToTrackerTransform must be 16 numbers; got 3"),
        ({"Seq_Frame0001_ProbeToTrackerTransform": IDENTITY + " 0"}, "must be 16 numbers; got 17"),
        (
            {"Seq_Frame0001_ProbeToTrackerTransform": IDENTITY.replace("1", "one")},
            "frame 1, ProbeToTrackerTransform must be 16 numbers; 'one'",
        ),
        ({"ImageToProbeTransform": "1"}, "ImageToProbeTransform must be 16 numbers"),
        ({"Seq_Frame0001_Timestamp": "noon"}, "frame 1, Timestamp must be a number of seconds"),
        ({"Seq_Frame0001_UnfilteredTimestamp": "nan"}, "frame 1, UnfilteredTimestamp must be a number of seconds"),
        ({"Seq_Frame0002_Timestamp": "1"}, "Seq_Frame0002_Timestamp belongs to frame 2, but there are only 2 frames"),
        ({"Seq_Frame0001_Timestamp": "1", "Seq_Frame001_Timestamp": "2"}, "frame 1 has Timestamp twice"),
    ],
)
@pytest.mark.parametrize("make", [metaimage, nrrd])
def test_a_wrong_field_is_named_with_its_frame(tmp_path, make, fields, expected):
    assert expected in refusal(make(tmp_path / ("sweep.mha" if make is metaimage else "sweep.nrrd"), ramp(), fields))


# Payloads


NOISE = np.random.default_rng(0).integers(0, 255, (4, 30, 40), dtype=np.uint8)


def test_a_truncated_raw_file_is_noticed_when_it_is_opened(tmp_path):
    path = metaimage(tmp_path / "sweep.mha", NOISE)
    path.write_bytes(path.read_bytes()[:-1500])
    assert "(2 of 4 frames" in refusal(path)


def test_a_truncated_compressed_metaimage_is_noticed_when_it_is_opened(tmp_path):
    path = metaimage(tmp_path / "sweep.mha", NOISE, compressed=True)
    path.write_bytes(path.read_bytes()[:-1])
    assert "cut short: CompressedDataSize is" in refusal(path)


def test_too_many_frames_are_refused_before_anything_is_allocated(tmp_path):
    path = metaimage(tmp_path / "sweep.mha", ramp(), data=zlib.compress(b"\0" * 2_000_000), CompressedData="True", DimSize="1 1 1500000")
    assert "beyond the limits" in refusal(path)


def test_the_first_frame_that_a_truncated_stream_lacks_is_named(tmp_path):
    path = nrrd(tmp_path / "sweep.nrrd", NOISE, compressed=True)
    path.write_bytes(path.read_bytes()[:-1500])
    with pytest.raises(SequenceFormatError, match="cut short, in frame 2"):
        np.asarray(read_sequence(path).images)


def test_a_missing_checksum_is_noticed_at_the_last_frame(tmp_path):
    path = nrrd(tmp_path / "sweep.nrrd", NOISE, compressed=True)
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(SequenceFormatError, match="cut short, in frame 3"):
        read_sequence(path).images[3]


def test_a_corrupt_stream_is_noticed(tmp_path):
    stream = bytearray(zlib.compress(NOISE.tobytes()))
    stream[len(stream) // 2] ^= 0x55
    path = metaimage(tmp_path / "sweep.mha", NOISE, compressed=True, data=bytes(stream))
    with pytest.raises(SequenceFormatError, match="corrupt"):
        np.asarray(read_sequence(path).images)


def test_bytes_behind_a_compressed_stream_are_noticed(tmp_path):
    path = nrrd(tmp_path / "sweep.nrrd", NOISE, compressed=True)
    path.write_bytes(path.read_bytes() + b"junk")
    with pytest.raises(SequenceFormatError, match="go on behind the last frame"):
        np.asarray(read_sequence(path).images)


@pytest.mark.parametrize("unknown", ["", "0", None])
def test_a_compressed_size_that_was_never_filled_in_does_not_matter(tmp_path, unknown):
    path = metaimage(tmp_path / "sweep.mha", NOISE, compressed=True, CompressedDataSize=unknown)
    np.testing.assert_array_equal(read_sequence(path).images[3], NOISE[3])


@pytest.mark.parametrize("compressed", [False, True])
def test_a_file_that_shrinks_after_opening_is_noticed(tmp_path, compressed):
    path = metaimage(tmp_path / "sweep.mha", NOISE, compressed=compressed)
    images = read_sequence(path).images
    path.write_bytes(path.read_bytes()[:600])
    with pytest.raises(SequenceFormatError, match="has changed"):
        images[3]


def test_a_file_that_vanishes_after_opening_is_noticed(tmp_path):
    path = metaimage(tmp_path / "sweep.mha", NOISE)
    images = read_sequence(path).images
    path.unlink()
    with pytest.raises(SequenceFormatError, match="cannot be read"):
        images[0]


@pytest.mark.parametrize("limit", [0, 10**9])
def test_compressed_frames_are_the_same_in_any_order_kept_or_not(tmp_path, monkeypatch, limit):
    monkeypatch.setattr(file_images, "KEPT_BYTES", limit)
    images = read_sequence(metaimage(tmp_path / "sweep.mha", NOISE, compressed=True)).images
    for index in (2, len(NOISE) - 1, 0, 2, 1, 1, len(NOISE) - 1, 3):
        np.testing.assert_array_equal(images[index], NOISE[index])


def test_a_short_compressed_recording_is_decoded_once(tmp_path):
    path = metaimage(tmp_path / "sweep.mha", NOISE, compressed=True)
    images = read_sequence(path).images
    images[len(NOISE) - 1]
    path.unlink()
    np.testing.assert_array_equal(np.asarray(images), NOISE)


def test_reading_a_long_compressed_recording_needs_the_memory_of_a_few_frames(tmp_path, monkeypatch):
    monkeypatch.setattr(file_images, "KEPT_BYTES", 2**20)
    pixels = np.zeros((200, 200, 200), np.uint8)
    pixels[::2] = 7
    images = read_sequence(metaimage(tmp_path / "sweep.mha", pixels, compressed=True)).images
    tracemalloc.start()
    try:
        for index in range(len(images)):
            images[index]
        assert tracemalloc.get_traced_memory()[1] < 2_000_000
    finally:
        tracemalloc.stop()
