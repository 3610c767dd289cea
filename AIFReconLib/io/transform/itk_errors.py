"""SimpleITK's many-line exceptions in a few words."""

from __future__ import annotations

import re

from ..metafile.text_values import shorten


def short_cause(error: Exception) -> str:
    """The last meaningful line of a SimpleITK exception, without addresses and source paths."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    itk = [line for line in lines if "ERROR:" in line]
    text = (itk or lines or [type(error).__name__])[-1]
    text = re.sub(r"^.*?ERROR:\s*", "", text)
    text = re.sub(r"\(0x[0-9a-f]+\)", "", text)
    return shorten(text.rstrip(" .:"), 160)
