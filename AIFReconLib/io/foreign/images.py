"""Images of people without Plus, and what their decoders share: frames decoded one at a time, optional packages, errors of one line."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType

import numpy as np

from ...arrays import Floats, Numbers, NumberType
from ...errors import AIFReconError, FileFormatError
from ...imaging.images import ImageStack, luminance
from ..sequence.file_images import MAXIMUM_FRAME_BYTES, MAXIMUM_FRAMES
from ..sequence.images_on_demand import ImagesOnDemand

_INSTALLED_AS = {"PIL": "Pillow", "imageio_ffmpeg": "imageio-ffmpeg"}
"""What pip calls a package whose import has another name."""


@dataclass(frozen=True, eq=False)
class ImportedImages:
    """Frames, and what their files say of them.

    Parameters
    ----------
    stack : ImageStack
    description : str
        "12 PNG pictures of 640 x 480 pixels, uint8".
    names : tuple of str or None
        File name of each frame, where each has a file of its own.
    times : (frames,) array or None, s
    spacing : (x, y) or None, mm
        Size of a pixel.
    unknown_spacing, unknown_order : str or None
        Why the size of a pixel, or the order of the images, is not known though files speak of it: half a sentence.
    """

    stack: ImageStack
    description: str
    names: tuple[str, ...] | None = None
    times: Floats | None = None
    spacing: tuple[float, float] | None = None
    unknown_spacing: str | None = None
    unknown_order: str | None = None


class DecodedImages(ImagesOnDemand):
    """An `ImageStack` over a function that decodes one frame.

    Parameters
    ----------
    count : int
    decode : callable of int
        The frame as (rows, columns) or (rows, columns, 3 or 4).
    where : callable of int
        What to call a frame in a message: its file, and its number in it.

    Notes
    -----
    Size and type are those of the first frame; a frame that differs is an error that names it. Colors become luminance.
    """

    def __init__(self, count: int, decode: Callable[[int], Numbers], where: Callable[[int], str]):
        self._decode, self._where = decode, where
        self._last: tuple[int, Numbers] | None = None
        self.shape: tuple[int, ...] = (count,)
        self.dtype: NumberType = np.dtype(np.uint8)
        first = self._gray(0)
        self.shape, self.dtype = (count, *first.shape), first.dtype
        if count > MAXIMUM_FRAMES or first.nbytes > MAXIMUM_FRAME_BYTES:
            raise FileFormatError(f"{where(0)}: {count} frames of {first.nbytes} bytes are beyond the limits. Split the recording.")

    def _image(self, index: int) -> Numbers:
        image = self._gray(index)
        if image.shape != self.shape[1:] or image.dtype != self.dtype:
            raise FileFormatError(
                f"{self._where(index)}: every frame must have {_words(self.shape[1:], self.dtype)} as the first; got "
                f"{_words(image.shape, image.dtype)}. Export all frames alike."
            )
        return image

    def _gray(self, index: int) -> Numbers:
        if self._last is not None and self._last[0] == index:
            return self._last[1].copy()
        image = np.asarray(self._decode(index))
        if image.ndim == 3 and image.shape[2] in (1, 2):
            image = image[..., 0]  # gray, with transparency or without
        if image.ndim == 3 and image.shape[2] in (3, 4):
            image = luminance(image)
        if image.ndim != 2 or not image.size:
            raise FileFormatError(f"{self._where(index)}: a frame must be an image of gray levels or colors; got shape {image.shape}.")
        if image.dtype == bool:
            image = image.astype(np.uint8) * np.uint8(255)
        if image.dtype.kind not in "iuf" or image.dtype.itemsize > 8 or image.dtype == np.float16:
            raise FileFormatError(f"{self._where(index)}: pixels must be whole numbers or floats; got {image.dtype}. Convert the images.")
        image = np.array(image, dtype=image.dtype.newbyteorder("="), order="C")
        self._last = (index, image)
        return image.copy()


class FlippedImages:
    """Another stack's images, turned to MF orientation from what they are."""

    def __init__(self, stack: ImageStack, orientation: str):
        self._stack = stack
        self._flips = (slice(None, None, -1 if orientation[1] == "N" else 1), slice(None, None, -1 if orientation[0] == "U" else 1))
        self.shape, self.dtype = stack.shape, stack.dtype

    def __len__(self) -> int:
        return len(self._stack)

    def __getitem__(self, index: int) -> Numbers:
        return np.ascontiguousarray(self._stack[index][self._flips])


def library(name: str, purpose: str) -> ModuleType:
    """An optional package, or an error that says how to get it."""
    package = name.split(".")[0]
    try:
        return import_module(name)
    except ImportError:
        raise FileFormatError(
            "{purpose} cannot be read without the Python package {package}. Install it: pip install {package}.".format(
                purpose=purpose, package=_INSTALLED_AS.get(package, package)
            )
        ) from None


@contextlib.contextmanager
def decoding(what: str, advice: str) -> Iterator[None]:
    """Turn whatever another package's decoder raises into an error of one line.

    Parameters
    ----------
    what : Message
        File, frame and what cannot be done: ``"a.png: it cannot be read as a picture"``.
    advice : Message
        What to do.

    Notes
    -----
    Decoders meet damaged files with exceptions of every type, and with warnings; here both are the file's fault.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except AIFReconError:
        raise
    except Exception as error:
        raise FileFormatError(f"{what} ({str(error)[:200] or type(error).__name__}). {advice}") from error


def describe_stack(count: int, what: str, shape: tuple[int, ...], dtype: NumberType) -> str:
    """``12 PNG pictures of 640 x 480 pixels, uint8``."""
    return f"{count} {what} of {_words(shape, dtype)}"


def _words(shape: tuple[int, ...], dtype: NumberType) -> str:
    return f"{shape[1]} x {shape[0]} pixels, {np.dtype(dtype).name}"
