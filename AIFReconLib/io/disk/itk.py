"""What SimpleITK takes and says: paths in its encoding, its many-line exceptions in a few words, and its warnings nowhere."""

from __future__ import annotations

import contextlib
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import SimpleITK as sitk

from ...errors import FileFormatError, OutputError
from ...message import shorten


def itk_path(path: Path, error: type[FileFormatError] | type[OutputError]) -> str:
    """The path as UTF-8 text, whatever encoding Python takes file names to be in.

    Raises FileFormatError or OutputError when it cannot be said in UTF-8. SimpleITK would end the program at such a name.
    """
    try:
        text = os.fsencode(path).decode("utf-8")
        text.encode("utf-8")
    except UnicodeError:
        raise error(f"{path}: its name, or that of a folder, is not text in UTF-8. Rename it.") from None
    return text


def short_cause(error: Exception) -> str:
    """The sentence of a SimpleITK exception that says what was wrong, without addresses, source paths and functions."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    # NRRD's reader tells the way to the error, and that last
    said = [line for line in lines if line.startswith("[nrrd]")] or [line for line in lines if "ERROR:" in line]
    text = (said or lines or [type(error).__name__])[-1]
    text = re.sub(r"^(.*?ERROR:|\[nrrd\] \w+:)\s*", "", text)
    text = re.sub(r"\(0x[0-9a-f]+\)", "", text)
    text = re.sub(r"\S*aifrecon-\w+[/\\]copy[.\w]*", "it", text)  # of a local_copy
    return shorten(text.rstrip(" .:"), 160)


@contextlib.contextmanager
def without_warnings() -> Iterator[None]:
    """Within the block neither ITK prints warnings, which name lines of its own code, nor the libraries below it, which ask nobody."""
    shown = sitk.ProcessObject.GetGlobalWarningDisplay()
    sitk.ProcessObject.SetGlobalWarningDisplay(False)
    sys.stderr.flush()
    with open(os.devnull, "w") as nowhere, contextlib.ExitStack() as after:
        after.callback(sitk.ProcessObject.SetGlobalWarningDisplay, shown)
        with contextlib.suppress(OSError):  # a program without a terminal has no such file
            kept = os.dup(2)
            after.callback(os.close, kept)
            after.callback(os.dup2, kept, 2)
            os.dup2(nowhere.fileno(), 2)
        yield
