"""Images of people without Plus, opened one at a time: pictures, DICOM, video, numpy."""

from __future__ import annotations

import contextlib
import operator
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import AIFReconError, FileFormatError
from ..frames import ImageStack
from .file_images import MAXIMUM_FRAME_BYTES, MAXIMUM_FRAMES, luminance
from .metafile import require_regular_file
from .text_values import one_line

PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")
DICOM_SUFFIXES = (".dcm", ".dicom")
VIDEO_SUFFIXES = (".mp4", ".avi", ".mov", ".mkv", ".wmv", ".m4v", ".webm")
NUMPY_SUFFIXES = (".npy",)


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
    """

    stack: ImageStack
    description: str
    names: tuple[str, ...] | None = None
    times: np.ndarray | None = None
    spacing: tuple[float, float] | None = None


class DecodedImages:
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

    def __init__(self, count: int, decode: Callable[[int], np.ndarray], where: Callable[[int], str]):
        self._decode, self._where = decode, where
        self._last: tuple[int, np.ndarray] | None = None
        self.shape: tuple[int, ...] = (count,)
        self.dtype = np.dtype(np.uint8)
        first = self._gray(0)
        self.shape, self.dtype = (count, *first.shape), first.dtype
        if count > MAXIMUM_FRAMES or first.nbytes > MAXIMUM_FRAME_BYTES:
            raise FileFormatError(f"{where(0)}: {count} frames of {first.nbytes} bytes are beyond the limits. Split the recording.")

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: int) -> np.ndarray:
        index = operator.index(index)
        if not -len(self) <= index < len(self):
            raise IndexError(f"Input frame must be below {len(self)}; got {index}.")
        image = self._gray(index % len(self))
        if image.shape != self.shape[1:] or image.dtype != self.dtype:
            raise FileFormatError(
                f"{self._where(index % len(self))}: every frame must have {_words(self.shape[1:], self.dtype)} as the first; "
                f"got {_words(image.shape, image.dtype)}. Export all frames alike."
            )
        return image

    def _gray(self, index: int) -> np.ndarray:
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

    def __getitem__(self, index: int) -> np.ndarray:
        return np.ascontiguousarray(self._stack[index][self._flips])


def open_images(paths: Sequence[str | Path]) -> ImportedImages:
    """The frames in these files, in natural order of their names (2 before 10).

    Parameters
    ----------
    paths : sequence of str or Path
        Pictures or DICOM files, or a folder of them; or one video, multi-frame DICOM file or .npy array (frames, rows, columns).

    Raises
    ------
    FileFormatError
        Names the file, and what was expected.
    """
    files = _listed([Path(path) for path in paths])
    suffixes = {path.suffix.lower() for path in files}
    kind = next((k for k in _KINDS if suffixes <= set(k[0])), None)
    if kind is None:
        known = ", ".join(suffix for known, _ in _KINDS for suffix in known)
        raise FileFormatError(
            f"{files[0]}: images must all be pictures, DICOM files, one video or one .npy array ({known}); "
            f"got {', '.join(sorted(suffixes)) or 'no suffix'}. Give files of one kind."
        )
    return kind[1](files)


def natural_order(path: Path) -> list:
    """A key that sorts 2 before 10."""
    return [int(word) if word.isdigit() else word.lower() for word in re.split(r"([0-9]+)", path.name)]


def library(name: str, purpose: str):
    """An optional package, or an error that says how to get it."""
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError:
        raise FileFormatError(
            f"{purpose} cannot be read without the Python package {name.split('.')[0]}. Install it: pip install aifrecon[import]."
        ) from None


@contextlib.contextmanager
def decoding(what: str, advice: str) -> Iterator[None]:
    """Turn whatever another package's decoder raises into an error of one line.

    Parameters
    ----------
    what : str
        File, frame and what cannot be done: ``"a.png: it cannot be read as a picture"``.
    advice : str
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
        raise FileFormatError(f"{what} ({one_line(str(error))[:200] or type(error).__name__}). {advice}") from error


def describe_stack(count: int, what: str, shape: tuple[int, ...], dtype) -> str:
    """``12 PNG pictures of 640 x 480 pixels, uint8``."""
    return f"{count} {what} of {_words(shape, dtype)}"


def _words(shape: tuple[int, ...], dtype) -> str:
    return f"{shape[1]} x {shape[0]} pixels, {np.dtype(dtype).name}"


def _listed(paths: list[Path]) -> list[Path]:
    """The files, folders replaced by what is in them."""
    known = {suffix for suffixes, _ in _KINDS for suffix in suffixes}
    files: list[Path] = []
    for path in paths:
        if path.is_dir():
            inside = sorted((p for p in path.iterdir() if p.is_file() and p.suffix.lower() in known), key=natural_order)
            if not inside:
                raise FileFormatError(f"{path}: there are no images in this folder. Give a folder of pictures or DICOM files.")
            files += inside
        else:
            require_regular_file(path, FileFormatError)
            files.append(path)
    if not files:
        raise FileFormatError("Input images must be at least one file. Name pictures, a folder, a video or a .npy file.")
    return files


def _open_numpy(files: list[Path]) -> ImportedImages:
    path = _only(files, "array")
    with decoding(f"{path}: numpy cannot read it", "Save the array again with numpy.save."):
        array = np.load(path, mmap_mode="r", allow_pickle=False)
    if array.ndim not in (3, 4) or (array.ndim == 4 and array.shape[3] not in (1, 3, 4)) or not array.size:
        raise FileFormatError(
            f"{path}: the array must have shape (frames, rows, columns) or (frames, rows, columns, 3); got {array.shape}. Transpose it."
        )
    stack = DecodedImages(len(array), lambda n: array[n], lambda n: f"{path}, frame {n}")
    return ImportedImages(stack, describe_stack(len(array), "frames", stack.shape[1:], stack.dtype) + f" in {path.name}")


def _only(files: list[Path], what: str) -> Path:
    if len(files) != 1:
        raise FileFormatError(f"{files[1]}: there must be one {what}; got {len(files)} files. Import them one by one.")
    return files[0]


def _open_pictures(files: list[Path]) -> ImportedImages:
    from .pictures import open_pictures

    return open_pictures(files)


def _open_dicom(files: list[Path]) -> ImportedImages:
    from .dicom_images import open_dicom

    return open_dicom(files)


def _open_video(files: list[Path]) -> ImportedImages:
    from .video_images import open_video

    return open_video(_only(files, "video"))


_KINDS = (
    (PICTURE_SUFFIXES, _open_pictures),
    (DICOM_SUFFIXES, _open_dicom),
    (VIDEO_SUFFIXES, _open_video),
    (NUMPY_SUFFIXES, _open_numpy),
)
