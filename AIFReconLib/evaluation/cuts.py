"""Cuts through a reconstruction as PNG pictures, without matplotlib: for pages that are made where it is not installed."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Bytes, Floats
from ..geometry.volume import Volume
from ..inspection.enhancement_map import BANDS
from .figures import BONE_COLOR, CT_WINDOW, NOT_SCANNED
from .preview import middle_of_bone
from .slices import Plane, cut, planes, whole_cut

PIXELS = 420
"""Along the longest side of a cut."""

CT_DIMMED = 0.45
"""Brightness of the CT where nothing was scanned, so that nobody takes it for ultrasound."""

RAISED, MOST_RAISED = (168.0, 56.0, 242.0), 0.55
"""Color of the tint, and its opacity in the last band."""


@dataclass(frozen=True, eq=False)
class Scene:
    """What is cut: volumes placed in Reference.

    Parameters
    ----------
    shown : Volume
        The reconstruction, or its plain mean.
    window : (float, float)
        Gray levels shown black and white.
    labels : Volume or None
        Segmentation of the CT, drawn as an outline.
    ct : Volume of HU or None
        Shown, dimmed, where `shown` is 0.
    bands : Volume or None
        Of `raised_bands`, drawn as a tint.
    """

    shown: Volume
    window: tuple[float, float]
    labels: Volume | None = None
    ct: Volume | None = None
    bands: Volume | None = None

    def middle(self) -> Floats:
        """Where the cuts meet by default, (3,) mm: the middle of the bone that was seen."""
        return middle_of_bone(self.shown, self.shown.array != 0, self.labels)


def cut_pictures(scene: Scene, center: Floats | None = None) -> list[tuple[str, bytes]]:
    """Axial, sagittal and coronal cut, or those across the axes where no CT tells how the patient lies; each with a caption and as PNG.

    Parameters
    ----------
    center : (3,) array or None, mm
        Where the cuts meet; by default `Scene.middle`.
    """
    place = scene.middle() if center is None else center
    ways = planes(patient=scene.labels is not None or scene.ct is not None)
    captions = (f"{plane.name.capitalize()}: {plane.edges[0]} is left, {plane.edges[2]} is up" for plane in ways)
    return [(caption, png(_colors(scene, plane, place))) for caption, plane in zip(captions, ways, strict=True)]


def _colors(scene: Scene, plane: Plane, center: Floats) -> Bytes:
    """(rows, columns, 3) uint8."""
    middle, size = whole_cut(scene.shown.grid, plane, center)

    def sampled(volume: Volume, order: int = 0) -> Floats:
        return np.nan_to_num(cut(volume, plane, middle, *size, max(size) / PIXELS, order=order))

    levels = sampled(scene.shown)
    picture = np.repeat(_gray(levels, scene.window)[..., None], 3, axis=2)
    empty = levels == 0
    if scene.ct is not None:
        picture[empty] = CT_DIMMED * _gray(sampled(scene.ct, 1), CT_WINDOW)[empty][:, None]
    else:
        picture[empty] = _rgb(NOT_SCANNED)
    if scene.bands is not None:
        opacity = (sampled(scene.bands) * (MOST_RAISED / len(BANDS)))[..., None]
        picture = (1 - opacity) * picture + opacity * np.array(RAISED)
    if scene.labels is not None:
        inside = sampled(scene.labels) > 0
        picture[inside & ~scipy.ndimage.binary_erosion(inside, border_value=1)] = _rgb(BONE_COLOR)
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


def _gray(levels: Floats, window: tuple[float, float]) -> Floats:
    low, high = window
    gray: Floats = np.clip((levels - low) / max(high - low, 1e-9), 0.0, 1.0) * 255.0
    return gray


def _rgb(color: str) -> tuple[int, ...]:
    return tuple(bytes.fromhex(color[1:]))


def png(pixels: Bytes) -> bytes:
    """A PNG file of (rows, columns, 3) uint8 pixels.

    References
    ----------
    .. [1] ISO/IEC 15948, Portable Network Graphics.
    """
    rows, columns, _channels = pixels.shape
    # Every row begins with its filter: none
    lines = np.concatenate([np.zeros((rows, 1), dtype=np.uint8), pixels.reshape(rows, -1)], axis=1).tobytes()
    header = struct.pack(">2I5B", columns, rows, 8, 2, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(lines, 6)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + _check(kind + data) for kind, data in parts)


def _check(data: bytes) -> bytes:
    return struct.pack(">I", zlib.crc32(data))
