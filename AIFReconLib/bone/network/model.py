"""A network in an ONNX file that says where bone is in a frame, run by onnxruntime on this computer's processor."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ...arrays import Numbers, Singles
from ...errors import ModelError
from ...io.disk.regular_files import require_regular_file
from ...io.disk.small_files import read_bytes
from ...message import shorten
from ...sweep.frames import TrackedFrame
from ..predictions import Prediction, white_of

WHITE_OF_FLOATS = 255.0
ROUNDING = 1e-3

Shape = tuple[int | str | None, ...]


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
        raise ModelError(f"{path}: this is no JSON. Write an object with {', '.join(NAMES)}.") from None
    if not isinstance(table, dict):
        raise ModelError(f"{path}: a model's description must be an object with {', '.join(NAMES)}.")
    unknown = [name for name in table if name not in NAMES]
    if unknown:
        raise ModelError(f"{path}: {unknown[0]} is not known. Names are {', '.join(NAMES)}.")
    description = ModelDescription()
    if table.get("input_size") is not None:
        description = replace(description, input_size=_size(path, table["input_size"]))
    mean, std = (_per_channel(path, name, table.get(name, list(getattr(description, name)))) for name in ("mean", "std"))
    if not all(value > 0 for value in std):
        raise ModelError(f"{path}: std must be above 0; got {table['std']}.")
    output = table.get("output", description.output)
    if output not in OUTPUTS:
        raise ModelError(f"{path}: output must be one of {', '.join(OUTPUTS)}; got {output!r}.")
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


class OnnxModel:
    """A model as an estimator of bone.

    A JSON file of the same name beside the ``.onnx`` file, if there is one, says how images go in; see `ModelDescription`. `threads` are
    onnxruntime's.

    Raises ModelError when onnxruntime is not installed, or the file is no model that takes an image and answers with one,
    which is tried on a black image.
    """

    def __init__(self, path: str | Path, threads: int = 1):
        self.path = Path(path)
        require_regular_file(self.path, ModelError)
        json_path = self.path.with_suffix(".json")
        self.description = read_description(json_path) if json_path.is_file() else ModelDescription()
        self._session = _session(self.path, threads)
        inputs, outputs = self._session.get_inputs(), self._session.get_outputs()
        if len(inputs) != 1 or not outputs:
            raise self._misfit(f"it has {len(inputs)} inputs")
        self._input, self._output = inputs[0].name, outputs[0].name
        kind = inputs[0].type
        shape: Shape = tuple(inputs[0].shape)
        if kind != "tensor(float)" or len(shape) != 4 or not _may_be(shape[0], (1,)) or not _may_be(shape[1], (1, 3)):
            raise self._misfit(f"its input is {kind} of {_words(shape)}")
        self._channels = shape[1] if isinstance(shape[1], int) else max(len(self.description.mean), len(self.description.std))
        if not {len(self.description.mean), len(self.description.std)} <= {1, self._channels}:
            raise ModelError(f"{self.path}: mean and std of {json_path.name} must be one number, or {self._channels}. Correct them.")
        self._size = self._input_size(shape)
        self._resizers: dict[tuple[int, int], tuple[scipy.sparse.csr_matrix[np.float32], scipy.sparse.csr_matrix[np.float32]]] = {}
        rows, columns = self._size or (256, 256)
        self._probability(np.zeros((rows, columns), dtype=np.float32))

    def estimate(self, frame: TrackedFrame) -> Prediction | None:
        """See `BoneEstimator`; raises ModelError when the model fails at it, or answers what is no probability."""
        image = frame.placed()[0]
        white = white_of(image) or WHITE_OF_FLOATS
        rows, columns = self._size or (int(image.shape[0]), int(image.shape[1]))
        return Prediction(self._probability(self._resized(image.astype(np.float32) / np.float32(white), rows, columns), frame.number))

    def notes(self) -> tuple[str, ...]:
        """Which model it is."""
        return (f"Bone is what the model {self.path.name} says.",)

    def _input_size(self, shape: Shape) -> tuple[int, int] | None:
        asked = self.description.input_size
        stated = tuple(side if isinstance(side, int) else None for side in shape[2:])
        if any(side is not None and not 1 <= side <= LARGEST_SIDE for side in stated):
            raise self._misfit(f"its input is {_words(shape)}")
        if asked is None:
            asked = (stated[0], stated[1]) if stated[0] is not None and stated[1] is not None else None
        elif any(side is not None and side != wanted for side, wanted in zip(stated, asked, strict=True)):
            described = self.path.with_suffix(".json").name
            raise ModelError(
                f"{self.path}: its input is {_words(shape)}, and input_size of {described} says {_words(asked)}. Correct one of them."
            )
        return asked

    def _resized(self, image: Singles, rows: int, columns: int) -> Singles:
        size = int(image.shape[0]), int(image.shape[1])
        if size == (rows, columns):
            return image
        if size not in self._resizers:
            self._resizers[size] = _resizer(size[0], rows), _resizer(size[1], columns)
        along, across = self._resizers[size]
        resized: Singles = np.ascontiguousarray((across @ (along @ image).T).T)
        return resized

    def _probability(self, image: Singles, number: int | None = None) -> Singles:
        """Of an image of the model's size, 0 black and 1 white."""
        mean, std = (np.array(values, dtype=np.float32).reshape(-1, 1, 1) for values in (self.description.mean, self.description.std))
        given = np.broadcast_to((image[None] - mean) / std, (self._channels, *image.shape))[None]
        try:
            answer = np.asarray(self._session.run([self._output], {self._input: np.ascontiguousarray(given)})[0])
        except Exception as error:  # onnxruntime has classes of its own for each failure
            raise ModelError(
                f"{self.path}: the model fails with an input of {_words(given.shape)} ({_reason(error)}). Check input_size "
                "in the JSON file beside it."
            ) from error
        return self._bone_of(answer, number)

    def _bone_of(self, answer: Numbers, number: int | None) -> Singles:
        """The channel of bone as a probability; of the trial, which has no `number`, whatever numbers it answers."""
        channels = answer[None] if answer.ndim == 3 else answer
        if channels.ndim != 4 or channels.shape[0] != 1 or min(channels.shape) < 1 or channels.dtype.kind != "f":
            raise self._misfit(f"it answers with {answer.dtype.name} of {_words(answer.shape)}")
        values, wanted = channels[0].astype(np.float32), self.description.bone_class
        if self.description.output == CLASSES:
            values = scipy.special.softmax(values, axis=0)
        elif self.description.output == LOGITS:
            values = scipy.special.expit(values)
        count = len(values)
        if count == 1 and self.description.output != CLASSES:
            wanted = 0
        if wanted >= count or (count == 1 and self.description.output == CLASSES):
            raise ModelError(
                f"{self.path}: its answer of {_words(answer.shape)} has no class {wanted} of several. Correct output and bone_class in "
                "the JSON file beside it."
            )
        bone: Singles = values[wanted]
        where = "" if number is None else f" in frame {number}"
        if not np.isfinite(bone).all():
            raise ModelError(f"{self.path}: the model answers NaN or infinity{where}. Export it again, or use another.")
        if number is not None and (float(bone.min()) < -ROUNDING or float(bone.max()) > 1 + ROUNDING):
            raise ModelError(
                f"{self.path}: the model answers {float(bone.min()):g} to {float(bone.max()):g}{where}, which is no probability. Say "
                '"output": "logits" in the JSON file beside it.'
            )
        return np.clip(bone, 0.0, 1.0)

    def _misfit(self, what: str) -> ModelError:
        return ModelError(
            f"{self.path}: {what}, and a model of bone takes one image of 1 x 1 x H x W or 1 x 3 x H x W floats and answers with 1 x N "
            "x H x W. Export it with these."
        )


def _session(path: Path, threads: int) -> Any:  # onnxruntime has no types
    """A session that runs the model in this file."""
    try:
        runtime = import_module("onnxruntime")
    except ImportError:
        raise ModelError(
            f"{path}: a model cannot be run without the Python package onnxruntime. Install it: pip install onnxruntime."
        ) from None
    options = runtime.SessionOptions()
    options.intra_op_num_threads, options.inter_op_num_threads = threads, 1
    # Threads that wait for work would take the cores from the reconstruction
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    options.log_severity_level = 4
    try:
        return runtime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has classes of its own for each failure
        raise ModelError(
            f"{path}: onnxruntime {runtime.__version__} cannot run this model ({_reason(error)}). Export it as ONNX with "
            "standard operators that this version has."
        ) from error


def _reason(error: Exception) -> str:
    """What onnxruntime says, without its place in a source file."""
    line = " ".join(str(error).split())
    return shorten(line.split(" : ", 3)[-1], 200).rstrip(". ")


def _may_be(side: int | str | None, allowed: tuple[int, ...]) -> bool:
    """Whether a side of a shape is, or may be, one of these; those with a name may be any."""
    return not isinstance(side, int) or side in allowed


def _words(shape: tuple[object, ...]) -> str:
    return " x ".join("?" if side is None else str(side) for side in shape)


def _resizer(old: int, new: int) -> scipy.sparse.csr_matrix[np.float32]:
    """The matrix (new, old) that resizes along one axis: linear between pixels, and means over them where it makes fewer."""
    scale = old / new
    reach = max(scale, 1.0)
    center = (np.arange(new) + 0.5) * scale - 0.5
    near = np.floor(center - reach).astype(np.int64)[:, None] + np.arange(int(np.ceil(2 * reach)) + 2)
    weight = np.maximum(1 - np.abs(near - center[:, None]) / reach, 0.0)
    weight /= weight.sum(axis=1, keepdims=True)
    at = np.clip(near, 0, old - 1)
    line = np.repeat(np.arange(new), near.shape[1])
    return scipy.sparse.csr_matrix((weight.ravel().astype(np.float32), (line, at.ravel())), shape=(new, old))
