"""Where the lines of each frame lie in a long header: they stay in the file, and are read again when they are asked for.

A day at 30 frames/s with ten transforms has 6 GB of them.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable

LONG_HEADER = 2**25
"""Bytes. All fields of shorter headers are kept in memory."""

FRAME_KEY = re.compile(r"Seq_Frame0*([0-9]{1,12})_")
_PIECE = 2**20
"""Bytes that are read at a time, lines of many frames."""


class OutOfOrder(Exception):
    """Frames do not follow each other in a header, or their lines are not together."""


class FrameLines:
    """The places of frames' lines; frame n has those of number n, which may be none.

    Parameters
    ----------
    split : callable
        From a line to its key and value.
    """

    def __init__(self, split: Callable[[str], tuple[str, str]]):
        self._split = split
        self._starts, self._ends = array("Q"), array("Q")
        self._piece = (0, b"")

    def __len__(self) -> int:
        return len(self._starts)

    def add(self, number: int, start: int, end: int) -> None:
        """Take in a line of a frame, from byte `start` to `end` of the file.

        Raises OutOfOrder when it cannot belong to the last frame or a later one.
        """
        last = len(self) - 1
        # No more places than a file of this length has lines
        if not last <= number <= end or number < 0:
            raise OutOfOrder
        if number > last:
            self._starts.extend([start] * (number - last))
            self._ends.extend([start] * (number - last))
        self._ends[number] = end

    def read(self, read_at: Callable[[int, int], bytes], number: int) -> list[tuple[str, str]]:
        """Keys and values in the lines of one frame, and in lines of the whole sequence that lie between them.

        Parameters
        ----------
        read_at : callable
            From a place in the file and a number of bytes to these bytes, or fewer at its end.
        number : int

        Raises
        ------
        OSError
            Also when the file ends before.
        """
        if number >= len(self):
            return []
        start, end = self._starts[number], self._ends[number]
        begin, piece = self._piece
        if not begin <= start <= end <= begin + len(piece):
            begin, piece = self._piece = (start, read_at(start, max(end - start, _PIECE)))
        if end > begin + len(piece):
            raise OSError(0, "it ends before its length")
        text = piece[start - begin : end - begin].decode("utf-8", errors="surrogateescape")
        return [self._split(line.rstrip("\r")) for line in text.split("\n") if line.strip()]
