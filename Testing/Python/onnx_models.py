"""Models of a few operators, made with the onnx package: the rule for echoes as a graph, and others that must be refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

OPSET = 17


def graph_of(nodes, constants, input_shape, output_shape, output_type=TensorProto.FLOAT) -> onnx.ModelProto:
    """A model from ``image`` to ``bone``."""
    tensors = [numpy_helper.from_array(np.asarray(value), name) for name, value in constants.items()]
    given = helper.make_tensor_value_info("image", TensorProto.FLOAT, input_shape)
    answer = helper.make_tensor_value_info("bone", output_type, output_shape)
    graph = helper.make_graph(nodes, "bone", [given], [answer], tensors)
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=8)


def saved(model: onnx.ModelProto, path: Path, **external) -> Path:
    """The model in a file."""
    onnx.save(model, path, **external)
    return path


def scaling(factor=1.0, shift=0.0, shape=(1, 1, None, None), channels=1) -> onnx.ModelProto:
    """Answers with the image times a factor, in so many channels."""
    weights = np.full((channels, shape[1] or 1, 1, 1), factor, np.float32)
    sides = [name if side is None else side for name, side in zip("nchw", shape, strict=True)]
    return graph_of(
        [helper.make_node("Conv", ["image", "weights", "shift"], ["bone"])],
        {"weights": weights, "shift": np.full(channels, shift, np.float32)},
        sides,
        [sides[0], channels, *sides[2:]],
    )
