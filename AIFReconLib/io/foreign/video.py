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
from ...message import one_line
from ..sequence.decoded_images import DecodedImages, decoding, library
from .images import ImportedImages

_ONLY_THIS_FILE = ("-protocol_whitelist", "file", "-format_whitelist", "mov,mp4,avi,matroska,webm,asf")
"""ffmpeg goes by the content, whatever the suffix: without this, a list of other files or addresses would be followed."""

_EVERY_FRAME = ("-map", "0:v:0", "-fps_mode", "passthrough", "-pix_fmt", "gray")
"""The first video stream as it is: no frame repeated or dropped to make the rate constant."""


def open_video(path: Path) -> ImportedImages:
    """The frames of a video file as gray levels, with the time of each.

    Raises FileFormatError when it cannot be decoded.

    Notes
    -----
    Reading in order decodes each frame once; going back starts over. Videos are compressed with loss: gray levels are near those that
    the scanner showed, not equal to them.
    """
    with decoding(f"{path}: there is no ffmpeg program", "Install it: pip install imageio-ffmpeg."):
        program = library("imageio_ffmpeg", "Videos").get_ffmpeg_exe()
    video = _Video(program, path)
    times = video.open()
    stack = DecodedImages(len(times), video.frame, lambda n: f"{path}, frame {n}")
    return ImportedImages(stack, "video frames", times=times)


class _Video:
    """One pass through a video, begun again when an earlier frame is asked for."""

    def __init__(self, program: str, path: Path):
        source = f"file:{os.path.realpath(path)}"
        self._command = [program, "-v", "error", "-nostdin", *_ONLY_THIS_FILE, "-i", source, *_EVERY_FRAME, "-f"]
        self._failure = f"{path}: it cannot be decoded as a video", "Export it again, or its frames as pictures."
        self._shape = (0, 0)
        self._stream: IO[bytes] | None = None
        self._next = 0
        self._stop: Callable[[], object] = lambda: None

    def open(self) -> Floats:
        """Times of all frames in s, from a first pass that decodes them: headers guess."""
        with decoding(*self._failure):
            done = subprocess.run([*self._command, "framecrc", "-"], stdin=subprocess.DEVNULL, capture_output=True, check=False)
            told = done.stdout.decode()
            base, size = (re.search(rf"^#{what} 0: (\d+).(\d+)", told, re.MULTILINE) for what in ("tb", "dimensions"))
            stamps = [int(line.split(",")[2]) for line in told.splitlines() if line and not line.startswith("#")]
            if base is None or size is None or not stamps:
                raise ValueError(one_line(done.stderr.decode(errors="replace").strip()) or "it holds no frames")
            self._shape = int(size[2]), int(size[1])
        return np.array(stamps) * (int(base[1]) / int(base[2]))

    def frame(self, number: int) -> Bytes:
        """One frame, (rows, columns) uint8."""
        with decoding(*self._failure):
            if self._stream is None or number < self._next:
                self._stop()
                process = subprocess.Popen(
                    [*self._command, "rawvideo", "-"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
                )
                self._stream, self._next = cast("IO[bytes]", process.stdout), 0
                self._stop = weakref.finalize(self, _end, process)
            while self._next <= number:
                data = self._stream.read(self._shape[0] * self._shape[1])
                self._next += 1
            if len(data) != self._shape[0] * self._shape[1]:
                raise ValueError(f"it ends before frame {number}")
        return np.frombuffer(data, np.uint8).reshape(self._shape)


def _end(process: subprocess.Popen[bytes]) -> None:
    """Stop the decoder, whether it has finished or not."""
    process.kill()
    process.communicate()
