"""Everything but bone: where skin, fat, fascia, muscle, ligaments and the dural sac are, and how strongly each scatters ultrasound.

All layers follow arcs about one axis (x) behind the back, so a point's tissue depends on x and on its depth along the radius.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..arrays import Floats, Reals, Singles
from .implicit_shapes import ellipse

SKIN_THICKNESS = 2.0
"""mm, epidermis and dermis of the back."""

TEXTURE_PITCH = 1.25
"""mm between samples of the texture."""

LIGAMENT_HALF_WIDTH = 2.2
"""mm, of the interspinous ligament."""


@dataclass(frozen=True, eq=False)
class SoftTissue:
    """Where the tissues are. Lengths in mm, depths from the skin or from the spinolaminar junctions' arc, forward positive.

    Parameters
    ----------
    arc_center_y : float
        y of the common axis in Reference, at z = 0.
    skin_to_lamina, fat_thickness : float
        In the midline.
    canal_center, body_center : float
        Depths from the laminae.
    canal_radii, body_radii : (lateral, along depth)
    body_angles : (inferior, superior), radians
        Extent of the column of bodies and discs along the arc.
    texture : (2, n, n, n) float32 array, [k, j, i], zero mean and unit variance, periodic
        Fibers along z, and sheets across y.
    """

    arc_center_y: float
    skin_to_lamina: float
    fat_thickness: float
    canal_center: float
    canal_radii: tuple[float, float]
    body_center: float
    body_radii: tuple[float, float]
    body_angles: tuple[float, float]
    texture: Singles

    @property
    def skin_radius(self) -> float:
        """Of the skin's arc in the midline."""
        return -self.arc_center_y

    def skin_relief(self, x: ArrayLike) -> Floats:
        """How much farther forward the skin lies at x than in the midline, mm: the back's roundness and the furrow between the muscles."""
        at: Floats = np.asarray(x)
        relief: Floats = at * at / 560.0 - 2.5 * (1.0 - np.exp(-((at / 24.0) ** 2)))
        return relief

    def skin_y(self, x: ArrayLike, z: ArrayLike) -> Floats:
        """y of the skin in Reference at (x, z), mm."""
        height = np.asarray(z, dtype=np.float64)
        y: Floats = self.arc_center_y + np.sqrt((self.skin_radius + self.skin_relief(x)) ** 2 - height * height)
        return y

    def fat_depth(self, x: Singles) -> Singles:
        """Depth of the thoracolumbar fascia under the skin at x, mm: a little deeper over the furrow."""
        depth = SKIN_THICKNESS + (self.fat_thickness - SKIN_THICKNESS) * (0.72 + 0.28 * np.exp(-((x / 18.0) ** 2)))
        return np.asarray(depth, dtype=np.float32)

    def sample_texture(self, kind: int, x: Reals, y: Reals, z: Reals) -> Singles:
        """Texture `kind` (0 fibers, 1 sheets) at points given by arrays of one shape."""
        coordinates = np.stack([np.ravel(c) for c in (z, y, x)]) / TEXTURE_PITCH
        coordinates = coordinates.astype(np.float32)
        values = scipy.ndimage.map_coordinates(self.texture[kind], coordinates, order=1, mode="grid-wrap", output=np.float32)
        return values.reshape(np.shape(x))

    def scattering_db(self, points_reference: Floats, beams_reference: Floats) -> Singles:
        """Mean echo of soft tissue, as if there were no bone.

        Parameters
        ----------
        points_reference : (..., 3) array, mm
        beams_reference : (..., 3) array that broadcasts with them, unit vectors

        Returns
        -------
        scattering_db : (...) float32 array
            dB above the smallest echo on the screen at normal gain; -40 where nothing scatters (gel before the skin). Fascia,
            ligamentum flavum and dura reflect most when met squarely.
        """
        x, y, z = (np.ascontiguousarray(points_reference[..., axis], dtype=np.float32) for axis in range(3))
        radius = np.hypot(y - np.float32(self.arc_center_y), z)
        depth = radius - np.float32(self.skin_radius) - self.skin_relief(x)
        forward = radius - np.float32(self.skin_radius + self.skin_to_lamina)
        fibers = self.sample_texture(0, x, forward, z)
        sheets = self.sample_texture(1, x, depth, z)
        square = np.abs(beams_reference[..., 1]).astype(np.float32) ** 6
        fascia = self.fat_depth(x)

        muscle = 18.0 + 3.4 * fibers + 7.0 * np.clip(fibers - 1.2, 0.0, 1.5) - 0.06 * np.clip(depth - 30.0, 0.0, None)
        midline = np.exp(-((x / LIGAMENT_HALF_WIDTH) ** 2)) * (forward < 0)
        db = muscle + midline * (5.0 + 2.0 * sheets)
        fat = 15.5 + 2.0 * sheets + 11.0 * np.clip(sheets - 0.9, 0.0, 1.2) * square
        db = np.where(depth < fascia, fat, db)
        db = np.maximum(db, 8.0 + (19.0 + 2.5 * fibers) * square * _line(depth - fascia, 0.7) + 6.0 * _line(depth - fascia, 0.9))
        db = np.where(depth < SKIN_THICKNESS, 26.0 + sheets, db)

        canal = ellipse(x, forward - self.canal_center, *self.canal_radii)
        behind = forward < self.canal_center
        flavum = _line(canal - 2.2, 1.5) * behind
        dura = np.maximum(_line(canal + 0.3, 0.6) * behind, 0.8 * _line(canal + 0.3, 0.6))
        db = np.where(canal < 0, np.where(canal < -0.8, 3.0 + fibers, db), db)
        db = np.maximum(db, (16.0 + 12.0 * square) * np.maximum(flavum, dura))
        disc = ellipse(x, forward - self.body_center, *self.body_radii)
        db = np.where((disc < 0) & (canal > 0), 12.0, db)
        return np.where(depth < 0, -40.0, db).astype(np.float32)


def _line(distance: Reals, width: float) -> Reals:
    """1 on a surface, falling smoothly to 0 within about `width` mm of it."""
    line: Reals = np.exp(-((distance / width) ** 2))
    return line


def make_texture(rng: np.random.Generator, samples: int = 56) -> Singles:
    """Two periodic random fields, (2, n, n, n) float32, [k, j, i], zero mean and unit variance: fibers along z, and sheets across y."""
    fields = []
    for sigma in ((7.0, 0.8, 1.3), (5.0, 0.7, 6.0)):
        noise = rng.standard_normal((samples, samples, samples)).astype(np.float32)
        noise = scipy.ndimage.gaussian_filter(noise, sigma, mode="wrap")
        fields.append((noise - noise.mean()) / noise.std())
    return np.stack(fields)
