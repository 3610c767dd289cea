"""What a model of a network wants and answers, as the JSON file beside it says."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import ModelError
from ..io.disk.small_files import read_bytes

LOGITS, PROBABILITY, CLASSES = "logits", "probability", "classes"
OUTPUTS = (LOGITS, PROBABILITY, CLASSES)
NAMES = ("input_size", "mean", "std", "output", "bone_class")
LARGEST_FILE = 65536
LARGEST_SIDE, LARGEST_NUMBER = 4096, 1e9


@dataclass(frozen=True)
class ModelDescription:
    """How images go into a model, and bone comes out."""

    input_size: tuple[int, int] | None = None
    """(rows, columns). What images are resized to; None: what the model's own input says, else their own size."""
    mean: tuple[float, ...] = (0.0,)
    std: tuple[float, ...] = (1.0,)
    """One for all channels, or one for each. A gray level goes in as (level / white - mean) / std."""
    output: str = LOGITS
    """One of `OUTPUTS`: of bone, 1 x 1 x H x W; classes: logits of several, 1 x N x H x W, of which softmax makes
    probabilities."""
    bone_class: int = 1  #: Which of several channels is bone


def read_description(path: Path) -> ModelDescription:
    """What the JSON file says; raises ModelError when it is none, or names or values are not those of a description."""
    try:
        table = json.loads(read_bytes(path, LARGEST_FILE, ModelError).decode("utf-8"))
    except (ValueError, RecursionError):
        raise ModelError("{path}: this is no JSON. Write an object with {names}.".format(path=path, names=", ".join(NAMES))) from None
    if not isinstance(table, dict):
        raise ModelError("{path}: a model's description must be an object with {names}.".format(path=path, names=", ".join(NAMES)))
    unknown = [name for name in table if name not in NAMES]
    if unknown:
        raise ModelError("{path}: {name} is not known. Names are {names}.".format(path=path, name=unknown[0], names=", ".join(NAMES)))
    description = ModelDescription()
    if table.get("input_size") is not None:
        description = replace(description, input_size=_size(path, table["input_size"]))
    mean, std = (_per_channel(path, name, table.get(name, list(getattr(description, name)))) for name in ("mean", "std"))
    if not all(value > 0 for value in std):
        raise ModelError("{path}: std must be above 0; got {value}.".format(path=path, value=table["std"]))
    output = table.get("output", description.output)
    if output not in OUTPUTS:
        raise ModelError(
            "{path}: output must be one of {outputs}; got {value!r}.".format(path=path, outputs=", ".join(OUTPUTS), value=output)
        )
    bone_class = table.get("bone_class", description.bone_class)
    if not isinstance(bone_class, int) or isinstance(bone_class, bool) or bone_class < 0:
        raise ModelError(f"{path}: bone_class must be the number of a channel, from 0; got {bone_class!r}.")
    return replace(description, mean=mean, std=std, output=output, bone_class=bone_class)


def _size(path: Path, value: object) -> tuple[int, int]:
    if isinstance(value, list) and len(value) == 2 and all(type(n) is int and 1 <= n <= LARGEST_SIDE for n in value):
        return value[0], value[1]
    raise ModelError(f"{path}: input_size must be two whole numbers, rows and columns, of 1 to {LARGEST_SIDE}; got {value!r}.")


def _per_channel(path: Path, name: str, value: object) -> tuple[float, ...]:
    numbers = [
        float(each)
        for each in (value if isinstance(value, list) else [value])
        if isinstance(each, int | float) and not isinstance(each, bool) and abs(each) < LARGEST_NUMBER
    ]
    if len(numbers) in (1, 3) and len(numbers) == (len(value) if isinstance(value, list) else 1):
        return tuple(numbers)
    raise ModelError(f"{path}: {name} must be a number, or three; got {value!r}.")
