"""Recording a stream so that a crash at any moment leaves a sequence file that can be read.

While it runs there are two files beside the one that was asked for, named after it::

    sweep.recording.mhd      a header of every frame so far, which grows
    sweep.recording.raw      the pixels, appended frame by frame

`read_sequence` opens ``sweep.recording.mhd`` at any time, also after the program was killed or the disk was full. A frame is added in
an order that allows that: its pixels; behind the last line of the header, where nobody reads any more, its lines and that line again; the
number of frames; and at last one byte, which makes the older last line a field. The field `UNFINISHED` tells the reader that the
pixels may go on behind the frames that the header lists. `finish` makes the file that was asked for, completely or not at all, and only
then removes the two.
"""

from __future__ import annotations

import errno
import logging
import os
import shutil
from io import FileIO
from pathlib import Path

import numpy as np

from ...arrays import Numbers, NumberType
from ...errors import AIFReconError, OutputError
from ...geometry.transform_graph import TransformStatus
from ...io.disk.atomic import atomic_outputs, check_writable
from ...io.disk.workspace import workspace
from ...io.metafile.metafile import FORMER_LAST_LINE, UNFINISHED
from ...io.sequence.fields import frame_entries
from ...io.sequence.files import read_sequence
from ...io.sequence.writer import check_sequence_name, checked, write_sequence
from ...message import Sentence, said
from ...progress import Progress
from ...sweep.frames import FrameRecord, TrackedSequence
from ..pairing.synchronizer import LiveFrame

logger = logging.getLogger(__name__)

_FULL = {getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name)}
_FIRST_FRAME = "Seq_Frame0000_"
_SIZE = "DimSize = "
_SIZE_LETTERS = 40
"""Room for three numbers, the last of which grows."""

_LAST_LINE = b"ElementDataFile"


def growing_files(path: Path) -> tuple[Path, Path]:
    """Header and pixels of a recording to `path` while it runs."""
    header, pixels = (path.with_name(f"{path.name[: -len(path.suffix)]}.recording{suffix}") for suffix in (".mhd", ".raw"))
    return header, pixels


class Recorder:
    """Appends live frames to a sequence file, tracked or not, with their transforms, statuses and times.

    Raises OutputError when nothing can be written there, or an unfinished recording of that name is there.

    Parameters
    ----------
    path : str or Path
        Where the finished sequence goes: .mha or .nrrd, for which the pixels are copied in the end, or .mhd, for which they are not.

    Notes
    -----
    A failure of the disk stops the recording, not its caller: `failure` then says what happened and where the frames are that were kept.
    A frame whose image differs in size or type from the first is recorded without its image, and counted in `without_image`. But before
    the probe was seen, images may change as they like: then the new ones are recorded, and it is those before that lose theirs.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        check_sequence_name(self.path)
        check_writable(self.path)
        self.header_path, self._pixels_path = growing_files(self.path)
        left = next((path for path in (self.header_path, self._pixels_path) if os.path.lexists(path)), None)
        if left is not None:
            raise OutputError(
                f"Cannot record to {self.path}: {left.name} is there, from a recording that was not finished. Keep "
                f"{self.header_path.name} and its .raw file under another name, or choose one."
            )
        self.frames = self.without_image = 0
        self._was_seen = False
        self._cause: str | None = None
        self._frames_are_in = self.header_path
        self._shape: tuple[int, ...] = (0, 0)
        self._dtype: NumberType = np.dtype(np.uint8)
        self._pixels: FileIO | None = None
        self._header: FileIO | None = None
        self._size_at = self._end_at = 0

    @property
    def failure(self) -> str | None:
        """Why the recording stopped, and where its frames are; None while all is well."""
        if self._cause is None:
            return None
        kept = f"{self.frames} frames are kept in {self._frames_are_in}." if self.frames else "No frame was recorded."
        return Sentence(f"Recording stopped: {self._cause} {kept}", self._cause)

    @property
    def loss(self) -> str | None:
        """How many frames are recorded without their image, and why; None where all have theirs."""
        if not self.without_image:
            return None
        return (
            f"{self.without_image} of {self.frames} recorded frames are without their image, which was not of the size and type of the "
            f"others ({self._shape[1]} x {self._shape[0]} pixels, {self._dtype}). Do not change the scanner's mode in the middle of a scan."
        )

    def append(self, frame: LiveFrame) -> None:
        """Record a frame. Does nothing after a failure, or with a frame that has no image."""
        if self._cause is not None or frame.image is None:
            return
        try:
            if self.frames and not self._was_seen and self._differs(frame.image):
                self._start_anew(frame.image)
            self._append(frame.image, frame.record)
            self._was_seen |= any(sample.status is TransformStatus.OK for sample in frame.record.transforms.values())
        except (AIFReconError, OSError) as error:
            self._fail(error)

    def finish(self, progress: Progress | None = None) -> Path | None:
        """Make the file that was asked for; the answer is its path, or None when there is no frame.

        None also where it cannot be made: the recording then stays in the files beside it, and `failure` names them.
        """
        self.close()
        try:
            if not self.frames:
                self._remove()
                return None
            if self.path.suffix.lower() == ".mhd":
                self._finish_in_place()
            else:
                recorded = read_sequence(self.header_path)
                fields = {key: value for key, value in recorded.fields.items() if key not in (UNFINISHED, FORMER_LAST_LINE)}
                write_sequence(TrackedSequence(recorded.images, recorded.records, fields), self.path, compress=False, progress=progress)
            self._remove()
        except (AIFReconError, OSError) as error:
            self._fail(error)
            return None
        self._frames_are_in = self.path
        return self.path

    def close(self) -> None:
        """Close the files as they are; the recording stays unfinished, and readable."""
        for file in (self._pixels, self._header):
            if file is not None:
                file.close()

    def _fail(self, error: AIFReconError | OSError) -> None:
        cause = "the disk is full" if getattr(error, "errno", None) in _FULL else getattr(error, "strerror", None) or error
        self._cause = said(error) if isinstance(error, AIFReconError) else f"{cause}."
        logger.exception("%s", self.failure)

    def _differs(self, image: Numbers) -> bool:
        return image.shape != self._shape or image.dtype != self._dtype

    def _append(self, image: Numbers | None, record: FrameRecord) -> None:
        """Add a frame; where `image` is None or unlike the first one, without an image."""
        if image is not None and not self.frames:
            self._shape, self._dtype = image.shape, image.dtype
        is_missing = image is None or self._differs(image)
        pixels = np.zeros(self._shape, self._dtype) if image is None or is_missing else image
        lines = []
        for key, value in checked(frame_entries([record])):
            name = key.removeprefix(_FIRST_FRAME)
            text = TransformStatus.INVALID.value if is_missing and name == "ImageStatus" else value
            lines.append(f"Seq_Frame{self.frames:04d}_{name} = {text}\n")
        written = "".join(lines).encode("utf-8", errors="surrogateescape")
        end = _LAST_LINE + f" = {self._pixels_path.name}\n".encode()
        # Without buffers of our own, what was written survives the program
        if self._pixels is None:
            self._pixels = open(self._pixels_path, "xb", buffering=0)  # noqa: SIM115 (closed in close)
        self._write(self._pixels, np.ascontiguousarray(pixels, dtype=self._dtype.newbyteorder("<")).data)
        if self._header is None:
            self._header = self._begin_header(pixels, written + end)
            self._end_at = self._header.seek(0, os.SEEK_END) - len(end)
        else:
            self._write_at(self._header, self._end_at + len(end), written + end)
            self._write_at(self._header, self._size_at, self._size(self.frames + 1))
            self._write_at(self._header, self._end_at, FORMER_LAST_LINE[:1].encode())
            self._end_at += len(end) + len(written)
        self.frames += 1
        self.without_image += is_missing

    def _begin_header(self, image: Numbers, lines_of_frame: bytes) -> FileIO:
        """The header of one frame as the sequence writer makes it, but for the lines of that frame."""
        with workspace(self.path.absolute().parent) as folder:
            path = folder / "header.mhd"
            write_sequence(TrackedSequence(image[None], [FrameRecord()], {UNFINISHED: "True"}), path, compress=False)
            lines = [line for line in path.read_bytes().splitlines(keepends=True)[:-1] if not line.startswith(_FIRST_FRAME.encode())]
            size = next(number for number, line in enumerate(lines) if line.startswith(_SIZE.encode()))
            self._size_at = sum(map(len, lines[:size]))
            lines[size] = self._size(1) + b"\n"
            path.write_bytes(b"".join(lines) + lines_of_frame)
            os.replace(path, self.header_path)
        return open(self.header_path, "r+b", buffering=0)

    def _size(self, frames: int) -> bytes:
        """The line of the header that says so many frames, as long for any number of them."""
        return _SIZE.encode() + f"{self._shape[1]} {self._shape[0]} {frames}".ljust(_SIZE_LETTERS).encode()

    def _start_anew(self, image: Numbers) -> None:
        """Record images of another size or type from now on, and the frames so far without theirs."""
        before = list(read_sequence(self.header_path).records)
        self.close()
        self._remove()
        self._pixels = self._header = None
        self._shape, self._dtype = image.shape, image.dtype
        self.frames = self.without_image = 0
        for record in before:
            self._append(None, record)

    def _write_at(self, file: FileIO, offset: int, data: bytes) -> None:
        file.seek(offset)
        self._write(file, memoryview(data))

    @staticmethod
    def _write(file: FileIO, data: memoryview) -> None:
        rest = data.cast("B")
        while rest:
            rest = rest[file.write(rest) :]

    def _finish_in_place(self) -> None:
        """Give pixels and header their final names."""
        target = self.path.with_suffix(".raw")
        os.truncate(self._pixels_path, self.frames * self._shape[0] * self._shape[1] * self._dtype.itemsize)
        with atomic_outputs(target, self.path) as (pixels, header):
            # Two names until the header is there: at no moment is the recording without one that fits
            try:
                os.link(self._pixels_path, pixels)
            except OSError:  # not every file system gives a file two names
                shutil.copyfile(self._pixels_path, pixels)
            with open(self.header_path, "rb") as growing, open(header, "wb") as file:
                for line in growing:
                    if line.startswith(_LAST_LINE):
                        break
                    if not line.startswith((FORMER_LAST_LINE.encode(), UNFINISHED.encode())):
                        file.write(self._size(self.frames) + b"\n" if line.startswith(_SIZE.encode()) else line)
                file.write(_LAST_LINE + f" = {target.name}\n".encode())

    def _remove(self) -> None:
        for path in (self.header_path, self._pixels_path):
            path.unlink(missing_ok=True)
