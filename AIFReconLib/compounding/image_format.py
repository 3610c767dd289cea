"""What all images of a reconstruction have in common: their size, their pixel type, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Numbers, NumberType
from ..errors import GeometryError
from ..message import Sentence
from ..recipe.recipe import Recipe
from ..remedies import Remedy
from .methods.table import method_named


@dataclass(frozen=True)
class ImageKind:
    """Size (rows, columns) and pixel type of the images."""

    shape: tuple[int, int]
    dtype: NumberType

    @classmethod
    def of(cls, image: Numbers, number: int) -> ImageKind:
        """That of the first image, of frame `number`; a GeometryError where it is not one of gray pixels."""
        if image.ndim != 2 or not image.size or image.dtype.kind not in "biuf":
            raise GeometryError(f"Input images must be gray, rows x columns of numbers; got {image.shape} {image.dtype} in frame {number}.")
        rows, columns = image.shape
        return cls((rows, columns), image.dtype)

    def check(self, image: Numbers, number: int) -> None:
        """Return if the image of a later frame, `number`, is alike; else raise a GeometryError."""
        if image.shape != self.shape or image.dtype != self.dtype:
            raise GeometryError(
                f"Input images must all be alike; got {image.shape} {image.dtype} in frame {number} after {self.shape} {self.dtype}."
            )

    @property
    def is_8_bit(self) -> bool:
        """Whether pixels are gray levels from 0 to 255."""
        return self.dtype == np.uint8

    def maximum(self, settings: Recipe) -> float:
        """The brightest value that an image can hold; infinite where neither the settings nor the type tell."""
        if settings.intensity_maximum is not None:
            return settings.intensity_maximum
        return float(np.iinfo(self.dtype.name).max) if self.dtype.kind in "iu" else np.inf

    def output_type(self, settings: Recipe) -> str:
        """The pixel type of the volume: "uint8" or "float32"."""
        return settings.output_type or ("uint8" if self.is_8_bit else "float32")

    def warnings(self, method: str, settings: Recipe) -> list[str]:
        """What does not go well with such pixels."""
        if self.is_8_bit:
            return []
        found: list[str] = []
        if method_named(method).needs_shadows and settings.intensity_maximum is None:
            found.append(
                Sentence(
                    f"Warning: {method} judges brightness against the full gray scale, which {self.dtype.name} images do not tell.",
                    Remedy.BRIGHTEST_VALUE,
                )
            )
        if settings.output_type == "uint8":
            found.append(
                Sentence(f"Warning: {self.dtype.name} images are written as uint8: values above 255 are cut off.", Remedy.FLOAT_OUTPUT)
            )
        return found
