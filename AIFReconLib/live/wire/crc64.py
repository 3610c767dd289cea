"""The checksum of OpenIGTLink messages, quick enough for images, on every machine and without a compiler.

It is CRC-64/ECMA-182: polynomial 0x42F0E1EBA9EA3693, no reflection, start value 0. A CRC is linear, so a large message is cut into rows:
the sum of the rows so far is multiplied by x^(bits of a row) modulo the polynomial, and the next row is added. The multiplication by a
constant is eight table look-ups per word, one for each of its bytes. (pyigtl takes its sum from crcmod, which is compiled where a compiler
is at hand, and elsewhere needs 35 ms for an image of 640 x 480.)
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

POLYNOMIAL = 0x42F0E1EBA9EA3693
WORD_BITS = 64

ROW = 1024
"""Words of a row. Shorter messages are walked byte by byte."""

Words = NDArray[np.uint64]
"""Numbers modulo the polynomial, in wire order."""
_MASK = (1 << WORD_BITS) - 1


def crc64(data: bytes | bytearray | memoryview) -> int:
    """The checksum of `data`, an unsigned 64-bit integer; 0 of no data.

    Notes
    -----
    Bytes of zero in front of a message leave the sum as it is (the start value is 0), so the message is filled up to whole rows there.
    """
    size = len(data)
    if size <= 8 * ROW:
        return _walk(data)
    words: Words = np.zeros((-(-size // (8 * ROW)), ROW), np.uint64)
    words.reshape(-1).view(np.uint8)[words.nbytes - size :] = np.frombuffer(data, np.uint8)
    total: Words = words[0]
    for row in words[1:]:
        total = row ^ _multiplied(total, _of_a_row())
    return _walk(total.tobytes())


def _walk(data: bytes | bytearray | memoryview) -> int:
    """The sum by its definition, a byte at a time."""
    table = _byte_table()
    value = 0
    for byte in data:
        value = ((value << 8) & _MASK) ^ table[(value >> (WORD_BITS - 8)) ^ byte]
    return value


def _multiplied(words: Words, tables: Words) -> Words:
    """Every word times the constant of `tables`; all are in wire order, whatever the machine's byte order."""
    octets = words.view(np.uint8).reshape(-1, 8)
    product: Words = np.zeros(len(words), np.uint64)
    for place in range(8):
        product ^= tables[place][octets[:, place]]
    return product


@lru_cache(maxsize=1)
def _of_a_row() -> Words:
    """Products of every byte at each of the 8 places of a word with x^(64 ROW), modulo the polynomial; (8, 256), in wire order."""
    words = [bytes(place) + bytes([byte]) + bytes(7 - place) for place in range(8) for byte in range(256)]
    product: Words = np.array([_walk(word) for word in words], ">u8").view(np.uint64)
    of_a_word = product.reshape(8, 256)
    for _ in range(ROW - 1):
        product = _multiplied(product, of_a_word)
    return product.reshape(8, 256)


@lru_cache(maxsize=1)
def _byte_table() -> list[int]:
    """Products of every byte with x^64."""
    values = [byte << (WORD_BITS - 8) for byte in range(256)]
    for _ in range(8):
        values = [((value << 1) & _MASK) ^ (POLYNOMIAL if value >> (WORD_BITS - 1) else 0) for value in values]
    return values
