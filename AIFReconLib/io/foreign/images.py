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
from ...message import Message, one_line
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
            raise FileFormatError(
                "{where}: {count} frames of {bytes} bytes are beyond the limits. Split the recording.",
                where=where(0),
                count=count,
                bytes=first.nbytes,
            )

    def _image(self, index: int) -> Numbers:
        image = self._gray(index)
        if image.shape != self.shape[1:] or image.dtype != self.dtype:
            raise FileFormatError(
                "{where}: every frame must have {expected} as the first; got {found}. Export all frames alike.",
                where=self._where(index),
                expected=_words(self.shape[1:], self.dtype),
                found=_words(image.shape, image.dtype),
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
            raise FileFormatError(
                "{where}: a frame must be an image of gray levels or colors; got shape {shape}.",
                where=self._where(index),
                shape=image.shape,
            )
        if image.dtype == bool:
            image = image.astype(np.uint8) * np.uint8(255)
        if image.dtype.kind not in "iuf" or image.dtype.itemsize > 8 or image.dtype == np.float16:
            raise FileFormatError(
                "{where}: pixels must be whole numbers or floats; got {kind}. Convert the images.",
                where=self._where(index),
                kind=image.dtype,
            )
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


def library(name: str, purpose: Message) -> ModuleType:
    """An optional package, or an error that says how to get it."""
    package = name.split(".")[0]
    try:
        return import_module(name)
    except ImportError:
        raise FileFormatError(
            "{purpose} cannot be read without the Python package {package}. Install it: pip install {package}.",
            purpose=purpose,
            package=_INSTALLED_AS.get(package, package),
        ) from None


@contextlib.contextmanager
def decoding(what: Message, advice: Message) -> Iterator[None]:
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
        raise FileFormatError(
            "{what} ({cause}). {advice}", what=what, cause=one_line(str(error))[:200] or type(error).__name__, advice=advice
        ) from error


def describe_stack(count: int, what: str, shape: tuple[int, ...], dtype: NumberType) -> str:
    """``12 PNG pictures of 640 x 480 pixels, uint8``."""
    return f"{count} {what} of {_words(shape, dtype)}"


def _words(shape: tuple[int, ...], dtype: NumberType) -> Message:
    return Message("{columns} x {rows} pixels, {kind}", columns=shape[1], rows=shape[0], kind=np.dtype(dtype).name)
