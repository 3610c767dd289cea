"""A network in an ONNX file that says where bone is in a frame, run by onnxruntime on this computer's processor."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ...arrays import Numbers, Singles
from ...errors import FileFormatError, SettingsError
from ...io.disk.regular_files import require_regular_file
from ...io.disk.small_files import read_bytes
from ...message import listed, shorten
from ...recipe.recipe import Branch
from ...recipe.rules import NUMBERS, WHOLE, setting
from ...sweep.frames import TrackedFrame
from ..predictions import Prediction, white_of

WHITE_OF_FLOATS = 255.0
ROUNDING = 1e-3

Shape = tuple[int | str | None, ...]

LOGITS, PROBABILITY, CLASSES = "logits", "probability", "classes"
OUTPUTS = (LOGITS, PROBABILITY, CLASSES)
LARGEST_FILE = 65536
LARGEST_SIDE, LARGEST_NUMBER, SMALLEST_STD = 4096, 1e9, 1e-9
_per_channel = partial(setting, kind=NUMBERS, counts=(1, 3), maximum=LARGEST_NUMBER)


@dataclass(frozen=True)
class _Description(Branch):
    """How images go into a model, and bone comes out."""

    input_size: tuple[int, int] | None = setting(
        None, "(rows, columns) that images are resized to", NUMBERS, counts=(2,), minimum=1, maximum=LARGEST_SIDE
    )
    mean: float | tuple[float, ...] = _per_channel(
        0.0, "for all channels, or of each: a gray level goes in as (level / white - mean) / std", minimum=-LARGEST_NUMBER
    )
    std: float | tuple[float, ...] = _per_channel(1.0, "see mean", minimum=SMALLEST_STD)
    output: str = setting(LOGITS, "of bone, 1 x 1 x H x W; classes: logits of several, 1 x N x H x W", choices=OUTPUTS)
    bone_class: int = setting(1, "which of several channels is bone", WHOLE, minimum=0)


def _description(path: Path) -> _Description:
    """What a JSON file says of a model; raises FileFormatError when it says something else."""
    names = [spec.name for spec in fields(_Description)]
    try:
        table = json.loads(read_bytes(path, LARGEST_FILE, FileFormatError).decode("utf-8"))
        if not isinstance(table, dict):
            raise SettingsError("A model's description must be an object.")
        if unknown := {*table} - {*names}:
            raise SettingsError(f"{min(unknown)} is not known.")
        return _Description(**table)
    except SettingsError as error:
        raise FileFormatError(f"{path}: {error} Write an object with {listed(names)}.") from None
    except (ValueError, RecursionError):
        raise FileFormatError(f"{path}: this is no JSON. Write an object with {listed(names)}.") from None


class OnnxModel:
    """A model as an estimator of bone.

    A JSON file of the same name beside the ``.onnx`` file, if there is one, says how images go in, as docs/without-ct.md has it.
    `threads` are onnxruntime's.

    Raises FileFormatError when onnxruntime is not installed, or the file is no model that takes an image and answers with one,
    which is tried on a black image.
    """

    def __init__(self, path: str | Path, threads: int = 1):
        self.path = Path(path)
        require_regular_file(self.path, FileFormatError)
        json_path = self.path.with_suffix(".json")
        self.description = _description(json_path) if json_path.is_file() else _Description()
        self._mean, self._std = (np.array(each, np.float32).reshape(-1, 1, 1) for each in (self.description.mean, self.description.std))
        self._session = _session(self.path, threads)
        inputs, outputs = self._session.get_inputs(), self._session.get_outputs()
        self._input, self._output = inputs[0].name, outputs[0].name
        shape: Shape = tuple(inputs[0].shape)
        described = len(self._mean), len(self._std)
        self._channels = shape[1] if len(shape) == 4 and isinstance(shape[1], int) else max(described)
        if len(shape) != 4 or self._channels not in (1, 3):
            raise self._misfit(f"its input is {_words(shape)}")
        if not {*described} <= {1, self._channels}:
            raise FileFormatError(f"{self.path}: mean and std of {json_path.name} must be one number, or {self._channels}. Correct them.")
        rows, columns = shape[2:]
        stated = (rows, columns) if isinstance(rows, int) and isinstance(columns, int) else None
        self._size = self.description.input_size or stated
        self._probability(np.zeros(self._size or (256, 256), dtype=np.float32))

    def estimate(self, frame: TrackedFrame) -> Prediction | None:
        """See `BoneEstimator`; raises FileFormatError when the model fails at it, or answers what is no probability."""
        image = frame.placed()[0]
        white = white_of(image) or WHITE_OF_FLOATS
        return Prediction(self._probability(_resized(image.astype(np.float32) / np.float32(white), self._size), frame.number))

    def notes(self) -> tuple[str, ...]:
        """Which model it is."""
        return (f"Bone is what the model {self.path.name} says.",)

    def _probability(self, image: Singles, number: int | None = None) -> Singles:
        """Of an image of the model's size, 0 black and 1 white."""
        given = np.broadcast_to((image[None] - self._mean) / self._std, (self._channels, *image.shape))[None]
        try:
            answer = np.asarray(self._session.run([self._output], {self._input: np.ascontiguousarray(given)})[0])
        except Exception as error:  # onnxruntime has classes of its own for each failure
            raise FileFormatError(
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
            raise FileFormatError(
                f"{self.path}: its answer of {_words(answer.shape)} has no class {wanted} of several. Correct output and bone_class in "
                "the JSON file beside it."
            )
        bone: Singles = values[wanted]
        where = "" if number is None else f" in frame {number}"
        if not np.isfinite(bone).all():
            raise FileFormatError(f"{self.path}: the model answers NaN or infinity{where}. Export it again, or use another.")
        if number is not None and (float(bone.min()) < -ROUNDING or float(bone.max()) > 1 + ROUNDING):
            raise FileFormatError(
                f"{self.path}: the model answers {float(bone.min()):g} to {float(bone.max()):g}{where}, which is no probability. Say "
                '"output": "logits" in the JSON file beside it.'
            )
        return np.clip(bone, 0.0, 1.0)

    def _misfit(self, what: str) -> FileFormatError:
        return FileFormatError(
            f"{self.path}: {what}, and a model of bone takes one image of 1 x 1 x H x W or 1 x 3 x H x W floats and answers with 1 x N "
            "x H x W. Export it with these."
        )


def _session(path: Path, threads: int) -> Any:  # onnxruntime has no types
    """A session that runs the model in this file."""
    try:
        runtime = import_module("onnxruntime")
    except ImportError:
        raise FileFormatError(
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
        raise FileFormatError(
            f"{path}: onnxruntime {runtime.__version__} cannot run this model ({_reason(error)}). Export it as ONNX with "
            "standard operators that this version has."
        ) from error


def _reason(error: Exception) -> str:
    """What onnxruntime says, without its place in a source file."""
    line = " ".join(str(error).split())
    return shorten(line.split(" : ", 3)[-1], 200).rstrip(". ")


def _words(shape: tuple[object, ...]) -> str:
    return " x ".join("?" if side is None else str(side) for side in shape)


def _resized(image: Singles, size: tuple[int, int] | None) -> Singles:
    """An image of so many rows and columns: linear between pixels, which are smoothed before where it makes fewer."""
    if size is None or size == image.shape:
        return image
    scale = np.array(image.shape) / size
    smooth = scipy.ndimage.gaussian_filter(image, np.maximum(scale - 1, 0) / 2, mode="nearest")
    resized: Singles = scipy.ndimage.zoom(smooth, 1 / scale, order=1, mode="nearest", grid_mode=True)
    return resized
