"""The bytes of the pixels, decoded piece by piece in bounded memory."""

from __future__ import annotations

import zlib
from typing import BinaryIO

from ...errors import AIFReconError
from .metafile import RAW, Metafile

_PIECE = 2**18
"""Bytes read or decoded at a time."""

ZLIB_OR_GZIP = 32 + zlib.MAX_WBITS


class PayloadError(AIFReconError, ValueError):
    """What is wrong with compressed data, as the predicate of "the pixel data ..."."""


class Inflater:
    """A compressed stream, decoded forward. It keeps its place, not a file handle.

    Parameters
    ----------
    start : int
        Offset of the first compressed byte in the file.
    length : int
        Number of compressed bytes.
    """

    def __init__(self, start: int, length: int):
        self._next = start
        self._stop = start + length
        self._pending = b""
        self._decoder = zlib.decompressobj(ZLIB_OR_GZIP)
        self.position = 0

    def read(self, file: BinaryIO, count: int) -> bytes:
        """The next `count` decoded bytes.

        Raises PayloadError when the stream is corrupt or ends before.
        """
        pieces = []
        while count > 0:
            piece = self._decode(file, min(count, _PIECE))
            if not piece:
                raise PayloadError("are cut short")
            pieces.append(piece)
            count -= len(piece)
            self.position += len(piece)
        return b"".join(pieces)

    def skip(self, file: BinaryIO, count: int) -> None:
        """Decode `count` bytes and drop them."""
        while count > 0:
            count -= len(self.read(file, min(count, _PIECE)))

    def finish(self, file: BinaryIO) -> None:
        """Make sure that the stream ends here, with a right checksum, and that nothing follows.

        Raises PayloadError otherwise.
        """
        if self._decode(file, 1):
            raise PayloadError("go on behind the last frame or slice: the size in the header is wrong")
        if not self._decoder.eof:
            raise PayloadError("are cut short")
        if self._pending or self._next < self._stop:
            raise PayloadError("are followed by bytes that do not belong to them")

    def _decode(self, file: BinaryIO, limit: int) -> bytes:
        """Up to `limit` decoded bytes; none only at the end of the stream or of the file."""
        while True:
            if self._decoder.eof and not self._begin_next_member(file):
                return b""
            try:
                # An empty input still yields what the decoder held back when the last limit was reached.
                piece = self._decoder.decompress(self._pending, limit)
            except zlib.error as error:
                raise PayloadError(f"are corrupt ({error})") from error
            self._pending = self._decoder.unused_data if self._decoder.eof else self._decoder.unconsumed_tail
            if piece:
                return piece
            if not self._decoder.eof and not self._pending and not self._fill(file):
                return b""

    def _begin_next_member(self, file: BinaryIO) -> bool:
        """Go on with the next member of a gzip file; False when there is none."""
        if len(self._pending) < 2:
            self._fill(file)
        if not self._pending.startswith(b"\x1f\x8b"):
            return False
        self._decoder = zlib.decompressobj(ZLIB_OR_GZIP)
        return True

    def _fill(self, file: BinaryIO) -> bool:
        """Read on behind what is pending; False at the end of the payload."""
        file.seek(self._next)
        data = file.read(min(_PIECE, self._stop - self._next))
        self._next += len(data)
        self._pending += data
        return bool(data)


def check_payload(metafile: Metafile) -> None:
    """Decode a compressed payload once, keeping nothing, to make sure that all of it is there.

    Raises
    ------
    FileFormatError
        The metafile's kind. Raw payloads were measured when the header was read.
    """
    if metafile.encoding == RAW:
        return
    stream = Inflater(metafile.data_offset, metafile.data_length)
    with metafile.open_payload() as file:
        try:
            stream.skip(file, metafile.pixel_bytes)
            stream.finish(file)
        except PayloadError as error:
            raise metafile.failure(f"the pixel data {error}. Copy or write the file again.") from error
