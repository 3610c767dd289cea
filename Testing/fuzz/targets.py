"""What is fuzzed, and what every input must come to: a refusal in one sentence, or a well-formed result, in little time and memory."""

from __future__ import annotations

import contextlib
import resource
import struct
import tempfile
import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from igtl_streams import image_bytes, picture, transform_bytes
from live_messages import metadata
from made_recordings import PROBE, SCENE, Bag, acquisition, bundle, pose
from sequence_samples import metaimage, nrrd, ramp
from variant_files import poses, slicer_images, slicer_transforms

from AIFReconLib import Recipe, read_sequence, reconstruct
from AIFReconLib.errors import AIFReconError, LiveMessageError
from AIFReconLib.io.sequence.transforms import read_transform_sequence
from AIFReconLib.live.wire.crc64 import crc64
from AIFReconLib.live.wire.decoding import decode
from AIFReconLib.live.wire.encoding import encode_message, encode_status
from AIFReconLib.live.wire.framing import HEADER_SIZE, Framer
from AIFReconLib.live.wire.messages import ImageMessage, TransformMessage

LONGEST_MESSAGE = 8000
"""Characters: a few quotes of a file, every character of which must be escaped."""
SLOWEST = 5.0
"""s of CPU time that an input of a few KB may take. Machines of continuous integration are slow and shared."""
LARGEST_GROWTH = 400 * 2**20
"""Bytes that an input of a few KB may add to the memory of the process."""


@dataclass(frozen=True)
class Target:
    """One way into the library.

    Parameters
    ----------
    name : str
    file : str
        Under which the input is given to `read`.
    read : function (Path) -> None
        Reads the file and asserts that what comes out is well-formed.
    inputs : function (Path) -> list of bytes
        Good ones, small, made in this folder; what else belongs to one stays there.
    wrap : function (bytes) -> bytes
        What turns the damaged bytes into the input: damage behind a compression or a checksum is never reached otherwise.
    """

    name: str
    file: str
    read: Callable[[Path], None]
    inputs: Callable[[Path], list[bytes]]
    wrap: Callable[[bytes], bytes] = bytes


def check(target: Target, data: bytes, folder: Path) -> bool:
    """Give `data` to the target; True if it was accepted, False if it was refused.

    Raises whatever the library raised that is no refusal, and AssertionError when the refusal cannot be shown on a line, or the input took
    too long or too much memory.
    """
    path = folder / target.file
    path.write_bytes(target.wrap(data))
    before, begin = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    accepted = True
    try:
        target.read(path)
    except AIFReconError as error:
        accepted = False
        message = str(error)
        assert message, "a refusal without words"
        assert message.isprintable(), f"not for one line: {message[:3000]!r}"
        assert len(message) < LONGEST_MESSAGE, f"long: {message[:3000]!r}"
    if time.process_time() - begin > SLOWEST:
        # The first time something may have been loaded
        begin = time.process_time()
        with contextlib.suppress(AIFReconError):
            target.read(path)
        took = time.process_time() - begin
        assert took < SLOWEST, f"it takes {took:.1f} s"
    grown = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
    assert grown < LARGEST_GROWTH, f"it takes {grown / 2**20:.0f} MB"
    return accepted


# ---- recordings


def _sequence(path: Path) -> None:
    sequence = read_sequence(path)
    frames, rows, columns = sequence.images.shape
    assert len(sequence.records) == frames > 0
    assert min(rows, columns) > 0
    for record in sequence.records:
        assert record.timestamp is None or np.isfinite(record.timestamp)
        assert all(sample.matrix.shape == (4, 4) and sample.matrix.dtype == np.float64 for sample in record.transforms.values())
    for number in {0, frames // 2, frames - 1}:
        image = sequence.images[number]
        assert image.shape == (rows, columns)
        assert image.dtype == sequence.images.dtype


def _reconstruction(path: Path) -> None:
    volume = reconstruct(read_sequence(path), Recipe(spacing=1.0, engine="numpy")).intensity
    assert volume.array.size > 0
    assert np.isfinite(volume.ijk_to_reference).all()


def _transform_sequence(path: Path) -> None:
    for time_, sample in read_transform_sequence(path, "ImageToReference"):
        assert time_ is None or np.isfinite(time_)
        assert sample.matrix.shape == (4, 4)


def _acquisition(path: Path) -> None:
    _sequence(path.parent)


def _bytes_of(folder: Path, suffix: str, *writes: Callable[[Path], object]) -> list[bytes]:
    made = []
    for write in writes:
        write(folder / f"good{suffix}")
        made.append((folder / f"good{suffix}").read_bytes())
        (folder / f"good{suffix}").unlink()
    return made


def _metaimages(folder: Path) -> list[bytes]:
    makes = (
        lambda path: metaimage(path, ramp(frames=3), poses()),
        lambda path: metaimage(path, ramp(frames=3, channels=3), poses(), compressed=True),
        lambda path: metaimage(path, ramp(">u2", 3), poses(), UltrasoundImageOrientation="UN"),
        lambda path: metaimage(path, ramp("f4", 3), poses(), Kinds=None, RecordingUnfinished="True"),
    )
    return _bytes_of(folder, ".mha", *makes)


def _moves(folder: Path) -> list[bytes]:
    fields = poses(probe="ImageToReference", with_calibration=False)
    return _bytes_of(folder, ".mha", slicer_transforms, lambda path: metaimage(path, ramp(frames=3), fields))


def _nrrds(folder: Path) -> list[bytes]:
    return _bytes_of(
        folder,
        ".seq.nrrd",
        lambda path: nrrd(path, ramp(frames=3), poses()),
        lambda path: nrrd(path, ramp(frames=3, channels=3), poses(), compressed=True),
        slicer_images,
        partial(slicer_images, interleaved=True, compressed=False, unit="ms", **{"axis 0 item 0001 Note": "a"}),
        partial(slicer_images, color=True),
    )


def _deflated(data: bytes) -> bytes:
    """The bytes behind the header, compressed: the header promises what it likes."""
    head, mark, payload = data.partition(b"ElementDataFile = LOCAL\n")
    return head.replace(b"CompressedData = False", b"CompressedData = True") + mark + zlib.compress(payload, 1)


def _detached(folder: Path) -> list[bytes]:
    (folder / "data.raw").write_bytes(ramp(frames=3).tobytes())
    header = _metaimages(folder)[0].split(b"LOCAL")[0] + b"data.raw\n"
    size = next(line for line in header.splitlines(keepends=True) if line.startswith(b"DimSize"))
    # Of a recording that grows: its last frame stands behind the header
    grows = b"RecordingUnfinished = True\n" + header.replace(size, size.replace(b"3\n", b"2\n"))
    return [header, grows + b"Seq_Frame0002_ImageStatus = OK\n" + size]


def _bundled(scene: bytes) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        return bundle(Path(folder) / "a.mrb", scene).read_bytes()


def _scenes(_folder: Path) -> list[bytes]:
    return [SCENE.encode(), SCENE.replace("transform:c;", "").encode()]


def _arrays(folder: Path) -> list[bytes]:
    arrays: dict[str, Any] = {"images": ramp(frames=3), "image_to_reference": np.tile(np.diag([0.1, 0.1, 0.1, 1]), (3, 1, 1))}
    return _bytes_of(
        folder,
        ".npz",
        lambda path: np.savez(path, **arrays, timestamps=np.arange(3.0)),
        lambda path: np.savez_compressed(path, **arrays),
    )


def _acquisitions(suffix: str, folder: Path) -> list[bytes]:
    acquisition(folder, frame_poses=suffix == ".fp", probe=PROBE)
    return [next(folder.glob(f"*{suffix}")).read_bytes()]


BAGS = {"bag": ".bag", "mcap": ".mcap", "sqlite3": ".db3"}


def _bags(storage: str, folder: Path) -> list[bytes]:
    bag = Bag(folder / "good", storage)
    with bag.writer:
        for number in range(2):
            bag.image(number)
            bag.pose(0.05 * number, "tracker", pose(number))
    return [next(folder.rglob(f"*{BAGS[storage]}")).read_bytes()]


# ---- what a network sends


def _stream(path: Path) -> None:
    """The bytes in pieces, as a network gives them; the same messages must come out whatever the pieces, and a bad one costs no other."""
    data = path.read_bytes()
    framer = Framer(2**20)
    step = 1 + len(data) // 7
    messages = [message for start in range(0, len(data), step) for message in framer.feed(data[start : start + step])]
    assert [message.body for message in messages] == [message.body for message in Framer(2**20).feed(data)]
    assert framer.is_within in (True, False)
    for raw in messages:
        with contextlib.suppress(LiveMessageError):
            _decoded(raw)


def _messages(path: Path) -> None:
    for raw in Framer(2**20).feed(path.read_bytes()):
        _decoded(raw)


def _decoded(raw) -> None:
    for message in decode(raw):
        assert np.isfinite(message.timestamp)
        if isinstance(message, ImageMessage):
            assert message.image.ndim == 2
            assert message.image.size > 0
            assert message.image.dtype.isnative
        if isinstance(message, TransformMessage):
            assert message.matrix.shape == (4, 4)


def _sent(_folder: Path) -> list[bytes]:
    made = []
    for version, told in ((1, {}), (2, metadata(Probe="OK"))):
        for image in (picture(), picture(dtype="i2"), np.zeros((1, 2, 3, 3), np.uint8)):
            made.append(image_bytes(image, version=version, metadata=told))
        made.append(transform_bytes(version=version, metadata=told))
    tool = struct.pack(">20sBB12f", b"ProbeToTracker", 1, 0, *range(12))
    return [*made, encode_message("TDATA", "Tracker", 1.0, tool * 2), encode_status("", 0.0, text="fine", version=2)]


def _streams(folder: Path) -> list[bytes]:
    sent = _sent(folder)
    return [b"".join(sent), sent[0] + sent[3], sent[0][:70] + sent[0] + sent[1]]


def _with_checksum(message: bytes) -> bytes:
    """A message whose size and checksum are those of the body that it has."""
    body = message[HEADER_SIZE:]
    return message[:42] + len(body).to_bytes(8, "big") + crc64(body).to_bytes(8, "big") + body if body else message


TARGETS = {
    target.name: target
    for target in (
        Target("metaimage", "sweep.mha", _sequence, _metaimages),
        Target("metaimage-deflated", "sweep.mha", _sequence, _metaimages, _deflated),
        Target("metaimage-detached", "sweep.mhd", _sequence, _detached),
        Target("nrrd", "sweep.seq.nrrd", _sequence, _nrrds),
        Target("transforms", "move.seq.mha", _transform_sequence, _moves),
        Target("reconstruction", "sweep.mha", _reconstruction, _metaimages),
        Target("bundle", "sweep.mrb", _sequence, _scenes, _bundled),
        Target("arrays", "sweep.npz", _sequence, _arrays),
        *(Target(f"bag-{storage}", f"sweep{suffix}", _sequence, partial(_bags, storage)) for storage, suffix in BAGS.items()),
        *(
            Target(f"custusx{suffix}", f"US-Acq_1_20260101T120000_Probe{suffix}", _acquisition, partial(_acquisitions, suffix))
            for suffix in (".fts", ".fp", ".tp", ".tts", ".probedata.xml")
        ),
        Target("stream", "stream.igtl", _stream, _streams),
        Target("message", "message.igtl", _messages, _sent, _with_checksum),
    )
}
