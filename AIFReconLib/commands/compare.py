"""`aifrecon compare`: several volumes side by side, in one figure for a paper or a screen."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import numpy as np

from ..errors import GeometryError, SettingsError
from ..evaluation.figures import CT_WINDOW, ComparisonFigure, require_matplotlib
from ..evaluation.preview import middle_of_bone
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import read_volume
from ..provenance.record import unlike_inputs
from ..terminal.arguments import Names, Output
from ..terminal.console import ProgressBar
from ..terminal.labels_options import PlacedLabelsOptions, labels_from, labels_inputs, place_from
from ..terminal.outputs import tell
from .evaluate import unique_names

SUFFIXES = (".png", ".pdf", ".svg")


class _CompareOptions(PlacedLabelsOptions):
    """Draw the same axial, sagittal and coronal cuts of several volumes side by side, with one gray scale, the patient's right on the
    left: beside the CT with the outline of its bone, where these are given.

    Parameters
    ----------
    volumes : VOLUME
        reconstructions; the first says how much is shown
    output : FILE
        where to draw: a .png, .pdf or .svg
    names : NAME
        what is written above the volumes (default: the files' names)
    at : R A S
        mm where the cuts meet (default: the middle of the bone that shows)
    window : BLACK WHITE
        gray levels shown black and white
    white
        on white, for a paper
    title : TITLE
        written above all
    mask : MASK
        0 where nothing was scanned

    Examples
    --------
      aifrecon compare average.nrrd weighted.nrrd --ct ct.nrrd --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm \\
          --names average weighted --white --output figure.pdf
    """

    volumes: tuple[Path, ...]
    output: Output
    names: tuple[str, ...] = ()
    at: tuple[float, float, float] | None = None
    window: tuple[float, float] | None = None
    white: bool = False
    title: str = ""
    mask: Path | None = None

    WORDS: ClassVar[Names] = ("volumes",)


def run(asked: _CompareOptions) -> None:
    """Read, draw, write."""
    if asked.output.suffix.lower() not in SUFFIXES:
        raise SettingsError(f"{asked.output}: a figure is a PNG, PDF or SVG. Choose a name that ends with .png, .pdf or .svg.")
    require_matplotlib()
    paths = unique_names(asked.volumes)
    names = asked.names or list(paths)
    if len(names) != len(paths) or len({*names}) != len(names):
        raise SettingsError(f"Input --names must be {len(paths)} different names, one for each volume; got {' '.join(names)}.")
    if asked.window and not asked.window[0] < asked.window[1]:
        raise SettingsError("Input --window must be BLACK and WHITE, the smaller first.")
    with ProgressBar() as progress:
        progress(0.0, "Reading")
        volumes = {name: read_volume(path) for name, path in zip(names, paths.values(), strict=True)}
        first = volumes[names[0]]
        mask = read_volume(asked.mask) if asked.mask else None
        place = place_from(asked)
        given = labels_from(asked, progress)
        labels = None if given is None else given.told_by(first.grid, place).placed_by(place)
        headers = {name: volume.fields for name, volume in volumes.items()}
        doubts = unlike_inputs(headers, [*labels_inputs(asked), asked.bone_transform])
        ct = read_ct(asked.ct).placed_by(place) if asked.ct else None
        center = np.array(asked.at) if asked.at else middle_of_bone(first, first.array != 0, labels)
        _require_within(first.grid.corners(), center, asked.volumes[0])
        progress(0.6, "Drawing")
        figure = ComparisonFigure(volumes, center, ct, labels, mask, asked.title, asked.window, asked.white)
        figure.write(asked.output)
    where, window = " ".join(f"{mm:.1f}" for mm in center), " to ".join(f"{level:g}" for level in figure.gray_window)
    shown = f"cuts meet at {where} mm (R A S of Reference); gray levels {window}, CT {CT_WINDOW[0]:g} to {CT_WINDOW[1]:g} HU"
    black = "Black may be a shadow or a place that was not scanned: --mask (reconstruct --mask writes one) tells them apart."
    tell(f"wrote {asked.output}", [shown, *([black] if mask is None else []), *doubts, *(() if given is None else given.notes)])


def _require_within(corners: np.ndarray, center: np.ndarray, path: Path) -> None:
    """Return if the cuts go through the first volume."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    if not ((low <= center) & (center <= high)).all():
        box = ", ".join(f"{a:.0f} to {b:.0f}" for a, b in zip(low, high, strict=True))
        raise GeometryError(f"{path}: the cuts do not go through it. It fills {box} mm (R, A, S). Give a place within as --at R A S.")
