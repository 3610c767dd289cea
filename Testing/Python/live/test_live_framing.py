"""Bytes of a stream to messages: checksums, sizes, damage, decoding and encoding, without a socket."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from igtl_streams import POSE, image_bytes, picture, recorded, transform_bytes

from AIFReconLib.errors import LiveMessageError
from AIFReconLib.geometry.transform_graph import TransformStatus
from AIFReconLib.geometry.transforms import LPS_FROM_RAS
from AIFReconLib.live.wire import encoding
from AIFReconLib.live.wire.crc64 import crc64
from AIFReconLib.live.wire.decoding import decode
from AIFReconLib.live.wire.framing import Framer, parse_header


def crc_by_definition(data: bytes) -> int:
    """The checksum bit by bit, as the polynomial division that it is."""
    value = 0
    for byte in data:
        value ^= byte << 56
        for _ in range(8):
            value = (value << 1) ^ (0x142F0E1EBA9EA3693 if value >> 63 else 0)
    return value


def framed(*chunks: bytes, size_limit: int = 2**20) -> list:
    """What a framer makes of bytes that arrive in these chunks."""
    framer = Framer(size_limit)
    return [part for chunk in chunks for part in framer.feed(chunk)]


def decoded(message: bytes):
    """The only message in a frame."""
    (frame,) = framed(message)
    (held,) = decode(frame, received=7.0)
    return held


# ---- checksum


@pytest.mark.parametrize("size", [0, 1, 7, 8, 9, 48, 511, 512, 513, 520, 1025, 4099])
def test_the_checksum_of_any_length_is_that_of_the_definition(size):
    data = np.random.default_rng(size).bytes(size)
    assert crc64(data) == crc_by_definition(data)
    assert crc64(b"123456789") == 0x6C40DF5F0B497347  # as published


# ---- framing


@given(
    st.lists(
        st.tuples(st.sampled_from(["cut", "flip", "insert", "repeat"]), st.integers(0, 3000), st.integers(1, 300)), min_size=1, max_size=6
    ),
    st.integers(1, 400),
)
@example([("insert", 958, 1), ("insert", 1001, 9)], 1)
@settings(max_examples=60, deadline=None)
def test_whatever_happens_to_a_stream_no_message_comes_out_that_was_not_sent(damages, chunk):
    sent = [image_bytes(picture(n, 11, 17), timestamp=n) for n in range(4)] + [transform_bytes(device=f"T{n}") for n in range(4)]
    stream = b"".join(sent)
    for kind, start, length in damages:
        before, after = stream[:start], stream[start:]
        if kind == "cut":
            stream = before + after[length:]
        elif kind == "flip":
            stream = before + bytes(byte ^ 255 for byte in after[:length]) + after[length:]
        elif kind == "insert":
            stream = before + bytes(length) + after
        else:
            stream = before + before[-length:] + after
    parts = framed(*(stream[start : start + chunk] for start in range(0, len(stream), chunk)))
    # The checksum of zeros, and of nothing, is 0: inserted zeros can look like a verified body, and nothing comes of it
    bodies = {part.body for part in parts if part.problem is None and any(part.body)}
    assert bodies <= {message[58:] for message in sent}


def test_a_version_of_the_future_is_no_header():
    assert parse_header(b"\x00\x04" + transform_bytes()[2:]) is None


def test_a_really_damaged_stream_is_given_up_where_its_server_began_a_message_anew(data_dir):
    """Both replay one recording, so every image that comes out must be one of its frames, pixel for pixel."""
    framer = Framer()
    parts = framer.feed(recorded(data_dir, "H"))
    assert framer.problem == "Bytes arrived that are no OpenIGTLink message"
    assert [part.kind for part in parts if part.problem is not None] == ["IMAGE"]

    def pixels(messages):
        return {part.body[72:] for part in messages if part.problem is None and part.kind == "IMAGE"}

    assert pixels(parts) <= pixels(framed(recorded(data_dir, "A")))
    assert len(pixels(parts)) > 3


# ---- decoding


@pytest.mark.parametrize(("system", "matrix"), [("ras", POSE), ("lps", LPS_FROM_RAS @ POSE)])
def test_an_image_carries_its_time_its_metadata_and_its_matrix_in_ras(system, matrix):
    message = decoded(image_bytes(timestamp=1234.5, version=2, metadata={"Depth": "60"}, system=system))
    assert np.allclose(message.image_to_sender, matrix, atol=1e-5)
    assert (message.timestamp, message.metadata, message.header_version, message.received) == (1234.5, {"Depth": "60"}, 2, 7.0)


@pytest.mark.parametrize("dtype", ["int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"])
def test_every_type_of_pixel_arrives(dtype):
    image = decoded(image_bytes(picture(4, dtype=dtype))).image
    assert not image.flags.writeable
    assert image.dtype == np.dtype(dtype)
    assert np.array_equal(image, picture(4, dtype=dtype))


def test_big_endian_pixels_arrive_in_the_byte_order_of_the_machine():
    pixels = (picture(4, dtype="uint16") * 256).astype(">u2")
    body = bytearray(image_bytes(pixels.astype("<u2"))[58:])
    body[4], body[72:] = 1, pixels.tobytes()
    image = decoded(encoding.encode_message("IMAGE", "Big", 0.0, bytes(body))).image
    assert image.dtype.isnative
    assert np.array_equal(image, pixels)


def test_colors_are_reduced_to_luminance():
    colors = np.zeros((1, 2, 2, 3), np.uint8)
    colors[..., 1] = 200
    assert decoded(image_bytes(colors)).image.tolist() == [[117, 117], [117, 117]]


@pytest.mark.parametrize(
    ("matrix", "told", "status"),
    [
        (POSE, {}, TransformStatus.OK),
        (POSE, {"TransformStatus": "OUT_OF_VIEW", "TransformValid": "0"}, TransformStatus.OUT_OF_VIEW),
        (POSE, {"TransformValid": "0"}, TransformStatus.INVALID),
        (np.full((4, 4), np.nan), {"TransformStatus": "OK"}, TransformStatus.INVALID),
    ],
)
def test_the_status_of_a_transform_is_in_its_metadata_but_nan_is_never_a_pose(matrix, told, status):
    message = decoded(transform_bytes(matrix, version=2, metadata=told))
    assert message.status is status
    assert np.allclose(message.matrix[:3], matrix[:3], atol=1e-6, equal_nan=True)


POINT = encoding.encode_message("POSITION", "ProbeToTracker", 1.5, bytes(12))
SENSELESS = {
    "cut short": (encoding.encode_message("IMAGE", "Short", 0.0, image_bytes()[58:-3]), "'Short' cannot be understood"),
    "a thousand tools": (encoding.encode_message("TDATA", "Tracker", 1.0, bytes(70 * 1001)), "holds 1001 tools, more than 1000"),
    "no quaternion": (POINT, "holds 12 bytes, not a position and a quaternion .*send TRANSFORM"),
}


@pytest.mark.parametrize(("message", "why"), SENSELESS.values(), ids=SENSELESS)
def test_what_makes_no_sense_is_refused_with_the_reason(message, why):
    with pytest.raises(LiveMessageError, match=why):
        decoded(message)


QUATERNION = (0.5, -0.5, 0.5, 0.5)
TURNED = np.array([(0.0, -1.0, 0.0, 1.0), (0.0, 0.0, -1.0, 2.0), (1.0, 0.0, 0.0, 3.0), (0.0, 0.0, 0.0, 1.0)])
"""What it turns, with a position of 1, 2, 3 mm."""


@pytest.mark.parametrize("kind", ["POSITION", "QTRANS"])
@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("count", [6, 7])
def test_a_position_and_a_quaternion_are_a_pose(kind, version, count):
    content = struct.pack(f">{count}f", *((1, 2, 3, *QUATERNION)[:count]))
    message = decoded(encoding.encode_message(kind, "ProbeToTracker", 1.5, content, version=version))
    np.testing.assert_allclose(message.matrix, TURNED, atol=1e-7)
    assert (message.device, message.timestamp, message.status, message.from_quaternion) == ("ProbeToTracker", 1.5, TransformStatus.OK, True)


@pytest.mark.parametrize(
    ("kind", "form", "pose"), [("QTDATA", ">20sBB7f", (1, 2, 3, *QUATERNION)), ("TDATA", ">20sBB12f", TURNED[:3].T.ravel())]
)
def test_each_tool_of_tracking_data_is_a_pose(kind, form, pose):
    content = b"".join(struct.pack(form, name, 1, 0, *pose) for name in (b"Probe", b"ReferenceToTracker"))
    (frame,) = framed(encoding.encode_message(kind, "Tracker", 1.5, content))
    held = decode(frame)
    assert [message.device for message in held] == ["Probe", "ReferenceToTracker"]
    np.testing.assert_allclose(held[1].matrix, TURNED, atol=1e-7)


@pytest.mark.parametrize("quaternion", [(0, 0, 0, 0), (np.nan, 0, 0, 1), (np.inf, 0, 0, 1), (3, 0, 0, 0)])
def test_a_quaternion_that_turns_nothing_is_an_invalid_pose(quaternion):
    message = decoded(encoding.encode_message("POSITION", "ProbeToTracker", 1.5, struct.pack(">7f", 1, 2, 3, *quaternion)))
    assert message.status is TransformStatus.INVALID


# ---- encoding


def test_the_request_for_statuses_is_the_one_that_a_real_server_answered():
    # From the notes of recording B: size, checksum and body
    sent = bytes.fromhex("000000000000000eb21e4ee882505334000c000200000000000000000000")
    assert encoding.encode_status_request()[:14] == b"\x00\x02GET_STATUS\x00\x00"
    assert encoding.encode_status_request()[42:] == sent


@pytest.mark.parametrize("letter", ["A", "B"])
def test_what_a_real_server_sent_is_encoded_to_the_same_bytes(data_dir, letter):
    different = 0
    for part in framed(recorded(data_dir, letter))[:60]:
        if part.kind == "STATUS":
            continue
        (message,) = decode(part)
        options = {"version": part.version, "metadata": message.metadata}
        if part.kind == "IMAGE":
            again = encoding.encode_image(part.device, part.timestamp, message.image, message.image_to_sender, **options)
            # The center of the image comes out of a sum in other precision
            same = np.allclose(decoded(again).image_to_sender, message.image_to_sender, atol=1e-4)
        else:
            again = encoding.encode_transform(part.device, part.timestamp, message.matrix, **options)
            same = again[58:] == part.body
        different += not same or parse_header(again).timestamp != part.timestamp
    assert different == 0


def test_text_outside_ascii_and_the_last_bit_of_a_time_survive():
    message = decoded(encoding.encode_transform("A", 1795209143.174278, POSE, version=2, metadata={"Gerät": "Köpf"}))
    assert (message.timestamp, message.metadata) == (1795209143.174278, {"Gerät": "Köpf"})
