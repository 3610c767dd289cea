"""Image to probe from recordings of a phantom of N-wires, measured on frames that it has not seen.

The dots of an N tell, by the ratio of their distances, where the image plane cuts its middle wire: a point known in the phantom and in
the image. The outer dots tell how far off each wire is within the image.

References
----------
Chen TK, Thurston AD, Ellis RE, Abolmaesumi P (2009), Ultrasound in Medicine and Biology 35:79-93: middle wires by least squares. Carbajal
G, Lasso A, Gomez A, Fichtinger G (2013), Improving N-wire phantom-based freehand ultrasound calibration, International Journal of
Computer Assisted Radiology and Surgery 8:1063-1072: distances of wires within the image.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy

from ..arrays import Floats, Matrix
from ..errors import NoUsableFramesError, SettingsError, TransformError
from ..geometry.transform_graph import TransformName
from ..geometry.transforms import affine, invert, transform_points, unit_vectors
from ..message import Judged, Sentence, listed
from ..progress import Progress, part, report
from ..remedies import MISSING_LINK
from ..sweep.frames import CROPPED, TrackedSequence
from ..sweep.multi_sweep import sweeps_of
from ..sweep.poses import chain_ends, sweep_poses
from .wire_points import ORDERS, WireFrames, as_wires, wire_points

PHANTOM = "Phantom"
"""What Plus calls the phantom's frame."""

MOST_FRAMES = 300
FEWEST_FRAMES = 20

SHALLOWEST = 8.0
"""mm of depth that the wires must be seen over."""

FARTHEST = 1.5
"""mm. Wires that lie farther off than that in the median are not those of this phantom in this place."""

HALVES_APART = 2.0
"""mm. Farther apart the calibrations of both halves do not tell the same."""

TWO_WAYS, AS_NEAR = 1.5, 0.3
"""Times the distance of the best order of wires, and mm, below which another order fits as well."""

OUTLIER, LEAST_OUTLIER = 4.0, 1.0
"""Times the median distance, and mm, beyond which a frame's wires were taken for others."""

BLOCKS = 8
"""Parts of the recording, in the order of time: every other one is of the same half, and each is left out once for the uncertainty."""

SOFT = 0.5
"""mm beyond which a distance counts less than squared (scipy's soft_l1)."""

STEPS = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01, 0.01, 0.01])
"""Units of shift (mm), turn (radians) and logarithms of the pixel's size for the solver."""


@dataclass(frozen=True, eq=False, repr=False)
class WireCalibration(Judged):
    """What recordings of an N-wire phantom say of the calibration."""

    name: TransformName  #: Such as ImageToProbe
    image_to_probe: Matrix  #: (4, 4), pixels to mm
    given: Matrix | None  #: The one that the recordings came with, (4, 4); None without any
    frames: WireFrames  #: Those that were used
    tried: int  #: Frames that were looked at
    shown: int  #: Frames of those that show all wires
    other_half: float  #: mm. Median distance of the wires of one half by the calibration of the other; the mean of both ways round.
    apart: float  #: mm. How far apart the two halves place the wires' dots, in the median.
    uncertainty: float  #: mm. Dots are placed within this in the median, 9 times in 10, the phantom's place taken for true.
    depths: tuple[float, float]  #: mm. From where to where wires were seen.
    reason: str | None  #: Why it must not be used; None where it may be

    def _facts(self) -> list[tuple[str, str]]:
        return [("accepted", str(self.accepted)), ("frames", str(len(self.frames.numbers)))]

    @property
    def changed(self) -> float | None:
        """mm. How far the new calibration moves the dots in the frame of the probe, in the median; None without an old one."""
        return None if self.given is None else _apart(self.frames, self.image_to_probe, self.given)


def calibrate_on_wires(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    wires: Mapping[str, Floats],
    *,
    name: str | None = None,
    progress: Progress | None = None,
) -> WireCalibration:
    """Image to probe, pixel sizes included, from recordings of an N-wire phantom whose place is known.

    Parameters
    ----------
    sequences : TrackedSequence or several, all of one calibration
        They must lead from Probe to Phantom: PhantomToReference is recorded, or in the configuration, as Plus's phantom registration
        writes it.
    wires : mapping of names to (2, 3) arrays, mm
        As `read_wire_phantom` reads them.
    name : str or None
        What the calibration is called, as in "ImageToTransducer"; None: ImageToProbe.

    Raises
    ------
    AIFReconError
        For input that cannot be used. A calibration that must not be used is no error: see `WireCalibration.refusal`.
    """
    ends = as_wires(wires)
    sweeps = sweeps_of(sequences)
    called = TransformName.parse(name) if name else TransformName(chain_ends(sweeps[0].configuration, None, None)[0].source, "Probe")
    given = sweeps[0].configured().get(called)
    found, tried = _seen(sweeps, called.target, ends, part(progress, 0.0, 0.8))
    if len(found.numbers) < FEWEST_FRAMES:
        raise NoUsableFramesError(
            f"All {len(wires)} wires are seen in {len(found.numbers)} of {tried} frames, and {FEWEST_FRAMES} are needed. Scan across the "
            "wires with all of them in the image, at a gain at which little else is bright, and check that this is the phantom."
        )
    report(progress, 0.8, "Solving the calibration")
    shown = len(found.numbers)
    orders = (replace(found, points=found.points[:, ::rows, ::across]) for rows, across in ORDERS)
    starts = sorted((_start(each) for each in orders), key=lambda one: one[0])[:2]
    fits = [(float(np.median(each.distances(end := _solve(each, start)))), each, end) for _, each, start in starts]
    (best, found, solved), (rival, _, _) = sorted(fits, key=lambda one: one[0])
    off = found.distances(solved).mean(axis=(1, 2))
    found = found[np.flatnonzero(off <= max(OUTLIER * float(np.median(off)), LEAST_OUTLIER))]
    solved = _solve(found, solved)
    block = np.arange(len(found.numbers)) * BLOCKS // len(found.numbers)
    without = []
    for number in range(BLOCKS):
        report(progress, 0.85 + 0.1 * number / BLOCKS, "Judging the calibration")
        without.append(_solve(found[block != number], solved))
    halves = [_solve(found[block % 2 == side], solved) for side in (0, 1)]
    other = [float(np.median(found[block % 2 != side].distances(half))) for side, half in enumerate(halves)]
    apart = _apart(found, *halves)
    spread = np.sqrt((BLOCKS - 1) / BLOCKS * sum(_apart(found, each, solved) ** 2 for each in without))
    depth = found.points[..., 1].ravel() * np.linalg.norm(solved[:3, 1])
    depths = float(np.quantile(depth, 0.02)), float(np.quantile(depth, 0.98))
    reason = _refusal(found, solved, depths, apart, rival < max(TWO_WAYS * best, AS_NEAR))
    report(progress, 1.0, "Calibrated")
    uncertainty = math.hypot(1.645 * spread, apart / 2)  # 9 times in 10 of a normal distribution
    before = None if given is None else given.matrix
    return WireCalibration(called, solved, before, found, tried, shown, float(np.mean(other)), apart, uncertainty, depths, reason)


def _seen(sweeps: list[TrackedSequence], probe: str, wires: Floats, progress: Progress | None) -> tuple[WireFrames, int]:
    """The frames that show all wires, and how many frames were looked at."""
    across = scipy.linalg.null_space(unit_vectors(wires[0, 0, 1] - wires[0, 0, 0])[None])
    section = wires[:, [0, 2], 0] @ across
    starts = np.cumsum([0, *map(len, sweeps)])
    tried = [(sweep, int(start), *frame) for sweep, start in zip(sweeps, starts, strict=False) for frame in _poses(sweep, probe)]
    chosen = np.unique(np.linspace(0, len(tried) - 1, min(len(tried), MOST_FRAMES)).round().astype(int))
    numbers, poses, points = [], [], []
    for count, (sweep, start, number, matrix) in enumerate(tried[each] for each in chosen):
        report(progress, count / len(chosen), "Looking for wires")
        dots = wire_points(sweep.images[number], section)
        if dots is not None:
            numbers.append(start + number)
            poses.append(matrix)
            points.append(dots)
    return WireFrames(np.array(numbers, np.int64), np.array(poses), np.array(points), wires), len(chosen)


def _poses(sweep: TrackedSequence, probe: str) -> list[tuple[int, Matrix]]:
    """Numbers and probe_to_phantom of the frames that have one."""
    names = [*sweep.configured(), *sweep.transform_names()]
    frames = {frame for name in names for frame in (name.source, name.target)}
    if PHANTOM not in frames:
        raise TransformError(
            f"{sweep.name}: nothing says where the phantom is. PhantomToReference is missing, which Plus's phantom registration finds with "
            "a stylus.",
            MISSING_LINK,
        )
    if probe not in frames:
        raise TransformError(
            f"{sweep.name}: it has no pose of {probe}. Known are {listed(sorted(frames))}: name the calibration, ImageToX."
        )
    if {CROPPED, CROPPED.inverse} & {*names}:
        raise SettingsError(f"{sweep.name}: its images were cropped. Calibrate with whole ones.")
    poses = sweep_poses(sweep, f"{probe}To{PHANTOM}")
    return [(int(number), poses.image_to_reference[number]) for number in poses.require_usable(sweep.name)]


def _start(found: WireFrames) -> tuple[float, WireFrames, Matrix]:
    """A calibration by the middle dots, and by how many mm they disagree with it in the median: linear."""
    targets = np.stack([transform_points(invert(pose), each) for pose, each in zip(found.probe_to_phantom, found.middles(), strict=True)])
    points = np.concatenate([found.points[:, :, 1].reshape(-1, 2), np.ones((targets.shape[0] * targets.shape[1], 1))], axis=1)

    def distances(columns: Floats) -> Floats:
        return (points @ columns.reshape(3, 3) - targets.reshape(-1, 3)).ravel()

    columns = scipy.optimize.least_squares(distances, np.zeros(9), loss="soft_l1", f_scale=SOFT, x_scale="jac").x.reshape(3, 3)
    off = np.linalg.norm(distances(columns).reshape(-1, 3), axis=1)
    across, along, origin = columns
    axes = np.stack([unit_vectors(across), unit_vectors(along), unit_vectors(np.cross(across, along))], axis=1)
    left, _, right = np.linalg.svd(axes)
    matrix = affine(left @ right * [np.linalg.norm(across), np.linalg.norm(along), 1.0], origin)
    return float(np.median(off)), found, matrix


def _solve(found: WireFrames, start: Matrix) -> Matrix:
    """Turn, shift and both pixel sizes with which wires lie nearest within the images, and middle dots in space; (4, 4), pixels to mm."""

    def moved(vector: Floats) -> Matrix:
        matrix = start.copy()
        turn = scipy.spatial.transform.Rotation.from_rotvec(vector[3:6]).as_matrix()
        matrix[:3, :3] = turn @ start[:3, :3] * [*np.exp(vector[6:]), 1.0]
        matrix[:3, 3] += vector[:3]
        return matrix

    def distances(vector: Floats) -> Floats:
        matrix = moved(vector)
        return np.concatenate([found.off(matrix).ravel(), found.middles_off(matrix).ravel()])

    solution = scipy.optimize.least_squares(distances, np.zeros(8), loss="soft_l1", f_scale=SOFT, x_scale=STEPS, max_nfev=50)
    return moved(solution.x)


def _refusal(found: WireFrames, solved: Matrix, depths: tuple[float, float], apart: float, two_ways: bool) -> Sentence | None:
    """Why a calibration must not be used, in one sentence or two; None where it may."""
    off = float(np.median(found.distances(solved)))
    if len(found.numbers) < FEWEST_FRAMES:
        return Sentence(
            f"Only {len(found.numbers)} frames agree with each other. Check that this is the phantom, and its place, and scan it slowly."
        )
    if off > FARTHEST:
        return Sentence(
            f"The wires lie {off:.1f} mm off with any calibration. Check that this is the phantom, and repeat its registration."
        )
    if two_ways:
        return Sentence("The wires fit two ways round. Scan them also with the probe tilted to both sides and turned by 20 degrees.")
    if depths[1] - depths[0] < SHALLOWEST:
        return Sentence(
            f"The wires are seen from {depths[0]:.0f} to {depths[1]:.0f} mm deep, and a calibration needs {SHALLOWEST:.0f} mm between. "
            "Scan them also from farther away."
        )
    if apart > HALVES_APART:
        return Sentence(f"The halves of the recording give calibrations that lie {apart:.1f} mm apart. Scan longer, and from more sides.")
    return None


def _apart(found: WireFrames, one: Matrix, other: Matrix) -> float:
    """mm. How far apart two calibrations place the dots of the wires, in the median."""
    points = np.concatenate([found.points.reshape(-1, 2), np.zeros((found.points[..., 0].size, 1))], axis=1)
    return float(np.median(np.linalg.norm(transform_points(one, points) - transform_points(other, points), axis=1)))


def wire_findings(found: WireCalibration) -> list[str]:
    """What a user should know, one line each."""
    distances = found.frames.distances(found.image_to_probe)
    lines = [
        f"all wires are seen in {found.shown} of {found.tried} frames, {found.depths[0]:.0f} to {found.depths[1]:.0f} mm deep; "
        f"{len(found.frames.numbers)} frames agree",
        f"wires lie {np.median(distances):.2f} mm off in the median, 95% within {np.quantile(distances, 0.95):.2f} mm",
        f"calibrated on one half of the frames, the wires of the other half lie {found.other_half:.2f} mm off",
    ]
    if found.accepted:
        lines.append(f"image points are placed within {found.uncertainty:.1f} mm in the median, where the phantom's place is right")
    if found.given is not None and found.changed is not None:
        was = np.median(found.frames.distances(found.given))
        lines.append(f"with the calibration as given wires lie {was:.2f} mm off, and image points {found.changed:.1f} mm elsewhere")
    across, along = np.linalg.norm(found.image_to_probe[:3, :2], axis=0)
    return [*lines, f"pixels are {across:.4f} mm wide and {along:.4f} mm high"]


def wire_report(found: WireCalibration, names: Iterable[str]) -> dict[str, object]:
    """The calibration as JSON holds it, mm; `names` are those of the wires, in their order."""
    distances = found.frames.distances(found.image_to_probe)
    of_wire = distances.reshape(len(distances), -1).T
    return {
        "accepted": found.accepted,
        "refusal": found.refusal,
        str(found.name): found.image_to_probe.tolist(),
        "frames": {"tried": found.tried, "shown": found.shown, "used": found.frames.numbers.tolist()},
        "median_distance_mm": round(float(np.median(distances)), 4),
        "distance_of_95_percent_mm": round(float(np.quantile(distances, 0.95)), 4),
        "median_distance_by_wire_mm": {name: round(float(np.median(one)), 4) for name, one in zip(names, of_wire, strict=True)},
        "other_half_mm": round(found.other_half, 4),
        "halves_apart_mm": round(found.apart, 4),
        "uncertainty_mm": round(found.uncertainty, 4),
        "depths_mm": [round(depth, 2) for depth in found.depths],
        "changed_mm": None if found.changed is None else round(found.changed, 4),
    }
