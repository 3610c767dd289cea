"""What a Plus configuration file (PlusDeviceSet_*.xml) says of the calibration, the volume and the probe."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import ConfigurationError, GeometryError
from ...geometry.transform_graph import TransformName, TransformSample, TransformStatus, capitalized
from ...geometry.transforms import as_matrix
from ...geometry.volume import VoxelGrid
from ...imaging.beams import LINEAR, SECTOR, ProbeGeometry
from ...imaging.region import ClipRectangle, Fan, ImageRegion
from ...message import Message
from .reconstruction import build, read_reconstruction
from .xml_attributes import Attributes
from .xml_tree import parse_xml

if TYPE_CHECKING:
    from ...holes.filling import HoleFilling


@dataclass(frozen=True, eq=False)
class PlusConfiguration:
    """The parts of a Plus configuration that concern a reconstruction.

    Parameters
    ----------
    path : Path
    transforms : dict of TransformName to TransformSample
        From CoordinateDefinitions: the calibration and other fixed relations.
    image_frame, reference_frame : str or None
        Names of the coordinate frames, None when not given.
    spacing, origin : (x, y, z) or None, mm
        Of the volume, in Reference.
    extent : 6 int or None
        First and last voxel along x, y, z.
    region : ImageRegion
        Clip rectangle and fan of the volume reconstruction, in pixels.
    probe : ProbeGeometry or None
        From ScanConversion.
    scan_region : ImageRegion or None
        The part of the image that the scan conversion fills.
    method : str or None
        How pixels are combined, in this library's words; None when not given or not supported.
    interpolation : "nearest", "linear" or None
    uses_importance_mask : bool
        Whether an average is to be weighted by an importance mask.
    importance_mask : Path or None
        Image with the weight of each pixel, 0 to 255; not looked at yet. None where it must come from elsewhere.
    pixel_rejection : float or None
        Pixels darker than this do not enter.
    holes : tuple of HoleFilling
        Tried in this order; none where holes stay.
    threads : int or None
        How many to use.
    skip : int
        Every how many frames one is used.
    fixed_point : bool
        Whether pixels are to be placed in fixed-point numbers, as Plus's Optimization=FULL does.
    fits_spacing : bool
        Whether the spacing along z may grow so that the box around the sweep is a whole number of voxels.
    warnings : tuple of str
        What the file asks for and is not honored, one sentence each.
    """

    path: Path
    transforms: dict[TransformName, TransformSample] = field(default_factory=dict)
    image_frame: str | None = None
    reference_frame: str | None = None
    spacing: tuple[float, float, float] | None = None
    origin: tuple[float, float, float] | None = None
    extent: tuple[int, int, int, int, int, int] | None = None
    region: ImageRegion = field(default_factory=ImageRegion)
    probe: ProbeGeometry | None = None
    scan_region: ImageRegion | None = None
    method: str | None = None
    interpolation: str | None = None
    uses_importance_mask: bool = False
    importance_mask: Path | None = None
    pixel_rejection: float | None = None
    holes: tuple[HoleFilling, ...] = ()
    threads: int | None = None
    skip: int = 1
    fixed_point: bool = False
    fits_spacing: bool = False
    warnings: tuple[str, ...] = ()

    def importance(self) -> np.ndarray | None:
        """The weight of each pixel, (rows, columns) float32, 0 to 1, read from the importance mask's file; None where none is used.

        Raises
        ------
        FileFormatError
            When the mask has no file, or one that cannot be used.
        """
        from .importance_mask import read_importance_mask

        if not self.uses_importance_mask:
            return None
        if self.importance_mask is None:
            place = "VolumeReconstruction@ImportanceMaskFilename"
            raise ConfigurationError(
                "{path}: {place} is missing, and CompoundingMode=IMPORTANCE_MASK needs it. Add it, or give an importance mask.",
                path=self.path,
                place=place,
            )
        return read_importance_mask(self.importance_mask)

    def grid(self, spacing: tuple[float, float, float] | None = None) -> VoxelGrid | None:
        """The voxels that OutputOrigin, OutputExtent and OutputSpacing ask for; None where there is no OutputExtent.

        With another `spacing` (mm), the same box in voxels of that size: its first voxel's center stays where it was, and its size is
        that of the box rounded to whole voxels.
        """
        if self.extent is None:
            return None
        wanted = self.spacing if spacing is None else spacing
        first, last = np.array(self.extent[::2]), np.array(self.extent[1::2])
        size = np.floor((last - first) * np.array(self.spacing) / wanted + 0.5).astype(int) + 1
        origin = np.array(self.origin or (0.0, 0.0, 0.0)) + first * self.spacing
        return VoxelGrid.from_spacing(origin, tuple(int(n) for n in size), wanted)


def read_plus_configuration(path: str | Path) -> PlusConfiguration:
    """The configuration in a file. Elements that do not concern a reconstruction are not looked at.

    Raises
    ------
    ConfigurationError
        Names the element and attribute that cannot be used.
    """
    path = Path(path)
    root = parse_xml(path)
    if root.tag != "PlusConfiguration":
        raise ConfigurationError(
            "{path}: its root element must be PlusConfiguration; got {found}. Give a Plus configuration file.", path=path, found=root.tag
        )
    values = {"transforms": _read_transforms(path, root)}
    reconstruction = _find_reconstruction(root)
    if reconstruction is not None:
        values.update(read_reconstruction(path, reconstruction))
    conversion = root.find("ScanConversion")
    conversion = next(root.iter("ScanConversion"), None) if conversion is None else conversion
    if conversion is not None:
        values["probe"], values["scan_region"] = _read_scan_conversion(Attributes(path, conversion, "ScanConversion"))
    return PlusConfiguration(path=path, **values)


def _read_transforms(path: Path, root: Element) -> dict[TransformName, TransformSample]:
    transforms: dict[TransformName, TransformSample] = {}
    for number, element in enumerate(root.iterfind("CoordinateDefinitions/Transform"), start=1):
        attributes = Attributes(path, element, f"CoordinateDefinitions/Transform[{number}]")
        name = capitalized(TransformName(attributes.required_text("From"), attributes.required_text("To")))
        attributes.place = f"CoordinateDefinitions/Transform {name}"
        if name.source == name.target:
            raise attributes.failure("To", "must differ from From. Correct it.")
        for other in (name, name.inverse):
            if other in transforms:
                raise attributes.failure("To", "states the relation that {other} states already. Remove one of the two.", other=other)
        status = TransformStatus.parse(attributes.text("Status") or "OK")
        if status is TransformStatus.OK:
            try:
                matrix = as_matrix(attributes.required_numbers(16, "Matrix"), Message("transform {name}", name=name))
            except GeometryError as error:
                raise attributes.failure(
                    "Matrix", "cannot be used. {problem} Repeat the calibration, or correct it.", problem=error
                ) from error
        else:
            matrix = np.full((4, 4), np.nan)
        transforms[name] = TransformSample(matrix, status)
    return transforms


def _find_reconstruction(root: Element) -> Element | None:
    """The VolumeReconstruction element: under the root, else under a device that reconstructs volumes."""
    element = root.find("VolumeReconstruction")
    if element is not None:
        return element
    devices = (device for device in root.iter("Device") if device.get("Type") == "VirtualVolumeReconstructor")
    return next((element for device in devices for element in device.iter("VolumeReconstruction")), None)


def _read_scan_conversion(attributes: Attributes) -> tuple[ProbeGeometry, ImageRegion | None]:
    """The probe, and the part of the image that holds ultrasound, in MF pixels."""
    geometry = attributes.word("TransducerGeometry", ("CURVILINEAR", "LINEAR"))
    if geometry is None:
        attributes.required_text("TransducerGeometry")
    spacing = attributes.positive(attributes.required_numbers(2, "OutputImageSpacingMmPerPixel"), "OutputImageSpacingMmPerPixel")
    center = attributes.numbers(2, "TransducerCenterPixel")
    size = attributes.numbers(2, "OutputImageSizePixel")
    if center is None and size is None:
        raise attributes.failure("TransducerCenterPixel", "is missing, and OutputImageSizePixel too. Add one of them.")
    return (_read_curvilinear if geometry == "CURVILINEAR" else _read_linear)(attributes, spacing, center, size)


def _read_curvilinear(attributes: Attributes, spacing, center, size) -> tuple[ProbeGeometry, ImageRegion | None]:
    """Apex at the center of the transducer's curvature: RadiusStartMm above the middle of its face."""
    first = attributes.required_numbers(1, "RadiusStartMm")[0]
    last = attributes.required_numbers(1, "RadiusStopMm")[0]
    angles = attributes.required_numbers(1, "ThetaStartDeg") + attributes.required_numbers(1, "ThetaStopDeg")
    x, y = center or (size[0] / 2, first / spacing[1])
    apex = (x, y - first / spacing[1])
    fan = build(attributes, "ThetaStartDeg", Fan, apex, angles, (first, last), spacing)
    return ProbeGeometry(SECTOR, apex), ImageRegion(fan=fan)


def _read_linear(attributes: Attributes, spacing, center, size) -> tuple[ProbeGeometry, ImageRegion | None]:
    """A rectangle below the transducer's face, as wide as that and as deep as the image."""
    width = attributes.positive(attributes.numbers(1, "TransducerWidthMm"), "TransducerWidthMm")
    depth = attributes.positive(attributes.numbers(1, "ImagingDepthMm"), "ImagingDepthMm")
    if width is None or depth is None:
        return ProbeGeometry(LINEAR), None
    x, y = center or (size[0] / 2, 0.0)
    size_px = (width[0] / spacing[0], depth[0] / spacing[1])
    return ProbeGeometry(LINEAR), ImageRegion(clip=ClipRectangle((x - size_px[0] / 2, y), size_px))
