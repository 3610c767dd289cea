"""Images of people without Plus, as they are handed to the import."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Floats
from ...errors import SettingsError
from ...imaging.images import ImageStack
from ..sequence.decoded_images import DecodedImages, in_pixels


@dataclass(frozen=True, eq=False)
class ImportedImages:
    """Frames, and what their files say of them.

    Parameters
    ----------
    stack : ImageStack
    what : str
        What the frames are: "PNG pictures".
    names : tuple of str or None
        File name of each frame, where each has a file of its own.
    times : (frames,) array or None, s
    spacing : (x, y) or None, mm
        Size of a pixel.
    unknown_spacing, unknown_order : str or None
        Why the size of a pixel, or the order of the images, is not known though files speak of it: half a sentence.
    notes : tuple of str
        What was done to them.
    """

    stack: ImageStack
    what: str
    names: tuple[str, ...] | None = None
    times: Floats | None = None
    spacing: tuple[float, float] | None = None
    unknown_spacing: str | None = None
    unknown_order: str | None = None
    notes: tuple[str, ...] = ()

    @property
    def description(self) -> str:
        """``12 PNG pictures of 640 x 480 pixels, uint8``."""
        return ", ".join([f"{len(self.stack)} {self.what} of {in_pixels(self.stack.shape[1:], self.stack.dtype)}", *self.notes])


def timed(images: ImportedImages, times: Floats, names: list[str] | None = None) -> ImportedImages:
    """The images with times (n,) in s, in their order or by their files' names; SettingsError where one has none."""
    if names is not None and images.names is not None:
        known = {bare_name(name): time for name, time in zip(names, times.tolist(), strict=True)}
        for missing in (name for name in images.names if name not in known):
            raise SettingsError(f"Each image must have a time; {missing} has none.")
        return replace(images, times=np.array([known[name] for name in images.names]))
    if len(times) != len(images.stack):
        raise SettingsError(f"There must be as many times as images; got {len(times)} times for {len(images.stack)} images.")
    return replace(images, times=times)


def bare_name(text: str) -> str:
    """A file's name without its folders, as any system writes them."""
    return text.replace("\\", "/").rsplit("/", 1)[-1]


def flipped(stack: ImageStack, orientation: str) -> ImageStack:
    """A stack's images, turned to MF orientation from what they are."""
    rows, columns = (slice(None, None, -1 if turned else 1) for turned in (orientation[1] == "N", orientation[0] == "U"))
    return DecodedImages(len(stack), lambda number: stack[number][rows, columns], lambda number: f"frame {number}")
