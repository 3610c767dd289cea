"""What is known of a recording beside the file: the parts of a Plus configuration that concern a reconstruction."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, SupportsIndex

import numpy as np

from ..geometry.transform_graph import TransformName, TransformSample
from ..geometry.volume import VoxelGrid
from ..holes.filling import HoleFilling
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion


@dataclass(frozen=True, eq=False)
class PlusConfiguration:
    """The parts of a Plus configuration that concern a reconstruction; empty where nothing is configured."""

    path: Path | None = None  #: None where there is no file
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    """From CoordinateDefinitions: the calibration and other fixed relations."""
    rough: tuple[TransformName, ...] = ()  #: Those that may be many mm off, as they say themselves
    simulated: bool = False  #: Whether `aifrecon simulate` wrote it
    image_frame: str | None = None
    reference_frame: str | None = None
    """Names of the coordinate frames, None when not given."""
    spacing: tuple[float, float, float] | None = None
    origin: tuple[float, float, float] | None = None
    """(x, y, z), mm. Of the volume, in Reference."""
    extent: tuple[int, int, int, int, int, int] | None = None  #: First and last voxel along x, y, z.
    region: ImageRegion = field(default_factory=ImageRegion)
    """Clip rectangle and fan of the volume reconstruction, in pixels."""
    probe: ProbeGeometry | None = None  #: From ScanConversion
    scan_region: ImageRegion | None = None  #: The part of the image that the scan conversion fills
    scan_pixel: tuple[float, float] | None = None  #: Of the scan conversion, (x, y), mm
    method: str | None = None  #: How pixels are combined, in this library's words; None when not given or not supported
    interpolation: str | None = None  #: "nearest" or "linear"
    uses_importance_mask: bool = False  #: Whether an average is to be weighted by an importance mask
    importance_mask: Path | None = None
    """Image with the weight of each pixel, 0 to 255; not looked at yet. None where it must come from elsewhere."""
    pixel_rejection: float | None = None  #: Pixels darker than this do not enter
    holes: tuple[HoleFilling, ...] = ()  #: Tried in this order; none where holes stay
    threads: int | None = None  #: How many to use
    skip: int = 1  #: Every how many frames one is used
    fixed_point: bool = False
    """Whether pixels are to be placed in fixed-point numbers, as Plus's Optimization=FULL does."""
    fits_spacing: bool = False
    """Whether the spacing along z may grow so that the box around the sweep is a whole number of voxels."""
    warnings: tuple[str, ...] = ()  #: What the file asks for and is not honored, one sentence each

    @property
    def imaged_region(self) -> ImageRegion | None:
        """The pixels that are ultrasound: of the volume reconstruction, else of the scan conversion; None where neither tells."""
        known = (region for region in (self.region, self.scan_region) if region is not None and (region.clip or region.fan))
        return next(known, None)

    def grid(self, spacing: tuple[float, float, float] | None = None) -> VoxelGrid | None:
        """The voxels that OutputOrigin, OutputExtent and OutputSpacing ask for; None where they are not given.

        With another `spacing` (mm), the same box in voxels of that size: its first voxel's center stays where it was, and its size is
        that of the box rounded to whole voxels.
        """
        if self.extent is None or self.spacing is None:
            return None
        wanted = self.spacing if spacing is None else spacing
        first, last = np.array(self.extent[::2]), np.array(self.extent[1::2])
        size = np.floor((last - first) * np.array(self.spacing) / wanted + 0.5).astype(int) + 1
        origin = np.array(self.origin or (0.0, 0.0, 0.0)) + first * self.spacing
        return VoxelGrid.from_spacing(origin, tuple(int(n) for n in size), wanted)

    def __reduce_ex__(self, protocol: SupportsIndex) -> str | tuple[Any, ...]:
        # It is asked for by `is`, in other processes too
        return "NO_CONFIGURATION" if self is NO_CONFIGURATION else super().__reduce_ex__(protocol)


SIMULATION = "AIFRecon simulation"
"""Name of the device set of a simulated recording."""

NO_CONFIGURATION = PlusConfiguration()
"""Of a recording that came without one."""
