"""A process of its own that runs a model, which is a program: it may run on and on, take all memory or crash, and must end nobody else."""

from __future__ import annotations

import contextlib
import faulthandler
import json
import os
import subprocess
import sys
import threading
import weakref
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import IO, Any, cast

import numpy as np

from ...arrays import Numbers, Singles
from ...errors import ModelError
from ...machine.processes import Process, start_python
from ...message import shorten

LONGEST = 30.0
"""s that a model may take to load, and then for an image."""

MOST_MEMORY = 4_000_000_000
"""Bytes that a model may take beside three times its own, where the system can hold it to that (Linux)."""

MOST_ANSWER = 2**28
"""Bytes of an answer."""


class ModelProcess:
    """A session of onnxruntime in another process, ended with this object.

    `path` is for sentences, `data` the model, `threads` are onnxruntime's.

    Raises ModelError when the model cannot be run.

    Attributes
    ----------
    inputs : list of (name, type, shape)
    outputs : list of str
    """

    def __init__(self, path: Path, data: bytes, threads: int):
        self._path, self._turn = path, threading.Lock()
        try:
            self._process = start_python(__name__, serve.__name__, stream=subprocess.PIPE)
        except OSError as error:
            raise ModelError(f"{path}: no process can be started to run the model ({error!s}). Close other programs.") from None
        self.end = weakref.finalize(self, _end, self._process)
        facts, _ = self._answer({"threads": threads, "seconds": LONGEST, "memory": MOST_MEMORY + 3 * len(data)}, data)
        if "error" in facts:
            self.end()
            version, why = facts.get("version"), _reason(str(facts["error"]))
            raise ModelError(
                f"{path}: onnxruntime {version} cannot run this model ({why}). Export it with standard operators that this version has."
            )
        self.inputs: list[tuple[str, str, list[int | str | None]]] = facts["inputs"]
        self.outputs: list[str] = facts["outputs"]

    def run(self, image: Singles) -> Numbers:
        """What the first output is for an image, (1, channels, rows, columns).

        Raises ModelError when the model fails, or takes more time or memory than it may.
        """
        facts, data = self._answer({"shape": image.shape}, np.ascontiguousarray(image, dtype=np.float32).tobytes())
        if "error" in facts:
            shape, why = " x ".join(map(str, image.shape)), _reason(str(facts["error"]))
            raise ModelError(
                f"{self._path}: the model fails with an input of {shape} ({why}). Check input_size in the JSON file beside it."
            )
        answer: Numbers = np.frombuffer(data, np.dtype(facts["kind"])).reshape(facts["shape"])
        return answer

    def _answer(self, told: dict[str, Any], data: bytes) -> tuple[dict[str, Any], bytes]:
        """What the process answers to a line and bytes: the same."""
        asking, answering = cast("tuple[IO[bytes], IO[bytes]]", (self._process.stdin, self._process.stdout))
        try:
            with self._turn:
                _send(asking, told, data)
                return _received(answering)
        except BaseException as error:
            self.end()
            if not isinstance(error, (OSError, ValueError, EOFError)):
                raise
            raise ModelError(
                f"{self._path}: the model was ended: it takes more than {LONGEST:g} s or more memory than it may, or crashes. Use another."
            ) from None


def _end(process: Process) -> None:
    process.kill()
    # Closes its streams, one of which may still hold what it was to be told
    with contextlib.suppress(OSError), process:
        pass


def _send(stream: IO[bytes], told: dict[str, Any], data: bytes) -> None:
    stream.write(json.dumps({**told, "length": len(data)}).encode() + b"\n")
    stream.write(data)
    stream.flush()


def _received(stream: IO[bytes]) -> tuple[dict[str, Any], bytes]:
    told: dict[str, Any] = json.loads(stream.readline(2**20))
    data = stream.read(told["length"])
    if len(data) != told["length"]:
        raise EOFError
    return told, data


def _reason(error: str) -> str:
    """What onnxruntime says, without its place in a source file."""
    line = " ".join(error.split())
    return shorten(line.split(" : ", 3)[-1], 200).rstrip(". ")


# ---- in the other process


def serve() -> None:
    """Load the model that comes, and answer images until no more come."""
    # What libraries print must not be taken for an answer
    asked, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    told, data = _received(asked)
    with _within(told["seconds"]):
        runtime = import_module("onnxruntime")
        # Refused where less is allowed already, and not there on Windows
        with contextlib.suppress(ImportError, OSError, ValueError):
            resource = import_module("resource")
            resource.setrlimit(resource.RLIMIT_DATA, (told["memory"], told["memory"]))
        try:
            session = _session(runtime, data, told["threads"])
            inputs = [(each.name, each.type, each.shape) for each in session.get_inputs()]
            outputs = [each.name for each in session.get_outputs()]
        except Exception as error:  # onnxruntime has classes of its own for each failure
            _send(answers, {"error": str(error), "version": runtime.__version__}, b"")
            return
    seconds = told["seconds"]
    _send(answers, {"inputs": inputs, "outputs": outputs}, b"")
    while True:
        told, data = _received(asked)
        with _within(seconds):
            try:
                image = np.frombuffer(data, np.float32).reshape(told["shape"])
                answer = np.asarray(session.run(outputs[:1], {inputs[0][0]: image})[0])
                if answer.dtype.kind not in "fiub" or answer.nbytes > MOST_ANSWER:
                    raise ValueError(f"its answer is {answer.dtype} of {answer.shape}")
            except Exception as error:
                _send(answers, {"error": str(error)}, b"")
                continue
        _send(answers, {"kind": answer.dtype.str, "shape": answer.shape}, answer.tobytes())


@contextlib.contextmanager
def _within(seconds: float) -> Iterator[None]:
    """End this process, whatever holds it, when the block takes longer."""
    faulthandler.dump_traceback_later(seconds, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


def _session(runtime: Any, data: bytes, threads: int) -> Any:  # onnxruntime has no types
    """A session that runs a model."""
    options = runtime.SessionOptions()
    options.intra_op_num_threads, options.inter_op_num_threads = threads, 1
    # Threads that wait for work would take the cores from the reconstruction
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    # Given as bytes, a file of its own format would be taken too
    options.add_session_config_entry("session.load_model_format", "ONNX")
    options.log_severity_level = 4
    return runtime.InferenceSession(data, options, providers=["CPUExecutionProvider"])
