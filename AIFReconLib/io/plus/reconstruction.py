"""The VolumeReconstruction element of a Plus configuration: every attribute is read, or named in a warning."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from xml.etree.ElementTree import Element

from ...compounding.methods.average import AVERAGE
from ...compounding.methods.table import BUILT_IN
from ...geometry.transform_graph import capital
from ...holes.filling import CUBE, GAUSSIAN, GAUSSIAN_BY_HITS, INVERSE_DISTANCE, STICK, HoleFilling
from ...imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from ...sweep.configuration import PlusConfiguration
from .xml_attributes import Attributes

_IMPORTANCE_MASK = "IMPORTANCE_MASK"
_METHODS = {method.in_plus: method.name for method in BUILT_IN if method.in_plus} | {_IMPORTANCE_MASK: AVERAGE.name}
_INTERPOLATIONS = {"NEAREST_NEIGHBOR": "nearest", "LINEAR": "linear"}
_CUBES = {
    "NEAREST_NEIGHBOR": CUBE,
    "GAUSSIAN": GAUSSIAN,
    "GAUSSIAN_ACCUMULATION": GAUSSIAN_BY_HITS,
    "DISTANCE_WEIGHT_INVERSE": INVERSE_DISTANCE,
}
_DEFAULT_FAN_RADIUS_STOP = 500.0
_IN_VAIN: dict[str, str] = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
"""What is said of attributes that are not carried out, or have no effect beside others."""

_UNKNOWN = "has no effect: VolumeReconstruction has no such attribute. Check how it is spelled"


def read_reconstruction(path: Path, element: Element) -> PlusConfiguration:
    """What VolumeReconstruction says.

    Raises
    ------
    ConfigurationError
        Names the attribute that cannot be used, its value, and what was expected.
    """
    attributes = Attributes(path, element, "VolumeReconstruction")
    fan = _read_fan(attributes)
    rejection = attributes.number("PixelRejectionThreshold", default=0.0)
    threads = attributes.number("NumberOfThreads", whole=True, default=0)
    configuration = PlusConfiguration(
        image_frame=capital(attributes.text("ImageCoordinateFrame")) or None,
        reference_frame=capital(attributes.text("ReferenceCoordinateFrame")) or None,
        spacing=attributes.numbers(3, "OutputSpacing", positive=True),
        origin=attributes.numbers(3, "OutputOrigin"),
        extent=_read_extent(attributes),
        region=ImageRegion(_read_clip(attributes), fan, _read_fan_detection(attributes, fan)),
        method=_read_method(attributes),
        interpolation=_INTERPOLATIONS.get(attributes.word("Interpolation", _INTERPOLATIONS)),
        uses_importance_mask=attributes.word("CompoundingMode", _METHODS) == _IMPORTANCE_MASK,
        importance_mask=_read_importance_mask(path, attributes),
        pixel_rejection=rejection if rejection > 0 else None,
        holes=_read_holes(path, attributes),
        threads=threads if threads > 0 else None,
        skip=max(attributes.number("SkipInterval", whole=True, default=1), 1),
        fixed_point=attributes.text("Optimization").upper() == "FULL",
        fits_spacing=attributes.switch("RecomputeOutputSpacing"),
    )
    return replace(configuration, warnings=_not_honored(attributes, configuration))


def _read_extent(attributes: Attributes) -> tuple[int, int, int, int, int, int] | None:
    """First and last voxel along x, y, z; all zero stands for none, as in templates."""
    extent: tuple[int, int, int, int, int, int] | None = attributes.numbers(6, "OutputExtent", whole=True)
    if extent is None or not any(extent):
        return None
    if any(extent[2 * axis] > extent[2 * axis + 1] for axis in range(3)):
        got = attributes.text("OutputExtent")
        raise attributes.failure("OutputExtent", f"must be first and last voxel along x, y and z, rising; got {got!r}. Correct it.")
    if not attributes.text("OutputSpacing"):
        raise attributes.failure("OutputSpacing", "is missing, and OutputExtent counts voxels. Add it to the element.")
    return extent


def _read_clip(attributes: Attributes) -> ClipRectangle | None:
    size = attributes.numbers(2, "ClipRectangleSize") or (0.0, 0.0)
    origin = attributes.numbers(2, "ClipRectangleOrigin") or (0.0, 0.0)
    # As in IGSIO, which calls -1 no clipping
    return attributes.build("ClipRectangleSize", lambda: ClipRectangle(origin, size)) if min(size) > 0 else None


def _read_fan(attributes: Attributes) -> Fan | None:
    angles = attributes.numbers(2, "FanAnglesDeg", "FanAngles") or (0.0, 0.0)
    apex = attributes.numbers(2, "FanOriginPixel", "FanOrigin") or (0.0, 0.0)
    radii = (
        attributes.number("FanRadiusStartPixel", default=0.0),
        attributes.number("FanRadiusStopPixel", "FanDepth", default=_DEFAULT_FAN_RADIUS_STOP),
    )
    return attributes.build("FanAnglesDeg", lambda: Fan(apex, angles, radii)) if any(angles) else None


def _read_fan_detection(attributes: Attributes, fan: Fan | None) -> FanDetection | None:
    threshold = attributes.number("FanAnglesAutoDetectBrightnessThreshold", default=FanDetection.threshold)
    radius = attributes.number("FanAnglesAutoDetectFilterRadiusPixel", whole=True, positive=True, default=FanDetection.filter_radius_px)
    return FanDetection(threshold, radius) if attributes.switch("EnableFanAnglesAutoDetect") and fan is not None else None


def _read_method(attributes: Attributes) -> str | None:
    """CompoundingMode, else what the older Calculation and Compounding mean, in Plus's order of precedence."""
    mode = attributes.word("CompoundingMode", _METHODS)
    calculation = attributes.word("Calculation", ("WEIGHTED_AVERAGE", "MAXIMUM"))
    means = "MEAN" if attributes.switch("Compounding") else "LATEST"
    older = "MAXIMUM" if calculation == "MAXIMUM" else means if attributes.text("Compounding") else calculation and "MEAN"
    return _METHODS.get(mode or older)


def _read_importance_mask(path: Path, attributes: Attributes) -> Path | None:
    """The mask's file: as named, else beside the configuration."""
    # Windows paths in a configuration should not depend on where it is read
    name = attributes.text("ImportanceMaskFilename").replace("\\", "/")
    if not name or attributes.word("CompoundingMode", _METHODS) != _IMPORTANCE_MASK:
        return None
    if name.startswith("//") or "://" in name:
        raise attributes.failure("ImportanceMaskFilename", f"must be a file of this computer; got {name!r}. Copy it here.")
    return path.parent / name


def _read_holes(path: Path, attributes: Attributes) -> tuple[HoleFilling, ...]:
    """The elements of HoleFilling, in the order in which they are tried."""
    elements = attributes.element.findall("HoleFilling/HoleFillingElement") if attributes.switch("FillHoles") else []
    kinds = []
    for number, element in enumerate(elements, start=1):
        one = Attributes(path, element, f"HoleFillingElement[{number}]")
        word = one.word("Type", ("STICK", *_CUBES), required=True)
        place = "StickLengthLimit" if word == "STICK" else "Size"
        size = one.number(place, whole=True, required=True)
        if word == "STICK":
            make = partial(HoleFilling, STICK, size, sticks=one.number("NumberOfSticksToUse", whole=True, required=True))
        else:
            ratio = one.number("MinimumKnownVoxelsRatio", required=True)
            stdev = one.number("Stdev", required=True) if word.startswith("GAUSSIAN") else 1.0
            make = partial(HoleFilling, _CUBES[word], size, stdev, ratio)
        kinds.append(one.build(place, make))
    return tuple(kinds)


def _not_honored(attributes: Attributes, configuration: PlusConfiguration) -> tuple[str, ...]:
    """A sentence for each request that is not carried out, or that is but has no effect."""
    text, detects = attributes.text, attributes.switch("EnableFanAnglesAutoDetect")
    in_vain = {
        "Optimization": text("Optimization").upper() not in ("NONE", "FULL"),
        "SkipInterval": attributes.number("SkipInterval", default=1) < 1,
        "RecomputeOutputSpacing": configuration.fits_spacing and configuration.extent is not None,
        "ImportanceMaskFilename": not configuration.uses_importance_mask,
        "EnableFanAnglesAutoDetect": detects and configuration.region.fan is None,
        "FillHoles": attributes.switch("FillHoles") and not configuration.holes,
        "OutputOrigin": configuration.extent is None,
    }
    names = [*(name for name, is_so in in_vain.items() if is_so), *(n for n in attributes.element.attrib if n not in attributes.asked)]
    return tuple(f"{attributes.place}@{name}={text(name)} {_IN_VAIN.get(name, _UNKNOWN)}." for name in names if text(name))
