"""What is fuzzed, and the property that every input must have: a refusal in one sentence, or a result that is well-formed."""

from __future__ import annotations

import contextlib
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from AIFReconLib.errors import AIFReconError

REPOSITORY = Path(__file__).resolve().parents[2]

LONGEST_MESSAGE = 8000
"""Characters: a few quotes of a file, every character of which must be escaped."""
SLOWEST = 5.0
"""s that an input of a few KB may take. Machines of continuous integration are slow and shared."""
LARGEST_GROWTH = 400 * 2**20
"""Bytes that an input of a few KB may add to the memory of the process."""
QUICK = 0.02
"""s in which nothing costly can be done."""


class Finding(AssertionError):
    """An input that broke the property.

    Parameters
    ----------
    kind : str
        The same for inputs that break it in the same way: a type of error and the line that raised it.
    detail : str
    """

    def __init__(self, kind: str, detail: str):
        super().__init__(f"{kind}\n{detail}")
        self.kind = kind


@dataclass(frozen=True)
class Target:
    """One way into the library.

    Parameters
    ----------
    name : str
    file_name : str
        Under which the input is given to `read`.
    read : function (Path) -> None
        Reads the file and asserts that what comes out is well-formed.
    seeds : function () -> list of bytes
        Good inputs, small.
    wrap : function (bytes) -> bytes
        What turns the damaged bytes into the input, such as compressing them or giving them a right checksum; damage behind either is
        never reached otherwise.
    errors : tuple of exception types
        Refusals.
    words : tuple of bytes
        What the damage may put in, besides numbers.
    """

    name: str
    file_name: str
    read: Callable[[Path], None]
    seeds: Callable[[], list[bytes]]
    wrap: Callable[[bytes], bytes] = bytes
    errors: tuple[type[Exception], ...] = (AIFReconError,)
    words: Sequence[bytes] = ()


def check(target: Target, data: bytes, folder: Path) -> bool:
    """Give `data` to the target; True if it was accepted, False if it was refused.

    Raises
    ------
    Finding
        When it was neither, took too long, or took too much memory.
    """
    path = folder / target.file_name
    path.write_bytes(target.wrap(data))
    begin, before = time.monotonic(), peak_memory()
    accepted = True
    try:
        target.read(path)
    except target.errors as error:
        accepted = False
        _check_message(str(error), error)
    except Exception as error:
        raise Finding(_kind(error), "".join(traceback.format_exception(error))) from None
    if time.monotonic() - begin > QUICK:
        _check_cost(target, path, before)
    return accepted


def _check_cost(target: Target, path: Path, before: int) -> None:
    """Read an input again that was not quick, now that all is loaded, and raise a finding if it costs too much.

    `before` is what the process had held at most before it was read first, in bytes.
    """
    begin = time.process_time()
    with contextlib.suppress(*target.errors):
        target.read(path)
    took, growth = time.process_time() - begin, peak_memory() - before
    if took > SLOWEST:
        raise Finding("slow", f"{took:.1f} s")
    if growth > LARGEST_GROWTH:
        raise Finding("memory", f"{growth / 2**20:.0f} MB")


def _check_message(message: str, error: Exception) -> None:
    """A refusal is one line of text that can be shown."""
    if not message or not all(character.isprintable() for character in message) or len(message) > LONGEST_MESSAGE:
        raise Finding(f"message of {_place(error)}", repr(message[:3000]))


def _kind(error: BaseException) -> str:
    return f"{type(error).__name__} at {_place(error)}"


def _place(error: BaseException) -> str:
    """The innermost line of this repository that the error went through."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if str(REPOSITORY) in frame.filename]
    inside = [frame for frame in frames if "AIFReconLib" in frame.filename] or frames
    return f"{Path(inside[-1].filename).name}:{inside[-1].name}" if inside else "?"


def peak_memory() -> int:
    """Most bytes that this process has ever held; 0 where the system does not tell."""
    try:
        import resource
    except ImportError:
        return 0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
