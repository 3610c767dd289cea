"""What comes into a reconstruction: things of the right kind, and frames, those that cannot enter named, the others laid out and placed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Mask, Matrix, Numbers, NumberType
from ..bone.map import BoneMap
from ..errors import GeometryError, require_kind
from ..geometry.transforms import pixel_spacing, why_not_an_image_pose
from ..geometry.volume import VoxelGrid
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion
from ..imaging.sound_speed import depth_scale
from ..message import Sentence
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedFrame
from .batch import FrameBatch
from .evidence import ScanLines
from .layout import PixelLayout, in_fixed_point
from .methods.table import method_named

KINDS: dict[str, tuple[type, str]] = {
    "recipe": (Recipe, "Write Recipe(method=..., spacing=...)."),
    "bone": (
        BoneMap,
        "Make one: LabeledBone(Volume(labels, ijk_to_reference)), BoneMap.from_probability(volume), or bone_from_masks(sequence, masks).",
    ),
    "grid": (VoxelGrid, "A Volume has one: volume.grid; else VoxelGrid.from_spacing(origin, size, spacing)."),
    "region": (ImageRegion, "Make one: ImageRegion(ClipRectangle((x, y), (width, height)), Fan(apex, angles, radii))."),
    "probe": (ProbeGeometry, 'Make one: ProbeGeometry("linear") or ProbeGeometry("sector", (column, row)).'),
}
"""What is given to a reconstruction under these names, and how one gets it."""

OUTSIDE = "outside the volume"
"""Why a frame was left out none of whose pixels has a voxel."""


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
        if method_named(method).needs_shadows and settings.gray_levels is None and settings.intensity_maximum is None:
            found.append(
                Sentence(
                    f"Warning: {method} judges brightness against the full gray scale, which {self.dtype.name} images do not tell.",
                    "Give their brightest value with {intensity_maximum}.",
                )
            )
        if settings.output_type == "uint8":
            found.append(
                Sentence(
                    f"Warning: {self.dtype.name} images are written as uint8: values above 255 are cut off.", "Use {output_type:float32}."
                )
            )
        return found


def require_kinds(**given: object) -> None:
    """Return if what is given, by its name among `KINDS`, is of its kind or None; else an InputTypeError that says how one gets it."""
    for name, value in given.items():
        kind, advice = KINDS[name]
        require_kind(name, value, (kind, type(None)), advice)


def why_not(frame: TrackedFrame) -> str | None:
    """Why a frame cannot enter any volume; None for one that can."""
    if frame.status != "OK":
        return frame.status
    if frame.image is None:
        return "no image"
    if frame.image_to_reference is None:
        return "no pose"
    problem = why_not_an_image_pose(frame.image_to_reference)
    return f"image pose {problem}" if problem else None


class Intake:
    """Lays out frames and places them in the grid, before an engine gets them.

    Parameters
    ----------
    region : ImageRegion
        Pixels outside it never enter.
    needs_beams : bool
        Whether pixels get the direction of their beam.
    judges_shadows : bool
        Whether frames get the scan lines along which shadows are looked for.
    fixed_point : bool
        Place pixels as Plus's Optimization=FULL does; see `in_fixed_point`.

    Attributes
    ----------
    layout, scan_lines : PixelLayout, ScanLines or None
        Of the frames since `lay_out`.
    laid_out : dict of (x, y) mm by the number of the frame
        The pixel spacing by which each is laid out in the whole volume, where only a part is reconstructed: a part by itself would begin
        with another frame, whose spacing differs in its last digits.
    """

    def __init__(
        self,
        grid: VoxelGrid,
        settings: Recipe,
        region: ImageRegion,
        probe: ProbeGeometry | None,
        *,
        needs_beams: bool,
        judges_shadows: bool,
        fixed_point: bool = False,
    ):
        self.layout: PixelLayout | None = None
        self.scan_lines: ScanLines | None = None
        self._grid, self._settings, self._region, self._probe = grid, settings, region, probe
        self._needs_beams, self._judges_shadows, self._fixed_point = needs_beams, judges_shadows, fixed_point
        self._stretch: Matrix | None = None
        self.laid_out: dict[int, tuple[float, float]] = {}

    def fits(self, image: Numbers, pose: Matrix, number: int) -> bool:
        """Whether the layout serves the image (rows, columns) of frame `number` with this pose."""
        rows, columns = image.shape
        if self.layout is None or number in self.laid_out:
            return self.layout is not None and self.layout.spacing == self.laid_out[number]
        return self.layout.fits((columns, rows), pixel_spacing(pose))

    def lay_out(self, image: Numbers, pose: Matrix, number: int) -> None:
        """Make the layout that does."""
        rows, columns = image.shape
        spacing = self.laid_out.get(number) or pixel_spacing(pose)
        scale = depth_scale(self._settings, self._region.mask(columns, rows), self._probe, spacing)
        # What keeps rows straight is the pose's to do, which any engine can
        self._stretch = None if scale is None else scale.stretch
        scale = None if self._stretch is not None else scale
        self.layout = PixelLayout.build((columns, rows), spacing, self._region, self._probe if self._needs_beams else None, scale)
        if self._probe is not None and self._judges_shadows:
            self.scan_lines = ScanLines(self.layout, self._probe)

    def image_to_ijk(self, pose: Matrix) -> Matrix:
        """Where an image that fits the layout lies in the grid, (4, 4) float64."""
        image_to_ijk = self._grid.reference_to_ijk @ pose if self._stretch is None else self._grid.reference_to_ijk @ pose @ self._stretch
        return in_fixed_point(image_to_ijk) if self._fixed_point else image_to_ijk

    def why_nothing_entered(self, batch: FrameBatch, place: int) -> str:
        """Of a frame of a batch none of whose pixels entered."""
        measured: Mask | None = batch.measured.get(place)
        if self.layout is not None and measured is not None and not self.layout.has_any(measured):
            return "no pixel in the image is a finite number"
        if self.layout is not None and self.layout.voxels(batch.image_to_ijk[place], self._grid.size)[0].size:
            return "no pixel in the volume has any weight"
        return OUTSIDE
