"""Bad sequence files: each is an error of one line that names the file and what is wrong, never a traceback or a wrong image."""

from __future__ import annotations

import os
import re
import zlib
from functools import partial

import numpy as np
import pytest
import volume_samples
from sequence_samples import IDENTITY, metaimage, nrrd, ramp

from AIFReconLib.errors import SequenceFormatError
from AIFReconLib.io.sequence import file_images
from AIFReconLib.io.sequence.files import read_sequence

refusal = partial(volume_samples.refusal, read=read_sequence, error=SequenceFormatError)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes are POSIX")
def test_a_pipe_is_refused_without_waiting_for_it(tmp_path):
    os.mkfifo(tmp_path / "sweep.mha")
    assert "regular file" in refusal(tmp_path / "sweep.mha")


MAKE = {".mha": metaimage, ".nrrd": nrrd}


@pytest.mark.parametrize("suffix", MAKE)
@pytest.mark.parametrize("content", [b"", b"\x00" * 100, b"\n" * 100, bytes(range(256)) * 10, b"hello\n", b"NRRD0004\nhello\n"])
def test_a_file_without_a_header_or_its_end_is_refused(tmp_path, suffix, content):
    path = tmp_path / f"sweep{suffix}"
    path.write_bytes(content)
    refusal(path)
    path.write_bytes(MAKE[suffix](path, ramp()).read_bytes()[:300].rsplit(b"\n", 1)[0] + b"\n")
    assert "the header ends without" in refusal(path)


MHA = [
    ({"NDims": "5"}, "NDims must be"),
    ({"DimSize": "4 3"}, "DimSize must be 3 whole numbers"),
    ({"DimSize": "4 3 0"}, "holds no image"),
    ({"DimSize": "4 3 3"}, r"cut short: DimSize 4 3 3 needs 36 bytes, there are 24 \(2 of 3"),
    ({"DimSize": "4 3 1"}, "DimSize 4 3 1 needs 12 bytes, there are 12 bytes more"),
    ({"DimSize": "999999999999 999999999999 999999999999"}, "cut short"),
    ({"BinaryData": "False"}, "ASCII data are not supported"),
    ({"BinaryDataByteOrderMSB": "perhaps"}, "BinaryDataByteOrderMSB must be"),
    ({"ElementType": "MET_OTHER"}, "ElementType must be one of"),
    ({"ObjectType": "Tube"}, "ObjectType must be Image"),
    ({"HeaderSize": "-1"}, "HeaderSize must be"),
    ({"Kinds": "domain list"}, "Kinds must have 3 words"),
    ({"Kinds": "domain domain domain"}, "volume of 4 x 3 x 2 voxels; frames must be 2D"),
    ({"Kinds": "list domain domain"}, "axes must be columns, rows and time"),
    ({"NDims": "4", "DimSize": "4 1 3 2", "Kinds": None}, "volume of 4 x 1 x 3 voxels; frames must be 2D"),
    ({"ElementNumberOfChannels": "2", "DimSize": "4 3 1"}, "1 channel, or 3 or 4"),
    ({"ElementDataFile": "LIST"}, "Lists of files are not supported"),
    ({"ElementDataFile": "frame%03d.raw 1 2 1"}, "Lists of files are not supported"),
    ({"ElementDataFile": "missing.raw"}, "data file missing.raw is missing"),
    *(({"ElementDataFile": name}, "must lie beside it") for name in ("/etc/hostname", "../a.raw", "..\\a.raw", "C:a.raw", "")),
    ({"UltrasoundImageOrientation": "NUD"}, "radio-frequency"),
    ({"UltrasoundImageType": "RF_IQ_LINE", "UltrasoundImageOrientation": "FM"}, "type RF_IQ_LINE, orientation FM.*Export B-mode"),
    ({"UltrasoundImageType": "DOPPLER"}, "UltrasoundImageType must be"),
    ({"UltrasoundImageOrientation": "XX"}, "mirrors the anatomy"),
    ({"UltrasoundImageOrientation": "??"}, "did not know it.*say it with orientation"),
    ({"Extra": "1\nDimSize = 3 4 2"}, "DimSize is given twice"),
]
NRRD = [
    ({"dimension": "1"}, "dimension must be"),
    ({"sizes": "4 3"}, "sizes must be 3 whole numbers"),
    ({"sizes": "4 3 3"}, "cut short: sizes 4 3 3 needs 36 bytes"),
    ({"type": "block"}, "type must be"),
    ({"encoding": "ascii"}, "encoding must be raw or gzip; got 'ascii'"),
    ({"type": "short", "sizes": "2 3 2", "endian": "middle"}, "endian must be little or big"),
    ({"byte_skip": "12"}, "byte skip must be"),
    ({"data_file": "../sweep.raw"}, "must lie beside it"),
]


@pytest.mark.parametrize(("suffix", "changes", "expected"), [*((".mha", *row) for row in MHA), *((".nrrd", *row) for row in NRRD)])
def test_a_wrong_header_is_explained(tmp_path, suffix, changes, expected):
    assert re.search(expected, refusal(MAKE[suffix](tmp_path / f"sweep{suffix}", ramp(), **changes)))


POSE, WORDED = "Seq_Frame0001_ProbeToTrackerTransform", IDENTITY.replace("1", "one")


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({POSE: "1 0 0"}, "frame 1, ProbeToTrackerTransform must be 16 numbers; got 3"),
        ({POSE: WORDED}, "frame 1, ProbeToTrackerTransform must be 16 numbers; 'one'"),
        ({"ImageToProbeTransform": "1"}, "ImageToProbeTransform must be 16 numbers"),
        ({"Seq_Frame0001_Timestamp": "noon"}, "frame 1, Timestamp must be a number of seconds"),
        ({"Seq_Frame0001_UnfilteredTimestamp": "nan"}, "frame 1, UnfilteredTimestamp must be a number of seconds"),
        ({"Seq_Frame0002_Timestamp": "1"}, "Seq_Frame0002_Timestamp belongs to frame 2, but there are only 2 frames"),
        ({"Seq_Frame0001_Timestamp": "1", "Seq_Frame001_Timestamp": "2"}, "frame 1 has Timestamp twice"),
    ],
)
@pytest.mark.parametrize("suffix", MAKE)
def test_a_wrong_field_is_named_with_its_frame(tmp_path, suffix, fields, expected):
    assert expected in refusal(MAKE[suffix](tmp_path / f"sweep{suffix}", ramp(), fields))


# Payloads


NOISE = np.random.default_rng(0).integers(0, 255, (4, 30, 40), dtype=np.uint8)


def flipped(data: bytes) -> bytes:
    """With a byte in the middle of the pixels damaged."""
    at = (data.index(b"LOCAL") + len(data)) // 2
    return data[:at] + bytes([data[at] ^ 0x55]) + data[at + 1 :]


DAMAGED = {
    "raw, cut short": (".mha", False, lambda data: data[:-1500], "2 of 4 frames", True),
    "compressed MetaImage, cut short": (".mha", True, lambda data: data[:-1], "cut short: CompressedDataSize is", True),
    "compressed NRRD, cut short": (".nrrd", True, lambda data: data[:-1500], "cut short, in frame 2", False),
    "without its checksum": (".nrrd", True, lambda data: data[:-1], "cut short, in frame 3", False),
    "bytes behind": (".nrrd", True, lambda data: data + b"junk", "go on behind the last frame", False),
    "corrupt": (".mha", True, flipped, "corrupt", False),
}


@pytest.mark.parametrize(("suffix", "compressed", "damage", "said", "at_once"), DAMAGED.values(), ids=DAMAGED)
def test_damaged_pixels_are_noticed_when_the_file_is_opened_or_where_they_are_read(tmp_path, suffix, compressed, damage, said, at_once):
    path = MAKE[suffix](tmp_path / f"sweep{suffix}", NOISE, compressed=compressed)
    path.write_bytes(damage(path.read_bytes()))
    if at_once:
        assert said in refusal(path)
        return
    images = read_sequence(path).images
    with pytest.raises(SequenceFormatError, match=said):
        np.asarray(images)


def test_too_many_frames_are_refused_before_anything_is_allocated(tmp_path):
    path = metaimage(tmp_path / "sweep.mha", ramp(), data=zlib.compress(b"\0" * 2_000_000), CompressedData="True", DimSize="1 1 1500000")
    assert "beyond the limits" in refusal(path)


@pytest.mark.parametrize("unknown", ["", "0", None])
def test_a_compressed_size_that_was_never_filled_in_does_not_matter(tmp_path, unknown):
    path = metaimage(tmp_path / "sweep.mha", NOISE, compressed=True, CompressedDataSize=unknown)
    np.testing.assert_array_equal(read_sequence(path).images[3], NOISE[3])


def test_a_file_that_shrinks_or_vanishes_after_opening_is_noticed(tmp_path):
    for compressed in (False, True):
        path = metaimage(tmp_path / "sweep.mha", NOISE, compressed=compressed)
        images = read_sequence(path).images
        path.write_bytes(path.read_bytes()[:600])
        with pytest.raises(SequenceFormatError, match="has changed"):
            images[3]
        path.unlink()
        with pytest.raises(SequenceFormatError, match="cannot be read"):
            images[0]


@pytest.mark.parametrize("limit", [0, 10**9])
@pytest.mark.parametrize("compressed", [False, True])
def test_frames_are_the_same_in_any_order_kept_or_not(tmp_path, monkeypatch, limit, compressed):
    monkeypatch.setattr(file_images, "KEPT_BYTES", limit)
    # Larger than the buffer for decoding
    pixels = np.random.default_rng(1).integers(0, 255, (4, 700, 801), dtype=np.uint8)
    images = read_sequence(metaimage(tmp_path / "sweep.mha", pixels, compressed=compressed)).images
    for index in (2, 3, 0, 2, 1, 1, -1, 3):
        np.testing.assert_array_equal(images[index], pixels[index])
        images[index][:] = 0
    with pytest.raises(IndexError):
        images[4]
    with pytest.raises(ValueError, match="without a copy"):
        images.__array__(copy=False)
    assert np.asarray(images, dtype=np.float32).dtype == np.float32
