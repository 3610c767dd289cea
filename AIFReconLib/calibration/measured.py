"""A first calibration from what a ruler measures: good to some 10 mm and degrees, to be made exact by `calibrate`."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Matrix
from ..errors import SettingsError
from ..geometry.transforms import affine

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

LEAST_ANGLE_DEG = 45.0
"""What is measured as right and down of the image may be off, but not by so much that they do not tell a plane."""


def measured_calibration(pixel: float, face_px: tuple[float, float], face_mm: tuple[float, float, float], right: str, down: str) -> Matrix:
    """Image to probe, pixels (column, row) to mm, (4, 4) float64.

    Parameters
    ----------
    pixel : float, mm
        Size of a pixel: a length on the scanner's depth scale by the rows that it takes.
    face_px : (column, row)
        The middle of the probe's face in the images.
    face_mm : (x, y, z), mm
        The same, measured from the marker's origin along the marker's axes.
    right, down : str
        Where the images' columns and rows increase to (the marked side is on the right, the body below), as an axis of the marker,
        such as "x" or "-z", or as x, y and z of a direction between, such as "0.9,0,-0.4". What of `down` runs along `right` is left out.

    Raises SettingsError when they are no two directions, or the pixel has no size.
    """
    ways = [_direction("right", right), _direction("down", down)]
    if abs(float(ways[0] @ ways[1])) > np.cos(np.radians(LEAST_ANGLE_DEG)):
        raise SettingsError(f"Inputs right and down must be two different axes of the marker, or directions; got {right} and {down}.")
    if not (np.isfinite([pixel, *face_px, *face_mm]).all() and pixel > 0):
        raise SettingsError("A pixel has a size above 0 mm, and places are finite numbers.")
    ways[1] = ways[1] - ways[0] * (ways[0] @ ways[1])
    ways[1] /= np.linalg.norm(ways[1])
    linear = pixel * np.column_stack([*ways, np.cross(ways[0], ways[1])])
    return affine(linear, np.asarray(face_mm) - linear[:, :2] @ np.asarray(face_px))


def _direction(name: str, words: str) -> Floats:
    """The direction that is named, of length 1."""
    sign = -1.0 if words.startswith("-") and words.lstrip("+-") in AXES else 1.0
    try:
        numbers = AXES.get(words.lstrip("+-")) or tuple(map(float, words.split(",")))
    except ValueError:
        numbers = ()
    way: Floats = sign * np.array(numbers)
    if len(numbers) != 3 or not np.isfinite(way).all() or not way.any():
        raise SettingsError(f"Input {name} must be an axis of the marker (x, -x, y, -y, z or -z) or X,Y,Z of a direction; got {words}.")
    return way / np.linalg.norm(way)
