"""The bytes of the pixels, decoded piece by piece in bounded memory."""

from __future__ import annotations

import zlib
from typing import BinaryIO

from .header import RAW
from .metafile import Metafile, PayloadError

_PIECE = 2**18
"""Bytes read or decoded at a time."""

_ZLIB_OR_GZIP = 32 + zlib.MAX_WBITS


class PayloadStream:
    """The pixels of a metafile, decoded forward. It keeps its place, not a file handle: `file` is always that of `open_payload`."""

    def __init__(self, metafile: Metafile):
        self._metafile = metafile
        self._next = metafile.data_offset
        self._stop = metafile.data_offset + metafile.data_length
        self._decoder = None if metafile.encoding == RAW else zlib.decompressobj(_ZLIB_OR_GZIP)
        self.position = 0

    def __reduce__(self) -> tuple[type[PayloadStream], tuple[Metafile]]:
        # A decoder cannot go to another process: a copy begins at the first pixel
        return PayloadStream, (self._metafile,)

    def read(self, file: BinaryIO, count: int) -> bytes:
        """The next `count` decoded bytes.

        Raises PayloadError when the stream is corrupt or ends before.
        """
        pieces = []
        while count > 0:
            piece = self._decode(file, count)
            if not piece:
                raise PayloadError("are cut short")
            pieces.append(piece)
            count -= len(piece)
            self.position += len(piece)
        return b"".join(pieces)

    def skip(self, file: BinaryIO, count: int) -> None:
        """Decode `count` bytes and drop them."""
        if self._decoder is None:
            self._next += count
            self.position += count
            return
        while count > 0:
            count -= len(self.read(file, min(count, _PIECE)))

    def finish(self, file: BinaryIO) -> None:
        """Make sure that the stream ends here, with a right checksum, and that nothing follows. The length of raw pixels is known.

        Raises PayloadError otherwise.
        """
        if self._decoder is None:
            return
        if self._decode(file, 1) or self._decoder.unused_data or (self._decoder.eof and self._next < self._stop):
            raise PayloadError("go on behind the last frame or slice")
        if not self._decoder.eof:
            raise PayloadError("are cut short")

    def _decode(self, file: BinaryIO, limit: int) -> bytes:
        """Up to `limit` decoded bytes; none only at the end of the stream or of the file."""
        if self._decoder is None:
            return self._stored(file, limit)
        while not self._decoder.eof:
            # An empty input still yields what the decoder held back when the last limit was reached.
            pending = self._decoder.unconsumed_tail
            stored = pending or self._stored(file, _PIECE)
            try:
                piece = self._decoder.decompress(stored, limit)
            except zlib.error as error:
                raise PayloadError(f"are corrupt ({error})") from error
            if piece or not stored:
                return piece
        return b""

    def _stored(self, file: BinaryIO, limit: int) -> bytes:
        """The next bytes as they are stored; none at the end of the payload."""
        file.seek(self._next)
        data = file.read(min(limit, self._stop - self._next))
        self._next += len(data)
        return data


def check_payload(metafile: Metafile) -> None:
    """Decode a compressed payload once, keeping nothing, to make sure that all of it is there.

    Raises
    ------
    FileFormatError
        The metafile's kind. Raw payloads were measured when the header was read.
    """
    stream = PayloadStream(metafile)
    with metafile.open_payload() as file:
        stream.skip(file, metafile.pixel_bytes)
        stream.finish(file)
