"""Recording a stream so that a crash at any moment leaves a sequence file that can be read.

While it runs there are three files beside the one that was asked for, named after it::

    sweep.recording.mhd      a complete header of all frames but the last few; replaced as a whole about once a second
    sweep.recording.raw      the pixels, appended frame by frame
    sweep.recording.fields   the lines of the header that belong to frames, appended frame by frame

`read_sequence` opens ``sweep.recording.mhd`` at any time. Its field `UNFINISHED` tells the reader that the pixels may go on behind the
frames that the header lists. When the program is killed, at most the frames since the header was last replaced are missing from it
(their pixels and lines are in the other two files). `finish` makes the file that was asked for, completely or not at all, and only then
removes the three.
"""

from __future__ import annotations

import errno
import logging
import os
import time
from io import FileIO
from pathlib import Path

import numpy as np

from ...arrays import Numbers, NumberType
from ...errors import AIFReconError, OutputError
from ...geometry.transform_graph import TransformStatus
from ...io.disk.atomic import atomic_outputs, check_writable
from ...io.disk.workspace import workspace
from ...io.metafile.metafile import UNFINISHED
from ...io.sequence.fields import frame_entries
from ...io.sequence.files import read_sequence
from ...io.sequence.writer import check_sequence_name, checked, write_sequence
from ...message import Message, said
from ...progress import Progress
from ...sweep.frames import FrameRecord, TrackedSequence
from ..pairing.synchronizer import LiveFrame

logger = logging.getLogger(__name__)

REFRESH = 1.0
"""s between two headers at least."""

REFRESH_BY_COST = 20.0
"""Time between two headers at least, by the time that the last one took to write.

The header of an hour's frames is large, and appending must not wait for it.
"""

_FULL = {getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name)}
_FIRST_FRAME = "Seq_Frame0000_"
_PIECE = 2**20


class Recorder:
    """Appends live frames to a sequence file, tracked or not, with their transforms, statuses and times.

    Parameters
    ----------
    path : str or Path
        Where the finished sequence goes: .mha or .nrrd, for which the pixels are copied in the end, or .mhd, for which they are not.

    Raises
    ------
    OutputError
        When nothing can be written there, or an unfinished recording of that name is there.

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
        stem = self.path.name[: -len(self.path.suffix)]
        self.header_path, self._pixels_path, self._fields_path = (
            self.path.with_name(f"{stem}.recording{suffix}") for suffix in (".mhd", ".raw", ".fields")
        )
        left = next((path for path in (self.header_path, self._pixels_path, self._fields_path) if path.exists()), None)
        if left is not None:
            raise OutputError(
                "Cannot record to {path}: {left} is there, from a recording that was not finished. "
                "Keep {file} and its .raw file under another name, or choose one.",
                path=self.path,
                left=left.name,
                file=self.header_path.name,
            )
        self.frames = self.without_image = 0
        self._unseen: list[FrameRecord] | None = []
        self.failure: str | None = None
        self._shape: tuple[int, ...] = (0, 0)
        self._dtype: NumberType = np.dtype(np.uint8)
        self._header: tuple[list[str], list[str]] = ([], [])
        self._pixels: FileIO | None = None
        self._fields: FileIO | None = None
        self._fields_length = 0
        self._listed = 0
        self._refreshed = 0.0
        self._cost = 0.0

    def append(self, frame: LiveFrame) -> None:
        """Record a frame. Does nothing after a failure, or with a frame that has no image."""
        image = frame.image
        if self.failure is not None or image is None:
            return
        try:
            if self._pixels is None or self._fields is None:
                self._pixels, self._fields = self._start(image)
            elif self._unseen and self._differs(image):
                self._pixels, self._fields = self._start_anew(image, self._unseen)
            self._append(image, frame.record, self._pixels, self._fields)
            self._remember(frame.record)
            if time.monotonic() - self._refreshed >= max(REFRESH, REFRESH_BY_COST * self._cost):
                self.refresh()
        except AIFReconError as error:
            self._stop(said(error))
        except OSError as error:
            self._fail(error)

    def refresh(self) -> None:
        """List every frame that was appended in the header on the disk."""
        if self._listed == self.frames:
            return
        started = time.monotonic()
        try:
            self._write_header(self.header_path.with_name(self.header_path.name + ".new"), self.header_path)
            self._listed = self.frames
        except PermissionError:
            # On Windows, while somebody reads the older header; the next one replaces it
            if not self.header_path.exists():
                raise
        self._refreshed = time.monotonic()
        self._cost = self._refreshed - started

    def finish(self, progress: Progress | None = None) -> Path | None:
        """Make the file that was asked for; the answer is its path, or None when there is no frame.

        Raises
        ------
        OutputError
            When it cannot be made. The recording then stays in the files beside it, and the message names them.
        """
        try:
            if self._pixels is not None:
                self.refresh()
        except OSError as error:
            self._fail(error)
        self.close()
        if not self._listed:
            self._remove()
            return None
        try:
            if self.path.suffix.lower() != ".mhd" or not self._finish_in_place():
                self._copy(progress)
        except OSError as error:
            raise OutputError(
                "{problem} The recording is kept in {header} and its .raw file, and can be read there.",
                problem=error,
                header=self.header_path,
            ) from error
        self._remove()
        return self.path

    def close(self) -> None:
        """Close the files as they are; the recording stays unfinished, and readable."""
        for file in (self._pixels, self._fields):
            if file is not None:
                file.close()

    @property
    def loss(self) -> Message | None:
        """How many frames are recorded without their image, and why; None where all have theirs."""
        if not self.without_image:
            return None
        return Message(
            "{count} of {frames} recorded frames are without their image, which was not of the size and type of the others "
            "({columns} x {rows} pixels, {dtype}). Do not change the scanner's mode in the middle of a scan.",
            count=self.without_image,
            frames=self.frames,
            columns=self._shape[1],
            rows=self._shape[0],
            dtype=str(self._dtype),
        )

    @property
    def _frame_bytes(self) -> int:
        return self._shape[0] * self._shape[1] * self._dtype.itemsize

    def _start(self, image: Numbers) -> tuple[FileIO, FileIO]:
        """Create the files, and the header around the lines of the frames as the sequence writer makes it."""
        self._shape, self._dtype = image.shape, image.dtype
        with workspace(self.path.absolute().parent) as folder:
            path = folder / "header.mhd"
            write_sequence(TrackedSequence(image[None], [LiveFrame(image, None).record], {UNFINISHED: "True"}), path, compress=False)
            lines = path.read_text("utf-8").splitlines()
        place = lines.index(next(line for line in lines if line.startswith(_FIRST_FRAME)))
        self._header = (lines[:place], [line for line in lines[place:] if not line.startswith(_FIRST_FRAME)])
        # Without buffers of our own, what was written survives the program
        self._pixels = pixels = open(self._pixels_path, "xb", buffering=0)  # noqa: SIM115 (closed in close)
        return pixels, open(self._fields_path, "xb", buffering=0)

    def _remember(self, record: FrameRecord) -> None:
        """Until the probe is seen, what the frames had beside their images; then nothing."""
        if self._unseen is not None:
            seen = any(sample.status is TransformStatus.OK for sample in record.transforms.values())
            if seen:
                self._unseen = None
            else:
                self._unseen.append(record)

    def _start_anew(self, image: Numbers, before: list[FrameRecord]) -> tuple[FileIO, FileIO]:
        """Files for images of another size or type, with the frames so far, without their images."""
        self.close()
        self._remove()
        self.frames = self.without_image = self._listed = self._fields_length = 0
        self._refreshed = 0.0
        pixels, fields = self._start(image)
        for record in before:
            self._append(None, record, pixels, fields)
        return pixels, fields

    def _differs(self, image: Numbers) -> bool:
        return image.shape != self._shape or image.dtype != self._dtype

    def _append(self, image: Numbers | None, record: FrameRecord, pixels: FileIO, fields: FileIO) -> None:
        status = None
        if image is None or self._differs(image):
            image, status = np.zeros(self._shape, self._dtype), TransformStatus.INVALID
            self.without_image += 1
        lines = []
        for key, value in checked(frame_entries([record])):
            name = key.removeprefix(_FIRST_FRAME)
            text = status.value if status is not None and name == "ImageStatus" else value
            lines.append(f"Seq_Frame{self.frames:04d}_{name} = {text}\n")
        self._write(pixels, np.ascontiguousarray(image, dtype=self._dtype.newbyteorder("<")).data)
        written = "".join(lines).encode("utf-8", errors="surrogateescape")
        self._write(fields, memoryview(written))
        self._fields_length += len(written)
        self.frames += 1

    @staticmethod
    def _write(file: FileIO, data: memoryview) -> None:
        rest = data.cast("B")
        while rest:
            rest = rest[file.write(rest) :]

    def _write_header(self, temporary: Path, path: Path, data_file: str | None = None) -> None:
        """A header of all frames, in the place of an older one; `data_file` is that of a finished recording."""
        columns, rows = self._shape[1], self._shape[0]
        changes = {"DimSize": f"{columns} {rows} {self.frames}", "ElementDataFile": data_file or self._pixels_path.name}
        begin, end = (
            [f"{key} = {changes.get(key, value)}\n" for key, value in (line.split(" = ", 1) for line in lines)] for lines in self._header
        )
        if data_file is not None:
            begin, end = ([line for line in lines if not line.startswith(UNFINISHED)] for lines in (begin, end))
        try:
            with open(temporary, "wb") as file, open(self._fields_path, "rb") as lines:
                file.write("".join(begin).encode())
                left = self._fields_length
                while left and (piece := lines.read(min(left, _PIECE))):
                    file.write(piece)
                    left -= len(piece)
                file.write("".join(end).encode())
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)

    def _finish_in_place(self) -> bool:
        """Give pixels and header their final names; False where the file system cannot give a file two names for a moment."""
        target = self.path.with_suffix(".raw")
        with open(self._pixels_path, "rb+") as file:
            file.truncate(self.frames * self._frame_bytes)
        try:
            with atomic_outputs(target, self.path) as (temporary_data, temporary):
                # Two names until the header is there: at no moment is the recording without one that fits
                _give_second_name(self._pixels_path, temporary_data)
                self._write_header(temporary.with_name("header.new"), temporary, target.name)
        except _OneNameOnly:
            return False
        return True

    def _copy(self, progress: Progress | None) -> None:
        recorded = read_sequence(self.header_path)
        fields = {key: value for key, value in recorded.fields.items() if key != UNFINISHED}
        write_sequence(TrackedSequence(recorded.images, recorded.records, fields), self.path, compress=False, progress=progress)

    def _fail(self, error: OSError) -> None:
        try:
            if self._fields is not None:
                # Room for the last header
                os.truncate(self._pixels_path, self.frames * self._frame_bytes)
                self.refresh()
        except OSError:
            self.frames = self._listed
        cause = Message("the disk is full") if error.errno in _FULL else (error.strerror or str(error))
        self._stop(Message("{cause}.", cause=cause))

    def _stop(self, cause: Message) -> None:
        if self.frames:
            self.failure = Message(
                "Recording stopped: {cause} {count} frames are kept in {path}.", cause=cause, count=self.frames, path=self.header_path
            )
        else:
            self.failure = Message("Recording stopped: {cause} No frame was recorded.", cause=cause)
        logger.error("%s", self.failure, exc_info=True)
        self.close()

    def _remove(self) -> None:
        for path in (self.header_path, self._pixels_path, self._fields_path):
            path.unlink(missing_ok=True)


class _OneNameOnly(Exception):
    """The file system does not give a file two names."""


def _give_second_name(path: Path, other: Path) -> None:
    try:
        os.link(path, other)
    except OSError as error:
        raise _OneNameOnly from error
