"""The surface of bone from the echoes of all frames and angles, laid together: what takes the place of a CT.

References
----------
Hoppe H, DeRose T, Duchamp T, McDonald J, Stuetzle W (1992), "Surface reconstruction from unorganized points", SIGGRAPH: tangent planes
of neighboring points, and distances to them. Levin D (2004), "Mesh-independent surface interpolation", Geometric Modeling for Scientific
Visualization: planes by moving least squares. Curless B, Levoy M (1996), "A volumetric method for building complex models from range
images", SIGGRAPH: what a line of sight says of the space before and behind a point.
"""

from __future__ import annotations

import copy
import itertools
import threading
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import scipy

from ...arrays import Floats, Integers, Mask, Singles
from ...errors import BeamGeometryError, GeometryError, InsufficientMemoryError
from ...geometry.volume import Volume, VoxelGrid
from ...machine.memory import LARGEST_GRID, require_memory
from ...machine.threads import in_parts, usable_cores
from ...message import Sentence, listed, message_of
from ...progress import Progress, Steps, carry_out, part
from ...recipe.recipe import Recipe
from ...remedies import CHECK_PROBE_AND_CLIP
from ...sweep.frames import TrackedSequence
from ...sweep.multi_sweep import sweeps_of
from ..map import BoneMap
from .found import SweepEchoes
from .search import sweep_echoes

SPACING = 1.0
"""mm between the middles of cubes, which lie at whole multiples of it in Reference: all sums have the same cubes."""

HALF, ACROSS = 2**20, 2**21
"""Cubes on either side of the origin of Reference, and in all: how their numbers are made up."""

LEAST_SCORE = 0.35
"""From which echoes take part: those of many frames bear each other out, so that weaker ones count than in a registration."""

LEAST_A_FRAME = 3.0
"""Echoes in a frame on the mean, below which there is hardly any bone."""

SHADOW_FROM, SHADOW_TO = 2.5, 25.0
"""mm behind an echo where sound does not pass, and what looks like bone needs more frames that show it; as far before it sound passed."""

SHADOWED = 0.2
"""How much the shadow of an echo counts against one that lies in it, mm for mm."""

LEAST_TRUST = 0.35
"""Share of the echoes at a place in all that is said about it, its shadows included, from which an echo there takes part."""

LEAST_CROSSED = 0.2
"""Scores in a cubic mm, of beams that passed and of shadows, from which both are known of a place: bone lies between them."""

BLUR = 1.0
"""mm over which what is said of a place is averaged."""

NEIGHBORHOOD = 2.0
"""mm, standard deviation: the echoes that a plane is laid through."""

THICKNESS, REACH = 0.8, 2.0
"""mm, standard deviations: how far from its plane bone may lie, and how far beyond the last echo it goes on."""

FARTHEST = 3.0
"""mm from the nearest echo beyond which nothing is said."""

CUT_OFF = 3.0
"""Standard deviations beyond which a Gaussian is 0."""

PAIRS = [(a, b) for a in range(3) for b in range(a, 3)]
AT_ONCE = 4096
"""Echoes that are added, and voxels that planes are laid at, in one step."""

LAYING = "Laying echoes together"

BYTES_PER_VOXEL = 90
"""While planes are laid: sums and their blurred forms for two moments at a time, what beams passed, distances, and the map."""


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
    sweeps = sweeps_of(sequence, recipe)
    found = sweep_echoes(sweeps, recipe, most_frames=None, least_score=LEAST_SCORE, progress=part(progress, 0.0, 0.9))
    frames = sum(len(sweep) for sweep in sweeps)
    if len(found) < LEAST_A_FRAME * frames or not found.show_bone:
        raise GeometryError(
            f"{listed([sweep.name for sweep in sweeps])}: the images show hardly any bone, {len(found)} echoes in {frames} frames.",
            CHECK_PROBE_AND_CLIP,
        )
    if may_be is not None:
        found = found[may_be(found.points)]
    return replace(surface_of(found, part(progress, 0.9, 1.0)), made={"bone_from_sweep": True})


def default_bone(
    sequence: TrackedSequence, recipe: Recipe, progress: Progress | None = None
) -> tuple[Recipe, BoneMap | None, tuple[str, ...]]:
    """What is done where nobody has said how, by a method, a bone input or a configuration: recipe, bone, and why there is none.

    That is `bone_from_sweep` where the images show bone, and nothing of it where they do not or the probe is not known.
    """
    asked = recipe.given("method", "importance_mask", "speed_of_sound") or sequence.configuration.method
    if asked or sequence.configuration.uses_importance_mask:
        return recipe, None, ()
    try:
        bone = bone_from_sweep(sequence, recipe, progress)
    except (BeamGeometryError, GeometryError, InsufficientMemoryError) as error:
        return recipe, None, (Sentence(f"No CT, and no bone that the sweep shows by itself: a plain average. {message_of(error)}", error),)
    return replace(recipe, bone_from_sweep=True), replace(bone, notes=(f"No CT. {bone.notes[0]}", *bone.notes[1:])), ()


def surface_of(echoes: SweepEchoes, progress: Progress | None = None) -> BoneMap:
    """The bone that echoes show: probability, side and inside, as far as there are any.

    Raises GeometryError when there are none.
    """
    surface = EchoSurface()
    surface.add(echoes)
    found = carry_out(surface.news(usable_cores()), progress)
    if found is None:
        raise GeometryError("No frame shows an echo of bone.", CHECK_PROBE_AND_CLIP)
    return replace(found, notes=(f"Bone was found by {len(echoes):,} echoes in {len(np.unique(echoes.frames)):,} frames.",))


class EchoSurface:
    """The surface that echoes lie on, which may come one after the other. What is kept of them are sums in cubes of 1 mm.

    Echoes may be added by one thread while another asks for `news`: those that are added meanwhile come with the next. A third may ask for
    the `whole`.

    Notes
    -----
    At each voxel near echoes, a plane is laid through those around it: by their Gaussian-weighted mean and covariance, along the direction
    of its least spread, faced by the beams that saw them. With h the voxel's height over that plane and d its distance to the nearest echo,
    P = exp(-h^2 / 2 T^2 - d^2 / 2 R^2), T = `THICKNESS`, R = `REACH`. An echo counts by its score times its
    trust B / (B + 0.2 S), with B the scores of the echoes at its place and S those of the echoes in whose
    shadow it lies, per mm: echoes in the shadow of bone that other beams met before are reverberation more
    often than bone.

    Oblique bone sends no echo back, but stops the beams that meet it. It lies where what beams passed on their way to an echo borders on
    the shadows of echoes, of all angles: with F the scores of the beams that passed a place, and S as above, where F / (F + S) is a half.
    There P = exp(-h^2 / 2 T^2), h the distance from that border. The larger P holds.

    All follows from sums over echoes in cubes, so that a part has the values of the whole.
    """

    def __init__(self) -> None:
        self._new: deque[SweepEchoes] = deque()
        self._adding = threading.Lock()
        self._shown, self._crossed = _CubeSums(13), _CubeSums(2)
        self._changed: list[Integers] = []

    def add(self, echoes: SweepEchoes) -> None:
        """Take more echoes, of a frame or of a sweep."""
        if len(echoes):
            self._new.append(echoes)

    def take_in(self) -> bool:
        """Add up what has come; whether there are news."""
        new = SweepEchoes.joined([self._new.popleft() for _ in range(len(self._new))])
        depths = np.arange(SHADOW_FROM, SHADOW_TO, SPACING)
        for first in range(0, len(new), AT_ONCE):
            some = new[np.arange(first, min(first + AT_ONCE, len(new)))]
            ways = [some.points + depth * some.beams for depth in (*depths, *-depths)]
            cubes, crossed = cubes_of(some.points), cubes_of(np.concatenate(ways))
            scores = np.tile(some.scores.astype(np.float64), len(depths))
            with self._adding:
                self._shown.add(cubes, _moments(some))
                self._crossed.add(crossed, np.kron(np.eye(2), scores).astype(np.float64))
            self._changed += [end(of, axis=0) for of in (cubes, crossed) for end in (np.min, np.max)]
        return bool(self._changed)

    def whole(self) -> Steps[BoneMap | None]:
        """The map of all that was taken in, for another than who asks for `news`."""
        other = EchoSurface()
        with self._adding:
            other._shown, other._crossed = copy.deepcopy((self._shown, self._crossed))
        other.renew()
        return (yield from other.news())

    def renew(self) -> None:
        """The next `news` are of all that is known."""
        if len(self._shown.cubes):
            self._changed += list(self._ends())

    def _ends(self) -> tuple[Integers, Integers]:
        """From where to where there may be bone."""
        cubes, beyond = self._shown.cubes, int(FARTHEST / SPACING) + 1
        return cubes.min(axis=0) - beyond, cubes.max(axis=0) + beyond

    def news(self, threads: int = 1, within: tuple[Floats, Floats] | None = None) -> Steps[BoneMap | None]:
        """The part of the map that has changed since this was asked last, as far as it lies in a box (from, to; mm in Reference)."""
        yield 0.0, LAYING
        if not self.take_in():
            return None
        changed, self._changed = np.array(self._changed), []
        # A change reaches as far as trusts and neighborhoods are averaged; so does what the values there are made of
        (first, last), reach = self._ends(), int(CUT_OFF * (NEIGHBORHOOD + BLUR) / SPACING)
        low, high = np.maximum(changed.min(axis=0) - reach, first), np.minimum(changed.max(axis=0) + reach, last)
        if within is not None:
            low, high = np.maximum(low, cubes_of(within[0]) - 1), np.minimum(high, cubes_of(within[1]) + 1)
        if (low > high).any():
            return None
        start, stop = np.maximum(low - reach, first), np.minimum(high + reach, last)
        shape = tuple((stop - start + 1)[::-1].tolist())
        require_memory(shape[::-1], np.full(3, SPACING), BYTES_PER_VOXEL, most=LARGEST_GRID)
        voxels, sums, crossed = self._trusted(start, stop, shape)
        yield 0.2, LAYING
        away = _away(voxels, shape)
        part_of = tuple(slice(a, b + 1) for a, b in zip((low - start)[::-1].tolist(), (high - start)[::-1].tolist(), strict=True))
        wanted = np.zeros(shape, bool)
        wanted[part_of] = away[part_of] <= FARTHEST
        near = np.flatnonzero(wanted)
        moments = np.empty((len(sums), near.size))

        def gather(number: int) -> None:
            moments[number] = _blurred(voxels, sums[number], shape, NEIGHBORHOOD).reshape(-1)[near]

        yield from _each(gather, len(sums), threads, 0.3)
        places = np.stack(np.unravel_index(near, shape)[::-1], axis=1) + start
        probability, inside, slopes = np.zeros(shape, np.float32), np.zeros(shape, np.uint8), np.zeros((3, *shape), np.float32)

        def lay(number: int) -> None:
            some = slice(number * AT_ONCE, (number + 1) * AT_ONCE)
            heights, normals = _planes(SPACING * places[some], moments[:, some])
            at = tuple((places[some] - start).T[::-1])
            probability[at] = np.exp(-0.5 * (heights / THICKNESS) ** 2 - 0.5 * (away[at] / REACH) ** 2)
            inside[at] = heights > 0
            slopes[(slice(None), *at)] = normals.T

        yield from _each(lay, -(-near.size // AT_ONCE), threads, 0.7)
        border, between, beyond, across = _between(*crossed)
        larger = between > probability.reshape(-1)[border]
        border = border[larger]
        probability.reshape(-1)[border], inside.reshape(-1)[border] = between[larger], beyond[larger]
        slopes.reshape(3, -1)[:, border] = across[:, larger]
        yield 1.0, "Laid echoes together"
        around = VoxelGrid.from_spacing(SPACING * start, shape[::-1], SPACING).ijk_to_reference
        surface, behind = (Volume(values, around)[part_of] for values in (probability, inside))
        return BoneMap(surface, behind, slopes=np.ascontiguousarray(slopes[(slice(None), *part_of)]))

    def _trusted(self, start: Integers, stop: Integers, shape: tuple[int, ...]) -> tuple[Integers, Floats, list[Singles]]:
        """The voxels (n,), flat, that echoes are believed at, the sums (13, n) there; and everywhere, [k, j, i], shadows and beams."""
        (cubes, sums), (along, scores) = (of.within(start, stop) for of in (self._shown, self._crossed))
        voxels, ways = (np.ravel_multi_index((at - start).T[::-1], shape) for at in (cubes, along))
        echo = _blurred(voxels, sums[0], shape, BLUR).reshape(-1)[voxels]
        crossed = [_blurred(ways, each, shape, BLUR).astype(np.float32) for each in scores]
        trust = echo / (echo + SHADOWED * crossed[0].reshape(-1)[voxels])
        believed = trust >= LEAST_TRUST
        return voxels[believed], (sums * trust)[:, believed], crossed


def _each(work: Callable[[int], None], parts: int, threads: int, start: float) -> Steps[None]:
    """Parts of the work, so many at a time as there are threads."""
    numbers = itertools.count()
    for first in range(0, parts, threads):
        yield start + 0.3 * first / parts, LAYING
        in_parts(lambda _: work(next(numbers)), min(threads, parts - first), threads)


def _moments(echoes: SweepEchoes) -> Floats:
    """What a plane is laid by, (13, n): scores, and by these places, beams, and products of places."""
    products = [echoes.points[:, a] * echoes.points[:, b] for a, b in PAIRS]
    moments: Floats = np.stack([np.ones(len(echoes)), *echoes.points.T, *echoes.beams.T, *products]) * echoes.scores
    return moments


def _planes(places: Floats, moments: Floats) -> tuple[Floats, Floats]:
    """How far places (n, 3) lie behind the planes by these moments (13, n), and the planes' normals (n, 3)."""
    mean = (moments[1:4] / moments[0]).T
    covariance = np.empty((len(places), 3, 3))
    for (a, b), second in zip(PAIRS, moments[7:], strict=True):
        covariance[:, a, b] = covariance[:, b, a] = second / moments[0] - mean[:, a] * mean[:, b]
    normals = np.linalg.eigh(covariance)[1][:, :, 0]
    normals *= np.where((normals * moments[4:7].T).sum(axis=1) < 0, -1.0, 1.0)[:, None]
    return ((places - mean) * normals).sum(axis=1), normals


def _between(shadow: Singles, passed: Singles) -> tuple[Integers, Singles, Mask, Singles]:
    """The border of what was passed and what was shadowed, [k, j, i]: flat voxels (n,) around it, probability, what lies behind it, and
    its normals (3, n)."""
    known = np.minimum(shadow, passed) > LEAST_CROSSED
    known[[0, -1]] = known[:, [0, -1]] = known[:, :, [0, -1]] = False
    at, share = np.flatnonzero(known), (passed / np.maximum(passed + shadow, np.float32(1e-9))).reshape(-1)
    beside = (1, known.shape[2], known.shape[1] * known.shape[2])
    slopes = np.stack([share[at - step] - share[at + step] for step in beside]) / np.float32(2 * SPACING)
    steep = np.maximum(np.sqrt((slopes**2).sum(axis=0)), np.float32(1e-6))
    heights = (np.float32(0.5) - share[at]) / steep
    return at, np.exp(-0.5 * (heights / np.float32(THICKNESS)) ** 2), heights > 0, slopes / steep


def _away(voxels: Integers, shape: tuple[int, ...]) -> Singles:
    """How far each voxel [k, j, i] is from the nearest of these, flat, that lie not at the border; infinite from `FARTHEST` on, mm."""
    away, reach = np.full(shape, np.inf, np.float32), int(FARTHEST / SPACING)
    at = np.stack(np.unravel_index(voxels, shape), axis=1)
    at = at[np.all((at >= reach) & (at < np.array(shape) - reach), axis=1)]
    steps = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * 3), axis=-1).reshape(-1, 3)
    lengths = SPACING * np.linalg.norm(steps, axis=1)
    # The nearest is written last
    for number in np.argsort(-lengths):
        if lengths[number] <= FARTHEST:
            away[tuple((at + steps[number]).T)] = lengths[number]
    return away


def _blurred(voxels: Integers, values: Floats, shape: tuple[int, ...], sigma: float) -> Floats:
    """Values (n,) at voxels, flat, averaged over their neighborhoods, [k, j, i]."""
    sums = np.bincount(voxels, values, int(np.prod(shape))).astype(np.float64).reshape(shape)
    blurred: Floats = scipy.ndimage.gaussian_filter(sums, sigma / SPACING, mode="constant", truncate=CUT_OFF)
    return blurred


def cubes_of(points: Floats) -> Integers:
    """The cubes (n, 3) that points (n, 3), mm in Reference, lie in."""
    cubes: Integers = np.clip(np.rint(points / SPACING), -HALF, HALF - 1).astype(np.int64)
    return cubes


class _CubeSums:
    """What is kept of a scan, however long it lasts: sums of `many` values in each cube that has any; memory goes with these."""

    def __init__(self, many: int):
        self._numbers, self._sums = np.empty(0, np.int64), np.empty((many, 0))

    def add(self, cubes: Integers, values: Floats) -> None:
        """Add values (many, n) in cubes (n, 3)."""
        numbers, of = np.unique(_numbers(cubes), return_inverse=True)
        sums = np.stack([np.bincount(of.reshape(-1), each, len(numbers)) for each in values])
        at = np.searchsorted(self._numbers, numbers)
        known = np.append(self._numbers, -1)[at] == numbers
        self._sums[:, at[known]] += sums[:, known]
        self._numbers = np.insert(self._numbers, at[~known], numbers[~known])
        self._sums = np.insert(self._sums, at[~known], sums[:, ~known], axis=1)

    @property
    def cubes(self) -> Integers:
        """All that have sums, (n, 3)."""
        return _cubes(self._numbers)

    def within(self, low: Integers, high: Integers) -> tuple[Integers, Floats]:
        """The cubes (n, 3) from `low` to `high` that have sums, and these (many, n)."""
        first, last = np.searchsorted(self._numbers, _numbers(np.stack([low, high])))
        some = slice(first, last + 1)
        cubes = _cubes(self._numbers[some])
        inner = np.all((cubes >= low) & (cubes <= high), axis=1)
        return cubes[inner], self._sums[:, some][:, inner]


def _numbers(cubes: Integers) -> Integers:
    """One number for each cube (n, 3), in the order of arrays [k, j, i]."""
    i, j, k = cubes.T + HALF
    numbers: Integers = (k * ACROSS + j) * ACROSS + i
    return numbers


def _cubes(numbers: Integers) -> Integers:
    """The cubes (n, 3) with these numbers."""
    rest, i = np.divmod(numbers, ACROSS)
    cubes: Integers = np.stack([i, rest % ACROSS, rest // ACROSS], axis=1) - HALF
    return cubes
