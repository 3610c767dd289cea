"""Recording a stream so that a crash at any moment leaves a sequence file that can be read.

While it runs there are two files beside the one that was asked for, named after it::

    sweep.recording.mhd      a header of every frame so far, which grows
    sweep.recording.raw      the pixels, appended frame by frame

`read_sequence` opens ``sweep.recording.mhd`` at any time, also after the program was killed or the disk was full. Nothing in the two
files is ever changed, all is appended: of a frame first its pixels; then its lines, behind the header, the last of which says how many
frames there are. The field `UNFINISHED` tells the reader to look for them there. `finish` makes the file that was asked for, completely or
not at all, and only then removes the two.

Whose they are: the pixels are locked by the program that appends to them. Nobody else appends to the two, or removes them, and no file that
is there is replaced: a recording whose name is taken gets another one. Once their program has died they can be taken up.
"""

from __future__ import annotations

import errno
import itertools
import logging
import math
import os
import re
import shutil
from dataclasses import replace
from io import FileIO
from pathlib import Path

import numpy as np

from ...arrays import Numbers, NumberType
from ...errors import AIFReconError, SequenceFormatError
from ...geometry.transform_graph import TransformStatus
from ...io.disk.atomic import atomic_outputs, check_writable
from ...io.disk.locks import hold
from ...io.disk.workspace import workspace
from ...io.metafile.metafile import UNFINISHED
from ...io.sequence.fields import frame_entries
from ...io.sequence.files import read_sequence
from ...io.sequence.writer import check_sequence_name, checked, write_sequence
from ...message import Sentence, message_of
from ...progress import Progress
from ...recipe.recipe import LONGEST_GAP
from ...sweep.frames import FrameRecord, TrackedSequence
from ..pairing.synchronizer import LiveFrame

logger = logging.getLogger(__name__)

_FULL = {getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name)}
_FIRST_FRAME = "Seq_Frame0000_"
_SIZE, _LAST_LINE = b"DimSize = ", b"ElementDataFile = "
_WHOLE = re.compile(rb"^(DimSize = [0-9 ]+|ElementDataFile = .*)\n", re.MULTILINE)
"""Ends what is listed of a frame."""

GAP = "AIFRecon_gap"
"""Field of a frame before which nothing was recorded for so many s, as its program was lost."""

_PATIENCE = 2.0
"""s in which the lock of a program that was killed just now comes free."""


def growing_files(path: Path) -> tuple[Path, Path]:
    """Header and pixels of a recording to `path` while it runs."""
    header, pixels = (path.with_name(f"{path.name[: -len(path.suffix)]}.recording{suffix}") for suffix in (".mhd", ".raw"))
    return header, pixels


def _there(path: Path) -> list[Path]:
    """Files of a recording to `path` that are there, the finished ones first."""
    finished = [path, path.with_suffix(".raw")] if path.suffix.lower() == ".mhd" else [path]
    return [file for file in (*finished, *growing_files(path)) if os.path.lexists(file)]


def _free(path: Path) -> Path:
    """The path with the first number in its name that no recording has."""
    ending = re.search(r"(\.(igs|seq))?\.[^.]*$", path.name, re.IGNORECASE)
    start = ending.start() if ending else len(path.name)
    named = (path.with_name(f"{path.name[:start]}-{number}{path.name[start:]}") for number in itertools.count(2))
    return next(path for path in named if not _there(path))


def _shows_probe(record: FrameRecord) -> bool:
    return any(sample.status is TransformStatus.OK for sample in record.transforms.values())


class Recorder:
    """Appends live frames to a sequence file, tracked or not, with their transforms, statuses and times.

    Raises OutputError when nothing can be written there.

    Parameters
    ----------
    path : str or Path
        Where the finished sequence goes: .mha or .nrrd, for which the pixels are copied in the end, or .mhd, for which they are not.
        Where a recording of that name is there, finished or not, a number is added, and `note` says so.
    takes_up : bool
        Go on behind the frames of the unfinished recording of that name, if there is one that can be read and whose program has ended:
        `frames` counts them.

    Notes
    -----
    A failure of the disk stops the recording, not its caller: `failure` then says what happened and where the frames are that were kept.
    A frame whose image differs in size or type from the first is recorded without its image, and counted in `without_image`. But before
    the probe was seen, images may change as they like: what was recorded until then becomes a recording of its own.
    """

    def __init__(self, path: str | Path, takes_up: bool = False):
        self._asked = self.path = Path(path)
        check_sequence_name(self.path)
        self.header_path, self._pixels_path = growing_files(self.path)
        self.note: str | None = None
        self._cause: str | None = None
        self._is_finished = False
        self._begin()
        if not (takes_up and self._take_up()):
            self._find_name()
            check_writable(self.path)

    def _begin(self) -> None:
        """Begin with nothing."""
        self.frames = self.without_image = 0
        self._was_seen = False
        self._taken_up_at: float | None = None
        self._shape: tuple[int, ...] = (0, 0)
        self._dtype: NumberType = np.dtype(np.uint8)
        self._pixels: FileIO | None = None
        self._header: FileIO | None = None
        self._listed = 0

    def _find_name(self) -> None:
        """Use the name that was asked for, or one with a number where a recording of that name is there."""
        there, self.note = _there(self._asked), None
        self.path = _free(self._asked) if there else self._asked
        if there:
            what = "there, of a recording that is not finished" if there[0] in growing_files(self._asked) else "there already"
            self.note = f"{there[0].name} is {what}, so this scan is recorded to {self.path.name}."
        self.header_path, self._pixels_path = growing_files(self.path)

    @property
    def failure(self) -> str | None:
        """Why the recording stopped, and where its frames are; None while all is well."""
        if self._cause is None:
            return None
        place = self.path if self._is_finished else self.header_path
        kept = f"{self.frames} frames are kept in {place}." if self.frames else "No frame was recorded."
        return Sentence(f"Recording stopped: {self._cause} {kept}", message_of(self._cause))

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
                self._set_aside()
            self._append(frame.image, self._after_gap(frame.record))
            self._was_seen = self._was_seen or _shows_probe(frame.record)
        except (AIFReconError, OSError) as error:
            self._fail(error)

    def _after_gap(self, record: FrameRecord) -> FrameRecord:
        """The first frame behind those that were taken up says how long nothing was recorded, as `note` does."""
        before, self._taken_up_at = self._taken_up_at, None
        if before is None or record.timestamp is None or record.timestamp - before <= LONGEST_GAP:
            return record
        missing = record.timestamp - before
        self.note = f"{missing:.1f} s of the scan are missing after {before:.2f} s: the program that recorded was lost."
        return replace(record, fields={**record.fields, GAP: f"{missing:.3f}"})

    def finish(self, progress: Progress | None = None) -> Path | None:
        """Make the file that was asked for; the answer is its path, or None when there is no frame.

        None also where it cannot be made: the recording then stays in the files beside it, and `failure` names them.
        """
        try:
            if not self.frames:
                self._remove()
                return None
            self._make(progress)
        except (AIFReconError, OSError) as error:
            self._fail(error)
            return None
        finally:
            self.close()
        self._is_finished = True
        return self.path

    def _make(self, progress: Progress | None = None) -> None:
        """Make the finished file, then remove the growing ones."""
        there = [file for file in _there(self.path) if file not in (self.header_path, self._pixels_path)]
        if there:
            self.path = _free(self._asked)
            self.note = f"{there[0].name} came about during the scan, which is therefore recorded to {self.path.name}."
        if self.path.suffix.lower() == ".mhd":
            self._finish_in_place()
        else:
            recorded = read_sequence(self.header_path)
            fields = {key: value for key, value in recorded.fields.items() if key != UNFINISHED}
            write_sequence(TrackedSequence(recorded.images, recorded.records, fields), self.path, compress=False, progress=progress)
        self._remove()

    def close(self) -> None:
        """Close the files as they are; the recording stays unfinished, and readable, and can be taken up."""
        for file in (self._pixels, self._header):
            if file is not None:
                file.close()

    def _fail(self, error: AIFReconError | OSError) -> None:
        cause = "the disk is full" if getattr(error, "errno", None) in _FULL else getattr(error, "strerror", None) or error
        self._cause = message_of(error) if isinstance(error, AIFReconError) else f"{cause}."
        logger.exception("%s", self.failure)

    def _differs(self, image: Numbers) -> bool:
        return image.shape != self._shape or image.dtype != self._dtype

    def _append(self, image: Numbers, record: FrameRecord) -> None:
        """Add a frame, without its image where that is unlike the first one."""
        if not self.frames:
            self._shape, self._dtype = image.shape, image.dtype
        is_missing = self._differs(image)
        pixels = np.zeros(self._shape, self._dtype) if is_missing else image
        record = replace(record, image_status=TransformStatus.INVALID) if is_missing else record
        entries = [(key.removeprefix(_FIRST_FRAME), value) for key, value in checked(frame_entries([record]))]
        if self._pixels is None:
            self._pixels = self._own_pixels()
        self._write(self._pixels, np.ascontiguousarray(pixels, dtype=self._dtype.newbyteorder("<")).data)
        if self._header is None:
            self._header = self._begin_header(pixels, record)
        else:
            lines = "".join(f"Seq_Frame{self.frames:04d}_{name} = {value}\n" for name, value in entries)
            self._write(self._header, memoryview(lines.encode("utf-8", errors="surrogateescape") + self._size(self.frames + 1)))
        self._listed = self._header.tell()
        self.frames += 1
        self.without_image += is_missing

    def _own_pixels(self) -> FileIO:
        """The file of pixels, which nobody else has, under a name that is free by now."""
        while True:
            try:
                # Without buffers of our own, what was written survives the program
                pixels = open(self._pixels_path, "xb", buffering=0)  # noqa: SIM115 (closed in close)
            except FileExistsError:
                self._find_name()
            else:
                hold(pixels.fileno())
                return pixels

    def _take_up(self) -> bool:
        """Go on behind the frames of the unfinished recording; False where there is none, or it cannot be read or is somebody's."""
        if not self.header_path.exists():
            return False
        try:
            self._pixels = open(self._pixels_path, "r+b", buffering=0)  # noqa: SIM115 (closed in close)
            hold(self._pixels.fileno(), _PATIENCE)
            self._go_on(self._pixels)
        except (AIFReconError, OSError) as error:
            logger.warning("%s is kept, but not taken up: %s", self.header_path, message_of(error))
            self.close()
            self._begin()
            return False
        return True

    def _go_on(self, pixels: FileIO) -> None:
        """Find where the next frame belongs, and cut off what was begun of one."""
        recorded = read_sequence(self.header_path)
        if UNFINISHED not in recorded.fields or os.fstat(pixels.fileno()).st_nlink > 1:
            # Its program died in the middle of finishing: the finished file has the same pixels
            raise SequenceFormatError(f"{self.header_path}: this recording is finished.")
        self._shape, self._dtype = recorded.images.shape[1:], np.dtype(recorded.images.dtype)
        self.without_image = sum(record.image_status is not TransformStatus.OK for record in recorded.records)
        self._was_seen = any(_shows_probe(record) for record in recorded.records)
        self._taken_up_at = recorded.records[-1].timestamp
        self.frames = len(recorded)
        self._header = open(self.header_path, "r+b", buffering=0)  # noqa: SIM115 (closed in close)
        self._listed = max(line.end() for line in _WHOLE.finditer(self.header_path.read_bytes()))
        for file, size in ((self._header, self._listed), (pixels, math.prod(self._shape) * self._dtype.itemsize * self.frames)):
            file.truncate(size)
            file.seek(size)

    def _begin_header(self, image: Numbers, record: FrameRecord) -> FileIO:
        """The header of the first frame, as the sequence writer makes it."""
        with workspace(self.path.absolute().parent) as folder:
            path = folder / self.header_path.name
            write_sequence(TrackedSequence(image[None], [record], {UNFINISHED: "True"}), path, compress=False)
            os.replace(path, self.header_path)
        return open(self.header_path, "ab", buffering=0)

    def _size(self, frames: int) -> bytes:
        """The line that says so many frames."""
        return _SIZE + f"{self._shape[1]} {self._shape[0]} {frames}\n".encode()

    def _set_aside(self) -> None:
        """Finish what was recorded under a name of its own, and begin anew."""
        path, self.path = self.path, _free(self._asked)
        self._make()
        self.note = f"{self.note or ''} The images changed before the probe was seen; those before are in {self.path.name}.".lstrip()
        self.path = path
        self._begin()

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
            lines = self.header_path.read_bytes()[: self._listed].splitlines(keepends=True)
            kept = [line for line in lines if not line.startswith((_SIZE, _LAST_LINE, UNFINISHED.encode()))]
            place = next(number for number, line in enumerate(lines) if line.startswith(_SIZE))
            kept.insert(place, self._size(self.frames))
            header.write_bytes(b"".join(kept) + _LAST_LINE + f"{pixels.name}\n".encode())

    def _remove(self) -> None:
        """Remove the growing files, if they are ours."""
        self.close()
        if self._pixels is not None:
            for path in (self.header_path, self._pixels_path):
                path.unlink(missing_ok=True)
