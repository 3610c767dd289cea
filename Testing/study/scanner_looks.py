"""One sweep as other settings of a scanner would show it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

GRAY_LEVELS_OF_8_DB = 34.0
"""8 dB of the 60 dB that 255 gray levels hold."""


def _gray(values: np.ndarray) -> np.ndarray:
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def _depth_gain(frames: np.ndarray) -> np.ndarray:
    depth = np.linspace(0.0, 1.0, frames.shape[1])[None, :, None]
    return _gray(frames + 1.5 * GRAY_LEVELS_OF_8_DB * depth * (frames > 0))


LOOKS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "as recorded": lambda frames: frames,
    "gray curve 0.6": lambda frames: _gray(255.0 * (frames / 255.0) ** 0.6),
    "gray curve 1.6": lambda frames: _gray(255.0 * (frames / 255.0) ** 1.6),
    "gain +8 dB of 60": lambda frames: _gray(frames + GRAY_LEVELS_OF_8_DB * (frames > 0)),
    "gain -8 dB of 60": lambda frames: _gray(frames - GRAY_LEVELS_OF_8_DB),
    "depth gain +12 dB at the bottom": _depth_gain,
}
"""From frames (n, rows, columns) uint8, black outside of the image, to the same as a scanner with that setting shows them."""
