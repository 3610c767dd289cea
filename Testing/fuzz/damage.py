"""Damage that knows what headers are made of: in a good input a number, a word, a line or some bytes become another thing."""

from __future__ import annotations

import re
import time
import warnings
from collections.abc import Sequence
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from .targets import Target, check

LARGEST = 2**16
"""Bytes. Damage that is larger shows nothing that smaller damage does not."""

HEADER = 8192
"""Bytes in which a place is looked for: payloads are met by what is cut off behind it."""

NUMBER, WORD, LINE, FEW, REST = rb"[-+]?[\d.]+(?:[eE][-+]?\d+)?", rb"[A-Za-z_][\w-]*", rb"[^\n]*\n", rb"(?s).{1,8}", rb"(?s).+"
PARTS = tuple(map(re.compile, (NUMBER, NUMBER, WORD, LINE, FEW, REST)))

EXTREMES = (
    *b"0 1 -1 -0 0.5 1e-300 1e300 1e400 nan -inf 1.#IND 255 65536 2147483648 -2147483648 9223372036854775808".split(),
    *b"999999999999 1,5 0x10 1_0 . - e {} {0} %s ../x /dev/zero = := : # true null <!DOCTYPE> <!ENTITY none".split(),
    *(b"", b" ", b"\n", b"\0", b"\xff", b"\xc3\xa9", b"\xc2\xb2"),
    *(bytes([end]) * size for end in (0, 255, 127) for size in (2, 4, 8)),
)


PIECES = st.sampled_from(EXTREMES) | st.binary(max_size=8) | st.none()
TIMES = st.sampled_from((1, 1, 1, 1, 2, 1000))


@st.composite
def damaged(draw: st.DrawFn, inputs: Sequence[bytes]) -> bytes:
    """One of `inputs` with one to four damages; what is put in is extreme, at random, or part of another."""

    def part(pattern: re.Pattern[bytes], data: bytes) -> tuple[int, int]:
        spans = [found.span() for found in pattern.finditer(data, 0, HEADER)] or [(0, 0)]
        return spans[draw(st.integers(0, len(spans) - 1))]

    data = draw(st.sampled_from(inputs))
    for _ in range(draw(st.integers(1, 4))):
        pattern = draw(st.sampled_from(PARTS))
        start, end = part(pattern, data)
        new = draw(PIECES)
        if new is None:
            other = draw(st.sampled_from(inputs))
            new = other[slice(*part(pattern, other))]
        data = data[:start] + new * draw(TIMES) + data[end:]
    return data[:LARGEST]


def damage_for(connection, target: Target, seconds: float, folder: Path) -> None:
    """Damage inputs of one target for so long, in a process of its own; tell how many were read and how many of them accepted."""
    warnings.simplefilter("error")
    inputs = target.inputs(folder)
    end = time.monotonic() + seconds
    accepted: list[bool] = []

    @settings(
        max_examples=100, deadline=None, database=None, suppress_health_check=list(HealthCheck), phases=[Phase.generate, Phase.shrink]
    )
    @given(damaged(inputs))
    def read(data: bytes) -> None:
        accepted.append(check(target, data, folder))

    while time.monotonic() < end:
        seed(time.time_ns())(read)()
    connection.send((len(accepted), sum(accepted)))
