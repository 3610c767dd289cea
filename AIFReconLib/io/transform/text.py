"""ITK transform files in text (.tfm, .txt): blocks of ``Transform:``, ``Parameters:`` and ``FixedParameters:``."""

from __future__ import annotations

from ..metafile.text_values import NotANumberError, parse_numbers, shorten
from .parts import TransformPart, TransformPartError

MAGIC = "#Insight Transform File"


def read_transform_text(text: str) -> list[TransformPart]:
    """The transforms of a file, in its order.

    Raises
    ------
    TransformPartError
        When a line is none of such a file.
    """
    blocks: list[dict[str, str]] = []
    for line in text.splitlines():
        if line.startswith("#") or not line.strip():
            continue
        key, colon, value = (word.strip() for word in line.partition(":"))
        if key == "Transform" and colon:
            blocks.append({})
        if not blocks or not colon or key not in ("Transform", "Parameters", "FixedParameters") or key in blocks[-1]:
            raise TransformPartError(
                "has a line that is none of an ITK transform file: {line!r}. Save the transform from Slicer again.", line=shorten(line)
            )
        blocks[-1][key] = value
    return [TransformPart(block["Transform"], _numbers(block, "Parameters"), _numbers(block, "FixedParameters")) for block in blocks]


def _numbers(block: dict[str, str], key: str) -> tuple[float, ...]:
    try:
        return tuple(parse_numbers(block.get(key, "")))
    except NotANumberError as error:
        raise TransformPartError(
            "has {key} that must be numbers; {problem}. Save the transform from Slicer again.", key=key, problem=error
        ) from None
