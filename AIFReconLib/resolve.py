"""What the caller leaves open is taken from the Plus configuration, else from the images: settings, what a reconstructor gets, imaging."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from .arrays import Reals
from .compounding.methods.table import DEFAULT_METHOD_WITHOUT_BONE, LINEAR_METHODS, method_named
from .errors import BeamGeometryError, SettingsError
from .geometry.transforms import pixel_spacing
from .geometry.volume import VoxelGrid
from .holes.filling import HoleFilling
from .imaging.beams import SECTOR, ProbeGeometry
from .imaging.detection import detect_imaging
from .imaging.images import ImageStack
from .imaging.region import ImageRegion
from .io.plus.importance_mask import configured_importance
from .message import Sentence, said
from .remedies import Remedy
from .settings import ReconstructionSettings
from .sweep.frames import TrackedSequence
from .sweep.joined import names_of
from .sweep.poses import SweepPoses

if TYPE_CHECKING:
    from .sweep.configuration import PlusConfiguration


Value = TypeVar("Value")

MOST_OF_AN_IMAGE = 0.9
"""Where ultrasound fills more of an image than this, its surround does no harm."""


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


def resolve_settings(
    settings: ReconstructionSettings, configuration: PlusConfiguration, has_bone: bool, has_importance: bool = False
) -> ReconstructionSettings:
    """`settings` with what they leave open taken from a configuration, else from the defaults.

    That is the method (where there is no bone), spacing, skip, interpolation (where the method has one) and pixel rejection. With an
    importance mask the method is average where none is named.

    Raises
    ------
    SettingsError
        When a way to fill holes has no limit.
    """
    if settings.holes not in (None, "off") and settings.hole_limit == 0:
        raise SettingsError(f"Input hole_limit must be above 0 mm to fill holes by {settings.holes}; got 0.", Remedy.HOLE_LIMIT)

    method = settings.method
    if method is None and not has_bone:
        method = DEFAULT_METHOD_WITHOUT_BONE if has_importance else configuration.method
    method = method or settings.method_for(has_bone)
    interpolation = settings.interpolation
    if interpolation is None and method_named(method).spread is not None and not settings.best_cosine:
        interpolation = configuration.interpolation
    return replace(
        settings,
        method=method,
        spacing=configuration.spacing if settings.spacing is None else settings.spacing,
        skip=_first_known(settings.skip, configuration.skip),
        interpolation=interpolation or "nearest",
        pixel_rejection=_first_known(settings.pixel_rejection, configuration.pixel_rejection),
    )


def _first_known(own: Value | None, configured: Value | None) -> Value | None:
    return configured if own is None else own


def reconstructor_parts(
    asked: ReconstructionSettings,
    resolved: ReconstructionSettings,
    configuration: PlusConfiguration,
    importance: Reals | None = None,
) -> ReconstructorParts:
    """The parts for settings as `asked` by the caller and as `resolve_settings` returned them.

    Parameters
    ----------
    asked, resolved : ReconstructionSettings
    configuration : PlusConfiguration
    importance : (rows, columns) array, 0 to 1, or None
        The caller's; it comes before the configuration's.

    Raises
    ------
    FileFormatError
        When the configuration's importance mask cannot be read.
    """
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
            "The configuration's Interpolation=LINEAR is not used: it is for methods {methods}, and this is {method}.".format(
                methods=", ".join(LINEAR_METHODS), method=this
            )
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


@dataclass(frozen=True)
class Imaging:
    """How the images are to be read: the pixels that count, the probe where it is known, and where that knowledge is from."""

    region: ImageRegion
    probe: ProbeGeometry | None
    notes: tuple[str, ...] = ()

    def known_probe(self) -> ProbeGeometry:
        """The probe.

        Raises
        ------
        BeamGeometryError
            When it is not known.
        """
        if self.probe is None:
            raise BeamGeometryError("The directions of the beams are not known.", Remedy.NAME_THE_PROBE)
        return self.probe


def known_imaging(
    configuration: PlusConfiguration, need_probe: bool, region: ImageRegion | None = None, probe: ProbeGeometry | None = None
) -> Imaging | None:
    """Probe and region as given, else from the configuration; None where the images must be looked at."""
    region = region or configuration.imaged_region
    probe = probe or configuration.probe
    if probe is None and region is not None and region.fan is not None:
        probe = ProbeGeometry(SECTOR, region.fan.apex_px)
    return None if region is None or (need_probe and probe is None) else Imaging(region, probe)


def resolve_imaging(
    sequence: TrackedSequence, poses: SweepPoses, need_probe: bool, region: ImageRegion | None = None, probe: ProbeGeometry | None = None
) -> Imaging:
    """Probe and region: as given, else from the configuration, else recognized in the images.

    Raises
    ------
    BeamGeometryError
        When the probe is needed and cannot be told, or sweeps that were joined have configurations that contradict each other.
    """
    configuration = sequence.configuration
    _require_one_imaging(sequence, need_probe and probe is None, region is None)
    known = known_imaging(configuration, need_probe, region, probe)
    if known is not None:
        return replace(known, notes=_about_black_surround(sequence, known.region)) if region is None else known
    try:
        return recognized_imaging(sequence.images, poses, configuration, need_probe, region, probe)
    except BeamGeometryError as error:
        raise BeamGeometryError(f"{sequence.name}: {said(error)}", error) from None


def _require_one_imaging(sequence: TrackedSequence, about_probe: bool, about_region: bool) -> None:
    """Return if sweeps that were joined show the same part of the image alike, as far as that is left to their configurations."""
    first, names = sequence.configuration, names_of(sequence.parts)
    for other, name in zip(sequence.parts, names, strict=True):
        if about_region and other.configuration.imaged_region != first.imaged_region:
            raise BeamGeometryError(
                f"The configurations of {names[0]} and {name} name different parts of the image.", Remedy.ONE_CLIP_FOR_ALL
            )
        if about_probe and other.configuration.probe != first.probe:
            raise BeamGeometryError(f"The configurations of {names[0]} and {name} name different probes.", Remedy.ONE_PROBE_FOR_ALL)


def _about_black_surround(sequence: TrackedSequence, region: ImageRegion) -> tuple[str, ...]:
    """A note where a configuration's clip rectangle is the whole image although ultrasound fills only a part of it."""
    columns, rows = sequence.frame_size
    if region.fan is not None or not region.mask(columns, rows).all():
        return ()
    try:
        lit = detect_imaging(sequence.images).region.mask(columns, rows)
    except BeamGeometryError:
        return ()
    if lit.mean() > MOST_OF_AN_IMAGE:
        return ()
    (left, right), (top, bottom) = (np.flatnonzero(lit.any(axis=axis))[[0, -1]] for axis in (0, 1))
    return (
        Sentence(
            f"The configuration's clip rectangle is the whole image of {columns} x {rows} pixels, and ultrasound fills only a part of "
            "it: the black around it enters the volume too.",
            Remedy.CLIP_AS_RECOGNIZED,
            x=int(left),
            y=int(top),
            width=int(right - left),
            height=int(bottom - top),
        ),
    )


def recognized_imaging(
    images: ImageStack,
    poses: SweepPoses,
    configuration: PlusConfiguration,
    need_probe: bool,
    region: ImageRegion | None = None,
    probe: ProbeGeometry | None = None,
) -> Imaging:
    """What `known_imaging` leaves open, recognized in the images.

    Raises
    ------
    BeamGeometryError
        When the probe is needed and cannot be told.
    """
    region, probe = region or configuration.imaged_region, probe or configuration.probe
    try:
        detected = detect_imaging(images, pixel_spacing(poses.image_to_reference[poses.usable[0]]))
    except BeamGeometryError:
        if need_probe and probe is None:
            raise
        return Imaging(region or ImageRegion(), probe)
    note = f"Recognized in the images: {detected.description}."
    return Imaging(region or detected.region, probe or detected.probe, (note,))
