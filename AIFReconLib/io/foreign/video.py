"""Frames from a video, decoded forward by the ffmpeg program that the package imageio-ffmpeg brings along (or finds)."""

from __future__ import annotations

import os
import re
import subprocess
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import IO, cast

import numpy as np

from ...arrays import Bytes, Floats
from ...errors import FileFormatError
from ...message import one_line
from ..sequence.decoded_images import DecodedImages, library
from .images import ImportedImages, describe_stack

_ONLY_THIS_FILE = ("-protocol_whitelist", "file", "-format_whitelist", "mov,mp4,avi,matroska,webm,asf")
"""ffmpeg goes by the content, whatever the suffix: without this, a list of other files or addresses would be followed."""

_EVERY_FRAME = ("-map", "0:v:0", "-fps_mode", "passthrough")
"""The first video stream as it is: no frame repeated or dropped to make the rate constant."""


def open_video(path: Path) -> ImportedImages:
    """The frames of a video file as gray levels, with the time of each.

    Raises FileFormatError when it cannot be decoded.

    Notes
    -----
    Reading in order decodes each frame once; going back starts over. Videos are compressed with loss: gray levels are near those that
    the scanner showed, not equal to them.
    """
    try:
        program = library("imageio_ffmpeg", "Videos").get_ffmpeg_exe()
    except RuntimeError as error:
        raise FileFormatError(f"{path}: there is no ffmpeg program ({error}). Install it: pip install imageio-ffmpeg.") from None
    video = _Video(program, path)
    times = video.times()
    stack = DecodedImages(len(times), video.frame, lambda n: f"{path}, frame {n}")
    return ImportedImages(stack, describe_stack(len(times), "video frames", stack.shape[1:], stack.dtype), times=times)


class _Video:
    """One pass through a video, begun again when an earlier frame is asked for."""

    def __init__(self, program: str, path: Path):
        self._command = [program, "-v", "error", "-nostdin", *_ONLY_THIS_FILE, "-i", f"file:{os.path.realpath(path)}", *_EVERY_FRAME]
        self._path = path
        self._stream: IO[bytes] | None = None
        self._stop: Callable[[], object] | None = None
        self._next = 0

    def times(self) -> Floats:
        """Times of all frames in s, from a first pass that decodes them: headers guess."""
        try:
            done = subprocess.run(
                [*self._command, "-f", "framecrc", "-"],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                check=False,
                encoding="utf-8",
                errors="replace",
            )
        except OSError as error:
            raise self._failure(_shown(str(error))) from error
        base = re.search(r"^#tb 0: (\d+)/(\d+)", done.stdout, re.MULTILINE)
        stamps = [int(line.split(",")[2]) for line in done.stdout.splitlines() if line and not line.startswith("#")]
        if base is None or not stamps:
            raise self._failure(_shown(done.stderr) or "it holds no frames")
        return np.array(stamps) * (int(base[1]) / int(base[2]))

    def frame(self, number: int) -> Bytes:
        """One frame, (rows, columns) uint8."""
        stream = self._stream
        if stream is None or number < self._next:
            stream = self._stream = self._start()
        while True:
            image = self._read(stream)
            self._next += 1
            if self._next > number:
                return image

    def _start(self) -> IO[bytes]:
        if self._stop is not None:
            self._stop()
        try:
            process = subprocess.Popen(
                [*self._command, "-f", "image2pipe", "-pix_fmt", "gray", "-c:v", "pgm", "-"],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )
        except OSError as error:
            raise self._failure(_shown(str(error))) from error
        stream = cast("IO[bytes]", process.stdout)
        self._stop = weakref.finalize(self, _end, process, stream)
        self._next = 0
        return stream

    def _read(self, stream: IO[bytes]) -> Bytes:
        """The next picture in the stream: PGM, three short lines and the pixels."""
        lines = [stream.readline(64) for _ in range(3)]
        size = re.fullmatch(rb"(\d+) (\d+)\n", lines[1])
        if lines[0] != b"P5\n" or size is None:
            raise self._failure(f"it ends after frame {self._next - 1}")
        columns, rows = int(size[1]), int(size[2])
        data = stream.read(columns * rows)
        if len(data) != columns * rows:
            raise self._failure(f"it ends within frame {self._next}")
        return np.frombuffer(data, np.uint8).reshape(rows, columns)

    def _failure(self, why: str) -> FileFormatError:
        return FileFormatError(f"{self._path}: it cannot be decoded as a video ({why}). Export it again, or its frames as pictures.")


def _shown(text: str) -> str:
    return one_line(text.strip())[:200]


def _end(process: subprocess.Popen[bytes], stream: IO[bytes]) -> None:
    """Stop the decoder, whether it has finished or not."""
    process.kill()
    stream.close()
    process.wait()
