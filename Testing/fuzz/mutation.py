"""Damage that knows what headers are made of: lines, numbers and words, as well as bytes."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence

LARGEST = 2**16
"""Bytes. Damage that is larger shows nothing that smaller damage does not."""

NUMBERS = tuple(
    b"0 1 -1 2 3 4 5 -0 0.5 1e-7 1e-300 1e300 -1e300 1e400 1e18 nan -nan inf -inf NaN 1.#IND 1.#INF 255 256 65535 65536 2147483647 "
    b"2147483648 -2147483648 4294967296 9223372036854775807 9223372036854775808 18446744073709551616 999999999999 1,5 0x10 1_0 . - + "
    b"1e 1.5 00000000001 1000000 100000 0.0001".split()
)
WORDS = (
    b"",
    b" ",
    b"\t",
    b"\r",
    b"\n",
    b"=",
    b":",
    b":=",
    b"\0",
    b"\xff",
    b"\xc3\xa9",
    b"%d",
    b"%s",
    b"{}",
    b"{0}",
    b"../x",
    b"#",
    b"\xc2\xb2",
)
_NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_WORD = re.compile(rb"[A-Za-z_][A-Za-z0-9_-]*")


def mutate(data: bytes, rng: random.Random, words: Sequence[bytes] = (), others: Sequence[bytes] = ()) -> bytes:
    """`data` with one to four damages.

    Parameters
    ----------
    data : bytes
    rng : random.Random
    words : sequence of bytes
        What may be put in, besides numbers.
    others : sequence of bytes
        Other inputs, of which pieces may be put in.
    """
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        data = rng.choice(_DAMAGES)(data, rng, tuple(words), others)[:LARGEST]
    return data


def _span(data: bytes, rng: random.Random, longest: int = 64) -> tuple[int, int]:
    start = rng.randint(0, len(data))
    return start, min(len(data), start + rng.randint(0, longest))


def _replace_token(data, rng, words, others) -> bytes:
    """A number or a word becomes another."""
    pattern = _NUMBER if rng.random() < 0.7 else _WORD
    # Headers come first; payloads are damaged by the other kinds
    found = list(pattern.finditer(data, 0, 8192))
    if not found:
        return data
    match = rng.choice(found)
    pool = NUMBERS if pattern is _NUMBER or not words or rng.random() < 0.2 else (*words, *WORDS)
    token = rng.choice(pool) if rng.random() < 0.9 else rng.choice(pool) * rng.choice((2, 10, 1000))
    return data[: match.start()] + token + data[match.end() :]


def _lines(data, rng, words, others) -> bytes:
    """A line is left out, doubled, moved, changed for one of another input, or cut."""
    lines = data.split(b"\n")
    at, to = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(6)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines.insert(to, lines[at])
    elif kind == 2:
        lines[at], lines[to] = lines[to], lines[at]
    elif kind == 3 and others:
        lines.insert(at, rng.choice(rng.choice(others).split(b"\n")))
    elif kind == 4:
        lines[at] = lines[at][: rng.randint(0, len(lines[at]))]
    else:
        lines[at] += b"\n" + lines[at].replace(b"0", rng.choice(NUMBERS), 1)
    return b"\n".join(lines)


def _flip(data, rng, words, others) -> bytes:
    if not data:
        return rng.randbytes(8)
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8))):
        changed[rng.randrange(len(changed))] = rng.choice((0, 255, 127, 128, rng.randrange(256)))
    return bytes(changed)


def _integer(data, rng, words, others) -> bytes:
    """A field of a binary header becomes an extreme number."""
    size = rng.choice((1, 2, 4, 8))
    if len(data) < size:
        return data
    start = rng.randint(0, min(len(data), 1024) - size) if rng.random() < 0.8 else rng.randint(0, len(data) - size)
    top = 2 ** (8 * size)
    number = rng.choice((0, 1, 2, 7, 16, top - 1, top // 2, top // 2 - 1, top // 4, rng.randrange(top), rng.randrange(min(top, 4096))))
    return data[:start] + number.to_bytes(size, rng.choice(("little", "big"))) + data[start + size :]


def _cut(data, rng, words, others) -> bytes:
    start, stop = _span(data, rng)
    return data[:start] + data[stop:] if rng.random() < 0.6 else data[:start]


def _insert(data, rng, words, others) -> bytes:
    start, stop = _span(data, rng)
    piece = rng.choice((*NUMBERS, *WORDS, *words, data[start:stop], rng.randbytes(4)))
    return data[:start] + piece * rng.choice((1, 1, 1, 2, 100)) + data[start:]


def _splice(data, rng, words, others) -> bytes:
    """The beginning of this input and the end of another."""
    if not others:
        return data
    other = rng.choice(others)
    return data[: rng.randint(0, len(data))] + other[rng.randint(0, len(other)) :]


_DAMAGES = (_replace_token, _replace_token, _replace_token, _lines, _lines, _flip, _integer, _integer, _cut, _insert, _splice)
