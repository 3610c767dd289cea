"""Models of a few operators, made with the onnx package: the rule for echoes as a graph, and others that must be refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper
from scipy import ndimage

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


def echo_score(rows: int, columns: int, spacing: tuple[float, float]) -> onnx.ModelProto:
    """The score of `BoneEchoFinder` on whole images of a linear probe, from its definition; 0 near skin, sides and end.

    The Gaussians are scipy's response to one bright sample; the image goes in as gray levels.
    """
    sigma = np.array([0.4 / spacing[1], 0.8 / spacing[0]])
    reach = (4 * sigma + 0.5).astype(int)
    dot = np.zeros(2 * reach + 1, np.float32)
    dot[tuple(reach)] = 1.0
    gaussian = ndimage.gaussian_filter(dot, sigma)
    # Shadow: the mean from 1 to 10 mm behind, of what lies in the image
    first, stop = (round(mm / spacing[1]) for mm in (1.0, 10.0))
    behind = np.zeros((rows, rows), np.float32)
    for row in range(rows):
        within = behind[row, min(row + first, rows) : min(row + stop, rows)]
        within[:] = 1.0 / max(len(within), 1)
    depth = np.arange(rows) * spacing[1]
    left = np.minimum(np.arange(rows) + stop, rows) - np.minimum(np.arange(rows) + first, rows)
    across = np.arange(columns)
    inner = np.minimum(across, across[::-1]) >= round(2.0 / spacing[0])
    eligible = (((depth >= 8.0) & (left * spacing[1] >= 3.0))[:, None] & inner).astype(np.float32)
    mirrored = [np.pad(np.arange(n), r, mode="symmetric") for n, r in zip((rows, columns), reach, strict=True)]
    node = helper.make_node
    return graph_of(
        [
            node("Gather", ["image", "rows"], ["tall"], axis=2),
            node("Gather", ["tall", "columns"], ["wide"], axis=3),
            node("Conv", ["wide", "gaussian"], ["e"]),
            node("MatMul", ["behind", "image"], ["b"]),
            node("Sub", ["e", "b"], ["contrast"]),
            node("Add", ["e", "b"], ["both"]),
            node("Add", ["both", "faint"], ["all"]),
            node("Div", ["contrast", "all"], ["score"]),
            node("Mul", ["score", "eligible"], ["signed"]),
            node("Relu", ["signed"], ["bone"]),
        ],
        {
            "rows": mirrored[0],
            "columns": mirrored[1],
            "gaussian": gaussian[None, None],
            "behind": behind[None, None],
            "faint": np.float32(55.0),
            "eligible": eligible[None, None],
        },
        [1, 1, rows, columns],
        [1, 1, rows, columns],
    )
