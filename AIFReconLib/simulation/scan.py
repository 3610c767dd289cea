"""Probe paths over a back, and the tracked sequence that a scanner and an optical tracker record along them.

The face stays on the skin and the middle beam meets the spine in the midline (or at another place that the path says), 30 mm deep, so
that tilts turn about the target as those of a wearable or hand-held probe do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..arrays import Floats, Matrix
from ..errors import SettingsError
from ..geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ..geometry.transforms import affine
from ..progress import Progress, report
from ..sweep.configuration import SIMULATION
from ..sweep.frames import FrameRecord, TrackedSequence
from .phased_array import PhasedArray
from .ultrasound import UltrasoundEffects, UltrasoundTarget, simulate_frame

FRAME_RATE = 20.0
"""Hz."""

AIM_DEPTH = 30.0
"""mm under the skin of the point that every tilt keeps in the middle beam."""

BEYOND_TIPS = 16.0
"""mm that a pass goes beyond the first and the last spinous process's tip."""

IN_PLANE_TILTS_DEG, ELEVATIONAL_TILTS_DEG = (-30.0, 0.0, 30.0), (-15.0, 0.0, 15.0)
"""Every pair of them is a pass of a multi-angle sweep."""

BREATH, BREATHES_ALONG = 3.7, np.array([0.2, 0.81, 0.55])
"""s from breath to breath, and the way of a patient's back, a unit vector in Reference."""

PROBE_TO_TRACKER = TransformName("Probe", "Tracker")
REFERENCE_TO_TRACKER = TransformName("Reference", "Tracker")


class ScannedBack(UltrasoundTarget, Protocol):
    """A target with a skin to put the probe on and a spine to aim at."""

    def skin_y(self, x: ArrayLike, z: ArrayLike) -> Floats:
        """Where the skin is at x, z in Reference, mm."""
        ...

    def spinous_tips(self) -> Floats:
        """Tips of the spinous processes in Reference, (n, 3), mm."""
        ...


@dataclass(frozen=True, eq=False)
class ProbePath:
    """Where the transducer is and when: (frames, 4, 4) transducer_to_reference in mm and (frames,) timestamps in s, rising."""

    transducer_to_reference: Matrix
    timestamps: Floats

    def __len__(self) -> int:
        return len(self.timestamps)

    def delayed(self, seconds: float) -> ProbePath:
        """The path as poses that arrive late: at each timestamp, where the transducer was `seconds` before (held at the ends)."""
        if seconds == 0 or len(self) < 2:
            return self
        times = np.clip(self.timestamps - seconds, self.timestamps[0], self.timestamps[-1])
        poses = np.tile(np.eye(4), (len(self), 1, 1))
        turns = scipy.spatial.transform.Rotation.from_matrix(self.transducer_to_reference[:, :3, :3])
        poses[:, :3, :3] = scipy.spatial.transform.Slerp(self.timestamps, turns)(times).as_matrix()
        for axis in range(3):
            poses[:, axis, 3] = np.interp(times, self.timestamps, self.transducer_to_reference[:, axis, 3])
        return ProbePath(poses, self.timestamps)


@dataclass(frozen=True)
class TrackingErrors:
    """What goes wrong between the true poses and the recorded ones; nothing by default.

    Parameters
    ----------
    time_offset : float, s
        By how much recorded poses are late; between two passes they are interpolated over the turn.
    drift : float, mm
        How far the probe is recorded beside where it is at the end of the scan, in a direction of the tracker; it grows from 0 with time.
    breathing : float, mm
        How far the patient moves to either side of the middle as they breathe, every `BREATH` s: mostly back and forth, and toward the
        head. The marker does not move with them, nor below.
    shifting : float, mm
        Standard deviation, along each axis, of how far the patient lies elsewhere in each pass; turned by half as many degrees.
    step : float, mm
        How far the patient moves at once, in the middle of the middle pass.
    """

    time_offset: float = 0.0
    drift: float = 0.0
    breathing: float = 0.0
    shifting: float = 0.0
    step: float = 0.0

    def __post_init__(self) -> None:
        values = (self.drift, self.breathing, self.shifting, self.step)
        if min(values) < 0 or not math.isfinite(sum(values) + self.time_offset):
            raise SettingsError(f"Input tracking errors must be finite and not negative; got {self}.")


def contact_pose(
    phantom: ScannedBack, target_x: float, target_z: float, *, in_plane_tilt_deg: float = 0.0, elevational_tilt_deg: float = 0.0
) -> Matrix:
    """The transducer on the skin, its middle beam through a point 30 mm under the skin at (target_x, target_z).

    Image columns run to the patient's right, but for the tilts.

    Parameters
    ----------
    target_x, target_z : float, mm, Reference
    in_plane_tilt_deg : float
        Turns the middle beam toward the image's columns.
    elevational_tilt_deg : float
        Turns it toward the transducer's z axis.

    Returns
    -------
    transducer_to_reference : (4, 4) float64 array, mm
    """
    tilt = scipy.spatial.transform.Rotation.from_euler("ZX", [-in_plane_tilt_deg, elevational_tilt_deg], degrees=True).as_matrix()
    pose = affine(tilt)
    beam = pose[:3, 1]
    target = np.array([target_x, float(phantom.skin_y(target_x, target_z)) + AIM_DEPTH, target_z])
    near, far = 0.0, 4.0 * AIM_DEPTH
    for _ in range(50):
        middle = (near + far) / 2
        point = target - middle * beam
        near, far = (middle, far) if point[1] > phantom.skin_y(point[0], point[2]) else (near, middle)
    pose[:3, 3] = target - near * beam
    return pose


def single_angle_sweep(
    phantom: ScannedBack,
    frames: int = 60,
    *,
    in_plane_tilt_deg: float = 0.0,
    elevational_tilt_deg: float = 0.0,
    offset: float = 0.5,
    above: float = 0.0,
) -> ProbePath:
    """One pass along the spine at fixed tilts.

    Parameters
    ----------
    offset : float, 0 to 1
        Where in its part of the way each frame is taken: passes of different offsets interleave.
    above : float, mm
        By how much earlier the way begins.
    """
    tilts = {"in_plane_tilt_deg": in_plane_tilt_deg, "elevational_tilt_deg": elevational_tilt_deg}
    poses = [contact_pose(phantom, 0.0, z, **tilts) for z in _along_the_spine(phantom, (np.arange(frames) + offset) / frames, above)]
    return ProbePath(np.array(poses), np.arange(frames) / FRAME_RATE)


def _along_the_spine(phantom: ScannedBack, way: Floats, above: float = 0.0) -> Floats:
    """z of places on the way, 0 to 1, from above the first to below the last spinous process."""
    heights = phantom.spinous_tips()[:, 2]
    return np.asarray(heights.max() + BEYOND_TIPS + above - way * (np.ptp(heights) + 2 * BEYOND_TIPS + above))


def multi_angle_sweep(phantom: ScannedBack, frames: int = 144, above: float = 0.0) -> ProbePath:
    """A pass along the spine at every pair of tilts, to and fro, `frames` in all; the passes' planes interleave.

    Its way begins `above` mm earlier than need be for the first spinous process.

    Notes
    -----
    This is what a wearable device with a translation and two rotations does (Xu et al. 2022, AutoInFocus). Two seconds of turning lie
    between passes, in which nothing is recorded.
    """
    pairs = [(a, e) for e in ELEVATIONAL_TILTS_DEG for a in IN_PLANE_TILTS_DEG]
    if frames < len(pairs):
        raise SettingsError(f"Input frames must be at least one per pair of tilts ({len(pairs)}); got {frames!r}.")
    counts = [frames // len(pairs) + (n < frames % len(pairs)) for n in range(len(pairs))]
    poses, times, start = [], [], 0.0
    for n, ((in_plane, elevational), count) in enumerate(zip(pairs, counts)):
        offset = ((n * 4) % len(pairs) + 0.5) / len(pairs)
        tilts = {"in_plane_tilt_deg": in_plane, "elevational_tilt_deg": elevational}
        one = single_angle_sweep(phantom, count, **tilts, offset=offset, above=above)
        poses.append(one.transducer_to_reference[:: -1 if n % 2 else 1])
        times.append(start + one.timestamps)
        start = times[-1][-1] + 2.0
    return ProbePath(np.concatenate(poses), np.concatenate(times))


def freehand_sweep(phantom: ScannedBack, frames: int = 150) -> ProbePath:
    """Along the spine as a hand does it: uneven speed, wandering a few mm sideways, with slow tilts of up to about 20 degrees."""
    rng = np.random.default_rng([0, 10])
    wander = scipy.ndimage.gaussian_filter1d(rng.standard_normal((5, frames)), frames / 12, axis=1, mode="reflect")
    wander /= np.abs(wander).max(axis=1, keepdims=True)
    speed = np.maximum(1.0 + 0.6 * wander[0], 0.2)
    way = np.cumsum(speed) - speed[0]
    on_skin = [
        contact_pose(phantom, 5.0 * side, z, in_plane_tilt_deg=24.0 * a, elevational_tilt_deg=14.0 * e)
        for z, side, a, e in zip(_along_the_spine(phantom, way / way[-1]), *wander[1:4])
    ]
    poses = np.array(on_skin)
    turns = scipy.spatial.transform.Rotation.from_rotvec(np.deg2rad(8.0) * wander[4][:, None] * np.array([[0.0, 1.0, 0.0]])).as_matrix()
    poses[:, :3, :3] = poses[:, :3, :3] @ turns
    return ProbePath(poses, np.arange(frames) / FRAME_RATE)


def random_rigid(translation: float, rotation_deg: float, rng: np.random.Generator, about: ArrayLike = (0.0, 0.0, 0.0)) -> Matrix:
    """A rigid motion of exactly this length (mm) of the point `about`, and this angle, in random directions; (4, 4)."""
    direction, axis = (v / np.linalg.norm(v) for v in rng.standard_normal((2, 3)))
    linear = scipy.spatial.transform.Rotation.from_rotvec(math.radians(rotation_deg) * axis).as_matrix()
    return affine(linear, np.asarray(about) - linear @ np.asarray(about) + translation * direction)


def tracker_poses(timestamps: Floats) -> Matrix:
    """ReferenceToTracker, (n, 4, 4), mm: a camera 1.4 m away; the patient's marker rocks by half a millimeter as they breathe."""
    pose = affine(
        scipy.spatial.transform.Rotation.from_euler("xyz", [112.0, -17.0, 38.0], degrees=True).as_matrix(), (86.0, -145.0, -1390.0)
    )
    poses = np.tile(pose, (len(timestamps), 1, 1))
    breath = np.sin(2 * math.pi * 0.25 * np.asarray(timestamps))
    poses[:, :3, 3] += 0.5 * breath[:, None] * np.array([0.3, 0.8, 0.5])
    rocking = scipy.spatial.transform.Rotation.from_rotvec(np.deg2rad(0.1) * breath[:, None] * np.array([[1.0, 0.0, 0.0]]))
    poses[:, :3, :3] = poses[:, :3, :3] @ rocking.as_matrix()
    return poses


def simulate_sweep(
    phantom: UltrasoundTarget,
    probe: PhasedArray,
    path: ProbePath,
    *,
    errors: TrackingErrors | None = None,
    effects: UltrasoundEffects | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> TrackedSequence:
    """The recording of a scan, as Plus would write it.

    Returns
    -------
    sequence : TrackedSequence
        uint8 images; per frame ProbeToTracker and ReferenceToTracker with their statuses, timestamps and an OK image status.
        ImageToProbe is not in it: it belongs to the configuration (`plus_configuration_xml`).

    Notes
    -----
    Errors never touch the images, which are taken at the true poses. Every image and the errors draw from generators of their own, so the
    same seed gives the same images under any errors of tracking.
    """
    poses = np.array([probe.probe_to_reference(pose) for pose in path.transducer_to_reference])
    images = np.empty((len(path), probe.rows, probe.columns), dtype=np.uint8)
    for n, pose in enumerate(poses):
        report(progress, n / len(path), "Simulating ultrasound frames")
        images[n] = simulate_frame(phantom, probe, pose, np.random.default_rng([seed, 31, n]), effects)
    report(progress, 1.0, "Sweep simulated")
    return TrackedSequence(images, recorded_poses(probe, path, errors, seed))


def recorded_poses(probe: PhasedArray, path: ProbePath, errors: TrackingErrors | None = None, seed: int = 0) -> list[FrameRecord]:
    """What is recorded beside the images of a scan: ProbeToTracker and ReferenceToTracker of each frame, with these errors."""
    errors = errors or TrackingErrors()
    late = np.array([probe.probe_to_reference(pose) for pose in path.delayed(errors.time_offset).transducer_to_reference])
    reference_to_tracker = tracker_poses(path.timestamps)
    gone = (path.timestamps - path.timestamps[0]) / max(np.ptp(path.timestamps), 1e-9)
    drift = errors.drift * gone[:, None] * random_rigid(1.0, 0.0, np.random.default_rng([seed, 32]))[:3, 3]
    probe_to_tracker = reference_to_tracker @ patient_motion(path.timestamps, errors, seed) @ late
    probe_to_tracker[:, :3, 3] += drift
    return [
        FrameRecord(
            float(timestamp),
            float(timestamp),
            TransformStatus.OK,
            {PROBE_TO_TRACKER: TransformSample(of_probe), REFERENCE_TO_TRACKER: TransformSample(of_reference)},
        )
        for timestamp, of_probe, of_reference in zip(path.timestamps, probe_to_tracker, reference_to_tracker)
    ]


def patient_motion(timestamps: Floats, errors: TrackingErrors, seed: int = 0) -> Matrix:
    """Where the patient's bone has moved to in Reference at each time, (n, 4, 4): the probe follows it, and its images stay the same."""
    rng = np.random.default_rng([seed, 60])
    moved = np.tile(np.eye(4), (len(timestamps), 1, 1))
    passes = np.concatenate([[0], np.cumsum(np.diff(timestamps) > 1.0)])
    about = np.array([0.0, AIM_DEPTH + 10.0, 0.0])
    for number in range(int(passes[-1]) + 1):
        turn = np.radians(errors.shifting / 2) * rng.standard_normal(3)
        linear = scipy.spatial.transform.Rotation.from_rotvec(turn).as_matrix()
        one = affine(linear, about - linear @ about + errors.shifting * rng.standard_normal(3))
        moved[passes == number] = one
    phase = 2 * math.pi * (np.asarray(timestamps) / BREATH + rng.random())
    moved[:, :3, 3] += errors.breathing * np.sin(phase)[:, None] * BREATHES_ALONG
    middle = timestamps[np.flatnonzero(passes == passes[-1] // 2)].mean()
    moved[:, :3, 3] += errors.step * (timestamps > middle)[:, None] * random_rigid(1.0, 0.0, rng)[:3, 3]
    return moved


def plus_configuration_xml(probe: PhasedArray, image_to_probe: Matrix | None = None, output_spacing: float = 0.5) -> str:
    """The text of a Plus device set configuration: calibration, scan conversion and volume reconstruction of this probe.

    Parameters
    ----------
    image_to_probe : (4, 4) array, pixels to mm, optional
        The calibration to write; the probe's own by default.
    output_spacing : float, mm

    Notes
    -----
    Plus measures ScanConversion in mm from the transducer's center, which lies `RadiusStartMm` below the apex, and the fan of a volume
    reconstruction in pixels.
    """
    matrix = probe.image_to_probe if image_to_probe is None else np.asarray(image_to_probe)
    rows = "\n".join("        " + " ".join(f"{value:.9g}" for value in row) for row in matrix)
    spacing, half, fan = probe.pixel_spacing, probe.field_of_view_deg / 2, probe.fan
    apex, center = fan.apex_px, (fan.apex_px[0], fan.apex_px[1] + probe.radii[0] / spacing)
    return f"""<PlusConfiguration version="2.9">
  <DataCollection StartupDelaySec="1.0">
    <DeviceSet Name="{SIMULATION}" Description="Simulated phased array with optical tracking." />
  </DataCollection>
  <CoordinateDefinitions>
    <Transform From="Image" To="Probe"
      Matrix="
{rows}" />
  </CoordinateDefinitions>
  <ScanConversion TransducerName="Simulated phased array" TransducerGeometry="CURVILINEAR"
    RadiusStartMm="{probe.radii[0]:.9g}" RadiusStopMm="{probe.radii[1]:.9g}" ThetaStartDeg="{-half:.9g}" ThetaStopDeg="{half:.9g}"
    OutputImageSizePixel="{probe.columns} {probe.rows}" OutputImageSpacingMmPerPixel="{spacing:.9g} {spacing:.9g}"
    TransducerCenterPixel="{center[0]:.9g} {center[1]:.9g}" />
  <VolumeReconstruction ImageCoordinateFrame="Image" ReferenceCoordinateFrame="Reference"
    OutputSpacing="{output_spacing:g} {output_spacing:g} {output_spacing:g}"
    ClipRectangleOrigin="0 0" ClipRectangleSize="{probe.columns} {probe.rows}"
    FanAnglesDeg="{fan.angles_deg[0]:.9g} {fan.angles_deg[1]:.9g}" FanOriginPixel="{apex[0]:.9g} {apex[1]:.9g}"
    FanRadiusStartPixel="{fan.radii[0]:.9g}" FanRadiusStopPixel="{fan.radii[1]:.9g}"
    Interpolation="NEAREST_NEIGHBOR" Optimization="NONE" CompoundingMode="MEAN" FillHoles="OFF" />
</PlusConfiguration>
"""
