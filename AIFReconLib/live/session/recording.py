"""Recording a stream so that a crash at any moment leaves a sequence file that can be read.

While it runs there are three files beside the one that was asked for, named after it::

    sweep.recording.mhd      a complete header of all frames but the last few; replaced as a whole about once a second
    sweep.recording.raw      the pixels, appended frame by frame
    sweep.recording.fields   the header as it grows, frame by frame, but for the number of frames

`read_sequence` opens ``sweep.recording.mhd`` at any time. Its field `UNFINISHED` tells the reader that the pixels may go on behind the
frames that the header lists. When the program is killed, at most the frames since the header was last replaced are missing from it
(their pixels and lines are in the other two files). When the disk is full, the growing header is completed where it is, which takes
no room, and becomes ``sweep.recording.mhd``. `finish` makes the file that was asked for, completely or not at all, and only then removes
the three.
"""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import shutil
import threading
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
from ...machine.threads import start
from ...message import said
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

LONGEST_WAIT = 0.2
"""s that a frame may wait for a header."""

_FULL = {getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name)}
_FIRST_FRAME = "Seq_Frame0000_"
_SIZE = "DimSize = "
_SIZE_LETTERS = 40
"""Place for three numbers, which are known last and written first."""


def _write(file: FileIO, data: memoryview) -> None:
    rest = data.cast("B")
    while rest:
        rest = rest[file.write(rest) :]


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
        left = next((path for path in (self.header_path, self._pixels_path, self._fields_path) if os.path.lexists(path)), None)
        if left is not None:
            raise OutputError(
                f"Cannot record to {self.path}: {left.name} is there, from a recording that was not finished. Keep "
                f"{self.header_path.name} and its .raw file under another name, or choose one."
            )
        self.frames = self.without_image = 0
        self._unseen = True
        self.failure: str | None = None
        self._shape: tuple[int, ...] = (0, 0)
        self._dtype: NumberType = np.dtype(np.uint8)
        self._begin: list[str] = []
        self._pixels: FileIO | None = None
        self._fields: FileIO | None = None
        self._lister: threading.Thread | None = None
        self._list_error: OSError | None = None
        self._growing = self._fields_path
        self._fields_length = self._listed_length = 0
        self._listed = 0
        self._refreshed = 0.0
        self._cost = 0.0

    _write = staticmethod(_write)

    def append(self, frame: LiveFrame) -> None:
        """Record a frame. Does nothing after a failure, or with a frame that has no image."""
        image = frame.image
        if self.failure is not None or image is None:
            return
        try:
            if self._pixels is None or self._fields is None:
                self._pixels, self._fields = self._start(image)
            elif self._unseen and self._differs(image):
                self._pixels, self._fields = self._start_anew(image)
            self._append(image, frame.record, self._pixels, self._fields)
            self._unseen &= all(sample.status is not TransformStatus.OK for sample in frame.record.transforms.values())
            self._refresh_when_due()
        except AIFReconError as error:
            self._stop(said(error))
        except OSError as error:
            self._fail(error)

    def refresh(self) -> None:
        """List every frame that was appended in the header on the disk."""
        self._wait_for_header()
        if self._listed != self.frames:
            self._list(self.frames, self._fields_length)

    def _refresh_when_due(self) -> None:
        """List the frames so far where it is time; on a thread of its own where that takes long, so that no frame has to wait."""
        if self._lister is not None and self._lister.is_alive():
            return
        if time.monotonic() - self._refreshed < max(REFRESH, REFRESH_BY_COST * self._cost):
            return
        self._wait_for_header()
        self._lister = threading.Thread(
            target=self._list_beside, args=(self.frames, self._fields_length), name="listing the recording", daemon=True
        )
        if self._cost < LONGEST_WAIT or not start(self._lister):
            self._lister = None
            self.refresh()

    def _list_beside(self, frames: int, length: int) -> None:
        try:
            self._list(frames, length)
        except OSError as error:
            self._list_error = error

    def _wait_for_header(self) -> None:
        """Wait until no other thread writes the header, and raise what it met."""
        if self._lister is not None:
            self._lister.join()
        error, self._lister, self._list_error = self._list_error, None, None
        if error is not None:
            raise error

    def _list(self, frames: int, length: int) -> None:
        """Replace the header by one of so many frames, whose lines end at byte `length`."""
        started = time.monotonic()
        try:
            self._write_header(self.header_path.with_name(self.header_path.name + ".new"), self.header_path, self._end, frames, length)
            self._listed, self._listed_length = frames, length
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
                self._pixels.truncate(self.frames * self._frame_bytes)
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
            raise OutputError(f"{error} The recording is kept in {self.header_path} and its .raw file, and can be read there.") from error
        self._remove()
        if self.failure is not None:
            self._say_where(self.path)
        return self.path

    def close(self) -> None:
        """Close the files as they are; the recording stays unfinished, and readable."""
        with contextlib.suppress(OSError):
            self._wait_for_header()
        for file in (self._pixels, self._fields):
            if file is not None:
                file.close()

    @property
    def loss(self) -> str | None:
        """How many frames are recorded without their image, and why; None where all have theirs."""
        if not self.without_image:
            return None
        return (
            f"{self.without_image} of {self.frames} recorded frames are without their image, which was not of the size and type of the "
            f"others ({self._shape[1]} x {self._shape[0]} pixels, {self._dtype!s}). Do not change the scanner's mode in the middle "
            "of a scan."
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
        self._begin = [line for line in lines[:-1] if not line.startswith((_FIRST_FRAME, UNFINISHED))]
        # Without buffers of our own, what was written survives the program
        self._pixels = pixels = open(self._pixels_path, "xb", buffering=0)  # noqa: SIM115 (closed in close)
        self._fields = fields = open(self._fields_path, "xb", buffering=0)  # noqa: SIM115 (closed in close)
        begin = self._begin_of(0)
        _write(fields, memoryview(begin + self._end))
        self._fields_length = len(begin)
        return pixels, fields

    def _start_anew(self, image: Numbers) -> tuple[FileIO, FileIO]:
        """Files for images of another size or type, with the frames so far, without their images."""
        self.refresh()
        before = list(read_sequence(self.header_path).records)
        self.close()
        self._remove()
        self.frames = self.without_image = self._listed = 0
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
        # With the end behind it, which the next frame takes the place of: so there is room for it on a disk that is full
        fields.seek(self._fields_length)
        self._write(fields, memoryview(written + self._end))
        self._fields_length += len(written)
        self.frames += 1

    @property
    def _end(self) -> bytes:
        """The last lines of a header that is not finished."""
        return f"{UNFINISHED} = True\nElementDataFile = {self._pixels_path.name}\n".encode()

    def _begin_of(self, frames: int) -> bytes:
        """The lines before those of the frames, as long for any number of these."""
        size = f"{self._shape[1]} {self._shape[0]} {frames}".ljust(_SIZE_LETTERS)
        return "".join(f"{_SIZE}{size}\n" if line.startswith(_SIZE) else f"{line}\n" for line in self._begin).encode()

    def _write_header(self, temporary: Path, path: Path, end: bytes, frames: int, length: int) -> None:
        """A header of so many frames, whose lines end at byte `length`, with these last lines, in the place of an older one."""
        begin = self._begin_of(frames)
        temporary.unlink(missing_ok=True)
        try:
            # Made anew, whatever lies there: a link would lead to another file
            with open(temporary, "xb") as file, open(self._growing, "rb") as lines:
                file.write(begin)
                lines.seek(len(begin))
                shutil.copyfileobj(lines, file)
                file.truncate(length)
                file.seek(length)
                file.write(end)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)

    def _finish_in_place(self) -> bool:
        """Give pixels and header their final names; False where the file system cannot give a file two names for a moment."""
        target = self.path.with_suffix(".raw")
        try:
            with atomic_outputs(target, self.path) as (temporary_data, temporary):
                # Two names until the header is there: at no moment is the recording without one that fits
                _give_second_name(self._pixels_path, temporary_data)
                end = f"ElementDataFile = {target.name}\n".encode()
                self._write_header(temporary.with_name("header.new"), temporary, end, self.frames, self._fields_length)
        except _OneNameOnly:
            return False
        return True

    def _copy(self, progress: Progress | None) -> None:
        recorded = read_sequence(self.header_path)
        fields = {key: value for key, value in recorded.fields.items() if key != UNFINISHED}
        write_sequence(TrackedSequence(recorded.images, recorded.records, fields), self.path, compress=False, progress=progress)

    def _fail(self, error: OSError) -> None:
        with contextlib.suppress(OSError):
            self._wait_for_header()
        try:
            if self._fields is not None and not self._fields.closed:
                self._complete(self._fields)
        except OSError:
            self.frames, self._fields_length = self._listed, self._listed_length
        self._growing = self.header_path
        cause = "the disk is full" if error.errno in _FULL else (error.strerror or str(error))
        self._stop(f"{cause}.")

    def _complete(self, fields: FileIO) -> None:
        """Make the growing header the one of all frames, which takes no room on the disk."""
        fields.seek(self._fields_length)
        _write(fields, memoryview(self._end))
        fields.truncate()
        fields.seek(0)
        _write(fields, memoryview(self._begin_of(self.frames)))
        fields.close()
        os.replace(self._fields_path, self.header_path)
        self._listed = self.frames

    def _stop(self, cause: str) -> None:
        self._cause = cause
        self._say_where(self.header_path)
        logger.error("%s", self.failure, exc_info=True)

    def _say_where(self, path: Path) -> None:
        """Say why the recording stopped, and where its frames are now."""
        if self.frames:
            self.failure = f"Recording stopped: {self._cause} {self.frames} frames are kept in {path}."
        else:
            self.failure = f"Recording stopped: {self._cause} No frame was recorded."

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
