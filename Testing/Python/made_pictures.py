"""Frames as the files that programs export: one picture each."""

from __future__ import annotations

from pathlib import Path

import PIL.Image


def write_pictures(folder: Path, images, suffix: str = ".png", **options) -> Path:
    """A folder with a picture of each image, called by its number."""
    folder.mkdir(exist_ok=True)
    for number, image in enumerate(images):
        PIL.Image.fromarray(image).save(folder / f"{number}{suffix}", **options)
    return folder
