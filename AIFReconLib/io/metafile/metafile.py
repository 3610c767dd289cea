"""A MetaImage or NRRD file whose header was understood: what its pixels are and where their bytes lie."""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BufferedReader
from pathlib import Path
from typing import BinaryIO

from ...arrays import NumberType
from ...errors import AIFReconError, FileFormatError
from ..disk.regular_files import stamp

UNFINISHED = "RecordingUnfinished"
"""A field of recordings that go on, or were cut off by a crash: more frames stand behind the header, each closed by a line with the new
size, and pixels may go on behind the frames that are listed so."""


class PayloadError(AIFReconError, ValueError):
    """What is wrong with stored pixels, as the predicate of "the pixel data ..."."""


@dataclass(frozen=True, eq=False)
class Metafile:
    """A header that was understood, and its payload, whose length fits as far as that can be told without decoding it.

    Parameters
    ----------
    path : Path
    error : type of FileFormatError
        What to raise for this file.
    size : tuple of int
        Pixels along each axis, fastest first, without the channels.
    channels : int
    dtype : numpy.dtype
        With the file's byte order.
    kinds : tuple of str
        One per entry of `size`, lower case; empty when the header does not say.
    encoding : "raw" or "compressed"
    data_path, data_offset, data_length
        File, first byte and number of bytes of the payload as stored.
    fields : dict of str to str
        What the format itself does not define, by name: custom and per-frame fields.
    entries : dict of str to str
        What the format defines, as written: units of axes, place in space.
    """

    path: Path
    error: type[FileFormatError]
    size: tuple[int, ...]
    channels: int
    dtype: NumberType
    kinds: tuple[str, ...]
    encoding: str
    data_path: Path
    data_offset: int
    data_length: int
    fields: dict[str, str] = field(repr=False)
    data_stamp: tuple[int, int] = (0, 0)
    entries: dict[str, str] = field(default_factory=dict, repr=False)

    @property
    def pixel_bytes(self) -> int:
        """Bytes of all pixels, decoded."""
        return math.prod(self.size) * self.channels * self.dtype.itemsize

    def failure(self, problem: str, advice: str = "") -> FileFormatError:
        """The error to raise for this file."""
        return self.error(f"{self.path}: {problem}", advice)

    @contextlib.contextmanager
    def open_payload(self) -> Iterator[BufferedReader]:
        """The data file, open for reading, provided that it is still the one whose header was read.

        Raises
        ------
        FileFormatError
            `error`, for every PayloadError and OSError of the block too: a network disk that goes away shows even when the file is closed.
        """
        try:
            with open(self.data_path, "rb") as file:
                self.require_unchanged(file)
                yield file
        except PayloadError as error:
            raise self.failure(f"the pixel data {error}. Copy the file again, or write it again.") from error
        except OSError as error:
            raise self.failure(f"data file {self.data_path.name} cannot be read ({error.strerror}). Copy the file again.") from error

    def require_unchanged(self, file: BinaryIO) -> None:
        """Raise `error` unless the open data file is still as it was when the header was read."""
        if stamp(os.fstat(file.fileno())) != self.data_stamp:
            raise self.failure(f"data file {self.data_path.name} has changed since it was opened. Read the file again.")
