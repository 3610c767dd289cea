"""What the caller leaves open is taken from the Plus configuration, else from the images: settings, what a reconstructor gets, imaging."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import Reals
from .compounding.methods.table import DEFAULT_METHOD_WITHOUT_BONE, LINEAR_METHODS, method_named
from .errors import BeamGeometryError, SettingsError
from .geometry.transforms import pixel_spacing
from .geometry.volume import VoxelGrid
from .holes.filling import HoleFilling
from .imaging.beams import LINEAR, SECTOR, ProbeGeometry
from .imaging.gray_levels import GrayLevels
from .imaging.images import ImageStack
from .imaging.recognized import learned_gray_levels, recognized
from .imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from .io.plus.importance_mask import configured_importance, read_importance_mask
from .message import Sentence, message_of
from .recipe.recipe import AUTOMATIC, OF_GRID, OF_READING, OF_REGION, ImagingSettings, Recipe
from .remedies import NAME_THE_PROBE
from .sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from .sweep.frames import TrackedSequence
from .sweep.multi_sweep import names_of
from .sweep.poses import SweepPoses

BEFORE_FRAMES = (*OF_READING, *OF_REGION, "importance_mask", *OF_GRID)
"""Settings that are at work before the first frame enters: a `Reconstructor` is given what came of them."""

MOST_OF_AN_IMAGE = 0.9
"""Where ultrasound fills more of an image than this, its surround does no harm."""

RECOGNIZED = "Recognized in the images"

OTHER_DEPTH = 0.1
"""Part by which the pixels of a scan conversion differ from those of the poses where they are not of the same images."""


@dataclass(frozen=True, eq=False)
class ReconstructorParts:
    """What a `Reconstructor` is given.

    Parameters
    ----------
    importance : (rows, columns) float32 array, 0 to 1, or None
    holes : tuple of HoleFilling
    threads : int or None
    fixed_point : bool
        Whether pixels are placed as Plus's Optimization=FULL does.
    fits_spacing : bool
        Whether the spacing along z may grow to fit the box around the sweep.
    grid : VoxelGrid or None
        In the configuration's reference frame.
    notes : tuple of str
        What the configuration asks for and does not go with what the caller chose.
    """

    importance: Reals | None = None
    holes: tuple[HoleFilling, ...] = ()
    threads: int | None = None
    fixed_point: bool = False
    fits_spacing: bool = False
    grid: VoxelGrid | None = None
    notes: tuple[str, ...] = ()


def takes_out_motion(recipe: Recipe, configured: str | None = None) -> bool:
    """Whether the motion of the patient is to be taken out: as asked, else as the method has it, which may be one of a configuration."""
    method = configured if configured and recipe.method is None else recipe.method_for(True)
    return recipe.motion == AUTOMATIC if recipe.motion else method_named(method).mends_motion


def resolve_settings(settings: Recipe, configuration: PlusConfiguration, has_bone: bool) -> Recipe:
    """`settings` with what they leave open taken from a configuration, else from the defaults.

    That is the method (where there is no bone), spacing, skip, interpolation (where the method has one) and pixel rejection. With an
    importance mask the method is average where none is named.

    Raises SettingsError when a way to fill holes has no limit.
    """
    if settings.holes not in (None, "off") and settings.hole_limit == 0:
        raise SettingsError(f"Input hole_limit must be above 0 mm to fill holes by {settings.holes}; got 0.", "Give {hole_limit:MM}.")

    method = settings.method
    if method is None and not has_bone:
        method = DEFAULT_METHOD_WITHOUT_BONE if settings.importance_mask is not None else configuration.method
    method = method or settings.method_for(has_bone)
    interpolation = settings.interpolation
    if interpolation is None and method_named(method).spread is not None and not settings.best_cosine:
        interpolation = configuration.interpolation
    return replace(
        settings,
        method=method,
        spacing=configuration.spacing if settings.spacing is None else settings.spacing,
        skip=configuration.skip if settings.skip is None else settings.skip,
        interpolation=interpolation or "nearest",
        pixel_rejection=configuration.pixel_rejection if settings.pixel_rejection is None else settings.pixel_rejection,
    )


def reconstructor_parts(asked: Recipe, resolved: Recipe, configuration: PlusConfiguration) -> ReconstructorParts:
    """The parts for settings as `asked` by the caller and as `resolve_settings` returned them.

    Raises FileFormatError when the importance mask cannot be read.
    """
    importance = _asked_importance(asked)
    notes = []
    method = method_named(resolved.method or DEFAULT_METHOD_WITHOUT_BONE)
    if importance is None and configuration.uses_importance_mask:
        if asked.method is None and method.weighs_pixels:
            importance = configured_importance(configuration)
        else:
            notes.append(f"The configuration's importance mask is not used: it is for an average, and the method is {method.name}.")
    if asked.interpolation is None and configuration.interpolation == "linear" and resolved.interpolation != "linear":
        this = f"{method.name} with cosines" if resolved.best_cosine else method.name
        notes.append(
            f"The configuration's Interpolation=LINEAR is not used: it is for methods {', '.join(LINEAR_METHODS)}, and this is {this}."
        )
    return ReconstructorParts(
        importance,
        configuration.holes,
        configuration.threads,
        # Methods that weight by incidence are not Plus's
        configuration.fixed_point and method.spread is not None,
        configuration.fits_spacing and asked.spacing is None,
        configuration.grid(resolved.spacing_xyz()),
        tuple(notes),
    )


def _asked_importance(asked: ImagingSettings) -> Reals | None:
    mask = asked.importance_mask
    return read_importance_mask(mask) if isinstance(mask, str | Path) else mask


@dataclass(frozen=True)
class Imaging:
    """How the images are to be read: the pixels that count, the probe where it is known, and where that knowledge is from."""

    region: ImageRegion
    probe: ProbeGeometry | None
    notes: tuple[str, ...] = ()
    learned: Callable[[], GrayLevels] = GrayLevels.as_recorded  #: Called when brightness is judged first

    @cached_property
    def gray_levels(self) -> GrayLevels:
        """What the brightness of the images is judged by."""
        return self.learned()

    def learned_now(self) -> Imaging:
        """The same, which needs its images no longer."""
        levels = self.gray_levels
        return replace(self, learned=lambda: levels)

    def judging(self, images: ImageStack | tuple[()], asked: ImagingSettings | None) -> Imaging:
        """The same with the gray levels that are asked for, else those of these images."""
        given = None if asked is None else asked.gray_levels
        if given is not None:
            return replace(self, learned=partial(GrayLevels, given))
        return self if isinstance(images, tuple) else replace(self, learned=partial(learned_gray_levels, images, self.region))

    def known_probe(self) -> ProbeGeometry:
        """The probe.

        Raises BeamGeometryError when it is not known.
        """
        if self.probe is None:
            raise BeamGeometryError("The directions of the beams are not known.", NAME_THE_PROBE)
        return self.probe


def given_imaging(
    asked: ImagingSettings, region: ImageRegion | None, probe: ProbeGeometry | None, importance: Reals | None
) -> tuple[Imaging, Reals | None]:
    """Region, probe and weights of pixels that are given, else those that are asked for; without either every pixel counts alike.

    Raises SettingsError when both are there and differ.
    """
    asked_region, asked_probe = asked_imaging(asked, NO_CONFIGURATION)
    for name, own, other in (("region", region, asked_region), ("probe", probe, asked_probe)):
        if own is not None and other is not None and own != other:
            raise SettingsError(f"Input {name} is given, and the recipe asks for another. Leave out one of them.")
    if importance is not None and asked.importance_mask is not None:
        raise SettingsError("Input importance is given, and the recipe has an importance_mask. Leave out one of them.")
    known = known_imaging(NO_CONFIGURATION, False, region or asked_region or ImageRegion(), probe or asked_probe)
    return known or Imaging(ImageRegion(), None), _asked_importance(asked) if importance is None else importance


def known_imaging(
    configuration: PlusConfiguration, need_probe: bool, region: ImageRegion | None = None, probe: ProbeGeometry | None = None
) -> Imaging | None:
    """Probe and region as given, else from the configuration; None where the images must be looked at."""
    region = region or configuration.imaged_region
    probe = probe or configuration.probe
    if probe is None and region is not None and region.fan is not None:
        probe = ProbeGeometry(SECTOR, region.fan.apex_px)
    return None if region is None or (need_probe and probe is None) else Imaging(region, probe)


def resolve_imaging(sequence: TrackedSequence, poses: SweepPoses, need_probe: bool, asked: ImagingSettings | None = None) -> Imaging:
    """Probe and region: as asked for, else from the configuration, else recognized in the images.

    Raises
    ------
    SettingsError
        See `asked_imaging`.
    BeamGeometryError
        When the probe is needed and cannot be told, or sweeps that were joined have configurations that contradict each other.
    """
    configuration = sequence.configuration
    pixel = pixel_spacing(poses.image_to_reference[poses.usable[0]])
    configuration, notes = scanned_alike(configuration, pixel)
    region, probe = (None, None) if asked is None else asked_imaging(asked, configuration, sequence.images, pixel)
    _require_one_imaging(sequence, need_probe and probe is None, region is None)
    known = known_imaging(configuration, need_probe, region, probe)
    if known is None:
        try:
            known = recognized_imaging(sequence.images, poses, configuration, need_probe, region, probe)
        except BeamGeometryError as error:
            raise BeamGeometryError(f"{sequence.name}: {' '.join((*notes, message_of(error)))}", error) from None
    elif region is None:
        known = _with_black_surround_told(sequence, known, pixel)
    return replace(known, notes=(*notes, *known.notes)).judging(sequence.images, asked)


def asked_imaging(
    asked: ImagingSettings,
    configuration: PlusConfiguration,
    images: ImageStack | None = None,
    pixel: tuple[float, float] = (1.0, 1.0),
) -> tuple[ImageRegion | None, ProbeGeometry | None]:
    """Region and probe that are asked for, completed by the configuration's; None where they are left open. `pixel` (x, y), mm.

    Raises SettingsError when they do not go together, or the apex of a sector is not known; before a scan there are no `images` that show
    it.
    """
    probe = _asked_probe(asked, configuration, images, pixel)
    if asked.clip_px is None and asked.fan_radius_px is None:
        return None, probe
    configured = configuration.imaged_region or ImageRegion()
    clip, fan, detection = configured.clip, configured.fan, configured.fan_detection
    if asked.clip_px is not None:
        x, y, width, height = map(float, asked.clip_px)
        clip = ClipRectangle((x, y), (width, height)) if any(asked.clip_px) else None
    if asked.fan_angles_deg is not None and asked.fan_radius_px is not None:
        sector = probe or configuration.probe
        abouts = (asked.fan_apex_px, asked.apex_px, fan.apex_px if fan else None, sector.apex_px if sector else None)
        fan, detection = None, None
        if any(asked.fan_radius_px):
            about = next((each for each in abouts if each is not None), None)
            if about is None:
                raise SettingsError("A fan stands about the apex of a sector probe, which is not known.", NAME_THE_PROBE)
            more = (asked.fan_pixel_size,) if asked.fan_pixel_size else ()
            fan = Fan(about, asked.fan_angles_deg, asked.fan_radius_px, *more)
            detection = FanDetection(asked.fan_detection[0], int(asked.fan_detection[1])) if asked.fan_detection else None
    return ImageRegion(clip, fan, detection), probe


def _asked_probe(
    asked: ImagingSettings, configuration: PlusConfiguration, images: ImageStack | None, pixel: tuple[float, float]
) -> ProbeGeometry | None:
    if asked.probe == LINEAR:
        if asked.apex_px:
            raise SettingsError("A linear probe has no apex, and one is given.", NAME_THE_PROBE)
        return ProbeGeometry(LINEAR)
    if asked.apex_px:
        return ProbeGeometry(SECTOR, asked.apex_px)
    if asked.probe != SECTOR:
        return None
    known = configuration.probe
    if known is None:
        if images is None:
            raise SettingsError("A sector probe has an apex, which is not known before the scan.", NAME_THE_PROBE)
        known = recognized(images, pixel).probe
    if known.kind != SECTOR:
        raise SettingsError("The images or the configuration show a linear probe, not a sector.", NAME_THE_PROBE)
    return known


def imaging_fields(region: ImageRegion | None = None, probe: ProbeGeometry | None = None) -> dict[str, Any]:
    """The settings that ask for this region, the whole of it, and this probe, whatever a configuration says."""
    settings: dict[str, Any] = {}
    if region is not None:
        clip, fan, detection = region.clip, region.fan, region.fan_detection
        settings |= {"clip_px": (0.0,) * 4, "fan_angles_deg": (0.0, 0.0), "fan_radius_px": (0.0, 0.0)}
        if clip is not None:
            settings["clip_px"] = (*clip.origin_px, *clip.size_px)
        if fan is not None:
            settings |= {"fan_apex_px": fan.apex_px, "fan_angles_deg": fan.angles_deg, "fan_radius_px": fan.radii}
            settings["fan_pixel_size"] = fan.pixel_size
        if detection is not None:
            settings["fan_detection"] = (detection.threshold, detection.filter_radius_px)
    if probe is not None and probe.apex_px is not None:
        settings["apex_px"] = probe.apex_px
    kind = {} if probe is None else {"probe": probe.kind}
    return {**kind, **{name: [float(number) for number in pair] for name, pair in settings.items()}}


def _require_one_imaging(sequence: TrackedSequence, about_probe: bool, about_region: bool) -> None:
    """Return if sweeps that were joined show the same part of the image alike, as far as that is left to their configurations."""
    first, names = sequence.configuration, names_of(sequence.sweeps)
    for other, name in zip(sequence.sweeps, names, strict=True):
        for differs, what, setting in (
            (about_region and other.configuration.imaged_region != first.imaged_region, "parts of the image", "{clip_px:X Y W H}"),
            (about_probe and other.configuration.probe != first.probe, "probes", "{probe}"),
        ):
            if differs:
                contradiction = f"The configurations of {names[0]} and {name} name different {what}."
                raise BeamGeometryError(contradiction, f"Give {setting} for all, or reconstruct them one by one.")


def scanned_alike(configuration: PlusConfiguration, pixel: tuple[float, float]) -> tuple[PlusConfiguration, tuple[str, ...]]:
    """A configuration without its scan conversion where that is of images of another depth, and a note of that."""
    scanned = configuration.scan_pixel
    if scanned is None or np.allclose(scanned, pixel, rtol=OTHER_DEPTH):
        return configuration, ()
    note = (
        f"The configuration's ScanConversion is not used: its pixels are {scanned[0]:.4f} x {scanned[1]:.4f} mm, and those of the "
        f"poses {pixel[0]:.4f} x {pixel[1]:.4f} mm. One of them is of another depth."
    )
    return replace(configuration, probe=None, scan_region=None), (note,)


def _with_black_surround_told(sequence: TrackedSequence, known: Imaging, pixel: tuple[float, float]) -> Imaging:
    """The same, with a note where a configuration's clip rectangle is the whole image although ultrasound fills only a part of it."""
    columns, rows = sequence.frame_size
    if known.region.fan is not None or not known.region.mask(columns, rows).all():
        return known
    try:
        lit = recognized(sequence.images, pixel).region.mask(columns, rows)
    except BeamGeometryError:
        return known
    if lit.mean() > MOST_OF_AN_IMAGE:
        return known
    (left, right), (top, bottom) = (np.flatnonzero(lit.any(axis=axis))[[0, -1]] for axis in (0, 1))
    note = Sentence(
        f"The configuration's clip rectangle is the whole image of {columns} x {rows} pixels, and ultrasound fills only a part of "
        "it: the black around it enters the volume too.",
        "Recognized: {clip_px:{rectangle}}.",
        rectangle=f"{left} {top} {right - left} {bottom - top}",
    )
    return replace(known, notes=(*known.notes, note))


def recognized_imaging(
    images: ImageStack,
    poses: SweepPoses,
    configuration: PlusConfiguration,
    need_probe: bool,
    region: ImageRegion | None = None,
    probe: ProbeGeometry | None = None,
) -> Imaging:
    """What `known_imaging` leaves open, recognized in the images.

    Raises BeamGeometryError when the probe is needed and cannot be told.
    """
    region, probe = region or configuration.imaged_region, probe or configuration.probe
    try:
        detected = recognized(images, pixel_spacing(poses.image_to_reference[poses.usable[0]]))
    except BeamGeometryError:
        if need_probe and probe is None:
            raise
        return Imaging(region or ImageRegion(), probe)
    return Imaging(region or detected.region, probe or detected.probe, (f"{RECOGNIZED}: {detected.description}.",))
