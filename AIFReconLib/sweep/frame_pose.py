"""Where the image of one frame lies, by the transforms of that frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..arrays import Matrix
from ..errors import GeometryError, TransformError
from ..geometry.transform_graph import AGREE, TransformName, TransformSample, TransformStatus, Ways
from ..geometry.transforms import invert, why_not_affine, why_not_an_image_pose, why_not_rigid
from ..message import listed
from .frames import CROPPED


@dataclass(frozen=True, eq=False)
class FramePose:
    """The place of one image.

    Parameters
    ----------
    ways : Ways
        Those that were followed.
    matrix : (4, 4) float64 array or None, pixels to mm
    problem : str or None
        Why there is no matrix.
    loops : sequence of (2, 4, 4) array
        Where there are several ways: what each two of them give, see `Ways.follow`.
    """

    ways: Ways
    matrix: Matrix | None = None
    problem: str | None = None
    loops: Sequence[Matrix] = ()


def frame_pose(
    ways: Ways, transforms: Mapping[TransformName, TransformSample], static: Mapping[TransformName, TransformSample], image_frame: str
) -> FramePose:
    """Where the image lies, by the transforms of its frame and by those that hold for every frame."""
    samples, broken = _judge(ways, transforms, static, image_frame)
    seen = _without(ways, frozenset(broken))
    if seen is None:
        return FramePose(ways, problem=next(iter(broken.values())))
    try:
        matrix, loops = seen.follow({name: sample.matrix for name, sample in samples.items()})
    except GeometryError as error:
        return FramePose(ways, problem=str(error))
    problem = why_not_an_image_pose(matrix)
    return FramePose(seen, problem=f"image pose {problem}") if problem else FramePose(seen, matrix, loops=loops)


def require_agreement(whose: str, frame_size: tuple[int, int], ways: Ways, pairs: Mapping[int, Sequence[Matrix]]) -> None:
    """Return if the ways put the image's corners to one place in each of these frames.

    Raises
    ------
    TransformError
        Beginning with `whose` they are.
    """
    columns, rows = frame_size
    corners = np.array([(x, y, 0.0, 1.0) for x in (0.0, max(columns - 1, 1)) for y in (0.0, max(rows - 1, 1))]).T
    both = np.array(list(pairs.values()))
    gaps = np.linalg.norm(((both[..., 1, :, :] - both[..., 0, :, :]) @ corners)[..., :3, :], axis=-2).max(axis=-1)
    frame, pair = np.unravel_index(int(np.argmax(gaps)), gaps.shape)
    if gaps[frame, pair] > AGREE:
        raise TransformError(
            f"{whose}{ways.describe(int(pair))}. They differ by {float(gaps[frame, pair]):.3g} mm in frame {list(pairs)[frame]}.",
            "Say which one is right, as in {image_to_reference:{chain}}.",
            chain=listed((link.name for link in ways.path), ","),
        )


@lru_cache(maxsize=256)
def _without(ways: Ways, broken: frozenset[TransformName]) -> Ways | None:
    return ways.without(broken)


def _judge(
    ways: Ways, recorded: Mapping[TransformName, TransformSample], static: Mapping[TransformName, TransformSample], image_frame: str
) -> tuple[dict[TransformName, TransformSample], dict[TransformName, str]]:
    """One frame's transforms on the ways, and what is wrong with those that cannot be used, what says most first."""
    samples: dict[TransformName, TransformSample] = {}
    broken: dict[TransformName, str] = {}
    for name in ways.names:
        sample = recorded.get(name) or static.get(name) or _inverse(recorded.get(name.inverse))
        if sample is None:
            broken[name] = f"{name} not recorded"
            continue
        samples[name] = sample
        if sample.status is not TransformStatus.OK:
            broken[name] = f"{name} {sample.status.value}"
            continue
        scales_pixels = bool({image_frame, CROPPED.source} & {name.source, name.target})
        problem = why_not_rigid(sample.matrix) if name in recorded and not scales_pixels else why_not_affine(sample.matrix)
        if problem:
            broken[name] = f"{name} {problem}"
    return samples, broken


def _inverse(sample: TransformSample | None) -> TransformSample | None:
    """What a frame says that holds a transform the other way round than others do."""
    if sample is None or sample.status is not TransformStatus.OK or why_not_rigid(sample.matrix):
        return sample
    return TransformSample(invert(sample.matrix))
