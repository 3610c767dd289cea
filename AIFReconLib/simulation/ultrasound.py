"""How a phased array sees bone and soft tissue: one B-mode frame at a time.

The model works on scan lines (polar samples), in amplitudes relative to the smallest echo on the screen, and adds in this order:
soft tissue scattering with full shadow behind the first bone surface of each ray; the echo of that surface, by its angle of incidence;
reverberation between face and skin; the point spread; attenuation, time gain and electronic noise; log compression; scan conversion.

References
----------
Bürger et al. (2013), Real-time GPU-based ultrasound simulation using deformable mesh models, IEEE TMI 32:609-618,
doi:10.1109/TMI.2012.2234474 (ray-based echo and shadow). Szabo (2014), Diagnostic Ultrasound Imaging (beams, speckle, log
compression). Jain and Taylor (2004), Understanding bone responses in B-mode ultrasound images, doi:10.1117/12.535984 (bone echo,
its thickness by beam width).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from ..arrays import Bytes, Floats, Matrix, Numbers, Singles
from ..errors import SettingsError
from ..geometry.volume import Volume
from ..recipe.recipe import SCANNER_SPEED
from .phased_array import PhasedArray

DYNAMIC_RANGE_DB = 58.0
"""From gray level 1 to 255."""

BONE_ECHO_DB = 58.0
"""Echo of a smooth bone surface met squarely."""

SPECULAR_SLOPE = 0.38
"""Root mean square slope of bone's facets at the scale of the wavelength."""

DIFFUSE_SHARE = 0.2
"""Amplitude of the diffuse echo relative to the specular one at normal incidence. A real bone under a probe of higher frequency shows 0.45
(docs/decisions/0008)."""

ATTENUATION_DB_PER_MM = 0.5
"""Both ways: 0.5 dB/(cm MHz) at 5 MHz."""

TIME_GAIN_DB_PER_MM = 0.47
"""A little less than the attenuation, so that depth is a little darker."""

NOISE_DB = -36.0
"""Electronic noise at the face, before time gain."""

RAY_STEP = 1.0
"""mm between looks at the distance to bone along a ray; bone is thicker."""

ELEVATIONS = np.linspace(-2.0, 2.0, 5)
"""Rays across the beam, in standard deviations of its elevational profile."""

FINE_ELEVATIONS = np.linspace(-2.0, 2.0, 25)
"""Where echoes are deposited, by interpolation between those rays."""

SHADOW_FALL = 0.4
"""mm over which the shadow sets in."""

CLUTTER_DB, CLUTTER_FALL = 19.5, 1.4
"""Echo right behind bone where its shadow is not empty, in dB above the smallest on the screen, and by how many dB per mm it falls: what
real shadows hold (docs/decisions/0022)."""

Field = NDArray[np.complex64]
"""Echoes on scan lines, with their phases."""


class UltrasoundTarget(Protocol):
    """What can be scanned: a signed distance to bone in Reference, and how strongly soft tissue scatters."""

    @property
    def bone_distance(self) -> Volume:
        """Signed distance to bone in Reference, mm, negative inside."""
        ...

    def scattering_db(self, points_reference: Floats, beams_reference: Floats) -> Singles:
        """Strength of the scatter of soft tissue at points, along beams; both (..., 3)."""
        ...


@dataclass(frozen=True)
class UltrasoundEffects:
    """What may differ from scan to scan, beside the patient.

    Parameters
    ----------
    clutter : bool
        Reverberation and clutter behind bone, which leave a real shadow gray. Off by default: see docs/decisions/0022.
    gain_db, depth_gain_db : float, dB
        By which the scanner's gain is turned up, at all depths and, growing from none at the face, at the last one.
    gray_curve : float
        Power of the gray scale, of which 1 is white: above 1 the picture is darker and harder.
    speed_of_sound : float, m/s
        Of the body. The scanner takes `SCANNER_SPEED`, so in faster tissue all lies deeper than it is shown.
    """

    clutter: bool = False
    gain_db: float = 0.0
    depth_gain_db: float = 0.0
    gray_curve: float = 1.0
    speed_of_sound: float = SCANNER_SPEED

    def __post_init__(self) -> None:
        if not (np.isfinite([self.gain_db, self.depth_gain_db]).all() and 0.0 < self.gray_curve < np.inf):
            raise SettingsError("A simulated scanner has gains in dB and a gray curve above 0.")


def specular_echo(cosine: ArrayLike) -> Floats:
    """Amplitude of the echo of a bone surface's facets, 1 at normal incidence.

    Parameters
    ----------
    cosine : array or float
        Of the angle a between beam and surface normal; 0 and below: no echo.

    Notes
    -----
    A rough surface reflects as its facets do that face the probe. With normally distributed slopes of root mean square m, so many
    do: exp(-tan^2 a / (2 m^2)), the limit of a very rough surface in Beckmann and Spizzichino (1963), The scattering of electromagnetic
    waves from rough surfaces; m = 0.38.
    """
    clipped = np.clip(np.asarray(cosine), 0.0, 1.0)
    tangent_squared = 1.0 / np.maximum(clipped, 1e-3) ** 2 - 1.0
    return np.where(clipped > 0, np.exp(-tangent_squared / (2 * SPECULAR_SLOPE**2)), 0.0)


def diffuse_echo(cosine: ArrayLike) -> Floats:
    """Root mean square amplitude of what a bone surface scatters back from roughness and pores below the wavelength.

    Parameters
    ----------
    cosine : array or float
        Of the angle of incidence a; 0 and below: no echo.

    Notes
    -----
    `DIFFUSE_SHARE` cos a (Lambert), relative to the specular echo at normal incidence. Its phases are random, so echoes of different
    places add up in power, where those of facets add up in amplitude.
    """
    echo: Floats = DIFFUSE_SHARE * np.clip(np.asarray(cosine), 0.0, 1.0)
    return echo


def simulate_frame(
    phantom: UltrasoundTarget,
    probe: PhasedArray,
    probe_to_reference: Matrix,
    rng: np.random.Generator,
    effects: UltrasoundEffects | None = None,
) -> Bytes:
    """One B-mode frame.

    Parameters
    ----------
    probe_to_reference : (4, 4) array, mm
        Of the probe's marker.

    Returns
    -------
    image : (rows, columns) uint8 array
        0 outside the sector, at least 1 inside.
    """
    effects = effects or UltrasoundEffects()
    shown, probe = probe, replace(probe, depth=probe.depth * effects.speed_of_sound / SCANNER_SPEED)
    transducer_to_reference = probe_to_reference @ probe.transducer_to_probe
    hits, cosines = _first_surfaces(phantom.bone_distance, probe, transducer_to_reference)
    field = _tissue(phantom, probe, transducer_to_reference, hits, rng, effects.clutter)
    field += _bone_echoes(probe, hits, cosines, rng)
    field += _reverberation(probe, rng)
    return _to_image(np.abs(_receive(field, probe, rng)), shown, effects)


def _first_surfaces(distance: Volume, probe: PhasedArray, transducer_to_reference: Matrix) -> tuple[Floats, Floats]:
    """Where rays first meet bone: (lines, elevations) distances from the apex in mm, infinite without a hit, and cosines of incidence."""
    ranges = np.arange(probe.radii[0], probe.radii[1] + RAY_STEP, RAY_STEP, dtype=np.float64)
    sigma = probe.elevation_fwhm(ranges - probe.apex_offset) / 2.3548
    to_ijk = distance.grid.reference_to_ijk @ transducer_to_reference
    flat = probe.beam_points(ranges) @ to_ijk[:3, :3].T + to_ijk[:3, 3]
    offsets = (ELEVATIONS[:, None] * sigma)[..., None] * to_ijk[:3, 2]
    points_ijk = (flat[:, None] + offsets[None]).astype(np.float32)
    values = _sample(distance.array, points_ijk)

    inside = values <= 0
    found = inside.any(axis=2)
    after = np.maximum(inside.argmax(axis=2), 1)
    line, ray = np.ogrid[: probe.lines, : len(ELEVATIONS)]
    before_value, after_value = values[line, ray, after - 1], values[line, ray, after]
    drop = np.maximum(before_value - after_value, 1e-6)
    fraction = np.clip(before_value / drop, 0.0, 1.0)
    at_surface = points_ijk[line, ray, after - 1] + fraction[..., None] * (points_ijk[line, ray, after] - points_ijk[line, ray, after - 1])
    hits = np.where(found, ranges[after - 1] + fraction * RAY_STEP, np.inf)

    steps = np.concatenate([np.eye(3), -np.eye(3)]).astype(np.float32) * 0.75
    around = _sample(distance.array, at_surface[:, :, None, :].astype(np.float32) + steps)
    gradient = (around[..., :3] - around[..., 3:]) @ np.linalg.inv(distance.grid.ijk_to_reference[:3, :3])
    normals = gradient / np.maximum(np.linalg.norm(gradient, axis=-1, keepdims=True), 1e-9)
    beams = _beams(probe, transducer_to_reference)
    cosines = np.where(found, -np.einsum("lec,lc->le", normals, beams), 0.0)
    return hits, np.maximum(cosines, 0.0)


def _beams(probe: PhasedArray, transducer_to_reference: Matrix) -> Floats:
    """Direction of each beam in Reference, (lines, 3) unit vectors."""
    directions = np.stack([np.sin(probe.beam_angles), np.cos(probe.beam_angles), np.zeros(probe.lines)], axis=1)
    turned: Floats = directions @ transducer_to_reference[:3, :3].T
    return turned


def _sample(array: Numbers, points_ijk: Singles) -> Singles:
    """Trilinear values of a [k, j, i] array at points (..., 3) given as (i, j, k); 6 outside."""
    coordinates = points_ijk.reshape(-1, 3).T[::-1]
    values = scipy.ndimage.map_coordinates(array, coordinates, order=1, mode="constant", cval=6.0, output=np.float32)
    return values.reshape(points_ijk.shape[:-1])


def _tissue(
    phantom: UltrasoundTarget,
    probe: PhasedArray,
    transducer_to_reference: Matrix,
    hits: Floats,
    rng: np.random.Generator,
    clutter: bool,
) -> Field:
    """Echoes of soft tissue on the scan lines, (lines, samples) complex64; every second sample is computed, the others interpolated."""
    ranges = probe.ranges[::2]
    points = probe.beam_points(ranges) @ transducer_to_reference[:3, :3].T + transducer_to_reference[:3, 3]
    amplitude = 10.0 ** (phantom.scattering_db(points, _beams(probe, transducer_to_reference)[:, None, :]) / 20.0)
    weights = _elevation_weights(ELEVATIONS)
    reached = np.clip((hits[:, None, :] - ranges[None, :, None]) / SHADOW_FALL + 1.0, 0.0, 1.0)
    amplitude = amplitude * np.sqrt(reached @ weights)
    if clutter:
        behind = np.maximum(ranges[None, :, None] - hits[:, None, :], 0.0)
        power = ((1.0 - reached) * 10.0 ** ((CLUTTER_DB - CLUTTER_FALL * behind) / 10.0)) @ weights
        amplitude = np.hypot(amplitude, np.sqrt(power))
    full = np.empty((probe.lines, probe.samples), dtype=np.float32)
    full[:, ::2] = amplitude
    full[:, 1:-1:2] = (amplitude[:, : full[:, 1:-1:2].shape[1]] + amplitude[:, 1 : full[:, 1:-1:2].shape[1] + 1]) / 2
    if probe.samples % 2 == 0:
        full[:, -1] = amplitude[:, -1]
    field: Field = full * _random_phasors(rng, full.shape)
    return field


def _random_phasors(rng: np.random.Generator, shape: tuple[int, ...]) -> Field:
    """Circular complex normal numbers of unit mean power, complex64: many scatterers in one cell."""
    parts = rng.standard_normal((*shape, 2), dtype=np.float32) * np.float32(math.sqrt(0.5))
    return parts.view(np.complex64)[..., 0]


def _elevation_weights(elevations: Floats) -> Floats:
    """The part of the beam's power that the ray at each elevation stands for; they sum to 1."""
    weights = np.exp(-(elevations**2) / 2)
    normalized: Floats = weights / weights.sum()
    return normalized


def _bone_echoes(probe: PhasedArray, hits: Floats, cosines: Floats, rng: np.random.Generator) -> Field:
    """Echoes of the first bone surfaces, each in the sample where it arrives, (lines, samples) complex64.

    Notes
    -----
    Between two rays of a line that meet one surface, arrival and strength are interpolated, so that an oblique surface gives one long
    echo and not five short ones. The beam's profile in amplitude weighs them. Specular echoes that arrive together
    add up in amplitude, diffuse ones in power.
    """
    square = 10.0 ** (BONE_ECHO_DB / 20.0)
    position = np.interp(FINE_ELEVATIONS, ELEVATIONS, np.arange(len(ELEVATIONS)))
    low = np.minimum(position.astype(int), len(ELEVATIONS) - 2)
    fraction = position - low
    with np.errstate(invalid="ignore"):
        one_surface = np.abs(hits[:, low + 1] - hits[:, low]) < 4.0

    def between(values: Floats) -> Floats:
        with np.errstate(invalid="ignore"):
            blended = values[:, low] + fraction * (values[:, low + 1] - values[:, low])
        return np.where(one_surface, blended, np.where(fraction < 0.5, values[:, low], values[:, low + 1]))

    arrival, specular, diffuse = between(hits), between(specular_echo(cosines) * square), between(diffuse_echo(cosines) * square)
    weights = _elevation_weights(FINE_ELEVATIONS)
    sample = (arrival - probe.radii[0]) / probe.depth * (probe.samples - 1)
    seen = np.isfinite(sample) & (sample < probe.samples - 1.001) & (sample >= 0)
    line = np.broadcast_to(np.arange(probe.lines)[:, None], sample.shape)[seen]
    first = sample[seen].astype(int)
    beyond = sample[seen] - first
    number, size = line * probe.samples + first, probe.lines * probe.samples

    def deposited(strengths: Floats) -> Floats:
        strength = strengths[seen]
        field = np.bincount(number, strength * (1 - beyond), size) + np.bincount(number + 1, strength * beyond, size)
        return np.asarray(field, dtype=np.float64).reshape(probe.lines, probe.samples)

    coherent = deposited(specular * weights)
    incoherent = np.sqrt(deposited(diffuse**2 * weights**2 / (weights**2).sum()))
    texture = 0.8 + 0.55 * scipy.ndimage.gaussian_filter(_random_phasors(rng, coherent.shape), 0.7, mode="nearest") * 2.5
    return (coherent * texture + incoherent * _random_phasors(rng, coherent.shape)).astype(np.complex64)


def _reverberation(probe: PhasedArray, rng: np.random.Generator) -> Field:
    """Echoes that go to and fro between face and skin, (lines, samples) complex64: bands that fade, 1.9 mm apart."""
    depth = probe.ranges - probe.apex_offset
    bands = sum(10.0 ** ((44.0 - 6.5 * n) / 20.0) * np.exp(-(((depth - 0.5 - 1.9 * n) / 0.35) ** 2)) for n in range(5))
    uneven = scipy.ndimage.gaussian_filter1d(rng.standard_normal(probe.lines), 5.0) * 0.5 + 1.0
    return np.asarray(0.35 * uneven[:, None] * bands[None, :], np.complex64)


def _receive(field: Field, probe: PhasedArray, rng: np.random.Generator) -> Field:
    """What the receiver gives: blurred, attenuated, with noise and gained by depth; (lines, samples) complex64.

    Notes
    -----
    Resolution along a line falls with depth, as high frequencies are lost, and across lines it is an angle, so it grows in mm. Two
    filters, for the first and the last sample, are mixed by depth. Each keeps the mean power of speckle (weights' squares sum to 1)
    and is scaled to leave an echo's peak about as it was.
    """
    depth = (probe.ranges - probe.apex_offset).astype(np.float32)
    pitch = probe.depth / (probe.samples - 1)
    line_pitch = 2 * probe.half_angle / (probe.lines - 1)
    mix = depth / probe.depth
    near = _blur(field, math.radians(1.0) / line_pitch, 0.26 / pitch)
    far = _blur(field, math.radians(0.75) / line_pitch, 0.42 / pitch)
    field = (near * (1 - mix) + far * mix) * 10.0 ** (-ATTENUATION_DB_PER_MM * depth / 20.0)
    noise = scipy.ndimage.gaussian_filter1d(_random_phasors(rng, field.shape), 1.0, axis=1)
    noise *= np.float32(math.sqrt(2 * math.sqrt(math.pi)))
    field = field + noise * np.float32(10.0 ** (NOISE_DB / 20.0))
    return (field * 10.0 ** (TIME_GAIN_DB_PER_MM * depth / 20.0)).astype(np.complex64)


def _blur(field: Field, lines: float, samples: float) -> Field:
    """A Gaussian point spread of these standard deviations that keeps the power of uncorrelated echoes."""
    for axis, deviation in ((1, samples), (0, lines)):
        field = scipy.ndimage.gaussian_filter1d(field, deviation, axis=axis, truncate=3.2)
    return field * np.float32(2 * math.sqrt(math.pi * lines * samples))


def _to_image(amplitude: Singles, probe: PhasedArray, effects: UltrasoundEffects) -> Bytes:
    """Gray levels of the sector image, (rows, columns) uint8."""
    turned_up = effects.gain_db + effects.depth_gain_db * np.linspace(0.0, 1.0, amplitude.shape[1], dtype=np.float32)
    levels_per_db = np.float32(254.0 / DYNAMIC_RANGE_DB)
    gray = 1.0 + np.log10(np.maximum(amplitude, 1e-3)) * np.float32(20.0 * levels_per_db) + turned_up * levels_per_db
    if effects.gray_curve != 1.0:
        gray = 1.0 + 254.0 * ((np.clip(gray, 1.0, 255.0) - 1.0) / 254.0) ** np.float32(effects.gray_curve)
    pixels, weights = probe.scan_conversion
    image = np.zeros(probe.rows * probe.columns, dtype=np.uint8)
    image[pixels] = np.clip(np.rint(weights @ np.clip(gray, 1.0, 255.0).astype(np.float32).ravel()), 1, 255)
    return image.reshape(probe.rows, probe.columns)
