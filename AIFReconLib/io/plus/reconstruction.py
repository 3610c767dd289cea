"""The VolumeReconstruction element of a Plus configuration: every attribute is read, or named in a warning."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar
from xml.etree.ElementTree import Element

from ...compounding.methods.average import AVERAGE
from ...compounding.methods.table import BUILT_IN
from ...errors import AIFReconError
from ...geometry.transform_graph import capital
from ...holes.filling import CUBE, GAUSSIAN, GAUSSIAN_BY_HITS, INVERSE_DISTANCE, STICK, HoleFilling
from ...imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from ...sweep.configuration import PlusConfiguration
from .xml_attributes import Attributes

Thing = TypeVar("Thing")

_IMPORTANCE_MASK = "IMPORTANCE_MASK"
_METHODS = {method.in_plus: method.name for method in BUILT_IN if method.in_plus} | {_IMPORTANCE_MASK: AVERAGE.name}
_INTERPOLATIONS = {"NEAREST_NEIGHBOR": "nearest", "LINEAR": "linear"}
_DEFAULT_FAN_RADIUS_STOP = 500.0
_NO_EXTENT = (0,) * 6

_HONORED = frozenset(
    (
        *("ReferenceCoordinateFrame", "ImageCoordinateFrame", "OutputSpacing", "OutputOrigin", "OutputExtent", "ClipRectangleOrigin"),
        *("ClipRectangleSize", "FanAnglesDeg", "FanAngles", "FanOriginPixel", "FanOrigin", "FanRadiusStartPixel", "FanRadiusStopPixel"),
        *("FanDepth", "EnableFanAnglesAutoDetect", "FanAnglesAutoDetectBrightnessThreshold", "FanAnglesAutoDetectFilterRadiusPixel"),
        *("PixelRejectionThreshold", "SkipInterval", "Interpolation", "CompoundingMode", "Compounding", "Calculation", "FillHoles"),
        *("ImportanceMaskFilename", "NumberOfThreads", "Optimization", "RecomputeOutputSpacing"),
    )
)


def read_reconstruction(path: Path, element: Element) -> PlusConfiguration:
    """What VolumeReconstruction says.

    Raises
    ------
    ConfigurationError
        Names the attribute that cannot be used, its value, and what was expected.
    """
    attributes = Attributes(path, element, "VolumeReconstruction")
    skip = attributes.integers(1, "SkipInterval") or (1,)
    threads = attributes.integers(1, "NumberOfThreads") or (0,)
    rejection = attributes.number(0.0, "PixelRejectionThreshold")
    fan = _read_fan(attributes)
    interpolation = attributes.word("Interpolation", tuple(_INTERPOLATIONS))
    return PlusConfiguration(
        image_frame=capital(attributes.text("ImageCoordinateFrame") or "") or None,
        reference_frame=capital(attributes.text("ReferenceCoordinateFrame") or "") or None,
        spacing=attributes.positive(_read_point(attributes, "OutputSpacing"), "OutputSpacing"),
        origin=_read_point(attributes, "OutputOrigin"),
        extent=_read_extent(attributes),
        region=ImageRegion(_read_clip(attributes), fan, _read_fan_detection(attributes, fan)),
        method=_read_method(attributes),
        interpolation=_INTERPOLATIONS[interpolation] if interpolation else None,
        uses_importance_mask=_uses_importance_mask(attributes),
        importance_mask=_read_importance_mask(path, attributes),
        pixel_rejection=rejection if rejection > 0 else None,
        holes=_read_holes(path, attributes),
        threads=threads[0] if threads[0] > 0 else None,
        skip=max(skip[0], 1),
        fixed_point=(attributes.text("Optimization") or "").upper() == "FULL",
        fits_spacing=attributes.switch("RecomputeOutputSpacing"),
        warnings=_not_honored(attributes),
    )


def _read_point(attributes: Attributes, name: str) -> tuple[float, float, float] | None:
    numbers = attributes.numbers(3, name)
    return None if numbers is None else (numbers[0], numbers[1], numbers[2])


def _read_extent(attributes: Attributes) -> tuple[int, int, int, int, int, int] | None:
    """First and last voxel along x, y, z; all zero stands for none, as in templates."""
    extent = attributes.integers(6, "OutputExtent")
    if extent is None or extent == _NO_EXTENT:
        return None
    if any(extent[2 * axis] > extent[2 * axis + 1] for axis in range(3)):
        got = attributes.text("OutputExtent")
        raise attributes.failure("OutputExtent", f"must be first and last voxel along x, y and z, rising; got {got!r}. Correct it.")
    if attributes.text("OutputSpacing") is None:
        raise attributes.failure("OutputSpacing", "is missing, and OutputExtent counts voxels. Add it to the element.")
    first_x, last_x, first_y, last_y, first_z, last_z = extent
    return first_x, last_x, first_y, last_y, first_z, last_z


def _read_clip(attributes: Attributes) -> ClipRectangle | None:
    size = attributes.pair("ClipRectangleSize") or (0.0, 0.0)
    origin = attributes.pair("ClipRectangleOrigin") or (0.0, 0.0)
    if any(length <= 0 for length in size):  # as in IGSIO, which calls -1 no clipping
        return None
    return build(attributes, "ClipRectangleSize", lambda: ClipRectangle(origin, size))


def _read_fan(attributes: Attributes) -> Fan | None:
    angles = attributes.pair("FanAnglesDeg", "FanAngles") or (0.0, 0.0)
    apex = attributes.pair("FanOriginPixel", "FanOrigin") or (0.0, 0.0)
    radii = (
        attributes.number(0.0, "FanRadiusStartPixel"),
        attributes.number(_DEFAULT_FAN_RADIUS_STOP, "FanRadiusStopPixel", "FanDepth"),
    )
    if not any(angles):
        return None
    return build(attributes, "FanAnglesDeg", lambda: Fan(apex, angles, radii))


def _read_fan_detection(attributes: Attributes, fan: Fan | None) -> FanDetection | None:
    threshold = attributes.number(FanDetection.threshold, "FanAnglesAutoDetectBrightnessThreshold")
    radius = attributes.integers(1, "FanAnglesAutoDetectFilterRadiusPixel") or (FanDetection.filter_radius_px,)
    attributes.positive(radius, "FanAnglesAutoDetectFilterRadiusPixel")
    if not attributes.switch("EnableFanAnglesAutoDetect"):
        return None
    return None if fan is None else FanDetection(threshold, radius[0])


def _read_method(attributes: Attributes) -> str | None:
    """CompoundingMode, else what the older Calculation and Compounding mean, in Plus's order of precedence."""
    mode = attributes.word("CompoundingMode", tuple(_METHODS))
    calculation = attributes.word("Calculation", ("WEIGHTED_AVERAGE", "MAXIMUM"))
    compounding = attributes.text("Compounding") and attributes.switch("Compounding")
    if mode is not None:
        return _METHODS[mode]
    if calculation == "MAXIMUM":
        return _METHODS[calculation]
    if compounding is not None:
        return _METHODS["MEAN" if compounding else "LATEST"]
    return _METHODS["MEAN"] if calculation else None


def _uses_importance_mask(attributes: Attributes) -> bool:
    return attributes.word("CompoundingMode", tuple(_METHODS)) == _IMPORTANCE_MASK


def _read_importance_mask(path: Path, attributes: Attributes) -> Path | None:
    """The mask's file: as named, else beside the configuration."""
    name = attributes.text("ImportanceMaskFilename")
    if name is None or not _uses_importance_mask(attributes):
        return None
    # Windows paths in a configuration should not depend on where it is read
    name = name.replace("\\", "/")
    if name.startswith("//") or "://" in name:
        raise attributes.failure(
            "ImportanceMaskFilename", f"must be a file of this computer; got {name!r}. Copy it beside the configuration."
        )
    file = Path(name)
    return file if file.is_absolute() else path.parent / file


def _read_holes(path: Path, attributes: Attributes) -> tuple[HoleFilling, ...]:
    """The elements of HoleFilling, in the order in which they are tried."""
    if not attributes.switch("FillHoles"):
        return ()
    cubes = {
        "NEAREST_NEIGHBOR": CUBE,
        "GAUSSIAN": GAUSSIAN,
        "GAUSSIAN_ACCUMULATION": GAUSSIAN_BY_HITS,
        "DISTANCE_WEIGHT_INVERSE": INVERSE_DISTANCE,
    }
    kinds = []
    for number, element in enumerate(attributes.element.iterfind("HoleFilling/HoleFillingElement"), start=1):
        one = Attributes(path, element, f"HoleFillingElement[{number}]")
        word = one.required_word("Type", ("STICK", *cubes))
        if word == "STICK":
            kind, place = STICK, "StickLengthLimit"
            size, stdev, ratio, sticks = one.required_integer(place), 1.0, 0.0, one.required_integer("NumberOfSticksToUse")
        else:
            kind, place = cubes[word], "Size"
            size, ratio, sticks = one.required_integer(place), one.required_number("MinimumKnownVoxelsRatio"), 1
            stdev = one.required_number("Stdev") if word.startswith("GAUSSIAN") else 1.0
        kinds.append(build(one, place, partial(HoleFilling, kind, size, stdev, ratio, sticks)))
    return tuple(kinds)


def _not_honored(attributes: Attributes) -> tuple[str, ...]:
    """A sentence for each request that is not carried out, or that is but has no effect."""
    warnings = []

    def warn(attribute: str, problem: str) -> None:
        value = attributes.text(attribute)
        place = attributes.place
        warnings.append(f"{place}@{attribute}={value} {problem}.")

    if (attributes.text("Optimization") or "NONE").upper() not in ("NONE", "FULL"):
        warn("Optimization", "has no effect: voxels are those of NONE, in double precision")
    if attributes.number(1, "SkipInterval") < 1:
        warn("SkipInterval", "means 1, every frame: it must be at least that")
    if attributes.switch("RecomputeOutputSpacing") and _read_extent(attributes) is not None:
        warn("RecomputeOutputSpacing", "has no effect with OutputExtent, which gives the box in voxels")
    if attributes.text("ImportanceMaskFilename") and not _uses_importance_mask(attributes):
        warn("ImportanceMaskFilename", "has no effect without CompoundingMode=IMPORTANCE_MASK: all pixels count alike")
    if attributes.switch("EnableFanAnglesAutoDetect") and _read_fan(attributes) is None:
        warn("EnableFanAnglesAutoDetect", "has no effect without FanAnglesDeg, the widest angles to look within")
    if attributes.switch("FillHoles") and attributes.element.find("HoleFilling/HoleFillingElement") is None:
        warn("FillHoles", "is not honored: it has no HoleFillingElement")
    if attributes.text("OutputOrigin") and _read_extent(attributes) is None:
        warn("OutputOrigin", "is not honored without OutputExtent: the volume is the box around the sweep")
    for name in attributes.element.attrib:
        if name not in _HONORED and attributes.text(name):
            warn(name, "has no effect: VolumeReconstruction has no such attribute. Check how it is spelled")
    return tuple(warnings)


def build(attributes: Attributes, attribute: str, make: Callable[[], Thing]) -> Thing:
    """What `make` makes of values in the file; its complaint becomes the file's."""
    try:
        return make()
    except AIFReconError as error:
        raise attributes.failure(attribute, f"cannot be used. {error}") from error
