"""Frames from a video, decoded forward by the ffmpeg program that the package imageio-ffmpeg brings along (or finds)."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Generator
from pathlib import Path

import numpy as np

from ...arrays import Bytes
from ...message import one_line
from ..sequence.decoded_images import DecodedImages, Forward, decoding, library
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
    command = [program, "-v", "error", "-nostdin", *_ONLY_THIS_FILE, "-i", f"file:{os.path.realpath(path)}", *_EVERY_FRAME, "-f"]
    failure = f"{path}: it cannot be decoded as a video", "Export it again, or its frames as pictures."
    with decoding(*failure):
        # A first pass decodes all frames to know their times: headers guess
        done = subprocess.run([*command, "framecrc", "-"], stdin=subprocess.DEVNULL, capture_output=True, check=False)
        told = done.stdout.decode()
        base, size = (re.search(rf"^#{what} 0: (\d+).(\d+)", told, re.MULTILINE) for what in ("tb", "dimensions"))
        stamps = [int(line.split(",")[2]) for line in told.splitlines() if line and not line.startswith("#")]
        if base is None or size is None or not stamps:
            raise ValueError(one_line(done.stderr.decode(errors="replace").strip()) or "it holds no frames")
    shape = int(size[2]), int(size[1])
    frames = Forward(lambda: _decoded([*command, "rawvideo", "-"], shape))

    def decode(number: int) -> Bytes:
        with decoding(*failure):
            return frames[number]

    stack = DecodedImages(len(stamps), decode, lambda n: f"{path}, frame {n}")
    return ImportedImages(stack, "video frames", times=np.array(stamps) * (int(base[1]) / int(base[2])))


def _decoded(command: list[str], shape: tuple[int, int]) -> Generator[Bytes, None, None]:
    """The frames that ffmpeg decodes, (rows, columns) uint8 each; it is stopped when nobody wants more."""
    size = shape[0] * shape[1]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        try:
            while process.stdout and len(data := process.stdout.read(size)) == size:
                yield np.frombuffer(data, np.uint8).reshape(shape)
        finally:
            process.kill()
