"""Images that a function decodes one at a time, and what decoders share: optional packages, errors of one line, streams that go back."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Callable, Generator, Iterator
from importlib import import_module
from itertools import islice
from types import ModuleType
from typing import Generic, TypeVar

import numpy as np

from ...arrays import Numbers, NumberType
from ...errors import AIFReconError, FileFormatError
from ...imaging.images import ImagesOnDemand, luminance
from .file_images import MAXIMUM_FRAME_BYTES, MAXIMUM_FRAMES

_INSTALLED_AS = {"PIL": "Pillow", "imageio_ffmpeg": "imageio-ffmpeg"}
"""What pip calls a package whose import has another name."""

Item = TypeVar("Item")


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
        self.shape: tuple[int, ...] = (count,)
        self.dtype: NumberType = np.dtype(np.uint8)
        first = self._gray(0)
        self.shape, self.dtype = (count, *first.shape), first.dtype
        if count > MAXIMUM_FRAMES or first.nbytes > MAXIMUM_FRAME_BYTES:
            raise FileFormatError(f"{where(0)}: {count} frames of {first.nbytes} bytes are beyond the limits. Split the recording.")

    def _image(self, index: int) -> Numbers:
        image = self._gray(index)
        if image.shape != self.shape[1:] or image.dtype != self.dtype:
            first, here = in_pixels(self.shape[1:], self.dtype), in_pixels(image.shape, image.dtype)
            raise FileFormatError(f"{self._where(index)}: every frame must have {first} as the first; got {here}. Export all alike.")
        return image

    def _gray(self, index: int) -> Numbers:
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
        return np.array(image, dtype=image.dtype.newbyteorder("="), order="C")


def library(name: str, purpose: str) -> ModuleType:
    """An optional package, or an error that says how to get it."""
    package = name.split(".")[0]
    package = _INSTALLED_AS.get(package, package)
    try:
        return import_module(name)
    except ImportError:
        needs = f"{purpose} cannot be read without the Python package {package}"
        raise FileFormatError(f"{needs}. Install it: pip install {package}.") from None


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


class Forward(Generic[Item]):
    """What a generator yields, by number: it is read on from the one before. Going back, or on after a failure, begins it anew."""

    def __init__(self, begin: Callable[[], Generator[Item, None, None]]):
        self._begin, self._items = begin, begin()
        self._next: float = 0

    def __getitem__(self, number: int) -> Item:
        if number < self._next:
            self.close()
            self._items, self._next = self._begin(), 0
        items = islice(self._items, int(number - self._next), None)
        self._next = np.inf
        for item in items:
            self._next = number + 1
            return item
        raise ValueError(f"it ends before frame {number}")

    def close(self) -> None:
        """End what is under way."""
        self._items.close()


def in_pixels(shape: tuple[int, ...], dtype: NumberType) -> str:
    """``640 x 480 pixels, uint8``."""
    return f"{shape[1]} x {shape[0]} pixels, {np.dtype(dtype).name}"
