"""Where images show the wires of an N-wire phantom, and where a calibration expects them.

Wires are bright dots, three on a line for every N. Parallel wires meet a plane in an affine image of their cross-section, whatever the
pose of the plane and the size of its pixels. So the outer dots of all lines must be one affine map of the phantom's outer wires, and no
calibration is needed to know them.

References
----------
Chen TK, Thurston AD, Ellis RE, Abolmaesumi P (2009), A real-time freehand ultrasound calibration system with automatic accuracy feedback
and control, Ultrasound in Medicine and Biology 35:79-93: dots, and lines of three.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers, Matrix, Numbers
from ..errors import GeometryError
from ..geometry.transforms import unit_vectors

MOST_DOTS = 20
"""The brightest that are looked at."""

MOST_LINES = 40

FAINTEST = 0.1
"""Times the brightest dot of an image: fainter ones are none."""

SHORTEST = 0.15
"""Part of the image's width that an N spans at least."""

OFF = 0.02
"""Times the length of a line: how far its middle dot may lie off it, and its outer dots from where the other lines have them."""

ROWS_APART = 0.02
"""Part of the image's width between two lines."""

PARALLEL = 0.02
"""Between the directions of wires, of length 1, that count as parallel."""

FAR = 1e5
"""Pixels. Farther off no wire is expected."""

ORDERS = ((1, 1), (1, -1), (-1, 1), (-1, -1))
"""How the phantom may stand in the image: its first N on top or below, the first wire of an N on the left or on the right."""


@dataclass(frozen=True, eq=False)
class WireFrames:
    """Frames that show all wires."""

    numbers: Integers  #: (f,). Of all that were given, one sequence after the other
    probe_to_phantom: Matrix  #: (f, 4, 4), mm
    points: Floats  #: (f, n, 3, 2), pixels (column, row). Wires as the phantom lists them, or as the image shows them.
    wires: Floats  #: (n, 3, 2, 3), mm. Ends of each wire in the phantom.

    def __getitem__(self, chosen: Integers | Floats) -> WireFrames:
        """Some of the frames."""
        return WireFrames(self.numbers[chosen], self.probe_to_phantom[chosen], self.points[chosen], self.wires)

    def middles(self) -> Floats:
        """(f, n, 3) mm: where the image plane cuts the middle wires, in the phantom, by the ratio of distances to the outer ones."""
        line = self.points[:, :, 2] - self.points[:, :, 0]
        ratio = ((self.points[:, :, 1] - self.points[:, :, 0]) * line).sum(-1) / (line * line).sum(-1)
        front, back = self.wires[:, :, 0], self.wires[:, :, 1]
        along = unit_vectors(back[:, 0] - front[:, 0])
        across = front[:, 2] - front[:, 0]
        across = across - along * (across * along).sum(-1, keepdims=True)
        begins, ends = (((each[:, 1] - front[:, 0]) * across).sum(-1) / (across * across).sum(-1) for each in (front, back))
        part_of_wire = (ratio - begins) / (ends - begins)
        cut: Floats = front[:, 1] + part_of_wire[..., None] * (back[:, 1] - front[:, 1])
        return cut

    def expected(self, image_to_probe: Matrix) -> Floats:
        """(f, n, 3, 2) pixels: where a calibration (4, 4) expects the wires in the images."""
        phantom_to_image = np.linalg.inv(self.probe_to_phantom @ image_to_probe)
        turned = np.einsum("fij,nwej->fnwei", phantom_to_image[:, :3, :3], self.wires)
        front, back = np.moveaxis(turned + phantom_to_image[:, None, None, None, :3, 3], 3, 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            cut = (front + front[..., 2:] / (front[..., 2:] - back[..., 2:]) * (back - front))[..., :2]
        # A wire along the image meets it far away
        cut = np.clip(np.nan_to_num(cut, nan=FAR), -FAR, FAR)
        return np.asarray(cut, dtype=np.float64)

    def off(self, image_to_probe: Matrix) -> Floats:
        """(f, n, 3, 2) mm: how far off the wires lie within the image."""
        off: Floats = (self.expected(image_to_probe) - self.points) * np.linalg.norm(image_to_probe[:3, :2], axis=0)
        return off

    def middles_off(self, image_to_probe: Matrix) -> Floats:
        """(f, n, 3) mm: how far off the middle dots lie in the phantom, out of the image too."""
        points = np.concatenate([self.points[:, :, 1], np.zeros((*self.points.shape[:2], 1))], axis=-1)
        poses = self.probe_to_phantom @ image_to_probe
        off: Floats = np.einsum("fij,fnj->fni", poses[:, :3, :3], points) + poses[:, None, :3, 3] - self.middles()
        return off

    def distances(self, image_to_probe: Matrix) -> Floats:
        """(f, n, 3) mm: the same as lengths, within the image."""
        lengths: Floats = np.linalg.norm(self.off(image_to_probe), axis=-1)
        return lengths


def as_wires(wires: Mapping[str, Floats]) -> Floats:
    """The ends of the wires (n, 3, 2, 3); GeometryError where N's of them cannot be used."""
    ends = np.array(list(wires.values()), dtype=np.float64)
    if len(ends) < 6 or len(ends) % 3 or ends.shape[1:] != (2, 3) or not np.isfinite(ends).all():
        raise GeometryError(f"Input wires must be six or more, three for each N, (2, 3) each; got shape {ends.shape}.")
    ends = ends.reshape(-1, 3, 2, 3)
    along = ends[:, :, 1] - ends[:, :, 0]
    lengths = np.linalg.norm(along, axis=-1, keepdims=True)
    along = along / np.maximum(lengths, 1e-9)
    slanted = np.linalg.norm(along[:, 1] - along[:, 0], axis=-1) > PARALLEL
    if lengths.min() < 1 or not np.allclose(along[:, [0, 2]], along[0, 0], atol=PARALLEL) or not slanted.all():
        raise GeometryError(
            "The outer wires of all N's must be parallel, front ends on one side, and each middle wire slanted; these are not. Correct the "
            "phantom's description."
        )
    return ends


def wire_points(image: Numbers, section: Floats) -> Floats | None:
    """Where the wires are in an image, (n, 3, 2) pixels (column, row): lines from the top down, dots from left to right; None without.

    Parameters
    ----------
    image : (rows, columns) array
        Gray, MF.
    section : (n, 2, 2) array, mm
        Where the outer wires of each N cross a plane across them.
    """
    dots, brightness = bright_dots(image)
    triples = _lines(dots, SHORTEST * image.shape[1])
    if len(triples) < len(section):
        return None
    # Of several dots between the same two the brightest is met first
    triples = triples[np.lexsort((-brightness[triples[:, 1]], -brightness[triples].min(axis=1)))[:MOST_LINES]]
    points = dots[triples]
    sides = points[:, [0, 2]].reshape(-1, 4)
    heights = sides[:, 1::2].mean(axis=1)
    first, last = np.nonzero(heights[None] - heights[:, None] > (len(section) - 1) * ROWS_APART * image.shape[1])
    if not len(first):
        return None
    ends = np.concatenate([sides[first], sides[last]], axis=1).reshape(-1, 4, 2)
    widths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    best: tuple[float, Floats] | None = None
    for rows, across in ORDERS:
        ordered = section[::rows, ::across]
        homogeneous = np.concatenate([ordered, np.ones((*ordered.shape[:2], 1))], axis=2)
        fit = homogeneous.reshape(-1, 3) @ np.linalg.pinv(homogeneous[[0, -1]].reshape(4, 3))
        expected = (fit @ ends).reshape(len(ends), len(section), 1, 4)
        off = np.linalg.norm(expected - sides, axis=-1)  # (pairs, n, triples)
        off[:, 0], off[:, -1] = (np.where(np.arange(len(sides)) == end[:, None], off[:, k], np.inf) for k, end in ((0, first), (-1, last)))
        chosen = off.argmin(axis=2)
        worst = off.min(axis=2).max(axis=1) / widths
        faintest = brightness[triples[chosen]].min(axis=(1, 2))
        score = np.where(worst < OFF, faintest * np.exp(-((worst / OFF) ** 2) * 2), 0.0)
        number = int(score.argmax())
        if score[number] > (best[0] if best else 0.0):
            best = float(score[number]), points[chosen[number]]
    return None if best is None else best[1]


def bright_dots(image: Numbers) -> tuple[Floats, Floats]:
    """The brightest spots about as large as a wire's echo: (n, 2) pixels (column, row), centers of mass, and how bright each is, (n,)."""
    gray = np.asarray(image, dtype=np.float64)
    unit = max(gray.shape[1] / 200, 1.0)
    # A box is as good for what lies around, and much faster than a Gaussian
    blurred = scipy.ndimage.gaussian_filter(gray, unit / 2)
    spots = blurred - scipy.ndimage.uniform_filter(blurred, int(12 * unit) | 1)
    highest = scipy.ndimage.maximum_filter(spots, (int(4 * unit) | 1, int(6 * unit) | 1))
    found_rows, found_columns = np.nonzero((spots == highest) & (spots > FAINTEST * spots.max()) & (spots > 0))
    order = np.argsort(-spots[found_rows, found_columns], kind="stable")[:MOST_DOTS]
    centers = []
    tall, wide = int(3 * unit), int(5 * unit)
    for row, column in zip(found_rows[order], found_columns[order], strict=True):
        top, left = max(row - tall, 0), max(column - wide, 0)
        around = spots[top : row + tall + 1, left : column + wide + 1] - spots[row, column] / 2
        labels, _ = scipy.ndimage.label(around > 0)
        inside = labels == labels[row - top, column - left]
        weights = around[inside]
        rows, columns = np.nonzero(inside)
        centers.append((left + weights @ columns / weights.sum(), top + weights @ rows / weights.sum()))
    return np.array(centers).reshape(-1, 2), spots[found_rows[order], found_columns[order]]


def _lines(dots: Floats, shortest: float) -> Integers:
    """Numbers (n, 3) of dots on a line that is more level than upright, from left to right."""
    order = np.argsort(dots[:, 0], kind="stable")
    triples: Integers = order[np.array([*itertools.combinations(range(len(dots)), 3)], dtype=np.int64).reshape(-1, 3)]
    left, middle, right = triples.T
    along, to = dots[right] - dots[left], dots[middle] - dots[left]
    length = np.hypot(*along.T)
    with np.errstate(invalid="ignore", divide="ignore"):
        off = np.abs(along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]) / length
        part = (along * to).sum(axis=1) / length**2
    good = (length > shortest) & (np.abs(along[:, 1]) < np.abs(along[:, 0])) & (off < OFF * length) & (part > OFF) & (part < 1 - OFF)
    return np.asarray(triples[good])
