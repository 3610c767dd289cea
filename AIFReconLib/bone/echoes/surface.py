"""The surface of bone from the echoes of all frames and angles, laid together: what takes the place of a CT.

References
----------
Hoppe H, DeRose T, Duchamp T, McDonald J, Stuetzle W (1992), "Surface reconstruction from unorganized points", SIGGRAPH: tangent planes
of neighboring points, and distances to them. Levin D (2004), "Mesh-independent surface interpolation", Geometric Modeling for Scientific
Visualization: planes by moving least squares. Curless B, Levoy M (1996), "A volumetric method for building complex models from range
images", SIGGRAPH: what a line of sight says of the space before and behind a point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import scipy

from ...arrays import Floats, Integers, Mask, Singles
from ...errors import BeamGeometryError, GeometryError, InsufficientMemoryError
from ...geometry.volume import Volume, VoxelGrid
from ...machine.memory import LARGEST_GRID, require_memory
from ...machine.threads import in_parts, usable_cores
from ...message import Sentence, listed, said
from ...progress import Progress, part, report
from ...recipe.recipe import Recipe
from ...remedies import Remedy
from ...sweep.frames import TrackedSequence
from ...sweep.joined import sweeps_of
from ..map import BoneMap
from .found import SweepEchoes
from .search import sweep_echoes

SPACING = 1.0
"""mm between voxels of the map."""

LEAST_SCORE = 0.35
"""From which echoes take part: those of many frames bear each other out, so that weaker ones count than in a registration."""

LEAST_BRIGHTNESS, LEAST_A_FRAME = 1.5, 3.0
"""Times the mean of its frame that an echo is, and echoes in a frame on the mean: little of tissue's speckle is so bright."""

SHADOW_FROM, SHADOW_TO = 2.5, 25.0
"""mm behind an echo: where sound does not pass, and what looks like bone there needs more frames that show it."""

SHADOWED = 0.2
"""How much the shadow of an echo counts against one that lies in it, mm for mm."""

LEAST_TRUST = 0.35
"""Share of the echoes at a place in all that is said about it, its shadows included, from which an echo there takes part."""

BLUR = 1.0
"""mm over which what is said of a place is averaged."""

NEIGHBORHOOD = 2.0
"""mm, standard deviation: the echoes that a plane is laid through."""

THICKNESS, REACH = 0.8, 2.0
"""mm, standard deviations: how far from its plane bone may lie, and how far beyond the last echo it goes on."""

FARTHEST = 3.0
"""mm from the nearest echo beyond which nothing is said."""

AGREED, PARALLEL = 0.1, 1e-6
"""Part of how far beams are apart at the median voxel, from which on a place counts in full: what only one side has seen is bone less
often, in a sweep from several. And how far they are apart, within a tenth of a degree, where the whole sweep came from one."""

BYTES_PER_VOXEL = 80
"""While planes are laid: sums and their blurred forms for two moments at a time, distances, and the map."""


def bone_from_sweep(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    progress: Progress | None = None,
    *,
    may_be: Callable[[Floats], Mask] | None = None,
) -> BoneMap:
    """A bone map drawn from the sweep itself, in Reference.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
    recipe : Recipe or None
        As in `reconstruct`.
    may_be : callable or None
        Of points (n, 3) in Reference, mm, which may be bone, (n,) bool; the echoes at others are left out.

    Raises
    ------
    BeamGeometryError
        When the probe is not known.
    GeometryError
        When too few echoes of bone are found, as in water or in tissue alone.
    """
    sweeps = sweeps_of(sequence)
    found = sweep_echoes(
        sweeps, recipe, most_frames=None, least_score=LEAST_SCORE, least_brightness=LEAST_BRIGHTNESS, progress=part(progress, 0.0, 0.9)
    )
    frames = sum(len(sweep) for sweep in sweeps)
    if len(found) < LEAST_A_FRAME * frames:
        raise GeometryError(
            f"{listed([sweep.name for sweep in sweeps])}: the images show hardly any bone, {len(found)} echoes in {frames} frames.",
            Remedy.CHECK_PROBE_AND_CLIP,
        )
    if may_be is not None:
        found = found[may_be(found.points)]
    return surface_of(found, part(progress, 0.9, 1.0))


def bone_unasked(
    sequence: TrackedSequence, recipe: Recipe, progress: Progress | None = None
) -> tuple[Recipe, BoneMap | None, tuple[str, ...]]:
    """What is done where nobody has said how, by a method, a bone input or a configuration: recipe, bone, and why there is none.

    That is `bone_from_sweep` where the images show bone, and nothing of it where they do not or the probe is not known.
    """
    asked = recipe.method or recipe.importance_mask or recipe.speed_of_sound or sequence.configuration.method
    if asked or sequence.configuration.uses_importance_mask:
        return recipe, None, ()
    try:
        bone = bone_from_sweep(sequence, recipe, progress)
    except (BeamGeometryError, GeometryError, InsufficientMemoryError) as error:
        return recipe, None, (Sentence(f"No CT, and no bone that the sweep shows by itself: a plain average. {said(error)}", error),)
    return replace(recipe, bone_from_sweep=True), replace(bone, notes=(f"No CT. {bone.notes[0]}", *bone.notes[1:])), ()


def surface_of(echoes: SweepEchoes, progress: Progress | None = None) -> BoneMap:
    """The bone that echoes show: probability, side and inside, as far as there are any.

    Notes
    -----
    At each voxel near echoes, a plane is laid through those around it: by their Gaussian-weighted mean and covariance, along the direction
    of its least spread, faced by the beams that saw them. With h the voxel's height over that plane, d its distance to the nearest echo,
    and a how far apart the beams are there (1 less the length of their mean),
    P = exp(-h^2 / 2 T^2 - d^2 / 2 R^2) min(1, a / (0.1 median(a))), T = `THICKNESS`, R = `REACH`. An echo counts by its score
    times its trust B / (B + 0.2 S), with B the scores of the echoes at its place and S those of the echoes in whose shadow it lies, per
    mm: echoes in the shadow of bone that other beams met before are reverberation more often than bone.
    """
    report(progress, 0.0, "Laying echoes together")
    grid = _grid_around(echoes.points)
    trust = _trust(echoes, grid)
    kept = trust >= LEAST_TRUST
    echoes, weights = echoes[kept], (echoes.scores * trust)[kept].astype(np.float64)
    voxels = _numbers(echoes.points, grid)
    report(progress, 0.3, "Laying echoes together")
    count = np.bincount(voxels, minlength=grid.voxels)
    away = scipy.ndimage.distance_transform_edt(count.reshape(grid.shape) == 0, sampling=SPACING)
    near = np.flatnonzero(away <= FARTHEST)
    away = away.reshape(-1)[near]
    # About the middle, so that differences of squares keep their digits
    offsets = echoes.points - (grid.origin + 0.5 * SPACING * (np.array(grid.size) - 1))
    pairs = [(a, b) for a in range(3) for b in range(a, 3)]
    wanted = [
        np.ones(len(weights)),
        *offsets.T,
        *echoes.beams.T,
        *(offsets[:, a] * offsets[:, b] for a, b in pairs),
    ]
    moments = np.empty((len(wanted), near.size))

    def gather(number: int) -> None:
        sums = np.bincount(voxels, weights * wanted[number], grid.voxels).astype(np.float64).reshape(grid.shape)
        moments[number] = _blurred(sums, NEIGHBORHOOD).reshape(-1)[near]

    in_parts(gather, len(wanted), usable_cores(), part(progress, 0.3, 0.9), "Laying echoes together")
    mean = (moments[1:4] / moments[0]).T
    covariance = np.empty((near.size, 3, 3))
    for (a, b), second in zip(pairs, moments[7:], strict=True):
        covariance[:, a, b] = covariance[:, b, a] = second / moments[0] - mean[:, a] * mean[:, b]
    normals = np.linalg.eigh(covariance)[1][:, :, 0]
    normals *= np.where((normals * moments[4:7].T).sum(axis=1) < 0, -1.0, 1.0)[:, None]
    k, j, i = np.unravel_index(near, grid.shape)
    places = SPACING * (np.stack([i, j, k], axis=1) - 0.5 * (np.array(grid.size) - 1))
    height = ((places - mean) * normals).sum(axis=1)
    apart = 1.0 - np.linalg.norm(moments[4:7], axis=0) / moments[0]
    agreed = np.clip((apart + PARALLEL) / (AGREED * np.median(apart) + PARALLEL), 0.0, 1.0)
    probability, inside, slopes = np.zeros(grid.voxels, np.float32), np.zeros(grid.voxels, np.uint8), np.zeros((3, grid.voxels), np.float32)
    probability[near] = np.exp(-0.5 * (height / THICKNESS) ** 2 - 0.5 * (away / REACH) ** 2) * agreed
    inside[near] = height > 0
    slopes[:, near] = normals.T
    report(progress, 1.0, "Laid echoes together")
    surface, behind = (Volume(values.reshape(grid.shape), grid.ijk_to_reference) for values in (probability, inside))
    notes = (f"Bone is the surface that {len(echoes):,} echoes of {len(np.unique(echoes.frames)):,} frames lie on.",)
    return BoneMap(surface, behind, notes, slopes.reshape(3, *grid.shape))


def _grid_around(points: Floats) -> VoxelGrid:
    """Cubes around points with room for their neighborhoods."""
    low, high = points.min(axis=0) - 3 * NEIGHBORHOOD, points.max(axis=0) + 3 * NEIGHBORHOOD
    size = (np.ceil((high - low) / SPACING).astype(int) + 1).tolist()
    require_memory((size[0], size[1], size[2]), np.full(3, SPACING), BYTES_PER_VOXEL, most=LARGEST_GRID)
    return VoxelGrid.from_spacing(low, size, SPACING)


def _trust(echoes: SweepEchoes, grid: VoxelGrid) -> Singles:
    """Of each echo, what the others say of its place, (n,), 0 to 1."""
    at = _numbers(echoes.points, grid)
    shown = np.bincount(at, echoes.scores, grid.voxels).astype(np.float64)
    shadowed = np.zeros(grid.voxels)
    for depth in np.arange(SHADOW_FROM, SHADOW_TO, SPACING):
        behind = echoes.points + depth * echoes.beams
        within = np.all((behind >= grid.origin) & (behind <= grid.origin + SPACING * (np.array(grid.size) - 1)), axis=1)
        shadowed += np.bincount(_numbers(behind[within], grid), echoes.scores[within], grid.voxels)
    echo, shadow = (_blurred(sums.reshape(grid.shape), BLUR).reshape(-1)[at] for sums in (shown, shadowed))
    trust: Singles = (echo / (echo + SHADOWED * shadow)).astype(np.float32)
    return trust


def _numbers(points: Floats, grid: VoxelGrid) -> Integers:
    """The voxels [k, j, i], flat, that points (n, 3) within the grid lie in."""
    i, j, k = np.rint((points - grid.origin) / SPACING).astype(np.int64).T
    numbers: Integers = (k * grid.size[1] + j) * grid.size[0] + i
    return numbers


def _blurred(sums: Floats, sigma: float) -> Floats:
    blurred: Floats = scipy.ndimage.gaussian_filter(sums, sigma / SPACING, mode="constant", truncate=3.0)
    return blurred
