"""What SimpleITK takes and says: paths in its encoding, its many-line exceptions in a few words, and its warnings nowhere."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import SimpleITK as sitk

from ...errors import FileFormatError, OutputError
from ...message import shorten
from .regular_files import unchanged


def itk_path(path: Path, error: type[FileFormatError] | type[OutputError]) -> str:
    """The path as UTF-8 text, whatever encoding Python takes file names to be in.

    Raises FileFormatError or OutputError when it cannot be said in UTF-8. SimpleITK would end the program at such a name.
    """
    try:
        return os.fsencode(path).decode("utf-8")
    except UnicodeError:
        raise error(f"{path}: its name, or that of a folder, is not text in UTF-8. Rename it.") from None


@contextlib.contextmanager
def itk_reads(path: Path, error: type[FileFormatError], advice: str, *beside: Path) -> Iterator[str]:
    """The name by which SimpleITK finds a file, in a block in which it reads it, and other files beside it that it names.

    On Windows ITK finds no names beyond ASCII: there it gets a copy.

    Raises
    ------
    FileFormatError
        The given one, with the advice, when SimpleITK cannot read the file, or that changes meanwhile.
    """
    with unchanged(error, path, *beside), contextlib.ExitStack() as stack:
        name = itk_path(path, error)
        if sys.platform == "win32" and not name.isascii():
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
            name = str(shutil.copyfile(path, Path(folder, "copy").with_suffix("".join(path.suffixes[-2:]).lower())))
            for each in beside:
                shutil.copyfile(each, folder / each.name)
        stack.enter_context(without_warnings())
        try:
            yield name
        except (RuntimeError, KeyError) as cause:  # the second where ITK reads what SimpleITK has no class for
            raise error(f"{path}: SimpleITK cannot read it: {short_cause(cause)}. {advice}") from cause


def short_cause(error: Exception) -> str:
    """The sentence of a SimpleITK exception that says what was wrong, without addresses, source paths and functions."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    # NRRD's reader tells the way to the error, and that last
    named = [line for line in lines if line.startswith("[nrrd]")] or [line for line in lines if "ERROR:" in line]
    text = (named or lines or [type(error).__name__])[-1]
    text = re.sub(r"^(.*?ERROR:|\[nrrd\] \w+:)\s*", "", text)
    text = re.sub(r"\(0x[0-9a-f]+\)", "", text)
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
